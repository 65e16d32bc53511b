/* Trajectories: they pass through the samples, are as smooth and as accurate as promised, precise far from time 0, and every
 * wrong input is refused by name. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/trajectory.h"

#include "camera/td_curve.h"
#include "camera/td_rotation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SEED 20261121u
#define COUNT 12

/* xorshift32, so that the samples are the same everywhere. */
static double uniform(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state / 4294967296.0;
}

/* A path of uneven times; times are multiples of 2^-10, so that offsets are exact. */
static void random_samples(tides_pose_sample samples[COUNT], int with_rates) {
    uint32_t state = SEED;
    double time = 0.0, q[4] = {1.0, 0.0, 0.0, 0.0};
    memset(samples, 0, COUNT * sizeof *samples);
    for (int i = 0; i < COUNT; i++) {
        tides_pose_sample *s = samples + i;
        s->time = time;
        time += (64.0 + floor(128.0 * uniform(&state))) / 1024.0;
        for (int k = 0; k < 4; k++) q[k] += 0.6 * (uniform(&state) - 0.5);
        td_normalise_quaternion(q);
        memcpy(s->quaternion, q, sizeof q);
        for (int k = 0; k < 3; k++) s->position[k] = 4.0 * uniform(&state) - 2.0;
        for (int k = 0; k < 3; k++) s->velocity[k] = 2.0 * uniform(&state) - 1.0;
        for (int k = 0; k < 3; k++) s->angular_velocity[k] = 4.0 * uniform(&state) - 2.0;
        s->has_rates = with_rates;
    }
}

static tides_trajectory *create(const tides_pose_sample *samples, size_t count) {
    tides_trajectory *path = NULL;
    tides_error error = {0, ""};
    if (tides_trajectory_create(samples, count, &path, &error) != TIDES_OK) fail_msg("%s", error.text);
    return path;
}

static tides_pose pose_at(const tides_trajectory *path, double time) {
    tides_pose pose;
    tides_error error = {0, ""};
    if (tides_trajectory_at(path, time, &pose, &error) != TIDES_OK) fail_msg("%s", error.text);
    return pose;
}

static void assert_near(double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) fail_msg("got %.17g, expected %.17g, tolerance %g", got, expected, tolerance);
}

static void passes_through_the_samples(void **state) {
    (void)state;
    for (int with_rates = 0; with_rates < 2; with_rates++) {
        tides_pose_sample samples[COUNT];
        random_samples(samples, with_rates);
        tides_trajectory *path = create(samples, COUNT);
        assert_int_equal(tides_trajectory_count(path), COUNT);
        for (int i = 0; i < COUNT; i++) {
            tides_pose pose = pose_at(path, samples[i].time);
            double rotation[9], spin[9] = {0};
            td_rotation_from_quaternion(samples[i].quaternion, rotation);
            for (int k = 0; k < 9; k++) assert_near(pose.rotation[k], rotation[k], 1e-14);
            for (int k = 0; k < 3; k++) assert_near(pose.position[k], samples[i].position[k], 1e-14);
            if (!with_rates) continue;
            const double *w = samples[i].angular_velocity; /* R_dot = [w]x R */
            for (int j = 0; j < 3; j++) {
                spin[j] = w[1] * rotation[6 + j] - w[2] * rotation[3 + j];
                spin[3 + j] = w[2] * rotation[j] - w[0] * rotation[6 + j];
                spin[6 + j] = w[0] * rotation[3 + j] - w[1] * rotation[j];
            }
            for (int k = 0; k < 9; k++) assert_near(pose.rotation_dot[k], spin[k], 1e-12);
            for (int k = 0; k < 3; k++) assert_near(pose.position_dot[k], samples[i].velocity[k], 1e-12);
        }
        tides_trajectory_destroy(path);
    }
}

/* Second and third derivative of segment `index` at `time`: five-point formulas on its rate, exact for the quartic it is. */
static void higher_derivatives(const td_curve *curve, size_t index, double time, int k, double *second, double *third) {
    double rate[5], h = 0.03125;
    for (int i = 0; i < 5; i++) {
        double values[TD_CURVE_WIDTH], rates[TD_CURVE_WIDTH];
        td_curve_at(curve, index, time + (i - 2) * h, values, rates);
        rate[i] = rates[k];
    }
    *second = (rate[0] - 8.0 * rate[1] + 8.0 * rate[3] - rate[4]) / (12.0 * h);
    *third = (-rate[0] + 16.0 * rate[1] - 30.0 * rate[2] + 16.0 * rate[3] - rate[4]) / (12.0 * h * h);
}

