/* Internal: a smooth curve in R^7 through knots, with its exact derivative. The seven components of a pose (position,
 * quaternion) share their knots, so they share one tridiagonal system. */
#ifndef TD_CURVE_H
#define TD_CURVE_H

#include "tides/base.h"

#define TD_CURVE_WIDTH 7

typedef struct td_knot {
    double time; /* relative to the first knot [s] */
    double value[TD_CURVE_WIDTH];
    double rate[TD_CURVE_WIDTH]; /* [1/s]; read only where the curve is asked to honour rates */
} td_knot;

typedef struct td_curve td_curve;

/* A curve through `count` >= 2 knots in strictly increasing time. `with_rates` 0: C2 cubic spline; 1: C3 quintic spline
 * that also has the knots' rates. NULL: out of memory, error filled. */
td_curve *td_curve_create(const td_knot *knots, size_t count, int with_rates, tides_error *error);

/* NULL is fine. */
void td_curve_destroy(td_curve *curve);

/* Segment that holds `time`: the one that begins there at a knot, the last one at the end. */
size_t td_curve_find(const td_curve *curve, double time);

/* Value and exact derivative of segment `index` at `time`. */
void td_curve_at(const td_curve *curve, size_t index, double time, double value[TD_CURVE_WIDTH], double rate[TD_CURVE_WIDTH]);

/* Second derivative of segment `index` at `time`. */
void td_curve_second(const td_curve *curve, size_t index, double time, double second[TD_CURVE_WIDTH]);

/* The first knot in (start, stop) at which the curve is C1 only (curve_calm.c); the number of knots where there is none. An
 * end of the curve is no such knot. */
size_t td_curve_first_bend(const td_curve *curve, double start, double stop);

#endif
