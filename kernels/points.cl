/* Points, single pixels at single times, in double precision: makes the lists of tiles, and composites the points. */
#include "bitonic.h"
#include "path_node.h"
#include "point_instants.h"
#include "points.h"

/* Waits until the writes of the work-group are visible. With several lanes a work-group has one work-item, which needn't
 * wait. */
#if TD_LANES == 1
#define td_wait() barrier(CLK_GLOBAL_MEM_FENCE)
#else
#define td_wait()
#endif

/* A work-item's part of a loop that all work-items share: [first, end) by `step`. */
typedef struct td_share {
    int first, end, step;
} td_share;

/* A work-item's part of `count` items, in groups of TD_LANES. */
static td_share td_share_of_groups(int count) {
    const int me = (int)get_global_id(0), items = (int)get_global_size(0);
    const int groups = (count + TD_LANES - 1) / TD_LANES;
    td_share share;
#if TD_LANES == 1
    share.first = me, share.end = groups, share.step = items;
#else /* neighbouring groups: their data are neighbours in memory */
    share.first = (int)((long)groups * me / items), share.end = (int)((long)groups * (me + 1) / items), share.step = 1;
#endif
    return share;
}

static td_point_paths td_paths_make(__global const td_real *curves, __global const td_real *beside, int pieces, int slices,
                                    int split, int group) {
    td_point_paths paths;
    paths.curves = curves;
    paths.beside = beside;
    paths.slices.pieces = pieces;
    paths.slices.count = slices;
    paths.slices.split = split;
    paths.slices.group = group;
    return paths;
}

static td_point_backdrop td_backdrop_make(td_real first, td_real first_dot, td_real green, td_real blue) {
    td_point_backdrop behind;
    behind.first = first;
    behind.first_dot = first_dot;
    behind.green = green;
    behind.blue = blue;
    return behind;
}

/* Makes the arrays that points read, for the `count` Gaussians in `seen`. `own`: their paths; `own_sights`: their pixels.
 * Curve c, counted from `from` on, goes from row[2 c] to row[2 c + 1] in lengths[c] seconds. `depths` has a number for each
 * Gaussian, to sort by, and `records` has its tests. `path` and `sights` (2 x Gaussians) get paths and pixels, by Gaussian. */
typedef struct td_splats_to_make {
    __global const td_real *rows, *rows_beside, *lengths;
    __global const int *row, *seen, *own, *own_sights;
    __global td_real *curves, *beside;
    __global int *depths, *path, *sights;
    __global float *records;
    int count, from;
    td_share groups;
} td_splats_to_make;

/* Prefetches the first curve's rows of TD_LANES Gaussians from `first` on: waiting for them took a quarter of the time. */
enum { TD_PREFETCH_GROUPS = 2 };
static void td_rows_prefetch(const td_image *image, const td_splats_to_make *of, int first) {
    const int end = first + TD_LANES < of->count ? first + TD_LANES : of->count;
    for (int i = first; i < end; i++) {
        __global const int *row = of->row + 2 * (of->own[i] / TD_PATH_LEVELS - of->from);
        __global const td_real *from = of->rows + (long)row[0] * TD_PATH_STRIDE, *to = of->rows + (long)row[1] * TD_PATH_STRIDE;
        td_prefetch(from), td_prefetch(from + 8), td_prefetch(to), td_prefetch(to + 8);
        if (!td_paths_by_channels(image)) continue;
        td_prefetch(of->rows_beside + (long)row[0] * TD_BESIDE_STRIDE);
        td_prefetch(of->rows_beside + (long)row[1] * TD_BESIDE_STRIDE);
    }
}

