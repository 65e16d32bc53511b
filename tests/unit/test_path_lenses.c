/* Lenses of path files: the models of tides_lens, files without a lens, and lenses that differ from frame to frame. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void write_text(const char *path, const char *text) { scene_file_write(path, text, strlen(text)); }

static tides_path load(const char *file) {
    tides_path path;
    tides_error error = {0, ""};
    scene_expect_ok(tides_path_load(file, NULL, &path, &error), &error);
    return path;
}

static void intrinsics_are(const tides_path *path, const double expected[6]) {
    const tides_intrinsics *i = &path->intrinsics;
    const double got[6] = {i->width, i->height, i->fx, i->fy, i->cx, i->cy};
    for (int k = 0; k < 6; k++)
        if (!(fabs(got[k] - expected[k]) <= 1e-12)) fail_msg("intrinsic %d is %.17g, and not %.17g", k, got[k], expected[k]);
}

static void lens_is(const tides_path *path, const tides_lens *wanted) {
    const tides_lens *lens = &path->intrinsics.lens;
    const double got[] = {lens->k1, lens->k2, lens->k3, lens->k4, lens->p1, lens->p2};
    const double want[] = {wanted->k1, wanted->k2, wanted->k3, wanted->k4, wanted->p1, wanted->p2};
    assert_int_equal(lens->model, wanted->model);
    for (int i = 0; i < 6; i++)
        if (got[i] < want[i] || got[i] > want[i]) fail_msg("coefficient %d is %.17g, and not %.17g", i, got[i], want[i]);
}

enum { RADTAN = TIDES_LENS_RADTAN, EQUIDISTANT = TIDES_LENS_EQUIDISTANT };

static void models(void **state) {
    static const struct {
        const char *line;
        double intrinsics[6];
        int distorted;
        tides_lens lens;
    } cases[] = {
        {"SIMPLE_PINHOLE 10 8 5 6 7", {10, 8, 5, 5, 6, 7}, 0, {0}},
        {"PINHOLE 10 8 5 6 7 8", {10, 8, 5, 6, 7, 8}, 0, {0}},
        {"SIMPLE_RADIAL 10 8 5 6 7 0", {10, 8, 5, 5, 6, 7}, 0, {0}},
        {"SIMPLE_RADIAL 10 8 5 6 7 -0.1", {10, 8, 5, 5, 6, 7}, 0, {RADTAN, .k1 = -0.1}},
        {"RADIAL 10 8 5 6 7 0 0.1", {10, 8, 5, 5, 6, 7}, 0, {RADTAN, .k2 = 0.1}},
        {"OPENCV 10 8 5 6 7 8 0 0 0 0", {10, 8, 5, 6, 7, 8}, 0, {0}},
        {"OPENCV 10 8 5 6 7 8 .1 .2 .3 .4", {10, 8, 5, 6, 7, 8}, 0, {RADTAN, .k1 = .1, .k2 = .2, .p1 = .3, .p2 = .4}},
        {"OPENCV_FISHEYE 10 8 5 6 7 8 0 0 0 0", {10, 8, 5, 6, 7, 8}, 0, {.model = EQUIDISTANT}},
        {"OPENCV_FISHEYE 10 8 5 6 7 8 .1 .2 .3 .4",
         {10, 8, 5, 6, 7, 8},
         0,
         {EQUIDISTANT, .k1 = .1, .k2 = .2, .k3 = .3, .k4 = .4}},
        {"FULL_OPENCV 10 8 5 6 7 8 .1 .2 .3 .4 .5 0 0 0",
         {10, 8, 5, 6, 7, 8},
         0,
         {RADTAN, .k1 = .1, .k2 = .2, .p1 = .3, .p2 = .4, .k3 = .5}},
        {"FULL_OPENCV 10 8 5 6 7 8 0 0 0 0 0 0 0 1", {10, 8, 5, 6, 7, 8}, 1, {0}},
        {"FOV 10 8 5 6 7 8 0", {10, 8, 5, 6, 7, 8}, 0, {0}},
        {"SIMPLE_RADIAL_FISHEYE 10 8 5 6 7 .1", {10, 8, 5, 5, 6, 7}, 0, {EQUIDISTANT, .k1 = .1}},
        {"RADIAL_FISHEYE 10 8 5 6 7 .1 .2", {10, 8, 5, 5, 6, 7}, 0, {EQUIDISTANT, .k1 = .1, .k2 = .2}},
        {"THIN_PRISM_FISHEYE 10 8 5 6 7 8 .1 .2 0 0 .3 .4 0 0",
         {10, 8, 5, 6, 7, 8},
         0,
         {EQUIDISTANT, .k1 = .1, .k2 = .2, .k3 = .3, .k4 = .4}},
        {"THIN_PRISM_FISHEYE 10 8 5 6 7 8 0 0 0 .1 0 0 0 0", {10, 8, 5, 6, 7, 8}, 1, {0}},
    };
    char file[4200];
    snprintf(file, sizeof file, "%s", scene_in_folder(*state, "images.txt"));
    write_text(file, "1 1 0 0 0 0 0 0 3 a.png\n\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[128];
        snprintf(line, sizeof line, "3 %s # end\n", cases[i].line);
        write_text(scene_in_folder(*state, "cameras.txt"), line);
        tides_path path = load(file);
        intrinsics_are(&path, cases[i].intrinsics);
        assert_int_equal(path.distorted, cases[i].distorted);
        lens_is(&path, &cases[i].lens);
        tides_trajectory_destroy(path.trajectory);
    }
}

/* A FOV lens becomes the pinhole that agrees with it at its axis. COLMAP's formula for the radius of a ray's image is evaluated
 * 1e-7 beside the axis, where it differs from the pinhole's by less than 4e-11 of itself. */
