/* Test support: a sensor's pixels under signals given as functions of time, in steps of any length. */
#ifndef TESTS_UNIT_SENSOR_RIG_H
#define TESTS_UNIT_SENSOR_RIG_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/td_sensor.h"
#include "sensor/td_between.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Signal of pixel i at time t: value and rate. */
typedef void (*rig_signal)(const void *user, int i, double t, double *S, double *S_dot);
typedef double (*rig_coverage)(const void *user, int i, double t);

enum { RIG_WIDTH = 16, RIG_PIXELS = RIG_WIDTH * RIG_WIDTH, RIG_PLANES = 6 };

/* Tiles of 16 x 16 side by side, in a row. */
typedef struct rig {
    td_sensor sensor;
    td_tile *tile;
    int tiles;
    size_t pixels;
    double *plane[RIG_PLANES]; /* S, S_dot, coverage, now and next */
    td_work work;
    double start, now;
    rig_signal signal;
    rig_coverage coverage;
    const void *user;
} rig;

static inline void *rig_alloc(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    assert_non_null(memory);
    return memory;
}

static inline void rig_sample(rig *r, double t, int at) {
    for (size_t i = 0; i < r->pixels; i++) {
        r->signal(r->user, (int)i, t, &r->plane[at][i], &r->plane[at + 1][i]);
        r->plane[at + 2][i] = r->coverage ? r->coverage(r->user, (int)i, t) : 1;
    }
}

static inline rig *rig_make(const tides_sensor *sensor, int tiles, double start, rig_signal signal, const void *user) {
    rig *r = rig_alloc(1, sizeof *r);
    r->tiles = tiles;
    r->pixels = (size_t)tiles * RIG_PIXELS;
    r->tile = rig_alloc((size_t)tiles, sizeof *r->tile);
    for (int t = 0; t < tiles; t++) r->tile[t] = (td_tile){t * RIG_WIDTH, 0, RIG_WIDTH, RIG_PIXELS};
    for (int p = 0; p < RIG_PLANES; p++) r->plane[p] = rig_alloc(r->pixels, sizeof(double));
    r->start = r->now = start;
    r->signal = signal;
    r->user = user;
    tides_error error = {TIDES_OK, ""};
    if (td_sensor_create(sensor, TIDES_MODEL_HERMITE, 1e-3, start, &(const td_sensor_tiles){r->tile, tiles, tiles * RIG_WIDTH},
                         &r->sensor, &error) != TIDES_OK)
        fail_msg("%s", error.text);
    rig_sample(r, start, 0);
    td_sensor_begin(&r->sensor, r->plane[0], NULL);
    return r;
}

static inline void rig_free(rig *r) {
    td_sensor_release(&r->sensor);
    for (int p = 0; p < RIG_PLANES; p++) free(r->plane[p]);
    free(r->tile);
    free(r->work.events.events);
    free(r);
}

/* The invariant, at the time reached. */
static inline void rig_check(const rig *r) {
    double time = (r->now - r->start) * 1e9;
    if (!r->sensor.on) {
        assert_true(td_sensor_worst_residual(&r->sensor, r->plane[0], NULL, time) < 1);
        return;
    }
    for (size_t i = 0; i < r->pixels; i++) {
        if (!isfinite(r->plane[0][i]) || r->sensor.held_until[i] > time ||
            (r->sensor.masks && !(r->plane[2][i] >= r->sensor.sensor.b_min)))
            continue;
        double residual = td_sensor_signal(&r->sensor, i, r->plane[0][i], time) - r->sensor.pixels.reference[i];
        if (!(residual < r->sensor.threshold_on[i] + 1e-12 && residual > -r->sensor.threshold_off[i] - 1e-12))
            fail_msg("pixel %zu at %g s: S_eff - S_ref is %.17g", i, r->now, residual);
    }
}

/* One step to `stop`, as the simulator makes it: the last nanosecond is the next step's. */
static inline void rig_step(rig *r, double stop) {
    td_step step;
    tides_error error = {TIDES_OK, ""};
    rig_sample(r, stop, 3);
    assert_int_equal(td_step_between(r->now, stop, &step, &error), TIDES_OK);
    step.stop_ns--;
    for (int t = 0; t < r->tiles; t++) {
        size_t at = (size_t)t * RIG_PIXELS;
        td_signals signals = {r->plane[0] + at, r->plane[1] + at, r->plane[3] + at, r->plane[4] + at};
        td_coverage coverage = {r->plane[2] + at, r->plane[5] + at};
        if (td_sensor_step(&r->sensor, &step, &r->tile[t], at, &(td_seen){.signals = &signals, .coverage = coverage}, &r->work,
                           &error) != TIDES_OK)
            fail_msg("%s", error.text);
    }
    for (int p = 0; p < 3; p++) {
        double *passed = r->plane[p];
        r->plane[p] = r->plane[p + 3];
        r->plane[p + 3] = passed;
    }
    r->now = stop;
    rig_check(r);
}

/* `steps` equal steps to `stop`. */
static inline void rig_run(rig *r, double stop, int steps) {
    double from = r->now;
    for (int k = 1; k <= steps; k++) rig_step(r, k == steps ? stop : from + (stop - from) * k / steps);
}

/* Events of one pixel, in order. */
static inline size_t rig_events(const rig *r, int x, int y, tides_event *events, size_t room) {
    size_t count = 0;
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        if (e->x == x && e->y == y && count < room) events[count++] = *e;
    }
    return count;
}

#endif
