/* Ground truth and its image: alpha is the image's, the instance is the one that covers most, a PSF blurs nothing, only planes
 * asked for are given, and on a textured plane L_dot is -grad(L) . flow. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"
#include "tides/truth.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

typedef struct planes {
    double truth[TIDES_TRUTHS][PIXELS];
    double L[PIXELS], L_dot[PIXELS], alpha[PIXELS];
} planes;

static void take_truth(tides_renderer *renderer, const tides_trajectory *camera, double time, planes *to) {
    tides_truth truth;
    tides_error error;
    for (int i = 0; i < TIDES_TRUTHS; i++) truth.plane[i] = to->truth[i];
    scene_expect_ok(tides_renderer_truth(renderer, camera, time, &truth, &error), &error);
}

static void take_image(tides_renderer *renderer, const tides_trajectory *camera, double time, planes *to) {
    tides_frame frame = {{NULL}};
    tides_error error;
    frame.plane[TIDES_L] = to->L;
    frame.plane[TIDES_L_DOT] = to->L_dot;
    frame.plane[TIDES_ALPHA] = to->alpha;
    scene_expect_ok(tides_renderer_frame(renderer, camera, time, &frame, &error), &error);
}

static planes *make_planes(void) {
    planes *made = calloc(1, sizeof *made);
    assert_non_null(made);
    return made;
}

/* -- the same image ------------------------------------------------------------------------------------------------ */

static void test_alpha_is_the_images(void **state) {
    const double stop = 3e-5; /* inria's lists end where T is below 1e-4, smooth ones where L changes by 1e-5 */
    (void)state;
    for (int rules = 0; rules < RULES; rules++) {
        random_recipe recipe = recipe_of(1711 + (uint64_t)rules);
        recipe.width = WIDTH;
        recipe.height = HEIGHT;
        recipe.count = 600;
        recipe.opacity_max = 0.999;
        random_scene scene = random_scene_make(&recipe);
        tides_device *device = open_fast_device();
        tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, rules);
        planes *got = make_planes(), *blurred = make_planes();
        tides_error error;
        take_truth(renderer, scene.path, 0.4, got);
        take_image(renderer, scene.path, 0.4, got);
        double worst = 0, low = 1, high = 0;
        for (int i = 0; i < PIXELS; i++) {
            const double alpha = got->truth[TIDES_TRUTH_ALPHA][i];
            worst = fmax(worst, fabs(alpha - got->alpha[i]));
            low = fmin(low, alpha);
            high = fmax(high, alpha);
            assert_true(alpha <= 0 || got->truth[TIDES_TRUTH_INSTANCE][i] >= 0);
            if (fabs(alpha - 0.5) > 1e-5) assert_true((got->truth[TIDES_TRUTH_DEPTH_MEDIAN][i] > 0) == (alpha > 0.5));
        }
        print_message("rules %d: alpha from %.3g to %.6g, off by %.2g\n", rules, low, high, worst);
        assert_true(low < 0.5 && high > 0.99 && worst < stop);
        scene_expect_ok(tides_renderer_set_psf(renderer, 1.5, TIDES_PSF_LOG, &error), &error);
        take_truth(renderer, scene.path, 0.4, blurred);
        assert_memory_equal(blurred->truth, got->truth, sizeof got->truth);
        free(got);
        free(blurred);
        tides_renderer_destroy(renderer);
        tides_device_close(device);
        random_scene_free(&scene);
    }
}

/* -- objects ------------------------------------------------------------------------------------------------------- */

