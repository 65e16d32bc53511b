/* Test support: the small worlds of tests/golden/test_runs.c, by name. They are made from seeds by sums, products and
 * quotients, so that they are equal on every machine; sines come from the library. Errors fail the running cmocka test. */
#ifndef TESTS_SUPPORT_RUN_WORLDS_H
#define TESTS_SUPPORT_RUN_WORLDS_H

#include "tides/camera.h"
#include "tides/scene.h"

enum { RUN_WIDTH = 32, RUN_HEIGHT = 24, RUN_FRAMES = 9, RUN_VOXELS = 20 };

/* Runs go from RUN_START to RUN_STOP [s]: across a sample of the camera's path and the knot of the bent motion. */
#define RUN_START 0.42
#define RUN_STOP 0.455

typedef struct run_world {
    tides_scene *scene;
    tides_trajectory *path;
    tides_intrinsics camera;
} run_world;

/* "rigid", "moving", "callback", "motion0" .. (tests/support/random_motion.h), "hexplane", "network", "screw", "timenet", or a
 * kind of tides_generate. */
run_world run_world_make(const char *name);
void run_world_free(run_world *world);

/* A bright spot that crosses a ramp: RUN_FRAMES frames of luminance from RUN_START to RUN_STOP. */
void run_frames(double *Y, double *times);

/* Voxels of one interval, RUN_VOXELS planes, for the method LDATI. */
void run_voxels(double *voxels);

#endif
