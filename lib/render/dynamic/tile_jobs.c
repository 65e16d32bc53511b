/* Tile jobs of scenes with motion: which rows a launch needs, and candidate lists that point at them.
 *
 * Jobs are taken slot by slot. A slot's jobs need the union of the moving candidates of their tiles, at the slot's time:
 * each is worked out once. A launch is full when its records or its rows reach their limit. */
#include "render/td_render.h"

#include <stdlib.h>

static int by_slot(const void *a, const void *b) {
    const td_job *x = a, *y = b;
    if (x->slot != y->slot) return x->slot < y->slot ? -1 : 1;
    return td_job_by_falling_count(a, b);
}

/* The part that a group of candidates belongs to, by its leader; NULL for those that don't move by themselves. */
static const td_moved_part *part_of(const td_moved *moved, int leader) {
    int mover = moved->store->mover[moved->store->object[leader]];
    return mover < 0 ? NULL : &moved->part[mover];
}

/* Moving candidates of a job that the slot hasn't asked for yet; with `take` they are then. */
static int count_new(td_moved *moved, const int *candidates, int count, int take) {
    int fresh = 0;
    for (int group = 0; group < count; group += TD_PAD) {
        const td_moved_part *part = part_of(moved, candidates[group]);
        for (int i = group; part && i < group + TD_PAD && candidates[i] != TD_NO_GAUSSIAN; i++) {
            int at = candidates[i] - part->first + part->base;
            if (moved->stamp[at] == moved->serial) continue;
            fresh++;
            if (!take) continue;
            moved->stamp[at] = moved->serial;
            moved->lowest = at < moved->lowest ? at : moved->lowest;
            moved->highest = at > moved->highest ? at : moved->highest;
        }
    }
    return fresh;
}

/* A slot's own stamp. */
static void begin_slot(td_moved *moved) {
    if (++moved->serial == 0) { /* after 2^32 slots */
        memset(moved->stamp, 0, (size_t)moved->moving * sizeof *moved->stamp);
        moved->serial = 1;
    }
    moved->lowest = moved->moving;
    moved->highest = -1;
}

/* Adds what the slot asks for of a part: what is interpolated, or what is worked out. Returns the first entry. */
static int add_asked(td_moved *moved, const td_moved_part *part, const td_span *span, int interpolated) {
    int first = moved->rows.count, from = part->base, to = part->base + part->count;
    from = from > moved->lowest ? from : moved->lowest;
    to = to <= moved->highest ? to : moved->highest + 1;
    for (int at = from; at < to; at++) {
        if (moved->stamp[at] != moved->serial) continue;
        int fits = span && part->dear && moved->misfit[at] <= 1, gaussian = part->first + at - part->base;
        if (fits != interpolated) continue;
        moved->row_of[at] = moved->rows.row + moved->rows.count;
        if (interpolated)
            td_rows_add_between(moved, part, gaussian);
        else
            td_rows_add(moved, part, gaussian);
    }
    return first;
}

/* Rows for all that the slot asks for, those kept from the sweep as they are. */
static tides_status assign_rows(td_moved *moved, double time, int side, int asked, tides_error *error) {
    tides_status status = td_rows_reserve(moved, asked, error);
    for (int k = 0; k < TD_KEPT && moved->kept_rows; k++) {
        const td_kept *kept = &moved->kept[k];
        if (!kept->is_there || kept->time < time || kept->time > time) continue;
        if (kept->side != side && td_moved_is_knot(moved, time)) continue;
        for (int at = moved->lowest; at <= moved->highest; at++) moved->row_of[at] = kept->row + at;
        return status;
    }
    const td_span *span = td_moved_span(moved, time);
    for (int p = 0; p < moved->parts && status == TIDES_OK; p++) {
        const td_moved_part *part = &moved->part[p];
        int first = add_asked(moved, part, span, 0);
        status = td_rows_end_run(moved, part, first, time, side, error);
        if (status == TIDES_OK) status = td_rows_reserve(moved, asked, error);
        if (status != TIDES_OK || !span || !part->dear) continue;
        first = add_asked(moved, part, span, 1);
        status = td_rows_end_between(moved, part, first, span, time, error);
        if (status == TIDES_OK) status = td_rows_reserve(moved, asked, error);
    }
    return status;
}

/* A job's own list: rows instead of Gaussians. */
static void point_at_rows(const td_moved *moved, const int *candidates, int count, int *list) {
    for (int group = 0; group < count; group += TD_PAD) {
        const td_moved_part *part = part_of(moved, candidates[group]);
        for (int i = group; i < group + TD_PAD; i++) {
            list[i] = candidates[i];
            if (part && list[i] != TD_NO_GAUSSIAN) list[i] = moved->row_of[list[i] - part->first + part->base];
        }
    }
}

/* What a launch holds so far. */
typedef struct launch_plan {
    int from, to; /* jobs */
    int records, rows;
} launch_plan;

/* As many of the following slot's jobs as there is room for; 0 in `*more` where the launch is full. */
static tides_status take_slot(tides_renderer *r, const double *times, td_job *jobs, int count, launch_plan *launch, int *more,
                              tides_error *error) {
    td_moved *moved = &r->moved;
    const int *candidates = r->candidates.list;
    int first = launch->to, slot = jobs[first].slot, asked = 0, padding = 2 * TD_PAD * moved->parts;
    begin_slot(moved);
    for (; launch->to < count && jobs[launch->to].slot == slot; launch->to++) {
        const td_job *job = &jobs[launch->to];
        int fresh = count_new(moved, candidates + job->candidates, job->count, 0);
        int full = launch->records > r->record_limit - job->count || moved->rows.count + asked + padding > r->row_limit - fresh;
        if (full && launch->to > launch->from) break;
        asked += count_new(moved, candidates + job->candidates, job->count, 1);
        launch->records += job->count;
    }
    *more = launch->to > first && launch->to < count && jobs[launch->to].slot != slot;
    tides_status status = assign_rows(moved, times[slot], r->side, asked, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&moved->list, &moved->list_capacity, (size_t)launch->records, sizeof *moved->list, error);
    for (int i = first; i < launch->to && status == TIDES_OK; i++) {
        point_at_rows(moved, candidates + jobs[i].candidates, jobs[i].count, moved->list + launch->rows);
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
    tides_status status = td_rows_send(&r->moved, r->backend, error);
    if (status != TIDES_OK) return status;
    batch->candidates = r->moved.list;
    batch->candidate_count = launch->rows;
    batch->candidates_serial = ++r->moved.serial_of_list;
    batch->jobs = jobs;
    batch->job_count = count;
    batch->records = records;
    return r->backend->type->render(r->backend, batch, planes, error);
}

tides_status td_moved_run(tides_renderer *r, td_batch *batch, const double *times, td_job *jobs, int count, double *planes,
                          tides_error *error) {
    tides_status status = TIDES_OK;
    qsort(jobs, (size_t)count, sizeof *jobs, by_slot);
    for (launch_plan launch = {0, 0, 0, 0}; launch.from < count && status == TIDES_OK; launch.from = launch.to) {
        int more = 1;
        launch.records = launch.rows = 0;
        td_rows_begin(&r->moved, r->store.count + r->moved.kept_rows);
        while (more && status == TIDES_OK) status = take_slot(r, times, jobs, count, &launch, &more, error);
        if (status == TIDES_OK) status = run_launch(r, batch, jobs + launch.from, &launch, planes, error);
    }
    return status;
}
