/* Matching streams: hand-made cases, closed forms, and the banded table against all pairings by brute force. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "metrics/td_align.h"
#include "tides/metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tides_event at(int64_t t, int x, int y, int polarity) {
    return (tides_event){.t = t, .x = (uint16_t)x, .y = (uint16_t)y, .polarity = (int8_t)polarity};
}

/* Events of one pixel and polarity from times [us]. */
static size_t train(const double *times_us, size_t count, tides_event *events) {
    for (size_t i = 0; i < count; i++) events[i] = at((int64_t)(1000 * times_us[i]), 3, 5, 1);
    return count;
}

static tides_match matched(const tides_event *a, size_t count_a, const tides_event *b, size_t count_b, double limit_s) {
    tides_match match;
    tides_error error;
    if (tides_match_events(a, count_a, b, count_b, limit_s, &match, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(match.missing + match.matched, count_a);
    assert_int_equal(match.spurious + match.matched, count_b);
    return match;
}

static void equal_streams(void **state) {
    (void)state;
    tides_event events[] = {at(0, 0, 0, 1), at(5, 1, 0, -1), at(9, 1, 0, -1), at(9, 0, 7, 1)};
    tides_match m = matched(events, 4, events, 4, 1e-3);
    assert_int_equal(m.matched, 4);
    assert_true(m.mismatch_percent == 0);
    assert_true(m.dt_max_us == 0);
    assert_true(m.dt_mean_us == 0);
}

/* dt = 1, 2, ..., 101 us at 101 pixels: percentiles are whole numbers. */
static void percentiles_of_a_ramp(void **state) {
    (void)state;
    tides_event a[101], b[101];
    for (int i = 0; i < 101; i++) {
        a[i] = at(1000000, i, 2, -1);
        b[100 - i] = at(1000000 + (i % 2 ? 1 : -1) * 1000 * (i + 1), i, 2, -1); /* in another order, both signs */
    }
    tides_match m = matched(a, 101, b, 101, 1e-3);
    assert_int_equal(m.matched, 101);
    assert_true(fabs(m.dt_median_us - 51) < 1e-9);
    assert_true(fabs(m.dt_p95_us - 96) < 1e-9);
    assert_true(fabs(m.dt_p99_us - 100) < 1e-9);
    assert_true(fabs(m.dt_max_us - 101) < 1e-9);
    assert_true(fabs(m.dt_mean_us - (50.0 - 101.0) / 101.0) < 1e-9); /* 50 pairs of (-k, k + 1), and -101 */
}

/* Between the ranks: of 1 and 3 us the median is 2, and p95 is 1 + 0.95 x 2. */
static void percentiles_interpolate(void **state) {
    (void)state;
    tides_event a[] = {at(0, 0, 0, 1), at(0, 1, 0, 1)}, b[] = {at(1000, 0, 0, 1), at(-3000, 1, 0, 1)};
    tides_match m = matched(a, 2, b, 2, 1e-3);
    assert_true(fabs(m.dt_median_us - 2) < 1e-12);
    assert_true(fabs(m.dt_p95_us - 2.9) < 1e-12);
}

static void pixels_and_polarities_are_apart(void **state) {
    (void)state;
    tides_event a[] = {at(10, 0, 0, 1)};
    tides_event b[] = {at(10, 0, 0, -1), at(10, 1, 0, 1), at(10, 0, 1, 1)};
    tides_match m = matched(a, 1, b, 3, 1e-3);
    assert_int_equal(m.matched, 0);
    assert_int_equal(m.spurious, 3);
    assert_true(m.mismatch_percent == 400.0);
    assert_true(isnan(m.dt_median_us));
    assert_true(isnan(m.dt_max_us));
}

/* One event too few in the middle: its neighbours keep their partners. */
static void a_missing_event_shifts_nothing(void **state) {
    (void)state;
    const double whole[] = {100, 200, 300, 400, 500, 600}, holed[] = {101, 202, 404, 505, 606};
    tides_event a[6], b[5];
    tides_match m = matched(a, train(whole, 6, a), b, train(holed, 5, b), 1e-3);
    assert_int_equal(m.missing, 1);
    assert_int_equal(m.spurious, 0);
    assert_true(fabs(m.dt_max_us - 6) < 1e-9);
    m = matched(b, 5, a, 6, 1e-3); /* and the other way round one too many */
    assert_int_equal(m.missing, 0);
    assert_int_equal(m.spurious, 1);
    assert_true(fabs(m.dt_max_us - 6) < 1e-9);
    assert_true(fabs(m.mismatch_percent - 20) < 1e-9);
}

/* One lost and another made up elsewhere: counts agree, and still nothing is paired over the distance. */
static void lost_and_spurious_cancel_nowhere(void **state) {
    (void)state;
    const double truth[] = {100, 200, 300, 400, 500}, other[] = {100, 300, 400, 500, 2600};
    tides_event a[5], b[5];
    train(truth, 5, a);
    train(other, 5, b);
    tides_match m = matched(a, 5, b, 5, 1e-3);
    assert_int_equal(m.matched, 4);
    assert_true(m.dt_max_us == 0);
    assert_true(fabs(m.mismatch_percent - 40) < 1e-9);
    m = matched(a, 5, b, 5, 10.0); /* where everything may be paired, all five are */
    assert_int_equal(m.matched, 5);
}

static void the_limit_is_inclusive(void **state) {
    (void)state;
    tides_event a[] = {at(0, 0, 0, 1)}, b[] = {at(1000, 0, 0, 1)};
    assert_int_equal(matched(a, 1, b, 1, 1e-6).matched, 1);
    assert_int_equal(matched(a, 1, b, 1, 0.999e-6).matched, 0);
}

static void empty_streams(void **state) {
    (void)state;
    tides_event one = at(0, 0, 0, 1);
    tides_match m = matched(NULL, 0, NULL, 0, 1e-3);
    assert_true(m.mismatch_percent == 0);
    assert_true(isnan(m.dt_p95_us));
    m = matched(&one, 1, NULL, 0, 1e-3);
    assert_true(m.mismatch_percent == 100);
    m = matched(NULL, 0, &one, 1, 1e-3);
    assert_true(isinf(m.mismatch_percent));
}

/* -- the table against brute force ----------------------------------------------------------------------------------------- */

/* The best sum over all pairings of a[i..] and b[j..]. */
static int64_t best_sum(const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, int64_t limit) {
    if (count_a == 0 || count_b == 0) return 0;
    int64_t gap = a[0] > b[0] ? a[0] - b[0] : b[0] - a[0];
    int64_t skip_a = best_sum(a + 1, count_a - 1, b, count_b, limit), skip_b = best_sum(a, count_a, b + 1, count_b - 1, limit);
    int64_t best = skip_a > skip_b ? skip_a : skip_b;
    if (gap > limit) return best;
    int64_t pair = limit - gap + best_sum(a + 1, count_a - 1, b + 1, count_b - 1, limit);
    return pair > best ? pair : best;
}

static uint32_t next(uint32_t *seed) { return (*seed = *seed * 1664525u + 1013904223u) >> 8; }

static int by_time(const void *left, const void *right) {
    int64_t a = *(const int64_t *)left, b = *(const int64_t *)right;
    return (a > b) - (a < b);
}

static size_t random_times(uint32_t *seed, int64_t *times) {
    size_t count = next(seed) % 8;
    for (size_t i = 0; i < count; i++) times[i] = next(seed) % 100;
    qsort(times, count, sizeof *times, by_time);
    return count;
}

static void table_finds_the_best_pairing(void **state) {
    (void)state;
    uint32_t seed = 7;
    print_message("    seed %u\n", (unsigned)seed);
    td_align align = {.score = NULL};
    for (int trial = 0; trial < 3000; trial++) {
        int64_t a[8], b[8], limit = 1 + next(&seed) % 60, sum = 0;
        size_t count_a = random_times(&seed, a), count_b = random_times(&seed, b);
        align.pairs = 0;
        assert_int_equal(td_align_times(&align, a, count_a, b, count_b, limit, NULL), TIDES_OK);
        for (size_t i = 0; i < align.pairs; i++) {
            assert_true(llabs(align.dt[i]) <= limit);
            sum += limit - llabs(align.dt[i]);
        }
        if (sum != best_sum(a, count_a, b, count_b, limit)) fail_msg("trial %d: not the best pairing", trial);
    }
    td_align_release(&align);
}

/* 200 000 events in one pixel, every 97th lost, all late by 300 ns: exactly that comes out, also where the limit spans far more
 * neighbours than the table is wide. */
static void long_trains_with_holes(void **state) {
    (void)state;
    enum { COUNT = 200000 };
    tides_event *a = calloc(COUNT, sizeof *a), *b = calloc(COUNT, sizeof *b);
    assert_non_null(a);
    assert_non_null(b);
    size_t kept = 0;
    for (int i = 0; i < COUNT; i++) {
        a[i] = at((int64_t)i * 1000, 1, 1, 1);
        if (i % 97 != 50) b[kept++] = at((int64_t)i * 1000 + 300, 1, 1, 1);
    }
    const double limits[] = {500e-9, 20e-6, 1e-3};
    for (size_t k = 0; k < sizeof limits / sizeof limits[0]; k++) {
        tides_match m = matched(a, COUNT, b, kept, limits[k]);
        assert_int_equal(m.missing, COUNT - kept);
        assert_true(fabs(m.dt_median_us - 0.3) < 1e-9);
        if (k == 0) assert_true(fabs(m.dt_max_us - 0.3) < 1e-9);
    }
    free(a);
    free(b);
}

static void nonsense_is_refused(void **state) {
    (void)state;
    tides_error error;
    tides_match match = {.matched = 77};
    tides_event one = at(0, 0, 0, 1), wrong = at(0, 0, 0, 0), far = at(INT64_MIN, 0, 0, 1);
    assert_int_equal(tides_match_events(NULL, 1, &one, 1, 1e-3, &match, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_match_events(&one, 1, &one, 1, 1e-3, NULL, &error), TIDES_BAD_ARGUMENT);
    const double limits[] = {0, -1, 11, NAN};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
        assert_int_equal(tides_match_events(&one, 1, &one, 1, limits[i], &match, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_match_events(&one, 1, &wrong, 1, 1e-3, &match, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "event 0 of the simulated stream has polarity 0"));
    assert_int_equal(tides_match_events(&far, 1, &one, 1, 1e-3, &match, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(match.matched, 77);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_streams),
        cmocka_unit_test(percentiles_of_a_ramp),
        cmocka_unit_test(percentiles_interpolate),
        cmocka_unit_test(pixels_and_polarities_are_apart),
        cmocka_unit_test(a_missing_event_shifts_nothing),
        cmocka_unit_test(lost_and_spurious_cancel_nowhere),
        cmocka_unit_test(the_limit_is_inclusive),
        cmocka_unit_test(empty_streams),
        cmocka_unit_test(table_finds_the_best_pairing),
        cmocka_unit_test(long_trains_with_holes),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests_name("match", tests, NULL, NULL);
}
