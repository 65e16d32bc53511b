/* Internal: a level that a local model reaches on a monotone piece, and the place where it does. */
#ifndef TD_LEVEL_H
#define TD_LEVEL_H

#include "td_model.h"
#include "td_root.h"

#include <float.h>
#include <math.h>

/* The level is reference + rise: ON with a positive rise, OFF with a negative one. */
typedef struct td_level {
    const td_model *model;
    double reference, rise;
} td_level;

static inline double td_level_excess(const void *of, double s) {
    const td_level *at = of;
    return td_model_value(at->model, s) - at->reference - at->rise;
}

static inline double td_level_slope(const void *of, double s) { return td_model_slope(((const td_level *)of)->model, s); }

/* Where the chord from `low` to `high` reaches the level. */
static inline double td_level_chord(const td_level *at, double low, double high, double value_high) {
    double value_low = td_model_value(at->model, low);
    return low + (high - low) * ((at->reference - value_low + at->rise) / (value_high - value_low));
}

/* The place in (low, high] where S - reference reaches the rise: it has at `high`, and hasn't at `low`. Newton begins where the
 * chord reaches the level. */
static inline double td_level_solve(const td_level *at, double low, double high, double value_high) {
    double guess = td_level_chord(at, low, high, value_high);
    return td_root(td_level_excess, td_level_slope, at, at->rise > 0.0 ? 1.0 : -1.0, low, high, guess);
}

/* A bound on the rounding of an excess. If the excess is this far from 0 on the same side, a search that ends there is on the
 * right side of the level. */
static inline double td_level_rounding(const td_level *at) {
    const double *b = at->model->control;
    return 64 * DBL_EPSILON * (fabs(b[0]) + fabs(b[1]) + fabs(b[2]) + fabs(b[3]) + fabs(at->reference) + fabs(at->rise));
}

/* Greatest distance [ns] of a place that is only near its crossing: few crossings are so close to the end of their
 * nanosecond. */
#define TD_NEAR_ENOUGH_NS 0x1p-11

#endif
