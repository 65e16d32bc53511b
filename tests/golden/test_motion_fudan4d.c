/* 4-D Gaussians' parameters, colours and rates over time against their own code: every folder of $TIDES_SHARED/golden/fudan4d.
 * Values and rates to 1e-12 of the largest in double, 1e-5 in single precision; opacities where their
 * renderer keeps the Gaussian, and 0 where it drops it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/golden_motion.h"
#include "tests/support/golden_folder.h"

#include "kernels/sh.h"

#include <math.h>
#include <stdlib.h>

enum { K = 16, ENTRIES = 3 * K };

typedef struct fudan_file {
    const char *name;
    npz *archive;
    int count, harmonics, tilts;
    float *mean, *scale, *left, *right, *opacity, *centre, *width, *sh, *harmonic;
    double *t, *duration, *eye;
    size_t frames;
} fudan_file;

/* Stored coefficient k of channel c of Gaussian i: the first in features_dc, the others in features_rest. */
static void read_sh(fudan_file *file) {
    size_t reals = 0;
    float *dc = golden_floats(file->archive, "raw_features_dc", NULL);
    float *rest = golden_floats(file->archive, "raw_features_rest", &reals);
    size_t stored = reals / 3 / (size_t)file->count;
    file->sh = calloc((size_t)file->count * ENTRIES, sizeof *file->sh);
    file->harmonic = calloc((size_t)(file->count * (file->harmonics + 1)) * ENTRIES, sizeof *file->harmonic);
    assert_true(file->sh && file->harmonic);
    assert_true(stored + 1 >= (size_t)(K * (file->harmonics + 1)));
    for (size_t i = 0; i < (size_t)file->count; i++) {
        float *own = file->sh + i * ENTRIES, *more = file->harmonic + i * (size_t)file->harmonics * ENTRIES;
        memcpy(own, dc + 3 * i, 3 * sizeof *own);
        memcpy(own + 3, rest + 3 * stored * i, (ENTRIES - 3) * sizeof *own);
        memcpy(more, rest + 3 * stored * i + ENTRIES - 3, (size_t)file->harmonics * ENTRIES * sizeof *more);
    }
    free(dc);
    free(rest);
}

static fudan_file file_open(const char *name, npz *archive) {
    size_t reals = 0;
    fudan_file file = {.name = name, .archive = archive};
    file.mean = golden_floats(archive, "raw_xyz", &reals);
    file.count = (int)(reals / 3);
    file.harmonics = (int)npz_int(archive, "sh_degree_t");
    file.tilts = npz_int(archive, "rot_4d") != 0;
    file.scale = golden_floats(archive, "raw_scaling", NULL);
    file.left = golden_floats(archive, "raw_rotation", NULL);
    file.right = golden_floats(archive, "raw_rotation_r", NULL);
    file.opacity = golden_floats(archive, "raw_opacity", NULL);
    file.centre = golden_floats(archive, "raw_t", NULL);
    file.width = golden_floats(archive, "raw_scaling_t", NULL);
    file.t = golden_doubles(archive, "t", &file.frames);
    file.duration = golden_doubles(archive, "time_duration", NULL);
    file.eye = golden_doubles(archive, "campos", NULL);
    read_sh(&file);
    return file;
}

static void file_free(fudan_file *file) {
    float *const arrays[] = {file->mean,   file->scale, file->left, file->right,   file->opacity,
                             file->centre, file->width, file->sh,   file->harmonic};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    free(file->t);
    free(file->duration);
    free(file->eye);
    npz_close(file->archive);
}

/* `value` and `rate` (count x width) against array `name` and its rate at one time of the file. */
static void compare(const fudan_file *file, const char *name, int frame, int precision, const unsigned char *keep,
                    const double *value, const double *rate, int width, int at, int stride) {
    char dot[64];
    snprintf(dot, sizeof dot, "%s_dot", name);
    double *expected = golden_doubles(file->archive, name, NULL), *expected_dot = golden_doubles(file->archive, dot, NULL);
    golden_part part = {file->name, name, file->count, width, at, stride, golden_tolerance[precision], keep};
    golden_compare(&part, value, expected + frame * file->count * width);
    part.name = dot;
    golden_compare(&part, rate, expected_dot + frame * file->count * width);
    free(expected);
    free(expected_dot);
}

static void compare_opacity(const fudan_file *file, int frame, int precision, const move_rows *rows) {
    double *marginal = golden_doubles(file->archive, "marginal_t", NULL);
    unsigned char *keep = calloc((size_t)file->count, 1);
    assert_non_null(keep);
    for (int i = 0; i < file->count; i++) {
        keep[i] = marginal[frame * file->count + i] > 0.05;
        const double *opacity = rows->geometry + i * TD_GEOMETRY_STRIDE + TD_G_OPACITY;
        if (!keep[i]) assert_true(*opacity == 0);
    }
    compare(file, "opacity", frame, precision, keep, rows->geometry, rows->rates, 1, TD_G_OPACITY, TD_GEOMETRY_STRIDE);
    free(keep);
    free(marginal);
}

