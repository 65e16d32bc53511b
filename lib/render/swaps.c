/* Swaps of depth: finds which splats of a tile come within reach of each other's depth in the interval swept last, and when.
 * It works on the host, in double, from views at a few samples and the cubics between them.
 *
 * Most scenes have none that samples could miss. A swap of two splats of one rigid body that is seen to turn lasts long where
 * the turn is slow and the splats are small: what takes more than a share of the interval shows in its samples. One that is
 * shorter needs splats so large that the turn takes their depths past each other fast, and one that comes back within the
 * interval needs depths that stray by the reach from going straight. Splats of different bodies are looked at wherever their
 * depths meet. A splat that a motion model moves is a body of its own (swap_movers.c). */
#include "scene/td_scene.h"
#include "td_extremes.h"
#include "td_math.h"
#include "td_sort.h"
#include "td_swaps.h"

#include <math.h>
#include <stdlib.h>

/* Parts of the interval at whose ends depths are computed: 4 to TD_SWAP_PARTS_MOST. There are more if a view turns by more than
 * `steady` [rad] in a part; with 0.2 a cubic is within 4e-6 of a turning path. Parts also end at joints of motions: no cubic
 * follows keyframes across one, and a swap would be sought 0.1 ms beside its time (check_lost, stops 2003). */
enum { LEAST_PARTS = 4 };
static const double steady = 0.2;

/* Samples nearer than this to another are it [s]. */
static const double same_time = 1e-9;

/* -- making and freeing ------------------------------------------------------------------------------------------------ */

/* An upper bound of the largest standard deviation: Frobenius' norm of the factor. */
static float extent_of(const double *geometry) {
    double sum = 0;
    for (int k = 0; k < 9; k++) sum += geometry[TD_G_FACTOR + k] * geometry[TD_G_FACTOR + k];
    return (float)(TD_SWAPS_SIGMAS * sqrt(sum));
}

tides_status td_swaps_create(const td_store *store, int tiles, struct td_swaps **swaps, tides_error *error) {
    struct td_swaps *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->extent = td_alloc((size_t)store->count, sizeof *made->extent, error);
    made->may = td_alloc((size_t)store->count, sizeof *made->may, error);
    made->group = td_alloc((size_t)store->objects, sizeof *made->group, error);
    made->turning = td_alloc((size_t)store->objects, sizeof *made->turning, error);
    made->turned = td_alloc((size_t)store->objects, sizeof *made->turned, error);
    made->first = td_alloc((size_t)tiles * TD_TILE_BLOCKS + 1, sizeof *made->first, error);
    made->mover = td_alloc((size_t)store->count, sizeof *made->mover, error);
    if (!made->mover || !made->extent || !made->may || !made->group || !made->turning || !made->turned || !made->first) {
        td_swaps_destroy(made);
        return TIDES_NO_MEMORY;
    }
    for (int i = 0; i < store->count; i++) made->extent[i] = extent_of(store->geometry + (size_t)i * TD_GEOMETRY_STRIDE);
    *swaps = made;
    return TIDES_OK;
}

void td_swaps_destroy(struct td_swaps *swaps) {
    if (!swaps) return;
    free(swaps->extent);
    free(swaps->may);
    free(swaps->group);
    free(swaps->turning);
    free(swaps->turned);
    free(swaps->view);
    free(swaps->first);
    free(swaps->swap);
    for (size_t k = 0; k < swaps->portions; k++) {
        free(swaps->portion[k].swap);
        free(swaps->portion[k].splat);
        free(swaps->portion[k].order);
        free(swaps->portion[k].depth);
        free(swaps->portion[k].taken);
    }
    free(swaps->portion);
    free(swaps->mover);
    free(swaps->move);
    free(swaps->shape);
    free(swaps->rests);
    free(swaps->joint);
    free(swaps);
}

/* -- bodies ---------------------------------------------------------------------------------------------------------------- */

/* Finds bodies: all objects at rest are one body, and each other object is a body of its own. */
static tides_status find_groups(const tides_renderer *renderer, struct td_swaps *swaps, tides_error *error) {
    for (int i = 0; i < renderer->store.objects; i++) {
        tides_object object;
        tides_status status = tides_scene_object(renderer->scene, renderer->store.scene_object[i], &object, error);
        if (status != TIDES_OK) return status;
        swaps->group[i] = renderer->store.mover[i] >= 0 ? -1 : td_object_travels(&object) ? i + 1 : 0;
    }
    return TIDES_OK;
}

