/* Depth order and lists. A radix sort orders the visible splats. Then the blocks that each splat may reach are found in that
 * order. Threads handle neighbouring parts of the order, and store their hits in turn, so that lists are in depth order too. */
#include "limit_parts.h"

#include <stdlib.h>

/* -- depth order ---------------------------------------------------------------------------------------------------------- */

enum { RADIX_BITS = 11, RADIX = 1 << RADIX_BITS };

/* Copies the keys of all threads side by side, and subtracts the smallest. Returns the largest. */
static uint32_t collect_keys(limit *l) {
    uint32_t least = UINT32_MAX, most = 0;
    l->splats = 0;
    for (int32_t t = 0; t < l->threads; t++) {
        const limit_worker *w = &l->workers[t];
        for (int64_t i = 0; i < w->splats; i++) {
            const uint32_t key = l->keys[0][w->first_splat + i];
            least = key < least ? key : least;
            most = key > most ? key : most;
            l->keys[1][l->splats] = key;
            l->places[1][l->splats++] = (int32_t)(w->first_splat + i);
        }
    }
    for (int64_t i = 0; i < l->splats; i++) l->keys[1][i] -= least;
    return l->splats ? most - least : 0;
}

static void radix_pass(limit *l, int32_t from, int32_t shift) {
    int32_t at[RADIX] = {0}, sum = 0;
    const uint32_t *key = l->keys[from];
    uint32_t *key_to = l->keys[!from];
    const int32_t *place = l->places[from];
    int32_t *place_to = l->places[!from];
    for (int64_t i = 0; i < l->splats; i++) at[(key[i] >> shift) & (RADIX - 1)]++;
    for (int32_t k = 0; k < RADIX; k++) {
        const int32_t count = at[k];
        at[k] = sum;
        sum += count;
    }
    for (int64_t i = 0; i < l->splats; i++) {
        const int32_t to = at[(key[i] >> shift) & (RADIX - 1)]++;
        key_to[to] = key[i];
        place_to[to] = place[i];
    }
}

/* Sorts the splats; places[0] gets the order. */
void limit_sort(limit *l) {
    const uint32_t most = collect_keys(l);
    int32_t from = 1;
    for (int32_t shift = 0; shift < 32 && most >> shift; shift += RADIX_BITS, from = !from) radix_pass(l, from, shift);
    if (from == 0) return;
    int32_t *order = l->places[1];
    l->places[1] = l->places[0];
    l->places[0] = order;
}

/* -- lists ---------------------------------------------------------------------------------------------------------------- */

static void part_of(const limit *l, int32_t thread, int64_t *first, int64_t *end) {
    *first = l->splats * thread / l->threads;
    *end = l->splats * (thread + 1) / l->threads;
}

/* Numbers of a splat that all tiles share. */
typedef struct ellipse {
    vec u, v, qxx, qxy, qyy, slope_x, slope_y, least;
} ellipse;

LIMIT_INLINE ellipse ellipse_of(const limit_record *r) {
    return (ellipse){splat(r->u),
                     splat(r->v),
                     splat(r->qxx),
                     splat(r->qxy),
                     splat(r->qyy),
                     splat(-0.5f * r->qxy / r->qxx),
                     splat(-0.5f * r->qxy / r->qyy),
                     splat(-(r->log2_opacity + 7.9944f))}; /* log2(255), and a little */
}

/* The blocks of the tile with a pixel centre within the ellipse, a lane for each block. Within a block the form is least on the
 * side nearest to the splat, in x or in y. */
LIMIT_INLINE uint32_t blocks_reached(const ellipse *e, float x, float y) {
    const vec block_x = {0, 4, 8, 12, 0, 4, 8, 12, 0, 4, 8, 12, 0, 4, 8, 12};
    const vec block_y = {0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12};
    const vec x0 = block_x + (x + 0.5f) - e->u, x1 = x0 + 3.0f, y0 = block_y + (y + 0.5f) - e->v, y1 = y0 + 3.0f;
    const vec near_x = smaller(larger(splat(0), x0), x1), near_y = smaller(larger(splat(0), y0), y1);
    const vec best_y = smaller(larger(e->slope_y * near_x, y0), y1), best_x = smaller(larger(e->slope_x * near_y, x0), x1);
    const vec on_x = near_x * (e->qxx * near_x + e->qxy * best_y) + e->qyy * best_y * best_y;
    const vec on_y = best_x * (e->qxx * best_x + e->qxy * near_y) + e->qyy * near_y * near_y;
    return bits(at_least(larger(on_x, on_y), e->least));
}

