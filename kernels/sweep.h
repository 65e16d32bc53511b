/* The screen box that a Gaussian's splat stays within over an interval of time. Tiles' candidate lists are made of these boxes.
 *
 * The interval is cut into pieces, mostly one, and their boxes are joined. In each piece the splat is projected at the start,
 * the middle and the end. Its mean's path is near the cubic through the ends with their rates, which lies within its Bezier
 * points. If object and camera move as cubics, the middle shows how far the path deviates from that cubic. For other motion the
 * host bounds the deviation (stray.h), and boxes are wider by that. */
#ifndef TD_SWEEP_H
#define TD_SWEEP_H

#include "unseen.h"

/* The interval: 2^level pieces, with views and rows at their 2^(level + 1) + 1 times, in order. */
typedef struct td_interval {
    TD_GLOBAL const td_view *views;   /* (times x objects) */
    TD_GLOBAL const td_stray *strays; /* (objects) */
    TD_GLOBAL const int *object;      /* of each Gaussian of the store */
    TD_GLOBAL const int *rows;        /* (times) row of the first Gaussian */
    td_real duration;
    int level;
} td_interval;

/* While depths are within this ratio, x/z of a cubic is within 1e-5 of its size from the cubic through its ends:
 * (ratio - 1)^4 / 16. */
#define TD_NEARLY_FLAT TD_REAL(1.1)
/* A place beyond any screen [px]. */
#define TD_NOWHERE TD_REAL(1e30)
/* Pieces that a splat which passes the near plane asks for, at most: the pieces are cut for the whole image. */
#define TD_CROSSING_MOST TD_REAL(256.0)

/* Results for TD_LANES Gaussians after some pieces. */
typedef struct td_swept {
    td_lanes x0, y0, x1, y1; /* empty: x0 > x1 */
    td_lanes travel;         /* the greatest of all pieces, in diameters */
    td_lanes pieces;         /* number of pieces asked for, other than by travel */
    td_lanes peak;           /* greatest opacity of the samples */
    td_lanes z0, z1;         /* camera z, least and greatest */
    td_mask crosses;         /* passes the near plane */
    td_mask shown;           /* on the screen at the interval's start or end */
} td_swept;

/* The range of the Bezier points of the cubic through (start, rate) and (end, rate), and of the middle. It is widened by four
 * times the middle's distance from the cubic beyond `known`: a quartic term that shows as e there is at most e elsewhere, and
 * the rest is safety. */
TD_INLINE void td_sweep_range(td_dual start, td_dual middle, td_dual end, td_real duration, td_lanes known, td_lanes *lower,
                              td_lanes *upper) {
    td_real third = duration / 3;
    td_lanes b1 = td_fma(start.d, third, start.v), b2 = td_fma(end.d, -third, end.v);
    td_lanes centre = 0.125f * (start.v + end.v) + 0.375f * (b1 + b2);
    td_lanes stray = 4.0f * td_larger(td_size(middle.v - centre) - known, td_splat(0.0f));
    *lower = td_smaller(td_smaller(start.v, end.v), td_smaller(td_smaller(b1, b2), middle.v)) - stray;
    *upper = td_larger(td_larger(start.v, end.v), td_larger(td_larger(b1, b2), middle.v)) + stray;
}

/* The largest of three half-widths, plus their spread, since half-widths may bulge between samples too. */
TD_INLINE td_lanes td_sweep_width(td_lanes a, td_lanes b, td_lanes c) {
    td_lanes most = td_larger(td_larger(a, b), c), least = td_smaller(td_smaller(a, b), c);
    return most + (most - least);
}

/* For Gaussians whose opacity changes: the greatest may lie between samples. All three shapes get the greatest opacity of the
 * cubic through them, and the ellipse out to where that is cut. */
