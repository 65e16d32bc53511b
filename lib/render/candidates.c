/* Candidate lists: for each 16x16 tile the Gaussians whose swept box touches it, in index order. This is a counting sort,
 * object by object: a pass over the boxes finds the touching ones and the lengths of the lists, and a second pass fills the
 * lists. Boxes are tested in vectors. A box of up to 2x2 tiles is put into its lists without a branch, since the number of
 * tiles is hard to predict. */
#include "td_renderer.h"
#include "td_wide.h"

#include <limits.h>
#include <stdlib.h>

/* Tiles, or blocks, that a box touches; both ends are included. */
typedef struct range {
    uint16_t x0, y0, x1, y1; /* large enough: images are limited to 16384 px */
} range;

/* A Gaussian that touches a tile. */
struct td_touch {
    int gaussian;
    range on;
};

/* The Gaussians of one object that touch a tile. */
struct td_touching {
    size_t begin, end; /* range in candidates->touches */
    range on;          /* tiles that they touch, together */
    int object;
};

enum { MISSING = 3 }; /* tiles behind the last one, for entries that aren't wanted */

/* Columns of blocks handled together, and the alignment of their vectors. */
enum { TOGETHER = 32 };

static int blocks_stride(const td_candidates *candidates) {
    return (candidates->tiles_x * (TD_TILE / TD_BLOCK) + TOGETHER - 1) / TOGETHER * TOGETHER;
}

tides_status td_candidates_create(int width, int height, td_candidates *candidates, tides_error *error) {
    memset(candidates, 0, sizeof *candidates);
    candidates->tiles_x = (width + TD_TILE - 1) / TD_TILE;
    candidates->tiles_y = (height + TD_TILE - 1) / TD_TILE;
    const size_t columns = (size_t)candidates->tiles_x, tiles = columns * (size_t)candidates->tiles_y;
    candidates->first = td_alloc(tiles + 1, sizeof *candidates->first, error);
    candidates->end = td_alloc(tiles + MISSING, sizeof *candidates->end, error);
    candidates->edges = td_alloc(tiles + columns + (size_t)candidates->tiles_y + 1, sizeof *candidates->edges, error);
    candidates->column = td_alloc(columns, sizeof *candidates->column, error);
    candidates->travel = td_alloc(tiles + MISSING, sizeof *candidates->travel, error);
    candidates->moving = td_alloc(tiles, sizeof *candidates->moving, error);
    candidates->hint = td_alloc(tiles, sizeof *candidates->hint, error);
    candidates->moving_blocks = td_alloc(tiles, sizeof *candidates->moving_blocks, error);
    candidates->blocks = td_alloc((size_t)blocks_stride(candidates) * (TD_TILE / TD_BLOCK) * (size_t)candidates->tiles_y,
                                  sizeof *candidates->blocks, error);
    candidates->block_travel = td_alloc(tiles * TD_TILE_BLOCKS, sizeof *candidates->block_travel, error);
    if (candidates->first && candidates->end && candidates->edges && candidates->column && candidates->travel &&
        candidates->moving && candidates->hint && candidates->moving_blocks && candidates->blocks && candidates->block_travel)
        return TIDES_OK;
    td_candidates_release(candidates);
    return TIDES_NO_MEMORY;
}

void td_candidates_release(td_candidates *candidates) {
    free(candidates->first);
    free(candidates->list);
    free(candidates->end);
    free(candidates->edges);
    free(candidates->column);
    free(candidates->touches);
    free(candidates->touching);
    free(candidates->groups);
    free(candidates->travel);
    free(candidates->moving);
    free(candidates->hint);
    free(candidates->moving_blocks);
    free(candidates->blocks);
    free(candidates->block_travel);
    memset(candidates, 0, sizeof *candidates);
}

static tides_status fail_many(tides_error *error) {
    return td_fail(error, TIDES_UNSUPPORTED,
                   "scene: its splats touch the tiles of this image more than %d times; use a "
                   "smaller image or fewer Gaussians",
                   INT_MAX / TD_RECORD_STRIDE);
}

/* -- Gaussians that touch a tile --------------------------------------------------------------------------------------- */

enum { LOOK = 16 * TD_PAD }; /* Gaussians that are tested together */

