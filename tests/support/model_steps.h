/* Test support: steps for tests of step control, which don't change with the defaults. The model decides event times, and
 * each tile has its own steps. */
#ifndef TESTS_SUPPORT_MODEL_STEPS_H
#define TESTS_SUPPORT_MODEL_STEPS_H

#include "tides/simulate.h"

static inline void model_steps(tides_stepping *stepping) {
    tides_stepping_defaults(stepping);
    stepping->solve = TIDES_SOLVE_OFF;
    stepping->unit = TIDES_UNIT_TILE;
    stepping->tolerance = 0.01;
}

#endif