TD_INLINE void td_sweep_opacity(td_shape s[3], const td_image *image, td_real duration) {
    td_lanes lower, upper;
    td_real cut = td_least_seen(image);
    td_sweep_range(s[0].opacity, s[1].opacity, s[2].opacity, duration, td_splat(0.0f), &lower, &upper);
    td_mask in_front = (s[0].depth.v > image->near) & (s[1].depth.v > image->near) & (s[2].depth.v > image->near);
    td_mask reached = in_front & (upper > cut);
    td_lanes power = 2.0f * td_log(td_select(td_splat(1.0f), upper / cut, reached));
    for (int i = 0; i < 3; i++) {
        s[i].visible = s[i].visible | reached;
        s[i].power = td_larger(s[i].power, power);
    }
}

/* For Gaussians near the near plane: the fade rises with depth, up to `z1`. All three shapes get the greatest opacity, and the
 * ellipse out to where that is cut. */
TD_INLINE void td_sweep_fade(td_shape s[3], const td_image *image, td_lanes opacity, td_lanes z0, td_lanes z1) {
    if (!(image->near_full > image->near)) return;
    td_real scale = 1 / (image->near_full - image->near), cut = td_least_seen(image);
    td_mask fading = (z0 < image->near_full) & (z1 > image->near) & (z0 < z1);
    td_lanes upper = opacity * td_smootherstep(td_clamp((z1 - image->near) * scale, 0, 1));
    td_mask reached = fading & (upper > cut);
    td_lanes power = 2.0f * td_log(td_select(td_splat(1.0f), upper / cut, reached));
    for (int i = 0; i < 3; i++) {
        s[i].visible = s[i].visible | (reached & (s[i].depth.v > image->near));
        s[i].power = td_larger(s[i].power, td_select(td_splat(0.0f), power, reached));
    }
}

/* Opacity as stored; where it changes, the greatest of the three rows. */
TD_INLINE td_lanes td_sweep_own_opacity(const td_image *image, const td_source *source, const int row[3]) {
    td_lanes most = td_gather(source->geometry, td_count_from(row[0]) * TD_GEOMETRY_STRIDE + TD_G_OPACITY);
    if (td_moving(image) && source->moved)
        for (int i = 1; i < 3; i++)
            most = td_larger(most, td_gather(source->geometry, td_count_from(row[i]) * TD_GEOMETRY_STRIDE + TD_G_OPACITY));
    return most;
}

/* The greatest lengths of the three rows. */
TD_INLINE td_reach td_sweep_reach(TD_GLOBAL const td_stray *stray, const td_image *image, const td_source *source,
                                  const int row[3]) {
    td_reach most = td_reach_at(stray, source, td_count_from(row[0]));
    for (int i = 1; i < 3 && td_moving(image) && source->moved; i++) {
        td_reach reach = td_reach_at(stray, source, td_count_from(row[i]));
        most.mean = td_larger(most.mean, reach.mean);
        most.factor = td_larger(most.factor, reach.factor);
    }
    return most;
}

/* One axis of the screen. */
typedef struct td_axis {
    td_real focal, centre, size, limit; /* limit: what |x/z| is clamped to in the Jacobian */
    int row;                            /* row of the view's matrix */
} td_axis;

/* Entry `axis` of the means in camera coordinates. */
TD_INLINE td_dual td_sweep_place(int axis, TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                 int row) {
    td_dual mean[3];
    td_index index = td_count_from(row) * TD_GEOMETRY_STRIDE;
    for (int k = 0; k < 3; k++) mean[k] = td_entry(source, image, index, TD_G_MEAN + k);
    return td_view_row(view->r + 3 * axis, view->r_dot + 3 * axis, image, mean, view->t[axis], view->t_dot[axis]);
}

/* The splats that stay to one side of the image at any depth up to z1: x_camera / z only falls with depth. `size`: reach of the
 * splats in the scene; `blur`: their additional reach [px]. */
