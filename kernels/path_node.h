/* Rows of record paths: projects Gaussians at nodes, measures by how much the cubic through two rows misses a row in the
 * middle, and makes twice as many rows where cubics are accurate enough. */
#ifndef TD_PATH_NODE_H
#define TD_PATH_NODE_H

#include "path.h"
#include "record.h"

/* Where rows are stored. */
typedef struct td_node_sink {
    TD_GLOBAL td_real *rows;
    TD_GLOBAL td_real *beside; /* of td_paths_by_channels: green, blue and their rates; then `rows` has red */
} td_node_sink;

/* The splats whose row may be used. */
TD_INLINE td_mask td_node_holds(const td_shape *shape) {
    td_lanes all = (shape->conic[0].d + shape->conic[2].d) + (shape->u.d + shape->v.d);
    return shape->visible & ~shape->broken & ~td_is_broken(all) & (shape->c.v > 0.0f) & (shape->det.v > 0.0f);
}

TD_INLINE void td_node_lay(const td_shape *shape, td_dual luminance, td_lanes entry[TD_PATH_STRIDE]) {
    td_mask holds = td_node_holds(shape);
    entry[TD_P_U] = shape->u.v, entry[TD_PATH_NUMBERS + TD_P_U] = shape->u.d;
    entry[TD_P_V] = shape->v.v, entry[TD_PATH_NUMBERS + TD_P_V] = shape->v.d;
    entry[TD_P_B] = shape->b.v, entry[TD_PATH_NUMBERS + TD_P_B] = shape->b.d;
    entry[TD_P_C] = shape->c.v, entry[TD_PATH_NUMBERS + TD_P_C] = shape->c.d;
    entry[TD_P_DET] = td_select(td_splat(0.0f), shape->det.v, holds), entry[TD_PATH_NUMBERS + TD_P_DET] = shape->det.d;
    entry[TD_P_OPACITY] = shape->opacity.v, entry[TD_PATH_NUMBERS + TD_P_OPACITY] = shape->opacity.d;
    entry[TD_P_LUMINANCE] = luminance.v, entry[TD_PATH_NUMBERS + TD_P_LUMINANCE] = luminance.d;
    entry[TD_P_DEPTH] = shape->depth.v, entry[TD_PATH_NUMBERS + TD_P_DEPTH] = shape->depth.d;
}

/* Stores green, blue and their rates. */
TD_INLINE void td_node_lay_beside(const td_colour *colour, td_index row, TD_GLOBAL td_real *beside) {
    int at[TD_LANES];
    td_spread_ints(row, at);
    for (int k = 0; k < TD_BESIDE_NUMBERS; k++) {
        td_real value[TD_LANES], rate[TD_LANES];
        td_spread(colour->channel[1 + k].v, value);
        td_spread(colour->channel[1 + k].d, rate);
        for (int lane = 0; lane < TD_LANES; lane++) {
            TD_GLOBAL td_real *own = beside + at[lane] * TD_BESIDE_STRIDE + k;
            own[0] = value[lane];
            own[TD_BESIDE_NUMBERS] = rate[lane];
        }
    }
}

/* Gaussians [i, i + TD_LANES) of a job. */
TD_INLINE void td_node_group(const td_node_job *job, int i, TD_GLOBAL const int *gaussians, TD_GLOBAL const int *rows,
                             TD_GLOBAL const int *object, TD_GLOBAL const td_view *views, const td_image *image,
                             const td_source *source, const td_node_sink *sink) {
    td_index gaussian = td_load_ints(gaussians + job->first + i), row = td_load_ints(rows + job->first + i);
    if (!td_any(gaussian >= 0)) return; /* padding alone: with one lane, groups would race for this row, which isn't read */
    int leader = gaussians[job->first + (i & ~(TD_PAD - 1))];
    td_source own = td_source_of(source, image, leader);
    TD_GLOBAL const td_view *view = views + job->slot * image->objects + object[td_owner_of(&own, leader)];
    td_gaussian numbers;
    td_load_gaussian(&own, image, td_not_below_0(gaussian), &numbers);
    td_shape shape = td_project_bare(view, image, &numbers, gaussian >= 0);
    /* Cubics follow colours that aren't clamped. A clamp is a kink, which no cubic follows: splats with one were projected at
     * each point's own time, at ten times the cost. Points clamp what the cubics say (point_splats.h). */
    const int clamps_here = !td_paths_by_channels(image) || view->colour_floor > image->colour_floor;
    td_colour colour = td_project_colour_above(view, image, &own, &numbers, td_not_below_0(gaussian),
                                               clamps_here ? view->colour_floor : TD_NO_FLOOR);
    td_lanes entry[TD_PATH_STRIDE];
    td_dual light = colour.channel[0];
    if (td_paths_by_channels(image))
        td_node_lay_beside(&colour, row, sink->beside);
    else
        light = td_luminance_of(&colour, image);
    td_node_lay(&shape, light, entry);
    td_store_rows(sink->rows, row, entry);
}

