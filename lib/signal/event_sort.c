/* Radix sort of events by (t, y, x, polarity).
 *
 * Times are whole nanoseconds, so that few events share theirs: events are sorted by the first bits of their time, counted from
 * the earliest of the packet, in as many passes as leave a few in a slice of time; and each slice then by itself. Passes over
 * all bits of time and place, four of them for a packet of 1 ms, took twice as long. */
#include "td_event_sort.h"

#include "td_sort.h"
#include "td_wide.h"

#include <string.h>

/* Below this, insertion beats clearing the counters. */
enum { FEW = 48 };

int td_event_compare(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return (a->polarity > b->polarity) - (a->polarity < b->polarity);
}

/* What keys count from; the first of their bits, and how many these are. */
typedef struct range {
    int64_t t;
    uint32_t x, y;
    int x_bits, shift, bits;
} range;

static int bits_of(uint64_t value) {
    int bits = 0;
    for (; value; value >>= 1) bits++;
    return bits;
}

/* Of times: all bits, or as many as make slices of four events if these are spread evenly. */
TD_WIDE static range find_times(const tides_event *events, size_t count) {
    int64_t least = events[0].t, most = least;
    for (size_t i = 1; i < count; i++) {
        const int64_t t = events[i].t;
        least = t < least ? t : least;
        most = t > most ? t : most;
    }
    const int bits = bits_of((uint64_t)most - (uint64_t)least);
    int used = TD_RADIX_BITS;
    while (used < bits && count >> used >= 4) used += TD_RADIX_BITS;
    return (range){.t = least, .shift = used < bits ? bits - used : 0, .bits = used < bits ? used : bits};
}

/* Of places. */
static range find_places(const tides_event *events, size_t count) {
    range least = {.x = events[0].x, .y = events[0].y}, most = least;
    for (size_t i = 1; i < count; i++) {
        const tides_event *event = &events[i];
        if (event->x < least.x) least.x = event->x;
        if (event->x > most.x) most.x = event->x;
        if (event->y < least.y) least.y = event->y;
        if (event->y > most.y) most.y = event->y;
    }
    least.x_bits = bits_of(most.x - least.x);
    least.bits = bits_of(most.y - least.y) + least.x_bits + 1;
    return least;
}

static inline uint64_t place_key(const void *context, const void *item) {
    const range *from = context;
    const tides_event *event = item;
    uint64_t y = event->y - from->y, x = event->x - from->x;
    return (y << from->x_bits | x) << 1 | (event->polarity > 0);
}

/* Unsigned, so that the whole range of int64 is fine. */
static inline uint64_t time_key(const void *context, const void *item) {
    return (uint64_t)((const tides_event *)item)->t - (uint64_t)((const range *)context)->t;
}

static void swap(tides_event **a, tides_event **b) {
    tides_event *kept = *a;
    *a = *b;
    *b = kept;
}

/* Sorts by the first bits of a key that the compiler knows. */
#if defined(__GNUC__)
__attribute__((__always_inline__))
#endif
static inline void
sort_by(td_radix_key key, const range *from, tides_event *events, tides_event *scratch, size_t count) {
    tides_event *in = events, *out = scratch;
    for (int done = 0; done < from->bits; done += TD_RADIX_BITS) {
        td_radix_pass(key, from, from->shift + done, in, out, count, sizeof *in);
        swap(&in, &out);
    }
    if (in != events) memcpy(events, in, count * sizeof *events);
}

static void insert_each(tides_event *events, size_t count) {
    for (size_t i = 1; i < count; i++) {
        tides_event event = events[i];
        size_t place = i;
        for (; place > 0 && td_event_compare(&events[place - 1], &event) > 0; place--) events[place] = events[place - 1];
        events[place] = event;
    }
}

static int is_sorted(const tides_event *events, size_t count) {
    for (size_t i = 1; i < count; i++)
        if (td_event_compare(&events[i - 1], &events[i]) > 0) return 0;
    return 1;
}

/* Each slice by itself: few events by insertion, many as a packet of their own, whose times have fewer bits; those of one
 * instant by place. */
static void sort_slices(tides_event *events, tides_event *scratch, size_t count, const range *from) {
    for (size_t i = 0, next; i < count; i = next) {
        const uint64_t slice = time_key(from, &events[i]) >> from->shift;
        for (next = i + 1; next < count && time_key(from, &events[next]) >> from->shift == slice;) next++;
        if (next > i + 1) td_event_sort(events + i, scratch, next - i);
    }
}

void td_event_sort(tides_event *events, tides_event *scratch, size_t count) {
    if (count <= FEW) {
        insert_each(events, count);
        return;
    }
    if (is_sorted(events, count)) return;
    const range times = find_times(events, count);
    if (times.bits == 0) {
        const range places = find_places(events, count);
        sort_by(place_key, &places, events, scratch, count);
        return;
    }
    sort_by(time_key, &times, events, scratch, count);
    sort_slices(events, scratch, count, &times);
}