TD_INLINE td_mask td_sweep_outside(const td_axis *axis, TD_GLOBAL const td_view *const view[3], const td_image *image,
                                   const td_source *source, const int row[3], td_real duration, td_lanes z1, td_lanes size,
                                   td_lanes blur) {
    td_dual x[3];
    td_lanes x0, x1;
    for (int i = 0; i < 3; i++) x[i] = td_sweep_place(axis->row, view[i], image, source, row[i]);
    td_sweep_range(x[0], x[1], x[2], duration, td_splat(0.0f), &x0, &x1);
    td_lanes reach = size * td_sqrt(td_splat(1 + axis->limit * axis->limit));
    td_lanes deep = td_larger(z1, td_splat(image->near));
    return (axis->focal * (x0 - reach) > deep * (axis->size - axis->centre + blur)) |
           (axis->focal * (x1 + reach) < -deep * (axis->centre + blur));
}

/* With a lens, the splats that stay farther from the axis than any corner, at any depth up to z1. */
TD_INLINE td_mask td_sweep_beyond(TD_GLOBAL const td_view *const view[3], const td_image *image, const td_source *source,
                                  const int row[3], td_real duration, td_lanes z1, td_lanes size, td_lanes blur) {
    td_lanes across = td_splat(0.0f);
    for (int axis = 0; axis < 2; axis++) {
        td_dual x[3];
        td_lanes x0, x1;
        for (int i = 0; i < 3; i++) x[i] = td_sweep_place(axis, view[i], image, source, row[i]);
        td_sweep_range(x[0], x[1], x[2], duration, td_splat(0.0f), &x0, &x1);
        td_lanes least = td_larger(td_larger(x0, -x1), td_splat(0.0f));
        across = td_fma(least, least, across);
    }
    td_real focal = image->fx < image->fy ? image->fx : image->fy;
    return td_lens_outside(image, td_sqrt(across), td_larger(z1, td_splat(image->near)), size, blur / focal);
}

/* The greater absolute value of a clamp's ends. */
TD_INLINE td_real td_sweep_limit(td_real lower, td_real upper) { return upper > -lower ? upper : -lower; }

/* A piece, and its values that are used more than once. */
typedef struct td_piece {
    td_shape s[3];
    TD_GLOBAL const td_view *view[3];
    TD_GLOBAL const td_stray *stray;
    int level, strays;       /* strays, 1: some path has a stray */
    int row[3], first, last; /* rows of the samples; numbers of the first and last time */
    td_real duration;
    td_reach reach;
    td_lanes opacity;
    td_lanes off;    /* bound on the strays of the splat's points [scene units] */
    td_lanes known;  /* its part that the mean shows in the middle: all, unless depths differ much */
    td_lanes z0, z1; /* depths */
} td_piece;

/* The splats that pass the near plane. They get the whole image as their box, or nothing where they are beside the image all
 * the time. They are taken out of `ever`, those whose samples give a box: behind the plane a splat has no place on the
 * screen. */
TD_INLINE td_mask td_sweep_crosses(const td_piece *piece, const td_image *image, const td_source *source, td_mask *ever) {
    const td_shape *s = piece->s;
    td_mask behind = (s[0].depth.v <= image->near) | (s[1].depth.v <= image->near) | (s[2].depth.v <= image->near);
    td_real cut = td_cut_rule(image) == TD_CUT_NONE ? TD_REAL(0.0) : image->cut;
    td_mask crosses = (piece->opacity > cut) & (((piece->z0 <= image->near) & (piece->z1 > image->near)) | (behind & *ever));
    if (!td_any(crosses)) return crosses;
    *ever &= crosses == 0;
    td_real least = td_least_seen(image), scale = 0;
    td_lanes sigmas = td_sqrt(2.0f * td_log(td_select(td_splat(1.0f), piece->opacity / least, piece->opacity > least)));
    for (int k = 0; k < 3; k++) scale += piece->view[1]->r[6 + k] * piece->view[1]->r[6 + k]; /* an object's scale^2 */
    td_lanes size = td_fma(sigmas * td_sqrt(td_splat(scale)),
                           TD_REAL(1.01) * td_sweep_reach(piece->stray, image, source, piece->row).factor, piece->off);
    td_lanes blur = td_fma(sigmas, td_sqrt(td_splat(image->dilation)), td_splat(1.0f));
    if (td_lens_model(image))
        return crosses & (td_sweep_beyond(piece->view, image, source, piece->row, piece->duration, piece->z1, size, blur) == 0);
    td_axis x = {image->fx, image->cx, (td_real)image->width, td_sweep_limit(image->limit_x0, image->limit_x1), 0};
    td_axis y = {image->fy, image->cy, (td_real)image->height, td_sweep_limit(image->limit_y0, image->limit_y1), 1};
    td_mask outside = td_sweep_outside(&x, piece->view, image, source, piece->row, piece->duration, piece->z1, size, blur) |
                      td_sweep_outside(&y, piece->view, image, source, piece->row, piece->duration, piece->z1, size, blur);
    return crosses & (outside == 0);
}

