/* The same poses in every camera format of $TIDES_SHARED/golden/cameras, against the matrices of golden_cameras.npz. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "tests/support/npz.h"
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
static void check_poses(const tides_path *path, const golden *g, int timed) {
    assert_int_equal(tides_trajectory_count(path->trajectory), g->count);
    for (size_t i = 0; i < g->count; i++) {
        double time = timed ? g->times[i] : (double)i / (double)(g->count - 1);
        const double *m = g->poses + 16 * i;
        tides_pose pose;
        tides_pose_sample sample;
        assert_int_equal(tides_trajectory_sample(path->trajectory, i, &sample, NULL), TIDES_OK);
        assert_near("time", sample.time, time, 1e-15);
        assert_int_equal(tides_trajectory_at(path->trajectory, sample.time, &pose, NULL), TIDES_OK);
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) assert_near("rotation", pose.rotation[3 * r + c], m[4 * r + c], TOLERANCE);
            assert_near("position", pose.position[r], m[4 * r + 3], TOLERANCE);
        }
    }
}

static void same_poses_in_every_format(void **state) {
    (void)state;
    const struct {
        const char *file, *format;
        int timed, sized;
    } files[] = {{"cameras.json", "cameras", 0, 1},
                 {"transforms_nerfstudio.json", "transforms", 1, 1},
                 {"transforms_dnerf.json", "transforms", 1, 0},
                 {"traj_tum.txt", "tum", 1, 0}};
    char name[1024];
    if (shared_path(name, sizeof name, "golden/cameras/golden_cameras.npz") != 0) skip();
    npz *archive = npz_open(name);
    assert_non_null(archive);
    golden g = {npz_doubles(archive, "c2w_opencv", NULL), NULL, npz_doubles(archive, "K", NULL), 0};
    g.times = npz_doubles(archive, "t", &g.count);
    assert_true(g.poses && g.times && g.k && g.count > 1);
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        char relative[128];
        tides_path path;
        tides_error error = {0, ""};
        snprintf(relative, sizeof relative, "golden/cameras/%s", files[f].file);
        assert_int_equal(shared_path(name, sizeof name, relative), 0);
        if (tides_path_load(name, NULL, &path, &error) != TIDES_OK) fail_msg("%s", error.text);
        print_message("    %s\n", files[f].file);
        assert_string_equal(path.format, files[f].format);
        check_poses(&path, &g, files[f].timed);
        const double expected[6] = {640.0, 480.0, g.k[0], g.k[4], g.k[2], g.k[5]};
        const double got[6] = {path.intrinsics.width, path.intrinsics.height, path.intrinsics.fx,
                               path.intrinsics.fy,    path.intrinsics.cx,     path.intrinsics.cy};
        for (int k = 0; k < 6; k++) assert_near("intrinsics", got[k], files[f].sized ? expected[k] : 0.0, 0.0);
        if (strstr(files[f].file, "dnerf")) assert_near("fx", 320.0 / tan(0.5 * path.field_of_view_x), g.k[0], 1e-9);
        tides_trajectory_destroy(path.trajectory);
    }
    free(g.poses);
    free(g.times);
    free(g.k);
    npz_close(archive);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(same_poses_in_every_format)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
