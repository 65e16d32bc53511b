/* Single pixels at single times (points.h), in double precision: the lists of tiles, and the points. */
#include "bitonic.h"
#include "path_node.h"
#include "points.h"
#include "specialise.h"

/* Until the work-group's writes are done: one work-item is its own. */
#if TD_LANES == 1
#define td_wait() barrier(CLK_GLOBAL_MEM_FENCE)
#else
#define td_wait()
#endif

static td_point_paths td_paths_make(__global const int *path, __global const td_real *curves, int pieces) {
    td_point_paths paths;
    paths.path = path;
    paths.curves = curves;
    paths.pieces = pieces;
    return paths;
}

/* Curve c from row[2 c] to row[2 c + 1], lengths[c] seconds apart. */
__kernel void td_point_bend_curves(__global const td_real *rows, __global const int *row, __global const td_real *lengths,
                                   int count, __global td_real *curves) {
    const int items = (int)get_global_size(0);
    for (int i = (int)get_global_id(0); i < count; i += items)
        td_point_curve(rows + (long)row[2 * i] * TD_PATH_STRIDE, rows + (long)row[2 * i + 1] * TD_PATH_STRIDE, lengths[i],
                       curves + (long)i * TD_CURVE_REALS);
}

/* Misfits of TD_LANES paths of a level per turn (td_path_worst), in targets. */
__kernel void td_point_find_misfits(__constant const td_image *image_buffer, __global const td_real *rows,
                                    __global const int *first, int count, int level, __global const td_real *lengths,
                                    int pieces, td_real target, td_real rounding, __global td_real *misfits) {
    const td_image image = td_specialised(image_buffer);
    const int items = (int)get_global_size(0) * TD_LANES;
    const td_path_terms terms = {target, 0, rounding, 0};
    for (int i = (int)get_global_id(0) * TD_LANES; i < count; i += items)
        td_store_lanes(misfits + i, td_path_worst(rows, td_load_ints(first + i), level, pieces, lengths, &terms, &image));
}

/* A key that sorts by depth, roughly: whoever is behind the camera in the interval's middle comes first. */
static long td_point_key(td_real depth, int place) {
    td_real near = depth > 0 ? depth : 0;
#ifdef TD_REAL_DOUBLE
    return (as_long(near) & ~0xffffffffL) | (long)place;
#else
    return ((long)as_int(near) << 32) | (long)place;
#endif
}

/* One work-group per tile in `wanted`: which blocks its candidates may reach, `reached` (at the candidates), how strongly, and
 * those that reach one by depth; keys have twice the room. counts: (all tiles). */
__kernel void td_point_make_lists(__constant const td_image *image_buffer, __global const td_point_tile *tiles,
                                  __global const int *wanted, __global const int *candidates, __global const int *path,
                                  __global const td_real *curves, int pieces, __global int *reached,
                                  __global td_real *strongest, __global long *keys, __global int *gaussian,
                                  __global int *blocks, __global td_real *power, __global int *counts) {
    const td_image image = td_specialised(image_buffer);
    const td_point_paths paths = td_paths_make(path, curves, pieces);
    const int number = wanted[get_group_id(0)], me = (int)get_local_id(0), items = (int)get_local_size(0);
    const td_point_tile tile = tiles[number];
    const int capacity = td_capacity(tile.count);
    __global long *own = keys + 2 * (long)tile.first;
    for (int i = me * TD_LANES; i < tile.count; i += items * TD_LANES) {
        td_lanes depth, most;
        td_real z[TD_LANES];
        int bits[TD_LANES];
        td_index reach = td_point_candidates(&paths, &image, &tile, td_load_ints(candidates + tile.first + i), &depth, &most);
        td_spread(depth, z);
        td_index_lanes(reach, bits);
        td_store_ints(reached + tile.first + i, reach);
        td_store_lanes(strongest + tile.first + i, most);
        for (int lane = 0; lane < TD_LANES; lane++) own[i + lane] = bits[lane] ? td_point_key(z[lane], i + lane) : TD_LAST_KEY;
    }
    for (int i = tile.count + me; i < capacity; i += items) own[i] = TD_LAST_KEY;
    td_wait();
    td_bitonic_sort(own, capacity);
    if (me == 0) counts[number] = 0;
    td_wait();
    for (int i = me; i < tile.count; i += items) {
        if (own[i] == TD_LAST_KEY) continue;
        const int place = (int)(own[i] & 0xffffffffL);
        gaussian[tile.first + i] = candidates[tile.first + place];
        blocks[tile.first + i] = reached[tile.first + place];
        power[tile.first + i] = strongest[tile.first + place];
        if (i + 1 == tile.count || own[i + 1] == TD_LAST_KEY) counts[number] = i + 1;
    }
}

/* Each work-item works out its share of the chunks, in its own room for lists of `longest` splats (td_point_room). */
__kernel void td_point_values(__constant const td_image *image_buffer, __global const td_point_tile *tiles,
                              __global const int *counts, __global const int *path, __global const td_real *curves, int pieces,
                              __global const int *gaussian, __global const int *blocks, __global const td_real *power,
                              __global const td_real *columns, int stride, __global const int *piece,
                              __global const td_point_chunk *chunks, int chunk_count, __global td_real *entries,
                              __global int *order, __global int *found, int longest, td_real backdrop, td_real backdrop_dot,
                              __global td_real *values) {
    const td_image image = td_specialised(image_buffer);
    const td_point_paths paths = td_paths_make(path, curves, pieces);
    const int me = (int)get_global_id(0), items = (int)get_global_size(0);
    td_point_lists lists;
    lists.gaussian = gaussian;
    lists.blocks = blocks;
    lists.power = power;
    td_point_arrays points;
    points.x = columns;
    points.y = columns + stride;
    points.s = columns + 2 * stride;
    points.h = columns + 3 * stride;
    points.piece = piece;
    td_point_room room;
    room.entries = entries + (long)me * (longest + 1) * (TD_POINT_ENTRY * TD_LANES);
    room.order = order + (long)me * (longest + 1) * TD_LANES;
    room.found = found + (long)me * (longest + 1);
#if TD_LANES == 1
    const int first = me, end = chunk_count, step = items;
#else /* neighbours, which are mostly of one tile, find its rows in the cache */
    const int first = (int)((long)chunk_count * me / items), end = (int)((long)chunk_count * (me + 1) / items), step = 1;
#endif
    for (int i = first; i < end; i += step) {
        const td_point_chunk chunk = chunks[i];
        td_point_tile tile = tiles[chunk.tile];
        tile.count = counts[chunk.tile];
        td_point_chunk_values(&chunk, &tile, &paths, &lists, &points, &image, &room, backdrop, backdrop_dot, values);
    }
}
