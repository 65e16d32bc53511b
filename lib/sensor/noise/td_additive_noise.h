/* Internal: the photoreceptor's additive noise: an Ornstein-Uhlenbeck process per pixel, on a time grid of the pixel's own.
 *
 * With tau = 1 / (2 pi noise_cutoff_hz), grid points are d = tau / 2 apart, from a phase that is drawn per pixel, and
 *
 *   x(k + 1) = rho x(k) + noise_rms sqrt(1 - rho^2) n(k + 1),  rho = exp(-d / tau),  n standard normal
 *
 * is the process itself at these points, stationary from the first. A segment is the time between two points. This header
 * bounds the noise there: within `reach` of the range of its ends. td_noise_bridge.h has the process itself between points.
 *
 * Normals are a function of (seed, pixel, k): not of steps, tiles, or where a run is cut. A pixel's state is k and x(k).
 *
 * Noise may vary. With noise_sigma each pixel has its own size. By noise_law PHOTOCURRENT size and tau follow from the pixel's
 * light at the beginning of each segment. The grid is the same for all pixels, by tau at Y = 1, and the process is exact on a
 * segment of any length. The light is as accurate as the steps' models. A pixel's state then has that light, too. */
#ifndef TD_ADDITIVE_NOISE_H
#define TD_ADDITIVE_NOISE_H

#include "signal/td_model.h"
#include "td_noise_light.h"
#include "td_random.h"
#include "tides/sensor.h"

/* Parts of one length, between values a and b at their ends. */
typedef struct td_noise_level {
    double variance;     /* of the Brownian bridge that varies as the process between the ends */
    double mean, change; /* of the value in the middle: mean (a + b) + change times a standard normal */
} td_noise_level;

enum { TD_NOISE_DEPTH_MAX = 22 }; /* at most so many: nodes share a word with the random numbers' purpose */

/* The process over a length l, in units of tau: x becomes keeps x + adds n, with n standard normal. */
typedef struct td_noise_move {
    double keeps, adds; /* e^-l; sigma sqrt(1 - e^-2l) */
} td_noise_move;
td_noise_move td_noise_move_of(double sigma, double l);
static inline double td_noise_moved(td_noise_move move, double x, double normal) { return move.keeps * x + move.adds * normal; }

/* The numbers of both for sigma 1. */
typedef struct td_noise_unit {
    double tangent, mean, root; /* tanh(l / 2); of the middle; sqrt(tangent) */
} td_noise_unit;

typedef struct td_additive_noise {
    int on;
    uint64_t seed;
    double spacing_ns;  /* d */
    double sigma;       /* standard deviation at grid points */
    td_noise_move move; /* from one grid point to the next */
    int varies;         /* 1: segments have numbers of their own; those here are bounds */
    double spread;      /* noise_sigma */
    double *own;        /* sizes of single pixels, by number, over the nominal one; NaN: drawn; NULL: all are (the sensor's) */
    td_noise_light light;
    double threshold;         /* distance of the nearest level */
    double reach;             /* how far the noise goes beyond its ends on a segment, at most */
    double usual_ns;          /* a tau, */
    td_noise_move usual_move; /* and its moves and parts for sigma 1, by depth */
    td_noise_unit usual[TD_NOISE_DEPTH_MAX + 1];
    int depth;                                    /* number of halvings of a segment, */
    td_noise_level level[TD_NOISE_DEPTH_MAX + 1]; /* and the parts after each */
} td_additive_noise;

/* Normals are drawn in blocks. Block b has n(b TD_NOISE_BLOCK) to n((b + 1) TD_NOISE_BLOCK - 1). */
enum { TD_NOISE_BLOCK = 4 }; /* of one number's bits */

/* A pixel's segment, from x(k) to x(k + 1). */
typedef struct td_noise_segment {
    uint64_t k;
    double from_ns, to_ns;        /* since the run's start */
    double begin, end;            /* [log units] */
    double origin_ns;             /* of segment 0 */
    double light;                 /* L where it began, of noise that depends on light */
    double own;                   /* the pixel's size, over the nominal one */
    double sigma, tau_ns;         /* of this segment, of noise that varies */
    double reach;                 /* of this segment, as td_additive_noise.reach */
    float normal[TD_NOISE_BLOCK]; /* the block that contains n(k + 1); of noise that varies, n(k + 1) alone is of use */
} td_noise_segment;

/* The numbers of a segment of noise that varies that take long to compute, beside k, x(k) and the light. They follow from
 * those. */
typedef struct td_noise_now {
    double origin_ns, own, sigma, tau_ns, reach, end;
} td_noise_now;

