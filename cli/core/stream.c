/* Collects the events of a run in memory. */
#include "stream.h"

#include <stdlib.h>
#include <string.h>

int cli_keep(void *user, const tides_event *events, size_t count) {
    cli_stream *stream = user;
    if (!stream || count == 0) return 0;
    if (stream->count + count > stream->capacity) {
        size_t capacity = 2 * (stream->count + count);
        tides_event *grown = realloc(stream->events, capacity * sizeof *grown);
        if (!grown) return TIDES_NO_MEMORY;
        stream->events = grown;
        stream->capacity = capacity;
    }
    memcpy(stream->events + stream->count, events, count * sizeof *events);
    stream->count += count;
    return 0;
}
