/* Points that see a splat without a curve: all their splats are projected at the point's own time. A batch ("lot") of points
 * is given to an engine as if it were an interval. Each point is a tile with its own list, each of its splats a Gaussian with
 * one row, and its curve is that of an instant: value and rate. */
#include "td_points_direct.h"
#include "td_points_wanted.h"
#include "td_renderer.h"

#include <math.h>
#include <stdlib.h>

/* Points, and splats, of one lot. On a CPU a lot of 32768 splats takes the time of twice as many, and 15 MB less; a GPU
 * needs many splats to be busy. */
enum { LOT = 256, LOT_SPLATS_CPU = 1 << 15, LOT_SPLATS_GPU = 1 << 16 };

/* Frees the engine and arrays of a lot, without which no lot can be computed. */
static void release_lot(td_points_direct *direct) {
    if (direct->engine) direct->engine->type->destroy(direct->engine);
    direct->engine = NULL;
    free(direct->end);
    free(direct->time);
    free(direct->tiles);
    free(direct->chunks);
    free(direct->values);
    free(direct->piece);
    for (int k = 0; k < TD_POINT_COLUMNS; k++) free(direct->column[k]);
}

void td_points_direct_release(td_points_direct *direct) {
    release_lot(direct);
    direct->nodes.is_shared = 1;
    td_point_nodes_release(&direct->nodes);
    free(direct->bent);
    free(direct->lists);
    free(direct->numbers);
    free(direct->sights);
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

static tides_status create(const tides_renderer *renderer, td_points_direct *direct, tides_error *error) {
    const td_image_numbers image = td_image_pack(&renderer->image);
    const size_t lot = LOT + TD_PAD;
    if (direct->engine) return TIDES_OK;
    release_lot(direct); /* left by an earlier failed attempt */
    direct->end = td_alloc(lot, sizeof *direct->end, error);
    direct->time = td_alloc(lot, sizeof *direct->time, error);
    direct->tiles = td_alloc(lot, sizeof *direct->tiles, error);
    direct->chunks = td_alloc(lot, sizeof *direct->chunks, error);
    direct->piece = td_alloc(lot, sizeof *direct->piece, error);
    direct->values = td_alloc(2 * lot, sizeof *direct->values, error);
    int all = direct->end && direct->time && direct->tiles && direct->chunks && direct->piece && direct->values;
    for (int k = 0; k < TD_POINT_COLUMNS; k++) {
        direct->column[k] = td_alloc(lot, sizeof *direct->column[k], error);
        all = all && direct->column[k];
    }
    if (!all) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < lot; i++) direct->column[3][i] = TD_POINT_INSTANT; /* column 2, the place within the curve, is 0 */
    return td_points_create_engine(renderer, &image, &direct->engine, error);
}

/* Fills in what is the same in each lot: Gaussian k has row k, path k and curve k, an instant. */
static void lay(const tides_renderer *renderer, td_points_direct *direct, int end) {
    td_path_group *group = &direct->nodes.group;
    for (int k = direct->laid; k < end; k++) {
        group->first[k] = group->row[2 * k] = group->row[2 * k + 1] = direct->numbers[k] = k;
        group->level[k] = 0;
        group->open_at[k] = -1;
        group->own[k] = k * TD_PATH_LEVELS;
        direct->sights[2 * k] = TD_SIGHT_END * renderer->image.width; /* all: its list is one pixel's alone */
        direct->sights[2 * k + 1] = TD_SIGHT_END * renderer->image.height;
        group->length[k] = TD_POINT_INSTANT;
    }
    if (end > direct->laid) direct->laid = end;
}

/* Makes room for `more` Gaussians in a lot. */
static tides_status reserve(const tides_renderer *renderer, td_points_direct *direct, int more, tides_error *error) {
    td_point_nodes *nodes = &direct->nodes;
    td_path_group *group = &nodes->group;
    const size_t wanted = (size_t)group->count + (size_t)more;
    size_t *capacity = direct->gaussian_capacity;
    tides_status status = td_reserve((void **)&group->gaussians, &capacity[0], wanted, sizeof *group->gaussians, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->first, &capacity[1], wanted, sizeof *group->first, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->level, &capacity[2], wanted, sizeof *group->level, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->open_at, &capacity[3], wanted, sizeof *group->open_at, error);
    if (status == TIDES_OK) status = td_reserve((void **)&group->own, &capacity[4], wanted, sizeof *group->own, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&direct->sights, &capacity[5], 2 * wanted, sizeof *direct->sights, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&group->row, &group->row_capacity, 2 * wanted, sizeof *group->row, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&group->length, &group->length_capacity, wanted, sizeof *group->length, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&direct->numbers, &direct->number_capacity, wanted, sizeof *direct->numbers, error);
    if (status == TIDES_OK) lay(renderer, direct, (int)wanted);
    return status;
}

/* Adds all that point k may see, as the lot's next Gaussians, and its tile's list. */
static tides_status add_point(const tides_renderer *renderer, td_points_direct *direct, const td_point *point, const int *seen,
                              int count, int k, int *listed, tides_error *error) {
    td_path_group *group = &direct->nodes.group;
    const int begun = *listed;
    tides_status status = reserve(renderer, direct, count, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&direct->lists, &direct->list_capacity, (size_t)(begun + count) + TD_PAD,
                            sizeof *direct->lists, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < count; i++) {
        group->gaussians[group->count] = seen[i];
        direct->lists[(*listed)++] = group->count++;
    }
    while (*listed % TD_PAD) direct->lists[(*listed)++] = TD_NO_GAUSSIAN;
    direct->end[k] = group->count;
    direct->time[k] = point->time;
    direct->tiles[k] = (td_points_tile){point->x / TD_TILE * TD_TILE, point->y / TD_TILE * TD_TILE, begun, *listed - begun};
    direct->chunks[k] = (td_points_chunk){k, k, 1};
    direct->column[0][k] = point->x + 0.5;
    direct->column[1][k] = point->y + 0.5;
    return status;
}

