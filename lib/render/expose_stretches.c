/* An exposure is gone through in stretches, each swept and integrated by itself (expose_panels.c): so short that no tile asks
 * for more than 64 panels in one, by what motions and paths say that they do. A lamp that flashes for 50 us in 10 ms would else
 * be dark whenever it is looked at. Most exposures are one stretch. For expose.c. */
#include "td_expose.h"

#include "motion/td_motion.h"
#include "td_extremes.h"

#include <stdlib.h>

/* A stretch is halved, down to nanoseconds, while some tile asks for more panels than it may begin with; so many stretches at
 * most, each a sweep. A sweep sees what takes a 4096th of it, and as it is of all Gaussians, an exposure is cut for that into
 * fewer. An exposure that takes more sweeps isn't searched, and its possible events count as unknown. */
enum { STRETCHES_MAX = 2048, DEEPEST = 20, SWEEPS_MAX = 64, SEEN_MOST = 1 << (TD_STRAY_LEVELS - 1) };

/* A path that strays by more than this from the cubics of so many pieces [px] does something in them that looks may miss; what
 * is less than that they needn't be made for, and what takes longer than pieces of this level a tile's travel tells. */
static const double strays_px = 0.25;
enum { LEAST_STRAY_LEVEL = 5 };

/* Scales this much below what a sweep sees, by rounding, don't count. */
static const double slack = 1e-6;

/* 2^level pieces of the interval swept last follow the path of an object. */
static int path_level(const tides_renderer *r, int object) {
    const double *px = r->sweep.strays.px + (size_t)object * TD_STRAY_LEVELS;
    int level = 0;
    while (level < TD_STRAY_LEVELS - 1 && px[level] > strays_px) level++;
    return level < LEAST_STRAY_LEVEL ? 0 : level;
}

static int finest_path(const tides_renderer *r) {
    int finest = 0;
    for (int i = 0; i < r->store.objects; i++) {
        const int own = path_level(r, i);
        finest = own > finest ? own : finest;
    }
    return finest;
}

/* Pieces by the roughness that the sweep found; with a colour filter, that of its roughest channel. */
static double rough_pieces(const tides_renderer *r, int gaussian) {
    double most = 0;
    for (; r; r = r->beside) most = td_greater(most, 2 * (double)r->sweep.travel[gaussian]);
    return most;
}

/* Asks for pieces of the Gaussians whose motion model moves them, where an event shorter than the stretch may happen to them.
 * If the motion knows which of them rest, each of the others asks for all pieces. Else a Gaussian asks for as many as the sweep
 * found it rough: by how much it differs from the image of coarser pieces. `unknown`: the sweep may have missed something, so
 * each asks for all. */
static tides_status ask_for_moved(const tides_renderer *r, td_dynamic_object *object, td_expose_band *band,
                                  tides_error *error) {
    const tides_motion *motion = object->of.motion;
    const uint8_t *level = r->dynamic.level + object->base;
    double from = 0, to = 0;
    int finest = 0;
    for (int i = 0; i < object->count; i++) finest = level[i] > finest ? level[i] : finest;
    if (finest == 0) return TIDES_OK;
    uint8_t *rests = motion->type->find_resting ? td_alloc((size_t)object->of.gaussians.count, 1, error) : NULL;
    if (motion->type->find_resting && !rests) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    if (rests)
        status = td_dynamic_own_times(&r->dynamic, object, r->sweep.interval[0], r->sweep.interval[1], &from, &to, NULL, error);
    if (rests && status == TIDES_OK) status = motion->type->find_resting(motion, &object->of.gaussians, from, to, rests, error);
    for (int i = 0; i < object->count && status == TIDES_OK; i++) {
        const int32_t pieces = level[i] > 0 ? 1 << level[i] : 0;
        const double rough = pieces > 0 ? td_lesser(rough_pieces(r, object->first + i), pieces) : 0;
        const int all = rests ? !rests[r->store.number[object->first + i]] : band->unknown;
        band->asks[object->first + i] = (float)(all ? pieces : rough);
    }
    free(rests);
    return status;
}

