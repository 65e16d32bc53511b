/* Camera files of datasets, made by the test: COLMAP, EuRoC, LLFF, nerfies and KITTI: poses, intrinsics, order, companion files
 * beside a file and in a folder, and every error. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "tests/support/scene_folder.h"
#include "tests/support/splat_make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void write_text(const char *path, const char *text) { scene_file_write(path, text, strlen(text)); }

static tides_path load(const char *file, const tides_path_options *options) {
    tides_path path;
    tides_error error = {0, ""};
    scene_expect_ok(tides_path_load(file, options, &path, &error), &error);
    return path;
}

static void expect_refused(const char *file, tides_status status, const char *words) {
    tides_path path, before;
    memset(&path, 7, sizeof path);
    before = path;
    tides_error error = {0, ""};
    scene_expect_error(tides_path_load(file, NULL, &path, &error), status, &error, words);
    assert_memory_equal(&path, &before, sizeof path);
    assert_int_equal(tides_path_load(file, NULL, &path, NULL), status);
}

static void assert_near(const char *what, double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) fail_msg("%s: got %.17g, expected %.17g", what, got, expected);
}

/* Time, position, and where the camera's x, y, z axes point. */
static void assert_pose(const tides_path *path, size_t index, double time, const double position[3], const double rotation[9]) {
    tides_pose_sample sample;
    tides_pose pose;
    assert_int_equal(tides_trajectory_sample(path->trajectory, index, &sample, NULL), TIDES_OK);
    assert_near("time", sample.time, time, 1e-12);
    assert_int_equal(tides_trajectory_at(path->trajectory, sample.time, &pose, NULL), TIDES_OK);
    for (int k = 0; k < 3; k++) assert_near("position", pose.position[k], position[k], 1e-12);
    for (int k = 0; k < 9; k++) assert_near("rotation", pose.rotation[k], rotation[k], 1e-12);
}

static void assert_intrinsics(const tides_path *path, const double expected[6]) {
    const tides_intrinsics *i = &path->intrinsics;
    const double got[6] = {i->width, i->height, i->fx, i->fy, i->cx, i->cy};
    for (int k = 0; k < 6; k++) assert_near("intrinsics", got[k], expected[k], 1e-12);
}

