/* One ideal pixel over one step: crossings of its local model (paper, "Comparator and sensor model"; DESIGN 3.2), then what the
 * step's end asks for. For comparator.c, which passes over the pixels that need nothing; pixel.c is its like with blocks. */
#include "signal/td_crossing.h"
#include "td_pixel.h"

#include <math.h>

/* The pixel while its step is being worked through. */
typedef struct cursor {
    uint16_t x, y;
    double on, off, initial, reference;
    uint32_t count_on, count_off;
    int32_t fired;
} cursor;

static tides_status fire(td_pixel_job *job, cursor *at, int64_t t, int polarity) {
    const tides_event event = {.t = t, .x = at->x, .y = at->y, .polarity = (int8_t)polarity, .cause = TIDES_CAUSE_SIGNAL};
    tides_status status = td_pixel_emit(job, &event, &at->fired);
    if (status != TIDES_OK) return status;
    if (polarity > 0)
        at->count_on++;
    else
        at->count_off++;
    at->reference = td_reference_of(at->on, at->off, at->initial, at->count_on, at->count_off);
    return TIDES_OK;
}

/* The model's events; `*cut` becomes 1 where there were more than max_events_per_step. */
static tides_status follow_model(td_pixel_job *job, cursor *at, const td_model *model, int *cut) {
    td_crossing_walk walk;
    td_crossing_begin(&walk, model);
    for (;;) {
        int polarity = td_crossing_next(&walk, at->reference, at->on, at->off);
        if (polarity == 0) return TIDES_OK;
        if (at->fired >= job->sensor->sensor.max_events_per_step) {
            *cut = 1;
            return TIDES_OK;
        }
        if (walk.s == 0.0) job->counts.caught_up++; /* S0 was beyond the level: after NaN, or not the S1 of the step before */
        tides_status status = fire(job, at, td_step_time(job->step, walk.s), polarity);
        if (status != TIDES_OK) return status;
    }
}

/* What S1 asks for beyond the model, at the step's end. */
static tides_status catch_up(td_pixel_job *job, cursor *at, double S1, uint64_t *late) {
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && S1 - at->reference >= at->on) {
        status = fire(job, at, job->step->stop_ns, 1);
        ++*late;
    }
    while (status == TIDES_OK && S1 - at->reference <= -at->off) {
        status = fire(job, at, job->step->stop_ns, -1);
        ++*late;
    }
    return status;
}

tides_status td_ideal_advance(td_pixel_job *job, size_t i, uint16_t x, uint16_t y, const td_model *model, double S1) {
    const td_pixels *pixels = &job->sensor->pixels;
    cursor at = {.x = x, .y = y, .initial = pixels->initial[i], .reference = pixels->reference[i]};
    at.on = job->sensor->sensor.threshold_on;
    at.off = job->sensor->sensor.threshold_off;
    at.count_on = pixels->count_on[i];
    at.count_off = pixels->count_off[i];

    tides_status status = TIDES_OK;
    int cut = 0, can_end = isfinite(S1) && isfinite(at.reference);
    job->counts.solved++;
    if (can_end && td_model_is_finite(model))
        status = follow_model(job, &at, model, &cut);
    else
        job->counts.nonfinite++;
    if (status == TIDES_OK && can_end) status = catch_up(job, &at, S1, cut ? &job->counts.truncated : &job->counts.caught_up);
    pixels->count_on[i] = at.count_on;
    pixels->count_off[i] = at.count_off;
    pixels->reference[i] = at.reference;
    return status;
}
