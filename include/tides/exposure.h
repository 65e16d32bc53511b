/* Frames as cameras make them: light gathered for a while, by a global or a rolling shutter, and written as numbers.
 *
 * A row that is exposed from a to b sees the mean of linear light, Y or (r, g, b), over [a, b]. That mean is integrated from
 * renders and their exact rates, tile by tile, at as many times as the asked tolerance needs, and as what motions and paths say
 * of themselves asks for: a flash of some microseconds is in it. A frame's time is the middle of its middle row's exposure. */
#ifndef TIDES_EXPOSURE_H
#define TIDES_EXPOSURE_H

#include "tides/render.h"

#ifdef __cplusplus
extern "C" {
#endif

/* GLOBAL: all rows are exposed together. ROLLING: each row row_time_s after the one above it. */
enum { TIDES_SHUTTER_GLOBAL = 0, TIDES_SHUTTER_ROLLING = 1 };

/* Fill with tides_exposure_defaults: global, Y, 8 bits, linear; 30 frames a second of 10 ms each, 20 us a row, to 0.001 of full
 * scale, gain 1, gamma 1, no noise, seed 0. */
typedef struct tides_exposure {
    uint32_t size;            /* sizeof this struct */
    int32_t shutter;          /* TIDES_SHUTTER_* */
    double frames_per_second; /* [Hz] */
    double exposure_s;        /* [s] for which each row gathers light; 0: an instant */
    double row_time_s;        /* [s] rolling: from a row to the one below it; negative: from the bottom up */
    double tolerance;         /* most that mean light may be off by: an estimate of it, in every pixel [1] */
    int32_t colour;           /* 1: r, g and b; 0: Y */
    int32_t bits;             /* of a value: 8 or 16 */
    int32_t transfer;         /* TIDES_TRANSFER_*: how light becomes a value (tides/frames.h) */
    int32_t reserved;
    double gamma;        /* with TIDES_TRANSFER_LINEAR: values go as light^(1 / gamma), 1 being full scale */
    double gain;         /* values are at full scale where light times gain is 1 */
    double full_well_e;  /* electrons at full scale, for shot noise; 0: none */
    double read_noise_e; /* electrons, rms, added to each value; asks for full_well_e */
    uint64_t seed;       /* of noise */
} tides_exposure;
TIDES_API void tides_exposure_defaults(tides_exposure *exposure);

/* Planes of a frame's light and values: 1 (Y) or 3 (r, g, b). */
TIDES_API int32_t tides_exposure_planes(const tides_exposure *exposure);

/* When a row is exposed, of a frame of `height` rows at `time` [s]: from `start` to `stop`, each nullable. And when any row of
 * it is: from the earlier of its first and last row's starts to the later of their stops. */
TIDES_API void tides_exposure_row(const tides_exposure *exposure, int32_t height, double time, int32_t row, double *start,
                                  double *stop);
TIDES_API void tides_exposure_span(const tides_exposure *exposure, int32_t height, double time, double *start, double *stop);

/* Frames that lie within [start, stop] [s] with all their rows, the first as early as can be; and when frame `index` is. */
TIDES_API size_t tides_exposure_count(const tides_exposure *exposure, int32_t height, double start, double stop);
TIDES_API double tides_exposure_time(const tides_exposure *exposure, int32_t height, double start, size_t index);

/* Cost and error of a frame. Plain value. */
typedef struct tides_exposed {
    double error;   /* largest estimated error of a pixel's mean light [1]; above the tolerance where pixels are unsettled */
    double renders; /* full frames' worth of tiles rendered */
    uint64_t unsettled; /* pixels that no cut to 1/4096 of the frame's exposure, or of what something short takes of it, brought
                           within the tolerance; and those that see what may be shorter than 1/262144 of it all along */
} tides_exposed;

/* Mean linear light of the frame at `time` [s] seen from `camera`: light (planes x height x width), row 0 on top, caller's
 * memory. The renderer's PSF, if any, blurs light itself, whatever its domain: optics do. `done` is nullable.
 * TIDES_UNSUPPORTED: a PSF with a rolling shutter. TIDES_OUT_OF_RANGE: the path ends before the exposure does.
 * TIDES_BAD_ARGUMENT: a value of the exposure out of range, by name. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_expose(tides_renderer *renderer, const tides_trajectory *camera,
                                                              double time, const tides_exposure *exposure, double *light,
                                                              tides_exposed *done, tides_error *error);

/* Light to values (height x width x planes, r, g and b together): gain, shot noise, read noise, clipping, transfer, rounding.
 * Noise is of the seed, the pixel and the frame's `index` alone. Where less than 100 electrons are expected their
 * number is drawn from Poisson's law. From 100 on it is a rounded normal number of the same mean and variance: a skewness of at
 * most 0.1 is lost. */
TIDES_MUST_CHECK TIDES_API tides_status tides_exposure_values(const tides_exposure *exposure, int32_t width, int32_t height,
                                                              size_t index, const double *light, uint16_t *values,
                                                              tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
