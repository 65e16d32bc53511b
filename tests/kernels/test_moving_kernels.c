/* Scenes whose Gaussians move by themselves: the OpenCL kernels equal the single-precision reference to the bit, at every
 * vector width. Neither the size of batches, nor rows kept from the sweep, nor shorter candidate lists change a bit. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "td_device.h"
#include "tests/support/moving_scene.h"
#include "tests/support/opencl.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 5150;
enum { OUTPUTS = TD_OUT_COLOUR, SLOTS = 5 };

static const double start = 0.4, length = 0.03;

static random_recipe recipe_with(uint64_t seed, int degree) {
    random_recipe recipe = recipe_of(seed);
    recipe.sh_degree = degree;
    recipe.count = 200;
    return recipe;
}

static void render_times(double times[SLOTS]) {
    static const double at[SLOTS] = {0, 0.13, 0.5, 0.81, 1};
    for (int i = 0; i < SLOTS; i++) times[i] = i == SLOTS - 1 ? start + length : start + at[i] * length;
}

/* Every tile at each time from lists for the whole interval: (slots x tiles x OUTPUTS x TD_TILE_PIXELS). */
static double *render_tiles(tides_renderer *renderer, const tides_trajectory *path) {
    int tiles = renderer->stats.tiles;
    double times[SLOTS], *planes = malloc((size_t)SLOTS * (size_t)tiles * OUTPUTS * TD_TILE_PIXELS * sizeof *planes);
    td_request *requests = calloc((size_t)SLOTS * (size_t)tiles, sizeof *requests);
    tides_error error;
    assert_true(planes && requests);
    render_times(times);
    for (int i = 0; i < SLOTS * tiles; i++) requests[i].tile = i % tiles, requests[i].slot = i / tiles;
    scene_expect_ok(td_renderer_tiles(renderer, path,
                                      &(td_tile_batch){times, SLOTS, TD_SIDE_BEGINS, requests, SLOTS * tiles, OUTPUTS}, planes,
                                      &error),
                    &error);
    free(requests);
    return planes;
}

static double *sweep_and_render(tides_renderer *renderer, const tides_trajectory *path) {
    tides_error error;
    scene_expect_ok(td_renderer_sweep(renderer, path, start, start + length, &error), &error);
    return render_tiles(renderer, path);
}

/* Pixels within the image that differ in any bit of any plane, and the first of them in a message. */
static void expect_same(const tides_renderer *renderer, const double *a, const double *b, const char *what) {
    int tiles_x = renderer->candidates.tiles_x, tiles = renderer->stats.tiles, moving = 0;
    for (int slot = 0; slot < SLOTS; slot++)
        for (int y = 0; y < renderer->image.height; y++)
            for (int x = 0; x < renderer->image.width; x++)
                for (int k = 0; k < OUTPUTS; k++) {
                    size_t tile =
                        (size_t)slot * (size_t)tiles + (size_t)(y / TD_TILE) * (size_t)tiles_x + (size_t)(x / TD_TILE);
                    size_t at = (tile * OUTPUTS + (size_t)k) * TD_TILE_PIXELS + (size_t)td_tile_pixel(x % TD_TILE, y % TD_TILE);
                    if (memcmp(&a[at], &b[at], sizeof *a) != 0)
                        fail_msg("%s: plane %d at (%d, %d), slot %d: %.9g and %.9g", what, k, x, y, slot, a[at], b[at]);
                    assert_true(isfinite(a[at]));
                    moving += k == TD_OUT_L_DOT && a[at] != 0;
                }
    assert_true(moving > 0);
}

static double *of_device(tides_device *device, const moving_scene *s, int rules) {
    tides_renderer *renderer = make_renderer(device, s->scene, &s->base.camera, rules);
    double *planes = sweep_and_render(renderer, s->base.path);
    tides_renderer_destroy(renderer);
    return planes;
}

