/* rig.file: Kalibr's camera chains as rigs: lenses, pixel centres and poses; merged with rig.cameras; other files are refused
 * in a line that names them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_folder.h"

#include "camera/td_camchain.h"
#include "tides/inputs.h"
#include "tides/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEED "tests/fuzz/seeds/camchain.yaml"
#define RUN(more) "{\"scene\": {\"file\": \"two.ply\"" more ", \"camera\": {\"file\": \"path.txt\"}, \"time\": {\"stop\": 0.1}}"
#define CHAIN "}, \"rig\": {\"file\": \"" SEED "\"}"

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

static void near_all(const double *a, const double *b, int count, double most) {
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= most)) fail_msg("number %d is %.17g, not %.17g", i, a[i], b[i]);
}

static void a_chain_is_a_rig(void **state) {
    (void)state;
    const char *first = "scene.metres_per_unit=0.5", *second[] = {"scene.metres_per_unit=0.5", "rig.camera=cam1"};
    tides_run *left = parsed(RUN(CHAIN), &first, 1), *right = parsed(RUN(CHAIN), second, 2);
    const tides_run_values l = values_of(left), r = values_of(right);
    assert_int_equal(l.intrinsics.width, 752);
    assert_int_equal(r.intrinsics.height, 260);
    near_all(&l.intrinsics.fx, (const double[]){461.5, 460.25, 363, 246.5}, 4, 0);
    near_all(&r.intrinsics.fx, (const double[]){190, 190.5, 172.5, 130}, 4, 0);
    assert_true(l.intrinsics.lens.model == TIDES_LENS_RADTAN && r.intrinsics.lens.model == TIDES_LENS_EQUIDISTANT);
    near_all(&l.intrinsics.lens.k1, (const double[]){-0.28, 0.07, 0, 0, 0.0002, -1.7e-5}, 6, 0);
    near_all(&r.intrinsics.lens.k1, (const double[]){-0.01, 0.02, -0.003, 0.0004, 0, 0}, 6, 0);
    /* cam0 from the IMU: T_cam_imu turned over, in units of half a metre; cam1 is 0.11 m to the right of it, in its axes. */
    static const double place[16] = {0, 1, 0, 0.02, -1, 0, 0, 0.04, 0, 0, 1, -0.01, 0, 0, 0, 1};
    tides_rig_camera camera;
    assert_int_equal(tides_run_rig_camera(left, 0, &camera), 1);
    assert_string_equal(camera.name, "cam0");
    near_all(camera.T_B_C, place, 16, 1e-15);
    assert_int_equal(tides_run_rig_camera(left, 1, &camera), 1);
    near_all(camera.T_B_C, (const double[]){0, 1, 0, 0.02, -1, 0, 0, 0.04 - 0.22}, 8, 1e-15);
    assert_int_equal(tides_run_rig_camera(left, 2, &camera), 0);
    tides_run *again = parsed(l.json, NULL, 0); /* what event files keep is the same run */
    assert_string_equal(values_of(again).json, l.json);
    tides_run_input *inputs;
    size_t count, named = 0;
    scene_expect_ok(tides_run_inputs(left, &inputs, &count, NULL), NULL);
    for (size_t i = 0; i < count; i++) named += strcmp(inputs[i].key, "rig.file") == 0;
    assert_int_equal(named, 1);
    free(inputs);
    tides_run_destroy(again);
    tides_run_destroy(left);
    tides_run_destroy(right);
}

/* A camera's own keys over the file's; and a run that varies another has the file's rig anew. */
static void keys_win_over_the_file(void **state) {
    (void)state;
    const char *own = "rig.cameras=[{\"name\": \"cam1\", \"kind\": \"event\", \"camera\": {\"width\": 100}}]",
               *sets[] = {"scene.metres_per_unit=1", own}, *vary[] = {"rig.camera=cam1", "scene.metres_per_unit=2"};
    tides_run *run = parsed(RUN(CHAIN), sets, 2), *other = NULL;
    tides_rig_camera camera;
    tides_error error;
    scene_expect_ok(tides_run_vary(run, vary, 2, &other, &error), &error);
    assert_int_equal(tides_run_rig_camera(other, 1, &camera), 1);
    assert_int_equal(camera.kind, TIDES_RIG_EVENT);
    near_all(camera.T_B_C + 3, (const double[]){0.005}, 1, 1e-15);
    assert_int_equal(values_of(other).intrinsics.width, 100);
    assert_int_equal(values_of(other).intrinsics.height, 260);
    tides_run_destroy(other);
    tides_run_destroy(run);
}

