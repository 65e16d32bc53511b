/* Record paths: what a splat is at any time of an interval, from rows worked out at a few times within it, the nodes.
 *
 * What splats do on the screen is far smoother than what pixels see of it. So a splat is projected at nodes only, and is the
 * cubic through the values and the rates of its two neighbouring rows in between (Hermite); the cubic's derivative is its rate.
 * Every image made of paths is one image, whose rates are exactly its own. A splat has 2^level times as many nodes as the
 * interval has pieces; its rows follow one another.
 *
 * Interpolated are mean2d; b, c and the determinant of the covariance; opacity with antialiasing but without the near plane's
 * fade, which follows the interpolated depth; luminance; depth. The conic is (c, -b, a) / det with a = (det + b^2) / c: sums of
 * what isn't negative, so that a needle's width doesn't cancel, as it would in a c - b^2.
 *
 * Host, device, float and double compile this file. */
#ifndef TD_PATH_H
#define TD_PATH_H

#include "extent.h"
#include "transpose.h"

/* The weights of a time, per lane (interpolate.h has the same for times that all lanes share). */
typedef struct td_path_cubic {
    td_lanes way, start, end;             /* 1, s, s */
    td_lanes way_dot, start_dot, end_dot; /* their derivatives */
} td_path_cubic;

/* Rows, and for a number of moments (times, one after the other; each with an entry per level) the node before it and the
 * weights between that and the next. */
typedef struct td_paths {
    TD_GLOBAL const td_real *rows;   /* TD_PATH_STRIDE each */
    TD_GLOBAL const td_real *low;    /* of each row: what depth is more, relative to it (fine_depth.h); nothing in double */
    TD_GLOBAL const td_real *cubics; /* (moments x TD_PATH_LEVELS x TD_PATH_CUBIC) */
    TD_GLOBAL const int *nodes;      /* (moments x TD_PATH_LEVELS) */
} td_paths;

/* A splat on its path. */
typedef struct td_path_splat {
    td_dual u, v, b, c, det, opacity, luminance, depth;
    td_lanes depth_low;
} td_path_splat;

/* -- between rows -------------------------------------------------------------------------------------------------- */

/* The weights at `entry` (moment * TD_PATH_LEVELS + level) of each lane: mostly the same for all. */
TD_INLINE td_path_cubic td_path_weights(TD_GLOBAL const td_real *cubics, td_index entry) {
    td_path_cubic cubic;
    int at[TD_LANES];
    td_index_lanes(entry, at);
    TD_GLOBAL const td_real *first = cubics + at[0] * TD_PATH_CUBIC;
    cubic.way = td_splat(first[0]), cubic.start = td_splat(first[1]), cubic.end = td_splat(first[2]);
    cubic.way_dot = td_splat(first[3]), cubic.start_dot = td_splat(first[4]), cubic.end_dot = td_splat(first[5]);
#if TD_LANES > 1
    if (!td_any(entry != at[0])) return cubic;
    td_index index = entry * TD_PATH_CUBIC;
    cubic.way = td_gather(cubics, index), cubic.start = td_gather(cubics, index + 1), cubic.end = td_gather(cubics, index + 2);
    cubic.way_dot = td_gather(cubics, index + 3), cubic.start_dot = td_gather(cubics, index + 4);
    cubic.end_dot = td_gather(cubics, index + 5);
#endif
    return cubic;
}

/* Beside the value and the rate, how far that is from the first row: adding it is where the value is rounded. */
TD_INLINE td_dual td_path_between(const td_path_cubic *cubic, td_dual from, td_dual to, td_lanes *step) {
    td_lanes way = to.v - from.v;
    *step = td_fma(way, cubic->way, td_fma(from.d, cubic->start, to.d * cubic->end));
    return td_dual_make(from.v + *step, td_fma(way, cubic->way_dot, td_fma(from.d, cubic->start_dot, to.d * cubic->end_dot)));
}

TD_INLINE td_dual td_path_number(const td_path_cubic *cubic, const td_lanes from[TD_PATH_STRIDE],
                                 const td_lanes to[TD_PATH_STRIDE], int k, td_lanes *step) {
    return td_path_between(cubic, td_dual_make(from[k], from[TD_PATH_NUMBERS + k]),
                           td_dual_make(to[k], to[TD_PATH_NUMBERS + k]), step);
}

