/* Divides an exposure into stretches, each swept and integrated by itself. A panel is the interval between two nodes, times at
 * which a tile is rendered. Stretches are so short that no tile needs more than 64 panels in one, by the time scales of motions
 * and the strays of paths. Otherwise a lamp that flashes for 50 us in 10 ms could be dark at every node. Most exposures are one
 * stretch. */
#include "td_expose.h"

#include "motion/td_motion.h"
#include "td_extremes.h"

#include <stdlib.h>

/* A stretch is halved, at most 20 times, while some tile needs more panels than it may begin with. There are at most 2048
 * stretches, each with a sweep. A sweep detects changes as short as 1/4096 of its interval. An exposure longer than 4096 times
 * the shortest declared scale is first cut for that, into at most 64 sweeps. If these aren't enough it isn't cut, and pixels
 * that may change faster count as unsettled. */
enum { STRETCHES_MAX = 2048, DEEPEST = 20, SWEEPS_MAX = 64, SEEN_MOST = 1 << (TD_STRAY_LEVELS - 1) };

/* Cubics of 2^level pieces follow a path if it strays from them by at most this [px]. Below the least level, the path asks for
 * no panels: the tile's travel already asks for enough. */
static const double strays_px = 0.25;
enum { LEAST_STRAY_LEVEL = 5 };

/* Rounding may make a scale of time shorter by this share. */
static const double slack = 1e-6;

/* Level of an object's path in the interval swept last: 2^level pieces follow it. 0: below the least level. */
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

/* Pieces that a Gaussian's changes need, by the sweep, whose travel is half their number. With a colour filter, the most of any
 * channel. */
static double rough_pieces(const tides_renderer *r, int gaussian) {
    double most = 0;
    for (; r; r = r->beside) most = td_greater(most, 2 * (double)r->sweep.travel[gaussian]);
    return most;
}

/* Sets band->asks, the pieces that each Gaussian of an object needs, if its motion declares scales shorter than the stretch. By
 * its scale a Gaussian needs 2^level pieces, and by the sweep (rough_pieces) often fewer. If the motion knows which Gaussians
 * rest, the others ask for 2^level. Without that knowledge all do, if the sweep may have missed a short change (band->unknown).
 * Else the sweep decides. */
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

/* Sets how many pieces each Gaussian needs in the interval swept last. */
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

/* The most panels that a tile of the band needs. */
static double most_asked(const tides_renderer *r, const td_expose_band *band) {
    const int across = r->candidates.tiles_x;
    double most = 0;
    for (int tile = band->first * across; tile < band->last * across && band->asked; tile++)
        most = td_greater(most, td_expose_asked(r, band, tile));
    return most;
}

/* Sets *is to 1 if the part may hold a change too short for its sweep to detect. */
static tides_status is_long(tides_renderer *r, td_row_window part, int *is, tides_error *error) {
    double shortest = INFINITY;
    const tides_status status = td_dynamic_shortest(&r->dynamic, part.start, part.stop, &shortest, error);
    *is = part.stop - part.start > SEEN_MOST * shortest * (1 + slack);
    return status;
}

/* Adds the sweeps that a part needs to *count. Once that is above SWEEPS_MAX, parts are no longer examined. */
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
