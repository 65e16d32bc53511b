/* Swaps of depth of two splats (td_swaps.h): when, how long they take, and what they are worth to the blocks of a tile. */
#include "camera/td_rotation.h"
#include "td_extremes.h"
#include "td_math.h"
#include "td_swaps.h"

#include <math.h>
#include <string.h>

/* -- a pair in a block --------------------------------------------------------------------------------------------- */

/* -ln of a splat's alpha at a pixel: half the quadratic form around (u, v), plus -ln of its opacity. */
typedef struct form {
    double u, v, a, b, c, rest;
} form;

static double form_at(const form *f, double x, double y) {
    const double dx = x - f->u, dy = y - f->v;
    return 0.5 * (dx * (f->a * dx + 2 * f->b * dy) + f->c * dy * dy) + f->rest;
}

/* Weights of the cubic through a part's two ends, at place s: of the change of value, and of both rates. */
typedef struct weights {
    double way, start, end;
} weights;

static weights weights_at(double h, double s) {
    const double rest = 1 - s;
    return (weights){s * s * (3 - 2 * s), h * s * rest * rest, -h * s * s * rest};
}

static double between(const weights *w, double from, double to, double rate0, double rate1) {
    return from + w->way * (to - from) + w->start * rate0 + w->end * rate1;
}

/* The rows of an object's view in part k. */
static void view_at(const td_swap_samples *at, int object, int k, const weights *w, double r[9], double t[3]) {
    const td_view *from = &at->view[(size_t)k * (size_t)at->objects + (size_t)object], *to = from + at->objects;
    for (int i = 0; i < 9; i++) r[i] = between(w, from->r[i], to->r[i], from->r_dot[i], to->r_dot[i]);
    for (int i = 0; i < 3; i++) t[i] = between(w, from->t[i], to->t[i], from->t_dot[i], to->t_dot[i]);
}

/* The mean of a splat in part k, in its object's units. */
static void mean_at(const td_swap_splat *of, int k, const weights *w, double mean[3]) {
    memcpy(mean, of->geometry + TD_G_MEAN, 3 * sizeof *mean);
    if (!of->move) return;
    const td_swap_move *from = &of->move[k], *to = from + 1;
    for (int i = 0; i < 3; i++) mean[i] = between(w, from->mean[i], to->mean[i], from->rate[i], to->rate[i]);
}

/* The form of a splat at place s of part k, by EWA; 0 if it is behind the camera. */
static int find_form(const td_image *image, const td_swap_samples *at, const td_swap_splat *of, int k, double s, form *f) {
    const double *g = of->geometry, *m = g + TD_G_FACTOR;
    double r[9], t[3], p[3], mean[3], row[2][3];
    const weights w = weights_at(td_swaps_length(at, k), s);
    view_at(at, of->object, k, &w, r, t);
    mean_at(of, k, &w, mean);
    for (int i = 0; i < 3; i++) p[i] = td_dot3(r + 3 * i, mean) + t[i];
    if (!(p[2] > image->near)) return 0;
    const double x = td_lesser(td_greater(p[0] / p[2], image->limit_x0), image->limit_x1);
    const double y = td_lesser(td_greater(p[1] / p[2], image->limit_y0), image->limit_y1);
    for (int j = 0; j < 3; j++) {
        double axis[3];
        for (int i = 0; i < 3; i++) axis[i] = r[3 * i] * m[j] + r[3 * i + 1] * m[3 + j] + r[3 * i + 2] * m[6 + j];
        row[0][j] = image->fx / p[2] * (axis[0] - x * axis[2]);
        row[1][j] = image->fy / p[2] * (axis[1] - y * axis[2]);
    }
    double a = image->dilation, b = 0, c = image->dilation;
    for (int j = 0; j < 3; j++) a += row[0][j] * row[0][j], b += row[0][j] * row[1][j], c += row[1][j] * row[1][j];
    const double det = a * c - b * b;
    *f = (form){image->fx * p[0] / p[2] + image->cx,
                image->fy * p[1] / p[2] + image->cy,
                c / det,
                -b / det,
                a / det,
                -td_ln(of->opacity)};
    return det > 0;
}

/* The least value of the sum of two forms in a block, approximately: at the sum's minimum, clamped into the block. */
static double least_in(const form *f, const form *g, double x0, double y0) {
    const double a = f->a + g->a, b = f->b + g->b, c = f->c + g->c, det = a * c - b * b;
    const double p = f->a * f->u + f->b * f->v + g->a * g->u + g->b * g->v,
                 q = f->b * f->u + f->c * f->v + g->b * g->u + g->c * g->v;
    const double x = td_lesser(td_greater((c * p - b * q) / det, x0), x0 + TD_BLOCK),
                 y = td_lesser(td_greater((a * q - b * p) / det, y0), y0 + TD_BLOCK);
    double least = form_at(f, x, y) + form_at(g, x, y);
    for (int i = 0; i < 4; i++) {
        const double corner_x = x0 + i % 2 * TD_BLOCK, corner_y = y0 + i / 2 * TD_BLOCK;
        least = td_lesser(least, form_at(f, corner_x, corner_y) + form_at(g, corner_x, corner_y));
    }
    return least;
}

