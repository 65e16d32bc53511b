/* Path files: TUM, ESIM, cameras.json, transforms.json and TIDES' own, from texts of this test. Options, detection by content,
 * saving, generators, and real files. Other formats: test_path_datasets.c. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "tests/support/shared.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[512], file[600];

static int make_folder(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/tides-path-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(folder)) return -1;
    snprintf(file, sizeof file, "%s/path", folder); /* one name for all formats: only the content tells the format */
    return 0;
}

static int remove_folder(void **state) {
    (void)state;
    remove(file);
    return rmdir(folder);
}

static void write_text(const char *text) {
    FILE *out = fopen(file, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(text, 1, strlen(text), out), strlen(text));
    assert_int_equal(fclose(out), 0);
}

static tides_path load(const char *name, const tides_path_options *options) {
    tides_path path;
    tides_error error = {0, ""};
    if (tides_path_load(name, options, &path, &error) != TIDES_OK) fail_msg("%s", error.text);
    return path;
}

static tides_path load_text(const char *text, const tides_path_options *options) {
    write_text(text);
    return load(file, options);
}

static tides_pose_sample sample_of(const tides_path *path, size_t index) {
    tides_pose_sample sample;
    if (tides_trajectory_sample(path->trajectory, index, &sample, NULL) != TIDES_OK) fail_msg("no sample %zu", index);
    return sample;
}

static void assert_near(double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) fail_msg("got %.17g, expected %.17g, tolerance %g", got, expected, tolerance);
}

/* Time, position, and quaternion up to its sign. */
static void assert_sample(const tides_path *path, size_t index, double time, const double position[3], const double q[4]) {
    tides_pose_sample sample = sample_of(path, index);
    double dot = 0.0;
    assert_near(sample.time, time, 1e-15 * (1.0 + fabs(time)));
    for (int k = 0; k < 3; k++) assert_near(sample.position[k], position[k], 1e-15);
    for (int k = 0; k < 4; k++) dot += sample.quaternion[k] * q[k];
    assert_near(fabs(dot), 1.0, 1e-12);
}

static void assert_intrinsics(const tides_path *path, int width, int height, double fx, double fy, double cx, double cy) {
    const tides_intrinsics *i = &path->intrinsics;
    assert_int_equal(i->width, width);
    assert_int_equal(i->height, height);
    assert_near(i->fx, fx, 1e-10);
    assert_near(i->fy, fy, 1e-10);
    assert_near(i->cx, cx, 0.0);
    assert_near(i->cy, cy, 0.0);
}

static const double at_first[3] = {1, 2, 3}, at_second[3] = {4, 5, 6};
static const double none[4] = {1, 0, 0, 0},
                    about_x[4] = {0.8, 0.6, 0, 0}; /* about_x: half of an angle with cos 0.28, sin 0.96 */

static void tum(void **state) {
    (void)state;
    tides_path path = load_text("\xEF\xBB\xBF# comment\n\n0.5 1 2 3 0 0 0 1\r\n  1.25\t4 5 6e0 -0.6 0 0 -0.8 # end", NULL);
    assert_string_equal(path.format, "tum");
    assert_int_equal(tides_trajectory_count(path.trajectory), 2);
    assert_sample(&path, 0, 0.5, at_first, none);
    assert_sample(&path, 1, 1.25, at_second, about_x);
    assert_intrinsics(&path, 0, 0, 0, 0, 0, 0);
    tides_trajectory_destroy(path.trajectory);
}

static void esim(void **state) {
    (void)state;
    tides_path path =
        load_text("# timestamp, x, y, z, qx, qy, qz, qw\n500000000,1,2,3,0,0,0,1\n1250000000.0, 4,5 ,6,.6,0,0,.8\n", NULL);
    assert_string_equal(path.format, "esim");
    assert_sample(&path, 0, 0.5, at_first, none);
    assert_sample(&path, 1, 1.25, at_second, about_x);
    tides_trajectory_destroy(path.trajectory);
}