static void bad_runs_are_named(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {RUN(CHAIN), "set scene.metres_per_unit"},
        {RUN("}, \"rig\": {\"file\": \"none.yaml\"}"), "none.yaml"},
        {RUN(", \"metres_per_unit\": 1}, \"rig\": {\"file\": \"" SEED "\", \"cameras\": [{\"name\": \"left\"}]}"),
         "\"left\" isn't in rig.file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tides_run *run = NULL;
        tides_error error = {0, ""};
        assert_int_not_equal(tides_run_parse(cases[i][0], ".", NULL, 0, &run, &error), TIDES_OK);
        if (!strstr(error.text, cases[i][1])) fail_msg("'%s' isn't in '%s'", cases[i][1], error.text);
        assert_null(strchr(error.text, '\n'));
    }
}

#define ROWS "\n  - [1, 0, 0, 0.1]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n"
#define LENS "  intrinsics: [10, 10, 5, 5]\n  resolution: [10, 10]\n"

static void bad_chains_are_named(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"", "no camera"},
        {"# nothing\n", "no camera"},
        {"left:\n" LENS, "cam0 was expected"},
        {"cam1:\n" LENS, "cam0 was expected"},
        {"cam0: 3\n", "cam0 was expected"},
        {"[1, 2]\n", ":1: this isn't Kalibr's"},
        {"  resolution: [1, 1]\n", ":1: this isn't Kalibr's"},
        {"cam0:\n  resolution: [10, 10]\n", "cam0: intrinsics are missing"},
        {"cam0:\n  intrinsics: [10, 10, 5, 5]\n", "cam0: resolution is missing"},
        {"cam0:\n  resolution: [10, 10]\n  intrinsics: [10, 10, 5]\n", "intrinsics must be 4 finite numbers"},
        {"cam0:\n  resolution: [10, 10]\n  intrinsics: [10, 10, 5, 5, 5]\n", "intrinsics must be 4 finite numbers"},
        {"cam0:\n  resolution: [10, 10]\n  intrinsics: [10, .inf, 5, 5]\n", "intrinsics must be 4 finite numbers"},
        {"cam0:\n  intrinsics: [0, 10, 5, 5]\n  resolution: [10, 10]\n", "above 0"},
        {"cam0:\n  intrinsics: [10, 10, 5, 5]\n  resolution: [10.5, 10]\n", "whole numbers"},
        {"cam0:\n" LENS LENS, "intrinsics is given twice"},
        {"cam0:\n" LENS "  line_delay: 1e-5\n", "key line_delay isn't one of Kalibr's"},
        {"cam0:\n" LENS "  camera_model: omni\n", "camera_model omni isn't supported"},
        {"cam0:\n" LENS "  distortion_model: fov\n  distortion_coeffs: [1, 0, 0, 0]\n", "distortion_model fov isn't supported"},
        {"cam0:\n  camera_model: ds\n  intrinsics: [0.1, 0.2, 10, 10, 5, 5]\n  distortion_model: none\n  distortion_coeffs: "
         "[]\n"
         "  resolution: [10, 10]\n",
         "camera_model ds isn't supported"},
        {"cam0:\n  camera_model: omni\n  intrinsics: [1.5, 10, 10, 5, 5]\n", "camera_model omni isn't supported"},
        {"cam0:\n  camera_model: eucm\n", "camera_model eucm isn't supported"},
        {"cam0:\n" LENS "  distortion_model: fov\n  distortion_coeffs: [0.9]\n", "distortion_model fov isn't supported"},
        {"cam0:\n" LENS "  distortion_model: radtan\n  distortion_coeffs: []\n", "distortion_coeffs must be 4 finite numbers"},
        {"cam0:\n" LENS "cam1:\n" LENS "  T_cam_imu:" ROWS, "cam1: T_cn_cnm1 is missing"},
        {"cam0:\n" LENS "  T_cam_imu:\n  - - 1\n    - 0\n    - 0\n  - - 0\n", "T_cam_imu must be four rows"},
        {"cam0:\n" LENS "  distortion_model: radtan\n", "needs distortion_coeffs"},
        {"cam0:\n" LENS "  timeshift_cam_imu: 0.0012\n", "one clock"},
        {"cam0:\n" LENS "  T_cam_imu:" ROWS "  T_imu_cam:" ROWS, "keep one"},
        {"cam0:\n" LENS "  T_cam_imu:\n  - [1, 0, 0, 0]\n", "T_cam_imu must be four rows"},
        {"cam0:\n" LENS "  T_cam_imu: [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n", "a rotation and a place"},
        {"cam0:\n" LENS "cam1:\n" LENS, "cam1: T_cn_cnm1 is missing"},
        {"cam0:\n" LENS "cam2:\n" LENS, "cam1 was expected"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static td_camchain chain;
        tides_error error = {0, ""};
        char *text = strdup(cases[i][0]);
        const tides_status status = td_camchain_parse("chain.yaml", text, &chain, &error);
        if (status != TIDES_BAD_FILE && status != TIDES_UNSUPPORTED) fail_msg("'%s' is read", cases[i][0]);
        if (!strstr(error.text, cases[i][1])) fail_msg("'%s' isn't in '%s'", cases[i][1], error.text);
        assert_null(strchr(error.text, '\n'));
        free(text);
    }
}

