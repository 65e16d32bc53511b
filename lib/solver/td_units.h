/* Internal: the units that have steps of their own, and rendering them at times.
 *
 * A unit is a 16x16 tile of the renderer, or a 4x4 block of one (stepping.unit). The solver calls its units tiles: td_tile says
 * where each is, and their pixels stand unit by unit in all of its arrays. Units of one tile that are wanted at one time are
 * one job of the renderer, which projects and sorts once for them. */
#ifndef TD_UNITS_H
#define TD_UNITS_H

#include "render/td_render.h"
#include "signal/td_signals.h"

/* A unit wanted at a time; `sample` is the caller's. */
typedef struct td_ask {
    double time; /* [s after the epoch] */
    int32_t unit, sample;
} td_ask;

/* The requests of a launch and its renders; memory is kept from one launch to the next. */
typedef struct td_launch {
    td_ask *ask;
    size_t count, ask_capacity;
    size_t first, done; /* ask[first .. first + done) have been rendered last */
    double *time;       /* (slots) their distinct times */
    size_t slots, time_capacity;
    int32_t *table; /* (table_size, a power of two) slots by time, open addressing: slot + 1, or 0 */
    size_t table_size, table_capacity;
    int32_t *last; /* (slots) the request made last for the slot, or -1 */
    size_t last_capacity;
    td_request *request;
    size_t requests, request_capacity;
    int32_t *place; /* (asks) the request of each */
    size_t place_capacity;
    double *planes; /* (requests x outputs x TD_TILE_PIXELS) */
    size_t plane_capacity;
    int outputs;
} td_launch;

struct tides_simulator;

/* The image's units, for the renderer that is there: tile, first_pixel and how many; then in which of the renderer's tiles one
 * is. */
tides_status td_units_lay(struct tides_simulator *s, tides_error *error);
int32_t td_units_tile(const struct tides_simulator *s, int32_t unit);

/* A unit's motion in the interval swept last: td_renderer_tile_moves and _travel of it. */
int td_units_moves(const struct tides_simulator *s, int32_t unit);
double td_units_travel(const struct tides_simulator *s, int32_t unit);

/* The renderer's blocks of a unit, and the swaps of depth that one of them sees (td_renderer_swaps). */
int td_units_blocks(const struct tides_simulator *s);
const td_swap *td_units_swaps(const struct tides_simulator *s, int32_t unit, int block, int *count);

static inline void td_launch_clear(td_launch *launch) { launch->count = launch->first = launch->done = 0; }
tides_status td_launch_add(td_launch *launch, int32_t unit, double time, int32_t sample, tides_error *error);

/* Renders asks from number `first` on, as many as `most` jobs of the renderer hold, at least one. */
tides_status td_launch_render(struct tides_simulator *s, size_t first, size_t most, int side, int outputs, tides_error *error);

/* The planes of the tile that holds the unit of ask `i`, which has just been rendered: td_unpack_tile takes the unit's. */
static inline const double *td_launch_planes(const td_launch *launch, size_t i) {
    return launch->planes + (size_t)launch->place[i - launch->first] * (size_t)launch->outputs * TD_TILE_PIXELS;
}

/* Takes a rendered ask; `planes` are its tile's, and td_unpack_tile takes the unit's. Asks of one unit come in order. Other
 * threads may take other units' asks meanwhile: a taker may change only the unit's or the ask's own data. */
typedef void (*td_launch_taker)(struct tides_simulator *s, const td_ask *ask, const double *planes, const void *user);

/* Renders all asks, as many at a time as memory_mb has room for (s->refine.batch), and has each taken. */
tides_status td_launch_take_all(struct tides_simulator *s, int side, int outputs, td_launch_taker take, const void *user,
                                tides_error *error);

void td_launch_release(td_launch *launch);

/* Where pixel (x, y) of a unit is in the planes of its tile. */
static inline int td_unit_pixel(const td_tile *unit, int x, int y) {
    return td_tile_pixel(unit->x0 % TD_TILE + x, unit->y0 % TD_TILE + y);
}

/* One plane of a unit from those of its tile, as rows of the unit's pixels. */
static inline void td_unpack_plane(const td_tile *unit, const double *restrict plane, double *restrict to) {
    if (unit->width == TD_BLOCK && unit->count == TD_BLOCK_PIXELS) { /* is stored as it is wanted */
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
