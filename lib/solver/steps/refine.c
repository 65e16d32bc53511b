/* Adaptive steps: which (unit, time) jobs a macro step needs.
 *
 * Level 0 renders every unit in which something moves, at the macro step's end, and inside it where the error is controlled.
 * Each level then cuts the new steps that the controller finds too long, until there are none or min_step_s is reached. All
 * jobs of a level are one batch of the renderer; jobs of equal time share a slot. */
#include "solver/td_probe.h"
#include "solver/td_simulator.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Positions within a macro step are finer than the shortest step by 2^SHORTEST_BITS, because cuts aren't in the middle. */
enum { MAX_DEPTH = 24, SHORTEST_BITS = 6 };

/* Steps are at least this many units in the last place of the run's length so far: 3.6 ps after 1000 s. Shorter ones have ends
 * that can't be told apart as nanoseconds with a fraction, whatever min_step_s is. */
static const double least_steps = 16;

/* A step between two knots may be cut into so many parts, however short it is. A leap of a microsecond that was one step of
 * min_step_s had a third of its events. */
static const double parts_between_knots = 64;

/* Halvings until steps are no longer than min_step. */
static int depth_for(double length, double min_step) {
    int depth = 0;
    while (depth < MAX_DEPTH && length > min_step * 1.000001) {
        length *= 0.5;
        depth++;
    }
    return depth;
}

static double shortest_step(const tides_simulator *s, double start, double stop) {
    const int is_between = td_grid_is_knot(&s->grid, s->step) && td_grid_is_knot(&s->grid, s->step + 1);
    const double asked = is_between ? fmin(s->given.min_step_s, (stop - start) / parts_between_knots) : s->given.min_step_s;
    return fmax(asked, least_steps * DBL_EPSILON * stop);
}

/* Adds a job for a new sample to the level. */
static tides_status add_job(tides_simulator *s, int unit, double time, tides_error *error) {
    int32_t sample;
    tides_status status = td_samples_take(&s->refine.samples, &sample, error);
    return status == TIDES_OK ? td_launch_add(&s->launch, unit, time, sample, error) : status;
}

/* -- steps ----------------------------------------------------------------------------------------------------------------- */

/* Returns a step that was given back, or a new one within the reserved memory. */
static int32_t next_step(td_refine *r) {
    const int32_t spare = r->spare_step;
    if (spare < 0) return (int32_t)r->steps++;
    r->spare_step = r->step[spare].next;
    return spare;
}

static tides_status new_step(td_refine *r, int32_t *index, tides_error *error) {
    tides_status status = td_reserve((void **)&r->step, &r->step_capacity, r->steps + 1, sizeof *r->step, error);
    if (status == TIDES_OK) *index = next_step(r);
    return status;
}

/* Begins a list of one whole step for each moving unit, from the sample that the last macro step ended with to a new one. */
static tides_status begin_lists(tides_simulator *s, td_refine *r, tides_error *error) {
    td_samples_clear(&r->samples);
    r->steps = r->open_count = r->fresh_count = 0;
    td_launch_clear(&s->launch);
    r->spare_step = -1;
    r->early = 0;
    tides_status status = td_reserve((void **)&r->fresh, &r->fresh_capacity, (size_t)r->units, sizeof *r->fresh, error);
    for (int t = 0; t < s->layout.units; t++) r->head[t] = -1;
    for (int i = 0; i < r->units && status == TIDES_OK; i++) {
        int t = r->unit[i];
        int32_t begin, step;
        status = td_samples_take(&r->samples, &begin, error);
        if (status == TIDES_OK) status = new_step(r, &step, error);
        if (status != TIDES_OK) return status;
        double *sample = td_sample_at(&r->samples, begin);
        for (int k = 0; k < r->samples.planes; k++)
            memcpy(sample + k * r->samples.pixels, s->now.plane[k] + s->layout.first_pixel[t],
                   (size_t)s->layout.unit[t].count * sizeof *sample);
        *td_sample_risk(&r->samples, begin) = s->unit_risk[t];
        td_sensor_begin_estimates(&s->sensor, s->layout.first_pixel[t], s->layout.unit[t].count);
        r->step[step] =
            (td_refine_step){.to = (uint32_t)1 << r->depth, .begin = begin, .probe = -1, .next = -1, .unit = t, .open = 1};
        r->head[t] = step;
        r->fresh[r->fresh_count++] = step;
    }
    return status;
}

