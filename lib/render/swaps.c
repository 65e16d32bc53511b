/* Swaps of depth: finds which splats of a tile come within reach of each other's depth in the interval swept last, and when.
 * It works on the host, in double, from views at a few samples and the cubics between them.
 *
 * Most scenes have none that samples could miss. A swap of two splats of one rigid body that is seen to turn lasts long where
 * the turn is slow and the splats are small: what takes more than a share of the interval shows in its samples. One that is
 * shorter needs splats so large that the turn takes their depths past each other fast, and one that comes back within the
 * interval needs depths that stray by the reach from going straight. Splats of different bodies are looked at wherever their
 * depths meet. A splat that a motion model moves is a body of its own (swap_movers.c). */
#include "camera/td_rotation.h"
#include "scene/td_scene.h"
#include "td_extremes.h"
#include "td_math.h"
#include "td_swaps.h"

#include <math.h>
#include <stdlib.h>

/* Parts of the interval at whose ends depths are computed: 4 to 64. There are more if a view turns by more than `steady`
 * [rad] in a part; with 0.2 a cubic is within 4e-6 of a turning path. */
enum { LEAST_PARTS = 4, MOST_PARTS = 64 };
static const double steady = 0.2;

/* Extent of a splat in standard deviations of its ellipsoid: there, a splat of opacity 1 has alpha 1/255. */
static const double sigmas = 3.4;

/* Pairs checked per tile, between bodies and within them: 10 ms of processor time each. Further pairs of a denser tile aren't
 * searched, and such tiles are counted (td_renderer_swaps_cut). */
enum { MOST_PAIRS = 1 << 20 };

/* Two splats that overlap in the image at equal depth have centres at most the sum of their extents apart, times this factor
 * off the axis. */
static const double askew = 1.5;

/* Allowance for splats whose colour depends on the view: their light may differ by this share beside the constant terms. */
static const double by_view = 0.1;

/* Possible partners of a splat in a swap. MAY_SWAP: only splats of other bodies; MAY_SHORTLY: also of its own body, if the
 * swap is short; MAY_ALONE: also of its own body. */
enum { MAY_NOT, MAY_SWAP, MAY_SHORTLY, MAY_ALONE };

/* -- making and freeing ------------------------------------------------------------------------------------------------ */

/* An upper bound of the largest standard deviation: Frobenius' norm of the factor. */
static float extent_of(const double *geometry) {
    double sum = 0;
    for (int k = 0; k < 9; k++) sum += geometry[TD_G_FACTOR + k] * geometry[TD_G_FACTOR + k];
    return (float)(sigmas * sqrt(sum));
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
    }
    free(swaps->portion);
    free(swaps->mover);
    free(swaps->move);
    free(swaps->shape);
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

/* Distance between two rows of views. */
static double apart(const double *a, const double *b) {
    const double way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return td_length3(way);
}

/* Computes views at the ends of `parts` parts of the interval: renderer->views. */
static tides_status find_views(tides_renderer *renderer, const tides_trajectory *camera, int parts, tides_error *error) {
    const double start = renderer->sweep.interval[0], stop = renderer->sweep.interval[1];
    double time[MOST_PARTS + 1];
    for (int k = 0; k < parts; k++) time[k] = start + (stop - start) * k / parts;
    time[parts] = stop;
    return td_renderer_views(renderer, camera, time, parts + 1, error);
}

/* Largest turn within a part, of a view's row that gives depths. */
static double most_turned(const tides_renderer *renderer, int parts) {
    const size_t objects = (size_t)renderer->store.objects;
    double most = 0;
    for (size_t i = 0; i < (size_t)parts * objects; i++) {
        const double *from = renderer->scratch.views[i].r + 6, *to = renderer->scratch.views[i + objects].r + 6;
        most = td_greater(most, apart(from, to) / td_length3(from));
    }
    return most;
}

/* Computes views at the ends of parts, with so many parts that no view turns much in one. */
static tides_status take_views(tides_renderer *renderer, const tides_trajectory *camera, struct td_swaps *swaps,
                               td_swap_samples *at, tides_error *error) {
    int parts = LEAST_PARTS;
    tides_status status = find_views(renderer, camera, parts, error);
    while (status == TIDES_OK && parts < MOST_PARTS && most_turned(renderer, parts) > steady) {
        parts *= 2;
        status = find_views(renderer, camera, parts, error);
    }
    const size_t count = ((size_t)parts + 1) * (size_t)renderer->store.objects;
    if (status == TIDES_OK)
        status = td_reserve((void **)&swaps->view, &swaps->view_capacity, count, sizeof *swaps->view, error);
    if (status != TIDES_OK) return status;
    memcpy(swaps->view, renderer->scratch.views, count * sizeof *swaps->view);
    *at = (td_swap_samples){parts, renderer->store.objects, (renderer->sweep.interval[1] - renderer->sweep.interval[0]) / parts,
                            swaps->view};
    return status;
}