/* 1 where a sample shows the splat on the screen. */
TD_INLINE td_mask td_sweep_shows(const td_shape *s, td_lanes rx, td_lanes ry, const td_image *image) {
    return s->visible & (s->u.v + rx > 0.0f) & (s->u.v - rx < (td_real)image->width) & (s->v.v + ry > 0.0f) &
           (s->v.v - ry < (td_real)image->height);
}

/* Pieces asked for by splats that pass the near plane and aren't seen at either end: two for each width of the fade that their
 * depth passes. Where there is no fade its width is a quarter of the near plane's depth. Behind the plane nothing else is known
 * of a splat. */
TD_INLINE td_lanes td_sweep_crossing(const td_swept *swept, const td_image *image) {
    td_real fade = image->near_full > image->near ? image->near_full - image->near : 0.25f * image->near;
    td_lanes pieces = td_smaller(2.0f * (swept->z1 - swept->z0) / fade, td_splat(TD_CROSSING_MOST));
    return td_select(td_splat(1.0f), pieces, swept->crosses & (swept->shown == 0));
}

/* Ranges of the mean on the screen, and half-widths [px]. */
typedef struct td_span2 {
    td_lanes x0, y0, x1, y1;
} td_span2;

/* Upper bound, over the focal length, of the pixels that a scene unit covers in the piece, for points that are x and y focal
 * lengths off the principal point. */
TD_INLINE td_lanes td_sweep_tilt(const td_piece *piece, const td_image *image, td_lanes x, td_lanes y) {
    td_lanes nearest = td_larger(piece->z0, td_splat(image->near));
    if (td_lens_model(image)) {
        x = x * image->lens.slope, y = y * image->lens.slope;
        nearest = nearest / image->lens.stretch;
    }
    return td_sqrt(td_fma(x, x, td_fma(y, y, td_splat(1.0f)))) / nearest;
}

/* The greatest |slope| of the samples from the principal point. */
TD_INLINE td_lanes td_sweep_slope(td_dual a, td_dual b, td_dual c, td_real centre, td_real focal) {
    return td_larger(td_size(a.v - centre), td_larger(td_size(b.v - centre), td_size(c.v - centre))) / focal;
}

/* The range of the mean, without strays. */
TD_INLINE td_span2 td_sweep_mean(const td_piece *piece, const td_image *image) {
    const td_shape *s = piece->s;
    td_span2 box;
    td_lanes known = piece->known;
    if (piece->strays) {
        td_lanes x = td_sweep_slope(s[0].u, s[1].u, s[2].u, image->cx, image->fx);
        td_lanes y = td_sweep_slope(s[0].v, s[1].v, s[2].v, image->cy, image->fy);
        known *= td_sweep_tilt(piece, image, x, y);
    }
    td_sweep_range(s[0].u, s[1].u, s[2].u, piece->duration, known * image->fx, &box.x0, &box.x1);
    td_sweep_range(s[0].v, s[1].v, s[2].v, piece->duration, known * image->fy, &box.y0, &box.y1);
    return box;
}

