/* Exact streams converge, and agree with closed forms. With ideal settings methods differ only in how they see the image. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tides.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static tides_run *parse(const char *text, const char *const *sets, size_t count) {
    tides_run *run = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(tides_run_parse(text, "", sets, count, &run, &error), &error);
    return run;
}

static const char base[] = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}}";

/* All that a noisy preset switches on is off, thresholds and logarithm are the run's. */
static void ideal_pixels_have_nothing_else(void **state) {
    (void)state;
    static const char *const methods[] = {"tides", "esim", "v2e", "dvs-voltmeter", "iebcs"};
    const char *const sets[] = {"sensor.preset=davis346",     "sensor.threshold_on=0.3", "sensor.threshold_off=0.1",
                                "frontend.noise_rms=0.1",     "image.log_eps=0.01",      "readout.enabled=true",
                                "frontend.bandwidth=circuit", "v2e.hdr=false",           "iebcs.arbiter=row"};
    tides_run *run = parse(base, sets, sizeof sets / sizeof sets[0]);
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        const char **texts = NULL;
        size_t count = 0;
        tides_error error = {0, ""};
        tides_run *ideal = NULL;
        tides_run_values v;
        scene_expect_ok(tides_ideal_settings(run, methods[i], TIDES_IDEAL_PIXEL, &texts, &count, &error), &error);
        scene_expect_ok(tides_run_vary(run, texts, count, &ideal, &error), &error);
        tides_run_get(ideal, &v);
        assert_string_equal(v.method, methods[i]);
        const tides_baseline_params *b = &v.baseline;
        if (i == 0) {
            tides_sensor plain;
            tides_sensor_defaults(&plain);
            plain.threshold_on = 0.3;
            plain.threshold_off = 0.1;
            plain.noise_cutoff_hz = v.sensor.noise_cutoff_hz; /* of noise that is off, and so on */
            plain.refractory_law = v.sensor.refractory_law;
            plain.leak_sigma = v.sensor.leak_sigma;
            plain.hot_pixel_rate_hz = v.sensor.hot_pixel_rate_hz;
            plain.photoreceptor_law = v.sensor.photoreceptor_law;
            assert_memory_equal(&v.sensor, &plain, sizeof plain);
            assert_int_equal(v.readout.enabled, 0);
        }
        if (i == 1) assert_true(b->esim.contrast_threshold_pos == 0.3 && b->esim.log_eps == 0.01);
        if (i == 1) assert_true(b->esim.contrast_threshold_sigma_pos == 0 && b->esim.contrast_threshold_sigma_neg == 0);
        if (i == 2) assert_true(b->v2e.neg_thres == 0.1 && b->v2e.sigma_thres == 0 && b->v2e.cutoff_hz == 0);
        if (i == 3) assert_true(fabs(b->voltmeter.k1 - 5) < 1e-9 && fabs(b->voltmeter.k2 - 2.55) < 1e-9);
        if (i == 4) assert_true(b->iebcs.scale == 100 && b->iebcs.ref == 1 && b->iebcs.lat == 0);
        if (i == 4) assert_int_equal(b->iebcs.arbiter, TIDES_ARBITER_NONE);
        tides_free(texts);
        tides_run_destroy(ideal);
    }
    tides_run_destroy(run);
}

