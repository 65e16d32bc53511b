/* Internal: a body that is mounted rigidly on another one (a camera on its rig). Poses and rates are composed exactly,
 * without resampling. */
#ifndef TD_MOUNT_H
#define TD_MOUNT_H

#include "tides/trajectory.h"

/* The run file's T_B_C: coordinates in the mounted body, taken to those in its carrier, the body that it is mounted on.
 * p_carrier = rotation p_mounted + position, with a row-major rotation. */
typedef struct td_mount {
    double rotation[9], quaternion[4]; /* one rotation in both forms */
    double position[3];                /* [scene units] */
} td_mount;

/* The identity: for a path that isn't mounted. */
void td_mount_none(td_mount *mount);

/* Mounts a third body: (position, quaternion) is its pose in the body that `under` mounts. `mount` becomes its pose in the
 * carrier of `under`, and may be `under` itself. The quaternion has unit length. */
void td_mount_add(const td_mount *under, const double position[3], const double quaternion[4], td_mount *mount);

/* Replaces a pose or sample of the carrier by the mounted body's at the same time. */
void td_mount_pose(const td_mount *mount, tides_pose *pose);
void td_mount_sample(const td_mount *mount, tides_pose_sample *sample);

#endif
