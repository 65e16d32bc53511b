/* Adaptive steps: which (tile, time) jobs a macro step needs.
 *
 * Level 0 renders every tile at the macro step's end. Each level then looks at the steps that are new, and halves those whose
 * estimated error is above the tolerance, until none is left or min_step_s is reached. All tiles' midpoints of a level are one
 * batch for the renderer; equal times share a slot. Without `local` one tile's failure halves the step of all. */
#include "td_simulator.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_DEPTH = 24 };

double td_refine_time(const td_refine *refine, double start, double stop, uint32_t at) {
    uint32_t whole = (uint32_t)1 << refine->depth;
    return at == whole ? stop : start + (stop - start) * ((double)at / (double)whole);
}

static double *sample_of(const td_refine *refine, int32_t sample) {
    return refine->samples + (size_t)sample * 2 * TD_TILE_PIXELS;
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

/* Copies one rendered tile, kept block by block, to a sample's rows. */
static void store_tile(const td_tile *tile, const double *planes, double *sample) {
    for (int y = 0, i = 0; i < tile->count; y++)
        for (int x = 0; x < tile->width; x++, i++) {
            int at = td_tile_pixel(x, y);
            sample[i] = planes[TD_OUT_L * TD_TILE_PIXELS + at];
            sample[TD_TILE_PIXELS + i] = planes[TD_OUT_L_DOT * TD_TILE_PIXELS + at];
        }
}

/* The samples that every tile begins the macro step with: what the last one ended with. */
static tides_status begin_samples(tides_simulator *s, td_refine *r, tides_error *error) {
    tides_status status = td_reserve((void **)&r->samples, &r->sample_capacity, (size_t)s->tiles * 4 * TD_TILE_PIXELS,
                                     sizeof *r->samples, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->step, &r->step_capacity, (size_t)s->tiles, sizeof *r->step, error);
    if (status != TIDES_OK) return status;
    for (int t = 0; t < s->tiles; t++) {
        double *sample = sample_of(r, t);
        memcpy(sample, s->now.S + s->first_pixel[t], (size_t)s->tile[t].count * sizeof *sample);
        memcpy(sample + TD_TILE_PIXELS, s->now.S_dot + s->first_pixel[t], (size_t)s->tile[t].count * sizeof *sample);
        td_refine_step whole = {0, (uint32_t)1 << r->depth, t, s->tiles + t, -1, t};
        r->step[t] = whole;
    }
    r->steps = (size_t)s->tiles;
    r->sample_count = (size_t)s->tiles;
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
    size_t reals = (size_t)TD_OUT_SIGNAL * TD_TILE_PIXELS, first = r->sample_count;
    tides_status status = td_reserve((void **)&r->times, &r->time_capacity, (size_t)count, sizeof *r->times, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->requests, &r->request_capacity, (size_t)count, sizeof *r->requests, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->planes, &r->plane_capacity, (size_t)count * reals, sizeof *r->planes, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->samples, &r->sample_capacity, (first + (size_t)count) * 2 * TD_TILE_PIXELS,
                            sizeof *r->samples, error);
    if (status != TIDES_OK) return status;
    memcpy(r->times, at, (size_t)count * sizeof *at);
    int slots = distinct(r->times, count);
    for (int i = 0; i < count; i++) {
        r->requests[i].tile = tiles[i];
        r->requests[i].slot = slot_of(r->times, slots, at[i]);
    }
    status = td_renderer_tiles(s->renderer, s->camera, r->times, slots, r->requests, count, TD_OUT_SIGNAL, r->planes, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < count; i++)
        store_tile(&s->tile[tiles[i]], r->planes + (size_t)i * reals, sample_of(r, (int32_t)(first + (size_t)i)));
    r->sample_count += (size_t)count;
    return TIDES_OK;
}

/* Does the estimate ask for halving? A step of the shortest length is accepted whatever it says. */
static int too_coarse(tides_simulator *s, const td_refine *r, const td_refine_step *step, double start, double stop) {
    const double *begin = sample_of(r, step->begin), *end = sample_of(r, step->end);
    const td_tile *tile = &s->tile[step->tile];
    td_signals signals = {begin, begin + TD_TILE_PIXELS, end, end + TD_TILE_PIXELS};
    double h = td_refine_time(r, start, stop, step->to) - td_refine_time(r, start, stop, step->from);
    td_estimate estimate = td_estimate_step(&s->comparator, h, &signals, s->pixels.reference + s->first_pixel[step->tile],
                                            tile->count);
    double threshold = s->comparator.threshold_on < s->comparator.threshold_off ? s->comparator.threshold_on
                                                                                : s->comparator.threshold_off;
    int coarse = estimate.error > s->tolerance * threshold ||
                 (s->time_tolerance_s > 0 && estimate.seconds > s->time_tolerance_s);
    int shortest = step->to - step->from == 1;
    if (coarse && !shortest) return 1;
    s->stats.steps_at_minimum += (uint64_t)(coarse && shortest);
    if (estimate.error > s->stats.worst_error * threshold) s->stats.worst_error = estimate.error / threshold;
    return 0;
}

static int contains(const uint32_t *sorted, size_t count, uint32_t value) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (sorted[middle] < value) low = middle + 1;
        else high = middle;
    }
    return low < count && sorted[low] == value;
}