/* What the relations of measure.h say, and that a run's own keys stay. */
static void a_sensor_in_other_methods_parameters(void **state) {
    (void)state;
    static const char *const sets[] = {"sensor.threshold_on=0.5",
                                       "sensor.threshold_off=0.3",
                                       "sensor.threshold_sigma=0.02",
                                       "sensor.refractory_s=0.001",
                                       "sensor.leak_rate_hz=0.1",
                                       "frontend.shot_noise_hz=4",
                                       "frontend.photoreceptor_cutoff_hz=50",
                                       "image.log_eps=0.05",
                                       "v2e.leak_rate_hz=3"};
    static const char *const methods[] = {"esim", "v2e", "dvs-voltmeter", "iebcs"};
    for (int i = 0; i < 4; i++) {
        tides_run *run = parse(base, sets, 9);
        const char **texts = NULL;
        size_t count = 0;
        tides_error error = {0, ""};
        tides_run_values v;
        scene_expect_ok(tides_ideal_settings(run, methods[i], TIDES_IDEAL_SENSOR, &texts, &count, &error), &error);
        const char *all[40];
        memcpy(all, sets, sizeof sets);
        memcpy(all + 9, texts, count * sizeof *texts);
        tides_run *own = parse(base, all, 9 + count);
        tides_run_get(own, &v);
        const tides_baseline_params *b = &v.baseline;
        if (i == 0) assert_true(b->esim.contrast_threshold_pos == 0.5 && b->esim.contrast_threshold_neg == 0.3);
        if (i == 0) assert_true(b->esim.contrast_threshold_sigma_pos == 0 && b->esim.refractory_period_ns == 1e6);
        if (i == 0) assert_true(b->esim.log_eps == 0.05);
        if (i == 1) assert_true(b->v2e.pos_thres == 0.5 && b->v2e.sigma_thres == 0.02 && fabs(b->v2e.added_dn - 12.75) < 1e-9);
        if (i == 1) assert_true(fabs(b->v2e.cutoff_hz * (255 * 0.23 + 20) / 275 - 50) < 1e-6 && b->v2e.leak_rate_hz == 3);
        if (i == 1) assert_true(b->v2e.shot_noise_rate_hz == 4 && b->v2e.refractory_period == 1e-3);
        if (i == 2) assert_true(b->voltmeter.k1 == 2.5 && b->voltmeter.k2 == 12.75 && fabs(b->voltmeter.k4 - 1e-7) < 1e-15);
        if (i == 2) assert_true(b->voltmeter.k3 == 0 && b->voltmeter.k5 == 0 && fabs(b->voltmeter.k6 - 2e-3) < 1e-12);
        if (i == 3) assert_true(b->iebcs.th_pos == 0.5 && b->iebcs.scale == 20 && b->iebcs.ref == 1000 && b->iebcs.lat == 0);
        /* 1 / (2 pi 50 Hz) at Y = 0.18, in us, where its constant is tau at 1 klux */
        if (i == 3) assert_true(fabs(1e3 * b->iebcs.tau / (20 * 0.18 + 1) - 1e6 / (6.283185307179586 * 50)) < 1e-4);
        if (i == 3) assert_true(fabs(b->iebcs.bgnp - 2.1) < 1e-9 && b->iebcs.bgnn == 2);
        tides_free(texts);
        tides_run_destroy(own);
        tides_run_destroy(run);
    }
}

static size_t thresholds_of(const char *const *sets, size_t count, const char *method) {
    tides_run *run = parse(base, sets, count);
    const char **texts = NULL;
    size_t number = 0;
    tides_error error = {0, ""};
    scene_expect_ok(tides_ideal_settings(run, method, TIDES_IDEAL_THRESHOLDS, &texts, &number, &error), &error);
    tides_free(texts);
    tides_run_destroy(run);
    return number;
}

static void thresholds_are_the_runs_unless_it_gives_the_methods(void **state) {
    (void)state;
    const char *const own[] = {"v2e.pos_thres=0.4"};
    assert_int_equal(thresholds_of(NULL, 0, "v2e"), 3);
    assert_int_equal(thresholds_of(own, 1, "v2e"), 1);
    assert_int_equal(thresholds_of(own, 1, "esim"), 3);
    assert_int_equal(thresholds_of(NULL, 0, "tides"), 1);
    tides_run *run = parse(base, NULL, 0);
    const char **texts = NULL;
    size_t count = 0;
    tides_error error = {0, ""};
    scene_expect_error(tides_ideal_settings(run, "vt2e", TIDES_IDEAL_PIXEL, &texts, &count, &error), TIDES_BAD_ARGUMENT, &error,
                       "vt2e|v2e|iebcs");
    assert_int_equal(tides_ideal_settings(NULL, "v2e", 1, &texts, &count, NULL), TIDES_BAD_ARGUMENT);
    tides_run_destroy(run);
}

