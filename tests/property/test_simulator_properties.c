/* Properties of any run: the comparator's invariant, counts, a sorted stream. Only the scene, the camera and the step decide
 * the events: not batches, nor how a run is cut into calls, stopped and resumed. On random scenes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tests/support/opencl.h"

static const uint64_t SEED = 90210;

/* -- properties ---------------------------------------------------------------------------------------------------- */

static void test_invariant_and_stream(void **state) {
    static const int32_t models[] = {TIDES_MODEL_LINEAR, TIDES_MODEL_QUADRATIC, TIDES_MODEL_HERMITE, TIDES_MODEL_SECANT};
    (void)state;
    for (uint64_t trial = 0; trial < 8; trial++) {
        random_scene scene = make_scene(SEED + trial);
        job j = job_of(&scene);
        j.stepping.model = models[trial % 4];
        j.stepping.step_s = trial < 4 ? 2e-3 : 20e-3;
        j.sensor.max_events_per_step = trial < 6 ? 64 : 1;
        outcome o = run(&j);
        assert_true(o.count > 1000);
        check_stream(&j, &o);
        check_state(&j, &o);
        assert_true(o.stats.steps + o.stats.tile_steps_still == (trial < 4 ? 40u : 4u) * 9u); /* of 3 x 3 tiles */
        assert_true((o.stats.events_truncated > 0) == (trial >= 6));
        free_outcome(&o);
        random_scene_free(&scene);
    }
}

static void test_invariant_and_stream_of_adaptive_steps(void **state) {
    (void)state;
    for (int local = 0; local < 2; local++) {
        random_scene scene = make_scene(SEED + 10);
        job j = adaptive_job_of(&scene, local);
        if (local) j.sensor.threshold_off = j.sensor.threshold_on; /* where tiles may leave out what can't fire */
        outcome o = run(&j);
        assert_true(o.count > 1000);
        check_stream(&j, &o);
        check_state(&j, &o);
        assert_true(o.stats.steps_rejected > 0);
        assert_true(o.stats.steps > 4 * 9);
        assert_true(o.stats.steps_at_minimum > 0 || o.stats.worst_error <= j.stepping.tolerance);
        free_outcome(&o);
        random_scene_free(&scene);
    }
}

/* Slopes by difference: each pixel's is that of the line over its last step; straight lines don't care; the invariant holds. */
static void test_slopes_by_difference(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 15);
    job j = job_of(&scene);
    j.stepping.model = TIDES_MODEL_SECANT;
    outcome lines = run(&j);
    j.stepping.slope = TIDES_SLOPE_DIFFERENCE;
    outcome same = run(&j);
    expect_same(&lines, &same, "straight lines");
    j.stepping.model = TIDES_MODEL_HERMITE;
    tides_device *device = open_device(j.device);
    tides_simulator *s = make_simulator(&j, device);
    outcome o = {0};
    tides_error error;
    double before[43 * 37];
    const double last = s->epoch + td_grid_time(s, s->grid.steps - 1);
    begin(&j, s, &o);
    scene_expect_ok(tides_simulator_run(s, last, collect, &o, NULL, NULL, &error), &error);
    memcpy(before, s->now.plane[TD_PLANE_S], sizeof before);
    scene_expect_ok(tides_simulator_run(s, j.stop, collect, &o, NULL, NULL, &error), &error);
    for (int i = 0; i < pixels_of(&j); i++) {
        double slope = (s->now.plane[TD_PLANE_S][i] - before[i]) / (j.stop - last);
        assert_true(fabs(s->now.plane[TD_PLANE_S_DOT][i] - slope) <= 1e-9 * (1 + fabs(slope)));
    }
    finish(s, &o);
    check_stream(&j, &o);
    check_state(&j, &o);
    assert_true(o.count != lines.count || memcmp(o.events, lines.events, o.count * sizeof *o.events) != 0);
    tides_simulator_destroy(s);
    tides_device_close(device);
    free_outcome(&o);
    free_outcome(&same);
    free_outcome(&lines);
    random_scene_free(&scene);
}

/* Several calls, some of them for times between grid points, past or behind. */
static void check_pieces(const job *j) {
    static const double untils[] = {0.2, 0.2001, 0.202, 0.2219999, 0.222, 0.222, 0.21, 0.25, 0.2799, 1};
    outcome whole = run(j), pieces = {0};
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &pieces);
    for (size_t i = 0; i < sizeof untils / sizeof *untils; i++) {
        tides_error error;
        size_t before = pieces.count;
        scene_expect_ok(tides_simulator_run(s, untils[i], collect, &pieces, NULL, NULL, &error), &error);
        for (size_t k = before; k < pieces.count; k++) assert_true((double)pieces.events[k].t <= untils[i] * 1e9);
    }
    finish(s, &pieces);
    expect_same(&whole, &pieces, "pieces");
    check_stream(j, &pieces);
    check_state(j, &pieces);
    tides_simulator_destroy(s);
    tides_device_close(device);
    free_outcome(&whole);
    free_outcome(&pieces);
}

