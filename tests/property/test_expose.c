/* Exposed frames: a pixel's light is the mean of many sharp frames', within the tolerance and the reported error. Each row of a
 * rolling shutter is that of renders at its own time. Nothing that passes quickly is missed, and wrong input is refused. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"
#include "tides/exposure.h"
#include "tides/sensor.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 61, HEIGHT = 43, PIXELS = WIDTH * HEIGHT, LOOKS = 256 };

static tides_exposure exposure_of(double exposure_s, double tolerance, int colour) {
    tides_exposure e;
    tides_exposure_defaults(&e);
    e.exposure_s = exposure_s;
    e.tolerance = tolerance;
    e.colour = colour;
    return e;
}

static double *expose(tides_renderer *renderer, const tides_trajectory *path, double time, const tides_exposure *e,
                      tides_exposed *done) {
    double *light = calloc((size_t)PIXELS * 3, sizeof *light);
    tides_error error;
    assert_non_null(light);
    scene_expect_ok(tides_renderer_expose(renderer, path, time, e, light, done, &error), &error);
    return light;
}

/* Adds a share of the sharp frame at `time` to the sum, planes as an exposure's; `row` -1: all. */
static void add_sharp(tides_renderer *renderer, const tides_trajectory *path, double time, int colour, int row, double share,
                      double *sum) {
    static double planes[3][PIXELS];
    tides_frame frame = {{NULL}};
    tides_error error;
    for (int c = 0; c < 3; c++) frame.plane[colour ? TIDES_R + c : TIDES_Y] = planes[colour ? c : 0];
    scene_expect_ok(tides_renderer_frame(renderer, path, time, &frame, &error), &error);
    for (int c = 0; c < (colour ? 3 : 1); c++)
        for (int i = 0; i < PIXELS; i++)
            if (row < 0 || i / WIDTH == row) sum[c * PIXELS + i] += share * planes[c][i];
}

/* The mean of `looks` sharp frames over [start, stop], in the middles of as many parts. */
static double *mean_of(tides_renderer *renderer, const tides_trajectory *path, double start, double stop, int looks,
                       int colour) {
    double *sum = calloc((size_t)PIXELS * 3, sizeof *sum);
    assert_non_null(sum);
    for (int k = 0; k < looks; k++)
        add_sharp(renderer, path, start + (stop - start) * (k + 0.5) / looks, colour, -1, 1.0 / looks, sum);
    return sum;
}

static double farthest(const double *a, const double *b, int count) {
    double most = 0;
    for (int i = 0; i < count; i++) most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

static void a_frame_is_the_mean_of_sharp_ones(void **state) {
    (void)state;
    for (int trial = 0; trial < 3; trial++) {
        const int colour = trial % 2;
        random_recipe recipe = recipe_of(301 + (uint64_t)trial);
        recipe.size = 0.05;
        recipe.camera_speed = 2;
        random_scene scene = random_scene_make(&recipe);
        tides_device *device = open_fast_device();
        tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, trial == 2 ? TIDES_RULES_INRIA : 0);
        double *mean = mean_of(renderer, scene.path, 0.45, 0.55, LOOKS, colour);
        const double own = trial == 2 ? 2e-3 : 2e-5; /* what the mean itself may be off by: jumps / looks, else its square */
        for (int k = 0; k < 3; k++) {
            const double tolerance = pow(10, -1.5 - k);
            const tides_exposure e = exposure_of(0.1, tolerance, colour);
            tides_exposed done;
            double *light = expose(renderer, scene.path, 0.5, &e, &done);
            const double off = farthest(light, mean, PIXELS * (colour ? 3 : 1));
            print_message("trial %d tolerance %.2g: off %.2g, said %.2g, %.1f renders\n", trial, tolerance, off, done.error,
                          done.renders);
            assert_true(done.error <= tolerance && done.unsettled == 0);
            assert_true(off <= done.error + own);
            free(light);
        }
        free(mean);
        tides_renderer_destroy(renderer);
        tides_device_close(device);
        random_scene_free(&scene);
    }
}

static void each_row_has_its_own_time(void **state) {
    (void)state;
    for (int trial = 0; trial < 3; trial++) {
        random_recipe recipe = recipe_of(401);
        random_scene scene = random_scene_make(&recipe);
        tides_device *device = open_fast_device();
        tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, 0);
        tides_exposure e = exposure_of(trial == 1 ? 0.01 : 0, 1e-3, trial == 2);
        const int planes = tides_exposure_planes(&e);
        e.shutter = TIDES_SHUTTER_ROLLING;
        e.row_time_s = trial == 1 ? -2e-3 : 2e-3;
        double *light = expose(renderer, scene.path, 0.5, &e, NULL), *rows = calloc((size_t)PIXELS * 3, sizeof *rows);
        for (int y = 0; y < HEIGHT; y++) {
            double start, stop;
            tides_exposure_row(&e, HEIGHT, 0.5, y, &start, &stop);
            const int looks = stop > start ? 24 : 1;
            for (int k = 0; k < looks; k++)
                add_sharp(renderer, scene.path, start + (stop - start) * (k + 0.5) / looks, e.colour, y, 1.0 / looks, rows);
        }
        const double off = farthest(light, rows, PIXELS * planes);
        print_message("rolling %d: off %.2g\n", trial, off);
        assert_true(off <= e.tolerance);
        double first, last, span_first, span_last;
        const int rows_back = e.row_time_s < 0; /* the last row is first */
        tides_exposure_row(&e, HEIGHT, 0.5, rows_back ? HEIGHT - 1 : 0, &first, NULL);
        tides_exposure_row(&e, HEIGHT, 0.5, rows_back ? 0 : HEIGHT - 1, NULL, &last);
        tides_exposure_span(&e, HEIGHT, 0.5, &span_first, &span_last);
        assert_true(span_first == first && span_last == last);
        free(rows);
        free(light);
        tides_renderer_destroy(renderer);
        tides_device_close(device);
        random_scene_free(&scene);
    }
}