/* Derivatives of both segments that meet at each inner knot; the cubic is C2, the quintic C3. */
static void curve_is_smooth_at_its_knots(void **state) {
    (void)state;
    for (int with_rates = 0; with_rates < 2; with_rates++) {
        tides_pose_sample samples[COUNT];
        td_knot knots[COUNT];
        random_samples(samples, 1);
        for (int i = 0; i < COUNT; i++) {
            knots[i].time = samples[i].time;
            memcpy(knots[i].value, samples[i].position, 3 * sizeof(double));
            memcpy(knots[i].value + 3, samples[i].quaternion, 4 * sizeof(double));
            memcpy(knots[i].rate, samples[i].velocity, 3 * sizeof(double));
            td_quaternion_rate(samples[i].quaternion, samples[i].angular_velocity, knots[i].rate + 3);
        }
        td_curve *curve = td_curve_create(knots, COUNT, with_rates, NULL);
        assert_non_null(curve);
        double jump_of_third = 0.0;
        for (size_t i = 1; i + 1 < COUNT; i++) {
            double left[TD_CURVE_WIDTH], right[TD_CURVE_WIDTH], left_dot[TD_CURVE_WIDTH], right_dot[TD_CURVE_WIDTH];
            td_curve_at(curve, i - 1, knots[i].time, left, left_dot);
            td_curve_at(curve, i, knots[i].time, right, right_dot);
            for (int k = 0; k < TD_CURVE_WIDTH; k++) {
                double second[2], third[2];
                higher_derivatives(curve, i - 1, knots[i].time, k, second, third);
                higher_derivatives(curve, i, knots[i].time, k, second + 1, third + 1);
                assert_near(left[k], right[k], 1e-13);
                assert_near(left_dot[k], right_dot[k], 1e-11);
                assert_near(second[0], second[1], 1e-8 * (1.0 + fabs(second[0])));
                if (with_rates) assert_near(third[0], third[1], 1e-7 * (1.0 + fabs(third[0])));
                jump_of_third = fmax(jump_of_third, fabs(third[0] - third[1]));
            }
        }
        if (!with_rates) assert_true(jump_of_third > 1.0); /* so the checks above see what they look at */
        td_curve_destroy(curve);
    }
}

/* A known motion: a helix that turns about a fixed skew axis. */
static void known_motion(double time, tides_pose_sample *s) {
    const double axis[3] = {2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0};
    double angle = 1.5 * time + 0.3 * sin(2.0 * time), rate = 1.5 + 0.6 * cos(2.0 * time);
    *s = (tides_pose_sample){.time = time,
                             .position = {cos(3.0 * time), sin(3.0 * time), 0.5 * time},
                             .velocity = {-3.0 * sin(3.0 * time), 3.0 * cos(3.0 * time), 0.5},
                             .has_rates = 1};
    s->quaternion[0] = cos(0.5 * angle);
    for (int k = 0; k < 3; k++) {
        s->quaternion[k + 1] = sin(0.5 * angle) * axis[k];
        s->angular_velocity[k] = rate * axis[k];
    }
}

/* Largest error in position and rotation over the whole path, ends included, sampled at `count` times over 2 s. */
static double worst_error(int count, int with_rates) {
    tides_pose_sample samples[200], truth;
    for (int i = 0; i < count; i++) {
        known_motion(2.0 * i / (count - 1), samples + i);
        samples[i].has_rates = with_rates;
    }
    tides_trajectory *path = create(samples, (size_t)count);
    double worst = 0.0;
    for (int i = 0; i <= 1000; i++) {
        tides_pose pose = pose_at(path, 2.0 * i / 1000.0);
        double rotation[9];
        known_motion(2.0 * i / 1000.0, &truth);
        td_rotation_from_quaternion(truth.quaternion, rotation);
        for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(pose.position[k] - truth.position[k]));
        for (int k = 0; k < 9; k++) worst = fmax(worst, fabs(pose.rotation[k] - rotation[k]));
    }
    tides_trajectory_destroy(path);
    return worst;
}

