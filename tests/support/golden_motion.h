/* Test support: motions from arrays of .npz files, moved in either precision, compared with the files' values and rates. Errors
 * fail the running cmocka test. */
#ifndef TESTS_SUPPORT_GOLDEN_MOTION_H
#define TESTS_SUPPORT_GOLDEN_MOTION_H

#include "motion/td_motion.h"
#include "tests/support/move.h"
#include "tests/support/npz.h"

enum { GOLDEN_DOUBLE = 0, GOLDEN_SINGLE = 1, GOLDEN_PRECISIONS = 2 };
static const double golden_tolerance[GOLDEN_PRECISIONS] = {1e-12, 1e-5};
static const char *const golden_precision[GOLDEN_PRECISIONS] = {"double", "single"};

/* An array of the file as floats or doubles, which must exist; *count (nullable): its elements. Freed with free(). */
float *golden_floats(npz *file, const char *name, size_t *count);
double *golden_doubles(npz *file, const char *name, size_t *count);

/* All Gaussians of a motion at tau, rates per unit of tau; freed with golden_rows_free. */
move_rows golden_move(const tides_motion *motion, const tides_gaussians *gaussians, double tau, int fades, int precision);
void golden_rows_free(move_rows *rows);

/* The factors R diag(s) and their rates, (count x 9), that rows must have for these raw quaternions and log scales. */
void golden_factors(const double *quaternion, const double *quaternion_dot, const float *log_scale, int count, double *factor,
                    double *factor_dot);

/* A part of rows to compare: in `count` rows of `stride` numbers, `width` entries from `at` on. Errors are relative to the
 * largest number in `expected`; `keep` (nullable): 0 leaves a row out. */
typedef struct golden_part {
    const char *file, *name;
    int count, width, at, stride;
    double tolerance;
    const unsigned char *keep;
} golden_part;
void golden_compare(const golden_part *part, const double *rows, const double *expected);

#endif
