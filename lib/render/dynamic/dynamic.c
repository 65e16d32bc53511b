/* Who moves by itself in a scene, and when rates of that may jump. */
#include "render/dynamic/td_dynamic.h"

#include "motion/td_motion.h"
#include "td_sort.h"

#include <stdlib.h>

/* Times closer than this are the same: what event times resolve [s]. */
static const double same_time = 1e-9;

/* Seconds after `epoch` of the knots. */
static void place_knots(td_moved_part *part, double epoch) {
    const tides_motion *motion = part->of.motion;
    for (size_t i = 0; i < part->knots; i++)
        part->knot_s[i] = (part->knot_tau[i] - motion->start) * (part->of.duration_s / (motion->stop - motion->start)) - epoch;
}

static tides_status find_knots(td_moved_part *part, tides_error *error) {
    const tides_motion *motion = part->of.motion;
    part->knots = motion->type->knots ? motion->type->knots(motion, NULL, 0) : 0;
    if (part->knots == 0) return TIDES_OK;
    part->knot_s = td_alloc(part->knots, sizeof *part->knot_s, error);
    part->knot_tau = td_alloc(part->knots, sizeof *part->knot_tau, error);
    if (!part->knot_s || !part->knot_tau) return TIDES_NO_MEMORY;
    motion->type->knots(motion, part->knot_tau, part->knots);
    place_knots(part, 0);
    return TIDES_OK;
}