static int32_t grow_hits(limit_worker *w, size_t more) {
    if (w->hit_count + more <= w->hit_capacity) return 1;
    const size_t capacity = 2 * (w->hit_count + more) + 4096;
    limit_hit *grown = realloc(w->hits, capacity * sizeof *grown);
    if (!grown) return 0;
    w->hits = grown;
    w->hit_capacity = capacity;
    return 1;
}

/* Puts the splats of a thread in order, and finds their hits. */
static void find_hits(limit *l, int32_t thread) {
    limit_worker *w = &l->workers[thread];
    int64_t first, end;
    part_of(l, thread, &first, &end);
    memset(w->tile_counts, 0, (size_t)l->tiles * sizeof *w->tile_counts);
    w->hit_count = 0;
    for (int64_t i = first; i < end && !w->failed; i++) {
        if (i + 12 < end) __builtin_prefetch(&l->records[l->places[0][i + 12]]);
        const limit_record r = l->records[l->places[0][i]];
        const ellipse e = ellipse_of(&r);
        l->sorted[i] = r;
        if (!grow_hits(w, (size_t)(r.x1 - r.x0) * (size_t)(r.y1 - r.y0))) w->failed = 1;
        for (int32_t ty = r.y0; ty < r.y1 && !w->failed; ty++)
            for (int32_t tx = r.x0; tx < r.x1; tx++) {
                const uint32_t blocks = blocks_reached(&e, (float)(TILE * tx), (float)(TILE * ty));
                const int32_t tile = ty * l->tiles_x + tx;
                w->hits[w->hit_count] = (limit_hit){tile, (int32_t)i, blocks};
                w->hit_count += blocks != 0;
                w->tile_counts[tile] += blocks != 0;
            }
    }
}

/* Moves the hits of a thread to the lists of their tiles. Its tile_counts have the place of the next hit. */
static void place_hits(limit *l, int32_t thread) {
    const limit_worker *w = &l->workers[thread];
    for (size_t i = 0; i < w->hit_count; i++) {
        const int32_t to = w->tile_counts[w->hits[i].tile]++;
        l->list[to] = w->hits[i].splat;
        l->masks[to] = (uint16_t)w->hits[i].blocks;
    }
}

/* Finds where each list begins, and each thread's part of it. Returns the number of hits. */
static int32_t begin_lists(limit *l) {
    int32_t sum = 0;
    for (int32_t tile = 0; tile < l->tiles; tile++) {
        l->starts[tile] = sum;
        for (int32_t t = 0; t < l->threads; t++) {
            const int32_t count = l->workers[t].tile_counts[tile];
            l->workers[t].tile_counts[tile] = sum;
            sum += count;
        }
    }
    l->starts[l->tiles] = sum;
    return sum;
}

/* Orders the tiles by the number of binary digits of their lists' lengths, the longest first, so that no thread gets a long
 * list at the end. */
static void order_tiles(limit *l) {
    int32_t at[33] = {0}, sum = 0;
    for (int32_t i = 0; i < l->tiles; i++) {
        const uint32_t length = (uint32_t)(l->starts[i + 1] - l->starts[i]);
        at[length ? __builtin_clz(length) : 32]++;
    }
    for (int32_t k = 0; k < 33; k++) {
        const int32_t count = at[k];
        at[k] = sum;
        sum += count;
    }
    for (int32_t i = 0; i < l->tiles; i++) {
        const uint32_t length = (uint32_t)(l->starts[i + 1] - l->starts[i]);
        l->by_length[at[length ? __builtin_clz(length) : 32]++] = i;
    }
}

int32_t limit_lists(limit *l) {
    limit_together(l, find_hits);
    for (int32_t t = 0; t < l->threads; t++)
        if (l->workers[t].failed) return 0;
    const size_t hits = (size_t)begin_lists(l);
    if (hits > l->list_capacity) {
        free(l->list);
        free(l->masks);
        l->list_capacity = hits + hits / 2;
        l->list = malloc(l->list_capacity * sizeof *l->list);
        l->masks = malloc(l->list_capacity * sizeof *l->masks);
        if (!l->list || !l->masks) return 0;
    }
    limit_together(l, place_hits);
    order_tiles(l);
    return 1;
}