/* -- a pair ---------------------------------------------------------------------------------------------------------------- */

/* The blocks of a tile that both boxes touch, as bits. corner: the tile's first pixel. */
static unsigned blocks_of(const td_swap_splat *a, const td_swap_splat *b, const int corner[2]) {
    unsigned columns = 0, rows = 0;
    const double left = td_greater((double)a->box[0], (double)b->box[0]) - corner[0],
                 right = td_lesser((double)a->box[2], (double)b->box[2]) - corner[0];
    const double top = td_greater((double)a->box[1], (double)b->box[1]) - corner[1],
                 bottom = td_lesser((double)a->box[3], (double)b->box[3]) - corner[1];
    for (int k = 0; k < TD_TILE / TD_BLOCK; k++) {
        const int from = k * TD_BLOCK, to = from + TD_BLOCK;
        if (left <= to && right >= from) columns |= 0x1111u << k;
        if (top <= to && bottom >= from) rows |= 0xfu << 4 * k;
    }
    return columns & rows;
}

/* Two splats of a tile, and where their swaps are stored. */
typedef struct pair {
    td_swap_tile *tile;
    const td_swap_splat *a, *b;
    unsigned blocks;
    double contrast, slow;
} pair;

/* The least value of the sum of two forms in a block of the tile. */
static double least_of(const pair *of, int block, const form *f, const form *g) {
    const int *corner = of->tile->corner;
    return least_in(f, g, corner[0] + block % 4 * TD_BLOCK, corner[1] + block / 4 * TD_BLOCK);
}

/* Finds the light that a swap moves in blocks of the tile. Through a lens the splats' places aren't computed, and may be
 * anywhere. Returns 0 if one is behind the camera. */
static int find_lights(const pair *of, int k, double s, unsigned blocks, double light[TD_TILE_BLOCKS]) {
    form f, g;
    const td_image *image = of->tile->image;
    const td_swap_samples *at = of->tile->at;
    const int lens = td_lens_model(image);
    if (!lens && (!find_form(image, at, of->a, k, s, &f) || !find_form(image, at, of->b, k, s, &g))) return 0;
    for (int i = 0; i < TD_TILE_BLOCKS; i++)
        if (blocks >> i & 1)
            light[i] = of->contrast * (lens ? of->a->opacity * of->b->opacity : td_exp(-least_of(of, i, &f, &g)));
    return 1;
}

/* Finds the most that a splat takes in each block of the tile, once for a part. */
static int find_taken(const pair *of, const td_swap_splat *splat, int k, double s, int32_t part) {
    static const form none;
    td_swap_taken *taken = splat->taken;
    form f;
    if (taken->part == part) return 1;
    if (!find_form(of->tile->image, of->tile->at, splat, k, s, &f)) return 0;
    for (int i = 0; i < TD_TILE_BLOCKS; i++) taken->share[i] = td_exp(-least_of(of, i, &f, &none));
    taken->part = part;
    return 1;
}

/* Finds the light that a swap moves in each block, or somewhat more: by the most that both splats take there. */
static int find_most_lights(const pair *of, int k, double s, int32_t part, double light[TD_TILE_BLOCKS]) {
    if (!find_taken(of, of->a, k, s, part) || !find_taken(of, of->b, k, s, part)) return 0;
    const double *a = of->a->taken->share, *b = of->b->taken->share;
    for (int i = 0; i < TD_TILE_BLOCKS; i++) light[i] = of->contrast * a[i] * b[i];
    return 1;
}

/* Place s of part k in the interval, and a part's length, in 1 / TD_SWAP_PARTS of the interval. */
static long place_in(const td_swap_samples *at, int k, double s) {
    return lround(TD_SWAP_PARTS * ((at->time[k] - at->time[0] + s * td_swaps_length(at, k)) / td_swaps_span(at)));
}
static double per_part(const td_swap_samples *at, int k) {
    return TD_SWAP_PARTS * (td_swaps_length(at, k) / td_swaps_span(at));
}

