/* Internal: a time step, and times within it to a fraction of a nanosecond, however long the run has lasted. */
#ifndef TD_STEP_H
#define TD_STEP_H

#include "tides/base.h"

/* One step (start, stop], in whole nanoseconds plus offsets. Steps lie on a grid of double seconds since the run's start, k
 * step_s (a product, not a running sum); a double at 1000 s resolves 1e-4 ns. An event is at floor(start_fraction + s
 * length_ns) ns after start_ns. Only small numbers are rounded in that, however long the run has lasted. */
typedef struct td_step {
    int64_t start_ns, stop_ns; /* both ends, rounded down [ns] */
    double start_fraction;     /* the fraction that rounding down took from the start [ns], in [0, 1) */
    double length_ns;          /* [ns] > 0 */
    double length_s;           /* length in seconds: h */
} td_step;

/* The step between two times [s]. A double always becomes the same nanosecond, so that one step's stop is the next one's start.
 * A double that is a whole nanosecond to within its own rounding is that nanosecond (1.001 s isn't 1000999999 ns).
 * TIDES_OUT_OF_RANGE if they aren't finite and ascending, or beyond 292 years. */
TIDES_MUST_CHECK tides_status td_step_between(double start, double stop, td_step *step, tides_error *error);

/* The nearest nanosecond, of a time within +-TD_FURTHEST_TIME. Exact: the product with 1e9 alone would be off by up to 128 ns
 * at 1e9 s. A run's start becomes an integer by it, once; all steps and events of the run count from there. */
int64_t td_time_ns(double seconds);

/* Time of an event at s in [0, 1], rounded down [ns]; at s = 1 exactly stop_ns, never beyond it. */
static inline int64_t td_step_time(const td_step *step, double s) {
    if (s >= 1.0) return step->stop_ns;
    int64_t ns = step->start_ns + (int64_t)(step->start_fraction + s * step->length_ns);
    return ns < step->stop_ns ? ns : step->stop_ns;
}

#endif
