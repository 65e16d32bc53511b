/* Opening what a run names: scene, objects, camera path, and how the run file's intrinsics and the path's go together. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tides/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char one_splat[] = "ply\nformat ascii 1.0\nelement vertex 1\n"
                                "property float x\nproperty float y\nproperty float z\n"
                                "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
                                "property float scale_0\nproperty float scale_1\nproperty float scale_2\n"
                                "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
                                "end_header\n0 0 4 1 1 1 2 -1 -1 -1 1 0 0 0\n";
static const char plain_path[] = "10.0 0 0 0 0 0 0 1\n11.0 0.1 0 0 0 0 0 1\n12.0 0.2 0 0 0 0 0 1\n";
static const char sized_path[] = "{\"format\": \"tides-path\", \"version\": 1, \"intrinsics\": {\"width\": 80, \"height\": 60,"
                                 "\"fx\": 50, \"fy\": 55, \"cx\": 41, \"cy\": 31}, \"samples\": ["
                                 "{\"t\": 0, \"position\": [0, 0, 0], \"quaternion\": [1, 0, 0, 0]},"
                                 "{\"t\": 2, \"position\": [1, 0, 0], \"quaternion\": [1, 0, 0, 0]}]}";
static const char angle_path[] = "{\"camera_angle_x\": 1.5707963267948966, \"frames\": ["
                                 "{\"time\": 0.0, \"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},"
                                 "{\"time\": 1.0, \"transform_matrix\": [[1,0,0,1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]}";

static void write_files(void *folder) {
    scene_file_write(scene_in_folder(folder, "one.ply"), one_splat, sizeof one_splat - 1);
    scene_file_write(scene_in_folder(folder, "plain.txt"), plain_path, sizeof plain_path - 1);
    scene_file_write(scene_in_folder(folder, "sized.json"), sized_path, sizeof sized_path - 1);
    scene_file_write(scene_in_folder(folder, "angle.json"), angle_path, sizeof angle_path - 1);
}

typedef struct opened {
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
} opened;

/* Parses with `sets` (ended by NULL) and opens. */
static tides_status open_run(void *folder, const char *const *sets, opened *o, tides_error *error) {
    static const char text[] = "{\"scene\": {\"file\": \"one.ply\"}, \"camera\": {\"file\": \"sized.json\"}}";
    size_t count = 0;
    while (sets[count]) count++;
    tides_run *run = NULL;
    tides_status status = tides_run_parse(text, folder, sets, count, &run, error);
    if (status != TIDES_OK) return status;
    memset(o, 0, sizeof *o);
    status = tides_run_open(run, &o->scene, &o->camera, &o->intrinsics, error);
    tides_run_destroy(run);
    if (status != TIDES_OK) { /* outputs untouched */
        assert_null(o->scene);
        assert_null(o->camera);
        assert_int_equal(o->intrinsics.width, 0);
    }
    return status;
}

static void close_run(opened *o) {
    tides_trajectory_destroy(o->camera);
    tides_scene_destroy(o->scene);
}

#define SETS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void fails(void *folder, const char *const *sets, tides_status wanted, const char *words) {
    tides_error error = {0, ""};
    opened o;
    tides_status status = open_run(folder, sets, &o, &error);
    scene_expect_error(status, wanted, &error, words);
}

static void intrinsics_are(void *folder, const char *const *sets, tides_intrinsics wanted) {
    tides_error error = {0, ""};
    opened o;
    scene_expect_ok(open_run(folder, sets, &o, &error), &error);
    assert_int_equal(o.intrinsics.width, wanted.width);
    assert_int_equal(o.intrinsics.height, wanted.height);
    const double got[4] = {o.intrinsics.fx, o.intrinsics.fy, o.intrinsics.cx, o.intrinsics.cy};
    const double want[4] = {wanted.fx, wanted.fy, wanted.cx, wanted.cy};
    for (int i = 0; i < 4; i++)
        if (fabs(got[i] - want[i]) > 1e-9) fail_msg("intrinsic %d is %.17g, not %.17g", i, got[i], want[i]);
    close_run(&o);
}

