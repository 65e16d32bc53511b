/* Deformation networks: refusals and their messages, sizes inferred from shapes, which Gaussians rest. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_hexplane.h"
#include "motion/td_network.h"
#include "tests/support/random_network.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 3 };

static random_hexplane_recipe small_hexplane(void) {
    return (random_hexplane_recipe){41, 3, {4, 5, 6, 7}, 2, 10, 2, 31, 0, 0.2};
}

static random_network_recipe small_network(void) { return (random_network_recipe){42, 12, 4, 2, 3, 0, 0, 0, 0.2}; }

static td_field *field_of(tides_motion *motion, const char *name) {
    for (int i = 0; i < motion->fields; i++)
        if (strcmp(motion->field[i].name, name) == 0) return &motion->field[i];
    fail_msg("no field %s", name);
    return NULL;
}

/* Checks and frees the motion; '|' separates what the message must hold. */
static void refuse(tides_motion *motion, const char *expected) {
    random_gaussians gaussians = random_gaussians_make(43, COUNT, 1, 1);
    tides_error error = {0, ""};
    td_mover_numbers numbers = {0};
    scene_expect_error(motion->type->check(motion, &gaussians.view, &error), TIDES_BAD_FILE, &error, expected);
    assert_int_equal(motion->type->pack(motion, &gaussians.view, &numbers, NULL), TIDES_BAD_FILE);
    assert_null(numbers.data);
    random_gaussians_free(&gaussians);
    tides_motion_destroy(motion);
}

/* A model without one of its arrays. */
static tides_motion *without(tides_motion *motion, const char *name) {
    field_of(motion, name)->name[0] = '#';
    return motion;
}

/* A model whose array has another extent. */
static tides_motion *with_extent(tides_motion *motion, const char *name, int axis, uint64_t extent) {
    field_of(motion, name)->shape[axis] = extent;
    return motion;
}

static tides_motion *hexplane(void) {
    random_hexplane_recipe recipe = small_hexplane();
    return random_hexplane_make(&recipe);
}

static tides_motion *network(void) {
    random_network_recipe recipe = small_network();
    return random_network_make(&recipe);
}

static void test_hexplane_refuses_missing(void **state) {
    static const char *const names[] = {"grid.aabb",
                                        "grid.grids.0.0",
                                        "grid.grids.1.5",
                                        "feature_out.0.bias",
                                        "feature_out.2.bias",
                                        "pos_deform.1.weight",
                                        "scales_deform.3.bias",
                                        "rotations_deform.1.bias",
                                        "opacity_deform.3.weight",
                                        "shs_deform.3.weight"};
    char expected[64];
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(expected, sizeof expected, "hexplane|'%s'|missing", names[i]);
        refuse(without(hexplane(), names[i]), expected);
    }
}

static void test_hexplane_refuses_shapes(void **state) {
    (void)state;
    refuse(with_extent(hexplane(), "grid.grids.0.2", 3, 5), "'grid.grids.0.2'|another shape");
    refuse(with_extent(hexplane(), "grid.grids.1.4", 2, 6), "'grid.grids.1.4'|another shape");
    refuse(with_extent(hexplane(), "grid.grids.1.0", 1, 4), "'grid.grids.1.0'|another shape");
    refuse(with_extent(hexplane(), "grid.grids.0.0", 3, 0), "'grid.grids.0.0'|side of 0");
    refuse(with_extent(hexplane(), "grid.grids.0.0", 2, 1u << 20), "'grid.grids.0.0'|1048576");
    refuse(with_extent(hexplane(), "feature_out.0.weight", 1, 7), "'feature_out.0.weight'|another shape");
    refuse(with_extent(hexplane(), "feature_out.0.weight", 0, 0), "'feature_out.0.weight'|0 rows");
    refuse(with_extent(hexplane(), "feature_out.2.weight", 0, 9), "'feature_out.2.weight'|another shape");
    refuse(with_extent(hexplane(), "shs_deform.3.weight", 0, 47), "'shs_deform.3.weight'|another shape");
    refuse(with_extent(hexplane(), "pos_deform.3.bias", 0, 4), "'pos_deform.3.bias'|another shape");
    tides_motion *flat = hexplane();
    field_of(flat, "grid.aabb")->value[1] = field_of(flat, "grid.aabb")->value[4];
    refuse(flat, "'grid.aabb'|along y");
}

static void test_hexplane_refuses_sizes(void **state) {
    random_hexplane_recipe recipe = small_hexplane();
    (void)state;
    recipe.levels = 7;
    refuse(random_hexplane_make(&recipe), "more than 6 levels");
    recipe = small_hexplane(), recipe.channels = 257;
    refuse(random_hexplane_make(&recipe), "544 channels|512");
    recipe = small_hexplane(), recipe.width = 513;
    refuse(random_hexplane_make(&recipe), "'feature_out.0.weight'|513|512");
}

