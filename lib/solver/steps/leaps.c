/* The run's grid of steps: regular points, knots of motions, and the ends of leaps.
 *
 * Between two samples that are close in time a path may go further than in all the time around them: a cut of the scene, or a
 * tracker that lost its target. Sweeps cut an interval into equal pieces until each is followed. So a leap of a microsecond had
 * 10 ms simulated in microseconds: 12 279 renders where 69 are enough (bench stability, leap-1e-6). As a step of its own it
 * costs only what happens in it. Leaps of open paths aren't known in time, and get no steps of their own. */
#include "camera/td_trajectory.h"
#include "solver/td_simulator.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

/* A leap takes less time, by this factor, than the intervals before and after it. */
static const double shorter = 32;

/* Times [s after the epoch]. */
typedef struct times {
    double *time;
    size_t count, capacity;
} times;

static tides_status add_time(times *to, double time, tides_error *error) {
    tides_status status = td_reserve((void **)&to->time, &to->capacity, to->count + 1, sizeof *to->time, error);
    if (status == TIDES_OK) to->time[to->count++] = time;
    return status;
}

/* The path between two samples. */
typedef struct way {
    double seconds, distance, turn; /* turn: 1 - cos of half the angle */
} way;

static way way_between(const tides_pose_sample *a, const tides_pose_sample *b) {
    double square = 0, dot = 0;
    for (int k = 0; k < 3; k++) square += (b->position[k] - a->position[k]) * (b->position[k] - a->position[k]);
    for (int k = 0; k < 4; k++) dot += a->quaternion[k] * b->quaternion[k];
    return (way){b->time - a->time, sqrt(square), 1 - fabs(dot)};
}

/* From sample i of a path to the next. Before the first and after the last sample the path rests. */
static tides_status way_after(const tides_trajectory *path, size_t i, way *found, tides_error *error) {
    tides_pose_sample a, b;
    *found = (way){INFINITY, 0, 0};
    if (i + 1 >= tides_trajectory_count(path)) return TIDES_OK;
    tides_status status = tides_trajectory_sample(path, i, &a, error);
    if (status == TIDES_OK) status = tides_trajectory_sample(path, i + 1, &b, error);
    if (status == TIDES_OK) *found = way_between(&a, &b);
    return status;
}

static int is_leap(const way *before, const way *own, const way *after) {
    return own->seconds * shorter < before->seconds && own->seconds * shorter < after->seconds &&
           ((own->distance > before->distance && own->distance > after->distance) ||
            (own->turn > before->turn && own->turn > after->turn));
}

/* Adds both ends of each leap of a path, in a run of `length` seconds. */
static tides_status add_leaps(const tides_trajectory *path, double epoch, double length, times *to, tides_error *error) {
    way before = {INFINITY, 0, 0}, own, after;
    tides_pose_sample begin;
    if (!path || tides_trajectory_is_static(path) || tides_trajectory_is_open(path)) return TIDES_OK;
    size_t i = td_trajectory_find(path, epoch, 0);
    tides_status status = i > 0 ? way_after(path, i - 1, &before, error) : TIDES_OK;
    if (status == TIDES_OK) status = way_after(path, i, &own, error);
    for (; status == TIDES_OK && i + 1 < tides_trajectory_count(path); i++, before = own, own = after) {
        status = tides_trajectory_sample(path, i, &begin, error);
        if (status != TIDES_OK || begin.time - epoch > length) break;
        status = way_after(path, i + 1, &after, error);
        if (status != TIDES_OK || !is_leap(&before, &own, &after)) continue;
        status = add_time(to, begin.time - epoch, error);
        if (status == TIDES_OK) status = add_time(to, begin.time - epoch + own.seconds, error);
    }
    return status;
}

static tides_status find_leaps(const tides_simulator *s, times *to, tides_error *error) {
    tides_status status = add_leaps(s->camera, s->epoch, s->length, to, error);
    for (int32_t i = 0; i < tides_scene_objects(s->scene) && status == TIDES_OK; i++) {
        tides_object object;
        status = tides_scene_object(s->scene, i, &object, error);
        if (status == TIDES_OK) status = add_leaps(object.trajectory, s->epoch, s->length, to, error);
    }
    return status;
}

/* Regular steps stay equal; knots cut them. */
tides_status td_lay_grid(tides_simulator *s, tides_error *error) {
    size_t knots;
    const double *knot = td_renderer_knots(s->renderer, &knots);
    times all = {NULL, 0, 0};
    tides_status status = s->given.mode == TIDES_STEPPING_FIXED ? TIDES_OK : find_leaps(s, &all, error);
    const size_t leaps = all.count;
    for (size_t k = 0; k < knots && leaps > 0 && status == TIDES_OK; k++) status = add_time(&all, knot[k], error);
    if (leaps > 0) {
        qsort(all.time, all.count, sizeof *all.time, td_ascending);
        knot = all.time, knots = all.count;
    }
    if (status == TIDES_OK)
        status = td_grid_create(0, s->length, s->given.step_s, knot, knots, s->given.min_step_s, &s->grid, error);
    s->grid.epoch_ns = td_time_ns(s->epoch);
    free(all.time);
    return status;
}