/* Notes a swap at place s in part k, `wide` parts to either side, for each block that sees both splats. */
static void note_time(const pair *of, int k, double s, double wide) {
    double light[TD_TILE_BLOCKS];
    const td_swap_samples *at = of->tile->at;
    const double lasts = wide * per_part(at, k);
    const long part = place_in(at, k, s);
    if (part < 1 || part >= TD_SWAP_PARTS || !(lasts < of->slow * TD_SWAP_PARTS)) return;
    td_swap_sum *sum = td_swaps_sum(of->tile, (int32_t)part, (float)lasts);
    const unsigned blocks = sum ? of->blocks & ~sum->whole : of->blocks;
    if (!blocks) return;
    if (sum && !td_lens_model(of->tile->image) ? !find_most_lights(of, k, s, (int32_t)part, light)
                                               : !find_lights(of, k, s, blocks, light))
        return;
    for (int i = 0; i < TD_TILE_BLOCKS && of->tile->status == TIDES_OK; i++) {
        if (!(blocks >> i & 1) || light[i] < TD_SWAP_LEAST_LIGHT) continue;
        const td_swap swap = {of->tile->tile * TD_TILE_BLOCKS + i, (int32_t)part, (float)light[i], (float)lasts};
        td_swaps_add(of->tile, &swap, sum);
    }
}

static double value_of(const double b[4], double s) {
    const double r = 1 - s;
    return r * r * (r * b[0] + 3 * s * b[1]) + s * s * (3 * r * b[2] + s * b[3]);
}

static double slope_of(const double b[4], double s) {
    const double r = 1 - s;
    return 3 * (r * r * (b[1] - b[0]) + 2 * r * s * (b[2] - b[1]) + s * s * (b[3] - b[2]));
}

static double bend_of(const double b[4], double s) {
    return 6 * ((1 - s) * (b[0] - 2 * b[1] + b[2]) + s * (b[1] - 2 * b[2] + b[3]));
}

/* Where in [from, to] a cubic passes a level, found by so many halvings. It may pass the level once there. */
static double reach(const double b[4], double level, double from, double to, int halvings) {
    const int begins_below = value_of(b, from) < level;
    for (int i = 0; i < halvings; i++) {
        const double middle = 0.5 * (from + to);
        if ((value_of(b, middle) < level) == begins_below)
            from = middle;
        else
            to = middle;
    }
    return 0.5 * (from + to);
}

/* Notes the zero of the cubic in [from, to], where it is monotone, if it has one. That of the former pair is tried first, since
 * coplanar splats of one body all pass at one time. */
static void note_level(const double b[4], double from, double to, double within, const pair *of, int k) {
    enum { HALVINGS = 24 };
    static const double same = 0x1p-25;
    double *s = &of->tile->zero;
    if ((value_of(b, from) < 0) == (value_of(b, to) < 0)) return;
    if (!(*s - same > from && *s + same < to) || (value_of(b, *s - same) < 0) == (value_of(b, *s + same) < 0))
        *s = reach(b, 0, from, to, HALVINGS);
    note_time(of, k, *s, within / fabs(slope_of(b, *s)));
}

/* The cubic's turning points within (0, 1), in order. */
static int turns_of(const double b[4], double turn[2]) {
    const double p = b[1] - b[0], q = b[2] - b[1], r = b[3] - b[2], a = p - 2 * q + r, half = q - p;
    const double inside = half * half - a * p;
    int count = 0;
    if (!(inside > 0) || (p * q > 0 && q * r > 0)) return 0;
    const double far = -(half + (half < 0 ? -1 : 1) * sqrt(inside)), root[2] = {far / a, p / far};
    for (int i = 0; i < 2; i++)
        if (root[i] > 0 && root[i] < 1) turn[count++] = root[i];
    if (count == 2 && turn[0] > turn[1]) {
        const double first = turn[1];
        turn[1] = turn[0], turn[0] = first;
    }
    return count;
}

/* Notes the times within part k at which two splats have equal depths, or turn back within reach of each other. */
static void note_part(const pair *of, double near, int k) {
    const td_swap_splat *a = of->a, *b = of->b;
    const double third = td_swaps_length(of->tile->at, k) / 3, d0 = a->z[k] - b->z[k], d1 = a->z[k + 1] - b->z[k + 1];
    const double c[4] = {d0, d0 + third * (a->z_dot[k] - b->z_dot[k]), d1 - third * (a->z_dot[k + 1] - b->z_dot[k + 1]), d1};
    const double within = near * fabs(a->z[k]);
    double end[4] = {0};
    if (td_least4(c) > within || td_most4(c) < -within) return;
    /* Depths that pass so slowly are seen by samples (note_time). No bend is more than 4 times the steepest slope. */
    const double slow = of->slow * TD_SWAP_PARTS / per_part(of->tile->at, k);
    const double steepest = 3 * td_greater(td_greater(fabs(c[1] - c[0]), fabs(c[2] - c[1])), fabs(c[3] - c[2]));
    if (within >= slow * steepest && within >= 2 * slow * slow * steepest) return;
    const int turns = turns_of(c, end + 1);
    end[turns + 1] = 1;
    for (int i = 0; i <= turns; i++) {
        note_level(c, end[i], end[i + 1], within, of, k);
        if (i < turns && fabs(value_of(c, end[i + 1])) < within)
            note_time(of, k, end[i + 1], sqrt(2 * within / fabs(bend_of(c, end[i + 1]))));
    }
}