/* M M^T; its rate is 0. */
static void compare_covariance(const fudan_file *file, int frame, int precision, const move_rows *rows) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    double *covariance = calloc((size_t)file->count * 6, sizeof *covariance);
    assert_non_null(covariance);
    for (int i = 0; i < file->count; i++) {
        const double *m = rows->geometry + i * TD_GEOMETRY_STRIDE + TD_G_FACTOR, *m_dot = rows->rates + i * TD_GEOMETRY_STRIDE;
        for (int k = 0; k < 6; k++)
            for (int j = 0; j < 3; j++) covariance[6 * i + k] += m[3 * row[k] + j] * m[3 * column[k] + j];
        for (int k = 0; k < 9; k++) assert_true(m_dot[TD_G_FACTOR + k] == 0);
    }
    double *expected = golden_doubles(file->archive, "cov3", NULL);
    golden_part part = {file->name, "cov3", file->count, 6, 0, 6, golden_tolerance[precision], NULL};
    golden_compare(&part, covariance, expected + frame * file->count * 6);
    free(expected);
    free(covariance);
}

/* Colour of Gaussian i seen from the file's eye, along the direction to entry `at` of the rows: in double from the rows. */
static td_colour colour_of(const fudan_file *file, const move_rows *rows, int i, int at) {
    td_dual d[3], square = td_dual_make(0, 0);
    int moves = file->harmonics > 0;
    double sh[ENTRIES];
    for (int e = 0; e < ENTRIES; e++) sh[e] = moves ? rows->sh[i * ENTRIES + e] : (double)file->sh[i * ENTRIES + e];
    for (int k = 0; k < 3; k++) {
        int entry = i * TD_GEOMETRY_STRIDE + at + k;
        d[k] = td_dual_make(rows->geometry[entry] - file->eye[k], rows->rates[entry]);
        square = td_dual_fma(d[k], d[k], square);
    }
    td_dual inverse = td_dual_reciprocal(td_dual_sqrt(square));
    const td_sh_source source = {sh, rows->sh_rates + i * ENTRIES, 0, 0, moves, 0};
    return td_sh_colour(td_dual_mul(d[0], inverse), td_dual_mul(d[1], inverse), td_dual_mul(d[2], inverse), &source, 3);
}

/* Their kernel's colours look to the row's origin, their Python's to its mean. */
static void compare_colours(const fudan_file *file, int frame, int precision, const move_rows *rows) {
    static const char *const names[2] = {"color_cuda_dir", "color_python_dir"};
    double *value = calloc((size_t)file->count * 6, sizeof *value), *rate = value + 3 * file->count;
    assert_non_null(value);
    for (int way = 0; way < 2; way++) {
        for (int i = 0; i < file->count; i++) {
            td_colour colour = colour_of(file, rows, i, way == 0 ? TD_G_ORIGIN : TD_G_MEAN);
            for (int c = 0; c < 3; c++) {
                value[3 * i + c] = colour.channel[c].v;
                rate[3 * i + c] = colour.channel[c].d;
            }
        }
        compare(file, names[way], frame, precision, NULL, value, rate, 3, 0, 3);
    }
    free(value);
}

static tides_motion *motion_of(const fudan_file *file) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    tides_rotor_motion arrays = {.count = file->count,
                                 .start = file->duration[0],
                                 .stop = file->duration[1],
                                 .centre = file->centre,
                                 .log_scale_time = file->width,
                                 .quaternion_right = file->tilts ? file->right : NULL,
                                 .sh_harmonic = file->harmonic,
                                 .harmonics = file->harmonics,
                                 .sh_degree = 3};
    if (tides_motion_create_rotor(&arrays, &motion, &error) != TIDES_OK) fail_msg("%s", error.text);
    return motion;
}

static void compare_file(const fudan_file *file) {
    const tides_gaussians gaussians = {.count = file->count,
                                       .sh_degree = 3,
                                       .mean = file->mean,
                                       .log_scale = file->scale,
                                       .quaternion = file->left,
                                       .opacity_logit = file->opacity,
                                       .sh = file->sh};
    tides_motion *motion = motion_of(file);
    for (int i = 0; i < GOLDEN_PRECISIONS * (int)file->frames; i++) {
        int frame = i / GOLDEN_PRECISIONS, precision = i % GOLDEN_PRECISIONS;
        move_rows rows = golden_move(motion, &gaussians, file->t[frame], 0, precision);
        compare(file, "means", frame, precision, NULL, rows.geometry, rows.rates, 3, TD_G_MEAN, TD_GEOMETRY_STRIDE);
        compare_opacity(file, frame, precision, &rows);
        if (file->tilts) compare_covariance(file, frame, precision, &rows);
        compare_colours(file, frame, precision, &rows);
        golden_rows_free(&rows);
    }
    tides_motion_destroy(motion);
}

static int visit(void *user, const char *path, const char *name) {
    char golden[4096];
    (void)user;
    snprintf(golden, sizeof golden, "%s/golden.npz", path);
    npz *archive = npz_open(golden);
    assert_non_null(archive);
    fudan_file file = file_open(name, archive);
    compare_file(&file);
    print_message("%s: %d Gaussians, %d harmonics\n", name, file.count, file.harmonics);
    file_free(&file);
    return 0;
}

static void test_files(void **state) {
    (void)state;
    golden_folder("golden/fudan4d", "", visit, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