/* A random scene: levels agree ever better, and another first level ends at the same events. */
static void levels_settle(void **state) {
    (void)state;
    random_recipe recipe = random_recipe_defaults(11);
    recipe.count = 12;
    recipe.width = 16;
    recipe.height = 12;
    random_scene s = random_scene_make(&recipe);
    tides_device *device = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    tides_image_params image;
    tides_sensor sensor;
    tides_exact_options how;
    tides_exact exact, other;
    tides_match match;
    tides_image_params_defaults(&image);
    tides_sensor_defaults(&sensor);
    tides_exact_options_defaults(&how);
    sensor.threshold_on = sensor.threshold_off = 0.05;
    assert_int_equal(tides_image_is_continuous(&image), 1);
    how.last_tolerance = 1e-7;
    scene_expect_ok(tides_exact_stream(device, s.scene, s.path, &s.camera, &image, &sensor, 0, 0.05, &how, NULL, NULL, &exact,
                                       &error),
                    &error);
    assert_true(exact.count > 20 && exact.tolerance > 0 && exact.worst_residual < 1 && exact.renders > 0);
    assert_true(exact.moved.mismatch_percent <= 0 && exact.moved.dt_p99_us <= 0.1);
    how.first_step_s = 0.0017;
    scene_expect_ok(tides_exact_stream(device, s.scene, s.path, &s.camera, &image, &sensor, 0, 0.05, &how, NULL, NULL, &other,
                                       &error),
                    &error);
    scene_expect_ok(tides_match_events(exact.events, exact.count, other.events, other.count, TIDES_MATCH_LIMIT_S, &match,
                                       &error),
                    &error);
    assert_true(match.mismatch_percent <= 0);
    assert_true(match.dt_p99_us <= 0.1);
    tides_free(other.events);
    tides_free(exact.events);
    image.rules = TIDES_RULES_INRIA; /* jumps: equal steps, as many as are asked for */
    how = (tides_exact_options){.size = sizeof how, .first_rate = 500, .least_rate = 1000, .last_rate = 1000};
    assert_int_equal(tides_image_is_continuous(&image), 0);
    scene_expect_ok(tides_exact_stream(device, s.scene, s.path, &s.camera, &image, &sensor, 0, 0.05, &how, NULL, NULL, &exact,
                                       &error),
                    &error);
    assert_true(exact.tolerance <= 0 && fabs(exact.steps_per_s - 1000) < 1e-6);
    tides_free(exact.events);
    how.last_rate = NAN;
    scene_expect_error(tides_exact_stream(device, s.scene, s.path, &s.camera, &image, &sensor, 0, 0.05, &how, NULL, NULL,
                                          &exact, &error),
                       TIDES_BAD_ARGUMENT, &error, "last_rate");
    assert_int_equal(tides_exact_stream(device, s.scene, s.path, &s.camera, &image, &sensor, 1, 1, NULL, NULL, NULL, &exact,
                                        NULL),
                     TIDES_BAD_ARGUMENT);
    tides_device_close(device);
    random_scene_free(&s);
}

/* One pixel whose logarithm goes up in a straight line: crossings are where a ruler puts them. */
static void frames_are_straight_lines(void **state) {
    void *folder = *state;
    tides_error error = {0, ""};
    tides_session *session = NULL;
    tides_run *run = NULL;
    tides_exact exact;
    const double first = 0.1, last = first * exp(1.0), Y[2] = {first, last};
    char npy[128 + sizeof Y] = "\x93NUMPY\x01";
    const char header[] = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1, 1), }";
    npy[8] = 118; /* ten bytes of preamble and 118 of header */
    memset(npy + 10, ' ', 118);
    memcpy(npy + 10, header, sizeof header - 1);
    npy[127] = '\n';
    memcpy(npy + 128, Y, sizeof Y);
    scene_file_write(scene_in_folder(folder, "ramp.npy"), npy, sizeof npy);
    const char *text = "{\"frames\": {\"file\": \"ramp.npy\", \"frames_per_second\": 10}, \"image\": {\"log_eps\": 1e-9},"
                       "\"sensor\": {\"threshold_on\": 0.25, \"refractory_s\": 0.05}, \"method\": \"v2e\"}";
    scene_expect_ok(tides_run_parse(text, folder, NULL, 0, &run, &error), &error);
    scene_expect_ok(tides_session_open(run, NULL, &session, &error), &error);
    scene_expect_ok(tides_session_exact(session, NULL, NULL, NULL, &exact, &error), &error);
    assert_true(exact.count >= 3 && exact.count <= 4 && exact.steps_per_s <= 0);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(exact.events[i].polarity, 1);
        assert_true(fabs((double)exact.events[i].t - 0.025e9 * (double)(i + 1)) <= 2);
    }
    tides_free(exact.events);
    tides_session_close(session);
    tides_run_destroy(run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ideal_pixels_have_nothing_else),
        cmocka_unit_test(thresholds_are_the_runs_unless_it_gives_the_methods),
        cmocka_unit_test(a_sensor_in_other_methods_parameters),
        cmocka_unit_test(levels_settle),
        cmocka_unit_test_setup_teardown(frames_are_straight_lines, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("measure", tests, NULL, NULL);
}
