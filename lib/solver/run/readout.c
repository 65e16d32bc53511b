/* The readout in a run. After each macro step its events go through the arbiter, with the activity at the macro step's end. The
 * arbiter and its queues are in lib/readout; the activity of its tiles (tile_px wide) is measured here. The filters behind the
 * readout are attached here, too.
 *
 * The activity psi of a tile is the mean of three shares, each at most 1:
 *   - the mean of |L_dot| / C over the tile's pixels, divided by 100 1/s; C is the mean of both nominal thresholds
 *   - the mean of |alpha_dot|, divided by 100 1/s
 *   - the mean number of contributors, divided by 64, as in the risk score.
 * Busy tiles of recordings have 100 events per second and pixel. Where nothing moved in the macro step, both rates are 0. */
#include "signal/td_event_sort.h"
#include "solver/td_simulator.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>

static const double full_rate = 100, full_contributors = 64;

/* -- attaching ------------------------------------------------------------------------------------------------------------- */

/* Makes samples keep the planes of diagnostics from now on: the activity is computed from them. */
static tides_status keep_all(tides_simulator *s, tides_error *error) {
    size_t pixels = s->layout.first_pixel[s->layout.units];
    for (int p = TD_PLANES_SIGNAL; p < TD_PLANES_ALL; p++) {
        if (!s->now.plane[p]) s->now.plane[p] = td_alloc(pixels, sizeof(double), error);
        if (!s->next.plane[p]) s->next.plane[p] = td_alloc(pixels, sizeof(double), error);
        if (!s->now.plane[p] || !s->next.plane[p]) return TIDES_NO_MEMORY;
    }
    s->given.sample_planes = s->refine.samples.planes = TD_PLANES_ALL;
    s->given.outputs = TD_OUT_DIAGNOSTICS;
    td_refine_bound(s);
    return td_renderer_prepare(s->renderer, TD_OUT_DIAGNOSTICS, error);
}

static tides_status attach(tides_simulator *s, const tides_readout *params, tides_error *error) {
    td_run_readout *readout = &s->readout;
    int32_t width = s->layout.width, height = s->layout.height, down;
    tides_status status = tides_arbiter_create(params, width, height, s->sensor.sensor.seed, &readout->arbiter, error);
    if (status != TIDES_OK) return status;
    tides_arbiter_start(readout->arbiter, s->grid.epoch_ns);
    readout->params = *params;
    if (!td_arbiter_has_ticks(readout->arbiter)) return TIDES_OK; /* activity isn't used without ticks */
    tides_arbiter_tiles(readout->arbiter, &readout->across, &down);
    readout->psi = td_alloc((size_t)readout->across * (size_t)down, sizeof *readout->psi, error);
    readout->pixels = td_alloc((size_t)readout->across * (size_t)down, sizeof *readout->pixels, error);
    readout->sums = td_alloc((size_t)readout->across * (size_t)down, sizeof *readout->sums, error);
    if (!readout->psi || !readout->pixels || !readout->sums) return TIDES_NO_MEMORY;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) readout->pixels[y / params->tile_px * readout->across + x / params->tile_px]++;
    return keep_all(s, error);
}

tides_status tides_simulator_readout(tides_simulator *simulator, const tides_readout *given, tides_error *error) {
    if (!simulator || !given)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_readout: simulator and readout must be given");
    if (simulator->started || simulator->readout.arbiter)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_readout: the run has begun, or has a readout already");
    tides_readout params;
    tides_readout_defaults(&params);
    tides_status status = TD_TAKE_STRUCT(tides_readout, &params, given, error);
    if (status != TIDES_OK || !params.enabled) return status;
    status = attach(simulator, &params, error);
    if (status != TIDES_OK) td_readout_release(&simulator->readout);
    return status;
}

tides_status tides_simulator_filters(tides_simulator *simulator, const tides_filters *given, tides_error *error) {
    if (!simulator || !given)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_filters: simulator and filters must be given");
    if (simulator->started || simulator->filters.filter)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_filters: the run has begun, or has filters already");
    tides_filters params;
    tides_filters_defaults(&params);
    tides_status status = TD_TAKE_STRUCT(tides_filters, &params, given, error);
    if (status != TIDES_OK || !tides_filters_any(&params)) return status;
    simulator->filters.params = params;
    return tides_filter_create(&params, simulator->layout.width, simulator->layout.height, simulator->sensor.sensor.seed,
                               &simulator->filters.filter, error);
}

const int64_t *tides_simulator_fired(const tides_simulator *simulator) {
    return simulator->readout.arbiter ? simulator->readout.fired : NULL;
}

