/* Internal: sorts events into the order of event streams. */
#ifndef TD_EVENT_SORT_H
#define TD_EVENT_SORT_H

#include "td_event_order.h"

/* Sorts `count` events by (t, y, x, polarity), in O(count) for any times. Stable. `scratch` is memory for as many events, whose
 * contents are lost. */
void td_event_sort(tides_event *events, tides_event *scratch, size_t count);

#endif
