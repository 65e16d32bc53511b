/* Computes into how many pieces an interval must be cut, so that samples show all that a splat does in it.
 *
 * The number is given as `travel`, in diameters. The step controller halves steps until a splat travels less than half a
 * diameter in each, so that n pieces are asked for by a travel of n / 2. Motion that is smooth within the interval asks for no
 * pieces, because the controller's own samples show it. Pieces are asked for by
 *   - a mean that passes a pixel: its way in the splat's diameters;
 *   - an ellipse that turns or grows: the way of its edge. That is half the relative change of the variance along some
 *     direction; for a needle of half-axes r1 > r2 that turns by phi, phi r1 / (2 r2);
 *   - an object's path that isn't the cubic through its ends, until it is to a hundredth of a pixel;
 *   - Gaussians that move by themselves, where their model changes more than three samples of an interval show: place, shape,
 *     opacity or colour aren't the cubics through coarser samples' values and rates;
 *   - a splat that appears from behind the near plane and is gone at both ends. */
#ifndef TD_UNSEEN_H
#define TD_UNSEEN_H

#include "extent.h"
#include "stray.h"

/* Allowed error of a place [px]. The steepest edges, of splats half a pixel wide (dilation under image.rules smooth makes them
 * 0.55 px), turn it into one or two hundredths in S: a tenth of a threshold. For wider splats it may be larger in proportion.
 * On the scenes of `bench accuracy` it asks for no step. SHARE is the allowed relative error of shape, opacity and colour:
 * samples need only show that they change, and the controller then resolves the change. */
#define TD_UNSEEN_PLACE TD_REAL(0.01)
#define TD_UNSEEN_SHARE TD_REAL(0.02)
/* Opacities below this (0.2/255, the cut of image.rules smooth) are invisible even before black. */
#define TD_UNSEEN_OPACITY TD_REAL(8e-4)

/* Length of a move of the mean, in the splat's diameters along it; the diameter ends where the splat is cut off. */
TD_INLINE td_lanes td_move(const td_shape *shape, td_lanes dx, td_lanes dy) {
    td_lanes q = dx * td_fma(shape->conic[0].v, dx, 2.0f * shape->conic[1].v * dy) + shape->conic[2].v * dy * dy;
    td_lanes radius2 = td_select(td_splat(1.0f), shape->power, shape->power > 0.0f);
    return 0.5f * td_sqrt(td_larger(q, td_splat(0.0f)) / radius2);
}

/* How many of its own diameters each splat travels in the interval: a splat may pass a pixel unseen between two samples. */
TD_INLINE td_lanes td_travel(const td_shape s[3], td_mask ever) {
    td_lanes first = td_move(&s[1], s[1].u.v - s[0].u.v, s[1].v.v - s[0].v.v);
    td_lanes second = td_move(&s[1], s[2].u.v - s[1].u.v, s[2].v.v - s[1].v.v);
    return td_select(td_splat(0.0f), first + second, ever & s[1].visible);
}

/* A power of two near the inverse variance. Scaled by it, variances and conics of splats up to 2^120 px^2 have products in
 * single precision, and nothing is rounded. Without it the products below overflowed from 1e9 px on, and each tile was cut down
 * to min_step_s: 24 508 renders instead of 39. */
TD_INLINE td_lanes td_inverse_scale(const td_shape *s) {
    return td_inverse_power(td_clamp(td_larger(s->a.v, s->c.v), TD_REAL(1.0), TD_REAL(1.329227995784916e36))); /* 2^120 */
}

/* The part of an ellipse's long half-axis that pixels may see, from its middle to the sensor's farthest corner, at most 1. The
 * way of a turning ellipse's edge is multiplied by it. By their whole length, needles of thousands of pixels asked for steps
 * down to min_step_s: 24 508 renders where 474 are enough (bench stability, singular-conics-1e3). */
TD_INLINE td_lanes td_seen_part(const td_shape *s, const td_image *image) {
    td_lanes dx = td_larger(td_size(s->u.v), td_size(td_splat((td_real)image->width) - s->u.v));
    td_lanes dy = td_larger(td_size(s->v.v), td_size(td_splat((td_real)image->height) - s->v.v));
    td_lanes reach2 = td_larger(s->power, td_splat(1.0f)) * (s->a.v + s->c.v); /* no less than the half-axis squared */
    td_lanes part = td_sqrt(td_fma(dx, dx, dy * dy) / reach2);
    return td_select(td_splat(1.0f), part, part < 1.0f);
}

/* Greatest relative rate of the variance along any direction [1/s]: the spectral radius of V^-1 V_dot. Where a splat is longer
 * than the part that is seen, turning counts by that part, and growth at least by half. */
TD_INLINE td_lanes td_reshape_rate(const td_shape *s, const td_image *image) {
    td_lanes shrink = td_inverse_scale(s), grow = 1.0f / shrink;
    td_lanes qa = s->conic[0].v * grow, qb = s->conic[1].v * grow, qc = s->conic[2].v * grow;
    td_lanes a_dot = s->a.d * shrink, b_dot = s->b.d * shrink, c_dot = s->c.d * shrink;
    td_lanes apart = 0.5f * td_fma(qa, a_dot, td_fma(2.0f * qb, b_dot, qc * c_dot));
    td_lanes det = td_fma(a_dot, c_dot, -(b_dot * b_dot)) * td_fma(qa, qc, -(qb * qb));
    return td_size(apart) + td_seen_part(s, image) * td_sqrt(td_larger(td_fma(apart, apart, -det), td_splat(0.0f)));
}

