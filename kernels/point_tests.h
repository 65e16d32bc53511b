/* Which splats of a tile's list a point may see, a single pixel at a single time. Sixteen splats are tested at once in single
 * precision.
 *
 * In a slice of the interval a splat is bounded by an ellipse that moves along a line at constant speed. Let P be the greatest
 * d^T Q d at which the splat is visible. S = P (covariance + spread) plus the distance of the centre from the line, both from
 * bounds of its curves (Bezier control points). A point at d from the line may see the splat only where d^T S^-1 d <= 1. Splats
 * that pass are computed in double precision. So wider bounds cost time, and change no result. */
#ifndef TD_POINT_TESTS_H
#define TD_POINT_TESTS_H

#include "point_lists.h"

/* A test: the line's start and way in the slice, d^T S^-1 d = a dx^2 + b dx dy + c dy^2, and the least depth. A splat that
 * isn't seen has a NaN as a. Each Gaussian has a test per slice, [Gaussian][slice][TD_TEST_REALS], which tiles copy: making
 * them for each tile took two to four times as long. In a tile's copy, places count from its top left corner, and TD_PAD splats
 * are stored together, [slice][group][TD_TEST_REALS][TD_PAD]. The depth of a group's first splat is replaced by the least depth
 * from there on. */
enum { TD_T_U = 0, TD_T_U_WAY, TD_T_V, TD_T_V_WAY, TD_T_A, TD_T_B, TD_T_C, TD_T_DEPTH, TD_TEST_REALS };

TD_INLINE size_t td_point_tests_at(const td_point_tile *tile, int slices, int slice) {
    return ((size_t)tile->first * (size_t)slices + (size_t)slice * (size_t)tile->count) * TD_TEST_REALS;
}

/* Where the test of a place begins within a slice; its reals are TD_PAD apart. */
TD_INLINE int td_point_test_of(int place) { return place / TD_PAD * (TD_PAD * TD_TEST_REALS) + place % TD_PAD; }

/* -- making -------------------------------------------------------------------------------------------------------- */

/* Bezier control points of a number on a part of its curve. */
typedef struct td_point_arc {
    td_lanes a, b, c, d;
} td_point_arc;

/* A number's cubics a0 + a1 s + a2 s^2 + a3 s^3 for TD_LANES splats, and the part of each that lies in the slice. */
typedef struct td_point_bent {
    td_point_eight a0, a1, a2, a3;
    td_lanes from, part;
} td_point_bent;

TD_INLINE td_point_arc td_point_bend(const td_point_bent *on, int k) {
    const td_real third = TD_REAL(0.33333333333333333);
    td_lanes a0 = td_point_pick(&on->a0, k), a1 = td_point_pick(&on->a1, k), a2 = td_point_pick(&on->a2, k);
    td_lanes a3 = td_point_pick(&on->a3, k), from = on->from, to = on->from + on->part, step = on->part * third;
    td_point_arc arc;
    arc.a = td_fma(td_fma(td_fma(a3, from, a2), from, a1), from, a0);
    arc.d = td_fma(td_fma(td_fma(a3, to, a2), to, a1), to, a0);
    arc.b = td_fma(td_fma(td_fma(3 * a3, from, 2 * a2), from, a1), step, arc.a);
    arc.c = td_fma(td_fma(td_fma(3 * a3, to, 2 * a2), to, a1), -step, arc.d);
    return arc;
}

typedef struct td_point_range {
    td_lanes low, high;
} td_point_range;

/* Widens a range by an arc's range, with a margin for rounding. */
TD_INLINE void td_point_widen(const td_point_bent *on, int k, td_point_range *range) {
    td_point_arc p = td_point_bend(on, k);
    td_lanes low = td_smaller(td_smaller(p.a, p.b), td_smaller(p.c, p.d));
    td_lanes high = td_larger(td_larger(p.a, p.b), td_larger(p.c, p.d));
    td_lanes margin = TD_REAL(1e-6) * td_larger(td_size(low), td_size(high));
    range->low = td_smaller(range->low, low - margin);
    range->high = td_larger(range->high, high + margin);
}

