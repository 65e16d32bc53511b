/* Boxes of dynamic Gaussians over an interval, from their rows at its start, middle and end. These rows are cached if memory
 * allows: the next interval begins where this one ends, and its first samples lie at its start and middle. Faster motion is
 * swept again in pieces afterwards. */
#include "render/dynamic/td_dynamic.h"

td_row_cache *td_dynamic_find_cached(td_dynamic *dynamic, double time, int side) {
    for (int k = 0; k < TD_ROW_CACHES; k++) {
        td_row_cache *cached = &dynamic->cached[k];
        if (cached->is_there && !(cached->time < time || cached->time > time) &&
            (cached->side == side || !td_dynamic_is_knot(dynamic, time)))
            return cached;
    }
    return NULL;
}

static tides_status work_out(td_dynamic *dynamic, td_backend *backend, td_row_cache *cached, double time, int side,
                             tides_error *error) {
    tides_status status = TIDES_OK;
    cached->is_there = 0;
    td_rows_begin(dynamic, cached->row);
    for (int p = 0; p < dynamic->objects && status == TIDES_OK; p++) {
        const td_dynamic_object *object = &dynamic->object[p];
        int first = dynamic->rows.count;
        status = td_rows_reserve(dynamic, object->count, error);
        for (int i = 0; i < object->count && status == TIDES_OK; i++) td_rows_add(dynamic, object, object->first + i);
        if (status == TIDES_OK) status = td_rows_end_run(dynamic, object, first, time, side, error);
    }
    if (status == TIDES_OK) status = td_rows_send(dynamic, backend, error);
    cached->is_there = status == TIDES_OK;
    cached->time = time;
    cached->side = side;
    return status;
}

/* A cache that none of the three times uses; at most two are in use when a third is requested. */
static td_row_cache *find_spare(td_dynamic *dynamic, td_row_cache *const used[3]) {
    td_row_cache *spare = dynamic->cached;
    while (spare == used[0] || spare == used[1] || spare == used[2]) spare++;
    return spare;
}

/* The three times of a sweep, and the side of a knot that rates are of there: 1 what begins, -1 what ends. */
typedef struct row_times {
    double time[3];
    int side[3];
} row_times;

/* Rows of the three times. Cached rows that one of them has found aren't given up for another. */
static tides_status cache_rows(td_dynamic *dynamic, td_backend *backend, const row_times *at, const td_row_cache *cached[3],
                               tides_error *error) {
    const double *time = at->time;
    const int *side = at->side;
    td_row_cache *used[3] = {NULL, NULL, NULL};
    tides_status status = TIDES_OK;
    for (int i = 0; i < 3; i++) used[i] = td_dynamic_find_cached(dynamic, time[i], side[i]);
    for (int i = 0; i < 3 && status == TIDES_OK; i++) {
        if (!used[i]) used[i] = td_dynamic_find_cached(dynamic, time[i], side[i]); /* maybe computed for another of the three */
        if (!used[i]) {
            used[i] = find_spare(dynamic, used);
            status = work_out(dynamic, backend, used[i], time[i], side[i], error);
        }
        cached[i] = used[i];
    }
    return status;
}

static int padded(int count) { return (count + TD_PAD - 1) / TD_PAD * TD_PAD; }

/* Empties the boxes of padding, which repeats the last Gaussian: no tile may list it twice. */
static void empty_padding(const td_dynamic_object *object, float *boxes) {
    for (int i = object->count; i < padded(object->count); i++) td_box_empty(boxes + 4 * (size_t)(object->first + i));
}

/* Gaussians [from, from + count) of an object: rows at the three times one after the other, used up at once. */
static tides_status sweep_chunk(td_dynamic *dynamic, td_backend *backend, const td_dynamic_object *object, int from, int count,
                                const row_times *at, const td_dynamic_sweep *sweep, tides_error *error) {
    int row[3], length = padded(count);
    tides_status status = td_rows_reserve(dynamic, 3 * length, error);
    td_rows_begin(dynamic, dynamic->store->count);
    if (status == TIDES_OK) status = td_rows_reserve(dynamic, 3 * length, error);
    for (int i = 0; i < 3 && status == TIDES_OK; i++) {
        int first = dynamic->rows.count;
        row[i] = dynamic->rows.row + first;
        for (int k = 0; k < count; k++) td_rows_add(dynamic, object, object->first + from + k);
        status = td_rows_end_run(dynamic, object, first, at->time[i], at->side[i], error);
    }
    if (status == TIDES_OK) status = td_rows_send(dynamic, backend, error);
    if (status != TIDES_OK) return status;
    int begin = object->first + from;
    const td_sweep_request request = {.views = sweep->views,
                                      .strays = sweep->strays,
                                      .duration = sweep->stop - sweep->start,
                                      .begin = begin,
                                      .end = begin + length,
                                      .rows = row};
    return backend->type->sweep(backend, &request, sweep->boxes, sweep->travel, error);
}

tides_status td_dynamic_sweep_rows(td_dynamic *dynamic, td_backend *backend, const td_dynamic_sweep *sweep,
                                   tides_error *error) {
    const double start = sweep->start, stop = sweep->stop;
    /* the middle as when steps are halved, so that its rows are found again */
    const row_times at = {{start, start + 0.5 * (stop - start), stop}, {1, 1, !(start < stop) ? 1 : -1}};
    const td_row_cache *cached[3] = {&dynamic->cached[0], &dynamic->cached[1], &dynamic->cached[2]};
    int chunk = sweep->row_limit / 3 / TD_PAD * TD_PAD;
    tides_status status = TIDES_OK;
    if (chunk < TD_PAD) chunk = TD_PAD;
    if (dynamic->cached_rows) status = cache_rows(dynamic, backend, &at, cached, error);
    if (dynamic->cached_rows && status == TIDES_OK) status = td_dynamic_measure(dynamic, backend, sweep->views, cached, error);
    for (int p = 0; p < dynamic->objects; p++) {
        const td_dynamic_object *object = &dynamic->object[p];
        int rows[3] = {cached[0]->row + object->base, cached[1]->row + object->base, cached[2]->row + object->base};
        for (int from = 0; from < object->count && !dynamic->cached_rows && status == TIDES_OK; from += chunk)
            status = sweep_chunk(dynamic, backend, object, from, object->count - from < chunk ? object->count - from : chunk,
                                 &at, sweep, error);
        const td_sweep_request request = {.views = sweep->views,
                                          .strays = sweep->strays,
                                          .duration = stop - start,
                                          .begin = object->first,
                                          .end = object->first + padded(object->count),
                                          .rows = rows};
        if (dynamic->cached_rows && status == TIDES_OK)
            status = backend->type->sweep(backend, &request, sweep->boxes, sweep->travel, error);
        empty_padding(object, sweep->boxes);
    }
    return status;
}
