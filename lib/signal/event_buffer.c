/* A growing list of events: its memory. Appending is inline, in td_event_buffer.h. */
#include "td_event_buffer.h"
#include "td_base.h"

#include <stdlib.h>

void td_event_buffer_release(td_event_buffer *buffer) {
    free(buffer->events);
    *buffer = (td_event_buffer){NULL, 0, 0};
}

tides_status td_event_buffer_reserve(td_event_buffer *buffer, size_t more, tides_error *error) {
    void *events = buffer->events;
    tides_status status = td_reserve(&events, &buffer->capacity, buffer->count + more, sizeof *buffer->events, error);
    buffer->events = events;
    return status;
}
