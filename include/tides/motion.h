/* How the Gaussians of an object move by themselves: the motion models that dynamic splatting methods train.
 *
 * A motion belongs to one set of Gaussians (its canonical, raw parameters). It gives their parameters and exact rates at any
 * time of its own clock, [start, stop], in the method's unit of time. */
#ifndef TIDES_MOTION_H
#define TIDES_MOTION_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A motion of Gaussians. Opaque, constant once made. */
typedef struct tides_motion tides_motion;

/* NULL is fine. A motion that was added to a scene belongs to the scene. */
TIDES_API void tides_motion_destroy(tides_motion *motion);

/* "polynomial", "rotor", "keyframes", "hexplane", "network", "callback"; static storage. */
TIDES_API const char *tides_motion_model(const tides_motion *motion);

/* First and last time of its own clock. */
TIDES_API void tides_motion_range(const tides_motion *motion, double *start, double *stop);

/* Constructors from arrays, which they copy. count < 1, start >= stop, NaN or Inf: an error naming the array. The Gaussians
 * come with the motion when it is added to a scene; their number must be the same. If they have an origin, means here still
 * count from (0, 0, 0). */

/* Polynomials in time with a bell of opacity (SpacetimeGaussians, Li et al. 2024): with dt = tau - opacity_centre,
 *   mean = mean_0 + c_1 dt + c_2 dt^2 + c_3 dt^3,   quaternion = (quaternion_0 + quaternion_dot dt) normalised,
 *   opacity = sigmoid(opacity_logit) exp(-(dt / e^opacity_log_width)^2);   scales and colours stay.
 * Its trainer's tau is (frame - first frame) / frames, from 0 to 1.
 *
 * The full model has nine features instead of a colour, (feature, dt feature_dot), which are composited and make a pixel's
 * colour: out(feature_0..2 + W_2 relu(W_1 (feature_3..8, centre of the camera, direction of the pixel))), with out the sigmoid
 * (`sandwich`), a clamp to 0..1 (`sandwichnoact`) or nothing (`sandwichnoactss`). */
enum { TIDES_DECODER_NONE = 0, TIDES_DECODER_SIGMOID = 1, TIDES_DECODER_CLAMP = 2, TIDES_DECODER_PLAIN = 3 };
typedef struct tides_polynomial_motion {
    int64_t count;                  /* N */
    double start, stop;             /* [tau] */
    const float *opacity_centre;    /* [tau]                    (N) */
    const float *opacity_log_width; /* ln [tau], within +-80    (N) */
    const float *mean_coefficient;  /* c_1, c_2, c_3: xyz each [scene units / tau^k]  (N x 9) */
    const float *quaternion_dot;    /* wxyz [1 / tau]           (N x 4) */
    int32_t plain_colour;           /* 1: colours are as given, not cut at 0 (the lite model) */
    int32_t decoder;                /* TIDES_DECODER_...; other than NONE: the full model, with */
    const float *feature;           /* albedo 3, then 3 more     (N x 6) */
    const float *feature_dot;       /* of the last 3 of nine: dt times these [1 / tau]  (N x 3) */
    const float *decoder_first;     /* W_1, row-major           (6 x 12) */
    const float *decoder_second;    /* W_2                      (3 x 6) */
} tides_polynomial_motion;
TIDES_MUST_CHECK TIDES_API tides_status tides_motion_create_polynomial(const tides_polynomial_motion *arrays,
                                                                       tides_motion **motion, tides_error *error);

/* 4-D Gaussians sliced in time (4d-gaussian-splatting of Fudan, Yang et al. 2024). In four dimensions (x y z t) the covariance
 * is that of two quaternions, the Gaussians' own (left) and quaternion_right, and four scales; at tau, with dt = tau - centre,
 *   mean = mean_0 + S_xt / S_tt dt,   covariance = S_xx - S_xt S_xt^T / S_tt,
 *   opacity = sigmoid(opacity_logit) exp(-dt^2 / (2 (S_tt + time_prefilter))),   sh = sum_k cos(2 pi k dt / period) sh_k,
 * sh_0 being the Gaussians' own. Without quaternion_right means don't move, and S_tt is e^log_scale_time, not its square (as
 * in their code). Opacities with a bell at or below 0.05 are 0 (image.rules smooth: fade below it). The direction of view is
 * taken to mean_0, as their kernel does. tau is in their scene's time: seconds for N3V, 0 to 1 for D-NeRF. */
