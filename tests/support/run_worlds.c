/* Makes the small worlds of test_runs.c. They move so fast that they have some hundred events in 35 ms. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/run_worlds.h"

#include "motion/td_hexplane.h"
#include "tests/support/moving_scene.h"
#include "tests/support/random_motion.h"
#include "tests/support/random_network.h"
#include "tests/support/scene_folder.h"
#include "tides/generate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t SEED = 20261122;

/* Duration of motions without a clock of their own [s]: a run of 35 ms sees some of their movement. */
#define MOTION_S 0.5

static random_recipe recipe_of(void) {
    random_recipe recipe = random_recipe_defaults(SEED);
    recipe.count = 40;
    recipe.objects = 3;
    recipe.sh_degree = 1;
    recipe.width = RUN_WIDTH;
    recipe.height = RUN_HEIGHT;
    recipe.size = 0.25;
    recipe.camera_speed = 2;
    return recipe;
}

/* The camera and path of a random scene, with an empty scene. */
static run_world empty_world(void) {
    random_recipe recipe = recipe_of();
    random_scene made = random_scene_make(&recipe);
    run_world world = {NULL, made.path, made.camera};
    tides_error error;
    made.path = NULL;
    random_scene_free(&made);
    scene_expect_ok(tides_scene_create(&world.scene, &error), &error);
    return world;
}

static run_world rigid_world(void) {
    random_recipe recipe = recipe_of();
    random_scene made = random_scene_make(&recipe);
    run_world world = {made.scene, made.path, made.camera};
    made.scene = NULL;
    made.path = NULL;
    random_scene_free(&made);
    return world;
}

static run_world moving_world(void) {
    random_recipe recipe = recipe_of();
    moving_scene made = moving_scene_make(&recipe, 2);
    run_world world = {made.scene, made.base.path, made.base.camera};
    made.scene = NULL;
    made.base.path = NULL;
    moving_scene_free(&made);
    return world;
}

static run_world motion_world(int kind) {
    run_world world = empty_world();
    random_motion made = random_motion_make(kind, SEED);
    tides_error error;
    scene_expect_ok(tides_scene_add_moving(world.scene, &made.gaussians, made.motion, MOTION_S, NULL, 1, made.name, NULL,
                                           &error),
                    &error);
    made.motion = NULL; /* the scene took it over */
    random_motion_free(&made);
    return world;
}

/* -- networks -------------------------------------------------------------------------------------------------------------- */

static tides_motion *network_of(const char *name) {
    if (strcmp(name, "hexplane") == 0) {
        random_hexplane_recipe recipe = {SEED, 8,  {8, 8, 8, 10}, 2, 16, 1, TD_HEAD_MEAN | TD_HEAD_SCALE | TD_HEAD_ROTATION,
                                         0,    0.2};
        return random_hexplane_make(&recipe);
    }
    random_network_recipe recipe = {SEED, 32, 3, 2, 6, 0, 0, 0, 0.1};
    recipe.screw = strcmp(name, "screw") == 0;
    if (strcmp(name, "timenet") == 0) {
        recipe.time_width = 16;
        recipe.times = 8;
    }
    return random_network_make(&recipe);
}

static run_world network_world(const char *name) {
    run_world world = empty_world();
    random_gaussians made = random_gaussians_make(SEED, 30, 1, 1.2);
    tides_error error;
    scene_expect_ok(tides_scene_add_moving(world.scene, &made.view, network_of(name), MOTION_S, NULL, 1, name, NULL, &error),
                    &error);
    random_gaussians_free(&made);
    return world;
}

/* -- a callback ------------------------------------------------------------------------------------------------------------ */

/* Parabolas: each Gaussian in another direction. */
static tides_status fly(void *user, double time, int32_t side, const int32_t *index, int64_t count, const tides_theta *theta,
                        tides_error *error) {
    (void)user, (void)side, (void)error;
    for (int64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double speed = (index[i] % 5 - 2 + k) * 0.5, bend = (index[i] % 3 - 1) * 0.75;
            theta->mean[3 * i + k] += time * (speed + time * bend);
            theta->mean_dot[3 * i + k] += speed + 2 * time * bend;
        }
    return TIDES_OK;
}

static run_world callback_world(void) {
    run_world world = empty_world();
    random_gaussians made = random_gaussians_make(SEED, 30, 1, 1.2);
    tides_callback_motion callback = {.count = 30, .stop = 1, .function = fly, .time_scale = 0.25};
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    scene_expect_ok(tides_scene_add_moving(world.scene, &made.view, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    random_gaussians_free(&made);
    return world;
}

/* -- by name --------------------------------------------------------------------------------------------------------------- */

static run_world generated_world(const char *kind) {
    tides_generate_options options;
    tides_world made;
    tides_error error;
    tides_generate_options_defaults(&options);
    if (strcmp(kind, "room") != 0) options.gaussians = 60; /* a room has a fixed number */
    if (strcmp(kind, "crowd") == 0) options.count = 9;     /* persons, instead of 200 */
    options.duration_s = 1;
    options.speed = 2;
    options.width = RUN_WIDTH;
    options.height = RUN_HEIGHT;
    scene_expect_ok(tides_generate(kind, &options, &made, &error), &error);
    return (run_world){made.scene, made.camera, made.intrinsics};
}

run_world run_world_make(const char *name) {
    if (strcmp(name, "rigid") == 0) return rigid_world();
    if (strcmp(name, "moving") == 0) return moving_world();
    if (strcmp(name, "callback") == 0) return callback_world();
    if (strncmp(name, "motion", 6) == 0) return motion_world(atoi(name + 6));
    if (strcmp(name, "hexplane") == 0 || strcmp(name, "network") == 0 || strcmp(name, "screw") == 0 ||
        strcmp(name, "timenet") == 0)
        return network_world(name);
    return generated_world(name);
}

void run_world_free(run_world *world) {
    tides_scene_destroy(world->scene);
    tides_trajectory_destroy(world->path);
    memset(world, 0, sizeof *world);
}

/* -- frames ---------------------------------------------------------------------------------------------------------------- */

void run_frames(double *Y, double *times) {
    for (int k = 0; k < RUN_FRAMES; k++) {
        double middle = 4 + 3 * k;
        times[k] = RUN_START + (RUN_STOP - RUN_START) * k / (RUN_FRAMES - 1);
        for (int y = 0; y < RUN_HEIGHT; y++)
            for (int x = 0; x < RUN_WIDTH; x++) {
                double dx = x - middle, dy = y - 0.5 * middle;
                Y[(k * RUN_HEIGHT + y) * RUN_WIDTH + x] = 0.05 + 0.01 * x + 0.7 / (1 + 0.1 * (dx * dx + dy * dy));
            }
    }
}

void run_voxels(double *voxels) {
    for (int i = 0; i < RUN_VOXELS * RUN_HEIGHT * RUN_WIDTH; i++) voxels[i] = i * 7919 % 13 == 0 ? 0.25 * (i % 9) : 0;
}
