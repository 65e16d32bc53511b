/* The extrema of many models, by the arithmetic of td_model_extrema without branches, in a loop that vectorises. */
#include "td_turns.h"

#include "td_extremes.h"
#include "td_wide.h"

#include <float.h>

/* a / (a + b) if a and b have the same sign, else 0. One comparison at a time, because gcc 12 doesn't vectorise others. */
static inline double share(double a, double b) {
    const double part = a / (a + b);
    double above = a > 0.0 ? part : 0.0, below = a < 0.0 ? part : 0.0;
    above = b > 0.0 ? above : 0.0;
    below = b < 0.0 ? below : 0.0;
    return above + below; /* one of them is 0 */
}

/* `at` if it lies within the step, else 1. */
static inline double within(double at) {
    const double begun = at > 0.0 ? at : 1.0;
    return begun < 1.0 ? begun : 1.0;
}

TD_WIDE static void find(td_turns *restrict turns) {
    const int count = turns->count;
    for (int k = 0; k < count; k++) {
        const td_model model = {{turns->control[0][k], turns->control[1][k], turns->control[2][k], turns->control[3][k]}};
        const double *b = model.control;
        const double rise = b[1] - b[0], on = b[2] - b[1], last = b[3] - b[2];
        const double scale = td_greater(fabs(rise), td_greater(fabs(on), fabs(last)));
        const double d0 = rise / scale, d1 = on / scale, d2 = last / scale;
        const double discriminant = d1 * d1 - d0 * d2;
        const double q = -(d1 + copysign(sqrt(discriminant), d1));
        const double one = share(q, d2), other = share(d0, q);
        double first = td_lesser(one, other), second = td_greater(one, other);
        first = discriminant > 0.0 ? first : 0.0;
        second = discriminant > 0.0 ? second : 0.0;
        first = scale <= DBL_MAX ? first : 0.0;
        second = scale <= DBL_MAX ? second : 0.0;
        second = second > first ? within(second) : 1.0;
        first = within(first);
        const double early = td_lesser(first, second), late = td_greater(first, second);
        turns->place[0][k] = early;
        turns->place[1][k] = late;
        turns->value[0][k] = td_model_value_within(&model, early);
        turns->value[1][k] = td_model_value_within(&model, late);
    }
}

void td_turns_find(td_turns *turns) { find(turns); }
