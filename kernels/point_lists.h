/* Record paths in the form that points need, single pixels at single times. Paths are stored as polynomials, and each tile has
 * a list of the splats that it may see within an interval, in one depth order. */
#ifndef TD_POINT_LISTS_H
#define TD_POINT_LISTS_H

#include "path.h"

/* A tile's list. It begins with `count` candidates in any order at place `first`. Once made, it has `count` places, of which
 * the first ones are used. Both numbers are multiples of TD_PAD. */
typedef struct td_point_tile {
    int x, y; /* its top left pixel */
    int first, count;
} td_point_tile;

/* Up to TD_LANES points, neighbours of one tile. */
typedef struct td_point_chunk {
    int tile;
    int first, count; /* [first, first + count) among the points */
} td_point_chunk;

/* Points as arrays: pixel centres [px], place within the piece in [0, 1], the piece's length [s], the piece's number. */
typedef struct td_point_arrays {
    TD_GLOBAL const td_real *x, *y, *s, *h;
    TD_GLOBAL const int *piece;
} td_point_arrays;

/* An interval's slices, short parts with tighter bounds on what splats reach. If the interval is one piece, it has 2^split
 * slices. If it has several pieces, a slice is `group` of them. */
typedef struct td_point_slices {
    int pieces; /* number of the interval's pieces */
    int count, split, group;
} td_point_slices;

/* Paths as points read them: between two rows a curve, each number a0 + a1 s + a2 s^2 + a3 s^3 for s in [0, 1]; first all a0,
 * then all a1, ... A splat has pieces << level curves, which are neighbours. A curve whose determinant is 0 can't be used, and
 * its splat isn't seen. */
enum { TD_CURVE_REALS = 4 * TD_PATH_NUMBERS, TD_BESIDE_REALS = 4 * TD_BESIDE_NUMBERS };
typedef struct td_point_paths {
    TD_GLOBAL const td_real *curves; /* TD_CURVE_REALS each */
    td_point_slices slices;
    TD_GLOBAL const td_real *beside; /* TD_BESIDE_REALS each: green and blue, where luminance is red (TD_BESIDE_NUMBERS) */
} td_point_paths;

/* A place of a list: the splat's path, its first curve * TD_PATH_LEVELS + level; its Gaussian, whose number counts at equal
 * depth; and the pixels that may see it, columns and rows (TD_SIGHT_END). */
enum { TD_L_PATH = 0, TD_L_NUMBER, TD_L_COLUMNS, TD_L_ROWS, TD_LIST_INTS };

/* The sorted lists of all tiles. */
typedef struct td_point_lists {
    TD_GLOBAL const int *places;  /* in a depth order: TD_LIST_INTS each */
    TD_GLOBAL const float *tests; /* point_tests.h */
} td_point_lists;

/* -- curves -------------------------------------------------------------------------------------------------------- */

/* Makes the curve between two rows that are h seconds apart. */
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

/* Makes the curve of green and blue between two rows that are h seconds apart. */
TD_INLINE void td_point_curve_beside(TD_GLOBAL const td_real *from, TD_GLOBAL const td_real *to, td_real h,
                                     TD_GLOBAL td_real *curve) {
    for (int k = 0; k < TD_BESIDE_NUMBERS; k++) {
        td_real way = to[k] - from[k], start = h * from[TD_BESIDE_NUMBERS + k], end = h * to[TD_BESIDE_NUMBERS + k];
        curve[k] = from[k];
        curve[TD_BESIDE_NUMBERS + k] = start;
        curve[2 * TD_BESIDE_NUMBERS + k] = 3 * way - (2 * start + end);
        curve[3 * TD_BESIDE_NUMBERS + k] = (start + end) - 2 * way;
    }
}

/* The depth in the middle of the interval, as a positive int that sorts like it. 0 for a splat that is behind the camera
 * then. */
TD_INLINE int td_point_depth_key(const td_point_paths *paths, int path) {
    int middle = (paths->slices.pieces << (path & (TD_PATH_LEVELS - 1))) / 2;
    float depth = (float)paths->curves[(path / TD_PATH_LEVELS + middle) * TD_CURVE_REALS + TD_P_DEPTH];
    depth = depth > 0.0f ? depth : 0.0f;
#ifdef TD_OPENCL
    return as_int(depth);
#else
    int bits;
    memcpy(&bits, &depth, sizeof bits);
    return bits;
#endif
}

