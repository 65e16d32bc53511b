/* Record paths in double precision for single pixels: pieces of the interval; every listed Gaussian projected at their ends
 * and in their middles (point_rows.c); by what the middles show each gets as many nodes as it needs.
 *
 * A Gaussian's nodes depend on it alone, so they are the same whenever it is made, and with whichever others. Into which pieces
 * an interval is cut is told by all that is in a list, or by every so manieth of that. */
#include "camera/td_trajectory.h"
#include "td_point_nodes.h"
#include "td_renderer.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

enum {
    WHOLE_LEVEL = 3,     /* the interval stays one piece if this level is enough for half of all Gaussians */
    MOST_LEVEL = 5,      /* 32 curves per piece: the error falls by 16^5 */
    MOST_ROWS = 1 << 21, /* limit for several pieces: 256 MB */
    MOST_SPLIT = 3,      /* log2 of the slices of an interval of one piece */
    MOST_SLICES = 8,     /* slices of an interval of several pieces */
    FEW_BENT = 64,       /* one in so many moving Gaussians may have too large an error */
    GROUP = 1 << 15,     /* Gaussians that are made together: so many are made at once, whoever asks */
    SOME = 1 << 12       /* of more, so many tell what pieces all have */
};

/* Bounds for paths that return within the interval in step with its nodes. No middle shows such a return, but halved paths
 * stray as far as before. A stray counts from so many pixels on, where halving leaves more than half of it. */
static const double strays_px = 1e-3, strays_share = 0.5;

/* Curves of an interval at most, so that a curve's reals can be counted in 32 bits (TD_CURVE_REALS of
 * kernels/point_lists.h). */
#define MOST_CURVES ((size_t)INT32_MAX / (2 * TD_PATH_STRIDE))

/* Samples nearer than this to another are it [s]. */
static const double same_time = 1e-9;

static tides_status create_group(td_path_group *group, size_t count, tides_error *error) {
    group->own = td_alloc(count, sizeof *group->own, error);
    group->gaussians = td_alloc(count, sizeof *group->gaussians, error);
    group->level = td_alloc(count, sizeof *group->level, error);
    group->first = td_alloc(count + TD_PAD, sizeof *group->first, error);
    group->kept = td_alloc(count, sizeof *group->kept, error);
    group->open_at = td_alloc(count, sizeof *group->open_at, error);
    group->halve_from = td_alloc(count, sizeof *group->halve_from, error);
    group->halve_to = td_alloc(count, sizeof *group->halve_to, error);
    group->is_direct = td_alloc(count, sizeof *group->is_direct, error);
    group->tried = td_alloc(count + TD_PAD, sizeof *group->tried, error);
    group->fit.worst = td_alloc(count + TD_PAD, sizeof *group->fit.worst, error);
    const int has_lists = group->own && group->gaussians && group->level && group->first && group->kept && group->open_at;
    const int has_work = group->halve_from && group->halve_to && group->is_direct && group->tried && group->fit.worst;
    return has_lists && has_work ? TIDES_OK : TIDES_NO_MEMORY;
}

static void release_group(td_path_group *group) {
    free(group->own);
    free(group->gaussians);
    free(group->level);
    free(group->first);
    free(group->kept);
    free(group->open_at);
    free(group->open);
    free(group->halve_from);
    free(group->halve_to);
    free(group->is_direct);
    free(group->tried);
    free(group->row);
    free(group->length);
    free(group->fit.worst);
    free(group->fit.each);
}

tides_status td_point_nodes_create(const tides_renderer *renderer, td_exact *shared, td_point_nodes *nodes,
                                   tides_error *error) {
    const size_t all = (size_t)renderer->store.count, count = all < GROUP ? all : GROUP;
    const td_image_numbers image = td_image_pack(&renderer->image);
    nodes->path = td_alloc(all, sizeof *nodes->path, error);
    nodes->listed = td_alloc(all, sizeof *nodes->listed, error);
    nodes->wanted = td_alloc(all, sizeof *nodes->wanted, error);
    if (!nodes->path || !nodes->listed || !nodes->wanted) return TIDES_NO_MEMORY;
    const tides_status status = create_group(&nodes->group, count, error);
    if (status != TIDES_OK) return status;
    nodes->group_size = GROUP;
    nodes->sample_size = SOME;
    nodes->exact = shared;
    nodes->is_shared = shared != NULL;
    return shared ? TIDES_OK : td_exact_create(renderer->device, &renderer->store, &image, &nodes->exact, error);
}

