/* Record paths of an interval: which Gaussians have one, and of how many nodes (td_paths.h). For the renderer's sweep, which
 * asks for them once it knows who can be seen. Times are path_times.c's, rows and misfits the backend's. */
#include "td_renderer.h"

#include <math.h>
#include <stdlib.h>

/* More nodes than 2^4, of what moves by itself than 2^2, aren't asked for: each costs a projection, or a network's
 * evaluation and one, and a Gaussian whose tiles take more samples than that is the exception. */
enum { FIRST_LEVEL = 1, MOST_LEVEL = 4, MOST_MOVED_LEVEL = 2 };

enum {
    ROW_LIMIT = 1 << 22,     /* rows in all, 256 MB on the device; Gaussians beyond have no path */
    ENTRY_LIMIT = 1 << 18,   /* rows per launch, where it isn't a single node's */
    JOB_LENGTH = 16 * TD_PAD /* rows per work-group */
};

/* What rounding makes of a number, relative: some units of the last place. */
static const double rounding_float = 0x1p-22, rounding_double = 0x1p-50;

/* Shifts below this are nothing [px], and no splat is taken for narrower than this [px^2]: misfits see to those that are. */
static const double least_px = 2e-5, least_variance = 0.1;

/* A smooth misfit falls by this much from one level to the next. */
static const double order_bits = 4;

tides_status td_renderer_paths(tides_renderer *renderer, double tolerance, double time_tolerance_s, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    if (renderer->image.decoder || renderer->image.is_coded)
        return TIDES_OK; /* no luminance to interpolate: projected at each time */
    tides_status status = renderer->backend->type->prepare_paths(renderer->backend, error);
    if (status != TIDES_OK) return status;
    size_t count = (size_t)renderer->store.count;
    paths->path_of = td_alloc(count, sizeof *paths->path_of, error);
    paths->level = td_alloc(count, sizeof *paths->level, error);
    if (!paths->path_of || !paths->level) return TIDES_NO_MEMORY;
    paths->tolerance = tolerance;
    paths->time_tolerance_s = time_tolerance_s;
    paths->on = 1;
    return renderer->beside ? td_renderer_paths(renderer->beside, tolerance, time_tolerance_s, error) : TIDES_OK;
}

/* The first level that an object's Gaussians may have, by how far its path strays from the cubics of as many pieces; 0 where
 * none will do. What a pixel makes of a shift: e^(-1/2) per standard deviation (kernels/path_node.h), the dilation's where it
 * is switched on. */
static int first_level(const tides_renderer *renderer, int object) {
    const double *px = renderer->strays.px + (size_t)object * TD_STRAY_LEVELS;
    const double sigma = sqrt(fmax(renderer->image.dilation, least_variance));
    const double enough = fmax(renderer->paths.tolerance * sigma / 0.6065306597126334, least_px);
    int level = FIRST_LEVEL, most = renderer->store.mover[object] >= 0 ? MOST_MOVED_LEVEL : MOST_LEVEL;
    while (level <= most && px[level] > enough) level++;
    return level <= most ? level : 0;
}

/* Gaussians that some tile may see want a path of their object's first level. */
static void mark_seen(tides_renderer *renderer) {
    td_record_paths *paths = &renderer->paths;
    const td_candidates *lists = &renderer->candidates;
    int entries = lists->first[lists->tiles_x * lists->tiles_y], object = -1, level = 0;
    memset(paths->level, 0, (size_t)renderer->store.count);
    for (int g = 0; g < renderer->store.count; g++) paths->path_of[g] = TD_PATH_UNSEEN;
    for (int i = 0; i < entries; i++) {
        int g = lists->list[i];
        if (g == TD_NO_GAUSSIAN) continue;
        if (renderer->store.object[g] != object) {
            object = renderer->store.object[g];
            level = first_level(renderer, object);
        }
        paths->level[g] = (uint8_t)level;
        paths->path_of[g] = TD_PATH_DIRECT;
    }
}

/* Those that want a level, in order, and the first row of each; what there's no room for goes without. Returns how many. */
static tides_status take_level(tides_renderer *renderer, int level, int *count, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    int rows = td_paths_rows(level);
    *count = 0;
    tides_status status = td_reserve((void **)&paths->wanted, &paths->wanted_capacity, (size_t)renderer->store.count,
                                     sizeof *paths->wanted, error);
    for (int g = 0; g < renderer->store.count && status == TIDES_OK; g++) {
        if (paths->level[g] != level) continue;
        paths->path_of[g] = TD_PATH_DIRECT;
        if (paths->row_count > ROW_LIMIT - rows) continue;
        paths->path_of[g] = paths->row_count * TD_PATH_LEVELS + level;
        paths->row_count += rows;
        paths->wanted[(*count)++] = g;
    }
    return status;
}

/* -- rows ---------------------------------------------------------------------------------------------------------- */

