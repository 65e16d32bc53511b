/* Internal: the struct behind a path, shared by paths known as a whole and open paths, whose samples are appended during a
 * run. */
#ifndef TD_TRAJECTORY_PARTS_H
#define TD_TRAJECTORY_PARTS_H

#include "camera/td_curve.h"
#include "camera/td_mount.h"
#include "camera/td_open.h"
#include "tides/trajectory.h"

struct tides_trajectory {
    tides_pose_sample *samples; /* quaternions normalised and sign-aligned; an open path forgets early ones */
    size_t count, capacity;
    double origin;   /* [s] time of the first sample; the curve's times count from it */
    td_curve *curve; /* NULL: a static or an open path */
    td_open open;    /* of an open path */
    int32_t is_open;
    int32_t mounted; /* 1: samples and curve are the body's; the path is `mount` on it */
    td_mount mount;
};

/* Checks the samples from number `from` on: finite, in order, distinct. The path begins at `origin` [s]. */
tides_status td_samples_check(const tides_pose_sample *samples, size_t from, size_t count, double origin, tides_error *error);

/* Normalises the quaternions, and gives each the sign that is nearer to its predecessor (q and -q are one rotation). */
tides_status td_samples_align(tides_pose_sample *samples, size_t from, size_t count, tides_error *error);

/* Fails if an angular velocity, from sample `from` on, turns by more than half a turn within a segment: then samples are
 * missing. */
tides_status td_samples_check_turns(const tides_pose_sample *samples, size_t from, size_t count, tides_error *error);

/* An aligned sample as a knot of the curve. */
td_knot td_sample_knot(const tides_pose_sample *sample, double origin);

/* 1 if a curve's value and rate are finite, and its quaternion is long enough to be normalised. */
int td_curve_value_is_sound(const double value[TD_CURVE_WIDTH], const double rate[TD_CURVE_WIDTH]);

/* Times closer than this count as equal: the rounding of doubles near `epoch`, and of sums of intervals. */
double td_trajectory_slack(const tides_trajectory *trajectory, double epoch, double relative);

#endif