/* Cuts the interval into so many even parts, and at the joints of motions if there is room for all of these. */
static void lay_parts(const tides_renderer *renderer, const struct td_swaps *swaps, int joints, int even, td_swap_samples *at) {
    const double start = renderer->sweep.interval[0], stop = renderer->sweep.interval[1];
    int count = 0, kept = 1;
    for (int k = 0; k < even; k++) at->time[count++] = start + (stop - start) * k / even;
    for (int k = 0; k < joints && even + joints <= TD_SWAP_PARTS_MOST; k++) at->time[count++] = swaps->joint[k];
    qsort(at->time, (size_t)count, sizeof *at->time, td_ascending);
    for (int k = 1; k < count; k++)
        if (at->time[k] > at->time[kept - 1] + same_time) at->time[kept++] = at->time[k];
    at->time[kept] = stop;
    at->parts = kept;
}

/* Computes views at the ends of parts: renderer->scratch.views. */
static tides_status find_views(tides_renderer *renderer, const tides_trajectory *camera, const struct td_swaps *swaps,
                               int joints, int even, td_swap_samples *at, tides_error *error) {
    lay_parts(renderer, swaps, joints, even, at);
    return td_renderer_views(renderer, camera, at->time, at->parts + 1, error);
}

/* Largest turn within a part, of a view's row that gives depths. */
static double most_turned(const tides_renderer *renderer, int parts) {
    const size_t objects = (size_t)renderer->store.objects;
    double most = 0;
    for (size_t i = 0; i < (size_t)parts * objects; i++) {
        const double *from = renderer->scratch.views[i].r + 6, *to = renderer->scratch.views[i + objects].r + 6;
        most = td_greater(most, td_swaps_apart(from, to) / td_length3(from));
    }
    return most;
}

/* Computes views at the ends of parts, with so many parts that no view turns much in one. */
static tides_status take_views(tides_renderer *renderer, const tides_trajectory *camera, struct td_swaps *swaps,
                               td_swap_samples *at, tides_error *error) {
    const double *swept = renderer->sweep.interval;
    int joints = 0, even = LEAST_PARTS;
    tides_status status = td_dynamic_joints(&renderer->dynamic, swept[0] + same_time, swept[1] - same_time, &swaps->joint,
                                            &joints, &swaps->joint_capacity, error);
    if (even + joints > TD_SWAP_PARTS_MOST) even = TD_SWAP_PARTS_MOST;
    if (status == TIDES_OK) status = find_views(renderer, camera, swaps, joints, even, at, error);
    while (status == TIDES_OK && even < TD_SWAP_PARTS_MOST && most_turned(renderer, at->parts) > steady) {
        even *= 2;
        status = find_views(renderer, camera, swaps, joints, even, at, error);
    }
    const size_t count = ((size_t)at->parts + 1) * (size_t)renderer->store.objects;
    if (status == TIDES_OK)
        status = td_reserve((void **)&swaps->view, &swaps->view_capacity, count, sizeof *swaps->view, error);
    if (status != TIDES_OK) return status;
    memcpy(swaps->view, renderer->scratch.views, count * sizeof *swaps->view);
    at->objects = renderer->store.objects;
    at->view = swaps->view;
    return status;
}

/* How far the row that gives depths deviates from a straight line. */
static double turning_of(const td_swap_samples *at, int object) {
    const double *from = at->view[object].r + 6, *to = at->view[(size_t)at->parts * (size_t)at->objects + (size_t)object].r + 6;
    double most = 0;
    for (int k = 1; k < at->parts; k++) {
        const double *own = at->view[(size_t)k * (size_t)at->objects + (size_t)object].r + 6;
        const double u = (at->time[k] - at->time[0]) / td_swaps_span(at);
        const double straight[3] = {from[0] + u * (to[0] - from[0]), from[1] + u * (to[1] - from[1]),
                                    from[2] + u * (to[2] - from[2])};
        most = td_greater(most, td_swaps_apart(own, straight));
    }
    return most;
}

/* How far that row would go in the interval at its largest rate. */
static double turned_by(const td_swap_samples *at, int object) {
    double most = 0;
    for (int k = 0; k <= at->parts; k++)
        most = td_greater(most, td_length3(at->view[(size_t)k * (size_t)at->objects + (size_t)object].r_dot + 6));
    return most * td_swaps_span(at);
}

/* Facts that the pool's threads share while they look at all Gaussians. */
typedef struct looking {
    const tides_renderer *renderer;
    struct td_swaps *swaps;
    const td_swap_samples *at;
    int alone; /* 1: there is one body */
    int portions;
    uint8_t may[TD_POOL_PORTIONS], fade[TD_POOL_PORTIONS]; /* 1 if some of the portion's Gaussians may swap; fade */
} looking;

