/* What must hold for any run: the comparator's invariant, counts, a sorted stream, and that nothing but the scene, the camera and
 * the step decides the events: not batches, not how a run is cut into calls, not the device. On random scenes and a real one. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "solver/td_simulator.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 90210;

/* -- running ----------------------------------------------------------------------------------------------------------------- */

/* What to simulate. */
typedef struct job {
    const char *device;
    const tides_scene *scene;
    const tides_trajectory *path;
    tides_intrinsics camera;
    tides_sensor sensor;
    tides_stepping stepping;
    double start, stop;
    int batch; /* steps per launch, 0: as the simulator likes */
} job;

/* What came out. */
typedef struct outcome {
    tides_event *events;
    size_t count, capacity;
    double *initial, *signal, *reference; /* (pixels) */
    uint32_t *count_on, *count_off;
    tides_stats stats;
    int calls, stop_at_call; /* of the sink; it stops the run at that call (0: never) */
} outcome;

static int collect(void *user, const tides_event *events, size_t count) {
    outcome *o = user;
    scene_expect_ok(td_reserve((void **)&o->events, &o->capacity, o->count + count, sizeof *events, NULL), NULL);
    memcpy(o->events + o->count, events, count * sizeof *events);
    o->count += count;
    o->calls++;
    return o->calls == o->stop_at_call;
}

static void free_outcome(outcome *o) {
    free(o->events);
    free(o->initial);
    free(o->signal);
    free(o->reference);
    free(o->count_on);
    free(o->count_off);
}

/* NULL where the device isn't there. */
static tides_device *open_device(const char *spec) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open(spec, &device, &error);
    if (status == TIDES_NO_DEVICE)
        print_message("skipped: %s\n", error.text);
    else
        scene_expect_ok(status, &error);
    return device;
}

static tides_simulator *make_simulator(const job *j, tides_device *device) {
    tides_simulator *s = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.background[0] = 0.1;
    scene_expect_ok(tides_simulator_create(device, j->scene, j->path, &j->camera, &params, &j->sensor, &j->stepping, j->start, j->stop,
                                           NULL, NULL, &s, &error), &error);
    if (j->batch) s->batch = s->batch_limit = j->batch;
    return s;
}

static int pixels_of(const job *j) { return j->camera.width * j->camera.height; }

/* Begins: the references are the initial signal then. */
static void begin(const job *j, tides_simulator *s, outcome *o) {
    size_t pixels = (size_t)pixels_of(j);
    tides_error error;
    o->initial = calloc(pixels, sizeof *o->initial);
    o->signal = calloc(pixels, sizeof *o->signal);
    o->reference = calloc(pixels, sizeof *o->reference);
    o->count_on = calloc(pixels, sizeof *o->count_on);
    o->count_off = calloc(pixels, sizeof *o->count_off);
    assert_true(o->initial && o->signal && o->reference && o->count_on && o->count_off);
    scene_expect_ok(tides_simulator_run(s, j->start, collect, o, NULL, NULL, &error), &error);
    tides_simulator_state(s, o->signal, o->initial, NULL, NULL);
    assert_memory_equal(o->signal, o->initial, pixels * sizeof(double));
    assert_int_equal(o->count, 0);
}

static void finish(tides_simulator *s, outcome *o) {
    tides_simulator_state(s, o->signal, o->reference, o->count_on, o->count_off);
    tides_simulator_stats(s, &o->stats);
}

/* The whole run in one call. */
static outcome run_on(const job *j, tides_device *device) {
    outcome o = {0};
    tides_error error;
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &o);
    scene_expect_ok(tides_simulator_run(s, j->stop, collect, &o, NULL, NULL, &error), &error);
    finish(s, &o);
    tides_simulator_destroy(s);
    return o;
}

static outcome run(const job *j) {
    tides_device *device = open_device(j->device);
    if (!device) skip();
    outcome o = run_on(j, device);
    tides_device_close(device);
    return o;
}

/* -- checks ------------------------------------------------------------------------------------------------------------------ */

static int compare_events(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return a->polarity < b->polarity ? -1 : a->polarity > b->polarity;
}