static void test_pieces_equal_the_whole(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 20);
    job fixed = job_of(&scene), adaptive = adaptive_job_of(&scene, 1);
    check_pieces(&fixed);
    check_pieces(&adaptive);
    random_scene_free(&scene);
}

static void test_batches_and_repeats_change_nothing(void **state) {
    static const int batches[] = {0, 1, 3, 16};
    static const char *const devices[] = {"reference-f32", "cpu"};
    (void)state;
    random_scene scene = make_scene(SEED + 30);
    job j = job_of(&scene);
    outcome first = run(&j);
    for (size_t d = 0; d < 2; d++) {
        tides_device *device = open_device(devices[d]);
        for (size_t i = 0; i < sizeof batches / sizeof *batches && device; i++) {
            char what[64];
            snprintf(what, sizeof what, "%s, batches of %d", devices[d], batches[i]);
            j.batch = batches[i];
            outcome o = run_on(&j, device);
            expect_same(&first, &o, what);
            free_outcome(&o);
        }
        tides_device_close(device);
    }
    free_outcome(&first);
    random_scene_free(&scene);
    skip_without_opencl();
}

/* A camera at rest before an object that moves in the middle of the image: tiles that see nothing move may be left out. */
static void test_still_tiles_change_nothing(void **state) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    (void)state;
    random_recipe recipe = random_recipe_defaults(SEED + 80);
    recipe.objects = 2;
    recipe.spread = 0.5;
    recipe.width = 90;
    recipe.height = 70;
    random_scene scene = random_scene_make(&recipe);
    tides_trajectory *still = NULL;
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &still, NULL), NULL);
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        job j = adaptive ? adaptive_job_of(&scene, 1) : job_of(&scene);
        j.path = still;
        j.stepping.tolerance = 1e9; /* no step is halved: only the tiles differ */
        outcome local = run(&j);
        j.stepping.local = 0;
        outcome whole = run(&j);
        expect_same(&local, &whole, "with and without still tiles");
        assert_memory_equal(local.signal, whole.signal, (size_t)pixels_of(&j) * sizeof(double));
        assert_true(local.count > 100);
        assert_true(local.stats.tile_steps_still > 0);
        assert_true(whole.stats.tile_steps_still == 0);
        check_stream(&j, &local);
        check_state(&j, &local);
        free_outcome(&local);
        free_outcome(&whole);
    }
    tides_trajectory_destroy(still);
    random_scene_free(&scene);
}

static void test_nothing_moves_no_event(void **state) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    (void)state;
    random_recipe recipe = random_recipe_defaults(SEED);
    random_scene scene = random_scene_make(&recipe);
    job j = job_of(&scene);
    tides_trajectory *still = NULL;
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &still, NULL), NULL);
    j.path = still;
    j.sensor.threshold_on = j.sensor.threshold_off = 1e-9;
    outcome o = run(&j);
    assert_int_equal(o.count, 0);
    assert_memory_equal(o.initial, o.signal, (size_t)pixels_of(&j) * sizeof(double));
    free_outcome(&o);
    tides_trajectory_destroy(still);
    random_scene_free(&scene);
}

/* -- stopping ------------------------------------------------------------------------------------------------------ */

/* Returns how often the run was stopped. */
static int check_stopping_sink(const job *j) {
    outcome whole = run(j), stopped = {0};
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    tides_status status = TIDES_CANCELLED;
    int stops = -1;
    begin(j, s, &stopped);
    for (int i = 0; status == TIDES_CANCELLED && i < 100; i++, stops++) {
        tides_error error;
        stopped.stop_at_call = stopped.calls + 1 + i % 3; /* now after one packet, now after three */
        status = tides_simulator_run(s, j->stop, collect, &stopped, NULL, NULL, &error);
        if (status == TIDES_CANCELLED) scene_expect_error(status, TIDES_CANCELLED, &error, "event sink");
    }
    assert_int_equal(status, TIDES_OK);
    finish(s, &stopped);
    expect_same(&whole, &stopped, "stopped by the sink");
    check_stream(j, &stopped);
    check_state(j, &stopped);
    tides_simulator_destroy(s);
    tides_device_close(device);
    free_outcome(&whole);
    free_outcome(&stopped);
    return stops;
}