TD_APART void td_splats_apart(__constant const td_image *image_buffer, const td_point_paths *all,
                              const td_splats_to_make *what) {
    const td_image image = *image_buffer;
    const td_point_paths paths = *all;
    const td_splats_to_make of = *what;
    const int pieces = paths.slices.pieces, slices = paths.slices.count;
    for (int k = of.groups.first; k < of.groups.end; k += of.groups.step) {
        const int i = k * TD_LANES;
        int mine[TD_LANES];
        size_t at[TD_LANES];
        if (TD_LANES > 1) td_rows_prefetch(&image, &of, i + TD_PREFETCH_GROUPS * TD_LANES);
        for (int lane = 0; lane < TD_LANES; lane++) {
            const int number = i + lane < of.count ? i + lane : i, gaussian = of.seen[number];
            mine[lane] = of.own[number];
            int first = mine[lane] / TD_PATH_LEVELS, end = first + (pieces << (mine[lane] & (TD_PATH_LEVELS - 1)));
            for (int c = first; c < end; c++) {
                const int at_row = c - of.from;
                const long from = of.row[2 * at_row], to = of.row[2 * at_row + 1];
                td_point_curve(of.rows + from * TD_PATH_STRIDE, of.rows + to * TD_PATH_STRIDE, of.lengths[at_row],
                               of.curves + (long)c * TD_CURVE_REALS);
                if (td_paths_by_channels(&image))
                    td_point_curve_beside(of.rows_beside + from * TD_BESIDE_STRIDE, of.rows_beside + to * TD_BESIDE_STRIDE,
                                          of.lengths[at_row], of.beside + (long)c * TD_BESIDE_REALS);
            }
            of.path[gaussian] = mine[lane];
            of.sights[2 * gaussian] = of.own_sights[2 * number], of.sights[2 * gaussian + 1] = of.own_sights[2 * number + 1];
            of.depths[gaussian] = td_point_depth_key(&paths, mine[lane]);
            at[lane] = (size_t)gaussian * (size_t)slices * TD_TEST_REALS;
        }
        for (int slice = 0; slice < slices; slice++) {
            td_point_make_tests(&paths, &image, slice, mine, of.records, at);
            for (int lane = 0; lane < TD_LANES; lane++) at[lane] += TD_TEST_REALS;
        }
    }
}

__kernel void td_point_make_splats(__constant const td_image *image_buffer, __global const td_real *rows,
                                   __global const int *row, __global const td_real *lengths, __global const int *seen,
                                   __global const int *own, __global const int *own_sights, int count, int from,
                                   __global int *path, __global int *sights, int pieces, int slices, int split, int group,
                                   __global td_real *curves, __global int *depths, __global float *records,
                                   __global const td_real *rows_beside, __global td_real *beside) {
    const td_point_paths paths = td_paths_make(curves, beside, pieces, slices, split, group);
    td_splats_to_make what;
    what.rows = rows;
    what.row = row;
    what.lengths = lengths;
    what.seen = seen;
    what.own = own;
    what.own_sights = own_sights;
    what.sights = sights;
    what.from = from;
    what.path = path;
    what.curves = curves;
    what.rows_beside = rows_beside;
    what.beside = beside;
    what.depths = depths;
    what.records = records;
    what.count = count;
    what.groups = td_share_of_groups(count);
    td_splats_apart(image_buffer, &paths, &what);
}

/* Misfits of paths of one level, TD_LANES at a time, as multiples of `target`. misfits[i] is the worst of path i. If
 * asks_each, misfits[i + stride (k + 1)] is the misfit of its curve k. */
TD_APART void td_misfits_apart(__constant const td_image *image_buffer, __global const td_real *rows,
                               __global const td_real *beside, __global const int *first, td_share groups, int level,
                               __global const td_real *lengths, int pieces, const td_path_terms *terms,
                               __global td_real *misfits, int stride, int asks_each) {
    const td_image image = *image_buffer;
    for (int k = groups.first; k < groups.end; k += groups.step) {
        const int i = k * TD_LANES;
        const td_lanes worst = td_path_try_each(rows, beside, td_load_ints(first + i), level, pieces, lengths, terms, &image,
                                                misfits + stride + i, asks_each ? stride : 0);
        td_store_lanes(misfits + i, worst);
    }
}

__kernel void td_point_find_misfits(__constant const td_image *image_buffer, __global const td_real *rows,
                                    __global const td_real *beside, __global const int *first, int count, int level,
                                    __global const td_real *lengths, int pieces, td_real target, td_real rounding,
                                    td_real place, __global td_real *misfits, int stride, int asks_each) {
    const td_path_terms terms = {target, rounding, place};
    td_misfits_apart(image_buffer, rows, beside, first, td_share_of_groups(count), level, lengths, pieces, &terms, misfits,
                     stride, asks_each);
}

/* A tile's list: its candidates that have paths, by depth, as `places` (TD_LIST_INTS x candidates); and their tests, made of
 * the splats' records. keys have twice the room. */
typedef struct td_list_to_make {
    __global const int *candidates, *path, *sights, *depths;
    __global const float *records;
    __global long *keys;
    __global int *places;
    __global float *tests;
    int slices, item, items;
} td_list_to_make;

