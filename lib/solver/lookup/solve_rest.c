/* Pixels before anything has moved: their references, and ramps (leak) that meet levels while the image is at rest. */
#include "solver/td_simulator.h"
#include "sensor/td_single.h"

/* -- references ------------------------------------------------------------------------------------------------------------ */

/* 1 in the first macro step: it begins at the run's start, so that its own interval holds the references' time. */
static int begins(const tides_simulator *s) { return s->step == 0; }

tides_status td_solve_keep_start(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    if (!solve->on || solve->kept || begins(s)) return TIDES_OK;
    tides_status status = td_renderer_sweep(s->renderer, s->camera, 0, 0, error);
    if (status == TIDES_OK) status = td_renderer_keep_instant(s->renderer, s->camera, error);
    solve->kept = status == TIDES_OK;
    return status;
}

/* Bound on the error of a sampled reference: that of any sample, and rounding where the image is steep. It is four times the
 * value that 99 % of samples stay below. A pixel that is wrongly taken to rest here loses its event, and a pixel that is
 * wrongly taken to act only costs a look. */
void td_solve_doubt(const tides_simulator *s, int t, double *doubt) {
    enum { ROUNDINGS = 4 };
    const td_tile *tile = &s->layout.unit[t];
    const size_t first = s->layout.first_pixel[t];
    const double *known = s->solve.known, *rest = s->sensor.pixels.initial + first;
    for (int32_t i = 0; i < tile->count; i++) {
        doubt[i] = 0;
        if (known[first + (size_t)i] == 0)
            doubt[i] =
                td_solve_sample_error(&s->solve, rest[i]) + ROUNDINGS * td_timing_rounding(&s->done.timing, tile, rest, i);
    }
}

tides_status td_solve_ask_reference(const tides_simulator *s, td_solve_portion *portion, int t, int32_t local,
                                    tides_error *error) {
    td_solve_refer_list *refer = &portion->refer;
    const td_tile *tile = &s->layout.unit[t];
    const size_t k = refer->count;
    tides_status status = td_reserve((void **)&refer->wanted, &refer->wanted_capacity, k + 1, sizeof *refer->wanted, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&refer->start, &refer->start_capacity, k + 1, sizeof *refer->start, error);
    if (status != TIDES_OK) return status;
    refer->wanted[k] = s->layout.first_pixel[t] + (size_t)local;
    refer->start[k] = (td_point){0, tile->x0 + local % tile->width, tile->y0 + local / tile->width};
    refer->count++;
    return TIDES_OK;
}

tides_status td_solve_refer(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    td_solve_refer_list *refer = &s->done.solve.refer;
    const size_t count = refer->count;
    refer->count = 0;
    tides_status status = td_renew((void **)&refer->rest, &refer->rest_capacity, count, sizeof *refer->rest, error);
    if (status != TIDES_OK || count == 0) return status;
    const double begun = td_now();
    status = begins(s) ? td_renderer_points(s->renderer, s->camera, refer->start, count, refer->rest, error)
                       : td_renderer_kept_points(s->renderer, s->camera, refer->start, count, refer->rest, error);
    td_solve_note_time(s, begun);
    solve->lookups += count;
    for (size_t k = 0; k < count && status == TIDES_OK; k++) {
        td_sensor_refer(&s->sensor, refer->wanted[k], refer->rest[k].L);
        solve->known[refer->wanted[k]] = 1;
    }
    return status;
}

/* -- ramps ---------------------------------------------------------------------------------------------------------------- */

/* Lists a pixel at rest, without steps, and requests its value. Point k of the batch is then pixel k's. */
static tides_status ask_at_rest(tides_simulator *s, int t, int32_t local, double start, tides_error *error) {
    td_solve_batch *batch = td_solve_filling(&s->solve);
    const td_asked asked = {-1, local, 0};
    tides_status status =
        td_reserve((void **)&batch->pixel, &batch->pixel_capacity, batch->pixels + 1, sizeof *batch->pixel, error);
    if (status == TIDES_OK) status = td_solve_ask(batch, &s->layout.unit[t], local, start, &asked, error);
    if (status == TIDES_OK) batch->pixel[batch->pixels++] = (td_solving){t, local, 0, 0, 0};
    return status;
}

/* Requests the values of pixels of a unit in which nothing moves, if they may do something in the step, and their references
 * where these aren't known. */
static tides_status ask_still(tides_simulator *s, int t, const td_step *span, double start, tides_error *error) {
    static const double no_rate[TD_TILE_PIXELS] = {0};
    const td_tile *tile = &s->layout.unit[t];
    const double *S = s->now.plane[TD_PLANE_S] + s->layout.first_pixel[t];
    const td_signals signals = {S, no_rate, S, no_rate};
    double widen[TD_TILE_PIXELS];
    uint8_t active[TD_TILE_PIXELS] = {0};
    tides_status status = TIDES_OK;
    td_solve_doubt(s, t, widen);
    for (int32_t i = 0; i < tile->count; i++) widen[i] += td_solve_sample_error(&s->solve, S[i]);
    td_sensor_find(&s->sensor, span, tile, s->layout.first_pixel[t], &signals, widen, active);
    for (int32_t i = 0; i < tile->count && status == TIDES_OK; i++) {
        if (!active[i]) continue;
        status = ask_at_rest(s, t, i, start, error);
        if (status == TIDES_OK && s->solve.known[s->layout.first_pixel[t] + (size_t)i] == 0)
            status = td_solve_ask_reference(s, &s->done.solve, t, i, error);
    }
    return status;
}

tides_status td_solve_still(tides_simulator *s, const td_step *span, double start, tides_error *error) {
    const td_solve *solve = &s->solve;
    const td_solve_batch *batch = td_solve_filling(&s->solve);
    tides_status status = TIDES_OK;
    if (!solve->on || !s->sensor.active_at_rest) return TIDES_OK;
    td_solve_clear_batches(s);
    for (int t = 0, moved = 0; t < s->layout.units && status == TIDES_OK; t++) { /* both lists are in ascending order */
        const int moves = moved < s->moving.count && s->moving.list[moved] == t;
        moved += moves;
        if (!moves) status = ask_still(s, t, span, start, error);
    }
    if (status == TIDES_OK) status = td_solve_refer(s, error);
    if (status == TIDES_OK) status = td_solve_look_up(s, error);
    for (size_t k = 0; k < batch->points && status == TIDES_OK; k++) {
        const td_solving *pixel = &batch->pixel[k];
        s->now.plane[TD_PLANE_S][s->layout.first_pixel[pixel->unit] + (size_t)pixel->local] = batch->value[k].L;
    }
    return status;
}
