/* Internal: sorts events into the order of event streams. */
#ifndef TD_EVENT_SORT_H
#define TD_EVENT_SORT_H

#include "td_event_order.h"

/* Sorts `count` events by (t, y, x, polarity), stably, in O(count) for any times. `scratch` is memory for as many events; its
 * contents are lost. */
void td_event_sort(tides_event *events, tides_event *scratch, size_t count);

#endif
