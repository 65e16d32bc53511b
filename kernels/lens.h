/* Lenses: what a camera does to slopes q = (a, b) = (x/z, y/z) before K, d(q). The projection needs d, its matrix Dd, and the
 * time derivatives of both.
 *
 * radtan (OpenCV's first five) and equidistant (Kannala-Brandt, OpenCV's fisheye) have one form. With w = a^2 + b^2, Q = 1 or
 * theta / tan(theta), and p = w Q^2 (tan^2 or theta^2) it is
 *   d = D(w) q + h(w) (2 p1 a b + p2 (w + 2 a^2), p1 (w + 2 b^2) + 2 p2 a b),   D = Q (1 + k1 p + k2 p^2 + k3 p^3 + k4 p^4),
 *   Dd = D I + 2 D' q q^T + h (tangential's own derivatives) + 2 h' (tangential) q^T.
 * So Dd's rate needs D'' and h'': D and D' are chained as duals. Tangential terms are radtan's alone.
 *
 * A polynomial turns back somewhere: the lens folds over. So it is used out to w = w1 only, beyond the image's corner and
 * before the fold. From there on d continues straight along the radius (D = A Q + B / r), with a continuous slope. It is one to
 * one for all directions in front of the camera, and directions beyond the fold stay outside the image. lib/camera/lens.c finds
 * w1, A, B. */
#ifndef TD_LENS_H
#define TD_LENS_H

#include "dual.h"
#include "layout.h"

/* Number of terms with which the series of theta / tan(theta) reaches rounding at the arguments used below; for w up to 1/8 its
 * derivatives reach it too. */
#ifdef TD_REAL_DOUBLE
enum { TD_LENS_TERMS = 22 };
#else
enum { TD_LENS_TERMS = 10 };
#endif
#define TD_LENS_NEAR_AXIS TD_REAL(0.125)
/* Limit of w. Slopes of a million count as 90 degrees, so that fourth powers of slopes stay in single precision. */
#define TD_LENS_FAR TD_REAL(1e12)
enum { TD_LENS_STEPS = 16 }; /* of Newton's method, from pixels to slopes; lib/camera/lens.c tries them on the image */
/* tan(theta / 2) of the farthest ray that a pixel may have: 89.94 degrees. */
#define TD_LENS_WIDEST TD_REAL(0.9995)

/* A function of w with its first and second derivative. */
typedef struct td_of_w {
    td_lanes f, first, second;
} td_of_w;

/* Slopes through the lens, and the matrix Dd. */
typedef struct td_bent {
    td_dual x, y, xx, xy, yx, yy;
} td_bent;

/* q(w) = atan(r) / r with w = r^2, and its derivatives. Near 0 by its series (Horner). Farther out by the series after halving
 * the angle twice, and then 2 w q' = 1 / (1 + w) - q, which would cancel near 0. */
TD_INLINE td_of_w td_lens_arc(td_lanes w) {
    td_mask near = w < TD_LENS_NEAR_AXIS;
    td_lanes once = 1.0f / (1.0f + td_sqrt(1.0f + w)), v = w * (once * once);
    td_lanes again = 1.0f / (1.0f + td_sqrt(1.0f + v));
    v = td_select(v * (again * again), w, near);
    td_lanes s0 = td_splat(0.0f), s1 = s0, s2 = s0;
    for (int n = TD_LENS_TERMS - 1; n >= 0; n--) {
        td_real term = 1 / (td_real)(2 * n + 1);
        s2 = td_fma(s2, v, s1);
        s1 = td_fma(s1, v, s0);
        s0 = td_fma(s0, v, td_splat(n & 1 ? -term : term));
    }
    td_lanes inverse = 1.0f / (1.0f + w), twice = 0.5f / td_select(w, td_splat(1.0f), near);
    td_of_w q;
    q.f = td_select(4.0f * once * again * s0, s0, near);
    q.first = td_select((inverse - q.f) * twice, s1, near);
    q.second = td_select(td_fma(-3.0f, q.first, -(inverse * inverse)) * twice, 2.0f * s2, near);
    return q;
}

/* 1 + k1 p + k2 p^2 + k3 p^3 + k4 p^4 and its derivatives by p. */
TD_INLINE td_of_w td_lens_polynomial(const td_lens *lens, td_lanes p) {
    td_of_w sum;
    sum.f = td_fma(td_splat(lens->k4), p, td_splat(lens->k3));
    sum.first = td_splat(lens->k4);
    sum.second = td_fma(sum.first, p, sum.f);
    td_lanes f = td_fma(sum.f, p, td_splat(lens->k2)), first = sum.second;
    sum.second = td_fma(sum.first, p, first);
    sum.first = td_fma(first, p, f);
    f = td_fma(f, p, td_splat(lens->k1));
    sum.second = td_fma(sum.second, p, sum.first);
    sum.first = td_fma(sum.first, p, f);
    sum.f = td_fma(f, p, td_splat(1.0f));
    sum.second = 2.0f * sum.second;
    return sum;
}

