/* Internal: an order in which neighbours in space are neighbours in memory. */
#ifndef TD_SPACE_ORDER_H
#define TD_SPACE_ORDER_H

#include "tides/base.h"

/* Writes the indices of the means (x 3) that are not left out to order[], along a space-filling curve; within a cell of the
 * curve, in ascending order. NaN means come first. TIDES_NO_MEMORY. */
tides_status td_space_order(const float *mean, const uint8_t *left_out, int64_t count, int64_t *order, tides_error *error);

#endif
