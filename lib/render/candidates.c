/* Tile candidate lists: for each 16x16 tile the Gaussians whose swept box touches it, in index order. A counting sort: one
 * pass over the boxes, which lists what touches what, and one over that list. (Through the boxes' tiles once more: half as much
 * again, since how many tiles a box has is hard to guess.) */
#include "td_renderer.h"

#include <limits.h>
#include <stdlib.h>

/* A tile's list while it is made. What is asked for with each Gaussian lies side by side. */
struct td_tile_fill {
    int end;    /* one behind its last Gaussian */
    int object; /* of that one; -1: none yet */
    int moves;
    float travel;
};

/* A Gaussian, and a tile that it touches. */
struct td_touched {
    int gaussian, tile;
};

/* Tiles, both ends included. */
typedef struct tile_range {
    int x0, y0, x1, y1;
} tile_range;

tides_status td_candidates_create(int width, int height, td_candidates *candidates, tides_error *error) {
    memset(candidates, 0, sizeof *candidates);
    candidates->tiles_x = (width + TD_TILE - 1) / TD_TILE;
    candidates->tiles_y = (height + TD_TILE - 1) / TD_TILE;
    size_t tiles = (size_t)candidates->tiles_x * candidates->tiles_y;
    candidates->first = td_alloc(tiles + 1, sizeof *candidates->first, error);
    candidates->fill = td_alloc(tiles, sizeof *candidates->fill, error);
    candidates->travel = td_alloc(tiles, sizeof *candidates->travel, error);
    candidates->moving = td_alloc(tiles, sizeof *candidates->moving, error);
    candidates->hint = td_alloc(tiles, sizeof *candidates->hint, error);
    candidates->moving_blocks = td_alloc(tiles, sizeof *candidates->moving_blocks, error);
    candidates->block_travel = td_alloc(tiles * TD_TILE_BLOCKS, sizeof *candidates->block_travel, error);
    if (candidates->first && candidates->fill && candidates->travel && candidates->moving && candidates->hint &&
        candidates->moving_blocks && candidates->block_travel)
        return TIDES_OK;
    td_candidates_release(candidates);
    return TIDES_NO_MEMORY;
}

void td_candidates_release(td_candidates *candidates) {
    free(candidates->first);
    free(candidates->list);
    free(candidates->fill);
    free(candidates->touched);
    free(candidates->groups);
    free(candidates->travel);
    free(candidates->moving);
    free(candidates->hint);
    free(candidates->moving_blocks);
    free(candidates->block_travel);
    memset(candidates, 0, sizeof *candidates);
}

/* Whether a box touches any. */
static inline int touches(const td_candidates *candidates, const float *box, tile_range *on) {
    const float limit_x = (float)(TD_TILE * candidates->tiles_x), limit_y = (float)(TD_TILE * candidates->tiles_y);
    if (!(box[0] < limit_x && box[1] < limit_y && box[2] >= 0 && box[3] >= 0)) return 0;
    on->x0 = box[0] > 0 ? (int)box[0] / TD_TILE : 0;
    on->y0 = box[1] > 0 ? (int)box[1] / TD_TILE : 0;
    on->x1 = box[2] < limit_x ? (int)box[2] / TD_TILE : candidates->tiles_x - 1;
    on->y1 = box[3] < limit_y ? (int)box[3] / TD_TILE : candidates->tiles_y - 1;
    return on->x0 <= on->x1 && on->y0 <= on->y1;
}

/* Adds a moving candidate of the tile at (x0, y0), which its box touches, to the blocks that it touches. */
static void add_to_blocks(const float *box, float way, int x0, int y0, uint16_t *moving, float *travel) {
    const int left = box[0] > (float)x0 ? ((int)box[0] - x0) / TD_BLOCK : 0;
    const int top = box[1] > (float)y0 ? ((int)box[1] - y0) / TD_BLOCK : 0;
    const int right = box[2] < (float)(x0 + TD_TILE) ? ((int)box[2] - x0) / TD_BLOCK : 3;
    const int bottom = box[3] < (float)(y0 + TD_TILE) ? ((int)box[3] - y0) / TD_BLOCK : 3;
    for (int row = top; row <= bottom; row++)
        for (int k = 4 * row + left; k <= 4 * row + right; k++) {
            *moving |= (uint16_t)(1 << k);
            travel[k] = way > travel[k] ? way : travel[k];
        }
}

/* What a Gaussian is to the tiles that it touches. */
typedef struct touching {
    const float *box;
    float travel;
    int gaussian, moves;
} touching;

