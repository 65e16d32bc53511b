/* Assembles a batch of rows for the backend. A run is some of an object's Gaussians at one time. It becomes jobs of a kernel,
 * rows from the host (callbacks), or cubics between existing rows. The callers decide which rows are needed. */
#include "render/dynamic/td_dynamic.h"

#include "motion/td_motion.h"

#include <stdlib.h>

enum { JOB_LENGTH = 256 }; /* Gaussians per work-group: many short jobs keep all threads busy */

void td_rows_begin(td_dynamic *dynamic, int row) {
    td_dynamic_rows *rows = &dynamic->rows;
    rows->row = row;
    rows->count = rows->moment_count = rows->job_count = rows->host_runs = rows->host_count = 0;
    rows->cubic_count = rows->cubic_job_count = rows->interpolated = 0;
}

tides_status td_rows_reserve(td_dynamic *dynamic, int more, tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    size_t count = (size_t)rows->count + (size_t)more;
    tides_status status =
        td_reserve((void **)&rows->gaussians, &rows->gaussian_capacity, count, sizeof *rows->gaussians, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&rows->owners, &rows->owner_capacity, 2 * count, sizeof *rows->owners, error);
    return status;
}

void td_rows_add(td_dynamic *dynamic, const td_dynamic_object *object, int gaussian) {
    td_dynamic_rows *rows = &dynamic->rows;
    int i = rows->count++;
    rows->gaussians[i] = dynamic->store->number[gaussian];
    rows->owners[2 * i] = gaussian;
    rows->owners[2 * i + 1] = object->moves_sh ? rows->row + i : gaussian;
}

void td_rows_add_between(td_dynamic *dynamic, const td_dynamic_object *object, int gaussian) {
    td_rows_add(dynamic, object, gaussian);
    dynamic->rows.gaussians[dynamic->rows.count - 1] = gaussian - object->first + object->base;
}

/* Own time of `time` seconds after the epoch. At a knot it is exactly the knot's, so that the side on which rates are wanted
 * is clear. */
static tides_status own_time(const td_dynamic_object *object, double epoch, double time, double *tau, double *tau_dot,
                             tides_error *error) {
    const double same_time = 1e-9; /* [s] */
    tides_status status = td_motion_time(object->of.motion, object->of.duration_s, epoch + time, tau, tau_dot, error);
    if (status != TIDES_OK) return td_fail_within(error, status, "object '%.80s'", object->of.name);
    size_t low = 0, high = object->knots;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (object->knot_s[middle] < time - same_time)
            low = middle + 1;
        else
            high = middle;
    }
    if (low < object->knots && object->knot_s[low] <= time + same_time) *tau = object->knot_tau[low];
    return TIDES_OK;
}

static tides_status add_host_run(td_dynamic *dynamic, const td_dynamic_object *object, int first, const double at[2], int side,
                                 tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    size_t from = (size_t)rows->host_count, count = (size_t)(rows->count - first), sh = (size_t)dynamic->store->sh_stride;
    size_t width[4] = {TD_GEOMETRY_STRIDE, TD_GEOMETRY_STRIDE, sh, sh};
    int arrays = dynamic->store->movers.moves_sh ? 4 : 2;
    tides_status status =
        td_reserve((void **)&rows->host, &rows->host_capacity, (size_t)rows->host_runs + 1, sizeof *rows->host, error);
    for (int i = 0; i < arrays && status == TIDES_OK; i++)
        status = td_reserve((void **)&rows->host_row[i], &rows->host_row_capacity[i], (from + count) * width[i],
                            sizeof *rows->host_row[i], error);
    if (status != TIDES_OK) return status;
    td_mover_numbers numbers; /* a callback doesn't use it */
    memset(&numbers, 0, sizeof numbers);
    numbers.moves_sh = object->moves_sh;
    td_motion_sink sink = {rows->host_row[0] + from * TD_GEOMETRY_STRIDE, rows->host_row[1] + from * TD_GEOMETRY_STRIDE, NULL,
                           NULL, dynamic->store->sh_stride};
    for (int i = 2; i < arrays; i++) memset(rows->host_row[i] + from * sh, 0, count * sh * sizeof(double));
    if (object->moves_sh) sink.sh = rows->host_row[2] + from * sh, sink.sh_rates = rows->host_row[3] + from * sh;
    td_host_rows run = {rows->row + first, (int)count, (int)from};
    rows->host[rows->host_runs++] = run;
    rows->host_count += (int)count;
    const td_motion_asked asked = {at[0], at[1], side, 0, rows->gaussians + first, (int64_t)count};
    return td_motion_rows(object->of.motion, &object->of.gaussians, &numbers, &asked, &sink, error);
}

