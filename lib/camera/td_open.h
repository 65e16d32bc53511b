/* Internal: an open curve, to which knots are appended during a run. Between two knots it is the cubic with their values and
 * rates. So an appended knot changes nothing before it; in a spline it would. */
#ifndef TD_OPEN_H
#define TD_OPEN_H

#include "camera/td_curve.h"

typedef struct td_open {
    td_knot *knot; /* (count), without forgotten ones */
    size_t count, capacity;
} td_open;

/* Appends a knot, later than the last. Without `with_rate` its rate is that of the parabola through it and the two knots
 * before. The second knot's rate is then the slope of the line, and so is the first one's if `first_has_rate` is 0. On
 * failure nothing changes. */
tides_status td_open_append(td_open *open, const td_knot *knot, int32_t with_rate, int32_t first_has_rate, tides_error *error);

/* The last knot at or before `time`, without the very last one; 0 if there is none. */
size_t td_open_find(const td_open *open, double time);

/* Value and exact derivative at `time`. Within `slack` of a knot they are the knot's, to the bit, whether or not the next
 * knot is known yet. */
void td_open_at(const td_open *open, double time, double slack, double value[TD_CURVE_WIDTH], double rate[TD_CURVE_WIDTH]);

/* Drops knots that are needed neither for times from `time` on nor for rates of later knots. Returns their number. */
size_t td_open_forget(td_open *open, double time);

#endif
