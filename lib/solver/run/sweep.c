/* The beginning of a step, fixed or refined: sweeps it, lists the units that can change in it, and sets their rates at a
 * knot. */
#include "solver/td_simulator.h"

/* Lists the units that can change in the interval swept last; all units where they have their steps in common. */
static void list_moving(tides_simulator *s) {
    int last = -1;
    s->moving.count = s->moving.tiles = 0;
    for (int t = 0; t < s->layout.units; t++) {
        const int tile = td_units_tile(s, t);
        if (s->given.local && s->started && !td_units_moves(s, t)) continue;
        s->moving.list[s->moving.count++] = t;
        s->moving.tiles += tile != last;
        last = tile;
    }
}

/* Stores S_dot of a unit. S itself is the same on both sides of a knot. */
static void store_rate(const tides_simulator *s, const td_ask *ask, const double *planes, const void *user) {
    (void)user;
    double S[TD_TILE_PIXELS];
    td_unpack_tile(&s->layout.unit[ask->unit], planes, S, s->now.plane[TD_PLANE_S_DOT] + s->layout.first_pixel[ask->unit]);
}

/* At a motion's knot rates may jump: S_dot of the moving units becomes the rate of the motion that begins there. */
static tides_status turn_knot(tides_simulator *s, tides_error *error) {
    const double time = td_grid_time(s, s->step);
    if (!s->started || s->moving.count == 0 || !td_grid_is_knot(&s->grid, s->step)) return TIDES_OK;
    td_launch_clear(&s->launch);
    tides_status status = TIDES_OK;
    for (int i = 0; i < s->moving.count && status == TIDES_OK; i++)
        status = td_launch_add(&s->launch, s->moving.list[i], time, 0, error);
    return status == TIDES_OK ? td_launch_take_all(s, TD_SIDE_BEGINS, TD_OUT_SIGNAL, store_rate, NULL, error) : status;
}

tides_status td_sweep(tides_simulator *s, double start, double stop, tides_error *error) {
    tides_status status = td_renderer_sweep(s->renderer, s->camera, start, stop, error);
    if (status != TIDES_OK) return status;
    list_moving(s);
    return turn_knot(s, error);
}
