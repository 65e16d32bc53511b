/* Poses of a camera mounted on a body. With the body at (R, p) and a resting mount (M, m), the camera is at (R M, p + R m),
 * with rates (R_dot M, p_dot + R_dot m). So two cameras of a rig keep their distance exactly. With a spline through samples
 * of each camera's path, the distance would vary between the samples. */
#include "camera/td_mount.h"

#include "camera/td_rotation.h"

#include <string.h>

static void product(const double a[9], const double b[9], double out[9]) {
    double made[9];
    for (int i = 0; i < 9; i++)
        made[i] = a[i / 3 * 3] * b[i % 3] + a[i / 3 * 3 + 1] * b[3 + i % 3] + a[i / 3 * 3 + 2] * b[6 + i % 3];
    memcpy(out, made, sizeof made);
}

static void quaternion_product(const double a[4], const double b[4], double out[4]) {
    double cross[3], made[4] = {a[0] * b[0] - td_dot3(a + 1, b + 1)};
    td_cross3(a + 1, b + 1, cross);
    for (int k = 0; k < 3; k++) made[k + 1] = a[0] * b[k + 1] + b[0] * a[k + 1] + cross[k];
    memcpy(out, made, sizeof made);
}

static void turn(const double rotation[9], const double vector[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = td_dot3(rotation + 3 * i, vector);
}

void td_mount_none(td_mount *mount) {
    *mount = (td_mount){.quaternion = {1, 0, 0, 0}};
    td_rotation_from_quaternion(mount->quaternion, mount->rotation);
}

void td_mount_add(const td_mount *under, const double position[3], const double quaternion[4], td_mount *mount) {
    td_mount made;
    turn(under->rotation, position, made.position);
    for (int k = 0; k < 3; k++) made.position[k] += under->position[k];
    quaternion_product(under->quaternion, quaternion, made.quaternion);
    td_rotation_from_quaternion(made.quaternion, made.rotation);
    *mount = made;
}

void td_mount_pose(const td_mount *mount, tides_pose *pose) {
    double arm[3], arm_dot[3];
    turn(pose->rotation, mount->position, arm);
    turn(pose->rotation_dot, mount->position, arm_dot);
    for (int k = 0; k < 3; k++) {
        pose->position[k] += arm[k];
        pose->position_dot[k] += arm_dot[k];
    }
    product(pose->rotation, mount->rotation, pose->rotation);
    product(pose->rotation_dot, mount->rotation, pose->rotation_dot);
}

void td_mount_sample(const td_mount *mount, tides_pose_sample *sample) {
    double rotation[9], arm[3], swing[3];
    td_rotation_from_quaternion(sample->quaternion, rotation);
    turn(rotation, mount->position, arm);
    td_cross3(sample->angular_velocity, arm, swing);
    for (int k = 0; k < 3; k++) {
        sample->position[k] += arm[k];
        if (sample->has_rates) sample->velocity[k] += swing[k];
    }
    quaternion_product(sample->quaternion, mount->quaternion, sample->quaternion);
}
