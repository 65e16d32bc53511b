/* Finds events of a recording that light didn't cause: bursts when a DAVIS reads out a frame, and hot pixels. A simulation of
 * light has neither, so comparisons leave them out of both streams. */
#include "td_metrics.h"

#include "td_bursts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    REACH = 2,      /* px: a pixel is compared with its neighbours within this distance in x and y */
    RANK = 3,       /* of these the third busiest counts, since two may be hot themselves */
    HOT_LEAST = 10, /* a hot pixel has more events than this */
    HOT_TIMES = 5   /* a hot pixel has more than this multiple of the third busiest neighbour's events */
};
#define SPAN_MOST_S 20000.0 /* [s] the longest recording: 80 million bins of rates */

/* Converts bins of bursts to spans of time, from the recording's first event on. */
static tides_status take_bursts(tides_blemishes *found, const uint8_t *burst, size_t bins, int64_t first_ns,
                                tides_error *error) {
    const double bin_ns = 1e9 * TD_BURST_BIN_S;
    size_t stretches = 0;
    for (size_t i = 0; i < bins; i++) stretches += burst[i] && (i == 0 || !burst[i - 1]);
    found->burst = td_alloc(2 * stretches, sizeof *found->burst, error);
    if (!found->burst) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < bins; i++) {
        if (!burst[i]) continue;
        if (i == 0 || !burst[i - 1]) found->burst[2 * found->bursts++] = first_ns + (int64_t)(bin_ns * (double)i);
        found->burst[2 * found->bursts - 1] = first_ns + (int64_t)(bin_ns * (double)(i + 1));
    }
    return TIDES_OK;
}

static tides_status find_bursts(const tides_event *events, size_t count, tides_blemishes *found, tides_error *error) {
    const double bin_ns = 1e9 * TD_BURST_BIN_S, span = (double)events[count - 1].t - (double)events[0].t;
    if (span > 1e9 * SPAN_MOST_S)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "tides_blemishes_find: a recording of %.0f s; at most %.0f s: take a stretch of it", 1e-9 * span,
                       SPAN_MOST_S);
    const size_t bins = (size_t)(span / bin_ns) + 1;
    uint32_t *rate = td_alloc(bins, sizeof *rate, error);
    uint8_t *burst = rate ? td_alloc(bins, 1, error) : NULL;
    tides_status status = burst ? TIDES_OK : TIDES_NO_MEMORY;
    for (size_t i = 0; burst && i < count; i++) rate[(size_t)((double)(events[i].t - events[0].t) / bin_ns)]++;
    if (burst) td_bursts_in(rate, bins, burst);
    if (burst) status = take_bursts(found, burst, bins, events[0].t, error);
    free(rate);
    free(burst);
    return status;
}

/* The number of events of the RANKth busiest pixel around (x, y). */
static uint32_t around(const uint32_t *counts, int32_t width, int32_t height, int32_t x, int32_t y) {
    uint32_t most[RANK] = {0};
    for (int32_t v = y - REACH; v <= y + REACH; v++) {
        for (int32_t u = x - REACH; u <= x + REACH; u++) {
            if (u < 0 || v < 0 || u >= width || v >= height || (u == x && v == y)) continue;
            uint32_t here = counts[(size_t)v * (size_t)width + (size_t)u];
            for (int i = 0; i < RANK; i++) {
                const uint32_t other = most[i];
                if (here <= other) continue;
                most[i] = here;
                here = other;
            }
        }
    }
    return most[RANK - 1];
}

static tides_status add_hot(tides_blemishes *found, size_t *capacity, int32_t x, int32_t y, tides_error *error) {
    void *hot = found->hot;
    const tides_status status = td_reserve(&hot, capacity, found->hots + 1, 2 * sizeof *found->hot, error);
    found->hot = hot;
    if (status != TIDES_OK) return status;
    found->hot[2 * found->hots] = (uint16_t)x;
    found->hot[2 * found->hots++ + 1] = (uint16_t)y;
    return TIDES_OK;
}

