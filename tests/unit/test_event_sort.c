/* The event sort against an insertion sort by the documented order, on sizes and ranges that take every path. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "signal/td_event_sort.h"
#include "td_base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t next_random(uint64_t *state) { /* xorshift64*: Vigna 2016 */
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 2685821657736338717ULL;
}

/* What random events are drawn from: times from `t` on, `t_range` of them (0: all of int64), places below the maxima. */
typedef struct draw {
    int64_t t;
    uint64_t t_range;
    uint32_t x_range, y_range;
} draw;

static void fill(tides_event *events, size_t count, const draw *from, uint64_t seed) {
    memset(events, 0, count * sizeof *events);
    for (size_t i = 0; i < count; i++) {
        uint64_t t = next_random(&seed) ^ next_random(&seed) >> 11;
        events[i].t = (int64_t)((uint64_t)from->t + (from->t_range ? t % from->t_range : t));
        events[i].x = (uint16_t)(65535 - (next_random(&seed) >> 20) % from->x_range);
        events[i].y = (uint16_t)((next_random(&seed) >> 20) % from->y_range);
        events[i].polarity = next_random(&seed) >> 63 ? 1 : -1;
        memcpy(&events[i].cause, &i, 3); /* makes equal events distinguishable: the sort must be stable */
    }
}

/* glibc's qsort isn't promised to be stable: ties go by the three bytes after the polarity, which hold the order before. */
static int compare_stably(const void *a, const void *b) {
    const tides_event *left = a, *right = b;
    int order = td_event_compare(left, right);
    if (order) return order;
    uint32_t first = 0, second = 0;
    memcpy(&first, &left->cause, 3);
    memcpy(&second, &right->cause, 3);
    return first < second ? -1 : first > second;
}

static void check(size_t count, const draw *from, uint64_t seed) {
    tides_event *events = td_alloc(count, sizeof *events, NULL), *scratch = td_alloc(count, sizeof *scratch, NULL);
    tides_event *expected = td_alloc(count, sizeof *expected, NULL);
    assert_true(events && scratch && expected);
    fill(events, count, from, seed);
    memcpy(expected, events, count * sizeof *events);
    qsort(expected, count, sizeof *expected, compare_stably);
    td_event_sort(events, scratch, count);
    assert_memory_equal(events, expected, count * sizeof *events);
    td_event_sort(events, scratch, count); /* sorted already */
    assert_memory_equal(events, expected, count * sizeof *events);
    free(events);
    free(scratch);
    free(expected);
}

static void sorts_like_a_comparison_sort(void **state) {
    (void)state;
    static const draw draws[] = {
        {5000000000, 1000000, 346, 260},         /* a packet */
        {0, 1, 65536, 65536},                    /* one instant, the largest sensor */
        {-500, 1000, 1, 1},                      /* one pixel, around time zero */
        {INT64_MIN, 0, 640, 480},                /* all times there are */
        {INT64_MAX - 100, 100, 3, 2},            /* many equal events */
        {1000000000000, 40000000000, 1280, 720}, /* 40 s at 1000 s */
    };
    static const size_t counts[] = {1, 2, 3, 47, 48, 49, 50, 1000, 30000};
    for (size_t d = 0; d < sizeof draws / sizeof *draws; d++)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
            for (uint64_t seed = 1; seed <= 4; seed++) check(counts[c], &draws[d], seed * 1000003 + c);
}

static void nothing_is_sorted_too(void **state) {
    (void)state;
    td_event_sort(NULL, NULL, 0);
}

/* The same set in any order gives the same stream. */
static void the_result_does_not_depend_on_the_order_before(void **state) {
    (void)state;
    enum { COUNT = 5000 };
    tides_event *first = td_alloc(COUNT, sizeof *first, NULL), *second = td_alloc(COUNT, sizeof *second, NULL);
    tides_event *scratch = td_alloc(COUNT, sizeof *scratch, NULL);
    assert_true(first && second && scratch);
    const draw from = {0, 2000, 20, 20};
    fill(first, COUNT, &from, 9);
    for (size_t i = 0; i < COUNT; i++) memset(&first[i].cause, 0, 3);
    for (size_t i = 0; i < COUNT; i++) second[i] = first[(i * 1237) % COUNT]; /* 1237 and 5000 have no common factor */
    td_event_sort(first, scratch, COUNT);
    td_event_sort(second, scratch, COUNT);
    assert_memory_equal(first, second, COUNT * sizeof *first);
    free(first);
    free(second);
    free(scratch);
}

static void the_order_is_t_y_x_polarity(void **state) {
    (void)state;
    static const tides_event ascending[] = {
        {-1, 9, 9, 1, 0, 0}, {0, 9, 0, 1, 0, 0},  {0, 0, 1, -1, 0, 0},
        {0, 0, 1, 1, 0, 0},  {0, 1, 1, -1, 0, 0}, {1, 0, 0, -1, 0, 0},
    };
    enum { COUNT = sizeof ascending / sizeof *ascending };
    for (int i = 0; i < COUNT; i++)
        for (int j = 0; j < COUNT; j++) {
            int order = td_event_compare(&ascending[i], &ascending[j]);
            assert_int_equal((order > 0) - (order < 0), (i > j) - (i < j));
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sorts_like_a_comparison_sort),
        cmocka_unit_test(nothing_is_sorted_too),
        cmocka_unit_test(the_result_does_not_depend_on_the_order_before),
        cmocka_unit_test(the_order_is_t_y_x_polarity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
