/* Internal: one ideal pixel over one step: crossings of its local model (paper, "Comparator and sensor model"; DESIGN 3.2),
 * then those that the signal at the step's end asks for.
 *
 * Inline, so that the model stays in registers. As functions in a file of their own, they made tiles in which half of the
 * pixels cross once 2 to 4 % slower (bench_comparator). */
#ifndef TD_IDEAL_H
#define TD_IDEAL_H

#include "signal/td_crossing.h"
#include "td_between.h"
#include "td_pixel.h"

#include <math.h>

/* A pixel on its way through the step. */
typedef struct td_ideal {
    uint16_t x, y;
    double on, off, initial, reference;
    uint32_t count_on, count_off;
    int32_t fired;
} td_ideal;

static inline tides_status td_ideal_fire(td_pixel_job *job, td_ideal *at, int64_t t, int polarity) {
    const tides_event event = {.t = t, .x = at->x, .y = at->y, .polarity = (int8_t)polarity, .cause = TIDES_CAUSE_SIGNAL};
    tides_status status = td_pixel_emit(job, &event, &at->fired);
    if (status != TIDES_OK) return status;
    if (polarity > 0)
        at->count_on++;
    else
        at->count_off++;
    at->reference = td_reference_at(at->on, at->off, at->initial, at->count_on, at->count_off);
    return TIDES_OK;
}

/* Fires the model's events. The model holds on [from, from + length] of the step. `*cut` becomes 1 where there were more than
 * max_events_per_step. */
static inline tides_status td_ideal_follow(td_pixel_job *job, td_ideal *at, const td_model *model, double from, double length,
                                           const td_tie *tie, int *cut) {
    td_crossing_walk walk;
    td_step part = *job->step;
    part.start_fraction += from * part.length_ns;
    part.length_ns *= length;
    td_crossing_begin(&walk, model, &part);
    if (tie) walk.tie = *tie;
    for (;;) {
        int polarity = td_crossing_next(&walk, at->reference, at->on, at->off);
        if (polarity == 0) return TIDES_OK;
        if (at->fired >= job->sensor->sensor.max_events_per_step) {
            *cut = 1;
            return TIDES_OK;
        }
        double s = from + length * walk.s;
        if (s == 0.0) job->counts.caught_up++; /* S0 was beyond the level: after NaN, or S0 differs from the last step's S1 */
        tides_status status = td_ideal_fire(job, at, td_step_time(job->step, s), polarity);
        if (status != TIDES_OK) return status;
        td_pixel_note(job, s, at->reference, polarity, 1);
    }
}

/* td_ideal_follow over the pieces of a model, one by one. */
static inline tides_status td_ideal_follow_pieces(td_pixel_job *job, td_ideal *at, const td_pieces *pieces, int *cut) {
    tides_status status = TIDES_OK;
    for (int k = 0; k < pieces->count && status == TIDES_OK && !*cut; k++) {
        const double length = pieces->from[k + 1] - pieces->from[k];
        const td_tie tie = td_pieces_tie(pieces, k);
        status = td_ideal_follow(job, at, &pieces->model[k], pieces->from[k], length, &tie, cut);
    }
    return status;
}

/* Fires at the step's end the events for which S1 asks and which the model didn't give. */
static inline tides_status td_ideal_catch_up(td_pixel_job *job, td_ideal *at, double S1, uint64_t *late) {
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && S1 - at->reference >= at->on) {
        status = td_ideal_fire(job, at, job->step->stop_ns, 1);
        td_pixel_note(job, 1, at->reference, 1, 1);
        ++*late;
    }
    while (status == TIDES_OK && S1 - at->reference <= -at->off) {
        status = td_ideal_fire(job, at, job->step->stop_ns, -1);
        td_pixel_note(job, 1, at->reference, -1, 1);
        ++*late;
    }
    return status;
}

/* Advances pixel i at (x, y): by its model, or by its pieces where there are any, then by its signal at the step's end. On
 * failure the pixel's counts are those of the events in the buffer. */
static inline TIDES_MUST_CHECK tides_status td_ideal_advance(td_pixel_job *job, size_t i, uint16_t x, uint16_t y,
                                                             const td_model *model, const td_pieces *pieces, double S1) {
    const td_pixels *pixels = &job->sensor->pixels;
    td_ideal at = {.x = x, .y = y, .initial = pixels->initial[i], .reference = pixels->reference[i]};
    at.on = job->sensor->sensor.threshold_on;
    at.off = job->sensor->sensor.threshold_off;
    at.count_on = pixels->count_on[i];
    at.count_off = pixels->count_off[i];

    tides_status status = TIDES_OK;
    int cut = 0, can_end = isfinite(S1) && isfinite(at.reference);
    job->counts.solved++;
    if (can_end && td_model_is_finite(model))
        status = pieces ? td_ideal_follow_pieces(job, &at, pieces, &cut) : td_ideal_follow(job, &at, model, 0, 1, NULL, &cut);
    else
        job->counts.nonfinite++;
    if (status == TIDES_OK && can_end)
        status = td_ideal_catch_up(job, &at, S1, cut ? &job->counts.truncated : &job->counts.caught_up);
    pixels->count_on[i] = at.count_on;
    pixels->count_off[i] = at.count_off;
    pixels->reference[i] = at.reference;
    return status;
}

#endif
