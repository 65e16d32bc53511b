/* Internal: the local model of one pixel's signal on one step, and its crossings of a pair of levels that moves with them.
 *
 * Time within a step is s = (t - t0) / h in [0, 1]. Every model (TIDES_MODEL_*, DESIGN 3.2) is a cubic held as its four Bezier
 * control values, because
 *   - both ends are met to the bit: value(0) = control[0], value(1) = control[3];
 *   - the curve stays within the range of its control values: "nothing can cross" needs four comparisons and no root;
 *   - whether and where the slope changes sign can be read off differences without cancellation. */
#ifndef TD_CROSSING_H
#define TD_CROSSING_H

#include "tides/simulate.h"

typedef struct td_model {
    double control[4]; /* [log units] */
} td_model;

/* The model `kind` (TIDES_MODEL_*) on a step of h seconds. The linear model reads no S1, only the cubic reads S1_dot, the
 * secant reads no rates. Inline, so that the comparator's test of whole tiles vectorises; kinds are checked by the caller. */
static inline td_model td_model_fit(int32_t kind, double h, double S0, double S0_dot, double S1, double S1_dot) {
    /* Each model is the cubic with its own idea of the end value and of the rates (per step) at both ends. */
    double rate0 = h * S0_dot, end = S1, rate1 = h * S1_dot;
    if (kind == TIDES_MODEL_LINEAR) {
        end = S0 + rate0;
        rate1 = rate0;
    } else if (kind == TIDES_MODEL_QUADRATIC) {
        rate1 = 2.0 * (S1 - S0) - rate0;
    } else if (kind == TIDES_MODEL_SECANT) {
        rate0 = rate1 = S1 - S0;
    }
    td_model model = {{S0, S0 + rate0 * (1.0 / 3.0), end - rate1 * (1.0 / 3.0), end}};
    return model;
}

/* S and dS/ds at s in [0, 1]. */
double td_model_value(const td_model *model, double s);
double td_model_slope(const td_model *model, double s);

/* 1 if no control value is NaN or infinite. */
int td_model_is_finite(const td_model *model);

/* The places in (0, 1) where the slope changes sign, ascending: 0, 1 or 2 of them. None where the model isn't finite. */
int td_model_extrema(const td_model *model, double s[2]);

/* A walk along the model that stops at each crossing. */
typedef struct td_crossing_walk {
    td_model model;
    double knot[4];  /* the start, the extrema and the end: between knots the model is monotone */
    double value[4]; /* S at the knots, within the range of the control values */
    int knots, next; /* how many there are; the first that hasn't been passed */
    double s;        /* where the walk stands */
} td_crossing_walk;

void td_crossing_begin(td_crossing_walk *walk, const td_model *model);

/* Goes on to the first s, at or after where the walk stands, at which S - reference >= threshold_on (returns +1) or
 * S - reference <= -threshold_off (returns -1); 0 where the rest of the step has none. The caller then moves the reference by
 * that threshold and asks again. S on a level counts as reached, so that touching a level fires, and a signal that is beyond a
 * level at s = 0 already gives s = 0. Crossings come in time order. Bounded work for any input, NaN and infinities included:
 * NaN reaches nothing. */
int td_crossing_next(td_crossing_walk *walk, double reference, double threshold_on, double threshold_off);

#endif
