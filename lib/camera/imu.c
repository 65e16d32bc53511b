/* Samples of an IMU on the body: the path's exact derivatives, with biases that walk and white noise.
 *
 * The noise model is Kalibr's. White noise of density sigma [unit/sqrt(Hz)] is sigma / sqrt(dt) per sample. A bias walk of
 * density sigma_b moves the bias by sigma_b sqrt(dt) from sample to sample. Random numbers depend on (seed, axis, sample), so
 * a longer recording begins with the samples of a shorter one. */
#include "tides/imu.h"

#include "camera/td_rotation.h"
#include "camera/td_trajectory.h"
#include "td_base.h"
#include "td_random.h"
#include "td_struct.h"

#include <math.h>

static const double slack = 1e-9; /* [s] by which rounding may put a sample beyond the end */

void tides_imu_defaults(tides_imu *imu) {
    if (imu) *imu = (tides_imu){.size = sizeof *imu, .rate_hz = 200, .gravity = 9.80665};
}

size_t tides_imu_count(const tides_imu *imu, double start, double stop) {
    return stop < start ? 0 : (size_t)floor((stop - start + slack) * imu->rate_hz) + 1;
}

/* -- parameters --------------------------------------------------------------------------------------------------- */

static tides_status check_densities(const tides_imu *imu, tides_error *error) {
    const struct {
        const char *name;
        double value;
    } densities[] = {{"gyroscope_noise", imu->gyroscope_noise},
                     {"accelerometer_noise", imu->accelerometer_noise},
                     {"gyroscope_walk", imu->gyroscope_walk},
                     {"accelerometer_walk", imu->accelerometer_walk}};
    for (size_t i = 0; i < sizeof densities / sizeof *densities; i++)
        if (!(densities[i].value >= 0 && densities[i].value <= 1e3))
            return td_fail(error, TIDES_BAD_ARGUMENT, "imu.%s: %g must lie in [0, 1000]", densities[i].name,
                           densities[i].value);
    if (!td_all_finite(imu->gyroscope_bias, 3) || !td_all_finite(imu->accelerometer_bias, 3))
        return td_fail(error, TIDES_BAD_ARGUMENT, "imu.gyroscope_bias and imu.accelerometer_bias must be finite numbers");
    return TIDES_OK;
}

/* Checks metres_per_unit and the direction of gravity, which have no default. `gravity` is in world axes [m/s^2]. */
static tides_status check_known(const tides_imu *imu, double gravity[3], tides_error *error) {
    const double length = td_length3(imu->down);
    if (!(imu->metres_per_unit > 0 && isfinite(imu->metres_per_unit)))
        return td_fail(error, TIDES_BAD_CONFIG,
                       "an accelerometer measures metres, and how long a unit of the scene is isn't known: set "
                       "scene.metres_per_unit");
    if (imu->gravity > 0 && !(length > 0 && isfinite(length)))
        return td_fail(error, TIDES_BAD_CONFIG,
                       "where gravity points to isn't known: set imu.down, in world axes, or imu.gravity to 0");
    for (int k = 0; k < 3; k++) gravity[k] = imu->gravity > 0 ? imu->gravity * imu->down[k] / length : 0;
    return TIDES_OK;
}

/* Copies and checks the parameters; `gravity` is in world axes [m/s^2]. */
static tides_status take_imu(const tides_imu *given, tides_imu *imu, double gravity[3], tides_error *error) {
    tides_imu_defaults(imu);
    tides_status status = TD_TAKE_STRUCT(tides_imu, imu, given, error);
    if (status != TIDES_OK) return status;
    if (!(imu->rate_hz >= 1e-3 && imu->rate_hz <= 1e6))
        return td_fail(error, TIDES_BAD_ARGUMENT, "imu.rate_hz: %g Hz must lie in [0.001, 1e6]", imu->rate_hz);
    if (!(imu->gravity >= 0 && imu->gravity <= 1e3))
        return td_fail(error, TIDES_BAD_ARGUMENT, "imu.gravity: %g m/s^2 must lie in [0, 1000]", imu->gravity);
    status = check_densities(imu, error);
    return status == TIDES_OK ? check_known(imu, gravity, error) : status;
}

