/* Record paths in double precision for single pixels: pieces of the interval; every listed Gaussian projected at their ends
 * and in their middles; by what the middles show each gets as many nodes as it needs. */
#include "camera/td_trajectory.h"
#include "td_point_nodes.h"
#include "td_renderer.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

enum {
    JOB_GAUSSIANS = 256, /* of a job: enough for its start, few enough that threads end together */
    WHOLE_LEVEL = 3,     /* the interval stays whole where that is enough for half of all */
    MOST_LEVEL = 5,      /* 32 curves a piece: the error falls by 16^5 */
    MOST_ROWS = 1 << 21, /* where there are several pieces: 256 MB */
    MOST_SPLIT = 3,      /* slices of a whole interval, as a power of two, */
    MOST_SLICES = 8,     /* and of one in pieces */
    FEW_BENT = 64        /* so many that move, of which one may be off by more than it should */
};

/* What is off by more is off by anything [of log_luminance]. */
static const double most_off = 10;

/* What returns within the interval does so in step with its nodes: no middle shows it, but paths that are halved stray as far
 * as before. That far counts [px], where halving leaves more than half of it. */
static const double strays_px = 1e-3, strays_share = 0.5;

/* Samples nearer than this to another are it [s]. */
static const double same_time = 1e-9;

tides_status td_point_nodes_create(const tides_renderer *renderer, td_exact *shared, td_point_nodes *nodes,
                                   tides_error *error) {
    const size_t count = (size_t)renderer->store.count;
    const td_image_numbers image = td_image_pack(&renderer->image);
    nodes->path = td_alloc(count, sizeof *nodes->path, error);
    nodes->gaussians = td_alloc(count, sizeof *nodes->gaussians, error);
    nodes->level = td_alloc(count, sizeof *nodes->level, error);
    nodes->first = td_alloc(count + TD_PAD, sizeof *nodes->first, error);
    nodes->tried = td_alloc(count + TD_PAD, sizeof *nodes->tried, error);
    nodes->fit.worst = td_alloc(count + TD_PAD, sizeof *nodes->fit.worst, error);
    nodes->fit.bent = td_alloc(count + TD_PAD, sizeof *nodes->fit.bent, error);
    nodes->fit.calm = td_alloc(count + TD_PAD, sizeof *nodes->fit.calm, error);
    if (!nodes->path || !nodes->gaussians || !nodes->level || !nodes->first || !nodes->tried || !nodes->fit.worst ||
        !nodes->fit.bent || !nodes->fit.calm)
        return TIDES_NO_MEMORY;
    nodes->exact = shared;
    nodes->is_shared = shared != NULL;
    return shared ? TIDES_OK : td_exact_create(renderer->device, &renderer->store, &image, &nodes->exact, error);
}

void td_point_nodes_release(td_point_nodes *nodes) {
    if (!nodes->is_shared) td_exact_destroy(nodes->exact);
    free(nodes->knot);
    free(nodes->path);
    free(nodes->gaussians);
    free(nodes->level);
    free(nodes->first);
    free(nodes->tried);
    free(nodes->row);
    free(nodes->length);
    free(nodes->fit.worst);
    free(nodes->fit.bent);
    free(nodes->fit.calm);
    free(nodes->time);
    free(nodes->entry);
    free(nodes->at);
    free(nodes->jobs);
}

/* -- pieces ---------------------------------------------------------------------------------------------------------------- */

static tides_status add_knot(td_point_nodes *nodes, double time, tides_error *error) {
    const size_t wanted = (size_t)nodes->pieces + 1;
    tides_status status = td_reserve((void **)&nodes->knot, &nodes->knot_capacity, wanted, sizeof *nodes->knot, error);
    if (status == TIDES_OK) nodes->knot[nodes->pieces++] = time;
    return status;
}