static void error_falls_with_the_order(void **state) {
    (void)state;
    double cubic = worst_error(51, 0), cubic_half = worst_error(101, 0);
    double quintic = worst_error(26, 1), quintic_half = worst_error(51, 1);
    print_message("    cubic %.3g -> %.3g, quintic %.3g -> %.3g\n", cubic, cubic_half, quintic, quintic_half);
    assert_true(cubic / cubic_half > 12.0);     /* order 4: 16, ends included */
    assert_true(quintic / quintic_half > 24.0); /* order 5 at the ends: 32 */
    assert_true(cubic < 1e-5 && quintic < 1e-6);
}

static void far_times_and_signs_change_nothing(void **state) {
    (void)state;
    for (int with_rates = 0; with_rates < 2; with_rates++) {
        tides_pose_sample near[COUNT], far[COUNT];
        random_samples(near, with_rates);
        memcpy(far, near, sizeof far);
        const double offset = 1305031098.5; /* a ROS stamp */
        for (int i = 0; i < COUNT; i++) {
            far[i].time += offset;
            for (int k = 0; k < 4 && i % 3 == 1; k++) far[i].quaternion[k] = -far[i].quaternion[k];
        }
        tides_trajectory *a = create(near, COUNT), *b = create(far, COUNT);
        for (int i = 0; i <= 512; i++) {
            double time = near[COUNT - 1].time * i / 512.0;
            time = floor(time * 4096.0) / 4096.0;
            tides_pose pose_a = pose_at(a, time), pose_b = pose_at(b, time + offset);
            assert_memory_equal(&pose_a, &pose_b, sizeof pose_a);
        }
        tides_trajectory_destroy(a);
        tides_trajectory_destroy(b);
    }
}

static void few_samples(void **state) {
    (void)state;
    tides_pose_sample s[3];
    memset(s, 0, sizeof s);
    for (int i = 0; i < 3; i++) s[i].quaternion[0] = 2.0;
    s[1].time = 1.0;
    s[2].time = 3.0;
    for (int i = 0; i < 3; i++) s[i].position[0] = 5.0 + s[i].time * (2.0 - s[i].time);
    tides_trajectory *path = create(s, 2); /* a line */
    tides_pose pose = pose_at(path, 0.25);
    assert_near(pose.position[0], 5.25, 1e-14);
    assert_near(pose.position_dot[0], 1.0, 1e-14);
    tides_trajectory_destroy(path);
    path = create(s, 3); /* a parabola */
    pose = pose_at(path, 2.0);
    assert_near(pose.position[0], 5.0, 1e-14);
    assert_near(pose.position_dot[0], -2.0, 1e-14);
    tides_trajectory_destroy(path);
    for (int i = 0; i < 2; i++) {
        s[i].position[0] = s[i].time * s[i].time * s[i].time;
        s[i].velocity[0] = 3.0 * s[i].time * s[i].time;
        s[i].has_rates = 1;
    }
    path = create(s, 2); /* the Hermite cubic */
    pose = pose_at(path, 0.5);
    assert_near(pose.position[0], 0.125, 1e-14);
    assert_near(pose.position_dot[0], 0.75, 1e-14);
    tides_trajectory_destroy(path);
}

/* After a gap of 1 s, 2 mm of jitter at 100 Hz mustn't be extrapolated into metres. */
static void a_gap_at_the_end_stays_calm(void **state) {
    (void)state;
    tides_pose_sample s[10];
    memset(s, 0, sizeof s);
    for (int i = 0; i < 10; i++) {
        s[i].time = i ? 1.0 + 0.01 * i : 0.0;
        s[i].quaternion[0] = 1.0;
        s[i].position[0] = i % 2 ? 0.001 : -0.001;
    }
    tides_trajectory *path = create(s, 10);
    double worst = 0.0;
    for (int i = 0; i <= 100; i++) worst = fmax(worst, fabs(pose_at(path, 0.01 * i).position[0]));
    print_message("    largest swing %.3g\n", worst);
    assert_true(worst < 0.3);
    tides_trajectory_destroy(path);
}

/* Samples may turn by just under 179 degrees each. */
static void large_even_turns(void **state) {
    (void)state;
    for (int with_rates = 0; with_rates < 2; with_rates++) {
        tides_pose_sample s[40];
        const double turn = 3.1;
        memset(s, 0, sizeof s);
        for (int i = 0; i < 40; i++) {
            s[i].time = i;
            s[i].quaternion[0] = cos(0.5 * turn * i);
            s[i].quaternion[2] = sin(0.5 * turn * i);
            s[i].angular_velocity[1] = turn;
            s[i].has_rates = with_rates;
        }
        tides_trajectory *path = create(s, 40);
        tides_pose pose = pose_at(path, 20.5), knot = pose_at(path, 20.0);
        assert_near(pose.rotation[0], cos(20.5 * turn), 1e-3);
        assert_near(knot.rotation_dot[0], -turn * sin(20.0 * turn), with_rates ? 1e-12 : 0.1);
        tides_trajectory_destroy(path);
    }
}