/* How far the row that gives depths deviates from a straight line. */
static double turning_of(const td_swap_samples *at, int object) {
    const double *from = at->view[object].r + 6, *to = at->view[(size_t)at->parts * (size_t)at->objects + (size_t)object].r + 6;
    double most = 0;
    for (int k = 1; k < at->parts; k++) {
        const double *own = at->view[(size_t)k * (size_t)at->objects + (size_t)object].r + 6, u = (double)k / at->parts;
        const double straight[3] = {from[0] + u * (to[0] - from[0]), from[1] + u * (to[1] - from[1]),
                                    from[2] + u * (to[2] - from[2])};
        most = td_greater(most, apart(own, straight));
    }
    return most;
}

/* How far that row would go in the interval at its largest rate. */
static double turned_by(const td_swap_samples *at, int object) {
    double most = 0;
    for (int k = 0; k <= at->parts; k++)
        most = td_greater(most, td_length3(at->view[(size_t)k * (size_t)at->objects + (size_t)object].r_dot + 6));
    return most * at->h * at->parts;
}

static double depth_at(const td_view *view, const double *mean) {
    return view->r[6] * mean[0] + view->r[7] * mean[1] + view->r[8] * mean[2] + view->t[2];
}

static double depth_rate_at(const td_view *view, const double *mean) {
    return view->r_dot[6] * mean[0] + view->r_dot[7] * mean[1] + view->r_dot[8] * mean[2] + view->t_dot[2];
}

/* Half the distance, in its object's units, between a splat at depth z and a splat that shares a pixel with it at that
 * depth. */
static double reach_of(const tides_renderer *renderer, const struct td_swaps *swaps, int g, double z) {
    const td_image *image = &renderer->image;
    return askew * ((double)swaps->extent[g] + sigmas * sqrt(image->dilation) * fabs(z) / image->fx);
}

/* Finds which Gaussians may swap; returns 1 if any may. */
static int find_who_may(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at) {
    const td_store *store = &renderer->store;
    const double share = 0.5 * TD_SWAP_REACH * renderer->image.soft_depth; /* of two splats alike */
    int moving = 2 * (swaps->moves > 0), rests = 0, any = swaps->moves > 1;
    for (int i = 0; i < store->objects; i++) {
        swaps->turning[i] = swaps->group[i] >= 0 ? turning_of(at, i) : 0;
        swaps->turned[i] = swaps->group[i] >= 0 ? turned_by(at, i) : 0;
        moving += swaps->group[i] > 0;
        rests += swaps->group[i] == 0;
    }
    const int alone = moving + (rests > 0) < 2;
    for (int g = 0; g < store->count; g++) {
        const int object = store->object[g];
        const float *box = renderer->sweep.boxes + 4 * (size_t)g;
        swaps->may[g] = swaps->mover[g] >= 0 ? MAY_SWAP : MAY_NOT;
        if (swaps->group[object] < 0 || !(box[0] <= box[2])) continue;
        if (alone && !(swaps->turning[object] > 0)) continue;
        const double z = depth_at(&at->view[object], store->geometry + (size_t)g * TD_GEOMETRY_STRIDE + TD_G_MEAN);
        const int strays_far = swaps->turning[object] * (double)swaps->extent[g] >= share * fabs(z);
        const int is_short = TD_SWAP_SLOW_WITHIN * swaps->turned[object] * reach_of(renderer, swaps, g, z) >= share * fabs(z);
        swaps->may[g] = (uint8_t)(strays_far ? MAY_ALONE : is_short ? MAY_SHORTLY : MAY_SWAP);
        any |= strays_far || is_short || !alone;
    }
    return any;
}

/* -- a tile ---------------------------------------------------------------------------------------------------------------- */

static int by_depth(const void *a, const void *b) {
    const td_swap_splat *x = *(const td_swap_splat *const *)a, *y = *(const td_swap_splat *const *)b;
    if (x->least != y->least) return x->least < y->least ? -1 : 1;
    return (x->box > y->box) - (x->box < y->box);
}

/* Sorts by body, and within a body by depth at the start. */
static int by_start(const void *a, const void *b) {
    const td_swap_splat *x = *(const td_swap_splat *const *)a, *y = *(const td_swap_splat *const *)b;
    if (x->group != y->group) return x->group < y->group ? -1 : 1;
    if (x->z[0] != y->z[0]) return x->z[0] < y->z[0] ? -1 : 1;
    return (x->box > y->box) - (x->box < y->box);
}

