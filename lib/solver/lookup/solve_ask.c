/* Points to be looked up: requested one by one, sent to the renderer in batches, and received. */
#include "solver/td_simulator.h"

/* Points of the first batch, while the device has nothing to do. Each next batch is twice as large: requesting a point takes
 * the host as long as looking it up takes a core of two, or half of that. */
enum { FIRST = 1024 };

tides_status td_solve_ask(td_solve_batch *batch, const td_tile *tile, int32_t local, double time, const td_asked *asked,
                          tides_error *error) {
    const size_t k = batch->points;
    tides_status status = td_reserve((void **)&batch->point, &batch->point_capacity, k + 1, sizeof *batch->point, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&batch->asked, &batch->asked_capacity, k + 1, sizeof *batch->asked, error);
    if (status != TIDES_OK) return status;
    batch->point[k] = (td_point){time, tile->x0 + local % tile->width, tile->y0 + local / tile->width};
    batch->asked[k] = *asked;
    batch->points++;
    return TIDES_OK;
}

void td_solve_note_time(tides_simulator *s, double begun) {
    const double took = td_now() - begun;
    s->totals.here.time_look_up_s += took;
    s->totals.here.time_compare_s -= took; /* time of look-ups isn't counted as comparing */
}

tides_status td_solve_send(tides_simulator *s, td_solve_batch *batch, tides_error *error) {
    tides_status status = td_renew((void **)&batch->value, &batch->value_capacity, batch->points, sizeof *batch->value, error);
    if (status != TIDES_OK || batch->points == 0) return status;
    const double begun = td_now();
    s->solve.lookups += batch->points;
    status = td_renderer_points_begin(s->renderer, s->camera, batch->point, batch->points, batch->value, error);
    td_solve_note_time(s, begun);
    s->solve.sent_s = td_now();
    s->solve.sent_alone_s = td_alone_time(s);
    return status;
}

/* Adds the calling thread's time since the batch was sent, as far as the device worked on it: `alone` of `wall`. */
static void note_covered(tides_simulator *s, double alone, double wall) {
    const double took = td_renderer_points_took(s->renderer);
    if (s->solve.sent_s > 0) s->solve.covered_s += took < wall ? alone * (took / wall) : alone;
    s->solve.sent_s = 0;
}

tides_status td_solve_receive(tides_simulator *s, tides_error *error) {
    const double begun = td_now(), alone = td_alone_time(s) - s->solve.sent_alone_s;
    const tides_status status = td_renderer_points_end(s->renderer, error);
    td_solve_note_time(s, begun);
    note_covered(s, alone, begun - s->solve.sent_s);
    return status;
}

tides_status td_solve_look_up(tides_simulator *s, tides_error *error) {
    tides_status status = td_solve_send(s, td_solve_filling(&s->solve), error);
    return status == TIDES_OK ? td_solve_receive(s, error) : status;
}

int td_solve_is_busy(const tides_simulator *s) {
    size_t left = s->done.solve.refer.count;
    for (int k = 0; k < TD_SOLVE_BATCHES; k++) left += s->solve.batch[k].points;
    return left > 0;
}

int td_solve_has_enough(const tides_simulator *s) {
    const td_solve *solve = &s->solve;
    return solve->batch[solve->filling].points >= solve->enough_now && td_renderer_points_go_on(s->renderer);
}

void td_solve_clear_batches(tides_simulator *s) {
    td_renderer_points_drop(s->renderer);
    s->solve.sent_s = 0;
    for (int k = 0; k < TD_SOLVE_BATCHES; k++) s->solve.batch[k].points = s->solve.batch[k].pixels = 0;
    s->done.solve.refer.count = 0;
    s->solve.enough_now = s->solve.enough < FIRST ? s->solve.enough : FIRST;
}
