/* A pixel's signal on a step: its value, its bounds, and where it crosses a level. */
#include "td_path.h"
#include "td_path_parts.h"
#include "td_pieces.h"

#include <float.h>
#include <math.h>

/* -- values -------------------------------------------------------------------------------------------------------------- */

static double direct_value(const td_path *path, double s) {
    double value = td_model_value(&path->cubic, s);
    for (int k = 0; k < path->modes; k++) value += td_mode_value(&path->mode[k], s);
    return value;
}

static double direct_slope(const td_path *path, double s) {
    double slope = td_model_slope(&path->cubic, s);
    for (int k = 0; k < path->modes; k++) slope += td_mode_slope(&path->mode[k], s);
    return slope;
}

/* The piece that holds s. */
static void find_piece(td_pieces *pieces, const td_path *path, double s) {
    td_pieces_begin(pieces, &path->drive);
    while (td_pieces_next(pieces) && pieces->to < s) continue;
}

static double place_in(const td_pieces *pieces, double s) {
    return fmin(fmax((s - pieces->from) / (pieces->to - pieces->from), 0), 1);
}

double td_path_value(const td_path *path, double s) {
    td_pieces pieces;
    if (!path->drive.frontend) return direct_value(path, s);
    find_piece(&pieces, path, s);
    return direct_value(path, s) + direct_value(&pieces.path, place_in(&pieces, s));
}

double td_path_slope(const td_path *path, double s) {
    td_pieces pieces;
    if (!path->drive.frontend) return direct_slope(path, s);
    find_piece(&pieces, path, s);
    return direct_slope(path, s) + direct_slope(&pieces.path, place_in(&pieces, s)) / (pieces.to - pieces.from);
}

/* -- bounds -------------------------------------------------------------------------------------------------------------- */

void td_path_range(const td_path *path, double *low, double *high) {
    const double *b = path->cubic.control;
    double size = 0;
    *low = *high = b[0];
    for (int i = 0; i < 4; i++) {
        *low = b[i] < *low ? b[i] : *low;
        *high = b[i] > *high ? b[i] : *high;
        size = fmax(size, fabs(b[i]));
    }
    if (path->modes == 0 && !path->drive.frontend) return;
    double mode_low = path->drive.low, mode_high = path->drive.high;
    for (int k = 0; k <= path->modes; k++) { /* the drive's bounds, or 0 and 0, first */
        *low += mode_low;
        *high += mode_high;
        size += fmax(fabs(mode_low), fabs(mode_high));
        if (k < path->modes) td_mode_range(&path->mode[k], &mode_low, &mode_high);
    }
    *low -= 16 * DBL_EPSILON * size;
    *high += 16 * DBL_EPSILON * size;
}

/* -- crossings ----------------------------------------------------------------------------------------------------------- */

/* The walk over [from, to] only: its knots between them, and both. */
static void cut(td_crossing_walk *walk, double from, double to) {
    td_crossing_walk all = *walk;
    walk->knots = 0;
    walk->s = from;
    walk->knot[walk->knots] = from;
    walk->value[walk->knots++] = td_model_value(&all.model, from);
    for (int i = 0; i < all.knots && to > from; i++) {
        if (!(all.knot[i] > from && all.knot[i] < to)) continue;
        walk->knot[walk->knots] = all.knot[i];
        walk->value[walk->knots++] = all.value[i];
    }
    if (!(to > from)) return;
    walk->knot[walk->knots] = to;
    walk->value[walk->knots++] = td_model_value(&all.model, to);
}

int td_cubic_crossing(const td_model *cubic, double reference, double threshold_on, double threshold_off, double from,
                      double to, double *s) {
    td_crossing_walk walk;
    td_crossing_begin(&walk, cubic);
    cut(&walk, from, to);
    int polarity = td_crossing_next(&walk, reference, threshold_on, threshold_off);
    *s = walk.s;
    return polarity;
}

static int is_finite(const td_path *path) {
    int finite = td_model_is_finite(&path->cubic);
    for (int k = 0; k < path->modes; k++) {
        const td_mode *mode = &path->mode[k];
        finite &= isfinite(mode->rate) && isfinite(mode->frequency) && isfinite(mode->cosine) && isfinite(mode->sine);
    }
    return finite;
}

static int crossing_in_pieces(const td_path *path, double reference, double threshold_on, double threshold_off, double from,
                              double to, double *s) {
    td_pieces pieces;
    td_pieces_begin(&pieces, &path->drive);
    while (td_pieces_next(&pieces) && pieces.from <= to) {
        if (pieces.to < from) continue;
        td_path piece = pieces.path;
        td_model more = td_model_part(&path->cubic, pieces.from, pieces.to);
        for (int i = 0; i < 4; i++) piece.cubic.control[i] += more.control[i];
        double begin = place_in(&pieces, from), end = place_in(&pieces, to), u;
        int polarity = td_path_crossing(&piece, reference, threshold_on, threshold_off, begin, end, &u);
        if (polarity == 0) continue;
        *s = fmin(fmax(pieces.from + u * (pieces.to - pieces.from), from), to);
        return polarity;
    }
    *s = to;
    return 0;
}

int td_path_crossing(const td_path *path, double reference, double threshold_on, double threshold_off, double from, double to,
                     double *s) {
    if (path->modes == 0 && !path->drive.frontend)
        return td_cubic_crossing(&path->cubic, reference, threshold_on, threshold_off, from, to, s);
    double low, high;
    *s = to;
    td_path_range(path, &low, &high);
    if (!is_finite(path) || !(high - reference >= threshold_on || low - reference <= -threshold_off)) return 0;
    if (path->drive.frontend) return crossing_in_pieces(path, reference, threshold_on, threshold_off, from, to, s);
    return td_modes_crossing(path, reference, threshold_on, threshold_off, from, to, s);
}
