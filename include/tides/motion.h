/* How the Gaussians of an object move by themselves: the motion models that dynamic splatting methods train.
 *
 * A motion belongs to one set of Gaussians (its canonical, raw parameters) and gives their parameters and exact rates at any
 * time of its own clock, [start, stop], in whatever unit the method used. */
#ifndef TIDES_MOTION_H
#define TIDES_MOTION_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct tides_motion tides_motion;

/* NULL is fine. A motion that a scene took over isn't the caller's any more. */
TIDES_API void tides_motion_destroy(tides_motion *motion);

/* "polynomial", "rotor", "keyframes", "hexplane", "network", "callback"; static storage. */
TIDES_API const char *tides_motion_model(const tides_motion *motion);

/* First and last time of its own clock. */
TIDES_API void tides_motion_range(const tides_motion *motion, double *start, double *stop);

/* Constructors from arrays. They copy what they are given; count < 1, start >= stop, NaN or Inf: an error naming the array.
 * The Gaussians that a motion is for come with it when it is added to a scene: their number must be the same. */

/* Polynomials in time with a bell of opacity (SpacetimeGaussians, Li et al. 2024): with dt = tau - opacity_centre,
 *   mean = mean_0 + c_1 dt + c_2 dt^2 + c_3 dt^3,   quaternion = (quaternion_0 + quaternion_dot dt) normalised,
 *   opacity = sigmoid(opacity_logit) exp(-(dt / e^opacity_log_width)^2);   scales and colours stay.
 * Its trainer's tau is (frame - first frame) / frames, from 0 to 1. */
typedef struct tides_polynomial_motion {
    int64_t count;                  /* N */
    double start, stop;             /* [tau] */
    const float *opacity_centre;    /* [tau]                    (N) */
    const float *opacity_log_width; /* ln [tau], within +-80    (N) */
    const float *mean_coefficient;  /* c_1, c_2, c_3: xyz each [scene units / tau^k]  (N x 9) */
    const float *quaternion_dot;    /* wxyz [1 / tau]           (N x 4) */
    int32_t plain_colour;           /* 1: colours are as given, not cut at 0 (the lite model) */
    int32_t reserved;
} tides_polynomial_motion;
TIDES_MUST_CHECK TIDES_API tides_status tides_motion_create_polynomial(const tides_polynomial_motion *arrays,
                                                                       tides_motion **motion, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
