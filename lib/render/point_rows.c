/* Rows of record paths in double precision, for points: projects Gaussians at the nodes of a level. */
#include "td_point_nodes.h"
#include "td_renderer.h"

#include <stdlib.h>

/* Gaussians per job: enough to repay its start, few enough that threads end together. */
enum { JOB_GAUSSIANS = 256 };

/* -- projection ------------------------------------------------------------------------------------------------------------ */

static tides_status reserve_entries(td_point_nodes *nodes, size_t more, tides_error *error) {
    const size_t wanted = (size_t)nodes->jobs.entries + more;
    tides_status status =
        td_reserve((void **)&nodes->jobs.entry, &nodes->jobs.entry_capacity[0], wanted, sizeof *nodes->jobs.entry, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&nodes->jobs.at, &nodes->jobs.entry_capacity[1], wanted, sizeof *nodes->jobs.at, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&nodes->jobs.list, &nodes->jobs.capacity, (size_t)nodes->jobs.count + 1,
                            sizeof *nodes->jobs.list, error);
    return status;
}

/* Fills the last job up to a multiple of TD_PAD with entries that write to an unused row. */
static void end_job(td_point_nodes *nodes) {
    td_node_job *job = &nodes->jobs.list[nodes->jobs.count - 1];
    for (; job->count % TD_PAD; job->count++, nodes->jobs.entries++) {
        nodes->jobs.entry[nodes->jobs.entries] = TD_NO_GAUSSIAN;
        nodes->jobs.at[nodes->jobs.entries] = nodes->group.rows;
    }
}

/* 1 if node `node` of a level has to be computed for Gaussian i. If only some curves of the previous level were open, it has
 * to be the middle of a half of an open one. */
static int is_wanted(const td_point_nodes *nodes, int i, int level, int node) {
    if (nodes->group.level[i] != level) return 0;
    return nodes->group.open_at[i] < 0 || (node % 2 && nodes->group.open[nodes->group.open_at[i] + node / 4]);
}

/* Opens a job in slot `slot`, with room for all that a job holds. */
static tides_status open_job(td_point_nodes *nodes, int slot, tides_error *error) {
    const tides_status status = reserve_entries(nodes, JOB_GAUSSIANS, error);
    if (status == TIDES_OK) nodes->jobs.list[nodes->jobs.count++] = (td_node_job){slot, nodes->jobs.entries, 0, 0};
    return status;
}

typedef char td_job_is_whole_groups[JOB_GAUSSIANS % TD_PAD == 0 ? 1 : -1];

/* A node of a level, for the Gaussians [from, end) of the group. */
typedef struct node_of {
    int level, node, from, end;
} node_of;

/* Adds jobs for a node, in slot `slot`, of those of its Gaussians that need it. `row` (may be NULL) has their moved rows, if
 * some move by themselves. */
static tides_status add_node(const tides_renderer *renderer, td_point_nodes *nodes, node_of at, int slot, const int *row,
                             tides_error *error) {
    const int *object_of = renderer->store.objects > 1 ? renderer->store.object : NULL; /* each look is a cache miss */
    int open = 0, object = -1, taken = 0;
    tides_status status = TIDES_OK;
    for (int i = at.from; i < at.end && status == TIDES_OK; i++) {
        if (!is_wanted(nodes, i, at.level, at.node)) continue;
        const int gaussian = nodes->group.gaussians[i], own = object_of ? object_of[gaussian] : 0;
        if (open && (own != object || nodes->jobs.list[nodes->jobs.count - 1].count == JOB_GAUSSIANS)) {
            end_job(nodes);
            open = 0;
        }
        if (!open) status = open_job(nodes, slot, error);
        if (status != TIDES_OK) return status;
        open = 1;
        object = own;
        nodes->jobs.entry[nodes->jobs.entries] = row ? row[taken++] : gaussian;
        nodes->jobs.at[nodes->jobs.entries++] = nodes->group.first[i] + at.node;
        nodes->jobs.list[nodes->jobs.count - 1].count++;
    }
    if (open && status == TIDES_OK) end_job(nodes);
    return status;
}

