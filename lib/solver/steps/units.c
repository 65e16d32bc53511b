/* Units and their samples: divides an image into the units that have steps of their own, and renders units at times as jobs of
 * the renderer. */
#include "solver/td_simulator.h"

#include <stdlib.h>

/* -- the image in units ---------------------------------------------------------------------------------------------------- */

static double smaller(double a, double b) { return a < b ? a : b; }

/* Adds the unit with its upper left pixel at (x0, y0), cut to the image. A unit outside of the image isn't added. */
static void add_unit(tides_simulator *s, int x0, int y0, int side) {
    if (x0 >= s->layout.width || y0 >= s->layout.height) return;
    const int width = (int)smaller(side, s->layout.width - x0), height = (int)smaller(side, s->layout.height - y0);
    s->layout.unit[s->layout.units] = (td_tile){x0, y0, width, width * height};
    s->layout.first_pixel[s->layout.units + 1] = s->layout.first_pixel[s->layout.units] + (size_t)(width * height);
    s->layout.units++;
}

tides_status td_units_lay(tides_simulator *s, tides_error *error) {
    const int blocks = s->given.unit == TIDES_UNIT_BLOCK, side = blocks ? TD_BLOCK : TD_TILE,
              each = blocks ? TD_TILE_BLOCKS : 1;
    const size_t most = (size_t)s->layout.image_tiles * (size_t)each;
    s->layout.unit = td_alloc(most, sizeof *s->layout.unit, error);
    s->layout.first_pixel = td_alloc(most + 1, sizeof *s->layout.first_pixel, error);
    if (!s->layout.unit || !s->layout.first_pixel) return TIDES_NO_MEMORY;
    if (blocks) td_renderer_by_blocks(s->renderer);
    const int across = td_renderer_tiles_across(s->renderer);
    for (int t = 0; t < s->layout.image_tiles; t++)
        for (int k = 0; k < each; k++)
            add_unit(s, t % across * TD_TILE + k % 4 * TD_BLOCK, t / across * TD_TILE + k / 4 * TD_BLOCK, side);
    return TIDES_OK;
}

int32_t td_units_tile(const tides_simulator *s, int32_t unit) {
    const td_tile *at = &s->layout.unit[unit];
    return at->y0 / TD_TILE * td_renderer_tiles_across(s->renderer) + at->x0 / TD_TILE;
}

/* The number of a unit within its tile, row by row. */
static int block_of(const tides_simulator *s, int32_t unit) {
    const td_tile *at = &s->layout.unit[unit];
    return at->y0 % TD_TILE / TD_BLOCK * (TD_TILE / TD_BLOCK) + at->x0 % TD_TILE / TD_BLOCK;
}

int td_units_moves(const tides_simulator *s, int32_t unit) {
    const int tile = td_units_tile(s, unit);
    if (s->given.unit == TIDES_UNIT_TILE) return td_renderer_tile_moves(s->renderer, tile);
    return td_renderer_block_moves(s->renderer, tile, block_of(s, unit));
}

double td_units_travel(const tides_simulator *s, int32_t unit) {
    const int tile = td_units_tile(s, unit);
    if (s->given.unit == TIDES_UNIT_TILE) return td_renderer_tile_travel(s->renderer, tile);
    return td_renderer_block_travel(s->renderer, tile, block_of(s, unit));
}

int td_units_blocks(const tides_simulator *s) { return s->given.unit == TIDES_UNIT_TILE ? TD_TILE_BLOCKS : 1; }

const td_swap *td_units_swaps(const tides_simulator *s, int32_t unit, int block, int *count) {
    return td_renderer_swaps(s->renderer, td_units_tile(s, unit), s->given.unit == TIDES_UNIT_TILE ? block : block_of(s, unit),
                             count);
}

/* -- what is asked for ----------------------------------------------------------------------------------------------------- */

tides_status td_launch_add(td_launch *l, int32_t unit, double time, int32_t sample, tides_error *error) {
    tides_status status = td_reserve((void **)&l->ask, &l->ask_capacity, l->count + 1, sizeof *l->ask, error);
    if (status == TIDES_OK) l->ask[l->count++] = (td_ask){time, unit, sample};
    return status;
}

/* The place of a time in the hash table, or the free place for it. */
static size_t place_of(const td_launch *l, double time) {
    uint64_t bits;
    memcpy(&bits, &time, sizeof bits);
    bits *= 0x9e3779b97f4a7c15u; /* 2^64 over the golden ratio: Fibonacci hashing, the upper bits are the mixed ones */
    size_t at = (size_t)(bits >> 32) & (l->table_size - 1);
    while (l->table[at] && memcmp(&l->time[l->table[at] - 1], &time, sizeof time) != 0) at = (at + 1) & (l->table_size - 1);
    return at;
}

/* Makes the table anew with `size` places, and enters all times. */
static tides_status renew_table(td_launch *l, size_t size, tides_error *error) {
    tides_status status = td_reserve((void **)&l->table, &l->table_capacity, size, sizeof *l->table, error);
    if (status != TIDES_OK) return status;
    l->table_size = size;
    memset(l->table, 0, size * sizeof *l->table);
    for (size_t k = 0; k < l->slots; k++) l->table[place_of(l, l->time[k])] = (int32_t)k + 1;
    return TIDES_OK;
}