/* Finds the pieces that each Gaussian asks for in the interval swept last. */
static tides_status find_asks(tides_renderer *r, td_expose_band *band, tides_error *error) {
    const int paths = finest_path(r);
    tides_status status = TIDES_OK;
    band->asked = paths > 0 || td_dynamic_finest(&r->dynamic) > 0;
    if (!band->asked) return TIDES_OK;
    if (!band->asks) band->asks = td_alloc((size_t)r->store.count, sizeof *band->asks, error);
    if (!band->asks) return TIDES_NO_MEMORY;
    memset(band->asks, 0, (size_t)r->store.count * sizeof *band->asks);
    for (int p = 0; p < r->dynamic.objects && status == TIDES_OK; p++)
        status = ask_for_moved(r, &r->dynamic.object[p], band, error);
    for (int g = 0; g < r->store.count && paths > 0; g++) {
        const int level = path_level(r, r->store.object[g]);
        const double pieces = level > 0 ? 1 << level : 0;
        band->asks[g] = (float)td_greater(td_lesser(rough_pieces(r, g), pieces), (double)band->asks[g]);
    }
    return status;
}

static double middle_of(td_row_window stretch) { return stretch.start + 0.5 * (stretch.stop - stretch.start); }

/* The most panels that any tile of the band asks for. */
static double most_asked(const tides_renderer *r, const td_expose_band *band) {
    const int across = r->candidates.tiles_x;
    double most = 0;
    for (int tile = band->first * across; tile < band->last * across && band->asked; tile++)
        most = td_greater(most, td_expose_asked(r, band, tile));
    return most;
}

/* 1 in *is where a part may hold something too short for its sweep. */
static tides_status is_long(tides_renderer *r, td_row_window part, int *is, tides_error *error) {
    double shortest = INFINITY;
    const tides_status status = td_dynamic_shortest(&r->dynamic, part.start, part.stop, &shortest, error);
    *is = part.stop - part.start > SEEN_MOST * shortest * (1 + slack);
    return status;
}

/* Counts the sweeps that a part takes, up to one more than there may be. */
static tides_status count_sweeps(tides_renderer *r, td_row_window part, int depth, int *count, tides_error *error) {
    int more = 0;
    tides_status status = depth < DEEPEST && *count <= SWEEPS_MAX ? is_long(r, part, &more, error) : TIDES_OK;
    const double middle = middle_of(part);
    *count += !more;
    if (status == TIDES_OK && more) status = count_sweeps(r, (td_row_window){part.start, middle}, depth + 1, count, error);
    if (status == TIDES_OK && more) status = count_sweeps(r, (td_row_window){middle, part.stop}, depth + 1, count, error);
    return status;
}

static tides_status expose_part(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band, td_row_window part,
                                int depth, tides_error *error);

static tides_status expose_halves(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band, td_row_window part,
                                  int depth, tides_error *error) {
    const double middle = middle_of(part);
    band->stretches++;
    tides_status status = expose_part(r, camera, band, (td_row_window){part.start, middle}, depth + 1, error);
    return status == TIDES_OK ? expose_part(r, camera, band, (td_row_window){middle, part.stop}, depth + 1, error) : status;
}

/* Exposes a stretch, or its two halves. */
static tides_status expose_part(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band, td_row_window part,
                                int depth, tides_error *error) {
    tides_status status = td_renderer_check_stop(r, 0, error);
    if (status == TIDES_OK) status = is_long(r, part, &band->unknown, error);
    if (status != TIDES_OK) return status;
    if (band->unknown && band->by_sweeps && depth < DEEPEST) return expose_halves(r, camera, band, part, depth, error);
    if (!(band->swept.start == part.start && band->swept.stop == part.stop))
        status = td_renderer_sweep(r, camera, part.start, part.stop, error);
    band->swept = part;
    if (status == TIDES_OK) status = find_asks(r, band, error);
    if (status != TIDES_OK) return status;
    if (most_asked(r, band) > TD_EXPOSE_PANELS && !band->unknown && depth < DEEPEST && band->stretches < STRETCHES_MAX)
        return expose_halves(r, camera, band, part, depth, error);
    band->stretch = part;
    return td_expose_panels(r, camera, band, error);
}

tides_status td_expose_stretches(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band, td_row_window all,
                                 tides_error *error) {
    int sweeps = 0;
    band->all = all;
    band->stretches = 1;
    const tides_status status = count_sweeps(r, all, 0, &sweeps, error);
    band->by_sweeps = sweeps <= SWEEPS_MAX;
    return status == TIDES_OK ? expose_part(r, camera, band, all, 0, error) : status;
}
