/* Pixels at times of their own: what a frame of that time shows there; in whatever order they are asked for. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "renderer_of.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 1400;
static const double START = 0.3, LENGTH = 0.005; /* [s] */
enum { POINTS = 700 };

/* Points all over the image and the interval, its ends too. */
static void scatter(const random_recipe *recipe, td_point *points) {
    for (int i = 0; i < POINTS; i++) {
        points[i].time = START + LENGTH * (double)(i * 37 % POINTS) / (POINTS - 1);
        points[i].x = i * 13 % recipe->width;
        points[i].y = i * 29 % recipe->height;
    }
}

/* Every 50th against a frame. */
static void check_against_frames(tides_renderer *renderer, const random_scene *s, const td_point *points,
                                 const td_point_value *values, int width, int height) {
    size_t pixels = (size_t)width * (size_t)height;
    double *L = malloc(2 * pixels * sizeof *L);
    assert_non_null(L);
    for (int i = 0; i < POINTS; i += 50) {
        tides_error error;
        tides_frame frame = {{NULL}};
        frame.plane[TIDES_L] = L;
        frame.plane[TIDES_L_DOT] = L + pixels;
        scene_expect_ok(td_renderer_frame(renderer, s->path, points[i].time, &frame, &error), &error);
        size_t at = (size_t)points[i].y * (size_t)width + (size_t)points[i].x;
        if (fabs(values[i].L - L[at]) > 1e-6 || fabs(values[i].L_dot - L[pixels + at]) > 1e-4 * (1 + fabs(values[i].L_dot)))
            fail_msg("point %d: %.9g and %.9g, the frame has %.9g and %.9g", i, values[i].L, values[i].L_dot, L[at],
                     L[pixels + at]);
    }
    free(L);
}

static void test_frames_pixels_in_any_order(void **state) {
    (void)state;
    tides_error error;
    random_recipe recipe = recipe_of(SEED);
    random_scene s = random_scene_make(&recipe);
    tides_device *device = open_device("reference");
    tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_SMOOTH);
    td_point points[POINTS], turned[POINTS];
    td_point_value values[POINTS], others[POINTS];
    scatter(&recipe, points);
    for (int i = 0; i < POINTS; i++) turned[i] = points[POINTS - 1 - i];
    scene_expect_ok(td_renderer_sweep(renderer, s.path, START, START + LENGTH, &error), &error);
    scene_expect_ok(td_renderer_points(renderer, s.path, points, POINTS, values, &error), &error);
    scene_expect_ok(td_renderer_points(renderer, s.path, turned, POINTS, others, &error), &error);
    for (int i = 0; i < POINTS; i++) assert_memory_equal(&values[i], &others[POINTS - 1 - i], sizeof *values);
    check_against_frames(renderer, &s, points, values, recipe.width, recipe.height);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_frames_pixels_in_any_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
