/* Inertial measurements along a path: what a gyroscope and an accelerometer on the moving body measure. */
#ifndef TIDES_IMU_H
#define TIDES_IMU_H

#include "tides/trajectory.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An IMU at the body's origin, with its axes; noise as Kalibr has it (continuous-time densities). Fill with
 * tides_imu_defaults: 200 Hz, 9.80665 m/s^2, down and metres_per_unit unknown, no noise, no bias, seed 0. */
typedef struct tides_imu {
    uint32_t size; /* sizeof this struct */
    int32_t reserved;
    double rate_hz;               /* samples a second [Hz], > 0 */
    double gravity;               /* [m/s^2]; 0: none */
    double down[3];               /* direction of gravity in world axes, of any length; needed unless gravity is 0 */
    double metres_per_unit;       /* length of a scene unit [m]; needed */
    double gyroscope_noise;       /* white noise's density              [rad/s/sqrt(Hz)] */
    double accelerometer_noise;   /*                                    [m/s^2/sqrt(Hz)] */
    double gyroscope_walk;        /* density of the bias's random walk  [rad/s^2/sqrt(Hz)] */
    double accelerometer_walk;    /*                                    [m/s^3/sqrt(Hz)] */
    double gyroscope_bias[3];     /* at the first sample                [rad/s] */
    double accelerometer_bias[3]; /*                                    [m/s^2] */
    uint64_t seed;                /* of noise and random walks */
} tides_imu;
TIDES_API void tides_imu_defaults(tides_imu *imu);

/* One measurement, in body axes, biases and noise included; and the biases by themselves. */
typedef struct tides_imu_sample {
    double time;                  /* [s] */
    double angular_rate[3];       /* of the body against the world        [rad/s] */
    double specific_force[3];     /* R^T (a - g)                          [m/s^2] */
    double gyroscope_bias[3];     /* [rad/s] */
    double accelerometer_bias[3]; /* [m/s^2] */
} tides_imu_sample;

/* Number of samples in [start, stop] [s], which are at start + k / rate_hz. */
TIDES_API size_t tides_imu_count(const tides_imu *imu, double start, double stop);

/* Makes the first `count` samples, from the path's exact derivatives. TIDES_BAD_ARGUMENT naming a value. TIDES_BAD_CONFIG:
 * `down` or metres_per_unit is unknown. TIDES_OUT_OF_RANGE: the path ends too early. TIDES_UNSUPPORTED, naming where: the
 * path isn't C2, so its acceleration jumps. */
TIDES_MUST_CHECK TIDES_API tides_status tides_trajectory_imu(const tides_trajectory *trajectory, const tides_imu *imu,
                                                             double start, size_t count, tides_imu_sample *samples,
                                                             tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