/* Widens a box by the strays of the paths, and returns the number of pieces that they ask for. A point at X/Z that is off by d
 * in the scene is off on the screen by at most f d sqrt(1 + (X/Z)^2) / Z, with the lesser of both depths. */
TD_INLINE td_lanes td_sweep_widen(const td_piece *piece, const td_image *image, const td_span2 *box, td_lanes *wide,
                                  td_lanes *high) {
    td_lanes x = td_larger(td_size(box->x0 - image->cx), td_size(box->x1 - image->cx)) / image->fx;
    td_lanes y = td_larger(td_size(box->y0 - image->cy), td_size(box->y1 - image->cy)) / image->fy;
    td_lanes tilted = td_sweep_tilt(piece, image, x, y), nearer = piece->off / td_larger(piece->z0, td_splat(image->near));
    *wide = td_fma(piece->off * tilted, image->fx, td_fma(nearer, *wide, *wide));
    *high = td_fma(piece->off * tilted, image->fy, td_fma(nearer, *high, *high));
    td_lanes allowed = TD_UNSEEN_PLACE * td_larger(td_narrowest(&piece->s[1]), td_splat(1.0f));
    return td_stray_pieces(piece->stray, &piece->reach, (image->fx > image->fy ? image->fx : image->fy) * tilted, allowed);
}

/* Depths, opacity and strays of a piece. The shapes' opacities become the greatest of the piece. */
TD_INLINE void td_sweep_begin(td_piece *piece, const td_image *image, const td_source *source) {
    td_shape *s = piece->s;
    td_lanes off = td_splat(0.0f);
    piece->off = piece->known = off;
    piece->opacity = td_sweep_own_opacity(image, source, piece->row);
    if (piece->strays) {
        piece->reach = td_sweep_reach(piece->stray, image, source, piece->row);
        off = td_stray_of(piece->stray, piece->level, &piece->reach, td_splat(0.0f));
        if (!(td_moving(image) && source->moved)) piece->known = off; /* their middle has other reasons to be off the cubic */
    }
    td_sweep_range(s[0].depth, s[1].depth, s[2].depth, piece->duration, piece->known, &piece->z0, &piece->z1);
    piece->z0 -= off;
    piece->z1 += off;
    piece->known = td_select(td_splat(0.0f), piece->known, piece->z1 < TD_NEARLY_FLAT * piece->z0);
    if (td_moving(image) && source->moved) td_sweep_opacity(s, image, piece->duration);
    td_sweep_fade(s, image, piece->opacity, piece->z0, piece->z1);
    if (!piece->strays) return;
    td_lanes power = td_larger(td_larger(s[0].power, td_larger(s[1].power, s[2].power)), td_splat(0.0f));
    piece->off = td_stray_of(piece->stray, piece->level, &piece->reach, td_sqrt(power));
}

