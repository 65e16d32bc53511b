/* Crossings of a cubic local model with a moving pair of levels (paper Eq. 13; DESIGN 3.2).
 *
 * The model is cut at its extrema. On each monotone piece a level is crossed if and only if the piece's end has reached it,
 * so no pair of crossings within a step can cancel and go unseen, and each crossing has a bracket before any equation is
 * solved. */
#include "td_crossing.h"
#include "td_level.h"

#include <float.h>
#include <math.h>

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
    if ((d0 > 0.0 && d1 > 0.0 && d2 > 0.0) || (d0 < 0.0 && d1 < 0.0 && d2 < 0.0)) return 0; /* both shares would be 0 */
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

/* Rounding mustn't lift an extremum out of the range that the comparator rejects tiles by. */
static double value_within(const td_model *model, double s) {
    const double *b = model->control;
    double low = fmin(fmin(b[0], b[1]), fmin(b[2], b[3]));
    double high = fmax(fmax(b[0], b[1]), fmax(b[2], b[3]));
    return fmin(fmax(td_model_value(model, s), low), high);
}

void td_crossing_begin(td_crossing_walk *walk, const td_model *model, const td_step *step) {
    const double *b = model->control;
    double extrema[2];
    int count = td_model_extrema(model, extrema);
    walk->model = *model;
    walk->step = step;
    walk->is_near = 0;
    walk->s = 0.0;
    walk->next = 0;
    walk->knots = 0;
    walk->knot[walk->knots] = 0.0;
    walk->value[walk->knots++] = b[0];
    for (int i = 0; i < count; i++) {
        walk->knot[walk->knots] = extrema[i];
        walk->value[walk->knots++] = value_within(model, extrema[i]);
    }
    walk->knot[walk->knots] = 1.0;
    walk->value[walk->knots++] = b[3];
}

/* Finds a place that has the time which td_level_solve would give: 1 where it did. Two thirds of what that does is to tell
 * apart neighbouring numbers, in the rounding of the excess. Here Newton goes on until its next step is short; then two places
 * beside it of one nanosecond, on both sides of the level by more than rounding, have all places between them where it could
 * end, for the piece is monotone. */
static int solve_near(const td_level *at, const td_step *step, double low, double high, double value_high, double *s) {
    enum { TRIES = 6 };
    const double side = TD_NEAR_ENOUGH_NS / step->length_ns, sign = at->rise > 0.0 ? 1.0 : -1.0;
    double place = td_level_chord(at, low, high, value_high), move = 1;
    for (int i = 0; i < TRIES && !(move * move < side); i++) {
        if (!(place > low && place < high)) return 0;
        move = td_level_excess(at, place) / td_level_slope(at, place);
        place -= move;
    }
    const double before = place - side, after = place + side, least = td_level_rounding(at);
    if (!(before - side > low && after + side < high)) return 0;
    *s = place;
    return td_step_time(step, before - side) == td_step_time(step, after + side) &&
           sign * td_level_excess(at, before) < -least && sign * td_level_excess(at, after) > least;
}

/* On to the crossing that lies before `knot`. From a place that is only near, it first goes on to where that is. */
static void go(td_crossing_walk *walk, double reference, double rise, double knot, double value) {
    if (walk->is_near) {
        const td_level last = {&walk->model, walk->reference, walk->rise};
        walk->s = td_level_solve(&last, walk->low, knot, value);
    }
    const td_level at = {&walk->model, reference, rise};
    walk->low = walk->s;
    walk->reference = reference;
    walk->rise = rise;
    walk->is_near = walk->step && solve_near(&at, walk->step, walk->low, knot, value, &walk->s);
    if (!walk->is_near) walk->s = td_level_solve(&at, walk->low, knot, value);
}

int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off) {
    for (; walk->next < walk->knots; walk->next++) {
        double knot = walk->knot[walk->next], value = walk->value[walk->next];
        double residual = value - reference;
        int polarity = residual >= threshold_on ? 1 : residual <= -threshold_off ? -1 : 0;
        if (polarity) {
            go(walk, reference, polarity > 0 ? threshold_on : -threshold_off, knot, value);
            return polarity;
        }
        walk->s = knot;
        walk->is_near = 0;
    }
    return 0;
}

/* The walk over [from, to] only: its knots between them, and both. */
static void cut(td_crossing_walk *walk, double from, double to) {
    td_crossing_walk all = *walk;
    walk->knots = 0;
    walk->s = from;
    walk->knot[walk->knots] = from;
    walk->value[walk->knots++] = td_model_value(&all.model, from);
    for (int i = 0; i < all.knots && to > from; i++) {
        if (!(all.knot[i] > from && all.knot[i] < to)) continue;
        walk->knot[walk->knots] = all.knot[i];
        walk->value[walk->knots++] = all.value[i];
    }
    if (!(to > from)) return;
    walk->knot[walk->knots] = to;
    walk->value[walk->knots++] = td_model_value(&all.model, to);
}

int td_crossing_within(const td_model *model, double reference, double threshold_on, double threshold_off, double from,
                       double to, double *s) {
    td_crossing_walk walk;
    td_crossing_begin(&walk, model, NULL);
    cut(&walk, from, to);
    int polarity = td_crossing_next(&walk, reference, threshold_on, threshold_off);
    *s = walk.s;
    return polarity;
}
