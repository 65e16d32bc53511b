/* Internal: the order of events in a stream, used by sorts, writers and readers. */
#ifndef TD_EVENT_ORDER_H
#define TD_EVENT_ORDER_H

#include "tides/events.h"

/* By time, then y, x, polarity. Below 0: `a` comes before `b`; 0: they are equal; above 0: `a` comes after. */
static inline int td_event_compare(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return (a->polarity > b->polarity) - (a->polarity < b->polarity);
}

#endif