static void test_kernels_equal_the_reference(void **state) {
    static const int lanes[] = {16, 8, 4, 1}, degrees[] = {1, 0, 2, 3};
    (void)state;
    for (int i = 0; i < 4; i++) {
        tides_device *device = NULL, *reference = open_device("reference-f32");
        if (tides_device_open("cpu", &device, NULL) != TIDES_OK) {
            tides_device_close(reference);
            skip();
        }
        device->info.lanes = lanes[i];
        random_recipe recipe = recipe_with(SEED + (uint64_t)i, degrees[i]);
        moving_scene s = moving_scene_make(&recipe, 0.6);
        tides_renderer *renderer = make_renderer(reference, s.scene, &s.base.camera, i % RULES);
        double *expected = sweep_and_render(renderer, s.base.path), *found = of_device(device, &s, i % RULES);
        expect_same(renderer, expected, found, "device and reference");
        free(expected);
        free(found);
        tides_renderer_destroy(renderer);
        moving_scene_free(&s);
        tides_device_close(device);
        tides_device_close(reference);
    }
}

/* Launches of few records and rows, and sweeps in small chunks whose rows aren't kept. */
static void cut(tides_renderer *renderer, int records, int rows) {
    if (records) renderer->record_limit = records;
    if (!rows) return;
    renderer->row_limit = rows;
    renderer->dynamic.cached_rows = 0;
}

static void check_cuts(const char *device_name, uint64_t seed) {
    static const int cuts[][2] = {{48, 0}, {0, 1 << 20}, {0, 96}, {64, 48}, {1, 16}};
    tides_device *device = NULL;
    if (tides_device_open(device_name, &device, NULL) != TIDES_OK) return;
    random_recipe recipe = recipe_with(seed, 1);
    moving_scene s = moving_scene_make(&recipe, 0.6);
    tides_renderer *whole = make_renderer(device, s.scene, &s.base.camera, TIDES_RULES_SMOOTH);
    double *expected = sweep_and_render(whole, s.base.path);
    assert_true(whole->dynamic.cached_rows > 0);
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        tides_renderer *renderer = make_renderer(device, s.scene, &s.base.camera, TIDES_RULES_SMOOTH);
        cut(renderer, cuts[i][0], cuts[i][1]);
        double *found = sweep_and_render(renderer, s.base.path);
        expect_same(whole, expected, found, "cut");
        free(found);
        tides_renderer_destroy(renderer);
    }
    /* One after the other: what is kept from the last sweep is found again. */
    uint64_t before = whole->backend->stats.gaussians_moved;
    double *again = sweep_and_render(whole, s.base.path);
    expect_same(whole, expected, again, "kept");
    assert_true(whole->backend->stats.gaussians_moved - before < before);
    free(again);
    free(expected);
    tides_renderer_destroy(whole);
    moving_scene_free(&s);
    tides_device_close(device);
}

static void test_cuts_change_nothing(void **state) {
    (void)state;
    check_cuts("reference", SEED + 10);
    check_cuts("cpu", SEED + 11);
    skip_without_opencl();
}

/* -- sides ----------------------------------------------------------------------------------------------------------- */

/* L_dot of every tile at the knot from `side`, after a sweep of [start, stop]; with rows kept from it, or none. */
static double *at_knot(tides_device *device, const moving_scene *s, double from, double to, int side, int keeps) {
    tides_renderer *renderer = make_renderer(device, s->scene, &s->base.camera, TIDES_RULES_SMOOTH);
    const double knot = MOVING_KNOT;
    int tiles = renderer->stats.tiles;
    double *planes = malloc((size_t)tiles * OUTPUTS * TD_TILE_PIXELS * sizeof *planes);
    td_request *requests = calloc((size_t)tiles, sizeof *requests);
    tides_error error;
    assert_true(planes && requests);
    for (int i = 0; i < tiles; i++) requests[i].tile = i;
    if (!keeps) renderer->dynamic.cached_rows = 0;
    scene_expect_ok(td_renderer_sweep(renderer, s->base.path, from, to, &error), &error);
    scene_expect_ok(td_renderer_tiles(renderer, s->base.path, &(td_tile_batch){&knot, 1, side, requests, tiles, OUTPUTS},
                                      planes, &error),
                    &error);
    free(requests);
    tides_renderer_destroy(renderer);
    return planes;
}

