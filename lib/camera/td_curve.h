/* Internal: a smooth curve in R^7 through knots, with its exact derivative. The seven components of a pose (position,
 * quaternion) share their knots, so they share one tridiagonal system. */
#ifndef TD_CURVE_H
#define TD_CURVE_H

#include "tides/base.h"

#define TD_CURVE_WIDTH 7 /* components: position and quaternion */

typedef struct td_knot {
    double time; /* relative to the first knot [s] */
    double value[TD_CURVE_WIDTH];
    double rate[TD_CURVE_WIDTH]; /* [1/s]; used only with `with_rates` */
} td_knot;

typedef struct td_curve td_curve;

/* A curve through `count` >= 2 knots in strictly increasing time. `with_rates` 0: a C2 cubic spline; 1: a C3 quintic spline
 * that also has the knots' rates. NULL: out of memory, error filled. */
td_curve *td_curve_create(const td_knot *knots, size_t count, int with_rates, tides_error *error);

void td_curve_destroy(td_curve *curve);

/* Index of the segment that holds `time`. At a knot it is the segment that begins there; at the end, the last one. */
size_t td_curve_find(const td_curve *curve, double time);

/* Value and exact derivative of segment `index` at `time`. */
void td_curve_at(const td_curve *curve, size_t index, double time, double value[TD_CURVE_WIDTH], double rate[TD_CURVE_WIDTH]);

/* Second derivative of segment `index` at `time`. */
void td_curve_second(const td_curve *curve, size_t index, double time, double second[TD_CURVE_WIDTH]);

/* The first knot in (start, stop) where the curve is only C1, because a segment beside it was replaced by a calmer one. If
 * there is none, the number of knots. The ends of the curve don't count. */
size_t td_curve_first_bend(const td_curve *curve, double start, double stop);

#endif