static tides_status add_jobs(td_dynamic *dynamic, const td_dynamic_object *object, int first, const double at[2], int side,
                             tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    int count = rows->count - first, jobs = (count + JOB_LENGTH - 1) / JOB_LENGTH;
    tides_status status = td_reserve((void **)&rows->moments, &rows->moment_capacity,
                                     ((size_t)rows->moment_count + 1) * TD_MOMENT_REALS, sizeof *rows->moments, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&rows->jobs, &rows->job_capacity, (size_t)rows->job_count + (size_t)jobs,
                            sizeof *rows->jobs, error);
    if (status != TIDES_OK) return status;
    td_motion_moment(object->of.motion, at[0], at[1], side, rows->moments + (size_t)rows->moment_count * TD_MOMENT_REALS);
    for (int i = first; i < rows->count; i += JOB_LENGTH) {
        td_move_job job = {dynamic->store->mover[object->in_store],
                           rows->moment_count,
                           i,
                           rows->count - i < JOB_LENGTH ? rows->count - i : JOB_LENGTH,
                           rows->row + i,
                           {0}};
        rows->jobs[rows->job_count++] = job;
    }
    rows->moment_count++;
    return TIDES_OK;
}

tides_status td_rows_end_run(td_dynamic *dynamic, const td_dynamic_object *object, int first, double time, int side,
                             tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    double at[2]; /* own time and its rate */
    if (rows->count == first) return TIDES_OK;
    tides_status status = td_rows_reserve(dynamic, TD_PAD, error);
    if (status == TIDES_OK) status = own_time(object, dynamic->epoch, time, &at[0], &at[1], error);
    if (status != TIDES_OK) return status;
    int last = rows->owners[2 * (rows->count - 1)];
    while ((rows->count - first) % TD_PAD) td_rows_add(dynamic, object, last);
    const double second = dynamic->epoch + time;
    side = second <= 0 ? 1 : second >= object->of.duration_s ? -1 : side; /* a motion has only one side at its ends */
    return object->hosted ? add_host_run(dynamic, object, first, at, side, error)
                          : add_jobs(dynamic, object, first, at, side, error);
}

tides_status td_rows_end_between(td_dynamic *dynamic, const td_dynamic_object *object, int first, const td_span *span,
                                 double time, tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    if (rows->count == first) return TIDES_OK;
    tides_status status = td_rows_reserve(dynamic, TD_PAD, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&rows->cubics, &rows->cubic_capacity, ((size_t)rows->cubic_count + 1) * TD_CUBIC_REALS,
                            sizeof *rows->cubics, error);
    if (status != TIDES_OK) return status;
    int last = rows->owners[2 * (rows->count - 1)];
    while ((rows->count - first) % TD_PAD) td_rows_add_between(dynamic, object, last);
    int count = rows->count - first, jobs = (count + JOB_LENGTH - 1) / JOB_LENGTH;
    status = td_reserve((void **)&rows->cubic_jobs, &rows->cubic_job_capacity, (size_t)rows->cubic_job_count + (size_t)jobs,
                        sizeof *rows->cubic_jobs, error);
    if (status != TIDES_OK) return status;
    td_cubic_weights(span->from->time, span->to->time, time, rows->cubics + (size_t)rows->cubic_count * TD_CUBIC_REALS);
    for (int i = first; i < rows->count; i += JOB_LENGTH) {
        int length = rows->count - i < JOB_LENGTH ? rows->count - i : JOB_LENGTH;
        td_cubic_job job = {rows->cubic_count, i, length, rows->row + i, span->from->row, span->to->row, object->moves_sh, 0};
        rows->cubic_jobs[rows->cubic_job_count++] = job;
    }
    rows->cubic_count++;
    rows->interpolated += count;
    return TIDES_OK;
}

/* Sorts jobs by kind; there are few kinds, mostly one. */
static tides_status sort_by_kind(td_dynamic *dynamic, tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    const td_movers *movers = &dynamic->store->movers;
    size_t count = (size_t)rows->job_count;
    td_move_job *sorted = td_alloc(count + 1, sizeof *sorted, error);
    if (!sorted) return TIDES_NO_MEMORY;
    int at = 0;
    for (int kind = 0; kind < movers->kinds; kind++) {
        rows->kind_first[kind] = at;
        for (size_t i = 0; i < count; i++)
            if (movers->kind[rows->jobs[i].mover] == kind) sorted[at++] = rows->jobs[i];
    }
    rows->kind_first[movers->kinds] = at;
    if (count) memcpy(rows->jobs, sorted, count * sizeof *sorted);
    free(sorted);
    return TIDES_OK;
}

tides_status td_rows_send(td_dynamic *dynamic, td_backend *backend, tides_error *error) {
    td_dynamic_rows *rows = &dynamic->rows;
    if (rows->count == 0) return TIDES_OK;
    tides_status status = sort_by_kind(dynamic, error);
    if (status != TIDES_OK) return status;
    td_move_batch batch = {rows->moments,     rows->moment_count, rows->jobs,
                           rows->kind_first,  rows->gaussians,    rows->count,
                           rows->row,         rows->count,        rows->owners,
                           rows->host,        rows->host_runs,    rows->host_count,
                           rows->host_row[0], rows->host_row[1],  rows->host_row[2],
                           rows->host_row[3], rows->cubic_jobs,   rows->cubic_job_count,
                           rows->cubics,      rows->cubic_count};
    backend->stats.gaussians_moved += (uint64_t)(rows->count - rows->interpolated);
    backend->stats.gaussians_interpolated += (uint64_t)rows->interpolated;
    return backend->type->move(backend, &batch, error);
}
