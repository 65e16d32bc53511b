/* The splats that points see, each on its curve at the point's time. TD_LANES points, single pixels at single times, are
 * handled together. What they see of a splat becomes an entry, kept until all are known. */
#ifndef TD_POINT_SPLATS_H
#define TD_POINT_SPLATS_H

#include "compositing.h"
#include "point_entries.h"
#include "point_tests.h"
#include "soft_order.h"

/* -- curves at a time ---------------------------------------------------------------------------------------------- */

/* Places of a lane's time on curves of each level, [level][lane]. curve: the curve's first real, from the first of the splat's;
 * way: s in [0, 1] on it; rate: ds/dt [1/s]. These arrays are the work-item's own, since splats have different levels. */
TD_INLINE void td_point_weights(td_real s, td_real h, int piece, int lane, td_real *way, td_real *rate, int *curve) {
    td_real once = 1 / h;
    for (int level = 0; level < TD_PATH_LEVELS; level++) {
        int parts = 1 << level, part = (int)(s * (td_real)parts);
        part = part < parts - 1 ? part : parts - 1;
        way[level * TD_LANES + lane] = s * (td_real)parts - (td_real)part;
        rate[level * TD_LANES + lane] = (td_real)parts * once; /* parts / h: a power of two */
        curve[level * TD_LANES + lane] = ((piece << level) + part) * TD_CURVE_REALS;
    }
}

/* 1 if all lanes are on one curve. */
TD_INLINE int td_point_together(const int *curve) {
    int same = 1;
    for (int lane = 1; lane < TD_LANES; lane++) same &= curve[lane] == curve[0];
    return same;
}

/* A cubic and its slope in s, by Horner's rule. */
TD_INLINE void td_point_cubic(td_lanes a0, td_lanes a1, td_lanes a2, td_lanes a3, td_lanes s, td_lanes *value,
                              td_lanes *slope) {
    td_lanes b2 = td_fma(a3, s, a2), b1 = td_fma(b2, s, a1);
    *value = td_fma(b1, s, a0);
    *slope = td_fma(td_fma(a3, s, b2), s, b1);
}

/* A splat's numbers on one curve, at the times of the lanes, and their slopes in s. */
TD_INLINE void td_point_numbers_together(TD_GLOBAL const td_real *curve, const td_real *way, td_point_eight *value,
                                         td_point_eight *slope) {
    td_lanes s = td_collect(way);
#define TD_POINT_SHARED(k, x)                                                                                              \
    td_point_cubic(td_splat(curve[k]), td_splat(curve[TD_PATH_NUMBERS + (k)]), td_splat(curve[2 * TD_PATH_NUMBERS + (k)]), \
                   td_splat(curve[3 * TD_PATH_NUMBERS + (k)]), s, &value->x, &slope->x)
    TD_POINT_SHARED(0, a), TD_POINT_SHARED(1, b), TD_POINT_SHARED(2, c), TD_POINT_SHARED(3, d);
    TD_POINT_SHARED(4, e), TD_POINT_SHARED(5, f), TD_POINT_SHARED(6, g), TD_POINT_SHARED(7, h);
}

/* A splat's numbers where each lane has its own curve, at curves + at[lane]. A curve's eight numbers are neighbours, so that
 * one vector loads them. Then values and slopes are transposed, two blocks, instead of the four coefficients. */
TD_INLINE void td_point_numbers_apart(TD_GLOBAL const td_real *curves, const int *at, const td_real *way, td_point_eight *value,
                                      td_point_eight *slope) {
#if TD_LANES > 1
    td_point_eight v, d;
#define TD_POINT_BLOCK(i, block) td_load_lanes(curves + TD_POINT_PLACE(at, i) + (block)*TD_PATH_NUMBERS)
#define TD_POINT_ROW(i, x)                                                                                 \
    td_point_cubic(TD_POINT_BLOCK(i, 0), TD_POINT_BLOCK(i, 1), TD_POINT_BLOCK(i, 2), TD_POINT_BLOCK(i, 3), \
                   td_splat(way[(i) % TD_LANES]), &v.x, &d.x)
    TD_POINT_ROW(0, a), TD_POINT_ROW(1, b), TD_POINT_ROW(2, c), TD_POINT_ROW(3, d);
    TD_POINT_ROW(4, e), TD_POINT_ROW(5, f), TD_POINT_ROW(6, g), TD_POINT_ROW(7, h);
    *value = td_point_turn(&v), *slope = td_point_turn(&d);
#else
    td_point_numbers_together(curves + at[0], way, value, slope);
#endif
}

