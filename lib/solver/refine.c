/* Adaptive steps: which (tile, time) jobs a macro step needs.
 *
 * Level 0 renders every tile in which something moves at the macro step's end. Each level then halves those of the new steps
 * that the controller (control.c) finds too long, until there is none or min_step_s is reached. All tiles' midpoints of a level
 * are one batch for the renderer; equal times share a slot. */
#include "td_simulator.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { MAX_DEPTH = 24 };

/* Steps are at least so many units in the last place of the run's length so far: 3.6 ps after 1000 s. Below, their ends are no
 * longer told apart as nanoseconds with a fraction (step.c), however short min_step_s asks for. */
static const double least_steps = 16;

double td_refine_time(const td_refine *refine, double start, double stop, uint32_t at) {
    uint32_t whole = (uint32_t)1 << refine->depth;
    return at == whole ? stop : start + (stop - start) * ((double)at / (double)whole);
}

/* Halvings until steps are no longer than min_step. */
static int depth_for(double length, double min_step) {
    int depth = 0;
    while (depth < MAX_DEPTH && length > min_step * 1.000001) {
        length *= 0.5;
        depth++;
    }
    return depth;
}

/* Copies one rendered tile, kept block by block, to a sample's rows, and notes its risk. */
static void store_sample(const tides_simulator *s, const td_refine *r, int t, const double *planes, int32_t index) {
    double *sample = td_refine_sample(r, index);
    td_unpack_tile(&s->tile[t], planes, sample, sample + TD_TILE_PIXELS);
    if (r->planes_kept == TD_KEPT_ALL) td_unpack_diagnostics(&s->tile[t], planes, sample);
    r->risk[index] = s->outputs == TD_OUT_SIGNAL ? 0 : td_tile_risk(s, &s->tile[t], planes);
}

