/* Inertial measurements: integrated twice they give the path back, their noise has the densities that were asked for, and what
 * isn't known or isn't C2 is refused by name. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/imu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static tides_imu imu_of(double rate_hz) {
    tides_imu imu;
    tides_imu_defaults(&imu);
    imu.rate_hz = rate_hz;
    imu.metres_per_unit = 0.5;
    imu.down[0] = 0.3, imu.down[1] = -2, imu.down[2] = 0.1;
    return imu;
}

static tides_imu_sample *measure(const tides_trajectory *path, const tides_imu *imu, double start, size_t count) {
    tides_imu_sample *samples = calloc(count, sizeof *samples);
    tides_error error = {TIDES_OK, ""};
    assert_non_null(samples);
    if (tides_trajectory_imu(path, imu, start, count, samples, &error) != TIDES_OK) fail_msg("%s", error.text);
    return samples;
}

static tides_trajectory *hand(double stop) {
    const tides_handheld h = {.position = {1, 2, 3},
                              .target = {0, 0, 0.5},
                              .up = {0, 0, 1},
                              .position_amplitude = 0.3,
                              .rotation_amplitude = 0.2,
                              .frequency = 0.7,
                              .seed = 5,
                              .start = 0,
                              .stop = stop};
    tides_trajectory *path = NULL;
    tides_error error;
    assert_int_equal(tides_trajectory_create_handheld(&h, &path, &error), TIDES_OK);
    return path;
}

/* -- integrated -------------------------------------------------------------------------------------------------------- */

/* Rotation, position [m] and velocity, and their rates by what is measured. */
typedef struct state {
    double v[15]; /* rotation 9, position 3, velocity 3 */
} state;

static state rate_of(const state *s, const tides_imu_sample *m, const double gravity[3]) {
    const double *w = m->angular_rate, *f = m->specific_force, *r = s->v;
    state d;
    for (int i = 0; i < 3; i++) { /* R [w]x */
        d.v[3 * i] = r[3 * i + 1] * w[2] - r[3 * i + 2] * w[1];
        d.v[3 * i + 1] = r[3 * i + 2] * w[0] - r[3 * i] * w[2];
        d.v[3 * i + 2] = r[3 * i] * w[1] - r[3 * i + 1] * w[0];
        d.v[9 + i] = s->v[12 + i];
        d.v[12 + i] = r[3 * i] * f[0] + r[3 * i + 1] * f[1] + r[3 * i + 2] * f[2] + gravity[i];
    }
    return d;
}

static state along(const state *s, const state *d, double by) {
    state moved;
    for (int i = 0; i < 15; i++) moved.v[i] = s->v[i] + by * d->v[i];
    return moved;
}

/* Runge and Kutta's fourth order over two periods. */
static void step(state *s, const tides_imu_sample m[3], double h, const double gravity[3]) {
    const state a = rate_of(s, &m[0], gravity), at_b = along(s, &a, 0.5 * h), b = rate_of(&at_b, &m[1], gravity),
                at_c = along(s, &b, 0.5 * h), c = rate_of(&at_c, &m[1], gravity), at_d = along(s, &c, h),
                d = rate_of(&at_d, &m[2], gravity);
    for (int i = 0; i < 15; i++) s->v[i] += h / 6 * (a.v[i] + 2 * b.v[i] + 2 * c.v[i] + d.v[i]);
}

static void integrated_twice_they_give_the_path_back(void **unused) {
    enum { COUNT = 20001 };
    tides_trajectory *path = hand(10);
    const tides_imu imu = imu_of(2000);
    tides_imu_sample *samples = measure(path, &imu, 0, COUNT);
    const double length = sqrt(0.3 * 0.3 + 4 + 0.01);
    double gravity[3], off = 0, turned = 0;
    tides_pose pose;
    state s;
    (void)unused;
    for (int k = 0; k < 3; k++) gravity[k] = 9.80665 * imu.down[k] / length;
    assert_int_equal(tides_trajectory_at(path, 0, &pose, NULL), TIDES_OK);
    memcpy(s.v, pose.rotation, sizeof pose.rotation);
    for (int k = 0; k < 3; k++) s.v[9 + k] = 0.5 * pose.position[k], s.v[12 + k] = 0.5 * pose.position_dot[k];
    for (int i = 0; i + 2 < COUNT; i += 2) {
        step(&s, samples + i, 2 / imu.rate_hz, gravity);
        assert_int_equal(tides_trajectory_at(path, samples[i + 2].time, &pose, NULL), TIDES_OK);
        for (int k = 0; k < 3; k++) off = fmax(off, fabs(s.v[9 + k] - 0.5 * pose.position[k]));
        for (int k = 0; k < 9; k++) turned = fmax(turned, fabs(s.v[k] - pose.rotation[k]));
    }
    print_message("after 10 s: %.2g m, %.2g rad\n", off, turned);
    assert_true(off < 1e-6 && turned < 1e-6);
    free(samples);
    tides_trajectory_destroy(path);
}

