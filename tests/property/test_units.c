/* Steps of 4x4 blocks (stepping.unit): events agree with those of steps of whole tiles and with exact ones, for fewer pixels.
 * They are equal however the run is cut, launched and given memory. If pixels have their steps in common the unit changes
 * nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/refine_world.h"
#include "tests/support/opencl.h"

static const uint64_t SEED = 4404;

/* -- what is fired --------------------------------------------------------------------------------------------------------- */

static void expect_near(const outcome *truth, const outcome *o, const char *what) {
    tides_match m = match(truth, o);
    if (!(m.mismatch_percent < 0.3 && m.dt_median_us < 1 && m.dt_p95_us < 20))
        fail_msg("%s: mismatched %g %%, median %g us, p95 %g us", what, m.mismatch_percent, m.dt_median_us, m.dt_p95_us);
}

static void test_fewer_pixels_and_the_same_events(void **state) {
    (void)state;
    print_message("seed %llu\n", (unsigned long long)SEED);
    for (int trial = 0; trial < 6; trial++) {
        world w = make_world(SEED + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        outcome whole = run(&j), truth = truth_of(&j, 5e-5);
        j.stepping.unit = TIDES_UNIT_BLOCK;
        outcome parts = run(&j);
        check_stream(&j, &parts);
        check_state(&j, &parts);
        expect_near(&whole, &parts, "against tiles");
        expect_near(&truth, &parts, "against fine steps");
        assert_true(parts.stats.render.blocks < 9 * whole.stats.render.blocks / 10);
        /* Swaps of depth are cut at where a block sees them: 1.01 to 1.22 times as many jobs, up to 1.05 without any. */
        assert_true(10 * parts.stats.render.tile_jobs <= 13 * whole.stats.render.tile_jobs);
        assert_true(parts.stats.worst_error <= j.stepping.tolerance || parts.stats.steps_at_minimum > 0);
        assert_true(parts.stats.tile_steps_still == whole.stats.tile_steps_still);
        free_outcome(&whole);
        free_outcome(&parts);
        free_outcome(&truth);
        free_world(&w);
    }
}

/* -- the same bits --------------------------------------------------------------------------------------------------------- */

/* Blocks of the sensor that read neighbours in the order of pixels or times; events looked up in the image where they can be.
 */
static void dress(job *j, int trial) {
    j->sensor.threshold_sigma = trial % 2 ? 0.01 : 0;
    j->sensor.refractory_s = trial % 3 ? 0 : 3e-4;
    j->sensor.leak_rate_hz = trial % 3 == 1 ? 4 : 0;
    j->sensor.b_min = trial % 4 == 1 ? 0.2 : 0;
    j->sensor.psf_sigma_px = trial % 4 == 2 ? 0.8 : 0;
    j->sensor.photoreceptor_cutoff_hz = trial % 5 == 3 ? 300 : 0;
    j->sensor.noise_rms = trial % 5 == 4 ? 0.02 : 0;
    j->sensor.seed = SEED;
    const int clear = !(j->sensor.psf_sigma_px > 0 || j->sensor.photoreceptor_cutoff_hz > 0 || j->sensor.noise_rms > 0);
    j->stepping.solve = clear && trial % 2 == 0 ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
}

/* In pieces, with `read_out` through a readout, with launches of few records where `records` isn't 0. */
static outcome run_in(const job *j, tides_device *device, int pieces, int read_out, int records) {
    outcome o = {0};
    tides_error error;
    tides_simulator *s = make_simulator(j, device);
    const tides_readout readout = busy_readout();
    if (read_out) scene_expect_ok(tides_simulator_readout(s, &readout, &error), &error);
    if (records) s->renderer->record_limit = records;
    begin(j, s, &o);
    for (int k = 1; k <= pieces; k++) {
        double until = j->start + (j->stop - j->start) * k / pieces;
        scene_expect_ok(tides_simulator_run(s, k == pieces ? j->stop : until, collect, &o, NULL, NULL, &error), &error);
    }
    finish(s, &o);
    tides_simulator_destroy(s);
    return o;
}

/* Which steps are taken must not depend on what was judged before a checkpoint either. */
static void test_steps_after_a_checkpoint(void **state) {
    enum { PARTS = 5 };
    const char *path = scene_in_folder(*state, "units.checkpoint");
    for (int trial = 0; trial < 4; trial++) {
        world w = make_world(SEED + 60 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.sensor.threshold_sigma = 0.03;
        j.sensor.refractory_s = trial % 2 ? 3e-4 : 0;
        j.sensor.seed = SEED;
        j.stepping.unit = trial < 2 ? TIDES_UNIT_BLOCK : TIDES_UNIT_TILE;
        j.stepping.step_s = (j.stop - j.start) / PARTS;
        tides_device *device = open_device(j.device);
        outcome whole = run_in(&j, device, 1, 0, 0);
        for (int part = 1; part < PARTS; part++) {
            outcome resumed = run_resumed(&j, device, path, j.start + (j.stop - j.start) * part / PARTS);
            expect_same(&whole, &resumed, "resumed");
            assert_int_equal(resumed.stats.steps, whole.stats.steps);
            free_outcome(&resumed);
        }
        free_outcome(&whole);
        tides_device_close(device);
        free_world(&w);
    }
}

static void test_order_of_the_work_changes_nothing(void **state) {
    static const int modes[] = {TIDES_STEPPING_ERROR, TIDES_STEPPING_RISK};
    (void)state;
    tides_device *cpu = open_device("cpu");
    for (int trial = 0; trial < 10; trial++) {
        world w = make_world(SEED + 40 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        dress(&j, trial);
        j.stepping.unit = TIDES_UNIT_BLOCK;
        j.stepping.mode = modes[trial % 2];
        j.stepping.min_step_s = 2e-4;
        tides_device *device = open_device(j.device);
        outcome first = run_in(&j, device, 1, trial % 2, 0);
        j.stepping.memory_mb = 1;
        outcome again = run_in(&j, device, 3, trial % 2, 64);
        expect_same(&first, &again, "in pieces, with little memory");
        assert_true(first.count > 100 && first.stats.steps == again.stats.steps);
        /* with a blur launches share what neighbours ask for */
        assert_true(j.sensor.psf_sigma_px > 0 || first.stats.render.blocks == again.stats.render.blocks);
        assert_true(first.stats.error_p95_s == again.stats.error_p95_s);
        assert_memory_equal(first.signal, again.signal, (size_t)pixels_of(&j) * sizeof *first.signal);
        if (cpu) {
            outcome other = run_in(&j, cpu, 2, trial % 2, 0);
            expect_same(&first, &other, "on the cpu");
            free_outcome(&other);
        }
        free_outcome(&first);
        free_outcome(&again);
        tides_device_close(device);
        free_world(&w);
    }
    tides_device_close(cpu);
    skip_without_opencl();
}

/* -- steps in common ------------------------------------------------------------------------------------------------------- */

static void test_steps_in_common_are_of_tiles(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        world w = make_world(SEED + 60 + (uint64_t)k, k % KINDS);
        job j = job_in(&w);
        if (k == 0) j.stepping.mode = TIDES_STEPPING_FIXED;
        if (k == 1) j.stepping.local = 0;
        if (k == 2) j.sensor.surround_lambda_px = 2, j.sensor.surround_tau_s = 4e-3;
        outcome tiles = run(&j);
        j.stepping.unit = TIDES_UNIT_BLOCK;
        outcome blocks = run(&j);
        expect_same(&tiles, &blocks, "steps in common");
        assert_true(tiles.stats.render.blocks == blocks.stats.render.blocks && tiles.stats.steps == blocks.stats.steps);
        free_outcome(&tiles);
        free_outcome(&blocks);
        free_world(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fewer_pixels_and_the_same_events),
                                       cmocka_unit_test(test_order_of_the_work_changes_nothing),
                                       cmocka_unit_test_setup_teardown(test_steps_after_a_checkpoint, scene_folder_setup,
                                                                       scene_folder_teardown),
                                       cmocka_unit_test(test_steps_in_common_are_of_tiles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
