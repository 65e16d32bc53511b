/* Pixels that nothing moves, for solve.c: references that were taken at rest, and ramps that meet them there. In double
 * precision: in single, what is looked up is what samples are. */
#include "td_simulator.h"

/* Asks for all pixels of a unit. */
static tides_status ask_unit(tides_simulator *s, int t, double time, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < s->tile[t].count && status == TIDES_OK; i++) {
        const td_asked asked = {(int32_t)(s->first_pixel[t] + (size_t)i), 0};
        status = td_solve_ask(s, &s->tile[t], i, time, &asked, error);
    }
    return status;
}

/* A pixel that has been at rest since the run's start is where it was then: so what never moves is never looked up. Where ramps
 * take pixels at rest to their levels all are, at once. */
tides_status td_solve_references(tides_simulator *s, double start, tides_error *error) {
    td_solve *solve = &s->solve;
    const int all = s->sensor.active_at_rest, count = all ? s->tiles : s->moving_count;
    tides_status status = TIDES_OK;
    if (!solve->known) return TIDES_OK;
    solve->points = 0;
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        const int t = all ? k : s->moving[k];
        if (solve->known[t] == 0) status = ask_unit(s, t, start, error);
    }
    if (status == TIDES_OK && solve->points > 0) status = td_solve_look_up(s, 0, error);
    for (size_t k = 0; k < solve->points && status == TIDES_OK; k++) {
        const size_t pixel = (size_t)solve->asked[k].looked;
        s->now.plane[TD_PLANE_S][pixel] = solve->value[k].L;
        s->now.plane[TD_PLANE_S_DOT][pixel] = solve->value[k].L_dot;
        td_sensor_refer(&s->sensor, pixel, solve->value[k].L);
    }
    for (int k = 0; k < count && status == TIDES_OK; k++) solve->known[all ? k : s->moving[k]] = 1;
    return status;
}

/* -- ramps ---------------------------------------------------------------------------------------------------------------- */

/* Asks for the pixels of a tile in which nothing moves that may do something in the step: their places in the sample, too. */
static tides_status ask_still(tides_simulator *s, int t, const td_step *span, double start, tides_error *error) {
    static const double no_rate[TD_TILE_PIXELS] = {0};
    const td_tile *tile = &s->tile[t];
    const double *S = s->now.plane[TD_PLANE_S] + s->first_pixel[t];
    const td_signals signals = {S, no_rate, S, no_rate};
    double widen[TD_TILE_PIXELS];
    uint8_t active[TD_TILE_PIXELS] = {0};
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < tile->count; i++) widen[i] = s->solve.samples;
    td_sensor_find(&s->sensor, span, tile, s->first_pixel[t], &signals, widen, active);
    for (int32_t i = 0; i < tile->count && status == TIDES_OK; i++) {
        const td_asked asked = {(int32_t)(s->first_pixel[t] + (size_t)i), 0};
        if (active[i]) status = td_solve_ask(s, tile, i, start, &asked, error);
    }
    return status;
}

tides_status td_solve_still(tides_simulator *s, const td_step *span, double start, tides_error *error) {
    td_solve *solve = &s->solve;
    tides_status status = TIDES_OK;
    if (!solve->known || !s->sensor.active_at_rest) return TIDES_OK;
    solve->points = 0;
    for (int t = 0, moved = 0; t < s->tiles && status == TIDES_OK; t++) { /* both lists ascend */
        const int moves = moved < s->moving_count && s->moving[moved] == t;
        moved += moves;
        if (!moves) status = ask_still(s, t, span, start, error);
    }
    if (status == TIDES_OK && solve->points > 0) status = td_solve_look_up(s, 1, error);
    for (size_t k = 0; k < solve->points && status == TIDES_OK; k++)
        s->now.plane[TD_PLANE_S][solve->asked[k].looked] = solve->value[k].L;
    return status;
}
