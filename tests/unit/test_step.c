/* Time steps: grids that stay exact over long runs, times before zero, and invalid steps. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "signal/td_step.h"

#include <math.h>

static td_step step_between(double start, double stop) {
    td_step step;
    assert_int_equal(td_step_between(start, stop, &step, NULL), TIDES_OK);
    return step;
}

static void whole_nanoseconds_are_whole(void **state) {
    (void)state;
    for (int k = 0; k < 1000000; k += 7) { /* a millisecond grid over 1000 s */
        td_step step = step_between(k * 1e-3, (k + 1) * 1e-3);
        assert_int_equal(step.start_ns, (int64_t)k * 1000000);
        assert_int_equal(step.stop_ns, (int64_t)(k + 1) * 1000000);
        assert_true(step.start_fraction == 0.0);
        assert_true(step.length_ns == 1e6);
    }
}

static void steps_join_and_cover(void **state) {
    (void)state;
    static const double grids[] = {1e-3 / 3.0, 1.0 / 30.0, 1e-9 * 3.14159, 0.7, 123.456};
    static const double starts[] = {0.0, -5.0, 1000.0, 0.1};
    for (size_t g = 0; g < sizeof grids / sizeof *grids; g++) {
        for (size_t s = 0; s < sizeof starts / sizeof *starts; s++) {
            td_step before = step_between(starts[s], starts[s] + grids[g]);
            for (int k = 1; k < 1000; k++) {
                td_step step = step_between(starts[s] + k * grids[g], starts[s] + (k + 1) * grids[g]);
                assert_true(step.start_ns == before.stop_ns);
                assert_true(step.start_fraction >= 0.0);
                assert_true(step.start_fraction < 1.0);
                assert_true(td_step_time(&step, 0.0) == step.start_ns);
                assert_true(td_step_time(&step, 1.0) == step.stop_ns);
                assert_true(td_step_time(&step, 1.0 - 1e-16) <= step.stop_ns);
                /* At 1000 s a double is 1.1e-13 s wide; each end is taken to within two of these. */
                assert_true(fabs(step.length_s - grids[g]) <= 1.2e-15 * (fabs(starts[s]) + 1e3 * grids[g]));
                before = step;
            }
        }
    }
}

static void times_before_zero_are_floored(void **state) {
    (void)state;
    td_step step = step_between(-1.5e-9, 1.5e-9);
    assert_int_equal(step.start_ns, -2);
    assert_int_equal(step.stop_ns, 1);
    assert_true(fabs(step.start_fraction - 0.5) < 1e-12);
    assert_int_equal(td_step_time(&step, 0.1), -2);
    assert_int_equal(td_step_time(&step, 0.4), -1);
    assert_int_equal(td_step_time(&step, 0.6), 0);
}

static void impossible_steps_are_refused(void **state) {
    (void)state;
    static const double pairs[][2] = {{1.0, 1.0},      {1.0, 0.5},   {NAN, 1.0}, {0.0, NAN},
                                      {0.0, INFINITY}, {-1e10, 0.0}, {0.0, 1e10}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        td_step step = {.start_ns = 77};
        tides_error error;
        assert_int_equal(td_step_between(pairs[i][0], pairs[i][1], &step, &error), TIDES_OUT_OF_RANGE);
        assert_int_equal(error.status, TIDES_OUT_OF_RANGE);
        assert_int_equal(step.start_ns, 77);
    }
}

/* A thousand seconds in, a ten-thousandth of a nanosecond still tells two times apart. */
static void late_times_are_as_fine_as_early_ones(void **state) {
    (void)state;
    for (int k = 0; k < 1000; k++) {
        td_step step = step_between(1000.0 + k * 1e-3, 1000.0 + (k + 1) * 1e-3);
        assert_int_equal(td_step_time(&step, (0.5 + 123456.0 + 1e-3) / 1e6), 1000000000000 + k * 1000000LL + 123456);
        assert_int_equal(td_step_time(&step, (123456.0 - 2e-3) / 1e6), 1000000000000 + k * 1000000LL + 123455);
        assert_int_equal(td_step_time(&step, (123456.0 + 2e-3) / 1e6), 1000000000000 + k * 1000000LL + 123456);
    }
}

/* Seconds to the nearest nanosecond of the double's own value, which 1e9 times it isn't from 1e7 s on. */
static void starts_become_the_nearest_nanosecond(void **state) {
    (void)state;
    assert_true(td_time_ns(0) == 0);
    assert_true(td_time_ns(0.1) == 100000000);
    assert_true(td_time_ns(1.001) == 1001000000);
    assert_true(td_time_ns(-5) == -INT64_C(5000000000));
    assert_true(td_time_ns(-0.25e-9) == 0);
    assert_true(td_time_ns(0.75e-9) == 1);
    for (int64_t k = 0; k < 4194304; k += 4097) {            /* multiples of 2^-22: what doubles at 2e9 s are */
        int64_t rest = (k * 1000000000 + 2097152) / 4194304; /* half is rounded up, which no k is */
        assert_true(td_time_ns(2e9 + (double)k / 4194304) == INT64_C(2000000000) * 1000000000 + rest);
        assert_true(td_time_ns(1305031102 + (double)k / 4194304) == INT64_C(1305031102) * 1000000000 + rest);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_nanoseconds_are_whole),          cmocka_unit_test(steps_join_and_cover),
        cmocka_unit_test(times_before_zero_are_floored),        cmocka_unit_test(impossible_steps_are_refused),
        cmocka_unit_test(late_times_are_as_fine_as_early_ones), cmocka_unit_test(starts_become_the_nearest_nanosecond),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
