/* Internal: the units that have steps of their own, and rendering them at times.
 *
 * A unit is a 16x16 tile of the renderer, or a 4x4 block of one (stepping.unit). The solver calls its units tiles: td_tile says
 * where each is, and pixels are stored unit by unit in all of its arrays. Units of one tile that are needed at one time are one
 * job of the renderer, which projects and sorts once for them. */
#ifndef TD_UNITS_H
#define TD_UNITS_H

#include "render/td_render.h"
#include "signal/td_signals.h"

/* A unit that is asked for at a time; `sample` is the caller's. */
typedef struct td_ask {
    double time; /* [s after the epoch] */
    int32_t unit, sample;
} td_ask;

/* The requests of a launch, and the planes rendered for them. Memory is kept from one launch to the next. */
typedef struct td_launch {
    td_ask *ask;
    size_t count, ask_capacity;
    size_t first, done; /* ask[first .. first + done) were rendered last */
    double *time;       /* (slots) distinct times of the asks */
    size_t slots, time_capacity;
    int32_t *table; /* (table_size, a power of two) slots by time, open addressing: slot + 1, or 0 */
    size_t table_size, table_capacity;
    int32_t *last; /* (slots) the last request for the slot, or -1 */
    size_t last_capacity;
    td_request *request;
    size_t requests, request_capacity;
    int32_t *place; /* (asks) number of the ask's request */
    size_t place_capacity;
    double *planes; /* (requests x outputs x TD_TILE_PIXELS) */
    size_t plane_capacity;
    int outputs;
} td_launch;

struct tides_simulator;

/* td_units_lay lays out the units for the renderer: tile, first_pixel and their number. td_units_tile: the renderer's tile of a
 * unit. */
tides_status td_units_lay(struct tides_simulator *s, tides_error *error);
int32_t td_units_tile(const struct tides_simulator *s, int32_t unit);

/* Whether, and how far, a unit moves in the interval swept last. */
int td_units_moves(const struct tides_simulator *s, int32_t unit);
double td_units_travel(const struct tides_simulator *s, int32_t unit);

/* td_units_blocks: the blocks of the renderer in a unit. td_units_swaps: the swaps of depth that a unit's block sees. */
int td_units_blocks(const struct tides_simulator *s);
const td_swap *td_units_swaps(const struct tides_simulator *s, int32_t unit, int block, int *count);

static inline void td_launch_clear(td_launch *launch) { launch->count = launch->first = launch->done = 0; }
tides_status td_launch_add(td_launch *launch, int32_t unit, double time, int32_t sample, tides_error *error);

/* Renders asks from number `first` on, as many as fit in `most` jobs of the renderer, at least one. */
tides_status td_launch_render(struct tides_simulator *s, size_t first, size_t most, int side, int outputs, tides_error *error);

/* The planes of the tile that contains the unit of ask `i`, which was rendered last. */
static inline const double *td_launch_planes(const td_launch *launch, size_t i) {
    return launch->planes + (size_t)launch->place[i - launch->first] * (size_t)launch->outputs * TD_TILE_PIXELS;
}

/* Takes a rendered ask. `planes` are its tile's; td_unpack_tile extracts the unit's. Asks of one unit come in order. Other
 * threads may take asks of other units at the same time, so that a taker may change only data of the unit or the ask. */
typedef void (*td_launch_taker)(const struct tides_simulator *s, const td_ask *ask, const double *planes, const void *user);

/* Renders all asks, as many at a time as memory_mb allows (s->refine.batch), and calls `take` for each. */
tides_status td_launch_take_all(struct tides_simulator *s, int side, int outputs, td_launch_taker take, const void *user,
                                tides_error *error);

void td_launch_release(td_launch *launch);

/* The place of pixel (x, y) of a unit in its tile's planes. */
static inline int td_unit_pixel(const td_tile *unit, int x, int y) {
    return td_tile_pixel(unit->x0 % TD_TILE + x, unit->y0 % TD_TILE + y);
}

/* Extracts one plane of a unit from its tile's, as rows of the unit's pixels. */
static inline void td_unpack_plane(const td_tile *unit, const double *restrict plane, double *restrict to) {
    if (unit->width == TD_BLOCK && unit->count == TD_BLOCK_PIXELS) { /* a block's pixels are neighbours */
        memcpy(to, plane + td_unit_pixel(unit, 0, 0), TD_BLOCK_PIXELS * sizeof *to);
        return;
    }
    const int whole = unit->width / TD_BLOCK * TD_BLOCK;
    for (int y = 0; y * unit->width < unit->count; y++, to += unit->width) {
        for (int x = 0; x < whole; x += TD_BLOCK)
            for (int k = 0; k < TD_BLOCK; k++) to[x + k] = plane[td_unit_pixel(unit, x, y) + k];
        for (int x = whole; x < unit->width; x++) to[x] = plane[td_unit_pixel(unit, x, y)];
    }
}

/* S and S_dot of a rendered unit. */
static inline void td_unpack_tile(const td_tile *unit, const double *planes, double *S, double *S_dot) {
    td_unpack_plane(unit, planes + TD_OUT_L * TD_TILE_PIXELS, S);
    td_unpack_plane(unit, planes + TD_OUT_L_DOT * TD_TILE_PIXELS, S_dot);
}

#endif
