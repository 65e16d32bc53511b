/* Test support: motion models of trained folders against their own code, differentiated in double precision. */
#ifndef TESTS_SUPPORT_GOLDEN_MODEL_H
#define TESTS_SUPPORT_GOLDEN_MODEL_H

#include "scene/td_method_networks.h"
#include "tests/support/golden_rows.h"

/* How a method's folders are opened, and what its golden_theta.npz calls things. */
typedef struct golden_model {
    tides_status (*open)(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
    golden_names names;
    double rates_before; /* rates are compared at times before this one */
} golden_model;

/* Compares every model of "$TIDES_SHARED/RELATIVE"; skips or fails the running cmocka test. Values and rates within 1e-12 in
 * double precision, which is some thousand roundings; within 1e-5 in single precision, a hundred of them. */
void golden_model_check(const char *relative, const golden_model *model);

#endif
