/* Camera paths: samples of a rigid motion, a curve through them, and the pose and its exact rate at any time.
 *
 * Position and quaternion are one curve in R^7. Each quaternion has the sign nearer to its predecessor (q and -q are the same
 * rotation), and the curve's quaternion is divided by its length. The result is as smooth as the curve (C2, C3 with rates),
 * passes exactly through the samples, and allows uneven times; its rate is by the quotient rule. The length must stay away
 * from zero, so neighbouring samples must be less than TD_MOST_TURN apart.
 *
 * Times are stored relative to the first sample, so that large ones, such as ROS stamps of 1e9 s, lose no precision. */
#include "tides/trajectory.h"

#include "camera/td_rotation.h"
#include "camera/td_trajectory.h"
#include "camera/td_trajectory_parts.h"
#include "td_base.h"
#include "td_math.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest turn between neighbouring samples [rad]: 179 degrees. At 180 degrees the direction of the turn would be ambiguous. */
#define TD_MOST_TURN 3.1241393610698500

/* Allowed lengths of the curve's quaternion between samples, checked at 8 points of each segment. With evenly turning samples
 * it stays within 0.93 and 1.1. With random rotations at random times it is within 0.5 and 2 on 95 % of paths of eight
 * samples. A quick turn beside a long gap makes the spline swing, by half a turn or more beyond these lengths. */
#define TD_LEAST_LENGTH 0.1
#define TD_MOST_LENGTH 10.0
#define TD_LENGTH_PROBES 8

tides_status td_samples_check(const tides_pose_sample *samples, size_t from, size_t count, double origin, tides_error *error) {
    for (size_t i = from; i < count; i++) {
        const tides_pose_sample *s = samples + i;
        if (!isfinite(s->time) || !td_all_finite(s->position, 3) || !td_all_finite(s->quaternion, 4))
            return td_fail(error, TIDES_BAD_ARGUMENT, "sample %zu: time, position and quaternion must be finite numbers", i);
        if (s->has_rates && (!td_all_finite(s->velocity, 3) || !td_all_finite(s->angular_velocity, 3)))
            return td_fail(error, TIDES_BAD_ARGUMENT, "sample %zu: velocity and angular velocity must be finite numbers", i);
        if (i && s->time > s[-1].time && !(s->time - origin > s[-1].time - origin))
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "samples %zu and %zu: their times %s s and %s s are too close, or too far from the first "
                           "sample's %s s, to be told apart in double precision",
                           i - 1, i, TD_SHORT(s[-1].time), TD_SHORT(s->time), TD_SHORT(origin));
        if (i && !(s->time > s[-1].time))
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "sample %zu: its time %s s %s that of sample %zu, %s s; times must strictly increase%s", i,
                           TD_SHORT(s->time), s->time < s[-1].time ? "comes before" : "equals", i - 1, TD_SHORT(s[-1].time),
                           s->time < s[-1].time ? ": sort the samples" : ": drop one of the two");
    }
    return TIDES_OK;
}

tides_status td_samples_align(tides_pose_sample *samples, size_t from, size_t count, tides_error *error) {
    for (size_t i = from; i < count; i++) {
        double *q = samples[i].quaternion, dot = 0.0;
        if (!td_normalise_quaternion(q))
            return td_fail(error, TIDES_BAD_ARGUMENT, "sample %zu: its quaternion is zero; give a rotation (1 0 0 0 is none)",
                           i);
        if (i == 0) continue;
        for (int k = 0; k < 4; k++) dot += q[k] * samples[i - 1].quaternion[k];
        for (int k = 0; k < 4; k++) q[k] = dot < 0.0 ? -q[k] : q[k];
        double turn = 2.0 * td_acos(fmin(fabs(dot), 1.0));
        if (turn >= TD_MOST_TURN)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "samples %zu and %zu (%s s and %s s) are turned by %.1f degrees against each other; which way "
                           "round isn't determined: give denser samples",
                           i - 1, i, TD_SHORT(samples[i - 1].time), TD_SHORT(samples[i].time), turn * 57.29577951308232);
    }
    return TIDES_OK;
}

