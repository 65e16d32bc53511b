/* Tile jobs in scenes with dynamic Gaussians: finds the rows that a launch needs, and makes candidate lists that contain
 * these rows instead of the store's Gaussians.
 *
 * Jobs are handled slot by slot (a slot is one time). The moving candidates of all of a slot's tiles are collected, so that
 * each row is computed once. A launch is full when its records or its rows reach their limit. */
#include "render/td_renderer.h"

#include <stdlib.h>

static int by_slot(const void *a, const void *b) {
    const td_job *x = a, *y = b;
    if (x->slot != y->slot) return x->slot < y->slot ? -1 : 1;
    return td_job_by_falling_count(a, b);
}

/* The object of a group of candidates, by its first one; NULL if they don't move by themselves. */
static const td_dynamic_object *object_of(const td_dynamic *dynamic, int leader) {
    int mover = dynamic->store->mover[dynamic->store->object[leader]];
    return mover < 0 ? NULL : &dynamic->object[mover];
}

/* Counts a job's moving candidates that the slot hasn't requested yet; with `take`, marks them as requested. */
static int count_new(td_dynamic *dynamic, const int *candidates, int count, int take) {
    int fresh = 0;
    for (int group = 0; group < count; group += TD_PAD) {
        const td_dynamic_object *object = object_of(dynamic, candidates[group]);
        for (int i = group; object && i < group + TD_PAD && candidates[i] != TD_NO_GAUSSIAN; i++) {
            int at = candidates[i] - object->first + object->base;
            if (dynamic->stamp[at] == dynamic->serial) continue;
            fresh++;
            if (!take) continue;
            dynamic->stamp[at] = dynamic->serial;
            dynamic->lowest = at < dynamic->lowest ? at : dynamic->lowest;
            dynamic->highest = at > dynamic->highest ? at : dynamic->highest;
        }
    }
    return fresh;
}

/* Begins a slot, with a serial number of its own. */
static void begin_slot(td_dynamic *dynamic) {
    if (++dynamic->serial == 0) { /* overflow after 2^32 slots */
        memset(dynamic->stamp, 0, (size_t)dynamic->gaussians * sizeof *dynamic->stamp);
        dynamic->serial = 1;
    }
    dynamic->lowest = dynamic->gaussians;
    dynamic->highest = -1;
}

/* Adds what the slot requested of an object: rows to interpolate, or rows to compute. Returns the first entry. */
static int add_asked(td_dynamic *dynamic, const td_dynamic_object *object, const td_span *span, int interpolated) {
    int first = dynamic->rows.count, from = object->base, to = object->base + object->count;
    from = from > dynamic->lowest ? from : dynamic->lowest;
    to = to <= dynamic->highest ? to : dynamic->highest + 1;
    for (int at = from; at < to; at++) {
        if (dynamic->stamp[at] != dynamic->serial) continue;
        int fits = span && object->expensive && dynamic->misfit[at] <= 1, gaussian = object->first + at - object->base;
        if (fits != interpolated) continue;
        dynamic->row_of[at] = dynamic->rows.row + dynamic->rows.count;
        if (interpolated)
            td_rows_add_between(dynamic, object, gaussian);
        else
            td_rows_add(dynamic, object, gaussian);
    }
    return first;
}

/* Assigns rows to all that the slot requested: cached rows of the sweep, or new ones. */
static tides_status assign_rows(td_dynamic *dynamic, double time, int side, int asked, tides_error *error) {
    tides_status status = td_rows_reserve(dynamic, asked, error);
    for (int k = 0; k < TD_ROW_CACHES && dynamic->cached_rows; k++) {
        const td_row_cache *cached = &dynamic->cached[k];
        if (!cached->is_there || cached->time < time || cached->time > time) continue;
        if (cached->side != side && td_dynamic_is_knot(dynamic, time)) continue;
        for (int at = dynamic->lowest; at <= dynamic->highest; at++) dynamic->row_of[at] = cached->row + at;
        return status;
    }
    const td_span *span = td_dynamic_span(dynamic, time);
    for (int p = 0; p < dynamic->objects && status == TIDES_OK; p++) {
        const td_dynamic_object *object = &dynamic->object[p];
        int first = add_asked(dynamic, object, span, 0);
        status = td_rows_end_run(dynamic, object, first, time, side, error);
        if (status == TIDES_OK) status = td_rows_reserve(dynamic, asked, error);
        if (status != TIDES_OK || !span || !object->expensive) continue;
        first = add_asked(dynamic, object, span, 1);
        status = td_rows_end_between(dynamic, object, first, span, time, error);
        if (status == TIDES_OK) status = td_rows_reserve(dynamic, asked, error);
    }
    return status;
}

