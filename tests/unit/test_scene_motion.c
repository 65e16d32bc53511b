/* Motions in scenes and in TIDES's scene files: what is written is read back, files without motion stay readable by older
 * versions, and every way of being wrong has its message. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "motion/td_motion.h"
#include "tests/support/moving_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <hdf5.h>

/* A scene of an object at rest and one that moves, on a path of its own. */
static tides_scene *make_sample(td_gaussians *g) {
    tides_error error;
    *g = scene_random(91, 40, 1, SCENE_SMALL_INTEGERS);
    tides_scene *scene = scene_new();
    tides_trajectory *path = scene_path(1);
    tides_gaussians view = td_gaussians_view(g);
    scene_add(scene, g, NULL, 1, "rests");
    scene_expect_ok(tides_scene_add_moving(scene, &view, polynomial_motion_make(3, 40, 0.5), 2.5, path, 1.5, "moves", NULL,
                                           &error),
                    &error);
    tides_trajectory_destroy(path);
    return scene;
}

static int version_of(const char *path) {
    int version = -1;
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), attribute = H5Aopen(file, "version", H5P_DEFAULT);
    assert_true(H5Aread(attribute, H5T_NATIVE_INT, &version) >= 0);
    H5Aclose(attribute);
    H5Fclose(file);
    return version;
}

static void test_there_and_back(void **state) {
    const char *path = scene_in_folder(*state, "moves.h5"), *still = scene_in_folder(*state, "rests.h5");
    td_gaussians g;
    tides_scene *scene = make_sample(&g), *read = scene_new(), *resting = scene_new();
    scene_save(scene, path);
    scene_load(read, path, NULL, 1);
    tides_object before = scene_object_of(scene, 1), after = scene_object_of(read, 1);
    assert_null(scene_object_of(read, 0).motion);
    assert_true(scene_same(&g, &after.gaussians));
    assert_non_null(after.trajectory);
    assert_true(after.duration_s == 2.5);
    assert_true(after.scale == 1.5);
    const tides_motion *a = before.motion, *b = after.motion;
    assert_string_equal(tides_motion_model(b), "polynomial");
    assert_true(a->start == b->start);
    assert_true(a->stop == b->stop);
    assert_true(a->fields == b->fields);
    assert_true(a->settings == b->settings);
    for (int i = 0; i < a->settings; i++) assert_true(td_motion_setting(b, a->setting[i].name, -77) == a->setting[i].value);
    for (int i = 0; i < a->fields; i++) {
        const td_field *x = &a->field[i], *y = td_motion_field(b, x->name);
        size_t count = 1;
        assert_true(y);
        assert_true(x->rank == y->rank);
        for (int k = 0; k < x->rank; k++) {
            assert_true(x->shape[k] == y->shape[k]);
            count *= (size_t)x->shape[k];
        }
        assert_memory_equal(x->value, y->value, count * sizeof *x->value);
    }
    assert_int_equal(version_of(path), 2);
    scene_add(resting, &g, NULL, 1, "rests");
    scene_save(resting, still);
    assert_int_equal(version_of(still), 1);
    tides_scene_destroy(scene);
    tides_scene_destroy(read);
    tides_scene_destroy(resting);
    td_gaussians_free(&g);
}

/* Bounds are those of the Gaussians without their motion. */
static void test_bounds(void **state) {
    (void)state;
    td_gaussians g;
    tides_scene *scene = make_sample(&g), *still = scene_new();
    tides_trajectory *path = scene_path(1);
    double box[2][3], expected[2][3];
    scene_add(still, &g, NULL, 1, "rests");
    scene_add(still, &g, path, 1.5, "moves");
    tides_scene_bounds(scene, box[0], box[1]);
    tides_scene_bounds(still, expected[0], expected[1]);
    assert_memory_equal(box, expected, sizeof box);
    for (int k = 0; k < 3; k++) assert_true(box[0][k] < box[1][k]);
    tides_trajectory_destroy(path);
    tides_scene_destroy(still);
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

static void test_durations(void **state) {
    (void)state;
    td_gaussians g;
    tides_scene *scene = make_sample(&g);
    tides_gaussians view = td_gaussians_view(&g);
    tides_motion *motion = bent_motion_make(1, 1);
    tides_error error;
    scene_expect_error(tides_scene_add_moving(scene, &view, motion, -1, NULL, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT,
                       &error, "object 2|duration_s|-1");
    assert_int_equal(tides_scene_objects(scene), 2);
    scene_expect_ok(tides_scene_add_moving(scene, &view, motion, 0, NULL, 1, NULL, NULL, &error), &error);
    assert_true(scene_object_of(scene, 2).duration_s == 3); /* its own time is [2, 5] */
    assert_true(scene_object_of(scene, 0).duration_s == 0);
    assert_int_equal(tides_scene_set_duration(scene, 0.25), 2);
    assert_true(scene_object_of(scene, 1).duration_s == 0.25);
    assert_true(scene_object_of(scene, 2).duration_s == 0.25);
    assert_int_equal(tides_motion_moving(scene_object_of(scene, 1).motion, &view), 30); /* every fourth rests */
    assert_int_equal(tides_motion_knots(scene_object_of(scene, 2).motion), 1);
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

static void test_refused(void **state) {
    td_gaussians g;
    tides_scene *scene = make_sample(&g);
    tides_gaussians view = td_gaussians_view(&g), fewer = view;
    tides_motion *motion = polynomial_motion_make(3, 40, 1);
    tides_error error;
    fewer.count = 39;
    scene_expect_error(tides_scene_add_moving(scene, &fewer, motion, 0, NULL, 1, NULL, NULL, &error), TIDES_BAD_FILE, &error,
                       "object 2|polynomial");
    tides_motion_destroy(motion);
    scene_expect_ok(tides_scene_add_moving(scene, &view, bent_motion_make(1, 1), 0, NULL, 1, NULL, NULL, &error), &error);
    scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, "c.h5"), &error), TIDES_UNSUPPORTED, &error,
                       "c.h5|/objects/2|callback");
    tides_scene_destroy(scene);
    scene = scene_new();
    motion = polynomial_motion_make(3, 40, 1);
    scene_expect_ok(tides_scene_add_moving(scene, &view, motion, 0, NULL, 1, "m", NULL, &error), &error);
    scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, "m.ply"), &error), TIDES_UNSUPPORTED, &error,
                       "m.ply|motion of 'm'|.h5");
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

