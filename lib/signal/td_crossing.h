/* Internal: crossings of a pixel's local model, on one step, with a pair of levels that moves at each crossing. */
#ifndef TD_CROSSING_H
#define TD_CROSSING_H

#include "td_model.h"
#include "td_step.h"

/* The places in (0, 1) where the slope changes sign, ascending: 0, 1 or 2. None if the model isn't finite. */
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
    double value[4]; /* S at the knots, clamped to the range of the control values */
    int knots, next; /* number of knots; the first that hasn't been passed */
    double s;        /* where the walk stands; with a `step`, exact only as far as its time in ns */
    const td_step *step;
    double low; /* the last place that is known to the last bit, */
    int near;   /* and the number of crossings since, whose places are only near */
    td_crossed crossed[TD_CROSSED_MAX];
} td_crossing_walk;

/* With `step`, only the times of crossings are exact, to the nanosecond. NULL: their places are. */
void td_crossing_begin(td_crossing_walk *walk, const td_model *model, const td_step *step);

/* Goes on to the first s, at or after where the walk stands, at which S - reference >= threshold_on (returns +1) or S -
 * reference <= -threshold_off (returns -1). Returns 0 if there is none. The caller then moves the reference by that threshold
 * and asks again.
 *
 * A level counts as reached where S equals it, so touching it fires. A signal beyond a level at s = 0 gives s = 0. Crossings
 * come in time order. Work is bounded for any input; NaN reaches no level. */
int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off);

/* The first crossing in [from, to], where 0 <= `from` <= `to` <= 1: returns its polarity and sets its place; 0 if there is
 * none. */
int td_crossing_within(const td_model *model, double reference, double threshold_on, double threshold_off, double from,
                       double to, double *s);

#endif
