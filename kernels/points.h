/* Single pixels at single times: L and L_dot on the image made of record paths (path.h), which the solver solves events on.
 *
 * A point has a list of its own: of its tile's splats those that a quick test leaves (point_tests.h), of these those that it
 * sees, TD_LANES at a time, each on its curve at the point's time (point_splats.h), in the order of that time: splats change
 * places rarely, so that the tile's order is nearly it. Then light goes down the lists of TD_LANES points together
 * (point_light.h). What a point gets depends on nothing but itself. Every splat counts but those behind what is opaque
 * (TD_POINT_OPAQUE): the image's stop rule doesn't; where it drops splats, or the extent isn't the ellipse, there are no points
 * (lib/render/points.c says so). */
#ifndef TD_POINTS_H
#define TD_POINTS_H

#include "point_light.h"

/* Makes a point's list in the room of a lane, of the first `taken` places of its tile's; returns how many splats it sees. */
TD_INLINE int td_point_list(const td_point_paths *paths, const td_point_lists *lists, const td_point_tile *tile, int taken,
                            const td_image *image, const td_point_arrays *points, int point, int lane,
                            const td_point_room *room) {
    td_real way[TD_PATH_LEVELS], rate[TD_PATH_LEVELS], s = points->s[point];
    int number[TD_PATH_LEVELS], piece = points->piece[point], count = 0, done = 0;
    float w, x = (float)(points->x[point] - (td_real)tile->x), y = (float)(points->y[point] - (td_real)tile->y);
    td_point_eye eye = {points->x[point], points->y[point], 0, 0, 0, TD_POINT_NEVER};
    TD_GLOBAL const int *listed = lists->path + tile->first;
    TD_GLOBAL const float *tests =
        lists->tests + td_point_tests_at(tile, &paths->slices, td_point_slice(&paths->slices, piece, s, &w));
    td_point_weights(s, points->h[point], piece, way, rate, number);
    for (int i = 0; i < taken && td_point_front(tests, i) < (float)eye.end;) {
        for (; i < taken && count - done <= TD_POINT_BATCH - TD_POINT_ASKED; i += TD_POINT_ASKED)
            for (td_point_bits bits = td_point_ask(tests, i, taken, x, y, w); bits; bits &= bits - 1) {
                int path = listed[i + td_point_lowest(bits)], level = path & (TD_PATH_LEVELS - 1);
                room->found.path[count] = path;
                room->found.curve[count] = (path / TD_PATH_LEVELS + number[level]) * TD_CURVE_REALS;
                room->found.way[count] = way[level];
                room->found.rate[count++] = rate[level];
            }
        td_point_look(paths->curves, image, room, lane, done, count - done, &eye);
        done = count;
    }
    return eye.seen;
}

/* Values of a chunk's points: values[2 * point] = L, [2 * point + 1] = L_dot. taken: places of the tile's list. */
TD_INLINE void td_point_chunk_values(const td_point_chunk *chunk, const td_point_tile *tile, int taken,
                                     const td_point_paths *paths, const td_point_lists *lists, const td_point_arrays *points,
                                     const td_image *image, const td_point_room *room, td_real backdrop, td_real backdrop_dot,
                                     TD_GLOBAL td_real *values) {
    int seen[TD_LANES], most = 0;
    td_real L[TD_LANES], L_dot[TD_LANES];
    td_lanes planes[3];
    for (int lane = 0; lane < TD_LANES; lane++) {
        seen[lane] = 0;
        for (int k = 0; k < TD_POINT_ENTRY; k++) room->entries[lane * room->rows * TD_POINT_ENTRY + k] = 0;
        if (lane >= chunk->count) continue;
        seen[lane] = td_point_list(paths, lists, tile, taken, image, points, chunk->first + lane, lane, room);
        most = seen[lane] > most ? seen[lane] : most;
    }
    for (int lane = 0; lane < TD_LANES; lane++)
        for (int j = seen[lane]; j <= most; j++) room->order[j * TD_LANES + lane] = 0;
    td_point_light light = td_point_composite(image, room, most);
    td_finish_luminance(td_fma(light.t, backdrop, light.y),
                        td_fma(light.t_dot, backdrop, td_fma(light.t, backdrop_dot, light.y_dot)), image->log_eps, planes);
    td_spread(planes[0], L);
    td_spread(planes[1], L_dot);
    for (int lane = 0; lane < chunk->count; lane++) {
        values[2 * (chunk->first + lane)] = L[lane];
        values[2 * (chunk->first + lane) + 1] = L_dot[lane];
    }
}

#endif