/* The samples of a path within the interval, where its curve may bend. */
static tides_status add_samples(td_point_nodes *nodes, const tides_trajectory *path, double epoch, double start, double stop,
                                tides_error *error) {
    tides_status status = TIDES_OK;
    tides_pose_sample sample;
    if (!path || tides_trajectory_is_static(path)) return status;
    for (size_t i = td_trajectory_find(path, epoch, start); i < tides_trajectory_count(path) && status == TIDES_OK; i++) {
        status = tides_trajectory_sample(path, i, &sample, error);
        const double time = sample.time - epoch;
        if (status != TIDES_OK || time >= stop - same_time) break;
        if (time > start + same_time) status = add_knot(nodes, time, error);
    }
    return status;
}

/* The interval as one piece. */
static tides_status begin_whole(td_point_nodes *nodes, double start, double stop, tides_error *error) {
    nodes->pieces = 0; /* knots, until they are in order */
    tides_status status = add_knot(nodes, start, error);
    if (status == TIDES_OK) status = add_knot(nodes, stop, error);
    nodes->pieces = 1;
    return status;
}

/* Of an instant one row of each is enough. */
static int is_instant(const td_point_nodes *nodes) { return !(nodes->knot[0] < nodes->knot[nodes->pieces]); }

/* Cuts it where paths may bend: the pieces are between knots, each once, in order. */
static tides_status cut(const tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                        td_point_nodes *nodes, tides_error *error) {
    tides_status status = begin_whole(nodes, start, stop, error);
    nodes->pieces = 2;
    if (status == TIDES_OK) status = add_samples(nodes, camera, renderer->epoch, start, stop, error);
    if (status == TIDES_OK)
        status = td_dynamic_joints(&renderer->dynamic, start + same_time, stop - same_time, &nodes->knot, &nodes->pieces,
                                   &nodes->knot_capacity, error);
    for (int i = 0; i < renderer->store.objects && status == TIDES_OK; i++) {
        tides_object object;
        status = tides_scene_object(renderer->scene, renderer->store.scene_object[i], &object, error);
        if (status == TIDES_OK) status = add_samples(nodes, object.trajectory, renderer->epoch, start, stop, error);
    }
    if (status != TIDES_OK) return status;
    int kept = 1;
    qsort(nodes->knot, (size_t)nodes->pieces, sizeof *nodes->knot, td_ascending);
    for (int i = 1; i < nodes->pieces; i++)
        if (nodes->knot[i] > nodes->knot[kept - 1] + same_time || (i == nodes->pieces - 1 && kept == 1))
            nodes->knot[kept++] = nodes->knot[i];
    nodes->pieces = kept - 1;
    return TIDES_OK;
}

/* -- projection ------------------------------------------------------------------------------------------------------------ */

static tides_status reserve_entries(td_point_nodes *nodes, size_t more, tides_error *error) {
    const size_t wanted = (size_t)nodes->entries + more;
    tides_status status = td_reserve((void **)&nodes->entry, &nodes->entry_capacity[0], wanted, sizeof *nodes->entry, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&nodes->at, &nodes->entry_capacity[1], wanted, sizeof *nodes->at, error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&nodes->jobs, &nodes->job_capacity, (size_t)nodes->job_count + 1, sizeof *nodes->jobs, error);
    return status;
}

/* Fills the last job up to a multiple of TD_PAD with what goes to the row that nobody reads. */
static void end_job(td_point_nodes *nodes) {
    td_node_job *job = &nodes->jobs[nodes->job_count - 1];
    for (; job->count % TD_PAD; job->count++, nodes->entries++) {
        nodes->entry[nodes->entries] = TD_NO_GAUSSIAN;
        nodes->at[nodes->entries] = nodes->rows;
    }
}

/* Jobs for node `node`, which is number `slot` of a request, of gaussians[from .. end) that have a level; `row` (nullable) has
 * the rows of those, where some move by themselves. */