/* -- noise ------------------------------------------------------------------------------------------------------------- */

/* Allan's variance of one axis over clusters of `m` samples, and how many clusters there were. */
static double allan(const tides_imu_sample *samples, size_t count, size_t m, size_t offset, size_t *clusters) {
    double before = 0, sum = 0;
    *clusters = count / m;
    for (size_t c = 0; c < *clusters; c++) {
        double mean = 0;
        for (size_t i = c * m; i < (c + 1) * m; i++) {
            double value;
            memcpy(&value, (const char *)&samples[i] + offset, sizeof value);
            mean += value / (double)m;
        }
        if (c) sum += 0.5 * (mean - before) * (mean - before);
        before = mean;
    }
    return sum / (double)(*clusters - 1);
}

static void expect_density(const char *what, double found, double wanted, double clusters) {
    const double error = wanted / sqrt(2 * clusters) * 1.3; /* differences of neighbours share a cluster */
    print_message("%s: %.5g, asked for %.5g, standard error %.2g\n", what, found, wanted, error);
    assert_true(fabs(found - wanted) <= 3 * error);
}

static void noise_has_its_densities(void **unused) {
    enum { COUNT = 200000, M = 20 };
    static const size_t gyroscope[3] = {offsetof(tides_imu_sample, angular_rate), offsetof(tides_imu_sample, angular_rate) + 8,
                                        offsetof(tides_imu_sample, angular_rate) + 16},
                        accelerometer[3] = {offsetof(tides_imu_sample, specific_force),
                                            offsetof(tides_imu_sample, specific_force) + 8,
                                            offsetof(tides_imu_sample, specific_force) + 16};
    const double place[3] = {0, 0, 0}, upright[4] = {1, 0, 0, 0}, rate = 200, dt = 1 / rate;
    tides_trajectory *path = NULL;
    (void)unused;
    assert_int_equal(tides_trajectory_create_static(place, upright, &path, NULL), TIDES_OK);
    for (int k = 0; k < 3; k++) {
        size_t clusters;
        tides_imu imu = imu_of(rate);
        imu.seed = 11 + (uint64_t)k;
        imu.gyroscope_noise = 1.7e-4, imu.accelerometer_noise = 2e-3; /* EuRoC's ADIS16448 */
        tides_imu_sample *samples = measure(path, &imu, 0, COUNT);
        const double tau = M * dt; /* white noise: N^2 / tau */
        double found = sqrt(allan(samples, COUNT, M, gyroscope[k], &clusters) * tau);
        expect_density("gyroscope noise", found, imu.gyroscope_noise, (double)clusters);
        found = sqrt(allan(samples, COUNT, M, accelerometer[k], &clusters) * tau);
        expect_density("accelerometer noise", found, imu.accelerometer_noise, (double)clusters);
        free(samples);
        imu.gyroscope_noise = imu.accelerometer_noise = 0;
        imu.gyroscope_walk = 2e-5, imu.accelerometer_walk = 3e-3;
        samples = measure(path, &imu, 0, COUNT);
        const double walk = dt * (2.0 * M * M + 1) / (6.0 * M); /* a random walk: K^2 tau / 3, in steps of dt */
        found = sqrt(allan(samples, COUNT, M, gyroscope[k], &clusters) / walk);
        expect_density("gyroscope walk", found, imu.gyroscope_walk, (double)clusters);
        found = sqrt(allan(samples, COUNT, M, accelerometer[k], &clusters) / walk);
        expect_density("accelerometer walk", found, imu.accelerometer_walk, (double)clusters);
        assert_true(samples[COUNT - 1].gyroscope_bias[k] == samples[COUNT - 1].angular_rate[k]);
        free(samples);
    }
    tides_trajectory_destroy(path);
}