/* Sorted, in the image and in the run, of either polarity; as many per pixel as the state says. */
static void check_stream(const job *j, const outcome *o) {
    size_t pixels = (size_t)pixels_of(j);
    uint32_t *on = calloc(pixels, sizeof *on), *off = calloc(pixels, sizeof *off);
    uint64_t ons = 0;
    assert_true(on && off);
    for (size_t k = 0; k < o->count; k++) {
        const tides_event *e = &o->events[k];
        assert_true(e->x < j->camera.width && e->y < j->camera.height);
        assert_true(e->t >= (int64_t)floor(j->start * 1e9) && e->t <= (int64_t)ceil(j->stop * 1e9));
        assert_true(e->polarity == 1 || e->polarity == -1);
        assert_true(k == 0 || compare_events(e - 1, e) <= 0);
        uint32_t *count = e->polarity > 0 ? on : off;
        count[(size_t)e->y * (size_t)j->camera.width + e->x]++;
        ons += e->polarity > 0;
    }
    assert_memory_equal(on, o->count_on, pixels * sizeof *on);
    assert_memory_equal(off, o->count_off, pixels * sizeof *off);
    assert_true(o->stats.events == o->count && o->stats.events_on == ons && o->stats.events_off == o->count - ons);
    free(on);
    free(off);
}

/* -C- < S - S_ref < C+, and S_ref = S_init + n_on C+ - n_off C-. */
static void check_state(const job *j, const outcome *o) {
    double on = j->sensor.threshold_on, off = j->sensor.threshold_off, worst = 0;
    for (int i = 0; i < pixels_of(j); i++) {
        double residual = o->signal[i] - o->reference[i];
        if (!(residual < on && residual > -off)) fail_msg("pixel %d: S - S_ref is %.17g at the end", i, residual);
        worst = fmax(worst, fmax(residual / on, -residual / off));
        double reference = o->initial[i] + o->count_on[i] * on - o->count_off[i] * off;
        if (!(fabs(o->reference[i] - reference) < 1e-12 * (1 + fabs(reference)))) fail_msg("pixel %d: S_ref is %.17g", i, o->reference[i]);
    }
    assert_true(fabs(worst - o->stats.worst_residual) < 1e-12);
}

static void expect_same(const outcome *a, const outcome *b, const char *what) {
    if (a->count != b->count) fail_msg("%s: %zu events and %zu", what, a->count, b->count);
    for (size_t k = 0; k < a->count; k++)
        if (memcmp(&a->events[k], &b->events[k], sizeof *a->events) != 0)
            fail_msg("%s: event %zu differs: %lld ns and %lld ns", what, k, (long long)a->events[k].t, (long long)b->events[k].t);
}

/* -- scenes ------------------------------------------------------------------------------------------------------------------ */

static random_scene make_scene(uint64_t trial) {
    random_recipe recipe = random_recipe_defaults(SEED + trial);
    recipe.objects = 2;
    recipe.sh_degree = 1;
    recipe.width = 43;
    recipe.height = 37;
    recipe.size = 0.2;
    recipe.camera_speed = 2;
    return random_scene_make(&recipe);
}

/* 40 steps, the last one shorter. */
static job job_of(const random_scene *scene) {
    job j = {.device = "reference-f32", .scene = scene->scene, .path = scene->path, .camera = scene->camera, .start = 0.2, .stop = 0.2795};
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    j.sensor.threshold_on = 0.1;
    j.sensor.threshold_off = 0.13;
    j.stepping.step_s = 2e-3;
    return j;
}

/* The same under error control: macro steps of 20 ms, halved by each tile for itself or by all together. */
static job adaptive_job_of(const random_scene *scene, int local) {
    job j = job_of(scene);
    j.stepping.mode = TIDES_STEPPING_ERROR;
    j.stepping.local = local;
    j.stepping.step_s = 20e-3;
    j.stepping.min_step_s = 1e-4;
    return j;
}

/* -- properties -------------------------------------------------------------------------------------------------------------- */

static void test_invariant_and_stream(void **state) {
    static const int32_t models[] = {TIDES_MODEL_LINEAR, TIDES_MODEL_QUADRATIC, TIDES_MODEL_HERMITE, TIDES_MODEL_SECANT};
    (void)state;
    for (uint64_t trial = 0; trial < 8; trial++) {
        random_scene scene = make_scene(trial);
        job j = job_of(&scene);
        j.stepping.model = models[trial % 4];
        j.stepping.step_s = trial < 4 ? 2e-3 : 20e-3;
        j.sensor.max_events_per_step = trial < 6 ? 64 : 1;
        outcome o = run(&j);
        assert_true(o.count > 1000);
        check_stream(&j, &o);
        check_state(&j, &o);
        assert_true(o.stats.steps == (trial < 4 ? 40u : 4u) * 9u); /* of 3 x 3 tiles */
        assert_true((o.stats.events_truncated > 0) == (trial >= 6));
        free_outcome(&o);
        random_scene_free(&scene);
    }
}

