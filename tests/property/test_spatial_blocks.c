/* Runs with the PSF, the centre-surround and additive noise: the comparator's invariant, equal events however the run is cut
 * and batched, and convergence with finer steps. On random scenes that move fast. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"

static const uint64_t SEED = 6100;

enum { PSF_LOG, PSF_LINEAR, SURROUND, SURROUND_NOW, BOTH, NOISE, ALL, BLOCKS };
static const char *const block_names[BLOCKS] = {"psf, log", "psf, linear", "surround", "surround without delay",
                                                "both",     "noise",       "all"};

static void set_blocks(tides_sensor *sensor, int blocks) {
    if (blocks == PSF_LOG || blocks == PSF_LINEAR || blocks == BOTH || blocks == ALL) {
        sensor->psf_sigma_px = 1.3;
        sensor->psf_domain = blocks == PSF_LINEAR ? TIDES_PSF_LINEAR : TIDES_PSF_LOG;
    }
    if (blocks == SURROUND || blocks == BOTH || blocks == ALL) sensor->surround_tau_s = 2e-3;
    if (blocks == SURROUND || blocks == SURROUND_NOW || blocks == BOTH || blocks == ALL) sensor->surround_lambda_px = 3;
    if (blocks == ALL) sensor->photoreceptor_cutoff_hz = 400;
    if (blocks != NOISE && blocks != ALL) return;
    sensor->noise_rms = 0.03;
    sensor->noise_cutoff_hz = 150;
}

/* Blocks by fixed and by adaptive steps. */
static job job_with(const random_scene *scene, int blocks, int adaptive) {
    job j = adaptive ? adaptive_job_of(scene, 1) : job_of(scene);
    set_blocks(&j.sensor, blocks);
    return j;
}

static void test_invariants(void **state) {
    (void)state;
    for (int blocks = 0; blocks < BLOCKS; blocks++)
        for (int adaptive = 0; adaptive < 2; adaptive++) {
            random_scene scene = make_scene(SEED + (uint64_t)blocks);
            job j = job_with(&scene, blocks, adaptive);
            outcome o = run(&j);
            print_message("%s, %s steps: %zu events\n", block_names[blocks], adaptive ? "adaptive" : "fixed", o.count);
            assert_true(o.count > 300);
            check_stream(&j, &o);
            check_state(&j, &o);
            free_outcome(&o);
            random_scene_free(&scene);
        }
}

/* Launches of one step and of many, a run in pieces, and one that is saved and goes on in another simulator. */
static void test_cuts(void **state) {
    tides_error error;
    static const int blocks[] = {PSF_LINEAR, SURROUND, NOISE, ALL};
    for (int n = 0; n < 8; n++) {
        random_scene scene = make_scene(SEED + 20);
        job j = job_with(&scene, blocks[n / 2], n % 2);
        outcome whole = run(&j), parts = {0};
        if (n % 2 == 0) {
            job long_batches = j;
            long_batches.batch = 7;
            outcome other = run(&long_batches);
            expect_same(&whole, &other, "batches");
            free_outcome(&other);
        }
        tides_device *device = open_device(j.device);
        tides_simulator *first = make_simulator(&j, device), *second = make_simulator(&j, device);
        const char *path = scene_in_folder(*state, "state.h5");
        begin(&j, first, &parts);
        scene_expect_ok(tides_simulator_run(first, 0.222, collect, &parts, NULL, NULL, &error), &error);
        scene_expect_ok(tides_simulator_save(first, NULL, path, &error), &error);
        scene_expect_ok(tides_simulator_restore(second, NULL, path, &error), &error);
        scene_expect_ok(tides_simulator_run(second, j.stop, collect, &parts, NULL, NULL, &error), &error);
        finish(second, &parts);
        expect_same(&whole, &parts, "cut in two");
        check_state(&j, &parts);
        tides_simulator_destroy(first);
        tides_simulator_destroy(second);
        tides_device_close(device);
        free_outcome(&whole);
        free_outcome(&parts);
        random_scene_free(&scene);
    }
}

static double tiles_of(const job *j) { return ((j->camera.width + 15) / 16) * (double)((j->camera.height + 15) / 16); }

/* Mean distance of the k-th events of each pixel and polarity, where both runs have as many of them. */
static double distance(const job *j, const outcome *a, const outcome *b, double *matched) {
    double sum = 0, count = 0;
    for (int polarity = -1; polarity <= 1; polarity += 2)
        for (int pixel = 0; pixel < pixels_of(j); pixel++) {
            size_t k = 0;
            const uint32_t *counts[] = {polarity > 0 ? a->count_on : a->count_off, polarity > 0 ? b->count_on : b->count_off};
            if (counts[0][pixel] != counts[1][pixel]) continue;
            for (size_t i = 0; i < a->count; i++) {
                const tides_event *e = &a->events[i];
                if (e->polarity != polarity || e->y * j->camera.width + e->x != pixel) continue;
                while (b->events[k].polarity != polarity || b->events[k].y * j->camera.width + b->events[k].x != pixel) k++;
                sum += fabs((double)(e->t - b->events[k++].t));
                count++;
            }
        }
    *matched = count / (double)a->count;
    return sum / count;
}

