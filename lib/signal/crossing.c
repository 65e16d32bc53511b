/* Crossings of a cubic local model with a moving pair of levels (paper Eq. 13; DESIGN 3.2).
 *
 * The model is cut at its extrema. On each monotone piece a level is crossed if and only if the piece's end has reached it,
 * so no pair of crossings within a step can cancel and go unseen, and each crossing has a bracket before any equation is
 * solved. */
#include "td_crossing.h"

#include <float.h>
#include <math.h>

double td_model_value(const td_model *model, double s) {
    const double *b = model->control;
    double u = 1.0 - s;
    return u * u * (u * b[0] + 3.0 * s * b[1]) + s * s * (3.0 * u * b[2] + s * b[3]);
}

double td_model_slope(const td_model *model, double s) {
    const double *b = model->control;
    double u = 1.0 - s;
    return 3.0 * (u * u * (b[1] - b[0]) + 2.0 * u * s * (b[2] - b[1]) + s * s * (b[3] - b[2]));
}

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

void td_crossing_begin(td_crossing_walk *walk, const td_model *model) {
    const double *b = model->control;
    double low = fmin(fmin(b[0], b[1]), fmin(b[2], b[3]));
    double high = fmax(fmax(b[0], b[1]), fmax(b[2], b[3]));
    double extrema[2];
    int count = td_model_extrema(model, extrema);
    walk->model = *model;
    walk->s = 0.0;
    walk->next = 0;
    walk->knots = 0;
    walk->knot[walk->knots] = 0.0;
    walk->value[walk->knots++] = b[0];
    for (int i = 0; i < count; i++) {
        /* Rounding mustn't lift an extremum out of the range that the comparator rejects tiles by. */
        walk->knot[walk->knots] = extrema[i];
        walk->value[walk->knots++] = fmin(fmax(td_model_value(model, extrema[i]), low), high);
    }
    walk->knot[walk->knots] = 1.0;
    walk->value[walk->knots++] = b[3];
}

/* Newton alone for the first tries (two or three do, away from extrema); then every second try halves the bracket, which bounds
 * the work: 64 halvings leave 5e-20 of a step. */
enum { NEWTON_TRIES = 8, TRIES = NEWTON_TRIES + 2 * 64 };

/* The place in (low, high] where S - reference reaches `rise` (ON above 0, OFF below), given that it has at `high` and hasn't
 * at `low`. Safeguarded Newton: each try shrinks the bracket, and a Newton step that leaves it is replaced by its middle. */
static double solve(const td_model *model, double reference, double rise, double low, double high, double value_high) {
    double direction = rise > 0.0 ? 1.0 : -1.0;
    double value_low = td_model_value(model, low);
    double s = low + (high - low) * ((reference - value_low + rise) / (value_high - value_low));
    for (int i = 0; i < TRIES; i++) {
        int halve = i >= NEWTON_TRIES && i % 2 == 1;
        if (halve || !(s > low && s < high)) s = low + 0.5 * (high - low);
        if (!(s > low && s < high)) break; /* neighbouring numbers: nothing between them */
        double excess = td_model_value(model, s) - reference - rise;
        if (excess == 0.0) return s;
        if (direction * excess > 0.0)
            high = s;
        else
            low = s;
        double step = excess / td_model_slope(model, s); /* may be infinite or NaN: then the middle is next */
        s -= step;
        /* The last bit of s in [0.5, 1): 1e-16 of a step. */
        if (fabs(step) <= 0.5 * DBL_EPSILON) return fmin(fmax(s, low), high);
    }
    return high; /* the side on which the level has been reached, as in CVODE's root finder */
}

int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off) {
    for (; walk->next < walk->knots; walk->next++) {
        double knot = walk->knot[walk->next], value = walk->value[walk->next];
        double residual = value - reference;
        int polarity = residual >= threshold_on ? 1 : residual <= -threshold_off ? -1 : 0;
        if (polarity) {
            walk->s = solve(&walk->model, reference, polarity > 0 ? threshold_on : -threshold_off, walk->s, knot, value);
            return polarity;
        }
        walk->s = knot;
    }
    return 0;
}
