/* Internal: 3-vectors, unit quaternions (wxyz) and rotation matrices (row-major) with their rates, in double, for the host. */
#ifndef TD_ROTATION_H
#define TD_ROTATION_H

#include "tides/base.h"

#include <math.h>

static inline double td_dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
void td_cross3(const double a[3], const double b[3], double out[3]);
static inline double td_length3(const double a[3]) { return sqrt(td_dot3(a, a)); }

/* 1 if all `count` numbers are finite. */
int td_all_finite(const double *numbers, size_t count);

/* Matrix of a unit quaternion. */
void td_rotation_from_quaternion(const double q[4], double rotation[9]);

/* Rate of that matrix if the quaternion has the rate `q_dot` (tangent to the unit sphere). */
void td_rotation_rate(const double q[4], const double q_dot[4], double rotation_dot[9]);

/* Unit quaternion, w >= 0, of a rotation matrix. Of the four formulas it takes the best conditioned one. */
void td_quaternion_from_rotation(const double rotation[9], double q[4]);

/* Replaces a matrix that is a rotation up to rounded digits by the nearest rotation. */
void td_straighten_rotation(double rotation[9]);

/* q = a b; `q` may be `a` or `b`. */
void td_quaternion_product(const double a[4], const double b[4], double q[4]);

/* q_dot = 1/2 omega q for an angular velocity in world axes. */
void td_quaternion_rate(const double q[4], const double omega[3], double q_dot[4]);

/* Scales q to length 1 in place; returns 0 if it is zero, NaN or infinite. */
int td_normalise_quaternion(double q[4]);

/* A camera at `position` that looks at `target`, in OpenCV axes, with the image's top towards `up`. `omega` (may be NULL) is
 * its angular velocity in world axes if it moves with `velocity`. 0 if the target is at the camera, or straight above or
 * below it along `up`. */
int td_look_at(const double position[3], const double velocity[3], const double target[3], const double up[3],
               double rotation[9], double omega[3]);

#endif
