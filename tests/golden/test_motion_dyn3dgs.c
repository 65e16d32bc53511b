/* Dynamic3DGaussians' frames joined by Catmull and Rom's cubics against $TIDES_SHARED/golden/dyn3dgs, values
 * and rates per frame to 1e-12 of the largest in double, 1e-5 in single precision; the C2 spline goes through the frames. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/golden_motion.h"
#include "tests/support/shared.h"

#include <stdlib.h>

typedef struct frames_file {
    float *mean, *quaternion, *scale, *opacity, *sh;
    double *time;
    int frames, count;
} frames_file;

static frames_file file_read(const char *path) {
    size_t reals = 0;
    frames_file file = {0};
    npz *archive = npz_open(path);
    assert_non_null(archive);
    const npz_array *mean = npz_get(archive, "means3D");
    assert_true(mean);
    assert_true(mean->ndim == 3);
    file.frames = (int)mean->shape[0];
    file.count = (int)mean->shape[1];
    file.mean = golden_floats(archive, "means3D", NULL);
    file.quaternion = golden_floats(archive, "unnorm_rotations", NULL);
    file.scale = golden_floats(archive, "log_scales", &reals);
    file.opacity = golden_floats(archive, "logit_opacities", NULL);
    file.sh = calloc(reals, sizeof *file.sh);
    file.time = calloc((size_t)file.frames, sizeof *file.time);
    assert_true(file.sh && file.time);
    for (int i = 0; i < file.frames; i++) file.time[i] = i;
    npz_close(archive);
    return file;
}

static void file_free(frames_file *file) {
    free(file->mean);
    free(file->quaternion);
    free(file->scale);
    free(file->opacity);
    free(file->sh);
    free(file->time);
}

static tides_motion *motion_of(const frames_file *file, int catmull_rom) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    tides_keyframes_motion arrays = {.frames = file->frames, .count = file->count, .time = file->time};
    arrays.mean = file->mean;
    arrays.quaternion = file->quaternion;
    arrays.catmull_rom = catmull_rom;
    if (tides_motion_create_keyframes(&arrays, &motion, &error) != TIDES_OK) fail_msg("%s", error.text);
    return motion;
}

static tides_gaussians gaussians_of(const frames_file *file) {
    const tides_gaussians made = {.count = file->count,
                                  .mean = file->mean,
                                  .log_scale = file->scale,
                                  .quaternion = file->quaternion,
                                  .opacity_logit = file->opacity,
                                  .sh = file->sh};
    return made;
}

static void compare_golden(const frames_file *file, npz *golden) {
    size_t times = 0;
    double *s = golden_doubles(golden, "s", &times);
    double *means = golden_doubles(golden, "means", NULL), *means_dot = golden_doubles(golden, "means_dot", NULL);
    double *q = golden_doubles(golden, "quats", NULL), *q_dot = golden_doubles(golden, "quats_dot", NULL);
    double *factor = calloc((size_t)file->count * 18, sizeof *factor);
    assert_non_null(factor);
    tides_motion *motion = motion_of(file, 1);
    const tides_gaussians gaussians = gaussians_of(file);
    for (int i = 0; i < GOLDEN_PRECISIONS * (int)times; i++) {
        int at = i / GOLDEN_PRECISIONS * file->count;
        double tolerance = golden_tolerance[i % GOLDEN_PRECISIONS];
        move_rows rows = golden_move(motion, &gaussians, s[i / GOLDEN_PRECISIONS], 1, i % GOLDEN_PRECISIONS);
        const golden_part mean = {"dyn3dgs", "means", file->count, 3, TD_G_MEAN, TD_GEOMETRY_STRIDE, tolerance, NULL};
        const golden_part turn = {"dyn3dgs", "factor", file->count, 9, TD_G_FACTOR, TD_GEOMETRY_STRIDE, tolerance, NULL};
        golden_compare(&mean, rows.geometry, means + 3 * at);
        golden_compare(&mean, rows.rates, means_dot + 3 * at);
        golden_factors(q + 4 * at, q_dot + 4 * at, file->scale, file->count, factor, factor + 9 * file->count);
        golden_compare(&turn, rows.geometry, factor);
        golden_compare(&turn, rows.rates, factor + 9 * file->count);
        golden_rows_free(&rows);
    }
    tides_motion_destroy(motion);
    free(s), free(means), free(means_dot), free(q), free(q_dot), free(factor);
}

static void test_catmull_rom(void **state) {
    char path[4096];
    (void)state;
    if (shared_path(path, sizeof path, "golden/dyn3dgs/params.npz") != 0) {
        print_message("skipped: no %s\n", path);
        skip();
    }
    frames_file file = file_read(path);
    assert_int_equal(shared_path(path, sizeof path, "golden/dyn3dgs/golden_catmull_rom.npz"), 0);
    npz *golden = npz_open(path);
    assert_non_null(golden);
    compare_golden(&file, golden);
    npz_close(golden);
    file_free(&file);
}

/* Means at every frame; rates that go on across it. */
static void test_spline_meets_frames(void **state) {
    char path[4096];
    (void)state;
    if (shared_path(path, sizeof path, "golden/dyn3dgs/params.npz") != 0) {
        print_message("skipped: no %s\n", path);
        skip();
    }
    frames_file file = file_read(path);
    const tides_gaussians gaussians = gaussians_of(&file);
    tides_motion *motion = motion_of(&file, 0);
    for (int i = 0; i < file.frames; i++) {
        double *mean = calloc((size_t)file.count * 3, sizeof *mean), *rate = calloc((size_t)file.count * 3, sizeof *rate);
        move_rows rows = golden_move(motion, &gaussians, i, 1, GOLDEN_DOUBLE);
        move_rows before = golden_move(motion, &gaussians, i == 0 ? 0 : i - 1e-9, 1, GOLDEN_DOUBLE);
        assert_true(mean && rate);
        for (int k = 0; k < 3 * file.count; k++) {
            mean[k] = (double)file.mean[3 * i * file.count + k];
            rate[k] = rows.rates[k / 3 * TD_GEOMETRY_STRIDE + TD_G_MEAN + k % 3];
        }
        const golden_part exact = {"dyn3dgs", "means", file.count, 3, TD_G_MEAN, TD_GEOMETRY_STRIDE, 1e-12, NULL};
        const golden_part near = {"dyn3dgs", "rates", file.count, 3, TD_G_MEAN, TD_GEOMETRY_STRIDE, 1e-7, NULL};
        golden_compare(&exact, rows.geometry, mean);
        golden_compare(&near, before.rates, rate);
        golden_rows_free(&rows);
        golden_rows_free(&before);
        free(mean), free(rate);
    }
    tides_motion_destroy(motion);
    file_free(&file);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_catmull_rom), cmocka_unit_test(test_spline_meets_frames)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
