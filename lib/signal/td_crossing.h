/* Internal: crossings of a local model (td_model.h) with a pair of levels that moves with them, for the comparator, with or
 * without blocks. It knows one pixel on one step; the caller gives a crossing its meaning. */
#ifndef TD_CROSSING_H
#define TD_CROSSING_H

#include "td_model.h"
#include "td_step.h"

/* The places in (0, 1) where the slope changes sign, ascending: 0, 1 or 2 of them. None where the model isn't finite. */
int td_model_extrema(const td_model *model, double s[2]);

/* A level that was crossed. */
typedef struct td_crossed {
    double reference, rise;
} td_crossed;

enum { TD_CROSSED_MAX = 8 };

/* A walk along the model that stops at each crossing. */
typedef struct td_crossing_walk {
    td_model model;
    double knot[4];  /* the start, the extrema and the end: between knots the model is monotone */
    double value[4]; /* S at the knots, within the range of the control values */
    int knots, next; /* how many there are; the first that hasn't been passed */
    double s;        /* where the walk stands; with a `step` so near that td_step_time is what it is there */
    const td_step *step;
    double low; /* the last place that is known to rounding, */
    int near;   /* and so many crossings since, which are near only */
    td_crossed crossed[TD_CROSSED_MAX];
} td_crossing_walk;

/* `step`: only the times are wanted that it gives the crossings, to the nanosecond; NULL: their places. */
void td_crossing_begin(td_crossing_walk *walk, const td_model *model, const td_step *step);

/* Goes on to the first s, at or after where the walk stands, at which S - reference >= threshold_on (returns +1) or
 * S - reference <= -threshold_off (returns -1); 0 where the rest of the step has none. The caller then moves the reference by
 * that threshold and asks again. S on a level counts as reached, so that touching a level fires, and a signal that is beyond a
 * level at s = 0 already gives s = 0. Crossings come in time order. Bounded work for any input, NaN and infinities included:
 * NaN reaches nothing. */
int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off);

/* The first crossing in [from, to] alone, `from` <= `to` within [0, 1]: its polarity, and its place; 0 where there is none. */
int td_crossing_within(const td_model *model, double reference, double threshold_on, double threshold_off, double from,
                       double to, double *s);

#endif
