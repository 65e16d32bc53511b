/* Internal: a curve that is told as it goes. Between two knots it is the cubic with their values and rates, so that a knot that
 * is added changes nothing before it; a spline through all of them would. */
#ifndef TD_OPEN_H
#define TD_OPEN_H

#include "camera/td_curve.h"

typedef struct td_open {
    td_knot *knot; /* (count), of all that were told the last ones */
    size_t count, capacity;
} td_open;

/* Adds a knot, later than the last. Without `with_rate` its rate is that of the parabola through it and the two knots before;
 * of the second the chord's, which then is the first one's, too, where `first_has_rate` is 0. On failure nothing changes. */
tides_status td_open_append(td_open *open, const td_knot *knot, int32_t with_rate, int32_t first_has_rate, tides_error *error);

/* The last knot at or before `time`, but never the last; 0 where there is none. */
size_t td_open_find(const td_open *open, double time);

/* Value and exact derivative at `time`. A time within `slack` of a knot is the knot, to the bit, whether or not the next one is
 * known yet. */
void td_open_at(const td_open *open, double time, double slack, double value[TD_CURVE_WIDTH], double rate[TD_CURVE_WIDTH]);

/* Drops knots that a curve from `time` on, and rates of those to come, don't need. Returns how many. */
size_t td_open_forget(td_open *open, double time);

#endif
