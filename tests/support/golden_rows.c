/* Compares rows of a motion with arrays of .npz files. */
#include "tests/support/golden_rows.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An array at one time, and its rates; owned. */
typedef struct slice {
    double *all, *all_dot;
    const double *value, *rate;
    size_t count;
} slice;

static slice take(npz *file, const char *name, size_t time) {
    char dot[64];
    slice s;
    size_t total = 0, times = 0;
    double *t = npz_doubles(file, "t", &times);
    snprintf(dot, sizeof dot, "%s_dot", name);
    s.all = npz_doubles(file, name, &total);
    s.all_dot = npz_doubles(file, dot, NULL);
    assert_true(t && s.all && s.all_dot);
    assert_true(times > 0);
    s.count = total / times;
    s.value = s.all + time * s.count;
    s.rate = s.all_dot + time * s.count;
    free(t);
    return s;
}

static void drop(slice *s) {
    free(s->all);
    free(s->all_dot);
}

/* The bilinear form R(a, b) of two quaternions, with R(q, q) the rotation of unit q; constant: 1, or 0 for a rate, R(q_dot,
 * q) + R(q, q_dot). */
static void rotate(const double a[4], const double b[4], double constant, double r[9]) {
    double n[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) n[i][j] = a[1 + i] * b[1 + j];
    double wx = a[0] * b[1], wy = a[0] * b[2], wz = a[0] * b[3];
    const double m[9] = {constant - 2 * (n[1][1] + n[2][2]), 2 * (n[0][1] - wz), 2 * (n[0][2] + wy), 2 * (n[0][1] + wz),
                         constant - 2 * (n[0][0] + n[2][2]), 2 * (n[1][2] - wx), 2 * (n[0][2] - wy), 2 * (n[1][2] + wx),
                         constant - 2 * (n[0][0] + n[1][1])};
    memcpy(r, m, sizeof m);
}

static void factor_of(const double *q, const double *q_dot, const double *s, const double *s_dot, double m[9],
                      double m_dot[9]) {
    double r[9], left[9], right[9];
    rotate(q, q, 1, r);
    rotate(q_dot, q, 0, left);
    rotate(q, q_dot, 0, right);
    for (int k = 0; k < 9; k++) {
        m[k] = r[k] * s[k % 3];
        m_dot[k] = (left[k] + right[k]) * s[k % 3] + r[k] * s_dot[k % 3];
    }
}

static double largest(const double *array, size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++) most = fmax(most, fabs(array[i]));
    return most;
}

/* Largest difference of entries [at, at + width) of every row from an array, relative to the array's largest number. */
static double difference(const double *rows, size_t count, size_t stride, size_t at, const double *array, size_t width) {
    double most = 0, scale = largest(array, count * width);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < width; k++) most = fmax(most, fabs(rows[i * stride + at + k] - array[i * width + k]));
    return most == 0 ? 0 : most / scale; /* infinite where nothing should move */
}

static void compare(const motion_rows *rows, size_t at, const double *value, const double *rate, size_t width, int rates,
                    golden_errors *errors) {
    size_t count = (size_t)rows->count;
    errors->value = fmax(errors->value, difference(rows->geometry, count, TD_GEOMETRY_STRIDE, at, value, width));
    if (rates) errors->rate = fmax(errors->rate, difference(rows->rates, count, TD_GEOMETRY_STRIDE, at, rate, width));
}

static void compare_factors(npz *file, const golden_names *names, size_t time, const motion_rows *rows, int rates,
                            golden_errors *errors) {
    slice scale = take(file, names->scale, time), turn = take(file, names->quaternion, time);
    double *m = malloc((size_t)rows->count * 9 * sizeof *m), *m_dot = malloc((size_t)rows->count * 9 * sizeof *m_dot);
    assert_true(m && m_dot);
    for (int i = 0; i < rows->count; i++)
        factor_of(turn.value + 4 * i, turn.rate + 4 * i, scale.value + 3 * i, scale.rate + 3 * i, m + 9 * i, m_dot + 9 * i);
    compare(rows, TD_G_FACTOR, m, m_dot, 9, rates, errors);
    free(m);
    free(m_dot);
    drop(&scale);
    drop(&turn);
}

void golden_rows_compare(npz *file, const golden_names *names, size_t time, const motion_rows *rows, int rates,
                         golden_errors *errors) {
    slice mean = take(file, names->mean, time), opacity = take(file, names->opacity, time);
    assert_int_equal(mean.count, 3 * rows->count);
    assert_int_equal(opacity.count, rows->count);
    compare(rows, TD_G_MEAN, mean.value, mean.rate, 3, rates, errors);
    compare(rows, TD_G_ORIGIN, mean.value, mean.rate, 3, rates, errors);
    compare(rows, TD_G_OPACITY, opacity.value, opacity.rate, 1, rates, errors);
    compare_factors(file, names, time, rows, rates, errors);
    drop(&mean);
    drop(&opacity);
    if (!rows->sh) return;
    slice sh = take(file, names->sh, time);
    size_t count = (size_t)rows->count, stride = (size_t)rows->sh_stride;
    errors->value = fmax(errors->value, difference(rows->sh, count, stride, 0, sh.value, sh.count / count));
    if (rates) errors->rate = fmax(errors->rate, difference(rows->sh_rates, count, stride, 0, sh.rate, sh.count / count));
    drop(&sh);
}