/* Prefetches the test of a place's splat, TD_PREFETCH_PLACES ahead. */
enum { TD_PREFETCH_PLACES = 16 };
static void td_place_prefetch(const td_list_to_make *of, long key, __global const int *candidates) {
    if (key == TD_LAST_KEY) return;
    const int gaussian = candidates[(int)(key & 0xffffffffL)];
    td_prefetch(of->records + (size_t)gaussian * (size_t)of->slices * TD_TEST_REALS);
    td_prefetch(of->path + gaussian), td_prefetch(of->sights + 2 * gaussian);
}

TD_APART void td_list_apart(__global const td_point_tile *at, const td_list_to_make *what, __global int *listed_count) {
    const td_point_tile tile = *at;
    const td_list_to_make of = *what;
    const int me = of.item, items = of.items, slices = of.slices;
    __global const int *candidates = of.candidates + tile.first;
    __global long *own = of.keys + 2 * (long)tile.first;
    int keys = items > 1 ? tile.count : 0; /* a single work-item leaves out candidates without a path */
    for (int i = me; i < tile.count; i += items) {
        const int gaussian = candidates[i], there = gaussian >= 0 && of.path[gaussian] >= 0;
        const long key = there ? ((long)of.depths[gaussian] << 32) | (long)i : TD_LAST_KEY;
        if (items > 1)
            own[i] = key;
        else if (there)
            own[keys++] = key;
    }
    const int capacity = tile.count > 0 ? td_capacity(keys) : 0; /* without candidates, there is no room for keys */
    for (int i = keys + me; i < capacity || i < tile.count; i += items) own[i] = TD_LAST_KEY;
    td_wait();
    if (TD_LANES == 1 || capacity > 0) td_bitonic_sort(own, capacity);
    if (me == 0) *listed_count = 0;
    td_wait();
    for (int i = me; i < tile.count; i += items) {
        if (own[i / TD_PAD * TD_PAD] == TD_LAST_KEY) continue; /* groups behind those taken aren't read */
        const int there = own[i] != TD_LAST_KEY;
        const int gaussian = there ? candidates[(int)(own[i] & 0xffffffffL)] : -1;
        if (TD_LANES > 1 && i + TD_PREFETCH_PLACES < tile.count)
            td_place_prefetch(&of, own[i + TD_PREFETCH_PLACES], candidates);
        __global float *place = of.tests + td_point_tests_at(&tile, slices, 0) + td_point_test_of(i);
        __global int *listed = of.places + (tile.first + i) * TD_LIST_INTS;
        listed[TD_L_PATH] = there ? of.path[gaussian] : -1, listed[TD_L_NUMBER] = gaussian;
        listed[TD_L_COLUMNS] = there ? of.sights[2 * gaussian] : 0, listed[TD_L_ROWS] = there ? of.sights[2 * gaussian + 1] : 0;
        if (there && (i + 1 == tile.count || own[i + 1] == TD_LAST_KEY)) *listed_count = i + 1;
        for (int slice = 0; slice < slices; slice++, place += tile.count * TD_TEST_REALS) {
            if (there)
                td_point_place_test(of.records + ((size_t)gaussian * (size_t)slices + (size_t)slice) * TD_TEST_REALS, &tile,
                                    place);
            else
                td_point_place_nobody(place);
        }
    }
    td_wait();
    const int taken = (*listed_count + TD_PAD - 1) / TD_PAD * TD_PAD;
    for (int slice = me; slice < slices; slice += items)
        td_point_find_fronts(of.tests + td_point_tests_at(&tile, slices, slice), taken / TD_PAD);
}

/* One work-group per tile in `wanted`. counts (all tiles) gets the length of each list. */
__kernel void td_point_make_lists(__global const td_point_tile *tiles, __global const int *wanted,
                                  __global const int *candidates, __global const int *path, __global const int *sights,
                                  __global const int *depths, __global const float *records, int slices, __global long *keys,
                                  __global int *places, __global float *tests, __global int *counts) {
    const int number = wanted[get_group_id(0)];
    td_list_to_make what;
    what.candidates = candidates;
    what.path = path;
    what.sights = sights;
    what.depths = depths;
    what.records = records;
    what.keys = keys;
    what.places = places;
    what.tests = tests;
    what.slices = slices;
    what.item = (int)get_local_id(0);
    what.items = (int)get_local_size(0);
    td_list_apart(tiles + number, &what, counts + number);
}