tides_status td_samples_check_turns(const tides_pose_sample *samples, size_t from, size_t count, tides_error *error) {
    for (size_t i = from; i + 1 < count; i++) {
        const double rate = fmax(td_length3(samples[i].angular_velocity), td_length3(samples[i + 1].angular_velocity));
        const double span = samples[i + 1].time - samples[i].time;
        if (rate * span >= TD_MOST_TURN)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "samples %zu and %zu (%s s and %s s): an angular velocity of %g rad/s turns by %.1f degrees "
                           "between them; give samples less than 179 degrees apart",
                           i, i + 1, TD_SHORT(samples[i].time), TD_SHORT(samples[i + 1].time), rate,
                           rate * span * 57.29577951308232);
    }
    return TIDES_OK;
}

int td_curve_value_is_sound(const double value[TD_CURVE_WIDTH], const double rate[TD_CURVE_WIDTH]) {
    if (!td_all_finite(value, TD_CURVE_WIDTH) || !td_all_finite(rate, TD_CURVE_WIDTH)) return 0;
    const double *q = value + 3;
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return square > TD_LEAST_LENGTH * TD_LEAST_LENGTH && square < TD_MOST_LENGTH * TD_MOST_LENGTH;
}

/* Checks the curve between samples: it must not overflow, and its quaternion must keep an allowed length. */
static tides_status check_curve(const tides_trajectory *trajectory, tides_error *error) {
    const tides_pose_sample *s = trajectory->samples;
    for (size_t i = 0; i + 1 < trajectory->count; i++)
        for (int probe = 1; probe < TD_LENGTH_PROBES; probe++) {
            double from = s[i].time - s[0].time, to = s[i + 1].time - s[0].time, value[TD_CURVE_WIDTH], rate[TD_CURVE_WIDTH];
            td_curve_at(trajectory->curve, i, from + (to - from) * probe / TD_LENGTH_PROBES, value, rate);
            if (!td_all_finite(value, TD_CURVE_WIDTH) || !td_all_finite(rate, TD_CURVE_WIDTH))
                return td_fail(error, TIDES_BAD_ARGUMENT,
                               "the path between samples %zu and %zu (%s s and %s s) exceeds double precision: positions "
                               "are too large or times too close",
                               i, i + 1, TD_SHORT(s[i].time), TD_SHORT(s[i + 1].time));
            if (!td_curve_value_is_sound(value, rate))
                return td_fail(error, TIDES_BAD_ARGUMENT,
                               "the rotation between samples %zu and %zu (%s s and %s s) isn't determined by its "
                               "neighbours, which turn far faster: give denser samples there",
                               i, i + 1, TD_SHORT(s[i].time), TD_SHORT(s[i + 1].time));
        }
    return TIDES_OK;
}

td_knot td_sample_knot(const tides_pose_sample *sample, double origin) {
    td_knot knot = {.time = sample->time - origin};
    memcpy(knot.value, sample->position, sizeof sample->position);
    memcpy(knot.value + 3, sample->quaternion, sizeof sample->quaternion);
    memcpy(knot.rate, sample->velocity, sizeof sample->velocity);
    td_quaternion_rate(sample->quaternion, sample->angular_velocity, knot.rate + 3);
    return knot;
}

/* Makes the curve through the (aligned) samples of a path that moves. */
static tides_status build_curve(tides_trajectory *trajectory, tides_error *error) {
    size_t count = trajectory->count;
    const tides_pose_sample *samples = trajectory->samples;
    int with_rates = 1;
    for (size_t i = 0; i < count; i++) with_rates = with_rates && samples[i].has_rates;
    if (with_rates && td_samples_check_turns(samples, 0, count, error) != TIDES_OK) return TIDES_BAD_ARGUMENT;
    td_knot *knots = td_alloc(count, sizeof *knots, error);
    if (!knots) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) knots[i] = td_sample_knot(samples + i, trajectory->origin);
    trajectory->curve = td_curve_create(knots, count, with_rates, error);
    free(knots);
    return trajectory->curve ? check_curve(trajectory, error) : TIDES_NO_MEMORY;
}