/* -- halving ------------------------------------------------------------------------------------------------------- */

/* The row in the middle of the cubic between two rows that are `h` seconds apart: `numbers` values, then as many rates. The
 * cubics of both halves are then equal to this cubic. */
TD_INLINE void td_path_middle_row(TD_GLOBAL const td_real *from, TD_GLOBAL const td_real *to, td_real h, int numbers,
                                  TD_GLOBAL td_real *middle) {
    const td_real per_h = TD_REAL(1.5) / h, eighth = TD_REAL(0.125) * h;
    for (int k = 0; k < numbers; k++) {
        const td_real begin = from[k], way = to[k] - begin, rate = from[numbers + k], last = to[numbers + k];
        middle[k] = begin + (TD_REAL(0.5) * way + eighth * (rate - last));
        middle[numbers + k] = per_h * way - TD_REAL(0.25) * (rate + last);
    }
}

/* Makes a path's rows of the next level, from row `to` on, of rows of this level, 2^level curves per piece, from row `from` on.
 * Every second row is a copy; the rows between are those of the cubic. Piece k has lengths[k] seconds. */
TD_INLINE void td_path_halve(TD_GLOBAL td_real *rows, int numbers, int from, int to, int level, int pieces,
                             TD_GLOBAL const td_real *lengths) {
    const int parts = 1 << level, stride = 2 * numbers;
    TD_GLOBAL const td_real *old = rows + from * stride;
    TD_GLOBAL td_real *made = rows + to * stride;
    for (int k = 0; k < stride; k++) made[k] = old[k];
    for (int piece = 0; piece < pieces; piece++) {
        const td_real h = lengths[piece] / (td_real)parts;
        for (int part = 0; part < parts; part++, old += stride, made += 2 * stride) {
            td_path_middle_row(old, old + stride, h, numbers, made + stride);
            for (int k = 0; k < stride; k++) made[2 * stride + k] = old[stride + k];
        }
    }
}

/* -- the misfit ---------------------------------------------------------------------------------------------------- */

/* The error of a number, and of its rate. */
typedef struct td_path_stray {
    td_dual u, v, a, b, c, det, opacity, luminance;
} td_path_stray;

TD_INLINE td_path_stray td_path_compare(const td_path_splat *path, td_dual path_a, const td_path_splat *own, td_dual own_a) {
    td_path_stray off;
    off.u = td_dual_sub(own->u, path->u), off.v = td_dual_sub(own->v, path->v);
    off.a = td_dual_sub(own_a, path_a), off.b = td_dual_sub(own->b, path->b), off.c = td_dual_sub(own->c, path->c);
    off.det = td_dual_sub(own->det, path->det);
    off.opacity = td_dual_sub(own->opacity, path->opacity);
    off.luminance = td_dual_sub(own->luminance, path->luminance);
    return off;
}

/* The greatest change of log_luminance for small changes of a splat's numbers, where splat_alpha changes most. The worst case
 * is a splat before black, or black before the splat. An opaque splat is all that is seen there, and so is a faint one before
 * black. log_luminance changes by luminance / (opacity luminance + log_eps) times the change of alpha. From an opacity of 0.05
 * on this factor is reduced, because a splat that takes more light is seen less by itself. Above 0.14 the factor is 1; without
 * the reduction, the errors found in such scenes are 2 to 4 times the true ones. Changes of light count in full, because the
 * splat may be faint at some time.
 *
 * A shift d of the mean changes alpha by at most e^(-1/2) opacity sqrt(d^T Q d), one standard deviation out. A change D of the
 * covariance changes it by opacity |M|_F / e, M = Q D, on the circle of sqrt 2. |M|_F^2 = tr(M)^2 - 2 det(M) in the coordinates
 * where the splat is round, with tr(M) = ddet / det to first order and det(M) = det(D) / det: no conic is needed, which would
 * cancel. */
