/* The screen box that a Gaussian's splat stays within while time runs over an interval: what tile candidate lists are made of.
 *
 * The splat is projected at the interval's start, middle and end. Its mean's path lies near the cubic through the ends with
 * their rates; that cubic lies within its Bezier points; and the middle tells how far the path strays from it. */
#ifndef TD_SWEEP_H
#define TD_SWEEP_H

#include "extent.h"

/* Smallest and largest of the Bezier points of the cubic through (p0, rate r0) and (p1, rate r1), widened by four times the
 * distance at the middle (a quartic term that shows as e there is at most e within; the rest is safety). */
TD_INLINE void td_sweep_range(td_dual start, td_dual middle, td_dual end, td_real duration, td_lanes *lower, td_lanes *upper) {
    td_real third = duration / 3;
    td_lanes b1 = td_fma(start.d, third, start.v), b2 = td_fma(end.d, -third, end.v);
    td_lanes centre = 0.125f * (start.v + end.v) + 0.375f * (b1 + b2);
    td_lanes stray = middle.v - centre;
    stray = 4.0f * td_larger(stray, -stray);
    *lower = td_smaller(td_smaller(start.v, end.v), td_smaller(td_smaller(b1, b2), middle.v)) - stray;
    *upper = td_larger(td_larger(start.v, end.v), td_larger(td_larger(b1, b2), middle.v)) + stray;
}

/* Largest of three half-widths, plus their spread: they too may bulge between the samples. */
TD_INLINE td_lanes td_sweep_width(td_lanes a, td_lanes b, td_lanes c) {
    td_lanes most = td_larger(td_larger(a, b), c), least = td_smaller(td_smaller(a, b), c);
    return most + (most - least);
}

/* Length of a move of the mean in units of the splat's diameter along it, out to where it is cut off. */
TD_INLINE td_lanes td_move(const td_shape *shape, td_lanes dx, td_lanes dy) {
    td_lanes q = dx * td_fma(shape->conic[0].v, dx, 2.0f * shape->conic[1].v * dy) + shape->conic[2].v * dy * dy;
    td_lanes radius2 = td_select(td_splat(1.0f), shape->power, shape->power > 0.0f);
    return 0.5f * td_sqrt(td_larger(q, td_splat(0.0f)) / radius2);
}

/* How many of its own diameters each splat travels in the interval: what passes a pixel between two samples unseen. */
TD_INLINE td_lanes td_travel(const td_shape s[3], td_mask ever) {
    td_lanes first = td_move(&s[1], s[1].u.v - s[0].u.v, s[1].v.v - s[0].v.v);
    td_lanes second = td_move(&s[1], s[2].u.v - s[1].u.v, s[2].v.v - s[1].v.v);
    return td_select(td_splat(0.0f), first + second, ever & s[1].visible);
}

