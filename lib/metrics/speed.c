/* Speed of the image, from the reference only. A pixel's crossing time is the time since the latest earlier event of equal
 * polarity on its four neighbours. The speed is one pixel divided by the median of the crossing times up to 50 ms. */
#include "td_metrics.h"

#include <math.h>
#include <stdlib.h>

static const int64_t longest_ns = 50000000; /* longest crossing time that counts */

/* The time of the latest event for each polarity and pixel [ns]; for none, a time below -longest_ns. */
typedef struct surface {
    int64_t *latest; /* (2, height, width) */
    int32_t width, height;
} surface;

static int64_t *place(const surface *s, const tides_event *event) {
    const size_t plane = event->polarity > 0 ? (size_t)s->width * (size_t)s->height : 0;
    return &s->latest[plane + (size_t)event->y * (size_t)s->width + event->x];
}

static int64_t latest_neighbour(const surface *s, const tides_event *event) {
    const int64_t *here = place(s, event);
    int64_t latest = INT64_MIN;
    if (event->x > 0 && here[-1] > latest) latest = here[-1];
    if (event->x + 1 < s->width && here[1] > latest) latest = here[1];
    if (event->y > 0 && here[-s->width] > latest) latest = here[-s->width];
    if (event->y + 1 < s->height && here[s->width] > latest) latest = here[s->width];
    return latest;
}

/* Simultaneous events don't count for each other: all are looked up first, and stored afterwards. */
static size_t crossing_times(const td_stream *stream, const surface *s, uint64_t *times) {
    const tides_event *events = stream->events;
    size_t found = 0;
    for (size_t i = 0, end; i < stream->count; i = end) {
        for (end = i; end < stream->count && events[end].t == events[i].t; end++) {
            const int64_t latest = latest_neighbour(s, &events[end]);
            if (latest >= events[end].t - longest_ns) times[found++] = (uint64_t)(events[end].t - latest);
        }
        for (size_t k = i; k < end; k++) *place(s, &events[k]) = events[k].t;
    }
    return found;
}

tides_status td_compare_speed(const td_compare *c, double *speed) {
    const size_t places = 2 * td_compare_pixels(c), count = c->reference.count;
    surface s = {td_alloc(places, sizeof *s.latest, c->error), c->width, c->height};
    uint64_t *times = td_alloc(count, sizeof *times, c->error), *scratch = td_alloc(count, sizeof *scratch, c->error);
    tides_status status = s.latest && times && scratch ? TIDES_OK : TIDES_NO_MEMORY;
    *speed = NAN;
    if (status == TIDES_OK) {
        for (size_t i = 0; i < places; i++) s.latest[i] = INT64_MIN;
        const size_t found = crossing_times(&c->reference, &s, times);
        td_sort_values(times, scratch, found);
        if (found) *speed = 1e9 / td_median(times, found);
    }
    free(s.latest);
    free(times);
    free(scratch);
    return status;
}
