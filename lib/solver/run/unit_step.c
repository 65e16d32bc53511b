/* A step of one unit: its signals go to the sensor, which appends events. Also the values that pixels' comparators see at the
 * time reached. */
#include "solver/td_simulator.h"
#include "sensor/td_between.h"

#include <math.h>

/* The time of the grid point reached [ns since the run's start]. */
static double time_now(const tides_simulator *s) {
    td_step step;
    double time = td_grid_time(s, s->step);
    if (td_step_between(time, time + 1, &step, NULL) != TIDES_OK) return 0; /* can't fail: the run's steps were like this one */
    return td_sensor_time(&s->sensor, s->grid.epoch_ns + step.start_ns, step.start_fraction);
}

/* Fails because of NaN in the sensor. Rendered planes are checked before, so that it comes from the front end. */
static tides_status fail_nonfinite(const tides_simulator *s, int t, const td_step *step, uint64_t pixels, tides_error *error) {
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "the signal of %llu pixels of the tile at (%d, %d) isn't finite at %.15g s, although the image is: the "
                   "front end's parameters are beyond what can be computed with",
                   (unsigned long long)pixels, (int)s->layout.unit[t].x0, (int)s->layout.unit[t].y0,
                   1e-9 * (double)step->start_ns);
}

static td_signals signals_of(const td_compared *at) {
    return (td_signals){at->begin[TD_PLANE_S], at->begin[TD_PLANE_S_DOT], at->end[TD_PLANE_S], at->end[TD_PLANE_S_DOT]};
}

tides_status td_compare_unit(const tides_simulator *s, td_portion *portion, const td_compared *at, tides_error *error) {
    const uint64_t before = portion->work.counts.nonfinite;
    const td_signals signals = signals_of(at);
    td_seen seen = {.signals = &signals, .light = at->light};
    if (s->sensor.masks) seen.coverage = (td_coverage){at->begin[TD_PLANE_ALPHA], at->end[TD_PLANE_ALPHA]};
    portion->work.slopes.on = td_sensor_adds(&s->sensor);
    tides_status status = td_sensor_step(&s->sensor, at->step, &s->layout.unit[at->unit], s->layout.first_pixel[at->unit],
                                         &seen, &portion->work, error);
    if (status != TIDES_OK || portion->work.counts.nonfinite == before) return status;
    return fail_nonfinite(s, at->unit, at->step, portion->work.counts.nonfinite - before, error);
}

/* The number of moving units before unit t; their list is in ascending order. */
static int moving_before(const td_moving *moving, int t) {
    int low = 0, high = moving->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (moving->list[middle] < t)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static tides_status compare_some_still(const tides_simulator *s, td_portion *portion, int first, int end, const void *step,
                                       tides_error *error) {
    static const double no_rate[TD_TILE_PIXELS] = {0};
    int moved = moving_before(&s->moving, first);
    for (int t = first; t < end; t++) {
        if (moved < s->moving.count && s->moving.list[moved] == t) {
            moved++;
            continue;
        }
        const double *plane[TD_PLANES_ALL];
        for (int k = 0; k < s->given.sample_planes; k++) plane[k] = s->now.plane[k] + s->layout.first_pixel[t];
        plane[TD_PLANE_S_DOT] = no_rate;
        const td_compared unit = {t, step, plane, plane, NULL};
        tides_status status = td_compare_unit(s, portion, &unit, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

tides_status td_compare_still(tides_simulator *s, const td_step *step, tides_error *error) {
    if (!s->sensor.active_at_rest) return TIDES_OK;
    return td_share_out(s, s->layout.units, TD_FEWEST_UNITS, compare_some_still, step, error);
}

/* Where a hold takes a new reference from the signal after each event, an error of the event's time becomes an error of the
 * reference. So errors of a pixel's events add up: in quadrature over some 16 events of a busy pixel in a run. */
static const double hold_adds = 4;

/* Behind a filter an error of S lasts for a time constant, and is equal in a reference and in the next events, so that little
 * adds up. A hold that ends in noise takes its reference wherever the noise is then: its error is that of a steeper slope.
 * Choices: on 469 runs of tests/property/test_filter_estimates.c (TIDES_TRIALS=30) none reports too little. */
static const double hold_adds_behind = 1.6, noisy_hold_adds_behind = 2.5, adds_behind = 1.3;

/* How many times an event's own error counts, for earlier errors that its reference keeps. */
static double adds_of(const td_sensor *sensor) {
    const int holds = td_sensor_holds(sensor);
    if (!sensor->filtered.error) return holds ? hold_adds : 1;
    if (!holds) return adds_behind;
    return sensor->additive.on ? noisy_hold_adds_behind : hold_adds_behind;
}

void td_time_events(const tides_simulator *s, td_portion *portion, const td_refine_step *refined, const td_compared *compared,
                    size_t first) {
    const td_signals signals = signals_of(compared);
    const td_event_buffer *events = &portion->work.events;
    const td_samples *samples = &s->refine.samples;
    const int holds = td_sensor_holds(&s->sensor);
    td_timed timed = {.step = compared->step,
                      .tile = &s->layout.unit[refined->unit],
                      .signals = &signals,
                      .deviation = refined->probe < 0 ? NULL : td_sample_deviation(samples, refined->probe),
                      .fall = refined->probe < 0 ? NULL : td_sample_fall(samples, refined->probe),
                      .adds = adds_of(&s->sensor),
                      .held = holds ? s->sensor.refractory_ns / compared->step->length_ns : 0,
                      .is_last = td_refine_ends_run(s, refined),
                      .levels = td_sensor_levels(&s->sensor, compared->step, s->layout.first_pixel[refined->unit]),
                      .frontend = &s->sensor.frontend,
                      .log_eps = s->sensor.log_eps,
                      .filter_error =
                          s->sensor.filtered.error ? s->sensor.filtered.error + s->layout.first_pixel[refined->unit] : NULL,
                      .slopes = portion->work.slopes.on && events->count > first ? portion->work.slopes.slope + first : NULL,
                      .events = events->count > first ? events->events + first : NULL,
                      .count = events->count - first};
    td_timing_add(&portion->timing, &timed);
    td_timing_add_turns(&portion->timing, &timed);
}

double td_signal_now(const tides_simulator *s, size_t pixel) {
    return td_sensor_signal(&s->sensor, pixel, td_seen_now(s)[pixel], time_now(s));
}

double td_worst_residual(const tides_simulator *s) {
    return td_sensor_worst_residual(&s->sensor, td_seen_now(s), s->now.plane[TD_PLANE_ALPHA], time_now(s));
}
