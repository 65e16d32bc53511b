/* Reader of SpacetimeGaussians: rgbfunction in cfg_args chooses the full model's last function, and is ignored for lite models.
 * Files are made here byte by byte. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_pyrepr.h"
#include "motion/td_motion.h"
#include "scene/td_method_arrays.h"
#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST = 6 * 12, SECOND = 3 * 6 };

static void add_properties(char *head, size_t size, const char *name, int count) {
    for (int i = 0; i < count; i++) {
        size_t used = strlen(head);
        snprintf(head + used, size - used, count > 1 ? "property float %s_%d\n" : "property float %s\n", name, i);
    }
}

/* Two Gaussians; of nine features where `full`. Value k of either is k / 64, but number `broken` is NaN (-1: none). */
static void write_points(const char *path, int full, int broken) {
    char head[4096] = "ply\nformat binary_little_endian 1.0\nelement vertex 2\n";
    static const char *const single[] = {"x", "y", "z", "opacity", "trbf_center", "trbf_scale"};
    for (size_t i = 0; i < sizeof single / sizeof *single; i++) add_properties(head, sizeof head, single[i], 1);
    int columns = 6 + 3 + 4 + 9 + 4 + (full ? 9 : 3);
    add_properties(head, sizeof head, "scale", 3);
    add_properties(head, sizeof head, "rot", 4);
    add_properties(head, sizeof head, "motion", 9);
    add_properties(head, sizeof head, "omega", 4);
    add_properties(head, sizeof head, "f_dc", full ? 6 : 3);
    if (full) add_properties(head, sizeof head, "f_t", 3);
    scene_bytes file = {0};
    scene_bytes_add(&file, head, strlen(head));
    PICKLE(&file, "end_header\n");
    for (int i = 0; i < 2 * columns; i++) {
        float value = i == broken ? (float)NAN : (float)(i % columns + 1) / 64;
        scene_bytes_add(&file, &value, sizeof value);
    }
    scene_file_write(path, file.data, file.size);
    free(file.data);
}

static void write_decoder(const char *path) {
    static const int32_t first[4] = {6, 12, 1, 1}, first_stride[4] = {12, 1, 1, 1};
    static const int32_t second[4] = {3, 6, 1, 1}, second_stride[4] = {6, 1, 1, 1};
    float a[FIRST], b[SECOND];
    for (int i = 0; i < FIRST; i++) a[i] = (float)i;
    for (int i = 0; i < SECOND; i++) b[i] = (float)-i;
    scene_bytes pickle = {0};
    PICKLE(&pickle, "\x80\x02"
                    "ccollections\nOrderedDict\n)R(");
    pickle_text(&pickle, "mlp1.weight");
    pickle_tensor(&pickle, "FloatStorage", "0", FIRST, 0, 4, first, first_stride);
    pickle_text(&pickle, "mlp2.weight");
    pickle_tensor(&pickle, "FloatStorage", "1", SECOND, 0, 4, second, second_stride);
    PICKLE(&pickle, "u.");
    const pickle_storage_bytes storages[2] = {{a, sizeof a}, {b, sizeof b}};
    scene_bytes archive = pickle_archive(&pickle, storages, 2);
    scene_file_write(path, archive.data, archive.size);
    free(archive.data);
    free(pickle.data);
}

/* Opens what write_points made with `cfg` (nullable) beside it. */
static tides_status open_with(void *folder, int full, int broken, const char *cfg, tides_motion **motion, tides_error *error) {
    td_model_dir dir = {0};
    td_gaussians gaussians = {0};
    dir.method = TD_METHOD_STG;
    dir.folder = td_strdup(folder, NULL);
    dir.points = td_strdup(scene_in_folder(folder, "point_cloud.ply"), NULL);
    dir.weights = full ? td_strdup(scene_in_folder(folder, "point_cloud.pt"), NULL) : NULL;
    write_points(dir.points, full, broken);
    if (full) write_decoder(dir.weights);
    if (cfg) scene_expect_ok(td_pyrepr_parse("cfg_args", cfg, strlen(cfg), &dir.cfg, error), error);
    tides_status status = td_stg_open(&dir, &gaussians, motion, error);
    if (status == TIDES_OK) assert_int_equal(gaussians.count, 2);
    td_gaussians_free(&gaussians);
    td_model_dir_free(&dir);
    return status;
}

static void expect_decoder(void *folder, int full, const char *cfg, int decoder) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    scene_expect_ok(open_with(folder, full, -1, cfg, &motion, &error), &error);
    assert_int_equal(td_motion_setting(motion, "decoder", 0), decoder);
    if (full) {
        const td_field *first = td_motion_field(motion, "decoder_first"), *second = td_motion_field(motion, "decoder_second");
        assert_non_null(first);
        assert_non_null(second);
        for (int i = 0; i < FIRST; i++) assert_true(first->value[i] == (float)i);
        for (int i = 0; i < SECOND; i++) assert_true(second->value[i] == (float)-i);
    }
    tides_motion_destroy(motion);
}

static void test_rgbfunction(void **state) {
    expect_decoder(*state, 1, NULL, TIDES_DECODER_SIGMOID);
    expect_decoder(*state, 1, "Namespace(sh_degree=3)", TIDES_DECODER_SIGMOID);
    expect_decoder(*state, 1, "Namespace(rgbfunction='sandwich')", TIDES_DECODER_SIGMOID);
    expect_decoder(*state, 1, "Namespace(rgbfunction='sandwichnoact')", TIDES_DECODER_CLAMP);
    expect_decoder(*state, 1, "Namespace(sh_degree=3, rgbfunction='sandwichnoactss', model='ours_full')", TIDES_DECODER_PLAIN);
    expect_decoder(*state, 0, "Namespace(rgbfunction='rgbv1', model='ours_lite')", TIDES_DECODER_NONE);
}

static void test_unknown_rgbfunction(void **state) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    tides_status status = open_with(*state, 1, -1, "Namespace(rgbfunction='rgbv1')", &motion, &error);
    scene_expect_error(status, TIDES_UNSUPPORTED, &error, "point_cloud.ply|cfg_args|rgbfunction|'rgbv1'|sandwich");
    assert_null(motion);
}

/* A file's fault, whoever finds it. */
static void test_values_that_are_none(void **state) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    enum { MOTION_0 = 6 + 3 + 4, OMEGA_0 = MOTION_0 + 9 };
    tides_status status = open_with(*state, 0, MOTION_0, NULL, &motion, &error);
    scene_expect_error(status, TIDES_BAD_FILE, &error, "point_cloud.ply|must be finite");
    status = open_with(*state, 0, OMEGA_0, NULL, &motion, &error);
    scene_expect_error(status, TIDES_BAD_FILE, &error, "point_cloud.ply|must be finite");
    assert_null(motion);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_rgbfunction, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_unknown_rgbfunction, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_values_that_are_none, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
