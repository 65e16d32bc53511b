/* The close view of a comparison: a part of a row of pixels and of time, where most happens. A line joins each event to the
 * nearest exact one. */
#include "compare_zoom.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- offsets --------------------------------------------------------------------------------------------------------------- */

static size_t place_of(const compare_index *index, const tides_event *e) {
    return 2 * ((size_t)e->y * (size_t)index->width + e->x) + (e->polarity > 0);
}

/* A counting sort by place. Exact events are in order of time, and so they stay within each place. */
tides_status compare_index_make(const comparison *c, compare_index *index, tides_error *error) {
    const size_t count = c->exact.count;
    index->width = c->session.intrinsics.width;
    const size_t places = 2 * (size_t)index->width * (size_t)c->session.intrinsics.height;
    index->first = calloc(places + 2, sizeof *index->first);
    index->times = malloc((count + 1) * sizeof *index->times);
    if (!index->first || !index->times) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    for (size_t i = 0; i < count; i++) index->first[place_of(index, &c->exact.events[i]) + 2]++;
    for (size_t p = 2; p < places + 2; p++) index->first[p] += index->first[p - 1];
    for (size_t i = 0; i < count; i++)
        index->times[index->first[place_of(index, &c->exact.events[i]) + 1]++] = c->exact.events[i].t;
    return TIDES_OK;
}

void compare_index_free(compare_index *index) {
    free(index->first);
    free(index->times);
}

double compare_offset_ns(const compare_index *index, const tides_event *e) {
    const size_t place = place_of(index, e), end = index->first[place + 1];
    size_t low = index->first[place], high = end;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (index->times[middle] < e->t)
            low = middle + 1;
        else
            high = middle;
    }
    const double after = low < end ? (double)(e->t - index->times[low]) : INFINITY;
    const double before = low > index->first[place] ? (double)(e->t - index->times[low - 1]) : INFINITY;
    return fabs(after) < before ? after : before;
}

/* -- where ----------------------------------------------------------------------------------------------------------------- */

enum { ZOOM_WIDTH = 24 /* px */, ZOOM_EVENTS = 120 /* ZOOM_EVENTS can be told apart */ };

static int32_t is_inside(const view_mark *zoom, const tides_event *e) {
    return e->y == zoom->y && e->x >= zoom->x && e->x < zoom->x + zoom->width && e->t >= zoom->first_ns && e->t < zoom->stop_ns;
}

cli_window compare_zoom_events(const view_mark *zoom, const tides_event *events, size_t count, tides_event *kept) {
    cli_window found = {.first_ns = zoom->first_ns, .stop_ns = zoom->stop_ns, .events = kept};
    for (size_t i = 0; i < count; i++) {
        if (!is_inside(zoom, &events[i])) continue;
        if (kept) kept[found.count] = events[i];
        found.count++;
    }
    return found;
}

/* The part of a row with the most exact events. */
static tides_status choose_place(const comparison *c, view_mark *zoom, tides_error *error) {
    const int32_t width = c->session.intrinsics.width, height = c->session.intrinsics.height;
    zoom->width = width < ZOOM_WIDTH ? width : ZOOM_WIDTH;
    const int32_t across = width / zoom->width;
    uint32_t *counts = calloc((size_t)across * (size_t)height, sizeof *counts);
    size_t best = 0;
    if (!counts) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    for (size_t i = 0; i < c->exact.count; i++) {
        const tides_event *e = &c->exact.events[i];
        if (e->x < across * zoom->width) counts[(size_t)e->y * (size_t)across + (size_t)(e->x / zoom->width)]++;
    }
    for (size_t i = 1; i < (size_t)across * (size_t)height; i++)
        if (counts[i] > counts[best]) best = i;
    zoom->y = (int32_t)(best / (size_t)across);
    zoom->x = (int32_t)(best % (size_t)across) * zoom->width;
    free(counts);
    return TIDES_OK;
}

/* The interval in the middle of the run: as long as asked for, else halved until events can be told apart. */
tides_status compare_choose_zoom(const comparison *c, view_mark *zoom, tides_error *error) {
    int64_t start, stop;
    compare_interval(c, COMPARE_EXACT, &start, &stop);
    int64_t length = stop - start;
    if (c->window_s > 0) length = (int64_t)fmin((double)length, fmax(1e9 * c->window_s, 1));
    const tides_status status = choose_place(c, zoom, error);
    for (; status == TIDES_OK; length /= 2) {
        zoom->first_ns = start + (stop - start - length) / 2;
        zoom->stop_ns = zoom->first_ns + length;
        if (c->window_s > 0 || length < 2000) break;
        if (compare_zoom_events(zoom, c->exact.events, c->exact.count, NULL).count <= ZOOM_EVENTS) break;
    }
    return status;
}