void td_point_nodes_release(td_point_nodes *nodes) {
    if (!nodes->is_shared) td_exact_destroy(nodes->exact);
    free(nodes->kept);
    free(nodes->knot);
    free(nodes->piece_length);
    free(nodes->path);
    free(nodes->listed);
    free(nodes->wanted);
    release_group(&nodes->group);
    free(nodes->jobs.time);
    free(nodes->jobs.entry);
    free(nodes->jobs.at);
    free(nodes->jobs.list);
}

/* -- pieces ---------------------------------------------------------------------------------------------------------------- */

static tides_status add_knot(td_point_nodes *nodes, double time, tides_error *error) {
    const size_t wanted = (size_t)nodes->pieces + 1;
    tides_status status = td_reserve((void **)&nodes->knot, &nodes->knot_capacity, wanted, sizeof *nodes->knot, error);
    if (status == TIDES_OK) nodes->knot[nodes->pieces++] = time;
    return status;
}

/* Adds the samples of a path within the interval as knots, since the curve may bend there. */
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

/* Makes the interval one piece. */
static tides_status begin_whole(td_point_nodes *nodes, double start, double stop, tides_error *error) {
    nodes->pieces = 0; /* counts knots until they are sorted */
    tides_status status = add_knot(nodes, start, error);
    if (status == TIDES_OK) status = add_knot(nodes, stop, error);
    nodes->pieces = 1;
    return status;
}

