/* Finds which splats single pixels may see (td_points_near.h): goes through the lists of their tiles. */
#include "td_points_near.h"
#include "td_renderer.h"
#include "td_wide.h"

#include <stdlib.h>

void td_points_near_release(td_points_near *near) {
    for (size_t k = 0; k < near->portions; k++) {
        td_near_portion *portion = &near->portion[k];
        free(portion->gaussian);
        free(portion->touches);
        free(portion->found);
        for (int i = 0; i < 4; i++) free(portion->side[i]);
    }
    free(near->portion);
    free(near->count);
    free((void *)near->seen);
}

/* Facts that the pool's threads share. */
typedef struct finding {
    const tides_renderer *renderer;
    const td_points_near *near;
    const td_point_span *span;
    const td_points_some *some;
    int portions;
} finding;

/* Takes a tile's list, with its boxes side by side, unless it is there: points of one tile mostly follow one another. In the
 * store's order each look at a box was a cache miss: half of the time of points among 500 000 splats. */
static tides_status take_tile(td_near_portion *of, const td_point_span *span, int tile) {
    const int first = span->first[tile], end = span->first[tile + 1];
    const size_t most = (size_t)(end - first);
    int count = 0;
    if (of->tile == tile) return TIDES_OK;
    of->tile = -1;
    tides_status status = td_renew((void **)&of->gaussian, &of->capacity[0], most, sizeof *of->gaussian, &of->error);
    if (status == TIDES_OK) status = td_renew((void **)&of->touches, &of->capacity[1], most, sizeof *of->touches, &of->error);
    for (int k = 0; k < 4 && status == TIDES_OK; k++)
        status = td_renew((void **)&of->side[k], &of->capacity[2 + k], most, sizeof **of->side, &of->error);
    for (int i = first; i < end && status == TIDES_OK; i++) {
        if (span->list[i] < 0) continue;
        const float *box = span->boxes + 4 * (size_t)span->list[i];
        of->gaussian[count] = span->list[i];
        for (int k = 0; k < 4; k++) of->side[k][count] = box[k];
        count++;
    }
    if (status != TIDES_OK) return status;
    of->tile = tile;
    of->count = count;
    return status;
}

/* Half the width of what boxes must touch [px]: a pixel's centre, and what rounding may make of boxes. With whole pixels a
 * point has half as many splats again. */
static const float about = 0.0625f;

/* Finds the boxes that touch a pixel's centre. */
TD_WIDE static void find_touching(int count, const float *x0, const float *y0, const float *x1, const float *y1, float x,
                                  float y, uint8_t *restrict touches) {
    const float left = x + (0.5f - about), right = x + (0.5f + about), top = y + (0.5f - about), bottom = y + (0.5f + about);
    for (int i = 0; i < count; i++)
        touches[i] = (uint8_t)((x0[i] <= right) & (x1[i] >= left) & (y0[i] <= bottom) & (y1[i] >= top));
}

/* Adds what a point may see; `count` gets how much. */
static tides_status look_from(td_near_portion *of, const finding *all, const td_point *point, int *count) {
    const int tile = point->y / TD_TILE * all->renderer->candidates.tiles_x + point->x / TD_TILE;
    tides_status status = take_tile(of, all->span, tile);
    if (status == TIDES_OK)
        status = td_reserve((void **)&of->found, &of->found_capacity, of->found_count + (size_t)of->count + 1,
                            sizeof *of->found, &of->error);
    if (status != TIDES_OK) return status;
    find_touching(of->count, of->side[0], of->side[1], of->side[2], of->side[3], (float)point->x, (float)point->y, of->touches);
    int *to = of->found + of->found_count, found = 0;
    for (int i = 0; i < of->count; i++) { /* without a branch: what doesn't touch is overwritten by the next */
        to[found] = of->gaussian[i];
        found += of->touches[i];
    }
    of->found_count += (size_t)found;
    *count = found;
    return status;
}

static void find_some(void *user, int k) {
    const finding *all = user;
    const td_points_some *some = all->some;
    td_near_portion *of = &all->near->portion[k];
    const int end = td_pool_begin(some->count, all->portions, k + 1);
    of->tile = -1; /* lists may be of another interval */
    of->found_count = 0;
    of->status = TIDES_OK;
    for (int i = td_pool_begin(some->count, all->portions, k); i < end && of->status == TIDES_OK; i++)
        of->status = look_from(of, all, &some->points[some->which[i]], &all->near->count[i]);
}

/* Sets where each point's splats are, which move as their arrays grow. */
static tides_status lay_seen(td_points_near *near, const finding *all, tides_error *error) {
    for (int k = 0; k < all->portions; k++) {
        const td_near_portion *of = &near->portion[k];
        const int end = td_pool_begin(all->some->count, all->portions, k + 1);
        const int *at = of->found;
        if (of->status != TIDES_OK && error) *error = of->error;
        if (of->status != TIDES_OK) return of->status;
        for (int i = td_pool_begin(all->some->count, all->portions, k); i < end; at += near->count[i++]) near->seen[i] = at;
    }
    return TIDES_OK;
}

/* Fewest points that are worth a thread of their own. */
enum { FEWEST_POINTS = 8 };

tides_status td_points_near_find(const tides_renderer *renderer, td_points_near *near, const td_point_span *span,
                                 const td_points_some *some, tides_error *error) {
    finding all = {renderer, near, span, some, td_pool_portions(renderer->pool, some->count, FEWEST_POINTS)};
    const size_t before = near->portions, wanted = (size_t)some->count;
    tides_status status = td_reserve((void **)&near->count, &near->count_capacity, wanted, sizeof *near->count, error);
    if (status == TIDES_OK) status = td_reserve((void **)&near->seen, &near->seen_capacity, wanted, sizeof *near->seen, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&near->portion, &near->portions, (size_t)all.portions, sizeof *near->portion, error);
    if (near->portions > before) memset(near->portion + before, 0, (near->portions - before) * sizeof *near->portion);
    if (status != TIDES_OK) return status;
    td_pool_run(renderer->pool, all.portions, find_some, &all);
    return lay_seen(near, &all, error);
}
