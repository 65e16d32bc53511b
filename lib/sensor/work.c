/* The results of pieces of a sensor's work are added up, joined and cleared here. */
#include "td_sensor_work.h"

#include <stdlib.h>
#include <string.h>

void td_counts_add(td_sensor_counts *sum, const td_sensor_counts *more) {
    for (int c = 0; c < TIDES_CAUSES; c++) sum->cause[c] += more->cause[c];
    sum->events_on += more->events_on;
    sum->events_off += more->events_off;
    sum->truncated += more->truncated;
    sum->caught_up += more->caught_up;
    sum->solved += more->solved;
    sum->nonfinite += more->nonfinite;
    sum->suppressed += more->suppressed;
    sum->refractory += more->refractory;
}

tides_status td_work_join(td_work *to, const td_work *piece, tides_error *error) {
    const size_t some = piece->events.count;
    tides_status status = some > 0 ? td_event_buffer_reserve(&to->events, some, error) : TIDES_OK;
    if (status != TIDES_OK) return status;
    if (some > 0) memcpy(to->events.events + to->events.count, piece->events.events, some * sizeof *to->events.events);
    to->events.count += some;
    td_counts_add(&to->counts, &piece->counts);
    return TIDES_OK;
}

void td_work_clear(td_work *work) {
    work->events.count = 0;
    work->counts = (td_sensor_counts){0};
}

void td_work_release(td_work *work) {
    td_event_buffer_release(&work->events);
    free(work->slopes.slope);
    work->slopes = (td_slopes){0};
    td_work_clear(work);
}
