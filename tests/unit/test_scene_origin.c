/* Means far from (0, 0, 0): which scenes get an origin, no reader rounds a file's means before it is subtracted, files are
 * written with their own coordinates, and motions see those too. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_motion.h"
#include "tests/support/motion_rows.h"
#include "tests/support/random_network.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 40 };

/* A multiple of 4, as the origin of means within 1 is, so that it is taken off whole. */
static const double far_off[3] = {4194304, -1048576, 65536};

static double on_grid(double x) { return round(x * 0x1p20) * 0x1p-20; }

/* Means within 1 of `offset`, multiples of 2^-20; freed with td_gaussians_free. */
static td_gaussians cloud(const double offset[3]) {
    td_gaussians g = scene_random(5, COUNT, 1, SCENE_TRAINED);
    tides_error error;
    uint64_t seed = 6;
    scene_expect_ok(td_gaussians_widen(&g, &error), &error);
    for (size_t i = 0; i < COUNT; i++)
        for (size_t k = 0; k < 3; k++) {
            g.log_scale[3 * i + k] = -3;
            td_gaussians_put_mean(&g, i, k, offset[k] + on_grid((double)(scene_next(&seed) >> 11) * 0x1p-52 - 1));
        }
    return g;
}

/* The first object holds the cloud, without a bit lost. */
static void expect_cloud(const tides_scene *scene, const td_gaussians *want, int far) {
    const tides_object object = scene_object_of(scene, 0);
    const tides_gaussians *g = &object.gaussians;
    assert_int_equal(g->count, COUNT);
    for (int i = 0; i < 3 * COUNT; i++) {
        assert_true(g->origin[i % 3] == (far ? far_off[i % 3] : 0));
        assert_true(g->origin[i % 3] + g->mean[i] == want->mean_double[i]);
    }
}

/* -- which ----------------------------------------------------------------------------------------------------------- */

static tides_scene *scene_of(const td_gaussians *g) {
    tides_scene *scene = scene_new();
    tides_error error;
    tides_gaussians view = td_gaussians_view(g);
    view.mean_double = g->mean_double;
    view.mean = g->mean_double ? NULL : g->mean;
    scene_expect_ok(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), &error);
    return scene;
}

static void test_near_scenes_keep_their_bits(void **state) {
    static const double places[][3] = {{0, 0, 0}, {3, -5, 8}, {12, 12, 12}};
    (void)state;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        td_gaussians g = cloud(places[i]);
        tides_scene *scene = scene_of(&g);
        const tides_object object = scene_object_of(scene, 0);
        assert_memory_equal(object.gaussians.mean, g.mean, 3 * COUNT * sizeof *g.mean);
        for (int k = 0; k < 3; k++) assert_true(object.gaussians.origin[k] == 0);
        tides_scene_destroy(scene);
        td_gaussians_free(&g);
    }
}

