/* Open paths, whose samples are appended during a run, and copies of paths of any kind. */
#include "camera/td_rotation.h"
#include "camera/td_trajectory.h"
#include "camera/td_trajectory_parts.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- appending ------------------------------------------------------------------------------------------------------ */

/* Points of each segment at which it is checked. */
enum { PROBES = 8 };

/* Checks the last segment between its samples: it must not overflow, and its quaternion must keep an allowed length. */
static tides_status check_segment(const tides_trajectory *t, size_t i, tides_error *error) {
    if (t->open.count < 2) return TIDES_OK;
    const td_knot *to = t->open.knot + t->open.count - 1, *from = to - 1;
    for (int probe = 1; probe < PROBES; probe++) {
        double value[TD_CURVE_WIDTH], rate[TD_CURVE_WIDTH];
        td_open_at(&t->open, from->time + (to->time - from->time) * probe / PROBES, 0, value, rate);
        if (td_curve_value_is_sound(value, rate)) continue;
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "sample %zu (%.17g s): the path from the sample before isn't determined by its rates, or exceeds double "
                       "precision: tell poses that are nearer in time, or their true rates",
                       i, t->samples[i].time);
    }
    return TIDES_OK;
}

/* Refuses samples so close together that a time could belong to either. */
static tides_status check_apart(const tides_trajectory *t, size_t from, size_t count, tides_error *error) {
    enum { SLACKS = 4 }; /* least distance, in rounding errors of a time */
    for (size_t i = from; i < count; i++) {
        if (i == 0) continue;
        const double after = t->samples[i].time - t->samples[i - 1].time;
        const double least = SLACKS * td_trajectory_slack(t, t->origin, t->samples[i].time - t->origin);
        if (!(after > least))
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "sample %zu: its time %.17g s comes %g s after the one before; as late as that poses must be %g s "
                           "apart: "
                           "count time from a nearer second 0",
                           i, t->samples[i].time, after, least);
    }
    return TIDES_OK;
}

/* Appends knots to the curve for the samples from number `from` on, which are stored already. */
static tides_status add_knots(tides_trajectory *t, size_t from, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = from; i < count && status == TIDES_OK; i++) {
        const td_knot knot = td_sample_knot(t->samples + i, t->origin);
        status = td_open_append(&t->open, &knot, t->samples[i].has_rates, t->samples[0].has_rates, error);
        if (status == TIDES_OK) status = check_segment(t, i, error);
    }
    return status;
}

/* Checks the turns of new segments by the samples' rates, if they have any. */
static tides_status check_turns(const tides_trajectory *t, size_t from, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = from; i + 1 < count && status == TIDES_OK; i++)
        if (t->samples[i].has_rates && t->samples[i + 1].has_rates)
            status = td_samples_check_turns(t->samples, i, i + 2, error);
    return status;
}

/* If the first sample has no rate of its own, its knot has one that comes from the second sample. When the second sample is
 * removed, so is this rate. */
void td_trajectory_take_back(tides_trajectory *t, size_t count) {
    t->count = t->open.count = count;
    if (count == 1 && !t->samples[0].has_rates) memset(t->open.knot[0].rate, 0, sizeof t->open.knot[0].rate);
}

tides_status tides_trajectory_append(tides_trajectory *trajectory, const tides_pose_sample *samples, size_t count,
                                     tides_error *error) {
    tides_trajectory *t = trajectory;
    if (!t || !samples) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_trajectory_append: trajectory or samples is NULL");
    if (!t->is_open)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_trajectory_append: this path is known as a whole; one that tides_trajectory_create_open made can "
                       "be appended to");
    const size_t before = t->count, last = before ? before - 1 : 0;
    tides_status status = td_reserve((void **)&t->samples, &t->capacity, before + count, sizeof *t->samples, error);
    if (status != TIDES_OK) return status;
    memcpy(t->samples + before, samples, count * sizeof *samples);
    status = td_samples_check(t->samples, before, before + count, t->origin, error);
    if (status == TIDES_OK) status = check_apart(t, before, before + count, error);
    if (status == TIDES_OK) status = td_samples_align(t->samples, before, before + count, error);
    if (status == TIDES_OK) status = check_turns(t, last, before + count, error);
    if (status == TIDES_OK) status = add_knots(t, before, before + count, error);
    if (status == TIDES_OK)
        t->count += count;
    else
        td_trajectory_take_back(t, before);
    return status;
}

