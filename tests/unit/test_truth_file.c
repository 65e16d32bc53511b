/* Ground truth from files: values of DSEC's and TUM's pictures and BlinkFlow's arrays, planes by name, NaN where unknown; other
 * files are refused in a line. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_npy.h"
#include "tests/support/scene_folder.h"
#include "tides/truth.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { WIDTH = 3, HEIGHT = 2, PIXELS = WIDTH * HEIGHT };

static void write_png(const char *path, int planes, int bits, const uint16_t *values) {
    tides_error error = {0, ""};
    scene_expect_ok(tides_png_write_values(path, WIDTH, HEIGHT, planes, bits, values, &error), &error);
}

static void write_npy(const char *path, const char *dtype, size_t item, int ndim, const size_t *inner, const void *rows) {
    td_npy_writer *npy = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(td_npy_writer_open(path, 0, &npy, &error), &error);
    const tides_status status = td_npy_writer_put(npy, &(td_npy_form){"data", dtype, item, ndim, inner}, rows, HEIGHT, &error);
    scene_expect_ok(td_npy_writer_end(npy, status, &error), &error);
}

/* Reads `path`, which has `count` planes of these names and values; NaN is NaN. */
static void expect_planes(const char *path, int count, const char *const *names, const float *values) {
    tides_exr *planes = NULL;
    tides_error error = {0, ""};
    int32_t width, height, channels;
    scene_expect_ok(tides_truth_read(path, &planes, &error), &error);
    tides_exr_size(planes, &width, &height, &channels);
    assert_true(width == WIDTH && height == HEIGHT && channels == count);
    for (int c = 0; c < count; c++) {
        assert_string_equal(tides_exr_name(planes, c), names[c]);
        for (int i = 0; i < PIXELS; i++) {
            const float found = tides_exr_pixels(planes, c)[i], wanted = values[c * PIXELS + i];
            if (!(isnan(wanted) ? isnan(found) : fabsf(found - wanted) <= 0))
                fail_msg("%s, pixel %d: %.9g, not %.9g", names[c], i, (double)found, (double)wanted);
        }
    }
    tides_exr_destroy(planes);
}

static const char *const moves[] = {"displacement_u", "displacement_v"};

static void pictures(void **state) {
    static const uint16_t flow[3 * PIXELS] = {32768, 32768, 1, 32896, 32512, 1, 0, 0, 0, 65535, 0, 1, 32769, 32767, 1, 5, 5, 0};
    static const float of_flow[2 * PIXELS] = {0, 1,  NAN, 32767 / 128.0f, 1 / 128.0f,  NAN, /* u */
                                              0, -2, NAN, -256,           -1 / 128.0f, NAN};
    static const uint16_t grey[PIXELS] = {0, 256, 5000, 65535, 1, 10000}, masks[PIXELS] = {0, 1, 2, 255, 0, 7};
    static const float depth[PIXELS] = {NAN, 256 / 5000.0f, 1, 65535 / 5000.0f, 1 / 5000.0f, 2},
                       disparity[PIXELS] = {NAN, 1, 5000 / 256.0f, 65535 / 256.0f, 1 / 256.0f, 10000 / 256.0f},
                       instance[PIXELS] = {0, 1, 2, 255, 0, 7};
    const char *const depth_name = "depth", *const disparity_name = "disparity", *const instance_name = "instance";
    const char *path = scene_in_folder(*state, "flow.png");
    write_png(path, 3, 16, flow);
    expect_planes(path, 2, moves, of_flow);
    path = scene_in_folder(*state, "depth.png");
    write_png(path, 1, 16, grey);
    expect_planes(path, 1, &depth_name, depth);
    assert_int_equal(mkdir(scene_in_folder(*state, "disparity"), 0700), 0);
    path = scene_in_folder(*state, "disparity/0.png");
    write_png(path, 1, 16, grey);
    expect_planes(path, 1, &disparity_name, disparity);
    remove(path);
    remove(scene_in_folder(*state, "disparity"));
    path = scene_in_folder(*state, "mask.png");
    write_png(path, 1, 8, masks);
    expect_planes(path, 1, &instance_name, instance);
}

static void arrays(void **state) {
    static const float flow[3 * PIXELS] = {1, 2, 1, 3, 4, 1, 5, 6, 0, 7, 8, 1, 9, 10, 1, 11, 12, 0};
    static const float known[2 * PIXELS] = {1, 3, NAN, 7, 9, NAN, 2, 4, NAN, 8, 10, NAN};
    static const float all[2 * PIXELS] = {1, 1, 4, 5, 0, 8, 2, 3, 1, 6, 7, 1}; /* the first twelve numbers as pairs */
    static const double depth[PIXELS] = {0.5, 1, 1.5, 2, 2.5, 3};
    static const float of_depth[PIXELS] = {0.5, 1, 1.5, 2, 2.5, 3}, of_mask[PIXELS] = {-1, 0, 1, 2, 3, 4};
    static const int32_t mask[PIXELS] = {-1, 0, 1, 2, 3, 4};
    const char *const depth_name = "depth", *const instance_name = "instance";
    const char *path = scene_in_folder(*state, "a.npy");
    write_npy(path, "'<f4'", 4, 3, (const size_t[]){WIDTH, 3}, flow);
    expect_planes(path, 2, moves, known);
    write_npy(path, "'<f4'", 4, 3, (const size_t[]){WIDTH, 2}, flow);
    expect_planes(path, 2, moves, all);
    write_npy(path, "'<f8'", 8, 2, (const size_t[]){WIDTH}, depth);
    expect_planes(path, 1, &depth_name, of_depth);
    write_npy(path, "'<i4'", 4, 2, (const size_t[]){WIDTH}, mask);
    expect_planes(path, 1, &instance_name, of_mask);
}

static void refused(void **state) {
    static const uint16_t colour[3 * PIXELS] = {0};
    static const float one[2 * PIXELS] = {0};
    tides_exr *planes = NULL;
    tides_error error = {0, ""};
    const char *path = scene_in_folder(*state, "a.png");
    write_png(path, 3, 8, colour);
    scene_expect_error(tides_truth_read(path, &planes, &error), TIDES_UNSUPPORTED, &error, "isn't ground truth");
    path = scene_in_folder(*state, "a.npy");
    write_npy(path, "'<f4'", 4, 1, NULL, one);
    scene_expect_error(tides_truth_read(path, &planes, &error), TIDES_UNSUPPORTED, &error, "(height, width)");
    write_npy(path, "[('t', '<i8'), ('x', '<i2')]", 10, 2, (const size_t[]){1}, one);
    scene_expect_error(tides_truth_read(path, &planes, &error), TIDES_UNSUPPORTED, &error, "(height, width)");
    scene_expect_error(tides_truth_read("a.txt", &planes, &error), TIDES_UNSUPPORTED, &error, ".exr, .png and .npy");
    scene_expect_error(tides_truth_read("gone.png", &planes, &error), TIDES_FILE_NOT_FOUND, &error, "gone.png");
    scene_expect_error(tides_truth_read(NULL, &planes, &error), TIDES_BAD_ARGUMENT, &error, "path");
    assert_null(planes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(pictures, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(arrays, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(refused, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
