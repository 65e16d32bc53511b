/* A pixel's signal on a step, and where it crosses a level. */
#include "td_path.h"

double td_path_value(const td_path *path, double s) { return td_model_value(&path->cubic, s); }

double td_path_slope(const td_path *path, double s) { return td_model_slope(&path->cubic, s); }

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

int td_path_crossing(const td_path *path, double reference, double threshold_on, double threshold_off, double from, double to,
                     double *s) {
    td_crossing_walk walk;
    td_crossing_begin(&walk, &path->cubic);
    cut(&walk, from, to);
    int polarity = td_crossing_next(&walk, reference, threshold_on, threshold_off);
    *s = walk.s;
    return polarity;
}

void td_path_range(const td_path *path, double *low, double *high) {
    const double *b = path->cubic.control;
    *low = *high = b[0];
    for (int i = 1; i < 4; i++) {
        *low = b[i] < *low ? b[i] : *low;
        *high = b[i] > *high ? b[i] : *high;
    }
}
