/* Radix sort of events by (t, y, x, polarity).
 *
 * Least significant digit first, in two keys: the place (y, x, polarity), then the time. Both count from the smallest that
 * occurs, so that a packet of 1 ms from a 346x260 sensor has 19 + 20 bits: four passes of 11 bits. */
#include "td_event_sort.h"

#include <string.h>

/* 2048 counters fill half of a 32 KiB L1 cache. 8 bits would take more passes; 16 would miss the cache. */
enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

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

static inline uint64_t place_key(const range *from, const tides_event *event) {
    uint64_t y = event->y - from->y, x = event->x - from->x;
    return (y << from->x_bits | x) << 1 | (event->polarity > 0);
}

/* Unsigned, so that the whole range of int64 is fine. */
static inline uint64_t time_key(const range *from, const tides_event *event) { return (uint64_t)event->t - (uint64_t)from->t; }

/* One stable pass from `in` to `out` by the digit at `shift`; `by_time` is constant in both callers. */
static inline void pass(int by_time, const range *from, int shift, const tides_event *in, tides_event *out, size_t count) {
    size_t place[DIGITS] = {0}, next = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t key = by_time ? time_key(from, &in[i]) : place_key(from, &in[i]);
        place[key >> shift & (DIGITS - 1)]++;
    }
    for (int digit = 0; digit < DIGITS; digit++) {
        size_t here = place[digit];
        place[digit] = next;
        next += here;
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t key = by_time ? time_key(from, &in[i]) : place_key(from, &in[i]);
        out[place[key >> shift & (DIGITS - 1)]++] = in[i];
    }
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
    for (int shift = 0; shift < from.place_bits; shift += DIGIT_BITS) {
        pass(0, &from, shift, in, out, count);
        swap(&in, &out);
    }
    for (int shift = 0; shift < from.time_bits; shift += DIGIT_BITS) {
        pass(1, &from, shift, in, out, count);
        swap(&in, &out);
    }
    if (in != events) memcpy(events, in, count * sizeof *events);
}
