/* Frame sequences as input: pictures in a folder, arrays in a file, videos, or memory. */
#ifndef TIDES_FRAMES_H
#define TIDES_FRAMES_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How stored values become luminance (TIDES_TRANSFER_LINEAR or _SRGB): sRGB-encoded ones are decoded before r, g and b are
 * weighed. options->full_scale is the stored value that stands for 1. Without it, light 1 is the largest value of an integer
 * type, and 1 for floats. Floats that are whole numbers, the largest above 16 and at most 255, count to 255 (tides_frames_note
 * says so). Other values need the option, else TIDES_BAD_CONFIG: integers of 16 bits or more that fill less than a quarter of
 * their range (10 bits, say), floats beyond 16, and whole ones from 2 to 16.
 *
 * Fill with tides_frames_options_defaults: no file, no rate, auto, linear, the weights of BT.709, luminance, full scale as the
 * values tell. */
typedef struct tides_frames_options {
    uint32_t size;
    int32_t transfer;         /* TIDES_TRANSFER_LINEAR or _SRGB */
    int32_t unit;             /* TIDES_TIME_* of timestamp files and of arrays with times; AUTO: as its header says, else
                                 microseconds in image_timestamps.txt (DSEC), else the unit in which frames come 1 to 1000
                                 times a second, or count from 1970 */
    int32_t rebase;           /* 1: the first frame's time becomes 0 */
    const char *timestamps;   /* text file with a time per line, after names or an index, with or without header; or NULL */
    double frames_per_second; /* [Hz]: frame k is at k / rate; 0: not given */
    double luminance[3];      /* weights of r, g, b */
    int32_t planes;           /* 1: luminance; more: arrays with this many values per pixel, used unchanged (voxel grids) */
    double offset_s;          /* [s] added to all times, after `rebase` */
    double full_scale;        /* the stored value that means light 1; 0: the type's largest value, or found from the values */
} tides_frames_options;
TIDES_API void tides_frames_options_defaults(tides_frames_options *options);

/* A sequence of frames: a file, a folder, or memory. Opaque. */
typedef struct tides_frames tides_frames;

/* Opens a sequence, all frames of one size, times ascending:
 *   a folder         its .png (grey or RGB, 8 or 16 bit) or .exr files (channel Y, R G B, or the only one), in natural order
 *   .npy, .npz       an array (frames, height, width) of numbers; the .npz's is "Y", "frames", "images" or "voxels", times
 *                    "t" or "timestamps"
 *   .h5, .hdf5       the same names, read frame by frame; .aedat4: those beside its events, at mid-exposure, on their clock
 *   .y4m, a pipe,    YUV4MPEG2 video, as `ffmpeg -f yuv4mpegpipe` writes it: 4:2:0, 4:2:2, 4:4:4, 4:1:1 or grey, of 8 to 16
 *   "-"              bits, with its frame rate; "-" is the standard input. Pipes are read to their end, into a temporary file.
 *                    Values are R'G'B' by BT.601: give them TIDES_TRANSFER_SRGB
 * With more planes an array is (frames, planes, height, width), where several dimensions may make up the planes, as in
 * (frames, 2, 10, height, width); without its first dimension it is one frame.
 * Times come from options->timestamps, else the rate, else the array file's own, else timestamps.txt or image_timestamps.txt
 * in the folder or beside it. TIDES_BAD_FILE, TIDES_BAD_CONFIG where there are no times. */
TIDES_MUST_CHECK TIDES_API tides_status tides_frames_open(const char *path, const tides_frames_options *options,
                                                          tides_frames **frames, tides_error *error);

/* A line that says how values were interpreted, if this was guessed from them; else "". Lives as long as the frames. */
TIDES_API const char *tides_frames_note(const tides_frames *frames);

/* Frames in memory: luminance (count x height x width), 1 at full scale, and times [s] (count), which must outlive the
 * object. */
TIDES_MUST_CHECK TIDES_API tides_status tides_frames_from_memory(const double *Y, const double *times, size_t count,
                                                                 int32_t width, int32_t height, tides_frames **frames,
                                                                 tides_error *error);
TIDES_API void tides_frames_close(tides_frames *frames); /* NULL is fine */

/* The number of frames, and their size [px]. */
TIDES_API size_t tides_frames_count(const tides_frames *frames);
TIDES_API void tides_frames_size(const tides_frames *frames, int32_t *width, int32_t *height);
TIDES_API int32_t tides_frames_planes(const tides_frames *frames);            /* values per pixel */
TIDES_API double tides_frames_time(const tides_frames *frames, size_t index); /* [s]; NaN out of range */

/* Reads the luminance of frame `index` into Y ((planes x) height x width, row 0 on top), caller's memory. TIDES_BAD_FILE
 * naming the pixel: negative, infinite or NaN. */
TIDES_MUST_CHECK TIDES_API tides_status tides_frames_read(tides_frames *frames, size_t index, double *Y, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
