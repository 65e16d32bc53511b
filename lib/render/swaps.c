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

/* Pairs checked per tile, between bodies and within them: 10 ms of processor time each. Where a tile has more, its fainter
 * splats aren't searched, and the tile is counted (td_renderer_swaps_cut). */
enum { MOST_PAIRS = 1 << 20 };

/* Two splats that overlap in the image at equal depth have centres at most the sum of their extents apart, times this factor
 * off the axis. */
static const double askew = 1.5;

/* Allowance for splats whose colour depends on the view: their light may differ by this share beside the constant terms. */
static const double by_view = 0.1;

/* Splats of a tile in which slow swaps within a body, and of splats that motion models move, are searched too. In denser tiles
 * the search would take 20 % of the demo's time, and each splat counts for less. */
enum { FEW_SPLATS = 128 };

/* Possible partners of a splat in a swap. MAY_SWAP: only splats of other bodies; MAY_SLOWLY: in tiles with few splats also of
 * its own body; MAY_SHORTLY: also of its own body, if the swap is short; MAY_ALONE: also of its own body. */
enum { MAY_NOT, MAY_SWAP, MAY_SLOWLY, MAY_SHORTLY, MAY_ALONE };

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
    free(swaps->splat);
    free(swaps->depth);
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
        const double sway = swaps->turned[object] * reach_of(renderer, swaps, g, z), least = share * fabs(z);
        const int turns = sway * TD_SWAP_SLOW_WITHIN >= least ? MAY_SHORTLY
                          : sway * TD_SWAP_SLOW >= least      ? MAY_SLOWLY
                                                              : MAY_SWAP;
        swaps->may[g] = (uint8_t)(strays_far ? MAY_ALONE : turns);
        any |= swaps->may[g] > MAY_SWAP || !alone;
    }
    return any;
}

/* -- a tile ---------------------------------------------------------------------------------------------------------------- */

static int by_depth(const void *a, const void *b) {
    const td_swap_splat *x = a, *y = b;
    if (x->least != y->least) return x->least < y->least ? -1 : 1;
    return (x->box > y->box) - (x->box < y->box);
}

/* Sorts by body, and within a body by depth at the start. */
static int by_start(const void *a, const void *b) {
    const td_swap_splat *x = a, *y = b;
    if (x->group != y->group) return x->group < y->group ? -1 : 1;
    if (x->z[0] != y->z[0]) return x->z[0] < y->z[0] ? -1 : 1;
    return (x->box > y->box) - (x->box < y->box);
}

