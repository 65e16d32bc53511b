/* Internal: the polynomial segments of a curve, shared by the spline and by the calming of segments that swing. */
#ifndef TD_CURVE_SEGMENT_H
#define TD_CURVE_SEGMENT_H

#include "camera/td_curve.h"

typedef struct td_segment {
    double coefficient[TD_CURVE_WIDTH][6]; /* of powers of u = (t - start) / span */
} td_segment;

/* Replaces segments that swing far beyond the samples by calmer ones. `segments`: those of the spline through the knots.
 * bends[i] becomes 1 if the curve is then only C1 at knot i. */
tides_status td_curve_calm(const td_knot *knots, size_t count, int with_rates, td_segment *segments, unsigned char *bends,
                           tides_error *error);

#endif
