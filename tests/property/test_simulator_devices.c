/* The simulator on different devices: the OpenCL CPU device gives exactly the events of the single-precision reference, with
 * and without double precision of its own, and both give those of the double reference to within nanoseconds. On random scenes
 * and a real one. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tests/support/moving_scene.h"
#include "tests/support/shared.h"
#include "device/td_device.h"
#include "td_sort.h"
#include "tests/support/opencl.h"

static const uint64_t SEED = 90210;

/* By pixel, then time. */
static int by_pixel(const void *a, const void *b) {
    const tides_event *l = a, *r = b;
    if (l->y != r->y) return l->y < r->y ? -1 : 1;
    if (l->x != r->x) return l->x < r->x ? -1 : 1;
    return compare_events(l, r);
}

static int same_pixel(const tides_event *a, const tides_event *b) { return a->x == b->x && a->y == b->y; }

/* Matches events per pixel, in order, where polarities agree. Sorts both streams. Returns how many are left over; `*median`
 * becomes that of |dt| [ns] of the others. */
static size_t match(outcome *a, outcome *b, double *median) {
    size_t i = 0, k = 0, matched = 0, left = 0;
    double *dt = calloc(a->count + 1, sizeof *dt);
    assert_non_null(dt);
    qsort(a->events, a->count, sizeof *a->events, by_pixel);
    qsort(b->events, b->count, sizeof *b->events, by_pixel);
    while (i < a->count && k < b->count) {
        const tides_event *x = &a->events[i], *y = &b->events[k];
        if (same_pixel(x, y)) {
            if (x->polarity == y->polarity)
                dt[matched++] = fabs((double)(x->t - y->t));
            else
                left += 2;
            i++, k++;
        } else {
            left++;
            if (by_pixel(x, y) < 0)
                i++;
            else
                k++;
        }
    }
    left += a->count - i + b->count - k;
    qsort(dt, matched, sizeof *dt, td_ascending);
    *median = matched ? dt[matched / 2] : 0;
    free(dt);
    return left;
}

/* cpu == reference-f32 to the bit, and both near the double reference. */
static void compare_devices(job *j, const char *what, double worst_median_ns) {
    tides_device *cpu = open_device("cpu");
    outcome on_cpu = {0};
    double median;
    if (cpu) on_cpu = run_on(j, cpu);
    j->device = "reference-f32";
    outcome single = run(j);
    j->device = "reference";
    outcome wide = run(j);
    if (cpu) {
        expect_same(&on_cpu, &single, what);
        assert_memory_equal(on_cpu.signal, single.signal, (size_t)pixels_of(j) * sizeof(double));
    }
    size_t left = match(&single, &wide, &median);
    print_message("%s: %zu events in single precision, %zu in double; %zu not matched, median |dt| %.0f ns\n", what,
                  single.count, wide.count, left, median);
    assert_true(wide.count > 500);
    assert_true((double)left <= 1e-3 * (double)wide.count + 2);
    assert_true(median < worst_median_ns);
    tides_device_close(cpu);
    free_outcome(&on_cpu);
    free_outcome(&single);
    free_outcome(&wide);
}

static void test_devices_agree(void **state) {
    (void)state;
    for (uint64_t trial = 60; trial < 62; trial++) {
        random_scene scene = make_scene(SEED + trial);
        job j = job_of(&scene);
        if (trial == 61) j.sensor.threshold_off = j.sensor.threshold_on;
        compare_devices(&j, "random scene", 1000);
        j = adaptive_job_of(&scene, 1);
        compare_devices(&j, "random scene, adaptive", 1000);
        j.stepping.solve = TIDES_SOLVE_DOUBLE;
        j.stepping.unit = trial % 2 ? TIDES_UNIT_BLOCK : TIDES_UNIT_TILE;
        compare_devices(&j, "random scene, solved", 1);
        random_scene_free(&scene);
    }
    skip_without_opencl();
}

/* What is wanted in double is worked out in C where a device has none: the default settings' events are its as well. */
static void test_a_device_without_double(void **state) {
    (void)state;
    tides_device *cpu = open_device("cpu");
    if (!cpu) skip();
    for (int moves = 0; moves < 2; moves++) {
        random_scene still = make_scene(SEED + 70);
        moving_scene mover = moving_scene_small(SEED + 71);
        const random_scene *scene = moves ? &mover.base : &still;
        job j = adaptive_job_of(scene, 1);
        if (moves) j.scene = mover.scene, j.start = 0.4, j.stop = 0.45;
        tides_stepping_defaults(&j.stepping);
        cpu->has_double = 1;
        outcome own = run_on(&j, cpu);
        cpu->has_double = 0;
        outcome twin = run_on(&j, cpu);
        assert_int_equal(twin.stats.solve, TIDES_SOLVE_DOUBLE);
        assert_true(twin.count > 500 && twin.stats.events_solved > 500);
        expect_same(&own, &twin, moves ? "Gaussians that move, no double" : "no double");
        assert_memory_equal(own.signal, twin.signal, (size_t)pixels_of(&j) * sizeof(double));
        assert_memory_equal(own.reference, twin.reference, (size_t)pixels_of(&j) * sizeof(double));
        free_outcome(&own);
        free_outcome(&twin);
        random_scene_free(&still);
        moving_scene_free(&mover);
    }
    tides_device_close(cpu);
}

/* -- a real scene -------------------------------------------------------------------------------------------------- */

static void test_real_scene(void **state) {
    (void)state;
    char file[1024];
    tides_orbit orbit = {{0}, {0, -1, 0}, 0, 0, 0.3, 1.5, 0, 1};
    tides_trajectory *path = NULL;
    tides_scene *scene = NULL;
    tides_error error;
    double lower[3], upper[3];
    if (shared_path(file, sizeof file, "data/playcanvas/playbot_lod5_inria_sh2.ply") != 0) {
        print_message("skipped: no data/playcanvas/playbot_lod5_inria_sh2.ply in $TIDES_SHARED\n");
        skip();
    }
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, file, NULL, 1, &error), &error);
    tides_scene_bounds(scene, lower, upper);
    for (int i = 0; i < 3; i++) orbit.target[i] = 0.5 * (lower[i] + upper[i]);
    orbit.radius = 1.1 * (upper[1] - lower[1]);
    scene_expect_ok(tides_trajectory_create_orbit(&orbit, &path, &error), &error);
    job j = {.device = "reference-f32",
             .scene = scene,
             .path = path,
             .camera = {56, 44, 50, 50, 28, 22, {0}},
             .start = 0,
             .stop = 0.05};
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    j.stepping.mode = TIDES_STEPPING_FIXED;
    j.stepping.step_s = 5e-3;
    outcome o = run(&j);
    check_stream(&j, &o);
    check_state(&j, &o);
    free_outcome(&o);
    compare_devices(&j, "playbot", 5000);
    tides_trajectory_destroy(path);
    tides_scene_destroy(scene);
    skip_without_opencl();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_devices_agree), cmocka_unit_test(test_a_device_without_double),
                                       cmocka_unit_test(test_real_scene)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