static tides_status add_node(const tides_renderer *renderer, td_point_nodes *nodes, int level, int node, int slot, int from,
                             int end, const int *row, tides_error *error) {
    int open = 0, object = -1, taken = 0;
    tides_status status = reserve_entries(nodes, 0, error);
    for (int i = from; i < end && status == TIDES_OK; i++) {
        const int gaussian = nodes->gaussians[i];
        if (nodes->level[i] != level) continue;
        status = reserve_entries(nodes, 2 * TD_PAD, error);
        if (status != TIDES_OK) return status;
        if (open && (renderer->store.object[gaussian] != object || nodes->jobs[nodes->job_count - 1].count == JOB_GAUSSIANS)) {
            end_job(nodes);
            open = 0;
            status = reserve_entries(nodes, 2 * TD_PAD, error);
            if (status != TIDES_OK) return status;
        }
        if (!open) nodes->jobs[nodes->job_count++] = (td_node_job){slot, nodes->entries, 0, 0};
        open = 1;
        object = renderer->store.object[gaussian];
        nodes->entry[nodes->entries] = row ? row[taken++] : gaussian;
        nodes->at[nodes->entries++] = nodes->first[i] + node;
        nodes->jobs[nodes->job_count - 1].count++;
    }
    if (open && status == TIDES_OK) end_job(nodes);
    return status;
}

/* Jobs for the next node of what the jobs from `job` on, and entries from `entry` on, are for. */
static tides_status repeat_node(td_point_nodes *nodes, int job, int entry, tides_error *error) {
    const int jobs = nodes->job_count - job, entries = nodes->entries - entry;
    tides_status status = TIDES_OK;
    for (int i = 0; i < jobs && status == TIDES_OK; i++) {
        status = reserve_entries(nodes, (size_t)entries, error);
        if (status != TIDES_OK) return status;
        const td_node_job *of = &nodes->jobs[job + i];
        nodes->jobs[nodes->job_count++] = (td_node_job){of->slot + 1, of->first + entries, of->count, 0};
    }
    for (int i = entry; i < entry + entries && status == TIDES_OK; i++) {
        nodes->entry[i + entries] = nodes->entry[i];
        nodes->at[i + entries] = nodes->at[i] + (nodes->entry[i] != TD_NO_GAUSSIAN);
    }
    nodes->entries += entries;
    return status;
}

/* Jobs for all nodes of a level, one after the other for so many Gaussians as a job takes: what they are made of, and their
 * rows, are in the cache then. */
static tides_status add_nodes(const tides_renderer *renderer, td_point_nodes *nodes, int level, int slots, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int from = 0, end = 0; from < nodes->count && status == TIDES_OK; from = end) {
        int job = nodes->job_count, entry = nodes->entries;
        for (int taken = 0; end < nodes->count && taken < JOB_GAUSSIANS; end++) taken += nodes->level[end] == level;
        status = add_node(renderer, nodes, level, 0, 0, from, end, NULL, error);
        for (int k = 1; k < slots && status == TIDES_OK; k++) {
            const int next_job = nodes->job_count, next_entry = nodes->entries;
            status = repeat_node(nodes, job, entry, error);
            job = next_job, entry = next_entry;
        }
    }
    return status;
}

/* Node k of a level, counted through all pieces [s after the epoch]. */
static double node_time(const td_point_nodes *nodes, int level, int k) {
    const int piece = k >> level, part = k & ((1 << level) - 1);
    if (part == 0) return nodes->knot[piece];
    return nodes->knot[piece] + (nodes->knot[piece + 1] - nodes->knot[piece]) * (part / (double)(1 << level));
}

/* The nodes that there are jobs for, at `slots` times. */
static tides_status send(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes, const double *times,
                         int slots, tides_error *error) {
    if (nodes->job_count == 0) return TIDES_OK;
    tides_status status = td_renderer_views(renderer, camera, times, slots, error);
    if (status != TIDES_OK) return status;
    const td_node_request request = {.views = (const double *)renderer->views,
                                     .slots = slots,
                                     .jobs = nodes->jobs,
                                     .job_count = nodes->job_count,
                                     .gaussians = nodes->entry,
                                     .rows = nodes->at,
                                     .count = nodes->entries,
                                     .row_count = nodes->rows + 1};
    return td_exact_nodes(nodes->exact, renderer->backend, &request, error);
}

