/* Test support: one run of the simulator with all its results, and checks that hold for any run. */
#ifndef TESTS_PROPERTY_SIMULATOR_RUN_H
#define TESTS_PROPERTY_SIMULATOR_RUN_H

#include "render/td_renderer.h"
#include "solver/td_simulator.h"
#include "tests/support/model_steps.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

/* -- running ------------------------------------------------------------------------------------------------------- */

/* What to simulate. */
typedef struct job {
    const char *device;
    const tides_scene *scene;
    const tides_trajectory *path;
    tides_intrinsics camera;
    tides_sensor sensor;
    tides_stepping stepping;
    double start, stop;
    int batch;          /* steps per launch, 0: as the simulator likes */
    double stop_change; /* image.smoothing.stop_change; 0: the default */
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

static inline int collect(void *user, const tides_event *events, size_t count) {
    outcome *o = user;
    scene_expect_ok(td_reserve((void **)&o->events, &o->capacity, o->count + count, sizeof *events, NULL), NULL);
    if (count) memcpy(o->events + o->count, events, count * sizeof *events);
    o->count += count;
    o->calls++;
    return o->calls == o->stop_at_call;
}

static inline void free_outcome(outcome *o) {
    free(o->events);
    free(o->initial);
    free(o->signal);
    free(o->reference);
    free(o->count_on);
    free(o->count_off);
}

/* NULL where the device isn't there. */
static inline tides_device *open_device(const char *spec) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open(spec, &device, &error);
    if (status == TIDES_NO_DEVICE)
        print_message("skipped: %s\n", error.text);
    else
        scene_expect_ok(status, &error);
    return device;
}

static inline tides_simulator *make_simulator(const job *j, tides_device *device) {
    tides_simulator *s = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.background[0] = 0.1;
    if (j->stop_change > 0) params.smoothing.stop_change = j->stop_change;
    scene_expect_ok(tides_simulator_create(device, j->scene, j->path, &j->camera, &params, &j->sensor, &j->stepping, j->start,
                                           j->stop, NULL, NULL, &s, &error),
                    &error);
    if (j->batch) s->batch.steps = s->batch.limit = j->batch;
    return s;
}

static inline int pixels_of(const job *j) { return j->camera.width * j->camera.height; }

/* Begins: the references are the initial signal then. */
static inline void begin(const job *j, tides_simulator *s, outcome *o) {
    size_t pixels = (size_t)pixels_of(j);
    tides_error error;
    o->initial = calloc(pixels, sizeof *o->initial);
    o->signal = calloc(pixels, sizeof *o->signal);
    o->reference = calloc(pixels, sizeof *o->reference);
    o->count_on = calloc(pixels, sizeof *o->count_on);
    o->count_off = calloc(pixels, sizeof *o->count_off);
    assert_true(o->initial && o->signal && o->reference && o->count_on && o->count_off);
    tides_simulator_state(s, o->signal, o->reference, NULL, NULL);
    for (size_t i = 0; i < pixels; i++) assert_true(isnan(o->signal[i]) && isnan(o->reference[i])); /* nothing is rendered */
    scene_expect_ok(tides_simulator_run(s, j->start, collect, o, NULL, NULL, &error), &error);
    tides_simulator_state(s, o->signal, o->initial, NULL, NULL);
    assert_memory_equal(o->signal, o->initial, pixels * sizeof(double));
    assert_int_equal(o->count, 0);
}

static inline void finish(tides_simulator *s, outcome *o) {
    tides_simulator_state(s, o->signal, o->reference, o->count_on, o->count_off);
    tides_simulator_stats(s, &o->stats);
}

/* The whole run in one call, of a simulator that was made for it and is destroyed. */
static inline outcome run_made(const job *j, tides_simulator *s) {
    outcome o = {0};
    tides_error error;
    begin(j, s, &o);
    scene_expect_ok(tides_simulator_run(s, j->stop, collect, &o, NULL, NULL, &error), &error);
    finish(s, &o);
    tides_simulator_destroy(s);
    return o;
}

static inline outcome run_on(const job *j, tides_device *device) { return run_made(j, make_simulator(j, device)); }

