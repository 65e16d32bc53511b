/* Internal: the only root finder: Newton's method, safeguarded by a bracket. Callers give a bracket on which the function is
 * monotone.
 *
 * Inline, so that constant function pointers are inlined too. */
#ifndef TD_ROOT_H
#define TD_ROOT_H

#include <float.h>
#include <math.h>

/* The first tries are Newton's alone; two or three suffice away from extrema. Then every second try halves the bracket, which
 * bounds the work: 64 halvings leave 5e-20 of a bracket of length 1. */
enum { TD_NEWTON_TRIES = 8, TD_ROOT_TRIES = TD_NEWTON_TRIES + 2 * 64 };

/* The last bit of a place in [0.5, 1): 1e-16 of a step. A Newton step of at most that ends the search. */
#define TD_ROOT_RESOLUTION (0.5 * DBL_EPSILON)

/* A function of a place; `of` is its object. */
typedef double td_root_function(const void *of, double at);

/* The place in (low, high] where `excess` becomes 0; `slope` is its derivative. At `high` the excess must be 0 or have the
 * sign of `direction`, at `low` the opposite sign. Each try shrinks the bracket. A Newton step that leaves the bracket is
 * replaced by its middle. If no number is exact, the result is on the side of `high`, as in CVODE's root finder. */
static inline double td_root(td_root_function *excess, td_root_function *slope, const void *of, double direction, double low,
                             double high, double guess) {
    double at = guess;
    for (int i = 0; i < TD_ROOT_TRIES; i++) {
        int halve = i >= TD_NEWTON_TRIES && i % 2 == 1;
        if (halve || !(at > low && at < high)) at = low + 0.5 * (high - low);
        if (!(at > low && at < high)) break; /* neighbouring numbers */
        double beyond = excess(of, at);
        if (beyond == 0.0) return at;
        if (direction * beyond > 0.0)
            high = at;
        else
            low = at;
        double step = beyond / slope(of, at); /* if infinite or NaN, the middle is next */
        at -= step;
        if (fabs(step) <= TD_ROOT_RESOLUTION) return fmin(fmax(at, low), high);
    }
    return high;
}

#endif