/* Adds the same jobs (from `job` on, with entries from `entry` on) for the next node. */
static tides_status repeat_node(td_point_nodes *nodes, int job, int entry, tides_error *error) {
    const int jobs = nodes->jobs.count - job, entries = nodes->jobs.entries - entry;
    tides_status status = TIDES_OK;
    for (int i = 0; i < jobs && status == TIDES_OK; i++) {
        status = reserve_entries(nodes, (size_t)entries, error);
        if (status != TIDES_OK) return status;
        const td_node_job *of = &nodes->jobs.list[job + i];
        nodes->jobs.list[nodes->jobs.count++] = (td_node_job){of->slot + 1, of->first + entries, of->count, 0};
    }
    for (int i = entry; i < entry + entries && status == TIDES_OK; i++) {
        nodes->jobs.entry[i + entries] = nodes->jobs.entry[i];
        nodes->jobs.at[i + entries] = nodes->jobs.at[i] + (nodes->jobs.entry[i] != TD_NO_GAUSSIAN);
    }
    nodes->jobs.entries += entries;
    return status;
}

/* Adds jobs for all nodes of a level, one node after the other for as many Gaussians as a job holds: their data then stays in
 * the cache. */
static tides_status add_nodes(const tides_renderer *renderer, td_point_nodes *nodes, int level, int slots, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int from = 0, end = 0; from < nodes->group.count && status == TIDES_OK; from = end) {
        int job = nodes->jobs.count, entry = nodes->jobs.entries;
        for (int taken = 0; end < nodes->group.count && taken < JOB_GAUSSIANS; end++) taken += nodes->group.level[end] == level;
        status = add_node(renderer, nodes, (node_of){level, 0, from, end}, 0, NULL, error);
        for (int k = 1; k < slots && status == TIDES_OK; k++) {
            const int next_job = nodes->jobs.count, next_entry = nodes->jobs.entries;
            status = repeat_node(nodes, job, entry, error);
            job = next_job, entry = next_entry;
        }
    }
    return status;
}

/* Time of node k of a level, counted through all pieces [s after the epoch]. */
static double node_time(const td_point_nodes *nodes, int level, int k) {
    const int piece = k >> level, part = k & ((1 << level) - 1);
    if (part == 0) return nodes->knot[piece];
    return nodes->knot[piece] + (nodes->knot[piece + 1] - nodes->knot[piece]) * (part / (double)(1 << level));
}

/* Sends the jobs, with views at `slots` times. */
static tides_status send(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes, const double *times,
                         int slots, tides_error *error) {
    if (nodes->jobs.count == 0) return TIDES_OK;
    tides_status status = nodes->kept ? td_renderer_views_again(renderer, nodes->kept, slots, error)
                                      : td_renderer_views(renderer, camera, times, slots, error);
    if (status != TIDES_OK) return status;
    const td_node_request request = {.views = (const double *)renderer->scratch.views,
                                     .slots = slots,
                                     .jobs = nodes->jobs.list,
                                     .job_count = nodes->jobs.count,
                                     .gaussians = nodes->jobs.entry,
                                     .rows = nodes->jobs.at,
                                     .count = nodes->jobs.entries,
                                     .row_count = nodes->group.rows + 1};
    return td_exact_nodes(nodes->exact, renderer->backend, &request, error);
}

/* Limits of what is moved and projected together. A launch costs as much as a thousand rows, and more than so many rows don't
 * stay in the caches. */
enum { BATCH_ROWS = 1 << 13, BATCH_SLOTS = 256 };
typedef struct moved_batch {
    int *wanted, *row; /* (Gaussians) of a node; their rows */
    int limit;         /* limit of rows */
    int slots;
    double time[BATCH_SLOTS];
} moved_batch;

static void begin_batch(tides_renderer *renderer, td_point_nodes *nodes, moved_batch *batch) {
    td_dynamic_rows_open(&renderer->dynamic);
    nodes->jobs.entries = nodes->jobs.count = batch->slots = 0;
}

static tides_status end_batch(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                              moved_batch *batch, tides_error *error) {
    tides_status status = td_rows_send(&renderer->dynamic, renderer->backend, error);
    if (status == TIDES_OK) status = send(renderer, camera, nodes, batch->time, batch->slots, error);
    begin_batch(renderer, nodes, batch);
    return status;
}

