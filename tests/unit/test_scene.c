/* The object store: objects read back as added, those that can't be rendered are refused by name, trajectories are copied; and
 * writing PLY: round trips, unwritable places, a full disk. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

static void test_store(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    assert_int_equal(tides_scene_objects(scene), 0);
    assert_int_equal(tides_scene_count(scene), 0);
    assert_int_equal(tides_scene_sh_degree(scene), 0);
    td_gaussians all[5];
    for (int32_t i = 0; i < 5; i++) {
        int32_t index = -1;
        all[i] = scene_random(20 + (uint64_t)i, 3 + i, i, SCENE_TRAINED);
        tides_gaussians view = td_gaussians_view(&all[i]);
        scene_expect_ok(tides_scene_add(scene, &view, NULL, 1 + i, i % 2 ? "odd" : NULL, &index, &error), &error);
        assert_int_equal(index, i);
    }
    assert_int_equal(tides_scene_objects(scene), 5);
    assert_int_equal(tides_scene_count(scene), 25);
    assert_int_equal(tides_scene_sh_degree(scene), 4);
    for (int32_t i = 0; i < 5; i++) {
        tides_object object = scene_object_of(scene, i);
        assert_true(scene_same(&all[i], &object.gaussians));
        assert_true(object.gaussians.mean != all[i].mean); /* a copy */
        assert_true(object.scale == 1 + i);
        assert_true(object.trajectory == NULL);
        assert_string_equal(object.name, i == 1 || i == 3 ? "odd" : i == 0 ? "object 0" : i == 2 ? "object 2" : "object 4");
        assert_string_equal(object.source, "");
        td_gaussians_free(&all[i]);
    }
    tides_object object;
    scene_expect_error(tides_scene_object(scene, 5, &object, &error), TIDES_BAD_ARGUMENT, &error, "object 5|has 5");
    scene_expect_error(tides_scene_object(scene, -1, &object, &error), TIDES_BAD_ARGUMENT, &error, "object -1");
    tides_scene_destroy(scene);
    tides_scene_destroy(NULL);
}