tides_status tides_trajectory_create_open(const tides_pose_sample *samples, size_t count, tides_trajectory **trajectory,
                                          tides_error *error) {
    if (!samples || !trajectory || count == 0)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "an open path needs the sample that it begins with and a place for the result");
    tides_trajectory *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->is_open = 1;
    made->origin = samples->time;
    tides_status status = tides_trajectory_append(made, samples, count, error);
    if (status == TIDES_OK)
        *trajectory = made;
    else
        tides_trajectory_destroy(made);
    return status;
}

tides_status td_trajectory_begin(tides_trajectory *t, const tides_pose_sample *first, tides_error *error) {
    tides_trajectory *made = NULL;
    tides_status status = tides_trajectory_create_open(first, 1, &made, error);
    if (status != TIDES_OK || !made) return status;
    t->samples[0] = made->samples[0];
    t->open.knot[0] = made->open.knot[0];
    t->origin = made->origin;
    t->count = t->open.count = 1;
    tides_trajectory_destroy(made);
    return TIDES_OK;
}

int32_t tides_trajectory_is_open(const tides_trajectory *trajectory) { return trajectory ? trajectory->is_open : 0; }

void tides_trajectory_forget(tides_trajectory *trajectory, double time) {
    if (!trajectory || !trajectory->is_open) return;
    const size_t gone = td_open_forget(&trajectory->open, time - trajectory->origin);
    if (gone == 0) return;
    trajectory->count -= gone;
    memmove(trajectory->samples, trajectory->samples + gone, trajectory->count * sizeof *trajectory->samples);
}

int32_t td_trajectory_reaches(const tides_trajectory *trajectory, double epoch, double offset) {
    if (!trajectory || !trajectory->is_open) return 1;
    const double relative = (epoch - trajectory->origin) + offset;
    const double told = trajectory->samples[trajectory->count - 1].time - trajectory->origin;
    return relative <= told + td_trajectory_slack(trajectory, epoch, relative);
}

/* -- copies --------------------------------------------------------------------------------------------------------- */

static tides_status copy_open(const tides_trajectory *from, tides_trajectory **copy, tides_error *error) {
    tides_trajectory *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    *made = *from;
    made->capacity = made->open.capacity = 0;
    made->samples = NULL;
    made->open.knot = NULL;
    tides_status status = td_reserve((void **)&made->samples, &made->capacity, from->count, sizeof *made->samples, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&made->open.knot, &made->open.capacity, from->open.count, sizeof *made->open.knot, error);
    if (status != TIDES_OK) {
        tides_trajectory_destroy(made);
        return status;
    }
    memcpy(made->samples, from->samples, from->count * sizeof *made->samples);
    memcpy(made->open.knot, from->open.knot, from->open.count * sizeof *made->open.knot);
    *copy = made;
    return TIDES_OK;
}

tides_status td_trajectory_copy(const tides_trajectory *trajectory, tides_trajectory **copy, tides_error *error) {
    if (trajectory->is_open) return copy_open(trajectory, copy, error);
    tides_status status = tides_trajectory_create(trajectory->samples, trajectory->count, copy, error);
    if (status != TIDES_OK) return status;
    (*copy)->mounted = trajectory->mounted;
    (*copy)->mount = trajectory->mount;
    return TIDES_OK;
}

tides_status tides_trajectory_create_mounted(const tides_trajectory *body, const double position[3], const double quaternion[4],
                                             tides_trajectory **trajectory, tides_error *error) {
    if (!body || !position || !quaternion || !trajectory)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "a mounted path needs a body's, a position, a quaternion and a place for the result");
    double q[4];
    memcpy(q, quaternion, sizeof q);
    if (!td_all_finite(position, 3) || !td_all_finite(quaternion, 4) || !td_normalise_quaternion(q))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "a mount needs finite numbers, and a quaternion that isn't zero (1 0 0 0 is no turn)");
    tides_trajectory *made = NULL;
    tides_status status = td_trajectory_copy(body, &made, error);
    if (status != TIDES_OK) return status;
    td_mount none;
    td_mount_none(&none);
    td_mount_add(body->mounted ? &body->mount : &none, position, q, &made->mount);
    made->mounted = 1;
    *trajectory = made;
    return TIDES_OK;
}