static inline outcome run(const job *j) {
    tides_device *device = open_device(j->device);
    if (!device) skip();
    outcome o = run_on(j, device);
    tides_device_close(device);
    return o;
}

/* Up to `until`, and from there by another simulator, which goes on from a checkpoint at `path`. */
static inline outcome run_resumed(const job *j, tides_device *device, const char *path, double until) {
    outcome o = {0};
    tides_error error;
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &o);
    scene_expect_ok(tides_simulator_run(s, until, collect, &o, NULL, NULL, &error), &error);
    scene_expect_ok(tides_simulator_save(s, NULL, path, &error), &error);
    tides_simulator_destroy(s);
    s = make_simulator(j, device);
    scene_expect_ok(tides_simulator_restore(s, NULL, path, &error), &error);
    scene_expect_ok(tides_simulator_run(s, j->stop, collect, &o, NULL, NULL, &error), &error);
    finish(s, &o);
    tides_simulator_destroy(s);
    return o;
}

/* -- checks -------------------------------------------------------------------------------------------------------- */

static inline int compare_events(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return a->polarity < b->polarity ? -1 : a->polarity > b->polarity;
}

/* Sorted, in the image and in the run, of either polarity; as many per pixel as the state says. */
static inline void check_stream(const job *j, const outcome *o) {
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
static inline void check_state(const job *j, const outcome *o) {
    double on = j->sensor.threshold_on, off = j->sensor.threshold_off, worst = 0;
    for (int i = 0; i < pixels_of(j); i++) {
        double residual = o->signal[i] - o->reference[i];
        if (!(residual < on && residual > -off)) fail_msg("pixel %d: S - S_ref is %.17g at the end", i, residual);
        worst = fmax(worst, fmax(residual / on, -residual / off));
        double reference = o->initial[i] + o->count_on[i] * on - o->count_off[i] * off;
        if (!(fabs(o->reference[i] - reference) < 1e-12 * (1 + fabs(reference))))
            fail_msg("pixel %d: S_ref is %.17g", i, o->reference[i]);
    }
    assert_true(fabs(worst - o->stats.worst_residual) < 1e-12);
}

static inline void expect_same(const outcome *a, const outcome *b, const char *what) {
    if (a->count != b->count) fail_msg("%s: %zu events and %zu", what, a->count, b->count);
    for (size_t k = 0; k < a->count; k++)
        if (memcmp(&a->events[k], &b->events[k], sizeof *a->events) != 0)
            fail_msg("%s: event %zu differs: %lld ns and %lld ns", what, k, (long long)a->events[k].t,
                     (long long)b->events[k].t);
}

/* A readout that delays, drops and jitters. */
static inline tides_readout busy_readout(void) {
    tides_readout readout;
    tides_readout_defaults(&readout);
    readout.enabled = 1;
    readout.tile_px = 8;
    readout.tick_s = 10e-6;
    readout.k0 = 2;
    readout.queue_capacity = 64;
    readout.p0 = 0.01;
    readout.sigma0_s = 2e-6;
    return readout;
}

/* -- scenes -------------------------------------------------------------------------------------------------------- */

static inline random_scene make_scene(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.objects = 2;
    recipe.sh_degree = 1;
    recipe.width = 43;
    recipe.height = 37;
    recipe.size = 0.2;
    recipe.camera_speed = 2;
    return random_scene_make(&recipe);
}

/* 40 steps, the last one shorter. */
static inline job job_of(const random_scene *scene) {
    job j = {.device = "reference-f32",
             .scene = scene->scene,
             .path = scene->path,
             .camera = scene->camera,
             .start = 0.2,
             .stop = 0.2795};
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    j.stepping.mode = TIDES_STEPPING_FIXED;
    j.sensor.threshold_on = 0.1;
    j.sensor.threshold_off = 0.13;
    j.stepping.step_s = 2e-3;
    return j;
}

/* The same under error control: macro steps of 20 ms, halved by each tile for itself or by all together. */
static inline job adaptive_job_of(const random_scene *scene, int local) {
    job j = job_of(scene);
    j.stepping.mode = TIDES_STEPPING_ERROR;
    j.stepping.local = local;
    j.stepping.step_s = 20e-3;
    j.stepping.min_step_s = 1e-4;
    return j;
}

#endif
