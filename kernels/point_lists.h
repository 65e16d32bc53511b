/* Record paths as single pixels read them (points.h): curves, and for each tile the splats that its blocks may see within an
 * interval, in a depth order. */
#ifndef TD_POINT_LISTS_H
#define TD_POINT_LISTS_H

#include "path.h"

/* A tile's list, whose places begin at `first`: candidates in any order of places; then, after td_point_list, `count` splats.
 * */
typedef struct td_point_tile {
    int x, y; /* its top left pixel */
    int first, count;
} td_point_tile;

/* Up to TD_LANES points, neighbours of one tile. */
typedef struct td_point_chunk {
    int tile;
    int first, count; /* of the points */
    int blocks;       /* that they are in, a bit each */
} td_point_chunk;

/* Points as arrays: pixel centres, where in its piece each is in [0, 1], the piece's length [s], the piece. */
typedef struct td_point_arrays {
    TD_GLOBAL const td_real *x, *y, *s, *h;
    TD_GLOBAL const int *piece;
} td_point_arrays;

/* Paths as points read them: between two rows a curve, each number a0 + a1 s + a2 s^2 + a3 s^3 for s in [0, 1]; first all a0,
 * then all a1, ... A splat's curves follow one another. One whose determinant is 0 can't be used: nothing is seen of it. */
enum { TD_CURVE_REALS = 4 * TD_PATH_NUMBERS };
typedef struct td_point_paths {
    TD_GLOBAL const int *path; /* of each Gaussian of the store: its first curve * TD_PATH_LEVELS + level; below 0: none */
    TD_GLOBAL const td_real *curves; /* TD_CURVE_REALS each */
    int pieces;                      /* of the interval: a splat has so many curves << level */
} td_point_paths;

/* The sorted lists of all tiles. */
typedef struct td_point_lists {
    TD_GLOBAL const int *gaussian; /* in a depth order */
    TD_GLOBAL const int *blocks;   /* that each may reach within the interval */
    TD_GLOBAL const td_real
        *power; /* the most that 2 ln(opacity / cut) comes to there: where d^T Q d is more nothing is seen */
} td_point_lists;

/* -- curves -------------------------------------------------------------------------------------------------------- */

/* The curve between rows that are h seconds apart. */
TD_INLINE void td_point_curve(TD_GLOBAL const td_real *from, TD_GLOBAL const td_real *to, td_real h, TD_GLOBAL td_real *curve) {
    int whole = from[TD_P_DET] > 0 && to[TD_P_DET] > 0;
    for (int k = 0; k < TD_PATH_NUMBERS; k++) {
        td_real way = to[k] - from[k], start = h * from[TD_PATH_NUMBERS + k], end = h * to[TD_PATH_NUMBERS + k];
        int lost = !whole && k == TD_P_DET;
        curve[k] = lost ? 0 : from[k];
        curve[TD_PATH_NUMBERS + k] = lost ? 0 : start;
        curve[2 * TD_PATH_NUMBERS + k] = lost ? 0 : 3 * way - (2 * start + end);
        curve[3 * TD_PATH_NUMBERS + k] = lost ? 0 : (start + end) - 2 * way;
    }
}

/* -- lists --------------------------------------------------------------------------------------------------------- */

/* Bounds of a number on a curve: those of its Bezier control points, with a margin for rounding. */
typedef struct td_point_range {
    td_lanes low, high;
} td_point_range;

TD_INLINE td_point_range td_point_hull(TD_GLOBAL const td_real *curves, td_index curve, int k) {
    const td_real third = TD_REAL(0.33333333333333333);
    td_index at = curve * TD_CURVE_REALS + k;
    td_lanes a0 = td_gather(curves, at), a1 = td_gather(curves, at + TD_PATH_NUMBERS);
    td_lanes a2 = td_gather(curves, at + 2 * TD_PATH_NUMBERS), a3 = td_gather(curves, at + 3 * TD_PATH_NUMBERS);
    td_lanes b = td_fma(a1, third, a0), c = td_fma(2 * a1 + a2, third, a0), d = ((a0 + a1) + a2) + a3;
    td_lanes low = td_smaller(td_smaller(a0, b), td_smaller(c, d)), high = td_larger(td_larger(a0, b), td_larger(c, d));
    td_lanes margin = TD_REAL(1e-6) * td_larger(td_size(low), td_size(high));
    td_point_range range;
    range.low = low - margin;
    range.high = high + margin;
    return range;
}