/* The first samples of a longer recording are a shorter one's, and another seed's are others. */
static void draws_are_by_number(void **unused) {
    tides_trajectory *path = hand(1);
    tides_imu imu = imu_of(200);
    (void)unused;
    imu.gyroscope_noise = imu.accelerometer_walk = 0.1;
    tides_imu_sample *a = measure(path, &imu, 0.25, 100), *b = measure(path, &imu, 0.25, 40);
    imu.seed = 1;
    tides_imu_sample *c = measure(path, &imu, 0.25, 40);
    assert_memory_equal(a, b, 40 * sizeof *a);
    for (int i = 0; i < 40; i++) assert_true(a[i].angular_rate[0] != c[i].angular_rate[0]);
    assert_true(a[0].accelerometer_bias[1] == 0 && a[39].accelerometer_bias[1] != c[39].accelerometer_bias[1]);
    assert_int_equal(tides_imu_count(&imu, 0, 1), 201);
    assert_int_equal(tides_imu_count(&imu, 0, 0.0049), 1);
    assert_int_equal(tides_imu_count(&imu, 1, 0), 0);
    free(a);
    free(b);
    free(c);
    tides_trajectory_destroy(path);
}

/* -- refused ----------------------------------------------------------------------------------------------------------- */

static void expect_refused(const tides_trajectory *path, const tides_imu *imu, tides_status status, const char *words) {
    static tides_imu_sample samples[200];
    tides_error error = {TIDES_OK, ""};
    assert_int_equal(tides_trajectory_imu(path, imu, 0, 200, samples, &error), status);
    if (!strstr(error.text, words)) fail_msg("'%s' isn't in '%s'", words, error.text);
}

static void what_cannot_be_is_refused(void **unused) {
    tides_trajectory *path = hand(2);
    tides_imu imu = imu_of(100);
    (void)unused;
    imu.metres_per_unit = 0;
    expect_refused(path, &imu, TIDES_BAD_CONFIG, "scene.metres_per_unit");
    imu = imu_of(100);
    memset(imu.down, 0, sizeof imu.down);
    expect_refused(path, &imu, TIDES_BAD_CONFIG, "imu.down");
    imu.gravity = 0;
    free(measure(path, &imu, 0, 10)); /* in free fall down isn't needed */
    imu.accelerometer_walk = -1;
    expect_refused(path, &imu, TIDES_BAD_ARGUMENT, "imu.accelerometer_walk");
    imu = imu_of(80);
    expect_refused(path, &imu, TIDES_OUT_OF_RANGE, "outside the path");
    tides_trajectory_destroy(path);
}

/* Two samples a tenth of a microsecond apart, with noise: the spline is calmed there, and C1. */
static void a_path_that_is_not_c2_is_refused(void **unused) {
    tides_pose_sample samples[12];
    tides_trajectory *path = NULL;
    tides_error error;
    double acceleration[3];
    (void)unused;
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 12; i++) {
        samples[i].time = 0.25 * (i < 6 ? i : i - 1) + (i == 6 ? 1e-7 : 0);
        samples[i].position[0] = sin(samples[i].time) + (i == 6 ? 1e-3 : 0);
        samples[i].quaternion[0] = 1;
    }
    assert_int_equal(tides_trajectory_create(samples, 12, &path, &error), TIDES_OK);
    const tides_imu imu = imu_of(100);
    expect_refused(path, &imu, TIDES_UNSUPPORTED, "isn't C2 at sample");
    assert_int_equal(tides_trajectory_acceleration(path, samples[6].time, acceleration, &error), TIDES_UNSUPPORTED);
    assert_int_equal(tides_trajectory_acceleration(path, 0.3, acceleration, &error), TIDES_OK);
    tides_imu_sample before[20];
    assert_int_equal(tides_trajectory_imu(path, &imu, 0, 20, before, &error), TIDES_OK); /* it is C2 until then */
    tides_trajectory_destroy(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integrated_twice_they_give_the_path_back),
        cmocka_unit_test(noise_has_its_densities),
        cmocka_unit_test(draws_are_by_number),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(a_path_that_is_not_c2_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
