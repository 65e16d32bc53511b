/* The readout in a run: after each step on the grid its events go through the arbiter, under the activity at the step's end.
 *
 * psi of a tile is the mean of three shares, each cut off at 1: its pixels' mean |L_dot| / C (C the mean of both nominal
 * thresholds) over 100 per second, their mean |alpha_dot| over 100 per second, and their mean number of contributors over 64.
 * 100 events a second and pixel are as busy as tiles of recordings come; 64 is where the risk score's norm ends too
 * (control.c). In a tile in which nothing moved in the step both rates are 0. */
#include "signal/td_event_sort.h"
#include "td_simulator.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>

static const double full_rate = 100, full_contributors = 64;

/* -- attaching ------------------------------------------------------------------------------------------------------------- */

/* From now on samples have diagnostics. */
static tides_status keep_all(tides_simulator *s, tides_error *error) {
    size_t pixels = s->first_pixel[s->tiles], samples = (size_t)s->batch_limit * (size_t)s->tiles;
    for (int p = TD_KEPT_SIGNAL; p < TD_KEPT_ALL; p++) {
        if (!s->now.plane[p]) s->now.plane[p] = td_alloc(pixels, sizeof(double), error);
        if (!s->next.plane[p]) s->next.plane[p] = td_alloc(pixels, sizeof(double), error);
        if (!s->now.plane[p] || !s->next.plane[p]) return TIDES_NO_MEMORY;
    }
    double *planes = td_alloc(samples * TD_OUT_DIAGNOSTICS * TD_TILE_PIXELS, sizeof *planes, error);
    if (!planes) return TIDES_NO_MEMORY;
    free(s->planes);
    s->planes = planes;
    s->planes_kept = s->refine.samples.kept = TD_KEPT_ALL;
    s->outputs = TD_OUT_DIAGNOSTICS;
    td_refine_bound(s);
    return td_renderer_prepare(s->renderer, TD_OUT_DIAGNOSTICS, error);
}

static tides_status attach(tides_simulator *s, const tides_readout *readout, tides_error *error) {
    td_scan *scan = &s->scan;
    int32_t width = s->width, height = s->height, down;
    tides_status status = tides_arbiter_create(readout, width, height, s->sensor.sensor.seed, &scan->arbiter, error);
    if (status != TIDES_OK) return status;
    tides_arbiter_start(scan->arbiter, s->epoch_ns);
    scan->readout = *readout;
    tides_arbiter_tiles(scan->arbiter, &scan->across, &down);
    scan->psi = td_alloc((size_t)scan->across * (size_t)down, sizeof *scan->psi, error);
    scan->pixels = td_alloc((size_t)scan->across * (size_t)down, sizeof *scan->pixels, error);
    scan->sums = td_alloc((size_t)scan->across * (size_t)down, sizeof *scan->sums, error);
    if (!scan->psi || !scan->pixels || !scan->sums) return TIDES_NO_MEMORY;
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) scan->pixels[y / readout->tile_px * scan->across + x / readout->tile_px]++;
    return keep_all(s, error);
}

tides_status tides_simulator_readout(tides_simulator *simulator, const tides_readout *given, tides_error *error) {
    if (!simulator || !given)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_readout: simulator and readout must be given");
    if (simulator->started || simulator->scan.arbiter)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_readout: the run has begun, or has a readout already");
    tides_readout readout;
    tides_readout_defaults(&readout);
    tides_status status = TD_TAKE_STRUCT(tides_readout, &readout, given, error);
    if (status != TIDES_OK || !readout.enabled) return status;
    status = attach(simulator, &readout, error);
    if (status != TIDES_OK) td_scan_release(&simulator->scan);
    return status;
}

const int64_t *tides_simulator_fired(const tides_simulator *simulator) {
    return simulator->scan.arbiter ? simulator->scan.fired : NULL;
}