/* ROS stamps in nanoseconds: 1e18 ns has more digits than a double, but time differences must be right to the nanosecond. */
static void stamps_keep_their_nanoseconds(void **state) {
    (void)state;
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.rebase = 1;
    options.start = 77.0; /* ignored */
    tides_path path = load_text("1403636579758555392,1,2,3,0,0,0,1\n1403636579763555401,1,2,3,0,0,0,1\n", &options);
    assert_near(sample_of(&path, 0).time, 0.0, 0.0);
    assert_near(sample_of(&path, 1).time, 0.005000009, 2e-16);
    tides_trajectory_destroy(path.trajectory);
    options.rebase = 0;
    options.start = 1403636579.5;
    path = load_text("1403636579.758555392 1 2 3 0 0 0 1\n1403636580.0 1 2 3 0 0 0 1\n", &options);
    assert_near(sample_of(&path, 0).time, 0.258555392, 2e-16);
    assert_near(sample_of(&path, 1).time, 0.5, 0.0);
    tides_trajectory_destroy(path.trajectory);
    path = load_text("-2.3 1 2 3 0 0 0 1\n-1e-1 1 2 3 0 0 0 1\n3.3 1 2 3 0 0 0 1\n",
                     NULL); /* nothing is subtracted, so times are as written */
    assert_near(sample_of(&path, 0).time, -2.3, 0.0);
    assert_near(sample_of(&path, 1).time, -0.1, 0.0);
    assert_near(sample_of(&path, 2).time, 3.3, 0.0);
    tides_trajectory_destroy(path.trajectory);
    path = load_text("-2300000000.0,1,2,3,0,0,0,1\n3.3e9,1,2,3,0,0,0,1\n", NULL);
    assert_near(sample_of(&path, 0).time, -2.3, 0.0);
    assert_near(sample_of(&path, 1).time, 3.3, 0.0);
    tides_trajectory_destroy(path.trajectory);
}

static const char cameras_text[] = "[{\"id\": 0, \"img_name\": \"a\", \"width\": 640, \"height\": 480, \"position\": [1, 2, 3],"
                                   "  \"rotation\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"fy\": 510, \"fx\": 500},"
                                   " {\"id\": 1, \"width\": 640, \"height\": 480, \"position\": [1, 2, 3],"
                                   "  \"rotation\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"fy\": 510, \"fx\": 501},"
                                   " {\"id\": 2, \"width\": 640, \"height\": 480, \"position\": [4, 5, 6],"
                                   "  \"rotation\": [[1, 0, 0], [0, 0.28, -0.96], [0, 0.96, 0.28]], \"fy\": 510, \"fx\": 500}]";

static void cameras(void **state) {
    (void)state;
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.duration = 3.0;
    options.start = 1.0;
    tides_path path = load_text(cameras_text, &options);
    assert_string_equal(path.format, "cameras");
    assert_sample(&path, 0, -1.0, at_first, none);
    assert_sample(&path, 1, 0.5, at_first, none);
    assert_sample(&path, 2, 2.0, at_second, about_x);
    assert_intrinsics(&path, 640, 480, 0.0, 510, 320, 240); /* fx differs between frames */
    tides_trajectory_destroy(path.trajectory);
}

/* A camera in OpenGL axes looks along -z with y up: half a turn about x from a camera in OpenCV axes. */
#define FRAME_ONE "\"transform_matrix\": [[1,0,0,1],[0,-1,0,2],[0,0,-1,3],[0,0,0,1]]"
#define FRAME_TWO "\"transform_matrix\": [[1,0,0,4],[0,-0.28,0.96,5],[0,-0.96,-0.28,6]]"

static void transforms(void **state) {
    (void)state;
    tides_path path = load_text("{\"fl_x\": 500, \"w\": 640, \"h\": 480, \"k1\": 0.1, \"cy\": 241, \"frames\": ["
                                "{\"file_path\": \"b\", \"time\": 2.5, " FRAME_TWO "},"
                                "{\"file_path\": \"a\", \"time\": 0.5, " FRAME_ONE "}]}",
                                NULL);
    assert_string_equal(path.format, "transforms");
    assert_sample(&path, 0, 0.5, at_first, none); /* sorted by time; times are in seconds, because one is above 1 */
    assert_sample(&path, 1, 2.5, at_second, about_x);
    assert_intrinsics(&path, 640, 480, 500, 500, 320, 241);
    tides_trajectory_destroy(path.trajectory);
}