/* A centre's line, start + w way for w in [0, 1] in the slice, and the greatest distance of the centre from it. */
typedef struct td_point_line {
    td_lanes start, way, off;
} td_point_line;

/* Widens a line's distance by an arc from w = begin, `length` long. The first arc sets the line. */
TD_INLINE void td_point_follow(const td_point_bent *on, int k, int is_first, td_lanes begin, td_lanes length,
                               td_point_line *line) {
    const td_real third = TD_REAL(0.33333333333333333);
    td_point_arc p = td_point_bend(on, k);
    if (is_first) {
        line->start = p.a;
        line->way = (p.d - p.a) / length;
        line->off = td_splat(0.0f);
    }
    td_lanes at = td_fma(begin, line->way, line->start), step = length * third * line->way;
    td_lanes ends = td_larger(td_size(p.a - at), td_size(p.d - (at + 3 * step)));
    td_lanes middle = td_larger(td_size(p.b - (at + step)), td_size(p.c - (at + 2 * step)));
    line->off = td_larger(line->off, td_larger(ends, middle));
}

/* Bounds of TD_LANES splats in a slice. */
typedef struct td_point_bounds {
    td_point_line u, v;
    td_point_range b, c, det, opacity, depth;
} td_point_bounds;

/* A splat's curves in a slice: `count` curves from `first`, or a part of one curve from `from` on. Each takes `length` of the
 * slice. */
typedef struct td_point_span {
    int first, count;
    td_real from, part, length;
} td_point_span;

TD_INLINE td_point_span td_point_spans(const td_point_slices *slices, int slice, int path) {
    td_point_span span;
    int level = path & (TD_PATH_LEVELS - 1), up = level - slices->split, start = slice * slices->group;
    int pieces = slices->pieces - start < slices->group ? slices->pieces - start : slices->group;
    if (slices->split) start = slice, pieces = 1;
    span.first = (up < 0 ? start >> -up : start << up) + path / TD_PATH_LEVELS;
    span.count = up < 0 ? 1 : pieces << up;
    span.part = up < 0 ? 1 / (td_real)(1 << -up) : 1;
    span.from = up < 0 ? (td_real)(slice & ((1 << -up) - 1)) * span.part : 0;
    span.length = up < 0 ? 1 : 1 / (td_real)(slices->group << up);
    return span;
}

TD_INLINE td_point_bounds td_point_find_bounds(const td_point_paths *paths, int slice, const int path[TD_LANES]) {
    td_point_bounds bounds;
    td_point_range none = {td_splat(TD_REAL(1e30)), td_splat(TD_REAL(-1e30))};
    bounds.b = bounds.c = bounds.det = bounds.opacity = bounds.depth = none;
    int first[TD_LANES], count[TD_LANES], at[TD_LANES], most = 1;
    td_real from[TD_LANES], part[TD_LANES], length[TD_LANES], begin[TD_LANES];
    for (int lane = 0; lane < TD_LANES; lane++) {
        td_point_span span = td_point_spans(&paths->slices, slice, path[lane]);
        first[lane] = span.first, count[lane] = span.count;
        from[lane] = span.from, part[lane] = span.part, length[lane] = span.length;
        most = span.count > most ? span.count : most;
    }
    for (int k = 0; k < most; k++) {
        td_point_bent on;
        for (int lane = 0; lane < TD_LANES; lane++) {
            int own = k < count[lane] ? k : count[lane] - 1;
            at[lane] = (first[lane] + own) * TD_CURVE_REALS;
            begin[lane] = (td_real)own * length[lane];
        }
        on.a0 = td_point_load_eight(paths->curves, at), on.a1 = td_point_load_eight(paths->curves + TD_PATH_NUMBERS, at);
        on.a2 = td_point_load_eight(paths->curves + 2 * TD_PATH_NUMBERS, at);
        on.a3 = td_point_load_eight(paths->curves + 3 * TD_PATH_NUMBERS, at);
        on.from = td_collect(from), on.part = td_collect(part);
        td_point_follow(&on, TD_P_U, k == 0, td_collect(begin), td_collect(length), &bounds.u);
        td_point_follow(&on, TD_P_V, k == 0, td_collect(begin), td_collect(length), &bounds.v);
        td_point_widen(&on, TD_P_B, &bounds.b), td_point_widen(&on, TD_P_C, &bounds.c);
        td_point_widen(&on, TD_P_DET, &bounds.det), td_point_widen(&on, TD_P_OPACITY, &bounds.opacity);
        td_point_widen(&on, TD_P_DEPTH, &bounds.depth);
    }
    return bounds;
}

