/* Buffers that host and device share: writing, reading, lending and growing give the results of commands, and an image and a
 * whole run are equal to the bit. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "device/td_launch.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tides.h"

#include <stdlib.h>
#include <string.h>

enum { COUNT = 1000, PART = 300, FIRST = 17 };

static tides_device *open_device(void) {
    tides_device *device = NULL;
    tides_error error = {0, ""};
    const tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) skip();
    scene_expect_ok(status, &error);
    return device;
}

/* All that may be done with a buffer. */
static void use_buffer(tides_device *device, int near) {
    int from[2 * COUNT], to[2 * COUNT], viewed[COUNT];
    const int *lent = NULL;
    td_buffer buffer = {NULL, 0, NULL};
    tides_error error = {0, ""};
    for (int i = 0; i < 2 * COUNT; i++) from[i] = 7 * i + 1;
    device->near = near;
    scene_expect_ok(td_buffer_write(device, &buffer, from, COUNT * sizeof *from, &error), &error);
    assert_int_equal(buffer.near != NULL, near);
    scene_expect_ok(td_buffer_read(device, &buffer, to, COUNT * sizeof *to, &error), &error);
    assert_memory_equal(to, from, COUNT * sizeof *to);
    scene_expect_ok(td_buffer_grow(device, &buffer, COUNT * sizeof *from, 2 * COUNT * sizeof *from, &error), &error);
    const size_t skipped = FIRST * sizeof *from, part = PART * sizeof *from;
    scene_expect_ok(td_buffer_write_at(device, &buffer, skipped, from + COUNT, part, &error), &error);
    memcpy(from + FIRST, from + COUNT, part);
    scene_expect_ok(td_buffer_read(device, &buffer, to, COUNT * sizeof *to, &error), &error);
    assert_memory_equal(to, from, COUNT * sizeof *to);
    memset(to, 0, sizeof to);
    scene_expect_ok(td_buffer_read_part(device, &buffer, to, skipped, part, &error), &error);
    assert_memory_equal(to + FIRST, from + FIRST, part);
    for (int i = 0; i < COUNT; i++) from[i] += 3;
    scene_expect_ok(td_buffer_send(device, &buffer, from, COUNT * sizeof *from, &error), &error);
    memset(to, 0, sizeof to);
    scene_expect_ok(td_buffer_fetch(device, &buffer, to, COUNT * sizeof *to, &error), &error);
    scene_expect_ok(td_buffer_view(device, &buffer, near ? NULL : viewed, COUNT * sizeof *from, (const void **)&lent, &error),
                    &error);
    scene_expect_ok(td_finish(device, TIDES_OK, &error), &error);
    assert_memory_equal(to, from, COUNT * sizeof *to);
    assert_memory_equal(lent, from, COUNT * sizeof *from);
    td_buffer_release(&buffer);
    assert_null(buffer.near);
}

static void test_a_buffer_is_a_buffer(void **state) {
    tides_device *device = open_device();
    const int near = device->near;
    (void)state;
    use_buffer(device, 0);
    if (near) use_buffer(device, 1);
    tides_device_close(device);
}

/* log_luminance of a frame; the caller frees it. */
static double *render(tides_device *device, const random_scene *scene) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_error error = {0, ""};
    const size_t pixels = (size_t)scene->camera.width * (size_t)scene->camera.height;
    double *plane = calloc(pixels, sizeof *plane);
    tides_frame frame = {{NULL}};
    assert_non_null(plane);
    tides_image_params_defaults(&params);
    frame.plane[TIDES_L] = plane;
    scene_expect_ok(tides_renderer_create(device, scene->scene, &scene->camera, &params, NULL, NULL, &renderer, &error),
                    &error);
    for (int k = 0; k < 3; k++) scene_expect_ok(tides_renderer_frame(renderer, scene->path, 0.2 * k, &frame, &error), &error);
    tides_renderer_destroy(renderer);
    return plane;
}

/* What is lent is read in place where memory is shared, and left as it is by a buffer that grows and is then written to. */
static void lend_buffer(tides_device *device, int near) {
    enum { SLACK = TD_BUFFER_SLACK / sizeof(int) };
    int from[COUNT + SLACK], kept[COUNT], to[COUNT];
    const int none[PART] = {0};
    td_buffer buffer = {NULL, 0, NULL};
    tides_error error = {0, ""};
    for (int i = 0; i < COUNT + SLACK; i++) from[i] = 5 * i + 2;
    memcpy(kept, from, sizeof kept);
    device->near = near;
    scene_expect_ok(td_buffer_lend(device, &buffer, from, sizeof kept, &error), &error);
    assert_int_equal(buffer.near == from, near);
    scene_expect_ok(td_buffer_read(device, &buffer, to, sizeof to, &error), &error);
    assert_memory_equal(to, kept, sizeof kept);
    scene_expect_ok(td_buffer_grow(device, &buffer, SIZE_MAX, 2 * sizeof kept, &error), &error);
    assert_ptr_not_equal(buffer.near, from);
    scene_expect_ok(td_buffer_read(device, &buffer, to, sizeof to, &error), &error);
    assert_memory_equal(to, kept, sizeof kept);
    scene_expect_ok(td_buffer_write_at(device, &buffer, 0, none, sizeof none, &error), &error);
    assert_memory_equal(from, kept, sizeof kept);
    td_buffer_release(&buffer);
    assert_memory_equal(from, kept, sizeof kept);
}

