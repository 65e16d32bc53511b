/* The events of a stretch of time, read back from an event file. */
#include "session.h"

#include <stdlib.h>

/* Number of the first of `count` events at or after `ns`: events are sorted by time. */
static tides_status find_first(const char *path, uint64_t count, int64_t ns, uint64_t *first, tides_error *error) {
    uint64_t low = 0, high = count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        tides_event event;
        size_t got = 0;
        tides_status status = tides_events_read(path, middle, 1, &event, &got, error);
        if (status != TIDES_OK) return status;
        if (got == 1 && event.t < ns)
            low = middle + 1;
        else
            high = middle;
    }
    *first = low;
    return TIDES_OK;
}

tides_status cli_window_read(const char *path, cli_window *window, tides_error *error) {
    tides_event_summary summary;
    uint64_t first = 0, stop = 0;
    tides_status status = tides_events_summary(path, &summary, error);
    if (status == TIDES_OK) status = find_first(path, summary.count, window->first_ns, &first, error);
    if (status == TIDES_OK) status = find_first(path, summary.count, window->stop_ns, &stop, error);
    if (status != TIDES_OK || stop == first) return status;
    tides_event *events = malloc((size_t)(stop - first) * sizeof *events);
    if (!events) return cli_error(error, TIDES_NO_MEMORY, "out of memory: events of the preview");
    status = tides_events_read(path, first, (size_t)(stop - first), events, &window->count, error);
    if (status == TIDES_OK)
        window->events = events;
    else
        free(events);
    return status;
}
