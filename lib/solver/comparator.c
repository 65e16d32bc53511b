/* The residual-state comparator (paper, "Comparator and sensor model"; DESIGN 3.2 and 3.3) over the pixels of a tile.
 *
 * Most pixels do nothing in most steps. Blocks of them are rejected by comparing the model's control values with the levels, in
 * loops that compilers turn into vector code; only what is left goes to crossing.c, one pixel after the other. */
#include "td_comparator.h"
#include "td_base.h"
#include "signal/td_crossing.h"

#include <float.h>
#include <math.h>

/* -- parameters and state ------------------------------------------------------------------------------------------------ */

tides_status td_comparator_check(const td_comparator *comparator, tides_error *error) {
    if (!(comparator->threshold_on > 0.0 && comparator->threshold_on <= DBL_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "threshold_on is %g; it must be finite and above 0",
                       comparator->threshold_on);
    if (!(comparator->threshold_off > 0.0 && comparator->threshold_off <= DBL_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "threshold_off is %g; it must be finite and above 0",
                       comparator->threshold_off);
    if (comparator->model < TIDES_MODEL_LINEAR || comparator->model > TIDES_MODEL_SECANT)
        return td_fail(error, TIDES_BAD_ARGUMENT, "model is %d; it must be one of TIDES_MODEL_*", (int)comparator->model);
    if (comparator->max_events_per_step < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "max_events_per_step is %d; it must be at least 1",
                       (int)comparator->max_events_per_step);
    return TIDES_OK;
}

void td_pixels_reset(const td_pixels *pixels, const double *S, size_t count) {
    for (size_t i = 0; i < count; i++) {
        pixels->initial[i] = pixels->reference[i] = S[i];
        pixels->count_on[i] = pixels->count_off[i] = 0;
    }
}

double td_comparator_worst_residual(const td_comparator *comparator, const td_pixels *pixels, const double *S, size_t count) {
    double worst = 0.0;
    for (size_t i = 0; i < count; i++) {
        double residual = S[i] - pixels->reference[i];
        double relative = residual > 0.0 ? residual / comparator->threshold_on : -residual / comparator->threshold_off;
        if (relative > worst) worst = relative;
    }
    return worst;
}

/* -- one pixel ----------------------------------------------------------------------------------------------------------- */

/* What the parts of a call share. */
typedef struct tile_job {
    const td_comparator *comparator;
    const td_step *step;
    const td_tile *tile;
    const td_signals *signals;
    const td_pixels *pixels;
    td_event_buffer *buffer;
    td_comparator_counts counts; /* of this call */
    tides_error *error;
} tile_job;

/* A pixel while its step is being worked through. */
typedef struct cursor {
    tides_event event; /* the next event, but for time and polarity */
    double initial, reference;
    uint32_t count_on, count_off;
    int32_t fired;
} cursor;

static tides_status fire(tile_job *job, cursor *at, int64_t t, int polarity) {
    if (at->fired == TD_EVENTS_PER_PIXEL_MAX)
        return td_fail(job->error, TIDES_OUT_OF_RANGE,
                       "pixel (%d, %d) would fire more than %d events before %lld ns: raise the thresholds or mend the signal",
                       at->event.x, at->event.y, (int)TD_EVENTS_PER_PIXEL_MAX, (long long)job->step->stop_ns);
    at->event.t = t;
    at->event.polarity = (int8_t)polarity;
    tides_status status = td_event_buffer_add(job->buffer, &at->event, job->error);
    if (status != TIDES_OK) return status;
    at->fired++;
    if (polarity > 0) {
        at->count_on++;
        job->counts.events_on++;
    } else {
        at->count_off++;
        job->counts.events_off++;
    }
    at->reference = td_reference(job->comparator, at->initial, at->count_on, at->count_off);
    return TIDES_OK;
}

/* The model's events; `*cut` becomes 1 where there were more than max_events_per_step. */
static tides_status follow_model(tile_job *job, cursor *at, const td_model *model, int *cut) {
    const td_comparator *c = job->comparator;
    td_crossing_walk walk;
    td_crossing_begin(&walk, model);
    for (;;) {
        int polarity = td_crossing_next(&walk, at->reference, c->threshold_on, c->threshold_off);
        if (polarity == 0) return TIDES_OK;
        if (at->fired >= c->max_events_per_step) {
            *cut = 1;
            return TIDES_OK;
        }
        if (walk.s == 0.0) job->counts.caught_up++; /* S0 was beyond the level: after NaN, or not the S1 of the step before */
        tides_status status = fire(job, at, td_step_time(job->step, walk.s), polarity);
        if (status != TIDES_OK) return status;
    }
}

/* What S1 asks for beyond the model, at the step's end. */
static tides_status catch_up(tile_job *job, cursor *at, double S1, uint64_t *late) {
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && S1 - at->reference >= job->comparator->threshold_on) {
        status = fire(job, at, job->step->stop_ns, 1);
        ++*late;
    }
    while (status == TIDES_OK && S1 - at->reference <= -job->comparator->threshold_off) {
        status = fire(job, at, job->step->stop_ns, -1);
        ++*late;
    }
    return status;
}

/* Rates that the model doesn't read count as 0; `kind` is a constant where this is inlined into vector loops. */
static inline td_model fit_pixel(int32_t kind, const td_signals *signals, double h, size_t i) {
    double S0_dot = kind == TIDES_MODEL_SECANT ? 0.0 : signals->S0_dot[i];
    double S1_dot = kind == TIDES_MODEL_HERMITE ? signals->S1_dot[i] : 0.0;
    return td_model_fit(kind, h, signals->S0[i], S0_dot, signals->S1[i], S1_dot);
}

static tides_status solve_pixel(tile_job *job, size_t i) {
    const td_tile *tile = job->tile;
    const td_pixels *pixels = job->pixels;
    cursor at = {.initial = pixels->initial[i], .reference = pixels->reference[i]};
    at.count_on = pixels->count_on[i];
    at.count_off = pixels->count_off[i];
    at.event.x = (uint16_t)(tile->x0 + (int32_t)i % tile->width);
    at.event.y = (uint16_t)(tile->y0 + (int32_t)i / tile->width);

    double S1 = job->signals->S1[i];
    td_model model = fit_pixel(job->comparator->model, job->signals, job->step->length_s, i);
    tides_status status = TIDES_OK;
    int cut = 0, can_end = isfinite(S1) && isfinite(at.reference);
    job->counts.solved++;
    if (can_end && td_model_is_finite(&model))
        status = follow_model(job, &at, &model, &cut);
    else
        job->counts.nonfinite++;
    if (status == TIDES_OK && can_end) status = catch_up(job, &at, S1, cut ? &job->counts.truncated : &job->counts.caught_up);
    pixels->count_on[i] = at.count_on; /* also after a failure: `undo` goes by the events in the buffer */
    pixels->count_off[i] = at.count_off;
    pixels->reference[i] = at.reference;
    return status;
}

/* -- the tile ------------------------------------------------------------------------------------------------------------ */

enum { BLOCK = 64 }; /* pixels tested together: their flags stay in L1 */

/* outside[j] = 0 where pixel first + j can't fire: the model's control values and S1 all lie strictly between the levels (NaN
 * doesn't); otherwise 1. With `kind` constant the loop is straight-line code that vectorises (gcc -O3 -fopt-info-vec names
 * it). The flags are doubles, set one comparison at a time, because gcc 12 gives up where comparisons of doubles end in
 * integers. */
static inline void reject(int32_t kind, const td_comparator *comparator, double h, const td_signals *signals,
                          const double *reference, size_t first, size_t count, double *restrict outside) {
    const double on = comparator->threshold_on, off = -comparator->threshold_off;
    const td_signals from = *signals;
    for (size_t j = 0; j < count; j++) {
        size_t i = first + j;
        td_model model = fit_pixel(kind, &from, h, i);
        double r0 = model.control[0] - reference[i], r1 = model.control[1] - reference[i];
        double r2 = model.control[2] - reference[i], r3 = model.control[3] - reference[i];
        double last = from.S1[i] - reference[i];
        double flag = r0 < on ? 0.0 : 1.0;
        flag = r0 > off ? flag : 1.0;
        flag = r1 < on ? flag : 1.0;
        flag = r1 > off ? flag : 1.0;
        flag = r2 < on ? flag : 1.0;
        flag = r2 > off ? flag : 1.0;
        flag = r3 < on ? flag : 1.0;
        flag = r3 > off ? flag : 1.0;
        flag = last < on ? flag : 1.0;
        outside[j] = last > off ? flag : 1.0;
    }
}

/* `reject` for the model at hand, each with its own loop. */
static void reject_block(const tile_job *job, size_t first, size_t count, double *outside) {
    const td_comparator *c = job->comparator;
    const double *reference = job->pixels->reference;
    double h = job->step->length_s;
    switch (c->model) {
        case TIDES_MODEL_LINEAR: reject(TIDES_MODEL_LINEAR, c, h, job->signals, reference, first, count, outside); break;
        case TIDES_MODEL_QUADRATIC: reject(TIDES_MODEL_QUADRATIC, c, h, job->signals, reference, first, count, outside); break;
        case TIDES_MODEL_SECANT: reject(TIDES_MODEL_SECANT, c, h, job->signals, reference, first, count, outside); break;
        default: reject(TIDES_MODEL_HERMITE, c, h, job->signals, reference, first, count, outside); break;
    }
}

/* Takes back the events from `first` on: each says which count it has raised. */
static void undo(const tile_job *job, size_t first) {
    const td_pixels *pixels = job->pixels;
    for (size_t k = first; k < job->buffer->count; k++) {
        const tides_event *event = &job->buffer->events[k];
        size_t i = (size_t)(event->y - job->tile->y0) * (size_t)job->tile->width + (size_t)(event->x - job->tile->x0);
        if (event->polarity > 0)
            pixels->count_on[i]--;
        else
            pixels->count_off[i]--;
        pixels->reference[i] = td_reference(job->comparator, pixels->initial[i], pixels->count_on[i], pixels->count_off[i]);
    }
    job->buffer->count = first;
}

static void add_counts(td_comparator_counts *sum, const td_comparator_counts *more) {
    sum->events_on += more->events_on;
    sum->events_off += more->events_off;
    sum->truncated += more->truncated;
    sum->caught_up += more->caught_up;
    sum->solved += more->solved;
    sum->nonfinite += more->nonfinite;
}

tides_status td_comparator_step(const td_comparator *comparator, const td_step *step, const td_tile *tile,
                                const td_signals *signals, const td_pixels *pixels, td_event_buffer *buffer,
                                td_comparator_counts *counts, tides_error *error) {
    tile_job job = {comparator, step, tile, signals, pixels, buffer, {0}, error};
    size_t before = buffer->count, pixel_count = (size_t)tile->count;
    double outside[BLOCK];
    for (size_t first = 0; first < pixel_count; first += BLOCK) {
        size_t count = pixel_count - first < BLOCK ? pixel_count - first : BLOCK;
        if (!comparator->exhaustive) reject_block(&job, first, count, outside);
        for (size_t j = 0; j < count; j++) {
            if (!comparator->exhaustive && outside[j] == 0.0) continue;
            tides_status status = solve_pixel(&job, first + j);
            if (status != TIDES_OK) {
                undo(&job, before);
                return status;
            }
        }
    }
    add_counts(counts, &job.counts);
    return TIDES_OK;
}
