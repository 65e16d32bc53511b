/* Points of Gaussians that an expensive model moves. Rows are computed only where curves need them, and points are as accurate
 * as with all rows: equal to a frame there, except at kinks, and equal to the bit on every device. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "network_scene.h"
#include "td_device.h"
#include "td_sort.h"
#include "tests/support/tile_points.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 1450;
static const double START = 0.3, LENGTH = 0.02; /* [s] of the motion's second, whose planes have a knot every twelfth */
enum { POINTS = 3000 };

/* A renderer of a network's scene that has swept the interval. */
typedef struct swept {
    network_scene scene;
    tides_device *device;
    tides_renderer *renderer;
} swept;

static swept sweep_on(tides_device *device, uint64_t seed) {
    swept w = {network_scene_make(seed, 0.2), device, NULL};
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.background[1] = 0.2;
    params.smoothing.stop_change = 1e-13; /* the frames' lists to their end */
    scene_expect_ok(tides_renderer_create(device, w.scene.scene, &w.scene.base.camera, &params, NULL, NULL, &w.renderer,
                                          &error),
                    &error);
    scene_expect_ok(td_renderer_sweep(w.renderer, w.scene.base.path, START, START + LENGTH, &error), &error);
    return w;
}

static void close_swept(swept *w) {
    tides_renderer_destroy(w->renderer);
    tides_device_close(w->device);
    network_scene_free(&w->scene);
}

/* Points all over the image and the interval. */
static void scatter(const swept *w, td_point *points) {
    for (int i = 0; i < POINTS; i++) {
        points[i].time = START + LENGTH * (double)(i * 37 % POINTS) / (POINTS - 1);
        points[i].x = i * 13 % w->scene.base.recipe.width;
        points[i].y = i * 29 % w->scene.base.recipe.height;
    }
}

/* Asks for the points, exact ones or those of frames; how many rows of the motion that took. */
static uint64_t values_of(swept *w, int exact, const td_point *points, td_point_value *values) {
    tides_error error;
    const uint64_t before = w->renderer->backend->stats.gaussians_moved;
    if (exact) {
        scene_expect_ok(td_renderer_exact_points(w->renderer, &error), &error);
        scene_expect_ok(td_renderer_points(w->renderer, w->scene.base.path, points, POINTS, values, &error), &error);
    } else {
        scene_expect_ok(tile_points(w->renderer, w->scene.base.path, points, POINTS, values, &error), &error);
    }
    return w->renderer->backend->stats.gaussians_moved - before;
}

/* Gaussians in some list. */
static int listed(const tides_renderer *renderer) {
    const td_candidates *lists = &renderer->candidates;
    uint8_t *is_listed = calloc((size_t)renderer->store.count, 1);
    int count = 0;
    assert_non_null(is_listed);
    for (int i = 0; i < lists->first[renderer->stats.tiles]; i++)
        if (lists->list[i] >= 0) is_listed[lists->list[i]] = 1;
    for (int i = 0; i < renderer->store.count; i++) count += is_listed[i];
    free(is_listed);
    return count;
}

/* A Gaussian whose path bends somewhere had 2 + 6 + 14 + 30 rows beside the sweep's own when all curves of a level were worked
 * out anew; where curves that do stay as they are, each level takes the two halves of what has a kink, or a little more. */
static void test_rows_are_worked_out_where_paths_bend(void **state) {
    static td_point points[POINTS];
    static td_point_value frames[POINTS], exact[POINTS];
    static double off[POINTS];
    (void)state;
    for (uint64_t seed = SEED; seed < SEED + 4; seed++) {
        swept w = sweep_on(open_device("reference"), seed);
        scatter(&w, points);
        values_of(&w, 0, points, frames);
        const double rows = (double)values_of(&w, 1, points, exact) / listed(w.renderer);
        for (int i = 0; i < POINTS; i++) off[i] = fabs(exact[i].L - frames[i].L);
        qsort(off, POINTS, sizeof *off, td_ascending);
        print_message("seed %u: %.1f rows a Gaussian; L off by %.2g, %.2g, %.2g (p50, p95, p99), at most %.2g\n",
                      (unsigned)seed, rows, off[POINTS / 2], off[POINTS * 95 / 100], off[POINTS * 99 / 100], off[POINTS - 1]);
        close_swept(&w);
        if (rows < 2 || rows > 8) fail_msg("%g rows a Gaussian", rows);
        if (off[POINTS / 2] > 1e-8 || off[POINTS * 95 / 100] > 1e-6 || off[POINTS * 99 / 100] > 1e-5 || off[POINTS - 1] > 1e-3)
            fail_msg("L is off by more than paths are");
    }
}

/* On kernels of `lanes` the bits of the twin. */
static void check_lanes(int lanes, const td_point *points, const td_point_value *twin) {
    static td_point_value values[POINTS];
    tides_device *device = open_device("cpu");
    device->info.lanes = device->double_lanes = lanes;
    swept w = sweep_on(device, SEED);
    values_of(&w, 1, points, values);
    close_swept(&w);
    for (int i = 0; i < POINTS; i++)
        if (memcmp(&values[i], &twin[i], sizeof *values) != 0)
            fail_msg("%d lanes, point %d: %.17g, the twin has %.17g", lanes, i, values[i].L, twin[i].L);
}

static void test_bits_of_any_device(void **state) {
    static const int lanes[] = {8, 4, 1};
    static td_point points[POINTS];
    static td_point_value twin[POINTS];
    tides_device *none = NULL;
    (void)state;
    if (tides_device_open("cpu", &none, NULL) != TIDES_OK) skip();
    tides_device_close(none);
    swept w = sweep_on(open_device("reference-f32"), SEED);
    scatter(&w, points);
    values_of(&w, 1, points, twin);
    close_swept(&w);
    for (size_t i = 0; i < sizeof lanes / sizeof *lanes; i++) check_lanes(lanes[i], points, twin);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows_are_worked_out_where_paths_bend),
                                       cmocka_unit_test(test_bits_of_any_device)};
    print_message("seed %u\n", (unsigned)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