static void test_invariant_and_stream_of_adaptive_steps(void **state) {
    (void)state;
    for (int local = 0; local < 2; local++) {
        random_scene scene = make_scene(10);
        job j = adaptive_job_of(&scene, local);
        if (local) j.sensor.threshold_off = j.sensor.threshold_on; /* where tiles may leave out what can't fire */
        outcome o = run(&j);
        assert_true(o.count > 1000);
        check_stream(&j, &o);
        check_state(&j, &o);
        assert_true(o.stats.steps_rejected > 0 && o.stats.steps > 4 * 9);
        assert_true(o.stats.steps_at_minimum > 0 || o.stats.worst_error <= j.stepping.tolerance);
        free_outcome(&o);
        random_scene_free(&scene);
    }
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
    random_scene scene = make_scene(20);
    job fixed = job_of(&scene), adaptive = adaptive_job_of(&scene, 1);
    check_pieces(&fixed);
    check_pieces(&adaptive);
    random_scene_free(&scene);
}

static void test_batches_and_repeats_change_nothing(void **state) {
    static const int batches[] = {0, 1, 3, 16};
    static const char *const devices[] = {"reference-f32", "cpu"};
    (void)state;
    random_scene scene = make_scene(30);
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

/* -- stopping ---------------------------------------------------------------------------------------------------------------- */

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
    random_scene scene = make_scene(40);
    job fixed = job_of(&scene), adaptive = adaptive_job_of(&scene, 1);
    fixed.batch = 3;
    adaptive.stepping.step_s = 5e-3;
    assert_true(check_stopping_sink(&fixed) > 3);
    assert_true(check_stopping_sink(&adaptive) > 3);
    random_scene_free(&scene);
}

/* Checks what a progress gets, and stops. */
static int stop_always(void *user, double fraction, const char *stage) {
    double *last = user;
    assert_true(fraction > *last && fraction <= 1);
    assert_string_equal(stage, "simulating");
    *last = fraction;
    return 1;
}

static void test_stopping_progress_loses_nothing(void **state) {
    (void)state;
    random_scene scene = make_scene(50);
    job j = job_of(&scene);
    outcome whole = run(&j), stopped = {0};
    tides_device *device = open_device(j.device);
    tides_simulator *s = make_simulator(&j, device);
    double last = 0;
    int stops = 0;
    begin(&j, s, &stopped);
    while (last < 1) {
        tides_error error;
        scene_expect_error(tides_simulator_run(s, j.stop, collect, &stopped, stop_always, &last, &error), TIDES_CANCELLED, &error, "request");
        stops++;
    }
    assert_true(stops > 2);
    assert_int_equal(tides_simulator_run(s, j.stop, collect, &stopped, stop_always, &last, NULL), TIDES_OK); /* nothing left to stop */
    expect_same(&whole, &stopped, "stopped by the progress");
    tides_simulator_destroy(s);
    tides_device_close(device);
    free_outcome(&whole);
    free_outcome(&stopped);
    random_scene_free(&scene);
}

/* -- devices ----------------------------------------------------------------------------------------------------------------- */

/* By pixel, then time. */
static int by_pixel(const void *a, const void *b) {
    const tides_event *l = a, *r = b;
    if (l->y != r->y) return l->y < r->y ? -1 : 1;
    if (l->x != r->x) return l->x < r->x ? -1 : 1;
    return compare_events(l, r);
}

static int by_value(const void *a, const void *b) {
    const double *l = a, *r = b;
    return *l < *r ? -1 : *l > *r;
}

static int same_pixel(const tides_event *a, const tides_event *b) { return a->x == b->x && a->y == b->y; }

/* Matches events per pixel, in order, where polarities agree. Sorts both streams. Returns how many are left over; `*median`
 * becomes that of |dt| [ns] of the others. */