/* Joins a piece's box and numbers to those of the pieces before it. */
TD_INLINE void td_sweep_piece(td_piece *piece, const td_image *image, const td_source *source, td_swept *swept) {
    const td_shape *s = piece->s;
    td_lanes rx[3], ry[3], pieces = td_splat(1.0f);
    for (int i = 0; i < 3; i++) swept->peak = td_larger(swept->peak, s[i].opacity.v);
    td_sweep_begin(piece, image, source);
    for (int i = 0; i < 3; i++) {
        td_half_widths(&s[i], &rx[i], &ry[i]);
        rx[i] = td_select(td_splat(0.0f), rx[i], s[i].visible);
        ry[i] = td_select(td_splat(0.0f), ry[i], s[i].visible);
    }
    td_mask ever = s[0].visible | s[1].visible | s[2].visible;
    td_mask broken = s[0].broken | s[1].broken | s[2].broken; /* the box is the whole image, so that pixels show the fault */
    td_mask crosses = td_sweep_crosses(piece, image, source, &ever) | broken;
    td_span2 box = td_sweep_mean(piece, image);
    td_lanes wide = td_sweep_width(rx[0], rx[1], rx[2]), high = td_sweep_width(ry[0], ry[1], ry[2]);
    if (piece->strays) pieces = td_sweep_widen(piece, image, &box, &wide, &high);
    pieces = td_select(td_splat(1.0f), pieces, ever & (crosses == 0) & (piece->opacity > TD_UNSEEN_OPACITY));
    swept->pieces = td_larger(swept->pieces, pieces);
    swept->crosses |= crosses;
    swept->z0 = td_smaller(swept->z0, piece->z0);
    swept->z1 = td_larger(swept->z1, piece->z1);
    if (piece->first) swept->shown |= td_sweep_shows(&s[0], rx[0], ry[0], image);
    if (piece->last) swept->shown |= td_sweep_shows(&s[2], rx[2], ry[2], image);
    td_lanes travel = td_larger(td_travel(s, ever), td_reshape(s, image, piece->duration));
    swept->travel = td_larger(swept->travel, td_select(travel, td_splat(0.0f), crosses));
    td_lanes none = td_splat(TD_NOWHERE), width = td_splat((td_real)image->width), height = td_splat((td_real)image->height);
    swept->x0 = td_smaller(swept->x0, td_select(td_select(none, box.x0 - wide, ever), td_splat(0.0f), crosses));
    swept->y0 = td_smaller(swept->y0, td_select(td_select(none, box.y0 - high, ever), td_splat(0.0f), crosses));
    swept->x1 = td_larger(swept->x1, td_select(td_select(-none, box.x1 + wide, ever), width, crosses));
    swept->y1 = td_larger(swept->y1, td_select(td_select(-none, box.y1 + high, ever), height, crosses));
}

/* Projects TD_LANES Gaussians at time `at` of the interval; their rows begin `offset` behind the time's first. */
TD_INLINE void td_sweep_sample(td_piece *piece, int i, const td_interval *all, const td_image *image, const td_source *source,
                               int which, int at, int offset) {
    piece->row[i] = all->rows[at] + offset;
    piece->view[i] = all->views + at * image->objects + which;
    if (i > 0 && all->duration == 0) { /* the interval is an instant: all samples are equal */
        piece->s[i] = piece->s[0];
        return;
    }
    td_gaussian gaussian;
    td_load_gaussian(source, image, td_count_from(piece->row[i]), &gaussian);
    piece->s[i] = td_project_shape(piece->view[i], image, &gaussian, td_count_from(piece->row[i]) >= 0);
}

/* Pieces that Gaussians that move by themselves ask for: twice as many as at the finest level at which one of them is rough. */
TD_INLINE td_lanes td_sweep_rough(td_piece *piece, const td_interval *all, const td_image *image, const td_source *source,
                                  int which, int offset, td_lanes peak) {
    td_lanes pieces = td_splat(1.0f);
    for (int level = all->level; level >= 0; level--) {
        int apart = 1 << (all->level - level);
        td_real duration = all->duration / (td_real)(1 << level);
        td_mask open = pieces <= 1.0f, rough = open & 0;
        if (!td_any(open)) break;
        for (int at = 0; at < 2 << all->level; at += 2 * apart) {
            for (int i = 0; i < 3; i++) td_sweep_sample(piece, i, all, image, source, which, at + i * apart, offset);
            rough |= td_is_rough(piece->s, piece->view[0], image, source, piece->row, duration, peak);
        }
        pieces = td_select(pieces, td_splat((td_real)(2 << level)), open & rough);
    }
    return pieces;
}

/* Stores boxes; empty ones (x0 > x1) where `nowhere`. */
TD_INLINE void td_store_boxes(const td_image *image, const td_span2 *box, td_mask nowhere, TD_GLOBAL td_real *boxes) {
    td_scatter(boxes, 4, 0, td_select(box->x0, td_splat((td_real)(image->width + 1)), nowhere));
    td_scatter(boxes, 4, 1, td_select(box->y0, td_splat((td_real)(image->height + 1)), nowhere));
    td_scatter(boxes, 4, 2, td_select(box->x1, td_splat(-1.0f), nowhere));
    td_scatter(boxes, 4, 3, td_select(box->y1, td_splat(-1.0f), nowhere));
}

