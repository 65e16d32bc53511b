/* Sweeps in pieces for those dynamic Gaussians whose motion has a shorter scale of time than the interval: dense keyframes, a
 * short bell of opacity, a fast sine. Each is swept in as many pieces as its own scale needs, after the ordinary sweep. The
 * motion models declare the scales. */
#include "motion/td_motion.h"
#include "render/td_renderer.h"

#include <math.h>
#include <stdlib.h>

/* A bell exp(-(dt / width)^2) is above the cutoff of `smooth` within so many widths of its centre: at 3 it is 1.2e-4. */
static const double bell_reach = 3;
/* Rounding may make a scale of time shorter than the interval by this share. */
static const double slack = 1e-6;

/* The shortest distance between knots, one of which is in the interval, in own time; INFINITY if none is. */
static double knot_distance(const td_dynamic_object *object, double from, double to) {
    double least = INFINITY;
    for (size_t k = 1; k < object->knots; k++) {
        int within = (object->knot_tau[k] > from && object->knot_tau[k] < to) ||
                     (object->knot_tau[k - 1] > from && object->knot_tau[k - 1] < to);
        if (within) least = fmin(least, object->knot_tau[k] - object->knot_tau[k - 1]);
    }
    return least;
}

/* How often `length` must be halved until it isn't longer than `scale`. */
static int level_for(double length, double scale) {
    int level = 0;
    for (; level < TD_STRAY_LEVELS - 1 && length > scale * (1 + slack); level++) length *= 0.5;
    return level;
}

/* The scale of one Gaussian in own time [from, to]; `all` is its object's. */
static double scale_of(const td_time_scale *own, double all, double from, double to) {
    double reach = bell_reach * own->width, scale = fmin(fmax(all, own->smooth), own->always);
    int active = isfinite(reach) && own->centre + reach > from && own->centre - reach < to;
    return active ? fmin(scale, own->width) : scale;
}

/* The scale common to all of an object's Gaussians in own time [from, to]. */
static double common_scale(const td_dynamic_object *object, double from, double to) {
    const tides_motion *motion = object->of.motion;
    return fmin(knot_distance(object, from, to), motion->type->scale ? motion->type->scale(motion, from, to) : INFINITY);
}

/* Finds the levels of an object's Gaussians over own time [from, to], and the highest. */
static tides_status find_levels(td_dynamic *dynamic, td_dynamic_object *object, double from, double to, int *highest,
                                tides_error *error) {
    double all = common_scale(object, from, to);
    int common = level_for(to - from, all);
    tides_status status = common > 0 ? td_dynamic_find_scales(dynamic->store, object, error) : TIDES_OK;
    *highest = 0;
    for (int i = 0; i < object->count && status == TIDES_OK; i++) {
        int level = object->scale ? level_for(to - from, scale_of(&object->scale[i], all, from, to)) : common;
        dynamic->level[object->base + i] = (uint8_t)level;
        *highest = level > *highest ? level : *highest;
    }
    return status;
}

/* Computes rows of `count` Gaussians at all times of the current sweep, one time after the other. */
static tides_status move_chunk(tides_renderer *r, const td_dynamic_object *object, const int *gaussians, int count, int times,
                               int *rows, tides_error *error) {
    td_dynamic *dynamic = &r->dynamic;
    tides_status status = TIDES_OK;
    td_rows_begin(dynamic, r->store.count + dynamic->cached_rows);
    for (int i = 0; i < times && status == TIDES_OK; i++) {
        int first = dynamic->rows.count;
        rows[i] = dynamic->rows.row + first;
        status = td_rows_reserve(dynamic, count + TD_PAD, error);
        for (int k = 0; k < count && status == TIDES_OK; k++) td_rows_add(dynamic, object, gaussians[k]);
        if (status == TIDES_OK)
            status = td_rows_end_run(dynamic, object, first, r->sweep.times[i], i == times - 1 ? -1 : 1, error);
    }
    return status == TIDES_OK ? td_rows_send(dynamic, r->backend, error) : status;
}

/* Computes boxes and travel of `count` listed Gaussians, from 2^level pieces. */
static tides_status sweep_chunk(tides_renderer *r, const td_dynamic_object *object, const int *gaussians, int count, int level,
                                int *rows, double duration, tides_error *error) {
    td_dynamic *dynamic = &r->dynamic;
    int padded = (count + TD_PAD - 1) / TD_PAD * TD_PAD;
    tides_status status = move_chunk(r, object, gaussians, count, td_sweep_times(level), rows, error);
    const td_sweep_request request = {.views = (const double *)r->scratch.views,
                                      .strays = r->sweep.strays.bound,
                                      .duration = duration,
                                      .level = level,
                                      .end = padded,
                                      .rows = rows};
    if (status == TIDES_OK)
        status = r->backend->type->sweep(r->backend, &request, dynamic->fine_box, dynamic->fine_travel, error);
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        memcpy(r->sweep.boxes + 4 * (size_t)gaussians[k], dynamic->fine_box + 4 * (size_t)k, 4 * sizeof *r->sweep.boxes);
        r->sweep.travel[gaussians[k]] = dynamic->fine_travel[k];
        /* Three rows can't represent this motion: rows in between must not be interpolated. */
        if (dynamic->misfit) dynamic->misfit[object->base + gaussians[k] - object->first] = INFINITY;
    }
    return status;
}

