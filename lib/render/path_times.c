/* Times of record paths: the pieces that an interval falls into, the nodes of a piece, and for any time within the node before
 * it and the weights from there. For paths.c and whatever evaluates paths (tiles.c). */
#include "camera/td_trajectory.h"
#include "td_renderer.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

/* An interval with more samples of paths in it than this has no record paths: with as many nodes nothing is gained. */
enum { MOST_PIECES = 64 };

/* Knots nearer than this to another are it [s]. */
static const double same_time = 1e-9;

static tides_status add_knot(td_record_paths *paths, double time, tides_error *error) {
    tides_status status =
        td_reserve((void **)&paths->knot, &paths->knot_capacity, (size_t)paths->pieces + 1, sizeof *paths->knot, error);
    if (status == TIDES_OK) paths->knot[paths->pieces++] = time;
    return status;
}

/* The samples of a path within the interval, where its curve may bend; no more than are too many. */
static tides_status add_samples(td_record_paths *paths, const tides_trajectory *path, double epoch, double start, double stop,
                                tides_error *error) {
    tides_status status = TIDES_OK;
    tides_pose_sample sample;
    if (!path || tides_trajectory_is_static(path)) return status;
    for (size_t i = td_trajectory_find(path, epoch, start);
         i < tides_trajectory_count(path) && paths->pieces <= 4 * MOST_PIECES && status == TIDES_OK; i++) {
        status = tides_trajectory_sample(path, i, &sample, error);
        double time = sample.time - epoch;
        if (status != TIDES_OK || time >= stop - same_time) break;
        if (time > start + same_time) status = add_knot(paths, time, error);
    }
    return status;
}

/* Each knot once, in order: `pieces` becomes the number of pieces between them. */
static void order_knots(td_record_paths *paths) {
    int kept = 0;
    qsort(paths->knot, (size_t)paths->pieces, sizeof *paths->knot, td_ascending);
    for (int i = 0; i < paths->pieces; i++)
        if (kept == 0 || paths->knot[i] > paths->knot[kept - 1] + same_time) paths->knot[kept++] = paths->knot[i];
    paths->pieces = kept - 1;
}

tides_status td_paths_cut(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop, int *cut,
                          tides_error *error) {
    td_record_paths *paths = &renderer->paths;
    paths->pieces = 0;
    *cut = 0;
    tides_status status = add_knot(paths, start, error);
    if (status == TIDES_OK) status = add_knot(paths, stop, error);
    if (status == TIDES_OK) status = add_samples(paths, camera, renderer->epoch, start, stop, error);
    for (int i = 0; i < renderer->store.objects && status == TIDES_OK; i++) {
        tides_object facts;
        status = tides_scene_object(renderer->scene, renderer->store.scene_object[i], &facts, error);
        if (status == TIDES_OK) status = add_samples(paths, facts.trajectory, renderer->epoch, start, stop, error);
    }
    if (status != TIDES_OK) return status;
    order_knots(paths);
    if (paths->pieces < 1 || paths->pieces > MOST_PIECES) return TIDES_OK;
    status = td_reserve((void **)&paths->length, &paths->length_capacity, (size_t)paths->pieces, sizeof *paths->length, error);
    for (int i = 0; i < paths->pieces && status == TIDES_OK; i++) paths->length[i] = paths->knot[i + 1] - paths->knot[i];
    *cut = status == TIDES_OK;
    return status;
}

double td_paths_node(const td_record_paths *paths, int piece, int level, int k) {
    if (piece >= paths->pieces) return paths->knot[paths->pieces];
    const double from = paths->knot[piece], to = paths->knot[piece + 1];
    return k >> level ? to : from + (k / (double)(1 << level)) * (to - from);
}

/* The piece that a time is in. */
static int piece_of(const td_record_paths *paths, double time) {
    int low = 0, high = paths->pieces - 1;
    while (low < high) {
        int middle = (low + high + 1) / 2;
        if (paths->knot[middle] <= time)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static void set_moment(td_record_paths *paths, double time, int piece, int level, int at) {
    const int parts = 1 << level;
    int k = (int)floor((time - paths->knot[piece]) / paths->length[piece] * parts);
    k = k < 0 ? 0 : k >= parts ? parts - 1 : k;
    while (k > 0 && td_paths_node(paths, piece, level, k) > time) k--;
    while (k + 1 < parts && td_paths_node(paths, piece, level, k + 1) <= time) k++;
    paths->nodes[at] = piece * parts + k;
    td_cubic_weights(td_paths_node(paths, piece, level, k), td_paths_node(paths, piece, level, k + 1), time,
                     paths->cubics + (size_t)at * TD_PATH_CUBIC);
}

tides_status td_paths_moments(td_record_paths *paths, const double *times, int slots, tides_error *error) {
    size_t entries = (size_t)slots * TD_PATH_LEVELS;
    tides_status status =
        td_reserve((void **)&paths->cubics, &paths->cubic_capacity, entries * TD_PATH_CUBIC, sizeof *paths->cubics, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&paths->nodes, &paths->node_capacity, entries, sizeof *paths->nodes, error);
    if (status != TIDES_OK) return status;
    memset(paths->cubics, 0, entries * TD_PATH_CUBIC * sizeof *paths->cubics);
    for (int slot = 0; slot < slots; slot++) {
        const int piece = piece_of(paths, times[slot]);
        for (int level = 0; level < TD_PATH_LEVELS; level++)
            set_moment(paths, times[slot], piece, level, slot * TD_PATH_LEVELS + level);
    }
    return TIDES_OK;
}
