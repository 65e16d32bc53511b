/* ESIM's sampling by motion: a wall at a known depth, passed at a known speed, is rendered as often as lambda over its flow
 * says, whether the camera moves, the wall does, or its splats do; and frames have no flow to go by. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"
#include "tests/support/scene_folder.h"
#include "tides/baselines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 12, ROWS = 9, SPLATS = COLUMNS * ROWS, WIDTH = 48, HEIGHT = 36 };

static const tides_intrinsics lens = {.width = WIDTH, .height = HEIGHT, .fx = 50, .fy = 50, .cx = 24, .cy = 18};
static const double depth = 4, speed = 2; /* of the wall [scene units]; across it [scene units/s]: 25 px/s */

/* At rest, or moving along x. */
static tides_trajectory *path_along_x(double velocity) {
    tides_trajectory *path = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_pose_sample samples[2];
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 2; i++) {
        samples[i].time = i;
        samples[i].position[0] = velocity * i;
        samples[i].quaternion[0] = 1;
        samples[i].velocity[0] = velocity;
        samples[i].has_rates = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, fabs(velocity) > 0 ? 2 : 1, &path, &error), &error);
    return path;
}

/* Every splat of the wall moves along x by itself. */
static tides_motion *splats_along_x(double velocity) {
    static float centre[SPLATS], width[SPLATS], mean[9 * SPLATS], turn[4 * SPLATS];
    tides_motion *motion = NULL;
    tides_error error = {TIDES_OK, ""};
    for (int i = 0; i < SPLATS; i++) {
        width[i] = 60; /* no bell */
        mean[9 * i] = (float)velocity;
    }
    tides_polynomial_motion arrays = {.count = SPLATS, .stop = 1, .opacity_centre = centre, .opacity_log_width = width};
    arrays.mean_coefficient = mean;
    arrays.quaternion_dot = turn;
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    return motion;
}

/* A wall that fills the image and more; it moves at `velocity` along x, as a whole or splat by splat. */
static tides_scene *make_wall(double velocity, int by_splats) {
    float mean[SPLATS * 3], scale[SPLATS * 3], rotation[SPLATS * 4] = {0}, opacity[SPLATS], sh[SPLATS * 3];
    tides_scene *scene = NULL;
    tides_error error = {TIDES_OK, ""};
    for (int i = 0; i < SPLATS; i++) {
        const int column = i % COLUMNS, row = i / COLUMNS;
        mean[3 * i] = ((float)column - 5.5f) * 0.5f;
        mean[3 * i + 1] = ((float)row - 4) * 0.5f;
        mean[3 * i + 2] = (float)depth;
        for (int k = 0; k < 3; k++) scale[3 * i + k] = k < 2 ? -1.5f : -4;
        rotation[4 * i] = 1;
        opacity[i] = 3;
        for (int k = 0; k < 3; k++) sh[3 * i + k] = (i + row) % 2 ? 1.2f : -1.4f;
    }
    const tides_gaussians wall =
        {.count = SPLATS, .mean = mean, .log_scale = scale, .quaternion = rotation, .opacity_logit = opacity, .sh = sh};
    tides_trajectory *path = path_along_x(by_splats ? 0 : velocity);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(by_splats ? tides_scene_add_moving(scene, &wall, splats_along_x(velocity), 1, path, 1, "wall", NULL, &error)
                              : tides_scene_add(scene, &wall, path, 1, "wall", NULL, &error),
                    &error);
    tides_trajectory_destroy(path);
    return scene;
}

static tides_renderer *make_renderer(tides_device *device, const tides_scene *scene) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_error error = {TIDES_OK, ""};
    tides_image_params_defaults(&params);
    scene_expect_ok(tides_renderer_create(device, scene, &lens, &params, NULL, NULL, &renderer, &error), &error);
    return renderer;
}

static tides_baseline *make_esim(double lambda) {
    tides_baseline *baseline = NULL;
    tides_baseline_params params;
    tides_error error = {TIDES_OK, ""};
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_ESIM;
    params.esim.adaptive_sampling = TIDES_ESIM_MOTION;
    params.esim.adaptive_sampling_lambda = lambda;
    scene_expect_ok(tides_baseline_create(&params, WIDTH, HEIGHT, &baseline, &error), &error);
    return baseline;
}

/* How fast what moves. */
typedef struct moves {
    double camera, wall, splats; /* [scene units/s] along x */
} moves;

