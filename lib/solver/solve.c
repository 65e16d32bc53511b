/* Events on the image itself, round after round: which pixels may do something, then all that isn't settled looked up in one
 * batch, until all is. For settle.c. What a pixel needs is solve_run.c's to say, what was found solve_nodes.c's to keep. */
#include "td_extremes.h"
#include "td_probe.h"
#include "signal/td_model_error.h"
#include "td_simulator.h"

#include <stdlib.h>

/* Times that are settled where no tolerance is set [s]: ten units of event times, above which nothing that follows is felt. */
static const double default_target_s = 1e-8;

/* -- having it ------------------------------------------------------------------------------------------------------------ */

static tides_status refuse(const char *what, tides_error *error) {
    return td_fail(error, TIDES_UNSUPPORTED, "stepping.solve: events can't be solved on the image %s; set \"off\"", what);
}

tides_status td_solve_create(tides_simulator *s, const tides_stepping *stepping, tides_error *error) {
    const int32_t precision = stepping->solve;
    if (precision != TIDES_SOLVE_OFF && precision != TIDES_SOLVE_FLOAT && precision != TIDES_SOLVE_DOUBLE)
        return td_fail(error, TIDES_UNSUPPORTED, "stepping.solve: %d is none of TIDES_SOLVE_*", (int)precision);
    if (precision == TIDES_SOLVE_OFF) return TIDES_OK;
    if (s->mode == TIDES_STEPPING_FIXED) return refuse("with fixed steps, whose errors nobody knows", error);
    if (!td_sensor_solves(&s->sensor))
        return refuse("where a PSF, a filter, a surround or additive noise comes between it and the comparator, or with "
                      "another model than hermite",
                      error);
    if (precision == TIDES_SOLVE_DOUBLE) {
        tides_status status = td_renderer_exact_points(s->renderer, error);
        if (status != TIDES_OK) return td_fail_within(error, status, "stepping.solve \"double\"");
    }
    s->solve.precision = precision;
    s->solve.samples = s->timing.rounding + (precision == TIDES_SOLVE_DOUBLE ? TD_SOLVE_SAMPLES : 0);
    s->solve.target_s = s->time_tolerance_s > 0 ? s->time_tolerance_s : default_target_s;
    return TIDES_OK;
}

void td_solve_release(td_solve *solve) {
    free(solve->pixel);
    free(solve->looked);
    free(solve->found);
    free(solve->step);
    free(solve->reaches);
    free(solve->point);
    free(solve->asked);
    free(solve->value);
    *solve = (td_solve){.precision = solve->precision};
}

static tides_status look_up(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    tides_status status =
        td_reserve((void **)&solve->value, &solve->value_capacity, solve->points, sizeof *solve->value, error);
    if (status != TIDES_OK) return status;
    solve->lookups += solve->points;
    const double begun = td_now();
    status = td_renderer_points(s->renderer, s->camera, solve->point, solve->points, solve->value, error);
    if (solve->precision == TIDES_SOLVE_DOUBLE) s->stats.time_look_up_s += td_now() - begun;
    solve->paths = td_renderer_points_error(s->renderer);
    return status;
}

/* The same while the comparator's time is taken, which it is no part of. */
static tides_status look_up_apart(tides_simulator *s, tides_error *error) {
    const double begun = td_now();
    const tides_status status = look_up(s, error);
    s->stats.time_compare_s -= td_now() - begun;
    return status;
}

tides_status td_solve_begin(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    const size_t pixels = s->first_pixel[s->tiles];
    if (solve->precision != TIDES_SOLVE_DOUBLE) return TIDES_OK;
    tides_status status = td_reserve((void **)&solve->point, &solve->point_capacity, pixels, sizeof *solve->point, error);
    if (status != TIDES_OK) return status;
    for (int t = 0; t < s->tiles; t++)
        for (int32_t i = 0; i < s->tile[t].count; i++)
            solve->point[s->first_pixel[t] + (size_t)i] =
                (td_point){0, s->tile[t].x0 + i % s->tile[t].width, s->tile[t].y0 + i / s->tile[t].width};
    solve->points = pixels;
    status = look_up(s, error);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++) {
        s->now.plane[TD_PLANE_S][i] = solve->value[i].L;
        s->now.plane[TD_PLANE_S_DOT][i] = solve->value[i].L_dot;
    }
    return status;
}

