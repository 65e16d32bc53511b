/* Events of runs on record paths (stepping.paths): those of projections to within what paths may be off by, the same whatever
 * the order of the work and the number of calls; and what a run says of its paths. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/event_list.h"
#include "solver/td_simulator.h"
#include "td_device.h"
#include "tests/property/renderer_of.h"
#include "tests/support/model_steps.h"
#include "tests/support/moving_scene.h"
#include "tests/support/run_worlds.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 90;

/* RUN_START to RUN_STOP, across a sample of the camera's path and a knot of the bent motion, in one call or in many, launches
 * small where they are many. */
static stream simulate_on(tides_device *device, const tides_scene *scene, const tides_trajectory *camera,
                          const tides_intrinsics *intrinsics, int paths, int calls) {
    const double from = RUN_START, to = RUN_STOP;
    stream s;
    tides_error error;
    tides_image_params params;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_simulator *simulator = NULL;
    memset(&s, 0, sizeof s);
    tides_image_params_defaults(&params);
    tides_sensor_defaults(&sensor);
    model_steps(&stepping);
    sensor.threshold_on = sensor.threshold_off = 0.1;
    stepping.paths = paths;
    scene_expect_ok(tides_simulator_create(device, scene, camera, intrinsics, &params, &sensor, &stepping, from, to, NULL, NULL,
                                           &simulator, &error),
                    &error);
    if (calls > 1) simulator->renderer->record_limit = 100;
    for (int i = 1; i <= calls; i++)
        scene_expect_ok(tides_simulator_run(simulator, i < calls ? from + (to - from) * i / calls : to, collect, &s, NULL, NULL,
                                            &error),
                        &error);
    tides_simulator_stats(simulator, &s.stats);
    tides_simulator_destroy(simulator);
    return s;
}

static stream simulate(tides_device *device, const moving_scene *scene, int paths, int calls) {
    return simulate_on(device, scene->scene, scene->base.path, &scene->base.camera, paths, calls);
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *x = a, *y = b;
    if (x->y != y->y) return x->y < y->y ? -1 : 1;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return x->t < y->t ? -1 : x->t > y->t;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* In double steps hardly notice, so that streams are the same but for some nanoseconds. */
static void test_events_are_those_of_projections(void **state) {
    random_recipe recipe = recipe_of(SEED);
    moving_scene scene = moving_scene_make(&recipe, 0.5);
    tides_device *device = open_device("reference");
    stream a = simulate(device, &scene, 0, 1), b = simulate(device, &scene, 1, 1);
    (void)state;
    assert_true(a.count > 300);
    assert_int_equal(a.stats.render.path_nodes + a.stats.render.gaussians_on_paths + a.stats.render.gaussians_at_nodes, 0);
    assert_true(b.stats.render.gaussians_on_paths > 2 * b.stats.render.gaussians_projected);
    assert_true(b.stats.render.path_nodes >= 3 * 3 && b.stats.render.gaussians_at_nodes > b.stats.render.path_nodes);
    assert_int_equal(a.count, b.count);
    double *late = calloc(a.count, sizeof *late);
    assert_non_null(late);
    qsort(a.events, a.count, sizeof *a.events, by_pixel);
    qsort(b.events, b.count, sizeof *b.events, by_pixel);
    for (size_t i = 0; i < a.count; i++) {
        assert_true(a.events[i].x == b.events[i].x && a.events[i].y == b.events[i].y);
        assert_int_equal(a.events[i].polarity, b.events[i].polarity);
        late[i] = fabs(1e-9 * (double)(a.events[i].t - b.events[i].t));
    }
    qsort(late, a.count, sizeof *late, by_size);
    print_message("%d events; p50 %.2g s, p95 %.2g s, most %.2g s apart\n", (int)a.count, late[a.count / 2],
                  late[a.count * 95 / 100], late[a.count - 1]);
    assert_true(late[a.count * 95 / 100] < 2e-8);
    free(late);
    free(a.events);
    free(b.events);
    moving_scene_free(&scene);
    tides_device_close(device);
}

static void test_order_of_work_changes_nothing(void **state) {
    random_recipe recipe = recipe_of(SEED + 1);
    moving_scene scene = moving_scene_make(&recipe, 0.5);
    tides_device *device = open_fast_device();
    stream a = simulate(device, &scene, 1, 1), b = simulate(device, &scene, 1, 5);
    (void)state;
    assert_true(a.count > 300 && a.count == b.count);
    assert_memory_equal(a.events, b.events, a.count * sizeof *a.events);
    free(a.events);
    free(b.events);
    moving_scene_free(&scene);
    tides_device_close(device);
}

/* Every kind of motion: as many events but for some at the edge of a threshold, and most records from paths. What a decoder
 * colours has none: to the bit what it was. */
static void test_worlds(void **state) {
    static const char *const names[] = {"rigid",   "moving",   "callback", "timenet", "motion1",
                                        "motion2", "hexplane", "network",  "screw"};
    tides_device *device = open_fast_device();
    uint64_t on_paths = 0, projected = 0;
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        run_world world = run_world_make(names[i]);
        stream a = simulate_on(device, world.scene, world.path, &world.camera, 0, 1);
        stream b = simulate_on(device, world.scene, world.path, &world.camera, 1, 1);
        print_message("%s: %d events and %d; rows of motions %d and %d; %d projected, %d at nodes, %d on paths\n", names[i],
                      (int)a.count, (int)b.count, (int)a.stats.render.gaussians_moved, (int)b.stats.render.gaussians_moved,
                      (int)b.stats.render.gaussians_projected, (int)b.stats.render.gaussians_at_nodes,
                      (int)b.stats.render.gaussians_on_paths);
        assert_true(a.count > 0 && fabs((double)a.count - (double)b.count) <= 2 + 0.01 * (double)a.count);
        on_paths += b.stats.render.gaussians_on_paths;
        projected += b.stats.render.gaussians_projected;
        free(a.events);
        free(b.events);
        run_world_free(&world);
    }
    assert_true(on_paths > projected);
    tides_device_close(device);
}

static void test_decoders_have_none(void **state) {
    tides_device *device = open_fast_device();
    run_world world = run_world_make("motion0");
    stream a = simulate_on(device, world.scene, world.path, &world.camera, 0, 1);
    stream b = simulate_on(device, world.scene, world.path, &world.camera, 1, 1);
    (void)state;
    assert_int_equal(b.stats.render.path_nodes, 0);
    assert_true(a.count > 0 && a.count == b.count);
    assert_memory_equal(a.events, b.events, a.count * sizeof *a.events);
    free(a.events);
    free(b.events);
    run_world_free(&world);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_events_are_those_of_projections),
                                       cmocka_unit_test(test_order_of_work_changes_nothing), cmocka_unit_test(test_worlds),
                                       cmocka_unit_test(test_decoders_have_none)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
