/* Shared by the tests of checkpoints: a small run, cut and compared to the bit. */
#ifndef TEST_CHECKPOINT_COMMON_H
#define TEST_CHECKPOINT_COMMON_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "checkpoint/td_checkpoint.h"
#include "solver/td_simulator.h"
#include "tests/support/model_steps.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static const uint64_t SEED = 4711;

/* -- running --------------------------------------------------------------------------------------------------------------- */

enum { WIDTH = 43, HEIGHT = 37, PIXELS = WIDTH * HEIGHT };

/* What to simulate; `change` spoils it. */
typedef struct job {
    const char *device;
    random_scene scene;
    tides_image_params image;
    tides_intrinsics camera;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_filters filters; /* all off as made */
    double start, stop;
} job;

static inline random_scene make_scene(uint64_t seed, double camera_speed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.objects = 2;
    recipe.sh_degree = 1;
    recipe.width = WIDTH;
    recipe.height = HEIGHT;
    recipe.size = 0.2;
    recipe.camera_speed = camera_speed;
    return random_scene_make(&recipe);
}

/* 16 steps, the last one shorter. */
static inline job make_job(int mode, const char *device) {
    job j = {.device = device, .scene = make_scene(SEED, 2), .start = 0.2, .stop = 0.2795};
    j.camera = j.scene.camera;
    tides_image_params_defaults(&j.image);
    tides_sensor_defaults(&j.sensor);
    tides_filters_defaults(&j.filters);
    model_steps(&j.stepping);
    j.sensor.threshold_on = 0.1;
    j.sensor.threshold_off = 0.13;
    j.stepping.mode = mode;
    j.stepping.step_s = 5e-3;
    return j;
}

static inline void free_job(job *j) { random_scene_free(&j->scene); }

/* What came out. */
typedef struct outcome {
    tides_event *events;
    size_t count, capacity;
    double signal[PIXELS], reference[PIXELS];
    uint32_t on[PIXELS], off[PIXELS];
    tides_stats stats;
} outcome;

static inline int collect(void *user, const tides_event *events, size_t count) {
    outcome *o = user;
    scene_expect_ok(td_reserve((void **)&o->events, &o->capacity, o->count + count, sizeof *events, NULL), NULL);
    memcpy(o->events + o->count, events, count * sizeof *events);
    o->count += count;
    return 0;
}

static inline outcome *new_outcome(void) {
    outcome *o = calloc(1, sizeof *o);
    assert_non_null(o);
    return o;
}

static inline void free_outcome(outcome *o) {
    free(o->events);
    free(o);
}

static inline tides_device *open_device(const job *j) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open(j->device, &device, &error);
    if (status == TIDES_NO_DEVICE) return NULL;
    scene_expect_ok(status, &error);
    return device;
}

static inline tides_simulator *make_simulator(const job *j, tides_device *device) {
    tides_simulator *s = NULL;
    tides_error error;
    scene_expect_ok(tides_simulator_create(device, j->scene.scene, j->scene.path, &j->camera, &j->image, &j->sensor,
                                           &j->stepping, j->start, j->stop, NULL, NULL, &s, &error),
                    &error);
    scene_expect_ok(tides_simulator_filters(s, &j->filters, &error), &error);
    return s;
}

static inline void advance(tides_simulator *s, double until, outcome *o) {
    tides_error error;
    scene_expect_ok(tides_simulator_run(s, until, collect, o, NULL, NULL, &error), &error);
}

static inline void finish(tides_simulator *s, outcome *o) {
    tides_simulator_state(s, o->signal, o->reference, o->on, o->off);
    tides_simulator_stats(s, &o->stats);
    tides_simulator_destroy(s);
}

static inline outcome *run_whole(const job *j, tides_device *device) {
    outcome *o = new_outcome();
    tides_simulator *s = make_simulator(j, device);
    advance(s, j->stop, o);
    finish(s, o);
    assert_true(o->count > 1000);
    return o;
}

