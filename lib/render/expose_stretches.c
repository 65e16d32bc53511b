/* An exposure is gone through in stretches, each swept and integrated by itself (expose_panels.c): so short that the shortest
 * thing that motions and paths say may happen in one takes a 64th of it. A lamp that flashes for 50 us in 10 ms would else be
 * dark whenever it is looked at. Most exposures are one stretch. For expose.c. */
#include "td_expose.h"

#include "td_extremes.h"

/* Halves of halves: 2^18 panels an exposure, of which a tile that something short is seen in may need each. */
enum { DEEPEST = 12, FINEST_LEVEL = 6 };

/* A path that strays by more than this from the cubics of so many pieces [px] does something in them that looks may miss; what
 * is less than that they needn't be made for, and what takes longer than pieces of this level a tile's travel tells. */
static const double strays_px = 0.25;
enum { LEAST_STRAY_LEVEL = 5 };

/* Scales this much below a 64th, by rounding, don't count. */
static const double slack = 1e-6;

/* 2^level pieces of the interval swept last follow the path of an object. */
static int path_level(const tides_renderer *r, int object) {
    const double *px = r->strays.px + (size_t)object * TD_STRAY_LEVELS;
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

/* The level of what a Gaussian may do, by its own motion and its object's path; 0: nothing short. */
static int level_of(const tides_renderer *r, int gaussian) {
    const td_dynamic_object *moves = td_dynamic_object_of(&r->dynamic, gaussian);
    const int path = path_level(r, r->store.object[gaussian]);
    const int own = moves ? r->dynamic.level[moves->base + gaussian - moves->first] : 0;
    return own > path ? own : path;
}

double td_expose_asked(const tides_renderer *r, int tile) {
    double most = 0;
    for (; r; r = r->beside) {
        const td_candidates *lists = &r->candidates;
        if (td_dynamic_finest(&r->dynamic) == 0 && finest_path(r) == 0) continue;
        for (int i = lists->first[tile]; i < lists->first[tile + 1]; i++) {
            const int gaussian = lists->list[i], level = gaussian == TD_NO_GAUSSIAN ? 0 : level_of(r, gaussian);
            if (level > 0) most = td_greater(most, td_lesser(2 * (double)r->travel[gaussian], (double)(1 << level)));
        }
    }
    return most;
}

static tides_status expose_between(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band,
                                   td_row_window stretch, int depth, tides_error *error);

static tides_status expose_halves(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band,
                                  td_row_window stretch, int depth, tides_error *error) {
    const double middle = stretch.start + 0.5 * (stretch.stop - stretch.start);
    const td_row_window half[2] = {{stretch.start, middle}, {middle, stretch.stop}};
    tides_status status = expose_between(r, camera, band, half[0], depth + 1, error);
    return status == TIDES_OK ? expose_between(r, camera, band, half[1], depth + 1, error) : status;
}

static tides_status expose_between(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band,
                                   td_row_window stretch, int depth, tides_error *error) {
    const double length = stretch.stop - stretch.start;
    double shortest = 0;
    tides_status status = td_renderer_heed(r, 0, error);
    if (status == TIDES_OK) status = td_dynamic_shortest(&r->dynamic, stretch.start, stretch.stop, &shortest, error);
    if (status != TIDES_OK) return status;
    band->unknown = length > (1 << FINEST_LEVEL) * shortest * (1 + slack);
    if (band->unknown && depth < DEEPEST) return expose_halves(r, camera, band, stretch, depth, error);
    if (!(band->swept.start == stretch.start && band->swept.stop == stretch.stop))
        status = td_renderer_sweep(r, camera, stretch.start, stretch.stop, error);
    band->swept = stretch;
    if (status != TIDES_OK) return status;
    const int strays = finest_path(r) > FINEST_LEVEL;
    band->unknown |= strays;
    if (strays && depth < DEEPEST) return expose_halves(r, camera, band, stretch, depth, error);
    band->stretch = stretch;
    return td_expose_panels(r, camera, band, error);
}

tides_status td_expose_stretches(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band, td_row_window all,
                                 tides_error *error) {
    band->all = all;
    return expose_between(r, camera, band, all, 0, error);
}