tides_status tides_trajectory_create(const tides_pose_sample *samples, size_t count, tides_trajectory **trajectory,
                                     tides_error *error) {
    if (!samples || !trajectory || count == 0)
        return td_fail(error, TIDES_BAD_ARGUMENT, "a trajectory needs at least one sample and a place for the result");
    tides_status status = td_samples_check(samples, 0, count, samples->time, error);
    if (status != TIDES_OK) return status;
    status = TIDES_NO_MEMORY;
    tides_trajectory *made = td_alloc(1, sizeof *made, error);
    if (!made) goto done;
    made->count = count;
    made->origin = samples->time;
    made->samples = td_alloc(count, sizeof *samples, error);
    if (!made->samples) goto done;
    memcpy(made->samples, samples, count * sizeof *samples);
    status = td_samples_align(made->samples, 0, count, error);
    if (status == TIDES_OK && count > 1) status = build_curve(made, error);
    if (status != TIDES_OK) goto done;
    *trajectory = made;
    made = NULL;
done:
    tides_trajectory_destroy(made);
    return status;
}

tides_status tides_trajectory_create_static(const double position[3], const double quaternion[4], tides_trajectory **trajectory,
                                            tides_error *error) {
    if (!position || !quaternion)
        return td_fail(error, TIDES_BAD_ARGUMENT, "a static trajectory needs a position and a quaternion");
    tides_pose_sample sample = {0};
    memcpy(sample.position, position, sizeof sample.position);
    memcpy(sample.quaternion, quaternion, sizeof sample.quaternion);
    return tides_trajectory_create(&sample, 1, trajectory, error);
}

void tides_trajectory_destroy(tides_trajectory *trajectory) {
    if (!trajectory) return;
    td_curve_destroy(trajectory->curve);
    free(trajectory->open.knot);
    free(trajectory->samples);
    free(trajectory);
}

/* Normalises the curve's quaternion, and computes the rate of the result. */
static void normalise_with_rate(double q[4], double q_dot[4]) {
    double square = 0.0, along = 0.0;
    for (int k = 0; k < 4; k++) square += q[k] * q[k];
    double length = sqrt(square);
    for (int k = 0; k < 4; k++) {
        q[k] /= length;
        q_dot[k] /= length;
        along += q[k] * q_dot[k];
    }
    for (int k = 0; k < 4; k++) q_dot[k] -= along * q[k];
}

/* Callers of open paths add up intervals. The rounding error is 0.1 ns after 1e4 steps of a millisecond, and is below an
 * event's time resolution. */
static const double lost_in_sums = 1e-10;

double td_trajectory_slack(const tides_trajectory *t, double epoch, double relative) {
    const double rounding = 2 * DBL_EPSILON * (fabs(epoch) + fabs(t->origin) + fabs(relative));
    return t->is_open ? lost_in_sums + rounding : rounding;
}

/* Pose of the body at `relative`, a time on the path's own clock and within the path; `slack` is the time's largest rounding
 * error. */
static void body_at(const tides_trajectory *trajectory, double relative, double slack, tides_pose *pose) {
    const tides_pose_sample *first = trajectory->samples;
    if (!trajectory->curve && !trajectory->is_open) {
        memset(pose, 0, sizeof *pose);
        memcpy(pose->position, first->position, sizeof pose->position);
        td_rotation_from_quaternion(first->quaternion, pose->rotation);
        return;
    }
    double value[TD_CURVE_WIDTH], rate[TD_CURVE_WIDTH];
    if (trajectory->is_open)
        td_open_at(&trajectory->open, relative, slack, value, rate);
    else
        td_curve_at(trajectory->curve, td_curve_find(trajectory->curve, relative), relative, value, rate);
    memcpy(pose->position, value, sizeof pose->position);
    memcpy(pose->position_dot, rate, sizeof pose->position_dot);
    normalise_with_rate(value + 3, rate + 3);
    td_rotation_from_quaternion(value + 3, pose->rotation);
    td_rotation_rate(value + 3, rate + 3, pose->rotation_dot);
}