static void test_network_refuses(void **state) {
    static const char *const names[] = {"linear.0.weight", "linear.3.bias", "gaussian_warp.weight", "gaussian_rotation.bias",
                                        "gaussian_scaling.weight"};
    char expected[64];
    random_network_recipe recipe = small_network();
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(expected, sizeof expected, "network|'%s'|missing", names[i]);
        refuse(without(network(), names[i]), expected);
    }
    recipe.screw = 1;
    refuse(without(random_network_make(&recipe), "branch_v.bias"), "'branch_v.bias'|missing");
    refuse(with_extent(network(), "linear.0.weight", 1, 63), "'linear.0.weight'|0, must be 1 to");
    refuse(with_extent(network(), "linear.0.weight", 1, 1u << 31), "'linear.0.weight'|2147483648");
    refuse(with_extent(network(), "linear.0.weight", 1, 71), "8 inputs from the time");
    refuse(with_extent(network(), "linear.0.weight", 0, 513), "'linear.0.bias'|another shape");
    refuse(with_extent(network(), "linear.1.weight", 1, 13), "'linear.1.weight'|another shape");
    refuse(with_extent(network(), "gaussian_rotation.weight", 0, 3), "'gaussian_rotation.weight'|another shape");
    recipe = small_network(), recipe.layers = 17;
    refuse(random_network_make(&recipe), "more than 16 layers");
    recipe = small_network(), recipe.width = 520;
    refuse(random_network_make(&recipe), "'linear.0.weight'|520");
    tides_motion *octaves = network();
    assert_int_equal(td_motion_set(octaves, "position_octaves", 9.5, NULL), TIDES_OK);
    refuse(octaves, "'position_octaves'|9.5");
}

static void test_network_refuses_times(void **state) {
    random_network_recipe recipe = small_network();
    (void)state;
    recipe.time_width = 9, recipe.times = 30;
    refuse(without(random_network_make(&recipe), "timenet.2.weight"), "'timenet.2.weight'|missing");
    refuse(with_extent(random_network_make(&recipe), "timenet.2.weight", 0, 29), "'timenet.2.weight'|another shape");
    refuse(with_extent(random_network_make(&recipe), "timenet.0.weight", 1, 6), "6 inputs from the time");
    refuse(with_extent(random_network_make(&recipe), "timenet.0.weight", 1, 999), "'timenet.0.weight'|999");
    recipe.times = 63;
    refuse(random_network_make(&recipe), "'linear.0.weight'|63, must be 1 to 62");
}

static void test_nan_is_refused(void **state) {
    static const uint64_t shape[2] = {1, 2};
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    float *values = calloc(2, sizeof *values);
    (void)state;
    assert_non_null(values);
    values[1] = NAN;
    assert_int_equal(td_motion_create(&td_hexplane_class, 0, 1, &motion, NULL), TIDES_OK);
    scene_expect_error(td_motion_take_field(motion, "feature_out.0.weight", 2, shape, values, &error), TIDES_BAD_FILE, &error,
                       "value 1|feature_out.0.weight|nan");
    tides_motion_destroy(motion);
}

/* Arrays and settings that mean nothing here do nothing; a head that is off may be missing. */
static void test_unknown_is_harmless(void **state) {
    static const uint64_t shape[2] = {3, 3};
    random_gaussians gaussians = random_gaussians_make(44, COUNT, 3, 1);
    tides_motion *motion = hexplane();
    td_hexplane shape_of;
    uint64_t seed = 1;
    (void)state;
    random_field(motion, &seed, "timenet.0.weight", 2, shape, 1, 0);
    assert_int_equal(td_motion_set(motion, "posebase_pe", 10, NULL), TIDES_OK);
    assert_int_equal(motion->type->check(motion, &gaussians.view, NULL), TIDES_OK);
    assert_int_equal(td_hexplane_measure(motion, &shape_of, NULL), TIDES_OK);
    assert_int_equal(shape_of.levels, 2);
    assert_int_equal(shape_of.channels, 3);
    assert_int_equal(shape_of.rows, 7);
    assert_int_equal(shape_of.layers, 2);
    assert_int_equal(shape_of.heads, 31);
    tides_motion_destroy(motion);
    random_hexplane_recipe recipe = small_hexplane();
    recipe.heads = TD_HEAD_SCALE, recipe.turns = 1;
    motion = random_hexplane_make(&recipe);
    assert_null(td_motion_field(motion, "pos_deform.1.weight"));
    assert_int_equal(td_hexplane_measure(motion, &shape_of, NULL), TIDES_OK);
    assert_int_equal(shape_of.heads, TD_HEAD_SCALE);
    assert_int_equal(shape_of.turns, 0); /* no rotation to multiply */
    tides_motion_destroy(motion);
    random_gaussians_free(&gaussians);
}

static void expect_moving(const random_hexplane_recipe *recipe, int expected) {
    random_gaussians gaussians = random_gaussians_make(45, COUNT, 0, 1);
    tides_motion *motion = random_hexplane_make(recipe);
    uint8_t moving[COUNT] = {7, 7, 7};
    motion->type->find_moving(motion, &gaussians.view, moving);
    for (int i = 0; i < COUNT; i++) assert_int_equal(moving[i], expected);
    tides_motion_destroy(motion);
    random_gaussians_free(&gaussians);
}

static void test_what_rests(void **state) {
    random_hexplane_recipe recipe = small_hexplane();
    (void)state;
    expect_moving(&recipe, 1);
    recipe.heads = 0;
    expect_moving(&recipe, 0);
    recipe = small_hexplane(), recipe.size[3] = 1;
    expect_moving(&recipe, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hexplane_refuses_missing),
                                       cmocka_unit_test(test_hexplane_refuses_shapes),
                                       cmocka_unit_test(test_hexplane_refuses_sizes),
                                       cmocka_unit_test(test_network_refuses),
                                       cmocka_unit_test(test_network_refuses_times),
                                       cmocka_unit_test(test_nan_is_refused),
                                       cmocka_unit_test(test_unknown_is_harmless),
                                       cmocka_unit_test(test_what_rests)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
