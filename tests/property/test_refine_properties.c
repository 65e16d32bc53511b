/* Properties of adaptive steps, on random scenes under a moving camera and before a resting one: the comparator's invariant,
 * equal events however a run is cut and on every device, and errors that fall with the tolerance and stay within the reported
 * ones. test_refine_steps.c looks at the steps themselves. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/refine_world.h"
#include "tests/support/opencl.h"

static const uint64_t SEED = 16180;

/* -- invariant, pieces, devices ------------------------------------------------------------------------------------ */

static void test_invariant_in_every_mode(void **state) {
    static const int modes[] = {TIDES_STEPPING_RISK, TIDES_STEPPING_ERROR};
    (void)state;
    for (int trial = 0; trial < 12; trial++) {
        world w = make_world(SEED + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stepping.mode = modes[trial % 2];
        j.stepping.local = trial % 4 != 3;
        j.stepping.min_step_s = 5e-4;
        j.stop = 0.32;
        if (trial >= 6) j.sensor.threshold_off = 0.17; /* every pixel that moves is then estimated */
        outcome o = run(&j);
        assert_true(o.count > 100);
        check_stream(&j, &o);
        check_state(&j, &o);
        assert_true(o.stats.steps_rejected > 0);
        assert_true(o.stats.steps_at_minimum > 0 || o.stats.worst_error <= j.stepping.tolerance);
        assert_true(j.stepping.mode != TIDES_STEPPING_RISK || o.stats.worst_error == 0);
        free_outcome(&o);
        free_world(&w);
    }
}

/* `o` becomes the run on `device`, in calls that end on, between and before grid points. */
static outcome run_in_pieces(const job *j, tides_device *device) {
    static const double shares[] = {0, 0.1, 0.25, 0.26, 0.2, 0.74999, 0.75, 2};
    outcome o = {0};
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &o);
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        tides_error error;
        scene_expect_ok(tides_simulator_run(s, j->start + shares[i] * (j->stop - j->start), collect, &o, NULL, NULL, &error),
                        &error);
    }
    finish(s, &o);
    tides_simulator_destroy(s);
    return o;
}

static void test_pieces_and_devices_change_nothing(void **state) {
    static const int modes[] = {TIDES_STEPPING_ERROR, TIDES_STEPPING_RISK};
    (void)state;
    tides_device *cpu = open_device("cpu");
    for (int trial = 0; trial < 6; trial++) {
        world w = make_world(SEED + 20 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stepping.mode = modes[trial % 2];
        j.stepping.min_step_s = 2e-4;
        outcome whole = run(&j);
        size_t bytes = (size_t)pixels_of(&j) * sizeof(double);
        tides_device *devices[2] = {open_device(j.device), cpu};
        for (int d = 0; d < 2 && devices[d]; d++) {
            outcome pieces = run_in_pieces(&j, devices[d]);
            expect_same(&whole, &pieces, d ? "pieces on the cpu" : "pieces");
            assert_memory_equal(whole.signal, pieces.signal, bytes);
            assert_memory_equal(whole.reference, pieces.reference, bytes);
            assert_true(whole.stats.steps == pieces.stats.steps);
            assert_true(whole.stats.steps_rejected == pieces.stats.steps_rejected);
            free_outcome(&pieces);
        }
        tides_device_close(devices[0]);
        free_outcome(&whole);
        free_world(&w);
    }
    tides_device_close(cpu);
    skip_without_opencl();
}

/* -- steps of each tile and steps of all --------------------------------------------------------------------------- */

static void test_local_steps_cost_less_and_agree(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        world w = make_world(SEED + 30 + (uint64_t)kind, kind);
        job j = job_in(&w);
        outcome local = run(&j);
        j.stepping.local = 0;
        outcome whole = run(&j);
        tides_match m = match(&whole, &local);
        if (!(m.mismatch_percent < 0.3 && m.dt_median_us < 1 && m.dt_p95_us < 20))
            fail_msg("mismatched %g %%, median %g us, p95 %g us", m.mismatch_percent, m.dt_median_us, m.dt_p95_us);
        double share = (double)local.stats.render.tile_jobs / (double)whole.stats.render.tile_jobs;
        assert_true(share < (kind == OBJECT_MOVES ? 0.5 : 1));
        assert_true(whole.stats.tile_steps_still == 0);
        assert_true(whole.stats.steps % (uint64_t)tiles_of(&j) == 0);
        free_outcome(&local);
        free_outcome(&whole);
        free_world(&w);
    }
}