/* One node of gaussians[from .. end), some of which move by themselves: first their rows. `wanted` and `row` have room for
 * them. */
static tides_status project_moved(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes, int level,
                                  int node, int from, int end, int *wanted, int *row, tides_error *error) {
    const int is_last = node == nodes->pieces << level;
    int count = 0;
    for (int i = from; i < end; i++)
        if (nodes->level[i] == level) wanted[count++] = nodes->gaussians[i];
    if (count == 0) return TIDES_OK;
    tides_status status = td_dynamic_rows_at(&renderer->dynamic, renderer->backend, wanted, count, nodes->time[node],
                                             is_last ? TD_SIDE_ENDS : TD_SIDE_BEGINS, row, error);
    nodes->entries = nodes->job_count = 0;
    if (status == TIDES_OK) status = add_node(renderer, nodes, level, node, 0, from, end, row, error);
    return status == TIDES_OK ? send(renderer, camera, nodes, nodes->time + node, 1, error) : status;
}

/* All nodes, one by one, of so many Gaussians as rows of motions have room for beside what the sweep has cached. */
static tides_status project_all_moved(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                      int level, int slots, tides_error *error) {
    const int chunk = renderer->row_limit / 2;
    int *wanted = td_alloc(2 * (size_t)nodes->count, sizeof *wanted, error);
    tides_status status = wanted ? TIDES_OK : TIDES_NO_MEMORY;
    for (int node = 0; node < slots; node++)
        for (int from = 0; from < nodes->count && status == TIDES_OK; from += chunk)
            status =
                project_moved(renderer, camera, nodes, level, node, from,
                              nodes->count - from > chunk ? from + chunk : nodes->count, wanted, wanted + nodes->count, error);
    free(wanted);
    return status;
}

/* Rows of the Gaussians of a level, at all its nodes. */
static tides_status project(tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes, int level,
                            tides_error *error) {
    const int slots = is_instant(nodes) ? 1 : (nodes->pieces << level) + 1;
    tides_status status = td_reserve((void **)&nodes->time, &nodes->time_capacity, (size_t)slots, sizeof *nodes->time, error);
    nodes->entries = nodes->job_count = 0;
    for (int k = 0; k < slots && status == TIDES_OK; k++) nodes->time[k] = node_time(nodes, level, k);
    if (renderer->dynamic.gaussians && status == TIDES_OK)
        return project_all_moved(renderer, camera, nodes, level, slots, error);
    if (status == TIDES_OK) status = add_nodes(renderer, nodes, level, slots, error);
    return status == TIDES_OK ? send(renderer, camera, nodes, nodes->time, slots, error) : status;
}

/* -- levels ---------------------------------------------------------------------------------------------------------------- */

static tides_status too_many(const td_point_nodes *nodes, tides_error *error) {
    return td_fail(error, TIDES_NO_MEMORY, "record paths of an interval of %g s: too many rows; use shorter steps",
                   nodes->knot[nodes->pieces] - nodes->knot[0]);
}

/* The level that a Gaussian begins with, so that no curve has it go further than its own diameter: what comes back between two
 * nodes, or is over, shows in neither. Above MOST_LEVEL where none is enough. */
static int first_level(const tides_renderer *renderer, const td_point_nodes *nodes, int gaussian) {
    int level = 1;
    while (level <= MOST_LEVEL && renderer->travel[gaussian] > (double)((int64_t)nodes->pieces << level)) level++;
    return level;
}