/* Eight numbers of TD_LANES splats. */
typedef struct td_point_eight {
    td_lanes a, b, c, d, e, f, g, h;
} td_point_eight;

/* Number k, a constant where it is inlined. */
TD_INLINE td_lanes td_point_pick(const td_point_eight *x, int k) {
    if (k < 4) return k < 2 ? (k == 0 ? x->a : x->b) : (k == 2 ? x->c : x->d);
    return k < 6 ? (k == 4 ? x->e : x->f) : (k == 6 ? x->g : x->h);
}

#if TD_LANES > 1
/* Transposes eight vectors: of eight lanes a block of 8x8, of four lanes two of 4x4. Without arrays: PoCL would keep them in
 * memory. */
#if TD_LANES == 8
TD_INLINE td_point_eight td_point_zip(const td_point_eight *x) {
    td_point_eight y;
    y.a = TD_ZIP_LOWER(x->a, x->e), y.b = TD_ZIP_UPPER(x->a, x->e), y.c = TD_ZIP_LOWER(x->b, x->f);
    y.d = TD_ZIP_UPPER(x->b, x->f), y.e = TD_ZIP_LOWER(x->c, x->g), y.f = TD_ZIP_UPPER(x->c, x->g);
    y.g = TD_ZIP_LOWER(x->d, x->h), y.h = TD_ZIP_UPPER(x->d, x->h);
    return y;
}
TD_INLINE td_point_eight td_point_turn(const td_point_eight *x) {
    td_point_eight once = td_point_zip(x), twice = td_point_zip(&once);
    return td_point_zip(&twice);
}
#else
TD_INLINE td_point_eight td_point_turn(const td_point_eight *x) {
    td_point_eight t, y;
    t.a = TD_TURN_LOWER(x->a, x->b), t.b = TD_TURN_UPPER(x->a, x->b), t.c = TD_TURN_LOWER(x->c, x->d);
    t.d = TD_TURN_UPPER(x->c, x->d), t.e = TD_TURN_LOWER(x->e, x->f), t.f = TD_TURN_UPPER(x->e, x->f);
    t.g = TD_TURN_LOWER(x->g, x->h), t.h = TD_TURN_UPPER(x->g, x->h);
    y.a = TD_EVEN(t.a, t.c), y.b = TD_EVEN(t.b, t.d), y.c = TD_ODD(t.a, t.c), y.d = TD_ODD(t.b, t.d);
    y.e = TD_EVEN(t.e, t.g), y.f = TD_EVEN(t.f, t.h), y.g = TD_ODD(t.e, t.g), y.h = TD_ODD(t.f, t.h);
    return y;
}
#endif

/* The place of vector i, 0..7, of eight reals at each lane's place: lane by lane, or first all first halves, then all second
 * ones. */
#define TD_POINT_PLACE(at, i) ((at)[(i) % TD_LANES] + (i) / TD_LANES * TD_LANES)
#endif

/* Loads eight reals at each of TD_LANES places: a vector of the first, a vector of the second, ... */
TD_INLINE td_point_eight td_point_load_eight(TD_GLOBAL const td_real *array, const int at[TD_LANES]) {
    td_point_eight x;
#if TD_LANES > 1
#define TD_POINT_LOAD(i) td_load_lanes(array + TD_POINT_PLACE(at, i))
    x.a = TD_POINT_LOAD(0), x.b = TD_POINT_LOAD(1), x.c = TD_POINT_LOAD(2), x.d = TD_POINT_LOAD(3);
    x.e = TD_POINT_LOAD(4), x.f = TD_POINT_LOAD(5), x.g = TD_POINT_LOAD(6), x.h = TD_POINT_LOAD(7);
    return td_point_turn(&x);
#else
    array += at[0];
    x.a = array[0], x.b = array[1], x.c = array[2], x.d = array[3];
    x.e = array[4], x.f = array[5], x.g = array[6], x.h = array[7];
    return x;
#endif
}

#endif
