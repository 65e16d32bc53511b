/* The rates of a trajectory equal central differences of its poses, on random paths with and without given rates and on each
 * generator; and rotation_dot rotation^T is antisymmetric. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/trajectory.h"

#include <math.h>
#include <stdio.h>

#define SEED 7u
#define COUNT 40

static double uniform(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state / 4294967296.0;
}

static tides_pose pose_at(const tides_trajectory *path, double time) {
    tides_pose pose;
    tides_error error = {0, ""};
    if (tides_trajectory_at(path, time, &pose, &error) != TIDES_OK) fail_msg("%s", error.text);
    return pose;
}

/* Number `k` of a pose: rotation, then position; and of its rate. */
static double value_of(const tides_pose *pose, int k) { return k < 9 ? pose->rotation[k] : pose->position[k - 9]; }
static double rate_of(const tides_pose *pose, int k) { return k < 9 ? pose->rotation_dot[k] : pose->position_dot[k - 9]; }

/* Largest |rate - difference| over the path, relative to the largest rate of its kind. Five-point differences of step `h`
 * (error h^4) at random times of the inside of segments: at samples a higher derivative may jump. */
static double worst_rate(const tides_trajectory *path, double h, uint32_t *random) {
    double worst[2] = {0.0, 0.0}, scale[2] = {1e-300, 1e-300};
    size_t count = tides_trajectory_count(path);
    for (int i = 0; i < 2000; i++) {
        tides_pose_sample from, to;
        size_t segment = (size_t)(uniform(random) * (double)(count - 1));
        assert_int_equal(tides_trajectory_sample(path, segment, &from, NULL), TIDES_OK);
        assert_int_equal(tides_trajectory_sample(path, segment + 1, &to, NULL), TIDES_OK);
        double step = h * (to.time - from.time), time = from.time + (0.1 + 0.8 * uniform(random)) * (to.time - from.time);
        tides_pose pose[5];
        for (int j = 0; j < 5; j++) pose[j] = pose_at(path, time + (j - 2) * step);
        for (int k = 0; k < 12; k++) {
            double far = value_of(pose, k) - value_of(pose + 4, k), near = value_of(pose + 3, k) - value_of(pose + 1, k);
            double difference = (far + 8.0 * near) / (12.0 * step), rate = rate_of(pose + 2, k);
            worst[k >= 9] = fmax(worst[k >= 9], fabs(rate - difference));
            scale[k >= 9] = fmax(scale[k >= 9], fabs(rate));
        }
    }
    return fmax(worst[0] / scale[0], worst[1] / scale[1]);
}

/* Largest symmetric part of rotation_dot rotation^T, relative to its largest entry. */
static double worst_symmetry(const tides_trajectory *path) {
    double start, stop, worst = 0.0, scale = 1e-300;
    tides_trajectory_range(path, &start, &stop);
    for (int i = 0; i <= 1000; i++) {
        tides_pose pose = pose_at(path, start + (stop - start) * i / 1000.0);
        double spin[3][3] = {{0}};
        for (int a = 0; a < 9; a++)
            for (int k = 0; k < 3; k++) spin[a / 3][a % 3] += pose.rotation_dot[a / 3 * 3 + k] * pose.rotation[a % 3 * 3 + k];
        for (int a = 0; a < 9; a++) {
            worst = fmax(worst, fabs(spin[a / 3][a % 3] + spin[a % 3][a / 3]));
            scale = fmax(scale, fabs(spin[a / 3][a % 3]));
        }
    }
    return worst / scale;
}

static void check_rates(tides_trajectory *path, const char *name) {
    uint32_t random = SEED;
    double rate = worst_rate(path, 2e-3, &random), symmetry = worst_symmetry(path);
    print_message("    %s: rates off by %.2g, symmetric part %.2g\n", name, rate, symmetry);
    assert_true(rate < 1e-7);
    assert_true(symmetry < 1e-13);
    tides_trajectory_destroy(path);
}

static void random_paths(void **state) {
    (void)state;
    uint32_t random = SEED;
    for (int with_rates = 0; with_rates < 2; with_rates++) {
        tides_pose_sample samples[COUNT] = {{0}};
        double time = 1e3;
        for (int i = 0; i < COUNT; i++) {
            samples[i].time = time += 0.02 + 0.03 * uniform(&random);
            samples[i].has_rates = with_rates;
            for (int k = 0; k < 4; k++) samples[i].quaternion[k] = (k == 1) + 0.7 * (uniform(&random) - 0.5);
            for (int k = 0; k < 3; k++) samples[i].position[k] = uniform(&random);
            for (int k = 0; k < 3; k++) samples[i].velocity[k] = 10.0 * uniform(&random) - 5.0;
            for (int k = 0; k < 3; k++) samples[i].angular_velocity[k] = 20.0 * uniform(&random) - 10.0;
        }
        tides_trajectory *path = NULL;
        assert_int_equal(tides_trajectory_create(samples, COUNT, &path, NULL), TIDES_OK);
        check_rates(path, with_rates ? "random with rates" : "random");
    }
}

static void generators(void **state) {
    (void)state;
    const tides_orbit orbit =
        {.target = {1, 2, 3}, .up = {0.2, -1, 0.1}, .radius = 2, .height = 1, .angular_speed = 6, .stop = 1};
    const tides_dolly dolly = {.from = {-3, 0, 1}, .to = {3, 1, 1}, .target = {0, 3, 0}, .up = {0, 0, 1}, .stop = 2};
    const tides_handheld hand = {.position = {0, -3, 1},
                                 .target = {0, 0, 1},
                                 .up = {0, 0, 1},
                                 .position_amplitude = 0.02,
                                 .rotation_amplitude = 0.03,
                                 .frequency = 1.5,
                                 .seed = 11,
                                 .stop = 3};
    tides_trajectory *path = NULL;
    assert_int_equal(tides_trajectory_create_orbit(&orbit, &path, NULL), TIDES_OK);
    check_rates(path, "orbit");
    assert_int_equal(tides_trajectory_create_dolly(&dolly, &path, NULL), TIDES_OK);
    check_rates(path, "dolly");
    assert_int_equal(tides_trajectory_create_handheld(&hand, &path, NULL), TIDES_OK);
    check_rates(path, "handheld");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_paths),
        cmocka_unit_test(generators),
    };
    print_message("seed %u\n", SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
