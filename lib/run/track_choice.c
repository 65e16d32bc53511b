/* Chooses points to follow: at random on all that is seen, on a grid over the first image, or equally many per object
 * (tracks.choice). */
#include "run/td_track_choice.h"

#include "td_base.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHOICES = 8 }; /* so that objects which come into view later get points, too */

uint32_t td_tracks_choices(const tides_session_facts *facts) {
    return facts->values.track_choice == TIDES_TRACKS_GRID ? 1 : CHOICES;
}

/* -- a grid ---------------------------------------------------------------------------------------------------------------- */

/* Adds points at those of `places` that show a splat, in order, up to `count`. */
static tides_status pick(tides_renderer *renderer, const tides_session_facts *facts, double time, const double *places,
                         size_t tried, size_t count, td_track_choice *choice, tides_error *error) {
    tides_material_point *seen = td_alloc(tried + 1, sizeof *seen, error);
    tides_status status =
        seen ? tides_renderer_pick(renderer, facts->camera, time, places, tried, seen, error) : TIDES_NO_MEMORY;
    size_t found = 0;
    for (size_t i = 0; i < tried && found < count && status == TIDES_OK; i++) {
        if (seen[i].object < 0) continue;
        memcpy(choice->xy + 2 * choice->count, places + 2 * i, 2 * sizeof *places);
        choice->points[choice->count++] = seen[i];
        found++;
    }
    free(seen);
    return status;
}

/* Tries the centres of `most` cells, which are as square as possible. */
static tides_status choose_grid(tides_renderer *renderer, const tides_session_facts *facts, double time,
                                td_track_choice *choice, tides_error *error) {
    const size_t count = choice->most;
    const double width = facts->intrinsics.width, height = facts->intrinsics.height;
    size_t across = (size_t)fmax(1, rint(sqrt((double)count * width / height)));
    if (across > count) across = count;
    const size_t down = count / across, cells = across * down;
    double *places = td_alloc(cells + 1, 2 * sizeof *places, error);
    if (!places) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < cells; i++) {
        const size_t column = i % across, row = i / across;
        places[2 * i] = ((double)column + 0.5) * width / (double)across;
        places[2 * i + 1] = ((double)row + 0.5) * height / (double)down;
    }
    const tides_status status = pick(renderer, facts, time, places, cells, count, choice, error);
    free(places);
    return status;
}

/* -- equally many per object ------------------------------------------------------------------------------------------- */

/* Pixels sorted by the object that they show: those of object k are order[first[k] .. first[k + 1]). */
typedef struct pixels_of {
    double *instance; /* (pixels) */
    size_t *order;    /* (pixels) */
    size_t *first;    /* (objects + 1) */
    int32_t objects, seen;
} pixels_of;

static void release(pixels_of *p) {
    free(p->instance);
    free(p->order);
    free(p->first);
}

static tides_status sort_pixels(tides_renderer *renderer, const tides_session_facts *facts, double time, pixels_of *p,
                                tides_error *error) {
    const size_t pixels = (size_t)facts->intrinsics.width * (size_t)facts->intrinsics.height;
    tides_truth truth = {{NULL}};
    p->objects = tides_scene_objects(facts->scene);
    p->instance = td_alloc(pixels, sizeof *p->instance, error);
    p->order = td_alloc(pixels, sizeof *p->order, error);
    p->first = td_alloc((size_t)p->objects + 2, sizeof *p->first, error);
    if (!p->instance || !p->order || !p->first) return TIDES_NO_MEMORY;
    truth.plane[TIDES_TRUTH_INSTANCE] = p->instance;
    const tides_status status = tides_renderer_truth(renderer, facts->camera, time, &truth, error);
    if (status != TIDES_OK) return status;
    size_t *next = p->first + 1; /* counts are stored two places further, so that they become the first indices */
    for (size_t i = 0; i < pixels; i++)
        if (p->instance[i] >= 0 && p->instance[i] + 1 < p->objects) next[(size_t)p->instance[i] + 1]++;
    for (int32_t k = 1; k < p->objects; k++) next[k] += next[k - 1];
    for (size_t i = 0; i < pixels; i++)
        if (p->instance[i] >= 0) p->order[next[(size_t)p->instance[i]]++] = i;
    for (int32_t k = 0; k < p->objects; k++) p->seen += p->first[k + 1] > p->first[k];
    return TIDES_OK;
}

/* Draws places in pixels of one object, by (seed, number, draw). */
static void draw_places(const pixels_of *p, int32_t object, const tides_session_facts *facts, uint32_t number, size_t count,
                        double *places) {
    const size_t begin = p->first[object], own = p->first[object + 1] - begin, width = (size_t)facts->intrinsics.width;
    for (size_t i = 0; i < count; i++) {
        const uint64_t draw = (uint64_t)(object + 1) << 32 | i;
        const td_random_bits bits = td_random(facts->values.sensor.seed, number, draw, TD_RANDOM_TRACKS);
        size_t which = (size_t)(td_random_uniform(&bits, 0) * (double)own);
        if (which >= own) which = own - 1;
        const size_t pixel = p->order[begin + which];
        const size_t column = pixel % width, row = pixel / width;
        places[2 * i] = (double)column + 0.5;
        places[2 * i + 1] = (double)row + 0.5;
    }
}

/* Chooses points per object. The object with the largest weight in a pixel may differ from that of the median splat, which is
 * followed. So more places are drawn than points are needed. */
static tides_status choose_instances(tides_renderer *renderer, const tides_session_facts *facts, double time, uint32_t number,
                                     td_track_choice *choice, tides_error *error) {
    enum { DRAWN = 4 };
    const size_t count = choice->most;
    pixels_of p = {.instance = NULL};
    double *places = td_alloc(DRAWN * count + 1, 2 * sizeof *places, error);
    tides_status status = places ? sort_pixels(renderer, facts, time, &p, error) : TIDES_NO_MEMORY;
    size_t turn = 0;
    for (int32_t k = 0; k < p.objects && status == TIDES_OK; k++) {
        if (p.first[k + 1] == p.first[k]) continue;
        /* NOLINTNEXTLINE(clang-analyzer-core.DivideZero): this object is seen */
        const size_t share = count * (turn + 1) / (size_t)p.seen - count * turn / (size_t)p.seen;
        turn++;
        draw_places(&p, k, facts, number, DRAWN * share, places);
        status = pick(renderer, facts, time, places, DRAWN * share, share, choice, error);
    }
    release(&p);
    free(places);
    return status;
}

tides_status td_tracks_choose(tides_renderer *renderer, const tides_session_facts *facts, double time, uint32_t number,
                              td_track_choice *choice, tides_error *error) {
    const tides_run_values *v = &facts->values;
    if (v->track_choice == TIDES_TRACKS_GRID) return choose_grid(renderer, facts, time, choice, error);
    if (v->track_choice == TIDES_TRACKS_INSTANCE) return choose_instances(renderer, facts, time, number, choice, error);
    return tides_renderer_choose(renderer, facts->camera, time, v->sensor.seed, number, choice->most, choice->xy,
                                 choice->points, &choice->count, error);
}