/* Boxes of an instant, whose samples are equal: the splats' own. Frames need these only, and they take half of the time. */
TD_INLINE void td_sweep_instant(const td_interval *all, const td_image *image, const td_source *source, int which, int offset,
                                TD_GLOBAL td_real *boxes, TD_GLOBAL td_real *travel) {
    td_index row = td_count_from(all->rows[0] + offset);
    td_lanes none = td_splat(0.0f), rx, ry;
    td_gaussian gaussian;
    td_span2 box;
    td_load_gaussian(source, image, row, &gaussian);
    td_shape s = td_project_shape(all->views + which, image, &gaussian, row >= 0);
    td_half_widths(&s, &rx, &ry);
    box.x0 = td_select(s.u.v - rx, none, s.broken);
    box.y0 = td_select(s.v.v - ry, none, s.broken);
    box.x1 = td_select(s.u.v + rx, td_splat((td_real)image->width), s.broken);
    box.y1 = td_select(s.v.v + ry, td_splat((td_real)image->height), s.broken);
    td_store_boxes(image, &box, (s.visible | s.broken) == 0, boxes);
    td_store_lanes(travel, none);
}

/* Boxes [x0, y0, x1, y1] of TD_LANES Gaussians of an object, at boxes + 4 i; empty (x0 > x1) where never visible. Their rows
 * are neighbours, `offset` behind each time's first. travel[i]: twice the number of pieces that the Gaussian asks for. */
TD_INLINE void td_sweep_group(const td_interval *all, const td_image *image, const td_source *sources, int offset,
                              TD_GLOBAL td_real *boxes, TD_GLOBAL td_real *travel) {
    td_source own = td_source_of(sources, image, all->rows[0] + offset);
    int which = all->object[td_owner_of(&own, all->rows[0] + offset)];
    td_lanes none = td_splat(TD_NOWHERE);
    td_swept swept;
    td_piece piece;
    piece.stray = all->strays + which;
    piece.strays = piece.stray->position[0] > 0 || piece.stray->rotation[0] > 0;
    if (all->duration == 0 && all->level == 0 && !piece.strays) {
        td_sweep_instant(all, image, &own, which, offset, boxes, travel);
        return;
    }
    swept.x0 = swept.y0 = swept.z0 = none;
    swept.x1 = swept.y1 = swept.z1 = -none;
    swept.crosses = swept.shown = none < 0.0f;
    swept.travel = swept.peak = td_splat(0.0f);
    swept.pieces = td_splat(1.0f);
    piece.level = all->level;
    piece.duration = all->duration / (td_real)(1 << all->level);
    for (int at = 0; at < 2 << all->level; at += 2) {
        for (int i = 0; i < 3; i++) td_sweep_sample(&piece, i, all, image, &own, which, at + i, offset);
        piece.first = at == 0;
        piece.last = at + 2 == 2 << all->level;
        td_sweep_piece(&piece, image, &own, &swept);
    }
    swept.pieces = td_larger(swept.pieces, td_sweep_crossing(&swept, image));
    if (all->level > 0 && td_moving(image) && own.moved)
        swept.pieces = td_larger(swept.pieces, td_sweep_rough(&piece, all, image, &own, which, offset, swept.peak));
    const td_span2 box = {swept.x0, swept.y0, swept.x1, swept.y1};
    td_store_boxes(image, &box, swept.x0 > swept.x1, boxes);
    td_lanes asked = td_select(td_splat(0.0f), 0.5f * swept.pieces, swept.pieces > 1.0f);
    td_store_lanes(travel, td_larger(asked, swept.travel * (td_real)(1 << all->level)));
}

#endif