void td_scan_release(td_scan *scan) {
    tides_arbiter_destroy(scan->arbiter);
    free(scan->psi);
    free(scan->pixels);
    free(scan->sums);
    free(scan->events);
    free(scan->fired);
    memset(scan, 0, sizeof *scan);
}

/* -- activity ------------------------------------------------------------------------------------------------------------ */

static double share(double value, double full) { return fmin(value / full, 1); }

/* What one of the simulator's tiles adds to the sums of the arbiter's. */
static void add_tile(tides_simulator *s, int t, int moves) {
    const td_tile *tile = &s->tile[t];
    const double threshold = 0.5 * (s->comparator.threshold_on + s->comparator.threshold_off);
    for (int32_t i = 0; i < tile->count; i++) {
        int32_t x = tile->x0 + i % tile->width, y = tile->y0 + i / tile->width;
        td_activity *sum = &s->scan.sums[y / s->scan.readout.tile_px * s->scan.across + x / s->scan.readout.tile_px];
        size_t at = s->first_pixel[t] + (size_t)i;
        double L_dot = fabs(s->now.plane[TD_KEPT_S_DOT][at]), alpha_dot = fabs(s->now.plane[TD_KEPT_ALPHA_DOT][at]);
        if (moves && isfinite(L_dot)) sum->rate += L_dot / threshold;
        if (moves && isfinite(alpha_dot)) sum->alpha += alpha_dot;
        sum->contributors += s->now.plane[TD_KEPT_CONTRIBUTORS][at];
    }
}

/* scan->psi of the time reached; the tiles in s->moving moved on the way there. */
static void measure_activity(tides_simulator *s) {
    td_scan *scan = &s->scan;
    size_t tiles = (size_t)scan->arbiter->across * (size_t)scan->arbiter->down;
    memset(scan->sums, 0, tiles * sizeof *scan->sums);
    for (int t = 0, moved = 0; t < s->tiles; t++) {
        int moves = moved < s->moving_count && s->moving[moved] == t;
        moved += moves;
        add_tile(s, t, moves);
    }
    for (size_t i = 0; i < tiles; i++)
        scan->psi[i] =
            (share(scan->sums[i].rate / scan->pixels[i], full_rate) + share(scan->sums[i].alpha / scan->pixels[i], full_rate) +
             share(scan->sums[i].contributors / scan->pixels[i], full_contributors)) /
            3;
}

/* -- events -------------------------------------------------------------------------------------------------------------- */

/* A tides_readout_sink: keeps what leaves for the packet. */
static int take(void *user, const tides_event *events, const int64_t *fired, size_t count) {
    td_scan *scan = user;
    tides_status status =
        td_reserve((void **)&scan->events, &scan->events_capacity, scan->count + count, sizeof *scan->events, &scan->error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&scan->fired, &scan->fired_capacity, scan->count + count, sizeof *scan->fired, &scan->error);
    if (status != TIDES_OK) return 1;
    memcpy(scan->events + scan->count, events, count * sizeof *events);
    memcpy(scan->fired + scan->count, fired, count * sizeof *fired);
    scan->count += count;
    return 0;
}

tides_status td_scan_step(tides_simulator *s, tides_error *error) {
    td_scan *scan = &s->scan;
    tides_error *reason = error ? error : &scan->error;
    tides_status status = td_reserve((void **)&s->scratch, &s->scratch_capacity, s->events.count, sizeof *s->scratch, reason);
    if (status != TIDES_OK) return status;
    measure_activity(s);
    status = tides_arbiter_activity(scan->arbiter, scan->psi, reason);
    if (status != TIDES_OK) return status;
    td_event_sort(s->events.events, s->scratch, s->events.count);
    status = tides_arbiter_push(scan->arbiter, s->events.events, s->events.count, take, scan, reason);
    s->events.count = 0;
    if (status == TIDES_OK && s->step == s->steps) status = tides_arbiter_finish(scan->arbiter, take, scan, reason);
    return status == TIDES_CANCELLED ? td_fail(error, TIDES_NO_MEMORY, "%s", scan->error.text) : status;
}