/* Each object's share of a tile's list begins at a multiple of TD_PAD. */
static int padded(int end) { return (end + TD_PAD - 1) / TD_PAD * TD_PAD; }

/* Nobody up to there. */
static void fill_up(td_candidates *candidates, struct td_tile_fill *fill, int end) {
    while (fill->end < end) candidates->list[fill->end++] = TD_NO_GAUSSIAN;
}

/* Puts a Gaussian into a tile's list. What moves there, and how far at most, is noted on the way: lists are long, and to go
 * through them once more, Gaussian by Gaussian, took as long as to make them. */
static void place(td_candidates *candidates, int tile, int object, const touching *it) {
    struct td_tile_fill *fill = &candidates->fill[tile];
    if (fill->object != object) {
        fill_up(candidates, fill, padded(fill->end));
        fill->object = object;
    }
    candidates->list[fill->end++] = it->gaussian;
    if (!it->moves) return;
    fill->moves = 1;
    fill->travel = it->travel > fill->travel ? it->travel : fill->travel;
    if (candidates->by_blocks)
        add_to_blocks(it->box, it->travel, tile % candidates->tiles_x * TD_TILE, tile / candidates->tiles_x * TD_TILE,
                      &candidates->moving_blocks[tile], candidates->block_travel + (size_t)tile * TD_TILE_BLOCKS);
}

/* Gaussians come in the store's order, and so do their groups. */
static void add_group(td_candidates *candidates, int group) {
    if (candidates->group_count == 0 || candidates->groups[candidates->group_count - 1] != group)
        candidates->groups[candidates->group_count++] = group;
}

static tides_status fail_many(tides_error *error) {
    return td_fail(error, TIDES_UNSUPPORTED,
                   "scene: its splats touch the tiles of this image more than %d times; use a "
                   "smaller image or fewer Gaussians",
                   INT_MAX / TD_RECORD_STRIDE);
}

/* A Gaussian of an object touches these tiles. */
static inline void touch(td_candidates *candidates, const tile_range *on, int gaussian, int object) {
    const int tiles_x = candidates->tiles_x;
    struct td_touched *touched = candidates->touched + candidates->touched_count;
    for (int y = on->y0; y <= on->y1; y++)
        for (int t = y * tiles_x + on->x0; t <= y * tiles_x + on->x1; t++) {
            struct td_tile_fill *fill = &candidates->fill[t];
            if (fill->object != object) fill->end = padded(fill->end);
            fill->object = object;
            fill->end++;
            *touched++ = (struct td_touched){gaussian, t};
        }
    candidates->touched_count = (size_t)(touched - candidates->touched);
}

/* Who touches which tiles, and how long their lists will be. */
static tides_status count_all(td_candidates *candidates, const td_store *store, const float *boxes, tides_error *error) {
    const size_t tiles = (size_t)candidates->tiles_x * (size_t)candidates->tiles_y;
    for (size_t t = 0; t < tiles; t++) candidates->fill[t] = (struct td_tile_fill){.object = -1};
    candidates->group_count = 0;
    candidates->touched_count = 0;
    for (int g = 0; g < store->count; g++) {
        tile_range on;
        if (!touches(candidates, boxes + 4 * (size_t)g, &on)) continue;
        if (candidates->touched_count + tiles > candidates->touched_capacity) {
            if (candidates->touched_count > INT_MAX / TD_RECORD_STRIDE) return fail_many(error);
            tides_status status = td_reserve((void **)&candidates->touched, &candidates->touched_capacity,
                                             candidates->touched_count + tiles, sizeof *candidates->touched, error);
            if (status != TIDES_OK) return status;
        }
        add_group(candidates, g / TD_PAD);
        touch(candidates, &on, g, store->object[g]);
    }
    return TIDES_OK;
}

/* Lists begin anew, where they are to lie. */
static void begin_lists(td_candidates *candidates) {
    const size_t tiles = (size_t)candidates->tiles_x * (size_t)candidates->tiles_y;
    memset(candidates->moving_blocks, 0, tiles * sizeof *candidates->moving_blocks);
    memset(candidates->block_travel, 0, tiles * TD_TILE_BLOCKS * sizeof *candidates->block_travel);
    for (size_t t = 0; t < tiles; t++) candidates->fill[t] = (struct td_tile_fill){.end = candidates->first[t], .object = -1};
}

static void end_lists(td_candidates *candidates) {
    for (int t = 0; t < candidates->tiles_x * candidates->tiles_y; t++) {
        struct td_tile_fill *fill = &candidates->fill[t];
        fill_up(candidates, fill, candidates->first[t + 1]);
        candidates->moving[t] = (uint8_t)fill->moves;
        candidates->travel[t] = fill->travel;
    }
}

