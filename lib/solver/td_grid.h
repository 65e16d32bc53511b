/* Internal: the times at which steps begin and end: start + k step_s, and the knots of motions, at which rates may jump. */
#ifndef TD_GRID_H
#define TD_GRID_H

#include "signal/td_step.h"
#include "tides/base.h"

#include <stddef.h>

/* Points are numbered from 0, at `start`, to `steps`, at `stop`. Regular points are products, not running sums. A regular point
 * closer to a knot than `gap` gives way to it, so that no tiny step is left. For the same reason a last step shorter than
 * 1/1024 of the others is joined to the one before. A run's grid counts from its start: `start` is 0. */
typedef struct td_grid {
    double start, stop, step_s;
    int64_t regular; /* steps there would be without knots */
    int64_t steps;
    size_t knots;
    double *knot;      /* (knots) [s], ascending, within (start, stop) */
    int64_t *point;    /* (knots) number of the knot's point */
    int64_t *replaced; /* regular points that gave way to this knot and those before */
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

/* 1 where epoch + the time of point k is at or before `time`, except for rounding. Callers compute times as epoch + k step_s,
 * write them down in decimals, or add steps up. */
int td_grid_reaches(const td_grid *grid, int64_t k, double epoch, double time);

/* The last point k for which td_grid_reaches is 1; 0 where there is none. */
int64_t td_grid_last_until(const td_grid *grid, double epoch, double time);

/* The step between two times of the run, in absolute nanoseconds. The step's last nanosecond belongs to the next step, except
 * at the run's end: an event at the very end is put a nanosecond earlier. So packets never overlap, and the stream is in order
 * however it is cut into packets. */
tides_status td_grid_step(const td_grid *grid, double start, double stop, td_step *step, tides_error *error);

#endif
