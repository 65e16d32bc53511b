/* Internal: the pieces of a curve, for what makes them (curve.c) and what calms them (curve_calm.c). */
#ifndef TD_CURVE_SEGMENT_H
#define TD_CURVE_SEGMENT_H

#include "camera/td_curve.h"

typedef struct td_segment {
    double coefficient[TD_CURVE_WIDTH][6]; /* of powers of u = (t - start) / span */
} td_segment;

/* Puts pieces that don't swing in the place of those that do (curve_calm.c); `segments` are those of the spline through the
 * knots, and bends[i] becomes 1 where the curve is C1 only at knot i. */
tides_status td_curve_calm(const td_knot *knots, size_t count, int with_rates, td_segment *segments, unsigned char *bends,
                           tides_error *error);

#endif
