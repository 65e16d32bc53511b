/* The local model: extrema and parts of a cubic from its control values. For the comparator's crossings, the
 * sensor's filters and the solver's estimates, which do the rest. */
#include "td_model.h"

#include <float.h>
#include <math.h>

int td_model_is_finite(const td_model *model) {
    const double *b = model->control;
    return isfinite(b[0]) && isfinite(b[1]) && isfinite(b[2]) && isfinite(b[3]);
}

/* a / (a + b) where a and b have the same sign (then it lies in (0, 1) and nothing cancels); 0 where they don't. */
static double share(double a, double b) {
    int same_sign = (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0);
    return same_sign ? a / (a + b) : 0.0;
}

/* The slope is d0 u^2 + 2 d1 u s + d2 s^2 with u = 1 - s: a quadratic in the ratio r = s / u, where r > 0 is all of 0 < s < 1.
 * With q = -(d1 + sign(d1) sqrt(d1^2 - d0 d2)) its roots are q / d2 and d0 / q. Back in s both are shares of quantities of one
 * sign, so nothing cancels, and a vanishing d2 or d0 merely moves its root to an end. What can cancel is the discriminant where
 * the two extrema nearly meet; the piece between them is then lower than rounding, and it doesn't matter whether it is seen. */
int td_model_extrema(const td_model *model, double s[2]) {
    const double *b = model->control;
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    double scale = fmax(fabs(d0), fmax(fabs(d1), fabs(d2)));
    if (!(scale > 0.0 && scale <= DBL_MAX)) return 0;
    d0 /= scale; /* so that squares neither overflow nor vanish */
    d1 /= scale;
    d2 /= scale;
    double discriminant = d1 * d1 - d0 * d2;
    if (!(discriminant > 0.0)) return 0; /* zero: the slope touches 0 and keeps its sign */
    double q = -(d1 + copysign(sqrt(discriminant), d1));
    double first = share(q, d2), second = share(d0, q);
    if (second < first) {
        double swapped = first;
        first = second;
        second = swapped;
    }
    int count = 0;
    if (first > 0.0 && first < 1.0) s[count++] = first;
    if (second > 0.0 && second < 1.0 && second > first) s[count++] = second;
    return count;
}

static double between(double a, double b, double t) { return (1 - t) * a + t * b; }

/* The polar form of the cubic: its value where all three places are one. */
static double blossom(const double b[4], double x, double y, double z) {
    double one[3] = {between(b[0], b[1], x), between(b[1], b[2], x), between(b[2], b[3], x)};
    return between(between(one[0], one[1], y), between(one[1], one[2], y), z);
}

td_model td_model_part(const td_model *model, double from, double to) {
    const double *b = model->control;
    return (td_model){
        {blossom(b, from, from, from), blossom(b, from, from, to), blossom(b, from, to, to), blossom(b, to, to, to)}};
}
