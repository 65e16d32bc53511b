/* Internal: neighbours in space as neighbours in memory. */
#ifndef TD_SPACE_ORDER_H
#define TD_SPACE_ORDER_H

#include "tides/base.h"

/* Indices of those of `count` means (x 3) that are not left out, along a space-filling curve, to order[]; of one cell of it in
 * the order in which they are. Means that aren't numbers come first. TIDES_NO_MEMORY. */
tides_status td_space_order(const float *mean, const uint8_t *left_out, int64_t count, int64_t *order, tides_error *error);

#endif