static void test_null_arguments(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    tides_object object;
    tides_gaussians none = {.count = 1};
    assert_int_equal(tides_scene_create(NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_add(NULL, &none, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_add(scene, NULL, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    scene_expect_error(tides_scene_add(scene, &none, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "mean is NULL");
    assert_int_equal(tides_scene_add_file(scene, NULL, NULL, 1, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_add_file(NULL, "x.ply", NULL, 1, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_save(scene, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_save(NULL, "x.ply", &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_object(scene, 0, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_object(NULL, 0, &object, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_scene_objects(NULL), 0);
    tides_scene_destroy(scene);
}

/* One value of one array made wrong; object, Gaussian and property are named, and the scene stays as it was. */
static void test_bad_values(void **state) {
    (void)state;
    enum { MEAN, LOG_SCALE, QUATERNION, OPACITY, SH };
    static const struct {
        int array, at;
        float value;
        double scale;
        const char *expected;
    } cases[] = {{MEAN, 7, NAN, 1, "Gaussian 2: mean[1] is nan"},
                 {MEAN, 0, INFINITY, 1, "Gaussian 0: mean[0] is inf"},
                 {MEAN, 0, 1e30f, 1e10, "Gaussian 0: mean[0]|beyond 1e18"},
                 {LOG_SCALE, 11, -INFINITY, 1, "Gaussian 3: log_scale[2] is -inf"},
                 {LOG_SCALE, 4, 88.8f, 1, "Gaussian 1: log_scale[1] is 88.8|float's range"},
                 {LOG_SCALE, 4, 80.0f, 1e4, "Gaussian 1: log_scale[1] is 80|float's range|10000"},
                 {QUATERNION, 15, NAN, 1, "Gaussian 3: quaternion[3] is nan"},
                 {QUATERNION, -1, 0, 1, "Gaussian 2: quaternion (0 0 0 0) has norm 0"},
                 {QUATERNION, -1, 1e-20f, 1, "Gaussian 2: quaternion|too small"},
                 {QUATERNION, -1, 1e20f, 1, "Gaussian 2: quaternion|too large"},
                 {OPACITY, 3, NAN, 1, "Gaussian 3: opacity_logit is nan"},
                 {SH, 2 * 27 + 3 * 5 + 1, -INFINITY, 1, "Gaussian 2: sh[5][1] is -inf"},
                 {SH, 27 + 3 * 8 + 2, -1.1e18f, 1, "Gaussian 1: sh[8][2] is -1.1e+18|beyond 1e18"}};
    tides_scene *scene = scene_new();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tides_error error = {0, ""};
        td_gaussians g = scene_random(30, 4, 2, SCENE_TRAINED);
        float *const arrays[] = {g.mean, g.log_scale, g.quaternion, g.opacity_logit, g.sh};
        if (cases[i].at < 0)
            for (int k = 0; k < 4; k++) g.quaternion[8 + k] = cases[i].value;
        else
            arrays[cases[i].array][cases[i].at] = cases[i].value;
        tides_gaussians view = td_gaussians_view(&g);
        int32_t index = 77;
        tides_status status = tides_scene_add(scene, &view, NULL, cases[i].scale, "fan", &index, &error);
        scene_expect_error(status, TIDES_BAD_ARGUMENT, &error, cases[i].expected);
        scene_expect_error(status, TIDES_BAD_ARGUMENT, &error, "object 0 ('fan')");
        assert_int_equal(tides_scene_add(scene, &view, NULL, cases[i].scale, NULL, &index, NULL), TIDES_BAD_ARGUMENT);
        assert_int_equal(index, 77);
        assert_int_equal(tides_scene_objects(scene), 0);
        td_gaussians_free(&g);
    }
    tides_scene_destroy(scene);
}

static void test_bad_counts_and_scales(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(31, 4, 0, SCENE_TRAINED);
    tides_gaussians view = td_gaussians_view(&g);
    static const double scales[] = {0, -1, NAN, INFINITY, 1e300};
    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++)
        scene_expect_error(tides_scene_add(scene, &view, NULL, scales[i], NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                           "object 0|scale is|positive");
    static const int64_t counts[] = {0, -1, INT64_MIN};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        view.count = counts[i];
        scene_expect_error(tides_scene_add(scene, &view, NULL, 1, "fan", NULL, &error), TIDES_BAD_ARGUMENT, &error,
                           "fan|count is|at least one");
    }
    view.count = INT64_MAX; /* the bytes overflow before anything is read */
    assert_int_equal(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), TIDES_NO_MEMORY);
    view.count = 4;
    static const int32_t degrees[] = {-1, 5, INT32_MAX};
    for (size_t i = 0; i < sizeof degrees / sizeof degrees[0]; i++) {
        view.sh_degree = degrees[i];
        scene_expect_error(tides_scene_add(scene, &view, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                           "sh_degree is|0 to 4");
    }
    assert_int_equal(tides_scene_objects(scene), 0);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

static void test_bounds(void **state) {
    (void)state;
    double lower[3] = {1, 1, 1}, upper[3] = {-1, -1, -1};
    tides_scene *scene = scene_new();
    tides_scene_bounds(scene, lower, upper);
    for (int axis = 0; axis < 3; axis++) assert_true(lower[axis] == 0 && upper[axis] == 0);
    td_gaussians g = scene_random(32, 2, 0, SCENE_TRAINED);
    memcpy(g.mean, (float[]){1, 2, 3, -1, 0, 5}, 6 * sizeof(float));
    scene_add(scene, &g, NULL, 2, NULL);
    tides_scene_bounds(scene, lower, upper);
    assert_true(lower[0] == -2);
    assert_true(lower[1] == 0);
    assert_true(lower[2] == 6);
    assert_true(upper[0] == 2);
    assert_true(upper[1] == 4);
    assert_true(upper[2] == 10);

    /* a quarter turn about z at the start, and away: the start counts */
    tides_error error = {0, ""};
    tides_trajectory *path = NULL;
    const double h = sqrt(0.5);
    const tides_pose_sample samples[] = {{.time = 5, .position = {100, 0, 0}, .quaternion = {h, 0, 0, h}},
                                         {.time = 6, .position = {1000, 0, 0}, .quaternion = {h, 0, 0, h}}};
    scene_expect_ok(tides_trajectory_create(samples, 2, &path, &error), &error);
    scene_add(scene, &g, path, 1, NULL); /* (x, y) to (100 - y, x) */
    tides_trajectory_destroy(path);
    tides_scene_bounds(scene, lower, upper);
    assert_true(fabs(upper[0] - 100) < 1e-12);
    assert_true(lower[0] == -2);
    assert_true(upper[1] == 4);
    assert_true(fabs(lower[1] + 1) < 1e-12);

    scene_expect_ok(tides_trajectory_create_static((double[]){0, 0, -50}, (double[]){1, 0, 0, 0}, &path, &error), &error);
    scene_add(scene, &g, path, 1, NULL);
    tides_trajectory_destroy(path);
    tides_scene_bounds(scene, lower, upper);
    assert_true(lower[2] == -47);
    assert_true(upper[2] == 10);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

/* The scene's own path outlives the caller's and is the same curve. */
static void test_trajectory_is_copied(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_trajectory *path = NULL;
    tides_orbit orbit = {.up = {0, 0, 1}, .radius = 2, .angular_speed = 3, .stop = 1};
    scene_expect_ok(tides_trajectory_create_orbit(&orbit, &path, &error), &error);
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(33, 2, 0, SCENE_TRAINED);
    scene_add(scene, &g, path, 1, NULL);
    tides_object object = scene_object_of(scene, 0);
    assert_non_null(object.trajectory);
    assert_ptr_not_equal(object.trajectory, path);
    for (int i = 0; i <= 100; i++) {
        tides_pose ours, theirs;
        scene_expect_ok(tides_trajectory_at(object.trajectory, 0.01 * i, &ours, &error), &error);
        scene_expect_ok(tides_trajectory_at(path, 0.01 * i, &theirs, &error), &error);
        for (int k = 0; k < 9; k++) assert_true(fabs(ours.rotation_dot[k] - theirs.rotation_dot[k]) < 1e-12);
        for (int k = 0; k < 3; k++) assert_true(fabs(ours.position[k] - theirs.position[k]) < 1e-12);
    }
    tides_trajectory_destroy(path);
    tides_pose pose;
    scene_expect_ok(tides_trajectory_at(scene_object_of(scene, 0).trajectory, 0.5, &pose, &error), &error);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

/* -- files -- */

static void test_ply_round_trip(void **state) {
    tides_error error = {0, ""};
    for (int32_t degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        tides_scene *scene = scene_new(), *again = scene_new();
        td_gaussians g = scene_random(40 + (uint64_t)degree, 17, degree, SCENE_TRAINED);
        scene_add(scene, &g, NULL, 1, "x");
        const char *path = scene_in_folder(*state, degree % 2 ? "a.b.PLY" : "a.b.ply");
        scene_expect_ok(tides_scene_save(scene, path, &error), &error);
        scene_expect_ok(tides_scene_add_file(again, path, NULL, 3, &error), &error);
        tides_object object = scene_object_of(again, 0);
        assert_true(scene_same(&g, &object.gaussians));
        assert_string_equal(object.name, "a.b");
        assert_string_equal(object.source, path);
        assert_true(object.scale == 3);
        assert_int_not_equal(access(scene_in_folder(*state, degree % 2 ? "a.b.PLY.part" : "a.b.ply.part"), F_OK), 0);
        td_gaussians_free(&g);
        tides_scene_destroy(scene);
        tides_scene_destroy(again);
    }
}

/* INRIA's header, letter by letter, and the size that follows from it. */
static void test_ply_layout(void **state) {
    static const char expected[] =
        "ply\nformat binary_little_endian 1.0\ncomment ColourTransfer: linear\nelement vertex 2\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nproperty float f_dc_0\nproperty float f_dc_1\n"
        "property float f_dc_2\nproperty float f_rest_0\nproperty float f_rest_1\nproperty float f_rest_2\n"
        "property float f_rest_3\nproperty float f_rest_4\nproperty float f_rest_5\nproperty float f_rest_6\n"
        "property float f_rest_7\nproperty float f_rest_8\nproperty float opacity\nproperty float scale_0\n"
        "property float scale_1\nproperty float scale_2\nproperty float rot_0\nproperty float rot_1\nproperty float rot_2\n"
        "property float rot_3\nend_header\n";
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(50, 2, 1, SCENE_TRAINED);
    g.mean[0] = 1; /* 0x3f800000 */
    scene_add(scene, &g, NULL, 1, NULL);
    const char *path = scene_in_folder(*state, "s.ply");
    scene_expect_ok(tides_scene_save(scene, path, &error), &error);
    size_t size;
    char *data = scene_file_read(path, &size);
    assert_int_equal(size, sizeof expected - 1 + 2 * 26 * 4);
    assert_memory_equal(data, expected, sizeof expected - 1);
    assert_memory_equal(data + sizeof expected - 1, "\0\0\x80\x3f", 4);
    free(data);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

/* A PLY has no place for an object's scale: it goes into means and scales. */
static void test_ply_scale(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(51, 5, 1, SCENE_TRAINED);
    scene_add(scene, &g, NULL, 2, NULL);
    const char *path = scene_in_folder(*state, "s.ply");
    scene_expect_ok(tides_scene_save(scene, path, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    tides_object object = scene_object_of(scene, 1);
    for (size_t i = 0; i < 15; i++) {
        assert_true(object.gaussians.mean[i] == 2 * g.mean[i]);
        assert_true(fabs(object.gaussians.log_scale[i] - (g.log_scale[i] + log(2))) < 1e-6);
    }
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

static void test_save_refusals(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(52, 5, 1, SCENE_TRAINED);
    const char *ply = scene_in_folder(*state, "s.ply");
    scene_expect_error(tides_scene_save(scene, ply, &error), TIDES_BAD_ARGUMENT, &error, "s.ply|scene is empty");
    scene_add(scene, &g, NULL, 1, NULL);
    scene_expect_error(tides_scene_save(scene, "s.ksplat", &error), TIDES_BAD_ARGUMENT, &error,
                       "s.ksplat|.ply, .spz, .glb, .h5 or .splat");
    scene_expect_error(tides_scene_save(scene, "ply", &error), TIDES_BAD_ARGUMENT, &error, ".ply, .spz");
    scene_add(scene, &g, NULL, 1, NULL);
    scene_expect_error(tides_scene_save(scene, ply, &error), TIDES_UNSUPPORTED, &error, "s.ply|one object|has 2|.h5");
    tides_scene_destroy(scene);
    scene = scene_new();
    tides_trajectory *path = NULL;
    scene_expect_ok(tides_trajectory_create_static((double[]){0, 0, 0}, (double[]){1, 0, 0, 0}, &path, &error), &error);
    scene_add(scene, &g, path, 1, "fan");
    scene_expect_error(tides_scene_save(scene, ply, &error), TIDES_UNSUPPORTED, &error, "trajectory of 'fan'|.h5");
    assert_int_not_equal(access(ply, F_OK), 0);
    tides_trajectory_destroy(path);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

/* Neither a missing folder nor a link that somebody put in the place of the .part file harms the file that was there. */
static void test_unwritable(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(53, 2000, 3, SCENE_TRAINED);
    scene_add(scene, &g, NULL, 1, NULL);
    static const char *const names[] = {"s.ply", "s.h5"}, *const parts[] = {"s.ply.part", "s.h5.part"},
                             *const missing[] = {"none/s.ply", "none/s.h5"};
    for (int i = 0; i < 2; i++) {
        scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, missing[i]), &error), TIDES_WRITE_FAILED, &error,
                           missing[i]);
        const char *path = scene_in_folder(*state, names[i]), *part = scene_in_folder(*state, parts[i]);
        scene_file_write(path, "old", 3);
        if (symlink("/dev/full", part) != 0 || access("/dev/full", W_OK) != 0) skip();
        scene_expect_error(tides_scene_save(scene, path, &error), TIDES_WRITE_FAILED, &error, names[i]);
        assert_int_equal(remove(part), 0); /* it is theirs */
        size_t size;
        char *data = scene_file_read(path, &size);
        assert_string_equal(data, "old");
        free(data);
    }
    struct stat facts;
    assert_int_equal(stat("/dev/full", &facts), 0); /* the link went, not what it points to */
    /* a folder in the file's place */
    assert_int_equal(mkdir(scene_in_folder(*state, "d.ply"), 0700), 0);
    scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, "d.ply"), &error), TIDES_WRITE_FAILED, &error,
                       "d.ply: is a folder");
    assert_int_not_equal(access(scene_in_folder(*state, "d.ply.part"), F_OK), 0);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

static void test_unreadable(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    const char *path = scene_in_folder(*state, "s.ply");
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_FILE_NOT_FOUND, &error, "s.ply|No such file");
    scene_expect_error(tides_scene_add_file(scene, *state, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "no folder of a trained model");
    scene_file_write(path, "", 0);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, "s.ply: is empty");
    scene_file_write(path, "JUNK", 4);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "is no scene, neither .ply|.h5");
    scene_file_write(path, "ply", 3);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, "s.ply|neither");
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
}

/* A file's bad values are the file's fault; a bad scale is the caller's. */
static void test_bad_values_in_file(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(54, 3, 0, SCENE_TRAINED);
    const char *path = scene_in_folder(*state, "s.ply");
    scene_bytes bytes = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    scene_file_write(path, bytes.data, bytes.size);
    free(bytes.data);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, -2, &error), TIDES_BAD_ARGUMENT, &error, "s.ply|scale is -2");
    g.opacity_logit[1] = NAN;
    bytes = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    scene_file_write(path, bytes.data, bytes.size);
    free(bytes.data);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "s.ply|object 0 ('s')|Gaussian 1: opacity_logit is nan");
    assert_int_equal(tides_scene_objects(scene), 0);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_store),       cmocka_unit_test(test_null_arguments),
        cmocka_unit_test(test_bad_values),  cmocka_unit_test(test_bad_counts_and_scales),
        cmocka_unit_test(test_bounds),      cmocka_unit_test(test_trajectory_is_copied),
        IN_FOLDER(test_ply_round_trip),     IN_FOLDER(test_ply_layout),
        IN_FOLDER(test_ply_scale),          IN_FOLDER(test_save_refusals),
        IN_FOLDER(test_unwritable),         IN_FOLDER(test_unreadable),
        IN_FOLDER(test_bad_values_in_file),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
