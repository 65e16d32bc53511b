/* Internal: a body that sits rigidly on another one (a camera on its rig): pose and rates composed, nothing resampled. */
#ifndef TD_MOUNT_H
#define TD_MOUNT_H

#include "tides/trajectory.h"

/* T_B_C: p_body = rotation p_mounted + position. */
typedef struct td_mount {
    double rotation[9], quaternion[4]; /* the same one */
    double position[3];                /* [scene units] */
} td_mount;

/* No displacement at all: what a path has that isn't mounted. */
void td_mount_none(td_mount *mount);

/* `mount` on top of what `under` is already. The quaternion is of unit length. */
void td_mount_add(const td_mount *under, const double position[3], const double quaternion[4], td_mount *mount);

/* The body's pose or sample becomes that of what is mounted on it. */
void td_mount_pose(const td_mount *mount, tides_pose *pose);
void td_mount_sample(const td_mount *mount, tides_pose_sample *sample);

#endif
