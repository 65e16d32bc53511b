/* A rigid motion over time: the path of a camera or of an object, with its exact rate.
 *
 * Between samples, positions follow a C2 cubic spline, and rotations a C1 (or smoother) curve on the sphere of unit
 * quaternions. The rates are the exact derivatives of those curves, never differences. Samples that are far closer than their
 * neighbours could make a component overshoot the range of the samples around it by as much as that range. There it is a
 * monotone C1 cubic instead (Fritsch and Butland). Poses map body coordinates to the world: p_world = rotation p_body +
 * position. A camera's body axes are OpenCV's: x right, y down, z forward. */
#ifndef TIDES_TRAJECTORY_H
#define TIDES_TRAJECTORY_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A path: poses with rates at any time. Opaque, constant once made. */
typedef struct tides_trajectory tides_trajectory;

/* One sample. Plain value. Rates are used where `has_rates` is 1 for every sample of a path (Hermite interpolation of
 * position, and rotation with the given angular velocities); otherwise they are ignored. */
typedef struct tides_pose_sample {
    double time;                /* [s] */
    double position[3];         /* body origin in the world             [scene units] */
    double quaternion[4];       /* body to world, wxyz; normalised here */
    double velocity[3];         /* d(position)/dt                       [scene units/s] */
    double angular_velocity[3]; /* in world axes                        [rad/s] */
    int32_t has_rates;          /* 1: velocity and angular_velocity are given */
    int32_t reserved;
} tides_pose_sample;

/* Pose and rate at one time. Matrices row-major. */
typedef struct tides_pose {
    double rotation[9];     /* body to world */
    double rotation_dot[9]; /* [1/s] */
    double position[3];     /* [scene units] */
    double position_dot[3]; /* [scene units/s] */
} tides_pose;

/* Builds a path from `count` >= 1 samples in strictly increasing time (a single sample is a pose at rest for all times).
 * Unsorted or duplicate times, NaN, or a zero quaternion: TIDES_BAD_ARGUMENT naming the sample. Copies its input. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create(const tides_pose_sample *samples, size_t count,
                                                                tides_trajectory **trajectory, tides_error *error);

/* A pose that never changes, valid at all times. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create_static(const double position[3], const double quaternion[4],
                                                                       tides_trajectory **trajectory, tides_error *error);

/* The path of what sits rigidly on a body, such as a camera on its rig: p_body = R(quaternion) p_mounted + position, wxyz,
 * [scene units]. Poses and rates are composed from the body's at each time. (A spline through the mounted samples would be
 * another path.) `body` isn't needed afterwards. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create_mounted(const tides_trajectory *body, const double position[3],
                                                                        const double quaternion[4],
                                                                        tides_trajectory **trajectory, tides_error *error);

/* An open path, for runs that get their poses while they advance (tides/live.h). It begins with `count` >= 1 samples;
 * tides_trajectory_append adds more. Between two samples it is the C1 cubic with their poses and rates, so that later samples
 * don't change the path before them. A sample may have rates; else its rate is that of the parabola through it and the two
 * samples before it (first two: of the line between them). The path ends at its last sample. A time within a tenth of a
 * nanosecond (or rounding, if that is more) of a sample is that sample, exactly. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create_open(const tides_pose_sample *samples, size_t count,
                                                                     tides_trajectory **trajectory, tides_error *error);

/* Adds samples to an open path, all or none: later than its last, and less than 179 degrees from one to the next.
 * TIDES_BAD_ARGUMENT naming the sample, counted from the first that the path still has. A path that is mounted on an open
 * body takes samples of the body, and is independent of the body's own path from then on. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_append(tides_trajectory *trajectory, const tides_pose_sample *samples,
                                                                size_t count, tides_error *error);

/* 1 if the path is open: samples can be appended. */
TIDES_API int32_t tides_trajectory_is_open(const tides_trajectory *trajectory);

/* Lets an open path forget samples that it doesn't need from `time` on, if they are half of it or more. The curve at later
 * times doesn't change. Other paths keep all samples. A simulator that follows the path must have reached `time` and taken
 * two steps, because the second one keeps what it needs of the run's start. */
TIDES_API void tides_trajectory_forget(tides_trajectory *trajectory, double time);

/* NULL is fine. */
TIDES_API void tides_trajectory_destroy(tides_trajectory *trajectory);

/* Pose and rate at `time`. Outside [start, stop]: TIDES_OUT_OF_RANGE (a static path covers all times). At a sample, rates
 * are those of the segment that begins there (of the one that ends there at `stop`); they agree where the curve is C1. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_at(const tides_trajectory *trajectory, double time, tides_pose *pose,
                                                            tides_error *error);

/* Acceleration of the body's origin at `time` [scene units/s^2], in world axes: the curve's exact second derivative.
 * TIDES_OUT_OF_RANGE: outside the path. TIDES_UNSUPPORTED: at a sample where the curve is only C1, so that there are two
 * accelerations. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_acceleration(const tides_trajectory *trajectory, double time,
                                                                      double acceleration[3], tides_error *error);

/* First and last time [s]; -INFINITY and INFINITY for a static path. */
TIDES_API void tides_trajectory_range(const tides_trajectory *trajectory, double *start, double *stop);

/* 1 if the pose is the same at all times. */
TIDES_API int32_t tides_trajectory_is_static(const tides_trajectory *trajectory);

/* Number of samples, and a copy of sample `index`. */
TIDES_API size_t tides_trajectory_count(const tides_trajectory *trajectory);
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_sample(const tides_trajectory *trajectory, size_t index,
                                                                tides_pose_sample *sample, tides_error *error);

/* Generators. Each is an ordinary sampled path, dense enough (stated in the .c file) that the spline's error against the
 * formula is below 1e-6 of its size; all are deterministic in their parameters. */

/* A camera on a circle of `radius` about `target` in the plane normal to `up`, `height` above it, looking at the target. */
typedef struct tides_orbit {
    double target[3], up[3]; /* world axes [scene units]; `up` of any length */
    double radius, height;   /* [scene units] */
    double start_angle;      /* [rad] */
    double angular_speed;    /* [rad/s] */
    double start, stop;      /* [s] */
} tides_orbit;
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create_orbit(const tides_orbit *orbit, tides_trajectory **trajectory,
                                                                      tides_error *error);

/* A camera that moves on a line from `from` to `to` while looking at `target`. */
typedef struct tides_dolly {
    double from[3], to[3], target[3], up[3]; /* world axes [scene units]; `up` of any length */
    double start, stop;                      /* [s] */
} tides_dolly;
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create_dolly(const tides_dolly *dolly, tides_trajectory **trajectory,
                                                                      tides_error *error);

/* A camera held by hand: at `position`, looking at `target`, shaken by a few sines per axis whose phases come from `seed`. */
typedef struct tides_handheld {
    double position[3], target[3], up[3]; /* world axes [scene units]; `up` of any length */
    double position_amplitude;            /* [scene units], rms per axis */
    double rotation_amplitude;            /* [rad], rms per axis */
    double frequency;                     /* [Hz], of the slowest sine; the fastest is 5 times that */
    uint64_t seed;                        /* of the phases */
    double start, stop;                   /* [s] */
} tides_handheld;
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_create_handheld(const tides_handheld *handheld,
                                                                         tides_trajectory **trajectory, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