/* The slot of a time, a new one where there is none. */
static tides_status find_slot(td_launch *l, double time, int32_t *slot, tides_error *error) {
    enum { LEAST = 64 };
    tides_status status = TIDES_OK;
    if (2 * (l->slots + 1) > l->table_size) status = renew_table(l, l->table_size ? 2 * l->table_size : LEAST, error);
    if (status != TIDES_OK) return status;
    size_t at = place_of(l, time);
    if (l->table[at] == 0) {
        status = td_reserve((void **)&l->time, &l->time_capacity, l->slots + 1, sizeof *l->time, error);
        if (status == TIDES_OK) status = td_reserve((void **)&l->last, &l->last_capacity, l->slots + 1, sizeof *l->last, error);
        if (status != TIDES_OK) return status;
        l->time[l->slots] = time;
        l->last[l->slots++] = -1;
        l->table[at] = (int32_t)l->slots;
    }
    *slot = l->table[at] - 1;
    return TIDES_OK;
}

/* The request that an ask joins: a new one, unless the last request of its time is for the same tile. Units of a tile are asked
 * for one after the other. */
static tides_status join_request(const tides_simulator *s, td_launch *l, const td_ask *ask, int32_t *place,
                                 tides_error *error) {
    int32_t slot, tile = td_units_tile(s, ask->unit);
    tides_status status = find_slot(l, ask->time, &slot, error);
    if (status != TIDES_OK) return status;
    if (l->last[slot] < 0 || l->request[l->last[slot]].tile != tile) {
        status = td_reserve((void **)&l->request, &l->request_capacity, l->requests + 1, sizeof *l->request, error);
        if (status != TIDES_OK) return status;
        l->request[l->requests] = (td_request){tile, slot, 0};
        l->last[slot] = (int32_t)l->requests++;
    }
    *place = l->last[slot];
    if (s->given.unit == TIDES_UNIT_BLOCK) l->request[*place].blocks |= 1 << block_of(s, ask->unit);
    return TIDES_OK;
}

/* Makes requests for asks from number `first` on, `most` at most. */
static tides_status gather(const tides_simulator *s, td_launch *l, size_t first, size_t most, tides_error *error) {
    l->first = first;
    l->done = l->slots = l->requests = 0;
    tides_status status = td_reserve((void **)&l->place, &l->place_capacity, l->count - first, sizeof *l->place, error);
    if (status == TIDES_OK && l->table_size) status = renew_table(l, l->table_size, error);
    for (size_t i = first; i < l->count && status == TIDES_OK && (l->requests < most || i == first); i++) {
        status = join_request(s, l, &l->ask[i], &l->place[i - first], error);
        l->done++;
    }
    return status;
}

tides_status td_launch_render(tides_simulator *s, size_t first, size_t most, int side, int outputs, tides_error *error) {
    td_launch *l = &s->launch;
    tides_status status = gather(s, l, first, most, error);
    if (status == TIDES_OK)
        status = td_renew((void **)&l->planes, &l->plane_capacity, l->requests * (size_t)outputs * TD_TILE_PIXELS,
                          sizeof *l->planes, error);
    if (status != TIDES_OK || l->done == 0) return status;
    l->outputs = outputs;
    const td_tile_batch batch = {l->time, (int)l->slots, side, l->request, (int)l->requests, outputs};
    return td_renderer_tiles(s->renderer, s->camera, &batch, l->planes, error);
}

/* Rendered asks that are to be taken, from number `first` on. */
typedef struct taking {
    td_launch_taker take;
    const void *user;
    size_t first, count;
} taking;

/* The first ask from number k on that begins a unit: one thread takes all asks of a unit. */
static size_t begins_unit(const td_launch *l, const taking *all, int k) {
    size_t i = all->first + (size_t)k;
    while (k > 0 && i < all->first + all->count && l->ask[i].unit == l->ask[i - 1].unit) i++;
    return i;
}

static tides_status take_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                              tides_error *error) {
    const taking *all = user;
    const td_launch *l = &s->launch;
    (void)portion, (void)error;
    for (size_t i = begins_unit(l, all, first), stop = begins_unit(l, all, end); i < stop; i++)
        all->take(s, &l->ask[i], td_launch_planes(l, i), all->user);
    return TIDES_OK;
}

/* Takes what was rendered last, in runs of asks in which units ascend, so that all asks of a unit in a run are neighbours. */
static tides_status take_rendered(tides_simulator *s, td_launch_taker take, const void *user, tides_error *error) {
    enum { FEWEST = 16 };
    const td_launch *l = &s->launch;
    tides_status status = TIDES_OK;
    taking all = {take, user, l->first, 0};
    for (const size_t end = l->first + l->done; all.first < end && status == TIDES_OK; all.first += all.count) {
        all.count = 1;
        while (all.first + all.count < end && l->ask[all.first + all.count].unit >= l->ask[all.first + all.count - 1].unit)
            all.count++;
        status = td_share_out(s, (int)all.count, FEWEST, take_some, &all, error);
    }
    return status;
}

tides_status td_launch_take_all(tides_simulator *s, int side, int outputs, td_launch_taker take, const void *user,
                                tides_error *error) {
    td_launch *l = &s->launch;
    tides_status status = TIDES_OK;
    for (size_t first = 0; first < l->count && status == TIDES_OK; first += l->done) {
        status = td_launch_render(s, first, s->refine.batch, side, outputs, error);
        if (status == TIDES_OK) status = take_rendered(s, take, user, error);
    }
    return status;
}

void td_launch_release(td_launch *launch) {
    free(launch->ask);
    free(launch->time);
    free(launch->table);
    free(launch->last);
    free(launch->request);
    free(launch->place);
    free(launch->planes);
    *launch = (td_launch){0};
}