tides_status td_moved_find_scales(const td_store *store, td_moved_part *part, tides_error *error) {
    const tides_motion *motion = part->of.motion;
    if (!motion->type->scales || part->scale) return TIDES_OK;
    td_time_scale *all = td_alloc((size_t)part->of.gaussians.count, sizeof *all, error);
    part->scale = td_alloc((size_t)part->count, sizeof *part->scale, error);
    if (all && part->scale) {
        motion->type->scales(motion, &part->of.gaussians, all);
        for (int i = 0; i < part->count; i++) part->scale[i] = all[store->number[part->first + i]];
    }
    free(all);
    return all && part->scale ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status add_part(const tides_scene *scene, int object, int first, int end, td_moved *moved, tides_error *error) {
    const td_store *store = moved->store;
    td_moved_part *part = &moved->part[store->mover[object]];
    tides_status status = tides_scene_object(scene, store->scene_object[object], &part->of, error);
    if (status != TIDES_OK) return status;
    part->object = object;
    part->first = first;
    part->base = moved->moving;
    while (part->count < end - first &&
           (part->count == 0 || store->number[first + part->count] > store->number[first + part->count - 1]))
        part->count++; /* padding repeats the last number */
    part->moves_sh = store->movers.row[store->mover[object]].whole[TD_MOVER_INTS + 3];
    part->hosted = part->of.motion->type->evaluate != NULL;
    part->dear = part->of.motion->type->dear;
    moved->moving += end - first;
    if (!part->of.motion->type->scale) status = td_moved_find_scales(store, part, error);
    return status == TIDES_OK ? find_knots(part, error) : status;
}

/* The knots of all parts as one list, for which there is room. */
static void join_knots(td_moved *moved) {
    size_t total = 0, kept = 0;
    for (int i = 0; i < moved->parts; i++)
        for (size_t k = 0; k < moved->part[i].knots; k++) moved->knots[total++] = moved->part[i].knot_s[k];
    qsort(moved->knots, total, sizeof *moved->knots, td_ascending);
    for (size_t k = 0; k < total; k++)
        if (kept == 0 || moved->knots[k] - moved->knots[kept - 1] > same_time) moved->knots[kept++] = moved->knots[k];
    moved->knot_count = kept;
}

static tides_status make_knots(td_moved *moved, tides_error *error) {
    size_t total = 0;
    for (int i = 0; i < moved->parts; i++) total += moved->part[i].knots;
    if (total == 0) return TIDES_OK;
    moved->knots = td_alloc(total, sizeof *moved->knots, error);
    if (!moved->knots) return TIDES_NO_MEMORY;
    join_knots(moved);
    return TIDES_OK;
}

void td_moved_set_epoch(td_moved *moved, double epoch) {
    moved->epoch = epoch;
    for (int i = 0; i < moved->parts; i++) place_knots(&moved->part[i], epoch);
    if (moved->knots) join_knots(moved);
    for (int k = 0; k < TD_KEPT; k++) moved->kept[k].is_there = 0;
    memset(moved->halves, 0, sizeof moved->halves);
}

static tides_status fill(const tides_scene *scene, int row_limit, td_moved *moved, tides_error *error) {
    const td_store *store = moved->store;
    tides_status status = TIDES_OK;
    moved->parts = store->movers.count;
    if (moved->parts == 0) return TIDES_OK;
    moved->part = td_alloc((size_t)moved->parts, sizeof *moved->part, error);
    moved->rows.kind_first = td_alloc((size_t)store->movers.kinds + 1, sizeof *moved->rows.kind_first, error);
    if (!moved->part || !moved->rows.kind_first) return TIDES_NO_MEMORY;
    for (int g = 0; g < store->count && status == TIDES_OK;) {
        int object = store->object[g], first = g;
        while (g < store->count && store->object[g] == object) g++;
        if (store->mover[object] >= 0) status = add_part(scene, object, first, g, moved, error);
    }
    if (status == TIDES_OK) status = make_knots(moved, error);
    if (status != TIDES_OK) return status;
    moved->stamp = td_alloc((size_t)moved->moving, sizeof *moved->stamp, error);
    moved->row_of = td_alloc((size_t)moved->moving, sizeof *moved->row_of, error);
    moved->level = td_alloc((size_t)moved->moving, sizeof *moved->level, error);
    moved->fine = td_alloc((size_t)moved->moving, sizeof *moved->fine, error);
    moved->fine_box = td_alloc((size_t)moved->moving, 4 * sizeof *moved->fine_box, error);
    moved->fine_travel = td_alloc((size_t)moved->moving, sizeof *moved->fine_travel, error);
    if (moved->moving <= row_limit / TD_KEPT) moved->kept_rows = TD_KEPT * moved->moving;
    for (int k = 0; k < TD_KEPT; k++) moved->kept[k].row = store->count + k * moved->moving;
    int all = moved->stamp && moved->row_of && moved->level && moved->fine && moved->fine_box && moved->fine_travel;
    return all ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_moved_create(const tides_scene *scene, const td_store *store, int row_limit, td_moved *moved,
                             tides_error *error) {
    memset(moved, 0, sizeof *moved);
    moved->store = store;
    tides_status status = fill(scene, row_limit, moved, error);
    if (status != TIDES_OK) td_moved_release(moved);
    return status;
}

void td_moved_release(td_moved *moved) {
    td_moving_rows *rows = &moved->rows;
    for (int i = 0; i < moved->parts && moved->part; i++) {
        free(moved->part[i].knot_s);
        free(moved->part[i].knot_tau);
        free(moved->part[i].scale);
    }
    free(moved->part);
    free(moved->knots);
    free(moved->stamp);
    free(moved->row_of);
    free(moved->list);
    free(moved->misfit);
    free(moved->level);
    free(moved->fine);
    free(moved->fine_box);
    free(moved->fine_travel);
    free(rows->gaussians);
    free(rows->owners);
    free(rows->moments);
    free(rows->jobs);
    free(rows->cubics);
    free(rows->cubic_jobs);
    free(rows->kind_first);
    free(rows->host);
    for (int i = 0; i < 4; i++) free(rows->host_row[i]);
    memset(moved, 0, sizeof *moved);
}

/* The first knot that isn't before `time`. */
static size_t knot_from(const td_moved *moved, double time) {
    size_t low = 0, high = moved->knot_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (moved->knots[middle] < time)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int td_moved_is_knot(const td_moved *moved, double time) {
    size_t first = knot_from(moved, time - same_time);
    return first < moved->knot_count && moved->knots[first] <= time + same_time;
}

int td_moved_knot_within(const td_moved *moved, double start, double stop) {
    size_t first = knot_from(moved, start + same_time);
    return first < moved->knot_count && moved->knots[first] < stop - same_time;
}
