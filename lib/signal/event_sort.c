/* Radix sort of events by (t, y, x, polarity).
 *
 * Times are whole nanoseconds, so that few events share theirs. A packet is distributed into intervals of time that fit the
 * nearest cache, and each interval into slices of about one event. Only neighbours are left to be sorted. Passes over all bits
 * of time and place take twice as long. */
#include "td_event_sort.h"

#include "td_sort.h"
#include "td_wide.h"

#include <string.h>

/* With fewer events insertion is faster than clearing the counters. */
enum { FEW = 48 };

/* The least values, which keys are relative to, and numbers of bits of keys. */
typedef struct range {
    int64_t t;
    uint32_t x, y;
    int x_bits, bits;
} range;

static int bits_of(uint64_t value) {
    int bits = 0;
    for (; value; value >>= 1) bits++;
    return bits;
}

/* Range of times. */
TD_WIDE static range find_times(const tides_event *events, size_t count) {
    int64_t least = events[0].t, most = least;
    for (size_t i = 1; i < count; i++) {
        const int64_t t = events[i].t;
        least = t < least ? t : least;
        most = t > most ? t : most;
    }
    return (range){.t = least, .bits = bits_of((uint64_t)most - (uint64_t)least)};
}

/* Range of places. */
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

static void swap(tides_event **a, tides_event **b) {
    tides_event *kept = *a;
    *a = *b;
    *b = kept;
}

static void sort_by_place(tides_event *events, tides_event *scratch, size_t count) {
    const range from = find_places(events, count);
    tides_event *in = events, *out = scratch;
    for (int done = 0; done < from.bits; done += TD_RADIX_BITS) {
        td_radix_pass(place_key, &from, done, in, out, count, sizeof *in);
        swap(&in, &out);
    }
    if (in != events) memcpy(events, in, count * sizeof *events);
}

static void insert_each(tides_event *events, size_t count) {
    for (size_t i = 1; i < count; i++) {
        if (events[i - 1].t < events[i].t) continue; /* most are in order */
        const tides_event event = events[i];
        size_t place = i;
        for (; place > 0 && td_event_compare(&events[place - 1], &event) > 0; place--) events[place] = events[place - 1];
        if (place < i) events[place] = event;
    }
}

static int is_sorted(const tides_event *events, size_t count) {
    for (size_t i = 1; i < count; i++)
        if (td_event_compare(&events[i - 1], &events[i]) > 0) return 0;
    return 1;
}

/* -- by time --------------------------------------------------------------------------------------------------------------- */

/* A digit: bits of a time since `t`, from `shift` on; fewer than 64. */
typedef struct digit {
    int64_t t;
    int shift, bits;
} digit;

/* Unsigned, for the whole range of int64. */
static inline size_t digit_of(const digit *of, const tides_event *event) {
    const uint64_t since = (uint64_t)event->t - (uint64_t)of->t;
    return (size_t)(since >> of->shift & (((uint64_t)1 << of->bits) - 1));
}

/* Distributes the events by their digits, in their order; `end` is each digit's end. Returns the greatest number of events of a
 * digit. */
static size_t deal(const digit *of, const tides_event *in, tides_event *out, size_t count, size_t *end) {
    const digit by = *of;
    const size_t digits = (size_t)1 << by.bits;
    size_t next = 0, most = 0;
    memset(end, 0, digits * sizeof *end);
    for (size_t i = 0; i < count; i++) end[digit_of(&by, &in[i])]++;
    for (size_t k = 0; k < digits; k++) {
        const size_t here = end[k];
        most = here > most ? here : most;
        end[k] = next;
        next += here;
    }
    for (size_t i = 0; i < count; i++) out[end[digit_of(&by, &in[i])]++] = in[i];
    return most;
}

static int lesser_of(int a, int b) { return a < b ? a : b; }

/* Sorts an interval of time from `in`, whose contents are lost, to `events`. Times differ in their last `bits` bits. */
static void sort_stretch(tides_event *in, tides_event *events, size_t count, int64_t t, int bits) {
    size_t end[TD_RADIX_DIGITS], begin = 0;
    const int most_bits = lesser_of(bits_of(count), TD_RADIX_BITS), used = lesser_of(bits, most_bits);
    const digit slices = {t, bits - used, used};
    if (count <= FEW) {
        memcpy(events, in, count * sizeof *in);
        insert_each(events, count);
        return;
    }
    if (deal(&slices, in, events, count, end) <= FEW) {
        insert_each(events, count);
        return;
    }
    for (size_t k = 0; k < (size_t)1 << used; begin = end[k++]) td_event_sort(events + begin, in + begin, end[k] - begin);
}

/* Events of an interval, if times are spread evenly: twice 8 KB. */
enum { STRETCH = 512 };

static void sort_by_time(tides_event *events, tides_event *scratch, size_t count, const range *times) {
    size_t end[TD_RADIX_DIGITS], begin = 0;
    int used = 0;
    while (used < lesser_of(times->bits, TD_RADIX_BITS) && count >> used > STRETCH) used++;
    const int bits = times->bits - used;
    const digit stretches = {times->t, used > 0 ? bits : 0, used};
    deal(&stretches, events, scratch, count, end);
    for (size_t k = 0; k < (size_t)1 << used; begin = end[k++])
        sort_stretch(scratch + begin, events + begin, end[k] - begin, times->t, bits);
}

void td_event_sort(tides_event *events, tides_event *scratch, size_t count) {
    if (count <= FEW) {
        insert_each(events, count);
        return;
    }
    if (is_sorted(events, count)) return;
    const range times = find_times(events, count);
    if (times.bits == 0)
        sort_by_place(events, scratch, count);
    else
        sort_by_time(events, scratch, count, &times);
}