/* Those in a list, with rows of their first levels. */
static tides_status find_listed(const tides_renderer *renderer, const td_point_span *lists, td_point_nodes *nodes,
                                tides_error *error) {
    const int end = lists->first[renderer->stats.tiles];
    int64_t rows = 0;
    for (int i = 0; i < renderer->store.count; i++) nodes->path[i] = TD_PATH_UNSEEN;
    for (int i = 0; i < end; i++)
        if (lists->list[i] >= 0) nodes->path[lists->list[i]] = 0;
    nodes->count = nodes->bent = 0;
    for (int i = 0; i < renderer->store.count; i++) {
        if (nodes->path[i] == TD_PATH_UNSEEN) continue;
        int level = is_instant(nodes) ? 0 : first_level(renderer, nodes, i);
        nodes->bent += level > MOST_LEVEL;
        if (level > MOST_LEVEL) level = MOST_LEVEL;
        nodes->first[nodes->count] = (int)rows;
        nodes->level[nodes->count] = (uint8_t)level;
        nodes->gaussians[nodes->count++] = i;
        rows += is_instant(nodes) ? 1 : ((int64_t)nodes->pieces << level) + 1;
        if (rows > INT32_MAX / TD_PATH_STRIDE) return too_many(nodes, error);
    }
    nodes->rows = (int)rows;
    return TIDES_OK;
}

/* Gives a Gaussian rows of the next level. */
static tides_status refine(td_point_nodes *nodes, int i, tides_error *error) {
    const int level = ++nodes->level[i];
    const int64_t rows = (int64_t)nodes->rows + ((int64_t)nodes->pieces << level) + 1;
    if (rows > INT32_MAX / TD_PATH_STRIDE) return too_many(nodes, error);
    nodes->first[i] = nodes->rows;
    nodes->rows = (int)rows;
    return TIDES_OK;
}

/* What the rows of Gaussian i allow its paths to be good to: those that a motion model moves are in the backend's precision. */
static double target_of(const tides_renderer *renderer, const td_point_nodes *nodes, int i) {
    const int moves = renderer->store.mover[renderer->store.object[nodes->gaussians[i]]] >= 0;
    return moves && !td_renderer_is_double(renderer) ? TD_POINT_PATH_MOVED : TD_POINT_PATH_TARGET;
}

/* What a motion model does it does to many splats at once: their errors add up. Without, p95 was reported too small in 1 of 45
 * random scenes, where a lamp flickers (tests/property/test_solved.c). */
static double added_up(const tides_renderer *renderer, const td_point_nodes *nodes, int i) {
    return renderer->store.mover[renderer->store.object[nodes->gaussians[i]]] >= 0 ? 2 : 1;
}

/* What Gaussian i needs whose cubics of the level before are off by so much (of log_luminance) in the middle: its level is
 * enough where a sixteenth of the worst is, by which a smooth path's error falls with each level; at the last it may have a
 * kink, and is taken to be off by all of it the share `bent` of the time. What can't be compared at all crosses the near plane:
 * it has faded where its curves can't be used, if they are short, so that it counts as bent, and isn't told. An event sees a
 * path at some time: the law is told what is off on average, outside of kinks; the worst was 20 times what is true where a lamp
 * flickers, or a splat passes the clamp. */
static tides_status choose_level(const tides_renderer *renderer, td_point_nodes *nodes, int i, double worst, double calm,
                                 double bent, tides_error *error) {
    const double never = 2 * TD_PATH_WILD * TD_POINT_PATH_TARGET;
    const double target = target_of(renderer, nodes, i);
    double falls = 16;
    const int first = first_level(renderer, nodes, nodes->gaussians[i]);
    nodes->moving += worst > 0 && nodes->level[i] == (first < MOST_LEVEL ? first : MOST_LEVEL);
    if (worst > falls * target && nodes->level[i] < MOST_LEVEL) return refine(nodes, i, error);
    const int is_bent = worst > falls * target;
    if (nodes->level[i] == 1 && worst <= target) {
        nodes->level[i] = 0; /* with every other row of level 1 */
        falls = 1;
    }
    nodes->bent += is_bent;
    if (!(worst > 0 && worst < never)) return TIDES_OK;
    const double smooth = is_bent || worst <= TD_PATH_BENT * TD_POINT_PATH_TARGET ? calm : worst;
    td_path_tally_add(&nodes->tally, added_up(renderer, nodes, i) * smooth / falls, fmin(worst, most_off), is_bent ? bent : 0);
    return TIDES_OK;
}

