/* A splat at single pixels at single times (points.h), TD_LANES of them: on its curve, what each sees of it, and how that is
 * kept until all are known. */
#ifndef TD_POINT_SPLATS_H
#define TD_POINT_SPLATS_H

#include "compositing.h"
#include "point_lists.h"

/* -- splats at points ---------------------------------------------------------------------------------------------- */

/* TD_LANES points. */
typedef struct td_point_lanes {
    td_lanes x, y, s, h;
    td_index piece, block; /* block: a bit of the sixteen */
} td_point_lanes;

TD_INLINE td_point_lanes td_point_load(const td_point_arrays *points, const td_point_tile *tile, int first) {
    td_point_lanes at;
    at.x = td_load_lanes(points->x + first);
    at.y = td_load_lanes(points->y + first);
    at.s = td_load_lanes(points->s + first);
    at.h = td_load_lanes(points->h + first);
    at.piece = td_load_ints(points->piece + first);
    at.block = at.piece & 0;
    for (int i = 0; i < 16; i++) {
        td_real x = (td_real)(tile->x + 4 * (i & 3)), y = (td_real)(tile->y + 4 * (i >> 2));
        at.block |= td_mask_bit((at.x > x) & (at.x < x + 4) & (at.y > y) & (at.y < y + 4), 1 << i);
    }
    return at;
}

/* Powers of s on the curves of a level at the points' times, and their rates. */
typedef struct td_point_powers {
    td_lanes s, s2, s3, rate, rate2, rate3;
} td_point_powers;

/* The same, and which of a splat's curves it is. */
TD_INLINE td_point_powers td_point_weights(const td_point_lanes *at, int level, td_index *curve) {
    td_point_powers powers;
    td_lanes parts = td_splat((td_real)(1 << level)), way = at->s * parts, part = td_splat(0.0f);
    td_index number = at->piece << level;
    for (int k = 1; k < 1 << level; k++) { /* levels are few, and mostly 0 */
        td_mask behind = way >= (td_real)k;
        number += td_mask_bit(behind, 1);
        part = td_select(part, td_splat((td_real)k), behind);
    }
    powers.s = way - part;
    powers.s2 = powers.s * powers.s;
    powers.s3 = powers.s2 * powers.s;
    powers.rate = parts / at->h;
    powers.rate2 = 2 * powers.s * powers.rate;
    powers.rate3 = 3 * powers.s2 * powers.rate;
    *curve = number;
    return powers;
}

#if TD_LANES == 8
/* Eight vectors of eight: td_transpose without arrays, which would stay in memory (layout.h). */
typedef struct td_point_eight {
    td_lanes a, b, c, d, e, f, g, h;
} td_point_eight;

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

/* Eight reals at each of eight places, a vector of the first, of the second, ... */
TD_INLINE td_point_eight td_point_load_eight(TD_GLOBAL const td_real *array, const int at[8], int offset) {
    td_point_eight x;
    x.a = td_load_lanes(array + at[0] + offset), x.b = td_load_lanes(array + at[1] + offset);
    x.c = td_load_lanes(array + at[2] + offset), x.d = td_load_lanes(array + at[3] + offset);
    x.e = td_load_lanes(array + at[4] + offset), x.f = td_load_lanes(array + at[5] + offset);
    x.g = td_load_lanes(array + at[6] + offset), x.h = td_load_lanes(array + at[7] + offset);
    return td_point_turn(&x);
}

/* Vector k, which is known where it's compiled. */
TD_INLINE td_lanes td_point_pick(const td_point_eight *x, int k) {
    if (k < 4) return k < 2 ? (k == 0 ? x->a : x->b) : (k == 2 ? x->c : x->d);
    return k < 6 ? (k == 4 ? x->e : x->f) : (k == 6 ? x->g : x->h);
}
#endif

/* The curves that points are on, of one splat: the same for all, either of two neighbours, or anyone's own. Which it is is
 * known where it's compiled. */
enum { TD_CURVE_SHARED = 0, TD_CURVE_PAIR, TD_CURVE_APART };
typedef struct td_point_curves {
    TD_GLOBAL const td_real *curves, *first; /* the splat's; of those that the points are on, the first */
    td_index curve;
    td_mask second; /* PAIR: on the one after it */
#if TD_LANES == 8
    td_point_eight terms[4]; /* APART: a0 .. a3 */
#endif
} td_point_curves;

TD_INLINE void td_point_part(td_point_curves *on) {
    (void)on;
#if TD_LANES == 8
    int at[TD_LANES];
    td_index_lanes(on->curve * TD_CURVE_REALS, at);
    on->terms[0] = td_point_load_eight(on->curves, at, 0);
    on->terms[1] = td_point_load_eight(on->curves, at, TD_PATH_NUMBERS);
    on->terms[2] = td_point_load_eight(on->curves, at, 2 * TD_PATH_NUMBERS);
    on->terms[3] = td_point_load_eight(on->curves, at, 3 * TD_PATH_NUMBERS);
#endif
}