/* Points to be composited, in chunks, and the work-item's room for `entries`. */
typedef struct td_values_to_find {
    __global const td_point_tile *tiles;
    __global const int *counts;
    __global const td_point_chunk *chunks;
    __global td_real *entries, *values;
    int count;
    td_point_backdrop backdrop;
} td_values_to_find;

/* Work-items take TD_TURN_CHUNKS chunks at a time, when they have done the last ones. The host's threads may need a core, whose
 * work-item then takes fewer. */
enum { TD_TURN_CHUNKS = TD_LANES > 1 ? 8 : 1 };
TD_INLINE int td_next_chunks(volatile __global int *turn) { return atomic_inc(turn) * TD_TURN_CHUNKS; }

TD_APART void td_values_apart(__constant const td_image *image_buffer, const td_point_paths *all_paths,
                              const td_point_lists *all_lists, const td_point_arrays *all_points, const td_values_to_find *what,
                              volatile __global int *turn) {
    const td_image image = *image_buffer;
    const td_point_paths paths = *all_paths;
    const td_point_lists lists = *all_lists;
    const td_point_arrays points = *all_points;
    const td_values_to_find of = *what;
    for (int next; (next = td_next_chunks(turn)) < of.count;)
        for (int i = next; i < of.count && i < next + TD_TURN_CHUNKS; i++) {
            const td_point_chunk chunk = of.chunks[i];
            const td_point_tile tile = of.tiles[chunk.tile];
            td_point_chunk_values(&chunk, &tile, of.counts[chunk.tile], &paths, &lists, &points, &image, of.entries,
                                  &of.backdrop, of.values);
        }
}

/* Composites all chunks; each work-item has its own room for `rows` entries. */
__kernel void td_point_values(__constant const td_image *image_buffer, __global const td_point_tile *tiles,
                              __global const int *counts, __global const td_real *curves, int pieces, int slices, int split,
                              int group, __global const int *places, __global const float *tests,
                              __global const td_real *columns, int stride, __global const int *piece,
                              __global const td_point_chunk *chunks, int chunk_count, __global td_real *entries, int rows,
                              td_real backdrop, td_real backdrop_dot, __global td_real *values, volatile __global int *turn,
                              __global const td_real *beside, td_real green, td_real blue) {
    const td_image image = *image_buffer;
    const td_point_paths paths = td_paths_make(curves, beside, pieces, slices, split, group);
    td_point_lists lists;
    lists.places = places;
    lists.tests = tests;
    td_point_arrays points;
    points.x = columns;
    points.y = columns + stride;
    points.s = columns + 2 * stride;
    points.h = columns + 3 * stride;
    points.piece = piece;
    td_values_to_find what;
    what.tiles = tiles;
    what.counts = counts;
    what.chunks = chunks;
    what.entries = entries + (long)get_global_id(0) * rows * td_point_room(&image);
    what.values = values;
    what.count = chunk_count;
    what.backdrop = td_backdrop_make(backdrop, backdrop_dot, green, blue);
    td_values_apart(image_buffer, &paths, &lists, &points, &what, turn);
}

TD_APART void td_instants_apart(__constant const td_image *image_buffer, const td_instants *all, const td_values_to_find *what,
                                volatile __global int *turn) {
    const td_image image = *image_buffer;
    const td_instants of = *all;
    const td_values_to_find to = *what;
    for (int i; (i = atomic_inc(turn) * TD_LANES) < to.count;)
        td_instant_values(&of, i, to.count - i < TD_LANES ? to.count - i : TD_LANES, &image, to.entries, &to.backdrop,
                          to.values);
}

/* Values of `count` points whose rows were projected at their own times. Work-items take TD_LANES points at a time; each has
 * `room` reals of memory. */
__kernel void td_point_instants(__constant const td_image *image_buffer, __global const td_real *rows,
                                __global const td_real *beside, __global const int *end, __global const td_real *columns,
                                int count, int most, __global td_real *entries, int room, td_real backdrop,
                                td_real backdrop_dot, td_real green, td_real blue, __global td_real *values,
                                volatile __global int *turn) {
    td_instants of;
    of.rows = rows;
    of.beside = beside;
    of.end = end;
    of.x = columns;
    of.y = columns + count;
    of.most = most;
    td_values_to_find what;
    what.entries = entries + (long)get_global_id(0) * room;
    what.values = values;
    what.count = count;
    what.backdrop = td_backdrop_make(backdrop, backdrop_dot, green, blue);
    td_instants_apart(image_buffer, &of, &what, turn);
}
