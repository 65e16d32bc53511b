/* Step control as tests of step control mean it, whatever the defaults are: the model decides when events are, in steps of
 * whole tiles. */
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