/* -- what a point sees --------------------------------------------------------------------------------------------- */

/* Opacity with the fade at the near plane. */
TD_INLINE td_dual td_point_opacity(td_dual opacity, td_dual depth, const td_image *image) {
    if (!(image->near_full > image->near) || !td_any(depth.v < image->near_full))
        return opacity; /* no near plane within reach of this splat: the fade is 1 */
    td_real scale = 1 / (image->near_full - image->near);
    td_dual x = td_dual_clamp(td_dual_scale(td_dual_offset(depth, -image->near), scale), 0, 1);
    return td_dual_mul(opacity, td_dual_make(td_smootherstep(x.v), td_smootherstep_slope(x.v) * x.d));
}

/* Numerator and denominator of d^T Q d = ((c dx - b dy)^2 + det dy^2) / (c det), in sums of terms that aren't negative, and
 * parts of them. */
typedef struct td_point_form {
    td_lanes dx, dy, b, c, det, along, over, under;
} td_point_form;

TD_INLINE td_point_form td_point_forms(const td_point_eight *value, td_lanes x, td_lanes y) {
    td_point_form f;
    f.dx = x - td_point_pick(value, TD_P_U);
    f.dy = y - td_point_pick(value, TD_P_V);
    f.b = td_point_pick(value, TD_P_B);
    f.c = td_point_pick(value, TD_P_C);
    f.det = td_point_pick(value, TD_P_DET);
    f.along = td_fma(f.c, f.dx, -(f.b * f.dy));
    f.over = td_fma(f.along, f.along, f.det * (f.dy * f.dy));
    f.under = f.c * f.det;
    return f;
}

/* d^T Q d and its rate. inverse: 1 / denominator. */
TD_INLINE td_dual td_point_distance(const td_point_form *f, td_lanes inverse, const td_point_eight *slope) {
    td_lanes u = -td_point_pick(slope, TD_P_U), v = -td_point_pick(slope, TD_P_V), b = td_point_pick(slope, TD_P_B);
    td_lanes c = td_point_pick(slope, TD_P_C), det = td_point_pick(slope, TD_P_DET);
    td_lanes along = td_fma(c, f->dx, f->c * u) - td_fma(b, f->dy, f->b * v);
    td_lanes over = td_fma(2 * f->along, along, f->dy * td_fma(det, f->dy, 2 * f->det * v));
    td_lanes under = td_fma(c, f->det, f->c * det), distance = f->over * inverse;
    return td_dual_make(distance, td_fma(-distance, under, over) * inverse);
}

/* A splat as points see it, before the exponential (power, opacity, slope), and afterwards (alpha; then the light that it
 * takes: tau in hard order, optical depth in soft order). Later numbers are stored in the places of those that they are
 * computed from. */
enum { TD_V_POWER = 0, TD_V_OPACITY, TD_V_SLOPE, TD_V_LUMINANCE, TD_V_LUMINANCE_DOT, TD_V_DEPTH, TD_V_GROWTH };
enum { TD_V_GREEN = TD_E_GREEN, TD_V_GREEN_DOT, TD_V_BLUE, TD_V_BLUE_DOT };
enum { TD_V_ALPHA = TD_V_POWER, TD_V_ALPHA_DOT = TD_V_SLOPE, TD_V_TAKES = TD_V_OPACITY, TD_V_TAKES_DOT = TD_V_SLOPE };
typedef struct td_point_view {
    td_lanes power, opacity, slope; /* alpha = opacity 2^power, alpha_dot = slope 2^power */
    td_lanes luminance, luminance_dot, depth, growth;
} td_point_view;

/* The view of a splat with these numbers and slopes in s at the times of the lanes. rate: ds/dt. Splats that can't be seen
 * there get an opacity of 0. */