static void pose_at(const tides_trajectory *trajectory, double relative, double slack, tides_pose *pose) {
    body_at(trajectory, relative, slack, pose);
    if (trajectory->mounted) td_mount_pose(&trajectory->mount, pose);
}

static tides_status fail_outside(const tides_trajectory *trajectory, double time, tides_error *error) {
    return td_fail(error, TIDES_OUT_OF_RANGE,
                   "time %s s lies outside the path, which covers %s s to %s s: shorten the run or give a longer "
                   "path",
                   TD_SHORT(time), TD_SHORT(trajectory->samples[0].time),
                   TD_SHORT(trajectory->samples[trajectory->count - 1].time));
}

static tides_status fail_arguments(tides_error *error) {
    return td_fail(error, TIDES_BAD_ARGUMENT, "a pose needs a trajectory, a time that is a number, and a place for the result");
}

tides_status tides_trajectory_at(const tides_trajectory *trajectory, double time, tides_pose *pose, tides_error *error) {
    if (!trajectory || !pose || isnan(time)) return fail_arguments(error);
    const tides_pose_sample *first = trajectory->samples, *last = first + trajectory->count - 1;
    const int32_t moves = trajectory->curve || trajectory->is_open;
    if (moves && (time < first->time || time > last->time)) return fail_outside(trajectory, time, error);
    const double relative = time - trajectory->origin;
    pose_at(trajectory, relative, td_trajectory_slack(trajectory, 0, relative), pose);
    return TIDES_OK;
}

/* Refuses an acceleration of an open path, whose curve is only C1. */
static tides_status fail_open(tides_error *error) {
    return td_fail(error, TIDES_UNSUPPORTED,
                   "an open path's acceleration jumps at every sample, where an IMU would feel a blow; make a path of its "
                   "samples "
                   "with tides_trajectory_create");
}

/* Refuses the range if the curve is only C1 at a sample within it: there it has two accelerations. */
static tides_status check_bends(const tides_trajectory *trajectory, double start, double stop, tides_error *error) {
    const size_t bend = trajectory->curve ? td_curve_first_bend(trajectory->curve, start, stop) : trajectory->count;
    if (bend >= trajectory->count) return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED,
                   "the path isn't C2 at sample %zu, %s s, so that its acceleration jumps: samples there are far closer "
                   "than "
                   "their neighbours, and a spline would swing; give evenly timed ones",
                   bend, TD_SHORT(trajectory->samples[bend].time));
}

tides_status td_trajectory_check_smooth(const tides_trajectory *trajectory, double start, double stop, tides_error *error) {
    const double from = trajectory->origin;
    if (trajectory->is_open) return fail_open(error);
    return check_bends(trajectory, start - from, stop - from, error);
}

/* Adds R_ddot m, the acceleration by rotation at the end of a mount's arm m. For the unit quaternion u = q / |q|, with a = u
 * . q_dot, the second derivative is u_ddot = q_ddot - 2 a q_dot - (q_dot . q_dot + u . q_ddot) u + 3 a^2 u, with q's
 * derivatives divided by |q|. R is quadratic in u, and td_rotation_rate is bilinear, so R_ddot = rate(u, u_ddot) +
 * rate(u_dot, u_dot). */
