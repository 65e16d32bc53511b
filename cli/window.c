/* The events of a stretch of time, read back from an event file. */
#include "session.h"

#include <stdlib.h>
#include <string.h>

/* Appends those of the stretch; `*past` once one lies behind it: events are sorted by time. */
static tides_status keep(const char *path, cli_window *window, size_t *capacity, const tides_event *events, size_t count,
                         int *past, tides_error *error) {
    for (size_t i = 0; i < count && !*past; i++) {
        *past = events[i].t >= window->stop_ns;
        if (*past || events[i].t < window->first_ns) continue;
        if (window->count == *capacity) {
            size_t grown = *capacity ? 2 * *capacity : 4096;
            tides_event *more = realloc(window->events, grown * sizeof *more);
            if (!more) return cli_error(error, TIDES_NO_MEMORY, "out of memory: events of %s", path);
            window->events = more;
            *capacity = grown;
        }
        window->events[window->count++] = events[i];
    }
    return TIDES_OK;
}

tides_status cli_window_read(const char *path, cli_window *window, tides_error *error) {
    tides_event_reader *reader = NULL;
    tides_event events[1024];
    size_t capacity = 0;
    int past = 0;
    tides_status status = tides_event_reader_open(path, NULL, &reader, error);
    for (size_t got = 1; got && !past && status == TIDES_OK;) {
        status = tides_event_reader_read(reader, events, sizeof events / sizeof *events, &got, error);
        if (status == TIDES_OK) status = keep(path, window, &capacity, events, got, &past, error);
    }
    tides_event_reader_close(reader);
    if (status == TIDES_OK) return TIDES_OK;
    free(window->events);
    window->events = NULL;
    return status;
}
