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

static td_point_paths td_paths_make(__global const int *path, __global const td_real *curves, int pieces, int slices, int split,
                                    int group) {
    td_point_paths paths;
    paths.path = path;
    paths.curves = curves;
    paths.slices.pieces = pieces;
    paths.slices.count = slices;
    paths.slices.split = split;
    paths.slices.group = group;
    return paths;
}

/* What points need of the `count` Gaussians in `seen`: their curves, c from row[2 c] to
 * row[2 c + 1], lengths[c] seconds apart, depths (Gaussians) to be sorted by, and `records` of tests. */
__kernel void td_point_make_splats(__constant const td_image *image_buffer, __global const td_real *rows,
                                   __global const int *row, __global const td_real *lengths, __global const int *seen,
                                   int count, __global const int *path, int pieces, int slices, int split, int group,
                                   __global td_real *curves, __global int *depths, __global float *records) {
    const td_image image = td_specialised(image_buffer);
    const td_point_paths paths = td_paths_make(path, curves, pieces, slices, split, group);
    const int items = (int)get_global_size(0) * TD_LANES;
    for (int i = (int)get_global_id(0) * TD_LANES; i < count; i += items) {
        int mine[TD_LANES];
        size_t at[TD_LANES];
        for (int lane = 0; lane < TD_LANES; lane++) {
            int gaussian = seen[i + lane < count ? i + lane : i];
            mine[lane] = path[gaussian];
            int first = mine[lane] / TD_PATH_LEVELS, end = first + (pieces << (mine[lane] & (TD_PATH_LEVELS - 1)));
            for (int c = first; c < end; c++)
                td_point_curve(rows + (long)row[2 * c] * TD_PATH_STRIDE, rows + (long)row[2 * c + 1] * TD_PATH_STRIDE,
                               lengths[c], curves + (long)c * TD_CURVE_REALS);
            depths[gaussian] = td_point_depth_key(&paths, mine[lane]);
            at[lane] = (size_t)gaussian * (size_t)slices * TD_TEST_REALS;
        }
        for (int slice = 0; slice < slices; slice++) {
            td_point_make_tests(&paths, &image, slice, mine, records, at);
            for (int lane = 0; lane < TD_LANES; lane++) at[lane] += TD_TEST_REALS;
        }
    }
}

/* Misfits of TD_LANES paths of a level per turn (td_path_try), in targets: the worst, then, each `stride` on, bent and calm. */
__kernel void td_point_find_misfits(__constant const td_image *image_buffer, __global const td_real *rows,
                                    __global const int *first, int count, int level, __global const td_real *lengths,
                                    int pieces, td_real target, td_real rounding, __global td_real *misfits, int stride) {
    const td_image image = td_specialised(image_buffer);
    const int items = (int)get_global_size(0) * TD_LANES;
    const td_path_terms terms = {target, 0, rounding, 0};
    for (int i = (int)get_global_id(0) * TD_LANES; i < count; i += items) {
        const td_path_misfits of = td_path_try(rows, td_load_ints(first + i), level, pieces, lengths, &terms, &image);
        td_store_lanes(misfits + i, of.worst);
        td_store_lanes(misfits + stride + i, of.bent);
        td_store_lanes(misfits + 2 * stride + i, of.calm);
    }
}

/* One work-group per tile in `wanted`: those of its candidates that have paths, by depth, `listed` (at the candidates), and
 * their tests of the splats' records; keys have twice the room. counts: (all tiles). */
__kernel void td_point_make_lists(__global const td_point_tile *tiles, __global const int *wanted,
                                  __global const int *candidates, __global const int *path, __global const int *depths,
                                  __global const float *records, int slices, __global long *keys, __global int *listed,
                                  __global float *tests, __global int *counts) {
    const int number = wanted[get_group_id(0)], me = (int)get_local_id(0), items = (int)get_local_size(0);
    const td_point_tile tile = tiles[number];
    const int capacity = td_capacity(tile.count);
    __global long *own = keys + 2 * (long)tile.first;
    for (int i = me; i < tile.count; i += items) {
        const int gaussian = candidates[tile.first + i], there = gaussian >= 0 && path[gaussian] >= 0;
        own[i] = there ? ((long)depths[gaussian] << 32) | (long)i : TD_LAST_KEY;
    }
    for (int i = tile.count + me; i < capacity; i += items) own[i] = TD_LAST_KEY;
    td_wait();
    td_bitonic_sort(own, capacity);
    if (me == 0) counts[number] = 0;
    td_wait();
    for (int i = me; i < tile.count; i += items) {
        const int there = own[i] != TD_LAST_KEY;
        const int gaussian = there ? candidates[tile.first + (int)(own[i] & 0xffffffffL)] : -1;
        __global float *place = tests + td_point_tests_at(&tile, slices, 0) + td_point_test_of(i);
        listed[tile.first + i] = there ? path[gaussian] : -1;
        if (there && (i + 1 == tile.count || own[i + 1] == TD_LAST_KEY)) counts[number] = i + 1;
        for (int slice = 0; slice < slices; slice++, place += tile.count * TD_TEST_REALS) {
            if (there)
                td_point_place_test(records + ((size_t)gaussian * (size_t)slices + (size_t)slice) * TD_TEST_REALS, &tile,
                                    place);
            else
                td_point_place_nobody(place);
        }
    }
    td_wait();
    const int taken = (counts[number] + TD_PAD - 1) / TD_PAD * TD_PAD;
    for (int slice = me; slice < slices; slice += items)
        td_point_find_fronts(tests + td_point_tests_at(&tile, slices, slice), taken / TD_PAD);
}

/* Each work-item works out its share of the chunks, in its own room for so many entries. */
__kernel void td_point_values(__constant const td_image *image_buffer, __global const td_point_tile *tiles,
                              __global const int *counts, __global const td_real *curves, int pieces, int slices, int split,
                              int group, __global const int *listed, __global const float *tests,
                              __global const td_real *columns, int stride, __global const int *piece,
                              __global const td_point_chunk *chunks, int chunk_count, __global td_real *entries, int rows,
                              td_real backdrop, td_real backdrop_dot, __global td_real *values) {
    const td_image image = td_specialised(image_buffer);
    const td_point_paths paths = td_paths_make(listed, curves, pieces, slices, split, group);
    const int me = (int)get_global_id(0), items = (int)get_global_size(0);
    td_point_lists lists;
    lists.path = listed;
    lists.tests = tests;
    td_point_arrays points;
    points.x = columns;
    points.y = columns + stride;
    points.s = columns + 2 * stride;
    points.h = columns + 3 * stride;
    points.piece = piece;
    __global td_real *own = entries + (long)me * rows * TD_POINT_ENTRY;
#if TD_LANES == 1
    const int first = me, end = chunk_count, step = items;
#else /* neighbours, which are mostly of one tile, find its tests in the cache */
    const int first = (int)((long)chunk_count * me / items), end = (int)((long)chunk_count * (me + 1) / items), step = 1;
#endif
    for (int i = first; i < end; i += step) {
        const td_point_chunk chunk = chunks[i];
        const td_point_tile tile = tiles[chunk.tile];
        td_point_chunk_values(&chunk, &tile, counts[chunk.tile], &paths, &lists, &points, &image, own, backdrop, backdrop_dot,
                              values);
    }
}
