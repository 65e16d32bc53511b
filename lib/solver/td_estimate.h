/* Internal: how wrong the local model may be on a step, seen from the two renders that it already has. */
#ifndef TD_ESTIMATE_H
#define TD_ESTIMATE_H

#include "sensor/td_sensor.h"
#include "td_comparator.h"

/* What one tile's step looks like. */
typedef struct td_estimate {
    double error;   /* largest estimated error of S over the pixels that may reach a threshold [log units] */
    double seconds; /* the largest such error divided by its pixel's slope [s] */
} td_estimate;

/* The embedded estimate (DESIGN 3.2): the cubic against the quadratic through S0, S0_dot, S1 and its mirror image through S0,
 * S1, S1_dot. Their difference is greatest at a third of the step, 4/27 |h S1_dot - (2 (S1 - S0) - h S0_dot)|: the cubic itself
 * is one order better, so it bounds the cubic's error on steps where halving helps at all.
 *
 * Only pixels count whose signal may reach a threshold within the step: those whose control values, widened by the estimate,
 * have a level between them. With equal thresholds every level that a pixel may ever fire at is reference + n C, whatever
 * happens before the step within the same macro step; with unequal ones every pixel counts that moves. */
td_estimate td_estimate_step(const td_comparator *comparator, double h, const td_signals *signals, const double *reference,
                             int32_t count);

/* The same under a sensor with a block on, for a tile that begins at its pixel `first`; the step begins at `time` [ns since the
 * run's start], and `whole` says that it is a whole macro step. Errors are scaled by nominal over own threshold, the smaller of
 * each, so that limits in thresholds mean each pixel's own.
 *
 * Levels are those of S with its leak. Where both thresholds are equal and no hold re-references, they are reference + n C
 * as above. Elsewhere a pixel counts from when it may first have fired or been re-referenced in this macro step: its range,
 * widened, left the band between its levels on a step judged so far, or it was held when the macro step began. Behind a
 * filter every pixel counts: low-passes don't enlarge the error of L, but where S is isn't seen in L. What a noise
 * event does to a reference isn't foreseen: noise forces no halving. */
td_estimate td_estimate_sensor(td_sensor *sensor, size_t first, int whole, double time, double h, const td_signals *signals,
                               const double *reference, int32_t count);

/* Estimated timing errors of a run's events: each pixel's step weighs in with the thresholds that it moves through. */
enum { TD_TIMING_BITS = 3, TD_TIMING_BINS = 64 << TD_TIMING_BITS }; /* 64 octaves, each in 8 equal parts */
typedef struct td_timing {
    double slow_s;   /* pixels that would hardly move in so long don't count; 0: in the step */
    double rounding; /* error of S that no step makes smaller [log units]: 0 where the device computes in double */
    double weight[TD_TIMING_BINS]; /* from 2^-48 s on */
} td_timing;

/* What single precision does to S in nine tenths of the pixels: 3e-6 to 8e-6 in the scenes of tides bench accuracy, against the
 * double reference; the largest, so that what is reported is honest on all of them. Most of it is the rounding of where splats
 * are on the screen. */
#define TD_SINGLE_ROUNDING 8e-6

/* Adds one accepted step. */
void td_timing_add(td_timing *timing, const td_comparator *comparator, double h, const td_signals *signals, int32_t count);

/* The error [s] that `share` (0 to 1) of the events stay below; 0 where nothing moved. */
double td_timing_percentile(const td_timing *timing, double share);

#endif