/* Room for entries and jobs of one more node of `count` Gaussians. */
static tides_status reserve_entries(tides_renderer *renderer, int count, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    size_t more = (size_t)paths->entries + (size_t)count + (size_t)TD_PAD * (size_t)renderer->store.objects;
    size_t jobs = more / JOB_LENGTH + (size_t)paths->job_count + (size_t)renderer->store.objects + 1;
    tides_status status = td_reserve((void **)&paths->gaussians, &paths->entry_capacity[0], more, sizeof(int), error);
    if (status == TIDES_OK) status = td_reserve((void **)&paths->rows, &paths->entry_capacity[1], more, sizeof(int), error);
    return status == TIDES_OK ? td_reserve((void **)&paths->jobs, &paths->job_capacity, jobs, sizeof *paths->jobs, error)
                              : status;
}

/* Fills the last group up, and makes jobs of what has come since entry `first`. Row 0 is nobody's. */
static void end_object(td_record_paths *paths, int slot, int first) {
    for (; (paths->entries - first) % TD_PAD; paths->entries++) {
        paths->gaussians[paths->entries] = TD_NO_GAUSSIAN;
        paths->rows[paths->entries] = 0;
    }
    for (; first < paths->entries; first += JOB_LENGTH) {
        int count = paths->entries - first < JOB_LENGTH ? paths->entries - first : JOB_LENGTH;
        paths->jobs[paths->job_count++] = (td_node_job){slot, first, count, 0};
    }
}

/* Gaussians wanted[from .. end) at node `node` of their level, object by object; `row_of_moved` (nullable) has the rows of
 * those that move by themselves. */
static tides_status add_node(tides_renderer *renderer, int slot, int node, int from, int end, const int *row_of_moved,
                             tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    const td_store *store = &renderer->store;
    tides_status status = reserve_entries(renderer, end - from, error);
    for (int i = from; i < end && status == TIDES_OK;) {
        int object = store->object[paths->wanted[i]], first = paths->entries;
        for (; i < end && store->object[paths->wanted[i]] == object; i++, paths->entries++) {
            int g = paths->wanted[i];
            paths->gaussians[paths->entries] = row_of_moved && store->mover[object] >= 0 ? row_of_moved[i - from] : g;
            paths->rows[paths->entries] = paths->path_of[g] / TD_PATH_LEVELS + node;
        }
        end_object(paths, slot, first);
    }
    return status;
}

static tides_status send_nodes(tides_renderer *renderer, int slots, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    const td_node_request request = {(const double *)renderer->views,
                                     slots,
                                     paths->jobs,
                                     paths->job_count,
                                     paths->gaussians,
                                     paths->rows,
                                     paths->entries,
                                     paths->row_count};
    renderer->stats.path_nodes += (uint64_t)slots;
    return renderer->backend->type->nodes(renderer->backend, &request, error);
}

/* Nodes [first, end) of all that want a level, none of which moves by itself. */
static tides_status project_nodes(tides_renderer *renderer, const tides_trajectory *camera, int first, int end, int count,
                                  tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    tides_status status = td_renderer_views(renderer, camera, paths->time + first, end - first, error);
    paths->entries = paths->job_count = 0;
    for (int node = first; node < end && status == TIDES_OK; node++)
        status = add_node(renderer, node - first, node, 0, count, NULL, error);
    return status == TIDES_OK ? send_nodes(renderer, end - first, error) : status;
}

/* One node of wanted[from .. end), some of which move by themselves: first their rows. */
static tides_status project_moved(tides_renderer *renderer, const tides_trajectory *camera, int node, int last, int from,
                                  int end, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    int *row = td_alloc((size_t)(end - from), sizeof *row, error);
    if (!row) return TIDES_NO_MEMORY;
    const int side = node == last ? TD_SIDE_ENDS : TD_SIDE_BEGINS;
    tides_status status = td_dynamic_rows_at(&renderer->dynamic, renderer->backend, paths->wanted + from, end - from,
                                             paths->time[node], side, row, error);
    if (status == TIDES_OK) status = td_renderer_views(renderer, camera, paths->time + node, 1, error);
    paths->entries = paths->job_count = 0;
    if (status == TIDES_OK) status = add_node(renderer, 0, node, from, end, row, error);
    if (status == TIDES_OK) status = send_nodes(renderer, 1, error);
    free(row);
    return status;
}

