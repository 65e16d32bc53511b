/* Accepted steps: the comparator over them, what they say of the run's accuracy, and their samples given back. For run.c at
 * the end of a macro step, and before that for window.c, where memory is short. What an event time is worth timing.c estimates;
 * sorting events and handing them out are run.c's. */
#include "td_extremes.h"
#include "solver/td_probe.h"
#include "solver/td_simulator.h"

#include <stdlib.h>

/* What an accepted step adds to the statistics. */
static void note_step(tides_simulator *s, const td_refine_step *step) {
    tides_stats *stats = &s->stats;
    int controls = s->given.mode == TIDES_STEPPING_ERROR, above = step->excess > 1;
    stats->steps++;
    stats->steps_probed += (uint64_t)(controls && step->probe >= 0);
    stats->steps_at_minimum += (uint64_t)above;
    stats->steps_at_rounding += (uint64_t)(!above && step->rounded > s->given.tolerance);
    stats->worst_error = td_greater(stats->worst_error, step->error);
    stats->worst_deviation = td_greater(stats->worst_deviation, step->deviation);
}

static tides_status compare_step(tides_simulator *s, const td_refine_step *refined, double start, double stop,
                                 tides_error *error) {
    const td_refine *r = &s->refine;
    const double *begin_planes[TD_PLANES_ALL], *end_planes[TD_PLANES_ALL];
    td_refine_planes(s, refined, begin_planes, end_planes);
    td_step step;
    size_t first = s->work.events.count;
    tides_status status = td_grid_step(&s->grid, td_refine_time(r, start, stop, refined->from),
                                       td_refine_time(r, start, stop, refined->to), &step, error);
    if (status == TIDES_OK) status = td_compare_tile(s, refined->tile, &step, begin_planes, end_planes, NULL, error);
    if (status != TIDES_OK) return status;
    td_time_events(s, refined, &step, begin_planes, end_planes, first);
    return TIDES_OK;
}

/* The tile's sample becomes `to`'s. */
static void reach(tides_simulator *s, int t, int32_t index, const td_sample *to) {
    const double *reached = td_sample_at(&s->refine.samples, index);
    size_t at = s->layout.first_pixel[t], bytes = (size_t)s->layout.tile[t].count * sizeof *reached;
    for (int p = 0; p < s->given.sample_planes; p++) memcpy(to->plane[p] + at, reached + p * s->refine.samples.pixels, bytes);
    s->tile_risk[t] = *td_sample_risk(&s->refine.samples, index);
}

/* The head of a tile's list is done with: it and its samples are given back. */
static void pass_head(td_refine *r, int t) {
    int32_t done = r->head[t], next = r->step[done].next;
    r->head[t] = next;
    td_samples_give(&r->samples, r->step[done].begin);
    if (next < 0) td_samples_give(&r->samples, r->step[done].end);
    r->step[done].next = r->spare_step;
    r->spare_step = done;
}

/* The accepted steps of a tile: compared where they weren't solved. */
static tides_status settle_tile(tides_simulator *s, int t, double start, double stop, int early, tides_error *error) {
    td_refine *r = &s->refine;
    for (int32_t i = r->head[t]; i >= 0 && !r->step[i].open;) {
        const td_refine_step step = r->step[i];
        tides_status status = s->solve.on ? TIDES_OK : compare_step(s, &step, start, stop, error);
        if (status != TIDES_OK) return status;
        note_step(s, &step);
        if (step.next < 0) reach(s, t, step.end, &s->now);
        i = step.next;
        if (early) pass_head(r, t);
    }
    return TIDES_OK;
}

/* The first step of every tile, where they have their steps in common, to s->next and through the surround. */
static tides_status settle_common_step(tides_simulator *s, const int32_t *which, double start, double stop,
                                       tides_error *error) {
    td_refine *r = &s->refine;
    double from = td_refine_time(r, start, stop, r->step[which[0]].from),
           to = td_refine_time(r, start, stop, r->step[which[0]].to);
    for (int t = 0; t < s->layout.tiles; t++) {
        reach(s, t, r->step[which[t]].end, &s->next);
        note_step(s, &r->step[which[t]]);
    }
    tides_status status = td_surround_compare(s, from, to, which, error);
    if (status != TIDES_OK) return status;
    td_turn_samples(s);
    return TIDES_OK;
}

static tides_status settle_together(tides_simulator *s, double start, double stop, int early, tides_error *error) {
    td_refine *r = &s->refine;
    int32_t *which = td_alloc((size_t)s->layout.tiles, sizeof *which, error);
    tides_status status = which ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) memcpy(which, r->head, (size_t)s->layout.tiles * sizeof *which);
    while (status == TIDES_OK && which[0] >= 0 && !r->step[which[0]].open) {
        status = settle_common_step(s, which, start, stop, error);
        for (int t = 0; t < s->layout.tiles && status == TIDES_OK; t++) {
            which[t] = r->step[which[t]].next;
            if (early) pass_head(r, t);
        }
    }
    free(which);
    return status;
}

/* The references that the macro step began with, for those steps that are judged after others have been compared. */
static tides_status keep_references(tides_simulator *s, tides_error *error) {
    td_refine *r = &s->refine;
    size_t pixels = s->layout.first_pixel[s->layout.tiles];
    if (r->early) return TIDES_OK;
    tides_status status = td_reserve((void **)&r->reference, &r->reference_capacity, pixels, sizeof *r->reference, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < r->units; i++) {
        const size_t first = s->layout.first_pixel[r->unit[i]];
        memcpy(r->reference + first, s->sensor.pixels.reference + first,
               (size_t)s->layout.tile[r->unit[i]].count * sizeof *r->reference);
    }
    r->early = 1;
    return TIDES_OK;
}

tides_status td_settle(tides_simulator *s, double start, double stop, int early, tides_error *error) {
    double begun = td_now();
    tides_status status = early ? keep_references(s, error) : TIDES_OK;
    if (status != TIDES_OK) return status;
    if (s->solve.on) status = td_solve_steps(s, start, stop, error);
    if (s->surround.surround.on)
        status = settle_together(s, start, stop, early, error);
    else
        for (int i = 0; i < s->refine.units && status == TIDES_OK; i++)
            status = settle_tile(s, s->refine.unit[i], start, stop, early, error);
    s->stats.time_compare_s += td_now() - begun;
    s->broken |= status != TIDES_OK;
    return status;
}
