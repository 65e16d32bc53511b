/* Test support: compares motion models with golden_theta.npz, which lies in each folder of a trained scene. It has every
 * Gaussian's values and their rates at several times, from the method's original code in double precision. */
#ifndef TESTS_SUPPORT_GOLDEN_MODEL_H
#define TESTS_SUPPORT_GOLDEN_MODEL_H

#include "scene/td_method_networks.h"
#include "tests/support/golden_rows.h"

/* A method: the function that opens its trained folders, and the names of arrays in its golden_theta.npz. */
typedef struct golden_model {
    tides_status (*open)(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
    golden_names names;
    /* Rates are compared only at times before this one, in the file's unit: 4DGaussians' code clips at the last time, and has
     * rates of 0 there. INFINITY: all times. */
    double rates_before;
} golden_model;

/* Compares every model of "$TIDES_SHARED/RELATIVE". The running cmocka test is skipped without that folder, and fails if a
 * model differs. Tolerances are relative to the largest number of an array: 1e-12 in double precision, about 5000 units of
 * rounding, and 1e-5 in single precision, about 100. */
void golden_model_check(const char *relative, const golden_model *model);

#endif
