/* What a run says of its own event times is measured: some events of each macro step, drawn by chance, are held against the
 * image itself, with all that their pixels see projected at the events' own times. What record paths, cubics and looks left is
 * in that; a percentile of few is raised by what chance may do (td_timing_percentile).
 *
 * Which events these are follows from the events alone: the first in a random order of pixels and times. */
#include "td_random.h"
#include "solver/td_simulator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measured in each of a run's first macro steps, and later. A choice: of so many in 30 ms p95 is known to a share of 0.7 %, and
 * the demo's run is 1 % longer; steps of a millisecond pay for few. */
enum { FIRST_STEPS = 4, MANY = 256, FEW = 32 };

static size_t wanted(const tides_simulator *s) { return s->step < FIRST_STEPS ? MANY : FEW; }

/* Pixels that see the same at once must not come one after the other. */
static uint64_t order_of(const td_point *point) {
    uint64_t time;
    memcpy(&time, &point->time, sizeof time);
    const td_random_bits bits = td_random(0, (uint32_t)point->y << 16 | (uint32_t)point->x, time, TD_RANDOM_SAMPLE);
    return (uint64_t)bits.word[0] << 32 | bits.word[1];
}

static int by_order(const void *a, const void *b) {
    const td_sampled *x = a, *y = b;
    if (x->order != y->order) return x->order < y->order ? -1 : 1;
    if (x->point.time != y->point.time) return x->point.time < y->point.time ? -1 : 1;
    if (x->point.y != y->point.y) return x->point.y < y->point.y ? -1 : 1;
    return (x->point.x > y->point.x) - (x->point.x < y->point.x);
}

/* Keeps those that come first. */
static void cut(const tides_simulator *s, td_solve *solve) {
    if (solve->sampled_count == 0) return;
    qsort(solve->sampled, solve->sampled_count, sizeof *solve->sampled, by_order);
    if (solve->sampled_count > wanted(s)) solve->sampled_count = wanted(s);
}

tides_status td_solve_sample(tides_simulator *s, const td_sampled *one, tides_error *error) {
    td_solve *solve = &s->solve;
    const size_t most = 2 * wanted(s), count = solve->sampled_count;
    const uint64_t order = order_of(&one->point);
    if (solve->fired++ >= most && /* it has been cut */
        by_order(&(td_sampled){.order = order, .point = one->point}, &solve->sampled[wanted(s) - 1]) > 0)
        return TIDES_OK;
    tides_status status = td_reserve((void **)&solve->sampled, &solve->sampled_capacity, most, sizeof *solve->sampled, error);
    if (status != TIDES_OK) return status;
    solve->sampled[count] = *one;
    solve->sampled[count].order = order;
    solve->sampled_count++;
    if (solve->sampled_count < most) return TIDES_OK;
    cut(s, solve);
    return TIDES_OK;
}

/* An event stands for so many as there are of it in the step. */
static void note(tides_simulator *s, const td_sampled *one, double L, double stands_for) {
    const double error = td_timing_together(L - one->L, one->floor);
    if (one->late > 0)
        td_timing_add_solved(&s->timing, stands_for, one->late, 1, 0, one->length_s);
    else
        td_timing_add_solved(&s->timing, stands_for, error, one->slope, one->bend, one->length_s);
}

tides_status td_solve_measure(tides_simulator *s, tides_error *error) {
    td_solve *solve = &s->solve;
    td_point points[MANY];
    td_point_value values[MANY];
    tides_status status = TIDES_OK;
    const double begun = td_now();
    cut(s, solve);
    const size_t count = solve->sampled_count;
    for (size_t i = 0; i < count; i++) points[i] = solve->sampled[i].point;
    if (count > 0) status = td_renderer_direct_points(s->renderer, s->camera, points, count, values, error);
    td_solve_note_time(s, begun);
    const double stands_for = count > 0 ? (double)solve->fired / (double)count : 0;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) note(s, &solve->sampled[i], values[i].L, stands_for);
    return status;
}