static void fov_at_its_axis(void **state) {
    static const double omegas[] = {1e-9, 0.01, 0.9, -0.9, 2.5, 3.1}, beside = 1e-7;
    char file[4200];
    snprintf(file, sizeof file, "%s", scene_in_folder(*state, "images.txt"));
    write_text(file, "1 1 0 0 0 0 0 0 3 a.png\n\n");
    for (size_t i = 0; i < sizeof omegas / sizeof *omegas; i++) {
        const double radius = atan(beside * 2 * tan(omegas[i] / 2)) / omegas[i], scale = radius / beside;
        char line[128];
        snprintf(line, sizeof line, "3 FOV 10 8 5 6 7 8 %.17g\n", omegas[i]);
        write_text(scene_in_folder(*state, "cameras.txt"), line);
        tides_path path = load(file);
        const tides_intrinsics *is = &path.intrinsics;
        assert_int_equal(path.distorted, 1);
        assert_int_equal(is->lens.model, TIDES_LENS_NONE);
        if (!(fabs(is->fx / 5 - scale) <= 1e-10 * scale && fabs(is->fy / 6 - scale) <= 1e-10 * scale))
            fail_msg("omega %g: scales are %.12g and %.12g, and not %.12g", omegas[i], is->fx / 5, is->fy / 6, scale);
        assert_true(is->cx == 7 && is->cy == 8);
        tides_trajectory_destroy(path.trajectory);
    }
}

static const char sensor[] = "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0.0, 0.0, 1.0, 0.0,\n"
                             "   -1, 0, 0, 0,\n   0, -1, 0, 1.0,\n  0, 0, 0, 1]\nresolution: [752, 480]\n"
                             "intrinsics: [458.5, 457.25, 367.5, 248] #fu, fv, cu, cv\n";
#define REST "\"focal_length\": 500, \"principal_point\": [320, 240], \"pixel_aspect_ratio\": 1.1, \"image_size\": [640, 480]"