/* A path of two poses whose camera is of a model, with k1. */
static void write_bent(void *folder, const char *model) {
    char text[600];
    int bytes = snprintf(text, sizeof text, "{\"camera_model\": \"%s\", \"k1\": 0.25, \"w\": 80, \"h\": 60, \"fl_x\": 50, %s",
                         model, angle_path + strlen("{\"camera_angle_x\": 1.5707963267948966, "));
    scene_file_write(scene_in_folder(folder, "bent.json"), text, (size_t)bytes);
}

static void a_lens_is_the_runs(void **state) {
    tides_error error = {0, ""};
    opened o;
    write_files(*state);
    scene_expect_ok(open_run(*state, SETS("camera.lens=radtan", "camera.k1=-0.1", "camera.p2=0.002"), &o, &error), &error);
    const tides_lens *lens = &o.intrinsics.lens;
    assert_int_equal(lens->model, TIDES_LENS_RADTAN);
    assert_true(lens->k1 == -0.1 && lens->k2 == 0 && lens->p2 == 0.002);
    close_run(&o);
    fails(*state, SETS("camera.k2=0.1"), TIDES_BAD_CONFIG, "camera.k2|without camera.lens");
    write_bent(*state, "OPENCV_FISHEYE");
    scene_expect_ok(open_run(*state, SETS("camera.file=bent.json"), &o, &error), &error);
    assert_int_equal(o.intrinsics.lens.model, TIDES_LENS_EQUIDISTANT);
    assert_true(o.intrinsics.lens.k1 == 0.25);
    close_run(&o);
    scene_expect_ok(open_run(*state, SETS("camera.file=bent.json", "camera.lens=none"), &o, &error), &error);
    assert_int_equal(o.intrinsics.lens.model, TIDES_LENS_NONE);
    close_run(&o);
    write_bent(*state, "FISHEYE624");
    fails(*state, SETS("camera.file=bent.json"), TIDES_BAD_CONFIG, "bent.json|camera.lens|none|radtan");
    scene_expect_ok(open_run(*state, SETS("camera.file=bent.json", "camera.lens=none"), &o, &error), &error);
    close_run(&o);
}

static void the_path_gives_what_the_run_does_not(void **state) {
    write_files(*state);
    intrinsics_are(*state, SETS(NULL), (tides_intrinsics){80, 60, 50, 55, 41, 31, {0}});
    intrinsics_are(*state, SETS("camera.fx=70"), (tides_intrinsics){80, 60, 70, 55, 41, 31, {0}});
    intrinsics_are(*state, SETS("camera.cx=0", "camera.cy=-2"), (tides_intrinsics){80, 60, 50, 55, 0, -2, {0}});
    /* Another size: the file's lens doesn't apply. */
    intrinsics_are(*state, SETS("camera.width=40", "camera.fx=9"), (tides_intrinsics){40, 60, 9, 9, 20, 30, {0}});
    fails(*state, SETS("camera.width=40", "camera.height=60"), TIDES_BAD_CONFIG, "camera.fx|80x60|40x60|camera.scale");
}

/* The same view in other pixels: camera.scale, and one side alone. */
static void views_scale(void **state) {
    write_files(*state);
    intrinsics_are(*state, SETS("camera.width=40"), (tides_intrinsics){40, 30, 25, 27.5, 20.5, 15.5, {0}});
    intrinsics_are(*state, SETS("camera.height=120"), (tides_intrinsics){160, 120, 100, 110, 82, 62, {0}});
    intrinsics_are(*state, SETS("camera.width=40", "camera.cx=3"), (tides_intrinsics){40, 30, 25, 27.5, 3, 15.5, {0}});
    intrinsics_are(*state, SETS("camera.scale=0.5"), (tides_intrinsics){40, 30, 25, 27.5, 20.5, 15.5, {0}});
    intrinsics_are(*state, SETS("camera.scale=2", "camera.width=40"), (tides_intrinsics){80, 60, 50, 55, 41, 31, {0}});
    intrinsics_are(*state, SETS("camera.scale=0.11"),
                   (tides_intrinsics){9, 7, 50 * 9 / 80., 55 * 7 / 60., 41 * 9 / 80., 31 * 7 / 60., {0}});
    fails(*state, SETS("camera.scale=900"), TIDES_BAD_CONFIG, "camera.scale = 900|72000x54000");
}