/* Sorts the most opaque ones first. */
static int by_opacity(const void *a, const void *b) {
    const td_swap_splat *x = a, *y = b;
    if (x->opacity != y->opacity) return x->opacity > y->opacity ? -1 : 1;
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

/* The least `may` of splats that are searched for swaps within their bodies, in a tile with so many splats. */
static int least_within(int splats) { return splats <= FEW_SPLATS ? MAY_SLOWLY : MAY_SHORTLY; }

/* Takes the splats of a tile's list that may swap. Takes none if all are of one body within which no swap is possible. */
static tides_status take_splats(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at, int tile,
                                int *count, int *bodies, int *within, tides_error *error) {
    const int *first = renderer->candidates.first, *list = renderer->candidates.list;
    int group = 0, some = 0, most = MAY_NOT;
    *count = *bodies = *within = 0;
    for (int i = first[tile]; i < first[tile + 1]; i++) {
        const int g = list[i];
        if (g < 0 || swaps->may[g] == MAY_NOT) continue;
        const int own = group_of(renderer, swaps, g);
        if (swaps->may[g] > most) most = swaps->may[g];
        *bodies |= some > 0 && own != group;
        group = own;
        some++;
    }
    *within = most >= least_within(some);
    if (!*within && !*bodies) return TIDES_OK;
    tides_status status = td_reserve((void **)&swaps->splat, &swaps->splat_capacity, (size_t)some, sizeof *swaps->splat, error);
    const size_t each = 2 * ((size_t)at->parts + 1);
    if (status == TIDES_OK)
        status = td_reserve((void **)&swaps->depth, &swaps->depth_capacity, (size_t)some * each, sizeof *swaps->depth, error);
    for (int i = first[tile]; i < first[tile + 1] && status == TIDES_OK; i++) {
        if (list[i] < 0 || swaps->may[list[i]] == MAY_NOT) continue;
        take_splat(renderer, swaps, at, list[i], swaps->depth + (size_t)*count * each, &swaps->splat[*count]);
        ++*count;
    }
    return status;
}

/* -------------------------------------------------------------------------------------------------------------------------- */

/* The longest swap within a body, or of a splat that a motion model moves, that is searched in a tile with so many splats. */
static double slow_in(int splats) { return splats <= FEW_SPLATS ? TD_SWAP_SLOW : TD_SWAP_SLOW_WITHIN; }

/* Checks pairs of splats of different bodies. */
static void look_across(td_swap_tile *of, const td_swap_splat *all, int count, double near) {
    int pairs = 0;
    for (int i = 0; i < count && of->status == TIDES_OK; i++) {
        const td_swap_splat *a = &all[i];
        const double far = a->most + near * fabs(a->most);
        for (int j = i + 1; j < count && all[j].least <= far && pairs < MOST_PAIRS; j++, pairs++)
            if (a->group != all[j].group)
                td_swaps_look_at(of, a, &all[j], a->move || all[j].move ? slow_in(count) : TD_SWAP_SLOW);
    }
    of->is_full = pairs == MOST_PAIRS;
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
static void look_within(td_swap_tile *of, const td_swap_splat *all, int count, double near) {
    int pairs = 0;
    for (int i = 0; i < count && of->status == TIDES_OK; i++) {
        const td_swap_splat *a = &all[i];
        if (a->may < least_within(count)) continue;
        const double reach = 2 * a->sway + near * fabs(a->z[0]);
        for (int side = -1; side <= 1; side += 2)
            for (int j = i + side; j >= 0 && j < count && pairs < MOST_PAIRS; j += side, pairs++) {
                const td_swap_splat *b = &all[j];
                if (b->group != a->group || fabs(b->z[0] - a->z[0]) > reach) break;
                if (b->may >= least_within(count) && (b->sway > a->sway || (b->sway == a->sway && j < i))) continue;
                const double slow = a->may == MAY_ALONE || b->may == MAY_ALONE ? TD_SWAP_SLOW : slow_in(count);
                if (!is_none(of, a, b, near, slow)) td_swaps_look_at(of, a, b, slow);
            }
    }
    of->is_full = pairs == MOST_PAIRS;
}

/* Checks all pairs of a kind. Where they are too many, it begins again without the fainter half of the splats. */
static void look_at_all(td_swap_tile *of, td_swap_splat *all, int count, int (*order)(const void *, const void *),
                        void (*look)(td_swap_tile *, const td_swap_splat *, int, double), double near) {
    const size_t before = of->swaps->count;
    for (;; count /= 2) {
        qsort(all, (size_t)count, sizeof *all, order);
        look(of, all, count, near);
        if (!of->is_full || of->status != TIDES_OK) return;
        of->is_cut = 1;
        of->swaps->count = before;
        qsort(all, (size_t)count, sizeof *all, by_opacity);
    }
}

/* Looks at the splats of a tile that fade, if it has few splats. */
static tides_status look_at_fades(const tides_renderer *renderer, struct td_swaps *swaps, td_swap_tile *of) {
    const int *first = renderer->candidates.first + of->tile, *list = renderer->candidates.list;
    const size_t each = 2 * ((size_t)of->at->parts + 1);
    if (first[1] - first[0] > FEW_SPLATS) return TIDES_OK;
    of->status = td_reserve((void **)&swaps->depth, &swaps->depth_capacity, each, sizeof *swaps->depth, of->error);
    for (int i = first[0]; i < first[1] && of->status == TIDES_OK; i++) {
        td_swap_splat one;
        if (list[i] < 0 || swaps->mover[list[i]] >= 0 || !td_swaps_is_fading(renderer, of->at, list[i])) continue;
        take_splat(renderer, swaps, of->at, list[i], swaps->depth, &one);
        td_swaps_look_at_fade(of, &one);
    }
    return of->status;
}

static td_swap_tile tile_of(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at, int tile,
                            tides_error *error) {
    const int across = renderer->candidates.tiles_x;
    return (td_swap_tile){.swaps = swaps,
                          .image = &renderer->image,
                          .at = at,
                          .tile = tile,
                          .corner = {tile % across * TD_TILE, tile / across * TD_TILE},
                          .contrast = renderer->store.sh_stride > 3 ? by_view : 0,
                          .status = TIDES_OK,
                          .error = error};
}

static tides_status look_in(const tides_renderer *renderer, struct td_swaps *swaps, td_swap_tile *of) {
    const double near = TD_SWAP_REACH * renderer->image.soft_depth;
    int count, bodies, within;
    of->status = take_splats(renderer, swaps, of->at, of->tile, &count, &bodies, &within, of->error);
    if (count == 0 || of->status != TIDES_OK) return of->status;
    if (bodies) look_at_all(of, swaps->splat, count, by_depth, look_across, near);
    if (within) look_at_all(of, swaps->splat, count, by_start, look_within, near);
    return of->status;
}

static int by_place(const void *a, const void *b) {
    const td_swap *x = a, *y = b;
    if (x->block != y->block) return x->block < y->block ? -1 : 1;
    if (x->part != y->part) return x->part < y->part ? -1 : 1;
    if (x->light != y->light) return x->light > y->light ? -1 : 1;
    /* equal entries are interchangeable, so qsort may put them in any order */
    return x->wide > y->wide ? -1 : x->wide < y->wide;
}

/* Sorts the swaps by block and time. */
static tides_status lay_swaps(const tides_renderer *renderer, struct td_swaps *swaps, tides_error *error) {
    const size_t blocks = (size_t)renderer->stats.tiles * TD_TILE_BLOCKS;
    if (swaps->count == 0) return TIDES_OK;
    if (swaps->count > INT32_MAX)
        return td_fail(error, TIDES_NO_MEMORY, "swaps of depth: too many in one step; use shorter steps");
    qsort(swaps->swap, swaps->count, sizeof *swaps->swap, by_place);
    size_t i = 0;
    for (size_t b = 0; b <= blocks; b++) {
        while (i < swaps->count && (size_t)swaps->swap[i].block < b) i++;
        swaps->first[b] = (int32_t)i;
    }
    return TIDES_OK;
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
    const int may = find_who_may(renderer, swaps, &at), fade = td_swaps_some_fade(renderer, swaps, &at);
    for (int tile = 0; tile < renderer->stats.tiles && status == TIDES_OK && (may || fade); tile++) {
        if (!renderer->candidates.moving[tile]) continue;
        td_swap_tile of = tile_of(renderer, swaps, &at, tile, error);
        if (may) status = look_in(renderer, swaps, &of);
        if (fade && status == TIDES_OK) status = look_at_fades(renderer, swaps, &of);
        swaps->tiles_cut += of.is_cut;
    }
    return status == TIDES_OK ? lay_swaps(renderer, swaps, error) : status;
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
