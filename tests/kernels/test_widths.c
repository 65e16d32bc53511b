/* Vectors of 1, 4, 8 and 16 pixels give the same bits. Tile lists have every length that the sort treats differently (less than
 * a vector, one, many), in order already, reversed, shuffled, and with equal depths. On sheets of splats close to each other,
 * all in soft order, opaque and faint, weights add up to 1 - T. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/kernels/backend_pair.h"

#include <math.h>

static const uint64_t SEED = 1009;
static const pair_setting setting = {TIDES_RULES_SMOOTH, 0, 0, 0};

/* All Gaussians in the one tile of a small image, faint enough for every one to be blended; the camera looks along z. */
static random_recipe one_tile(int count) {
    random_recipe recipe = random_recipe_defaults(SEED + (uint64_t)count);
    recipe.count = count;
    recipe.sh_degree = 0;
    recipe.width = 13;
    recipe.height = 11;
    recipe.spread = 0.3;
    recipe.size = 0.1;
    recipe.opacity_min = 0.005;
    recipe.opacity_max = 0.05;
    recipe.camera_speed = 0;
    return recipe;
}

/* The place of a Gaussian's z, to be overwritten. */
static double *depth_of(td_store *store, int i) { return store->geometry + (size_t)i * TD_GEOMETRY_STRIDE + TD_G_MEAN + 2; }

static void put_in_order(td_store *store) {
    for (int i = 0; i < store->real_count; i++) *depth_of(store, i) = 0.4 * i / store->real_count;
}

static void put_in_reverse(td_store *store) {
    for (int i = 0; i < store->real_count; i++) *depth_of(store, i) = -0.4 * i / store->real_count;
}

/* Three depths for all. */
static void put_in_layers(td_store *store) {
    for (int i = 0; i < store->real_count; i++) *depth_of(store, i) = 0.25 * (i * 7 % 3);
}

typedef void (*edit_store)(td_store *store);

static void compare_list(tides_device *device, int count, const char *order, edit_store edit) {
    char name[64];
    random_recipe recipe = one_tile(count);
    snprintf(name, sizeof name, "%d splats, %s, %d lanes", count, order, (int)device->info.lanes);
    backend_pair pair = pair_make(name, device, &recipe, &setting, edit);
    assert_int_equal(pair.job_count, PAIR_SLOTS);
    assert_int_equal(pair_compare_stages(&pair, &pair.jobs[0]), count);
    free(pair_compare_planes(&pair, TD_OUT_COLOUR));
    pair_free(&pair);
}

/* Depths that differ by 2e-4 of themselves at most, some of them not at all; the camera is 4 away. */
static void put_in_a_sheet(td_store *store) {
    for (int i = 0; i < store->real_count; i++) *depth_of(store, i) = (float)(8e-4 * (i * 7919 % 4001) / 4001);
}

/* The sum of weights is 1 - T, in the reference that the kernels equal. */
static void expect_light(const backend_pair *pair, const double *planes) {
    for (int job = 0; job < pair->job_count; job++)
        for (int pixel = 0; pixel < TD_TILE_PIXELS; pixel++) {
            const double *at = planes + (size_t)job * TD_OUT_COLOUR * TD_TILE_PIXELS + pixel;
            double coverage = at[TD_OUT_COVERAGE * TD_TILE_PIXELS], alpha = at[TD_OUT_ALPHA * TD_TILE_PIXELS];
            if (!(fabs(coverage - alpha) < 1e-6)) fail_msg("%s: coverage %.9g, alpha %.9g", pair->name, coverage, alpha);
        }
}

static void compare_sheet(tides_device *device, int count, double opacity_min, double opacity_max) {
    char name[64];
    random_recipe recipe = one_tile(count);
    recipe.opacity_min = opacity_min;
    recipe.opacity_max = opacity_max;
    snprintf(name, sizeof name, "a sheet of %d, opacity %g to %g, %d lanes", count, opacity_min, opacity_max,
             (int)device->info.lanes);
    backend_pair pair = pair_make(name, device, &recipe, &setting, put_in_a_sheet);
    static const int outputs[] = {TD_OUT_SIGNAL, TD_OUT_DIAGNOSTICS};
    for (int i = 0; i < 2; i++) free(pair_compare_planes(&pair, outputs[i]));
    double *planes = pair_compare_planes(&pair, TD_OUT_COLOUR);
    expect_light(&pair, planes);
    free(planes);
    pair_free(&pair);
}

/* A scene of many tiles and objects that leave gaps in the lists. */
static void compare_scene(tides_device *device) {
    random_recipe recipe = pair_ordinary(SEED);
    recipe.sh_degree = 0;
    backend_pair pair = pair_make("many tiles", device, &recipe, &setting, NULL);
    free(pair_compare_planes(&pair, TD_OUT_COLOUR));
    for (int i = 0; i < pair.job_count; i++) pair_compare_stages(&pair, &pair.jobs[i]);
    pair_free(&pair);
}

static void compare_width(int lanes) {
    static const int counts[] = {1, 7, 8, 9, 15, 16, 17, 33, 64, 65, 200, 1000, 3000};
    tides_device *device = pair_device(lanes);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        compare_list(device, counts[i], "shuffled", NULL);
        if (counts[i] == 3000) continue;
        compare_list(device, counts[i], "in order", put_in_order);
        compare_list(device, counts[i], "reversed", put_in_reverse);
        compare_list(device, counts[i], "in layers", put_in_layers);
    }
    static const int sheets[] = {1, 2, 3, 20, 300, 5000};
    for (size_t i = 0; i < sizeof sheets / sizeof *sheets; i++) {
        compare_sheet(device, sheets[i], 0.1, 0.95);
        compare_sheet(device, sheets[i], 0.002, 0.02);
    }
    compare_scene(device);
    tides_device_close(device);
}

static void test_1_lane(void **state) {
    (void)state;
    compare_width(1);
}
static void test_4_lanes(void **state) {
    (void)state;
    compare_width(4);
}
static void test_8_lanes(void **state) {
    (void)state;
    compare_width(8);
}
static void test_16_lanes(void **state) {
    (void)state;
    compare_width(16);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_1_lane), cmocka_unit_test(test_4_lanes),
                                       cmocka_unit_test(test_8_lanes), cmocka_unit_test(test_16_lanes)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
