/* Test support: compares rows of geometry with means, scales, rotations, opacities and spherical harmonics of other people's
 * code. Errors fail the running cmocka test. */
#ifndef TESTS_SUPPORT_GOLDEN_ROWS_H
#define TESTS_SUPPORT_GOLDEN_ROWS_H

#include "tests/support/motion_rows.h"
#include "tests/support/npz.h"

/* Names of the file's arrays, each with its rate under NAME_dot. */
typedef struct golden_names {
    const char *mean, *scale, *quaternion, *opacity, *sh; /* sh may be NULL */
} golden_names;

/* Largest errors so far, relative to the largest number of the array at that time. */
typedef struct golden_errors {
    double value, rate;
} golden_errors;

/* Compares rows with time number `time` of the file; `rates` 0 leaves rates out. */
void golden_rows_compare(npz *file, const golden_names *names, size_t time, const motion_rows *rows, int rates,
                         golden_errors *errors);

#endif
