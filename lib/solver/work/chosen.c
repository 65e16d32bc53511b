/* Chooses the events of a macro step that are measured: the first in a random order of pixels and times. The order follows from
 * the events alone, whichever thread finds them first. */
#include "td_random.h"
#include "solver/td_simulator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A hash, so that pixels which see the same edge aren't neighbours in the order. */
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

/* Keeps the first TD_TIMING_SAMPLE in the order. The last one kept is the bound for later events. */
static void cut(td_solve_portion *portion) {
    if (portion->sampled_count == 0) return;
    qsort(portion->sampled, portion->sampled_count, sizeof *portion->sampled, by_order);
    if (portion->sampled_count < TD_TIMING_SAMPLE) return;
    portion->sampled_count = TD_TIMING_SAMPLE;
    portion->is_cut = 1;
}

/* Adds an event whose order is set. */
static tides_status add(td_solve_portion *portion, const td_sampled *one, tides_error *error) {
    const size_t most = 2 * TD_TIMING_SAMPLE;
    if (portion->is_cut && by_order(one, &portion->sampled[TD_TIMING_SAMPLE - 1]) > 0) return TIDES_OK;
    tides_status status =
        td_reserve((void **)&portion->sampled, &portion->sampled_capacity, most, sizeof *portion->sampled, error);
    if (status != TIDES_OK) return status;
    portion->sampled[portion->sampled_count++] = *one;
    if (portion->sampled_count == most) cut(portion);
    return TIDES_OK;
}

tides_status td_solve_sample(td_solve_portion *portion, const td_sampled *one, tides_error *error) {
    td_sampled own = *one;
    own.order = order_of(&one->point);
    portion->fired++;
    return add(portion, &own, error);
}

tides_status td_solve_join_samples(tides_simulator *s, const td_solve_portion *portion, tides_error *error) {
    tides_status status = TIDES_OK;
    s->done.solve.fired += portion->fired;
    for (size_t k = 0; k < portion->sampled_count && status == TIDES_OK; k++)
        status = add(&s->done.solve, &portion->sampled[k], error);
    return status;
}

/* A measured event stands for at most a TD_TIMING_SAMPLE-th of all events so far, whenever the hard part comes. So the first
 * TD_TIMING_SAMPLE events are all measured, and of equal steps the k-th has a k-th of the first one's sample. With 256 events
 * in each of the first steps and 32 later, a p99 was too small where these had few events, or where the hard part came
 * later. */
void td_solve_cut(td_solve_portion *portion, double before) {
    const double fired = (double)portion->fired, wanted = ceil(fired * TD_TIMING_SAMPLE / (before + fired));
    cut(portion);
    if (portion->sampled_count > wanted) portion->sampled_count = (size_t)wanted;
}