/* S, an ellipse {d: d^T S^-1 d <= 1}. */
typedef struct td_point_ellipse {
    td_lanes xx, xy, yy;
} td_point_ellipse;

/* An ellipse that contains P times each of the covariances, plus the distance of the centre from its line. It is the ellipse of
 * the ranges' middle plus a circle, the greatest distance to the others. The sum of an ellipse and a circle of radius r lies
 * within (1 + h) of the ellipse + (1 + 1/h) r^2, for any h. `farthest`: [px] from the image's corner. */
TD_INLINE td_point_ellipse td_point_hold(const td_point_bounds *of, td_lanes power, td_real farthest) {
    const td_real more = TD_REAL(0.01);
    td_point_ellipse s;
    td_lanes none = td_splat(0.0f), least = td_larger(none, td_larger(of->b.low, -of->b.high));
    td_lanes most = td_larger(td_size(of->b.low), td_size(of->b.high));
    td_lanes low = td_fma(least, least, td_larger(of->det.low, none)) / of->c.high;
    td_lanes high = td_fma(most, most, of->det.high) / of->c.low;
    td_lanes spread = 0.5f * (td_larger(high - low, of->c.high - of->c.low) + (of->b.high - of->b.low));
    td_lanes far = (td_size(of->u.start) + td_size(of->u.way)) + (td_size(of->v.start) + td_size(of->v.way));
    td_lanes round = TD_REAL(3e-7) * (far + 2 * farthest); /* rounding in single precision */
    td_lanes off = td_fma(of->u.off, of->u.off, of->v.off * of->v.off) + round * round;
    td_lanes scale = (1 + more) * power, circle = td_fma(scale, spread, 2 * (1 + 1 / more) * off);
    s.xx = td_fma(scale, 0.5f * (low + high), circle);
    s.yy = td_fma(scale, 0.5f * (of->c.low + of->c.high), circle);
    s.xy = scale * (0.5f * (of->b.low + of->b.high));
    return s;
}

/* Stores eight numbers of each splat at its own place. */
TD_INLINE void td_point_store_tests(TD_GLOBAL float *tests, const size_t at[TD_LANES], const td_point_eight *of) {
#if TD_LANES > 1
    td_point_eight row = td_point_turn(of);
#define TD_POINT_STORE(i, x) TD_VECTOR(vstore)(TD_VECTOR(convert_float)(row.x), 0, tests + TD_POINT_PLACE(at, i))
    TD_POINT_STORE(0, a), TD_POINT_STORE(1, b), TD_POINT_STORE(2, c), TD_POINT_STORE(3, d);
    TD_POINT_STORE(4, e), TD_POINT_STORE(5, f), TD_POINT_STORE(6, g), TD_POINT_STORE(7, h);
#else
    for (int k = 0; k < TD_TEST_REALS; k++) tests[at[0] + (size_t)k] = (float)td_point_pick(of, k);
#endif
}

