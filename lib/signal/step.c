/* Time steps: seconds in double become whole nanoseconds and an offset. */
#include "td_step.h"
#include "td_base.h"

#include <float.h>
#include <math.h>

/* Seconds to whole nanoseconds and a fraction in [0, 1). */
static int64_t split_time(double seconds, double *fraction) {
    double ns = seconds * 1e9, nearest = round(ns), below = floor(ns);
    /* `seconds` is known to half a unit in its last place, and the product to as much again. */
    int is_whole = fabs(ns - nearest) <= 2.0 * DBL_EPSILON * fabs(ns);
    *fraction = is_whole ? 0.0 : ns - below;
    return (int64_t)(is_whole ? nearest : below);
}

tides_status td_step_between(double start, double stop, td_step *step, tides_error *error) {
    if (!(start >= -TD_FURTHEST_TIME && stop <= TD_FURTHEST_TIME && start < stop))
        return td_fail(error, TIDES_OUT_OF_RANGE, "a step from %.17g s to %.17g s: times must ascend, within +-%g s", start,
                       stop, TD_FURTHEST_TIME);
    double start_fraction, stop_fraction;
    int64_t start_ns = split_time(start, &start_fraction), stop_ns = split_time(stop, &stop_fraction);
    double length = (double)(stop_ns - start_ns) + (stop_fraction - start_fraction);
    if (!(length > 0.0))
        return td_fail(error, TIDES_OUT_OF_RANGE,
                       "a step from %.17g s to %.17g s is shorter than a double resolves: make steps longer", start, stop);
    *step = (td_step){start_ns, stop_ns, start_fraction, length, length * 1e-9};
    return TIDES_OK;
}

int64_t td_time_ns(double seconds) {
    double whole = floor(seconds); /* the rest is exact */
    return (int64_t)whole * 1000000000 + (int64_t)round((seconds - whole) * 1e9);
}
