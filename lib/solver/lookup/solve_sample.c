/* Measures a run's own event times. Some events of each macro step, drawn by chance, are held against the image itself. All
 * splats that their pixels see are projected at the events' own times. So the measurement includes the errors that record
 * paths, cubics and looks left. A percentile of few events is raised by the spread of chance (td_timing_percentile).
 *
 * Which events these are follows from the events alone (chosen.c). */
#include "solver/td_simulator.h"
#include "td_extremes.h"

#include <math.h>

/* Adds a measured event to the timing statistics. `stands_for`: events of the macro step per measured one. The signal's slope
 * is the image's where that is less than the model's: a model that is off by much may also be too steep (check_lost, leap 402:
 * 2000 in place of 1660 per second). */
static void note(tides_simulator *s, const td_sampled *one, const td_point_value *seen, double stands_for) {
    const double error = td_timing_together(seen->L - one->L, one->floor);
    const double slope = td_lesser(one->slope, one->polarity * seen->L_dot * one->length_s + one->rise);
    if (one->late > 0)
        td_timing_add_solved(&s->done.timing, stands_for, one->late, 1, 0, one->length_s);
    else
        td_timing_add_solved(&s->done.timing, stands_for, error, slope, one->bend, one->length_s);
}

tides_status td_solve_measure(tides_simulator *s, tides_error *error) {
    td_solve_portion *solve = &s->done.solve;
    td_point points[TD_TIMING_SAMPLE];
    td_point_value values[TD_TIMING_SAMPLE];
    tides_status status = TIDES_OK;
    const double begun = td_now();
    td_solve_cut(solve, td_timing_events(&s->done.timing));
    const size_t count = solve->sampled_count;
    for (size_t i = 0; i < count; i++) points[i] = solve->sampled[i].point;
    if (count > 0) status = td_renderer_direct_points(s->renderer, s->camera, points, count, values, error);
    td_solve_note_time(s, begun);
    const double stands_for = count > 0 ? (double)solve->fired / (double)count : 0;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) note(s, &solve->sampled[i], &values[i], stands_for);
    return status;
}
