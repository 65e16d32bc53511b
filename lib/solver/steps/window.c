/* Chooses the open steps that are refined next: all, or where their samples would need too much memory, the earliest. */
#include "solver/td_simulator.h"

#include <stdlib.h>

/* An open step, its start and its unit. */
typedef struct place {
    uint32_t from;
    int32_t unit, step;
} place;

static int by_place(const void *a, const void *b) {
    const place *x = a, *y = b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return x->unit < y->unit ? -1 : x->unit > y->unit;
}

void td_refine_bound(tides_simulator *s) {
    td_refine *r = &s->refine;
    const double bytes = (double)s->given.memory_mb * 1e6;
    /* Half of memory_mb is for samples and their steps. A quarter is for a launch's planes, in double here and in float on the
     * device. A quarter is for the launch's other buffers. */
    const double sample = (double)(td_sample_reals(&r->samples) * sizeof(double) + 2 * sizeof(td_refine_step));
    const double launched = (double)s->given.outputs * TD_TILE_PIXELS * (sizeof(double) + sizeof(float));
    r->limit = (size_t)(0.5 * bytes / sample);
    r->batch = (size_t)(0.25 * bytes / launched);
    if (r->batch < 1) r->batch = 1;
}

/* Samples per unit: at both ends of the macro step, inside, and at one further cut. Units that are cut further need more, but
 * most aren't. */
enum { SAMPLES_A_UNIT = 4 };

int td_window_units(const tides_simulator *s) {
    const size_t units = s->refine.limit / SAMPLES_A_UNIT;
    if (!s->given.local || units >= (size_t)s->moving.count) return s->moving.count;
    return units < 1 ? 1 : (int)units;
}

/* Steps that a launch may take where the earliest are taken first: so few that all parts of them, level by level down to the
 * shortest, find room too. An eighth of the moving units may always be taken, which over some 14 levels is two samples more per
 * unit. With one step at a time, an image whose units alone need more than memory_mb (8192x8192 and 256 MB) took hours. */
static size_t room(const tides_simulator *s, uint32_t longest) {
    const td_refine *r = &s->refine;
    size_t live = td_samples_live(&r->samples), levels = 1, least = (size_t)r->units / 8;
    for (uint32_t length = longest; length >= 2 * r->shortest; length -= length * 3 / 8) levels++; /* the longer part */
    size_t left = r->limit > live ? (r->limit - live) / levels : 0;
    return left > least ? left : least;
}

/* 1 for steps that can't wait. Without `local` all units are cut at once. With some sensors the first cuts of all units are
 * judged before others, which use the errors found there. */
static int must_take(const tides_simulator *s, const td_refine_step *step, const td_refine_step *last) {
    return (!s->given.local && step->from == last->from) || td_sensor_estimates_first(&s->sensor, step->cuts);
}

static tides_status take_earliest(const tides_simulator *s, td_refine *r, tides_error *error) {
    place *places = td_alloc(r->open_count, sizeof *places, error);
    if (!places) return TIDES_NO_MEMORY;
    uint32_t longest = 0;
    for (size_t i = 0; i < r->open_count; i++) {
        const td_refine_step *step = &r->step[r->open[i]];
        places[i] = (place){step->from, step->unit, r->open[i]};
        longest = step->to - step->from > longest ? step->to - step->from : longest;
    }
    qsort(places, r->open_count, sizeof *places, by_place);
    size_t wanted = room(s, longest), left = 0;
    for (size_t i = 0; i < r->open_count; i++) {
        int32_t step = places[i].step;
        int take = r->pending_count < wanted || r->pending_count == 0 ||
                   must_take(s, &r->step[step], &r->step[r->pending[r->pending_count - 1]]);
        if (take)
            r->pending[r->pending_count++] = step;
        else
            r->open[left++] = step;
    }
    r->open_count = left;
    free(places);
    return TIDES_OK;
}

int td_window_is_short(const tides_simulator *s) {
    const td_refine *r = &s->refine;
    return 2 * (td_samples_live(&r->samples) + r->open_count) > r->limit;
}

tides_status td_window_take(tides_simulator *s, int is_short, tides_error *error) {
    td_refine *r = &s->refine;
    tides_status status = td_reserve((void **)&r->pending, &r->pending_capacity, r->open_count, sizeof *r->pending, error);
    if (status != TIDES_OK) return status;
    r->pending_count = 0;
    if (is_short) return take_earliest(s, r, error);
    memcpy(r->pending, r->open, r->open_count * sizeof *r->open);
    r->pending_count = r->open_count;
    r->open_count = 0;
    return TIDES_OK;
}