typedef struct look {
    int32_t x0[LOOK], y0[LOOK], x1[LOOK], y1[LOOK]; /* their tiles; valid tile numbers even for one that touches none */
    int32_t any[LOOK];                              /* 1 if it touches a tile */
} look;

/* Finds the tiles that `count` boxes touch; `count` is a whole number of groups. A box with a NaN touches nothing. */
TD_WIDE static void look_at(const float *restrict boxes, int count, int tiles_x, int tiles_y, look *restrict out) {
    const float limit_x = (float)(TD_TILE * tiles_x), limit_y = (float)(TD_TILE * tiles_y);
    for (int i = 0; i < count; i++) {
        const float left = boxes[4 * i], top = boxes[4 * i + 1], right = boxes[4 * i + 2], bottom = boxes[4 * i + 3];
        const int32_t there = (left < limit_x) & (top < limit_y) & (right >= 0) & (bottom >= 0);
        float x0 = left > 0 ? left : 0, y0 = top > 0 ? top : 0, x1 = right > 0 ? right : 0, y1 = bottom > 0 ? bottom : 0;
        x0 = x0 < limit_x ? x0 : 0, y0 = y0 < limit_y ? y0 : 0;
        x1 = x1 < limit_x ? x1 : limit_x - 1, y1 = y1 < limit_y ? y1 : limit_y - 1;
        const int32_t a = (int32_t)x0 / TD_TILE, b = (int32_t)y0 / TD_TILE, c = (int32_t)x1 / TD_TILE,
                      d = (int32_t)y1 / TD_TILE;
        out->x0[i] = a, out->y0[i] = b, out->x1[i] = c, out->y1[i] = d;
        out->any[i] = there & (a <= c) & (b <= d);
    }
}

/* Appends those of TD_PAD neighbours that touch a tile. */
static void add_touches(td_candidates *candidates, const look *seen, int at, int first) {
    struct td_touch *touch = candidates->touches + candidates->touch_count;
    for (int i = at; i < at + TD_PAD; i++) {
        touch->gaussian = first + i;
        touch->on = (range){(uint16_t)seen->x0[i], (uint16_t)seen->y0[i], (uint16_t)seen->x1[i], (uint16_t)seen->y1[i]};
        touch += seen->any[i];
    }
    candidates->touch_count = (size_t)(touch - candidates->touches);
}

static void add_group(td_candidates *candidates, const td_store *store, const look *seen, int at, int first) {
    const int object = store->object[first + at];
    int32_t any = 0;
    /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): the analyzer doesn't know that counts are multiples of
     * TD_PAD */
    for (int i = at; i < at + TD_PAD; i++) any |= seen->any[i];
    if (!any) return;
    struct td_touching *touching = candidates->touching + candidates->touching_count;
    if (candidates->touching_count == 0 || touching[-1].object != object) {
        *touching = (struct td_touching){.begin = candidates->touch_count, .object = object};
        candidates->touching_count++;
    }
    candidates->groups[candidates->group_count++] = (first + at) / TD_PAD;
    add_touches(candidates, seen, at, first);
    candidates->touching[candidates->touching_count - 1].end = candidates->touch_count;
}

/* Finds the touching Gaussians among [first, first + count), at most LOOK. */
static tides_status look_for(td_candidates *candidates, const td_store *store, const float *boxes, int first, int count,
                             tides_error *error) {
    look seen;
    tides_status status = td_reserve((void **)&candidates->touches, &candidates->touches_capacity,
                                     candidates->touch_count + LOOK + 1, sizeof *candidates->touches, error);
    if (status != TIDES_OK) return status;
    look_at(boxes + 4 * (size_t)first, count, candidates->tiles_x, candidates->tiles_y, &seen);
    for (int at = 0; at < count; at += TD_PAD) add_group(candidates, store, &seen, at, first);
    return TIDES_OK;
}

/* Finds all touching Gaussians. They come in the store's order, so groups and objects are in order, too. */
static tides_status find_touches(td_candidates *candidates, const td_store *store, const td_boxes *boxes, tides_error *error) {
    const td_groups *groups = boxes->groups;
    const int all = groups ? groups->count : store->count / TD_PAD, most = LOOK / TD_PAD;
    tides_status status = TIDES_OK;
    candidates->group_count = candidates->touching_count = 0;
    candidates->touch_count = 0;
    for (int at = 0, next; at < all && status == TIDES_OK; at = next) {
        next = groups ? td_groups_together(groups, at, most) : at + most < all ? at + most : all;
        const int first = groups ? groups->number[at] : at;
        status = look_for(candidates, store, boxes->box, first * TD_PAD, (next - at) * TD_PAD, error);
    }
    return status;
}

