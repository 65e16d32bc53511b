/* Finds the Gaussians that points ask for (td_points_wanted.h): in the lists of their tiles, the ones that touch their pixels.
 * Rows, curves and tests cost what tens of looks at them do, and of the splats in view few may be seen by points: of half a
 * million before 2 500 of them, 12 000. */
#include "td_points_wanted.h"
#include "td_renderer.h"

#include <math.h>
#include <stdlib.h>

/* Margin of boxes on each side, as a share of themselves: the cubics of paths may go so much further than the splat itself.
 * Those of small splats go less than from a pixel's centre to its side. */
static const float margin_share = 0.002f;

typedef char td_wanted_row_has_a_bit_for_each[TD_TILE <= 16 ? 1 : -1];

tides_status td_points_wanted_create(const tides_renderer *renderer, td_points_wanted *wanted, tides_error *error) {
    const size_t tiles = (size_t)renderer->stats.tiles;
    wanted->asked = td_alloc((size_t)renderer->image.width * (size_t)renderer->image.height, 1, error);
    wanted->rows = td_alloc(tiles * TD_TILE, sizeof *wanted->rows, error);
    wanted->fresh = td_alloc(tiles, sizeof *wanted->fresh, error);
    wanted->listed = td_alloc(tiles, sizeof *wanted->listed, error);
    return wanted->asked && wanted->rows && wanted->fresh && wanted->listed ? TIDES_OK : TIDES_NO_MEMORY;
}

void td_points_wanted_release(td_points_wanted *wanted) {
    free(wanted->asked);
    free(wanted->rows);
    free(wanted->fresh);
    free(wanted->listed);
    free(wanted->sights);
    free(wanted->touched);
}

static void forget_fresh(td_points_wanted *wanted) {
    for (int i = 0; i < wanted->fresh_count; i++)
        memset(wanted->rows + (size_t)wanted->fresh[i] * TD_TILE, 0, TD_TILE * sizeof *wanted->rows);
    wanted->fresh_count = 0;
}

void td_points_wanted_clear(const tides_renderer *renderer, td_points_wanted *wanted) {
    const size_t tiles = (size_t)renderer->stats.tiles;
    memset(wanted->asked, 0, (size_t)renderer->image.width * (size_t)renderer->image.height);
    memset(wanted->listed, 0, tiles * sizeof *wanted->listed);
    forget_fresh(wanted);
    wanted->groups = 0;
}

/* The pixels that nobody has asked about, and their tiles. */
static void find_fresh(const tides_renderer *renderer, td_points_wanted *wanted, const td_point *points, const int *which,
                       int count) {
    for (int i = 0; i < count; i++) {
        const td_point *point = &points[which[i]];
        uint8_t *asked = &wanted->asked[(size_t)point->y * (size_t)renderer->image.width + (size_t)point->x];
        if (*asked) continue;
        const int tile = point->y / TD_TILE * renderer->candidates.tiles_x + point->x / TD_TILE;
        uint16_t *rows = wanted->rows + (size_t)tile * TD_TILE;
        int others = 0;
        for (int k = 0; k < TD_TILE; k++) others |= rows[k];
        if (!others) wanted->fresh[wanted->fresh_count++] = tile;
        rows[point->y % TD_TILE] |= (uint16_t)(1u << point->x % TD_TILE);
        *asked = 1;
    }
}

/* The pixels of `size` that a side of a box touches: from, and up to. None where it isn't a number. */
static void touch(float low, float high, int size, int *from, int *end) {
    const float most = (float)size, margin = margin_share * (high - low), begin = low - margin, stop = high + margin;
    *from = begin > 0 ? begin < most ? (int)begin : size : 0;
    *end = stop >= 0 ? stop < most ? (int)stop + 1 : size : 0;
}

td_sight td_sight_of(const td_image *image, const float *box) {
    td_sight sight;
    touch(box[0], box[2], image->width, &sight.x0, &sight.x1);
    touch(box[1], box[3], image->height, &sight.y0, &sight.y1);
    return sight;
}

typedef char td_sight_has_room_for_images[TD_SIGHT_END > 1 << 14 ? 1 : -1];

tides_status td_points_wanted_sights(const tides_renderer *renderer, td_points_wanted *wanted, const td_point_span *span,
                                     td_points_group *group, tides_error *error) {
    const size_t ints = 2 * (size_t)group->seen_count;
    tides_status status = td_reserve((void **)&wanted->sights, &wanted->sight_capacity, ints, sizeof *wanted->sights, error);
    for (int i = 0; i < group->seen_count && status == TIDES_OK; i++) {
        const td_sight sight = td_sight_of(&renderer->image, span->boxes + 4 * (size_t)group->seen[i]);
        wanted->sights[2 * i] = sight.x0 + TD_SIGHT_END * sight.x1;
        wanted->sights[2 * i + 1] = sight.y0 + TD_SIGHT_END * sight.y1;
    }
    group->sights = wanted->sights;
    return status;
}

