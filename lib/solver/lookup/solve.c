/* Events on the image itself, over the accepted steps of a macro step: finds the pixels that may do something, then looks up
 * places in the image in batches until all are settled. solve_run.c decides what a pixel needs, solve_nodes.c keeps the values
 * found, and solve_batches.c has the batches. */
#include "td_extremes.h"
#include "sensor/td_single.h"
#include "solver/td_probe.h"
#include "signal/td_model_error.h"
#include "solver/td_simulator.h"
#include "solver/td_swapped.h"
#include "td_wide.h"

#include <stdlib.h>

/* Points in a full batch: some 30 ms of a processor. With smaller batches a core changes between host and device work so often
 * that its caches are lost (two cores, the demo: 2048 took 1.06 of the time of one batch, 8192 0.94, 16384 0.92, 32768
 * 0.93). */
enum { ENOUGH = 1 << 14 };

/* Light that compositing leaves out of samples: image.smoothing.stop_change. Points in double precision don't leave it out. */
#define LEFT_OUT 1e-5

/* Units in the last place of 1 by which the light of a sample in single precision may be off: weights of splats are differences
 * of transmittances near 1. Two events were wrong, where samples were off by 1.3 and 2.5 (check_lost, taper 404 and 1111: faint
 * splats before black). */
#define IN_THE_DARK 4

/* Accuracy of event times where no tolerance is set [s]: ten times the resolution of event times. A smaller error has no effect
 * on later events. */
static const double default_target_s = 1e-8;

/* -- having it ------------------------------------------------------------------------------------------------------------ */

/* Finds the obstacle to `asked` (TIDES_UNSOLVED_*). Only the run counts, not the device. */
static tides_status find_obstacle(const tides_simulator *s, const tides_sensor *sensor, const tides_stepping *stepping,
                                  int32_t asked, int32_t *why, tides_error *error) {
    int shows = 0;
    tides_status status = td_sensor_shows_signal(sensor, &shows, error);
    if (asked == TIDES_SOLVE_OFF)
        *why = TIDES_UNSOLVED_ASKED;
    else if (stepping->mode == TIDES_STEPPING_FIXED)
        *why = TIDES_UNSOLVED_FIXED;
    else if (stepping->model != TIDES_MODEL_HERMITE)
        *why = TIDES_UNSOLVED_MODEL;
    else if (!shows)
        *why = TIDES_UNSOLVED_SENSOR;
    else if (td_renderer_lacks_exact_points(s->renderer))
        *why = TIDES_UNSOLVED_IMAGE;
    else
        *why = TIDES_UNSOLVED_NOT;
    return status;
}

static tides_status refuse(const tides_simulator *s, int32_t why, tides_error *error) {
    static const char *const words[] =
        {[TIDES_UNSOLVED_FIXED] = "with fixed steps, whose errors nobody knows",
         [TIDES_UNSOLVED_MODEL] = "with another stepping.model than hermite",
         [TIDES_UNSOLVED_SENSOR] =
             "where a PSF, a filter, a surround, additive noise or kicks come between it and the comparator"};
    if (why == TIDES_UNSOLVED_IMAGE)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "stepping.solve \"double\": single pixels can't be worked out in double precision: %s",
                       td_renderer_lacks_exact_points(s->renderer));
    return td_fail(error, TIDES_UNSUPPORTED, "stepping.solve: events can't be solved on the image %s; set \"off\"", words[why]);
}

tides_status td_solve_choose(tides_simulator *s, const tides_sensor *sensor, const tides_stepping *stepping,
                             tides_error *error) {
    const int32_t asked = stepping->solve;
    if (asked < TIDES_SOLVE_OFF || asked > TIDES_SOLVE_AUTO)
        return td_fail(error, TIDES_UNSUPPORTED, "stepping.solve: %d is none of TIDES_SOLVE_*", (int)asked);
    tides_status status = find_obstacle(s, sensor, stepping, asked, &s->solve.unsolved, error);
    if (status != TIDES_OK) return status;
    const int solves = s->solve.unsolved == TIDES_UNSOLVED_NOT;
    if (!solves && asked == TIDES_SOLVE_DOUBLE) return refuse(s, s->solve.unsolved, error);
    s->solve.on = solves;
    return TIDES_OK;
}

tides_status td_solve_create(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    if (!solve->on) return TIDES_OK;
    tides_status status = td_renderer_exact_points(s->renderer, error);
    if (status != TIDES_OK) return status;
    solve->known = td_alloc(s->layout.first_pixel[s->layout.units], sizeof *solve->known, error);
    if (!solve->known) return TIDES_NO_MEMORY;
    solve->is_exact = !td_renderer_points_rounded(s->renderer);
    solve->samples = s->done.timing.rounding + LEFT_OUT;
    solve->dark = IN_THE_DARK * s->done.timing.epsilon;
    solve->enough = ENOUGH;
    solve->target_s = s->given.time_tolerance_s > 0 ? s->given.time_tolerance_s : default_target_s;
    return TIDES_OK;
}