/* Notes how far the deviations of a cut have fallen since the cut before; sample `before` was that cut, -1 for none. */
static void note_falls(const td_refine *r, int32_t before, int32_t sample, int32_t count) {
    const double *deviation = td_sample_deviation(&r->samples, sample);
    uint8_t *fall = td_sample_fall(&r->samples, sample);
    if (before < 0) {
        memset(fall, 0, (size_t)count);
        return;
    }
    const double *last = td_sample_deviation(&r->samples, before);
    for (int32_t i = 0; i < count; i++) fall[i] = td_probe_fall(deviation[i], last[i]);
}

/* The place where a step is cut. */
static uint32_t place_of(const tides_simulator *s, const td_refine_step *step) {
    return step->swap ? step->swap : td_probe_place(s->refine.macro, step->from, step->to);
}

/* Where pixels are coupled, all units are cut where one needs it. A unit whose own cubic is good enough isn't rendered: its
 * values there are the cubic's, it follows. Its error may be this share of the limits only, because errors of all units meet
 * in the coupled signals. A choice: with a quarter the demo's p95 rises from 1.0 to 1.2 us, for a sixth of the renders. A step
 * with a swap is rendered: its cubic can't know the swap. */
static const double good_enough = 0.25;

static int follows(const tides_simulator *s, const td_refine_step *step) {
    return s->given.coupled && s->given.mode == TIDES_STEPPING_ERROR && !step->swap && step->probe >= 0 &&
           step->excess <= good_enough;
}

/* Forgets the deviations of a step that contains a swap: samples before needn't have seen it. */
static void begin_anew(td_refine_step *step) {
    step->probe = -1;
    step->deviation = step->past[0] = step->past[1] = 0;
}

/* Keeps the deviations of the part without a swap: a sample where a swap begins or ends says nothing about that part. */
static void keep_deviations(const td_refine *r, int32_t before, int32_t sample, int32_t count) {
    memcpy(td_sample_deviation(&r->samples, sample), td_sample_deviation(&r->samples, before), (size_t)count * sizeof(double));
    memset(td_sample_fall(&r->samples, sample), 0, (size_t)count); /* nor about how smooth it is */
}

/* Computes the deviations at a cut: how far the step's cubic is off its sample. */
static void note_deviations(const tides_simulator *s, const td_refine *r, double start, double stop, const td_refine_step *a,
                            uint32_t at, int32_t sample) {
    const double *begin = td_sample_at(&r->samples, a->begin), *end = td_sample_at(&r->samples, a->end);
    const double *inside = td_sample_at(&r->samples, sample);
    const td_signals ends = {begin, begin + r->samples.pixels, end, end + r->samples.pixels};
    double from = td_refine_time(r, start, stop, a->from), h = td_refine_time(r, start, stop, a->to) - from;
    double theta = (td_refine_time(r, start, stop, at) - from) / h;
    td_probe_deviation(h, theta, &ends, inside, inside + r->samples.pixels, s->layout.unit[a->unit].count,
                       td_sample_deviation(&r->samples, sample));
    note_falls(r, a->probe, sample, s->layout.unit[a->unit].count);
}

/* Copies a step's deviations to its parts, where the cut has the cubic's own values and no new sample. */
static void hand_down(const td_refine *r, int32_t before, int32_t sample, int32_t count) {
    memcpy(td_sample_deviation(&r->samples, sample), td_sample_deviation(&r->samples, before), (size_t)count * sizeof(double));
    memcpy(td_sample_fall(&r->samples, sample), td_sample_fall(&r->samples, before), (size_t)count);
}

/* Cuts a step at the position `at`, where `sample` was rendered. The second part is the new step `right`. */
static void cut(const tides_simulator *s, const td_refine *r, double start, double stop, int32_t left, int32_t right,
                uint32_t at, int32_t sample) {
    td_refine_step *a = &r->step[left], *b = &r->step[right];
    if (a->swap) {
        keep_deviations(r, a->probe, sample, s->layout.unit[a->unit].count);
    } else if (follows(s, a)) {
        hand_down(r, a->probe, sample, s->layout.unit[a->unit].count);
    } else {
        note_deviations(s, r, start, stop, a, at, sample);
        a->past[1] = a->past[0];
        a->past[0] = a->deviation;
    }
    a->probe = sample;
    a->cuts++;
    *b = *a;
    if (a->swap) begin_anew(a->begins ? b : a);
    a->to = b->from = at;
    a->end = b->begin = sample;
    a->next = right;
}