static void transforms_of_trainers(void **state) {
    (void)state;
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.duration = 10.0;
    tides_path path =
        load_text("{\"camera_angle_x\": 0.7, \"frames\": [{\"time\": 0.25, " FRAME_ONE "}, {\"time\": 1, " FRAME_TWO "}]}",
                  &options);
    assert_sample(&path, 0, 2.5, at_first, none); /* times in [0, 1] are scaled */
    assert_sample(&path, 1, 10.0, at_second, about_x);
    assert_intrinsics(&path, 0, 0, 0, 0, 0, 0);
    assert_near(path.field_of_view_x, 0.7, 0.0);
    tides_trajectory_destroy(path.trajectory);
    path = load_text("{\"frames\": [{\"w\": 800, \"h\": 600, \"camera_angle_x\": 0.7, " FRAME_ONE "},"
                     "{\"w\": 800, \"h\": 600, \"camera_angle_x\": 0.7, " FRAME_TWO "}]}",
                     &options);
    assert_sample(&path, 0, 0.0, at_first, none); /* without times: evenly spaced, in the order of the list */
    assert_sample(&path, 1, 10.0, at_second, about_x);
    assert_intrinsics(&path, 800, 600, 400 / tan(0.35), 400 / tan(0.35), 400, 300);
    tides_trajectory_destroy(path.trajectory);
    path = load_text("{\"frames\": [{" FRAME_ONE "}]}", NULL); /* a single frame is a camera at rest */
    assert_int_equal(tides_trajectory_is_static(path.trajectory), 1);
    tides_trajectory_destroy(path.trajectory);
}

static const char tides_text[] =
    "\n{\"format\": \"tides-path\", \"version\": 1,\n"
    "  \"intrinsics\": {\"width\": 346, \"height\": 260, \"fx\": 250.5, \"fy\": 251, \"cx\": 173, \"cy\": 130},\n"
    "  \"samples\": [{\"t\": 0.5, \"position\": [1, 2, 3], \"quaternion\": [2, 0, 0, 0],"
    "                 \"velocity\": [0.1, 0.2, 0.3], \"angular_velocity\": [1, 0, 0.1]},"
    "                {\"t\": 1.25, \"position\": [4, 5, 6], \"quaternion\": [0.8, 0.6, 0, 0],"
    "                 \"velocity\": [0.1, 0.2, 0.3], \"angular_velocity\": [1, 0, 0]}]}";

static void tides(void **state) {
    (void)state;
    tides_path path = load_text(tides_text, NULL);
    assert_string_equal(path.format, "tides");
    assert_sample(&path, 0, 0.5, at_first, none);
    assert_sample(&path, 1, 1.25, at_second, about_x);
    assert_intrinsics(&path, 346, 260, 250.5, 251, 173, 130);
    tides_pose_sample sample = sample_of(&path, 0);
    assert_int_equal(sample.has_rates, 1);
    assert_near(sample.velocity[1], 0.2, 0.0);
    assert_near(sample.angular_velocity[2], 0.1, 0.0);
    tides_trajectory_destroy(path.trajectory);
}

static void assert_same_poses(const tides_trajectory *a, const tides_trajectory *b, double shift) {
    double start, stop;
    tides_trajectory_range(a, &start, &stop);
    for (int i = 0; i <= 50; i++) {
        double time = start + (stop - start) * i / 50.0;
        tides_pose pose_a, pose_b;
        assert_int_equal(tides_trajectory_at(a, time, &pose_a, NULL), TIDES_OK);
        assert_int_equal(tides_trajectory_at(b, time - shift, &pose_b, NULL), TIDES_OK);
        for (int k = 0; k < 9; k++) assert_near(pose_a.rotation[k], pose_b.rotation[k], 1e-14);
        for (int k = 0; k < 3; k++) assert_near(pose_a.position_dot[k], pose_b.position_dot[k], 1e-12);
    }
}

/* A saved path loads with the same bits, also if the program's locale has a decimal comma. A save that fails leaves no .part
 * file. */
