/* Compositing by INRIA's rules. Each tile makes a contiguous copy of its records and a list for each of its blocks. Each block
 * composites sixteen pixels front to back, all in registers. */
#include "limit_parts.h"

#include <stdlib.h>

enum { LOOK_AHEAD = 8 }; /* after so many splats it asks whether any pixel can still change */

static const float alpha_most = 0.99f, cut = 1 / 255.0f, stop = 1e-4f;

/* The state of sixteen pixels while they go through a list. */
typedef struct pixels {
    vec T, T_dot, Y, Y_dot;
    mask live;
} pixels;

LIMIT_INLINE void blend(const limit_record *r, vec x, vec y, int rates, pixels *p) {
    const vec dx = x - r->u, dy = y - r->v;
    const vec power = dx * (r->qxx * dx + r->qxy * dy) + ((r->qyy * dy) * dy + r->log2_opacity);
    const vec alpha = power_of_2(larger(power, splat(-126)));
    const vec capped = smaller(alpha, splat(alpha_most));
    const mask seen = at_least(alpha, splat(cut));
    p->live = but(p->live, below_where(seen, p->T - p->T * capped, splat(stop)));
    const vec a = keep(both(seen, p->live), capped);
    const vec w = p->T * a;
    if (rates) {
        vec rate = dx * (r->kxx * dx + (r->kxy * dy + r->kx));
        rate = dy * (r->kyy * dy + r->ky) + rate;
        const vec a_dot = keep(above(splat(alpha_most), alpha), a * rate);
        const vec w_dot = p->T_dot * a + p->T * a_dot;
        p->Y_dot += w_dot * r->luminance + w * r->luminance_dot;
        p->T_dot -= w_dot;
    }
    p->Y += w * r->luminance;
    p->T -= w;
}

LIMIT_INLINE int64_t composite_block(const limit_record *records, const int32_t *list, int32_t count, vec x, vec y, int rates,
                                     pixels *p) {
    const vec none = splat(0);
    *p = (pixels){splat(1), none, none, none, all_lanes()};
    int32_t i = 0;
    while (i < count && any(p->live)) {
        const int32_t end = i + LOOK_AHEAD < count ? i + LOOK_AHEAD : count;
        for (; i < end; i++) blend(&records[list[i]], x, y, rates, p);
    }
    return i;
}

/* Adds the background, and takes logarithms. */
LIMIT_INLINE void finish(const limit *l, pixels *p, vec *L, vec *L_dot) {
    const double *b = l->setup.background, *w = l->setup.luminance;
    const float background = (float)(b[0] * w[0] + b[1] * w[1] + b[2] * w[2]);
    const vec Y = p->Y + p->T * background + (float)l->setup.log_eps;
    *L = natural_log(Y);
    *L_dot = (p->Y_dot + p->T_dot * background) / Y;
}

/* Writes four rows of four pixels into a plane. Pixels outside the image are left out. */
LIMIT_INLINE void put_block(const limit *l, int32_t x, int32_t y, vec values, float *plane) {
    const int32_t width = l->setup.width, height = l->setup.height, wide = width - x < 4 ? width - x : 4;
    float rows[LANES];
    store(rows, values);
    for (int32_t row = 0; row < 4 && y + row < height && wide > 0; row++) {
        float *to = plane + (size_t)(y + row) * (size_t)width + x;
        if (wide == 4)
            memcpy(to, rows + 4 * row, 4 * sizeof *to);
        else
            memcpy(to, rows + 4 * row, (size_t)wide * sizeof *to);
    }
}

static int32_t make_room(limit_worker *w, size_t count) {
    if (count <= w->local_capacity) return 1;
    free(w->local);
    free(w->lists);
    w->local_capacity = count + count / 2 + LANES; /* split_list writes up to a vector behind the end */
    w->local = malloc(w->local_capacity * sizeof *w->local);
    w->lists = malloc(w->local_capacity * BLOCKS * sizeof *w->lists);
    if (w->local && w->lists) return 1;
    w->local_capacity = 0;
    w->failed = 1;
    return 0;
}

/* Lists for each block the splats that reach it. It tests sixteen splats of a tile together where the machine can pack the
 * lanes of a mask. Without that, a branch on the number of blocks that a splat reaches is mispredicted for most splats. */
static void split_list(const uint16_t *masks, int32_t count, size_t capacity, int32_t *lists, int32_t counts[BLOCKS]) {
    memset(counts, 0, BLOCKS * sizeof *counts);
    for (int32_t i = 0; i < count; i += LANES) {
        uint16_t some[LANES] = {0};
        memcpy(some, masks + i, (size_t)(count - i < LANES ? count - i : LANES) * sizeof *some);
        for (int32_t block = 0; block < BLOCKS; block++)
            counts[block] += put_reaching(some, block, i, lists + (size_t)block * capacity + counts[block]);
    }
}

/* Copies the tile's records side by side, and makes the lists of its blocks. */
static void sort_out(const limit *l, limit_worker *w, int32_t first, int32_t count, int32_t counts[BLOCKS]) {
    const int32_t *list = l->list + first;
    for (int32_t i = 0; i < count; i++) {
        if (i + 12 < count) __builtin_prefetch(&l->sorted[list[i + 12]]);
        w->local[i] = l->sorted[list[i]];
    }
    split_list(l->masks + first, count, w->local_capacity, w->lists, counts);
}

static void composite_tile(limit *l, limit_worker *w, int32_t tile, int rates) {
    const vec in_x = {0.5f, 1.5f, 2.5f, 3.5f, 0.5f, 1.5f, 2.5f, 3.5f, 0.5f, 1.5f, 2.5f, 3.5f, 0.5f, 1.5f, 2.5f, 3.5f};
    const vec in_y = {0.5f, 0.5f, 0.5f, 0.5f, 1.5f, 1.5f, 1.5f, 1.5f, 2.5f, 2.5f, 2.5f, 2.5f, 3.5f, 3.5f, 3.5f, 3.5f};
    const int32_t left = tile % l->tiles_x * TILE, top = tile / l->tiles_x * TILE;
    const int32_t count = l->starts[tile + 1] - l->starts[tile];
    int32_t counts[BLOCKS];
    if (!make_room(w, (size_t)count)) return;
    sort_out(l, w, l->starts[tile], count, counts);
    for (int32_t block = 0; block < BLOCKS; block++) {
        const int32_t x = left + 4 * (block % 4), y = top + 4 * (block / 4);
        const int32_t *list = w->lists + (size_t)block * w->local_capacity;
        pixels p;
        vec L, L_dot;
        w->pairs += LANES * composite_block(w->local, list, counts[block], in_x + (float)x, in_y + (float)y, rates, &p);
        finish(l, &p, &L, &L_dot);
        put_block(l, x, y, L, l->L);
        if (rates) put_block(l, x, y, L_dot, l->L_dot);
    }
}

void limit_composite(limit *l, int32_t thread) {
    limit_worker *w = &l->workers[thread];
    w->pairs = 0;
    for (;;) {
        const int32_t next = __atomic_fetch_add(&l->next_tile, 1, __ATOMIC_RELAXED);
        if (next >= l->tiles || w->failed) return;
        if (l->rates)
            composite_tile(l, w, l->by_length[next], 1);
        else
            composite_tile(l, w, l->by_length[next], 0);
    }
}
