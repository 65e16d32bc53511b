/* Orders the points of a tile, so that points near one another in place and time, which see the same splats, are computed
 * together. */
#include "td_point_order.h"

#include <string.h>

/* Weight of a step along each axis (x, y, time): the whole interval counts as much as two pixels. */
static const int weight[TD_PLACE_AXES] = {8, 8, 1};

/* The axis along which the points are farthest apart; -1: all are equal. */
static int longest(const td_point_place *places, int count) {
    int axis = -1, most = 0;
    for (int k = 0; k < TD_PLACE_AXES; k++) {
        int low = TD_PLACE_STEPS, high = 0;
        for (int i = 0; i < count; i++) {
            low = places[i].at[k] < low ? places[i].at[k] : low;
            high = places[i].at[k] > high ? places[i].at[k] : high;
        }
        if (weight[k] * (high - low) <= most) continue;
        most = weight[k] * (high - low);
        axis = k;
    }
    return axis;
}

/* Sorts places along one axis; equal places keep their order. */
static void sort_along(int axis, td_point_place *places, td_point_place *room, int count) {
    int first[TD_PLACE_STEPS + 1] = {0};
    for (int i = 0; i < count; i++) first[places[i].at[axis] + 1]++;
    for (int k = 0; k < TD_PLACE_STEPS; k++) first[k + 1] += first[k];
    memcpy(room, places, (size_t)count * sizeof *room);
    for (int i = 0; i < count; i++) places[first[room[i].at[axis]]++] = room[i];
}

void td_point_gather(td_point_place *places, td_point_place *room, int count, int lanes) {
    int axis;
    while (count > lanes && (axis = longest(places, count)) >= 0) {
        const int half = (count / lanes + 1) / 2 * lanes; /* so that only the very last group has fewer than `lanes` */
        sort_along(axis, places, room, count);
        td_point_gather(places, room, half, lanes);
        places += half;
        count -= half;
    }
}

/* Fewest places that are worth a thread of their own. */
enum { FEWEST_PLACES = 512 };

/* Arguments that the pool's threads share. */
typedef struct gathering {
    const td_point_tiles *all;
    int portions, *order;
} gathering;

static int begin_of(const td_point_tiles *all, int tile) { return tile > 0 ? all->end[tile - 1] : 0; }

/* The first tile that begins at `place` or later. */
static int tile_from(const td_point_tiles *all, int place) {
    int low = 0, high = all->tiles;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (begin_of(all, middle) < place)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Orders the tiles that begin in portion k of the places. */
static void gather_some(void *user, int k) {
    const gathering *of = user;
    const td_point_tiles *all = of->all;
    const int end = tile_from(all, td_pool_begin(all->count, of->portions, k + 1));
    for (int tile = tile_from(all, td_pool_begin(all->count, of->portions, k)); tile < end; tile++) {
        const int first = begin_of(all, tile);
        td_point_gather(all->places + first, all->room + first, all->end[tile] - first, all->lanes);
        for (int i = first; i < all->end[tile]; i++) of->order[i] = all->places[i].which;
    }
}

void td_point_gather_all(td_pool *pool, const td_point_tiles *all, int *order) {
    gathering of = {all, td_pool_portions(pool, all->count, FEWEST_PLACES), order};
    td_pool_run(pool, of.portions, gather_some, &of);
}