/* Other files' lenses, each a path of one pose beside or within which the lens stands. */
static void lenses(void **state) {
    static const struct {
        const char *name, *text;
        int distorted;
        tides_lens lens;
    } cases[] = {
        {"transforms.json",
         "\"camera_model\": \"OPENCV_FISHEYE\", \"k1\": 0.1, \"k4\": 0.4",
         0,
         {EQUIDISTANT, .k1 = .1, .k4 = .4}},
        {"transforms.json", "\"is_fisheye\": true, \"k2\": 0.2", 0, {EQUIDISTANT, .k2 = .2}},
        {"transforms.json",
         "\"camera_model\": \"OPENCV\", \"distortion_params\": [0.1, 0.2, 0.3, 0, 0.5, 0.6]",
         0,
         {RADTAN, .k1 = .1, .k2 = .2, .k3 = .3, .p1 = .5, .p2 = .6}},
        {"transforms.json", "\"camera_model\": \"OPENCV\", \"k4\": 0.1", 1, {.model = 0}},
        {"transforms.json", "\"camera_model\": \"FISHEYE624\"", 1, {.model = 0}},
        {"sensor.yaml",
         "distortion_model: radial-tangential\ndistortion_coefficients: [0.1, 0.2, 0.3, 0.4]\n",
         0,
         {RADTAN, .k1 = .1, .k2 = .2, .p1 = .3, .p2 = .4}},
        {"sensor.yaml",
         "distortion_model: equidistant\ndistortion_coefficients: [0.1, 0.2, 0.3, 0.4]\n",
         0,
         {EQUIDISTANT, .k1 = .1, .k2 = .2, .k3 = .3, .k4 = .4}},
        {"sensor.yaml",
         "distortion_model: radial-tangential\ndistortion_coefficients: [0.1, 0.2, 0.3, 0.4, 0.5]\n",
         0,
         {RADTAN, .k1 = .1, .k2 = .2, .p1 = .3, .p2 = .4, .k3 = .5}},
        {"sensor.yaml", "distortion_model: fov\ndistortion_coefficients: [0.9, 0, 0, 0]\n", 1, {.model = 0}},
        {"sensor.yaml", "distortion_model: fov\ndistortion_coefficients: [0.9]\n", 1, {.model = 0}},
        {"sensor.yaml", "distortion_model: fov\ndistortion_coefficients: [0]\n", 0, {.model = 0}},
        {"a.json",
         "\"radial_distortion\": [0.1, 0.2, 0.3], \"tangential_distortion\": [0.4, 0.5]",
         0,
         {RADTAN, .k1 = .1, .k2 = .2, .k3 = .3, .p1 = .4, .p2 = .5}},
    };
    char text[1024];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *name = cases[i].name, *of = cases[i].text;
        if (name[0] == 't')
            snprintf(text, sizeof text, "{%s, \"frames\": [{\"transform_matrix\": [[1,0,0,1],[0,-1,0,2],[0,0,-1,3]]}]}", of);
        if (name[0] == 's') snprintf(text, sizeof text, "%s%s", sensor, of);
        if (name[0] == 'a')
            snprintf(text, sizeof text, "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [0, 0, 0], %s, " REST "}",
                     of);
        write_text(scene_in_folder(*state, name), text);
        char file[4200];
        snprintf(file, sizeof file, "%s", scene_in_folder(*state, name[0] == 's' ? "gt.csv" : name));
        if (name[0] == 's') write_text(file, "#q_RS_w\n1000000,2,3,4,1,0,0,0\n2000000,2,3,4,1,0,0,0\n");
        tides_path path = load(file);
        assert_int_equal(path.distorted, cases[i].distorted);
        lens_is(&path, &cases[i].lens);
        tides_trajectory_destroy(path.trajectory);
        remove(scene_in_folder(*state, name));
        remove(file);
    }
}

/* A lens that differs from frame to frame is none. */
static void lenses_that_differ(void **state) {
    write_text(scene_in_folder(*state, "transforms.json"),
               "{\"frames\": [{\"k1\": 0.1, \"transform_matrix\": [[1,0,0,1],[0,-1,0,2],[0,0,-1,3]]},"
               "{\"k1\": 0.2, \"transform_matrix\": [[1,0,0,1],[0,-1,0,2],[0,0,-1,3]]}]}");
    tides_path path = load(*state);
    assert_int_equal(path.distorted, 1);
    assert_int_equal(path.intrinsics.lens.model, TIDES_LENS_NONE);
    tides_trajectory_destroy(path.trajectory);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {IN_FOLDER(models), IN_FOLDER(fov_at_its_axis), IN_FOLDER(lenses),
                                       IN_FOLDER(lenses_that_differ)};
    return cmocka_run_group_tests_name("path_lenses", tests, NULL, NULL);
}