static int by_position(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* One step for the whole image: whatever one tile wants halved is halved in all. `fresh` are the level's new steps. */
static tides_status join_tiles(td_refine *r, const int32_t *fresh, size_t count, tides_error *error) {
    uint32_t *wanted = td_alloc(r->pending_count, sizeof *wanted, error);
    if (!wanted) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < r->pending_count; i++) wanted[i] = r->step[r->pending[i]].from;
    qsort(wanted, r->pending_count, sizeof *wanted, by_position);
    size_t wanted_count = r->pending_count;
    r->pending_count = 0;
    for (size_t i = 0; i < count; i++)
        if (contains(wanted, wanted_count, r->step[fresh[i]].from)) r->pending[r->pending_count++] = fresh[i];
    free(wanted);
    return TIDES_OK;
}

/* Which of the `count` new steps are to be halved: pending. */
static tides_status choose(tides_simulator *s, td_refine *r, const int32_t *fresh, size_t count, double start, double stop,
                           tides_error *error) {
    tides_status status = td_reserve((void **)&r->pending, &r->pending_capacity, count, sizeof *r->pending, error);
    if (status != TIDES_OK) return status;
    r->pending_count = 0;
    for (size_t i = 0; i < count; i++)
        if (too_coarse(s, r, &r->step[fresh[i]], start, stop)) r->pending[r->pending_count++] = fresh[i];
    s->stats.steps_rejected += r->pending_count;
    return s->local || r->pending_count == 0 ? TIDES_OK : join_tiles(r, fresh, count, error);
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

/* Renders the pending steps' midpoints and halves them. */
static tides_status refine_level(tides_simulator *s, td_refine *r, double start, double stop, tides_error *error) {
    size_t count = r->pending_count, first = r->sample_count;
    int32_t *tiles = td_alloc(count, sizeof *tiles, error);
    double *at = td_alloc(count, sizeof *at, error);
    tides_status status = tiles && at ? TIDES_OK : TIDES_NO_MEMORY;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const td_refine_step *step = &r->step[r->pending[i]];
        tiles[i] = step->tile;
        at[i] = td_refine_time(r, start, stop, step->from + (step->to - step->from) / 2);
    }
    if (status == TIDES_OK) status = render_samples(s, r, tiles, at, (int)count, error);
    if (status == TIDES_OK) status = halve(r, first, error);
    free(at);
    free(tiles);
    return status;
}

/* Level 0: every tile at the macro step's end. */
static tides_status render_ends(tides_simulator *s, td_refine *r, double stop, tides_error *error) {
    int32_t *tiles = td_alloc((size_t)s->tiles, sizeof *tiles, error);
    double *at = td_alloc((size_t)s->tiles, sizeof *at, error);
    tides_status status = tiles && at ? TIDES_OK : TIDES_NO_MEMORY;
    for (int t = 0; t < s->tiles && status == TIDES_OK; t++) {
        tiles[t] = t;
        at[t] = stop;
    }
    if (status == TIDES_OK) status = render_samples(s, r, tiles, at, s->tiles, error);
    free(at);
    free(tiles);
    return status;
}

tides_status td_refine_macro_step(tides_simulator *s, double start, double stop, tides_error *error) {
    td_refine *r = &s->refine;
    r->depth = depth_for(stop - start, s->min_step_s);
    tides_status status = begin_samples(s, r, error);
    if (status == TIDES_OK) status = td_renderer_sweep(s->renderer, s->camera, start, stop, error);
    if (status == TIDES_OK) status = render_ends(s, r, stop, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->halved, &r->halved_capacity, r->steps, sizeof *r->halved, error);
    if (status != TIDES_OK) return status;
    size_t fresh = r->steps;
    for (size_t i = 0; i < fresh; i++) r->halved[i] = (int32_t)i;
    for (;;) {
        status = choose(s, r, r->halved, fresh, start, stop, error);
        if (status != TIDES_OK || r->pending_count == 0) return status;
        fresh = 2 * r->pending_count;
        status = refine_level(s, r, start, stop, error);
        if (status != TIDES_OK) return status;
    }
}

void td_refine_release(td_refine *refine) {
    free(refine->step);
    free(refine->samples);
    free(refine->pending);
    free(refine->halved);
    free(refine->times);
    free(refine->requests);
    free(refine->planes);
    memset(refine, 0, sizeof *refine);
}
