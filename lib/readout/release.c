/* Puts events that have left the readout's queues in the order of their times. Waiting and jitter disturb that order, but only
 * within a bounded time: events older than that are final, and go to the sink. */
#include "td_release.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

void td_release_free(td_release *release) {
    free(release->events);
    free(release->fired);
    memset(release, 0, sizeof *release);
}

tides_status td_release_grow(td_release *release, size_t more, tides_error *error) {
    void *events = release->events, *fired = release->fired;
    tides_status status = td_reserve(&events, &release->events_capacity, release->count + more, sizeof *release->events, error);
    release->events = events;
    if (status == TIDES_OK)
        status = td_reserve(&fired, &release->fired_capacity, release->count + more, sizeof *release->fired, error);
    release->fired = fired;
    return status;
}

size_t td_release_held(const td_release *release) { return release->count; }

/* Sort key for events of the same time: row, then column, then polarity. */
static inline uint64_t place_of(const tides_event *event) {
    return (uint64_t)event->y << 24 | (uint64_t)event->x << 8 | (uint64_t)(event->polarity - INT8_MIN);
}

/* Is x after y? The order is by time, then place_of, then the time of firing. It is total, so the output doesn't depend on the
 * sizes of the batches in which events were pushed. Time is compared first, since it decides most pairs. */
static inline int is_after(const tides_event *x, int64_t x_fired, const tides_event *y, int64_t y_fired) {
    if (x->t != y->t) return x->t > y->t;
    const uint64_t x_place = place_of(x), y_place = place_of(y);
    return x_place != y_place ? x_place > y_place : x_fired > y_fired;
}

enum { TOGETHER_MAX = 64 }; /* beyond this, comparing all pairs takes longer than sorting */

/* Counts for each event the events with smaller keys: that number is its new index. The counting loop has no branches, whereas
 * a sort of a few unordered events would mispredict most of its branches.
 *
 * A key is place_of and, for events of equal place_of, the index in `events`, which is the order in which they fired. Keys are
 * whole numbers below 2^53, so doubles hold them exactly. */
void td_release_order(tides_event *events, int64_t *fired, int32_t count) {
    double key[TOGETHER_MAX], rank[TOGETHER_MAX];
    tides_event event[TOGETHER_MAX];
    int64_t when[TOGETHER_MAX];
    if (count < 2 || count > TOGETHER_MAX) return;
    for (int32_t i = 0; i < count; i++) {
        key[i] = (double)(int64_t)(place_of(&events[i]) * TOGETHER_MAX + (uint64_t)i);
        rank[i] = 0;
        event[i] = events[i];
        when[i] = fired[i];
    }
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = 0; k < count; k++) rank[k] += key[i] < key[k] ? 1.0 : 0.0;
    for (int32_t i = 0; i < count; i++) {
        events[(int32_t)rank[i]] = event[i];
        fired[(int32_t)rank[i]] = when[i];
    }
}

/* Insertion sort of all events. It is fast where events are nearly in order: waiting shifts an event by less than a tick, and
 * jitter by a few of its standard deviations. Returns 0, with the events partly sorted, if more than `moves` moves by one place
 * are needed; else 1. */
static int insert_each(td_release *release, size_t moves) {
    tides_event *events = release->events;
    int64_t *fired = release->fired;
    for (size_t i = 1; i < release->count; i++) {
        tides_event event = events[i];
        int64_t when = fired[i];
        size_t to = i;
        for (; to > 0 && is_after(&events[to - 1], fired[to - 1], &event, when); to--) {
            events[to] = events[to - 1];
            fired[to] = fired[to - 1];
        }
        events[to] = event;
        fired[to] = when;
        if (i - to > moves) return 0;
        moves -= i - to;
    }
    return 1;
}

typedef struct left {
    tides_event event;
    int64_t fired;
} left;

static int by_time(const void *a, const void *b) {
    const left *x = a, *y = b;
    if (is_after(&x->event, x->fired, &y->event, y->fired)) return 1;
    return is_after(&y->event, y->fired, &x->event, x->fired) ? -1 : 0;
}

static tides_status sort_all(td_release *release, tides_error *error) {
    left *all = td_alloc(release->count, sizeof *all, error);
    if (!all) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < release->count; i++) all[i] = (left){release->events[i], release->fired[i]};
    qsort(all, release->count, sizeof *all, by_time);
    for (size_t i = 0; i < release->count; i++) {
        release->events[i] = all[i].event;
        release->fired[i] = all[i].fired;
    }
    free(all);
    return TIDES_OK;
}

/* The number of events that left before `certain` [ns]. The events are sorted. */
static size_t count_before(const td_release *release, int64_t certain) {
    size_t low = 0, high = release->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (release->events[middle].t < certain)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

tides_status td_release_emit(td_release *release, int64_t certain, tides_readout_sink sink, void *user, tides_error *error) {
    const size_t moves_each = 32; /* if events need more on average, qsort is faster */
    if (!insert_each(release, moves_each * release->count)) {
        tides_status status = sort_all(release, error);
        if (status != TIDES_OK) return status;
    }
    size_t count = count_before(release, certain);
    if (count == 0) return TIDES_OK;
    int stopped = sink && sink(user, release->events, release->fired, count);
    release->count -= count;
    memmove(release->events, release->events + count, release->count * sizeof *release->events);
    memmove(release->fired, release->fired + count, release->count * sizeof *release->fired);
    return stopped ? td_fail(error, TIDES_CANCELLED, "stopped by the sink of the readout") : TIDES_OK;
}