/* -- errors -------------------------------------------------------------------------------------------------------- */

/* The p95 of |dt| [s] against the truth; it must be within what the run reports, which is no worse than it needs to be. */
static double honest_p95(const job *j, const outcome *truth) {
    outcome o = run(j);
    tides_match m = match(truth, &o);
    double p95 = 1e-6 * m.dt_p95_us;
    if (!(p95 <= o.stats.error_p95_s && o.stats.error_p95_s < 100 * p95 && m.dt_median_us < 1e6 * o.stats.error_p50_s))
        fail_msg("tolerance %g, step %g: p95 %g s, reported %g s", j->stepping.tolerance, j->stepping.step_s, p95,
                 o.stats.error_p95_s);
    assert_true(o.stats.error_p50_s <= o.stats.error_p95_s);
    assert_true(o.stats.error_p95_s <= o.stats.error_p99_s);
    assert_true(m.mismatch_percent < 0.3);
    free_outcome(&o);
    return p95;
}

static void test_errors_fall_with_the_tolerance(void **state) {
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        static const double steps[] = {4e-3, 7e-3, 20e-3};
        world w = make_world(SEED + 40 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        outcome truth = truth_of(&j, 2e-4);
        double last = 1;
        for (double tolerance = 0.1; tolerance > 0.0005 && trial < KINDS; tolerance /= 10) {
            j.stepping.tolerance = tolerance;
            double p95 = honest_p95(&j, &truth);
            assert_true(p95 < 0.3 * last);
            last = p95;
        }
        j.stepping.tolerance = 0.01;
        for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
            j.stepping.step_s = steps[k];
            honest_p95(&j, &truth);
        }
        free_outcome(&truth);
        free_world(&w);
    }
}

static void test_a_tolerance_in_time(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        world w = make_world(SEED + 50 + (uint64_t)kind, kind);
        job j = job_in(&w);
        j.stop = 0.32;
        j.device = "reference"; /* below some microseconds the slowest pixels' times are rounding in single precision */
        outcome truth = truth_of(&j, 4e-5);
        j.stepping.tolerance = 1;
        for (double asked = 100e-6; asked > 10e-6; asked /= 8) {
            j.stepping.time_tolerance_s = asked;
            assert_true(honest_p95(&j, &truth) <= asked);
        }
        free_outcome(&truth);
        free_world(&w);
    }
}

/* -- few events a step ------------------------------------------------------------------------------------------------ */

/* However few events a step may have: steps are cut until none has more. */
static void test_no_event_is_cut_off(void **state) {
    static const double offs[] = {0.02, 0.03};
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        world w = make_world(SEED + 60 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stop = 0.32;
        j.sensor.threshold_on = 0.02;
        j.sensor.threshold_off = offs[trial / 2];
        j.stepping.tolerance = 0.5;
        outcome free_run = run(&j);
        assert_int_equal(free_run.stats.events_truncated, 0);
        j.sensor.max_events_per_step = 2;
        outcome capped = run(&j);
        assert_int_equal(capped.stats.events_truncated, 0);
        assert_true(capped.stats.steps_rejected > free_run.stats.steps_rejected);
        check_stream(&j, &capped);
        check_state(&j, &capped);
        j.stepping.mode = TIDES_STEPPING_FIXED; /* what isn't to be cut is cut off */
        outcome fixed = run(&j);
        assert_true(fixed.stats.events_truncated > 0);
        free_outcome(&fixed);
        free_outcome(&capped);
        free_outcome(&free_run);
        free_world(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_invariant_in_every_mode),
                                       cmocka_unit_test(test_pieces_and_devices_change_nothing),
                                       cmocka_unit_test(test_local_steps_cost_less_and_agree),
                                       cmocka_unit_test(test_errors_fall_with_the_tolerance),
                                       cmocka_unit_test(test_a_tolerance_in_time),
                                       cmocka_unit_test(test_no_event_is_cut_off)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