/* Finds how a Gaussian may swap. */
static uint8_t who_may(const looking *all, int g) {
    const td_store *store = &all->renderer->store;
    const struct td_swaps *swaps = all->swaps;
    const double share = 0.5 * TD_SWAP_REACH * all->renderer->image.soft_depth; /* of two splats alike */
    const int object = store->object[g];
    const float *box = all->renderer->sweep.boxes + 4 * (size_t)g;
    if (swaps->mover[g] >= 0) return TD_MAY_SWAP;
    if (swaps->group[object] < 0 || !(box[0] <= box[2]) || (all->alone && !(swaps->turning[object] > 0))) return TD_MAY_NOT;
    const double z = td_swaps_depth(&all->at->view[object], store->geometry + (size_t)g * TD_GEOMETRY_STRIDE + TD_G_MEAN);
    if (swaps->turning[object] * (double)swaps->extent[g] >= share * fabs(z)) return TD_MAY_ALONE;
    const double sway = swaps->turned[object] * td_swaps_reach(all->renderer, swaps, g, z), least = share * fabs(z);
    if (sway * TD_SWAP_SLOW_WITHIN >= least) return TD_MAY_SHORTLY;
    return sway * TD_SWAP_SLOW >= least ? TD_MAY_SLOWLY : TD_MAY_SWAP;
}

static void look_at_some(void *user, int portion) {
    looking *all = user;
    const int count = all->renderer->store.count, first = td_pool_begin(count, all->portions, portion),
              end = td_pool_begin(count, all->portions, portion + 1);
    for (int g = first; g < end; g++) {
        const uint8_t may = all->swaps->may[g] = who_may(all, g), least = all->alone ? TD_MAY_SLOWLY : TD_MAY_SWAP;
        all->may[portion] |= may >= least && td_swaps_is_of_body(all->swaps, all->renderer->store.object[g], g);
    }
    all->fade[portion] = (uint8_t)td_swaps_some_fade(all->renderer, all->swaps, all->at, first, end);
}

/* Finds which Gaussians may swap, and whether any may or fades. Splats that keep their places, though a motion model changes
 * their light, belong to a body if that doesn't turn. */
static void find_who_may(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at) {
    enum { FEWEST = 4096 };
    const td_store *store = &renderer->store;
    int moving = 0, rests = 0, own_way = swaps->moves - swaps->rest;
    for (int i = 0; i < store->objects; i++) {
        swaps->turning[i] = swaps->group[i] >= 0 ? turning_of(at, i) : 0;
        swaps->turned[i] = swaps->group[i] >= 0 ? turned_by(at, i) : 0;
        if (store->mover[i] >= 0 && swaps->turned[i] > 0) swaps->group[i] = -1, own_way = swaps->moves;
        moving += swaps->group[i] > 0;
        rests += swaps->group[i] == 0;
    }
    moving += 2 * (own_way > 0);
    looking all = {renderer, swaps, at, moving + (rests > 0) < 2, td_pool_portions(renderer->pool, store->count, FEWEST),
                   {0},      {0}};
    td_pool_run(renderer->pool, all.portions, look_at_some, &all);
    swaps->some_may = own_way > 1;
    swaps->some_fade = 0;
    for (int k = 0; k < all.portions; k++) {
        swaps->some_may |= all.may[k];
        swaps->some_fade |= all.fade[k];
    }
}

/* -- the search ------------------------------------------------------------------------------------------------------------ */

static int by_place(const void *a, const void *b) {
    const td_swap *x = a, *y = b;
    if (x->block != y->block) return x->block < y->block ? -1 : 1;
    if (x->part != y->part) return x->part < y->part ? -1 : 1;
    if (x->light != y->light) return x->light > y->light ? -1 : 1;
    /* equal entries are interchangeable, so qsort may put them in any order */
    return x->wide > y->wide ? -1 : x->wide < y->wide;
}

/* Data that the threads of the pool share. */
typedef struct searching {
    const tides_renderer *renderer;
    struct td_swaps *swaps;
    const td_swap_samples *at;
    int portions;
} searching;

/* Searches portion k of the tiles, and sorts its swaps by block and time. */
static void search(void *user, int k) {
    const searching *all = user;
    const int tiles = all->renderer->stats.tiles, end = td_pool_begin(tiles, all->portions, k + 1);
    td_swap_portion *portion = &all->swaps->portion[k];
    portion->count = 0;
    portion->tiles_cut = 0;
    portion->status = TIDES_OK;
    for (int tile = td_pool_begin(tiles, all->portions, k); tile < end && portion->status == TIDES_OK; tile++)
        if (all->renderer->candidates.moving[tile])
            portion->status = td_swaps_look_in(all->renderer, all->swaps, all->at, tile, portion);
    if (portion->count > 0) qsort(portion->swap, portion->count, sizeof *portion->swap, by_place);
}