/* -- before anything is looked up ----------------------------------------------------------------------------------------- */

td_trust td_solve_first_trust(const tides_simulator *s, const td_refine_step *refined, double h, int32_t i) {
    const td_samples *samples = &s->refine.samples;
    if (refined->probe >= 0) {
        const td_probe_law law = td_probe_left(td_sample_fall(samples, refined->probe)[i]);
        return (td_trust){TD_PROBE_LEFT_MOST * td_sample_deviation(samples, refined->probe)[i], law.is_smooth};
    }
    const double *begin[TD_PLANES_ALL], *end[TD_PLANES_ALL];
    td_settle_planes(s, refined, begin, end);
    const double rise = end[TD_PLANE_S][i] - begin[TD_PLANE_S][i];
    return (td_trust){td_embedded(rise, h * begin[TD_PLANE_S_DOT][i], h * end[TD_PLANE_S_DOT][i]), 1};
}

/* What all pixels of a step share. */
static tides_status lay_step(tides_simulator *s, const td_refine_step *refined, double start, double stop, td_solve_step *at,
                             tides_error *error) {
    const double *begin[TD_PLANES_ALL], *end[TD_PLANES_ALL];
    td_settle_planes(s, refined, begin, end);
    at->from = td_refine_time(&s->refine, start, stop, refined->from);
    at->to = td_refine_time(&s->refine, start, stop, refined->to);
    at->signals = (td_signals){begin[TD_PLANE_S], begin[TD_PLANE_S_DOT], end[TD_PLANE_S], end[TD_PLANE_S_DOT]};
    at->coverage = at->alpha_dot = (td_coverage){NULL, NULL};
    if (s->sensor.masks) at->coverage = (td_coverage){begin[TD_PLANE_ALPHA], end[TD_PLANE_ALPHA]};
    if (s->sensor.masks) at->alpha_dot = (td_coverage){begin[TD_PLANE_ALPHA_DOT], end[TD_PLANE_ALPHA_DOT]};
    return td_step_of_run(s, at->from, at->to, &at->span, error);
}

/* Lists the tile's pixels that aren't listed yet and may do something in a step of it. */
static tides_status list_active(tides_simulator *s, int32_t step, double start, double stop, uint8_t *active,
                                tides_error *error) {
    td_solve *solve = &s->solve;
    const td_refine_step *refined = &s->refine.step[step];
    const td_tile *tile = &s->tile[refined->tile];
    td_solve_step *at = &solve->step[step];
    double widen[TD_TILE_PIXELS];
    uint8_t before[TD_TILE_PIXELS];
    tides_status status = lay_step(s, refined, start, stop, at, error);
    if (status != TIDES_OK) return status;
    for (int32_t i = 0; i < tile->count; i++)
        widen[i] = td_solve_first_trust(s, refined, at->span.length_s, i).error + solve->samples;
    memcpy(before, active, sizeof before);
    td_sensor_find(&s->sensor, &at->span, tile, s->first_pixel[refined->tile], &at->signals, widen, active);
    td_sensor_reaches(&s->sensor, &at->span, tile, s->first_pixel[refined->tile], &at->signals, widen,
                      solve->reaches + (size_t)step * (size_t)s->refine.samples.pixels);
    for (int32_t i = 0; i < tile->count && status == TIDES_OK; i++) {
        if (active[i] == before[i]) continue;
        status = td_reserve((void **)&solve->pixel, &solve->pixel_capacity, solve->pixels + 1, sizeof *solve->pixel, error);
        if (status == TIDES_OK) solve->pixel[solve->pixels++] = (td_solving){refined->tile, i, step, -1};
    }
    return status;
}

/* Of all tiles that move; an ideal pixel that has done something may do more in any step that follows. */
static tides_status list_pixels(tides_simulator *s, double start, double stop, tides_error *error) {
    const td_refine *r = &s->refine;
    td_solve *solve = &s->solve;
    tides_status status = td_reserve((void **)&solve->step, &solve->step_capacity, r->steps, sizeof *solve->step, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&solve->reaches, &solve->reach_capacity, r->steps * (size_t)r->samples.pixels, 1, error);
    s->solve.pixels = s->solve.looked_count = s->solve.found_count = 0;
    for (int k = 0; k < s->moving_count; k++) {
        uint8_t active[TD_TILE_PIXELS] = {0};
        for (int32_t i = r->head[s->moving[k]]; i >= 0 && !r->step[i].open && status == TIDES_OK; i = r->step[i].next)
            status = list_active(s, i, start, stop, active, error);
    }
    return status;
}

