/* Internal to lib/render: the order of a tile's points. Points that are near in place and time see the same splats on the
 * same curves, so they are computed together. The set of points is cut in two along the axis where they are farthest apart,
 * and each part again. Along a space-filling curve, as before, 3 to 8 % more splats were entered. */
#ifndef TD_POINT_ORDER_H
#define TD_POINT_ORDER_H

#include "td_pool.h"

#include <stdint.h>

/* A point in its tile: pixel x and y, and time within the interval, each in TD_PLACE_STEPS steps; and its number. */
enum { TD_PLACE_AXES = 3, TD_PLACE_STEPS = 16 };
typedef struct td_point_place {
    uint8_t at[TD_PLACE_AXES];
    int which;
} td_point_place;

/* Orders a tile's places, so that each run of `lanes` from the first on has near neighbours. room: (count). */
void td_point_gather(td_point_place *places, td_point_place *room, int count, int lanes);

/* Places of all tiles: those of tile t end at end[t], and begin where the tile before ends. */
typedef struct td_point_tiles {
    td_point_place *places, *room; /* (count) */
    const int *end;                /* (tiles) */
    int tiles, count, lanes;
} td_point_tiles;

/* Orders the places of each tile, on the pool's threads; their numbers: order (count). */
void td_point_gather_all(td_pool *pool, const td_point_tiles *all, int *order);

#endif