/* A splat file in place of a run file, and camera.orbit_s: the scene is in the middle, and a longer run sees the same. */
static void a_scene_alone_has_an_orbit(void **state) {
    write_files(*state);
    tides_error error = {0, ""};
    tides_run *run = NULL;
    tides_run_values values;
    opened o;
    scene_expect_ok(tides_run_load(scene_in_folder(*state, "one.ply"), NULL, 0, &run, &error), &error);
    tides_run_get(run, &values);
    assert_null(values.camera_file);
    assert_true(values.stop == 0.1);
    assert_non_null(strstr(tides_run_notes(run), "a scene without a run file"));
    scene_expect_ok(tides_run_open(run, &o.scene, &o.camera, &o.intrinsics, &error), &error);
    assert_int_equal(o.intrinsics.width, 640);
    assert_int_equal(o.intrinsics.height, 480);
    assert_true(fabs(o.intrinsics.fx - 320 / tan(0.5235987755982988)) < 1e-9 && o.intrinsics.fy == o.intrinsics.fx);
    tides_pose pose, later;
    scene_expect_ok(tides_trajectory_at(o.camera, 0.05, &pose, &error), &error);
    const double way[3] = {-pose.position[0], -pose.position[1], 4 - pose.position[2]}; /* the splat is at 0 0 4 */
    const double distance = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    assert_true(pose.position[1] < -0.1); /* above, where y is down */
    for (int i = 0; i < 3; i++) assert_true(fabs(pose.rotation[3 * i + 2] - way[i] / distance) < 1e-6);
    close_run(&o);
    tides_run_destroy(run);
    const char *const sets[] = {"time.stop=7", "camera.width=320", "camera.up=[0,-2,0]"};
    scene_expect_ok(tides_run_load(scene_in_folder(*state, "one.ply"), sets, 3, &run, &error), &error);
    scene_expect_ok(tides_run_open(run, &o.scene, &o.camera, &o.intrinsics, &error), &error);
    assert_int_equal(o.intrinsics.height, 240);
    scene_expect_ok(tides_trajectory_at(o.camera, 0.05, &later, &error), &error);
    assert_memory_equal(&pose, &later, sizeof pose);
    close_run(&o);
    tides_run_destroy(run);
    fails(*state, SETS("camera.orbit_s=3"), TIDES_BAD_CONFIG, "camera.file and camera.orbit_s are both given");
}

static void an_angle_of_view_holds_at_any_size(void **state) {
    write_files(*state);
    const char *const sets[] = {"camera.file=angle.json", "camera.width=100", "camera.height=50", NULL};
    intrinsics_are(*state, sets, (tides_intrinsics){100, 50, 50, 50, 50, 25, {0}});
}

static void missing_intrinsics_are_named(void **state) {
    write_files(*state);
    const char *const file = "camera.file=plain.txt", *const rebase = "camera.rebase=true";
    fails(*state, SETS(file, rebase), TIDES_BAD_CONFIG, "camera.width is missing|plain.txt");
    fails(*state, SETS(file, rebase, "camera.width=8"), TIDES_BAD_CONFIG, "camera.height is missing");
    fails(*state, SETS(file, rebase, "camera.width=8", "camera.height=6"), TIDES_BAD_CONFIG, "camera.fx is missing");
    intrinsics_are(*state, SETS(file, rebase, "camera.width=8", "camera.height=6", "camera.fx=5"),
                   (tides_intrinsics){8, 6, 5, 5, 4, 3, {0}});
}

static void paths_must_cover_the_run(void **state) {
    write_files(*state);
    fails(*state, SETS("time.stop=2.5"), TIDES_OUT_OF_RANGE, "camera.file|sized.json|[0, 2] s|[0, 2.5] s");
    fails(*state, SETS("camera.file=plain.txt", "camera.width=8", "camera.height=6", "camera.fx=5"), TIDES_OUT_OF_RANGE,
          "camera.file|[10, 12] s|[0, 1] s|camera.start_s");
    const char *const start[] = {"camera.file=plain.txt", "camera.start_s=10.5", "camera.width=8",
                                 "camera.height=6",       "camera.fx=5",         NULL};
    intrinsics_are(*state, start, (tides_intrinsics){8, 6, 5, 5, 4, 3, {0}});
    fails(*state, SETS("scene.objects=[{\"file\": \"one.ply\"}, {\"file\": \"one.ply\", \"trajectory\": \"plain.txt\"}]"),
          TIDES_OUT_OF_RANGE, "scene.objects[1].trajectory|plain.txt|[10, 12] s");
}

