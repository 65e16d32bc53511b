/* Float images to and from OpenEXR, PNG pictures, and animations of them. */
#ifndef TIDES_IMAGE_H
#define TIDES_IMAGE_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One named channel of an EXR file. */
typedef struct tides_channel {
    const char *name;    /* e.g. "L_dot"; EXR sorts them by name */
    const float *pixels; /* (height x width), row 0 on top */
} tides_channel;

/* Compression: none; each row by itself; blocks of 16 rows. */
enum { TIDES_EXR_NONE = 0, TIDES_EXR_ZIPS = 2, TIDES_EXR_ZIP = 3 };

/* Writes 32-bit float channels to a scan-line EXR, as a .part that is renamed. `attributes` (nullable) is a list of name,
 * value string pairs ended by NULL. */
TIDES_MUST_CHECK TIDES_API tides_status tides_exr_write(const char *path, int32_t width, int32_t height,
                                                        const tides_channel *channels, int32_t count, int32_t compression,
                                                        const char *const *attributes, tides_error *error);

/* An EXR file in memory. */
typedef struct tides_exr tides_exr;
TIDES_MUST_CHECK TIDES_API tides_status tides_exr_read(const char *path, tides_exr **exr, tides_error *error);
TIDES_API void tides_exr_destroy(tides_exr *exr); /* NULL is fine */
TIDES_API void tides_exr_size(const tides_exr *exr, int32_t *width, int32_t *height, int32_t *channels);
TIDES_API const char *tides_exr_name(const tides_exr *exr, int32_t channel); /* lives as long as exr; NULL out of range */
/* (height x width), lives as long as exr; NULL out of range */
TIDES_API const float *tides_exr_pixels(const tides_exr *exr, int32_t channel);

/* 8-bit pictures. `rgb` is (height x width x 3), row 0 on top. */
TIDES_MUST_CHECK TIDES_API tides_status tides_png_write(const char *path, int32_t width, int32_t height, const uint8_t *rgb,
                                                        tides_error *error);

/* Writes values unchanged, of 8 or 16 bits, (height x width x planes): 1 plane is grey, 3 are r, g and b together. */
TIDES_MUST_CHECK TIDES_API tides_status tides_png_write_values(const char *path, int32_t width, int32_t height, int32_t planes,
                                                               int32_t bits, const uint16_t *values, tides_error *error);

/* Pictures of one size, one after the other, at 0.02 to 1000 pictures a second. By `path`:
 *   .png, .apng   an animated PNG, repeated for ever
 *   .y4m          a video for ffmpeg and mpv: YUV4MPEG2, 4:4:4, BT.601 in studio range
 *   frame%04d.png a PNG for each picture, numbered from 0 on: one %d, its width up to 9 digits
 * TIDES_UNSUPPORTED: another ending. The first two are streamed, written beside as `path` + ".part" and renamed. */
typedef struct tides_animation tides_animation;
TIDES_MUST_CHECK TIDES_API tides_status tides_animation_open(const char *path, int32_t width, int32_t height,
                                                             double pictures_per_second, tides_animation **animation,
                                                             tides_error *error);

/* Writes the video while it is made to an open file descriptor (a pipe), which the caller closes. */
TIDES_MUST_CHECK TIDES_API tides_status tides_animation_stream(int32_t descriptor, int32_t width, int32_t height,
                                                               double pictures_per_second, tides_animation **animation,
                                                               tides_error *error);

/* Appends a picture, rgb (height x width x 3). After a failure only _abandon may be called. */
TIDES_MUST_CHECK TIDES_API tides_status tides_animation_append(tides_animation *animation, const uint8_t *rgb,
                                                               tides_error *error);

/* Completes the file, which must have a picture; the animation is gone, whatever is returned. */
TIDES_MUST_CHECK TIDES_API tides_status tides_animation_finish(tides_animation *animation, tides_error *error);

/* Removes the unfinished file (numbered pictures stay). NULL is fine. */
TIDES_API void tides_animation_abandon(tides_animation *animation);

/* Pictures of data, into rgb (height x width x 3), caller's memory.
 * grey: linear values to sRGB grey; `white` is the value shown as white.
 * signed: diverging blue-white-red (colour-blind safe) of values in [-limit, limit]; limit <= 0 takes the 99.5th percentile.
 * events: red ON and blue OFF over `base` (linear, 1 is white; nullable: mid grey), brighter where a pixel fired more often,
 *   violet where it fired both ways.
 * flow: a colour wheel of (u, v), right red, down yellow-green, left cyan, up violet; white at rest, full at `limit`, darker
 *   beyond it; limit <= 0 takes the fastest.
 * depth: near is light, far is dark, from `near` to `far` (else the nearest and farthest there are); 0 is black.
 * labels: whole numbers in colours of their own; negative ones are black.
 * NaN is magenta. */
TIDES_API void tides_picture_grey(const double *values, int32_t width, int32_t height, double white, uint8_t *rgb);
TIDES_API void tides_picture_rgb(const double *r, const double *g, const double *b, int32_t width, int32_t height,
                                 uint8_t *rgb);
TIDES_API void tides_picture_signed(const double *values, int32_t width, int32_t height, double limit, uint8_t *rgb);
TIDES_API void tides_picture_flow(const double *u, const double *v, int32_t width, int32_t height, double limit, uint8_t *rgb);
TIDES_API void tides_picture_depth(const double *depth, int32_t width, int32_t height, double near, double far, uint8_t *rgb);
TIDES_API void tides_picture_labels(const double *labels, int32_t width, int32_t height, uint8_t *rgb);

/* Draw the key of the colours into the lower right corner of a picture, which must be at least 64 px wide and high. Flow has
 * a wheel, white at rest and full at the limit. Depth has a ramp, with the nearest at its left end. */
TIDES_API void tides_picture_flow_key(uint8_t *rgb, int32_t width, int32_t height);
TIDES_API void tides_picture_depth_key(uint8_t *rgb, int32_t width, int32_t height);
TIDES_API void tides_picture_events(const tides_event *events, size_t count, const double *base, int32_t width, int32_t height,
                                    uint8_t *rgb);

/* Draws ASCII text into a picture, with its top left corner at (x, y), in cells of `scale` px. A character takes 6 by 9
 * cells, '\n' starts the next line, and other characters are boxes. Clipped at the borders. */
TIDES_API void tides_picture_text(uint8_t *rgb, int32_t width, int32_t height, int32_t x, int32_t y, int32_t scale,
                                  const uint8_t colour[3], const char *text);

#ifdef __cplusplus
}
#endif
#endif