/* Makes the tests of TD_LANES splats in a slice; lane k's go to tests + at[k]. */
TD_INLINE void td_point_make_tests(const td_point_paths *paths, const td_image *image, int slice, const int path[TD_LANES],
                                   TD_GLOBAL float *tests, const size_t at[TD_LANES]) {
    td_real cut = td_least_seen(image);
    td_real across = (td_real)image->width, down = (td_real)image->height;
    td_lanes none = td_splat(0.0f), one = td_splat(1.0f);
    td_point_bounds of = td_point_find_bounds(paths, slice, path);
    td_mask seen = (of.det.high > 0.0f) & (of.opacity.high > cut), known = seen & (of.c.low > 0.0f);
    of.c.low = td_select(one, of.c.low, known);
    td_lanes power = td_fma(2.0f * td_log(td_select(one, of.opacity.high / cut, seen)), TD_REAL(1.0001), TD_REAL(1e-6));
    td_point_ellipse s = td_point_hold(&of, power, across + down);
    td_lanes product = s.xx * s.yy, det = td_fma(-s.xy, s.xy, product);
    known = known & (det > TD_REAL(1e-12) * product) & (product < TD_REAL(1e30));
    td_lanes under = td_fma(TD_REAL(2e-6), product, det); /* more than rounding: each term is below product / det */
    td_lanes inverse = td_select(none, 1 / td_select(one, under, known), known);
    td_point_eight test; /* in the order of TD_T_U ... */
    test.a = td_select(none, of.u.start, known), test.b = td_select(none, of.u.way, known);
    test.c = td_select(none, of.v.start, known), test.d = td_select(none, of.v.way, known);
    test.e = td_select(td_not_a_number(), td_select(none, s.yy * inverse, known), seen);
    test.f = td_select(none, -2 * s.xy * inverse, known), test.g = td_select(none, s.xx * inverse, known);
    test.h = td_select(td_splat(TD_REAL(1e30)), of.depth.low, seen);
    td_point_store_tests(tests, at, &test);
}

/* Copies a splat's test to a place of a tile. Written out, since LLVM makes a hardware scatter of a loop, and the loads that
 * follow wait for it. */
TD_INLINE void td_point_place_test(TD_GLOBAL const float *test, const td_point_tile *tile, TD_GLOBAL float *place) {
    float u = test[TD_T_U], v = test[TD_T_V], a = test[TD_T_A], b = test[TD_T_B], c = test[TD_T_C];
    float u_way = test[TD_T_U_WAY], v_way = test[TD_T_V_WAY], depth = test[TD_T_DEPTH];
    place[TD_T_U * TD_PAD] = u - (float)tile->x, place[TD_T_U_WAY * TD_PAD] = u_way;
    place[TD_T_V * TD_PAD] = v - (float)tile->y, place[TD_T_V_WAY * TD_PAD] = v_way;
    place[TD_T_A * TD_PAD] = a, place[TD_T_B * TD_PAD] = b, place[TD_T_C * TD_PAD] = c;
    place[TD_T_DEPTH * TD_PAD] = depth;
}

/* Stores a test that no point passes, in a place without a splat. */
TD_INLINE void td_point_place_nobody(TD_GLOBAL float *place) {
    for (int k = 0; k < TD_TEST_REALS; k++) place[k * TD_PAD] = 0;
    place[TD_T_A * TD_PAD] = NAN;
    place[TD_T_DEPTH * TD_PAD] = 1e30f;
}

/* Replaces the depth of each group's first splat in a slice by the least depth of this group and all behind it. */
TD_INLINE void td_point_find_fronts(TD_GLOBAL float *tests, int groups) {
    float least = 1e30f;
    for (int i = groups - 1; i >= 0; i--) {
        TD_GLOBAL float *depth = tests + td_point_test_of(i * TD_PAD) + TD_T_DEPTH * TD_PAD;
        for (int k = 0; k < TD_PAD; k++) least = depth[k] < least ? depth[k] : least;
        depth[0] = least;
    }
}

/* -- asking -------------------------------------------------------------------------------------------------------- */

