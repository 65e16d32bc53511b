/* The dynamic objects of a scene: those whose Gaussians a motion moves. Each has knots, at which the motion's rates may jump,
 * and time scales that its model declares. Objects and knots are found once per renderer. The run's grid of steps includes the
 * knots. */
#include "render/dynamic/td_dynamic.h"

#include "motion/td_motion.h"
#include "td_sort.h"

#include <stdlib.h>

/* Times closer than this are equal: the resolution of event times [s]. */
static const double same_time = 1e-9;

/* Sets the knots in seconds after `epoch`. */
static void place_knots(td_dynamic_object *object, double epoch) {
    const tides_motion *motion = object->of.motion;
    for (size_t i = 0; i < object->knots; i++)
        object->knot_s[i] =
            (object->knot_tau[i] - motion->start) * (object->of.duration_s / (motion->stop - motion->start)) - epoch;
}

static tides_status find_knots(td_dynamic_object *object, tides_error *error) {
    const tides_motion *motion = object->of.motion;
    object->knots = motion->type->knots ? motion->type->knots(motion, NULL, 0) : 0;
    if (object->knots == 0) return TIDES_OK;
    object->knot_s = td_alloc(object->knots, sizeof *object->knot_s, error);
    object->knot_tau = td_alloc(object->knots, sizeof *object->knot_tau, error);
    if (!object->knot_s || !object->knot_tau) return TIDES_NO_MEMORY;
    motion->type->knots(motion, object->knot_tau, object->knots);
    place_knots(object, 0);
    return TIDES_OK;
}