/* What lies between two rows. The low part of depth, where `low` has those of the rows, is what the sum of the first row's
 * depth and the way from there loses (Knuth), and theirs. */
TD_INLINE td_path_splat td_path_blend(const td_path_cubic *cubic, const td_lanes from[TD_PATH_STRIDE],
                                      const td_lanes to[TD_PATH_STRIDE], td_lanes low_from, td_lanes low_to) {
    td_path_splat splat;
    td_lanes step;
    splat.u = td_path_number(cubic, from, to, TD_P_U, &step);
    splat.v = td_path_number(cubic, from, to, TD_P_V, &step);
    splat.b = td_path_number(cubic, from, to, TD_P_B, &step);
    splat.c = td_path_number(cubic, from, to, TD_P_C, &step);
    splat.det = td_path_number(cubic, from, to, TD_P_DET, &step);
    splat.opacity = td_path_number(cubic, from, to, TD_P_OPACITY, &step);
    splat.luminance = td_path_number(cubic, from, to, TD_P_LUMINANCE, &step);
    splat.depth = td_path_number(cubic, from, to, TD_P_DEPTH, &step);
    td_lanes first = from[TD_P_DEPTH], depth = splat.depth.v, part = depth - first;
    td_lanes lost = (first - (depth - part)) + (step - part);
    splat.depth_low = lost / td_select(depth, td_splat(1.0f), depth == 0.0f) + td_fma(low_to - low_from, cubic->way, low_from);
    return splat;
}

/* TD_LANES splats, each on its path (>= 0) at its moment. */
TD_INLINE td_path_splat td_path_at(const td_paths *paths, td_index path, td_index moment) {
    td_lanes from[TD_PATH_STRIDE], to[TD_PATH_STRIDE], low_from = td_splat(0.0f), low_to = td_splat(0.0f);
    td_index entry = moment * TD_PATH_LEVELS + (path & (TD_PATH_LEVELS - 1));
    td_index row = (path >> TD_PATH_LEVEL_BITS) + td_gather_ints(paths->nodes, entry);
    td_path_cubic cubic = td_path_weights(paths->cubics, entry);
    td_load_rows(paths->rows, row, from);
    td_load_rows(paths->rows, row + 1, to);
#ifndef TD_REAL_DOUBLE
    low_from = td_gather(paths->low, row), low_to = td_gather(paths->low, row + 1);
#endif
    return td_path_blend(&cubic, from, to, low_from, low_to);
}

/* -- splats -------------------------------------------------------------------------------------------------------- */

/* The splat as the projection gives it (td_project_shape). */
TD_INLINE td_shape td_path_shape(const td_path_splat *splat, const td_image *image) {
    td_shape shape;
    td_dual one = td_dual_make(td_splat(1.0f), td_splat(0.0f));
    shape.u = splat->u, shape.v = splat->v;
    shape.b = splat->b, shape.c = splat->c, shape.det = splat->det;
    shape.depth = splat->depth;
    shape.depth_low = splat->depth_low;
    shape.compensation = td_splat(1.0f);
    shape.visible = (splat->det.v > 0.0f) & (splat->c.v > 0.0f) & (splat->depth.v > image->near);
    td_dual inverse = td_dual_reciprocal(td_dual_select(one, splat->det, shape.visible));
    td_dual inverse_c = td_dual_reciprocal(td_dual_select(one, splat->c, shape.visible));
    shape.a = td_dual_mul(td_dual_fma(splat->b, splat->b, splat->det), inverse_c);
    shape.conic[0] = td_dual_mul(splat->c, inverse);
    shape.conic[1] = td_dual_negate(td_dual_mul(splat->b, inverse));
    shape.conic[2] = td_dual_mul(shape.a, inverse);
    td_shape_fade(&shape, splat->opacity, image);
    td_lanes all = (shape.conic[0].d + shape.conic[2].d) + (shape.u.d + shape.v.d) + (shape.opacity.v + shape.opacity.d);
    shape.broken = shape.visible & td_is_broken(all);
    return shape;
}

#endif