/* Adds one node of the Gaussians in [from, end), some of which move by themselves, as a slot of the batch. */
static tides_status add_moved(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes, node_of at,
                              moved_batch *batch, tides_error *error) {
    const int is_last = at.node == nodes->pieces << at.level, padding = TD_PAD * renderer->store.objects;
    tides_status status = TIDES_OK;
    int count = 0;
    for (int i = at.from; i < at.end; i++)
        if (is_wanted(nodes, i, at.level, at.node)) batch->wanted[count++] = nodes->group.gaussians[i];
    if (count == 0) return status;
    if (renderer->dynamic.rows.count + count + padding > batch->limit || batch->slots == BATCH_SLOTS)
        status = end_batch(renderer, camera, nodes, batch, error);
    if (status == TIDES_OK)
        status = td_dynamic_rows_ask(&renderer->dynamic, batch->wanted, count, nodes->jobs.time[at.node],
                                     is_last ? TD_SIDE_ENDS : TD_SIDE_BEGINS, batch->row, error);
    if (status == TIDES_OK) status = add_node(renderer, nodes, at, batch->slots, batch->row, error);
    batch->time[batch->slots++] = nodes->jobs.time[at.node];
    return status;
}

/* Projects all nodes, for as many Gaussians at a time as moved rows fit beside the rows that the sweep has cached. */
static tides_status project_all_moved(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                      int level, int slots, tides_error *error) {
    int *wanted = td_alloc(2 * (size_t)nodes->group.count, sizeof *wanted, error);
    tides_status status = wanted ? TIDES_OK : TIDES_NO_MEMORY;
    moved_batch batch = {.wanted = wanted, .row = wanted ? wanted + nodes->group.count : NULL};
    batch.limit = renderer->row_limit / 2 < BATCH_ROWS ? renderer->row_limit / 2 : BATCH_ROWS;
    begin_batch(renderer, nodes, &batch);
    for (int node = 0; node < slots; node++)
        for (int from = 0; from < nodes->group.count && status == TIDES_OK; from += batch.limit) {
            const int end = nodes->group.count - from > batch.limit ? from + batch.limit : nodes->group.count;
            status = add_moved(renderer, camera, nodes, (node_of){level, node, from, end}, &batch, error);
        }
    if (status == TIDES_OK) status = end_batch(renderer, camera, nodes, &batch, error);
    free(wanted);
    return status;
}

/* Adds a slot: rows of its Gaussians, some of which may move by themselves. */
static tides_status add_slot(tides_renderer *renderer, td_point_nodes *nodes, double time, int slot, int from, int end,
                             int *row, tides_error *error) {
    const int moves = renderer->dynamic.gaussians > 0;
    tides_status status = TIDES_OK;
    if (moves)
        status = td_dynamic_rows_ask(&renderer->dynamic, nodes->group.gaussians + from, end - from, time, TD_SIDE_BEGINS, row,
                                     error);
    return status == TIDES_OK ? add_node(renderer, nodes, (node_of){0, 0, from, end}, slot, moves ? row : NULL, error) : status;
}

tides_status td_point_rows_direct(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                  const double *time, const int *end, int slots, tides_error *error) {
    int *row = td_alloc((size_t)nodes->group.count + 1, sizeof *row, error);
    tides_status status = row ? TIDES_OK : TIDES_NO_MEMORY;
    if (renderer->dynamic.gaussians) td_dynamic_rows_open(&renderer->dynamic);
    nodes->jobs.entries = nodes->jobs.count = 0;
    for (int k = 0; k < slots && status == TIDES_OK; k++)
        status = add_slot(renderer, nodes, time[k], k, k ? end[k - 1] : 0, end[k], row, error);
    if (status == TIDES_OK && renderer->dynamic.gaussians) status = td_rows_send(&renderer->dynamic, renderer->backend, error);
    if (status == TIDES_OK) status = send(renderer, camera, nodes, time, slots, error);
    free(row);
    return status;
}

tides_status td_point_rows_project(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes, int level,
                                   tides_error *error) {
    const int slots = td_point_is_instant(nodes) ? 1 : (nodes->pieces << level) + 1;
    tides_status status =
        td_reserve((void **)&nodes->jobs.time, &nodes->jobs.time_capacity, (size_t)slots, sizeof *nodes->jobs.time, error);
    nodes->jobs.entries = nodes->jobs.count = 0;
    for (int k = 0; k < slots && status == TIDES_OK; k++) nodes->jobs.time[k] = node_time(nodes, level, k);
    if (renderer->dynamic.gaussians && status == TIDES_OK)
        return project_all_moved(renderer, camera, nodes, level, slots, error);
    if (status == TIDES_OK) status = add_nodes(renderer, nodes, level, slots, error);
    return status == TIDES_OK ? send(renderer, camera, nodes, nodes->jobs.time, slots, error) : status;
}
