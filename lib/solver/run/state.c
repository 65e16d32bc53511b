/* The simulator's state for a checkpoint: the table of arrays that exist at the end of a step, and the time reached. It is also
 * taken up again here. lib/checkpoint writes the file; the sensor has a table of its own. */
#include "solver/td_simulator.h"

void td_simulator_state(tides_simulator *s, td_state *state) {
    const size_t pixels = s->layout.first_pixel[s->layout.tiles];
    const struct {
        const char *name;
        double *values;
    } real[] = {
        {"signal", s->now.plane[TD_PLANE_S]},
        {"signal_dot", s->now.plane[TD_PLANE_S_DOT]},
        {"coverage", s->now.plane[TD_PLANE_ALPHA]},
        {"alpha_dot", s->now.plane[TD_PLANE_ALPHA_DOT]},
        {"contributors", s->now.plane[TD_PLANE_CONTRIBUTORS]},
        {"surround", s->surround.h},
    };
    for (size_t i = 0; i < sizeof real / sizeof real[0]; i++)
        td_state_add(state, real[i].name, TD_STATE_REAL, TD_STATE_PIXELS, pixels, real[i].values);
    td_state_add(state, "tile_risk", TD_STATE_REAL, TD_STATE_PLAIN, (size_t)s->layout.tiles, s->tile_risk);
    td_state_add(state, "solve_known", TD_STATE_REAL, TD_STATE_PIXELS, pixels, s->solve.known);
    td_state_add(state, "timing_errors", TD_STATE_REAL, TD_STATE_PLAIN, TD_TIMING_BINS, s->done.timing.weight);
    td_state_add(state, "timing_squares", TD_STATE_REAL, TD_STATE_PLAIN, 1, &s->done.timing.squares);
    const tides_filter *filter = s->filters.filter;
    td_state_add(state, "filters", TD_STATE_WHOLE, TD_STATE_PLAIN, filter ? filter->count : 0, filter ? filter->state : NULL);
}

void td_simulator_resume(tides_simulator *s, int64_t step, const tides_stats *before) {
    td_sensor_resume(&s->sensor);
    if (s->surround.surround.on) td_surround_steps_resume(s);
    s->totals.before = *before;
    s->step = step;
    s->started = 1;
}

td_reached td_simulator_reached(const tides_simulator *s) {
    return (td_reached){s->step, td_grid_time(s, s->step), s->started, s->broken};
}

const tides_event *td_simulator_last(const tides_simulator *s) { return s->packet.last.polarity ? &s->packet.last : NULL; }
