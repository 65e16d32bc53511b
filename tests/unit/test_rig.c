/* Rigs: a camera's pose and rate on a body are composed to rounding. A run uses the camera that rig.camera names, whose own
 * keys come between the file's and --set's. Sessions of one rig share the scene. Wrong rigs are refused by name. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tides.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double turned[4] = {0.5, -0.5, 0.5, -0.5}, arm[3] = {0.1, -0.02, 0.3};

static tides_trajectory *body_path(void) {
    const tides_handheld shaken = {.target = {0, 0, 4},
                                   .up = {0, -1, 0},
                                   .position_amplitude = 0.2,
                                   .rotation_amplitude = 0.3,
                                   .frequency = 2,
                                   .seed = 7,
                                   .stop = 1};
    tides_trajectory *body = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(tides_trajectory_create_handheld(&shaken, &body, &error), &error);
    return body;
}

static tides_trajectory *mounted_on(const tides_trajectory *body, const double position[3], const double quaternion[4]) {
    tides_trajectory *made = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(tides_trajectory_create_mounted(body, position, quaternion, &made, &error), &error);
    return made;
}

static tides_pose at(const tides_trajectory *path, double time) {
    tides_pose pose;
    tides_error error = {0, ""};
    scene_expect_ok(tides_trajectory_at(path, time, &pose, &error), &error);
    return pose;
}

/* Where the body takes the point that the mount has at p. */
static void through(const double rotation[9], const double position[3], const double p[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = rotation[3 * i] * p[0] + rotation[3 * i + 1] * p[1] + rotation[3 * i + 2] * p[2] + position[i];
}

static void near_all(const double *one, const double *two, int count, double tolerance) {
    for (int i = 0; i < count; i++)
        if (!(fabs(one[i] - two[i]) <= tolerance)) fail_msg("%d: %.17g, not %.17g", i, one[i], two[i]);
}

static void mounts_are_composed_exactly(void **state) {
    (void)state;
    /* (w, x, y, z) = (1, -1, 1, -1) / 2 turns x to -y, y to -z, z to x */
    const double mount[9] = {0, 0, 1, -1, 0, 0, 0, -1, 0}, nothing[3] = {0, 0, 0};
    tides_trajectory *body = body_path(), *camera = mounted_on(body, arm, turned);
    assert_int_equal(tides_trajectory_count(camera), tides_trajectory_count(body));
    for (double t = 0; t <= 1; t += 0.0371) {
        const tides_pose b = at(body, t), c = at(camera, t);
        double expected[3];
        through(b.rotation, b.position, arm, expected);
        near_all(c.position, expected, 3, 1e-15);
        through(b.rotation_dot, b.position_dot, arm, expected);
        near_all(c.position_dot, expected, 3, 1e-14);
        for (int axis = 0; axis < 3; axis++) {
            const double column[3] = {mount[axis], mount[3 + axis], mount[6 + axis]};
            const double value[3] = {c.rotation[axis], c.rotation[3 + axis], c.rotation[6 + axis]};
            const double rate[3] = {c.rotation_dot[axis], c.rotation_dot[3 + axis], c.rotation_dot[6 + axis]};
            through(b.rotation, nothing, column, expected);
            near_all(value, expected, 3, 1e-15);
            through(b.rotation_dot, nothing, column, expected);
            near_all(rate, expected, 3, 1e-14);
        }
    }
    tides_trajectory_destroy(camera);
    tides_trajectory_destroy(body);
}

/* Samples are on the path that poses are on; a mount on a mount is one mount; none changes no bit. */
static void mounts_agree_with_themselves(void **state) {
    (void)state;
    const double none[3] = {0, 0, 0}, still[4] = {2, 0, 0, 0};
    tides_trajectory *body = body_path(), *camera = mounted_on(body, arm, turned), *twice = mounted_on(camera, arm, turned);
    tides_trajectory *same = mounted_on(body, none, still);
    tides_error error = {0, ""};
    for (size_t i = 0; i < tides_trajectory_count(camera); i += 5) {
        tides_pose_sample sample;
        scene_expect_ok(tides_trajectory_sample(camera, i, &sample, &error), &error);
        const tides_pose pose = at(camera, sample.time), body_pose = at(body, sample.time), other = at(same, sample.time);
        near_all(sample.position, pose.position, 3, 1e-12);
        near_all(sample.velocity, pose.position_dot, 3, 1e-9);
        assert_memory_equal(&other, &body_pose, sizeof other);
        double expected[3];
        through(pose.rotation, pose.position, arm, expected);
        near_all(at(twice, sample.time).position, expected, 3, 1e-14);
    }
    const double zero[4] = {0, 0, 0, 0};
    tides_trajectory *refused = NULL;
    assert_int_equal(tides_trajectory_create_mounted(body, arm, zero, &refused, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_trajectory_create_mounted(NULL, arm, turned, &refused, &error), TIDES_BAD_ARGUMENT);
    assert_null(refused);
    tides_trajectory_destroy(same);
    tides_trajectory_destroy(twice);
    tides_trajectory_destroy(camera);
    tides_trajectory_destroy(body);
}

/* A camera's acceleration is the rate of its velocity; an IMU's specific force is that in its own axes. */
static void mounts_accelerate(void **state) {
    (void)state;
    const double h = 1e-5;
    tides_trajectory *body = body_path(), *camera = mounted_on(body, arm, turned);
    tides_error error = {0, ""};
    for (double t = 0.1; t < 0.9; t += 0.0531) {
        double acceleration[3], expected[3], force[3];
        const tides_pose before = at(camera, t - h), after = at(camera, t + h), here = at(camera, t);
        for (int k = 0; k < 3; k++) expected[k] = (after.position_dot[k] - before.position_dot[k]) / (2 * h);
        scene_expect_ok(tides_trajectory_acceleration(camera, t, acceleration, &error), &error);
        near_all(acceleration, expected, 3, 1e-4); /* of up to 500: a difference is as good as samples' thirds let it be */
        tides_imu imu;
        tides_imu_defaults(&imu);
        imu.gravity = 0;
        imu.metres_per_unit = 2;
        tides_imu_sample sample;
        scene_expect_ok(tides_trajectory_imu(camera, &imu, t, 1, &sample, &error), &error);
        for (int k = 0; k < 3; k++)
            force[k] = 2 * (here.rotation[k] * acceleration[0] + here.rotation[3 + k] * acceleration[1] +
                            here.rotation[6 + k] * acceleration[2]);
        near_all(sample.specific_force, force, 3, 1e-12);
    }
    tides_trajectory_destroy(camera);
    tides_trajectory_destroy(body);
}

/* -- in run files --------------------------------------------------------------------------------------------------------- */

#define MATRIX(x) "[[1, 0, 0, " x "], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
#define RUN(rig)                                                                                                         \
    "{\"scene\": {\"file\": \"two.ply\"}, \"camera\": {\"file\": \"path.txt\", \"width\": 24, \"height\": 18,"           \
    " \"fx\": 20}, \"time\": {\"stop\": 0.1}, \"sensor\": {\"threshold_on\": 0.1}, \"device\": \"reference\", \"rig\": " \
    "{\"cameras\": " rig "}}"
#define STEREO                                                                                               \
    "[{\"name\": \"left\", \"sensor\": {\"threshold_on\": 0.4}}, {\"name\": \"right\", \"kind\": \"frame\"," \
    " \"T_B_C\": " MATRIX("0.25") ", \"camera\": {\"width\": 30}, \"frontend\": {\"circuit\": {\"gain\": 3}}}]"

static tides_run *parsed(const char *text, const char *const *sets, size_t count) {
    tides_run *run = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(tides_run_parse(text, ".", sets, count, &run, &error), &error);
    return run;
}

static tides_run_values values_of(const tides_run *run) {
    tides_run_values values;
    tides_run_get(run, &values);
    return values;
}

static void a_run_is_of_one_camera(void **state) {
    (void)state;
    const char *right = "rig.camera=right", *left = "rig.camera=left", *set[] = {"sensor.threshold_on=0.7", "rig.camera=left"};
    tides_error error = {0, ""};
    tides_run *first = parsed(RUN(STEREO), NULL, 0), *second = NULL, *back = NULL, *over = parsed(RUN(STEREO), set, 2);
    assert_true(fabs(values_of(first).sensor.threshold_on - 0.4) < 1e-15);
    assert_int_equal(values_of(first).intrinsics.width, 24);
    scene_expect_ok(tides_run_vary(first, &right, 1, &second, &error), &error);
    assert_true(fabs(values_of(second).sensor.threshold_on - 0.1) < 1e-15); /* the file's again */
    assert_int_equal(values_of(second).intrinsics.width, 30);
    assert_true(fabs(values_of(second).sensor.circuit.gain - 3) < 1e-15);
    scene_expect_ok(tides_run_vary(second, &left, 1, &back, &error), &error);
    assert_true(fabs(values_of(back).sensor.threshold_on - 0.4) < 1e-15);
    assert_int_equal(values_of(back).intrinsics.width, 24);
    assert_true(fabs(values_of(over).sensor.threshold_on - 0.7) < 1e-15);
    assert_int_equal(values_of(first).sensor.seed, 0);
    assert_true(values_of(second).sensor.seed != 0);            /* noise of its own */
    tides_run *again = parsed(values_of(second).json, NULL, 0); /* what event files keep is the same run */
    assert_string_equal(values_of(again).json, values_of(second).json);
    tides_rig_camera camera;
    assert_int_equal(tides_run_rig_camera(first, 1, &camera), 1);
    assert_string_equal(camera.name, "right");
    assert_int_equal(camera.kind, TIDES_RIG_FRAME);
    assert_true(fabs(camera.T_B_C[3] - 0.25) < 1e-15);
    assert_int_equal(tides_run_rig_camera(first, 2, &camera), 0);
    assert_int_equal(tides_run_rig_camera(NULL, 0, &camera), 0);
    tides_run *const made[] = {first, second, back, over, again};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) tides_run_destroy(made[i]);
}

static void bad_rigs_are_named(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {RUN("[{\"name\": \"a\"}, {\"name\": \"b\"}]"), "baseline of 0"},
        {RUN("[{\"name\": \"a\"}, {\"name\": \"a\", \"T_B_C\": " MATRIX("1") "}]"), "two are called \"a\""},
        {RUN("[{\"name\": \"a\", \"time\": {\"start\": 1}}]"), "one clock"},
        {RUN("[{\"name\": \"a\", \"camera\": {\"start_s\": 1}}]"), "camera.start_s"},
        {RUN("[{\"name\": \"a\", \"camera\": {\"views\": \"0:5\"}}]"), "camera.views"},
        {RUN("[{\"name\": \"a\", \"camera\": {\"width\": 0}}]"), "out of range"},
        {RUN("[{\"name\": \"a\", \"sensor\": {\"threshold\": 1}}]"), "sensor.threshold"},
        {RUN("[{\"name\": \"a/b\"}]"), "name"},
        {RUN("[{\"kind\": \"event\"}]"), "name is missing"},
        {RUN("[{\"name\": \"a\", \"kind\": \"radar\"}]"), "event, frame, both"},
        {RUN("[{\"name\": \"a\", \"T_B_C\": [1, 2]}]"), "four rows"},
        {RUN("[{\"name\": \"a\", \"T_B_C\": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]"), "rotation"},
        {RUN("[{\"name\": \"a\", \"T_B_C\": [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]"), "rotation"},
        {RUN("[{\"name\": \"a\", \"lens\": 1}]"), "lens is unknown"},
        {RUN("[3]"), "isn't an object"},
        {RUN("3"), "is a list"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tides_run *run = NULL;
        tides_error error = {0, ""};
        scene_expect_error(tides_run_parse(cases[i][0], ".", NULL, 0, &run, &error), TIDES_BAD_CONFIG, &error, cases[i][1]);
        assert_null(strchr(error.text, '\n'));
    }
    const char *unknown = "rig.camera=up";
    tides_run *run = NULL;
    tides_error error = {0, ""};
    scene_expect_error(tides_run_parse(RUN(STEREO), ".", &unknown, 1, &run, &error), TIDES_BAD_CONFIG, &error, "rig.camera");
    tides_run *fine = parsed(RUN("[{\"name\": \"a\", \"kind\": \"event\"}, {\"name\": \"b\", \"kind\": \"frame\"}]"), NULL, 0);
    tides_run_destroy(fine); /* behind one beam splitter */
}

/* -- open ----------------------------------------------------------------------------------------------------------------- */

static const char splats[] = "ply\nformat ascii 1.0\nelement vertex 1\n"
                             "property float x\nproperty float y\nproperty float z\n"
                             "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
                             "property float scale_0\nproperty float scale_1\nproperty float scale_2\n"
                             "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
                             "end_header\n0 0 4 1 1 1 2 -1 -1 -1 1 0 0 0\n";
static const char path[] = "0 0 0 0 0 0 0 1\n0.05 0.1 0.02 0 0 0 0 1\n0.1 0.3 0 0 0 0 0 1\n";

static void cameras_share_the_scene(void **state) {
    tides_error error = {0, ""};
    tides_session *left = NULL, *right = NULL, *none = NULL;
    const char *other = "rig.camera=right", *both[] = {"rig.camera=right", "scene.duration_s=2"};
    scene_file_write(scene_in_folder(*state, "two.ply"), splats, sizeof splats - 1);
    scene_file_write(scene_in_folder(*state, "path.txt"), path, sizeof path - 1);
    scene_file_write(scene_in_folder(*state, "run.json"), RUN(STEREO), sizeof RUN(STEREO) - 1);
    scene_expect_ok(tides_session_load(scene_in_folder(*state, "run.json"), NULL, 0, NULL, &left, &error), &error);
    scene_expect_ok(tides_session_vary(left, &other, 1, &right, &error), &error);
    tides_session_facts l, r;
    tides_session_get(left, &l);
    tides_session_get(right, &r);
    assert_ptr_equal(l.scene, r.scene);
    assert_int_equal(l.intrinsics.width, 24);
    assert_int_equal(r.intrinsics.width, 30);
    for (double t = 0; t <= 0.1; t += 0.01) {
        const tides_pose a = at(l.camera, t), b = at(r.camera, t);
        near_all(&b.position[0], (const double[]){a.position[0] + 0.25}, 1, 1e-15);
        assert_memory_equal(a.rotation_dot, b.rotation_dot, sizeof a.rotation_dot);
    }
    scene_expect_error(tides_session_vary(left, both, 2, &none, &error), TIDES_BAD_CONFIG, &error, "scene.duration_s");
    tides_session_close(right);
    tides_session_close(left);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mounts_are_composed_exactly),
        cmocka_unit_test(mounts_agree_with_themselves),
        cmocka_unit_test(mounts_accelerate),
        cmocka_unit_test(a_run_is_of_one_camera),
        cmocka_unit_test(bad_rigs_are_named),
        cmocka_unit_test_setup_teardown(cameras_share_the_scene, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