/* Bits of what [from, end) has of the TD_TILE from `first` on. */
static unsigned bits_of(int from, int end, int first) {
    const int low = from > first ? from - first : 0, high = end - first < TD_TILE ? end - first : TD_TILE;
    return low < high ? ((1u << high) - 1u) & ~((1u << low) - 1u) : 0;
}

/* May any of a tile's pixels see it? */
static int touches(const td_sight *sight, int x, int y, const uint16_t *rows) {
    const unsigned columns = bits_of(sight->x0, sight->x1, x);
    const int top = sight->y0 > y ? sight->y0 - y : 0, bottom = sight->y1 - y < TD_TILE ? sight->y1 - y : TD_TILE;
    int touched = 0;
    for (int k = top; k < bottom; k++) touched |= (rows[k] & columns) != 0;
    return touched;
}

/* Arguments that the pool's threads share. */
typedef struct touching {
    const tides_renderer *renderer;
    const td_points_wanted *wanted;
    const td_point_nodes *nodes;
    const td_point_span *span;
    int portions;
} touching;

/* Finds what a tile's fresh pixels may see and has no path. */
static void touch_tile(const touching *of, int tile) {
    const int across = of->renderer->candidates.tiles_x, x = tile % across * TD_TILE, y = tile / across * TD_TILE;
    const uint16_t *rows = of->wanted->rows + (size_t)tile * TD_TILE;
    for (int i = of->span->first[tile]; i < of->span->first[tile + 1]; i++) {
        const int gaussian = of->span->list[i];
        of->wanted->touched[i] = 0;
        if (gaussian < 0 || of->nodes->path[gaussian] != TD_PATH_UNMADE) continue;
        const td_sight sight = td_sight_of(&of->renderer->image, of->span->boxes + 4 * (size_t)gaussian);
        of->wanted->touched[i] = touches(&sight, x, y, rows) != 0;
    }
}

static void touch_some(void *user, int k) {
    const touching *of = user;
    const int end = td_pool_begin(of->wanted->fresh_count, of->portions, k + 1);
    for (int i = td_pool_begin(of->wanted->fresh_count, of->portions, k); i < end; i++) touch_tile(of, of->wanted->fresh[i]);
}

/* Marks what was found in a tile's list; how much of it no other tile has marked. */
static int mark_tile(const td_points_wanted *wanted, td_point_nodes *nodes, const td_point_span *span, int tile) {
    int marked = 0;
    for (int i = span->first[tile]; i < span->first[tile + 1]; i++) {
        if (!wanted->touched[i] || nodes->path[span->list[i]] != TD_PATH_UNMADE) continue;
        nodes->path[span->list[i]] = TD_PATH_WANTED;
        marked++;
    }
    return marked;
}

/* Fewest tiles that are worth a thread of their own. */
enum { FEWEST_TILES = 4 };

tides_status td_points_wanted_find(const tides_renderer *renderer, td_points_wanted *wanted, td_point_nodes *nodes,
                                   const td_point_span *span, const td_point *points, const int *which, int count,
                                   tides_error *error) {
    int marked = 0;
    nodes->wanted_count = 0;
    tides_status status = td_renew((void **)&wanted->touched, &wanted->touched_capacity,
                                   (size_t)span->first[renderer->stats.tiles], sizeof *wanted->touched, error);
    if (status != TIDES_OK) return status;
    forget_fresh(wanted);
    find_fresh(renderer, wanted, points, which, count);
    touching all = {renderer, wanted, nodes, span, td_pool_portions(renderer->pool, wanted->fresh_count, FEWEST_TILES)};
    td_pool_run(renderer->pool, all.portions, touch_some, &all);
    for (int i = 0; i < wanted->fresh_count; i++) marked += mark_tile(wanted, nodes, span, wanted->fresh[i]);
    for (int i = 0; i < nodes->listed_count && nodes->wanted_count < marked; i++)
        if (nodes->path[nodes->listed[i]] == TD_PATH_WANTED) nodes->wanted[nodes->wanted_count++] = nodes->listed[i];
    wanted->groups += marked > 0;
    return TIDES_OK;
}

void td_points_wanted_found(td_points_wanted *wanted) {
    for (int i = 0; i < wanted->fresh_count; i++) {
        int *listed = &wanted->listed[wanted->fresh[i]];
        if (*listed != wanted->groups + 1) *listed = 0;
    }
    forget_fresh(wanted);
}