/* -- samples --------------------------------------------------------------------------------------------------------- */

/* out = R^T v. */
static void to_body(const double rotation[9], const double v[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = rotation[k] * v[0] + rotation[3 + k] * v[1] + rotation[6 + k] * v[2];
}

/* The exact reading, without noise. */
static tides_status measure(const tides_trajectory *trajectory, double metres_per_unit, const double gravity[3], double time,
                            tides_imu_sample *sample, tides_error *error) {
    tides_pose pose;
    double force[3], column[3], rate[3];
    tides_status status = tides_trajectory_at(trajectory, time, &pose, error);
    if (status == TIDES_OK) status = tides_trajectory_acceleration(trajectory, time, force, error);
    if (status != TIDES_OK) return status;
    for (int k = 0; k < 3; k++) force[k] = force[k] * metres_per_unit - gravity[k];
    to_body(pose.rotation, force, sample->specific_force);
    /* R^T R_dot is the cross-product matrix of the angular rate: component i is its entry (j, k) */
    for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3, i = (k + 2) % 3;
        for (int r = 0; r < 3; r++) column[r] = pose.rotation_dot[3 * r + k];
        to_body(pose.rotation, column, rate);
        sample->angular_rate[i] = rate[j];
    }
    sample->time = time;
    return TIDES_OK;
}

/* Six normal numbers: three for the gyroscope's axes, three for the accelerometer's. */
static void draw(uint64_t seed, size_t index, uint32_t purpose, double normal[6]) {
    for (uint32_t pair = 0; pair < 3; pair++) {
        const td_random_bits bits = td_random(seed, pair, index, purpose);
        td_random_normals(&bits, normal + 2 * pair);
    }
}

static void disturb(const tides_imu *imu, size_t index, const double gyroscope_bias[3], const double accelerometer_bias[3],
                    tides_imu_sample *sample) {
    const double root = sqrt(imu->rate_hz);
    double normal[6];
    draw(imu->seed, index, TD_RANDOM_IMU_NOISE, normal);
    for (int k = 0; k < 3; k++) {
        sample->gyroscope_bias[k] = gyroscope_bias[k];
        sample->accelerometer_bias[k] = accelerometer_bias[k];
        sample->angular_rate[k] += gyroscope_bias[k] + imu->gyroscope_noise * root * normal[k];
        sample->specific_force[k] += accelerometer_bias[k] + imu->accelerometer_noise * root * normal[3 + k];
    }
}

tides_status tides_trajectory_imu(const tides_trajectory *trajectory, const tides_imu *given, double start, size_t count,
                                  tides_imu_sample *samples, tides_error *error) {
    tides_imu imu;
    double gravity[3], normal[6];
    if (!trajectory || !given || (count && !samples) || !isfinite(start))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_trajectory_imu: trajectory, imu, start and samples must be given");
    tides_status status = take_imu(given, &imu, gravity, error);
    if (status == TIDES_OK && count)
        status = td_trajectory_check_smooth(trajectory, start, start + (double)(count - 1) / imu.rate_hz, error);
    double *gyroscope = imu.gyroscope_bias, *accelerometer = imu.accelerometer_bias; /* biases at the current sample */
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        status = measure(trajectory, imu.metres_per_unit, gravity, start + (double)i / imu.rate_hz, &samples[i], error);
        if (status == TIDES_OK) disturb(&imu, i, gyroscope, accelerometer, &samples[i]);
        draw(imu.seed, i, TD_RANDOM_IMU_WALK, normal);
        for (int k = 0; k < 3; k++) {
            gyroscope[k] += imu.gyroscope_walk / sqrt(imu.rate_hz) * normal[k];
            accelerometer[k] += imu.accelerometer_walk / sqrt(imu.rate_hz) * normal[3 + k];
        }
    }
    return status;
}