/* D with its first and second derivative. */
TD_INLINE td_of_w td_lens_radial(const td_image *image, td_lanes w) {
    const td_lens *lens = &image->lens;
    td_mask outside = w > lens->straight_from;
    td_of_w q, d;
    q.f = td_splat(1.0f), q.first = q.second = td_splat(0.0f);
    td_lanes p = w, p1 = td_splat(1.0f), p2 = td_splat(0.0f);
    if (td_lens_model(image) == TD_LENS_EQUIDISTANT) {
        q = td_lens_arc(w);
        td_lanes inverse = 1.0f / (1.0f + w);
        p = w * (q.f * q.f);
        p1 = q.f * inverse;
        p2 = (q.first - p1) * inverse;
    }
    td_of_w poly = td_lens_polynomial(lens, td_select(p, td_splat(1.0f), outside));
    d.f = q.f * poly.f;
    d.first = td_fma(q.first, poly.f, q.f * (poly.first * p1));
    d.second = td_fma(q.second, poly.f, 2.0f * q.first * (poly.first * p1));
    d.second = td_fma(q.f, td_fma(poly.second * p1, p1, poly.first * p2), d.second);
    if (!td_any(outside)) return d;
    td_lanes on = 1.0f / td_select(td_splat(1.0f), w, outside), rest = lens->straight_offset * td_sqrt(on);
    d.f = td_select(d.f, td_fma(lens->straight_slope, q.f, rest), outside);
    d.first = td_select(d.first, td_fma(lens->straight_slope, q.first, -0.5f * rest * on), outside);
    d.second = td_select(d.second, td_fma(lens->straight_slope, q.second, 0.75f * rest * on * on), outside);
    return d;
}

/* h: 1 out to w1; beyond, where d is straight, h w = 2 r1 r - w1. */
TD_INLINE td_of_w td_lens_straight(const td_lens *lens, td_lanes w) {
    td_mask outside = w > lens->straight_from;
    td_real w1 = lens->straight_from, r1 = lens->straight_radius;
    td_lanes on = 1.0f / td_select(td_splat(1.0f), w, outside), root = r1 * td_sqrt(on);
    td_of_w h;
    h.f = td_select(td_splat(1.0f), td_fma(td_splat(2.0f), root, -w1 * on), outside);
    h.first = td_select(td_splat(0.0f), td_fma(w1, on, -root) * on, outside);
    h.second = td_select(td_splat(0.0f), td_fma(1.5f, root, -2.0f * w1 * on) * on * on, outside);
    return h;
}

/* A function of w as a dual, and its first derivative. */
TD_INLINE td_dual td_chain(const td_of_w *f, td_dual w) { return td_dual_make(f->f, f->first * w.d); }
TD_INLINE td_dual td_chain_first(const td_of_w *f, td_dual w) { return td_dual_make(f->first, f->second * w.d); }

/* Adds the tangential terms for (a, b), with w = a^2 + b^2. */
TD_INLINE void td_lens_tangential(const td_lens *lens, td_dual a, td_dual b, td_dual w, td_bent *bent) {
    td_of_w straight = td_lens_straight(lens, w.v);
    td_dual h = td_chain(&straight, w), h2 = td_dual_scale(td_chain_first(&straight, w), 2);
    td_dual ab2 = td_dual_scale(td_dual_mul(a, b), 2);
    td_dual wa = td_dual_plus(w, 2, td_dual_mul(a, a)), wb = td_dual_plus(w, 2, td_dual_mul(b, b));
    td_dual tx = td_dual_plus(td_dual_scale(ab2, lens->p1), lens->p2, wa);
    td_dual ty = td_dual_plus(td_dual_scale(ab2, lens->p2), lens->p1, wb);
    td_dual mixed = td_dual_plus(td_dual_scale(a, 2 * lens->p1), 2 * lens->p2, b);
    td_dual txx = td_dual_plus(td_dual_scale(b, 2 * lens->p1), 6 * lens->p2, a);
    td_dual tyy = td_dual_plus(td_dual_scale(a, 2 * lens->p2), 6 * lens->p1, b);
    td_dual ha = td_dual_mul(h2, a), hb = td_dual_mul(h2, b);
    bent->x = td_dual_fma(h, tx, bent->x);
    bent->y = td_dual_fma(h, ty, bent->y);
    bent->xx = td_dual_add(bent->xx, td_dual_fma(h, txx, td_dual_mul(ha, tx)));
    bent->xy = td_dual_add(bent->xy, td_dual_fma(h, mixed, td_dual_mul(hb, tx)));
    bent->yx = td_dual_add(bent->yx, td_dual_fma(h, mixed, td_dual_mul(ha, ty)));
    bent->yy = td_dual_add(bent->yy, td_dual_fma(h, tyy, td_dual_mul(hb, ty)));
}

