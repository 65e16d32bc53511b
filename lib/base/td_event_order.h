/* Internal: the order of event streams, once: for sorts, writers and readers. */
#ifndef TD_EVENT_ORDER_H
#define TD_EVENT_ORDER_H

#include "tides/events.h"

/* Below 0, 0 or above 0 as `a` comes before, with or after `b`: by (t, y, x, polarity). */
static inline int td_event_compare(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return (a->polarity > b->polarity) - (a->polarity < b->polarity);
}

#endif
