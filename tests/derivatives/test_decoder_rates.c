/* Images whose colours a decoder makes. Rates equal central differences of the double reference under a moving camera, on
 * splats and where only the decoder's background is. The OpenCL kernels equal single precision to the bit. Such a scene is
 * refused beside others. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"
#include "td_device.h"
#include "tests/support/random_motion.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 150, HEIGHT = 90, PIXELS = WIDTH * HEIGHT, CHANNELS = 8 };
static const uint64_t SEED = 12;
static const int channels[CHANNELS] = {TIDES_R, TIDES_G, TIDES_B, TIDES_L, TIDES_R_DOT, TIDES_G_DOT, TIDES_B_DOT, TIDES_L_DOT};

static tides_scene *make_scene(random_motion *made) {
    tides_error error = {0, ""};
    tides_scene *scene = NULL;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &made->gaussians, made->motion, 0, NULL, 1, "full", NULL, &error), &error);
    made->motion = NULL; /* the scene's now */
    return scene;
}

/* A camera that turns and moves, far enough off that some tiles see nothing. */
static tides_trajectory *make_camera(void) {
    tides_error error = {0, ""};
    tides_trajectory *camera = NULL;
    const tides_pose_sample samples[2] = {{.time = 0,
                                           .position = {0, 0, -9},
                                           .quaternion = {1, 0, 0, 0},
                                           .velocity = {2, 0.5, 1},
                                           .has_rates = 1,
                                           .angular_velocity = {0.1, -0.3, 0.2}},
                                          {.time = 1,
                                           .position = {1.5, 0.3, -8},
                                           .quaternion = {0.98, 0.05, -0.15, 0.1},
                                           .velocity = {1, 0, 1},
                                           .has_rates = 1,
                                           .angular_velocity = {0.2, -0.2, 0.1}}};
    scene_expect_ok(tides_trajectory_create(samples, 2, &camera, &error), &error);
    return camera;
}

typedef struct view_of {
    tides_device *device;
    tides_renderer *renderer;
    tides_trajectory *camera;
} view_of;

static int view_open(const char *name, int lanes, const tides_scene *scene, view_of *view) {
    const tides_intrinsics intrinsics = {WIDTH, HEIGHT, 140, 140, 75, 45, {0}};
    tides_error error = {0, ""};
    tides_image_params params;
    tides_image_params_defaults(&params); /* smooth: soft order, tapers */
    tides_status status = tides_device_open(name, &view->device, &error);
    if (status == TIDES_NO_DEVICE) return 0;
    scene_expect_ok(status, &error);
    view->device->info.lanes = lanes;
    view->camera = make_camera();
    scene_expect_ok(tides_renderer_create(view->device, scene, &intrinsics, &params, NULL, NULL, &view->renderer, &error),
                    &error);
    return 1;
}

static void view_close(view_of *view) {
    tides_renderer_destroy(view->renderer);
    tides_trajectory_destroy(view->camera);
    tides_device_close(view->device);
}

static void view_render(const view_of *view, double time, double *out) {
    tides_error error = {0, ""};
    tides_frame frame = {{NULL}};
    for (int c = 0; c < CHANNELS; c++) frame.plane[channels[c]] = out + (size_t)c * PIXELS;
    scene_expect_ok(tides_renderer_frame(view->renderer, view->camera, time, &frame, &error), &error);
}

/* Kinks (a relu, a clamp, alpha_max) and the stop, which the smooth rules bound, may lie within a difference: there the two
 * one-sided ones disagree. */
