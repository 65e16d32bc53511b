/* Equal poses in every camera format of $TIDES_SHARED/golden/cameras, against the matrices of golden_cameras.npz. Every file of
 * that folder must be read. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "camera/td_colmap.h"
#include "tests/support/npz.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOLERANCE 1e-13 /* files and goldens are in double with all digits */

typedef struct golden {
    double *poses;     /* count matrices, camera to world, OpenCV axes */
    double *times, *k; /* count times [s]; 3x3 intrinsics */
    size_t count;
} golden;

static void assert_near(const char *what, double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) fail_msg("%s: got %.17g, expected %.17g", what, got, expected);
}

/* Poses at their times; where the file has none, at even times over [0, 1]. */
static void check_poses(const tides_path *path, const golden *g, int timed, double nearness) {
    assert_int_equal(tides_trajectory_count(path->trajectory), g->count);
    for (size_t i = 0; i < g->count; i++) {
        double time = timed ? g->times[i] : (double)i / fmax((double)g->count - 1, 1);
        const double *m = g->poses + 16 * i;
        tides_pose pose;
        tides_pose_sample sample;
        assert_int_equal(tides_trajectory_sample(path->trajectory, i, &sample, NULL), TIDES_OK);
        assert_near("time", sample.time, time, nearness);
        assert_int_equal(tides_trajectory_at(path->trajectory, sample.time, &pose, NULL), TIDES_OK);
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) assert_near("rotation", pose.rotation[3 * r + c], m[4 * r + c], TOLERANCE);
            assert_near("position", pose.position[r], m[4 * r + 3], TOLERANCE);
        }
    }
}

/* How a format says it: with times (0: spread over [0, 1]), with a size and intrinsics (2: one focal length, fx). */
typedef struct expectation {
    const char *file, *format;
    int timed, sized;
} expectation;

static const expectation expected[] = {{"cameras.json", "cameras", 0, 1},
                                       {"transforms_nerfstudio.json", "transforms", 1, 1},
                                       {"transforms_dnerf.json", "transforms", 1, 0},
                                       {"traj_tum.txt", "tum", 1, 0},
                                       {"traj_euroc.csv", "euroc", 1, 0},
                                       {"images.txt", "colmap", 0, 1},
                                       {"images.bin", "colmap", 0, 1},
                                       {"poses_bounds.npy", "llff", 0, 2}};

/* Read along with another file: COLMAP's cameras; or not at all: its points, and the answers. */
static const char *const companions[] = {"cameras.txt", "cameras.bin", "points3D.txt", "golden_cameras.npz"};

static golden open_golden(npz **archive) {
    char name[1024];
    if (shared_path(name, sizeof name, "golden/cameras/golden_cameras.npz") != 0) skip();
    *archive = npz_open(name);
    assert_non_null(*archive);
    golden g = {npz_doubles(*archive, "c2w_opencv", NULL), NULL, npz_doubles(*archive, "K", NULL), 0};
    g.times = npz_doubles(*archive, "t", &g.count);
    assert_true(g.poses && g.times && g.k);
    assert_true(g.count > 1);
    return g;
}

static void close_golden(golden *g, npz *archive) {
    free(g->poses);
    free(g->times);
    free(g->k);
    npz_close(archive);
}

static tides_path load(const char *name, const tides_path_options *options) {
    tides_path path;
    tides_error error = {0, ""};
    if (tides_path_load(name, options, &path, &error) != TIDES_OK) fail_msg("%s", error.text);
    return path;
}

static void check_intrinsics(const tides_path *path, const golden *g, int sized) {
    const double wanted[6] = {640.0, 480.0, g->k[0], sized == 2 ? g->k[0] : g->k[4], g->k[2], g->k[5]};
    const double got[6] = {path->intrinsics.width, path->intrinsics.height, path->intrinsics.fx,
                           path->intrinsics.fy,    path->intrinsics.cx,     path->intrinsics.cy};
    for (int k = 0; k < 6; k++) assert_near("intrinsics", got[k], sized ? wanted[k] : 0.0, 1e-12 * wanted[k]);
    assert_int_equal(path->distorted, 0);
}

/* EuRoC's stamps begin at 1403636580 s. The golden file's went through doubles, which near 1.4e18 ns are 256 apart. */
#define EUROC_NEARNESS 1.281e-7

static void check_file(const char *name, const expectation *e, const golden *g) {
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.rebase = strcmp(e->format, "euroc") == 0;
    tides_path path = load(name, &options);
    print_message("    %s\n", e->file);
    assert_string_equal(path.format, e->format);
    check_poses(&path, g, e->timed, options.rebase ? EUROC_NEARNESS : 1e-15);
    check_intrinsics(&path, g, e->sized);
    if (strstr(e->file, "dnerf")) assert_near("fx", 320.0 / tan(0.5 * path.field_of_view_x), g->k[0], 1e-9);
    tides_trajectory_destroy(path.trajectory);
}

