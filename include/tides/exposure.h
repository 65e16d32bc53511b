/* Frames as cameras make them: light is gathered for a while, by a global or a rolling shutter, and converted to numbers.
 *
 * A row that is exposed from a to b sees the mean of linear light, Y or (r, g, b), over [a, b]. The mean is integrated from
 * renders and their exact rates, tile by tile, at as many times as the tolerance needs. Motions and paths tell where they are
 * fast, so that a flash of some microseconds isn't missed. A frame's time is the middle of its middle row's exposure. */
#ifndef TIDES_EXPOSURE_H
#define TIDES_EXPOSURE_H

#include "tides/render.h"

#ifdef __cplusplus
extern "C" {
#endif

/* GLOBAL: all rows are exposed together. ROLLING: each row is exposed row_time_s after the row above it. */
enum { TIDES_SHUTTER_GLOBAL = 0, TIDES_SHUTTER_ROLLING = 1 };

/* Fill with tides_exposure_defaults: global, Y, 8 bits, linear; 30 frames a second of 10 ms each, 20 us a row, to 0.001 of full
 * scale, gain 1, gamma 1, no noise, seed 0. */
typedef struct tides_exposure {
    uint32_t size;            /* sizeof this struct */
    int32_t shutter;          /* TIDES_SHUTTER_* */
    double frames_per_second; /* [Hz] */
    double exposure_s;        /* [s] during which each row gathers light; 0: an instant */
    double row_time_s;        /* [s] ROLLING: from a row to the one below; negative: the bottom row is first */
    double tolerance;         /* bound of the estimated error of mean light, in every pixel [1] */
    int32_t colour;           /* 1: r, g and b; 0: Y */
    int32_t bits;             /* of a value: 8 or 16 */
    int32_t transfer;         /* TIDES_TRANSFER_*: how light becomes a value */
    int32_t reserved;
    double gamma;        /* with TIDES_TRANSFER_LINEAR: values go as light^(1 / gamma), 1 being full scale */
    double gain;         /* values are at full scale where light times gain is 1 */
    double full_well_e;  /* electrons at full scale, for shot noise; 0: none */
    double read_noise_e; /* [electrons] rms, added to each value; needs full_well_e */
    uint64_t seed;       /* of noise */
} tides_exposure;
TIDES_API void tides_exposure_defaults(tides_exposure *exposure);

/* Planes of a frame's light and values: 1 (Y) or 3 (r, g, b). */
TIDES_API int32_t tides_exposure_planes(const tides_exposure *exposure);

/* The exposure of a row, in a frame of `height` rows at `time` [s]: from `start` to `stop`, each nullable. _span: from the
 * first start to the last stop of all its rows. */
TIDES_API void tides_exposure_row(const tides_exposure *exposure, int32_t height, double time, int32_t row, double *start,
                                  double *stop);
TIDES_API void tides_exposure_span(const tides_exposure *exposure, int32_t height, double time, double *start, double *stop);

/* The number of frames whose rows all lie within [start, stop] [s], the first as early as possible; and the time of frame
 * `index`. */
TIDES_API size_t tides_exposure_count(const tides_exposure *exposure, int32_t height, double start, double stop);
TIDES_API double tides_exposure_time(const tides_exposure *exposure, int32_t height, double start, size_t index);

/* The cost and the error of a frame. Plain value. */
typedef struct tides_exposed {
    double error;   /* largest estimated error of a pixel's mean light [1]; may exceed the tolerance if pixels are unsettled */
    double renders; /* full frames' worth of tiles rendered */
    /* pixels above the tolerance even after cuts to 1/4096 of the exposure, or of a short change; or that may change faster
     * than 1/262144 of it */
    uint64_t unsettled;
} tides_exposed;

/* Mean linear light of the frame at `time` [s] seen from `camera`: light (planes x height x width), row 0 on top, caller's
 * memory. A PSF of the renderer blurs light itself, whatever its domain, as optics do. `done` is nullable. TIDES_UNSUPPORTED:
 * a PSF with a rolling shutter. TIDES_OUT_OF_RANGE: the path ends during the exposure. TIDES_BAD_ARGUMENT naming a value of
 * the exposure. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_expose(tides_renderer *renderer, const tides_trajectory *camera,
                                                              double time, const tides_exposure *exposure, double *light,
                                                              tides_exposed *done, tides_error *error);

/* Converts light to values (height x width x planes, r, g and b together): gain, shot noise, read noise, clipping, transfer,
 * rounding. Noise depends only on the seed, the pixel and the frame's `index`. The number of electrons is drawn from
 * Poisson's law if less than 100 are expected. Else it is a rounded normal number of the same mean and variance, without the
 * skewness of at most 0.1. */
TIDES_MUST_CHECK TIDES_API tides_status tides_exposure_values(const tides_exposure *exposure, int32_t width, int32_t height,
                                                              size_t index, const double *light, uint16_t *values,
                                                              tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
