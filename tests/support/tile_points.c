/* Values of single pixels from whole tiles: renders many tiles at a time, and takes one pixel of each. */
#include "tile_points.h"

#include "render/td_renderer.h"

#include <stdlib.h>

enum { TILES_AT_ONCE = 256 };

/* Requests a tile at its time for each of `count` points. */
static void ask(const tides_renderer *renderer, const td_point *points, int count, double *times, td_request *requests) {
    for (int i = 0; i < count; i++) {
        times[i] = points[i].time;
        requests[i].tile = points[i].y / TD_TILE * td_renderer_tiles_across(renderer) + points[i].x / TD_TILE;
        requests[i].slot = i;
        requests[i].blocks = 1 << (points[i].y % TD_TILE / TD_BLOCK * (TD_TILE / TD_BLOCK) + points[i].x % TD_TILE / TD_BLOCK);
    }
}

/* Takes one pixel of each tile. */
static void take(const td_point *points, int count, const double *planes, td_point_value *values) {
    for (int i = 0; i < count; i++) {
        const double *tile = planes + (size_t)i * TD_OUT_SIGNAL * TD_TILE_PIXELS;
        const int at = td_tile_pixel(points[i].x % TD_TILE, points[i].y % TD_TILE);
        values[i] = (td_point_value){tile[TD_OUT_L * TD_TILE_PIXELS + at], tile[TD_OUT_L_DOT * TD_TILE_PIXELS + at]};
    }
}

tides_status tile_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                         td_point_value *values, tides_error *error) {
    double times[TILES_AT_ONCE];
    td_request requests[TILES_AT_ONCE];
    double *planes = td_alloc((size_t)TILES_AT_ONCE * TD_OUT_SIGNAL * TD_TILE_PIXELS, sizeof *planes, error);
    tides_status status = planes ? TIDES_OK : TIDES_NO_MEMORY;
    for (size_t from = 0; from < count && status == TIDES_OK; from += TILES_AT_ONCE) {
        const int some = (int)(count - from < TILES_AT_ONCE ? count - from : TILES_AT_ONCE);
        ask(renderer, points + from, some, times, requests);
        const td_tile_batch batch = {times, some, TD_SIDE_BEGINS, requests, some, TD_OUT_SIGNAL};
        status = td_renderer_tiles(renderer, camera, &batch, planes, error);
        if (status == TIDES_OK) take(points + from, some, planes, values + from);
    }
    free(planes);
    return status;
}