/* Twelve balls in a row, an object each, before a wall, which is the last one; the wall has a hole. */
static void test_instances(void **state) {
    enum { BALLS = 12, LENS = 40 };
    const tides_intrinsics lens = {WIDTH, HEIGHT, LENS, LENS, WIDTH / 2.0, HEIGHT / 2.0, {0}};
    const double origin[3] = {0}, ahead[4] = {1, 0, 0, 0};
    tides_scene *scene = NULL;
    tides_trajectory *camera = NULL;
    tides_error error;
    (void)state;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_trajectory_create_static(origin, ahead, &camera, &error), &error);
    for (int i = 0; i < BALLS; i++) {
        splat_set ball = {0};
        splat_set_ball(&ball, 0.4 * (i - 5.5), 0, 3, 0.08, 0.99, 0.5);
        world_add(scene, &ball, NULL);
    }
    splat_set wall = {0};
    for (int row = 0; row < 28; row++)
        for (int i = 0; i < 40; i++) splat_set_ball(&wall, 0.25 * (i - 19.5), 0.25 * (row - 19.5), 6, 0.2, 0.9, 0.2);
    world_add(scene, &wall, NULL);
    tides_device *device = open_fast_device();
    tides_renderer *renderer = make_renderer(device, scene, &lens, TIDES_RULES_SMOOTH);
    planes *got = make_planes();
    take_truth(renderer, camera, 0, got);
    for (int i = 0; i < BALLS; i++) { /* the pixel of its middle */
        const int at = HEIGHT / 2 * WIDTH + (int)(WIDTH / 2.0 + LENS * 0.4 * (i - 5.5) / 3);
        assert_true(got->truth[TIDES_TRUTH_INSTANCE][at] == i);
        assert_true(fabs(got->truth[TIDES_TRUTH_DEPTH_MEDIAN][at] - 3) < 0.03);
    }
    assert_true(got->truth[TIDES_TRUTH_INSTANCE][5 * WIDTH + 5] == BALLS);
    assert_true(fabs(got->truth[TIDES_TRUTH_DEPTH][5 * WIDTH + 5] - 6) < 0.02);
    assert_true(got->truth[TIDES_TRUTH_INSTANCE][(HEIGHT - 1) * WIDTH + 5] == -1);
    assert_true(got->truth[TIDES_TRUTH_DEPTH][(HEIGHT - 1) * WIDTH + 5] == 0);
    free(got);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
}

/* -- brightness is constant ---------------------------------------------------------------------------------------- */

static const double shift_px = 0.01;

/* The image with its lens moved by (x, y) pixels. */
static void take_shifted(const tides_scene *scene, const tides_trajectory *camera, tides_device *device, double x, double y,
                         planes *to) {
    const tides_intrinsics lens = {WIDTH, HEIGHT, 80, 80, WIDTH / 2.0 + x, HEIGHT / 2.0 + y, {0}};
    tides_renderer *renderer = make_renderer(device, scene, &lens, TIDES_RULES_SMOOTH);
    take_image(renderer, camera, 0.5, to);
    if (x == 0 && y == 0) take_truth(renderer, camera, 0.5, to);
    tides_renderer_destroy(renderer);
}

