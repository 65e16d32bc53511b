/* Progress within an image: a callback gets shares that grow, and may stop any call that renders before a launch. The next call
 * then gives what it would have given, to the bit. On a device, and on a reference. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tides/exposure.h"
#include "tides/truth.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 61, HEIGHT = 43, PIXELS = WIDTH * HEIGHT, PLANES = 3 };

/* Who is told: counts, and stops the call at `stop_at` (-1: never). */
typedef struct listener {
    int calls, stop_at;
    double last;
} listener;

static int hear(void *user, double fraction, const char *stage) {
    listener *l = user;
    assert_string_equal(stage, "rendering");
    assert_true(fraction >= l->last && fraction <= 1);
    l->last = fraction;
    return l->calls++ == l->stop_at;
}

typedef tides_status call(tides_renderer *renderer, const tides_trajectory *path, double *planes, tides_error *error);

static tides_status frame(tides_renderer *renderer, const tides_trajectory *path, double *planes, tides_error *error) {
    tides_frame wanted = {{NULL}};
    wanted.plane[TIDES_L] = planes;
    wanted.plane[TIDES_L_DOT] = planes + PIXELS;
    return tides_renderer_frame(renderer, path, 0.02, &wanted, error);
}

static tides_status truth(tides_renderer *renderer, const tides_trajectory *path, double *planes, tides_error *error) {
    tides_truth wanted = {{NULL}};
    wanted.plane[TIDES_TRUTH_DEPTH] = planes;
    return tides_renderer_truth(renderer, path, 0.02, &wanted, error);
}

static tides_status exposed(tides_renderer *renderer, const tides_trajectory *path, double *planes, tides_error *error) {
    tides_exposure e;
    tides_exposure_defaults(&e);
    e.exposure_s = 0.01;
    e.tolerance = 0.1;
    return tides_renderer_expose(renderer, path, 0.02, &e, planes, NULL, error);
}

static tides_status in_colour(tides_renderer *renderer, const tides_trajectory *path, double *planes, tides_error *error) {
    tides_exposure e;
    tides_exposure_defaults(&e);
    e.exposure_s = 0.01;
    e.tolerance = 0.1;
    e.colour = 1;
    return tides_renderer_expose(renderer, path, 0.02, &e, planes, NULL, error);
}

/* Stopped at five of its launches in turn, the first and the last among them, and then let through. */
static void stop_everywhere(tides_renderer *renderer, const tides_trajectory *path, call *one) {
    static double expected[PLANES * PIXELS], planes[PLANES * PIXELS];
    tides_error error;
    memset(expected, 0, sizeof expected);
    memset(planes, 0, sizeof planes);
    scene_expect_ok(one(renderer, path, expected, &error), &error);
    listener l = {.stop_at = -1};
    scene_expect_ok(tides_renderer_set_progress(renderer, hear, &l, &error), &error);
    scene_expect_ok(one(renderer, path, planes, &error), &error);
    assert_memory_equal(planes, expected, sizeof planes);
    const int launches = l.calls;
    assert_true(launches >= 3); /* the sweep, and several launches */
    enum { STOPS = 4 };
    for (int k = 0; k <= STOPS; k++) {
        const int at = k * (launches - 1) / STOPS;
        l = (listener){.stop_at = at};
        assert_int_equal(one(renderer, path, planes, &error), TIDES_CANCELLED);
        assert_non_null(strstr(error.text, "stopped on request"));
        assert_int_equal(l.calls, at + 1);
    }
    l = (listener){.stop_at = -1};
    scene_expect_ok(one(renderer, path, planes, &error), &error);
    assert_memory_equal(planes, expected, sizeof planes);
    scene_expect_ok(tides_renderer_set_progress(renderer, NULL, NULL, &error), &error);
    scene_expect_ok(one(renderer, path, planes, &error), &error);
    assert_int_equal(l.calls, launches);
}

static void try_all(tides_device *device, int filter) {
    random_recipe recipe = recipe_of(77);
    recipe.camera_speed = 1;
    random_scene scene = random_scene_make(&recipe);
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.colour_filter = filter;
    scene_expect_ok(tides_renderer_create(device, scene.scene, &scene.camera, &params, NULL, NULL, &renderer, &error), &error);
    for (tides_renderer *one = renderer; one; one = one->beside) one->control.record_limit = 600; /* many launches */
    call *const calls[] = {frame, truth, filter ? in_colour : exposed};
    for (int i = 0; i < 3; i++) stop_everywhere(renderer, scene.path, calls[i]);
    tides_renderer_destroy(renderer);
    random_scene_free(&scene);
}

static void any_launch_may_be_the_last(void **state) {
    (void)state;
    tides_device *devices[] = {open_fast_device(), open_device("reference")};
    for (int i = 0; i < 2; i++) {
        try_all(devices[i], TIDES_FILTER_OFF);
        try_all(devices[i], TIDES_FILTER_RGGB);
        tides_device_close(devices[i]);
    }
    tides_error error;
    assert_int_equal(tides_renderer_set_progress(NULL, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(any_launch_may_be_the_last)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
