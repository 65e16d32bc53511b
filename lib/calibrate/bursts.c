/* Marks the bursts that the readout of frames makes in the stretch from which a sensor is calibrated. */
#include "td_calibrate.h"

void td_bursts_mark(td_taken *taken) {
    taken->in_bursts = 0;
    for (size_t i = 0; i < taken->count; i++) {
        tides_event *e = &taken->events[i];
        e->cause = taken->burst[td_bin(taken, e->t)];
        taken->in_bursts += e->cause;
    }
}

tides_status td_bursts_find(td_taken *taken, tides_error *error) {
    taken->burst = td_alloc(taken->bins, 1, error);
    if (!taken->burst) return TIDES_NO_MEMORY;
    taken->bursts = td_bursts_in(taken->rate, taken->bins, taken->burst);
    td_bursts_mark(taken);
    return TIDES_OK;
}
