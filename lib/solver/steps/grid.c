/* The grid of steps: regular points and knots, by number and by time. */
#include "solver/td_grid.h"
#include "td_base.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A last step shorter than this share of the others is joined to the one before it. The share exceeds the rounding of a stop
 * near 2e9 s (2.4e-7 s) for steps of a millisecond, so that a run of ten such steps has ten. It doesn't depend on the epoch, so
 * that the same run at another time has the same steps. */
static const double least_last_step = 1.0 / 1024;

/* Two times that are closer than event times resolve are one [s]. */
static const double same_time = 1e-9;

static double regular_time(const td_grid *grid, int64_t k) {
    return k >= grid->regular ? grid->stop : grid->start + (double)k * grid->step_s;
}

/* The regular points before `time`. */
static int64_t regular_before(const td_grid *grid, double time) {
    int64_t k = (int64_t)((time - grid->start) / grid->step_s);
    k = k < 0 ? 0 : k > grid->regular ? grid->regular : k;
    while (k <= grid->regular && regular_time(grid, k) < time) k++;
    while (k > 0 && regular_time(grid, k - 1) >= time) k--;
    return k;
}

/* Inserts a knot behind the knots that are there. */
static void add_knot(td_grid *grid, double time, double gap, int64_t *last_replaced) {
    int64_t before = regular_before(grid, time), replaced = grid->knots ? grid->replaced[grid->knots - 1] : 0;
    int64_t near = before;
    if (before > 0 && time - regular_time(grid, before - 1) < regular_time(grid, before) - time) near = before - 1;
    int inner = near > 0 && near < grid->regular; /* the run's ends stay */
    int gives_way = inner && near != *last_replaced && fabs(regular_time(grid, near) - time) < gap;
    if (gives_way) {
        *last_replaced = near;
        before = near; /* this point gives way to the knot */
    } else if (*last_replaced >= before) {
        before = *last_replaced + 1; /* this point has given way to the knot before; `replaced` counts it */
    }
    grid->knot[grid->knots] = time;
    grid->point[grid->knots] = before - replaced + (int64_t)grid->knots;
    grid->replaced[grid->knots] = replaced + gives_way;
    grid->knots++;
}

tides_status td_grid_create(double start, double stop, double step_s, const double *knots, size_t count, double gap,
                            td_grid *grid, tides_error *error) {
    memset(grid, 0, sizeof *grid);
    grid->start = start;
    grid->stop = stop;
    grid->step_s = step_s;
    grid->regular = (int64_t)ceil((stop - start) / step_s - least_last_step);
    if (grid->regular < 1) grid->regular = 1;
    grid->knot = td_alloc(count + 1, sizeof *grid->knot, error);
    grid->point = td_alloc(count + 1, sizeof *grid->point, error);
    grid->replaced = td_alloc(count + 1, sizeof *grid->replaced, error);
    if (!grid->knot || !grid->point || !grid->replaced) {
        td_grid_release(grid);
        return TIDES_NO_MEMORY;
    }
    gap = gap < same_time ? same_time : gap;
    gap = gap < 0.5 * step_s ? gap : 0.5 * step_s;
    int64_t last_replaced = -1;
    for (size_t i = 0; i < count; i++)
        if (knots[i] > start + same_time && knots[i] < stop - same_time) add_knot(grid, knots[i], gap, &last_replaced);
    grid->steps = grid->regular + (int64_t)grid->knots - (grid->knots ? grid->replaced[grid->knots - 1] : 0);
    return TIDES_OK;
}

void td_grid_release(td_grid *grid) {
    free(grid->knot);
    free(grid->point);
    free(grid->replaced);
    memset(grid, 0, sizeof *grid);
}

/* Knots whose point is at or before k. */
static size_t knots_until(const td_grid *grid, int64_t k) {
    size_t low = 0, high = grid->knots;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (grid->point[middle] <= k)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

double td_grid_at(const td_grid *grid, int64_t k) {
    if (k >= grid->steps) return grid->stop;
    size_t knots = knots_until(grid, k);
    if (knots == 0) return regular_time(grid, k);
    if (grid->point[knots - 1] == k) return grid->knot[knots - 1];
    return regular_time(grid, k - (int64_t)knots + grid->replaced[knots - 1]);
}

int td_grid_is_knot(const td_grid *grid, int64_t k) {
    size_t knots = knots_until(grid, k);
    return knots > 0 && grid->point[knots - 1] == k;
}

/* By how much a point may seem later than the time that a caller means. The epoch, the step and the caller's sum are each off
 * by half a unit in the last place, and a clock that adds steps up by as much at each. Added errors count for at most half of
 * what lib/camera/trajectory.c allows for open paths, so that a path which was extended to such a time covers the step. All of
 * it is at most a quarter of a step, for late epochs, at which doubles hardly tell points apart. */
static double rounding_at(const td_grid *grid, double epoch, double at) {
    static const double most_added = 0.5e-10;
    const double late = fabs(epoch) + fabs(at), added = 0.5 * (at - grid->start) / grid->step_s * DBL_EPSILON * late;
    return fmin(DBL_EPSILON * (late + fabs(at)) + fmin(added, most_added), 0.25 * grid->step_s);
}

int td_grid_reaches(const td_grid *grid, int64_t k, double epoch, double time) {
    const double at = td_grid_at(grid, k);
    return epoch + at <= time || at - (time - epoch) <= rounding_at(grid, epoch, at);
}

int64_t td_grid_last_until(const td_grid *grid, double epoch, double time) {
    int64_t low = 0, high = grid->steps; /* the answer is in [low, high] */
    while (low < high) {
        int64_t middle = low + (high - low + 1) / 2;
        if (td_grid_reaches(grid, middle, epoch, time))
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

tides_status td_grid_step(const td_grid *grid, double start, double stop, td_step *step, tides_error *error) {
    tides_status status = td_step_between(start, stop, step, error);
    if (status != TIDES_OK) return status;
    step->start_ns += grid->epoch_ns;
    step->stop_ns += grid->epoch_ns;
    if (stop < grid->stop && step->stop_ns > step->start_ns) step->stop_ns--;
    return TIDES_OK;
}