/* Gives a lot, whose rows are ready, to the engine as an interval. Its values are under way then: `finish` isn't called. */
static tides_status look(const tides_renderer *renderer, td_points_direct *direct, int points, int listed, tides_error *error) {
    const td_point_nodes *nodes = &direct->nodes;
    const td_path_group *group = &nodes->group;
    const td_points_interval interval = {.gaussians = group->count,
                                         .curves = group->count,
                                         .slices = {1, 1, 0, 1},
                                         .candidates = direct->lists,
                                         .candidate_count = listed,
                                         .tiles = direct->tiles,
                                         .tile_count = points};
    const td_points_group all = {.exact = nodes->exact,
                                 .row_count = group->rows + 1,
                                 .row = group->row,
                                 .lengths = group->length,
                                 .curves = group->count,
                                 .seen = direct->numbers,
                                 .path = group->own,
                                 .sights = direct->sights,
                                 .seen_count = group->count};
    const td_points_batch batch = {{direct->column[0], direct->column[1], direct->column[2], direct->column[3]},
                                   direct->piece,
                                   points,
                                   direct->chunks,
                                   points,
                                   td_points_backdrop_of(&renderer->image, renderer->scratch.backdrops)};
    td_points_engine *engine = direct->engine;
    tides_status status = engine->type->begin(engine, &interval, error);
    if (status == TIDES_OK) status = engine->type->add(engine, &all, error);
    if (status == TIDES_OK) status = engine->type->lists(engine, direct->numbers, points, error);
    return status == TIDES_OK ? engine->type->values(engine, &batch, direct->values, error) : status;
}

/* Waits for the lot that is under way, if there is one, and takes its values. */
static tides_status take_away(td_points_direct *direct, tides_error *error) {
    const td_points_some lot = direct->away;
    tides_status status = TIDES_OK;
    direct->away.count = 0;
    if (lot.count > 0) status = direct->engine->type->finish(direct->engine, error);
    for (int k = 0; k < lot.count && status == TIDES_OK; k++)
        status = td_point_take(&lot.points[lot.which[k]], direct->values + 2 * k, &lot.values[lot.which[k]], error);
    return status;
}

/* Projects all that a lot's points see, and begins to compute their values. Until then the lot before is under way. */
static tides_status work_out(tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct, int points,
                             int listed, tides_error *error) {
    td_point_nodes *nodes = &direct->nodes;
    nodes->group.rows = nodes->group.count;
    tides_status status = reserve(renderer, direct, points, error); /* `numbers` has the tiles' numbers, too */
    if (status == TIDES_OK) status = td_point_rows_direct(renderer, camera, nodes, direct->time, direct->end, points, error);
    if (status == TIDES_OK) status = take_away(direct, error);
    return status == TIDES_OK ? look(renderer, direct, points, listed, error) : status;
}

/* Begins to compute the first of `some`, as many as a lot holds: `taken`. seen[k] and count[k] tell what point k may see. */
static tides_status send_lot(tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct,
                             const td_points_some *some, const int *const *seen, const int *count, int *taken,
                             tides_error *error) {
    const int most = direct->engine->lanes > 1 ? LOT_SPLATS_CPU : LOT_SPLATS_GPU, *which = some->which;
    tides_status status = TIDES_OK;
    int listed = 0, k = 0;
    direct->nodes.group.count = 0;
    for (; k < some->count && direct->nodes.group.count < most && status == TIDES_OK; k++)
        status = add_point(renderer, direct, &some->points[which[k]], seen[k], count[k], k, &listed, error);
    *taken = k;
    if (status == TIDES_OK) status = work_out(renderer, camera, direct, *taken, listed, error);
    if (status == TIDES_OK) direct->away = (td_points_some){some->points, some->values, which, *taken};
    return status;
}

/* Waits for the lot under way after a failure; its values aren't wanted. */
static void drop_away(td_points_direct *direct) {
    if (direct->away.count == 0) return;
    const tides_status ignored = direct->engine->type->finish(direct->engine, NULL);
    (void)ignored;
    direct->away.count = 0;
}

tides_status td_points_direct_values(tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct,
                                     td_exact *exact, const td_point_span *span, const td_points_some *some,
                                     tides_error *error) {
    const td_points_near *near = &direct->near;
    tides_status status = some->count > 0 ? create(renderer, direct, error) : TIDES_OK;
    direct->nodes.exact = exact;
    for (int from = 0; from < some->count && status == TIDES_OK; from += LOT) {
        const int count = some->count - from < LOT ? some->count - from : LOT;
        const td_points_some next = {some->points, some->values, some->which + from, count};
        status = td_points_near_find(renderer, &direct->near, span, &next, error);
        for (int at = 0, taken = 0; at < count && status == TIDES_OK; at += taken) {
            const td_points_some left = {some->points, some->values, next.which + at, count - at};
            status = td_renderer_check_stop(renderer, (double)(from + at) / some->count, error);
            if (status == TIDES_OK)
                status = send_lot(renderer, camera, direct, &left, near->seen + at, near->count + at, &taken, error);
        }
    }
    if (status == TIDES_OK) status = take_away(direct, error);
    drop_away(direct);
    return status;
}