TD_INLINE td_point_view td_point_see(const td_image *image, const td_point_eight *value, const td_point_eight *slope,
                                     td_lanes rate, td_lanes x, td_lanes y) {
    td_point_view view;
    td_point_form form = td_point_forms(value, x, y);
    td_dual z = td_dual_make(td_point_pick(value, TD_P_DEPTH), td_point_pick(slope, TD_P_DEPTH));
    td_mask there = (form.det > 0.0f) & (form.c > 0.0f) & (z.v > image->near);
    td_lanes under = td_select(td_splat(1.0f), form.under, there), depth = td_select(td_splat(1.0f), z.v, there);
    td_lanes inverse = 1 / (under * depth); /* one division for two */
    td_dual distance = td_point_distance(&form, inverse * depth, slope);
    td_dual opacity = td_dual_make(td_point_pick(value, TD_P_OPACITY), td_point_pick(slope, TD_P_OPACITY));
    opacity = td_point_opacity(opacity, z, image);
    td_lanes power = distance.v * TD_REAL(-0.72134752044448170368); /* log2(e) / 2 */
    view.power = td_select(td_splat(-1000.0f), power, there);
    view.opacity = opacity.v;
    view.slope = td_fma(-0.5f * distance.d, opacity.v, opacity.d) * rate;
    td_dual light = td_dual_make(td_point_pick(value, TD_P_LUMINANCE), td_point_pick(slope, TD_P_LUMINANCE) * rate);
    if (td_paths_by_channels(image)) light = td_sh_floor(light, image->colour_floor); /* red, which curves don't clamp */
    view.luminance = light.v, view.luminance_dot = light.d;
    view.depth = td_select(td_splat(0.0f), z.v, there), view.growth = z.d * rate * (inverse * under);
    return view;
}

/* Replaces power and slope by alpha and its rate. Returns 1 where any lane may see the splat. */
TD_INLINE int td_point_rise(const td_image *image, TD_GLOBAL td_real *view) {
    td_lanes fall = td_exp2(td_load_lanes(view + TD_V_POWER * TD_LANES));
    td_lanes alpha = td_load_lanes(view + TD_V_OPACITY * TD_LANES) * fall;
    td_store_lanes(view + TD_V_ALPHA * TD_LANES, alpha);
    td_store_lanes(view + TD_V_ALPHA_DOT * TD_LANES, td_load_lanes(view + TD_V_SLOPE * TD_LANES) * fall);
    return td_any(alpha >= td_least_seen(image));
}

/* Writes the light that the splat takes. */
TD_INLINE void td_point_take(const td_image *image, TD_GLOBAL td_real *view) {
    td_lanes takes, takes_dot;
    td_mask above;
    td_cap_alpha(image, td_load_lanes(view + TD_V_ALPHA * TD_LANES), td_load_lanes(view + TD_V_ALPHA_DOT * TD_LANES), &takes,
                 &takes_dot, &above);
    if (td_soft_order(image)) td_optical_depth(takes, takes_dot, &takes, &takes_dot);
    td_store_lanes(view + TD_V_TAKES * TD_LANES, takes);
    td_store_lanes(view + TD_V_TAKES_DOT * TD_LANES, takes_dot);
}

/* A splat's entry, and the mask of the points that see it, of those `within` its pixels. Else the splat takes and adds nothing.
 */
TD_INLINE td_point_entry td_point_enter(const td_image *image, TD_GLOBAL const td_real *view, td_lanes end, td_mask within,
                                        td_mask *sees) {
    td_point_entry entry;
    td_lanes none = td_splat(0.0f);
    entry.depth = td_load_lanes(view + TD_V_DEPTH * TD_LANES), entry.growth = td_load_lanes(view + TD_V_GROWTH * TD_LANES);
    *sees = within & (td_load_lanes(view + TD_V_ALPHA * TD_LANES) >= td_least_seen(image)) & (entry.depth < end);
    entry.takes = td_select(none, td_load_lanes(view + TD_V_TAKES * TD_LANES), *sees);
    entry.takes_dot = td_select(none, td_load_lanes(view + TD_V_TAKES_DOT * TD_LANES), *sees);
    entry.luminance = td_select(none, td_load_lanes(view + TD_V_LUMINANCE * TD_LANES), *sees);
    entry.luminance_dot = td_select(none, td_load_lanes(view + TD_V_LUMINANCE_DOT * TD_LANES), *sees);
    entry.green = entry.green_dot = entry.blue = entry.blue_dot = none;
    if (!td_is_coded(image)) return entry;
    entry.green = td_select(none, td_load_lanes(view + TD_V_GREEN * TD_LANES), *sees);
    entry.green_dot = td_select(none, td_load_lanes(view + TD_V_GREEN_DOT * TD_LANES), *sees);
    entry.blue = td_select(none, td_load_lanes(view + TD_V_BLUE * TD_LANES), *sees);
    entry.blue_dot = td_select(none, td_load_lanes(view + TD_V_BLUE_DOT * TD_LANES), *sees);
    return entry;
}

