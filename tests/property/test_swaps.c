/* The search of swaps of depth (lib/render/swaps.c): which splats it looks at. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"

/* How many swaps are found of two splats that a motion model takes past each other, before a third one that rests or alone. */
static int swaps_of_moved(tides_device *device, int rests) {
    static const float mean[6] = {0, 0, 3.9f, 0, 0, 4.1f}, quaternion[8] = {1, 0, 0, 0, 1, 0, 0, 0}, logit[2] = {1, 1};
    static const float log_scale[6] = {-1, -1, -1, -1, -1, -1}, sh[6] = {-1, -1, -1, 1, 1, 1}, zero[8] = {0};
    static const float wide[2] = {9, 9}, way[18] = {[2] = 0.4f, [11] = -0.4f};
    static const float there[3] = {0, 0, 9};
    static const double here[3] = {0, 0, 0}, ahead[4] = {1, 0, 0, 0};
    const tides_intrinsics facts = {24, 20, 30, 30, 12.2, 9.7, {0}};
    const tides_gaussians two =
        {.count = 2, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    const tides_gaussians far =
        {.count = 1, .mean = there, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    const tides_polynomial_motion arrays = {.count = 2,
                                            .stop = 1,
                                            .opacity_centre = zero,
                                            .opacity_log_width = wide,
                                            .mean_coefficient = way,
                                            .quaternion_dot = zero};
    tides_scene *scene = NULL;
    tides_motion *motion = NULL;
    tides_trajectory *camera = NULL;
    tides_error error;
    int found = 0;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    if (rests) scene_expect_ok(tides_scene_add(scene, &far, NULL, 1, NULL, NULL, &error), &error);
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &two, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    scene_expect_ok(tides_trajectory_create_static(here, ahead, &camera, &error), &error);
    tides_renderer *renderer = make_renderer(device, scene, &facts, TIDES_RULES_SMOOTH);
    scene_expect_ok(td_renderer_sweep(renderer, camera, 0, 1, &error), &error);
    scene_expect_ok(td_renderer_find_swaps(renderer, camera, &error), &error);
    for (int block = 0; block < 4 * TD_TILE_BLOCKS; block++) {
        int count;
        td_renderer_swaps(renderer, block / TD_TILE_BLOCKS, block % TD_TILE_BLOCKS, &count);
        found += count;
    }
    tides_renderer_destroy(renderer);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return found;
}

static void test_moved_alone(void **state) {
    tides_device *device = open_device("reference");
    (void)state;
    const int alone = swaps_of_moved(device, 0), beside = swaps_of_moved(device, 1);
    if (!(alone > 0 && alone == beside)) fail_msg("%d swaps, and %d with a splat that rests", alone, beside);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_moved_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