/* Makes a job's own list, with rows instead of Gaussians. */
static void point_at_rows(const td_dynamic *dynamic, const int *candidates, int count, int *list) {
    for (int group = 0; group < count; group += TD_PAD) {
        const td_dynamic_object *object = object_of(dynamic, candidates[group]);
        for (int i = group; i < group + TD_PAD; i++) {
            list[i] = candidates[i];
            if (object && list[i] != TD_NO_GAUSSIAN) list[i] = dynamic->row_of[list[i] - object->first + object->base];
        }
    }
}

/* Contents of a launch so far. */
typedef struct launch_plan {
    int from, to; /* jobs */
    int records, rows;
} launch_plan;

/* Adds as many jobs of the next slot as fit; *more is 0 when the launch is full. */
static tides_status take_slot(tides_renderer *r, const td_tile_batch *wanted, td_job *jobs, int count, launch_plan *launch,
                              int *more, tides_error *error) {
    td_dynamic *dynamic = &r->dynamic;
    const int *candidates = r->candidates.list;
    /* Rows are computed once per launch, so the limit must not depend on whether somebody may stop a run: statistics would. */
    const int limit = r->control.interrupt ? r->record_limit : td_renderer_record_limit(r);
    int first = launch->to, slot = jobs[first].slot, asked = 0, padding = 2 * TD_PAD * dynamic->objects;
    begin_slot(dynamic);
    for (; launch->to < count && jobs[launch->to].slot == slot; launch->to++) {
        const td_job *job = &jobs[launch->to];
        int fresh = count_new(dynamic, candidates + job->candidates, job->count, 0);
        int full = launch->records > limit - job->count || dynamic->rows.count + asked + padding > r->row_limit - fresh;
        if (full && launch->to > launch->from) break;
        asked += count_new(dynamic, candidates + job->candidates, job->count, 1);
        launch->records += job->count;
    }
    *more = launch->to > first && launch->to < count && jobs[launch->to].slot != slot;
    tides_status status = assign_rows(dynamic, wanted->times[slot], wanted->side, asked, error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&dynamic->list, &dynamic->list_capacity, (size_t)launch->records, sizeof *dynamic->list, error);
    for (int i = first; i < launch->to && status == TIDES_OK; i++) {
        point_at_rows(dynamic, candidates + jobs[i].candidates, jobs[i].count, dynamic->list + launch->rows);
        jobs[i].candidates = launch->rows;
        launch->rows += jobs[i].count;
    }
    return status;
}

static tides_status run_launch(tides_renderer *r, td_batch *batch, td_job *jobs, const launch_plan *launch, double *planes,
                               tides_error *error) {
    int records = 0, count = launch->to - launch->from;
    qsort(jobs, (size_t)count, sizeof *jobs, td_job_by_falling_count);
    for (int i = 0; i < count; i++) {
        jobs[i].records = records;
        records += jobs[i].count;
    }
    tides_status status = td_rows_send(&r->dynamic, r->backend, error);
    if (status != TIDES_OK) return status;
    batch->candidates = r->dynamic.list;
    batch->candidate_count = launch->rows;
    batch->candidates_serial = ++r->dynamic.serial_of_list;
    batch->jobs = jobs;
    batch->job_count = count;
    batch->records = records;
    return r->backend->type->render(r->backend, batch, planes, error);
}

tides_status td_dynamic_run_jobs(tides_renderer *r, td_batch *batch, const td_tile_batch *asked, td_job *jobs, int count,
                                 double *planes, tides_error *error) {
    tides_status status = TIDES_OK;
    qsort(jobs, (size_t)count, sizeof *jobs, by_slot);
    for (launch_plan launch = {0, 0, 0, 0}; launch.from < count && status == TIDES_OK; launch.from = launch.to) {
        int more = 1;
        status = td_renderer_check_stop(r, (double)launch.from / count, error);
        launch.records = launch.rows = 0;
        td_rows_begin(&r->dynamic, r->store.count + r->dynamic.cached_rows);
        while (more && status == TIDES_OK) status = take_slot(r, asked, jobs, count, &launch, &more, error);
        if (status == TIDES_OK) status = run_launch(r, batch, jobs + launch.from, &launch, planes, error);
    }
    return status;
}