static void static_paths(void **state) {
    (void)state;
    const double position[3] = {1.0, 2.0, 3.0}, quaternion[4] = {0.0, 0.0, 0.0, -4.0};
    tides_trajectory *path = NULL;
    assert_int_equal(tides_trajectory_create_static(position, quaternion, &path, NULL), TIDES_OK);
    double start = 0.0, stop = 0.0;
    tides_trajectory_range(path, &start, &stop);
    assert_true(isinf(start) && start < 0.0 && isinf(stop) && stop > 0.0);
    assert_int_equal(tides_trajectory_is_static(path), 1);
    tides_pose pose = pose_at(path, -1e9);
    const double expected[9] = {-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0}, zero[9] = {0};
    for (int k = 0; k < 9; k++) assert_near(pose.rotation[k], expected[k], 0.0);
    assert_memory_equal(pose.rotation_dot, zero, sizeof zero);
    assert_memory_equal(pose.position_dot, zero, sizeof pose.position_dot);
    assert_memory_equal(pose.position, position, sizeof position);
    tides_trajectory_destroy(path);
    tides_trajectory_destroy(NULL);
    assert_int_equal(tides_trajectory_is_static(NULL), 0);
    assert_int_equal(tides_trajectory_count(NULL), 0);
}

static void ranges_and_samples(void **state) {
    (void)state;
    tides_pose_sample samples[COUNT], copy;
    tides_error error = {0, ""};
    random_samples(samples, 1);
    for (int k = 0; k < 4; k++) samples[3].quaternion[k] *= 8.0; /* normalised on the way in */
    tides_trajectory *path = create(samples, COUNT);
    double start = 0.0, stop = 0.0;
    tides_trajectory_range(path, &start, &stop);
    assert_true(start == samples[0].time && stop == samples[COUNT - 1].time);
    assert_int_equal(tides_trajectory_is_static(path), 0);
    assert_int_equal(tides_trajectory_sample(path, 3, &copy, &error), TIDES_OK);
    assert_near(copy.quaternion[1], samples[3].quaternion[1] / 8.0, 1e-15);
    assert_true(copy.has_rates && copy.velocity[2] == samples[3].velocity[2]);
    assert_int_equal(tides_trajectory_sample(path, COUNT, &copy, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "sample 12"));
    tides_pose pose, before;
    memset(&pose, 7, sizeof pose);
    before = pose;
    assert_int_equal(tides_trajectory_at(path, stop + 1e-9, &pose, &error), TIDES_OUT_OF_RANGE);
    assert_non_null(strstr(error.text, "lies outside the path"));
    assert_int_equal(tides_trajectory_at(path, start - 1e-9, &pose, NULL), TIDES_OUT_OF_RANGE);
    assert_int_equal(tides_trajectory_at(path, NAN, &pose, &error), TIDES_BAD_ARGUMENT);
    assert_memory_equal(&pose, &before, sizeof pose);
    tides_trajectory_destroy(path);
}

/* Changes one sample of a good path through `spoil`, and expects a refusal whose text has `words`. */
static void expect_refusal(int with_rates, void (*spoil)(tides_pose_sample *samples), const char *words) {
    tides_pose_sample samples[COUNT];
    tides_trajectory *path = NULL;
    tides_error error = {0, ""};
    random_samples(samples, with_rates);
    spoil(samples);
    if (tides_trajectory_create(samples, COUNT, &path, &error) != TIDES_BAD_ARGUMENT)
        fail_msg("accepted, instead of \"%s\"", words);
    assert_int_equal(error.status, TIDES_BAD_ARGUMENT);
    assert_null(path);
    if (!strstr(error.text, words)) fail_msg("\"%s\" lacks \"%s\"", error.text, words);
    assert_int_equal(tides_trajectory_create(samples, COUNT, &path, NULL), TIDES_BAD_ARGUMENT);
}