static void objects_move_and_scale(void **state) {
    write_files(*state);
    tides_error error = {0, ""};
    opened o;
    const char *const sets[] = {"scene.file=null",
                                "scene.objects=[{\"file\": \"one.ply\", \"trajectory\": \"sized.json\", \"scale\": 2.5},"
                                "{\"file\": \"one.ply\", \"trajectory\": null}]",
                                NULL};
    scene_expect_ok(open_run(*state, sets, &o, &error), &error);
    assert_int_equal(tides_scene_objects(o.scene), 2);
    tides_object object;
    scene_expect_ok(tides_scene_object(o.scene, 0, &object, &error), &error);
    assert_non_null(object.trajectory);
    assert_true(object.scale == 2.5);
    scene_expect_ok(tides_scene_object(o.scene, 1, &object, &error), &error);
    assert_null(object.trajectory);
    close_run(&o);
}

/* An .h5 scene whose object moves for a shorter time than the run. */
static void motion_inside_a_scene_file_must_cover_too(void **state) {
    write_files(*state);
    tides_error error = {0, ""};
    tides_path_options options;
    tides_path_options_defaults(&options);
    tides_path path;
    tides_scene *scene = NULL;
    scene_expect_ok(tides_path_load(scene_in_folder(*state, "sized.json"), &options, &path, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, scene_in_folder(*state, "one.ply"), path.trajectory, 1.0, &error), &error);
    scene_expect_ok(tides_scene_save(scene, scene_in_folder(*state, "moving.h5"), &error), &error);
    tides_scene_destroy(scene);
    tides_trajectory_destroy(path.trajectory);

    opened o;
    const char *const fine[] = {"scene.file=moving.h5", NULL};
    scene_expect_ok(open_run(*state, fine, &o, &error), &error);
    close_run(&o);
    scene_file_write(scene_in_folder(*state, "long.txt"), "0 0 0 0 0 0 0 1\n9 1 0 0 0 0 0 1\n", 32);
    const char *const late[] = {"scene.file=moving.h5",
                                "camera.file=long.txt",
                                "camera.width=8",
                                "camera.height=6",
                                "camera.fx=5",
                                "time.stop=3",
                                NULL};
    fails(*state, late, TIDES_OUT_OF_RANGE, "scene.file|moving.h5|[0, 2] s|[0, 3] s");
}

static void missing_files_are_named(void **state) {
    write_files(*state);
    fails(*state, SETS("scene.file=none.ply"), TIDES_FILE_NOT_FOUND, "none.ply");
    fails(*state, SETS("camera.file=none.json"), TIDES_FILE_NOT_FOUND, "none.json");
    fails(*state, SETS("scene.objects=[{\"file\": \"none.ply\"}]"), TIDES_FILE_NOT_FOUND, "none.ply");
    fails(*state, SETS("scene.objects=[{\"file\": \"one.ply\", \"trajectory\": \"none.txt\"}]"), TIDES_FILE_NOT_FOUND,
          "none.txt");
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_FOLDER(a_lens_is_the_runs),
        IN_FOLDER(the_path_gives_what_the_run_does_not),
        IN_FOLDER(views_scale),
        IN_FOLDER(a_scene_alone_has_an_orbit),
        IN_FOLDER(an_angle_of_view_holds_at_any_size),
        IN_FOLDER(missing_intrinsics_are_named),
        IN_FOLDER(paths_must_cover_the_run),
        IN_FOLDER(objects_move_and_scale),
        IN_FOLDER(motion_inside_a_scene_file_must_cover_too),
        IN_FOLDER(missing_files_are_named),
    };
    return cmocka_run_group_tests_name("run_open", tests, NULL, NULL);
}