/* TD_POINT_ASKED places are tested at once: two groups, whose bits form one word. */
#if TD_LANES == 1
typedef float td_point_wide;
typedef int td_point_bits;
enum { TD_POINT_ASKED = 1 };
#define td_point_wide_load(tests, k) ((tests)[(k)*TD_PAD])
#ifdef TD_OPENCL
#define td_point_wide_fma(a, b, c) td_fma_of(float, a, b, c)
#else
#define td_point_wide_fma(a, b, c) fmaf(a, b, c)
#endif
TD_INLINE int td_point_lowest(td_point_bits bits) { return bits - 1; }
#else
typedef float16 td_point_wide;
typedef uint td_point_bits;
enum { TD_POINT_ASKED = 2 * TD_PAD };
#define td_point_wide_fma(a, b, c) td_fma_of(td_point_wide, a, b, c)
#define td_point_wide_load(tests, k) vload16(0, (tests) + (k)*TD_PAD)
TD_INLINE int td_point_lowest(td_point_bits bits) { return (int)popcount((bits & -bits) - 1); } /* number of the lowest bit */
#endif

/* d^T S^-1 d of a group's splats for the point at (x, y) [px], at w in the slice. */
TD_INLINE td_point_wide td_point_distances(TD_GLOBAL const float *tests, float x, float y, float w) {
    td_point_wide dx = td_point_wide_fma(-w, td_point_wide_load(tests, TD_T_U_WAY), x - td_point_wide_load(tests, TD_T_U));
    td_point_wide dy = td_point_wide_fma(-w, td_point_wide_load(tests, TD_T_V_WAY), y - td_point_wide_load(tests, TD_T_V));
    td_point_wide a = td_point_wide_fma(td_point_wide_load(tests, TD_T_A), dx, td_point_wide_load(tests, TD_T_B) * dy);
    return td_point_wide_fma(a, dx, td_point_wide_load(tests, TD_T_C) * dy * dy);
}

/* Bit k: any of `lanes` points may see the splat of place i + k. Each point has its own slice, pixel (x, y), and w in the
 * slice. */
TD_INLINE td_point_bits td_point_ask(TD_GLOBAL const float *tests, const int *slice, int lanes, int i, int taken,
                                     const float *x, const float *y, const float *w) {
    TD_GLOBAL const float *group = tests + td_point_test_of(i);
#if TD_LANES == 1
    (void)taken, (void)lanes;
    return td_point_distances(group + slice[0], x[0], y[0], w[0]) <= 1.0f;
#else
    const int16 ones = (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
    int16 first = 0, second = 0;
    for (int k = 0; k < lanes; k++) {
        first |= td_point_distances(group + slice[k], x[k], y[k], w[k]) <= 1.0f;
        if (i + TD_PAD < taken)
            second |= td_point_distances(group + slice[k] + TD_PAD * TD_TEST_REALS, x[k], y[k], w[k]) <= 1.0f;
    }
    int16 bits = (first & ones) | (second & (ones << TD_PAD));
    int8 a = bits.lo | bits.hi;
    int4 b = a.lo | a.hi;
    int2 c = b.lo | b.hi;
    return (uint)(c.x | c.y);
#endif
}

/* The least depth from a place's group on. */
TD_INLINE float td_point_front(TD_GLOBAL const float *tests, int place) {
    return tests[td_point_test_of(place / TD_PAD * TD_PAD) + TD_T_DEPTH * TD_PAD];
}

/* The slice of a point, and its place w in the slice, in [0, 1]. */
TD_INLINE int td_point_slice(const td_point_slices *slices, int piece, td_real s, float *w) {
    td_real way = slices->split ? s * (td_real)(1 << slices->split) : ((td_real)piece + s) / (td_real)slices->group;
    int slice = slices->split ? (int)way : piece / slices->group;
    slice = slice < slices->count - 1 ? slice : slices->count - 1;
    *w = (float)(way - (td_real)slice);
    return slice;
}

#endif
