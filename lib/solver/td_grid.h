/* Internal: the times that steps begin and end at: start + k step_s, joined by the knots of motions, at which rates may
 * jump. */
#ifndef TD_GRID_H
#define TD_GRID_H

#include "signal/td_step.h"
#include "tides/base.h"

#include <stddef.h>

/* Points are numbered from 0, at `start`, to `steps`, at `stop`. Regular points are products, not running sums; one that is
 * closer to a knot than `gap` gives way to it, so that no sliver of a step is left; and where the last would be one, shorter
 * than 1/1024 of the others, the one before it is so much longer. A run's grid counts from its start: `start` is 0. */
typedef struct td_grid {
    double start, stop, step_s;
    int64_t regular; /* steps without the knots */
    int64_t steps;
    size_t knots;
    double *knot;      /* (knots) [s], ascending, within (start, stop) */
    int64_t *point;    /* (knots) number of the knot's point */
    int64_t *replaced; /* (knots) regular points that gave way up to and with this knot */
    int64_t epoch_ns;  /* the nanosecond nearest to the run's start: event times are whole nanoseconds after it */
} td_grid;

/* A grid for [start, stop] with steps of step_s; `knots` [s] ascending, anywhere, are copied. `gap` [s] is at most half a
 * step. */
tides_status td_grid_create(double start, double stop, double step_s, const double *knots, size_t count, double gap,
                            td_grid *grid, tides_error *error);
void td_grid_release(td_grid *grid);

/* Time of point k [s]: `stop` from `steps` on. */
double td_grid_at(const td_grid *grid, int64_t k);

/* 1 where point k is a knot. */
int td_grid_is_knot(const td_grid *grid, int64_t k);

/* 1 where point k, `epoch` later, is at or before `time`, but for rounding: so it is at a time that a caller worked out as
 * epoch + k step_s, wrote down in decimals, or added up step by step. */
int td_grid_reaches(const td_grid *grid, int64_t k, double epoch, double time);

/* The last such point; 0 where there is none. */
int64_t td_grid_last_until(const td_grid *grid, double epoch, double time);

/* The step between two times of the run, in absolute nanoseconds. An event at its very end is put a nanosecond earlier, except
 * at the run's end. So a packet never ends with the nanosecond that the next one begins with, and the stream is in order
 * however it is cut into packets. */
tides_status td_grid_step(const td_grid *grid, double start, double stop, td_step *step, tides_error *error);

#endif
