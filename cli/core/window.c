/* Reads the events of a time interval from an event file. */
#include "session.h"

#include <stdlib.h>
#include <string.h>

/* Events may be out of order by so many places: readers of text files allow it, and sort. */
enum { LATE_MOST = 65536 };

/* Appends the events that are within the window's stretch. `*past` counts the events behind the stretch since the last one
 * before its end: after more than may be late none of the others is wanted. While the window is empty, all events are looked at
 * nevertheless, because the error message for an empty stretch (cli_window_check) says when the recording begins and ends. */
static tides_status keep(const char *path, cli_window *window, size_t *capacity, const tides_event *events, size_t count,
                         size_t *past, tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        const int64_t t = events[i].t;
        const int32_t any = window->seen_ns < window->seen_stop_ns;
        if (!any || t < window->seen_ns) window->seen_ns = t;
        if (!any || t >= window->seen_stop_ns) window->seen_stop_ns = t < INT64_MAX ? t + 1 : t;
        *past = t >= window->stop_ns ? *past + 1 : 0;
        if (*past || t < window->first_ns) continue;
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

/* Sets the sensor's size [px]. If the file doesn't say it, the size is the smallest that holds the window's events. */
static void set_size(cli_window *window, const tides_event_facts *facts) {
    window->width = facts->width > 0 ? facts->width : 1;
    window->height = facts->height > 0 ? facts->height : 1;
    for (size_t i = 0; i < window->count; i++) {
        if (facts->width <= 0 && window->events[i].x >= window->width) window->width = window->events[i].x + 1;
        if (facts->height <= 0 && window->events[i].y >= window->height) window->height = window->events[i].y + 1;
    }
}

tides_status cli_window_read(const char *path, cli_window *window, tides_error *error) {
    tides_event_reader *reader = NULL;
    tides_event events[1024];
    size_t capacity = 0;
    size_t past = 0;
    tides_status status = tides_event_reader_open_as(path, window->how, &reader, error);
    for (size_t got = 1; got && !(past > LATE_MOST && window->count) && status == TIDES_OK;) {
        status = tides_event_reader_read(reader, events, sizeof events / sizeof *events, &got, error);
        if (status == TIDES_OK) status = keep(path, window, &capacity, events, got, &past, error);
    }
    if (status == TIDES_OK) {
        tides_event_reader_facts(reader, &window->facts); /* after the events: some formats have the size at the end */
        set_size(window, &window->facts);
        window->run_start_ns = window->facts.start_ns;
        window->run_stop_ns = window->facts.stop_ns;
    }
    tides_event_reader_close(reader);
    if (status == TIDES_OK) return TIDES_OK;
    free(window->events);
    window->events = NULL;
    return status;
}

tides_status cli_window_check(const char *path, const cli_window *window, int64_t start_ns, int64_t stop_ns,
                              tides_error *error) {
    const int32_t any = window->seen_ns < window->seen_stop_ns, known = window->run_start_ns < window->run_stop_ns;
    int64_t first = any ? window->seen_ns : window->run_start_ns, stop = any ? window->seen_stop_ns : window->run_stop_ns;
    if (known && window->run_start_ns < first) first = window->run_start_ns;
    if (known && window->run_stop_ns > stop) stop = window->run_stop_ns;
    return tides_event_stretch_check(path, first, stop, start_ns, stop_ns, window->how && window->how->rebase, error);
}

tides_status cli_window_ordered(const char *path, const cli_window *window, tides_error *error) {
    for (size_t i = 1; i < window->count; i++)
        if (window->events[i].t < window->events[i - 1].t)
            return cli_error(error, TIDES_BAD_FILE,
                             "%s: event %zu is earlier than the one before it: tides convert puts events in order", path, i);
    return TIDES_OK;
}

/* Index of the first event at or after `t`. */
static size_t lower_bound(const cli_window *window, int64_t t) {
    size_t low = 0, high = window->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (window->events[middle].t < t)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

cli_window cli_window_slice(const cli_window *window, int64_t first_ns, int64_t stop_ns) {
    cli_window slice = *window;
    const size_t first = lower_bound(window, first_ns), stop = lower_bound(window, stop_ns);
    slice.first_ns = first_ns;
    slice.stop_ns = stop_ns;
    slice.events = slice.events ? slice.events + first : NULL;
    slice.count = stop > first ? stop - first : 0;
    return slice;
}
