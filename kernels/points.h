/* Single pixels at single times: L and L_dot on the image made of record paths (path.h), which the solver solves events on.
 *
 * TD_LANES points of one tile, neighbours in place and time, go down their tile's list together, a lane each. A quick test
 * keeps the splats that any of them may see (point_tests.h); each is worked out for all lanes, on its curve at each lane's own
 * time, and entered where that time's depth puts it (point_entries.h). Then light goes through the entries (point_light.h). A
 * point's result depends on nothing but itself: a splat that it doesn't see changes no bit of it, whichever other point sees
 * the splat. Every splat counts but those behind opaque ones (TD_POINT_OPAQUE): the image's stop rule isn't applied. Where that
 * rule drops splats, or the extent isn't the ellipse, there are no points (lib/render/points.c). */
#ifndef TD_POINTS_H
#define TD_POINTS_H

#include "point_light.h"

/* May any of the lanes see what is nearest from place i on? */
TD_INLINE int td_point_goes_on(TD_GLOBAL const float *tests, const int *slice, int i, td_lanes end) {
    td_real last[TD_LANES];
    td_spread(end, last);
    for (int lane = 0; lane < TD_LANES; lane++)
        if (td_point_front(tests + slice[lane], i) < (float)last[lane]) return 1;
    return 0;
}

/* Prefetches a curve: four lines of memory. */
TD_INLINE void td_point_soon(TD_GLOBAL const td_real *curve) {
    td_soon(curve), td_soon(curve + 8), td_soon(curve + 16), td_soon(curve + 24);
}

/* Enters what a chunk's points see of the first `taken` places of their tile's list; how much that is. Lanes without a point
 * have that of the first. */
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
                td_point_soon(paths->curves + path / TD_PATH_LEVELS * TD_CURVE_REALS + curve[level * TD_LANES]);
                found[count++] = place;
            }
        td_point_look(paths, image, lists->places, found, count, way, rate, curve, together, entries, &eye);
    }
    td_point_settle(image, entries, &eye.order);
    return eye.order.count;
}

/* Values of a chunk's points: values[2 * point] = L, [2 * point + 1] = L_dot. taken: places of the tile's list; entries: room
 * of the work-item's own for as many, td_point_room each. */
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
        /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): it doesn't know that a chunk has a lane for each point */
        values[2 * (chunk->first + lane)] = L[lane];
        values[2 * (chunk->first + lane) + 1] = L_dot[lane];
    }
}

#endif