void td_solve_release(td_solve *solve) {
    free(solve->known);
    free(solve->found);
    free(solve->step);
    for (int k = 0; k < TD_SOLVE_BATCHES; k++) td_solve_batch_release(&solve->batch[k]);
    *solve = (td_solve){.on = solve->on, .unsolved = solve->unsolved};
}

/* -- before anything is looked up ----------------------------------------------------------------------------------------- */

/* Fills in the facts of a step that all its pixels share. */
static tides_status lay_step(const tides_simulator *s, const td_refine_step *refined, td_solve_step *at, tides_error *error) {
    const td_refine *r = &s->refine;
    const double *begin[TD_PLANES_ALL], *end[TD_PLANES_ALL];
    td_refine_planes(s, refined, begin, end);
    at->from = td_refine_time(r, r->start, r->stop, refined->from);
    at->to = td_refine_time(r, r->start, r->stop, refined->to);
    at->signals = (td_signals){begin[TD_PLANE_S], begin[TD_PLANE_S_DOT], end[TD_PLANE_S], end[TD_PLANE_S_DOT]};
    at->coverage = at->alpha_dot = (td_coverage){NULL, NULL};
    if (s->sensor.masks) at->coverage = (td_coverage){begin[TD_PLANE_ALPHA], end[TD_PLANE_ALPHA]};
    if (s->sensor.masks) at->alpha_dot = (td_coverage){begin[TD_PLANE_ALPHA_DOT], end[TD_PLANE_ALPHA_DOT]};
    return td_grid_step(&s->grid, at->from, at->to, &at->span, error);
}

/* Lists a pixel of a unit with its steps from `first` on, in which it may do something first. `row` counts that step in the
 * unit's list. */
static tides_status list_pixel(const tides_simulator *s, td_solve_portion *solve, int32_t first, size_t row, int32_t i,
                               tides_error *error) {
    const td_refine *r = &s->refine;
    td_solve_batch *batch = solve->asks;
    const size_t begun = solve->looked_count;
    tides_status status =
        td_reserve((void **)&batch->pixel, &batch->pixel_capacity, batch->pixels + 1, sizeof *batch->pixel, error);
    for (int32_t k = first; k >= 0 && !r->step[k].open && status == TIDES_OK; k = r->step[k].next, row++) {
        const size_t place = row * (size_t)r->samples.pixels + (size_t)i;
        if (!solve->reaches[place]) continue;
        status =
            td_reserve((void **)&solve->looked, &solve->looked_capacity, solve->looked_count + 1, sizeof *solve->looked, error);
        if (status != TIDES_OK) break;
        const td_signals *at = &s->solve.step[k].signals;
        const double h = s->solve.step[k].span.length_s;
        solve->looked[solve->looked_count++] = (td_looked){.ends = {h, at->S0[i], at->S0_dot[i], at->S1[i], at->S1_dot[i]},
                                                           .trust = solve->trust[place],
                                                           .step = k,
                                                           .first = -1};
    }
    if (status == TIDES_OK)
        batch->pixel[batch->pixels++] = (td_solving){r->step[first].unit, i, (int32_t)begun, (int32_t)solve->looked_count, 0};
    return status;
}

/* Finds the unit's pixels that may do something in a step, and those with a level within reach. `row` is the step's number in
 * the unit's list; `doubt` the errors of the pixels' references. */
static tides_status find_active(const tides_simulator *s, td_solve_portion *solve, int32_t step, size_t row,
                                const double *doubt, uint8_t *active, tides_error *error) {
    const td_refine_step *refined = &s->refine.step[step];
    const td_tile *tile = &s->layout.unit[refined->unit];
    const td_solve_step *at = &s->solve.step[step];
    const size_t pixels = (size_t)s->refine.samples.pixels, first = s->layout.first_pixel[refined->unit];
    double widen[TD_TILE_PIXELS];
    tides_status status = td_reserve((void **)&solve->reaches, &solve->reach_capacity, (row + 1) * pixels, 1, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&solve->trust, &solve->trust_capacity, (row + 1) * pixels, sizeof *solve->trust, error);
    if (status != TIDES_OK) return status;
    td_trust *trust = solve->trust + row * pixels;
    td_solve_first_trust(s, refined, at->span.length_s, 0, tile->count, trust);
    for (int32_t i = 0; i < tile->count; i++)
        widen[i] = td_solve_first_widen(&s->solve, &trust[i], td_lesser(at->signals.S0[i], at->signals.S1[i])) + doubt[i];
    td_solve_widen_swapped(s, refined, &at->signals, widen);
    td_sensor_find(&s->sensor, &at->span, tile, first, &at->signals, widen, active);
    td_sensor_reaches(&s->sensor, &at->span, tile, first, &at->signals, widen, solve->reaches + row * pixels);
    return TIDES_OK;
}