/* An instant is the frame itself, to the bit; and light blurred by the optics is the blurred mean. */
static void instants_and_optics(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(501);
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_fast_device();
    tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, 0);
    tides_exposure e = exposure_of(0, 1e-3, 0);
    tides_error error;
    tides_exposed done;
    double *sharp = mean_of(renderer, scene.path, 0.5, 0.5, 1, 0), *light = expose(renderer, scene.path, 0.5, &e, &done);
    assert_memory_equal(sharp, light, PIXELS * sizeof *light);
    assert_true(done.error == 0 && done.renders == 1);
    scene_expect_ok(tides_renderer_set_psf(renderer, 2, TIDES_PSF_LINEAR, &error), &error);
    double *blurred = expose(renderer, scene.path, 0.5, &e, NULL), *wanted = mean_of(renderer, scene.path, 0.5, 0.5, 1, 0);
    assert_true(farthest(blurred, wanted, PIXELS) < 1e-6); /* Y = e^L - log_eps, in single precision */
    assert_true(farthest(blurred, light, PIXELS) > 1e-3);
    e.shutter = TIDES_SHUTTER_ROLLING;
    assert_int_equal(tides_renderer_expose(renderer, scene.path, 0.5, &e, light, NULL, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "psf_sigma_px"));
    free(wanted);
    free(blurred);
    free(light);
    free(sharp);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&scene);
}

/* A small bright splat crosses the image in one exposure: its streak has no gaps, though each tile sees it for a moment. */
static void nothing_passes_unseen(void **state) {
    (void)state;
    splat_set set = {0};
    splat_set_ball(&set, 0, 0, 4, 0.03, 0.99, 1);
    tides_gaussians view = splat_set_view(&set);
    tides_scene *scene = scene_new();
    tides_error error;
    const shaking s = {.velocity = {3.6, 0.2, 0}, .centre_time = 0.5};
    tides_trajectory *moves = shaking_path(&s, 0, 1, 0.25, 1), *still = NULL;
    const double origin[3] = {0, 0, 0}, upright[4] = {1, 0, 0, 0};
    scene_expect_ok(tides_trajectory_create_static(origin, upright, &still, &error), &error);
    scene_expect_ok(tides_scene_add(scene, &view, moves, 1, "ball", NULL, &error), &error);
    const tides_intrinsics lens = {.width = WIDTH, .height = HEIGHT, .fx = 60, .fy = 60, .cx = 30.5, .cy = 21.5};
    tides_device *device = open_fast_device();
    tides_renderer *renderer = make_renderer(device, scene, &lens, 0);
    const tides_exposure e = exposure_of(1, 1e-3, 0);
    tides_exposed done;
    double *light = expose(renderer, still, 0.5, &e, &done), *mean = mean_of(renderer, still, 0, 1, 600, 0);
    print_message("streak: off %.2g, said %.2g, %.1f renders\n", farthest(light, mean, PIXELS), done.error, done.renders);
    assert_true(farthest(light, mean, PIXELS) <= e.tolerance);
    free(mean);
    free(light);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    tides_scene_destroy(scene);
    tides_trajectory_destroy(still);
    tides_trajectory_destroy(moves);
    splat_set_free(&set);
}

static void wrong_input_is_refused(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(601);
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_device("reference-f32");
    tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, 0);
    static double light[PIXELS];
    static uint16_t values[PIXELS];
    tides_error error;
    tides_exposure e = exposure_of(-1, 1e-3, 0);
    assert_int_equal(tides_renderer_expose(renderer, scene.path, 0.5, &e, light, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "exposure.exposure_s"));
    e = exposure_of(0.1, 0, 0);
    assert_int_equal(tides_renderer_expose(renderer, scene.path, 0.5, &e, light, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "exposure.tolerance"));
    e = exposure_of(0.1, 1e-2, 0);
    assert_int_equal(tides_renderer_expose(renderer, scene.path, 0.99, &e, light, NULL, &error), TIDES_OUT_OF_RANGE);
    e.bits = 12;
    assert_int_equal(tides_exposure_values(&e, WIDTH, HEIGHT, 0, light, values, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "exposure.bits"));
    e.bits = 8;
    e.transfer = 1;
    e.gamma = 2;
    assert_int_equal(tides_exposure_values(&e, WIDTH, HEIGHT, 0, light, values, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "exposure.gamma"));
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_the_mean_of_sharp_ones),
        cmocka_unit_test(each_row_has_its_own_time),
        cmocka_unit_test(instants_and_optics),
        cmocka_unit_test(nothing_passes_unseen),
        cmocka_unit_test(wrong_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