/* -- lengths of lists ---------------------------------------------------------------------------------------------------- */

/* Rounds up: each object's part of a tile's list begins at a multiple of TD_PAD. */
static int padded(int end) { return (end + TD_PAD - 1) / TD_PAD * TD_PAD; }

/* Marks corners of boxes in `edges`, so that sums over rows and columns give the number of boxes on each tile. Also finds the
 * range of tiles. */
static void mark_edges(td_candidates *candidates, struct td_touching *touching) {
    const int stride = candidates->tiles_x + 1;
    int *edges = candidates->edges;
    range all = candidates->touches[touching->begin].on;
    for (size_t i = touching->begin; i < touching->end; i++) {
        const range on = candidates->touches[i].on;
        int *top = edges + on.y0 * stride, *below = edges + (on.y1 + 1) * stride;
        top[on.x0]++, top[on.x1 + 1]--;
        below[on.x0]--, below[on.x1 + 1]++;
        all.x0 = on.x0 < all.x0 ? on.x0 : all.x0, all.y0 = on.y0 < all.y0 ? on.y0 : all.y0;
        all.x1 = on.x1 > all.x1 ? on.x1 : all.x1, all.y1 = on.y1 > all.y1 ? on.y1 : all.y1;
    }
    touching->on = all;
}

/* Adds an object's part to the lengths of lists, in candidates->end. `edges` is zeroed again. */
static void count_object(td_candidates *candidates, struct td_touching *touching) {
    const int tiles_x = candidates->tiles_x;
    int *column = candidates->column;
    mark_edges(candidates, touching);
    const range on = touching->on;
    memset(column + on.x0, 0, (size_t)(on.x1 + 1 - on.x0) * sizeof *column);
    for (int y = on.y0; y <= on.y1; y++) {
        int *edge = candidates->edges + y * (tiles_x + 1), *end = candidates->end + y * tiles_x, row = 0;
        for (int x = on.x0; x <= on.x1; x++) {
            row += edge[x];
            column[x] += row;
            end[x] = padded(end[x] + column[x]);
        }
        memset(edge + on.x0, 0, (size_t)(on.x1 + 2 - on.x0) * sizeof *edge);
    }
    memset(candidates->edges + (on.y1 + 1) * (tiles_x + 1) + on.x0, 0, (size_t)(on.x1 + 2 - on.x0) * sizeof *column);
}

/* Sets the beginning of each list, and allocates room for all. */
static tides_status lay_lists(td_candidates *candidates, tides_error *error) {
    const int tiles = candidates->tiles_x * candidates->tiles_y;
    int64_t total = 0;
    memset(candidates->end, 0, (size_t)tiles * sizeof *candidates->end);
    for (int i = 0; i < candidates->touching_count; i++) count_object(candidates, &candidates->touching[i]);
    for (int t = 0; t < tiles; t++) {
        candidates->first[t] = (int)total;
        total += candidates->end[t];
        if (total > INT_MAX / TD_RECORD_STRIDE) return fail_many(error);
    }
    candidates->first[tiles] = (int)total;
    return td_reserve((void **)&candidates->list, &candidates->capacity, (size_t)total + 1, sizeof *candidates->list, error);
}

/* -- filling the lists ------------------------------------------------------------------------------------------------- */

/* Appends a Gaussian to a tile's list. far: distance that it travels, in its own diameters. */
static inline void place(td_candidates *candidates, int tile, int there, int gaussian, int moves, float far) {
    candidates->list[candidates->end[tile]] = gaussian;
    candidates->end[tile] += there;
    if (moves) candidates->travel[tile] = far > candidates->travel[tile] ? far : candidates->travel[tile];
}

/* Puts one object's Gaussians into the lists of their tiles. For a moving object, notes that the tiles move, and how far at
 * most. Superfluous entries go to tiles behind the last. There are three of those, so that successive stores don't wait for
 * one counter. */