static void add_swing(const tides_trajectory *trajectory, double relative, const double q_ddot[4], double acceleration[3]) {
    double value[TD_CURVE_WIDTH], rate[TD_CURVE_WIDTH], second[4], bent[9], turned[9], length = 0, a = 0, b = 0;
    td_curve_at(trajectory->curve, td_curve_find(trajectory->curve, relative), relative, value, rate);
    double *u = value + 3, *v = rate + 3;
    for (int k = 0; k < 4; k++) length += u[k] * u[k];
    length = sqrt(length);
    for (int k = 0; k < 4; k++) u[k] /= length, v[k] /= length, second[k] = q_ddot[k] / length;
    for (int k = 0; k < 4; k++) a += u[k] * v[k], b += v[k] * v[k] + u[k] * second[k];
    for (int k = 0; k < 4; k++) second[k] += (3 * a * a - b) * u[k] - 2 * a * v[k];
    for (int k = 0; k < 4; k++) v[k] -= a * u[k];
    td_rotation_rate(u, second, bent);
    td_rotation_rate(v, v, turned);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) acceleration[i] += (bent[3 * i + k] + turned[3 * i + k]) * trajectory->mount.position[k];
}

tides_status tides_trajectory_acceleration(const tides_trajectory *trajectory, double time, double acceleration[3],
                                           tides_error *error) {
    tides_pose pose;
    if (!acceleration) return fail_arguments(error);
    tides_status status = tides_trajectory_at(trajectory, time, &pose, error);
    if (status != TIDES_OK) return status;
    const double relative = time - trajectory->origin;
    if (trajectory->is_open) return fail_open(error);
    double second[TD_CURVE_WIDTH] = {0};
    status = check_bends(trajectory, nextafter(relative, -INFINITY), nextafter(relative, INFINITY), error);
    if (status != TIDES_OK) return status;
    if (trajectory->curve) td_curve_second(trajectory->curve, td_curve_find(trajectory->curve, relative), relative, second);
    memcpy(acceleration, second, 3 * sizeof *acceleration);
    if (trajectory->mounted && trajectory->curve) add_swing(trajectory, relative, second + 3, acceleration);
    return TIDES_OK;
}

tides_status td_trajectory_at(const tides_trajectory *trajectory, double epoch, double offset, tides_pose *pose,
                              tides_error *error) {
    if (!trajectory || !pose || isnan(epoch) || isnan(offset)) return fail_arguments(error);
    const double from = trajectory->samples[0].time - trajectory->origin,
                 to = trajectory->samples[trajectory->count - 1].time - trajectory->origin;
    const double relative = (epoch - trajectory->origin) + offset;
    const double slack = td_trajectory_slack(trajectory, epoch, trajectory->is_open ? relative : to);
    if ((trajectory->curve || trajectory->is_open) && (relative < from - slack || relative > to + slack))
        return fail_outside(trajectory, epoch + offset, error);
    pose_at(trajectory, trajectory->is_open ? relative : fmin(fmax(relative, 0), to), slack, pose);
    return TIDES_OK;
}

size_t td_trajectory_find(const tides_trajectory *trajectory, double epoch, double offset) {
    const double relative = (epoch - trajectory->origin) + offset;
    if (trajectory->is_open) return td_open_find(&trajectory->open, relative);
    return trajectory->curve ? td_curve_find(trajectory->curve, relative) : 0;
}

void tides_trajectory_range(const tides_trajectory *trajectory, double *start, double *stop) {
    int moves = trajectory && (trajectory->curve || trajectory->is_open);
    if (start) *start = moves ? trajectory->samples[0].time : -INFINITY;
    if (stop) *stop = moves ? trajectory->samples[trajectory->count - 1].time : INFINITY;
}

int32_t tides_trajectory_is_static(const tides_trajectory *trajectory) {
    return trajectory && !trajectory->curve && !trajectory->is_open;
}

size_t tides_trajectory_count(const tides_trajectory *trajectory) { return trajectory ? trajectory->count : 0; }

tides_status tides_trajectory_sample(const tides_trajectory *trajectory, size_t index, tides_pose_sample *sample,
                                     tides_error *error) {
    if (!trajectory || !sample)
        return td_fail(error, TIDES_BAD_ARGUMENT, "a sample needs a trajectory and a place for the result");
    if (index >= trajectory->count)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sample %zu doesn't exist; the path has %zu samples, numbered from 0", index,
                       trajectory->count);
    *sample = trajectory->samples[index];
    if (trajectory->mounted) td_mount_sample(&trajectory->mount, sample);
    return TIDES_OK;
}
