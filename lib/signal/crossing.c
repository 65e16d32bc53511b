/* Crossings of a cubic local model with a moving pair of levels (paper Eq. 13; DESIGN 3.2).
 *
 * The model is cut at its extrema. On each monotone piece a level is crossed if and only if the piece's end has reached it,
 * so no pair of crossings within a step can cancel and go unseen, and each crossing has a bracket before any equation is
 * solved. */
#include "td_crossing.h"
#include "td_level.h"

#include <float.h>
#include <math.h>

/* a / (a + b) if a and b have the same sign: it is then in (0, 1), and nothing cancels. Otherwise 0. */
static double share(double a, double b) {
    int same_sign = (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0);
    return same_sign ? a / (a + b) : 0.0;
}

/* The slope is d0 u^2 + 2 d1 u s + d2 s^2 with u = 1 - s: a quadratic in the ratio r = s / u, where r > 0 is all of 0 < s < 1.
 * With q = -(d1 + sign(d1) sqrt(d1^2 - d0 d2)) its roots are q / d2 and d0 / q. As values of s both are shares of quantities of
 * one sign, so that nothing cancels, and a d2 or d0 of 0 only moves its root to an end. The discriminant can cancel where the
 * two extrema nearly meet. The piece between them is then lower than rounding, so that it doesn't matter whether it is
 * found. */
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

void td_crossing_begin(td_crossing_walk *walk, const td_model *model, const td_step *step) {
    const double *b = model->control;
    double extrema[2];
    int count = td_model_extrema(model, extrema);
    walk->model = *model;
    walk->step = step;
    walk->near = 0;
    walk->s = walk->low = 0.0;
    walk->tie = (td_tie){0, 0};
    walk->next = 0;
    walk->knots = 0;
    walk->knot[walk->knots] = 0.0;
    walk->value[walk->knots++] = b[0];
    for (int i = 0; i < count; i++) {
        walk->knot[walk->knots] = extrema[i];
        walk->value[walk->knots++] = td_model_value_within(model, extrema[i]);
    }
    walk->knot[walk->knots] = 1.0;
    walk->value[walk->knots++] = b[3];
}

/* Where Newton begins: where the chord reaches the level, or an end whose value is much nearer to it. If the crossing itself
 * was looked up, it is such an end. */
static double near_guess(const td_level *at, double low, double high, double value_high) {
    const double value_low = td_model_value(at->model, low), span = high - low, rise = value_high - value_low;
    const double after_low = at->reference - value_low + at->rise, before_high = at->reference - value_high + at->rise;
    const double much = 0x1p-6; /* then Newton's first step squares the error; else a third one is needed */
    if (fabs(before_high) < much * fabs(rise) && fabs(before_high) < much * span * fabs(td_level_slope(at, high))) return high;
    if (fabs(after_low) < much * fabs(rise) && fabs(after_low) < much * span * fabs(td_level_slope(at, low))) return low;
    return low + span * (after_low / rise);
}

/* Finds a place that has the same time [ns] as the place that td_level_solve would find; 1 if it did. td_level_solve spends two
 * thirds of its time on distinguishing neighbouring numbers. Here Newton goes on until its next step is short. Then two places
 * on either side, in one nanosecond and beyond rounding from the level, prove the result, since the piece is monotone. An end
 * of the piece needs no such margin. A place of an earlier crossing that is only near doesn't count. */
static int solve_near(const td_level *at, const td_crossing_walk *walk, double high, double value_high, double *s) {
    enum { TRIES = 6 };
    const td_step *step = walk->step;
    const double side = TD_NEAR_ENOUGH_NS / step->length_ns, sign = at->rise > 0.0 ? 1.0 : -1.0, low = walk->s;
    if (!(4 * side < high - low)) return 0;
    double place = near_guess(at, low, high, value_high), move = 1;
    for (int i = 0; i < TRIES && !(move * move < side); i++) {
        if (!(place >= low && place <= high)) return 0;
        move = td_level_excess(at, place) / td_level_slope(at, place);
        place -= move;
    }
    if (!(place > (walk->near ? low + 2 * side : low - side) && place < high + side)) return 0;
    const double before = place - side, after = place + side, least = td_level_rounding(at);
    const int inner_before = before > low, inner_after = after < high;
    *s = place > low ? (place < high ? place : high) : after;
    return td_step_time(step, inner_before ? before : low) == td_step_time(step, inner_after ? after : high) &&
           (!inner_before || sign * td_level_excess(at, before) < -least) &&
           (!inner_after || sign * td_level_excess(at, after) > least);
}

/* Finds the exact place where the walk is only near one: repeats the crossings since the last exact place. */
static void settle(td_crossing_walk *walk, double knot, double value) {
    for (int i = 0; i < walk->near; i++) {
        const td_level at = {&walk->model, walk->crossed[i].reference, walk->crossed[i].rise};
        walk->low = td_level_solve(&at, walk->low, knot, value);
    }
    walk->s = walk->low;
    walk->near = 0;
}

/* Goes to the crossing before `knot`, or near it where that is enough. */
static void go(td_crossing_walk *walk, double reference, double rise, double knot, double value) {
    const td_level at = {&walk->model, reference, rise};
    if (walk->near == TD_CROSSED_MAX) settle(walk, knot, value);
    if (walk->step && solve_near(&at, walk, knot, value, &walk->s)) {
        walk->crossed[walk->near++] = (td_crossed){reference, rise};
        return;
    }
    settle(walk, knot, value);
    walk->s = walk->low = td_level_solve(&at, walk->low, knot, value);
}

/* 1 where the signal ends or turns at a knot, at a level. It is flat there, so that no later part passes the level. Levels that
 * are hardly further apart have no ties: a signal at rest would reach one after the other without end. */
static int is_tie(const td_crossing_walk *walk, double knot, double residual, double threshold_on, double threshold_off) {
    static const double apart = 4; /* [ties] least threshold */
    const td_tie *tie = &walk->tie;
    if (!(fabs(residual - threshold_on) < tie->near || fabs(residual + threshold_off) < tie->near)) return 0;
    if (!(apart * tie->near < threshold_on && apart * tie->near < threshold_off)) return 0;
    return fabs(td_model_slope(&walk->model, knot)) < tie->flat;
}

int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off) {
    for (; walk->next < walk->knots; walk->next++) {
        double knot = walk->knot[walk->next], value = walk->value[walk->next];
        double residual = value - reference;
        const double tie = is_tie(walk, knot, residual, threshold_on, threshold_off) ? walk->tie.near : 0;
        const double on = threshold_on - tie, off = threshold_off - tie;
        int polarity = residual >= on ? 1 : residual <= -off ? -1 : 0;
        if (polarity) {
            go(walk, reference, polarity > 0 ? on : -off, knot, value);
            return polarity;
        }
        walk->s = walk->low = knot;
        walk->near = 0;
    }
    return 0;
}

/* Limits the walk to [from, to]: the knots between them, and both. */
static void cut(td_crossing_walk *walk, double from, double to) {
    td_crossing_walk all = *walk;
    walk->knots = 0;
    walk->s = walk->low = from;
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

int td_crossing_within(const td_model *model, const td_tie *tie, double reference, double threshold_on, double threshold_off,
                       double from, double to, double *s) {
    td_crossing_walk walk;
    td_crossing_begin(&walk, model, NULL);
    if (tie) walk.tie = *tie;
    cut(&walk, from, to);
    int polarity = td_crossing_next(&walk, reference, threshold_on, threshold_off);
    *s = walk.s;
    return polarity;
}