/* Renders of [0, stop] on a device. */
static double renders(const char *on, const moves *how, double lambda, double stop) {
    tides_device *device = NULL;
    tides_stats stats;
    tides_error error = {TIDES_OK, ""};
    scene_expect_ok(tides_device_open(on, &device, &error), &error);
    tides_trajectory *camera = path_along_x(how->camera);
    tides_scene *scene = fabs(how->splats) > 0 ? make_wall(how->splats, 1) : make_wall(how->wall, 0);
    tides_renderer *renderer = make_renderer(device, scene);
    tides_baseline *baseline = make_esim(lambda);
    const tides_frame_supply supply = {NULL, renderer, camera, 1000, 0, stop};
    scene_expect_ok(tides_baseline_run(baseline, &supply, NULL, NULL, NULL, NULL, &stats, &error), &error);
    tides_baseline_destroy(baseline);
    tides_renderer_destroy(renderer);
    tides_scene_destroy(scene);
    tides_trajectory_destroy(camera);
    tides_device_close(device);
    return stats.renders_full_frame_equivalent;
}

/* fx v / Z = 25 px/s: half a pixel takes 20 ms, so that 190 ms have nine whole intervals and a half. */
static void check_known_flow(const char *device) {
    const moves to_the_left[] = {{speed, 0, 0}, {0, -speed, 0}, {0, 0, -speed}};
    const moves apart[] = {{speed, -speed, 0}, {speed, 0, -speed}}; /* 50 px/s */
    for (int i = 0; i < 3; i++) assert_int_equal(renders(device, &to_the_left[i], 0.5, 0.19), 11);
    for (int i = 0; i < 3; i++) assert_int_equal(renders(device, &to_the_left[i], 0.25, 0.185), 20);
    for (int i = 0; i < 2; i++) assert_int_equal(renders(device, &apart[i], 0.5, 0.185), 20);
}

static void known_flow(void **state) {
    (void)state;
    check_known_flow("reference");
}

static void known_flow_opencl(void **state) {
    (void)state;
    tides_device *device = NULL;
    if (tides_device_open("cpu", &device, NULL) != TIDES_OK) skip();
    tides_device_close(device);
    check_known_flow("cpu");
}

/* Nothing moves: the slowest rate, 30 Hz. */
static void at_rest(void **state) {
    (void)state;
    assert_int_equal(renders("reference", &(moves){0, 0, 0}, 0.5, 0.19), 7);
}

/* A camera that turns: u_dot = -fx w (1 + x^2), v_dot = -fy w x y whatever the depth; the largest is at the image's corners. */
static void turning_camera(void **state) {
    (void)state;
    const double rate = 0.3, x = 23.5 / 50, y = 17.5 / 50;
    tides_device *device = NULL;
    tides_trajectory *camera = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_pose_sample samples[2];
    double Z[WIDTH * HEIGHT], fastest = 0;
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 2; i++) {
        samples[i].time = i;
        samples[i].quaternion[0] = cos(0.5 * rate * i);
        samples[i].quaternion[2] = sin(0.5 * rate * i);
        samples[i].angular_velocity[1] = rate;
        samples[i].has_rates = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, 2, &camera, &error), &error);
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    tides_scene *scene = make_wall(0, 0);
    tides_renderer *renderer = make_renderer(device, scene);
    for (int i = 0; i < WIDTH * HEIGHT; i++) Z[i] = 1 + i % 7;
    scene_expect_ok(td_renderer_flow(renderer, camera, 0, 0, 1, Z, &fastest, &error), &error);
    assert_true(fabs(fastest - 50 * rate * hypot(1 + x * x, x * y)) < 1e-9);
    memset(Z, 0, sizeof Z); /* nothing there: no flow, but what moves by itself */
    scene_expect_ok(td_renderer_flow(renderer, camera, 0, 0, 1, Z, &fastest, &error), &error);
    assert_false(fastest > 0);
    tides_renderer_destroy(renderer);
    tides_scene_destroy(scene);
    tides_trajectory_destroy(camera);
    tides_device_close(device);
}

static void not_on_frames(void **state) {
    (void)state;
    double Y[2 * WIDTH * HEIGHT] = {0}, times[2] = {0, 1};
    tides_frames *frames = NULL;
    tides_error error = {TIDES_OK, ""};
    scene_expect_ok(tides_frames_from_memory(Y, times, 2, WIDTH, HEIGHT, &frames, &error), &error);
    tides_baseline *baseline = make_esim(0.5);
    const tides_frame_supply supply = {.frames = frames, .start = 0, .stop = 1};
    scene_expect_error(tides_baseline_run(baseline, &supply, NULL, NULL, NULL, NULL, NULL, &error), TIDES_UNSUPPORTED, &error,
                       "simulation_adaptive_sampling_method|motion|none");
    tides_baseline_destroy(baseline);
    tides_frames_close(frames);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_flow),     cmocka_unit_test(known_flow_opencl), cmocka_unit_test(at_rest),
        cmocka_unit_test(turning_camera), cmocka_unit_test(not_on_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
