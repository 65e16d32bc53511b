/* Crossings of a cubic local model with a moving pair of levels (paper Eq. 13; DESIGN 3.2).
 *
 * The model is cut at its extrema. On each monotone piece a level is crossed if and only if the piece's end has reached it,
 * so no pair of crossings within a step can cancel and go unseen, and each crossing has a bracket before any equation is
 * solved. */
#include "td_crossing.h"
#include "td_root.h"

#include <math.h>

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

/* A level that a model is to reach, less its value where it is looked for. */
typedef struct level {
    const td_model *model;
    double reference, rise;
} level;

static double excess_of(const void *of, double s) {
    const level *at = of;
    return td_model_value(at->model, s) - at->reference - at->rise;
}

static double slope_of(const void *of, double s) { return td_model_slope(((const level *)of)->model, s); }

/* The place in (low, high] where S - reference reaches `rise` (ON above 0, OFF below), given that it has at `high` and hasn't
 * at `low`. The chord says where to begin. */
static double solve(const td_model *model, double reference, double rise, double low, double high, double value_high) {
    const level at = {model, reference, rise};
    double value_low = td_model_value(model, low);
    double guess = low + (high - low) * ((reference - value_low + rise) / (value_high - value_low));
    return td_root(excess_of, slope_of, &at, rise > 0.0 ? 1.0 : -1.0, low, high, guess);
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
    td_crossing_begin(&walk, model);
    cut(&walk, from, to);
    int polarity = td_crossing_next(&walk, reference, threshold_on, threshold_off);
    *s = walk.s;
    return polarity;
}
