/* Internal: a growing list of events, to which the comparator, the baselines and collectors of packets append. */
#ifndef TD_EVENT_BUFFER_H
#define TD_EVENT_BUFFER_H

#include "tides/events.h"

#include <stddef.h>

/* Zeroed at first; released by td_event_buffer_release, or free(events). */
typedef struct td_event_buffer {
    tides_event *events;
    size_t count, capacity;
} td_event_buffer;

void td_event_buffer_release(td_event_buffer *buffer);

/* Makes room for `more` events behind the present ones. */
TIDES_MUST_CHECK tides_status td_event_buffer_reserve(td_event_buffer *buffer, size_t more, tides_error *error);

/* Room is made for so many at a time: most packets of a tile have fewer. */
enum { TD_EVENT_BUFFER_GROWTH = 256 };

static inline TIDES_MUST_CHECK tides_status td_event_buffer_add(td_event_buffer *buffer, const tides_event *event,
                                                                tides_error *error) {
    if (buffer->count == buffer->capacity) {
        tides_status status = td_event_buffer_reserve(buffer, TD_EVENT_BUFFER_GROWTH, error);
        if (status != TIDES_OK) return status;
    }
    /* Field by field: a copy of 16 bytes would wait for the stores that made the fields. */
    tides_event *to = &buffer->events[buffer->count++];
    to->t = event->t;
    to->x = event->x;
    to->y = event->y;
    to->polarity = event->polarity;
    to->cause = event->cause;
    to->frontend = event->frontend;
    return TIDES_OK;
}

#endif