static tides_status reserve_portions(struct td_swaps *swaps, int portions, tides_error *error) {
    const size_t before = swaps->portions;
    const tides_status status =
        td_reserve((void **)&swaps->portion, &swaps->portions, (size_t)portions, sizeof *swaps->portion, error);
    if (swaps->portions > before) memset(swaps->portion + before, 0, (swaps->portions - before) * sizeof *swaps->portion);
    return status;
}

/* Joins the portions' swaps: sorted by block and time, since portions have tiles of their own in order. */
static tides_status join(struct td_swaps *swaps, int portions, tides_error *error) {
    size_t count = 0;
    for (int k = 0; k < portions; k++) {
        const td_swap_portion *portion = &swaps->portion[k];
        count += portion->count;
        swaps->tiles_cut += portion->tiles_cut;
        if (portion->status == TIDES_OK) continue;
        if (error) *error = portion->error;
        return portion->status;
    }
    if (count > INT32_MAX) return td_fail(error, TIDES_NO_MEMORY, "swaps of depth: too many in one step; use shorter steps");
    const tides_status status = td_renew((void **)&swaps->swap, &swaps->swap_capacity, count, sizeof *swaps->swap, error);
    for (int k = 0; k < portions && status == TIDES_OK; k++) {
        const td_swap_portion *portion = &swaps->portion[k];
        if (portion->count > 0) memcpy(swaps->swap + swaps->count, portion->swap, portion->count * sizeof *swaps->swap);
        swaps->count += portion->count;
    }
    return status;
}

/* Notes where each block's swaps begin. */
static void lay_swaps(const tides_renderer *renderer, struct td_swaps *swaps) {
    const size_t blocks = (size_t)renderer->stats.tiles * TD_TILE_BLOCKS;
    size_t i = 0;
    if (swaps->count == 0) return;
    for (size_t b = 0; b <= blocks; b++) {
        while (i < swaps->count && (size_t)swaps->swap[i].block < b) i++;
        swaps->first[b] = (int32_t)i;
    }
}

/* Fewest tiles that are worth a thread of their own. */
enum { FEWEST_TILES = 4 };

/* Searches all tiles, in portions that the pool's threads share. */
static tides_status search_tiles(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at,
                                 tides_error *error) {
    searching all = {renderer, swaps, at, td_pool_portions(renderer->pool, renderer->stats.tiles, FEWEST_TILES)};
    tides_status status = reserve_portions(swaps, all.portions, error);
    if (status != TIDES_OK) return status;
    td_pool_run(renderer->pool, all.portions, search, &all);
    status = join(swaps, all.portions, error);
    if (status == TIDES_OK) lay_swaps(renderer, swaps);
    return status;
}

tides_status td_renderer_find_swaps(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error) {
    tides_status status = TIDES_OK;
    td_swap_samples at;
    if (!renderer->image.soft_order) return status;
    if (!renderer->sweep.swaps)
        status = td_swaps_create(&renderer->store, renderer->stats.tiles, &renderer->sweep.swaps, error);
    if (status != TIDES_OK) return status;
    struct td_swaps *swaps = renderer->sweep.swaps;
    status = find_groups(renderer, swaps, error);
    if (status == TIDES_OK) status = take_views(renderer, camera, swaps, &at, error);
    if (status != TIDES_OK) return status;
    swaps->count = 0;
    swaps->tiles_cut = 0;
    status = td_swaps_move(renderer, swaps, &at, error);
    if (status != TIDES_OK) return status;
    find_who_may(renderer, swaps, &at);
    return swaps->some_may || swaps->some_fade ? search_tiles(renderer, swaps, &at, error) : TIDES_OK;
}

int td_renderer_swaps_cut(const tides_renderer *renderer) {
    return renderer->sweep.swaps ? renderer->sweep.swaps->tiles_cut : 0;
}

const td_swap *td_renderer_swaps(const tides_renderer *renderer, int tile, int block, int *count) {
    const struct td_swaps *swaps = renderer->sweep.swaps;
    *count = 0;
    if (!swaps || swaps->count == 0) return NULL;
    const int32_t *first = swaps->first + tile * TD_TILE_BLOCKS + block;
    *count = first[1] - first[0];
    return swaps->swap + first[0];
}