/* Compares the paths of a level with those of the level before, and gives the next level to those that need it. */
static tides_status try_level(const tides_renderer *renderer, td_point_nodes *nodes, td_points_engine *engine, int level,
                              tides_error *error) {
    int count = 0;
    for (int i = 0; i < nodes->count; i++)
        if (nodes->level[i] == level) nodes->tried[count++] = nodes->first[i];
    for (int i = count; i < count + TD_PAD; i++) nodes->tried[i] = count ? nodes->tried[0] : 0;
    const td_points_misfits request = {nodes->exact, nodes->rows, nodes->tried,  count,
                                       level,        nodes->knot, nodes->pieces, TD_POINT_PATH_TARGET};
    tides_status status = count ? engine->type->misfits(engine, &request, &nodes->fit, error) : TIDES_OK;
    for (int i = 0, k = 0; i < nodes->count && status == TIDES_OK; i++) {
        if (nodes->level[i] != level) continue;
        const double worst = (double)nodes->fit.worst[k] * TD_POINT_PATH_TARGET;
        const double calm = (double)nodes->fit.calm[k] * TD_POINT_PATH_TARGET;
        status = choose_level(renderer, nodes, i, worst, calm, nodes->fit.bent[k++], error);
    }
    return status;
}

/* Curves of all; paths. */
static tides_status lay_curves(td_point_nodes *nodes, tides_error *error) {
    const int moves = !is_instant(nodes);
    size_t curves = 0;
    for (int i = 0; i < nodes->count; i++) curves += (size_t)nodes->pieces << nodes->level[i];
    tides_status status = td_reserve((void **)&nodes->row, &nodes->row_capacity, 2 * curves, sizeof *nodes->row, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&nodes->length, &nodes->length_capacity, curves, sizeof *nodes->length, error);
    if (status != TIDES_OK) return status;
    nodes->curves = 0;
    for (int i = 0; i < nodes->count; i++) {
        const int level = nodes->level[i], stride = !moves ? 0 : level == 0 ? 2 : 1; /* level 0 has the rows of level 1 */
        nodes->path[nodes->gaussians[i]] = nodes->curves * TD_PATH_LEVELS + level;
        for (int k = 0; k < nodes->pieces << level; k++) {
            const double h = nodes->knot[(k >> level) + 1] - nodes->knot[k >> level];
            nodes->row[2 * nodes->curves] = nodes->first[i] + stride * k;
            nodes->row[2 * nodes->curves + 1] = nodes->first[i] + stride * (k + 1);
            nodes->length[nodes->curves++] = (moves ? h : TD_POINT_INSTANT) / (double)(1 << level);
        }
    }
    return TIDES_OK;
}

/* Are more than few bent? */
static int are_bent(const td_point_nodes *nodes) { return FEW_BENT * (int64_t)nodes->bent > nodes->moving; }

/* Rows of everything listed, in the pieces that there are. `bent`: whether others may be had; whether they are needed, because
 * WHOLE_LEVEL isn't enough for more than half of all, or all levels aren't for more than few of those that move. */
