/* Radix sort of events by (t, y, x, polarity).
 *
 * Least significant digit first, in two keys: the place (y, x, polarity), then the time. Both count from the smallest that
 * occurs, so that a packet of 1 ms from a 346x260 sensor has 19 + 20 bits: four passes of 11 bits. */
#include "td_event_sort.h"

#include "td_sort.h"

#include <string.h>

/* Below this, insertion beats clearing the counters. */
enum { FEW = 48 };

int td_event_compare(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return (a->polarity > b->polarity) - (a->polarity < b->polarity);
}

/* What the keys count from, and how many bits they need. */
typedef struct range {
    int64_t t;
    uint32_t x, y;
    int x_bits, place_bits, time_bits;
} range;

static int bits_of(uint64_t value) {
    int bits = 0;
    for (; value; value >>= 1) bits++;
    return bits;
}

static range find_range(const tides_event *events, size_t count) {
    range least = {.t = events[0].t, .x = events[0].x, .y = events[0].y}, most = least;
    for (size_t i = 1; i < count; i++) {
        const tides_event *event = &events[i];
        if (event->t < least.t) least.t = event->t;
        if (event->t > most.t) most.t = event->t;
        if (event->x < least.x) least.x = event->x;
        if (event->x > most.x) most.x = event->x;
        if (event->y < least.y) least.y = event->y;
        if (event->y > most.y) most.y = event->y;
    }
    least.x_bits = bits_of(most.x - least.x);
    least.place_bits = bits_of(most.y - least.y) + least.x_bits + 1;
    least.time_bits = bits_of((uint64_t)most.t - (uint64_t)least.t);
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

void td_event_sort(tides_event *events, tides_event *scratch, size_t count) {
    if (count <= FEW) {
        insert_each(events, count);
        return;
    }
    if (is_sorted(events, count)) return;
    range from = find_range(events, count);
    tides_event *in = events, *out = scratch;
    for (int shift = 0; shift < from.place_bits; shift += TD_RADIX_BITS) {
        td_radix_pass(place_key, &from, shift, in, out, count, sizeof *in);
        swap(&in, &out);
    }
    for (int shift = 0; shift < from.time_bits; shift += TD_RADIX_BITS) {
        td_radix_pass(time_key, &from, shift, in, out, count, sizeof *in);
        swap(&in, &out);
    }
    if (in != events) memcpy(events, in, count * sizeof *events);
}
