/* Accepted steps: runs the comparator over them, adds their estimated accuracy to the statistics, and gives their samples back.
 * At the end of a macro step for all; before that where memory is short, for the earliest. */
#include "td_extremes.h"
#include "solver/td_probe.h"
#include "solver/td_simulator.h"

#include <stdlib.h>

/* Adds an accepted step to the statistics. */
static void note_step(const tides_simulator *s, td_step_counts *steps, const td_refine_step *step) {
    int controls = s->given.mode == TIDES_STEPPING_ERROR, above = step->excess > 1;
    steps->steps++;
    steps->probed += (uint64_t)(controls && step->probe >= 0);
    steps->at_minimum += (uint64_t)above;
    steps->at_rounding += (uint64_t)(!above && step->rounded > s->given.tolerance);
    steps->worst_error = td_greater(steps->worst_error, step->error);
    steps->worst_deviation = td_greater(steps->worst_deviation, step->deviation);
}

static tides_status compare_step(const tides_simulator *s, td_portion *portion, const td_refine_step *refined,
                                 tides_error *error) {
    const td_refine *r = &s->refine;
    const double *begin_planes[TD_PLANES_ALL], *end_planes[TD_PLANES_ALL];
    td_refine_planes(s, refined, begin_planes, end_planes);
    td_step step;
    const td_compared unit = {refined->unit, &step, begin_planes, end_planes, NULL};
    const size_t first = portion->work.events.count;
    tides_status status = td_grid_step(&s->grid, td_refine_time(r, r->start, r->stop, refined->from),
                                       td_refine_time(r, r->start, r->stop, refined->to), &step, error);
    if (status == TIDES_OK) status = td_compare_unit(s, portion, &unit, error);
    if (status == TIDES_OK) td_time_events(s, portion, refined, &unit, first);
    return status;
}

/* The sample becomes the unit's state at the time reached. */
static void reach(const tides_simulator *s, int t, int32_t index, const td_sample *to) {
    const double *reached = td_sample_at(&s->refine.samples, index);
    size_t at = s->layout.first_pixel[t], bytes = (size_t)s->layout.unit[t].count * sizeof *reached;
    for (int p = 0; p < s->given.sample_planes; p++) memcpy(to->plane[p] + at, reached + p * s->refine.samples.pixels, bytes);
    s->unit_risk[t] = *td_sample_risk(&s->refine.samples, index);
}

/* Gives back the first step of a unit's list, and its samples. */
static void pass_head(td_refine *r, int t) {
    int32_t done = r->head[t], next = r->step[done].next;
    r->head[t] = next;
    td_samples_give(&r->samples, r->step[done].begin);
    if (next < 0) td_samples_give(&r->samples, r->step[done].end);
    r->step[done].next = r->spare_step;
    r->spare_step = done;
}

/* The accepted steps of a unit: compared here, unless look-ups have found their events already. */
static tides_status settle_unit(const tides_simulator *s, td_portion *portion, int t, tides_error *error) {
    const td_refine *r = &s->refine;
    for (int32_t i = r->head[t]; i >= 0 && !r->step[i].open; i = r->step[i].next) {
        const td_refine_step *step = &r->step[i];
        tides_status status = s->solve.on ? TIDES_OK : compare_step(s, portion, step, error);
        if (status != TIDES_OK) return status;
        note_step(s, &portion->steps, step);
        if (step->next < 0) reach(s, t, step->end, &s->now);
    }
    return TIDES_OK;
}

static tides_status settle_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                                tides_error *error) {
    tides_status status = TIDES_OK;
    (void)user;
    for (int i = first; i < end && status == TIDES_OK; i++) status = settle_unit(s, portion, s->refine.unit[i], error);
    return status;
}

/* Units per portion at least, where events are there and only samples are moved. */
enum { FEWEST_SOLVED = 256 };

/* Settles units that have steps of their own. */
static tides_status settle_apart(tides_simulator *s, int early, tides_error *error) {
    td_refine *r = &s->refine;
    tides_status status = td_share_out(s, r->units, s->solve.on ? FEWEST_SOLVED : TD_FEWEST_UNITS, settle_some, NULL, error);
    for (int i = 0; i < r->units && early && status == TIDES_OK; i++)
        while (r->head[r->unit[i]] >= 0 && !r->step[r->head[r->unit[i]]].open) pass_head(r, r->unit[i]);
    return status;
}

/* Settles the first step of every unit, where all have their steps in common: the surround sees the whole image. */
static tides_status settle_common_step(tides_simulator *s, const int32_t *which, double start, double stop,
                                       tides_error *error) {
    td_refine *r = &s->refine;
    double from = td_refine_time(r, start, stop, r->step[which[0]].from),
           to = td_refine_time(r, start, stop, r->step[which[0]].to);
    for (int t = 0; t < s->layout.units; t++) {
        if (r->step[which[t]].next < 0 || s->given.sample_planes > TD_PLANES_SIGNAL)
            reach(s, t, r->step[which[t]].end, &s->next);
        note_step(s, &s->done.steps, &r->step[which[t]]);
    }
    tides_status status = td_surround_compare(s, from, to, which, error);
    if (status != TIDES_OK) return status;
    td_turn_samples(s);
    return TIDES_OK;
}

static tides_status settle_together(tides_simulator *s, double start, double stop, int early, tides_error *error) {
    td_refine *r = &s->refine;
    int32_t *which = td_alloc((size_t)s->layout.units, sizeof *which, error);
    tides_status status = which ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) memcpy(which, r->head, (size_t)s->layout.units * sizeof *which);
    while (status == TIDES_OK && which[0] >= 0 && !r->step[which[0]].open) {
        status = settle_common_step(s, which, start, stop, error);
        for (int t = 0; t < s->layout.units && status == TIDES_OK; t++) {
            which[t] = r->step[which[t]].next;
            if (early) pass_head(r, t);
        }
    }
    free(which);
    return status;
}

/* Keeps the references that the macro step began with: steps that are judged after others have been compared need them. */
static tides_status keep_references(tides_simulator *s, tides_error *error) {
    td_refine *r = &s->refine;
    size_t pixels = s->layout.first_pixel[s->layout.units];
    if (r->early) return TIDES_OK;
    tides_status status = td_reserve((void **)&r->reference, &r->reference_capacity, pixels, sizeof *r->reference, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < r->units; i++) {
        const size_t first = s->layout.first_pixel[r->unit[i]];
        memcpy(r->reference + first, s->sensor.pixels.reference + first,
               (size_t)s->layout.unit[r->unit[i]].count * sizeof *r->reference);
    }
    r->early = 1;
    return TIDES_OK;
}

/* By default td_solve_steps finds the events of all pixels here, before their samples are given back by settle_apart. */
tides_status td_settle(tides_simulator *s, double start, double stop, int early, tides_error *error) {
    double begun = td_now();
    tides_status status = early ? keep_references(s, error) : TIDES_OK;
    if (status != TIDES_OK) return status;
    if (s->solve.on) status = td_solve_steps(s, error);
    if (s->given.coupled)
        status = settle_together(s, start, stop, early, error);
    else if (status == TIDES_OK)
        status = settle_apart(s, early, error);
    s->totals.here.time_compare_s += td_now() - begun;
    s->broken |= status != TIDES_OK;
    return status;
}
