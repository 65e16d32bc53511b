/* Entries of a point (kernels/point_entries.h) end in the order of depth and, at equal depth, of paths, in whatever order they
 * are added, and unchanged. If they come without order, that is noticed before much time is spent. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define TD_REAL_DOUBLE
#include "kernels/point_entries.h"
#include "tests/support/scene_make.h"

#include <stdlib.h>

enum { MOST = 700 };

/* All that an entry holds comes of its path, so that a mixture of two would show. */
static td_point_entry entry_of(const td_image *image, double depth, int path) {
    td_point_entry entry = {path + 0.1, path + 0.2, path + 0.3, path + 0.4, depth, path + 0.5, path, 0, 0, 0, 0};
    if (image->is_coded) entry.green = path + 0.6, entry.green_dot = path + 0.7, entry.blue = path + 0.8, entry.blue_dot = path;
    return entry;
}

static int by_depth(const void *a, const void *b) {
    const td_point_entry *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

/* Adds `count` entries of these depths, of luminance or of three channels, and holds what comes of it against qsort. */
static td_point_order check_order_of(const td_image *image, const double *depth, const int *path, int count) {
    static double entries[MOST * TD_POINT_CODED_NUMBERS];
    static td_point_entry wanted[MOST];
    td_point_order order = {0, 0, 0};
    for (int i = 0; i < count; i++) {
        wanted[i] = entry_of(image, depth[i], path[i]);
        td_point_add(image, entries, &wanted[i], &order);
    }
    assert_int_equal(order.count, count);
    td_point_settle(image, entries, &order);
    qsort(wanted, (size_t)count, sizeof *wanted, by_depth);
    for (int i = 0; i < count; i++) {
        const td_point_entry got = td_point_load_entry(image, entries + i * td_point_room(image));
        if (memcmp(&got, &wanted[i], sizeof got) != 0)
            fail_msg("%d of %d: depth %g, path %g, where depth %g, path %g belongs", i, count, got.depth, got.number,
                     wanted[i].depth, wanted[i].number);
    }
    return order;
}

static td_point_order check_order(const double *depth, const int *path, int count) {
    static const td_image linear = {.is_coded = 0}, coded = {.is_coded = 1};
    const td_point_order one = check_order_of(&linear, depth, path, count), other = check_order_of(&coded, depth, path, count);
    assert_true(one.passed == other.passed && one.loose == other.loose);
    return one;
}

/* Paths in any order: those of a list come by depth. */
static void any_paths(uint64_t *state, int *path, int count) {
    for (int i = 0; i < count; i++) path[i] = i;
    for (int i = count - 1; i > 0; i--) {
        const int k = (int)scene_between(state, 0, i + 1), other = path[k];
        path[k] = path[i], path[i] = other;
    }
}

static const int counts[] = {0, 1, 2, 3, 4, 5, 17, 64, 65, 200, 401, MOST};
enum { COUNTS = sizeof counts / sizeof *counts };

/* In their list's order but for neighbours: insertion does. */
static void test_nearly_in_order(void **state) {
    (void)state;
    static double depth[MOST];
    static int path[MOST];
    uint64_t seed = 1700;
    for (int n = 0; n < COUNTS; n++) {
        any_paths(&seed, path, counts[n]);
        for (int i = 0; i < counts[n]; i++) depth[i] = i + scene_between(&seed, 0, 5);
        assert_false(check_order(depth, path, counts[n]).loose);
    }
}

static void test_turned_over(void **state) {
    (void)state;
    static double depth[MOST];
    static int path[MOST];
    uint64_t seed = 1701;
    for (int n = 0; n < COUNTS; n++) {
        any_paths(&seed, path, counts[n]);
        for (int i = 0; i < counts[n]; i++) depth[i] = 3 - 1e-3 * i;
        assert_int_equal(check_order(depth, path, counts[n]).loose, counts[n] > 30);
    }
}

/* Any order, of depths of which many are the same, and of none but one: paths decide. */
static void test_any_order_and_ties(void **state) {
    (void)state;
    static double depth[MOST];
    static int path[MOST];
    uint64_t seed = 1702;
    for (int n = 0; n < COUNTS; n++)
        for (int kinds = 1; kinds <= 1000; kinds *= 10) {
            any_paths(&seed, path, counts[n]);
            for (int i = 0; i < counts[n]; i++) depth[i] = 1 + (int)scene_between(&seed, 0, kinds);
            const int was_sorted = check_order(depth, path, counts[n]).loose;
            if (counts[n] >= 200) assert_true(was_sorted);
        }
}

/* In order, and turned over from some place on: what is in its place stays, and what was added loosely finds its own. */
static void test_out_of_order_late(void **state) {
    (void)state;
    static double depth[MOST];
    static int path[MOST];
    uint64_t seed = 1703;
    any_paths(&seed, path, MOST);
    for (int from = 0; from <= MOST; from += 50) {
        for (int i = 0; i < MOST; i++) depth[i] = i < from ? i : MOST - i - 0.5;
        assert_int_equal(check_order(depth, path, MOST).loose, from < MOST);
    }
}

/* 700 that are put in their places one by one pass 122 000 others in any order, and twice as many turned over. */
static void test_noticed_soon(void **state) {
    (void)state;
    static double depth[MOST];
    static int path[MOST];
    uint64_t seed = 1704;
    for (int turned = 0; turned < 2; turned++) {
        any_paths(&seed, path, MOST);
        for (int i = 0; i < MOST; i++) depth[i] = turned ? -i : scene_between(&seed, 0, 1);
        const td_point_order order = check_order(depth, path, MOST);
        assert_true(order.loose);
        assert_true(order.passed < 1000);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_nearly_in_order), cmocka_unit_test(test_turned_over),
                                       cmocka_unit_test(test_any_order_and_ties), cmocka_unit_test(test_out_of_order_late),
                                       cmocka_unit_test(test_noticed_soon)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