/* Sweeps an object's Gaussians of one level. */
static tides_status sweep_level(tides_renderer *r, const td_dynamic_object *object, int level, int *rows, double duration,
                                tides_error *error) {
    td_dynamic *dynamic = &r->dynamic;
    int listed = 0, chunk = r->row_limit / td_sweep_times(level) / TD_PAD * TD_PAD;
    tides_status status = TIDES_OK;
    if (chunk < TD_PAD) chunk = TD_PAD;
    for (int i = 0; i < object->count; i++)
        if (dynamic->level[object->base + i] == level) dynamic->fine[listed++] = object->first + i;
    for (int from = 0; from < listed && status == TIDES_OK; from += chunk)
        status = sweep_chunk(r, object, dynamic->fine + from, listed - from < chunk ? listed - from : chunk, level, rows,
                             duration, error);
    return status;
}

/* Sweeps all objects' Gaussians level by level, so that views at a level's times are computed once. */
static tides_status sweep_levels(tides_renderer *r, const tides_trajectory *camera, double start, double stop,
                                 const int *highest, int most, tides_error *error) {
    int *rows = td_alloc((size_t)td_sweep_times(most), sizeof *rows, error);
    tides_status status = rows ? TIDES_OK : TIDES_NO_MEMORY;
    for (int level = 1; level <= most && status == TIDES_OK; level++) {
        int used = 0;
        for (int i = 0; i < r->dynamic.gaussians; i++) used |= r->dynamic.level[i] == level;
        if (!used) continue;
        status = td_renderer_sweep_views(r, camera, start, stop, level, error);
        for (int p = 0; p < r->dynamic.objects && status == TIDES_OK; p++)
            if (highest[p] >= level) status = sweep_level(r, &r->dynamic.object[p], level, rows, stop - start, error);
    }
    free(rows);
    return status;
}

int td_dynamic_finest(const td_dynamic *dynamic) {
    int finest = 0;
    for (int i = 0; i < dynamic->gaussians; i++) finest = dynamic->level[i] > finest ? dynamic->level[i] : finest;
    return finest;
}

tides_status td_dynamic_own_times(const td_dynamic *dynamic, const td_dynamic_object *object, double start, double stop,
                                  double *from, double *to, double *rate, tides_error *error) {
    const tides_object *of = &object->of;
    double own_rate = 1;
    tides_status status = td_motion_time(of->motion, of->duration_s, dynamic->epoch + start, from, &own_rate, error);
    if (status == TIDES_OK) status = td_motion_time(of->motion, of->duration_s, dynamic->epoch + stop, to, &own_rate, error);
    if (rate) *rate = own_rate;
    return status;
}

/* The shortest scale of an object's Gaussians in own time [from, to]. */
static tides_status shortest_of(td_dynamic *dynamic, td_dynamic_object *object, double from, double to, double *shortest,
                                tides_error *error) {
    const double all = common_scale(object, from, to);
    tides_status status = all < to - from ? td_dynamic_find_scales(dynamic->store, object, error) : TIDES_OK;
    *shortest = object->scale ? INFINITY : all;
    for (int i = 0; i < object->count && object->scale && status == TIDES_OK; i++)
        *shortest = fmin(*shortest, scale_of(&object->scale[i], all, from, to));
    return status;
}

tides_status td_dynamic_shortest(td_dynamic *dynamic, double start, double stop, double *shortest, tides_error *error) {
    tides_status status = TIDES_OK;
    *shortest = INFINITY;
    for (int p = 0; p < dynamic->objects && status == TIDES_OK; p++) {
        double from = 0, to = 0, rate = 1, own = INFINITY;
        status = td_dynamic_own_times(dynamic, &dynamic->object[p], start, stop, &from, &to, &rate, error);
        if (status == TIDES_OK) status = shortest_of(dynamic, &dynamic->object[p], from, to, &own, error);
        *shortest = fmin(*shortest, own / rate);
    }
    return status;
}

tides_status td_dynamic_sweep_pieces(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     tides_error *error) {
    td_dynamic *dynamic = &renderer->dynamic;
    int most = 0;
    if (!(start < stop)) return TIDES_OK;
    int *highest = td_alloc((size_t)dynamic->objects, sizeof *highest, error);
    if (!highest) return TIDES_NO_MEMORY;
    memset(dynamic->level, 0, (size_t)dynamic->gaussians * sizeof *dynamic->level);
    tides_status status = TIDES_OK;
    for (int p = 0; p < dynamic->objects && status == TIDES_OK; p++) {
        td_dynamic_object *object = &dynamic->object[p];
        double from = 0, to = 0;
        status = td_dynamic_own_times(dynamic, object, start, stop, &from, &to, NULL, error);
        if (status == TIDES_OK) status = find_levels(dynamic, object, from, to, &highest[p], error);
        most = highest[p] > most ? highest[p] : most;
    }
    if (status == TIDES_OK && most > 0) status = sweep_levels(renderer, camera, start, stop, highest, most, error);
    free(highest);
    return status;
}
