/* TIDES' own scene files: round trips with everything that a scene has, placement, and no messages from HDF5. */
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

#include <hdf5.h>
#include <math.h>
#include <unistd.h>

static void expect_same_path(const tides_trajectory *a, const tides_trajectory *b) {
    assert_int_equal(tides_trajectory_count(a), tides_trajectory_count(b));
    for (size_t i = 0; i < tides_trajectory_count(a); i++) {
        tides_pose_sample s, t;
        assert_int_equal(tides_trajectory_sample(a, i, &s, NULL), TIDES_OK);
        assert_int_equal(tides_trajectory_sample(b, i, &t, NULL), TIDES_OK);
        assert_true(s.time == t.time);
        assert_true(s.has_rates == t.has_rates);
        assert_memory_equal(s.position, t.position, sizeof s.position);
        for (int k = 0; k < 4; k++) assert_true(fabs(s.quaternion[k] - t.quaternion[k]) < 1e-15);
        if (!s.has_rates) continue;
        assert_memory_equal(s.velocity, t.velocity, sizeof s.velocity);
        assert_memory_equal(s.angular_velocity, t.angular_velocity, sizeof s.angular_velocity);
    }
}

static void test_round_trip(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new(), *again = scene_new();
    tides_trajectory *paths[5] = {NULL, scene_path(0), scene_path(1), NULL, NULL};
    const double place[3] = {1, 2, 3}, turn[4] = {0, 1, 0, 0};
    scene_expect_ok(tides_trajectory_create_static(place, turn, &paths[3], &error), &error);
    static const char *const names[5] = {"wall", "fan \"\xc3\xa9\"", "", NULL, "4"};
    td_gaussians all[5];
    for (int32_t i = 0; i < 5; i++) {
        all[i] = scene_random(60 + (uint64_t)i, 1 + 10 * i, i, SCENE_TRAINED);
        scene_add(scene, &all[i], paths[i], 0.5 + i, names[i]);
    }
    const char *path = scene_in_folder(*state, "s.h5");
    scene_save(scene, path);
    assert_int_not_equal(access(scene_in_folder(*state, "s.h5.part"), F_OK), 0);
    scene_load(again, path, NULL, 1);
    assert_int_equal(tides_scene_objects(again), 5);
    for (int32_t i = 0; i < 5; i++) {
        tides_object object = scene_object_of(again, i);
        assert_true(scene_same(&all[i], &object.gaussians));
        assert_true(object.scale == 0.5 + i);
        assert_string_equal(object.name, i == 3 ? "object 3" : names[i]);
        assert_string_equal(object.source, path); /* made from arrays: no file before this one */
        assert_int_equal(object.trajectory != NULL, paths[i] != NULL);
        if (paths[i]) expect_same_path(object.trajectory, paths[i]);
        td_gaussians_free(&all[i]);
        tides_trajectory_destroy(paths[i]);
    }
    tides_pose pose;
    scene_expect_ok(tides_trajectory_at(scene_object_of(again, 3).trajectory, 1e9, &pose, &error), &error); /* still static */
    tides_scene_destroy(scene);
    tides_scene_destroy(again);
}

/* PLY to HDF5 to PLY gives the bytes back, and the source stays the first file. */
static void test_ply_hdf5_ply(void **state) {
    for (int32_t degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        td_gaussians g = scene_random(70 + (uint64_t)degree, 50, degree, SCENE_TRAINED);
        tides_scene *a = scene_new(), *b = scene_new(), *c = scene_new();
        const char *first = scene_in_folder(*state, "first.ply"), *middle = scene_in_folder(*state, "middle.h5"),
                   *last = scene_in_folder(*state, "last.ply");
        scene_add(a, &g, NULL, 1, NULL);
        scene_save(a, first);
        scene_load(b, first, NULL, 1);
        scene_save(b, middle);
        scene_load(c, middle, NULL, 1);
        assert_string_equal(scene_object_of(c, 0).source, first);
        assert_string_equal(scene_object_of(c, 0).name, "first");
        scene_save(c, last);
        size_t size, size_again;
        char *bytes = scene_file_read(first, &size), *again = scene_file_read(last, &size_again);
        assert_int_equal(size, size_again);
        assert_memory_equal(bytes, again, size);
        free(bytes);
        free(again);
        td_gaussians_free(&g);
        tides_scene_destroy(a);
        tides_scene_destroy(b);
        tides_scene_destroy(c);
    }
}

