/* Millions of events through a run and into a file: the memory in use at the end is that at the beginning. So a run of 10^9
 * events needs no more. */
#define _DEFAULT_SOURCE /* mallinfo2 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tides/events.h"

#include <malloc.h>

/* A file's indices may grow, of milliseconds and of chunks, a hundredth of the 24 bytes that an event has in memory; 0.08
 * bytes were measured. */
static const double bytes_per_event = 0.24;

enum { SAMPLES = 401, SAMPLES_PER_S = 200, SAMPLES_PER_SWAY = 20, SIDE = 16 };

/* What the heap holds at most in each quarter of the run. */
typedef struct growth {
    tides_event_writer *writer;
    double start, stop; /* [ns] */
    size_t most[4];
    uint64_t events;
} growth;

static int note(void *user, const tides_event *events, size_t count) {
    growth *g = user;
    tides_error error;
    if (count == 0) return 0;
    scene_expect_ok(tides_event_writer_append(g->writer, events, NULL, count, &error), &error);
    const struct mallinfo2 heap = mallinfo2();
    const size_t used = heap.uordblks + heap.hblkhd;
    const int quarter = (int)(4 * ((double)events[0].t - g->start) / (g->stop - g->start));
    if (used > g->most[quarter]) g->most[quarter] = used;
    g->events += count;
    return 0;
}

/* A camera that sways to the side, so that every part of the run is like every other. */
static tides_trajectory *swaying(const tides_trajectory *base) {
    static tides_pose_sample samples[SAMPLES];
    tides_trajectory *path = NULL;
    tides_error error;
    for (size_t i = 0; i < SAMPLES; i++) {
        scene_expect_ok(tides_trajectory_sample(base, 0, &samples[i], &error), &error);
        samples[i].time = (double)i / SAMPLES_PER_S;
        samples[i].position[0] += 0.5 * sin(6.283185307179586 * (double)i / SAMPLES_PER_SWAY);
        samples[i].has_rates = 0;
    }
    scene_expect_ok(tides_trajectory_create(samples, SAMPLES, &path, &error), &error);
    return path;
}

static void check(const char *spec, int32_t mode, const char *file) {
    tides_error error;
    tides_device *device = open_device(spec);
    if (!device) skip();
    random_recipe recipe = random_recipe_defaults(3);
    recipe.count = 12;
    recipe.sh_degree = 0;
    recipe.width = recipe.height = SIDE;
    random_scene scene = random_scene_make(&recipe);
    tides_trajectory *path = swaying(scene.path);
    job j = {.device = spec, .scene = scene.scene, .path = path, .camera = scene.camera, .stop = 2};
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    j.sensor.threshold_on = j.sensor.threshold_off = 0.004;
    j.stepping.mode = mode;
    j.stepping.step_s = 0.004;
    const tides_event_file facts = {.width = SIDE, .height = SIDE};
    growth g = {.stop = 2e9};
    scene_expect_ok(tides_event_writer_open(file, NULL, &facts, &g.writer, &error), &error);
    tides_simulator *s = make_simulator(&j, device);
    scene_expect_ok(tides_simulator_run(s, j.stop, note, &g, NULL, NULL, &error), &error);
    print_message("%s, mode %d: %.2f million events, %zu kB in use at most in the run's quarters, %zu, %zu, %zu\n", spec,
                  (int)mode, 1e-6 * (double)g.events, g.most[0] / 1000, g.most[1] / 1000, g.most[2] / 1000, g.most[3] / 1000);
    assert_true(g.events > 1000000);
    const double grown = (double)g.most[3] - (double)g.most[1];
    assert_true(grown <= bytes_per_event * 0.5 * (double)g.events);
    tides_simulator_destroy(s);
    scene_expect_ok(tides_event_writer_finish(g.writer, (int64_t)g.stop, &error), &error);
    tides_trajectory_destroy(path);
    random_scene_free(&scene);
    tides_device_close(device);
}

static void test_growth(void **state) {
    const char *file = scene_in_folder(*state, "events.h5");
    check("reference-f32", TIDES_STEPPING_ERROR, file);
    check("reference-f32", TIDES_STEPPING_FIXED, file);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(test_growth, scene_folder_setup, scene_folder_teardown)};
    return cmocka_run_group_tests_name("growth", tests, NULL, NULL);
}
