/* Internal: crossings of a local model with a pair of levels that moves with them, for the comparator, with or without blocks.
 * A walk knows one pixel on one step; the caller gives a crossing its meaning. */
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

/* A signal that ends or turns so `near` a level, on either side, reaches it where it comes so near, if its slope there is less
 * than `flat`. 0 and 0: it must reach the level itself. */
typedef struct td_tie {
    double near, flat;
} td_tie;

/* A walk along the model that stops at each crossing. */
typedef struct td_crossing_walk {
    td_model model;
    double knot[4];  /* start, extrema, end: between two knots the model is monotone */
    double value[4]; /* S at the knots, within the range of the control values */
    int knots, next; /* their number; the first that hasn't been passed */
    double s;        /* place reached; with a `step` near the crossing, and in the same nanosecond */
    const td_step *step;
    double low; /* the last exact place, */
    int near;   /* and the number of crossings since, whose places are near only */
    td_tie tie;
    td_crossed crossed[TD_CROSSED_MAX];
} td_crossing_walk;

/* With `step`, crossings need only have the right nanosecond by td_step_time; NULL: exact places. */
void td_crossing_begin(td_crossing_walk *walk, const td_model *model, const td_step *step);

/* Advances to the first s, at or after the place reached, at which S - reference >= threshold_on (returns +1) or
 * S - reference <= -threshold_off (returns -1); 0 if the rest of the step has none. The caller then moves the reference by that
 * threshold and calls again. S on a level counts as reached: touching a level fires, and a signal that is beyond a level at
 * s = 0 already gives s = 0. Crossings come in time order. Work is bounded for any input, and NaN reaches nothing. */
int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off);

/* The first crossing in [from, to] alone, `from` <= `to` within [0, 1]: its polarity, and its place; 0 where there is none.
 * `tie` may be NULL. */
int td_crossing_within(const td_model *model, const td_tie *tie, double reference, double threshold_on, double threshold_off,
                       double from, double to, double *s);

#endif