/* rms of L_dot + grad(L) . flow over rms of L_dot, where the plane is whole. */
static double residual_of(const double velocity[3], double *fastest) {
    tides_scene *scene = NULL;
    tides_error error;
    splat_set set = {0};
    shaking s = {.centre_time = 0.5};
    uint64_t seed = 17;
    planes *at[5];
    memcpy(s.velocity, velocity, sizeof s.velocity);
    tides_trajectory *camera = shaking_path(&s, 0, 1, 0.125, 1);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    for (int i = 0; i < 6000; i++) { /* discs that face the camera, of all sizes, each a little behind the one before */
        const double sigma = world_between_log(&seed, 0.06, 0.2), grey = scene_between(&seed, 0.05, 1);
        const splat one = {.mean = {scene_between(&seed, -3, 3), scene_between(&seed, -2.5, 2.5), 4 + 1e-5 * i},
                           .sigma = {sigma, sigma * scene_between(&seed, 0.5, 1), exp(-20)},
                           .opacity = 0.9,
                           .rgb = {grey, grey, grey}};
        splat_set_add(&set, &one);
    }
    world_add(scene, &set, NULL);
    tides_device *device = open_device("reference");
    for (int i = 0; i < 5; i++) {
        const double x[5] = {0, shift_px, -shift_px, 0, 0}, y[5] = {0, 0, 0, shift_px, -shift_px};
        at[i] = make_planes();
        take_shifted(scene, camera, device, x[i], y[i], at[i]);
    }
    double left = 0, all = 0;
    *fastest = 0;
    for (int i = 0; i < PIXELS; i++) {
        const double u = at[0]->truth[TIDES_TRUTH_FLOW_U][i], v = at[0]->truth[TIDES_TRUTH_FLOW_V][i];
        if (at[0]->truth[TIDES_TRUTH_ALPHA][i] < 0.999) continue;
        const double L_x = (at[2]->L[i] - at[1]->L[i]) / (2 * shift_px), L_y = (at[4]->L[i] - at[3]->L[i]) / (2 * shift_px);
        const double off = at[0]->L_dot[i] + L_x * u + L_y * v;
        left += off * off;
        all += at[0]->L_dot[i] * at[0]->L_dot[i];
        *fastest = fmax(*fastest, hypot(u, v));
    }
    for (int i = 0; i < 5; i++) free(at[i]);
    tides_device_close(device);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return sqrt(left / all);
}

/* Sideways the image moves as a whole, but for what the Jacobian of EWA changes with the angle of view; in a dolly the
 * dilation of 0.3 px^2 doesn't grow with the splats. */
static void test_brightness_is_constant(void **state) {
    static const double sideways[3] = {1, 0.5, 0}, forwards[3] = {0, 0, 1.5};
    double fastest;
    (void)state;
    double residual = residual_of(sideways, &fastest);
    print_message("sideways at %.3g px/s: L_dot + grad(L) . flow is %.2g of L_dot\n", fastest, residual);
    assert_true(fastest > 10 && residual < 0.003);
    residual = residual_of(forwards, &fastest);
    print_message("forwards at %.3g px/s: L_dot + grad(L) . flow is %.2g of L_dot\n", fastest, residual);
    assert_true(fastest > 10 && residual < 0.04);
}

/* -- wrong input --------------------------------------------------------------------------------------------------- */

static void test_what_is_asked(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(1712);
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_device("reference-f32");
    tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, TIDES_RULES_SMOOTH);
    const size_t pixels = (size_t)recipe.width * (size_t)recipe.height;
    double *some = calloc(2 * pixels, sizeof *some);
    tides_truth truth = {{NULL}};
    tides_render_stats before, after;
    tides_error error;
    assert_non_null(some);
    tides_renderer_stats(renderer, &before);
    scene_expect_ok(tides_renderer_truth(renderer, scene.path, 0.4, &truth, &error), &error); /* nothing costs nothing */
    tides_renderer_stats(renderer, &after);
    assert_int_equal(after.tile_jobs, before.tile_jobs);
    assert_int_equal(tides_renderer_truth(renderer, scene.path, 0.4, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_renderer_truth(renderer, NULL, 0.4, &truth, &error), TIDES_BAD_ARGUMENT);
    truth.plane[TIDES_TRUTH_NORMAL_Z] = some;
    scene_expect_ok(tides_renderer_truth(renderer, scene.path, 0.4, &truth, &error), &error);
    for (size_t i = 0; i < pixels; i++) assert_true(some[i] <= 0 && some[i] >= -1.00001 && some[pixels + i] == 0);
    assert_int_equal(tides_renderer_truth(renderer, scene.path, 17, &truth, &error), TIDES_OUT_OF_RANGE);
    for (int i = 0; i < TIDES_TRUTHS; i++) assert_non_null(tides_truth_name(i));
    assert_null(tides_truth_name(-1));
    assert_null(tides_truth_name(TIDES_TRUTHS));
    free(some);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_alpha_is_the_images), cmocka_unit_test(test_instances),
                                       cmocka_unit_test(test_brightness_is_constant), cmocka_unit_test(test_what_is_asked)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