/* The way of an ellipse's edge in the interval, in diameters. */
TD_INLINE td_lanes td_reshape(const td_shape s[3], const td_image *image, td_real duration) {
    td_lanes most = td_splat(0.0f);
    for (int i = 0; i < 3; i++) most = td_larger(most, td_select(td_splat(0.0f), td_reshape_rate(&s[i], image), s[i].visible));
    return 0.5f * duration * most;
}

/* The narrowest standard deviation [px]. */
TD_INLINE td_lanes td_narrowest(const td_shape *s) {
    td_lanes shrink = td_inverse_scale(s), mixed = s->b.v * shrink;
    td_lanes apart = 0.5f * (s->a.v - s->c.v) * shrink, middle = 0.5f * (s->a.v + s->c.v);
    td_lanes gap = td_sqrt(td_fma(apart, apart, mixed * mixed)) / shrink;
    return td_sqrt(td_larger(middle - gap, td_splat(0.0f)));
}

/* Pieces that are needed until an object's path is followed; `per_unit`: pixels per unit of scene. */
TD_INLINE td_lanes td_stray_pieces(TD_GLOBAL const td_stray *stray, const td_reach *reach, td_lanes per_unit,
                                   td_lanes allowed) {
    td_lanes pieces = td_splat(1.0f);
    td_real next = 2;
    for (int level = 0; level < TD_STRAY_LEVELS; level++, next *= 2) {
        td_lanes off = td_stray_of(stray, level, reach, td_splat(1.0f)) * per_unit;
        pieces = td_select(pieces, td_splat(next), off > allowed);
    }
    return pieces;
}

/* -- Gaussians that move by themselves ------------------------------------------------------------------------------ */

/* By how much the middle isn't on the cubic through both ends, in value or, over a quarter of the time, in rate. */
TD_INLINE td_lanes td_surplus(td_dual start, td_dual middle, td_dual end, td_real duration) {
    td_lanes value = td_fma(start.d - end.d, td_splat(0.125f * duration), 0.5f * (start.v + end.v));
    td_lanes rate = td_fma(end.v - start.v, td_splat(1.5f / duration), -0.25f * (start.d + end.d));
    return td_larger(td_size(middle.v - value), 0.25f * duration * td_size(middle.d - rate));
}

/* td_surplus of all SH coefficients, in luminance and relative to the luminance of the constant term. A basis function up to
 * degree 4 is at most sqrt(9 / (4 pi)). */
TD_INLINE td_lanes td_colour_surplus(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                     const int row[3], td_real duration) {
    td_lanes sum = td_splat(0.0f), luminance = td_splat(image->transfer.dark);
    td_sh_source sh[3];
    for (int i = 0; i < 3; i++) sh[i] = td_sh_source_of(view, image, source, td_count_from(row[i]));
    for (int k = 0; k < image->sh_stride; k++) {
        td_dual x[3];
        for (int i = 0; i < 3; i++)
            x[i] = td_dual_make(td_gather_sh(sh[i].sh, sh[i].index + k), td_gather(sh[i].rates, sh[i].rate_index + k));
        td_lanes weight = td_splat(image->luminance[k % 3]);
        sum = td_fma(weight, td_surplus(x[0], x[1], x[2], duration), sum);
        td_lanes colour = td_fma(td_larger(x[0].v, td_larger(x[1].v, x[2].v)), TD_REAL(0.28209479177387814), td_splat(0.5f));
        if (k < 3) luminance = td_fma(weight, td_larger(colour, td_splat(0.0f)), luminance);
    }
    return TD_REAL(0.8462843753216345) * image->transfer.steepest * sum / luminance;
}

/* The mask of the visible Gaussians that change between these ends in a way which the ends don't show. `peak`: their greatest
 * opacity. */
TD_INLINE td_mask td_is_rough(const td_shape s[3], TD_GLOBAL const td_view *view, const td_image *image,
                              const td_source *source, const int row[3], td_real duration, td_lanes peak) {
    td_mask in_front = (s[0].depth.v > image->near) & (s[1].depth.v > image->near) & (s[2].depth.v > image->near);
    td_lanes most = td_larger(s[0].opacity.v, td_larger(s[1].opacity.v, s[2].opacity.v));
    td_lanes place = td_larger(td_surplus(s[0].u, s[1].u, s[2].u, duration), td_surplus(s[0].v, s[1].v, s[2].v, duration));
    td_lanes a = td_surplus(s[0].a, s[1].a, s[2].a, duration) / s[1].a.v;
    td_lanes c = td_surplus(s[0].c, s[1].c, s[2].c, duration) / s[1].c.v;
    td_lanes b = td_surplus(s[0].b, s[1].b, s[2].b, duration) / td_sqrt(s[1].a.v * s[1].c.v);
    td_lanes shape = td_larger(a, td_larger(b, c));
    td_lanes opacity = td_surplus(s[0].opacity, s[1].opacity, s[2].opacity, duration);
    td_mask rough = place > TD_UNSEEN_PLACE * td_larger(td_narrowest(&s[1]), td_splat(1.0f));
    rough |= shape > 2.0f * TD_UNSEEN_SHARE;
    rough |= opacity > td_fma(peak, TD_UNSEEN_SHARE, td_splat(0.25f * TD_UNSEEN_OPACITY));
    if (source->sh_rated) rough |= td_colour_surplus(view, image, source, row, duration) > TD_UNSEEN_SHARE;
    return rough & in_front & (most > TD_UNSEEN_OPACITY);
}

#endif
