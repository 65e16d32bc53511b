/* Test support: worlds for adaptive steps, with a moving camera and with a camera at rest, and comparisons of runs in them. */
#ifndef TESTS_PROPERTY_REFINE_WORLD_H
#define TESTS_PROPERTY_REFINE_WORLD_H

#include "tests/property/simulator_run.h"
#include "tides/metrics.h"

enum { CAMERA_MOVES, OBJECT_MOVES, KINDS };

typedef struct world {
    random_scene scene;
    tides_trajectory *still; /* OBJECT_MOVES: a camera at rest */
} world;

static inline world make_world(uint64_t seed, int kind) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    world w;
    memset(&w, 0, sizeof w);
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.objects = 2;
    recipe.sh_degree = 1;
    recipe.size = kind == CAMERA_MOVES ? 0.2 : 0.1;
    recipe.spread = kind == CAMERA_MOVES ? 1.5 : 0.5;
    recipe.width = kind == CAMERA_MOVES ? 64 : 90; /* 4 x 3 tiles, or 6 x 4, cut at the border */
    recipe.height = kind == CAMERA_MOVES ? 48 : 60;
    recipe.camera_speed = 3;
    w.scene = random_scene_make(&recipe);
    if (kind == OBJECT_MOVES) scene_expect_ok(tides_trajectory_create_static(position, quaternion, &w.still, NULL), NULL);
    return w;
}

static inline void free_world(world *w) {
    tides_trajectory_destroy(w->still);
    random_scene_free(&w->scene);
}

/* 40 ms in four macro steps under error control; equal thresholds. */
static inline job job_in(const world *w) {
    job j = adaptive_job_of(&w->scene, 1);
    if (w->still) j.path = w->still;
    j.start = 0.3;
    j.stop = 0.34;
    j.sensor.threshold_on = j.sensor.threshold_off = 0.1;
    j.stepping.step_s = 10e-3;
    j.stepping.min_step_s = 1e-5;
    return j;
}

static inline int tiles_of(const job *j) {
    return (j->camera.width + TD_TILE - 1) / TD_TILE * ((j->camera.height + TD_TILE - 1) / TD_TILE);
}

/* How the simulated stream compares with the other. */
static inline tides_match match(const outcome *reference, const outcome *simulated) {
    tides_match m;
    tides_error error;
    scene_expect_ok(tides_match_events(reference->events, reference->count, simulated->events, simulated->count, 5e-3, &m,
                                       &error),
                    &error);
    return m;
}

/* The exact events, as nearly as fine fixed steps give them. */
static inline outcome truth_of(const job *j, double step_s) {
    job fine = *j;
    fine.stepping.mode = TIDES_STEPPING_FIXED;
    fine.stepping.step_s = step_s;
    return run(&fine);
}

#endif