static void test_a_lent_buffer_is_read_in_place(void **state) {
    tides_device *device = open_device();
    const int near = device->near;
    (void)state;
    lend_buffer(device, 0);
    if (near) lend_buffer(device, 1);
    tides_device_close(device);
}

static void test_images_are_the_same(void **state) {
    tides_device *device = open_device();
    random_recipe recipe = random_recipe_defaults(8);
    (void)state;
    recipe.count = 500;
    random_scene scene = random_scene_make(&recipe);
    double *own = render(device, &scene);
    device->near = 0;
    double *commanded = render(device, &scene);
    assert_memory_equal(own, commanded, (size_t)scene.camera.width * (size_t)scene.camera.height * sizeof *own);
    free(own);
    free(commanded);
    random_scene_free(&scene);
    tides_device_close(device);
}

/* What a run leaves. */
typedef struct run {
    tides_event *events;
    size_t count, capacity;
    double *signal, *reference;
} run;

static int keep(void *user, const tides_event *events, size_t count) {
    run *r = user;
    scene_expect_ok(td_reserve((void **)&r->events, &r->capacity, r->count + count, sizeof *events, NULL), NULL);
    if (count) memcpy(r->events + r->count, events, count * sizeof *events);
    r->count += count;
    return 0;
}

static void simulate(tides_device *device, const random_scene *scene, const tides_stepping *stepping, run *r) {
    tides_simulator *simulator = NULL;
    tides_image_params params;
    tides_sensor sensor;
    tides_error error = {0, ""};
    const size_t pixels = (size_t)scene->camera.width * (size_t)scene->camera.height;
    *r = (run){.signal = calloc(pixels, sizeof(double)), .reference = calloc(pixels, sizeof(double))};
    assert_true(r->signal && r->reference);
    tides_image_params_defaults(&params);
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = 0.1;
    sensor.threshold_off = 0.13;
    scene_expect_ok(tides_simulator_create(device, scene->scene, scene->path, &scene->camera, &params, &sensor, stepping, 0.2,
                                           0.24, NULL, NULL, &simulator, &error),
                    &error);
    scene_expect_ok(tides_simulator_run(simulator, 0.24, keep, r, NULL, NULL, &error), &error);
    tides_simulator_state(simulator, r->signal, r->reference, NULL, NULL);
    tides_simulator_destroy(simulator);
}

static void expect_same(const run *a, const run *b, size_t pixels, const char *what) {
    if (a->count != b->count) fail_msg("%s: %zu events and %zu", what, a->count, b->count);
    assert_true(a->count > 100);
    assert_memory_equal(a->events, b->events, a->count * sizeof *a->events);
    assert_memory_equal(a->signal, b->signal, pixels * sizeof(double));
    assert_memory_equal(a->reference, b->reference, pixels * sizeof(double));
}

static void free_run(run *r) {
    free(r->events);
    free(r->signal);
    free(r->reference);
}

/* Runs of every kind, each of which launches kernels of its own; `near` is switched off for a second run of each. */
static void test_runs_are_the_same(void **state) {
    static const struct kind {
        const char *name;
        int32_t mode, solve, unit;
    } kinds[] = {{"fixed steps", TIDES_STEPPING_FIXED, TIDES_SOLVE_OFF, TIDES_UNIT_TILE},
                 {"error control", TIDES_STEPPING_ERROR, TIDES_SOLVE_OFF, TIDES_UNIT_TILE},
                 {"events looked up", TIDES_STEPPING_ERROR, TIDES_SOLVE_DOUBLE, TIDES_UNIT_BLOCK}};
    tides_device *device = open_device();
    random_recipe recipe = random_recipe_defaults(62);
    const int near = device->near;
    (void)state;
    recipe.objects = 2;
    recipe.size = 0.2;
    recipe.camera_speed = 2;
    random_scene scene = random_scene_make(&recipe);
    const size_t pixels = (size_t)scene.camera.width * (size_t)scene.camera.height;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        tides_stepping stepping;
        run own, commanded;
        tides_stepping_defaults(&stepping);
        stepping.mode = kinds[i].mode;
        stepping.solve = kinds[i].solve;
        stepping.unit = kinds[i].unit;
        stepping.step_s = kinds[i].mode == TIDES_STEPPING_FIXED ? 2e-3 : 20e-3;
        device->near = near;
        simulate(device, &scene, &stepping, &own);
        device->near = 0;
        simulate(device, &scene, &stepping, &commanded);
        expect_same(&own, &commanded, pixels, kinds[i].name);
        free_run(&own);
        free_run(&commanded);
    }
    random_scene_free(&scene);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_buffer_is_a_buffer),
                                       cmocka_unit_test(test_a_lent_buffer_is_read_in_place),
                                       cmocka_unit_test(test_images_are_the_same), cmocka_unit_test(test_runs_are_the_same)};
    return cmocka_run_group_tests_name("near", tests, NULL, NULL);
}