void td_readout_release(td_run_readout *readout) {
    tides_arbiter_destroy(readout->arbiter);
    free(readout->psi);
    free(readout->pixels);
    free(readout->sums);
    free(readout->events);
    free(readout->fired);
    memset(readout, 0, sizeof *readout);
}

/* -- activity ------------------------------------------------------------------------------------------------------------ */

static double share(double value, double full) { return fmin(value / full, 1); }

/* Adds one of the simulator's units to the sums of the arbiter's tiles. */
static void add_tile(const tides_simulator *s, int t, int moves) {
    const td_tile *tile = &s->layout.unit[t];
    const double threshold = 0.5 * (s->sensor.sensor.threshold_on + s->sensor.sensor.threshold_off);
    for (int32_t i = 0; i < tile->count; i++) {
        int32_t x = tile->x0 + i % tile->width, y = tile->y0 + i / tile->width;
        td_activity *sum = &s->readout.sums[y / s->readout.params.tile_px * s->readout.across + x / s->readout.params.tile_px];
        size_t at = s->layout.first_pixel[t] + (size_t)i;
        double L_dot = fabs(s->now.plane[TD_PLANE_S_DOT][at]), alpha_dot = fabs(s->now.plane[TD_PLANE_ALPHA_DOT][at]);
        if (moves && isfinite(L_dot)) sum->rate += L_dot / threshold;
        if (moves && isfinite(alpha_dot)) sum->alpha += alpha_dot;
        sum->contributors += s->now.plane[TD_PLANE_CONTRIBUTORS][at];
    }
}

/* Computes readout->psi at the time reached. s->moving.list has the units that moved in the step. */
static void measure_activity(tides_simulator *s) {
    td_run_readout *readout = &s->readout;
    size_t tiles = (size_t)readout->arbiter->across * (size_t)readout->arbiter->down;
    memset(readout->sums, 0, tiles * sizeof *readout->sums);
    for (int t = 0, moved = 0; t < s->layout.units; t++) {
        int moves = moved < s->moving.count && s->moving.list[moved] == t;
        moved += moves;
        add_tile(s, t, moves);
    }
    for (size_t i = 0; i < tiles; i++)
        readout->psi[i] = (share(readout->sums[i].rate / readout->pixels[i], full_rate) +
                           share(readout->sums[i].alpha / readout->pixels[i], full_rate) +
                           share(readout->sums[i].contributors / readout->pixels[i], full_contributors)) /
                          3;
}

/* -- events -------------------------------------------------------------------------------------------------------------- */

/* A tides_readout_sink: keeps the events that leave the readout, for the packet. It stops (TIDES_CANCELLED) only if memory is
 * short. */
static int take(void *user, const tides_event *events, const int64_t *fired, size_t count) {
    td_run_readout *readout = user;
    tides_status status = td_reserve((void **)&readout->events, &readout->events_capacity, readout->count + count,
                                     sizeof *readout->events, &readout->error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&readout->fired, &readout->fired_capacity, readout->count + count, sizeof *readout->fired,
                            &readout->error);
    if (status != TIDES_OK) return 1;
    memcpy(readout->events + readout->count, events, count * sizeof *events);
    memcpy(readout->fired + readout->count, fired, count * sizeof *fired);
    readout->count += count;
    return 0;
}

tides_status td_readout_step(tides_simulator *s, tides_error *error) {
    td_run_readout *readout = &s->readout;
    tides_error *reason = error ? error : &readout->error;
    tides_status status = td_renew((void **)&s->packet.scratch, &s->packet.scratch_capacity, s->done.work.events.count,
                                   sizeof *s->packet.scratch, reason);
    if (status != TIDES_OK) return status;
    if (readout->psi) {
        measure_activity(s);
        status = tides_arbiter_activity(readout->arbiter, readout->psi, reason);
        if (status != TIDES_OK) return status;
    }
    td_event_sort(s->done.work.events.events, s->packet.scratch, s->done.work.events.count);
    status = tides_arbiter_push(readout->arbiter, s->done.work.events.events, s->done.work.events.count, take, readout, reason);
    s->done.work.events.count = 0;
    if (status == TIDES_OK && s->step == s->grid.steps) return td_readout_finish(s, error);
    return status == TIDES_CANCELLED ? td_fail(error, TIDES_NO_MEMORY, "%s", readout->error.text) : status;
}

tides_status td_readout_finish(tides_simulator *s, tides_error *error) {
    td_run_readout *readout = &s->readout;
    const tides_status status = tides_arbiter_finish(readout->arbiter, take, readout, error ? error : &readout->error);
    return status == TIDES_CANCELLED ? td_fail(error, TIDES_NO_MEMORY, "%s", readout->error.text) : status;
}
