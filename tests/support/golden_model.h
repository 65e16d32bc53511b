/* Test support: compares motion models of trained folders with their authors' code, differentiated in double precision. */
#ifndef TESTS_SUPPORT_GOLDEN_MODEL_H
#define TESTS_SUPPORT_GOLDEN_MODEL_H

#include "scene/td_method_networks.h"
#include "tests/support/golden_rows.h"

/* A method: the function that opens its folders, and the names of arrays in its golden_theta.npz. */
typedef struct golden_model {
    tides_status (*open)(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
    golden_names names;
    double rates_before; /* rates are compared at times before this one */
} golden_model;

/* Compares every model of "$TIDES_SHARED/RELATIVE"; skips or fails the running cmocka test. Tolerances are 1e-12 in double
 * precision (about 5000 roundings) and 1e-5 in single precision (about 100). */
void golden_model_check(const char *relative, const golden_model *model);

#endif
