/* Times of record paths: nodes, and for any time within the interval the node before it and the weights from there. For paths.c
 * and whatever evaluates paths (tiles.c). */
#include "td_renderer.h"

#include <math.h>

double td_paths_node(const td_record_paths *paths, int level, int k) {
    return k >> level ? paths->stop : paths->start + (k / (double)(1 << level)) * (paths->stop - paths->start);
}

static void set_moment(td_record_paths *paths, double time, int level, int at) {
    const int parts = 1 << level;
    int k = (int)floor((time - paths->start) / (paths->stop - paths->start) * parts);
    k = k < 0 ? 0 : k >= parts ? parts - 1 : k;
    while (k > 0 && td_paths_node(paths, level, k) > time) k--;
    while (k + 1 < parts && td_paths_node(paths, level, k + 1) <= time) k++;
    paths->nodes[at] = k;
    td_cubic_weights(td_paths_node(paths, level, k), td_paths_node(paths, level, k + 1), time,
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
    for (int slot = 0; slot < slots; slot++)
        for (int level = 0; level < TD_PATH_LEVELS; level++)
            set_moment(paths, times[slot], level, slot * TD_PATH_LEVELS + level);
    return TIDES_OK;
}