/* The same scene makes the same bytes; the format is found from the content, whatever the name. */
static void test_deterministic(void **state) {
    td_gaussians g = scene_random(80, 20, 1, SCENE_TRAINED);
    tides_scene *scene = scene_new();
    tides_trajectory *path = scene_path(1);
    scene_add(scene, &g, path, 1, "fan");
    const char *a = scene_in_folder(*state, "a.h5"), *b = scene_in_folder(*state, "b.h5");
    scene_save(scene, a);
    scene_save(scene, b);
    size_t size, size_again;
    char *bytes = scene_file_read(a, &size), *again = scene_file_read(b, &size_again);
    assert_int_equal(size, size_again);
    assert_memory_equal(bytes, again, size);
    free(bytes);
    free(again);
    const char *misnamed = scene_in_folder(*state, "really_hdf5.ply");
    assert_int_equal(rename(a, misnamed), 0);
    scene_load(scene, misnamed, NULL, 1);
    assert_int_equal(tides_scene_objects(scene), 2);
    tides_trajectory_destroy(path);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

static void test_placement(void **state) {
    tides_error error = {0, ""};
    td_gaussians g = scene_random(81, 3, 0, SCENE_TRAINED);
    tides_trajectory *path = scene_path(0);
    tides_scene *rest = scene_new(), *moving = scene_new(), *scene = scene_new();
    const char *at_rest = scene_in_folder(*state, "rest.h5"), *in_motion = scene_in_folder(*state, "moving.h5");
    scene_add(rest, &g, NULL, 2, "a");
    scene_add(rest, &g, NULL, 3, "b");
    scene_save(rest, at_rest);
    scene_load(scene, at_rest, path, 10);
    assert_true(scene_object_of(scene, 0).scale == 20);
    assert_true(scene_object_of(scene, 1).scale == 30);
    expect_same_path(scene_object_of(scene, 1).trajectory, path);
    scene_add(moving, &g, NULL, 2, "a");
    scene_add(moving, &g, path, 3, "b");
    scene_save(moving, in_motion);
    scene_expect_error(tides_scene_add_file(scene, in_motion, path, 1, &error), TIDES_UNSUPPORTED, &error,
                       "moving.h5|/objects/1|trajectory of its own");
    scene_expect_error(tides_scene_add_file(scene, in_motion, NULL, 2, &error), TIDES_UNSUPPORTED, &error, "/objects/1");
    scene_expect_error(tides_scene_add_file(scene, at_rest, NULL, -2, &error), TIDES_BAD_ARGUMENT, &error,
                       "rest.h5|scale is -2");
    scene_expect_error(tides_scene_add_file(scene, at_rest, NULL, 0, &error), TIDES_BAD_ARGUMENT, &error, "scale is 0");
    assert_int_equal(tides_scene_objects(scene), 2); /* all of a file's objects, or none */
    tides_trajectory_destroy(path);
    td_gaussians_free(&g);
    tides_scene_destroy(rest);
    tides_scene_destroy(moving);
    tides_scene_destroy(scene);
}

/* HDF5's own printing of errors is the program's affair: silent during a call of ours, and as it was afterwards. */
static herr_t count_prints(hid_t stack, void *user) {
    (void)stack;
    ++*(int *)user;
    return 0;
}

static void test_error_printing(void **state) {
    int prints = 0;
    H5E_auto2_t before = NULL;
    void *before_data = NULL;
    H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
    H5Eset_auto2(H5E_DEFAULT, count_prints, &prints);
    const char *path = scene_in_folder(*state, "s.h5");
    td_gaussians g;
    scene_save_pair(path, &g);
    scene_file_write(path, "\x89HDF\r\n\x1a\n rubbish", 16);
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    assert_int_equal(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE);
    assert_int_equal(prints, 0);
    assert_true(H5Gopen2(-1, "none", H5P_DEFAULT) < 0);
    assert_int_equal(prints, 1);
    H5Eset_auto2(H5E_DEFAULT, before, before_data);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_round_trip), IN_FOLDER(test_ply_hdf5_ply),   IN_FOLDER(test_deterministic),
        IN_FOLDER(test_placement),  IN_FOLDER(test_error_printing),
    };
    return cmocka_run_group_tests_name("scene_hdf5", tests, NULL, NULL);
}
