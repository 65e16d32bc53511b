/* Internal: what a path is made of, for trajectory.c (paths that are known as a whole) and trajectory_open.c (those told as
 * they go). */
#ifndef TD_TRAJECTORY_PARTS_H
#define TD_TRAJECTORY_PARTS_H

#include "camera/td_curve.h"
#include "camera/td_mount.h"
#include "camera/td_open.h"
#include "tides/trajectory.h"

struct tides_trajectory {
    tides_pose_sample *samples; /* quaternions normalised and sign-aligned; of an open path those that it still has */
    size_t count, capacity;
    double origin;   /* [s] of its first sample: the curve's times count from there */
    td_curve *curve; /* NULL: static, or open */
    td_open open;    /* of a path that is told as it goes */
    int32_t is_open;
    int32_t mounted; /* 1: samples and curve are a body's, and this is `mount` on it */
    td_mount mount;
};

/* Samples from number `from` on, of a path whose first was at `origin`: finite, in order, distinct. */
tides_status td_samples_check(const tides_pose_sample *samples, size_t from, size_t count, double origin, tides_error *error);

/* Normalises their quaternions, and gives each the sign that is nearer to its predecessor. */
tides_status td_samples_align(tides_pose_sample *samples, size_t from, size_t count, tides_error *error);

/* Angular velocities that turn by more than half a turn within a segment, from sample `from` on, say that samples skip turns.
 * */
tides_status td_samples_check_turns(const tides_pose_sample *samples, size_t from, size_t count, tides_error *error);

/* An aligned sample as a knot of the curve. */
td_knot td_sample_knot(const tides_pose_sample *sample, double origin);

/* 1 where a curve's value and rate are finite, its quaternion of a length that can be divided by. */
int td_curve_value_is_sound(const double value[TD_CURVE_WIDTH], const double rate[TD_CURVE_WIDTH]);

/* How far apart two times are the same one: what doubles make of an epoch and sums of intervals. */
double td_trajectory_slack(const tides_trajectory *trajectory, double epoch, double relative);

#endif
