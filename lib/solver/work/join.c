/* Joins the results of a portion of the work to the run's: pixels that may do something, requested points, settled events. */
#include "solver/td_simulator.h"

#include <stdlib.h>

void td_solve_batch_release(td_solve_batch *batch) {
    free(batch->pixel);
    free(batch->point);
    free(batch->asked);
    free(batch->value);
    *batch = (td_solve_batch){.pixels = 0};
}

void td_solve_portion_clear(td_solve_portion *portion) {
    portion->asks = &portion->own;
    portion->own.pixels = portion->own.points = 0;
    portion->looked_count = portion->refer.count = portion->sampled_count = portion->fired = 0;
    portion->is_cut = 0;
    portion->events = 0;
}

void td_solve_portion_release(td_solve_portion *portion) {
    free(portion->looked);
    td_solve_batch_release(&portion->own);
    free(portion->refer.wanted);
    free(portion->refer.start);
    free(portion->refer.rest);
    free(portion->reaches);
    free(portion->trust);
    td_work_release(&portion->ahead);
    free(portion->sampled);
    *portion = (td_solve_portion){.events = 0};
}

/* Appends `some` elements of `size` bytes to a list. */
static tides_status append(void **list, size_t *count, size_t *capacity, const void *more, size_t some, size_t size,
                           tides_error *error) {
    tides_status status = some > 0 ? td_reserve(list, capacity, *count + some, size, error) : TIDES_OK;
    if (status != TIDES_OK || some == 0) return status;
    memcpy((char *)*list + *count * size, more, some * size);
    *count += some;
    return TIDES_OK;
}

/* Joins a portion's requests. A portion numbers the pixels that may do something by its own list, which begins at `from` in the
 * run's. */
static tides_status join_asks(td_solve_batch *to, const td_solve_batch *asks, int32_t from, tides_error *error) {
    const size_t pixels = to->pixels, points = to->points;
    size_t asked = points;
    tides_status status =
        append((void **)&to->pixel, &to->pixels, &to->pixel_capacity, asks->pixel, asks->pixels, sizeof *to->pixel, error);
    if (status == TIDES_OK)
        status = append((void **)&to->asked, &asked, &to->asked_capacity, asks->asked, asks->points, sizeof *to->asked, error);
    if (status == TIDES_OK)
        status =
            append((void **)&to->point, &to->points, &to->point_capacity, asks->point, asks->points, sizeof *to->point, error);
    for (size_t k = pixels; k < to->pixels && status == TIDES_OK; k++) to->pixel[k].next += from, to->pixel[k].end += from;
    for (size_t k = points; k < to->points && status == TIDES_OK; k++) to->asked[k].looked += from;
    return status;
}

static tides_status join_references(td_solve_refer_list *to, const td_solve_refer_list *refer, tides_error *error) {
    size_t started = to->count;
    tides_status status =
        append((void **)&to->start, &started, &to->start_capacity, refer->start, refer->count, sizeof *to->start, error);
    if (status != TIDES_OK) return status;
    return append((void **)&to->wanted, &to->count, &to->wanted_capacity, refer->wanted, refer->count, sizeof *to->wanted,
                  error);
}

tides_status td_solve_join(tides_simulator *s, const td_solve_portion *portion, tides_error *error) {
    td_solve_portion *to = &s->done.solve;
    const int32_t from = portion->looked_count > 0 ? (int32_t)to->looked_count : 0;
    to->events += portion->events;
    tides_status status = append((void **)&to->looked, &to->looked_count, &to->looked_capacity, portion->looked,
                                 portion->looked_count, sizeof *to->looked, error);
    if (status == TIDES_OK) status = join_asks(td_solve_filling(&s->solve), &portion->own, from, error);
    if (status == TIDES_OK) status = join_references(&to->refer, &portion->refer, error);
    return status == TIDES_OK ? td_solve_join_samples(s, portion, error) : status;
}
