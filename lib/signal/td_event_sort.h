/* Internal: the order of event streams, and a sort that makes it. */
#ifndef TD_EVENT_SORT_H
#define TD_EVENT_SORT_H

#include "tides/events.h"

/* Below 0, 0 or above 0 as `a` comes before, with or after `b`: by (t, y, x, polarity). */
int td_event_compare(const tides_event *a, const tides_event *b);

/* Sorts `count` events by (t, y, x, polarity), in O(count) for any times. Stable. `scratch` is memory for as many events, whose
 * contents are lost. */
void td_event_sort(tides_event *events, tides_event *scratch, size_t count);

#endif