TD_INLINE td_lanes td_path_change(const td_path_splat *own, td_lanes own_a, td_lanes du, td_lanes dv, td_lanes da, td_lanes db,
                                  td_lanes dc, td_lanes ddet, td_lanes dopacity, td_lanes dluminance, td_real log_eps) {
    td_lanes inverse = 1.0f / own->det.v;
    td_lanes along = own->c.v * du * du - 2.0f * own->b.v * du * dv + own_a * dv * dv;
    td_lanes shift = td_sqrt(td_larger(along, td_splat(0.0f)) * inverse);
    td_lanes trace = ddet * inverse, swap = (da * dc - db * db) * inverse;
    td_lanes shape = td_sqrt(td_larger(td_fma(trace, trace, -2.0f * swap), td_splat(0.0f)));
    td_lanes colour = td_size(dluminance) / (td_size(own->luminance.v) + log_eps);
    td_lanes place = td_fma(TD_REAL(0.36787944117144233), shape, TD_REAL(0.6065306597126334) * shift);
    td_lanes opacity = td_size(own->opacity.v), luminance = td_size(own->luminance.v);
    td_lanes alone = luminance / td_fma(opacity, luminance, td_splat(log_eps));
    td_lanes faint = TD_REAL(0.05) / td_larger(opacity, td_splat(TD_REAL(0.05)));
    const td_lanes one = td_splat(1.0f);
    td_lanes light = td_fma(opacity, colour, td_size(dopacity)) * td_larger(alone, one);
    return td_fma(opacity * td_larger(alone * faint * faint, one), place, light);
}

/* Bound on the part of a change that comes from rounding of mean2d, of the covariance's entries, and of the camera's place. A
 * needle at an angle is sensitive to the first, all splats are to the last where the camera is far from the origin. */
TD_INLINE td_lanes td_path_noise(const td_path_splat *own, td_lanes own_a, const td_path_terms *terms, const td_image *image) {
    const td_lanes near = terms->place / td_larger(own->depth.v, td_splat(image->near));
    const td_lanes rounding = terms->rounding + near;
    td_lanes a = rounding * own_a, c = rounding * own->c.v;
    td_lanes inverse = 1.0f / own->det.v;
    td_lanes u = td_fma(near, td_splat(image->fx), terms->rounding * td_size(own->u.v));
    td_lanes v = td_fma(near, td_splat(image->fy), terms->rounding * td_size(own->v.v));
    td_lanes shift = td_sqrt((own->c.v * u * u + own_a * v * v) * inverse); /* without a conic, which would cancel */
    td_lanes shape = 2.0f * td_sqrt(a * c * inverse) + rounding;
    return td_size(own->opacity.v) * (shape + shift + rounding);
}

/* The weights of a cubic's middle; the cubic is `h` seconds long. */
TD_INLINE td_path_cubic td_path_middle(td_real h) {
    td_path_cubic cubic;
    cubic.way = td_splat(0.5f), cubic.start = td_splat(0.125f * h), cubic.end = td_splat(-0.125f * h);
    cubic.way_dot = td_splat(1.5f / h), cubic.start_dot = td_splat(-0.25f), cubic.end_dot = td_splat(-0.25f);
    return cubic;
}

/* The splat of one row. */
TD_INLINE td_path_splat td_path_row(const td_lanes entry[TD_PATH_STRIDE]) {
    td_path_splat splat;
    splat.u = td_dual_make(entry[TD_P_U], entry[TD_PATH_NUMBERS + TD_P_U]);
    splat.v = td_dual_make(entry[TD_P_V], entry[TD_PATH_NUMBERS + TD_P_V]);
    splat.b = td_dual_make(entry[TD_P_B], entry[TD_PATH_NUMBERS + TD_P_B]);
    splat.c = td_dual_make(entry[TD_P_C], entry[TD_PATH_NUMBERS + TD_P_C]);
    splat.det = td_dual_make(entry[TD_P_DET], entry[TD_PATH_NUMBERS + TD_P_DET]);
    splat.opacity = td_dual_make(entry[TD_P_OPACITY], entry[TD_PATH_NUMBERS + TD_P_OPACITY]);
    splat.luminance = td_dual_make(entry[TD_P_LUMINANCE], entry[TD_PATH_NUMBERS + TD_P_LUMINANCE]);
    splat.depth = td_dual_make(entry[TD_P_DEPTH], entry[TD_PATH_NUMBERS + TD_P_DEPTH]);
    return splat;
}

TD_INLINE td_dual td_path_a(const td_path_splat *splat) {
    return td_dual_mul(td_dual_fma(splat->b, splat->b, splat->det), td_dual_reciprocal(splat->c));
}

/* Adds green and blue to `luminance`, which is red so far. Errors add by absolute value, since an error of one channel isn't
 * made up for by another's. Colours are compared before their clamp, since a clamp makes no error greater. */