/* Makes the parts of all pending steps, two for each, and lists them as `fresh`. */
static tides_status lay_parts(td_refine *r, tides_error *error) {
    const size_t count = r->pending_count;
    tides_status status = td_reserve((void **)&r->fresh, &r->fresh_capacity, 2 * count, sizeof *r->fresh, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->part, &r->part_capacity, count, sizeof *r->part, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->step, &r->step_capacity, r->steps + count, sizeof *r->step, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < count; i++) {
        r->part[i] = next_step(r);
        r->fresh[2 * i] = r->pending[i];
        r->fresh[2 * i + 1] = r->part[i];
    }
    if (count > 0) r->fresh_count = 2 * count;
    return TIDES_OK;
}

/* Cuts a pending step at its new sample. Parts of a step that follows its cubic keep its measures. */
static void cut_pending(const tides_simulator *s, size_t number, int32_t sample) {
    const td_refine *r = &s->refine;
    const int32_t left = r->pending[number], right = r->part[number];
    r->step[left].open = 0;
    const int as_before = follows(s, &r->step[left]);
    cut(s, r, r->start, r->stop, left, right, place_of(s, &r->step[left]), sample);
    if (as_before) return;
    td_control_judge(s, &r->step[left], r->start, r->stop);
    td_control_judge(s, &r->step[right], r->start, r->stop);
}

/* -- samples --------------------------------------------------------------------------------------------------------------- */

/* Copies one rendered unit to its sample's rows, and notes its risk. */
static void store_sample(const tides_simulator *s, const td_ask *ask, const double *planes) {
    const td_samples *samples = &s->refine.samples;
    const td_tile *unit = &s->layout.unit[ask->unit];
    double *sample = td_sample_at(samples, ask->sample);
    const size_t apart = (size_t)samples->pixels;
    td_unpack_tile(unit, planes, sample, sample + apart);
    if (samples->planes == TD_PLANES_ALL) td_unpack_diagnostics(unit, planes, apart, sample);
    *td_sample_risk(samples, ask->sample) = s->given.outputs == TD_OUT_SIGNAL ? 0 : td_unit_risk(s, unit, planes);
}

/* Stores a sample and reads it at once: the samples of a level don't fit in the cache. */
static void take_sample(const tides_simulator *s, const td_ask *ask, const double *planes, const void *user) {
    const size_t number = (size_t)(ask - s->launch.ask), first_cut = *(const size_t *)user;
    store_sample(s, ask, planes);
    if (number >= first_cut) cut_pending(s, number - first_cut, ask->sample);
}

/* Renders all jobs of the level. The pending steps are cut at the jobs from number `first_cut` on. */
static tides_status render_level(tides_simulator *s, size_t first_cut, tides_error *error) {
    tides_status status = lay_parts(&s->refine, error);
    return status == TIDES_OK ? td_launch_take_all(s, TD_SIDE_ENDS, s->given.outputs, take_sample, &first_cut, error) : status;
}

/* -- levels ---------------------------------------------------------------------------------------------------------------- */

/* Moves the pending steps that follow their cubics to the end of the list. Returns the number of the others. */
static size_t set_apart(const tides_simulator *s, td_refine *r) {
    size_t others = 0;
    for (size_t i = 0; i < r->pending_count; i++) {
        const int32_t step = r->pending[i];
        if (follows(s, &r->step[step])) continue;
        r->pending[i] = r->pending[others];
        r->pending[others++] = step;
    }
    return others;
}

/* Values and rates of cubics at s; `begin` and `end` are the planes of S and S_dot, `pixels` apart. */
TD_WIDE static void continue_all(double h, double s, int pixels, const double *begin, const double *end, double *restrict to) {
    for (int i = 0; i < pixels; i++) {
        const td_model model = td_model_fit(TIDES_MODEL_HERMITE, h, begin[i], begin[pixels + i], end[i], end[pixels + i]);
        to[i] = td_model_value(&model, s);
        to[pixels + i] = td_model_slope(&model, s) / h;
    }
}

/* Makes a sample from the step's cubic, and from lines for the other planes, where a step that follows is cut. */
static void continue_cubic(td_refine *r, const td_refine_step *step, uint32_t at, int32_t sample) {
    const double *begin = td_sample_at(&r->samples, step->begin), *end = td_sample_at(&r->samples, step->end);
    const double from = td_refine_time(r, r->start, r->stop, step->from);
    const double h = td_refine_time(r, r->start, r->stop, step->to) - from;
    const double s = (td_refine_time(r, r->start, r->stop, at) - from) / h;
    const int pixels = r->samples.pixels, all = pixels * r->samples.planes;
    double *to = td_sample_at(&r->samples, sample);
    continue_all(h, s, pixels, begin, end, to);
    for (int i = TD_PLANES_SIGNAL * pixels; i < all; i++) to[i] = (1 - s) * begin[i] + s * end[i];
    *td_sample_risk(&r->samples, sample) = 0;
}

