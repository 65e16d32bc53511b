/* The splats of one tile, for the search of swaps of depth (swaps.c): which of them are looked at, in which pairs, and whether
 * they fade. */
#include "td_extremes.h"
#include "td_math.h"
#include "td_swaps.h"
#include "kernels/record.h"

#include <math.h>
#include <stdlib.h>

/* Pairs checked per tile, between bodies and within them: 10 ms of processor time each. Where a tile has more, its fainter
 * splats aren't searched, and the tile is counted (td_renderer_swaps_cut). */
enum { MOST_PAIRS = 1 << 20 };

/* Allowance for splats whose colour depends on the view: their light may be so much further from that in the interval's middle
 * than it is at the end. */
static const double by_view = 2;

/* SH coefficients of degree 4, the highest. */
enum { SH_MOST = 25 };

/* Splats of a tile in which all slow swaps within a body, and of splats that motion models move, are searched too. In denser
 * tiles the search would take 20 % of the demo's time, and each splat counts for less. */
enum { FEW_SPLATS = 128 };

static double depth_rate_at(const td_view *view, const double *mean) {
    return view->r_dot[6] * mean[0] + view->r_dot[7] * mean[1] + view->r_dot[8] * mean[2] + view->t_dot[2];
}

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

/* Sorts the most opaque ones first. */
static int by_opacity(const void *a, const void *b) {
    const td_swap_splat *x = *(const td_swap_splat *const *)a, *y = *(const td_swap_splat *const *)b;
    if (x->opacity != y->opacity) return x->opacity > y->opacity ? -1 : 1;
    return (x->box > y->box) - (x->box < y->box);
}

/* The luminance of a splat as a view sees it. `sh`: its coefficients, in double. */
static double luminance_in(const tides_renderer *renderer, const td_view *view, const double *mean, const double *sh) {
    const td_sh_source source = {.sh = sh, .floor = 0};
    const double from_eye[3] = {mean[0] - view->eye[0], mean[1] - view->eye[1], mean[2] - view->eye[2]};
    const double per = 1 / td_greater(td_length3(from_eye), TD_SWAP_LEAST_LIGHT);
    const td_colour colour = td_sh_colour(td_dual_make(per * from_eye[0], 0), td_dual_make(per * from_eye[1], 0),
                                          td_dual_make(per * from_eye[2], 0), &source, td_sh_degree(&renderer->image));
    return td_luminance_of(&colour, &renderer->image).v;
}

/* Takes a splat's luminance in the middle of the interval, and how far it is from that at the end. */
static void take_light(const tides_renderer *renderer, const td_swap_samples *at, int g, td_swap_splat *to) {
    const td_store *store = &renderer->store;
    const size_t first = (size_t)g * (size_t)store->sh_stride, objects = (size_t)at->objects;
    const int count = 3 * (td_sh_degree(&renderer->image) + 1) * (td_sh_degree(&renderer->image) + 1);
    const int samples[2] = {at->parts / 2, at->parts};
    double sh[3 * SH_MOST], light[2];
    for (int k = 0; k < count; k++)
        sh[k] = store->sh ? (double)store->sh[first + (size_t)k] : store->sh_wide[first + (size_t)k];
    for (int i = 0; i < (count > 3 ? 2 : 1); i++) {
        const double *mean = to->move ? to->move[samples[i]].mean : to->geometry + TD_G_MEAN;
        light[i] = luminance_in(renderer, &at->view[(size_t)samples[i] * objects + (size_t)to->object], mean, sh);
        to->varies = by_view * fabs(light[i] - light[0]);
    }
    to->luminance = light[0];
}

/* The body of a splat: one that a motion model moves from its place is one by itself. */
static int group_of(const tides_renderer *renderer, const struct td_swaps *swaps, int g) {
    const int object = renderer->store.object[g];
    return td_swaps_is_of_body(swaps, object, g) ? swaps->group[object] : -1 - g;
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
    to->object = object;
    take_light(renderer, at, g, to);
    to->group = group_of(renderer, swaps, g);
    to->may = swaps->may[g];
    double *z_dot = z + at->parts + 1;
    to->least = INFINITY;
    to->most = -INFINITY;
    for (int k = 0; k <= at->parts; k++) {
        const td_view *view = &at->view[(size_t)k * (size_t)at->objects + (size_t)object];
        const double *mean = to->move ? to->move[k].mean : geometry + TD_G_MEAN;
        z[k] = td_swaps_depth(view, mean);
        z_dot[k] = depth_rate_at(view, mean);
        if (to->move) z_dot[k] += td_dot3(view->r + 6, to->move[k].rate);
        const double before = k > 0 ? td_swaps_length(at, k - 1) : 0, after = k < at->parts ? td_swaps_length(at, k) : 0;
        const double bow = td_greater(before, after) / 3 * fabs(z_dot[k]);
        to->least = td_lesser(to->least, z[k] - bow);
        to->most = td_greater(to->most, z[k] + bow);
    }
    to->sway = mover < 0 ? swaps->turned[object] * td_swaps_reach(renderer, swaps, g, z[0]) : 0;
    to->z = z;
    to->z_dot = z_dot;
}

