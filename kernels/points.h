/* Points: single pixels at single times. L and L_dot of the image made of record paths, on which the solver finds event times.
 *
 * TD_LANES points of one tile, neighbours in place and time, go down their tile's list together, a lane each. A quick test
 * keeps the splats that any of them may see. Each of these is computed for all lanes, on its curve at each lane's own time, and
 * inserted by its depth at that time. Then the light is composited. A point's result depends on nothing but itself: a splat
 * that it doesn't see changes no bit of it, even if another lane sees the splat. The image's stop rule isn't applied; splats
 * are dropped only behind TD_POINT_OPAQUE. Where that rule drops splats, or a splat's extent isn't its ellipse, the renderer
 * offers no points. */
#ifndef TD_POINTS_H
#define TD_POINTS_H

#include "point_light.h"

/* 1 if any lane may see a splat at place i of the list or behind it. end: each lane's depth behind which nothing is seen. */
TD_INLINE int td_point_goes_on(TD_GLOBAL const float *tests, const int *slice, int i, td_lanes end) {
    td_real last[TD_LANES];
    td_spread(end, last);
    for (int lane = 0; lane < TD_LANES; lane++)
        if (td_point_front(tests + slice[lane], i) < (float)last[lane]) return 1;
    return 0;
}

/* Prefetches a path's curve at `at`: four cache lines, and the one beside it. */
TD_INLINE void td_point_prefetch(const td_point_paths *paths, const td_image *image, int path, int at) {
    TD_GLOBAL const td_real *curve = paths->curves + path / TD_PATH_LEVELS * TD_CURVE_REALS + at;
    td_prefetch(curve), td_prefetch(curve + 8), td_prefetch(curve + 16), td_prefetch(curve + 24);
    if (td_paths_by_channels(image))
        td_prefetch(paths->beside + path / TD_PATH_LEVELS * TD_BESIDE_REALS + td_point_beside_at(at));
}

/* Enters what a chunk's points see of the first `taken` places of their tile's list. Returns the number of entries. Lanes
 * without a point repeat the first point. */
TD_INLINE int td_point_enter_all(const td_point_chunk *chunk, const td_point_tile *tile, int taken, const td_point_paths *paths,
                                 const td_point_lists *lists, const td_point_arrays *points, const td_image *image,
                                 TD_GLOBAL td_real *entries) {
    td_real way[TD_PATH_LEVELS * TD_LANES], rate[TD_PATH_LEVELS * TD_LANES], x[TD_LANES], y[TD_LANES];
    int curve[TD_PATH_LEVELS * TD_LANES], together[TD_PATH_LEVELS], slice[TD_LANES], found[TD_POINT_BATCH];
    float across[TD_LANES], down[TD_LANES], w[TD_LANES];
    for (int lane = 0; lane < TD_LANES; lane++) {
        int point = chunk->first + (lane < chunk->count ? lane : 0), piece = points->piece[point];
        x[lane] = points->x[point], y[lane] = points->y[point];
        across[lane] = (float)(x[lane] - (td_real)tile->x), down[lane] = (float)(y[lane] - (td_real)tile->y);
        slice[lane] = td_point_slice(&paths->slices, piece, points->s[point], &w[lane]) * tile->count * TD_TEST_REALS;
        td_point_weights(points->s[point], points->h[point], piece, lane, way, rate, curve);
    }
    for (int level = 0; level < TD_PATH_LEVELS; level++) together[level] = td_point_together(curve + level * TD_LANES);
    td_point_eye eye = {td_collect(x), td_collect(y), td_splat(0.0f), td_splat(0.0f), td_splat(TD_POINT_NEVER), {0, 0, 0}};
    TD_GLOBAL const float *tests = lists->tests + td_point_tests_at(tile, paths->slices.count, 0);
    for (int i = 0; i < taken && td_point_goes_on(tests, slice, i, eye.end);) {
        int count = 0;
        for (; i < taken && count <= TD_POINT_BATCH - TD_POINT_ASKED; i += TD_POINT_ASKED)
            for (td_point_bits bits = td_point_ask(tests, slice, chunk->count, i, taken, across, down, w); bits;
                 bits &= bits - 1) {
                const int place = (tile->first + i + td_point_lowest(bits)) * TD_LIST_INTS;
                const int path = lists->places[place + TD_L_PATH], level = path & (TD_PATH_LEVELS - 1);
                td_point_prefetch(paths, image, path, curve[level * TD_LANES]);
                found[count++] = place;
            }
        td_point_look(paths, image, lists->places, found, count, way, rate, curve, together, entries, &eye);
    }
    td_point_settle(image, entries, &eye.order);
    return eye.order.count;
}

/* Values of a chunk's points: values[2 * point] = L, [2 * point + 1] = L_dot. `taken` is the length of the tile's list;
 * `entries` has room for so many, td_point_room reals each. */
TD_INLINE void td_point_chunk_values(const td_point_chunk *chunk, const td_point_tile *tile, int taken,
                                     const td_point_paths *paths, const td_point_lists *lists, const td_point_arrays *points,
                                     const td_image *image, TD_GLOBAL td_real *entries, const td_point_backdrop *behind,
                                     TD_GLOBAL td_real *values) {
    td_real L[TD_LANES], L_dot[TD_LANES];
    td_lanes planes[3];
    int count = td_point_enter_all(chunk, tile, taken, paths, lists, points, image, entries);
    td_point_light light = td_point_composite(image, entries, count);
    td_point_finish(image, &light, behind, planes);
    td_spread(planes[0], L);
    td_spread(planes[1], L_dot);
    for (int lane = 0; lane < chunk->count; lane++) {
        /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): a chunk has a lane for each point */
        values[2 * (chunk->first + lane)] = L[lane];
        values[2 * (chunk->first + lane) + 1] = L_dot[lane];
    }
}

#endif
