/* Sweeps on the OpenCL device equal those of the single-precision reference to the bit, at every width: of paths with strays,
 * in several pieces, and of Gaussians that move by themselves on a shorter scale of time. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_device.h"
#include "tests/property/sweep_world.h"

static const uint64_t SEED = 77;

/* Boxes and travel of [start, stop], (5 x Gaussians), the caller's. */
static float *swept(tides_renderer *renderer, const world *w, double start, double stop) {
    size_t count = (size_t)renderer->store.count;
    float *all = malloc(5 * count * sizeof *all);
    tides_error error;
    assert_non_null(all);
    scene_expect_ok(td_renderer_sweep(renderer, w->path, start, stop, &error), &error);
    memcpy(all, renderer->sweep.boxes, 4 * count * sizeof *all);
    memcpy(all + 4 * count, renderer->sweep.travel, count * sizeof *all);
    return all;
}

static void compare_kind(tides_device *device, tides_device *reference, int kind, int lanes) {
    static const double ends[][2] = {{0, 0.01}, {0.0123, 0.0153}, {0.02, 0.02}};
    uint64_t seed = SEED + (uint64_t)kind;
    world w = make_world(&seed, kind, kind % 2 ? 0.01 : 0);
    tides_renderer *a = make_renderer(device, w.scene, &w.camera, TIDES_RULES_SMOOTH);
    tides_renderer *b = make_renderer(reference, w.scene, &w.camera, TIDES_RULES_SMOOTH);
    double asked = 0;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        float *x = swept(a, &w, ends[i][0], ends[i][1]), *y = swept(b, &w, ends[i][0], ends[i][1]);
        for (int k = 0; k < 5 * a->store.count; k++) {
            if (memcmp(&x[k], &y[k], sizeof *x) != 0)
                fail_msg("kind %d, %d lanes, from %g s: number %d is %.9g on the device, %.9g in the reference", kind, lanes,
                         ends[i][0], k, (double)x[k], (double)y[k]);
            if (k >= 4 * a->store.count) asked = fmax(asked, x[k]);
        }
        free(x);
        free(y);
    }
    assert_true(asked > 0.5);
    tides_renderer_destroy(a);
    tides_renderer_destroy(b);
    free_world(&w);
}

static void test_sweeps_equal_the_reference(void **state) {
    static const int widths[] = {16, 8, 4, 1};
    (void)state;
    tides_device *reference = open_device("reference-f32");
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        tides_device *device = NULL;
        tides_error error;
        tides_status status = tides_device_open("cpu", &device, &error);
        if (status == TIDES_NO_DEVICE) {
            tides_device_close(reference);
            print_message("skipped: %s\n", error.text);
            skip();
        }
        scene_expect_ok(status, &error);
        device->info.lanes = widths[i];
        for (int kind = 0; kind < KINDS; kind++) compare_kind(device, reference, kind, widths[i]);
        tides_device_close(device);
    }
    tides_device_close(reference);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sweeps_equal_the_reference)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