TD_INLINE void td_path_channels(TD_GLOBAL const td_real *beside, td_index row, const td_path_cubic *cubic,
                                const td_image *image, td_path_splat *own, td_path_stray *off) {
    own->luminance = td_dual_scale(td_sh_floor(own->luminance, image->colour_floor), image->luminance[0]);
    off->luminance =
        td_dual_make(td_size(off->luminance.v) * image->luminance[0], td_size(off->luminance.d) * image->luminance[0]);
    for (int k = 0; k < TD_BESIDE_NUMBERS; k++) {
        td_dual at[3];
        for (int i = 0; i < 3; i++) {
            td_index place = (row + i) * TD_BESIDE_STRIDE + k;
            at[i] = td_dual_make(td_gather(beside, place), td_gather(beside, place + TD_BESIDE_NUMBERS));
        }
        td_dual missed = td_dual_sub(at[1], td_path_between(cubic, at[0], at[2]));
        td_real weight = image->luminance[1 + k];
        own->luminance = td_dual_plus(own->luminance, weight, td_sh_floor(at[1], image->colour_floor));
        off->luminance = td_dual_plus(off->luminance, weight, td_dual_make(td_size(missed.v), td_size(missed.d)));
    }
}

/* Misfit of TD_LANES splats within one piece of `h` seconds, whose rows at its start, middle and end are neighbours from `row`
 * on. It is the possible error of log_luminance within the halves, in tolerances; up to 1 the halves' cubics are accurate
 * enough.
 *
 * Values are compared, and rates over half the piece. Their sum bounds the error of the halves' cubics at a kink, to within
 * a tenth. On a smooth path, the halves' cubics are 16 times more accurate than the sum says. The error from rounding is added
 * to the tolerance. */
TD_INLINE td_lanes td_path_misfit(TD_GLOBAL const td_real *rows, TD_GLOBAL const td_real *beside, td_index row, td_real h,
                                  const td_path_terms *terms, const td_image *image) {
    td_lanes start[TD_PATH_STRIDE], middle[TD_PATH_STRIDE], end[TD_PATH_STRIDE];
    td_load_rows(rows, row, start);
    td_load_rows(rows, row + 1, middle);
    td_load_rows(rows, row + 2, end);
    td_path_cubic cubic = td_path_middle(h);
    td_path_splat path = td_path_blend(&cubic, start, end), own = td_path_row(middle);
    td_dual a = td_path_a(&own);
    td_path_stray off = td_path_compare(&path, td_path_a(&path), &own, a);
    if (td_paths_by_channels(image)) td_path_channels(beside, row, &cubic, image, &own, &off);
    const td_real eps = image->transfer.dark;
    td_lanes value =
        td_path_change(&own, a.v, off.u.v, off.v.v, off.a.v, off.b.v, off.c.v, off.det.v, off.opacity.v, off.luminance.v, eps);
    td_lanes rate =
        td_path_change(&own, a.v, off.u.d, off.v.d, off.a.d, off.b.d, off.c.d, off.det.d, off.opacity.d, off.luminance.d, eps);
    td_lanes stray = td_fma(td_splat(0.5f * h), rate, value), noise = td_path_noise(&own, a.v, terms, image);
    td_lanes misfit = stray / (terms->tolerance / image->transfer.steepest + noise);
    td_mask there = (start[TD_P_DET] > 0.0f) & (own.det.v > 0.0f) & (end[TD_P_DET] > 0.0f);
    td_mask near = (path.det.v > 0.0f) & (path.c.v > 0.0f) & ~td_is_broken(misfit);
    return td_select(td_splat(TD_PATH_NEVER), misfit, there & near);
}

/* The largest misfit of each of TD_LANES splats over all pieces of the interval. Piece k has lengths[k] seconds and is cut into
 * 2^level, level >= 1. A splat's rows begin at first[lane]. The misfit of curve k goes to each[k x stride], or nowhere for
 * stride 0. */
TD_INLINE td_lanes td_path_try_each(TD_GLOBAL const td_real *rows, TD_GLOBAL const td_real *beside, td_index first, int level,
                                    int pieces, TD_GLOBAL const td_real *lengths, const td_path_terms *terms,
                                    const td_image *image, TD_GLOBAL td_real *each, int stride) {
    td_lanes worst = td_splat(0.0f);
    int parts = 1 << (level - 1);
    for (int piece = 0; piece < pieces; piece++) {
        td_real h = lengths[piece] / (td_real)parts;
        for (int k = 0; k < parts; k++) {
            td_lanes misfit = td_path_misfit(rows, beside, first + 2 * (piece * parts + k), h, terms, image);
            if (stride) td_store_lanes(each + (piece * parts + k) * stride, misfit);
            worst = td_larger(misfit, worst);
        }
    }
    return worst;
}

#endif