/* Cuts the interval at the knots, where paths may bend. */
static tides_status cut(const tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                        td_point_nodes *nodes, tides_error *error) {
    tides_status status = begin_whole(nodes, start, stop, error);
    nodes->pieces = 2;
    if (status == TIDES_OK) status = add_samples(nodes, camera, renderer->epoch, start, stop, error);
    const int before = nodes->pieces;
    if (status == TIDES_OK)
        status = td_dynamic_joints(&renderer->dynamic, start + same_time, stop - same_time, &nodes->knot, &nodes->pieces,
                                   &nodes->knot_capacity, error);
    nodes->joints = nodes->pieces - before;
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

/* -- levels ---------------------------------------------------------------------------------------------------------------- */

static tides_status too_many(const td_point_nodes *nodes, tides_error *error) {
    return td_fail(error, TIDES_NO_MEMORY, "record paths of an interval of %g s: too many rows; use shorter steps",
                   nodes->knot[nodes->pieces] - nodes->knot[0]);
}

/* A Gaussian's first level. No curve may be longer than the Gaussian's diameter: what happens and returns between two nodes
 * would show at neither. Above MOST_LEVEL if no level is enough. */
static int first_level(const tides_renderer *renderer, const td_point_nodes *nodes, int gaussian) {
    int level = 1;
    while (level <= MOST_LEVEL && renderer->sweep.travel[gaussian] > (double)((int64_t)nodes->pieces << level)) level++;
    return level;
}

/* Lists the Gaussians that are in some list; none of them has a path yet. */
static void find_listed(const tides_renderer *renderer, const td_point_span *lists, td_point_nodes *nodes) {
    const int end = lists->first[renderer->stats.tiles];
    for (int i = 0; i < renderer->store.count; i++) nodes->path[i] = TD_PATH_UNSEEN;
    for (int i = 0; i < end; i++)
        if (lists->list[i] >= 0) nodes->path[lists->list[i]] = TD_PATH_UNMADE;
    nodes->listed_count = nodes->made = nodes->curves = 0;
    for (int i = 0; i < renderer->store.count; i++)
        if (nodes->path[i] == TD_PATH_UNMADE) nodes->listed[nodes->listed_count++] = i;
}

/* Chooses the Gaussians that stand for all others; they become the wanted ones. An instant needs none. */
static void choose_some(td_point_nodes *nodes) {
    nodes->wanted_count = nodes->listed_count <= nodes->group_size ? nodes->listed_count : nodes->sample_size;
    if (td_point_is_instant(nodes)) nodes->wanted_count = 0;
    for (int i = 0; i < nodes->wanted_count; i++)
        nodes->wanted[i] = nodes->listed[(int64_t)i * nodes->listed_count / nodes->wanted_count];
}

/* The first `count` of those wanted, with rows of their first levels. */
static tides_status begin_group(const tides_renderer *renderer, td_point_nodes *nodes, int count, tides_error *error) {
    td_path_group *group = &nodes->group;
    int64_t rows = 0;
    nodes->bent = nodes->moving = group->count = 0;
    for (int i = 0; i < count; i++) {
        const int gaussian = nodes->wanted[i];
        int level = td_point_is_instant(nodes) ? 0 : first_level(renderer, nodes, gaussian);
        nodes->bent += level > MOST_LEVEL;
        if (level > MOST_LEVEL) level = MOST_LEVEL;
        group->first[group->count] = (int)rows;
        group->level[group->count] = (uint8_t)level;
        group->kept[group->count] = group->open_at[group->count] = -1;
        group->is_direct[group->count] = 0;
        group->gaussians[group->count++] = gaussian;
        rows += td_point_is_instant(nodes) ? 1 : ((int64_t)nodes->pieces << level) + 1;
        if (rows > INT32_MAX / TD_PATH_STRIDE) return too_many(nodes, error);
    }
    group->rows = (int)rows;
    return TIDES_OK;
}

/* Gives Gaussian i rows of the next level. */
static tides_status refine(td_point_nodes *nodes, int i, tides_error *error) {
    td_path_group *group = &nodes->group;
    const int level = ++group->level[i];
    const int64_t rows = (int64_t)group->rows + ((int64_t)nodes->pieces << level) + 1;
    if (rows > INT32_MAX / TD_PATH_STRIDE) return too_many(nodes, error);
    group->first[i] = group->rows;
    group->rows = (int)rows;
    return TIDES_OK;
}

/* The object whose motion model moves Gaussian i, or NULL. */
static const td_dynamic_object *moved_by(const tides_renderer *renderer, const td_point_nodes *nodes, int i) {
    return td_dynamic_object_of(&renderer->dynamic, nodes->group.gaussians[i]);
}

/* The allowed error of Gaussian i's paths. Rows from a motion model have the backend's precision, so they may have a larger
 * one. */
static double target_of(const tides_renderer *renderer, const td_point_nodes *nodes, int i) {
    return moved_by(renderer, nodes, i) && !td_renderer_is_double(renderer) ? TD_POINT_PATH_MOVED : TD_POINT_PATH_TARGET;
}

/* A smooth path's error falls by this factor per level. */
static const double falls = 16;

/* 1 if Gaussian i may be projected at each point's own time instead of having curves. An expensive motion may not: a row
 * costs a hundred times as much as a cubic, and a network has kinks anywhere. */
static int may_be_direct(const tides_renderer *renderer, const td_point_nodes *nodes, int i) {
    const td_dynamic_object *object = moved_by(renderer, nodes, i);
    return !object || !object->expensive;
}

/* 1 where Gaussian i may have a joint within the only piece. With one place in keyframes at both ends and in the middle it
 * swings between, and on the screen misses the cubic by the square of that: no node of three shows it (check_lost, stops
 * 1103). */
static int has_joint(const tides_renderer *renderer, const td_point_nodes *nodes, int i) {
    return nodes->joints > 0 && nodes->pieces == 1 && moved_by(renderer, nodes, i) && may_be_direct(renderer, nodes, i);
}

/* Chooses the level of Gaussian i from the error in the middle of the previous level's cubics (number k of the fit). The
 * level is enough if a sixteenth of the worst error is small enough; at the last level, the path may have a kink. If the
 * error can't be computed, the Gaussian crosses the near plane; then it has faded where its curves are invalid, if they are
 * short. */
static tides_status choose_level(const tides_renderer *renderer, td_point_nodes *nodes, int i, int k, tides_error *error) {
    td_path_group *group = &nodes->group;
    const double target = target_of(renderer, nodes, i), worst = (double)group->fit.worst[k] * TD_POINT_PATH_TARGET;
    const int first = first_level(renderer, nodes, group->gaussians[i]);
    nodes->moving += worst > 0 && group->level[i] == (first < MOST_LEVEL ? first : MOST_LEVEL);
    const int is_bent = worst > falls * target, kept = group->kept[i];
    group->kept[i] = group->level[i] == 1 && !is_bent && has_joint(renderer, nodes, i) ? group->first[i] : -1;
    if (group->kept[i] >= 0 || (is_bent && group->level[i] < MOST_LEVEL)) return refine(nodes, i, error);
    if (kept >= 0 && worst <= target) { /* its curves of level 1 fit at level 2, too */
        group->first[i] = kept;
        group->level[i] = 1;
        return TIDES_OK;
    }
    if (group->level[i] == 1 && worst <= target) group->level[i] = 0; /* its rows are every other row of level 1 */
    const int is_direct = is_bent && may_be_direct(renderer, nodes, i);
    nodes->bent += is_bent;
    group->is_direct[i] = (uint8_t)is_direct;
    return TIDES_OK;
}

/* Selects the curves whose halves need computed rows. A row of an expensive model costs a hundred times as much as a cubic,
 * and a kink is in one place. So at the next level, rows come from the cubics that are good enough, and only the middles of
 * halves of other curves are computed. Gaussian i is number k of the `tried`, with `curves` curves each; its rows begin at
 * `from`. */
static tides_status open_curves(td_point_nodes *nodes, int i, int k, int from, int tried, int curves, tides_error *error) {
    td_path_group *group = &nodes->group;
    const float *each = group->fit.each + k;
    const size_t flags = (size_t)group->open_count + (size_t)curves;
    tides_status status = td_reserve((void **)&group->open, &group->open_capacity, flags, sizeof *group->open, error);
    if (status != TIDES_OK) return status;
    group->open_at[i] = group->open_count;
    for (int curve = 0; curve < curves; curve++)
        group->open[group->open_count++] = each[(size_t)curve * (size_t)tried] > TD_PATH_BENT;
    group->halve_from[group->halves] = from;
    group->halve_to[group->halves++] = group->first[i];
    return status;
}

/* Makes rows of the next level by halving, for Gaussians with some open curves. */
static tides_status halve_open(td_point_nodes *nodes, int level, tides_error *error) {
    const td_path_group *group = &nodes->group;
    if (group->halves == 0) return TIDES_OK;
    const td_halve_request request = {group->halve_from, group->halve_to,     group->halves,  level,
                                      nodes->pieces,     nodes->piece_length, group->rows + 1};
    return td_exact_halve(nodes->exact, &request, error);
}

/* Measures the errors of a level's paths, for `count` Gaussians, whose first rows are in nodes->tried. `each`: of every
 * curve, too. */
static tides_status measure(td_point_nodes *nodes, td_points_engine *engine, int level, int count, int each,
                            tides_error *error) {
    td_path_group *group = &nodes->group;
    const td_points_misfits request = {nodes->exact,        group->rows,   group->tried,         count,       level,
                                       nodes->piece_length, nodes->pieces, TD_POINT_PATH_TARGET, nodes->place};
    td_points_fit fit = group->fit;
    tides_status status = TIDES_OK;
    if (count == 0) return status;
    if (each)
        status = td_reserve((void **)&group->fit.each, &group->each_capacity, td_points_tried(&request) * (size_t)count,
                            sizeof *group->fit.each, error);
    fit.each = each ? group->fit.each : NULL;
    return status == TIDES_OK ? engine->type->misfits(engine, &request, &fit, error) : status;
}

/* Compares a level's paths with the previous level's, and gives the next level to Gaussians that need it. */
static tides_status try_level(const tides_renderer *renderer, td_point_nodes *nodes, td_points_engine *engine, int level,
                              tides_error *error) {
    td_path_group *group = &nodes->group;
    const int each = td_dynamic_has_expensive(&renderer->dynamic) && level < MOST_LEVEL;
    int count = 0;
    for (int i = 0; i < group->count; i++)
        if (group->level[i] == level) group->tried[count++] = group->first[i];
    for (int i = count; i < count + TD_PAD; i++) group->tried[i] = count ? group->tried[0] : 0;
    tides_status status = measure(nodes, engine, level, count, each, error);
    group->open_count = group->halves = 0;
    for (int i = 0, k = 0; i < group->count && status == TIDES_OK; i++) {
        if (group->level[i] != level) continue;
        const int from = group->first[i];
        status = choose_level(renderer, nodes, i, k, error);
        const td_dynamic_object *object = moved_by(renderer, nodes, i);
        if (status == TIDES_OK && each && group->level[i] > level && object && object->expensive)
            status = open_curves(nodes, i, k, from, count, nodes->pieces << (level - 1), error);
        k++;
    }
    return status == TIDES_OK ? halve_open(nodes, level, error) : status;
}

/* Curves of the group; paths. */
static tides_status lay_curves(td_point_nodes *nodes, tides_error *error) {
    td_path_group *group = &nodes->group;
    const int moves = !td_point_is_instant(nodes);
    size_t curves = 0;
    for (int i = 0; i < group->count; i++) curves += (size_t)nodes->pieces << group->level[i];
    if (curves + (size_t)nodes->curves > MOST_CURVES) return too_many(nodes, error);
    tides_status status = td_reserve((void **)&group->row, &group->row_capacity, 2 * curves, sizeof *group->row, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&group->length, &group->length_capacity, curves, sizeof *group->length, error);
    if (status != TIDES_OK) return status;
    int laid = 0;
    for (int i = 0; i < group->count; i++) {
        const int level = group->level[i], stride = !moves ? 0 : level == 0 ? 2 : 1; /* level 0 has the rows of level 1 */
        group->own[i] = nodes->path[group->gaussians[i]] = (nodes->curves + laid) * TD_PATH_LEVELS + level;
        for (int k = 0; k < nodes->pieces << level; k++) {
            const double h = nodes->piece_length[k >> level];
            group->row[2 * laid] = group->first[i] + stride * k;
            group->row[2 * laid + 1] = group->first[i] + stride * (k + 1);
            group->length[laid++] = (moves ? h : TD_POINT_INSTANT) / (double)(1 << level);
        }
    }
    group->curves = laid;
    nodes->curves += laid;
    nodes->made += group->count;
    return TIDES_OK;
}

static tides_status measure_pieces(td_point_nodes *nodes, tides_error *error) {
    tides_status status = td_reserve((void **)&nodes->piece_length, &nodes->piece_capacity, (size_t)nodes->pieces,
                                     sizeof *nodes->piece_length, error);
    for (int k = 0; k < nodes->pieces && status == TIDES_OK; k++) nodes->piece_length[k] = nodes->knot[k + 1] - nodes->knot[k];
    return status;
}

/* 1 if more than a few Gaussians have too large an error. */
static int are_bent(const td_point_nodes *nodes) { return FEW_BENT * (int64_t)nodes->bent > nodes->moving; }

/* Rows of the first `count` of those wanted, in the pieces that there are. `bent`: whether others may be had; whether they are
 * needed, because WHOLE_LEVEL isn't enough for more than half of these, or all levels aren't for more than few of those that
 * move. */
static tides_status find_rows(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine, int count,
                              td_point_nodes *nodes, int *bent, tides_error *error) {
    const int may_bend = *bent;
    *bent = 0;
    tides_status status = begin_group(renderer, nodes, count, error);
    if (status == TIDES_OK && td_point_is_instant(nodes)) return td_point_rows_project(renderer, camera, nodes, 0, error);
    for (int level = 1, finer = 1; level <= MOST_LEVEL && finer > 0 && status == TIDES_OK && !*bent; level++) {
        finer = 0;
        status = td_point_rows_project(renderer, camera, nodes, level, error);
        if (status == TIDES_OK) status = try_level(renderer, nodes, engine, level, error);
        for (int i = 0; i < nodes->group.count; i++) finer += nodes->group.level[i] > level;
        *bent = may_bend && level == WHOLE_LEVEL && 2 * finer > nodes->group.count;
    }
    *bent = *bent || (may_bend && are_bent(nodes));
    return status;
}

/* Makes rows, as find_rows does, for the Gaussians that stand for all others. */
static tides_status find_some(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                              td_point_nodes *nodes, int *bent, tides_error *error) {
    const tides_status status = measure_pieces(nodes, error);
    if (status != TIDES_OK) return status;
    choose_some(nodes);
    return find_rows(renderer, camera, engine, nodes->wanted_count, nodes, bent, error);
}

/* Rows in the pieces that there are; or, where they would be too many, none. */
static tides_status find_cut(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                             const td_point_span *span, td_point_nodes *nodes, tides_error *error) {
    int bent = 0;
    tides_status status = cut(renderer, camera, span->start, span->stop, nodes, error);
    const double middle = nodes->knot[nodes->pieces / 2];
    if (status == TIDES_OK && (2 * (int64_t)nodes->pieces + 1) * nodes->listed_count > MOST_ROWS) nodes->halve = middle;
    if (status != TIDES_OK || !isnan(nodes->halve)) return status;
    return find_some(renderer, camera, engine, nodes, &bent, error);
}

/* 1 if halving the interval, and its halves, brings the cubics nearer to the paths. */
static int is_tame(const tides_renderer *renderer) {
    for (int i = 0; i < renderer->store.objects; i++) {
        const double *px = renderer->sweep.strays.px + (size_t)i * TD_STRAY_LEVELS;
        for (int k = 1; k < WHOLE_LEVEL; k++)
            if (px[k] > strays_px && px[k] > strays_share * px[k - 1]) return 0;
    }
    return 1;
}

/* Most paths are smooth enough for an interval of one piece, even with samples within it; then points share curves. Other
 * intervals are cut at the samples: a camera turns a corner or shakes, a lamp flickers. If that isn't enough, as for a
 * formula that shakes at some kHz, the interval is halved. */
tides_status td_point_nodes_find(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 const td_point_span *span, td_point_nodes *nodes, tides_error *error) {
    tides_status status = cut(renderer, camera, span->start, span->stop, nodes, error);
    int bent = nodes->pieces > 1;
    const int whole = !bent || !(span->start < span->stop) || is_tame(renderer);
    nodes->halve = NAN;
    if (status == TIDES_OK)
        status = td_renderer_place_rounding(renderer, camera, span->start, span->stop, &nodes->place, error);
    find_listed(renderer, span, nodes);
    if (status == TIDES_OK && whole) status = begin_whole(nodes, span->start, span->stop, error);
    if (status == TIDES_OK && whole) status = find_some(renderer, camera, engine, nodes, &bent, error);
    if (status == TIDES_OK && bent) status = find_cut(renderer, camera, engine, span, nodes, error);
    if (status != TIDES_OK || !isnan(nodes->halve)) return status;
    if (are_bent(nodes) && (span->stop - span->start) / nodes->pieces >= 2 * span->shortest)
        nodes->halve = nodes->pieces > 1 ? nodes->knot[nodes->pieces / 2] : 0.5 * (span->start + span->stop);
    nodes->wanted_count = 0;
    return isnan(nodes->halve) ? lay_curves(nodes, error) : status;
}

tides_status td_point_nodes_next(tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 td_point_nodes *nodes, tides_error *error) {
    int bent = 0;
    const int taken = nodes->wanted_count < nodes->group_size ? nodes->wanted_count : nodes->group_size;
    tides_status status = find_rows(renderer, camera, engine, taken, nodes, &bent, error);
    if (status == TIDES_OK) status = lay_curves(nodes, error);
    if (status != TIDES_OK) return status;
    nodes->wanted_count -= taken;
    memmove(nodes->wanted, nodes->wanted + taken, (size_t)nodes->wanted_count * sizeof *nodes->wanted);
    return status;
}

td_points_group td_point_nodes_group(const td_point_nodes *nodes) {
    const td_path_group *group = &nodes->group;
    return (td_points_group){.exact = nodes->exact,
                             .row_count = group->rows,
                             .row = group->row,
                             .lengths = group->length,
                             .first = nodes->curves - group->curves,
                             .curves = group->curves,
                             .seen = group->gaussians,
                             .path = group->own,
                             .seen_count = group->count};
}

int td_point_nodes_expected(const td_point_nodes *nodes) {
    const double each = nodes->made > 0 ? (double)nodes->curves / nodes->made : 1, all = ceil(each * nodes->listed_count);
    return all < (double)MOST_CURVES ? (int)all : (int)MOST_CURVES;
}

/* Tests take a splat to go straight on in a slice, and cost as much again with each: how splats bend curves tell. On 10 ms of
 * the demo, 5 curves a splat, a point costs 2.9, 1.8, 1.5 us with 1, 2, 4 slices; on 3 ms it costs 1.2 with any. With 4 a
 * trained object's lists, 1300 long, cost more than their points. */
td_points_slices td_point_nodes_slices(const td_point_nodes *nodes) {
    int split = 0;
    if (nodes->pieces > 1) {
        const int group = (nodes->pieces + MOST_SLICES - 1) / MOST_SLICES;
        return (td_points_slices){nodes->pieces, (nodes->pieces + group - 1) / group, 0, group};
    }
    while (split < MOST_SPLIT && 2 * (int64_t)nodes->curves > 3 * ((int64_t)nodes->group.count << split)) split++;
    return (td_points_slices){1, 1 << split, split, 1};
}