static void save_and_load(void **state) {
    (void)state;
    tides_path path = load_text(tides_text, NULL), again;
    for (int round = 0; round < 2; round++) {
        if (round == 1 && !setlocale(LC_NUMERIC, "de_DE.UTF-8")) {
            print_message("    no locale with a decimal comma here\n");
            break;
        }
        assert_int_equal(tides_path_save(file, path.trajectory, &path.intrinsics, NULL), TIDES_OK);
        again = load(file, NULL);
        assert_memory_equal(&again.intrinsics, &path.intrinsics, sizeof path.intrinsics);
        for (size_t i = 0; i < 2; i++) {
            tides_pose_sample a = sample_of(&path, i), b = sample_of(&again, i);
            assert_memory_equal(&a, &b, sizeof a);
        }
        tides_trajectory_destroy(again.trajectory);
    }
    setlocale(LC_NUMERIC, "C");
    assert_int_equal(tides_path_save(file, path.trajectory, NULL, NULL), TIDES_OK);
    again = load(file, NULL);
    assert_intrinsics(&again, 0, 0, 0, 0, 0, 0);
    tides_trajectory_destroy(again.trajectory);
    tides_intrinsics bent = path.intrinsics;
    bent.lens = (tides_lens){TIDES_LENS_EQUIDISTANT, 0, 0.1, -0.2, 1.0 / 3, 1e-30, 0, 0};
    assert_int_equal(tides_path_save(file, path.trajectory, &bent, NULL), TIDES_OK);
    again = load(file, NULL);
    assert_memory_equal(&again.intrinsics, &bent, sizeof bent);
    tides_trajectory_destroy(again.trajectory);
    char part[700];
    snprintf(part, sizeof part, "%s.part", file);
    assert_int_not_equal(access(part, F_OK), 0);

    tides_error error = {0, ""};
    tides_intrinsics flat = path.intrinsics;
    flat.fx = 0.0;
    assert_int_equal(tides_path_save(file, path.trajectory, &flat, &error), TIDES_BAD_ARGUMENT);
    bent.lens.model = 3;
    assert_int_equal(tides_path_save(file, path.trajectory, &bent, &error), TIDES_BAD_ARGUMENT);
    snprintf(part, sizeof part, "%s/nowhere/path", folder);
    assert_int_equal(tides_path_save(part, path.trajectory, NULL, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "nowhere/path"));
    assert_int_equal(tides_path_save(folder, path.trajectory, NULL, &error), TIDES_WRITE_FAILED);
    snprintf(part, sizeof part, "%s.part", folder);
    assert_int_not_equal(access(part, F_OK), 0);
    assert_int_equal(tides_path_save(NULL, path.trajectory, NULL, &error), TIDES_BAD_ARGUMENT);
    tides_trajectory_destroy(path.trajectory);
}

/* An orbit, dolly or handheld path in a file equals the path of its tides_trajectory_create_ function. With `rebase` its time
 * starts at 0. */