/* OpenVINS's key is the other way round; a file without a last newline, with Windows' ends of lines. */
static void other_ways_of_writing(void **state) {
    (void)state;
    static td_camchain chain;
    tides_error error = {0, ""};
    char text[] = "cam0:\r\n  T_imu_cam: #rotation from camera to IMU\r\n    - [1, 0, 0, 0.1]\r\n    - [0, 1, 0, 0]\r\n"
                  "    - [0, 0, 1, 0]\r\n    - [0, 0, 0, 1]\r\n  camera_model: \"pinhole\"\r\n  distortion_model: none\r\n"
                  "  intrinsics: [10, 10, 5, 5]\r\n  resolution: [10, 10]";
    scene_expect_ok(td_camchain_parse("chain.yaml", text, &chain, &error), &error);
    assert_int_equal(chain.count, 1);
    assert_true(fabs(chain.camera[0].T_B_C[3] - 0.1) < 1e-15 && chain.camera[0].intrinsics.lens.model == TIDES_LENS_NONE);
    static const char *const names[] = {"equi", "equidistant", "radtan", "plumb_bob"};
    for (int i = 0; i < 4; i++) {
        char other[300];
        snprintf(other, sizeof other,
                 "cam0:\n  camera_model: pinhole\n  distortion_model: %s\n  distortion_coeffs: [0.1, 0, 0, 0]\n"
                 "  intrinsics: [10, 10, 5, 5]\n  resolution: [10, 10]\n",
                 names[i]);
        scene_expect_ok(td_camchain_parse("chain.yaml", other, &chain, &error), &error);
        assert_int_equal(chain.camera[0].intrinsics.lens.model, i < 2 ? TIDES_LENS_EQUIDISTANT : TIDES_LENS_RADTAN);
    }
}

/* PyYAML's block style, and an editor's byte order mark; no lens with an empty list. */
static void blocks(void **state) {
    (void)state;
    static td_camchain chain;
    tides_error error = {0, ""};
    char text[] = "\xEF\xBB\xBF"
                  "cam0:\n  T_cam_imu:\n  - - 1.0\n    - 0.0\n    - 0.0\n    - 0.5\n  - - 0.0\n    - 1.0\n    - 0.0\n"
                  "    - -0.25\n  - - 0.0\n    - 0.0\n    - 1.0\n    - 0.0\n  - - 0.0\n    - 0.0\n    - 0.0\n    - 1.0\n"
                  "  cam_overlaps:\n  - 1\n  distortion_coeffs: []\n  distortion_model: none\n  intrinsics:\n  - 10.0\n"
                  "  - 11.0\n  - 5.0\n  - 6.0\n  resolution:\n  - 10\n  - 12\ncam1:\n  T_cn_cnm1:\n  - [1, 0, 0, 1]\n"
                  "  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n  distortion_coeffs:\n  - 0.1\n  - 0.2\n  - 0.3\n"
                  "  - 0.4\n  distortion_model: radtan\n" LENS;
    scene_expect_ok(td_camchain_parse("chain.yaml", text, &chain, &error), &error);
    assert_int_equal(chain.count, 2);
    assert_int_equal(chain.has_imu, 1);
    near_all(chain.camera[0].T_B_C, (const double[]){1, 0, 0, -0.5, 0, 1, 0, 0.25}, 8, 1e-15);
    near_all(&chain.camera[0].intrinsics.fx, (const double[]){10, 11, 5.5, 6.5}, 4, 1e-15);
    assert_int_equal(chain.camera[0].intrinsics.lens.model, TIDES_LENS_NONE);
    near_all(chain.camera[1].T_B_C, (const double[]){1, 0, 0, -1.5, 0, 1, 0, 0.25}, 8, 1e-15);
    near_all(&chain.camera[1].intrinsics.lens.k1, (const double[]){0.1, 0.2, 0, 0, 0.3, 0.4}, 6, 1e-15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_is_a_rig),     cmocka_unit_test(keys_win_over_the_file), cmocka_unit_test(bad_runs_are_named),
        cmocka_unit_test(bad_chains_are_named), cmocka_unit_test(other_ways_of_writing),  cmocka_unit_test(blocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