/* Finds hot pixels from the numbers of events outside bursts. */
static tides_status find_hot(const uint32_t *counts, int32_t width, int32_t height, tides_blemishes *found,
                             tides_error *error) {
    size_t capacity = 0;
    tides_status status = TIDES_OK;
    for (int32_t y = 0; y < height; y++) {
        for (int32_t x = 0; x < width && status == TIDES_OK; x++) {
            const uint32_t here = counts[(size_t)y * (size_t)width + (size_t)x];
            if (here <= HOT_LEAST || here <= HOT_TIMES * (uint64_t)around(counts, width, height, x, y)) continue;
            status = add_hot(found, &capacity, x, y, error);
            found->hot_events += here;
        }
    }
    return status;
}

/* 1 if the event lies within a burst. *next: the first burst that ends after the event; events come in order of time. */
static int in_burst(const tides_blemishes *b, size_t *next, int64_t t) {
    while (*next < b->bursts && b->burst[2 * *next + 1] <= t) ++*next;
    return *next < b->bursts && t >= b->burst[2 * *next];
}

static tides_status check(const tides_event *events, size_t count, int32_t width, int32_t height, tides_error *error) {
    if (width < 1 || height < 1 || width > 65536 || height > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_blemishes_find: a sensor of %dx%d px; 1 to 65536", width, height);
    for (size_t i = 0; i < count; i++) {
        if (events[i].x >= width || events[i].y >= height)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "tides_blemishes_find: event %zu is at pixel %d, %d of a sensor of %dx%d px", i, events[i].x,
                           events[i].y, width, height);
        if (i && events[i].t < events[i - 1].t)
            return td_fail(error, TIDES_BAD_ARGUMENT, "tides_blemishes_find: event %zu is earlier than the one before it", i);
    }
    return TIDES_OK;
}

tides_status tides_blemishes_find(const tides_event *events, size_t count, int32_t width, int32_t height,
                                  tides_blemishes *found, tides_error *error) {
    if (!found || (!events && count))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_blemishes_find: events and found must be given");
    tides_blemishes made = {.burst = NULL};
    uint32_t *counts = NULL;
    size_t next = 0;
    tides_status status = check(events, count, width, height, error);
    if (status == TIDES_OK && count) status = find_bursts(events, count, &made, error);
    if (status == TIDES_OK) {
        counts = td_alloc((size_t)width * (size_t)height, sizeof *counts, error);
        if (!counts) status = TIDES_NO_MEMORY;
    }
    for (size_t i = 0; counts && i < count; i++) {
        const int inside = in_burst(&made, &next, events[i].t);
        made.burst_events += (uint64_t)inside;
        if (!inside) counts[(size_t)events[i].y * (size_t)width + events[i].x]++;
    }
    if (counts) status = find_hot(counts, width, height, &made, error);
    free(counts);
    if (status == TIDES_OK)
        *found = made;
    else
        tides_blemishes_free(&made);
    return status;
}

static int by_place(const void *a, const void *b) {
    const uint16_t *p = a, *q = b;
    return p[1] != q[1] ? (p[1] > q[1]) - (p[1] < q[1]) : (p[0] > q[0]) - (p[0] < q[0]);
}

size_t tides_blemishes_leave_out(const tides_blemishes *b, tides_event *events, size_t count) {
    size_t kept = 0, next = 0;
    for (size_t i = 0; b && i < count; i++) {
        const uint16_t place[2] = {events[i].x, events[i].y};
        if (in_burst(b, &next, events[i].t)) continue;
        if (b->hots && bsearch(place, b->hot, b->hots, 2 * sizeof *b->hot, by_place)) continue;
        events[kept++] = events[i];
    }
    return b ? kept : count;
}

void tides_blemishes_free(tides_blemishes *b) {
    if (!b) return;
    free(b->burst);
    free(b->hot);
    *b = (tides_blemishes){.burst = NULL};
}