static void place_all(td_candidates *candidates, const td_store *store, const float *boxes, const float *travel,
                      const uint8_t *object_moves) {
    begin_lists(candidates);
    for (size_t i = 0; i < candidates->touched_count; i++) {
        const int g = candidates->touched[i].gaussian, object = store->object[g];
        const touching it = {boxes + 4 * (size_t)g, travel[g], g, object_moves[object]};
        place(candidates, candidates->touched[i].tile, object, &it);
    }
    end_lists(candidates);
}

void td_candidates_blocks_as_tiles(td_candidates *candidates) {
    int tiles = candidates->tiles_x * candidates->tiles_y;
    for (int t = 0; t < tiles; t++) {
        candidates->moving_blocks[t] = candidates->moving[t] ? TD_ALL_BLOCKS : 0;
        for (int k = 0; k < TD_TILE_BLOCKS; k++) candidates->block_travel[t * TD_TILE_BLOCKS + k] = candidates->travel[t];
    }
}

/* What is known of a tile's depth order in this sweep. */
enum {
    HINT_WANTED, /* nothing yet: the next job leaves its order */
    HINT_ASKED,  /* a job at work leaves it */
    HINT_THERE,
    HINT_USED,
    HINT_UNFIT /* orders change within a sweep, or nothing asks for a second one */
};

/* Leaving an order costs more than it saves where it isn't found again (under a moving camera; frame by frame): tiles where
 * it wasn't are tried again only every so many sweeps, which makes a sixteenth of the cost. */
enum { SWEEPS_TO_RETRY = 16 };

static void renew_hints(td_candidates *candidates) {
    int tiles = candidates->tiles_x * candidates->tiles_y, retry = candidates->serial % SWEEPS_TO_RETRY == 0;
    for (int t = 0; t < tiles; t++) {
        uint8_t *hint = &candidates->hint[t];
        int unfit = *hint == HINT_UNFIT || *hint == HINT_THERE;
        *hint = unfit && !retry ? HINT_UNFIT : HINT_WANTED;
    }
}

tides_status td_candidates_build(td_candidates *candidates, const td_store *store, const float *boxes, const float *travel,
                                 const uint8_t *object_moves, tides_error *error) {
    int tiles = candidates->tiles_x * candidates->tiles_y;
    int64_t total = 0;
    tides_status status = td_reserve((void **)&candidates->groups, &candidates->groups_capacity,
                                     (size_t)(store->count / TD_PAD), sizeof *candidates->groups, error);
    if (status == TIDES_OK) status = count_all(candidates, store, boxes, error);
    if (status != TIDES_OK) return status;
    for (int t = 0; t < tiles; t++) {
        candidates->first[t] = (int)total;
        total += padded(candidates->fill[t].end);
        if (total > INT_MAX / TD_RECORD_STRIDE) return fail_many(error);
    }
    candidates->first[tiles] = (int)total;
    status = td_reserve((void **)&candidates->list, &candidates->capacity, total ? (size_t)total : 1, sizeof *candidates->list,
                        error);
    if (status != TIDES_OK) return status;
    place_all(candidates, store, boxes, travel, object_moves);
    candidates->serial++;
    if (!candidates->instant) renew_hints(candidates);
    return TIDES_OK;
}

int td_candidates_hint_count(const td_candidates *candidates) {
    return 1 + candidates->first[candidates->tiles_x * candidates->tiles_y];
}

void td_candidates_give_hint(td_candidates *candidates, int tile, td_job *job) {
    uint8_t *hint = &candidates->hint[tile];
    int place = 1 + candidates->first[tile];
    if (candidates->instant) return;
    if (*hint == HINT_WANTED) {
        job->new_hint = place;
        *hint = HINT_ASKED;
    } else if (*hint == HINT_THERE || *hint == HINT_USED) {
        job->hint = place;
        *hint = HINT_USED;
    }
}

void td_candidates_take_hints(td_candidates *candidates, const td_job *jobs, int count, const uint8_t *in_order) {
    for (int i = 0; i < count; i++) {
        uint8_t *hint = &candidates->hint[jobs[i].y / TD_TILE * candidates->tiles_x + jobs[i].x / TD_TILE];
        if (jobs[i].new_hint)
            *hint = in_order ? HINT_THERE : HINT_WANTED;
        else if (jobs[i].hint && in_order && !in_order[jobs[i].out])
            *hint = HINT_UNFIT;
    }
}
