/* The splats that a point sees (points.h), TD_LANES of them at a time: each on its curve at the point's time, what the point
 * sees of it, and how that is kept until all are known. */
#ifndef TD_POINT_SPLATS_H
#define TD_POINT_SPLATS_H

#include "compositing.h"
#include "point_tests.h"
#include "soft_order.h"

/* -- curves at a time ---------------------------------------------------------------------------------------------- */

/* Where a time is on the curves of each level: which one of a splat's it is, s on it, and s by time. Arrays of the work-item's
 * own, since splats have levels of their own. */
TD_INLINE void td_point_weights(td_real s, td_real h, int piece, td_real way[TD_PATH_LEVELS], td_real rate[TD_PATH_LEVELS],
                                int number[TD_PATH_LEVELS]) {
    for (int level = 0; level < TD_PATH_LEVELS; level++) {
        int parts = 1 << level, part = (int)(s * (td_real)parts);
        part = part < parts - 1 ? part : parts - 1;
        way[level] = s * (td_real)parts - (td_real)part;
        rate[level] = (td_real)parts / h;
        number[level] = (piece << level) + part;
    }
}

/* Splats found, one after the other: paths, where each one's curve is, s on it, and s by time. */
typedef struct td_point_found {
    TD_GLOBAL int *path, *curve;
    TD_GLOBAL td_real *way, *rate;
} td_point_found;

/* A cubic and its slope in s, by Horner's rule. */
TD_INLINE void td_point_cubic(td_lanes a0, td_lanes a1, td_lanes a2, td_lanes a3, td_lanes s, td_lanes *value,
                              td_lanes *slope) {
    td_lanes b2 = td_fma(a3, s, a2), b1 = td_fma(b2, s, a1);
    *value = td_fma(b1, s, a0);
    *slope = td_fma(td_fma(a3, s, b2), s, b1);
}

/* The numbers of TD_LANES splats from number i on, and their slopes in s. A curve's eight numbers lie side by side, so that a
 * vector takes them all: two blocks are turned over, where turning the coefficients would be four. */
TD_INLINE void td_point_numbers(TD_GLOBAL const td_real *curves, const td_point_found *found, int i, td_point_eight *value,
                                td_point_eight *slope) {
    TD_GLOBAL const int *at = found->curve + i;
#if TD_LANES == 8
    td_point_eight v, d;
#define TD_POINT_BLOCK(lane, block) td_load_lanes(curves + at[lane] + (block)*TD_PATH_NUMBERS)
#define TD_POINT_ROW(lane, x)                                                                                          \
    td_point_cubic(TD_POINT_BLOCK(lane, 0), TD_POINT_BLOCK(lane, 1), TD_POINT_BLOCK(lane, 2), TD_POINT_BLOCK(lane, 3), \
                   td_splat(found->way[i + (lane)]), &v.x, &d.x)
    TD_POINT_ROW(0, a), TD_POINT_ROW(1, b), TD_POINT_ROW(2, c), TD_POINT_ROW(3, d);
    TD_POINT_ROW(4, e), TD_POINT_ROW(5, f), TD_POINT_ROW(6, g), TD_POINT_ROW(7, h);
    *value = td_point_turn(&v), *slope = td_point_turn(&d);
#else
    td_lanes s = td_load_lanes(found->way + i);
#define TD_POINT_TERM(block, k) TD_POINT_EACH(curves, at, (block)*TD_PATH_NUMBERS + (k))
#define TD_POINT_NUMBER(k, x) \
    td_point_cubic(TD_POINT_TERM(0, k), TD_POINT_TERM(1, k), TD_POINT_TERM(2, k), TD_POINT_TERM(3, k), s, &value->x, &slope->x)
    TD_POINT_NUMBER(0, a), TD_POINT_NUMBER(1, b), TD_POINT_NUMBER(2, c), TD_POINT_NUMBER(3, d);
    TD_POINT_NUMBER(4, e), TD_POINT_NUMBER(5, f), TD_POINT_NUMBER(6, g), TD_POINT_NUMBER(7, h);
#endif
}

/* -- what a point sees --------------------------------------------------------------------------------------------- */