/* Runs the pixel that was listed last, and drops it if it is settled. A pixel whose reference isn't known waits for its
 * reference. */
static tides_status run_last(const tides_simulator *s, td_portion *portion, tides_error *error) {
    const td_solve *solve = &s->solve;
    td_solve_batch *batch = portion->solve.asks;
    td_solving *pixel = &batch->pixel[batch->pixels - 1];
    if (solve->known[s->layout.first_pixel[pixel->unit] + (size_t)pixel->local] == 0) {
        pixel->waits = 1;
        return td_solve_ask_reference(s, &portion->solve, pixel->unit, pixel->local, error);
    }
    tides_status status = td_solve_run(s, portion, portion->solve.looked, pixel, error);
    if (pixel->next == pixel->end) batch->pixels--;
    return status;
}

/* The pixels of a unit that may do something. Each is listed and run at once, while its data are in the cache. */
static tides_status begin_unit(const tides_simulator *s, td_portion *portion, int t, tides_error *error) {
    const td_refine *r = &s->refine;
    uint8_t active[TD_TILE_PIXELS] = {0}, before[TD_TILE_PIXELS];
    int32_t first[TD_TILE_PIXELS];
    size_t row[TD_TILE_PIXELS], rows = 0;
    double doubt[TD_TILE_PIXELS];
    tides_status status = TIDES_OK;
    td_solve_doubt(s, t, doubt);
    for (int32_t k = r->head[t]; k >= 0 && !r->step[k].open && status == TIDES_OK; k = r->step[k].next, rows++) {
        memcpy(before, active, sizeof before);
        status = lay_step(s, &r->step[k], &s->solve.step[k], error);
        if (status == TIDES_OK) status = find_active(s, &portion->solve, k, rows, doubt, active, error);
        for (int32_t i = 0; i < s->layout.unit[t].count; i++)
            if (active[i] != before[i]) first[i] = k, row[i] = rows;
    }
    for (int32_t i = 0; i < s->layout.unit[t].count && status == TIDES_OK; i++) {
        if (!active[i]) continue;
        /* NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): `first` was set where the pixel became active */
        status = list_pixel(s, &portion->solve, first[i], row[i], i, error);
        if (status == TIDES_OK) status = run_last(s, portion, error);
    }
    return status;
}

/* -- batch after batch ---------------------------------------------------------------------------------------------------- */

static tides_status begin_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                               tides_error *error) {
    const int *unit = user;
    tides_status status = TIDES_OK;
    for (int k = first; k < end && status == TIDES_OK; k++) status = begin_unit(s, portion, unit[k], error);
    return status;
}

/* Units between two checks whether the batch is full: whole tiles, and with several threads enough to share out. */
enum { FEWEST_UNITS = 16, GROUP = 512 };

static int group_end(const tides_simulator *s, int first) {
    const td_refine *r = &s->refine;
    const int least = td_pool_threads(s->sharing.pool) > 1 ? GROUP : 1;
    int end = first + 1;
    while (end < r->units && (end < first + least || td_units_tile(s, r->unit[end]) == td_units_tile(s, r->unit[end - 1])))
        end++;
    return end;
}

/* Begins all units that are refined together. A full batch is sent between two tiles, because points of one tile are computed
 * faster together. */
static tides_status begin_units(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    const td_refine *r = &s->refine;
    tides_status status = td_reserve((void **)&solve->step, &solve->step_capacity, r->steps, sizeof *solve->step, error);
    for (int first = 0, end; first < r->units && status == TIDES_OK; first = end) {
        end = group_end(s, first);
        if (td_solve_has_enough(s)) status = td_solve_turn(s, error);
        if (status == TIDES_OK) status = td_share_out(s, end - first, FEWEST_UNITS, begin_some, r->unit + first, error);
    }
    return status;
}

tides_status td_solve_steps(tides_simulator *s, tides_error *error) {
    s->done.solve.looked_count = s->solve.found_count = 0;
    td_solve_clear_batches(s);
    tides_status status = begin_units(s, error);
    while (status == TIDES_OK && td_solve_is_busy(s)) status = td_solve_turn(s, error);
    if (status != TIDES_OK) td_solve_clear_batches(s);
    return status;
}