static double luminance_of(const tides_renderer *renderer, int g) {
    const td_store *store = &renderer->store;
    const size_t at = (size_t)g * (size_t)store->sh_stride;
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        const double own = store->sh ? (double)store->sh[at + (size_t)c] : store->sh_wide[at + (size_t)c];
        sum += renderer->image.luminance[c] * td_greater(td_splat_colour(own), 0);
    }
    return sum;
}

/* The body of a splat: one that a motion model moves is one by itself. */
static int group_of(const tides_renderer *renderer, const struct td_swaps *swaps, int g) {
    return swaps->mover[g] >= 0 ? -1 - g : swaps->group[renderer->store.object[g]];
}

static void take_splat(const tides_renderer *renderer, const struct td_swaps *swaps, const td_swap_samples *at, int g,
                       double *z, td_swap_splat *to) {
    const int object = renderer->store.object[g], mover = swaps->mover[g];
    const double *geometry = mover < 0 ? renderer->store.geometry + (size_t)g * TD_GEOMETRY_STRIDE
                                       : swaps->shape + (size_t)mover * TD_GEOMETRY_STRIDE;
    to->move = mover < 0 ? NULL : swaps->move + (size_t)mover * (size_t)(at->parts + 1);
    to->box = renderer->sweep.boxes + 4 * (size_t)g;
    to->geometry = geometry;
    to->opacity = geometry[TD_G_OPACITY];
    to->luminance = luminance_of(renderer, g);
    to->object = object;
    to->group = group_of(renderer, swaps, g);
    to->may = swaps->may[g];
    double *z_dot = z + at->parts + 1;
    to->least = INFINITY;
    to->most = -INFINITY;
    for (int k = 0; k <= at->parts; k++) {
        const td_view *view = &at->view[(size_t)k * (size_t)at->objects + (size_t)object];
        const double *mean = to->move ? to->move[k].mean : geometry + TD_G_MEAN;
        z[k] = depth_at(view, mean);
        z_dot[k] = depth_rate_at(view, mean);
        if (to->move) z_dot[k] += td_dot3(view->r + 6, to->move[k].rate);
        const double bow = at->h / 3 * fabs(z_dot[k]);
        to->least = td_lesser(to->least, z[k] - bow);
        to->most = td_greater(to->most, z[k] + bow);
    }
    to->sway = mover < 0 ? swaps->turned[object] * reach_of(renderer, swaps, g, z[0]) : 0;
    to->z = z;
    to->z_dot = z_dot;
}

/* Takes the splats of a tile's list that may swap. Takes none if all are of one body within which no swap is possible. */
static tides_status take_splats(const tides_renderer *renderer, td_swap_tile *of, int *count, int *bodies, int *within) {
    const struct td_swaps *swaps = of->swaps;
    td_swap_portion *to = of->portion;
    const int tile = of->tile, *first = renderer->candidates.first, *list = renderer->candidates.list;
    const size_t each = 2 * ((size_t)of->at->parts + 1);
    int group = 0, some = 0;
    *count = *bodies = *within = 0;
    for (int i = first[tile]; i < first[tile + 1]; i++) {
        const int g = list[i];
        if (g < 0 || swaps->may[g] == MAY_NOT) continue;
        const int own = group_of(renderer, swaps, g);
        *within |= swaps->may[g] >= MAY_SHORTLY;
        *bodies |= some > 0 && own != group;
        group = own;
        some++;
    }
    if (!*within && !*bodies) return TIDES_OK;
    tides_status status = td_renew((void **)&to->splat, &to->splat_capacity, (size_t)some, sizeof *to->splat, of->error);
    if (status == TIDES_OK)
        status = td_renew((void **)&to->order, &to->order_capacity, (size_t)some, sizeof *to->order, of->error);
    if (status == TIDES_OK)
        status = td_renew((void **)&to->depth, &to->depth_capacity, (size_t)some * each, sizeof *to->depth, of->error);
    for (int i = first[tile]; i < first[tile + 1] && status == TIDES_OK; i++) {
        if (list[i] < 0 || swaps->may[list[i]] == MAY_NOT) continue;
        take_splat(renderer, swaps, of->at, list[i], to->depth + (size_t)*count * each, &to->splat[*count]);
        to->order[*count] = &to->splat[*count];
        ++*count;
    }
    return status;
}

/* -------------------------------------------------------------------------------------------------------------------------- */

