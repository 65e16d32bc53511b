/* The simulator's state for a checkpoint: the table of arrays that exist at the end of a step, and the time reached. It is also
 * taken up again here. lib/checkpoint writes the file, and knows of a simulator what td_saved_run.h has. */
#include "solver/td_simulator.h"

void td_simulator_state(tides_simulator *s, td_state *state) {
    const size_t pixels = s->layout.first_pixel[s->layout.units];
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
    td_state_add(state, "tile_risk", TD_STATE_REAL, TD_STATE_PLAIN, (size_t)s->layout.units, s->unit_risk);
    td_state_add(state, "solve_known", TD_STATE_REAL, TD_STATE_PIXELS, pixels, s->solve.known);
    td_state_add(state, "timing_errors", TD_STATE_REAL, TD_STATE_PLAIN, TD_TIMING_BINS, s->done.timing.weight);
    td_state_add(state, "timing_measured", TD_STATE_REAL, TD_STATE_PLAIN, 1, &s->done.timing.measured);
    const tides_filter *filter = s->filters.filter;
    td_state_add(state, "filters", TD_STATE_WHOLE, TD_STATE_PLAIN, filter ? filter->count : 0, filter ? filter->state : NULL);
    td_sensor_state(&s->sensor, state);
}

void td_simulator_copy_pixels(const tides_simulator *s, int direction, size_t size, void *values, void *image) {
    for (int t = 0; t < s->layout.units; t++) {
        const td_tile *unit = &s->layout.unit[t];
        for (int i = 0; i < unit->count; i += unit->width) { /* a row of the unit is part of a row of the image */
            const size_t at = (size_t)(unit->y0 + i / unit->width) * (size_t)s->layout.width + (size_t)unit->x0;
            char *own = (char *)values + (s->layout.first_pixel[t] + (size_t)i) * size, *other = (char *)image + at * size;
            if (direction == TD_FROM_IMAGE)
                memcpy(own, other, (size_t)unit->width * size);
            else
                memcpy(other, own, (size_t)unit->width * size);
        }
    }
}

td_saved_run td_simulator_saved(const tides_simulator *s) {
    return (td_saved_run){.scene = s->scene,
                          .camera = s->camera,
                          .renderer = s->renderer,
                          .stepping = &s->stepping,
                          .sensor = &s->sensor.sensor,
                          .maps_checksum = s->sensor.maps_checksum,
                          .kick_checksum = s->sensor.kick.checksum,
                          .readout = &s->readout.params,
                          .filters = &s->filters.params,
                          .arbiter = s->readout.arbiter,
                          .width = s->layout.width,
                          .height = s->layout.height,
                          .epoch = s->epoch,
                          .length = s->length,
                          .steps = s->grid.steps};
}

double td_simulator_grid_time(const tides_simulator *s, int64_t k) { return td_grid_time(s, k); }

void td_simulator_resume(tides_simulator *s, td_resumed *from) {
    td_sensor_resume(&s->sensor);
    td_surround_steps_resume(s);
    s->totals.before = from->totals;
    s->step = from->step;
    s->started = 1;
    s->packet.last = from->last;
    tides_arbiter *own = s->readout.arbiter; /* both are NULL, or neither is */
    s->readout.arbiter = from->arbiter;
    from->arbiter = own;
}

td_reached td_simulator_reached(const tides_simulator *s) {
    return (td_reached){s->step, td_grid_time(s, s->step), s->started, s->broken};
}

td_pool *td_simulator_pool(const tides_simulator *s) { return s->sharing.pool; }

const tides_event *td_simulator_last(const tides_simulator *s) { return s->packet.last.polarity ? &s->packet.last : NULL; }
