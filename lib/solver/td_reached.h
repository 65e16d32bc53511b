/* Internal: the time that a simulator has reached, for recordings and live runs, which need nothing else of it. */
#ifndef TD_REACHED_H
#define TD_REACHED_H

#include "tides/simulate.h"

typedef struct td_reached {
    int64_t step;   /* steps taken, */
    double seconds; /* up to this time, from the run's start */
    int started;    /* the first sample is there: of an open path, the image at its first poses */
    int broken;     /* a step failed half way: the pixels no longer agree on the time */
} td_reached;
td_reached td_simulator_reached(const tides_simulator *simulator);

/* The event that was given away last, of the run's parts before too; NULL: there was none. */
const tides_event *td_simulator_last(const tides_simulator *simulator);

/* Up to when a run that is asked for up to `until` [s] is the same as a longer one: where its last whole step began. */
double td_simulator_extends_from(const tides_simulator *simulator, double until);

/* The run is over where it is: what its readout still holds goes to the sink as a last packet, as at its stop. */
tides_status td_simulator_finish(tides_simulator *simulator, tides_event_sink sink, void *user, tides_error *error);

#endif
