/* Points that see a splat without a curve: all their splats are projected at the point's own time. A batch ("lot") of points
 * has a row for each splat of each point, of which the engine of points makes values (kernels/point_instants.h). */
#include "td_points_direct.h"
#include "td_points_wanted.h"
#include "td_renderer.h"

#include <math.h>
#include <stdlib.h>

/* Points, and splats, of one lot. On a CPU a lot of 32768 splats takes the time of twice as many, and 15 MB less; a GPU
 * needs many splats to be busy. */
enum { LOT_SPLATS_CPU = 1 << 15, LOT_SPLATS_GPU = 1 << 16 };

void td_points_direct_release(td_points_direct *direct) {
    direct->nodes.is_shared = 1;
    td_point_nodes_release(&direct->nodes);
    free(direct->bent);
    td_points_near_release(&direct->near);
}

/* -- pixels that see a splat without a curve --------------------------------------------------------------------------- */

/* The pixels that may see it. */
static void mark(const tides_renderer *renderer, const float *box, uint8_t *bent) {
    const td_sight sight = td_sight_of(&renderer->image, box);
    for (int y = sight.y0; y < sight.y1; y++)
        for (int x = sight.x0; x < sight.x1; x++) bent[(size_t)y * (size_t)renderer->image.width + (size_t)x] = 1;
}

void td_points_direct_clear(const tides_renderer *renderer, td_points_direct *direct) {
    if (direct->any) memset(direct->bent, 0, (size_t)renderer->image.width * (size_t)renderer->image.height);
    direct->any = 0;
}

tides_status td_points_direct_add(const tides_renderer *renderer, const td_point_nodes *nodes, const float *boxes,
                                  td_points_direct *direct, tides_error *error) {
    for (int i = 0; i < nodes->group.count; i++) {
        if (!nodes->group.is_direct[i]) continue;
        if (!direct->bent) direct->bent = td_alloc((size_t)renderer->image.width * (size_t)renderer->image.height, 1, error);
        if (!direct->bent) return TIDES_NO_MEMORY;
        direct->any = 1;
        mark(renderer, boxes + 4 * (size_t)nodes->group.gaussians[i], direct->bent);
    }
    return TIDES_OK;
}

/* -- a lot ----------------------------------------------------------------------------------------------------------------- */

/* Makes room for `more` Gaussians in a lot. Gaussian k has row k. */
static tides_status reserve(td_points_direct *direct, int more, tides_error *error) {
    td_path_group *group = &direct->nodes.group;
    const size_t wanted = (size_t)group->count + (size_t)more;
    size_t *capacity = direct->capacity;
    tides_status status = td_reserve((void **)&group->gaussians, &capacity[0], wanted, sizeof *group->gaussians, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->first, &capacity[1], wanted, sizeof *group->first, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->level, &capacity[2], wanted, sizeof *group->level, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->open_at, &capacity[3], wanted, sizeof *group->open_at, error);
    for (; status == TIDES_OK && (size_t)direct->laid < wanted; direct->laid++) {
        group->first[direct->laid] = direct->laid;
        group->level[direct->laid] = 0;
        group->open_at[direct->laid] = -1;
    }
    return status;
}

/* Adds all that point k may see, as the lot's next Gaussians. */
static tides_status add_point(td_points_direct *direct, const td_point *point, const int *seen, int count, int k,
                              tides_error *error) {
    td_path_group *group = &direct->nodes.group;
    const tides_status status = reserve(direct, count, error);
    if (status != TIDES_OK) return status;
    memcpy(group->gaussians + group->count, seen, (size_t)count * sizeof *seen);
    group->count += count;
    direct->end[k] = group->count;
    direct->time[k] = point->time;
    direct->x[k] = point->x + 0.5;
    direct->y[k] = point->y + 0.5;
    if (count > direct->most) direct->most = count;
    return status;
}

/* Projects all that a lot's points see, and computes their values. */
static tides_status work_out(const td_direct_user *user, td_points_direct *direct, const td_points_some *lot,
                             tides_error *error) {
    td_point_nodes *nodes = &direct->nodes;
    const tides_renderer *renderer = user->renderer;
    const td_points_instants all = {.exact = nodes->exact,
                                    .x = direct->x,
                                    .y = direct->y,
                                    .end = direct->end,
                                    .count = lot->count,
                                    .most = direct->most,
                                    .backdrop = td_points_backdrop_of(&renderer->image, renderer->scratch.backdrops)};
    nodes->group.rows = nodes->group.count;
    tides_status status =
        td_point_rows_direct(user->renderer, user->camera, nodes, direct->time, direct->end, lot->count, error);
    if (status == TIDES_OK) status = user->engine->type->instants(user->engine, &all, direct->values, error);
    for (int k = 0; k < lot->count && status == TIDES_OK; k++)
        status = td_point_take(&lot->points[lot->which[k]], direct->values + 2 * k, &lot->values[lot->which[k]], error);
    return status;
}

/* Computes the first of `some`, as many as a lot holds: `taken`. seen[k] and count[k] tell what point k may see. */
static tides_status look_at_lot(const td_direct_user *user, td_points_direct *direct, const td_points_some *some,
                                const int *const *seen, const int *count, int *taken, tides_error *error) {
    const int most = user->engine->lanes > 1 ? LOT_SPLATS_CPU : LOT_SPLATS_GPU;
    tides_status status = TIDES_OK;
    int k = 0;
    direct->nodes.group.count = 0;
    direct->most = 1;
    for (; k < some->count && direct->nodes.group.count < most && status == TIDES_OK; k++)
        status = add_point(direct, &some->points[some->which[k]], seen[k], count[k], k, error);
    *taken = k;
    const td_points_some lot = {some->points, some->values, some->which, k};
    return status == TIDES_OK ? work_out(user, direct, &lot, error) : status;
}

tides_status td_points_direct_values(const td_direct_user *user, td_points_direct *direct, td_exact *exact,
                                     const td_point_span *span, const td_points_some *some, tides_error *error) {
    const td_points_near *near = &direct->near;
    tides_status status = TIDES_OK;
    direct->nodes.exact = exact;
    for (int from = 0; from < some->count && status == TIDES_OK; from += TD_DIRECT_LOT) {
        const int count = some->count - from < TD_DIRECT_LOT ? some->count - from : TD_DIRECT_LOT;
        const td_points_some next = {some->points, some->values, some->which + from, count};
        status = td_points_near_find(user->renderer, &direct->near, span, &next, error);
        for (int at = 0, taken = 0; at < count && status == TIDES_OK; at += taken) {
            const td_points_some left = {some->points, some->values, next.which + at, count - at};
            status = td_renderer_check_stop(user->renderer, (double)(from + at) / some->count, error);
            if (status == TIDES_OK) status = look_at_lot(user, direct, &left, near->seen + at, near->count + at, &taken, error);
        }
    }
    return status;
}