/* Makes the noise of a sensor; off where noise_rms is 0. TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_additive_noise_make(const tides_sensor *sensor, double log_eps, td_additive_noise *noise,
                                                     tides_error *error);

/* Gives single pixels their own size, as `own` of td_additive_noise; noise that is off stays off. */
void td_additive_noise_give(td_additive_noise *noise, double *own);

/* A pixel's size, over the nominal one. */
double td_additive_noise_own(const td_additive_noise *noise, uint32_t pixel);

/* tau of noise that doesn't vary [ns]. */
double td_additive_noise_tau(const td_additive_noise *noise);

/* Where the pixel's segment 0 begins, at or before the run's start [ns]. */
double td_additive_noise_origin(const td_additive_noise *noise, uint32_t pixel);

/* x(0) of `pixel`, in log-luminance `light` where the noise depends on it. The run's start lies on segment 0. */
double td_additive_noise_first(const td_additive_noise *noise, uint32_t pixel, double light);

/* The segment that begins with x(k) = value in this light. Checkpoints save these numbers. */
td_noise_segment td_additive_noise_resume(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double value,
                                          double light);

/* The segment of noise that varies, whose numbers are at hand. */
td_noise_segment td_additive_noise_again(const td_additive_noise *noise, uint64_t k, double value, double light,
                                         const td_noise_now *now);
static inline td_noise_now td_noise_now_of(const td_noise_segment *segment) {
    return (td_noise_now){segment->origin_ns, segment->own, segment->sigma, segment->tau_ns, segment->reach, segment->end};
}

/* Advances to the segment after *segment, which begins in this light. Light that isn't finite counts as unchanged. */
void td_additive_noise_next(const td_additive_noise *noise, uint32_t pixel, double light, td_noise_segment *segment);

/* Advances from *segment, at or before the time [ns since the run's start], to the segment that contains it, in unchanged
 * light. */
void td_additive_noise_seek(const td_additive_noise *noise, uint32_t pixel, double time_ns, td_noise_segment *segment);

/* A pixel's process as a sweep found it: x(k) is x[(k - from) TD_RANDOM_LANES], for the segments of the sweep and k - from <
 * TD_NOISE_PATH. */
enum { TD_NOISE_PATH = 64 };
typedef struct td_noise_path {
    const double *x; /* NULL: there is none */
    uint64_t from;
    double origin_ns; /* of segment 0 */
} td_noise_path;

/* td_additive_noise_resume and td_additive_noise_next with the numbers of a path, to the bit. Without a path they draw, and so
 * they do behind its end, where x becomes NULL. */
td_noise_segment td_additive_noise_along(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double value, double light,
                                         td_noise_path *path);
void td_additive_noise_next_along(const td_additive_noise *noise, uint32_t pixel, double light, td_noise_path *path,
                                  td_noise_segment *segment);

/* A time as a step's s in [0, 1]. */
static inline double td_place_of(double time_ns, double start_ns, double length_ns) { return (time_ns - start_ns) / length_ns; }

/* The light at the end s of a segment that is followed by another within the step. */
static inline double td_noise_light_of(const td_model *input, double s) { return td_model_value(input, s > 0 ? s : 0); }

/* A sweep of `count` pixels. On input, k and x(k) are those of the segment that contains the step's start, or of an earlier
 * one. On output they are those of the segment at its end. `low` and `high` bound the ends of the segments between: on the step
 * the noise stays within `reach` of them. Of noise that varies `low` and `high` bound the noise itself. Its first segments are
 * given in `at`; on output the list goes on from there, `input` giving the light. */
enum { TD_NOISE_FEW = 4 };
typedef struct td_noise_few {
    int count;                              /* of segments; if there are more than the list has room for, */
    td_noise_segment segment[TD_NOISE_FEW]; /* the last one takes the last place */
} td_noise_few;
typedef struct td_noise_sweep {
    double *segment, *value, *low, *high;
    td_noise_few *at; /* of noise that varies, else NULL */
    const td_model *input;
    double *path;         /* room for TD_NOISE_PATH x TD_RANDOM_LANES numbers for each TD_RANDOM_LANES pixels, and */
    td_noise_path *paths; /* (count) its content; neither is set for noise that varies */
    const double *origin; /* (count) td_additive_noise_origin of each, not for noise that varies */
} td_noise_sweep;

/* Sweeps all pixels side by side. The results equal those of td_additive_noise_next, segment by segment, to the bit. */
void td_additive_noise_sweep(const td_additive_noise *noise, double start_ns, double length_ns, const uint32_t *pixel,
                             size_t count, const td_noise_sweep *sweep);

#endif