/* Checks pairs of splats of different bodies. */
static void look_across(td_swap_tile *of, const td_swap_splat *const *all, int count, double near) {
    int pairs = 0;
    for (int i = 0; i < count && of->status == TIDES_OK; i++) {
        const td_swap_splat *a = all[i];
        const double far = a->most + near * fabs(a->most);
        for (int j = i + 1; j < count && all[j]->least <= far && pairs < MOST_PAIRS; j++, pairs++)
            if (a->group != all[j]->group)
                td_swaps_look_at(of, a, all[j], a->move || all[j]->move ? TD_SWAP_SLOW_WITHIN : TD_SWAP_SLOW);
    }
    of->is_cut |= pairs == MOST_PAIRS;
}

/* 1 if two splats of one object have no short swap. The difference of their depths deviates from a straight line by at most
 * their distance times the object's deviation per unit. So they are out of reach throughout, or within reach for long. */
static int is_none(const td_swap_tile *of, const td_swap_splat *a, const td_swap_splat *b, double near, double slow) {
    const double from = b->z[0] - a->z[0], to = b->z[of->at->parts] - a->z[of->at->parts];
    const double within = near * td_greater(fabs(a->z[0]), fabs(a->z[of->at->parts]));
    if (a->object != b->object) return 0;
    const double strays = askew * of->swaps->turning[a->object] * apart(a->geometry + TD_G_MEAN, b->geometry + TD_G_MEAN);
    const double most = fabs(to - from) + 4 * strays; /* slope of a parabola at its ends */
    return (from * to > 0 && td_lesser(fabs(from), fabs(to)) > within + strays) || slow * most < within;
}

/* Checks pairs within one body, sorted by by_start: splats that may swap within it, with all that its turn brings within
 * reach. A pair is found from the splat that may move further. */
static void look_within(td_swap_tile *of, const td_swap_splat *const *all, int count, double near) {
    int pairs = 0;
    for (int i = 0; i < count && of->status == TIDES_OK; i++) {
        const td_swap_splat *a = all[i];
        if (a->may < MAY_SHORTLY) continue;
        const double reach = 2 * a->sway + near * fabs(a->z[0]);
        for (int side = -1; side <= 1; side += 2)
            for (int j = i + side; j >= 0 && j < count && pairs < MOST_PAIRS; j += side, pairs++) {
                const td_swap_splat *b = all[j];
                if (b->group != a->group || fabs(b->z[0] - a->z[0]) > reach) break;
                if (b->may >= MAY_SHORTLY && (b->sway > a->sway || (b->sway == a->sway && j < i))) continue;
                const double slow = a->may == MAY_ALONE || b->may == MAY_ALONE ? TD_SWAP_SLOW : TD_SWAP_SLOW_WITHIN;
                if (!is_none(of, a, b, near, slow)) td_swaps_look_at(of, a, b, slow);
            }
    }
    of->is_cut |= pairs == MOST_PAIRS;
}

static tides_status look_in(const tides_renderer *renderer, const struct td_swaps *swaps, const td_swap_samples *at, int tile,
                            td_swap_portion *portion) {
    const double near = TD_SWAP_REACH * renderer->image.soft_depth;
    const int across = renderer->candidates.tiles_x;
    int count, bodies, within;
    td_swap_tile of = {.swaps = swaps,
                       .portion = portion,
                       .image = &renderer->image,
                       .at = at,
                       .tile = tile,
                       .corner = {tile % across * TD_TILE, tile / across * TD_TILE},
                       .contrast = renderer->store.sh_stride > 3 ? by_view : 0,
                       .error = &portion->error};
    of.status = take_splats(renderer, &of, &count, &bodies, &within);
    if (of.status != TIDES_OK || count == 0) return of.status;
    if (bodies) {
        qsort(portion->order, (size_t)count, sizeof *portion->order, by_depth);
        look_across(&of, portion->order, count, near);
    }
    if (within) {
        qsort(portion->order, (size_t)count, sizeof *portion->order, by_start);
        look_within(&of, portion->order, count, near);
    }
    portion->tiles_cut += of.is_cut;
    return of.status;
}

static int by_place(const void *a, const void *b) {
    const td_swap *x = a, *y = b;
    if (x->block != y->block) return x->block < y->block ? -1 : 1;
    if (x->part != y->part) return x->part < y->part ? -1 : 1;
    if (x->light != y->light) return x->light > y->light ? -1 : 1;
    /* equal entries are interchangeable, so qsort may put them in any order */
    return x->wide > y->wide ? -1 : x->wide < y->wide;
}

/* Arguments that the pool's threads share. */
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
            portion->status = look_in(all->renderer, all->swaps, all->at, tile, portion);
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
    if (!find_who_may(renderer, swaps, &at)) return status;
    return search_tiles(renderer, swaps, &at, error);
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
