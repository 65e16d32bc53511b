/* Ideal pixels together. Which levels a pixel goes through in a step can be told from its values where the model turns, without
 * solving an equation: they are listed for a run of pixels, their places are found all at once (signal/crossing_list.c), and
 * then the events are written. Pixels with anything out of the ordinary (signals that aren't finite, or beyond a level at the
 * step's start; more events than a step may have; an end that asks for more than the model fired) go through td_ideal.h. */
#include "td_ideal_block.h"

#include "signal/td_crossing_list.h"
#include "td_ideal.h"
#include "td_wide.h"

/* A pixel whose levels are listed, and what becomes of it. */
typedef struct listed {
    size_t k;         /* in the block */
    int first, last;  /* its levels: [first, last) */
    int is_plain;     /* 0: its levels aren't there, it takes the long way */
    uint32_t on, off; /* counts and reference afterwards */
    double reference;
} listed;

typedef struct run {
    td_pixel_job *job;
    const td_ideal_block *block;
    td_crossing_list list;
    listed pixel[TD_IDEAL_BLOCK];
    int pixels;
} run;

static inline td_model model_of(const run *r, size_t k) {
    const td_signals *at = r->block->signals;
    const size_t j = r->block->begin + k;
    const int32_t kind = r->job->sensor->model;
    double S0_dot = kind == TIDES_MODEL_SECANT ? 0.0 : at->S0_dot[j];
    double S1_dot = kind == TIDES_MODEL_HERMITE ? at->S1_dot[j] : 0.0;
    return td_model_fit(kind, r->job->step->length_s, at->S0[j], S0_dot, at->S1[j], S1_dot);
}

/* -- listing --------------------------------------------------------------------------------------------------------------- */

/* The levels on one monotone piece; 0 where they are too many. */
static int list_piece(run *r, listed *p, const td_model *model, const double end[2], const double value[2]) {
    const tides_sensor *sensor = &r->job->sensor->sensor;
    const double on = sensor->threshold_on, off = sensor->threshold_off;
    const int first = r->list.count;
    const double initial = r->job->sensor->pixels.initial[r->block->first + r->block->begin + p->k];
    for (;;) {
        const double residual = value[1] - p->reference;
        const int rises = residual >= on, falls = residual <= -off;
        if (!(rises || falls)) return 1;
        if (r->list.count == TD_CROSSING_LIST_ROOM || r->list.count - p->first >= sensor->max_events_per_step) return 0;
        const td_level level = {model, p->reference, rises ? on : -off};
        td_crossing_list_add(&r->list, &level, first, end, value);
        if (rises)
            p->on++;
        else
            p->off++;
        p->reference = td_reference_of(on, off, initial, p->on, p->off);
    }
}

/* All levels of a pixel; 0 where it must take the long way. */
static int list_levels(run *r, listed *p, double S1) {
    const tides_sensor *sensor = &r->job->sensor->sensor;
    const td_model model = model_of(r, p->k);
    td_crossing_walk walk;
    if (!(isfinite(S1) && isfinite(p->reference) && td_model_is_finite(&model))) return 0;
    td_crossing_begin(&walk, &model, NULL);
    const double residual = walk.value[0] - p->reference;
    if (residual >= sensor->threshold_on || residual <= -sensor->threshold_off) return 0;
    for (int piece = 1; piece < walk.knots; piece++)
        if (!list_piece(r, p, &model, walk.knot + piece - 1, walk.value + piece - 1)) return 0;
    return S1 - p->reference < sensor->threshold_on && S1 - p->reference > -sensor->threshold_off;
}

/* Lists pixel k: 1, or 0 and no levels of it. */
static int list_pixel(run *r, size_t k) {
    const td_pixels *pixels = &r->job->sensor->pixels;
    const size_t j = r->block->begin + k, i = r->block->first + j;
    listed *p = &r->pixel[r->pixels++];
    *p = (listed){k, r->list.count, 0, 0, pixels->count_on[i], pixels->count_off[i], pixels->reference[i]};
    p->is_plain = list_levels(r, p, r->block->signals->S1[j]);
    if (!p->is_plain) r->list.count = p->first;
    p->last = r->list.count;
    return p->is_plain;
}

/* -- firing ---------------------------------------------------------------------------------------------------------------- */

static uint16_t column(const td_tile *tile, size_t j) { return (uint16_t)(tile->x0 + (int32_t)j % tile->width); }

static uint16_t row(const td_tile *tile, size_t j) { return (uint16_t)(tile->y0 + (int32_t)j / tile->width); }

/* The events of the pixel's levels, whose places are known. */
static tides_status fire_levels(run *r, const listed *p) {
    td_pixel_job *job = r->job;
    td_crossing_list *list = &r->list;
    const td_pixels *pixels = &job->sensor->pixels;
    const size_t j = r->block->begin + p->k, i = r->block->first + j;
    const size_t count = (size_t)(p->last - p->first);
    td_event_buffer *buffer = job->buffer;
    if (buffer->capacity - buffer->count < count) {
        tides_status status = td_event_buffer_reserve(buffer, count + TD_EVENT_BUFFER_GROWTH, job->error);
        if (status != TIDES_OK) return status;
    }
    tides_event *to = buffer->events + buffer->count;
    const uint16_t x = column(r->block->tile, j), y = row(r->block->tile, j);
    for (int k = p->first; k < p->last; k++, to++) {
        to->t = td_crossing_list_time(list, job->step, k);
        to->x = x;
        to->y = y;
        to->polarity = list->rise[k] > 0.0 ? 1 : -1;
        to->cause = TIDES_CAUSE_SIGNAL;
        to->frontend = 0;
    }
    buffer->count += count;
    job->counts.solved++;
    job->counts.events_on += p->on - pixels->count_on[i];
    job->counts.events_off += p->off - pixels->count_off[i];
    pixels->count_on[i] = p->on;
    pixels->count_off[i] = p->off;
    pixels->reference[i] = p->reference;
    return TIDES_OK;
}

static tides_status take_long_way(run *r, size_t k) {
    const td_model model = model_of(r, k);
    const td_ideal_block *b = r->block;
    const size_t j = b->begin + k;
    return td_ideal_advance(r->job, b->first + j, column(b->tile, j), row(b->tile, j), &model, NULL, b->signals->S1[j]);
}

static tides_status fire(run *r) {
    tides_status status = TIDES_OK;
    td_crossing_list_solve(&r->list, r->job->step);
    for (int n = 0; n < r->pixels && status == TIDES_OK; n++)
        status = r->pixel[n].is_plain ? fire_levels(r, &r->pixel[n]) : take_long_way(r, r->pixel[n].k);
    r->pixels = 0;
    td_crossing_list_clear(&r->list);
    return status;
}

tides_status td_ideal_block_step(td_pixel_job *job, const td_ideal_block *block, const double *mark) {
    run r;
    r.job = job;
    r.block = block;
    r.pixels = 0;
    td_crossing_list_clear(&r.list);
    tides_status status = TIDES_OK;
    for (size_t k = 0; (k = td_next_mark(mark, k, block->count)) < block->count && status == TIDES_OK; k++) {
        if (list_pixel(&r, k) || r.pixels == 1) continue;
        r.pixels--; /* what found no room may find it in an empty list */
        status = fire(&r);
        list_pixel(&r, k);
    }
    return status == TIDES_OK && r.pixels > 0 ? fire(&r) : status;
}
