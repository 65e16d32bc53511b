/* Internal: the time that a simulator has reached, for recordings and live runs. */
#ifndef TD_REACHED_H
#define TD_REACHED_H

#include "td_pool.h"
#include "tides/simulate.h"

typedef struct td_reached {
    int64_t step;   /* steps taken */
    double seconds; /* their end [s from the run's start] */
    int started;    /* the first sample exists; of an open path, the image at its first poses */
    int broken;     /* a step failed half way: the pixels no longer agree on the time */
} td_reached;
td_reached td_simulator_reached(const tides_simulator *simulator);

/* The threads that share the simulator's work; a sink, in the thread that called, may let them share its own. */
td_pool *td_simulator_pool(const tides_simulator *simulator);

/* The last event that was given to the sink, in earlier parts of the run too; NULL: there was none. */
const tides_event *td_simulator_last(const tides_simulator *simulator);

/* The time [s] up to which a run until `until` equals a longer one: the beginning of its last whole step. */
double td_simulator_extends_from(const tides_simulator *simulator, double until);

/* Ends the run at the time reached: events that its readout still holds go to the sink as a last packet. */
tides_status td_simulator_finish(tides_simulator *simulator, tides_event_sink sink, void *user, tides_error *error);

#endif