static tides_status find_rows(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                              const td_point_span *span, td_point_nodes *nodes, int *bent, tides_error *error) {
    const int may_bend = *bent;
    *bent = 0;
    tides_status status = find_listed(renderer, span, nodes, error);
    nodes->tally = (td_path_tally){0};
    nodes->moving = 0;
    if (status == TIDES_OK && is_instant(nodes)) return project(renderer, camera, nodes, 0, error);
    for (int level = 1, finer = 1; level <= MOST_LEVEL && finer > 0 && status == TIDES_OK && !*bent; level++) {
        finer = 0;
        status = project(renderer, camera, nodes, level, error);
        if (status == TIDES_OK) status = try_level(renderer, nodes, engine, level, error);
        for (int i = 0; i < nodes->count; i++) finer += nodes->level[i] > level;
        *bent = may_bend && level == WHOLE_LEVEL && 2 * finer > nodes->count;
    }
    *bent = *bent || (may_bend && are_bent(nodes));
    return status;
}

/* Rows in the pieces that there are; or, where they would be too many, none. */
static tides_status find_cut(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                             const td_point_span *span, td_point_nodes *nodes, tides_error *error) {
    int bent = 0;
    tides_status status = cut(renderer, camera, span->start, span->stop, nodes, error);
    const double middle = nodes->knot[nodes->pieces / 2];
    if (status == TIDES_OK && (2 * (int64_t)nodes->pieces + 1) * nodes->count > MOST_ROWS) nodes->halve = middle;
    if (status != TIDES_OK || !isnan(nodes->halve)) return status;
    return find_rows(renderer, camera, engine, span, nodes, &bent, error);
}

/* Does halving the interval, and its halves, bring cubics nearer to what paths do within it? */
static int is_tame(const tides_renderer *renderer) {
    for (int i = 0; i < renderer->store.objects; i++) {
        const double *px = renderer->strays.px + (size_t)i * TD_STRAY_LEVELS;
        for (int k = 1; k < WHOLE_LEVEL; k++)
            if (px[k] > strays_px && px[k] > strays_share * px[k - 1]) return 0;
    }
    return 1;
}

/* Most paths are smooth enough for the interval to be one piece, whatever samples they have within it: then points share
 * curves. Where they aren't, as where a camera turns a corner or shakes, or a lamp flickers, it's cut there. Where that isn't
 * enough, as for what a formula shakes at some kHz, it is halved. */
tides_status td_point_nodes_find(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 const td_point_span *span, td_point_nodes *nodes, tides_error *error) {
    tides_status status = cut(renderer, camera, span->start, span->stop, nodes, error);
    int bent = nodes->pieces > 1;
    const int whole = !bent || !(span->start < span->stop) || is_tame(renderer);
    nodes->halve = NAN;
    if (status == TIDES_OK && whole) status = begin_whole(nodes, span->start, span->stop, error);
    if (status == TIDES_OK && whole) status = find_rows(renderer, camera, engine, span, nodes, &bent, error);
    if (status == TIDES_OK && bent) status = find_cut(renderer, camera, engine, span, nodes, error);
    if (status != TIDES_OK || !isnan(nodes->halve)) return status;
    if (are_bent(nodes) && (span->stop - span->start) / nodes->pieces >= 2 * span->shortest)
        nodes->halve = nodes->pieces > 1 ? nodes->knot[nodes->pieces / 2] : 0.5 * (span->start + span->stop);
    return isnan(nodes->halve) ? lay_curves(nodes, error) : status;
}

/* Tests take a splat to go straight on in a slice, and cost as much again with each: how splats bend curves tell. Of 10 ms of
 * the demo, 5 curves a splat, a point costs 2.9, 1.8, 1.5 us with 1, 2, 4 slices, of 3 ms 1.2 with any; and a trained object's
 * lists, 1300 long, cost more than their points with 4. */
td_points_slices td_point_nodes_slices(const td_point_nodes *nodes) {
    int split = 0;
    if (nodes->pieces > 1) {
        const int group = (nodes->pieces + MOST_SLICES - 1) / MOST_SLICES;
        return (td_points_slices){nodes->pieces, (nodes->pieces + group - 1) / group, 0, group};
    }
    while (split < MOST_SPLIT && 2 * (int64_t)nodes->curves > 3 * ((int64_t)nodes->count << split)) split++;
    return (td_points_slices){1, 1 << split, split, 1};
}
