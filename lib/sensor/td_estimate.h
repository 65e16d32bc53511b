/* Internal: the error of the local model on a tile's step, over the pixels that may fire in it. The sensor knows these pixels,
 * and the weight of an error for each; the limits are the solver's. */
#ifndef TD_ESTIMATE_H
#define TD_ESTIMATE_H

#include "td_sensor.h"

/* One tile's step. */
typedef struct td_estimated {
    double h; /* [s] */
    const td_signals *signals;
    const double *reference; /* NULL: every pixel counts */
    const double *deviation; /* of the longer step's model at the cut that made this one; NULL: none did */
    double rounding;         /* error of S by rounding [log units]: deviations up to it say nothing about the step */
    int32_t count;
} td_estimated;

/* The estimate of a step. */
typedef struct td_estimate {
    double error;     /* largest estimated error of S over the pixels that may reach a threshold [log units] */
    double seconds;   /* the largest such error divided by its pixel's slope [s] */
    double deviation; /* the largest deviation among them [log units] */
    double rounded;   /* the largest error, with rounding counted as an error of the model */
    double crossings; /* at least the number that the comparator finds in any pixel */
} td_estimate;

/* Errors follow from the deviation and the embedded estimate, or without a deviation from the latter alone. The tile begins at
 * the sensor's pixel `first`. The step begins at `time` [ns since the run's start], and came of `cuts` cuts of the macro step.
 *
 * Only pixels count whose signal may reach a threshold within the step. Their control values have a level between them, when
 * widened by the deviation (else by the estimate): a bump that the model doesn't show may be as high as that. With equal
 * thresholds every level at which an ideal pixel may ever fire is reference + n C, whatever happens before the step within the
 * same macro step. With unequal ones every ideal pixel counts that moves.
 *
 * Where a block is on, errors are scaled by nominal over own threshold, the smaller of each, so that limits in thresholds mean
 * each pixel's own. Levels are those of S with its leak. Where both thresholds are equal and no hold re-references, they are
 * reference + n C as above. Elsewhere a pixel counts from when it may first have fired or been re-referenced in this macro
 * step. It then left the band between its levels, widened, on this step or on one of few cuts judged so far, or it was held
 * when the macro step began. (Only few cuts, so that the order in which the others are judged doesn't matter.) Behind a filter
 * every pixel counts: low-passes don't enlarge the error of L, but L doesn't show where S is. Noise events may change a
 * reference unpredictably; they force no cut.
 *
 * Crossings. After the first, each takes a threshold's way of S, and the model's way is no longer than that along its control
 * values. So a way of n thresholds has at most n of them. Behind a filter, the response to light from before the step is left
 * out. */
void td_sensor_begin_estimates(const td_sensor *sensor, size_t first, int32_t count); /* before a tile's macro step */
td_estimate td_sensor_estimate(const td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time);

/* 1 where estimates of other steps use the results of this step's, so that it must come before them. */
enum { TD_FEW_CUTS = 2 };
static inline int td_sensor_estimates_first(const td_sensor *sensor, int cuts) { return sensor->on && cuts < TD_FEW_CUTS; }

#endif