/* Opacity with the fade at the near plane. */
TD_INLINE td_dual td_point_opacity(td_dual opacity, td_dual depth, const td_image *image) {
    if (!(image->near_full > image->near) || !td_any(depth.v < image->near_full))
        return opacity; /* the fade is 1 from there on */
    td_real scale = 1 / (image->near_full - image->near);
    td_dual x = td_dual_clamp(td_dual_scale(td_dual_offset(depth, -image->near), scale), 0, 1);
    return td_dual_mul(opacity, td_dual_make(td_smootherstep(x.v), td_smootherstep_slope(x.v) * x.d));
}

/* Numerator and denominator of d^T Q d = ((c dx - b dy)^2 + det dy^2) / (c det), in sums of what isn't negative; and parts. */
typedef struct td_point_form {
    td_lanes dx, dy, b, c, det, along, over, under;
} td_point_form;

TD_INLINE td_point_form td_point_forms(const td_point_eight *value, td_real x, td_real y) {
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

/* d^T Q d and its rate; inverse: 1 / under. */
TD_INLINE td_dual td_point_distance(const td_point_form *f, td_lanes inverse, const td_point_eight *slope) {
    td_lanes u = -td_point_pick(slope, TD_P_U), v = -td_point_pick(slope, TD_P_V), b = td_point_pick(slope, TD_P_B);
    td_lanes c = td_point_pick(slope, TD_P_C), det = td_point_pick(slope, TD_P_DET);
    td_lanes along = td_fma(c, f->dx, f->c * u) - td_fma(b, f->dy, f->b * v);
    td_lanes over = td_fma(2 * f->along, along, f->dy * td_fma(det, f->dy, 2 * f->det * v));
    td_lanes under = td_fma(c, f->det, f->c * det), distance = f->over * inverse;
    return td_dual_make(distance, td_fma(-distance, under, over) * inverse);
}

/* A splat as a point looks at it, before and after the exponential: both of as many reals as the widest vector has. Growth:
 * depth_dot / depth. */
enum {
    TD_V_POWER = 0,
    TD_V_OPACITY,
    TD_V_SLOPE,
    TD_V_LUMINANCE,
    TD_V_LUMINANCE_DOT,
    TD_V_DEPTH,
    TD_V_GROWTH,
    TD_POINT_VIEW = 8
};
typedef struct td_point_view {
    td_lanes power, opacity, slope; /* alpha = opacity 2^power, alpha_dot = slope 2^power; */
    td_lanes luminance, luminance_dot, depth, growth;
} td_point_view;

/* What it takes of the light: tau in hard order, the optical depth in soft order. */
enum { TD_E_TAKES = 0, TD_E_TAKES_DOT, TD_E_LUMINANCE, TD_E_LUMINANCE_DOT, TD_E_DEPTH, TD_E_GROWTH, TD_POINT_ENTRY = 8 };
typedef struct td_point_entry {
    td_lanes takes, takes_dot, luminance, luminance_dot, depth, growth;
} td_point_entry;

/* TD_LANES splats with these numbers, whose slopes are in s; rate: s by time. Nothing comes of what can't be seen there. */
TD_INLINE td_point_view td_point_see(const td_image *image, const td_point_eight *value, const td_point_eight *slope,
                                     td_lanes rate, td_real x, td_real y) {
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
    view.luminance = td_point_pick(value, TD_P_LUMINANCE), view.luminance_dot = td_point_pick(slope, TD_P_LUMINANCE) * rate;
    view.depth = z.v, view.growth = z.d * rate * (inverse * under);
    return view;
}

/* What it is to the light; depth is TD_POINT_NEVER where it's below the cut. */
#define TD_POINT_NEVER TD_REAL(1e30)
TD_INLINE td_point_entry td_point_enter(const td_image *image, const td_point_view *view) {
    td_point_entry entry;
    td_real cut = image->cut_rule == TD_CUT_NONE ? TD_REAL(1e-30) : image->cut;
    td_lanes fall = td_exp2(view->power), alpha = view->opacity * fall;
    td_mask sees;
    td_cap_alpha(image, alpha, view->slope * fall, &entry.takes, &entry.takes_dot, &sees);
    if (image->soft_order) td_optical_depth(entry.takes, entry.takes_dot, &entry.takes, &entry.takes_dot);
    entry.luminance = view->luminance, entry.luminance_dot = view->luminance_dot;
    entry.depth = td_select(td_splat(TD_POINT_NEVER), view->depth, alpha >= cut);
    entry.growth = view->growth;
    return entry;
}

/* -- a point's list ------------------------------------------------------------------------------------------------ */

/* Splats that are looked at together, in loops of their own: one that did all would wait for its own chain of operations, which
 * is longer than a processor looks ahead (1.3 times slower). */
enum { TD_POINT_BATCH = 64 };

/* A work-item's own room: for each lane's point `rows` entries, the first of them of nothing, and their numbers front to back,
 * [place][lane]; steps of the light (point_light.h); and of the point that is looked at, a batch of views, what was found, and
 * depths front to back. */
typedef struct td_point_room {
    TD_GLOBAL td_real *entries; /* (TD_LANES x rows x TD_POINT_ENTRY) */
    TD_GLOBAL td_real *steps;   /* (rows x TD_POINT_STEP x TD_LANES) */
    TD_GLOBAL td_real *depth;   /* (rows) */
    TD_GLOBAL int *order;       /* (rows x TD_LANES) */
    td_point_found found;       /* (rows) */
    int rows;                   /* of the longest list, and 1 + TD_POINT_BATCH: a batch of views is where steps will be */
} td_point_room;

/* Reals and ints of a row, in two blocks. */
enum {
    TD_POINT_STEP = 8,
    TD_POINT_ROW_REALS = TD_LANES * (TD_POINT_ENTRY + TD_POINT_STEP) + 3,
    TD_POINT_ROW_INTS = TD_LANES + 2
};
TD_INLINE td_point_room td_point_room_at(TD_GLOBAL td_real *reals, TD_GLOBAL int *ints, int rows) {
    td_point_room room;
    room.entries = reals;
    room.steps = reals + rows * (TD_LANES * TD_POINT_ENTRY);
    room.depth = room.steps + rows * (TD_LANES * TD_POINT_STEP);
    room.found.way = room.depth + rows;
    room.found.rate = room.found.way + rows;
    room.order = ints;
    room.found.path = ints + rows * TD_LANES;
    room.found.curve = room.found.path + rows;
    room.rows = rows;
    return room;
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

TD_INLINE td_point_view td_point_load_view(TD_GLOBAL const td_real *from) {
    td_point_view view;
    view.power = td_load_lanes(from + TD_V_POWER * TD_LANES);
    view.opacity = td_load_lanes(from + TD_V_OPACITY * TD_LANES);
    view.slope = td_load_lanes(from + TD_V_SLOPE * TD_LANES);
    view.luminance = td_load_lanes(from + TD_V_LUMINANCE * TD_LANES);
    view.luminance_dot = td_load_lanes(from + TD_V_LUMINANCE_DOT * TD_LANES);
    view.depth = td_load_lanes(from + TD_V_DEPTH * TD_LANES);
    view.growth = td_load_lanes(from + TD_V_GROWTH * TD_LANES);
    return view;
}

/* Splats by splat, each an entry: transposed, since gathers and scatters of a processor cost more (transpose.h). */
TD_INLINE void td_point_store(const td_point_entry *made, TD_GLOBAL td_real *to) {
    td_point_entry e = *made;
#if TD_LANES == 8
    td_lanes none = td_splat(0.0f);
    td_point_eight all = {e.takes, e.takes_dot, e.luminance, e.luminance_dot, e.depth, e.growth, none, none};
    td_point_eight x = td_point_turn(&all);
    td_store_lanes(to, x.a), td_store_lanes(to + 8, x.b), td_store_lanes(to + 16, x.c), td_store_lanes(to + 24, x.d);
    td_store_lanes(to + 32, x.e), td_store_lanes(to + 40, x.f), td_store_lanes(to + 48, x.g), td_store_lanes(to + 56, x.h);
#else
    td_scatter(to, TD_POINT_ENTRY, TD_E_TAKES, e.takes), td_scatter(to, TD_POINT_ENTRY, TD_E_TAKES_DOT, e.takes_dot);
    td_scatter(to, TD_POINT_ENTRY, TD_E_LUMINANCE, e.luminance);
    td_scatter(to, TD_POINT_ENTRY, TD_E_LUMINANCE_DOT, e.luminance_dot);
    td_scatter(to, TD_POINT_ENTRY, TD_E_DEPTH, e.depth), td_scatter(to, TD_POINT_ENTRY, TD_E_GROWTH, e.growth);
#endif
}

/* The entries `number` of the lanes. */
TD_INLINE td_point_entry td_point_fetch(const td_point_room *room, TD_GLOBAL const int *number) {
    int at[TD_LANES];
    for (int lane = 0; lane < TD_LANES; lane++) at[lane] = (lane * room->rows + number[lane]) * TD_POINT_ENTRY;
    td_point_eight x = td_point_load_eight(room->entries, at);
    td_point_entry e = {x.a, x.b, x.c, x.d, x.e, x.f};
    return e;
}

/* Puts entry `number`, at depth z, in its place among `count`: mostly the last. At equal depth, paths decide (td_point_lists).
 */
TD_INLINE void td_point_insert(const td_point_room *room, int lane, int count, int number, td_real z) {
    TD_GLOBAL td_real *depth = room->depth;
    TD_GLOBAL int *order = room->order + lane, *path = room->found.path - 1; /* entries are counted from 1 */
    int i = count;
    for (; i > 0 && (depth[i - 1] > z || (depth[i - 1] == z && path[order[(i - 1) * TD_LANES]] > path[number])); i--)
        depth[i] = depth[i - 1], order[i * TD_LANES] = order[(i - 1) * TD_LANES];
    depth[i] = z;
    order[i * TD_LANES] = number;
}

/* A point on its way down its tile's list: where it is, splats seen; what they take in all, at least, as an optical depth; how
 * far the farthest of them was; and the depth from which on nothing is seen any more. */
typedef struct td_point_eye {
    td_real x, y;
    int seen;
    td_real taken, far, end;
} td_point_eye;

/* Optical depth behind which nothing is seen: 1e-14 of it. What is dropped is told by what the point sees, in the list's order,
 * and by nothing else. */
#define TD_POINT_OPAQUE 32

/* Takes entry `number`, at depth z. */
TD_INLINE void td_point_take(const td_image *image, const td_point_room *room, int lane, int number, td_real z, td_real takes,
                             td_point_eye *eye) {
    if (z >= eye->end) return;
    td_point_insert(room, lane, eye->seen++, number, z);
    eye->taken += takes;
    eye->far = z > eye->far ? z : eye->far;
    if (eye->taken < TD_POINT_OPAQUE || eye->end < TD_POINT_NEVER) return;
    td_real reach = image->soft_order ? (td_real)(0.5f * TD_SOFT_REACH) * image->soft_depth : 0; /* td_is_near */
    if (reach < 1) eye->end = eye->far * (TD_REAL(1.000001) * (1 + reach) / (1 - reach));
}

/* Enters `count` of the splats found, TD_POINT_BATCH at most, from number `from` on, as what the point of a lane sees. */
TD_INLINE void td_point_look(TD_GLOBAL const td_real *curves, const td_image *image, const td_point_room *room, int lane,
                             int from, int count, td_point_eye *eye) {
    TD_GLOBAL td_real *entries = room->entries + (lane * room->rows + 1 + from) * TD_POINT_ENTRY;
    for (int k = from + count; k < from + count + TD_LANES - 1; k++) { /* anyone, where the last turn has too many */
        room->found.curve[k] = room->found.curve[from];
        room->found.way[k] = room->found.rate[k] = 0;
    }
    for (int i = 0; i < count; i += TD_LANES) {
        td_point_eight value, slope;
        td_point_numbers(curves, &room->found, from + i, &value, &slope);
        td_point_view view = td_point_see(image, &value, &slope, td_load_lanes(room->found.rate + from + i), eye->x, eye->y);
        td_point_store_view(&view, room->steps + i * TD_POINT_VIEW);
    }
    for (int i = 0; i < count; i += TD_LANES) {
        td_point_view view = td_point_load_view(room->steps + i * TD_POINT_VIEW);
        td_point_entry entry = td_point_enter(image, &view);
        td_point_store(&entry, entries + i * TD_POINT_ENTRY);
    }
    for (int k = 0; k < count; k++) {
        TD_GLOBAL const td_real *entry = entries + k * TD_POINT_ENTRY;
        td_point_take(image, room, lane, 1 + from + k, entry[TD_E_DEPTH], entry[TD_E_TAKES], eye);
    }
}

#endif
