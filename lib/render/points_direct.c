/* Points that see a splat without a curve: all their splats are projected at the point's own time. A batch ("lot") of points
 * is given to an engine as if it were an interval. Each point is a tile with its own list, each of its splats a Gaussian with
 * one row, and its curve is that of an instant: value and rate. */
#include "td_points_direct.h"
#include "td_points_wanted.h"
#include "td_renderer.h"
#include "td_wide.h"

#include <math.h>
#include <stdlib.h>

/* Points, and splats, of one lot. On a CPU a lot of 16384 splats takes the time of four times as many, and 22 MB less; a GPU
 * needs many splats to be busy. */
enum { LOT = 256, LOT_SPLATS_CPU = 1 << 14, LOT_SPLATS_GPU = 1 << 16 };

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
    free(direct->near.gaussian);
    free(direct->near.touches);
    for (int k = 0; k < 4; k++) free(direct->near.side[k]);
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

/* Makes room for `more` Gaussians in a lot. */
static tides_status reserve(td_points_direct *direct, int more, tides_error *error) {
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
    return status;
}

/* Takes a tile's list, with its boxes side by side, unless it is there: points of one tile mostly follow one another. In the
 * store's order each look at a box was a cache miss: half of the time of points among 500 000 splats. */
static tides_status take_tile(td_points_direct *direct, const td_point_span *span, int tile, tides_error *error) {
    const int first = span->first[tile], end = span->first[tile + 1];
    const size_t most = (size_t)(end - first);
    size_t *capacity = direct->near.capacity;
    int count = 0;
    if (direct->near.tile == tile) return TIDES_OK;
    direct->near.tile = -1;
    tides_status status = td_renew((void **)&direct->near.gaussian, &capacity[0], most, sizeof *direct->near.gaussian, error);
    if (status == TIDES_OK)
        status = td_renew((void **)&direct->near.touches, &capacity[1], most, sizeof *direct->near.touches, error);
    for (int k = 0; k < 4 && status == TIDES_OK; k++)
        status = td_renew((void **)&direct->near.side[k], &capacity[2 + k], most, sizeof **direct->near.side, error);
    for (int i = first; i < end && status == TIDES_OK; i++) {
        if (span->list[i] < 0) continue;
        const float *box = span->boxes + 4 * (size_t)span->list[i];
        direct->near.gaussian[count] = span->list[i];
        for (int k = 0; k < 4; k++) direct->near.side[k][count] = box[k];
        count++;
    }
    if (status != TIDES_OK) return status;
    direct->near.tile = tile;
    direct->near.count = count;
    return status;
}

/* Finds the boxes that touch a pixel. */
TD_WIDE static void find_touching(int count, const float *x0, const float *y0, const float *x1, const float *y1, float x,
                                  float y, uint8_t *restrict touches) {
    for (int i = 0; i < count; i++) touches[i] = (uint8_t)((x0[i] <= x + 1) & (x1[i] >= x) & (y0[i] <= y + 1) & (y1[i] >= y));
}

/* Adds all that point k may see, as the lot's next Gaussians, and its tile's list. */
static tides_status add_point(const tides_renderer *renderer, td_points_direct *direct, const td_point_span *span,
                              const td_point *point, int k, int *listed, tides_error *error) {
    td_point_nodes *nodes = &direct->nodes;
    td_path_group *group = &nodes->group;
    const int tile = point->y / TD_TILE * renderer->candidates.tiles_x + point->x / TD_TILE;
    const int begun = *listed;
    tides_status status = take_tile(direct, span, tile, error);
    if (status == TIDES_OK) status = reserve(direct, direct->near.count, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&direct->lists, &direct->list_capacity, (size_t)(*listed + direct->near.count) + TD_PAD,
                            sizeof *direct->lists, error);
    if (status != TIDES_OK) return status;
    float *const *side = direct->near.side;
    find_touching(direct->near.count, side[0], side[1], side[2], side[3], (float)point->x, (float)point->y,
                  direct->near.touches);
    for (int i = 0; i < direct->near.count; i++) {
        const int own = group->count;
        if (!direct->near.touches[i]) continue;
        group->gaussians[own] = direct->near.gaussian[i];
        group->first[own] = group->row[2 * own] = group->row[2 * own + 1] = direct->numbers[own] = own;
        group->level[own] = 0;
        group->open_at[own] = -1;
        group->own[own] = own * TD_PATH_LEVELS;
        direct->sights[2 * own] = TD_SIGHT_END * renderer->image.width; /* all: its list is this pixel's alone */
        direct->sights[2 * own + 1] = TD_SIGHT_END * renderer->image.height;
        group->length[own] = TD_POINT_INSTANT;
        direct->lists[(*listed)++] = own;
        group->count++;
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

/* Gives a lot, whose rows are ready, to the engine as an interval. */
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
    if (status == TIDES_OK) status = engine->type->values(engine, &batch, direct->values, error);
    return status == TIDES_OK ? engine->type->finish(engine, error) : status;
}

/* Projects all that a lot's points see, and computes their values. */
static tides_status work_out(tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct, int points,
                             int listed, tides_error *error) {
    td_point_nodes *nodes = &direct->nodes;
    nodes->group.rows = nodes->group.count;
    tides_status status = reserve(direct, points, error);
    for (int k = nodes->group.count; k < points && status == TIDES_OK; k++)
        direct->numbers[k] = k; /* also the numbers of tiles */
    if (status == TIDES_OK) status = td_point_rows_direct(renderer, camera, nodes, direct->time, direct->end, points, error);
    return status == TIDES_OK ? look(renderer, direct, points, listed, error) : status;
}

tides_status td_points_direct_values(tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct,
                                     td_exact *exact, const td_point_span *span, const td_points_some *some,
                                     tides_error *error) {
    const int count = some->count, *which = some->which;
    tides_status status = count > 0 ? create(renderer, direct, error) : TIDES_OK;
    direct->nodes.exact = exact;
    direct->near.tile = -1; /* lists may be of another interval */
    const int most = direct->engine && direct->engine->lanes > 1 ? LOT_SPLATS_CPU : LOT_SPLATS_GPU;
    for (int from = 0, taken; from < count && status == TIDES_OK; from += taken) {
        int listed = 0;
        direct->nodes.group.count = 0;
        for (taken = 0; taken < LOT && from + taken < count && direct->nodes.group.count < most && status == TIDES_OK;
             taken++)
            status = add_point(renderer, direct, span, &some->points[which[from + taken]], taken, &listed, error);
        if (status == TIDES_OK) status = td_renderer_check_stop(renderer, (double)from / count, error);
        if (status == TIDES_OK) status = work_out(renderer, camera, direct, taken, listed, error);
        for (int k = 0; k < taken && status == TIDES_OK; k++)
            status =
                td_point_take(&some->points[which[from + k]], direct->values + 2 * k, &some->values[which[from + k]], error);
    }
    return status;
}
