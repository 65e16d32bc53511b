/* A pixel's signal on a step: its value, its bounds, and where it crosses a level. */
#include "td_response.h"
#include "td_modes.h"
#include "td_substeps.h"

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
    int stretch = path->drive.stretches - 1;
    while (stretch > 0 && path->drive.stretch[stretch].from > s) stretch--;
    td_pieces_begin(pieces, &path->drive, stretch);
    while (td_pieces_next(pieces) && pieces->to < s) continue;
}

double td_path_value(const td_path *path, double s) {
    td_pieces pieces;
    if (!path->drive.frontend) return direct_value(path, s);
    find_piece(&pieces, path, s);
    return direct_value(path, s) + direct_value(&pieces.path, td_pieces_place(&pieces, s));
}

double td_path_slope(const td_path *path, double s) {
    td_pieces pieces;
    if (!path->drive.frontend) return direct_slope(path, s);
    find_piece(&pieces, path, s);
    return direct_slope(path, s) + direct_slope(&pieces.path, td_pieces_place(&pieces, s)) * td_pieces_speed(&pieces, s);
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
    double mode_low = path->drive.frontend ? INFINITY : 0, mode_high = -mode_low;
    for (int k = 0; path->drive.frontend && k < path->drive.stretches; k++) {
        mode_low = fmin(mode_low, path->drive.stretch[k].low);
        mode_high = fmax(mode_high, path->drive.stretch[k].high);
    }
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

static int is_finite(const td_path *path) {
    int finite = td_model_is_finite(&path->cubic);
    for (int k = 0; k < path->modes; k++) {
        const td_mode *mode = &path->mode[k];
        finite &= isfinite(mode->rate) && isfinite(mode->frequency) && isfinite(mode->cosine) && isfinite(mode->sine);
    }
    return finite;
}

/* A level, and the part of the step in which it is looked for. */
typedef struct request {
    double reference, on, off, from, to;
} request;

/* 1 where a stretch's bounds with the cubic's on it reach a level. */
static int may_reach(const td_path *path, int stretch, double until, const request *asked) {
    td_path part;
    double low, high;
    td_model cubic = td_model_part(&path->cubic, path->drive.stretch[stretch].from, until);
    td_path_set(&part, &cubic);
    td_path_range(&part, &low, &high);
    low += path->drive.stretch[stretch].low - asked->reference;
    high += path->drive.stretch[stretch].high - asked->reference;
    return high >= asked->on || low <= -asked->off;
}

/* A crossing in the warped time of a piece took what is added to its path as a cubic of that time; one Newton step with S
 * itself mends what that is off by, where S isn't about to turn. */
static double mend(const td_path *path, const td_pieces *pieces, const request *asked, int polarity, double s) {
    if (!pieces->warp.on || s <= asked->from) return s;
    double v = td_pieces_place(pieces, s), level = asked->reference + (polarity > 0 ? asked->on : -asked->off);
    double off = td_model_value(&path->cubic, s) + direct_value(&pieces->path, v) - level;
    double slope = td_model_slope(&path->cubic, s) + direct_slope(&pieces->path, v) * td_pieces_speed(pieces, s);
    double step = off / slope;
    return fabs(step) <= 1e-5 * (pieces->to - pieces->from) ? s - step : s;
}

static int crossing_in_stretch(const td_path *path, int stretch, double until, const request *asked, double *s) {
    td_pieces pieces;
    td_pieces_begin(&pieces, &path->drive, stretch);
    while (pieces.to < until && td_pieces_next(&pieces)) {
        if (pieces.to < asked->from || pieces.from > asked->to) continue;
        td_path piece;
        td_pieces_with(&pieces, &path->cubic, &piece);
        double begin = td_pieces_place(&pieces, asked->from), end = td_pieces_place(&pieces, asked->to), v;
        int polarity = td_path_crossing(&piece, asked->reference, asked->on, asked->off, begin, end, &v);
        if (polarity == 0) continue;
        *s = mend(path, &pieces, asked, polarity, td_pieces_time(&pieces, v));
        *s = fmin(fmax(*s, asked->from), asked->to);
        return polarity;
    }
    return 0;
}

static int crossing_in_pieces(const td_path *path, const request *asked, double *s) {
    const td_drive *drive = &path->drive;
    for (int k = 0; k < drive->stretches; k++) {
        double until = k + 1 < drive->stretches ? drive->stretch[k + 1].from : 1;
        if (until < asked->from || drive->stretch[k].from > asked->to || !may_reach(path, k, until, asked)) continue;
        int polarity = crossing_in_stretch(path, k, until, asked, s);
        if (polarity) return polarity;
    }
    return 0;
}

int td_path_crossing(const td_path *path, double reference, double threshold_on, double threshold_off, double from, double to,
                     double *s) {
    if (path->modes == 0 && !path->drive.frontend)
        return td_crossing_within(&path->cubic, reference, threshold_on, threshold_off, from, to, s);
    double low, high;
    *s = to;
    td_path_range(path, &low, &high);
    if (!is_finite(path) || !(high - reference >= threshold_on || low - reference <= -threshold_off)) return 0;
    if (!path->drive.frontend) return td_modes_crossing(path, reference, threshold_on, threshold_off, from, to, s);
    request asked = {reference, threshold_on, threshold_off, from, to};
    return crossing_in_pieces(path, &asked, s);
}