/* The longest swap within a body, or of a splat that a motion model moves, that is searched in a tile with so many splats. It
 * falls as their pairs grow, down to that of dense tiles at 287 splats. (check_lost, crowd 4020: a swap within a body of 5.03 %
 * of the interval, in a tile with more than 128, between two looks of a step of a quarter of the interval.) */
static double slow_in(int splats) {
    const double share = td_lesser(FEW_SPLATS / (double)splats, 1);
    return td_greater(TD_SWAP_SLOW * share * share, TD_SWAP_SLOW_WITHIN);
}

/* The least `may` of splats that are searched for swaps within their bodies, in a tile with so many splats. */
static int least_within(int splats) { return slow_in(splats) > TD_SWAP_SLOW_WITHIN ? TD_MAY_SLOWLY : TD_MAY_SHORTLY; }

/* Takes the splats of a tile's list that may swap. Takes none if all are of one body within which no swap is possible. */
static tides_status take_splats(const tides_renderer *renderer, td_swap_tile *of, int *count, int *bodies, int *within) {
    const struct td_swaps *swaps = of->swaps;
    td_swap_portion *to = of->portion;
    const int tile = of->tile, *first = renderer->candidates.first, *list = renderer->candidates.list;
    const size_t each = 2 * ((size_t)of->at->parts + 1);
    double darkest = INFINITY, brightest = 0;
    int group = 0, some = 0, most = TD_MAY_NOT;
    *count = *bodies = *within = 0;
    for (int i = first[tile]; i < first[tile + 1]; i++) {
        const int g = list[i];
        if (g < 0 || swaps->may[g] == TD_MAY_NOT) continue;
        const int own = group_of(renderer, swaps, g);
        if (swaps->may[g] > most) most = swaps->may[g];
        *bodies |= some > 0 && own != group;
        group = own;
        some++;
    }
    *within = most >= least_within(some);
    if (!*within && !*bodies) return TIDES_OK;
    tides_status status = td_renew((void **)&to->splat, &to->splat_capacity, (size_t)some, sizeof *to->splat, of->error);
    if (status == TIDES_OK)
        status = td_renew((void **)&to->order, &to->order_capacity, (size_t)some, sizeof *to->order, of->error);
    if (status == TIDES_OK)
        status = td_renew((void **)&to->taken, &to->taken_capacity, (size_t)some, sizeof *to->taken, of->error);
    if (status == TIDES_OK)
        status = td_renew((void **)&to->depth, &to->depth_capacity, (size_t)some * each, sizeof *to->depth, of->error);
    for (int i = first[tile]; i < first[tile + 1] && status == TIDES_OK; i++) {
        if (list[i] < 0 || swaps->may[list[i]] == TD_MAY_NOT) continue;
        td_swap_splat *own = &to->splat[*count];
        take_splat(renderer, swaps, of->at, list[i], to->depth + (size_t)*count * each, own);
        own->taken = &to->taken[*count];
        own->taken->part = 0;
        to->order[(*count)++] = own;
        darkest = td_lesser(darkest, own->luminance - own->varies);
        brightest = td_greater(brightest, own->luminance + own->varies);
    }
    of->most_light = (float)(brightest - darkest);
    return status;
}

/* Checks pairs of splats of different bodies. */
static void look_across(td_swap_tile *of, const td_swap_splat *const *all, int count, double near) {
    int pairs = 0;
    for (int i = 0; i < count && of->status == TIDES_OK; i++) {
        const td_swap_splat *a = all[i];
        const double far = a->most + near * fabs(a->most);
        for (int j = i + 1; j < count && all[j]->least <= far && pairs < MOST_PAIRS; j++, pairs++)
            if (a->group != all[j]->group)
                td_swaps_look_at(of, a, all[j], a->move || all[j]->move ? slow_in(count) : TD_SWAP_SLOW);
    }
    of->is_full = pairs == MOST_PAIRS;
}

/* No less than the distance between two points; many pairs are tried, and a root takes as long as all else. */
static double apart_at_most(const double *a, const double *b) {
    return fabs(a[0] - b[0]) + fabs(a[1] - b[1]) + fabs(a[2] - b[2]);
}

/* 1 if two splats of one object have no short swap. The difference of their depths deviates from a straight line by at most
 * their distance times the object's deviation per unit. So they are out of reach throughout, or within reach for long. */