/* -- fades at the near plane ----------------------------------------------------------------------------------------------- */

/* A splat that fades passes the taper (image.rules smooth) faster than it comes: in a pixel, alpha goes from 1 / 255 to a tenth
 * of that within a third of the fade. What the taper takes then is at most this share of 1 / 255: the greatest x (1 - s(x)) of
 * its quintic s. Pixels of a block pass it a little before or after its middle. */
static const double taken = 0.26, unevenly = 1.3;

/* The halvings by which places and depths of a fade are found. */
enum { FADE_HALVINGS = 16 };

/* The depth at which a splat has faded to this share of its opacity: smootherstep undone. */
static double faded_to(const td_image *image, double share) {
    double from = 0, to = 1;
    for (int i = 0; i < FADE_HALVINGS; i++) {
        const double x = 0.5 * (from + to);
        if (x * x * x * (10 + x * (6 * x - 15)) < share)
            from = x;
        else
            to = x;
    }
    return image->near + from * (image->near_full - image->near);
}

/* Notes when alpha passes the taper in a block, for a splat that fades at the near plane in part k. z: its depths, a cubic. */
static void note_fade(td_swap_tile *tile, const td_swap_splat *a, const form *f, int block, const double z[4], int k) {
    const td_image *image = tile->image;
    const double x = tile->corner[0] + (block % 4 + 0.5) * TD_BLOCK, y = tile->corner[1] + (block / 4 + 0.5) * TD_BLOCK;
    const double least = image->cut * td_exp(form_at(f, x, y)), most = image->cut_full / image->cut * least;
    if (!(least < 1)) return;
    const double begin = reach(z, faded_to(image, least), 0, 1, FADE_HALVINGS);
    const double end = reach(z, faded_to(image, td_lesser(most, 1)), 0, 1, FADE_HALVINGS);
    const double wide = unevenly * 0.5 * fabs(end - begin) * per_part(tile->at, k);
    const double light = taken * image->cut_full * a->luminance;
    const long part = place_in(tile->at, k, 0.5 * (begin + end));
    const td_swap swap = {tile->tile * TD_TILE_BLOCKS + block, (int32_t)part, (float)light, (float)wide};
    if (part < 1 || part >= TD_SWAP_PARTS || !(wide > 0 && wide < TD_SWAP_SLOW * TD_SWAP_PARTS)) return;
    if (light >= TD_SWAP_LEAST_LIGHT && tile->status == TIDES_OK) td_swaps_add(tile, &swap, NULL);
}

void td_swaps_look_at_fade(td_swap_tile *tile, const td_swap_splat *a) {
    const td_image *image = tile->image;
    const unsigned blocks = blocks_of(a, a, tile->corner);
    for (int k = 0; k < tile->at->parts; k++) {
        form f;
        const double third = td_swaps_length(tile->at, k) / 3, from = a->z[k], to = a->z[k + 1];
        const double z[4] = {from, from + third * a->z_dot[k], to - third * a->z_dot[k + 1], to};
        if (td_greater(from, to) <= image->near || td_lesser(from, to) >= image->near_full) continue;
        const double s = reach(z, faded_to(image, 0.5), 0, 1, FADE_HALVINGS);
        if (!find_form(image, tile->at, a, k, s, &f)) continue;
        for (int i = 0; i < TD_TILE_BLOCKS; i++)
            if (blocks >> i & 1) note_fade(tile, a, &f, i, z, k);
    }
}

/* -------------------------------------------------------------------------------------------------------------------------- */

/* 1 if the boxes don't overlap. */
static int are_apart(const td_swap_splat *a, const td_swap_splat *b) {
    return a->box[0] > b->box[2] || b->box[0] > a->box[2] || a->box[1] > b->box[3] || b->box[1] > a->box[3];
}

void td_swaps_look_at(td_swap_tile *tile, const td_swap_splat *a, const td_swap_splat *b, double slow) {
    const double contrast = fabs(a->luminance - b->luminance) + a->varies + b->varies;
    if (a->opacity * b->opacity * contrast < TD_SWAP_LEAST_LIGHT || are_apart(a, b)) return;
    const pair of = {tile, a, b, blocks_of(a, b, tile->corner), contrast, slow};
    const double near = TD_SWAP_REACH * tile->image->soft_depth;
    for (int k = 0; k < tile->at->parts && of.blocks; k++) note_part(&of, near, k);
}