/* -- edited files ---------------------------------------------------------------------------------------------------- */

static void set_double(hid_t file, const char *group, const char *name, double value) {
    hid_t at = H5Gopen2(file, group, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    if (H5Aexists(at, name) > 0) assert_true(H5Adelete(at, name) >= 0);
    hid_t attribute = H5Acreate2(at, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Gclose(at);
}

static void set_text(hid_t file, const char *group, const char *name, const char *text) {
    hid_t at = H5Gopen2(file, group, H5P_DEFAULT), space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    assert_true(H5Adelete(at, name) >= 0);
    hid_t attribute = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, text) >= 0);
    H5Aclose(attribute);
    H5Tclose(type);
    H5Sclose(space);
    H5Gclose(at);
}

/* A dataset that claims 10^12 numbers and stores none. */
static void claim_much(hid_t file, const char *name) {
    const hsize_t shape[2] = {1000000000, 1000}, chunk[2] = {1, 1000};
    hid_t space = H5Screate_simple(2, shape, NULL), properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 2, chunk);
    hid_t set = H5Dcreate2(file, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    assert_true(set >= 0);
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
}

#define MOTION "/objects/1/motion"

static void edit_model(hid_t file) { set_text(file, MOTION, "model", "wavelets"); }
static void edit_callback(hid_t file) { set_text(file, MOTION, "model", "callback"); }
static void edit_range(hid_t file) { set_double(file, MOTION, "stop", -1); }
static void edit_duration(hid_t file) { set_double(file, MOTION, "duration_s", 0); }
static void edit_fields(hid_t file) { assert_true(H5Ldelete(file, MOTION "/fields", H5P_DEFAULT) >= 0); }
static void edit_group(hid_t file) { H5Gclose(H5Gcreate2(file, MOTION "/fields/more", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }
static void edit_huge(hid_t file) { claim_much(file, MOTION "/fields/more"); }
static void edit_setting(hid_t file) {
    set_double(file, MOTION "/settings", "a name that is too long for any setting of a model", 1);
}
static void edit_array(hid_t file) {
    assert_true(H5Lmove(file, MOTION "/fields/mean_coefficient", file, MOTION "/fields/renamed", H5P_DEFAULT, H5P_DEFAULT) >=
                0);
}

static void test_edited_files(void **state) {
    static const struct {
        void (*edit)(hid_t file);
        tides_status status;
        const char *expected;
    } cases[] = {
        {edit_model, TIDES_UNSUPPORTED, "s.h5|" MOTION "|'wavelets'|update TIDES"},
        {edit_callback, TIDES_UNSUPPORTED, "s.h5|" MOTION "|'callback'"},
        {edit_range, TIDES_BAD_FILE, "s.h5|" MOTION "|[0, -1]"},
        {edit_duration, TIDES_BAD_FILE, "s.h5|duration_s of " MOTION},
        {edit_fields, TIDES_BAD_FILE, "s.h5|group fields is missing"},
        {edit_group, TIDES_BAD_FILE, "s.h5|more of " MOTION "/fields|dimensions"},
        {edit_huge, TIDES_BAD_FILE, "s.h5|more of " MOTION "/fields|more than the file holds"},
        {edit_setting, TIDES_BAD_FILE, "s.h5|name in " MOTION "/settings|longer than 31"},
        {edit_array, TIDES_BAD_FILE, "s.h5|/objects/1|mean_coefficient"},
    };
    const char *path = scene_in_folder(*state, "s.h5");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        td_gaussians g;
        tides_scene *scene = make_sample(&g), *read = scene_new();
        tides_error error;
        scene_save(scene, path);
        hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        cases[i].edit(file);
        H5Fclose(file);
        scene_expect_error(tides_scene_add_file(read, path, NULL, 1, &error), cases[i].status, &error, cases[i].expected);
        assert_int_equal(tides_scene_objects(read), 0);
        tides_scene_destroy(scene);
        tides_scene_destroy(read);
        td_gaussians_free(&g);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_there_and_back, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_durations),
        cmocka_unit_test_setup_teardown(test_refused, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_edited_files, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("motions in scenes", tests, NULL, NULL);
}