static inline void place_each(td_candidates *candidates, const struct td_touching *touching, const float *travel, int moves) {
    const int tiles_x = candidates->tiles_x, none = tiles_x * candidates->tiles_y;
    for (size_t i = touching->begin; i < touching->end; i++) {
        const range on = candidates->touches[i].on;
        const int g = candidates->touches[i].gaussian, tile = on.y0 * tiles_x + on.x0, wide = on.x1 - on.x0,
                  high = on.y1 - on.y0;
        const float far = moves && travel[g] > 0 ? travel[g] : 0;
        if ((wide | high) > 1) {
            for (int y = on.y0; y <= on.y1; y++)
                for (int t = y * tiles_x + on.x0; t <= y * tiles_x + on.x1; t++) place(candidates, t, 1, g, moves, far);
            continue;
        }
        place(candidates, tile, 1, g, moves, far);
        place(candidates, wide ? tile + 1 : none, wide, g, moves, far);
        place(candidates, high ? tile + tiles_x : none + 1, high, g, moves, far);
        place(candidates, wide & high ? tile + tiles_x + 1 : none + 2, wide & high, g, moves, far);
    }
}

/* Fills each tile's list with TD_NO_GAUSSIAN up to the next object's part. */
static void fill_up(td_candidates *candidates, const range *on) {
    for (int y = on->y0; y <= on->y1; y++)
        for (int t = y * candidates->tiles_x + on->x0; t <= y * candidates->tiles_x + on->x1; t++) {
            const int end = padded(candidates->end[t]);
            while (candidates->end[t] < end) candidates->list[candidates->end[t]++] = TD_NO_GAUSSIAN;
        }
}

/* -- motion by blocks ------------------------------------------------------------------------------------------------- */

/* Raises the travel of the blocks of `on` in a row, in TOGETHER columns from `at` on, to `far`. */
static inline void travel_in(float *restrict blocks, int stride, const range *on, int at, float far) {
    float here[TOGETHER];
    for (int k = 0; k < TOGETHER; k++) here[k] = ((at + k < on->x0) | (at + k > on->x1)) ? -1 : far;
    for (int y = on->y0; y <= on->y1; y++) {
        float *row = blocks + (size_t)y * (size_t)stride + at;
        for (int k = 0; k < TOGETHER; k++) row[k] = here[k] > row[k] ? here[k] : row[k];
    }
}

/* Notes an object's travel in the blocks that its boxes touch. `blocks` (rows x stride) holds the largest travel, -1 if
 * nothing moves. */
TD_WIDE static void place_blocks(const struct td_touch *restrict touches, size_t count, const float *restrict boxes,
                                 const float *restrict travel, int last_x, int last_y, int stride, float *restrict blocks) {
    const float end_x = (float)((last_x + 1) * TD_BLOCK), end_y = (float)((last_y + 1) * TD_BLOCK);
    for (size_t i = 0; i < count; i++) {
        const float *box = boxes + 4 * (size_t)touches[i].gaussian, way = travel[touches[i].gaussian], far = way > 0 ? way : 0;
        range on;
        on.x0 = (uint16_t)(box[0] > 0 ? (int)box[0] / TD_BLOCK : 0);
        on.y0 = (uint16_t)(box[1] > 0 ? (int)box[1] / TD_BLOCK : 0);
        on.x1 = (uint16_t)(box[2] < end_x ? (int)box[2] / TD_BLOCK : last_x);
        on.y1 = (uint16_t)(box[3] < end_y ? (int)box[3] / TD_BLOCK : last_y);
        for (int at = on.x0 & -TOGETHER; at <= on.x1; at += TOGETHER) travel_in(blocks, stride, &on, at, far);
    }
}