static void test_far_scenes_get_an_origin(void **state) {
    td_gaussians g = cloud(far_off);
    tides_scene *scene = scene_of(&g);
    double lower[3], upper[3], lower_at[3], upper_at[3];
    (void)state;
    expect_cloud(scene, &g, 1);
    tides_scene_bounds(scene, lower, upper);
    assert_int_equal(tides_scene_bounds_at(scene, 0, lower_at, upper_at, NULL), TIDES_OK);
    for (int k = 0; k < 3; k++) {
        assert_true(lower[k] >= far_off[k] - 1);
        assert_true(lower[k] < far_off[k] - 0.5);
        assert_true(upper[k] <= far_off[k] + 1);
        assert_true(upper[k] > far_off[k] + 0.5);
        assert_true(lower[k] == lower_at[k]);
        assert_true(upper[k] == upper_at[k]);
    }
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

/* A splat by itself has one, and a cloud of which a few have strayed to (0, 0, 0) too. */
static void test_one_and_strays(void **state) {
    td_gaussians g = cloud(far_off);
    (void)state;
    for (int i = 0; i < COUNT; i += COUNT - 1)
        for (size_t k = 0; k < 3; k++) td_gaussians_put_mean(&g, (size_t)i, k, 0);
    tides_scene *scene = scene_of(&g);
    expect_cloud(scene, &g, 1);
    tides_scene_destroy(scene);
    for (size_t k = 0; k < 3; k++) td_gaussians_put_mean(&g, 0, k, far_off[k]);
    g.count = 1;
    scene = scene_of(&g);
    for (int k = 0; k < 3; k++) assert_true(scene_object_of(scene, 0).gaussians.origin[k] == far_off[k]);
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

/* What is given relative to an origin stays so, to the bit; beyond single precision's range it is refused. */
static void test_given_origin(void **state) {
    static const double none[3] = {0};
    td_gaussians g = cloud(none);
    tides_gaussians view = td_gaussians_view(&g);
    tides_scene *scene = scene_new();
    tides_error error;
    (void)state;
    view.origin[1] = 1234567.8;
    scene_expect_ok(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), &error);
    const tides_object object = scene_object_of(scene, 0);
    assert_true(object.gaussians.origin[1] == 1234567.8);
    assert_true(object.gaussians.origin[0] == 0);
    assert_memory_equal(object.gaussians.mean, g.mean, 3 * COUNT * sizeof *g.mean);
    view.origin[2] = NAN;
    scene_expect_error(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "origin[2]|nan");
    view.origin[2] = 1e39;
    scene_expect_error(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "origin[2]");
    view.origin[2] = 0;
    td_gaussians_put_mean(&g, 7, 1, -1e200);
    view.mean_double = g.mean_double;
    scene_expect_error(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                       "Gaussian 7|mean[1]|-inf");
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

/* -- files ----------------------------------------------------------------------------------------------------------- */

/* All rows of an ASCII file, means in as many digits as they have; SH of degree 1. */
static void write_text_ply(const char *path, const td_gaussians *g, const char *type) {
    static const char *const rest[] = {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"};
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fprintf(out, "ply\nformat ascii 1.0\nelement vertex %d\n", COUNT);
    for (int k = 0; k < 3; k++) fprintf(out, "property %s %c\n", type, 'x' + k);
    for (int k = 0; k < 3; k++) fprintf(out, "property float f_dc_%d\n", k);
    for (int k = 0; k < 9; k++) fprintf(out, "property float f_rest_%d\n", k);
    for (size_t k = 0; k < sizeof rest / sizeof *rest; k++) fprintf(out, "property float %s\n", rest[k]);
    fprintf(out, "end_header\n");
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) fprintf(out, "%.17g ", g->mean_double[3 * i + k]);
        for (int k = 0; k < 12; k++) fprintf(out, "0.5 ");
        fprintf(out, "1 -3 -3 -3 1 0 0 0\n");
    }
    assert_int_equal(fclose(out), 0);
}

static tides_scene *load(const char *path) {
    tides_scene *scene = scene_new();
    scene_load(scene, path, NULL, 1);
    return scene;
}

static void expect_file(const char *path, const td_gaussians *want) {
    tides_scene *scene = load(path);
    expect_cloud(scene, want, 1);
    tides_scene_destroy(scene);
}

/* Text, doubles and .h5, there and back, keep every digit. */
static void test_files_keep_their_digits(void **state) {
    td_gaussians g = cloud(far_off);
    const char *ply = scene_in_folder(*state, "text.ply"), *copy = scene_in_folder(*state, "copy.ply");
    const char *h5 = scene_in_folder(*state, "copy.h5");
    write_text_ply(ply, &g, "float");
    expect_file(ply, &g);
    write_text_ply(ply, &g, "double");
    tides_scene *scene = load(ply);
    scene_save(scene, copy);
    scene_save(scene, h5);
    tides_scene_destroy(scene);
    expect_file(copy, &g);
    expect_file(h5, &g);
    size_t size;
    char *bytes = scene_file_read(copy, &size);
    assert_non_null(strstr(bytes, "property double x\n"));
    assert_non_null(strstr(bytes, "property float nx\n"));
    free(bytes);
    td_gaussians_free(&g);
}

/* What came as floats is written as floats, the same ones. */
static void test_float_files_stay_so(void **state) {
    td_gaussians g = cloud(far_off);
    const char *ply = scene_in_folder(*state, "float.ply"), *copy = scene_in_folder(*state, "copy.ply");
    for (int i = 0; i < 3 * COUNT; i++) g.mean_double[i] = g.mean[i];
    scene_bytes made = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    scene_file_write(ply, made.data, made.size);
    tides_scene *scene = load(ply);
    for (int i = 0; i < 3 * COUNT; i++) {
        const tides_gaussians got = scene_object_of(scene, 0).gaussians;
        assert_true(got.origin[0] > 4e6);
        assert_true(got.origin[i % 3] + got.mean[i] == (double)g.mean[i]);
    }
    scene_save(scene, copy);
    tides_scene_destroy(scene);
    size_t size;
    char *bytes = scene_file_read(copy, &size);
    assert_null(strstr(bytes, "double"));
    scene = load(copy);
    scene_save(scene, ply);
    size_t again_size;
    char *again = scene_file_read(ply, &again_size);
    assert_int_equal(size, again_size);
    assert_memory_equal(bytes, again, size);
    tides_scene_destroy(scene);
    free(bytes);
    free(again);
    free(made.data);
    td_gaussians_free(&g);
}

/* -- motions --------------------------------------------------------------------------------------------------------- */

enum { FEW = 16, HALFWAY = 2 };

/* The same Gaussians with their means relative to an origin; those of `whole` are rounded so that nothing more is. */
static const double shift[3] = {0.5, -0.25, 1};

static random_gaussians shifted(const random_gaussians *whole) {
    random_gaussians made = random_gaussians_make(9, FEW, 1, 1);
    for (int i = 0; i < 3 * FEW; i++) {
        float at = roundf(whole->view.mean[i] * 0x1p12f) * 0x1p-12f;
        made.values[i] = at - (float)shift[i % 3];
        whole->values[i] = at;
    }
    memcpy(made.view.origin, shift, sizeof shift);
    return made;
}

/* Rows of the shifted Gaussians are the others', but for the origin. */
static void check_motion(tides_motion *motion, const char *what) {
    random_gaussians whole = random_gaussians_make(9, FEW, 1, 1), relative = shifted(&whole);
    packed_motion a = packed_motion_make(motion, &whole.view), b = packed_motion_make(motion, &relative.view);
    motion_rows plain = motion_rows_f64(&a, 0.4, 1, NULL, FEW, 12), moved = motion_rows_f64(&b, 0.4, 1, NULL, FEW, 12);
    for (int i = 0; i < FEW * TD_GEOMETRY_STRIDE; i++) {
        int k = i % TD_GEOMETRY_STRIDE, axis = k < 3 ? k : k >= TD_G_ORIGIN ? k - TD_G_ORIGIN : -1;
        double got = moved.geometry[i] + (axis >= 0 ? shift[axis] : 0);
        if (!(fabs(got - plain.geometry[i]) < 1e-12)) fail_msg("%s: entry %d of row %d", what, k, i / TD_GEOMETRY_STRIDE);
        if (!(fabs(moved.rates[i] - plain.rates[i]) < 1e-10))
            fail_msg("%s: rate %d of row %d", what, k, i / TD_GEOMETRY_STRIDE);
    }
    motion_rows_free(&plain);
    motion_rows_free(&moved);
    packed_motion_free(&a);
    packed_motion_free(&b);
    random_gaussians_free(&whole);
    random_gaussians_free(&relative);
    tides_motion_destroy(motion);
}

static void test_networks_see_where_they_were_trained(void **state) {
    random_hexplane_recipe hexplane = {41, 3, {4, 5, 6, 7}, 2, 10, 2, 31, 0, 0.2};
    random_network_recipe network = {42, 12, 4, 2, 3, 0, 0, 0, 0.2};
    (void)state;
    check_motion(random_hexplane_make(&hexplane), "hexplane");
    check_motion(random_network_make(&network), "network");
}

/* A network that turns means about (0, 0, 0) can't be moved: its Gaussians stay. */
static void test_screws_keep_their_means(void **state) {
    random_network_recipe recipe = {42, 12, 4, 2, 3, 0, 0, 1, 0.2};
    random_gaussians g = random_gaussians_make(9, FEW, 1, 1);
    tides_scene *scene = scene_new();
    tides_error error;
    (void)state;
    for (int i = 0; i < 3 * FEW; i++) g.values[i] += 4096;
    tides_motion *motion = random_network_make(&recipe);
    scene_expect_ok(tides_scene_add_moving(scene, &g.view, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    const tides_object object = scene_object_of(scene, 0);
    assert_memory_equal(object.gaussians.mean, g.values, 3 * FEW * sizeof *g.values);
    assert_true(object.gaussians.origin[0] == 0);
    tides_scene_destroy(scene);
    random_gaussians_free(&g);
}

/* Doubles at the time: a callback sees the coordinates that its scene was given, and gives such. */
static tides_status push(void *user, double time, int32_t side, const int32_t *index, int64_t count, const tides_theta *theta,
                         tides_error *error) {
    const td_gaussians *g = user;
    (void)side, (void)error;
    for (int64_t i = 0; i < 3 * count; i++) {
        if (theta->mean[i] != g->mean_double[3 * index[i / 3] + i % 3]) return TIDES_BAD_ARGUMENT;
        theta->mean[i] += time * HALFWAY;
        theta->mean_dot[i] = HALFWAY;
    }
    return TIDES_OK;
}

static void test_callbacks_see_coordinates(void **state) {
    td_gaussians g = cloud(far_off);
    tides_gaussians view = td_gaussians_view(&g);
    tides_callback_motion callback = {.count = COUNT, .start = 0, .stop = 1, .function = push, .user = &g};
    tides_motion *motion = NULL;
    tides_scene *scene = scene_new();
    tides_error error;
    double lower[3], upper[3], before[3], after[3];
    (void)state;
    view.mean_double = g.mean_double;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &view, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    expect_cloud(scene, &g, 1);
    tides_scene_bounds(scene, before, after);
    scene_expect_ok(tides_scene_bounds_at(scene, 0.5, lower, upper, &error), &error);
    for (int k = 0; k < 3; k++) assert_true(lower[k] == before[k] + 1 && upper[k] == after[k] + 1);
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

/* Keyframes in double, saved and loaded: those whose means stay are found to rest, the others are where they were. */
static void test_keyframes_keep_their_digits(void **state) {
    enum { FRAMES = 3 };
    static const double time[FRAMES] = {0, 0.5, 1};
    td_gaussians g = cloud(far_off);
    double *mean = calloc(FRAMES * 3 * COUNT, sizeof *mean), lower[3], upper[3], again[3], above[3];
    float *quaternion = calloc(FRAMES * 4 * COUNT, sizeof *quaternion);
    const char *h5 = scene_in_folder(*state, "keyframes.h5");
    tides_gaussians view = td_gaussians_view(&g);
    tides_motion *motion = NULL;
    tides_error error;
    assert_true(mean && quaternion);
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < COUNT; i++) {
            for (int k = 0; k < 3; k++)
                mean[3 * (f * COUNT + i) + k] = g.mean_double[3 * i + k] + (i < COUNT / 2 ? f * 0.125 : 0);
            memcpy(quaternion + 4 * (f * COUNT + i), g.quaternion + 4 * i, 4 * sizeof *quaternion);
        }
    const tides_keyframes_motion keys = {.frames = FRAMES,
                                         .count = COUNT,
                                         .time = time,
                                         .quaternion = quaternion,
                                         .mean_double = mean};
    view.mean_double = g.mean_double;
    tides_scene *scene = scene_new();
    scene_expect_ok(tides_motion_create_keyframes(&keys, &motion, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &view, motion, 0, NULL, 1, NULL, NULL, &error), &error);
    scene_save(scene, h5);
    tides_scene *loaded = load(h5);
    expect_cloud(loaded, &g, 1);
    const tides_object object = scene_object_of(loaded, 0);
    assert_int_equal(tides_motion_moving(object.motion, &object.gaussians), COUNT / 2);
    scene_expect_ok(tides_scene_bounds_at(scene, 0.5, lower, upper, &error), &error);
    scene_expect_ok(tides_scene_bounds_at(loaded, 0.5, again, above, &error), &error);
    assert_memory_equal(lower, again, sizeof lower);
    assert_memory_equal(upper, above, sizeof upper);
    tides_scene_destroy(scene);
    tides_scene_destroy(loaded);
    td_gaussians_free(&g);
    free(mean);
    free(quaternion);
}

/* Frames in files of doubles, the second one only: the first frame's floats stay what they are. */
static void test_frames_keep_their_digits(void **state) {
    td_gaussians g = cloud(far_off);
    const char *first = scene_in_folder(*state, "time_00000.ply"), *second = scene_in_folder(*state, "time_00001.ply");
    double lower[3], upper[3];
    tides_error error;
    scene_bytes made = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    scene_file_write(first, made.data, made.size);
    for (int i = 0; i < 3 * COUNT; i++) g.mean_double[i] = far_off[i % 3] + (i < 3 ? -0x1p-19 : 0x1p-19);
    write_text_ply(second, &g, "double");
    tides_scene *scene = load(*state);
    scene_expect_ok(tides_scene_bounds_at(scene, 1, lower, upper, &error), &error);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(lower[k] - far_off[k] + 0x1p-19) < 0x1p-22);
        assert_true(fabs(upper[k] - far_off[k] - 0x1p-19) < 0x1p-22);
    }
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
    free(made.data);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_near_scenes_keep_their_bits),
        cmocka_unit_test(test_far_scenes_get_an_origin),
        cmocka_unit_test(test_one_and_strays),
        cmocka_unit_test(test_given_origin),
        IN_FOLDER(test_files_keep_their_digits),
        IN_FOLDER(test_float_files_stay_so),
        cmocka_unit_test(test_networks_see_where_they_were_trained),
        cmocka_unit_test(test_screws_keep_their_means),
        cmocka_unit_test(test_callbacks_see_coordinates),
        IN_FOLDER(test_keyframes_keep_their_digits),
        IN_FOLDER(test_frames_keep_their_digits),
    };
    return cmocka_run_group_tests_name("scene_origin", tests, NULL, NULL);
}