static void test_rates_equal_differences(void **state) {
    static double before[CHANNELS * PIXELS], here[CHANNELS * PIXELS], after[CHANNELS * PIXELS];
    const double h = 2e-6;
    random_motion made = random_motion_make(RANDOM_MOTION_DECODER, SEED);
    tides_scene *scene = make_scene(&made);
    view_of view;
    size_t kinks = 0;
    double worst = 0;
    (void)state;
    assert_int_equal(view_open("reference", 1, scene, &view), 1);
    view_render(&view, 0.4 - h, before);
    view_render(&view, 0.4, here);
    view_render(&view, 0.4 + h, after);
    for (size_t c = 0; c < 4; c++) {
        double largest = 0;
        for (size_t i = 0; i < PIXELS; i++) largest = fmax(largest, fabs(here[(4 + c) * PIXELS + i]));
        assert_true(largest > 0.01);
        for (size_t i = c * PIXELS; i < (c + 1) * PIXELS; i++) {
            double rate = here[4 * PIXELS + i], left = (here[i] - before[i]) / h, right = (after[i] - here[i]) / h;
            assert_true(isfinite(rate));
            if (fabs(left - right) > 1e-3 * largest) {
                kinks++;
                continue;
            }
            worst = fmax(worst, fabs(0.5 * (left + right) - rate) / largest);
        }
    }
    print_message("at most %.2g of the largest rate, %zu pixels at kinks\n", worst, kinks);
    assert_true(worst < 1e-6 && kinks < 4 * PIXELS / 100);
    tides_render_stats stats;
    tides_renderer_stats(view.renderer, &stats);
    assert_true(stats.tile_jobs == 3 * (uint64_t)stats.tiles); /* no tile is filled by formula */
    view_close(&view);
    tides_scene_destroy(scene);
    random_motion_free(&made);
}

/* The corner sees no splat: its colour is the decoder's, and moves with the ray. */
static void test_background_moves(void **state) {
    static double out[CHANNELS * PIXELS];
    random_motion made = random_motion_make(RANDOM_MOTION_DECODER, SEED);
    tides_scene *scene = make_scene(&made);
    view_of view;
    (void)state;
    assert_int_equal(view_open("reference", 1, scene, &view), 1);
    view_render(&view, 0.4, out);
    assert_true(out[0] > 0 && out[0] < 1);
    assert_true(out[4 * PIXELS] != 0 && out[0] != out[PIXELS - 1]);
    view_close(&view);
    tides_scene_destroy(scene);
    random_motion_free(&made);
}

static void test_kernels_equal_single_precision(void **state) {
    static double single[CHANNELS * PIXELS], device[CHANNELS * PIXELS];
    static const int widths[] = {16, 1};
    random_motion made = random_motion_make(RANDOM_MOTION_DECODER, SEED);
    tides_scene *scene = make_scene(&made);
    view_of view;
    (void)state;
    assert_int_equal(view_open("reference-f32", 1, scene, &view), 1);
    view_render(&view, 0.7, single);
    view_close(&view);
    for (int w = 0; w < 2; w++) {
        if (!view_open("cpu", widths[w], scene, &view)) skip();
        view_render(&view, 0.7, device);
        assert_memory_equal(single, device, sizeof device);
        view_close(&view);
    }
    tides_scene_destroy(scene);
    random_motion_free(&made);
}

static void test_alone_only(void **state) {
    const tides_intrinsics intrinsics = {WIDTH, HEIGHT, 140, 140, 75, 45, {0}};
    random_motion made = random_motion_make(RANDOM_MOTION_DECODER, SEED);
    tides_scene *scene = make_scene(&made);
    tides_image_params params;
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_error error = {0, ""};
    (void)state;
    scene_expect_ok(tides_scene_add(scene, &made.gaussians, NULL, 1, "still", NULL, &error), &error);
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    tides_image_params_defaults(&params);
    tides_status status = tides_renderer_create(device, scene, &intrinsics, &params, NULL, NULL, &renderer, &error);
    scene_expect_error(status, TIDES_UNSUPPORTED, &error, "SpacetimeGaussians|other objects");
    tides_device_close(device);
    tides_scene_destroy(scene);
    random_motion_free(&made);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rates_equal_differences), cmocka_unit_test(test_background_moves),
                                       cmocka_unit_test(test_kernels_equal_single_precision),
                                       cmocka_unit_test(test_alone_only)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
