/* Internal: the only root finder: safeguarded Newton on a bracket, for crossings of a local model or of a series, and for the
 * time maps of filters. Callers give a bracket on a monotone piece.
 *
 * Inline, so that constant functions are inlined into it. */
#ifndef TD_ROOT_H
#define TD_ROOT_H

#include <float.h>
#include <math.h>

/* Newton alone for the first tries (two or three are enough, away from extrema). Then every second try halves the bracket,
 * which bounds the work: 64 halvings leave 5e-20 of a bracket of length 1. */
enum { TD_NEWTON_TRIES = 8, TD_ROOT_TRIES = TD_NEWTON_TRIES + 2 * 64 };

/* The last bit of a place in [0.5, 1): 1e-16 of a step. A Newton step of at most that ends the search. */
#define TD_ROOT_RESOLUTION (0.5 * DBL_EPSILON)

/* A function of a place, with the parameters `of`. */
typedef double td_root_function(const void *of, double at);

/* The place in (low, high] where `excess`, whose derivative is `slope`, becomes 0. It has the sign of `direction`, or is 0, at
 * `high` and hasn't at `low`. Each try shrinks the bracket, and a Newton step that leaves it is replaced by its middle. If no
 * place is exact, the result is on the side where the level has been reached, as in CVODE's root finder. */
static inline double td_root(td_root_function *excess, td_root_function *slope, const void *of, double direction, double low,
                             double high, double guess) {
    double at = guess;
    for (int i = 0; i < TD_ROOT_TRIES; i++) {
        int halve = i >= TD_NEWTON_TRIES && i % 2 == 1;
        if (halve || !(at > low && at < high)) at = low + 0.5 * (high - low);
        if (!(at > low && at < high)) break; /* neighbouring numbers, with none between */
        double beyond = excess(of, at);
        if (beyond == 0.0) return at;
        if (direction * beyond > 0.0)
            high = at;
        else
            low = at;
        double step = beyond / slope(of, at); /* may be infinite or NaN: then the middle is next */
        at -= step;
        if (fabs(step) <= TD_ROOT_RESOLUTION) return fmin(fmax(at, low), high);
    }
    return high;
}

#endif