/* Notes the travel of all moving objects in the blocks of each tile. */
static void find_blocks(td_candidates *candidates, const float *boxes, const float *travel, const uint8_t *object_moves) {
    enum { SIDE = TD_TILE / TD_BLOCK };
    const int stride = blocks_stride(candidates), rows = SIDE * candidates->tiles_y;
    for (int i = 0; i < rows * stride; i++) candidates->blocks[i] = -1;
    for (int i = 0; i < candidates->touching_count; i++) {
        const struct td_touching *touching = &candidates->touching[i];
        if (object_moves[touching->object])
            place_blocks(candidates->touches + touching->begin, touching->end - touching->begin, boxes, travel,
                         SIDE * candidates->tiles_x - 1, rows - 1, stride, candidates->blocks);
    }
    for (int t = 0; t < candidates->tiles_x * candidates->tiles_y; t++) {
        const int x = SIDE * (t % candidates->tiles_x), y = SIDE * (t / candidates->tiles_x);
        for (int k = 0; k < TD_TILE_BLOCKS; k++) {
            const float way = candidates->blocks[(y + k / SIDE) * stride + x + k % SIDE];
            candidates->moving_blocks[t] = (uint16_t)(candidates->moving_blocks[t] | (way >= 0) << k);
            candidates->block_travel[(size_t)t * TD_TILE_BLOCKS + (size_t)k] = way >= 0 ? way : 0;
        }
    }
}

/* -------------------------------------------------------------------------------------------------------------------------- */

/* Fills the lists, and finds which tiles move. */
static void place_all(td_candidates *candidates, const float *travel, const uint8_t *object_moves) {
    const size_t tiles = (size_t)candidates->tiles_x * (size_t)candidates->tiles_y;
    memcpy(candidates->end, candidates->first, tiles * sizeof *candidates->end);
    for (size_t t = tiles; t < tiles + MISSING; t++) candidates->end[t] = candidates->first[tiles];
    for (size_t t = 0; t < tiles + MISSING; t++) candidates->travel[t] = -1;
    for (int i = 0; i < candidates->touching_count; i++) {
        const struct td_touching *touching = &candidates->touching[i];
        if (object_moves[touching->object])
            place_each(candidates, touching, travel, 1);
        else
            place_each(candidates, touching, travel, 0);
        fill_up(candidates, &touching->on);
    }
    for (size_t t = 0; t < tiles; t++) {
        candidates->moving[t] = candidates->travel[t] >= 0;
        candidates->travel[t] = candidates->moving[t] ? candidates->travel[t] : 0;
    }
}

/* Lists and blocks, which two threads make side by side. */
enum { LISTS, BLOCKS, HALVES };

typedef struct placing {
    td_candidates *candidates;
    const td_boxes *boxes;
} placing;

static void place_half(void *user, int half) {
    const placing *of = user;
    td_candidates *candidates = of->candidates;
    const td_boxes *boxes = of->boxes;
    const size_t tiles = (size_t)candidates->tiles_x * (size_t)candidates->tiles_y;
    if (half == LISTS) {
        place_all(candidates, boxes->travel, boxes->object_moves);
        return;
    }
    memset(candidates->moving_blocks, 0, tiles * sizeof *candidates->moving_blocks);
    memset(candidates->block_travel, 0, tiles * TD_TILE_BLOCKS * sizeof *candidates->block_travel);
    if (candidates->by_blocks) find_blocks(candidates, boxes->box, boxes->travel, boxes->object_moves);
}

void td_candidates_blocks_as_tiles(td_candidates *candidates) {
    int tiles = candidates->tiles_x * candidates->tiles_y;
    for (int t = 0; t < tiles; t++) {
        candidates->moving_blocks[t] = candidates->moving[t] ? TD_ALL_BLOCKS : 0;
        for (int k = 0; k < TD_TILE_BLOCKS; k++) candidates->block_travel[t * TD_TILE_BLOCKS + k] = candidates->travel[t];
    }
}

tides_status td_candidates_build(td_candidates *candidates, const td_store *store, const td_boxes *boxes, tides_error *error) {
    tides_status status = td_reserve((void **)&candidates->groups, &candidates->groups_capacity,
                                     (size_t)(store->count / TD_PAD), sizeof *candidates->groups, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&candidates->touching, &candidates->touching_capacity, (size_t)store->objects,
                            sizeof *candidates->touching, error);
    if (status == TIDES_OK) status = find_touches(candidates, store, boxes, error);
    if (status == TIDES_OK) status = lay_lists(candidates, error);
    if (status != TIDES_OK) return status;
    placing both = {candidates, boxes};
    td_pool_run(boxes->pool, HALVES, place_half, &both);
    candidates->serial++;
    if (!candidates->instant) td_candidates_renew_hints(candidates);
    return TIDES_OK;
}
