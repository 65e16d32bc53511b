/* Internal: the nominal levels of a run, as the solver's estimates read them. */
#ifndef TD_COMPARATOR_H
#define TD_COMPARATOR_H

#include "signal/td_signals.h"
#include "signal/td_step.h"
#include "tides/simulate.h"

typedef struct td_comparator {
    double threshold_on, threshold_off; /* C+, C- [log units] > 0 */
    int32_t model;                      /* TIDES_MODEL_* */
    int32_t max_events_per_step;        /* per pixel, >= 1 */
    int32_t exhaustive;
} td_comparator;

#endif