static void generators(void **state) {
    (void)state;
    const tides_orbit orbit =
        {.target = {1, 2, 3}, .up = {0, -1, 0}, .radius = 2, .height = 0.5, .angular_speed = 3, .start = 4, .stop = 5};
    const tides_dolly dolly = {.from = {-1, -1, 0}, .to = {1, -1, 0}, .up = {0, 0, 1}, .stop = 1};
    const tides_handheld hand = {.position = {0, -3, 1},
                                 .up = {0, 0, 1},
                                 .position_amplitude = 0.02,
                                 .rotation_amplitude = 0.03,
                                 .frequency = 1.5,
                                 .seed = UINT64_C(18446744073709551615),
                                 .stop = 1};
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.rebase = 1;
    tides_trajectory *expected = NULL;
    tides_path path =
        load_text("{\"format\": \"tides-path\", \"version\": 1, \"orbit\": {\"target\": [1, 2, 3], \"up\": [0, -1, 0],"
                  "\"radius\": 2, \"height\": 0.5, \"angular_speed\": 3, \"start\": 4, \"stop\": 5}}",
                  &options);
    assert_int_equal(tides_trajectory_create_orbit(&orbit, &expected, NULL), TIDES_OK);
    assert_same_poses(expected, path.trajectory, 4.0);
    tides_trajectory_destroy(expected);
    tides_trajectory_destroy(path.trajectory);
    path = load_text("{\"format\": \"tides-path\", \"version\": 1, \"intrinsics\": {\"width\": 8, \"height\": 6, \"fx\": 9, "
                     "\"fy\": 9,"
                     "\"cx\": 4, \"cy\": 3}, \"dolly\": {\"from\": [-1, -1, 0], \"to\": [1, -1, 0], \"target\": [0, 0, 0],"
                     "\"up\": [0, 0, 1], \"stop\": 1}}",
                     NULL);
    assert_intrinsics(&path, 8, 6, 9, 9, 4, 3);
    assert_int_equal(tides_trajectory_create_dolly(&dolly, &expected, NULL), TIDES_OK);
    assert_same_poses(expected, path.trajectory, 0.0);
    tides_trajectory_destroy(expected);
    tides_trajectory_destroy(path.trajectory);
    path =
        load_text("{\"format\": \"tides-path\", \"version\": 1, \"handheld\": {\"position\": [0, -3, 1], \"target\": [0, 0, 0],"
                  "\"up\": [0, 0, 1], \"position_amplitude\": 0.02, \"rotation_amplitude\": 0.03, \"frequency\": 1.5,"
                  "\"seed\": \"18446744073709551615\", \"stop\": 1}}",
                  NULL);
    assert_int_equal(tides_trajectory_create_handheld(&hand, &expected, NULL), TIDES_OK);
    assert_same_poses(expected, path.trajectory, 0.0);
    tides_trajectory_destroy(expected);
    tides_trajectory_destroy(path.trajectory);
}

/* Real files: everything in data/traj, and a trained scene's cameras.json. */
static int load_real(void *loaded, const char *name, const char *base) {
    tides_path path = load(name, NULL);
    double start, stop;
    tides_trajectory_range(path.trajectory, &start, &stop);
    double fastest = 0.0, steps = (double)tides_trajectory_count(path.trajectory) - 1.0;
    for (int i = 0; i <= 10000; i++) {
        tides_pose pose;
        assert_int_equal(tides_trajectory_at(path.trajectory, start + (stop - start) * (i / 10000.0), &pose, NULL), TIDES_OK);
        for (int k = 0; k < 9; k++) fastest = fmax(fastest, fabs(pose.rotation_dot[k]) * (stop - start) / steps);
        for (int k = 0; k < 3; k++) fastest = fmax(fastest, fabs(pose.position_dot[k]) * (stop - start) / steps);
    }
    print_message("    %s: %s, %.0f poses, %.9g to %.9g s, up to %.3g per sample\n", base, path.format, steps + 1.0, start,
                  stop, fastest);
    assert_true(fastest < 10.0); /* per sample: a wrong order of poses or axes would swing wildly */
    tides_trajectory_destroy(path.trajectory);
    ++*(int *)loaded;
    return 0;
}

static void real_paths(void **state) {
    (void)state;
    char name[1024];
    int loaded = 0;
    if (shared_path(name, sizeof name, "data/traj") != 0) skip();
    shared_scan(name, "", load_real, &loaded);
    assert_true(loaded > 0);
}

static void real_cameras(void **state) {
    (void)state;
    char name[1024];
    int loaded = 0;
    if (shared_path(name, sizeof name, "data/snowmiku/cameras.json") != 0) skip();
    load_real(&loaded, name, "cameras.json");
    tides_path path = load(name, NULL);
    assert_string_equal(path.format, "cameras");
    assert_int_equal(path.intrinsics.width, 3958);
    assert_near(path.intrinsics.cx, 1979.0, 0.0);
    tides_trajectory_destroy(path.trajectory);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tum),        cmocka_unit_test(esim),          cmocka_unit_test(stamps_keep_their_nanoseconds),
        cmocka_unit_test(cameras),    cmocka_unit_test(transforms),    cmocka_unit_test(transforms_of_trainers),
        cmocka_unit_test(tides),      cmocka_unit_test(save_and_load), cmocka_unit_test(generators),
        cmocka_unit_test(real_paths), cmocka_unit_test(real_cameras),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