/* One bit of four for each 4 pixels from `edge` on of which one's centre may be within [low, high]. */
TD_INLINE td_index td_point_bits(td_lanes low, td_lanes high, int edge) {
    td_mask bits = (low < low) & 0;
    for (int i = 0; i < 4; i++) {
        td_real x = (td_real)(edge + 4 * i);
        bits |= td_mask_bit((low <= x + 3.5f) & (high >= x + 0.5f), 1 << i);
    }
    return bits;
}

/* The blocks of a tile that splats may reach on a curve, and how much d^T Q d may be where they are seen. alpha is below the
 * cut where dx^2 > power a. */
TD_INLINE td_index td_point_reach(TD_GLOBAL const td_real *curves, td_index curve, const td_image *image, int x, int y,
                                  td_lanes *power) {
    td_real cut = image->cut_rule == TD_CUT_NONE ? TD_REAL(1e-30) : image->cut;
    td_point_range u = td_point_hull(curves, curve, TD_P_U), v = td_point_hull(curves, curve, TD_P_V);
    td_point_range b = td_point_hull(curves, curve, TD_P_B), c = td_point_hull(curves, curve, TD_P_C);
    td_point_range det = td_point_hull(curves, curve, TD_P_DET), opacity = td_point_hull(curves, curve, TD_P_OPACITY);
    td_mask seen = (det.high > 0.0f) & (opacity.high > cut), known = (c.low > 0.0f) & (det.high > 0.0f);
    td_lanes side = td_larger(td_size(b.low), td_size(b.high));
    td_lanes a = td_fma(side, side, det.high) / td_select(td_splat(1.0f), c.low, known);
    *power = td_fma(2.0f * td_log(td_select(td_splat(1.0f), opacity.high / cut, seen)), TD_REAL(1.0001), TD_REAL(1e-6));
    td_lanes rx = td_sqrt(*power * td_select(td_splat(1.0f), a, known)) + TD_REAL(0.01);
    td_lanes ry = td_sqrt(*power * td_select(td_splat(1.0f), c.high, known)) + TD_REAL(0.01);
    td_index across = td_point_bits(u.low - rx, u.high + rx, x), down = td_point_bits(v.low - ry, v.high + ry, y);
    td_index bits = across & 0;
    for (int j = 0; j < 4; j++) bits |= td_mask_bit(((down >> j) & 1) != 0, across << (4 * j));
    bits = td_select_mask((bits & 0) | 0xffff, bits, known);
    return td_mask_bit(seen, bits);
}

/* TD_LANES candidates of a tile: the blocks that each may reach in the interval, with the most of their power; depth in the
 * middle, for the order. */
TD_INLINE td_index td_point_candidates(const td_point_paths *paths, const td_image *image, const td_point_tile *tile,
                                       td_index gaussian, td_lanes *depth, td_lanes *power) {
    td_index path = td_gather_ints(paths->path, td_not_below_0(gaussian)), blocks = path & 0;
    td_mask on = (gaussian >= 0) & (path >= 0);
    td_index level = path & (TD_PATH_LEVELS - 1), first = td_not_below_0(path) / TD_PATH_LEVELS;
    td_index one = (path & 0) | 1, last = (one << level) * paths->pieces - 1;
    *power = td_splat(0.0f);
    for (int k = 0; td_any(on & (last >= k)); k++) {
        td_index at = td_select_mask(last, (path & 0) | k, last >= k);
        td_lanes most;
        blocks |= td_point_reach(paths->curves, first + at, image, tile->x, tile->y, &most);
        *power = td_larger(*power, most);
    }
    *depth = td_gather(paths->curves, (first + (last + 1) / 2) * TD_CURVE_REALS + TD_P_DEPTH);
    return td_mask_bit(on, blocks);
}

#endif