TD_INLINE td_bent td_bend(const td_image *image, td_dual a, td_dual b) {
    td_dual w = td_dual_clamp(td_dual_fma(a, a, td_dual_mul(b, b)), TD_REAL(-1.0), TD_LENS_FAR);
    td_of_w radial = td_lens_radial(image, w.v);
    td_dual d = td_chain(&radial, w), twice = td_dual_scale(td_chain_first(&radial, w), 2);
    td_dual da = td_dual_mul(twice, a), db = td_dual_mul(twice, b);
    td_bent bent;
    bent.x = td_dual_mul(d, a);
    bent.y = td_dual_mul(d, b);
    bent.xx = td_dual_fma(da, a, d);
    bent.xy = bent.yx = td_dual_mul(da, b);
    bent.yy = td_dual_fma(db, b, d);
    if (td_lens_model(image) == TD_LENS_RADTAN) td_lens_tangential(&image->lens, a, b, w, &bent);
    return bent;
}

TD_INLINE td_dual td_still(td_lanes x) { return td_dual_make(x, td_splat(0.0f)); }

/* -- from pixels back ---------------------------------------------------------------------------------------------- */

/* The slopes whose image is (x, y), by Newton's method from (x, y). */
TD_INLINE void td_unbend_plane(const td_image *image, td_lanes x, td_lanes y, td_lanes *a, td_lanes *b) {
    *a = x, *b = y;
    for (int i = 0; i < TD_LENS_STEPS; i++) {
        td_bent at = td_bend(image, td_still(*a), td_still(*b));
        td_lanes ex = at.x.v - x, ey = at.y.v - y;
        td_lanes inverse = 1.0f / td_fma(at.xx.v, at.yy.v, -(at.xy.v * at.yx.v));
        *a = td_fma(td_fma(at.xy.v, ey, -(at.yy.v * ex)), inverse, *a);
        *b = td_fma(td_fma(at.yx.v, ex, -(at.xx.v * ey)), inverse, *b);
    }
}

/* Solves for the slopes by the angle theta from the axis. The unknown is t = tan(theta / 2), in which theta's image is nearly
 * linear. */
TD_INLINE void td_unbend_angle(const td_image *image, td_lanes x, td_lanes y, td_lanes *a, td_lanes *b) {
    const td_lens *lens = &image->lens;
    td_lanes rho = td_sqrt(td_fma(x, x, y * y)), t = td_clamp(0.5f * rho, TD_REAL(0.0), TD_LENS_WIDEST);
    for (int i = 0; i < TD_LENS_STEPS; i++) {
        td_lanes square = t * t, theta = 2.0f * t * td_lens_arc(square).f, p = theta * theta;
        td_lanes r = 2.0f * t / (1.0f - square);
        td_mask outside = r * r > lens->straight_from;
        td_of_w poly = td_lens_polynomial(lens, p);
        td_lanes g = td_select(theta * poly.f, td_fma(lens->straight_slope, theta, td_splat(lens->straight_offset)), outside);
        td_lanes slope = td_select(td_fma(2.0f * p, poly.first, poly.f), td_splat(lens->straight_slope), outside);
        t = td_clamp(td_fma(0.5f * (rho - g), (1.0f + square) / slope, t), TD_REAL(0.0), TD_LENS_WIDEST);
    }
    td_mask axis = rho < TD_REAL(1e-8);
    td_lanes ratio = 2.0f * t / ((1.0f - t * t) * td_select(rho, td_splat(1.0f), axis));
    ratio = td_select(ratio, td_splat(1.0f), axis);
    *a = x * ratio, *b = y * ratio;
}

/* x/z and y/z of the ray of pixel (u, v) [px]; of the farthest ray if no ray in front of the camera reaches this pixel. */
TD_INLINE void td_ray_of(const td_image *image, td_lanes u, td_lanes v, td_lanes *a, td_lanes *b) {
    td_lanes x = (u - image->cx) / image->fx, y = (v - image->cy) / image->fy;
    *a = x, *b = y;
    if (td_lens_model(image) == TD_LENS_RADTAN) td_unbend_plane(image, x, y, a, b);
    if (td_lens_model(image) == TD_LENS_EQUIDISTANT) td_unbend_angle(image, x, y, a, b);
}

/* -- bounds, for sweeps -------------------------------------------------------------------------------------------- */

/* Lanes whose splat is farther out than every corner of the image by `blur` [focal lengths] and more. The splat is at least
 * `across` from the axis, no deeper than `deep`, and reaches `size` around its centre [scene units]. For equidistant, its edge
 * on the image is at most `sideways` size / distance from the centre. For radtan, `across` is reduced by `reach` size instead,
 * because d grows at least as fast. */
TD_INLINE td_mask td_lens_outside(const td_image *image, td_lanes across, td_lanes deep, td_lanes size, td_lanes blur) {
    const td_lens *lens = &image->lens;
    td_lanes r = td_larger(across - lens->reach * size, td_splat(0.0f)) / deep;
    td_lanes w = td_smaller(r * r, td_splat(TD_LENS_FAR));
    td_lanes bent = td_lens_radial(image, w).f * td_sqrt(w);
    if (td_lens_model(image) == TD_LENS_RADTAN) bent = td_fma(-lens->tangential * w, td_lens_straight(lens, w).f, bent);
    td_lanes edge = lens->sideways * size / td_larger(across, td_splat(TD_REAL(1e-12)));
    return bent > lens->corner + blur + edge;
}

#endif
