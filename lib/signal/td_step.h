/* Internal: a time step, and times within it to a fraction of a nanosecond, however late in the run. */
#ifndef TD_STEP_H
#define TD_STEP_H

#include "tides/base.h"

/* A step (start, stop], as whole nanoseconds plus offsets. Steps lie on a grid of seconds since the run's start, k step_s (a
 * product, not a sum that accumulates rounding). A double at 1000 s resolves 1e-4 ns. An event is at floor(start_fraction + s
 * length_ns) ns after start_ns: only small numbers are rounded. */
typedef struct td_step {
    int64_t start_ns, stop_ns; /* both ends, floored [ns] */
    double start_fraction;     /* the start's fraction of a nanosecond, in [0, 1) */
    double length_ns;          /* [ns] > 0 */
    double length_s;           /* the same [s]: h */
} td_step;

/* The step between two times [s]. The same double always becomes the same nanosecond, so that a step's stop is the next one's
 * start. A double within rounding of a whole nanosecond becomes that nanosecond (1.001 s isn't 1000999999 ns).
 * TIDES_OUT_OF_RANGE: times that aren't finite or ascending, or are beyond 292 years. */
TIDES_MUST_CHECK tides_status td_step_between(double start, double stop, td_step *step, tides_error *error);

/* The nearest nanosecond to a time within +-TD_FURTHEST_TIME, exactly: a product with 1e9 alone would be off by up to 128 ns
 * at 1e9 s. Only a run's start is converted so; steps and events count from it. */
int64_t td_time_ns(double seconds);

/* Time of an event at s in [0, 1], floored [ns]; at most stop_ns, which it is at s = 1. */
static inline int64_t td_step_time(const td_step *step, double s) {
    if (s >= 1.0) return step->stop_ns;
    int64_t ns = step->start_ns + (int64_t)(step->start_fraction + s * step->length_ns);
    return ns < step->stop_ns ? ns : step->stop_ns;
}

#endif