static int is_none(const td_swap_tile *of, const td_swap_splat *a, const td_swap_splat *b, double near, double slow) {
    const double from = b->z[0] - a->z[0], to = b->z[of->at->parts] - a->z[of->at->parts];
    const double within = near * td_greater(fabs(a->z[0]), fabs(a->z[of->at->parts]));
    if (a->object != b->object) return 0;
    const double strays =
        TD_SWAPS_ASKEW * of->swaps->turning[a->object] * apart_at_most(a->geometry + TD_G_MEAN, b->geometry + TD_G_MEAN);
    const double most = fabs(to - from) + 4 * strays; /* slope of a parabola at its ends */
    return (from * to > 0 && td_lesser(fabs(from), fabs(to)) > within + strays) || slow * most < within;
}

/* Checks pairs within one body, sorted by by_start: splats that may swap within it, with all that its turn brings within
 * reach. A pair is found from the splat that may move further. */
static void look_within(td_swap_tile *of, const td_swap_splat *const *all, int count, double near) {
    int pairs = 0;
    for (int i = 0; i < count && of->status == TIDES_OK; i++) {
        const td_swap_splat *a = all[i];
        if (a->may < least_within(count)) continue;
        const double reach = 2 * a->sway + near * fabs(a->z[0]);
        for (int side = -1; side <= 1; side += 2)
            for (int j = i + side; j >= 0 && j < count && pairs < MOST_PAIRS; j += side, pairs++) {
                const td_swap_splat *b = all[j];
                if (b->group != a->group || fabs(b->z[0] - a->z[0]) > reach) break;
                if (b->may >= least_within(count) && (b->sway > a->sway || (b->sway == a->sway && j < i))) continue;
                const double slow = a->may == TD_MAY_ALONE || b->may == TD_MAY_ALONE ? TD_SWAP_SLOW : slow_in(count);
                if (!is_none(of, a, b, near, slow)) td_swaps_look_at(of, a, b, slow);
            }
    }
    of->is_full = pairs == MOST_PAIRS;
}

/* Checks all pairs of a kind. Where they are too many, it begins again without the fainter half of the splats. */
static void look_at_all(td_swap_tile *of, int count, int (*order)(const void *, const void *),
                        void (*look)(td_swap_tile *, const td_swap_splat *const *, int, double), double near) {
    const td_swap_splat **all = of->portion->order;
    const size_t before = of->portion->count;
    for (;; count /= 2) {
        qsort(all, (size_t)count, sizeof *all, order);
        look(of, all, count, near);
        if (!of->is_full || of->status != TIDES_OK) return;
        of->is_cut = 1;
        of->portion->count = before;
        qsort(all, (size_t)count, sizeof *all, by_opacity);
    }
}

/* Looks at the splats of a tile that fade, if it has few splats. */
static tides_status look_at_fades(const tides_renderer *renderer, td_swap_tile *of) {
    const int *first = renderer->candidates.first + of->tile, *list = renderer->candidates.list;
    const size_t each = 2 * ((size_t)of->at->parts + 1);
    td_swap_portion *to = of->portion;
    if (first[1] - first[0] > FEW_SPLATS) return TIDES_OK;
    of->status = td_renew((void **)&to->depth, &to->depth_capacity, each, sizeof *to->depth, of->error);
    for (int i = first[0]; i < first[1] && of->status == TIDES_OK; i++) {
        td_swap_splat one;
        if (list[i] < 0 || of->swaps->mover[list[i]] >= 0 || !td_swaps_is_fading(renderer, of->at, list[i])) continue;
        take_splat(renderer, of->swaps, of->at, list[i], to->depth, &one);
        td_swaps_look_at_fade(of, &one);
    }
    return of->status;
}

/* Looks at pairs of a tile's splats that may swap. */
static tides_status look_at_pairs(const tides_renderer *renderer, td_swap_tile *of) {
    const double near = TD_SWAP_REACH * renderer->image.soft_depth;
    int count, bodies, within;
    of->status = take_splats(renderer, of, &count, &bodies, &within);
    if (of->status != TIDES_OK || count == 0) return of->status;
    if (bodies) look_at_all(of, count, by_depth, look_across, near);
    if (within) look_at_all(of, count, by_start, look_within, near);
    return of->status;
}

tides_status td_swaps_look_in(const tides_renderer *renderer, const struct td_swaps *swaps, const td_swap_samples *at, int tile,
                              td_swap_portion *portion) {
    const int across = renderer->candidates.tiles_x;
    td_swap_tile of = {.swaps = swaps,
                       .portion = portion,
                       .image = &renderer->image,
                       .at = at,
                       .tile = tile,
                       .corner = {tile % across * TD_TILE, tile / across * TD_TILE},
                       .before = portion->count,
                       .status = TIDES_OK,
                       .error = &portion->error};
    tides_status status = swaps->some_may ? look_at_pairs(renderer, &of) : TIDES_OK;
    if (status == TIDES_OK && swaps->some_fade) status = look_at_fades(renderer, &of);
    portion->tiles_cut += of.is_cut;
    return status;
}