/* An interval keeps rates of the side that it lies on: asked for the other side's it must not give them. */
static void test_kept_rows_are_of_one_side(void **state) {
    static const double reach = 0.01;
    (void)state;
    tides_device *device = open_device("reference-f32");
    random_recipe recipe = recipe_with(SEED + 30, 1);
    moving_scene s = moving_scene_make(&recipe, 0.6);
    tides_renderer *shape = make_renderer(device, s.scene, &s.base.camera, TIDES_RULES_SMOOTH);
    size_t reals = (size_t)shape->stats.tiles * OUTPUTS * TD_TILE_PIXELS;
    for (int before = 0; before < 2; before++) {
        double from = before ? MOVING_KNOT - reach : MOVING_KNOT, to = before ? MOVING_KNOT : MOVING_KNOT + reach;
        double *kept[2], *fresh[2];
        for (int k = 0; k < 2; k++) {
            kept[k] = at_knot(device, &s, from, to, k ? 1 : -1, 1);
            fresh[k] = at_knot(device, &s, from, to, k ? 1 : -1, 0);
        }
        for (int k = 0; k < 2; k++) assert_memory_equal(kept[k], fresh[k], reals * sizeof *fresh[k]);
        assert_memory_not_equal(fresh[0], fresh[1], reals * sizeof *fresh[0]);
        for (int k = 0; k < 2; k++) free(kept[k]), free(fresh[k]);
    }
    tides_renderer_destroy(shape);
    moving_scene_free(&s);
    tides_device_close(device);
}

/* Lists for an interval give what lists of everything give. */
static void test_lists_are_conservative(void **state) {
    (void)state;
    for (uint64_t trial = 0; trial < 6; trial++) {
        tides_device *device = open_device("reference-f32");
        random_recipe recipe = recipe_with(SEED + 20 + trial, 0);
        recipe.size = trial % 2 ? 0.02 : 0.12;
        recipe.spread = trial % 3 ? 1.5 : 4.5;
        moving_scene s = moving_scene_make(&recipe, 8);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.base.camera, (int)(trial % RULES));
        double *swept = sweep_and_render(renderer, s.base.path);
        int listed = renderer->candidates.first[renderer->stats.tiles], count = renderer->store.count;
        tides_error error;
        for (int i = 0; i < count; i++) {
            float *box = renderer->sweep.boxes + 4 * (size_t)i;
            int padding = i % TD_PAD && renderer->store.number[i] == renderer->store.number[i - 1];
            box[0] = box[1] = 0;
            box[2] = padding ? -1 : (float)renderer->image.width;
            box[3] = padding ? -1 : (float)renderer->image.height;
        }
        const td_boxes all = {.box = renderer->sweep.boxes,
                              .travel = renderer->sweep.travel,
                              .object_moves = renderer->sweep.object_moves};
        scene_expect_ok(td_candidates_build(&renderer->candidates, &renderer->store, &all, &error), &error);
        assert_true(listed < renderer->candidates.first[renderer->stats.tiles]);
        double *full = render_tiles(renderer, s.base.path);
        expect_same(renderer, full, swept, "lists");
        free(swept);
        free(full);
        tides_renderer_destroy(renderer);
        moving_scene_free(&s);
        tides_device_close(device);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kernels_equal_the_reference),
                                       cmocka_unit_test(test_cuts_change_nothing),
                                       cmocka_unit_test(test_kept_rows_are_of_one_side),
                                       cmocka_unit_test(test_lists_are_conservative)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
