/* Ground truth of events: that of whole frames at each event's pixel and time, to the bit, when it fired and not when it was
 * read; and as columns of a file, at an epoch of 1.4e9 s too. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/moving_scene.h"
#include "tests/support/scene_make.h"
#include "tides/truth.h"

#include <stdlib.h>

enum { EVENTS = 60, LATER = 4000000 };

static moving_scene make_scene(void) {
    random_recipe recipe = recipe_of(1717);
    recipe.opacity_max = 0.999;
    return moving_scene_make(&recipe, 0.5);
}

/* Events in order over 0.1 s, anywhere; each fired up to LATER ns before its t. */
static void make_events(const random_recipe *recipe, tides_event events[EVENTS], int64_t fired[EVENTS]) {
    uint64_t seed = 5;
    for (int i = 0; i < EVENTS; i++) {
        events[i] = (tides_event){.t = 400000000 + 1600000 * (int64_t)i,
                                  .x = (uint16_t)(scene_next(&seed) % (uint64_t)recipe->width),
                                  .y = (uint16_t)(scene_next(&seed) % (uint64_t)recipe->height),
                                  .polarity = 1};
        fired[i] = events[i].t - (int64_t)(scene_next(&seed) % LATER);
    }
}

/* Frames of all planes, one for each event. */
static void check_device(const char *spec, int rules) {
    moving_scene scene = make_scene();
    const random_recipe *recipe = &scene.base.recipe;
    const size_t pixels = (size_t)recipe->width * (size_t)recipe->height;
    tides_device *device = open_device(spec);
    tides_renderer *renderer = make_renderer(device, scene.scene, &scene.base.camera, rules);
    tides_event events[EVENTS];
    int64_t fired[EVENTS];
    tides_event_truth got[EVENTS];
    tides_truth truth = {{NULL}};
    tides_error error;
    double *planes = calloc(TIDES_TRUTHS * pixels, sizeof *planes);
    int seen = 0;
    assert_non_null(planes);
    for (int i = 0; i < TIDES_TRUTHS; i++) truth.plane[i] = planes + (size_t)i * pixels;
    make_events(recipe, events, fired);
    scene_expect_ok(tides_renderer_event_truth(renderer, scene.base.path, events, fired, EVENTS, got, &error), &error);
    for (int i = 0; i < EVENTS; i++) {
        const size_t at = (size_t)events[i].y * (size_t)recipe->width + events[i].x;
        scene_expect_ok(tides_renderer_truth(renderer, scene.base.path, 1e-9 * (double)fired[i], &truth, &error), &error);
        assert_memory_equal(&got[i].flow_u, &truth.plane[TIDES_TRUTH_FLOW_U][at], sizeof(double));
        assert_memory_equal(&got[i].flow_v, &truth.plane[TIDES_TRUTH_FLOW_V][at], sizeof(double));
        assert_memory_equal(&got[i].depth, &truth.plane[TIDES_TRUTH_DEPTH][at], sizeof(double));
        assert_memory_equal(&got[i].alpha, &truth.plane[TIDES_TRUTH_ALPHA][at], sizeof(double));
        assert_true(got[i].instance == truth.plane[TIDES_TRUTH_INSTANCE][at]);
        seen += got[i].alpha > 0.1;
    }
    assert_true(seen > EVENTS / 4);
    events[7].x = (uint16_t)recipe->width;
    assert_int_equal(tides_renderer_event_truth(renderer, scene.base.path, events, NULL, EVENTS, got, &error),
                     TIDES_BAD_ARGUMENT);
    events[7].x = 0;
    events[7].t = 7000000000;
    assert_int_equal(tides_renderer_event_truth(renderer, scene.base.path, events, NULL, EVENTS, got, &error),
                     TIDES_OUT_OF_RANGE);
    free(planes);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    moving_scene_free(&scene);
}

static void test_events_have_their_frames(void **state) {
    (void)state;
    check_device("reference-f32", TIDES_RULES_SMOOTH);
    check_device("reference", TIDES_RULES_INRIA);
}

static void test_on_a_device(void **state) {
    tides_device *device = NULL;
    tides_error error;
    (void)state;
    if (tides_device_open("cpu", &device, &error) != TIDES_OK) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    tides_device_close(device);
    check_device("cpu", TIDES_RULES_SMOOTH);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_events_have_their_frames), cmocka_unit_test(test_on_a_device)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
