/* Sweeps in pieces for those Gaussians whose motion happens on a shorter scale of time than the interval: frames denser than
 * that, a bell of opacity within it, a fast sine. Each is swept in as many pieces as its own scale asks for. */
#include "motion/td_motion.h"
#include "render/td_render.h"

#include <math.h>
#include <stdlib.h>

/* Widths from its centre within which a bell exp(-(dt / width)^2) rises over smooth's cut: at 3 it is 1.2e-4. */
static const double bell_reach = 3;
/* Scales this much below the interval's length, by rounding, don't count. */
static const double slack = 1e-6;

/* The shortest distance between knots of which one is within the interval, in own time; INFINITY where none is. */
static double knot_distance(const td_moved_part *part, double from, double to) {
    double least = INFINITY;
    for (size_t k = 1; k < part->knots; k++) {
        int within = (part->knot_tau[k] > from && part->knot_tau[k] < to) ||
                     (part->knot_tau[k - 1] > from && part->knot_tau[k - 1] < to);
        if (within) least = fmin(least, part->knot_tau[k] - part->knot_tau[k - 1]);
    }
    return least;
}

/* Halvings of `length` until pieces aren't longer than `scale`. */
static int level_for(double length, double scale) {
    int level = 0;
    for (; level < TD_STRAY_LEVELS - 1 && length > scale * (1 + slack); level++) length *= 0.5;
    return level;
}

/* The scale that holds for one Gaussian of own time [from, to], with `all` that of its part. */
static double scale_of(const td_time_scale *own, double all, double from, double to) {
    double reach = bell_reach * own->width, scale = fmin(fmax(all, own->smooth), own->always);
    int active = isfinite(reach) && own->centre + reach > from && own->centre - reach < to;
    return active ? fmin(scale, own->width) : scale;
}

/* Levels of a part's Gaussians over own time [from, to], and the highest. */
static tides_status find_levels(td_moved *moved, td_moved_part *part, double from, double to, int *highest,
                                tides_error *error) {
    const tides_motion *motion = part->of.motion;
    double all = fmin(knot_distance(part, from, to), motion->type->scale ? motion->type->scale(motion, from, to) : INFINITY);
    int common = level_for(to - from, all);
    tides_status status = common > 0 ? td_moved_find_scales(moved->store, part, error) : TIDES_OK;
    *highest = 0;
    for (int i = 0; i < part->count && status == TIDES_OK; i++) {
        int level = part->scale ? level_for(to - from, scale_of(&part->scale[i], all, from, to)) : common;
        moved->level[part->base + i] = (uint8_t)level;
        *highest = level > *highest ? level : *highest;
    }
    return status;
}

/* Rows of `count` Gaussians at all times of the sweep in hand, one time after the other. */
static tides_status move_chunk(tides_renderer *r, const td_moved_part *part, const int *gaussians, int count, int times,
                               int *rows, tides_error *error) {
    td_moved *moved = &r->moved;
    tides_status status = TIDES_OK;
    td_rows_begin(moved, r->store.count + moved->kept_rows);
    for (int i = 0; i < times && status == TIDES_OK; i++) {
        int first = moved->rows.count;
        rows[i] = moved->rows.row + first;
        status = td_rows_reserve(moved, count + TD_PAD, error);
        for (int k = 0; k < count && status == TIDES_OK; k++) td_rows_add(moved, part, gaussians[k]);
        if (status == TIDES_OK) status = td_rows_end_run(moved, part, first, r->sweep_time[i], i == times - 1 ? -1 : 1, error);
    }
    return status == TIDES_OK ? td_rows_send(moved, r->backend, error) : status;
}

/* Boxes and travel of `count` listed Gaussians, from 2^level pieces. */
static tides_status sweep_chunk(tides_renderer *r, const td_moved_part *part, const int *gaussians, int count, int level,
                                int *rows, double duration, tides_error *error) {
    td_moved *moved = &r->moved;
    int padded = (count + TD_PAD - 1) / TD_PAD * TD_PAD;
    tides_status status = move_chunk(r, part, gaussians, count, td_sweep_times(level), rows, error);
    const td_sweep_request request = {(const double *)r->views, r->strays.bound, duration, level, 0, padded, rows};
    if (status == TIDES_OK) status = r->backend->type->sweep(r->backend, &request, moved->fine_box, moved->fine_travel, error);
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        memcpy(r->boxes + 4 * (size_t)gaussians[k], moved->fine_box + 4 * (size_t)k, 4 * sizeof *r->boxes);
        r->travel[gaussians[k]] = moved->fine_travel[k];
        /* Rows between those of the start, the middle and the end aren't what these say. */
        if (moved->misfit) moved->misfit[part->base + gaussians[k] - part->first] = INFINITY;
    }
    return status;
}

/* A part's Gaussians of one level. */
static tides_status sweep_level(tides_renderer *r, const td_moved_part *part, int level, int *rows, double duration,
                                tides_error *error) {
    td_moved *moved = &r->moved;
    int listed = 0, chunk = r->row_limit / td_sweep_times(level) / TD_PAD * TD_PAD;
    tides_status status = TIDES_OK;
    if (chunk < TD_PAD) chunk = TD_PAD;
    for (int i = 0; i < part->count; i++)
        if (moved->level[part->base + i] == level) moved->fine[listed++] = part->first + i;
    for (int from = 0; from < listed && status == TIDES_OK; from += chunk)
        status = sweep_chunk(r, part, moved->fine + from, listed - from < chunk ? listed - from : chunk, level, rows, duration,
                             error);
    return status;
}

/* All parts' Gaussians, level by level: views at a level's times are made once. */
static tides_status sweep_levels(tides_renderer *r, const tides_trajectory *camera, double start, double stop,
                                 const int *highest, int most, tides_error *error) {
    int *rows = td_alloc((size_t)td_sweep_times(most), sizeof *rows, error);
    tides_status status = rows ? TIDES_OK : TIDES_NO_MEMORY;
    for (int level = 1; level <= most && status == TIDES_OK; level++) {
        int used = 0;
        for (int i = 0; i < r->moved.moving; i++) used |= r->moved.level[i] == level;
        if (!used) continue;
        status = td_renderer_sweep_views(r, camera, start, stop, level, error);
        for (int p = 0; p < r->moved.parts && status == TIDES_OK; p++)
            if (highest[p] >= level) status = sweep_level(r, &r->moved.part[p], level, rows, stop - start, error);
    }
    free(rows);
    return status;
}

tides_status td_moved_sweep_fine(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                 tides_error *error) {
    td_moved *moved = &renderer->moved;
    int most = 0;
    if (!(start < stop)) return TIDES_OK;
    int *highest = td_alloc((size_t)moved->parts, sizeof *highest, error);
    if (!highest) return TIDES_NO_MEMORY;
    memset(moved->level, 0, (size_t)moved->moving * sizeof *moved->level);
    tides_status status = TIDES_OK;
    for (int p = 0; p < moved->parts && status == TIDES_OK; p++) {
        td_moved_part *part = &moved->part[p];
        double from = 0, to = 0, rate;
        status = td_motion_time(part->of.motion, part->of.duration_s, moved->epoch + start, &from, &rate, error);
        if (status == TIDES_OK)
            status = td_motion_time(part->of.motion, part->of.duration_s, moved->epoch + stop, &to, &rate, error);
        if (status == TIDES_OK) status = find_levels(moved, part, from, to, &highest[p], error);
        most = highest[p] > most ? highest[p] : most;
    }
    if (status == TIDES_OK && most > 0) status = sweep_levels(renderer, camera, start, stop, highest, most, error);
    free(highest);
    return status;
}
