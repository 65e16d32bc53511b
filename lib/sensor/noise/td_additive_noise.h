/* Internal: the photoreceptor's additive noise: an Ornstein-Uhlenbeck process per pixel, on a time grid of the pixel's own.
 *
 * With tau = 1 / (2 pi noise_cutoff_hz), grid points are d = tau / 8 apart, from a phase that is drawn per pixel, and
 *
 *   x(k + 1) = rho x(k) + noise_rms sqrt(1 - rho^2) n(k + 1),  rho = exp(-d / tau),  n standard normal
 *
 * is the process itself at these points, stationary from the first. td_noise_bridge.h has the process between them. Here only
 * bounds of that matter: a segment is the stretch between two points, and on it the noise stays within `reach` of their range.
 *
 * Normals are a function of (seed, pixel, k): not of steps, tiles, or where a run is cut. A pixel's state is k and x(k).
 *
 * Noise that varies: with noise_sigma its size is the pixel's own, and by noise_law PHOTOCURRENT size and tau are those of the
 * pixel's light where the segment begins (td_noise_light.h), for as long as it is. The grid is the same for all, of tau at
 * Y = 1, and the process is exact on a segment of any length; the light is known as well as the steps are fine. A pixel's
 * state then has that light, too. */
#ifndef TD_ADDITIVE_NOISE_H
#define TD_ADDITIVE_NOISE_H

#include "signal/td_model.h"
#include "td_noise_light.h"
#include "td_random.h"
#include "tides/sensor.h"

/* Parts of one length, with ends a and b. */
typedef struct td_noise_level {
    double variance;     /* of a Brownian bridge that varies as the process does between them */
    double mean, change; /* their middle: mean (a + b) + change times a standard normal */
} td_noise_level;

enum { TD_NOISE_DEPTH_MAX = 22 }; /* nodes of the tree share a word with the random numbers' purpose */

/* The process over a length l of tau: x becomes keeps x + adds n, with n standard normal. */
typedef struct td_noise_move {
    double keeps, adds; /* e^-l; sigma sqrt(1 - e^-2l) */
} td_noise_move;
td_noise_move td_noise_move_of(double sigma, double l);
static inline double td_noise_moved(td_noise_move move, double x, double normal) { return move.keeps * x + move.adds * normal; }

typedef struct td_additive_noise {
    int on;
    uint64_t seed;
    double spacing_ns;  /* d */
    double sigma;       /* of grid points */
    td_noise_move move; /* from one grid point to the next */
    int varies;         /* segments have their own numbers; those here are only bounds */
    double spread;      /* noise_sigma */
    td_noise_light light;
    double threshold;                             /* the nearest level */
    double reach;                                 /* how far beyond its ends the noise goes on a segment, at most */
    int depth;                                    /* halvings of a segment (td_noise_bridge.h), */
    td_noise_level level[TD_NOISE_DEPTH_MAX + 1]; /* and the parts after each */
} td_additive_noise;

/* Normals are drawn in blocks, which takes a fraction of the time: block b has n(b TD_NOISE_BLOCK) and those that follow. */
enum { TD_NOISE_BLOCK = 2 * TD_RANDOM_LANES };

/* A pixel's segment, from x(k) to x(k + 1). */
typedef struct td_noise_segment {
    uint64_t k;
    double from_ns, to_ns;         /* since the run's start */
    double begin, end;             /* [log units] */
    double origin_ns;              /* of segment 0 */
    double light;                  /* L where it began, of noise that goes with it */
    double own;                    /* the pixel's size, of nominal */
    double sigma, tau_ns;          /* here, of noise that varies */
    double reach;                  /* td_additive_noise.reach, here */
    double normal[TD_NOISE_BLOCK]; /* the block that n(k + 1) is of */
} td_noise_segment;

/* Off where noise_rms is 0. TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_additive_noise_make(const tides_sensor *sensor, double log_eps, td_additive_noise *noise,
                                                     tides_error *error);

/* tau of noise that doesn't vary [ns]. */
double td_additive_noise_tau(const td_additive_noise *noise);

/* x(0) of `pixel`, in log-luminance `light` where noise goes with it; the run's start is on segment 0. */
double td_additive_noise_first(const td_additive_noise *noise, uint32_t pixel, double light);

/* The segment that begins with x(k) = value in this light, as a checkpoint has it. */
td_noise_segment td_additive_noise_resume(const td_additive_noise *noise, uint32_t pixel, uint64_t k, double value,
                                          double light);

/* Goes on to the segment after *segment, which begins in this light; one that isn't finite counts as unchanged. */
void td_additive_noise_next(const td_additive_noise *noise, uint32_t pixel, double light, td_noise_segment *segment);

/* Goes on from *segment, at or before the time [ns since the run's start], to the one that holds it, in unchanged light. */
void td_additive_noise_seek(const td_additive_noise *noise, uint32_t pixel, double time_ns, td_noise_segment *segment);

/* Time as a step's s in [0, 1]. */
static inline double td_place_of(double time_ns, double start_ns, double length_ns) { return (time_ns - start_ns) / length_ns; }

/* The light where a segment ends that is followed by another within the step. */
static inline double td_noise_light_of(const td_model *input, double s) { return td_model_value(input, s > 0 ? s : 0); }

/* A sweep of `count` pixels. k and x(k) are those of the segment that holds the step's start, or of one before it; they become
 * those of the segment at its end. `low` and `high` bound the ends of these segments: on the step the noise stays within
 * `reach` of them. For noise that varies, `light` (else NULL) goes along, taken from `input`; `low` and `high` then bound the
 * noise itself. */
typedef struct td_noise_sweep {
    double *segment, *value, *low, *high, *light;
    const td_model *input;
} td_noise_sweep;

/* Sweeps all pixels side by side, to the bits of td_additive_noise_next from segment to segment. */
void td_additive_noise_sweep(const td_additive_noise *noise, double start_ns, double length_ns, const uint32_t *pixel,
                             size_t count, const td_noise_sweep *sweep);

#endif