/* All rows of the `count` Gaussians that want a level. */
static tides_status project_level(tides_renderer *renderer, const tides_trajectory *camera, int level, int count,
                                  tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    int rows = td_paths_rows(level), at_once = ENTRY_LIMIT / count > 1 ? ENTRY_LIMIT / count : 1;
    int chunk = renderer->row_limit / 2; /* beside what the sweep has cached; padding is less */
    tides_status status = td_reserve((void **)&paths->time, &paths->time_capacity, (size_t)rows, sizeof *paths->time, error);
    for (int node = 0; node < rows && status == TIDES_OK; node++) paths->time[node] = td_paths_node(paths, level, node);
    for (int node = 0; node < rows && !renderer->dynamic.gaussians && status == TIDES_OK; node += at_once)
        status = project_nodes(renderer, camera, node, node + at_once < rows ? node + at_once : rows, count, error);
    for (int node = 0; node < rows && renderer->dynamic.gaussians; node++)
        for (int from = 0; from < count && status == TIDES_OK; from += chunk)
            status = project_moved(renderer, camera, node, rows - 1, from, from + chunk < count ? from + chunk : count, error);
    renderer->stats.gaussians_at_nodes += (uint64_t)rows * (uint64_t)count;
    return status;
}

/* -- misfits ------------------------------------------------------------------------------------------------------- */

/* What becomes of a Gaussian whose path of this level has a misfit: it tries the level that a smooth one would need, unless
 * that is too fine. */
static void judge(tides_renderer *renderer, int gaussian, int level, float misfit) {
    td_record_paths *paths = &renderer->paths;
    const int moves = renderer->store.mover[renderer->store.object[gaussian]] >= 0;
    if (misfit <= 1) return;
    paths->path_of[gaussian] = TD_PATH_DIRECT;
    if (misfit >= TD_PATH_WILD) return;
    int more = (int)ceil(log2((double)misfit) / order_bits);
    int next = level + (more < 1 ? 1 : more);
    if (next <= (moves ? MOST_MOVED_LEVEL : MOST_LEVEL)) paths->level[gaussian] = (uint8_t)next;
}

static tides_status measure_level(tides_renderer *renderer, int level, int count, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    const double length = paths->stop - paths->start;
    int padded = (count + TD_PAD - 1) / TD_PAD * TD_PAD;
    tides_status status =
        td_reserve((void **)&paths->first, &paths->first_capacity, (size_t)padded, sizeof *paths->first, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&paths->misfit, &paths->misfit_capacity, (size_t)padded, sizeof *paths->misfit, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < padded; i++) paths->first[i] = paths->path_of[paths->wanted[i < count ? i : 0]] / TD_PATH_LEVELS;
    const td_path_request request = {.first = paths->first,
                                     .count = padded,
                                     .level = level,
                                     .pieces = 1,
                                     .lengths = &length,
                                     .tolerance = paths->tolerance,
                                     .time_tolerance_s = paths->time_tolerance_s,
                                     .rounding = td_renderer_is_double(renderer) ? rounding_double : rounding_float};
    status = renderer->backend->type->path_misfits(renderer->backend, &request, paths->misfit, error);
    for (int i = 0; i < count && status == TIDES_OK; i++) judge(renderer, paths->wanted[i], level, paths->misfit[i]);
    return status;
}

/* -- an interval --------------------------------------------------------------------------------------------------- */

/* How many of each tile's list have no path. */
static tides_status count_direct(tides_renderer *renderer, tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    const td_candidates *lists = &renderer->candidates;
    int tiles = lists->tiles_x * lists->tiles_y;
    tides_status status =
        td_reserve((void **)&paths->direct, &paths->direct_capacity, (size_t)tiles, sizeof *paths->direct, error);
    paths->direct_moves = 0;
    for (int t = 0; t < tiles && status == TIDES_OK; t++) {
        paths->direct[t] = 0;
        for (int i = lists->first[t]; i < lists->first[t + 1]; i++) {
            int g = lists->list[i];
            if (g == TD_NO_GAUSSIAN || paths->path_of[g] >= 0) continue;
            paths->direct[t]++;
            paths->direct_moves |= renderer->store.mover[renderer->store.object[g]] >= 0;
        }
    }
    return status;
}

tides_status td_paths_find(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                           tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    tides_status status = TIDES_OK;
    paths->there = 0;
    if (!paths->on || !(start < stop) || td_dynamic_knot_within(&renderer->dynamic, start, stop)) return TIDES_OK;
    paths->start = start;
    paths->stop = stop;
    mark_seen(renderer);
    paths->row_count = 1;
    for (int level = FIRST_LEVEL; level <= MOST_LEVEL && status == TIDES_OK; level++) {
        int count;
        status = take_level(renderer, level, &count, error);
        if (status != TIDES_OK || count == 0) continue;
        status = project_level(renderer, camera, level, count, error);
        if (status == TIDES_OK) status = measure_level(renderer, level, count, error);
    }
    if (status == TIDES_OK) status = count_direct(renderer, error);
    if (status != TIDES_OK) return status;
    paths->serial++;
    paths->there = 1;
    return TIDES_OK;
}

void td_paths_release(td_record_paths *paths) {
    void *owned[] = {paths->path_of,   paths->direct, paths->cubics, paths->nodes, paths->level, paths->wanted,
                     paths->gaussians, paths->rows,   paths->first,  paths->jobs,  paths->time,  paths->misfit};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) free(owned[i]);
    memset(paths, 0, sizeof *paths);
}
