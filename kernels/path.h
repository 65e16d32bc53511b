/* Record paths: a splat at any time of an interval, from rows computed at a few times within it, the nodes.
 *
 * The motion of splats on the screen is far smoother than the light of pixels. So a splat is projected at nodes only. In
 * between, it is the cubic through the values and rates of the two neighbouring rows (Hermite), and the cubic's derivative is
 * its rate. All images made of paths agree, and their rates are exact. A splat has 2^level curves in each piece of the
 * interval; its rows are neighbours in memory.
 *
 * The numbers interpolated are mean2d; b, c and the determinant of the covariance; opacity; luminance; depth. Opacity is that
 * with antialiasing and without the near plane's fade, which is applied by the interpolated depth. The conic is (c, -b,
 * a) / det with a = (det + b^2) / c. This is a sum of terms that aren't negative, so that a needle's width doesn't cancel, as
 * it would in a c - b^2. */
#ifndef TD_PATH_H
#define TD_PATH_H

#include "extent.h"
#include "transpose.h"

/* The weights of a time, one set per lane. */
typedef struct td_path_cubic {
    td_lanes way, start, end;             /* W [1], W0, W1 [s], for value = v0 + W (v1 - v0) + W0 r0 + W1 r1 */
    td_lanes way_dot, start_dot, end_dot; /* their derivatives */
} td_path_cubic;

/* A splat on its path. */
typedef struct td_path_splat {
    td_dual u, v, b, c, det, opacity, luminance, depth;
} td_path_splat;

/* -- between rows -------------------------------------------------------------------------------------------------- */

TD_INLINE td_dual td_path_between(const td_path_cubic *cubic, td_dual from, td_dual to) {
    td_lanes way = to.v - from.v;
    return td_dual_make(from.v + td_fma(way, cubic->way, td_fma(from.d, cubic->start, to.d * cubic->end)),
                        td_fma(way, cubic->way_dot, td_fma(from.d, cubic->start_dot, to.d * cubic->end_dot)));
}

TD_INLINE td_dual td_path_number(const td_path_cubic *cubic, const td_lanes from[TD_PATH_STRIDE],
                                 const td_lanes to[TD_PATH_STRIDE], int k) {
    return td_path_between(cubic, td_dual_make(from[k], from[TD_PATH_NUMBERS + k]),
                           td_dual_make(to[k], to[TD_PATH_NUMBERS + k]));
}

/* The splat between two rows. */
TD_INLINE td_path_splat td_path_blend(const td_path_cubic *cubic, const td_lanes from[TD_PATH_STRIDE],
                                      const td_lanes to[TD_PATH_STRIDE]) {
    td_path_splat splat;
    splat.u = td_path_number(cubic, from, to, TD_P_U);
    splat.v = td_path_number(cubic, from, to, TD_P_V);
    splat.b = td_path_number(cubic, from, to, TD_P_B);
    splat.c = td_path_number(cubic, from, to, TD_P_C);
    splat.det = td_path_number(cubic, from, to, TD_P_DET);
    splat.opacity = td_path_number(cubic, from, to, TD_P_OPACITY);
    splat.luminance = td_path_number(cubic, from, to, TD_P_LUMINANCE);
    splat.depth = td_path_number(cubic, from, to, TD_P_DEPTH);
    return splat;
}

#endif
