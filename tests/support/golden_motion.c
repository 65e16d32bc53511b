/* Compares motions made from arrays of .npz files with the files' values and rates. */
#include "tests/support/golden_motion.h"

#include "motion/td_activate.h"
#include "render/td_renderer.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

double *golden_doubles(npz *file, const char *name, size_t *count) {
    double *values = npz_doubles(file, name, count);
    if (!values) fail_msg("array '%s' is missing", name);
    return values;
}

float *golden_floats(npz *file, const char *name, size_t *count) {
    size_t own = 0;
    double *wide = golden_doubles(file, name, &own);
    float *values = malloc((own + 1) * sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < own; i++) values[i] = (float)wide[i];
    free(wide);
    if (count) *count = own;
    return values;
}

static double *reals(size_t count) {
    double *made = calloc(count, sizeof *made);
    assert_non_null(made);
    return made;
}

move_rows golden_move(const tides_motion *motion, const tides_gaussians *gaussians, double tau, int fades, int precision) {
    size_t count = (size_t)gaussians->count;
    int sh = 3 * (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1), entries = sh < TD_FEATURES ? TD_FEATURES : sh;
    move_rows rows = {entries, reals(count * TD_GEOMETRY_STRIDE), reals(count * TD_GEOMETRY_STRIDE),
                      reals(count * (size_t)entries), reals(count * (size_t)entries)};
    td_mover_numbers numbers = {0};
    tides_error error = {0, ""};
    double moment[TD_MOMENT_REALS];
    int *gaussian = calloc(count, sizeof *gaussian);
    assert_non_null(gaussian);
    for (size_t i = 0; i < count; i++) gaussian[i] = (int)i;
    if (motion->type->check(motion, gaussians, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (motion->type->pack(motion, gaussians, &numbers, &error) != TIDES_OK) fail_msg("%s", error.text);
    td_motion_moment(motion, tau, 1, 1, moment);
    const move_job job = {motion->type->code, fades,  numbers.moves_sh, numbers.real, numbers.own, numbers.data,
                          numbers.data_count, moment, gaussian,         (int)count,   (int)count};
    (precision == GOLDEN_DOUBLE ? move_f64 : move_f32)(&job, &rows);
    td_mover_release(&numbers);
    free(gaussian);
    return rows;
}

void golden_rows_free(move_rows *rows) {
    free(rows->geometry);
    free(rows->rates);
    free(rows->sh);
    free(rows->sh_rates);
}

void golden_factors(const double *quaternion, const double *quaternion_dot, const float *log_scale, int count, double *factor,
                    double *factor_dot) {
    const double still[3] = {0, 0, 0};
    for (int i = 0; i < count; i++) {
        double geometry[TD_GEOMETRY_STRIDE], rates[TD_GEOMETRY_STRIDE], scale[3];
        for (int k = 0; k < 3; k++) scale[k] = log_scale[3 * i + k];
        td_activate(still, scale, quaternion + 4 * i, 0, geometry);
        td_activate_rates(still, scale, still, quaternion + 4 * i, quaternion_dot + 4 * i, 0, 0, rates);
        memcpy(factor + 9 * i, geometry + TD_G_FACTOR, 9 * sizeof *factor);
        memcpy(factor_dot + 9 * i, rates + TD_G_FACTOR, 9 * sizeof *factor);
    }
}

void golden_compare(const golden_part *part, const double *rows, const double *expected) {
    double largest = 0;
    for (int i = 0; i < part->count * part->width; i++) largest = fmax(largest, fabs(expected[i]));
    for (int i = 0; i < part->count; i++) {
        if (part->keep && !part->keep[i]) continue;
        for (int k = 0; k < part->width; k++) {
            double is = rows[i * part->stride + part->at + k], should = expected[i * part->width + k];
            if (!(fabs(is - should) <= part->tolerance * largest))
                fail_msg("%s: %s of Gaussian %d, entry %d: %.15g, not %.15g (largest %g)", part->file, part->name, i, k, is,
                         should, largest);
        }
    }
}
