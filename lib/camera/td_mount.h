/* Internal: a body that is mounted rigidly on another one (a camera on its rig). Poses and rates are composed exactly,
 * without resampling. */
#ifndef TD_MOUNT_H
#define TD_MOUNT_H

#include "tides/trajectory.h"

/* T_B_C: p_body = rotation p_mounted + position. */
typedef struct td_mount {
    double rotation[9], quaternion[4]; /* one rotation in both forms */
    double position[3];                /* [scene units] */
} td_mount;

/* The identity: for a path that isn't mounted. */
void td_mount_none(td_mount *mount);

/* Composes: `mount` becomes (position, quaternion) on top of `under`. The quaternion has unit length. */
void td_mount_add(const td_mount *under, const double position[3], const double quaternion[4], td_mount *mount);

/* Changes a pose or sample of the body to that of what is mounted on it. */
void td_mount_pose(const td_mount *mount, tides_pose *pose);
void td_mount_sample(const td_mount *mount, tides_pose_sample *sample);

#endif