static void same_time(tides_pose_sample *s) { s[5].time = s[4].time; }
static void unsorted(tides_pose_sample *s) { s[5].time = 0.0; }
static void lost_time(tides_pose_sample *s) { s[7].time = NAN; }
static void endless(tides_pose_sample *s) { s[7].position[1] = INFINITY; }
static void lost_rotation(tides_pose_sample *s) { s[7].quaternion[2] = NAN; }
static void lost_rate(tides_pose_sample *s) { s[2].angular_velocity[2] = NAN; }
static void zero_rotation(tides_pose_sample *s) { memset(s[6].quaternion, 0, sizeof s[6].quaternion); }
static void fast_spin(tides_pose_sample *s) { s[3].angular_velocity[0] = 100.0; }
static void no_difference(tides_pose_sample *s) { s[0].time = -1e20; }
static void overflowing(tides_pose_sample *s) { s[4].position[0] = 1e308, s[5].position[0] = -1e308; }
static void half_turn(tides_pose_sample *s) {
    const double q[4] = {-s[7].quaternion[1], s[7].quaternion[0], s[7].quaternion[3], -s[7].quaternion[2]};
    memcpy(s[8].quaternion, q, sizeof q);
}
static void bad_samples_are_named(void **state) {
    (void)state;
    expect_refusal(0, same_time, "equals that of sample 4");
    expect_refusal(0, unsorted, "sample 5: its time 0 s comes before");
    expect_refusal(0, lost_time, "sample 7: time, position and quaternion must be finite");
    expect_refusal(0, endless, "sample 7");
    expect_refusal(0, lost_rotation, "sample 7");
    expect_refusal(1, lost_rate, "sample 2: velocity and angular velocity must be finite");
    expect_refusal(0, zero_rotation, "sample 6: its quaternion is zero");
    expect_refusal(0, half_turn, "samples 7 and 8");
    expect_refusal(1, fast_spin, "an angular velocity of 100");
    expect_refusal(0, no_difference, "to be told apart in double precision");
    expect_refusal(0, overflowing, "exceeds double precision");
    tides_trajectory *path = NULL;
    tides_pose_sample one = {.quaternion = {1.0}};
    assert_int_equal(tides_trajectory_create(NULL, 1, &path, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_trajectory_create(&one, 0, &path, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_trajectory_create(&one, 1, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_trajectory_create_static(NULL, one.quaternion, &path, NULL), TIDES_BAD_ARGUMENT);
}

/* Quaternion to matrix and back, in all four branches of the inverse. */
/* -- swings -------------------------------------------------------------------------------------------------------- */

/* A quick turn just before a long, quiet interval. */
static void wild(tides_pose_sample *s) {
    for (int i = 0; i < COUNT; i++) {
        const double q[4] = {cos(0.6 * (i < 6 ? i : 5)), sin(0.6 * (i < 6 ? i : 5)), 0.0, 0.0};
        memcpy(s[i].quaternion, q, sizeof q);
        s[i].time = i < 6 ? 0.001 * i : 0.005 + 0.2 * (i - 5);
    }
}

/* Two samples a tenth of a microsecond apart that differ by a millimetre and a milliradian, on a path of centimetres. */
static void jittered(tides_pose_sample *s) {
    for (int i = 0; i < COUNT; i++) {
        double time = 0.01 * (i < 6 ? i : i - 1) + (i == 6 ? 1e-7 : 0);
        s[i].time = time;
        for (int k = 0; k < 3; k++) s[i].position[k] = 0.1 * time + (i == 6 ? 1e-3 : 0);
        const double half = 0.5 * (time + (i == 6 ? 1e-3 : 0)), q[4] = {cos(half), 0, sin(half), 0};
        memcpy(s[i].quaternion, q, sizeof q);
    }
}

/* Nowhere further from the nearer of two samples than they are from each other, but for `slack`; rates are the derivatives, and
 * don't jump at the samples. */
static void expect_calm(void (*make)(tides_pose_sample *), double slack) {
    tides_pose_sample s[COUNT];
    random_samples(s, 0);
    make(s);
    tides_trajectory *path = create(s, COUNT);
    for (int i = 0; i + 1 < COUNT; i++)
        for (int probe = 1; probe < 64; probe++) {
            double span = s[i + 1].time - s[i].time, time = s[i].time + span * probe / 64, step = 1e-4 * span;
            tides_pose pose = pose_at(path, time), after = pose_at(path, time + step), from = pose_at(path, s[i].time),
                       to = pose_at(path, s[i + 1].time);
            for (int k = 0; k < 3; k++) {
                double low = fmin(s[i].position[k], s[i + 1].position[k]), high = fmax(s[i].position[k], s[i + 1].position[k]);
                assert_true(pose.position[k] > low - slack && pose.position[k] < high + slack);
            }
            for (int k = 0; k < 9; k++) {
                double between = fabs(to.rotation[k] - from.rotation[k]);
                assert_true(fabs(pose.rotation[k] - from.rotation[k]) <= between + 0.2 * between + slack);
                double rate = (after.rotation[k] - pose.rotation[k]) / step;
                assert_true(fabs(rate - pose.rotation_dot[k]) < 1e-2 * (1 + fabs(rate)) + slack / step);
            }
        }
    for (int i = 1; i + 1 < COUNT; i++) { /* C1 */
        double near = 1e-6 * fmin(s[i].time - s[i - 1].time, s[i + 1].time - s[i].time);
        tides_pose before = pose_at(path, s[i].time - near), after = pose_at(path, s[i].time + near);
        for (int k = 0; k < 3; k++) {
            double steepest = fmax(fabs(s[i].position[k] - s[i - 1].position[k]) / (s[i].time - s[i - 1].time),
                                   fabs(s[i + 1].position[k] - s[i].position[k]) / (s[i + 1].time - s[i].time));
            assert_true(fabs(after.position_dot[k] - before.position_dot[k]) < 1e-4 * (1 + steepest));
        }
    }
    tides_trajectory_destroy(path);
}

static void splines_that_swing_are_calmed(void **state) {
    (void)state;
    expect_calm(jittered, 1e-3);
    tides_pose_sample s[COUNT];
    random_samples(s, 0);
    wild(s);
    tides_trajectory *path = create(s, COUNT);
    for (int i = 0; i <= 1000; i++) { /* it stops where its samples do */
        tides_pose pose = pose_at(path, 0.005 + i * 1e-3), end = pose_at(path, 0.005);
        for (int k = 0; k < 9; k++) assert_true(fabs(pose.rotation[k] - end.rotation[k]) < 1e-2);
    }
    tides_trajectory_destroy(path);
}

/* What is thrown up comes down where it was, because its rates say so. */
static void rates_may_swing(void **state) {
    (void)state;
    tides_pose_sample s[2] = {{.quaternion = {1}, .velocity = {0, 5, 0}, .has_rates = 1},
                              {.time = 1, .quaternion = {1}, .velocity = {0, -5, 0}, .has_rates = 1}};
    tides_trajectory *path = create(s, 2);
    assert_true(fabs(pose_at(path, 0.5).position[1] - 1.25) < 1e-12);
    tides_trajectory_destroy(path);
}

static void rotations_convert_both_ways(void **state) {
    (void)state;
    uint32_t random = SEED;
    for (int i = 0; i < 2000; i++) {
        double q[4], back[4], rotation[9];
        for (int k = 0; k < 4; k++) q[k] = (uniform(&random) - 0.5) * (k == i % 4 ? 20.0 : 1.0);
        assert_true(td_normalise_quaternion(q));
        td_rotation_from_quaternion(q, rotation);
        td_quaternion_from_rotation(rotation, back);
        double sign = q[0] < 0.0 ? -1.0 : 1.0;
        for (int k = 0; k < 4; k++) assert_near(back[k], sign * q[k], 1e-14);
    }
    double tiny[4] = {1e-200, 0.0, -1e-200, 0.0};
    assert_true(td_normalise_quaternion(tiny));
    assert_near(tiny[0], sqrt(0.5), 1e-15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_through_the_samples),
        cmocka_unit_test(curve_is_smooth_at_its_knots),
        cmocka_unit_test(error_falls_with_the_order),
        cmocka_unit_test(far_times_and_signs_change_nothing),
        cmocka_unit_test(few_samples),
        cmocka_unit_test(a_gap_at_the_end_stays_calm),
        cmocka_unit_test(large_even_turns),
        cmocka_unit_test(static_paths),
        cmocka_unit_test(ranges_and_samples),
        cmocka_unit_test(bad_samples_are_named),
        cmocka_unit_test(splines_that_swing_are_calmed),
        cmocka_unit_test(rates_may_swing),
        cmocka_unit_test(rotations_convert_both_ways),
    };
    print_message("seed %u\n", SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