tides_status td_dynamic_find_scales(const td_store *store, td_dynamic_object *object, tides_error *error) {
    const tides_motion *motion = object->of.motion;
    if (!motion->type->scales || object->scale) return TIDES_OK;
    td_time_scale *all = td_alloc((size_t)object->of.gaussians.count, sizeof *all, error);
    object->scale = td_alloc((size_t)object->count, sizeof *object->scale, error);
    if (all && object->scale) {
        motion->type->scales(motion, &object->of.gaussians, all);
        for (int i = 0; i < object->count; i++) object->scale[i] = all[store->number[object->first + i]];
    }
    free(all);
    return all && object->scale ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status add_object(const tides_scene *scene, int index, int first, int end, td_dynamic *dynamic,
                               tides_error *error) {
    const td_store *store = dynamic->store;
    td_dynamic_object *object = &dynamic->object[store->mover[index]];
    tides_status status = tides_scene_object(scene, store->scene_object[index], &object->of, error);
    if (status != TIDES_OK) return status;
    object->in_store = index;
    object->first = first;
    object->base = dynamic->gaussians;
    while (object->count < end - first &&
           (object->count == 0 || store->number[first + object->count] > store->number[first + object->count - 1]))
        object->count++; /* the store's padding repeats the last Gaussian's number */
    object->moves_sh = store->movers.row[store->mover[index]].whole[TD_MOVER_INTS + 3];
    object->hosted = object->of.motion->type->evaluate != NULL;
    object->expensive = object->of.motion->type->expensive;
    dynamic->gaussians += end - first;
    if (!object->of.motion->type->scale) status = td_dynamic_find_scales(store, object, error);
    return status == TIDES_OK ? find_knots(object, error) : status;
}

/* Merges the knots of all objects into one list, which has room for them. */
static void join_knots(td_dynamic *dynamic) {
    size_t total = 0, kept = 0;
    for (int i = 0; i < dynamic->objects; i++)
        for (size_t k = 0; k < dynamic->object[i].knots; k++) dynamic->knots[total++] = dynamic->object[i].knot_s[k];
    qsort(dynamic->knots, total, sizeof *dynamic->knots, td_ascending);
    for (size_t k = 0; k < total; k++)
        if (kept == 0 || dynamic->knots[k] - dynamic->knots[kept - 1] > same_time) dynamic->knots[kept++] = dynamic->knots[k];
    dynamic->knot_count = kept;
}

static tides_status make_knots(td_dynamic *dynamic, tides_error *error) {
    size_t total = 0;
    for (int i = 0; i < dynamic->objects; i++) total += dynamic->object[i].knots;
    if (total == 0) return TIDES_OK;
    dynamic->knots = td_alloc(total, sizeof *dynamic->knots, error);
    if (!dynamic->knots) return TIDES_NO_MEMORY;
    join_knots(dynamic);
    return TIDES_OK;
}

void td_dynamic_set_epoch(td_dynamic *dynamic, double epoch) {
    dynamic->epoch = epoch;
    for (int i = 0; i < dynamic->objects; i++) place_knots(&dynamic->object[i], epoch);
    if (dynamic->knots) join_knots(dynamic);
    for (int k = 0; k < TD_ROW_CACHES; k++) dynamic->cached[k].is_there = 0;
    memset(dynamic->halves, 0, sizeof dynamic->halves);
}

static tides_status fill(const tides_scene *scene, int row_limit, td_dynamic *dynamic, tides_error *error) {
    const td_store *store = dynamic->store;
    tides_status status = TIDES_OK;
    dynamic->objects = store->movers.count;
    if (dynamic->objects == 0) return TIDES_OK;
    dynamic->object = td_alloc((size_t)dynamic->objects, sizeof *dynamic->object, error);
    dynamic->rows.kind_first = td_alloc((size_t)store->movers.kinds + 1, sizeof *dynamic->rows.kind_first, error);
    if (!dynamic->object || !dynamic->rows.kind_first) return TIDES_NO_MEMORY;
    for (int g = 0; g < store->count && status == TIDES_OK;) {
        int object = store->object[g], first = g;
        while (g < store->count && store->object[g] == object) g++;
        if (store->mover[object] >= 0) status = add_object(scene, object, first, g, dynamic, error);
    }
    if (status == TIDES_OK) status = make_knots(dynamic, error);
    if (status != TIDES_OK) return status;
    dynamic->stamp = td_alloc((size_t)dynamic->gaussians, sizeof *dynamic->stamp, error);
    dynamic->row_of = td_alloc((size_t)dynamic->gaussians, sizeof *dynamic->row_of, error);
    dynamic->level = td_alloc((size_t)dynamic->gaussians, sizeof *dynamic->level, error);
    dynamic->fine = td_alloc((size_t)dynamic->gaussians, sizeof *dynamic->fine, error);
    dynamic->fine_box = td_alloc((size_t)dynamic->gaussians, 4 * sizeof *dynamic->fine_box, error);
    dynamic->fine_travel = td_alloc((size_t)dynamic->gaussians, sizeof *dynamic->fine_travel, error);
    if (dynamic->gaussians <= row_limit / TD_ROW_CACHES) dynamic->cached_rows = TD_ROW_CACHES * dynamic->gaussians;
    for (int k = 0; k < TD_ROW_CACHES; k++) dynamic->cached[k].row = store->count + k * dynamic->gaussians;
    int all = dynamic->stamp && dynamic->row_of && dynamic->level && dynamic->fine && dynamic->fine_box && dynamic->fine_travel;
    return all ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_dynamic_create(const tides_scene *scene, const td_store *store, int row_limit, td_dynamic *dynamic,
                               tides_error *error) {
    memset(dynamic, 0, sizeof *dynamic);
    dynamic->store = store;
    tides_status status = fill(scene, row_limit, dynamic, error);
    if (status != TIDES_OK) td_dynamic_release(dynamic);
    return status;
}

void td_dynamic_release(td_dynamic *dynamic) {
    td_dynamic_rows *rows = &dynamic->rows;
    for (int i = 0; i < dynamic->objects && dynamic->object; i++) {
        free(dynamic->object[i].knot_s);
        free(dynamic->object[i].knot_tau);
        free(dynamic->object[i].scale);
    }
    free(dynamic->object);
    free(dynamic->knots);
    free(dynamic->stamp);
    free(dynamic->row_of);
    free(dynamic->list);
    free(dynamic->misfit);
    free(dynamic->level);
    free(dynamic->fine);
    free(dynamic->fine_box);
    free(dynamic->fine_travel);
    free(rows->gaussians);
    free(rows->owners);
    free(rows->moments);
    free(rows->jobs);
    free(rows->cubics);
    free(rows->cubic_jobs);
    free(rows->kind_first);
    free(rows->host);
    for (int i = 0; i < 4; i++) free(rows->host_row[i]);
    memset(dynamic, 0, sizeof *dynamic);
}

tides_status td_dynamic_joints(const td_dynamic *dynamic, double start, double stop, double **times, int *count,
                               size_t *capacity, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < dynamic->objects && status == TIDES_OK; i++) {
        const tides_object *of = &dynamic->object[i].of;
        const tides_motion *motion = of->motion;
        if (!motion->type->joints) continue;
        const double per = of->duration_s / (motion->stop - motion->start); /* seconds per unit of own time */
        const double from = motion->start + (start + dynamic->epoch) / per, to = motion->start + (stop + dynamic->epoch) / per;
        const size_t more = motion->type->joints(motion, from, to, NULL, 0);
        status = td_reserve((void **)times, capacity, (size_t)*count + more, sizeof **times, error);
        if (status != TIDES_OK || more == 0) continue;
        motion->type->joints(motion, from, to, *times + *count, more);
        for (size_t k = 0; k < more; k++, ++*count)
            (*times)[*count] = ((*times)[*count] - motion->start) * per - dynamic->epoch;
    }
    return status;
}

/* The first knot at or after `time`. */
static size_t knot_from(const td_dynamic *dynamic, double time) {
    size_t low = 0, high = dynamic->knot_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (dynamic->knots[middle] < time)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int td_dynamic_is_knot(const td_dynamic *dynamic, double time) {
    size_t first = knot_from(dynamic, time - same_time);
    return first < dynamic->knot_count && dynamic->knots[first] <= time + same_time;
}

int td_dynamic_knot_within(const td_dynamic *dynamic, double start, double stop) {
    size_t first = knot_from(dynamic, start + same_time);
    return first < dynamic->knot_count && dynamic->knots[first] < stop - same_time;
}

int td_dynamic_has_expensive(const td_dynamic *dynamic) {
    int expensive = 0;
    for (int p = 0; p < dynamic->objects; p++) expensive |= dynamic->object[p].expensive;
    return expensive;
}