/* Coefficient k of TD_CURVE_REALS; APART: after td_point_part. */
TD_INLINE td_lanes td_point_term(const td_point_curves *on, int kind, int k) {
    if (kind == TD_CURVE_SHARED) return td_splat(on->first[k]);
    if (kind == TD_CURVE_PAIR) return td_select(td_splat(on->first[k]), td_splat(on->first[TD_CURVE_REALS + k]), on->second);
#if TD_LANES == 8
    return td_point_pick(&on->terms[k / TD_PATH_NUMBERS], k % TD_PATH_NUMBERS);
#else
    return td_gather(on->curves, on->curve * TD_CURVE_REALS + k);
#endif
}
TD_INLINE td_lanes td_point_value(const td_point_curves *on, int kind, const td_point_powers *powers, int k) {
    td_lanes sum = td_fma(td_point_term(on, kind, TD_PATH_NUMBERS + k), powers->s, td_point_term(on, kind, k));
    sum = td_fma(td_point_term(on, kind, 2 * TD_PATH_NUMBERS + k), powers->s2, sum);
    return td_fma(td_point_term(on, kind, 3 * TD_PATH_NUMBERS + k), powers->s3, sum);
}
TD_INLINE td_lanes td_point_rate(const td_point_curves *on, int kind, const td_point_powers *powers, int k) {
    td_lanes sum = td_point_term(on, kind, TD_PATH_NUMBERS + k) * powers->rate;
    sum = td_fma(td_point_term(on, kind, 2 * TD_PATH_NUMBERS + k), powers->rate2, sum);
    return td_fma(td_point_term(on, kind, 3 * TD_PATH_NUMBERS + k), powers->rate3, sum);
}
TD_INLINE td_dual td_point_number(const td_point_curves *on, int kind, const td_point_powers *powers, int k) {
    return td_dual_make(td_point_value(on, kind, powers, k), td_point_rate(on, kind, powers, k));
}

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

TD_INLINE td_point_form td_point_forms(const td_point_curves *on, int kind, const td_point_powers *powers,
                                       const td_point_lanes *at) {
    td_point_form f;
    f.dx = at->x - td_point_value(on, kind, powers, TD_P_U);
    f.dy = at->y - td_point_value(on, kind, powers, TD_P_V);
    f.b = td_point_value(on, kind, powers, TD_P_B);
    f.c = td_point_value(on, kind, powers, TD_P_C);
    f.det = td_point_value(on, kind, powers, TD_P_DET);
    f.along = td_fma(f.c, f.dx, -(f.b * f.dy));
    f.over = td_fma(f.along, f.along, f.det * (f.dy * f.dy));
    f.under = f.c * f.det;
    return f;
}

/* d^T Q d and its rate; inverse: 1 / under. */
TD_INLINE td_dual td_point_distance(const td_point_form *f, td_lanes inverse, const td_point_curves *on, int kind,
                                    const td_point_powers *powers) {
    td_lanes u = -td_point_rate(on, kind, powers, TD_P_U), v = -td_point_rate(on, kind, powers, TD_P_V);
    td_lanes b = td_point_rate(on, kind, powers, TD_P_B), c = td_point_rate(on, kind, powers, TD_P_C);
    td_lanes det = td_point_rate(on, kind, powers, TD_P_DET);
    td_lanes along = td_fma(c, f->dx, f->c * u) - td_fma(b, f->dy, f->b * v);
    td_lanes over = td_fma(2 * f->along, along, f->dy * td_fma(det, f->dy, 2 * f->det * v));
    td_lanes under = td_fma(c, f->det, f->c * det), distance = f->over * inverse;
    return td_dual_make(distance, td_fma(-distance, under, over) * inverse);
}

/* -- what points see ----------------------------------------------------------------------------------------------- */

/* A splat at a point: of as many reals as the widest vector has. */
enum { TD_E_TAU = 0, TD_E_TAU_DOT, TD_E_LUMINANCE, TD_E_LUMINANCE_DOT, TD_E_DEPTH, TD_E_GROWTH, TD_POINT_ENTRY = 8 };

typedef struct td_point_entry {
    td_lanes tau, tau_dot, luminance, luminance_dot, depth, growth; /* growth: depth_dot / depth */
} td_point_entry;

/* A work-item's own room, for the longest list: entries [splat][lane][TD_POINT_ENTRY], the last of them of nothing; per lane an
 * order of its own [place][lane], of numbers of entries; splats found. */
typedef struct td_point_room {
    TD_GLOBAL td_real *entries; /* ((room + 1) x TD_LANES x TD_POINT_ENTRY) */
    TD_GLOBAL int *order;       /* ((room + 1) x TD_LANES) */
    TD_GLOBAL int *found;       /* (room + 1) places in the tile's list */
} td_point_room;

/* Splats of the tile that reach one of the blocks: returns how many. */
TD_INLINE int td_point_find(const td_point_lists *lists, const td_point_tile *tile, int blocks, const td_point_room *room) {
    int count = 0;
    for (int i = tile->first; i < tile->first + tile->count; i++) {
        room->found[count] = i;
        count += (lists->blocks[i] & blocks) != 0;
    }
    return count;
}

