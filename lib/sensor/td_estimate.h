/* Internal: the error of the local model on a tile's step, over the pixels that may fire in it. The sensor knows these pixels,
 * and the weight of an error for each. For step control, which says what is too much. */
#ifndef TD_ESTIMATE_H
#define TD_ESTIMATE_H

#include "td_sensor.h"

/* One tile's step, as it is judged. */
typedef struct td_estimated {
    double h; /* [s] */
    const td_signals *signals;
    const double *reference; /* NULL: every pixel counts */
    const double *deviation; /* where the step was cut out of a longer one (td_probe.h); NULL: it wasn't */
    double rounding;         /* what S is good to [log units]: deviations up to it say nothing of the step */
    int32_t count;
} td_estimated;

/* The estimate of a step. */
typedef struct td_estimate {
    double error;     /* largest estimated error of S over the pixels that may reach a threshold [log units] */
    double seconds;   /* the largest such error divided by its pixel's slope [s] */
    double deviation; /* the largest deviation among them [log units] */
    double rounded;   /* the largest error, had rounding been none */
    double crossings; /* as many as the comparator finds in any pixel, or more */
} td_estimate;

/* Errors are td_probe_error where there is a deviation, else the embedded estimate (signal/td_model_error.h). The tile begins
 * at the sensor's pixel `first`; the step begins at `time` [ns since the run's start] and came of `cuts` cuts of the macro
 * step.
 *
 * Only pixels count whose signal may reach a threshold within the step: those whose control values, widened by the deviation
 * (else by the estimate), have a level between them: a bump that the model doesn't show is as high as what the probe saw. With
 * equal thresholds every level that an ideal pixel may ever fire at is reference + n C, whatever happens before the step within
 * the same macro step; with unequal ones every ideal pixel counts that moves.
 *
 * Where a block is on, errors are scaled by nominal over own threshold, the smaller of each, so that limits in thresholds mean
 * each pixel's own. Levels are those of S with its leak. Where both thresholds are equal and no hold re-references, they are
 * reference + n C as above. Elsewhere a pixel counts from when it may first have fired or been re-referenced in this macro
 * step: its range, widened, left the band between its levels on this step or on one of few cuts judged so far, or it was held
 * when the macro step began. (Of few cuts, so that it doesn't matter in which order the others are judged.) Behind a filter
 * every pixel counts: low-passes don't enlarge the error of L, but where S is isn't seen in L. What a noise event does to a
 * reference isn't foreseen: noise forces no cut.
 *
 * Crossings: after the first each takes a threshold's way of S, and the model's way is no longer than that along its control
 * values. So a way of n thresholds has at most n of them. Behind a filter, what is still to come of light from before the step
 * is left out. */
void td_sensor_begin_estimates(td_sensor *sensor, size_t first, int32_t count); /* of a tile's macro step, before its others */
td_estimate td_sensor_estimate(td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time);

/* 1 where estimates of other steps read what the one of this step found, so that it must come before them. */
enum { TD_FEW_CUTS = 2 };
static inline int td_sensor_estimates_first(const td_sensor *sensor, int cuts) { return sensor->on && cuts < TD_FEW_CUTS; }

#endif