/* first, first + 1 .. in each lane */
TD_INLINE td_index td_count_from(int first) {
#if TD_LANES == 16
    return first + (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif TD_LANES == 8
    return first + (int8)(0, 1, 2, 3, 4, 5, 6, 7);
#elif TD_LANES == 4
    return first + (int4)(0, 1, 2, 3);
#else
    return first;
#endif
}

/* Gaussians whose own opacity changes may be visible only between the samples: gives all three the greatest opacity that the
 * cubic through them reaches, and so the ellipse out to where that one is cut. */
TD_INLINE void td_sweep_opacity(td_shape s[3], const td_image *image, td_real duration) {
    td_lanes lower, upper;
    td_real cut = image->cut_rule == TD_CUT_NONE ? TD_REAL(1e-30) : image->cut;
    td_sweep_range(s[0].opacity, s[1].opacity, s[2].opacity, duration, &lower, &upper);
    td_mask in_front = (s[0].depth.v > image->near) & (s[1].depth.v > image->near) & (s[2].depth.v > image->near);
    td_mask reached = in_front & (upper > cut);
    td_lanes power = 2.0f * td_log(td_select(td_splat(1.0f), upper / cut, reached));
    for (int i = 0; i < 3; i++) {
        s[i].visible = s[i].visible | reached;
        s[i].power = td_larger(s[i].power, power);
    }
}

/* Box [x0, y0, x1, y1] of TD_LANES Gaussians of an object, at boxes + 4 i; empty (x0 > x1) where never visible. They are in
 * neighbouring rows from row[0] at the interval's start, row[1] in its middle and row[2] at its end; `views` likewise, for
 * every object. Whatever crosses the near plane in the interval gets the whole image. travel[i]: see td_travel; 0 at the near
 * plane, where splats fade. */
TD_INLINE void td_sweep_group(TD_GLOBAL const td_view *views, const td_image *image, const td_source *all,
                              TD_GLOBAL const int *object, const int row[3], td_real duration, TD_GLOBAL td_real *boxes,
                              TD_GLOBAL td_real *travel) {
    td_shape s[3];
    td_lanes rx[3], ry[3];
    td_source own = td_source_of(all, image, row[0]);
    const td_source *source = &own;
    int which = object[td_owner_of(source, row[0])];
    for (int i = 0; i < 3; i++)
        s[i] = td_project_shape(views + i * image->objects + which, image, source, td_count_from(row[i]));
    if (image->moving && source->moved) td_sweep_opacity(s, image, duration);
    for (int i = 0; i < 3; i++) {
        td_half_widths(&s[i], &rx[i], &ry[i]);
        rx[i] = td_select(td_splat(0.0f), rx[i], s[i].visible);
        ry[i] = td_select(td_splat(0.0f), ry[i], s[i].visible);
    }
    td_mask ever = s[0].visible | s[1].visible | s[2].visible;
    td_mask behind = (s[0].depth.v <= image->near) | (s[1].depth.v <= image->near) | (s[2].depth.v <= image->near);
    td_lanes z0, z1;
    td_sweep_range(s[0].depth, s[1].depth, s[2].depth, duration, &z0, &z1);
    td_real cut = image->cut_rule == TD_CUT_NONE ? TD_REAL(0.0) : image->cut;
    td_mask opaque = td_gather(source->geometry, td_count_from(row[0]) * TD_GEOMETRY_STRIDE + TD_G_OPACITY) > cut;
    if (image->moving && source->moved)
        for (int i = 1; i < 3; i++)
            opaque |= td_gather(source->geometry, td_count_from(row[i]) * TD_GEOMETRY_STRIDE + TD_G_OPACITY) > cut;
    td_mask crosses = opaque & (((z0 <= image->near) & (z1 > image->near)) | (behind & ever));
    td_lanes x0, x1, y0, y1;
    td_sweep_range(s[0].u, s[1].u, s[2].u, duration, &x0, &x1);
    td_sweep_range(s[0].v, s[1].v, s[2].v, duration, &y0, &y1);
    td_lanes wide = td_sweep_width(rx[0], rx[1], rx[2]), high = td_sweep_width(ry[0], ry[1], ry[2]);
    td_lanes width = td_splat((td_real)image->width), height = td_splat((td_real)image->height);
    x0 = td_select(td_select(width + 1.0f, x0 - wide, ever), td_splat(0.0f), crosses);
    x1 = td_select(td_select(td_splat(-1.0f), x1 + wide, ever), width, crosses);
    y0 = td_select(td_select(height + 1.0f, y0 - high, ever), td_splat(0.0f), crosses);
    y1 = td_select(td_select(td_splat(-1.0f), y1 + high, ever), height, crosses);
    td_scatter(boxes, 4, 0, x0);
    td_scatter(boxes, 4, 1, y0);
    td_scatter(boxes, 4, 2, x1);
    td_scatter(boxes, 4, 3, y1);
    td_store_lanes(travel, td_select(td_travel(s, ever), td_splat(0.0f), crosses));
}

#endif