/* Lanes one by one, each an entry: transposed, since gathers and scatters of a processor cost more (transpose.h). */
TD_INLINE void td_point_store(const td_point_entry *made, int number, const td_point_room *room) {
    TD_GLOBAL td_real *to = room->entries + number * (TD_POINT_ENTRY * TD_LANES);
    td_point_entry e = *made;
#if TD_LANES == 8
    td_lanes none = td_splat(0.0f);
    td_point_eight all = {e.tau, e.tau_dot, e.luminance, e.luminance_dot, e.depth, e.growth, none, none};
    td_point_eight x = td_point_turn(&all);
    td_store_lanes(to, x.a), td_store_lanes(to + 8, x.b), td_store_lanes(to + 16, x.c), td_store_lanes(to + 24, x.d);
    td_store_lanes(to + 32, x.e), td_store_lanes(to + 40, x.f), td_store_lanes(to + 48, x.g), td_store_lanes(to + 56, x.h);
#else
    td_scatter(to, TD_POINT_ENTRY, TD_E_TAU, e.tau), td_scatter(to, TD_POINT_ENTRY, TD_E_TAU_DOT, e.tau_dot);
    td_scatter(to, TD_POINT_ENTRY, TD_E_LUMINANCE, e.luminance);
    td_scatter(to, TD_POINT_ENTRY, TD_E_LUMINANCE_DOT, e.luminance_dot);
    td_scatter(to, TD_POINT_ENTRY, TD_E_DEPTH, e.depth), td_scatter(to, TD_POINT_ENTRY, TD_E_GROWTH, e.growth);
#endif
}

/* Entries number[lane]. */
TD_INLINE td_point_entry td_point_fetch(const td_point_room *room, TD_GLOBAL const int *number) {
    td_point_entry e;
#if TD_LANES == 8
    int at[8];
    td_index_lanes((td_load_ints(number) * 8 + td_count_from(0)) * TD_POINT_ENTRY, at);
    td_point_eight x = td_point_load_eight(room->entries, at, 0);
    e.tau = x.a, e.tau_dot = x.b, e.luminance = x.c, e.luminance_dot = x.d, e.depth = x.e, e.growth = x.f;
#else
    td_index at = (td_load_ints(number) * TD_LANES + td_count_from(0)) * TD_POINT_ENTRY;
    e.tau = td_gather(room->entries, at + TD_E_TAU), e.tau_dot = td_gather(room->entries, at + TD_E_TAU_DOT);
    e.luminance = td_gather(room->entries, at + TD_E_LUMINANCE);
    e.luminance_dot = td_gather(room->entries, at + TD_E_LUMINANCE_DOT);
    e.depth = td_gather(room->entries, at + TD_E_DEPTH), e.growth = td_gather(room->entries, at + TD_E_GROWTH);
#endif
    return e;
}

/* Makes entry `number` of a splat, at place i of the tile's list: 0 where it's seen from none of the points; else where it is,
 * and its depth there. */
TD_INLINE int td_point_enter(const td_point_curves *on, int kind, const td_point_powers *powers, const td_image *image,
                             const td_point_lanes *at, const td_point_lists *lists, int i, int number,
                             const td_point_room *room, td_mask *seen, td_lanes *depth) {
    td_lanes tau, tau_dot;
    td_point_form form = td_point_forms(on, kind, powers, at);
    td_mask inside = (form.over <= lists->power[i] * form.under) & (form.det > 0.0f) & (form.c > 0.0f);
    inside = inside & ((at->block & lists->blocks[i]) != 0);
    if (!td_any(inside)) return 0;
    td_dual z = td_point_number(on, kind, powers, TD_P_DEPTH);
    inside = inside & (z.v > image->near);
    td_lanes under = td_select(td_splat(1.0f), form.under, inside), depth_there = td_select(td_splat(1.0f), z.v, inside);
    td_lanes inverse = 1 / (under * depth_there); /* one division for two */
    td_dual distance = td_point_distance(&form, inverse * depth_there, on, kind, powers);
    td_dual opacity = td_point_opacity(td_point_number(on, kind, powers, TD_P_OPACITY), z, image);
    td_lanes fall = td_exp2(distance.v * TD_REAL(-0.72134752044448170368)); /* log2(e) / 2 */
    td_cap_alpha(image, opacity.v * fall, fall * td_fma(-0.5f * distance.d, opacity.v, opacity.d), &tau, &tau_dot, seen);
    *seen = *seen & inside;
    *depth = z.v;
    td_point_entry entry;
    entry.tau = tau, entry.tau_dot = tau_dot;
    entry.luminance = td_point_value(on, kind, powers, TD_P_LUMINANCE);
    entry.luminance_dot = td_point_rate(on, kind, powers, TD_P_LUMINANCE);
    entry.depth = z.v, entry.growth = z.d * (inverse * under);
    td_point_store(&entry, number, room);
    return 1;
}

/* The entry of nothing. */
TD_INLINE void td_point_enter_nothing(int number, const td_point_room *room) {
    for (int k = 0; k < TD_POINT_ENTRY * TD_LANES; k++) room->entries[number * (TD_POINT_ENTRY * TD_LANES) + k] = 0;
}

#endif
