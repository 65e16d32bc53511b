/* SpacetimeGaussians' parameters and rates over time against its own code: every folder of $TIDES_SHARED/golden/stg.
 * Values and rates to 1e-12 of the largest in double, 1e-5 in single precision. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/golden_motion.h"
#include "tests/support/golden_folder.h"

#include <stdlib.h>

typedef struct stg_file {
    const char *name;
    npz *archive;
    int count;
    float *mean, *scale, *quaternion, *opacity, *sh, *centre, *width, *coefficient, *omega, *f_dc, *f_t;
    int full;
} stg_file;

static stg_file file_open(const char *name, npz *archive) {
    size_t reals = 0;
    stg_file file = {.name = name, .archive = archive};
    file.mean = golden_floats(archive, "raw_xyz", &reals);
    file.count = (int)(reals / 3);
    file.scale = golden_floats(archive, "raw_scale", NULL);
    file.quaternion = golden_floats(archive, "raw_rotation", NULL);
    file.opacity = golden_floats(archive, "raw_opacity", NULL);
    file.sh = calloc(reals, sizeof *file.sh);
    file.centre = golden_floats(archive, "raw_trbf_center", NULL);
    file.width = golden_floats(archive, "raw_trbf_scale", NULL);
    file.coefficient = golden_floats(archive, "raw_motion", NULL);
    file.omega = golden_floats(archive, "raw_omega", NULL);
    file.f_t = golden_floats(archive, "raw_f_t", NULL);
    file.f_dc = golden_floats(archive, "raw_f_dc", &reals);
    file.full = (int)reals == 6 * file.count;
    assert_non_null(file.sh);
    return file;
}

static void file_free(stg_file *file) {
    float *const arrays[] = {file->mean,  file->scale,       file->quaternion, file->opacity, file->sh, file->centre,
                             file->width, file->coefficient, file->omega,      file->f_dc,    file->f_t};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    npz_close(file->archive);
}

/* Nine features and their rates. */
static void compare_features(const stg_file *file, int frame, int precision, const move_rows *rows) {
    double *value = golden_doubles(file->archive, "features", NULL), *dot = golden_doubles(file->archive, "features_dot", NULL);
    golden_part part = {file->name, "features", file->count, 9, 0, rows->sh_stride, golden_tolerance[precision], NULL};
    golden_compare(&part, rows->sh, value + frame * file->count * 9);
    part.name = "features_dot";
    golden_compare(&part, rows->sh_rates, dot + frame * file->count * 9);
    free(value);
    free(dot);
}

/* One array and its rate at time `frame` of the file. */
static void compare(const stg_file *file, const char *name, int width, int at, int frame, int precision,
                    const move_rows *rows) {
    char rate[64];
    snprintf(rate, sizeof rate, "%s_dot", name);
    double *value = golden_doubles(file->archive, name, NULL), *dot = golden_doubles(file->archive, rate, NULL);
    golden_part part = {file->name, name, file->count, width, at, TD_GEOMETRY_STRIDE, golden_tolerance[precision], NULL};
    golden_compare(&part, rows->geometry, value + frame * file->count * width);
    part.name = rate;
    golden_compare(&part, rows->rates, dot + frame * file->count * width);
    free(value);
    free(dot);
}

static void compare_factors(const stg_file *file, int frame, int precision, const move_rows *rows) {
    double *q = golden_doubles(file->archive, "quats_raw", NULL), *q_dot = golden_doubles(file->archive, "quats_raw_dot", NULL);
    double *factor = calloc((size_t)file->count * 18, sizeof *factor), *factor_dot = factor + 9 * file->count;
    int first = 4 * frame * file->count;
    assert_non_null(factor);
    golden_factors(q + first, q_dot + first, file->scale, file->count, factor, factor_dot);
    golden_part part = {file->name, "factor", file->count, 9, TD_G_FACTOR, TD_GEOMETRY_STRIDE, golden_tolerance[precision],
                        NULL};
    golden_compare(&part, rows->geometry, factor);
    part.name = "factor_dot";
    golden_compare(&part, rows->rates, factor_dot);
    free(q);
    free(q_dot);
    free(factor);
}

static void compare_file(stg_file *file) {
    size_t frames = 0;
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    double *t = golden_doubles(file->archive, "t", &frames);
    float weights[72] = {0}; /* of a decoder: not looked at here */
    tides_polynomial_motion arrays = {.count = file->count,
                                      .stop = 1,
                                      .opacity_centre = file->centre,
                                      .opacity_log_width = file->width,
                                      .mean_coefficient = file->coefficient,
                                      .quaternion_dot = file->omega};
    if (file->full) {
        arrays.decoder = TIDES_DECODER_SIGMOID;
        arrays.feature = file->f_dc, arrays.feature_dot = file->f_t;
        arrays.decoder_first = arrays.decoder_second = weights;
    }
    const tides_gaussians gaussians = {.count = file->count,
                                       .mean = file->mean,
                                       .log_scale = file->scale,
                                       .quaternion = file->quaternion,
                                       .opacity_logit = file->opacity,
                                       .sh = file->sh};
    if (tides_motion_create_polynomial(&arrays, &motion, &error) != TIDES_OK) fail_msg("%s", error.text);
    for (int i = 0; i < GOLDEN_PRECISIONS * (int)frames; i++) {
        int frame = i / GOLDEN_PRECISIONS, precision = i % GOLDEN_PRECISIONS;
        move_rows rows = golden_move(motion, &gaussians, t[frame], 1, precision);
        compare(file, "means", 3, TD_G_MEAN, frame, precision, &rows);
        compare(file, "means", 3, TD_G_ORIGIN, frame, precision, &rows);
        compare(file, "opacity", 1, TD_G_OPACITY, frame, precision, &rows);
        compare_factors(file, frame, precision, &rows);
        if (file->full) compare_features(file, frame, precision, &rows);
        golden_rows_free(&rows);
    }
    tides_motion_destroy(motion);
    free(t);
}

static int visit(void *user, const char *path, const char *name) {
    char golden[4096];
    (void)user;
    snprintf(golden, sizeof golden, "%s/golden.npz", path);
    npz *archive = npz_open(golden);
    assert_non_null(archive);
    stg_file file = file_open(name, archive);
    compare_file(&file);
    print_message("%s: %d Gaussians\n", name, file.count);
    file_free(&file);
    return 0;
}

static void test_files(void **state) {
    (void)state;
    golden_folder("golden/stg", "", visit, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