/* A tolerance ten times finer moves events by less and less. Through a surround tiles that are good enough follow where others
 * are cut, without being rendered. */
static void test_steps(void **state) {
    (void)state;
    for (int blocks = 0; blocks < BLOCKS; blocks++) {
        random_recipe recipe = random_recipe_defaults(SEED + 40);
        recipe.sh_degree = 0;
        recipe.width = 21;
        recipe.height = 19;
        recipe.size = 0.2;
        recipe.camera_speed = 2;
        random_scene scene = random_scene_make(&recipe);
        job j = job_with(&scene, blocks, 1), fine = j, truth = j;
        j.device = fine.device = truth.device = "reference";
        j.stepping.min_step_s = fine.stepping.min_step_s = truth.stepping.min_step_s = 1e-6;
        j.stepping.tolerance = 1e-2;
        fine.stepping.tolerance = 1e-3;
        truth.stepping.tolerance = 3e-5;
        outcome a = run(&j), b = run(&fine), c = run(&truth);
        double matched[2], coarse = distance(&j, &a, &c, &matched[0]), finer = distance(&j, &b, &c, &matched[1]);
        print_message("%s: %zu events; off by %.0f and %.0f ns on average; %.1f and %.1f %% matched\n", block_names[blocks],
                      c.count, coarse, finer, 100 * matched[0], 100 * matched[1]);
        if (blocks == SURROUND) assert_true(a.stats.renders_full_frame_equivalent < 0.9 * (double)a.stats.steps / tiles_of(&j));
        assert_true(coarse < 20e3);
        assert_true(finer < 2e3);
        assert_true(matched[0] > 0.97);
        assert_true(matched[1] > 0.99);
        free_outcome(&a);
        free_outcome(&b);
        free_outcome(&c);
        random_scene_free(&scene);
    }
}

/* A scene at rest: noise alone fires, in tiles that are never rendered again, and steps of any length give the same events, but
 * for what times lose when they are rounded to nanoseconds. */
static void test_noise_at_rest(void **state) {
    (void)state;
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    static const double step_s[] = {2e-3, 7e-3, 1};
    random_recipe recipe = random_recipe_defaults(SEED);
    random_scene scene = random_scene_make(&recipe);
    tides_trajectory *still = NULL;
    outcome first = {0};
    assert_int_equal(tides_trajectory_create_static(position, quaternion, &still, NULL), TIDES_OK);
    for (int n = 0; n < 6; n++) {
        job j = job_with(&scene, NOISE, n / 3);
        j.path = still;
        j.sensor.noise_rms = 0.08;
        j.sensor.max_events_per_step = 1000; /* a step of the whole run holds hundreds of some pixels */
        j.stepping.step_s = step_s[n % 3];
        outcome o = run(&j);
        check_stream(&j, &o);
        check_state(&j, &o);
        if (n == 0) first = o;
        assert_true(o.count > 10000);
        assert_true(o.count == first.count);
        assert_true(o.stats.renders_full_frame_equivalent <= 1);
        for (size_t k = 0; k < o.count; k++) assert_true(llabs(o.events[k].t - first.events[k].t) <= 2);
        if (n > 0) free_outcome(&o);
    }
    print_message("noise at rest: %zu events\n", first.count);
    free_outcome(&first);
    tides_trajectory_destroy(still);
    random_scene_free(&scene);
}

/* What can't be kept is refused. */
static void test_refused(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED);
    tides_device *device = open_device("reference-f32");
    tides_image_params params;
    tides_simulator *s = NULL;
    tides_error error;
    tides_image_params_defaults(&params);
    job wide = job_with(&scene, PSF_LOG, 1);
    wide.sensor.psf_sigma_px = INFINITY;
    assert_int_equal(tides_simulator_create(device, wide.scene, wide.path, &wide.camera, &params, &wide.sensor, &wide.stepping,
                                            0.2, 0.3, NULL, NULL, &s, &error),
                     TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "psf_sigma_px"));
    assert_null(s);
    tides_device_close(device);
    random_scene_free(&scene);
}

int main(void) {
    print_message("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_invariants),
        cmocka_unit_test_setup_teardown(test_cuts, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_noise_at_rest),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
