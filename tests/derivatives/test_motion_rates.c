/* Rates of images of Gaussians that move by themselves, against central differences of the double reference: from a model's own
 * clock to pixels. Jumps of the stop rule are switched off; pixels with kinks are found by their second differences, and left
 * out. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/moving_scene.h"

#include <math.h>
#include <stdlib.h>

#define STEP 1e-6 /* h [s] */
#define TOLERANCE 1e-6
#define KINK 1e-7
enum { NODES = 5, WIDTH = 48, HEIGHT = 32, PIXELS = WIDTH * HEIGHT };

static const int values[] = {TIDES_L, TIDES_ALPHA, TIDES_R, TIDES_G, TIDES_B};
static const int rates[] = {TIDES_L_DOT, TIDES_ALPHA_DOT, TIDES_R_DOT, TIDES_G_DOT, TIDES_B_DOT};
enum { PAIRS = sizeof values / sizeof *values };

/* A renderer whose image has no stop. */
static tides_renderer *smooth_renderer(tides_device *device, const moving_scene *s) {
    tides_renderer *renderer = make_renderer(device, s->scene, &s->base.camera, TIDES_RULES_SMOOTH);
    tides_error error;
    renderer->image.stop = 0;
    td_image_numbers numbers = td_image_pack(&renderer->image);
    renderer->backend->type->destroy(renderer->backend);
    scene_expect_ok(td_backend_create_f64(&renderer->store, &numbers, &renderer->backend, &error), &error);
    return renderer;
}

static void render(tides_renderer *renderer, const tides_trajectory *path, double time, double *planes) {
    tides_frame frame = {{NULL}};
    tides_error error;
    for (int p = 0; p < PAIRS; p++) {
        frame.plane[values[p]] = planes + 2 * p * PIXELS;
        frame.plane[rates[p]] = planes + (2 * p + 1) * PIXELS;
    }
    scene_expect_ok(tides_renderer_frame(renderer, path, time, &frame, &error), &error);
}

static void check_at(uint64_t seed, int degree, double time) {
    static const double offset[NODES] = {-1, -0.5, 0, 0.5, 1};
    tides_device *device = open_device("reference");
    random_recipe recipe = recipe_of(seed);
    recipe.width = WIDTH;
    recipe.height = HEIGHT;
    recipe.sh_degree = degree;
    moving_scene s = moving_scene_make(&recipe, 0.6);
    tides_renderer *renderer = smooth_renderer(device, &s);
    double *frames = calloc((size_t)NODES * 2 * PAIRS * PIXELS, sizeof *frames);
    int kinks = 0, moving = 0;
    assert_non_null(frames);
    for (int k = 0; k < NODES; k++)
        render(renderer, s.base.path, time + STEP * offset[k], frames + (size_t)k * 2 * PAIRS * PIXELS);
    for (int p = 0; p < PAIRS; p++) {
        const double *rate = frames + (size_t)2 * 2 * PAIRS * PIXELS + (size_t)(2 * p + 1) * PIXELS;
        double largest = 0;
        for (int i = 0; i < PIXELS; i++) largest = fmax(largest, fabs(rate[i]));
        for (int i = 0; i < PIXELS; i++) {
            double f[NODES], h = STEP;
            for (int k = 0; k < NODES; k++)
                f[k] = frames[(size_t)k * 2 * PAIRS * PIXELS + (size_t)(2 * p) * PIXELS + (size_t)i];
            double whole = (f[4] - 2 * f[2] + f[0]) / h, half = (f[3] - 2 * f[2] + f[1]) / (0.5 * h);
            if (fabs(whole - 2 * half) > KINK * largest) {
                kinks++;
                continue;
            }
            moving += fabs(rate[i]) > 0.01 * largest;
            double difference = (4 * (f[3] - f[1]) / h - (f[4] - f[0]) / (2 * h)) / 3;
            if (!(fabs(rate[i] - difference) <= TOLERANCE * largest))
                fail_msg("seed %d, degree %d, channel %s, pixel %d: rate %.12g, difference %.12g, largest %g", (int)seed,
                         degree, tides_channel_name(values[p]), i, rate[i], difference, largest);
        }
    }
    if (kinks > 0.01 * PAIRS * PIXELS || moving < 0.2 * PAIRS * PIXELS)
        fail_msg("seed %d: %d at kinks, %d moving", (int)seed, kinks, moving);
    free(frames);
    tides_renderer_destroy(renderer);
    moving_scene_free(&s);
    tides_device_close(device);
}

static void test_rates(void **state) {
    (void)state;
    for (int degree = 0; degree < 4; degree++) {
        check_at(700 + (uint64_t)degree, degree, 0.3217); /* before the knot */
        check_at(710 + (uint64_t)degree, degree, 0.6431); /* and after it */
    }
}

/* A frame beyond the motion's time is refused in words that help. */
static void test_time_out_of_range(void **state) {
    (void)state;
    tides_device *device = open_device("reference-f32");
    random_recipe recipe = recipe_of(730);
    moving_scene s = moving_scene_make(&recipe, 0.6);
    tides_renderer *renderer = make_renderer(device, s.scene, &s.base.camera, TIDES_RULES_SMOOTH);
    double *plane = calloc((size_t)recipe.width * (size_t)recipe.height, sizeof *plane);
    tides_frame frame = {{NULL}};
    tides_error error;
    frame.plane[TIDES_L] = plane;
    assert_int_equal(tides_scene_set_duration(s.scene, 0.5), 2);
    tides_renderer_destroy(renderer);
    renderer = make_renderer(device, s.scene, &s.base.camera, TIDES_RULES_SMOOTH);
    scene_expect_ok(tides_renderer_frame(renderer, s.base.path, 0.5, &frame, &error), &error);
    assert_int_equal(tides_renderer_frame(renderer, s.base.path, 0.51, &frame, &error), TIDES_OUT_OF_RANGE);
    assert_non_null(strstr(error.text, "scene.duration_s"));
    free(plane);
    tides_renderer_destroy(renderer);
    moving_scene_free(&s);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rates), cmocka_unit_test(test_time_out_of_range)};
    return cmocka_run_group_tests_name("rates of moving Gaussians", tests, NULL, NULL);
}