/* One camera of nerfies' is at rest, at the pose that its number says. */
static void check_single(const char *name, const golden *g) {
    tides_path path = load(name, NULL);
    size_t index = strtoul(strrchr(name, '_') + 1, NULL, 10);
    assert_string_equal(path.format, "nerfies");
    assert_true(index < g->count);
    assert_true(tides_trajectory_is_static(path.trajectory));
    golden one = {g->poses + 16 * index, g->times, g->k, 1};
    check_poses(&path, &one, 0, 0);
    check_intrinsics(&path, g, 1);
    tides_trajectory_destroy(path.trajectory);
}

static int check_entry(void *user, const char *path, const char *name) {
    const golden *g = user;
    for (size_t k = 0; k < sizeof companions / sizeof *companions; k++)
        if (strcmp(name, companions[k]) == 0) return 0;
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        if (strcmp(name, expected[k].file) == 0) {
            check_file(path, &expected[k], g);
            return 0;
        }
    if (strncmp(name, "nerfies_", 8) != 0) fail_msg("%s: this test doesn't know what to expect of it", name);
    check_single(path, g);
    return 0;
}

static void same_poses_in_every_format(void **state) {
    (void)state;
    char folder[1024];
    npz *archive = NULL;
    golden g = open_golden(&archive);
    assert_int_equal(shared_path(folder, sizeof folder, "golden/cameras"), 0);
    assert_true(shared_scan(folder, "", check_entry, &g) > 15);
    close_golden(&g, archive);
}

/* The nerfies files together, in a folder of their own: as they are, and through a scene.json. */
static int copy_camera(void *folder, const char *path, const char *name) {
    size_t size;
    char *bytes = scene_file_read(path, &size);
    if (strncmp(name, "nerfies_", 8) == 0) scene_file_write(scene_in_folder(folder, name), bytes, size);
    free(bytes);
    return 0;
}

static void nerfies_folder(void **state) {
    char folder[1024];
    npz *archive = NULL;
    golden g = open_golden(&archive);
    assert_int_equal(shared_path(folder, sizeof folder, "golden/cameras"), 0);
    shared_scan(folder, ".json", copy_camera, *state);
    tides_path path = load(*state, NULL);
    assert_string_equal(path.format, "nerfies");
    check_poses(&path, &g, 0, 1e-15);
    check_intrinsics(&path, &g, 1);
    tides_trajectory_destroy(path.trajectory);
    const char scene[] = "{\"scale\": 0.5, \"center\": [1, -2, 4], \"near\": 0.1, \"far\": 2}";
    scene_file_write(scene_in_folder(*state, "scene.json"), scene, sizeof scene - 1);
    const double center[3] = {1, -2, 4};
    tides_path_options options;
    tides_path_options_defaults(&options);
    for (options.raw_positions = 1; options.raw_positions >= 0; options.raw_positions--) {
        path = load(*state, &options);
        check_poses(&path, &g, 0, 1e-15);
        tides_trajectory_destroy(path.trajectory);
        for (size_t i = 0; i < 3 * g.count; i++) {
            double *p = g.poses + 16 * (i / 3) + 4 * (i % 3) + 3;
            *p = (*p - center[i % 3]) * 0.5;
        }
    }
    close_golden(&g, archive);
}

/* COLMAP's files as a folder; a real cameras.bin against the same camera in cameras.json. */
static void colmap(void **state) {
    (void)state;
    char name[1024];
    npz *archive = NULL;
    golden g = open_golden(&archive);
    assert_int_equal(shared_path(name, sizeof name, "golden/cameras"), 0);
    tides_path path = load(name, NULL);
    assert_string_equal(path.format, "colmap");
    check_poses(&path, &g, 0, 1e-15);
    tides_trajectory_destroy(path.trajectory);
    close_golden(&g, archive);
    td_colmap_cameras cameras;
    tides_error error = {0, ""};
    char *bytes;
    size_t size;
    if (shared_path(name, sizeof name, "data/snowmiku/cameras.bin") != 0) skip();
    bytes = scene_file_read(name, &size);
    scene_expect_ok(td_colmap_parse_cameras(name, bytes, size, 1, &cameras, &error), &error);
    free(bytes);
    scene_expect_error(tides_path_load(name, NULL, &path, &error), TIDES_BAD_FILE, &error, "1 camera |no poses|images.bin");
    assert_int_equal(shared_path(name, sizeof name, "data/snowmiku/cameras.json"), 0);
    path = load(name, NULL);
    assert_int_equal(cameras.count, 1);
    assert_int_equal(cameras.list[0].intrinsics.width, path.intrinsics.width);
    assert_int_equal(cameras.list[0].intrinsics.height, path.intrinsics.height);
    assert_near("fx", cameras.list[0].intrinsics.fx, path.intrinsics.fx, 1e-6 * path.intrinsics.fx);
    assert_near("fy", cameras.list[0].intrinsics.fy, path.intrinsics.fy, 1e-6 * path.intrinsics.fy);
    tides_trajectory_destroy(path.trajectory);
    free(cameras.list);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_poses_in_every_format),
        cmocka_unit_test_setup_teardown(nerfies_folder, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(colmap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