static void test_stopping_sink_loses_nothing(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 40);
    job fixed = job_of(&scene), adaptive = adaptive_job_of(&scene, 1);
    fixed.batch = 3;
    job crowded = fixed; /* with packets within a launch */
    crowded.batch = 8;
    crowded.sensor.threshold_on = crowded.sensor.threshold_off = 2e-4;
    crowded.sensor.max_events_per_step = 100000;
    adaptive.stepping.step_s = 5e-3;
    assert_true(check_stopping_sink(&fixed) > 3);
    assert_true(check_stopping_sink(&adaptive) > 3);
    assert_true(check_stopping_sink(&crowded) > 9); /* of five launches */
    random_scene_free(&scene);
}

/* Checks what a progress gets, and stops. */
static int stop_always(void *user, double fraction, const char *stage) {
    double *last = user;
    assert_true(fraction > *last);
    assert_true(fraction <= 1);
    assert_string_equal(stage, "simulating");
    *last = fraction;
    return 1;
}

static void test_stopping_progress_loses_nothing(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 50);
    job j = job_of(&scene);
    outcome whole = run(&j), stopped = {0};
    tides_device *device = open_device(j.device);
    tides_simulator *s = make_simulator(&j, device);
    double last = 0;
    int stops = 0;
    begin(&j, s, &stopped);
    while (last < 1) {
        tides_error error;
        scene_expect_error(tides_simulator_run(s, j.stop, collect, &stopped, stop_always, &last, &error), TIDES_CANCELLED,
                           &error, "request");
        stops++;
    }
    assert_true(stops > 2);
    assert_int_equal(tides_simulator_run(s, j.stop, collect, &stopped, stop_always, &last, NULL),
                     TIDES_OK); /* nothing left to stop */
    expect_same(&whole, &stopped, "stopped by the progress");
    tides_simulator_destroy(s);
    tides_device_close(device);
    free_outcome(&whole);
    free_outcome(&stopped);
    random_scene_free(&scene);
}

/* Stops at its `left`-th question; shares grow from one to the next. */
typedef struct countdown {
    int left;
    double last;
} countdown;

static int stop_in_time(void *user, double fraction, const char *stage) {
    countdown *c = user;
    assert_string_equal(stage, "simulating");
    assert_true(fraction >= c->last && fraction <= 1);
    c->last = fraction;
    return --c->left == 0;
}

/* A macro step of a large scene takes seconds: progress is asked within it, and a step that it stops is undone, so that the run
 * goes on as if nothing had been. */
static void test_stopping_within_a_step_loses_nothing(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 60);
    job j = adaptive_job_of(&scene, 1);
    j.stepping.step_s = 2 * (j.stop - j.start); /* one step */
    outcome whole = run(&j);
    tides_device *device = open_device(j.device);
    int asked = 0;
    for (tides_status status = TIDES_CANCELLED; status == TIDES_CANCELLED; asked++) {
        tides_error error;
        outcome parts = {0};
        countdown at = {asked + 1, 0};
        tides_simulator *s = make_simulator(&j, device);
        begin(&j, s, &parts);
        status = tides_simulator_run(s, j.stop, collect, &parts, stop_in_time, &at, &error);
        if (status == TIDES_CANCELLED && at.last < 1) assert_int_equal(parts.count, 0);
        scene_expect_ok(tides_simulator_run(s, j.stop, collect, &parts, NULL, NULL, &error), &error);
        expect_same(&whole, &parts, "stopped within the step");
        tides_simulator_destroy(s);
        free_outcome(&parts);
    }
    print_message("one step asks %d times\n", asked - 1);
    assert_true(asked > 4);
    tides_device_close(device);
    free_outcome(&whole);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_invariant_and_stream),
                                       cmocka_unit_test(test_invariant_and_stream_of_adaptive_steps),
                                       cmocka_unit_test(test_slopes_by_difference),
                                       cmocka_unit_test(test_pieces_equal_the_whole),
                                       cmocka_unit_test(test_batches_and_repeats_change_nothing),
                                       cmocka_unit_test(test_still_tiles_change_nothing),
                                       cmocka_unit_test(test_nothing_moves_no_event),
                                       cmocka_unit_test(test_stopping_sink_loses_nothing),
                                       cmocka_unit_test(test_stopping_progress_loses_nothing),
                                       cmocka_unit_test(test_stopping_within_a_step_loses_nothing)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