static tides_status cut_followers(tides_simulator *s, size_t first, tides_error *error) {
    td_refine *r = &s->refine;
    tides_status status = TIDES_OK;
    for (size_t i = first; i < r->pending_count && status == TIDES_OK; i++) {
        int32_t sample;
        status = td_samples_take(&r->samples, &sample, error);
        if (status != TIDES_OK) return status;
        const td_refine_step *step = &r->step[r->pending[i]];
        continue_cubic(r, step, place_of(s, step), sample);
        cut_pending(s, i, sample);
    }
    return status;
}

static tides_status add_cuts(tides_simulator *s, td_refine *r, size_t count, double start, double stop, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const td_refine_step *step = &r->step[r->pending[i]];
        const uint32_t at = place_of(s, step);
        status = add_job(s, step->unit, td_refine_time(r, start, stop, at), error);
    }
    return status;
}

/* Renders the places at which the pending steps are cut, and cuts them. */
tides_status td_refine_level(tides_simulator *s, double start, double stop, tides_error *error) {
    td_refine *r = &s->refine;
    td_launch_clear(&s->launch);
    const size_t rendered = set_apart(s, r);
    tides_status status = add_cuts(s, r, rendered, start, stop, error);
    r->fresh_count = 0;
    if (status == TIDES_OK) status = render_level(s, 0, error);
    return status == TIDES_OK ? cut_followers(s, rendered, error) : status;
}

/* Level 0: every moving unit at the macro step's end. It is also rendered inside, where all macro steps will be cut anyway. */
static tides_status first_level(tides_simulator *s, td_refine *r, double start, double stop, tides_error *error) {
    int looks = s->given.mode == TIDES_STEPPING_ERROR && td_refine_may_cut(r, &r->step[r->fresh[0]]);
    size_t count = r->fresh_count;
    tides_status status = td_reserve((void **)&r->pending, &r->pending_capacity, count, sizeof *r->pending, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) status = add_job(s, r->step[r->fresh[i]].unit, stop, error);
    if (status != TIDES_OK) return status;
    memcpy(r->pending, r->fresh, count * sizeof *r->fresh);
    for (size_t i = 0; i < count; i++) r->step[r->fresh[i]].end = s->launch.ask[i].sample;
    r->pending_count = looks ? count : 0;
    status = add_cuts(s, r, r->pending_count, start, stop, error);
    if (status == TIDES_OK) status = render_level(s, count, error);
    for (size_t i = 0; i < count && !looks && status == TIDES_OK; i++) td_control_judge(s, &r->step[r->fresh[i]], start, stop);
    if (looks && status == TIDES_OK) s->totals.here.steps_rejected += count;
    return status;
}

/* -- the macro step ---------------------------------------------------------------------------------------------------- */

tides_status td_refine_begin(tides_simulator *s, double start, double stop, tides_error *error) {
    td_refine *r = &s->refine;
    r->depth = depth_for(stop - start, shortest_step(s, start, stop)) + SHORTEST_BITS;
    r->shortest = (uint32_t)1 << SHORTEST_BITS;
    r->macro = (uint64_t)s->step;
    r->start = start;
    r->stop = stop;
    tides_status status = begin_lists(s, r, error);
    return status == TIDES_OK ? first_level(s, r, start, stop, error) : status;
}

void td_refine_planes(const tides_simulator *s, const td_refine_step *refined, const double *begin[], const double *end[]) {
    const double *from = td_sample_at(&s->refine.samples, refined->begin), *to = td_sample_at(&s->refine.samples, refined->end);
    for (int p = 0; p < s->given.sample_planes; p++) {
        begin[p] = from + p * s->refine.samples.pixels;
        end[p] = to + p * s->refine.samples.pixels;
    }
}

int td_refine_ends_run(const tides_simulator *s, const td_refine_step *step) {
    return s->step + 1 == s->grid.steps && step->to == (uint32_t)1 << s->refine.depth;
}

void td_refine_release(td_refine *refine) {
    td_samples_release(&refine->samples);
    free(refine->step);
    free(refine->head);
    free(refine->reference);
    free(refine->open);
    free(refine->pending);
    free(refine->part);
    free(refine->fresh);
    memset(refine, 0, sizeof *refine);
}