/* The samples that the moving tiles begin the macro step with: what the last one ended with. Tile t's list begins at step t. */
static tides_status begin_samples(tides_simulator *s, td_refine *r, tides_error *error) {
    tides_status status = td_reserve((void **)&r->samples, &r->sample_capacity,
                                     (size_t)s->tiles * 2 * (size_t)r->planes_kept * TD_TILE_PIXELS, sizeof *r->samples, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->step, &r->step_capacity, (size_t)s->tiles, sizeof *r->step, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->risk, &r->risk_capacity, 2 * (size_t)s->tiles, sizeof *r->risk, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < s->moving_count; i++) {
        int t = s->moving[i];
        r->risk[i] = s->tile_risk[t];
        double *sample = td_refine_sample(r, i);
        for (int k = 0; k < r->planes_kept; k++)
            memcpy(sample + k * TD_TILE_PIXELS, s->now.plane[k] + s->first_pixel[t], (size_t)s->tile[t].count * sizeof *sample);
        td_refine_step whole = {0, (uint32_t)1 << r->depth, i, s->moving_count + i, -1, t, 0, 0};
        r->step[t] = whole;
    }
    r->steps = (size_t)s->tiles;
    r->sample_count = (size_t)s->moving_count;
    return TIDES_OK;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Distinct values of `times`, sorted, in place. */
static int distinct(double *times, int count) {
    int kept = 0;
    qsort(times, (size_t)count, sizeof *times, by_value);
    for (int i = 0; i < count; i++)
        if (kept == 0 || times[i] != times[kept - 1]) times[kept++] = times[i];
    return kept;
}

static int slot_of(const double *times, int count, double time) {
    const double *found = bsearch(&time, times, (size_t)count, sizeof *times, by_value);
    return (int)(found - times);
}

/* Renders `count` samples: tile and time of each, into the samples that follow the last. */
static tides_status render_samples(tides_simulator *s, td_refine *r, const int32_t *tiles, const double *at, int count,
                                   tides_error *error) {
    size_t reals = (size_t)s->outputs * TD_TILE_PIXELS, first = r->sample_count;
    tides_status status = td_reserve((void **)&r->times, &r->time_capacity, (size_t)count, sizeof *r->times, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->requests, &r->request_capacity, (size_t)count, sizeof *r->requests, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->planes, &r->plane_capacity, (size_t)count * reals, sizeof *r->planes, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->samples, &r->sample_capacity,
                            (first + (size_t)count) * (size_t)r->planes_kept * TD_TILE_PIXELS, sizeof *r->samples, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->risk, &r->risk_capacity, first + (size_t)count, sizeof *r->risk, error);
    if (status != TIDES_OK) return status;
    memcpy(r->times, at, (size_t)count * sizeof *at);
    int slots = distinct(r->times, count);
    for (int i = 0; i < count; i++) {
        r->requests[i].tile = tiles[i];
        r->requests[i].slot = slot_of(r->times, slots, at[i]);
    }
    status = td_renderer_tiles(s->renderer, s->camera, r->times, slots, r->requests, count, s->outputs, r->planes, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < count; i++) store_sample(s, r, tiles[i], r->planes + (size_t)i * reals, (int32_t)(first + (size_t)i));
    r->sample_count += (size_t)count;
    return TIDES_OK;
}

/* Halves the pending steps around the samples from `first` on; both halves of each are the next level's new steps. */
static tides_status halve(td_refine *r, size_t first, tides_error *error) {
    tides_status status = td_reserve((void **)&r->step, &r->step_capacity, r->steps + r->pending_count, sizeof *r->step, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->halved, &r->halved_capacity, 2 * r->pending_count, sizeof *r->halved, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < r->pending_count; i++) {
        int32_t left = r->pending[i], right = (int32_t)r->steps++;
        td_refine_step *a = &r->step[left], *b = &r->step[right];
        *b = *a;
        a->to = b->from = a->from + (a->to - a->from) / 2;
        a->end = b->begin = (int32_t)(first + i);
        a->next = right;
        r->halved[2 * i] = left;
        r->halved[2 * i + 1] = right;
    }
    return TIDES_OK;
}

static tides_status reserve_level(td_refine *r, size_t count, tides_error *error) {
    tides_status status = td_reserve((void **)&r->level_tile, &r->level_tile_capacity, count, sizeof *r->level_tile, error);
    if (status != TIDES_OK) return status;
    return td_reserve((void **)&r->level_time, &r->level_time_capacity, count, sizeof *r->level_time, error);
}

/* Renders the pending steps' midpoints and halves them. */
static tides_status refine_level(tides_simulator *s, td_refine *r, double start, double stop, tides_error *error) {
    size_t count = r->pending_count, first = r->sample_count;
    tides_status status = reserve_level(r, count, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < count; i++) {
        const td_refine_step *step = &r->step[r->pending[i]];
        r->level_tile[i] = step->tile;
        r->level_time[i] = td_refine_time(r, start, stop, step->from + (step->to - step->from) / 2);
    }
    status = render_samples(s, r, r->level_tile, r->level_time, (int)count, error);
    return status == TIDES_OK ? halve(r, first, error) : status;
}

/* Level 0: every moving tile at the macro step's end. */
static tides_status render_ends(tides_simulator *s, td_refine *r, double stop, tides_error *error) {
    tides_status status = reserve_level(r, (size_t)s->moving_count, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < s->moving_count; i++) r->level_time[i] = stop;
    return render_samples(s, r, s->moving, r->level_time, s->moving_count, error);
}

tides_status td_refine_macro_step(tides_simulator *s, double start, double stop, tides_error *error) {
    td_refine *r = &s->refine;
    r->depth = depth_for(stop - start, fmax(s->min_step_s, least_steps * DBL_EPSILON * stop));
    tides_status status = td_renderer_sweep(s->renderer, s->camera, start, stop, error);
    if (status != TIDES_OK) return status;
    td_list_moving(s);
    if (s->moving_count == 0) return TIDES_OK;
    status = td_turn_knot(s, error);
    if (status == TIDES_OK) status = begin_samples(s, r, error);
    if (status == TIDES_OK) status = render_ends(s, r, stop, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->halved, &r->halved_capacity, r->steps, sizeof *r->halved, error);
    if (status != TIDES_OK) return status;
    size_t fresh = (size_t)s->moving_count;
    for (size_t i = 0; i < fresh; i++) r->halved[i] = s->moving[i];
    for (;;) {
        status = td_control_steps(s, r->halved, fresh, start, stop, error);
        if (status != TIDES_OK || r->pending_count == 0) return status;
        fresh = 2 * r->pending_count;
        status = refine_level(s, r, start, stop, error);
        if (status != TIDES_OK) return status;
    }
}

void td_refine_release(td_refine *refine) {
    free(refine->step);
    free(refine->samples);
    free(refine->risk);
    free(refine->pending);
    free(refine->halved);
    free(refine->level_tile);
    free(refine->level_time);
    free(refine->times);
    free(refine->requests);
    free(refine->planes);
    memset(refine, 0, sizeof *refine);
}