TD_INLINE void td_point_store_view(const td_point_view *view, TD_GLOBAL td_real *to) {
    td_store_lanes(to + TD_V_POWER * TD_LANES, view->power);
    td_store_lanes(to + TD_V_OPACITY * TD_LANES, view->opacity);
    td_store_lanes(to + TD_V_SLOPE * TD_LANES, view->slope);
    td_store_lanes(to + TD_V_LUMINANCE * TD_LANES, view->luminance);
    td_store_lanes(to + TD_V_LUMINANCE_DOT * TD_LANES, view->luminance_dot);
    td_store_lanes(to + TD_V_DEPTH * TD_LANES, view->depth);
    td_store_lanes(to + TD_V_GROWTH * TD_LANES, view->growth);
}

/* A curve of green and blue beside a splat's curve at `curve`. */
TD_INLINE int td_point_beside_at(int curve) { return curve / (TD_CURVE_REALS / TD_BESIDE_REALS); }

/* Green and blue, not clamped yet. Where light is linear in colours, they are added to red, and the view has luminance. */
TD_INLINE void td_point_add_beside(const td_image *image, td_dual green, td_dual blue, TD_GLOBAL td_real *view) {
    const td_dual g = td_sh_floor(green, image->colour_floor), b = td_sh_floor(blue, image->colour_floor);
    if (!td_is_coded(image)) {
        td_dual red =
            td_dual_make(td_load_lanes(view + TD_V_LUMINANCE * TD_LANES), td_load_lanes(view + TD_V_LUMINANCE_DOT * TD_LANES));
        td_dual light = td_dual_plus(td_dual_scale(red, image->luminance[0]), image->luminance[1], g);
        light = td_dual_plus(light, image->luminance[2], b);
        td_store_lanes(view + TD_V_LUMINANCE * TD_LANES, light.v);
        td_store_lanes(view + TD_V_LUMINANCE_DOT * TD_LANES, light.d);
        return;
    }
    td_store_lanes(view + TD_V_GREEN * TD_LANES, g.v);
    td_store_lanes(view + TD_V_GREEN_DOT * TD_LANES, g.d);
    td_store_lanes(view + TD_V_BLUE * TD_LANES, b.v);
    td_store_lanes(view + TD_V_BLUE_DOT * TD_LANES, b.d);
}

/* Green and blue at the times of the lanes, on one curve for all (`together`), or on a curve each. */
TD_INLINE void td_point_see_beside(const td_image *image, TD_GLOBAL const td_real *beside, const int *curve, int together,
                                   td_lanes way, td_lanes rate, TD_GLOBAL td_real *view) {
    td_lanes green, green_slope, blue, blue_slope;
    if (together) {
        TD_GLOBAL const td_real *a = beside + td_point_beside_at(curve[0]);
        td_point_cubic(td_splat(a[0]), td_splat(a[2]), td_splat(a[4]), td_splat(a[6]), way, &green, &green_slope);
        td_point_cubic(td_splat(a[1]), td_splat(a[3]), td_splat(a[5]), td_splat(a[7]), way, &blue, &blue_slope);
    } else {
        int at[TD_LANES];
        for (int lane = 0; lane < TD_LANES; lane++) at[lane] = td_point_beside_at(curve[lane]);
        td_point_eight of = td_point_load_eight(beside, at);
        td_point_cubic(of.a, of.c, of.e, of.g, way, &green, &green_slope);
        td_point_cubic(of.b, of.d, of.f, of.h, way, &blue, &blue_slope);
    }
    td_point_add_beside(image, td_dual_make(green, green_slope * rate), td_dual_make(blue, blue_slope * rate), view);
}

/* -- a list -------------------------------------------------------------------------------------------------------- */

/* Points on their way down their tile's list: pixel centres; `taken`, the optical depth of all splats seen so far; `far`, the
 * depth of the farthest of them; `end`, the depth behind which nothing is seen; and the entries' order. */
typedef struct td_point_eye {
    td_lanes x, y, taken, far, end;
    td_point_order order;
} td_point_eye;

/* Optical depth behind which splats are dropped: they have 1e-14 of the light. Which splats are dropped depends on the splats
 * that the point sees, in the list's order, and on nothing else. */