/* -- round after round ---------------------------------------------------------------------------------------------------- */

/* What was found becomes nodes. */
static tides_status take(td_solve *solve, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t k = 0; k < solve->points && status == TIDES_OK; k++) {
        const td_asked *asked = &solve->asked[k];
        const int32_t i = solve->pixel[asked->pixel].local;
        td_looked *looked = &solve->looked[asked->looked];
        const td_solve_step *step = &solve->step[looked->step];
        const td_signals *at = &step->signals;
        const td_ends ends = {step->span.length_s, at->S0[i], at->S0_dot[i], at->S1[i], at->S1_dot[i]};
        status = td_solve_insert(solve, looked, &ends, asked->s, &solve->value[k], error);
    }
    return status;
}

/* Runs every pixel that isn't settled, and keeps those that still aren't. */
static tides_status run_pixels(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    tides_status status = TIDES_OK;
    solve->points = 0;
    for (size_t k = 0; k < solve->pixels && status == TIDES_OK; k++)
        if (solve->pixel[k].step >= 0) status = td_solve_run(s, (int32_t)k, error);
    return status;
}

tides_status td_solve_steps(tides_simulator *s, double start, double stop, tides_error *error) {
    tides_status status = list_pixels(s, start, stop, error);
    while (status == TIDES_OK) {
        status = run_pixels(s, error);
        if (status != TIDES_OK || s->solve.points == 0) break;
        status = look_up_apart(s, error);
        if (status == TIDES_OK) status = take(&s->solve, error);
    }
    return status;
}

/* -- at rest --------------------------------------------------------------------------------------------------------------- */

/* Asks for the pixels of a tile in which nothing moves that may do something in the step: their places in the sample, too. */
static tides_status ask_still(tides_simulator *s, int t, const td_step *span, double start, tides_error *error) {
    static const double no_rate[TD_TILE_PIXELS] = {0};
    td_solve *solve = &s->solve;
    const td_tile *tile = &s->tile[t];
    const double *S = s->now.plane[TD_PLANE_S] + s->first_pixel[t];
    const td_signals signals = {S, no_rate, S, no_rate};
    double widen[TD_TILE_PIXELS];
    uint8_t active[TD_TILE_PIXELS] = {0};
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < tile->count; i++) widen[i] = solve->samples;
    td_sensor_find(&s->sensor, span, tile, s->first_pixel[t], &signals, widen, active);
    for (int32_t i = 0; i < tile->count && status == TIDES_OK; i++) {
        const size_t k = solve->points;
        if (!active[i]) continue;
        status = td_reserve((void **)&solve->point, &solve->point_capacity, k + 1, sizeof *solve->point, error);
        if (status == TIDES_OK)
            status = td_reserve((void **)&solve->asked, &solve->asked_capacity, k + 1, sizeof *solve->asked, error);
        if (status != TIDES_OK) return status;
        solve->point[k] = (td_point){start, tile->x0 + i % tile->width, tile->y0 + i / tile->width};
        solve->asked[k] = (td_asked){(int32_t)(s->first_pixel[t] + (size_t)i), -1, 0};
        solve->points++;
    }
    return status;
}

tides_status td_solve_still(tides_simulator *s, const td_step *span, double start, tides_error *error) {
    td_solve *solve = &s->solve;
    tides_status status = TIDES_OK;
    if (solve->precision != TIDES_SOLVE_DOUBLE || !s->sensor.active_at_rest) return TIDES_OK;
    solve->points = 0;
    for (int t = 0, moved = 0; t < s->tiles && status == TIDES_OK; t++) { /* both lists ascend */
        const int moves = moved < s->moving_count && s->moving[moved] == t;
        moved += moves;
        if (!moves) status = ask_still(s, t, span, start, error);
    }
    if (status == TIDES_OK && solve->points > 0) status = look_up_apart(s, error);
    for (size_t k = 0; k < solve->points && status == TIDES_OK; k++)
        s->now.plane[TD_PLANE_S][solve->asked[k].pixel] = solve->value[k].L;
    return status;
}
