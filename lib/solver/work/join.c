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

/* Makes room for `some` more elements of `size` bytes at a list's end, which begins at `*at`. */
static tides_status place(void **list, size_t *count, size_t *capacity, size_t some, size_t size, size_t *at,
                          tides_error *error) {
    tides_status status = some > 0 ? td_reserve(list, capacity, *count + some, size, error) : TIDES_OK;
    *at = *count;
    if (status == TIDES_OK) *count += some;
    return status;
}

tides_status td_solve_place(tides_simulator *s, td_solve_portion *portion, tides_error *error) {
    td_solve_portion *to = &s->done.solve;
    td_solve_batch *batch = td_solve_filling(&s->solve);
    td_solve_begins *at = &portion->at;
    size_t asked = batch->points, started = to->refer.count;
    to->events += portion->events;
    tides_status status = place((void **)&to->looked, &to->looked_count, &to->looked_capacity, portion->looked_count,
                                sizeof *to->looked, &at->looked, error);
    if (status == TIDES_OK)
        status = place((void **)&batch->pixel, &batch->pixels, &batch->pixel_capacity, portion->own.pixels,
                       sizeof *batch->pixel, &at->pixel, error);
    if (status == TIDES_OK)
        status = place((void **)&batch->asked, &asked, &batch->asked_capacity, portion->own.points, sizeof *batch->asked,
                       &at->point, error);
    if (status == TIDES_OK)
        status = place((void **)&batch->point, &batch->points, &batch->point_capacity, portion->own.points,
                       sizeof *batch->point, &at->point, error);
    if (status == TIDES_OK)
        status = place((void **)&to->refer.start, &started, &to->refer.start_capacity, portion->refer.count,
                       sizeof *to->refer.start, &at->refer, error);
    if (status == TIDES_OK)
        status = place((void **)&to->refer.wanted, &to->refer.count, &to->refer.wanted_capacity, portion->refer.count,
                       sizeof *to->refer.wanted, &at->refer, error);
    return status == TIDES_OK ? td_solve_join_samples(s, portion, error) : status;
}

static void copy(void *list, size_t at, const void *from, size_t count, size_t size) {
    if (count > 0) memcpy((char *)list + at * size, from, count * size);
}

/* A portion numbers the pixels that may do something by its own list. */
void td_solve_join(tides_simulator *s, const td_solve_portion *portion) {
    td_solve_portion *to = &s->done.solve;
    td_solve_batch *batch = td_solve_filling(&s->solve);
    const td_solve_begins *at = &portion->at;
    const td_solve_batch *own = &portion->own;
    const td_solve_refer_list *refer = &portion->refer;
    const int32_t from = portion->looked_count > 0 ? (int32_t)at->looked : 0;
    copy(to->looked, at->looked, portion->looked, portion->looked_count, sizeof *to->looked);
    copy(batch->pixel, at->pixel, own->pixel, own->pixels, sizeof *own->pixel);
    copy(batch->asked, at->point, own->asked, own->points, sizeof *own->asked);
    copy(batch->point, at->point, own->point, own->points, sizeof *own->point);
    copy(to->refer.start, at->refer, refer->start, refer->count, sizeof *refer->start);
    copy(to->refer.wanted, at->refer, refer->wanted, refer->count, sizeof *refer->wanted);
    for (size_t k = at->pixel; k < at->pixel + own->pixels; k++) batch->pixel[k].next += from, batch->pixel[k].end += from;
    for (size_t k = at->point; k < at->point + own->points; k++) batch->asked[k].looked += from;
}