#define TD_POINT_OPAQUE 32
#define TD_POINT_NEVER TD_REAL(1e30)

/* The points whose pixels may see the splat of a place. A splat has a path if a point of one of these pixels was requested
 * (lib/render/point_wanted.c). Points of other pixels don't see it: otherwise their values would depend on which points were
 * requested before. */
TD_INLINE td_mask td_point_within(TD_GLOBAL const int *place, const td_point_eye *eye) {
    const int columns = place[TD_L_COLUMNS], rows = place[TD_L_ROWS];
    return (eye->x > (td_real)(columns % TD_SIGHT_END)) & (eye->x < (td_real)(columns / TD_SIGHT_END)) &
           (eye->y > (td_real)(rows % TD_SIGHT_END)) & (eye->y < (td_real)(rows / TD_SIGHT_END));
}

/* The depth behind which nothing is seen, over that of the farthest splat that takes light; 0: soft order has no end. */
TD_INLINE td_real td_point_beyond(const td_image *image) {
    const td_real reach = td_soft_order(image) ? (td_real)(0.5f * TD_SOFT_REACH) * image->soft_depth : 0; /* td_is_near */
    return reach < 1 ? TD_REAL(1.000001) * (1 + reach) / (1 - reach) : 0;
}

/* Takes note of what is seen of a splat. */
TD_INLINE void td_point_note(const td_image *image, const td_point_entry *entry, td_mask sees, td_point_eye *eye) {
    const td_real beyond = td_point_beyond(image);
    eye->taken = eye->taken + entry->takes;
    eye->far = td_select(eye->far, entry->depth, sees & (entry->depth > eye->far));
    td_mask opaque = (eye->taken >= (td_real)TD_POINT_OPAQUE) & (eye->end >= TD_POINT_NEVER);
    if (beyond > 0) eye->end = td_select(eye->end, eye->far * beyond, opaque);
}

/* Splats that are handled together, in several short loops. In one loop each splat would wait for its own chain of operations,
 * which is longer than the processor's reorder window (1.3 times slower). */
enum { TD_POINT_BATCH = 64 };

/* Makes entries of the splats at places[found[i]]. Their views are stored where entries will be; there are no more entries
 * than views. */
TD_INLINE void td_point_look(const td_point_paths *paths, const td_image *image, TD_GLOBAL const int *places, const int *found,
                             int count, const td_real *way, const td_real *rate, const int *curve, const int *together,
                             TD_GLOBAL td_real *entries, td_point_eye *eye) {
    const int room = td_point_room(image);
    TD_GLOBAL td_real *views = entries + eye->order.count * room;
    int above[TD_POINT_BATCH], seen = 0;
    for (int i = 0; i < count; i++) {
        const int path = places[found[i] + TD_L_PATH], level = path & (TD_PATH_LEVELS - 1), lanes = level * TD_LANES;
        TD_GLOBAL const td_real *own = paths->curves + path / TD_PATH_LEVELS * TD_CURVE_REALS;
        td_point_eight value, slope;
        if (together[level])
            td_point_numbers_together(own + curve[lanes], way + lanes, &value, &slope);
        else
            td_point_numbers_apart(own, curve + lanes, way + lanes, &value, &slope);
        td_point_view view = td_point_see(image, &value, &slope, td_collect(rate + lanes), eye->x, eye->y);
        td_point_store_view(&view, views + i * room);
        if (td_paths_by_channels(image))
            td_point_see_beside(image, paths->beside + path / TD_PATH_LEVELS * TD_BESIDE_REALS, curve + lanes, together[level],
                                td_collect(way + lanes), td_collect(rate + lanes), views + i * room);
    }
    for (int i = 0; i < count; i++) {
        above[seen] = i;
        seen += td_point_rise(image, views + i * room);
    }
    for (int k = 0; k < seen; k++) td_point_take(image, views + above[k] * room);
    for (int k = 0; k < seen; k++) {
        TD_GLOBAL const int *place = places + found[above[k]];
        td_mask sees;
        td_point_entry entry = td_point_enter(image, views + above[k] * room, eye->end, td_point_within(place, eye), &sees);
        if (!td_any(sees)) continue;
        entry.number = td_splat((td_real)place[TD_L_NUMBER]);
        td_point_note(image, &entry, sees, eye);
        td_point_add(image, entries, &entry, &eye->order);
    }
}

#endif