/* Cuts `*s` here: saved, gone, and restored in a new one. */
static inline void cut(const job *j, tides_device *device, const char *path, tides_simulator **s) {
    tides_error error;
    scene_expect_ok(tides_simulator_save(*s, "{}", path, &error), &error);
    tides_simulator_destroy(*s);
    *s = make_simulator(j, device);
    scene_expect_ok(tides_simulator_restore(*s, "{}", path, &error), &error);
}

static inline void expect_same(const outcome *a, const outcome *b) {
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->events, b->events, a->count * sizeof *a->events);
    assert_memory_equal(a->signal, b->signal, sizeof a->signal);
    assert_memory_equal(a->reference, b->reference, sizeof a->reference);
    assert_memory_equal(a->on, b->on, sizeof a->on);
    assert_memory_equal(a->off, b->off, sizeof a->off);
}

/* Totals that don't depend on how launches are put together; and none that starts again. */
static inline void expect_same_totals(const tides_stats *a, const tides_stats *b) {
    assert_true(a->events == b->events && a->events_on == b->events_on && a->events_off == b->events_off);
    assert_true(a->events_truncated == b->events_truncated && a->events_caught_up == b->events_caught_up);
    assert_true(a->steps == b->steps && a->steps_rejected == b->steps_rejected && a->steps_at_minimum == b->steps_at_minimum);
    assert_true(a->tile_steps_still == b->tile_steps_still);
    assert_true(a->worst_error == b->worst_error && a->worst_residual == b->worst_residual);
    assert_true(a->error_p50_s == b->error_p50_s && a->error_p99_s == b->error_p99_s);
    assert_true(a->steps_probed == b->steps_probed && a->steps_at_rounding == b->steps_at_rounding);
    assert_true(a->events_uncertain == b->events_uncertain && a->worst_deviation == b->worst_deviation);
    assert_true(a->simulated_s == b->simulated_s);
    assert_true(a->renders_full_frame_equivalent == b->renders_full_frame_equivalent);
    assert_true(b->render.gaussians_projected > a->render.gaussians_projected / 4);
    assert_true(b->render.pairs_evaluated > a->render.pairs_evaluated / 4);
    assert_true(b->run_time_s > 0 && b->time_compare_s > 0);
}

/* -- a checkpoint and who takes it ----------------------------------------------------------------------------------- */

/* A checkpoint of `j` in the middle of its run, with the run's text. */
static inline void save_middle(const job *j, const char *run, const char *path) {
    tides_device *device = open_device(j);
    tides_simulator *s = make_simulator(j, device);
    outcome *o = new_outcome();
    tides_error error;
    advance(s, 0.2401, o);
    scene_expect_ok(tides_simulator_save(s, run, path, &error), &error);
    tides_simulator_destroy(s);
    free_outcome(o);
    tides_device_close(device);
}

/* Restoring `path` in a simulator of `j` ends with `wanted` and a text of these words, and leaves the simulator as it was. */
static inline void refuse(const job *j, const char *run, const char *path, tides_status wanted, const char *words) {
    tides_device *device = open_device(j);
    tides_simulator *s = make_simulator(j, device);
    tides_error error = {0};
    scene_expect_error(tides_simulator_restore(s, run, path, &error), wanted, &error, words);
    assert_false(s->started);
    assert_true(s->step == 0 && s->done.work.counts.events_on == 0);
    tides_simulator_destroy(s);
    tides_device_close(device);
}

static inline void accept(const job *j, const char *run, const char *path) {
    tides_device *device = open_device(j);
    tides_simulator *s = make_simulator(j, device);
    tides_error error = {0};
    scene_expect_ok(tides_simulator_restore(s, run, path, &error), &error);
    assert_true(s->step == 8);
    tides_simulator_destroy(s);
    tides_device_close(device);
}

#endif