/* A camera that looks along x: its z axis is the world's x, its x the world's -y, its y the world's -z. */
static const double level[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, forward[9] = {0, 0, 1, -1, 0, 0, 0, -1, 0};
static const double origin[3] = {0, 0, 0}, away[3] = {1, 2, 3};

/* -- COLMAP -- */

/* World to camera of `forward` at `away`: q = (1/2, 1/2, -1/2, 1/2), t = -R^T (1, 2, 3) = (2, 3, -1). */
#define LEVEL "1 0 0 0 0 0 0"
#define FORWARD "0.5 0.5 -0.5 0.5 2 3 -1"
#define HEAD "# a comment\n\n"

/* What an image's two lines are, and how names rule the order. */
static void colmap_text(void **state) {
    const char *file = scene_in_folder(*state, "images.txt");
    write_text(scene_in_folder(*state, "cameras.txt"), HEAD "7 PINHOLE 640 480 500 510 320.5 240.25\r\n");
    write_text(file, HEAD "1 " FORWARD " 7 b name.png\n1 2 3\n  2 " LEVEL " 7 a.png\n\n3 " LEVEL " 7 0010.png\n# points\n");
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.duration = 4;
    tides_path path = load(file, &options);
    assert_string_equal(path.format, "colmap");
    assert_int_equal(tides_trajectory_count(path.trajectory), 3);
    assert_pose(&path, 0, 0, origin, level); /* 0010.png */
    assert_pose(&path, 1, 2, origin, level);
    assert_pose(&path, 2, 4, away, forward);
    assert_intrinsics(&path, (const double[6]){640, 480, 500, 510, 320.5, 240.25});
    assert_int_equal(path.distorted, 0);
    tides_trajectory_destroy(path.trajectory);
    write_text(file, "1 " FORWARD " 7 0001\n"); /* no points at the end; a name that is a number */
    path = load(*state, NULL);
    assert_pose(&path, 0, 0, away, forward);
    tides_trajectory_destroy(path.trajectory);
}

static void colmap_refused(void **state) {
    static const struct {
        const char *cameras, *images;
        tides_status status;
        const char *words;
    } cases[] = {
        {NULL, "1 " LEVEL " 3 a\n\n", TIDES_FILE_NOT_FOUND, "images.txt: needs COLMAP's cameras.bin or cameras.txt beside it"},
        {"# none\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "cameras.txt: holds no camera"},
        {"3 PINHOLE 10 8 5 6 7 8\n", "1 " LEVEL " 4 a\n\n", TIDES_BAD_FILE, "images.txt: line 1: camera 4 isn't among the 1"},
        {"3 PINHOLE 10 8 5 6 7 8\n", "1 " LEVEL " 3 a\n\n\n2 " LEVEL " x a\n", TIDES_BAD_FILE,
         "images.txt:4: an image is ID QW"},
        {"3 PINHOLE 10 8 5 6 7 8\n", "1 2 0 0 0 0 0 0 3 a\n\n", TIDES_BAD_FILE,
         "line 1: the quaternion's length is 2|QW QX QY QZ"},
        {"3 PINHOLE 10 8 5 6 7 8\n", "1 1 0 0 0 nan 0 0 3 a\n", TIDES_BAD_FILE, "images.txt"},
        {"3 PINHOLE 10 8 5 6 7\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "cameras.txt:1: PINHOLE needs exactly 4 numbers"},
        {"3 PINHOLE 10 8 5 6 7 8 9\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "cameras.txt:1: PINHOLE needs exactly 4 numbers"},
        {"3 PINHOLES 10 8 5 6 7 8\n", "1 " LEVEL " 3 a\n\n", TIDES_UNSUPPORTED,
         "cameras.txt:1: unknown camera model \"PINHOLES\"; TIDES reads COLMAP's models SIMPLE_PINHOLE to THIN_PRISM_FISHEYE"},
        {"# c\n3.5 PINHOLE 10 8 5 6 7 8\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "cameras.txt:2: a camera is ID MODEL"},
        {"3 PINHOLE 0 8 5 6 7 8\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "camera 3: 0 x 8 pixels"},
        {"3 PINHOLE 10 1e10 5 6 7 8\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "camera 3: 10 x 1e+10 pixels|to 2147483647"},
        {"3 PINHOLE 10 8 5 -6 7 8\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "parameter 2 of its model PINHOLE is -6|above 0"},
        {"3 PINHOLE 10 8 5 6 inf 8\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "parameter 3 of its model PINHOLE is inf"},
        {"3 FOV 10 8 5 6 7 8 3.2\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "parameter 5 of its model FOV is 3.2|radians"},
        {"3 PINHOLE 1 1 1 1 1 1\n3 PINHOLE 1 1 1 1 1 1\n", "1 " LEVEL " 3 a\n\n", TIDES_BAD_FILE, "two cameras have the id 3"},
    };
    char file[4200];
    snprintf(file, sizeof file, "%s", scene_in_folder(*state, "images.txt"));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (cases[i].cameras) write_text(scene_in_folder(*state, "cameras.txt"), cases[i].cameras);
        write_text(file, cases[i].images);
        expect_refused(file, cases[i].status, cases[i].words);
    }
    const char *cameras = scene_in_folder(*state, "cameras.txt");
    write_text(cameras, "3 PINHOLE 10 8 5 6 7 8\n4 PINHOLE 10 8 5 6 7 8\n");
    expect_refused(cameras, TIDES_BAD_FILE, "holds 2 cameras (10x8 px, fx 5) but no poses|images.txt");
}

static void add_double(scene_bytes *b, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    splat_u64(b, bits);
}

static scene_bytes binary_cameras(void) {
    scene_bytes b = {0};
    splat_u64(&b, 1);
    splat_u32(&b, 9);
    splat_u32(&b, 2); /* SIMPLE_RADIAL */
    splat_u64(&b, 640);
    splat_u64(&b, 480);
    static const double p[] = {500, 320, 240, 0.01};
    for (int k = 0; k < 4; k++) add_double(&b, p[k]);
    return b;
}

static scene_bytes binary_images(void) {
    static const double poses[2][7] = {{0.5, 0.5, -0.5, 0.5, 2, 3, -1}, {1, 0, 0, 0, 0, 0, 0}};
    scene_bytes b = {0};
    splat_u64(&b, 2);
    for (unsigned i = 0; i < 2; i++) {
        splat_u32(&b, i + 1);
        for (int k = 0; k < 7; k++) add_double(&b, poses[i][k]);
        splat_u32(&b, 9);
        scene_bytes_add(&b, i ? "a" : "b", 2);
        splat_u64(&b, i);
        splat_zeros(&b, 24 * i);
    }
    return b;
}

static void colmap_binary(void **state) {
    scene_bytes cameras = binary_cameras(), images = binary_images();
    char file[4200], beside[4200];
    snprintf(file, sizeof file, "%s", scene_in_folder(*state, "images.bin"));
    snprintf(beside, sizeof beside, "%s", scene_in_folder(*state, "cameras.bin"));
    scene_file_write(beside, cameras.data, cameras.size);
    scene_file_write(file, images.data, images.size);
    tides_path path = load(*state, NULL);
    assert_pose(&path, 0, 0, origin, level);
    assert_pose(&path, 1, 1, away, forward);
    assert_intrinsics(&path, (const double[6]){640, 480, 500, 500, 320, 240});
    assert_int_equal(path.intrinsics.lens.model, TIDES_LENS_RADTAN);
    assert_true(path.intrinsics.lens.k1 == 0.01);
    tides_trajectory_destroy(path.trajectory);
    enum { IMAGE = 4 + 56 + 4 + 2 + 8 }; /* bytes of the first image, which has no points */
    for (size_t size = 1; size < images.size; size++) {
        const char *place = size < 8           ? "images.bin: ends within the number"
                            : size < 8 + IMAGE ? "images.bin: ends within image 1 of 2"
                                               : "images.bin: ends within image 2 of 2";
        scene_file_write(file, images.data, size);
        expect_refused(file, TIDES_BAD_FILE, place);
    }
    static const size_t lies[] = {0, 4, 8 + 4 + 56 + 4 + 2}; /* counts of images and of points */
    for (size_t k = 0; k < 3; k++) {
        scene_bytes lie = binary_images();
        splat_patch(&lie, lies[k], 0x7fffffff);
        scene_file_write(file, lie.data, lie.size);
        expect_refused(file, TIDES_BAD_FILE, "images.bin: ends within image");
        free(lie.data);
    }
    scene_file_write(file, images.data, images.size);
    for (size_t size = 1; size < cameras.size; size++) {
        const char *place = size < 8 ? "cameras.bin: ends within the number" : "cameras.bin: ends within camera 1 of 1";
        scene_file_write(beside, cameras.data, size);
        expect_refused(file, TIDES_BAD_FILE, place);
        expect_refused(beside, TIDES_BAD_FILE, place);
    }
    splat_patch(&cameras, 12, 11);
    scene_file_write(beside, cameras.data, cameras.size);
    expect_refused(file, TIDES_UNSUPPORTED, "camera 9 (number 1 of 1) has the unknown model 11; TIDES reads models 0 to 10");
    splat_patch(&images, 8 + 4, 0);
    splat_patch(&images, 8 + 8, 0x7ff80000); /* a NaN */
    splat_patch(&cameras, 12, 2);
    scene_file_write(beside, cameras.data, cameras.size);
    scene_file_write(file, images.data, images.size);
    expect_refused(file, TIDES_BAD_FILE, "images[0]: the pose has a number that isn't finite");
    free(images.data);
    free(cameras.data);
}

/* -- EuRoC -- */

static const char euroc[] = "#timestamp, p_RS_R_x [m], q_RS_w []\n"
                            "1403636580000000000,1,2,3,1,0,0,0,0,0,0,0,0,0,0,0,0\n"
                            "1403636580250000001, 1, 2 ,3,0.5,-0.5,0.5,-0.5,9,9,9,9,9,9,9,9,9\r\n";
/* The camera sits at (0, 0, 1) of the body and looks along the body's x. */
static const char sensor[] = "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0.0, 0.0, 1.0, 0.0,\n"
                             "   -1, 0, 0, 0,\n   0, -1, 0, 1.0,\n  0, 0, 0, 1]\nresolution: [752, 480]\n"
                             "intrinsics: [458.5, 457.25, 367.5, 248] #fu, fv, cu, cv\n";

static void euroc_paths(void **state) {
    char file[4200];
    snprintf(file, sizeof file, "%s", scene_in_folder(*state, "gt.csv"));
    write_text(file, euroc);
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.rebase = 1;
    tides_path path = load(file, &options);
    assert_string_equal(path.format, "euroc");
    assert_pose(&path, 0, 0, away, level);
    assert_pose(&path, 1, 0.250000001, away, forward);
    assert_int_equal(path.intrinsics.width, 0);
    tides_trajectory_destroy(path.trajectory);
    write_text(scene_in_folder(*state, "sensor.yaml"), sensor);
    path = load(file, &options);
    const double above[3] = {1, 2, 4};
    assert_pose(&path, 0, 0, above, forward);
    /* forward twice: x' = z = -y ... */
    const double ahead[3] = {2, 2, 3}, twice[9] = {0, -1, 0, 0, 0, -1, 1, 0, 0};
    assert_pose(&path, 1, 0.250000001, ahead, twice);
    assert_intrinsics(&path, (const double[6]){752, 480, 458.5, 457.25, 368, 248.5});
    assert_int_equal(path.distorted, 0);
    tides_trajectory_destroy(path.trajectory);
    write_text(scene_in_folder(*state, "sensor.yaml"), /* as PyYAML dumps it */
               "\xEF\xBB\xBFT_BS:\n  cols: 4\n  data:\n  - 0.0\n  - 0.0\n  - 1.0\n  - 0.0\n  - -1\n  - 0\n  - 0\n  - 0\n"
               "  - 0\n  - -1\n  - 0\n  - 1.0\n  - 0\n  - 0\n  - 0\n  - 1\n  rows: 4\nresolution:\n- 752\n- 480\n"
               "intrinsics:\n- 458.5\n- 457.25\n- 367.5\n- 248\n");
    path = load(file, &options);
    assert_pose(&path, 1, 0.250000001, ahead, twice);
    assert_intrinsics(&path, (const double[6]){752, 480, 458.5, 457.25, 368, 248.5});
    assert_int_equal(path.has_imu, 1); /* at the body's origin: in the camera's axes (0, 1, 0) below it */
    const double place[16] = {0, -1, 0, 0, 0, 0, -1, 1, 1, 0, 0, 0, 0, 0, 0, 1};
    for (int k = 0; k < 16; k++) assert_true(fabs(path.T_C_I[k] - place[k]) < 1e-15);
    tides_trajectory_destroy(path.trajectory);
    options.body = 1;
    path = load(file, &options);
    assert_pose(&path, 1, 0.250000001, away, forward);
    assert_int_equal(path.has_imu, 0);
    tides_trajectory_destroy(path.trajectory);
    static const struct {
        const char *sensor, *words;
    } cases[] = {
        {"T_BX: [1]\n", "sensor.yaml: needs T_BS"},
        {"T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0]\n", "sensor.yaml: needs T_BS"},
        {"T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]\n", "sensor.yaml: T_BS|isn't a rotation"},
        {"T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, nan, 0, 0, 0, 1]\n", "sensor.yaml: needs T_BS"},
        {"T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [0, 1]\nintrinsics: [1, 1, 1, 1]\n",
         "sensor.yaml: resolution and intrinsics"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_text(scene_in_folder(*state, "sensor.yaml"), cases[i].sensor);
        expect_refused(file, TIDES_BAD_FILE, cases[i].words);
    }
    remove(scene_in_folder(*state, "sensor.yaml"));
    write_text(file, "#q_RS_w\n1,2,3,4,1,0,0,0\n2,2,3,4,2,0,0,0\n");
    expect_refused(file, TIDES_BAD_FILE, "gt.csv:3: the quaternion's length is 2|qw qx qy qz");
    write_text(file, "#q_RS_w\n1,2,x,4,1,0,0,0\n");
    expect_refused(file, TIDES_BAD_FILE, "gt.csv:2: column 3 (y) must be a finite number");
    write_text(file, "#q_RS_w\n1,2,3,4,1,0,0\n");
    expect_refused(file, TIDES_BAD_FILE, "gt.csv:2: fewer than the 8 columns");
    write_text(file, "#q_RS_w\n2000000,2,3,4,1,0,0,0\n1000000,2,3,4,1,0,0,0\n");
    expect_refused(file, TIDES_BAD_FILE, "gt.csv:3: its time");
}

/* -- KITTI -- */

static void kitti(void **state) {
    const char *file = scene_in_folder(*state, "00.txt");
    write_text(file, "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 1 -1 0 0 2 0 -1 0 3\n");
    tides_path path = load(file, NULL);
    assert_string_equal(path.format, "kitti");
    assert_pose(&path, 0, 0, origin, level);
    assert_pose(&path, 1, 1, away, forward);
    tides_trajectory_destroy(path.trajectory);
    write_text(file, "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 1 -1 0 0 2 0 -1 0\n");
    expect_refused(file, TIDES_BAD_FILE, "00.txt:2: a KITTI pose is 12 finite numbers");
    write_text(file, "1 0 0 0 0 1 0 0 0 0 2 0\n");
    expect_refused(file, TIDES_BAD_FILE, "00.txt: line 1.pose: isn't a rotation");
}

/* -- LLFF -- */

static scene_bytes npy(const char *shape, size_t values, const double *v) {
    char header[118];
    int length = snprintf(header, sizeof header, "{'descr': '<f8', 'fortran_order': False, 'shape': (%s), }", shape);
    memset(header + length, ' ', sizeof header - (size_t)length);
    header[sizeof header - 1] = '\n';
    scene_bytes b = {0};
    scene_bytes_add(&b, "\x93NUMPY\1\0\x76\0", 10);
    scene_bytes_add(&b, header, sizeof header);
    for (size_t i = 0; i < values; i++) add_double(&b, v[i]);
    return b;
}

static void llff(void **state) {
    /* down, right, back, centre, h w f: `level` and `forward` */
    double v[34] = {0, 1, 0,  0, 480, 1, 0,  0, 0, 640, 0,  0, -1, 0, 500.5, 0.1, 9,
                    0, 0, -1, 1, 480, 0, -1, 0, 2, 640, -1, 0, 0,  3, 500.5, 0.1, 9};
    const char *file = scene_in_folder(*state, "poses.npy");
    scene_bytes b = npy("2, 17", 34, v);
    scene_file_write(file, b.data, b.size);
    tides_path path = load(file, NULL);
    assert_string_equal(path.format, "llff");
    assert_pose(&path, 0, 0, origin, level);
    assert_pose(&path, 1, 1, away, forward);
    assert_intrinsics(&path, (const double[6]){640, 480, 500.5, 500.5, 320, 240});
    tides_trajectory_destroy(path.trajectory);
    for (size_t size = 6; size < b.size; size++) {
        scene_file_write(file, b.data, size);
        expect_refused(file, TIDES_BAD_FILE, "poses.npy");
    }
    free(b.data);
    static const struct {
        size_t at;
        double value;
        const char *shape, *words;
    } cases[] = {{0, 0, "17, 2", "must have the shape [n, 17]"},
                 {0, 0, "34,", "must have the shape [n, 17]"},
                 {18, NAN, "2, 17", "poses[1]: must be finite"},
                 {21, 0, "2, 17", "poses[1]: height, width and focal length"},
                 {31, -1, "2, 17", "poses[1]: height, width and focal length"},
                 {1, 2, "2, 17", "poses[0].pose: isn't a rotation"},
                 {0, 0, "0, 17", "holds no poses"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double before = v[cases[i].at];
        v[cases[i].at] = cases[i].value;
        b = npy(cases[i].shape, cases[i].shape[0] == '0' ? 0 : 34, v);
        scene_file_write(file, b.data, b.size);
        expect_refused(file, TIDES_BAD_FILE, cases[i].words);
        v[cases[i].at] = before;
        free(b.data);
    }
}

/* -- nerfies -- */

#define REST "\"focal_length\": 500, \"principal_point\": [320, 240], \"pixel_aspect_ratio\": 1.1, \"image_size\": [640, 480]"

static void nerfies(void **state) {
    static const char first[] = "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [0, 0, 0], " REST "}";
    static const char second[] =
        "{\"orientation\": [[0,-1,0],[0,0,-1],[1,0,0]], \"position\": [1, 2, 3], \"skew\": 0.1, " REST "}";
    write_text(scene_in_folder(*state, "b.json"), first);
    write_text(scene_in_folder(*state, "a.json"), second);
    tides_path path = load(*state, NULL);
    assert_string_equal(path.format, "nerfies");
    assert_pose(&path, 0, 0, away, forward);
    assert_pose(&path, 1, 1, origin, level);
    assert_intrinsics(&path, (const double[6]){640, 480, 500, 500 * 1.1, 320, 240});
    assert_int_equal(path.distorted, 1);
    tides_trajectory_destroy(path.trajectory);
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.duration = 10;
    write_text(scene_in_folder(*state, "scene.json"), "{\"scale\": 2, \"center\": [0, 0, 1]}");
    write_text(scene_in_folder(*state, "metadata.json"),
               "{\"a\": {\"warp_id\": 3}, \"b\": {\"time_id\": 1}, \"c\": {\"warp_id\": 4}}");
    const double moved[3] = {2, 4, 4}, below[3] = {0, 0, -2};
    path = load(*state, &options);
    assert_pose(&path, 0, 2.5, below, level);
    assert_pose(&path, 1, 7.5, moved, forward);
    tides_trajectory_destroy(path.trajectory);
    options.raw_positions = 1;
    path = load(*state, &options);
    assert_pose(&path, 1, 7.5, away, forward);
    tides_trajectory_destroy(path.trajectory);
    path = load(scene_in_folder(*state, "a.json"), NULL);
    assert_int_equal(tides_trajectory_is_static(path.trajectory), 1);
    assert_pose(&path, 0, 0, moved, forward);
    tides_trajectory_destroy(path.trajectory);
}

static void nerfies_refused(void **state) {
    static const char good[] = "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [0, 0, 0], " REST "}";
    static const struct {
        const char *name, *text, *words;
    } cases[] = {
        {"a.json", "{\"orientation\": 1}", "a.json: orientation: must be a matrix"},
        {"a.json", "{\"orientation\": [[2,0,0],[0,1,0],[0,0,1]]}", "a.json|isn't a rotation"},
        {"a.json", "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]]}", "a.json: position: is missing"},
        {"a.json",
         "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [0,0,0], \"image_size\": [2.5, 1],"
         "\"principal_point\": [0,0], \"focal_length\": 1}",
         "a.json: image_size: must be two whole numbers"},
        {"a.json",
         "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [0,0,0], \"image_size\": [2, 1],"
         "\"principal_point\": [0,0], \"focal_length\": -1}",
         "a.json: focal_length, pixel_aspect_ratio: must be above 0"},
        {"a.json", "{", "a.json:1|isn't valid JSON"},
        {"scene.json", "{\"scale\": 0, \"center\": [0,0,0]}", "scene.json: scale: must be above 0"},
        {"scene.json", "{\"scale\": 1}", "scene.json: center: is missing"},
        {"scene.json", "[", "scene.json:1|isn't valid JSON"},
        {"metadata.json", "{\"a\": {\"warp_id\": 1}}", "metadata.json has a warp_id for 1 of 2 cameras"},
        {"metadata.json", "{\"a\": {\"warp_id\": 1}, \"b\": {\"warp_id\": 1}}",
         "cameras[1]: its time, 1 s, is also that of entry 0"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_text(scene_in_folder(*state, "a.json"), good);
        write_text(scene_in_folder(*state, "b.json"), good);
        write_text(scene_in_folder(*state, cases[i].name), cases[i].text);
        expect_refused(*state, TIDES_BAD_FILE, cases[i].words);
        remove(scene_in_folder(*state, cases[i].name));
    }
}

/* -- folders and others -- */

static void folders(void **state) {
    char inside[4200];
    expect_refused(*state, TIDES_FILE_NOT_FOUND, "no camera path is in this folder|images.bin|poses_bounds.npy");
    snprintf(inside, sizeof inside, "%s", scene_in_folder(*state, "transforms.json"));
    write_text(inside, "{\"k1\": 0, \"frames\": [{\"transform_matrix\": [[1,0,0,1],[0,-1,0,2],[0,0,-1,3]], \"p2\": 0.5}]}");
    tides_path path = load(*state, NULL);
    assert_string_equal(path.format, "transforms");
    assert_pose(&path, 0, 0, away, level);
    assert_int_equal(path.distorted, 0);
    assert_true(path.intrinsics.lens.p2 == 0.5);
    tides_trajectory_destroy(path.trajectory);
    remove(inside);
    char deep[4200];
    snprintf(deep, sizeof deep, "%s", scene_in_folder(*state, "camera"));
    assert_int_equal(mkdir(deep, 0700), 0);
    snprintf(inside, sizeof inside, "%s", scene_in_folder(*state, "camera/x.json"));
    write_text(inside, "{\"orientation\": [[1,0,0],[0,1,0],[0,0,1]], \"position\": [0, 0, 0], " REST "}");
    write_text(scene_in_folder(*state, "scene.json"), "{\"scale\": 1, \"center\": [-1, -2, -3]}");
    path = load(*state, NULL);
    assert_pose(&path, 0, 0, away, level);
    tides_trajectory_destroy(path.trajectory);
    remove(inside);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_FOLDER(colmap_text), IN_FOLDER(colmap_refused), IN_FOLDER(colmap_binary),   IN_FOLDER(euroc_paths), IN_FOLDER(kitti),
        IN_FOLDER(llff),        IN_FOLDER(nerfies),        IN_FOLDER(nerfies_refused), IN_FOLDER(folders),
    };
    return cmocka_run_group_tests_name("path_datasets", tests, NULL, NULL);
}