static size_t match(outcome *a, outcome *b, double *median) {
    size_t i = 0, k = 0, matched = 0, left = 0;
    double *dt = calloc(a->count + 1, sizeof *dt);
    assert_non_null(dt);
    qsort(a->events, a->count, sizeof *a->events, by_pixel);
    qsort(b->events, b->count, sizeof *b->events, by_pixel);
    while (i < a->count && k < b->count) {
        const tides_event *x = &a->events[i], *y = &b->events[k];
        if (same_pixel(x, y)) {
            if (x->polarity == y->polarity)
                dt[matched++] = fabs((double)(x->t - y->t));
            else
                left += 2;
            i++, k++;
        } else {
            left++;
            if (by_pixel(x, y) < 0) i++; else k++;
        }
    }
    left += a->count - i + b->count - k;
    qsort(dt, matched, sizeof *dt, by_value);
    *median = matched ? dt[matched / 2] : 0;
    free(dt);
    return left;
}

/* cpu == reference-f32 to the bit, and both near the double reference. */
static void compare_devices(job *j, const char *what, double worst_median_ns) {
    tides_device *cpu = open_device("cpu");
    outcome on_cpu = {0};
    double median;
    if (cpu) on_cpu = run_on(j, cpu);
    j->device = "reference-f32";
    outcome single = run(j);
    j->device = "reference";
    outcome wide = run(j);
    if (cpu) {
        expect_same(&on_cpu, &single, what);
        assert_memory_equal(on_cpu.signal, single.signal, (size_t)pixels_of(j) * sizeof(double));
    }
    size_t left = match(&single, &wide, &median);
    print_message("%s: %zu events in single precision, %zu in double; %zu not matched, median |dt| %.0f ns\n", what, single.count,
                  wide.count, left, median);
    assert_true(wide.count > 500);
    assert_true((double)left <= 1e-3 * (double)wide.count + 2);
    assert_true(median < worst_median_ns);
    tides_device_close(cpu);
    free_outcome(&on_cpu);
    free_outcome(&single);
    free_outcome(&wide);
}

static void test_devices_agree(void **state) {
    (void)state;
    for (uint64_t trial = 60; trial < 62; trial++) {
        random_scene scene = make_scene(trial);
        job j = job_of(&scene);
        if (trial == 61) j.sensor.threshold_off = j.sensor.threshold_on;
        compare_devices(&j, "random scene", 1000);
        j = adaptive_job_of(&scene, 1);
        compare_devices(&j, "random scene, adaptive", 1000);
        random_scene_free(&scene);
    }
}

/* -- a real scene ------------------------------------------------------------------------------------------------------------ */

static void test_real_scene(void **state) {
    (void)state;
    char file[1024];
    tides_orbit orbit = {{0}, {0, -1, 0}, 0, 0, 0.3, 1.5, 0, 1};
    tides_trajectory *path = NULL;
    tides_scene *scene = NULL;
    tides_error error;
    double lower[3], upper[3];
    if (shared_path(file, sizeof file, "data/playcanvas/playbot_lod5_inria_sh2.ply") != 0) {
        print_message("skipped: no data/playcanvas/playbot_lod5_inria_sh2.ply in $TIDES_SHARED\n");
        skip();
    }
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, file, NULL, 1, &error), &error);
    tides_scene_bounds(scene, lower, upper);
    for (int i = 0; i < 3; i++) orbit.target[i] = 0.5 * (lower[i] + upper[i]);
    orbit.radius = 1.1 * (upper[1] - lower[1]);
    scene_expect_ok(tides_trajectory_create_orbit(&orbit, &path, &error), &error);
    job j = {.device = "reference-f32", .scene = scene, .path = path, .camera = {56, 44, 50, 50, 28, 22}, .start = 0, .stop = 0.05};
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    j.stepping.step_s = 5e-3;
    outcome o = run(&j);
    check_stream(&j, &o);
    check_state(&j, &o);
    free_outcome(&o);
    compare_devices(&j, "playbot", 5000);
    tides_trajectory_destroy(path);
    tides_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_invariant_and_stream),
                                       cmocka_unit_test(test_invariant_and_stream_of_adaptive_steps),
                                       cmocka_unit_test(test_pieces_equal_the_whole),
                                       cmocka_unit_test(test_batches_and_repeats_change_nothing),
                                       cmocka_unit_test(test_nothing_moves_no_event),
                                       cmocka_unit_test(test_stopping_sink_loses_nothing),
                                       cmocka_unit_test(test_stopping_progress_loses_nothing),
                                       cmocka_unit_test(test_devices_agree),
                                       cmocka_unit_test(test_real_scene)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