typedef struct tides_rotor_motion {
    int64_t count;                 /* N */
    double start, stop;            /* [tau] */
    double period;                 /* [tau]; 0: stop - start */
    double time_prefilter;         /* [tau^2]; 0 or less: none */
    const float *centre;           /* [tau]                     (N) */
    const float *log_scale_time;   /* ln [tau]                  (N) */
    const float *quaternion_right; /* NULL: none                (N x 4) */
    const float *sh_harmonic;      /* sh_1, sh_2 ..             (N x harmonics x K x 3) */
    int32_t harmonics;             /* 0..4; their sh_degree_t */
    int32_t sh_degree;             /* of K = (sh_degree + 1)^2: the Gaussians' own */
} tides_rotor_motion;
TIDES_MUST_CHECK TIDES_API tides_status tides_motion_create_rotor(const tides_rotor_motion *arrays, tides_motion **motion,
                                                                  tides_error *error);

/* Raw parameters at frames (Dynamic3DGaussians, Luiten et al. 2024; sequences of .ply files), joined by a C2 cubic spline;
 * where that would swing far beyond the frames around it, by a calmer C1 one. Rates are its exact derivative. Quaternions are
 * normalised, their signs made continuous, and normalised again in between.
 * Parameters that are NULL stay the Gaussians' own. Its clock is that of `time`, from the first frame to the last. */
typedef struct tides_keyframes_motion {
    int64_t frames, count;      /* T >= 2, N */
    const double *time;         /* any unit, strictly rising (T) */
    const float *mean;          /* [scene units]            (T x N x 3) */
    const float *quaternion;    /* wxyz, raw                (T x N x 4) */
    const float *log_scale;     /* ln [scene units]; or NULL (T x N x 3) */
    const float *opacity_logit; /* or NULL                  (T x N) */
    const float *sh;            /* or NULL                  (T x N x K x 3) */
    int32_t sh_degree;          /* of K = (sh_degree + 1)^2: the Gaussians' own */
    int32_t catmull_rom;        /* 1: Catmull and Rom's C1 cubics instead */
    int32_t plain_colour;       /* 1: colours aren't cut at 0 */
    int32_t reserved;
    const double *mean_double; /* NULL, or the means in double, in place of `mean` (T x N x 3) */
} tides_keyframes_motion;
TIDES_MUST_CHECK TIDES_API tides_status tides_motion_create_keyframes(const tides_keyframes_motion *arrays,
                                                                      tides_motion **motion, tides_error *error);

/* Raw parameters of `count` Gaussians at a time, and their rates per unit of that time. A function gets them filled with the
 * Gaussians' own parameters and rates of 0, and changes them. Row i belongs to Gaussian index[i]. */
typedef struct tides_theta {
    double *mean, *mean_dot;                   /* (count x 3) */
    double *log_scale, *log_scale_dot;         /* (count x 3) */
    double *quaternion, *quaternion_dot;       /* (count x 4) */
    double *opacity_logit, *opacity_logit_dot; /* (count) */
    double *sh, *sh_dot;                       /* (count x K x 3); NULL unless the motion moves them */
} tides_theta;

/* Fills `theta` at `time`. Where rates jump, `side` -1 asks for rates before `time`, +1 for those after it. Returns TIDES_OK,
 * or a status with `error` filled, which the running call returns (TIDES_CANCELLED for a number that isn't a status). */
typedef tides_status (*tides_motion_function)(void *user, double time, int32_t side, const int32_t *index, int64_t count,
                                              const tides_theta *theta, tides_error *error);

/* Any other motion, as a function. It is called in the thread that renders or simulates the scene, once at a time for each
 * renderer; renderers of several threads call it at once. `user` must outlive the motion. NaN or Inf, or a quaternion of
 * zero, ends the running call with TIDES_BAD_ARGUMENT. Scenes with such a motion can't be saved. */
typedef struct tides_callback_motion {
    int64_t count;                  /* N */
    double start, stop;             /* its own clock, any unit */
    tides_motion_function function; /* fills values and rates */
    void *user;                     /* its first argument */
    int32_t moves_sh;               /* 1: it also fills sh and sh_dot */
    int32_t reserved;
    /* about the shortest period: how long motion may go on unseen between values and rates at the start, the middle and the
     * end. 0: one macro step of the run (step_s), at least */
    double time_scale;
} tides_callback_motion;
TIDES_MUST_CHECK TIDES_API tides_status tides_motion_create_callback(const tides_callback_motion *callback,
                                                                     tides_motion **motion, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
