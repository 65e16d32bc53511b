/* Generated paths: against their formulas between samples too, deterministic in their parameters; wrong ones are refused. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/trajectory.h"

#include "camera/td_rotation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
#define LIMIT 1e-6 /* what trajectory.h promises */

static tides_pose pose_at(const tides_trajectory *path, double time) {
    tides_pose pose;
    tides_error error = {0, ""};
    if (tides_trajectory_at(path, time, &pose, &error) != TIDES_OK) fail_msg("%s", error.text);
    return pose;
}

static void assert_near(double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) fail_msg("got %.17g, expected %.17g, tolerance %g", got, expected, tolerance);
}

/* Largest error of pose and rates, relative to `size` of position and `rate` [rad/s] of turning. */
static double pose_error(const tides_pose *a, const tides_pose *b, double size, double rate) {
    double worst = 0.0;
    for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(a->position[k] - b->position[k]) / size);
    for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(a->position_dot[k] - b->position_dot[k]) / (size * rate));
    for (int k = 0; k < 9; k++) worst = fmax(worst, fabs(a->rotation[k] - b->rotation[k]));
    for (int k = 0; k < 9; k++) worst = fmax(worst, fabs(a->rotation_dot[k] - b->rotation_dot[k]) / rate);
    return worst;
}

/* R_dot = [omega]x R */
static void spin(const double rotation[9], const double omega[3], double rotation_dot[9]) {
    for (int j = 0; j < 3; j++) {
        const double column[3] = {rotation[j], rotation[3 + j], rotation[6 + j]};
        double rate[3];
        td_cross3(omega, column, rate);
        for (int i = 0; i < 3; i++) rotation_dot[3 * i + j] = rate[i];
    }
}

static void camera_looks_at_its_target(void **state) {
    (void)state;
    const double position[3] = {0.0, -2.0, 0.0}, still[3] = {0}, target[3] = {0}, up[3] = {0.0, 0.0, 5.0};
    const double expected[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0}; /* columns: right +x, down -z, forward +y */
    double rotation[9], omega[3];
    assert_int_equal(td_look_at(position, still, target, up, rotation, omega), 1);
    for (int k = 0; k < 9; k++) assert_near(rotation[k], expected[k], 1e-15);
    const double above[3] = {0.0, 0.0, 3.0};
    assert_int_equal(td_look_at(above, still, target, up, rotation, omega), 0);
    assert_int_equal(td_look_at(target, still, target, up, rotation, omega), 0);
}

/* An orbit about +z seen from above turns counterclockwise from +x. */
static void orbit_follows_its_formula(void **state) {
    (void)state;
    const tides_orbit o = {.target = {1, 2, 3},
                           .up = {0, 0, 2},
                           .radius = 2,
                           .height = 1.5,
                           .start_angle = 0.4,
                           .angular_speed = -6,
                           .start = 10,
                           .stop = 12};
    tides_trajectory *path = NULL;
    assert_int_equal(tides_trajectory_create_orbit(&o, &path, NULL), TIDES_OK);
    double worst = 0.0;
    for (int i = 0; i <= 5000; i++) {
        double time = o.start + (o.stop - o.start) * i / 5000.0, a = o.start_angle + o.angular_speed * (time - o.start);
        const double omega[3] = {0, 0, o.angular_speed}, norm = hypot(o.radius, o.height);
        const double right[3] = {-sin(a), cos(a), 0}; /* looking inwards, counterclockwise is to the right */
        const double forward[3] = {-cos(a) * o.radius / norm, -sin(a) * o.radius / norm, -o.height / norm};
        double down[3];
        tides_pose expected = {.position = {1 + 2 * cos(a), 2 + 2 * sin(a), 4.5},
                               .position_dot = {12 * sin(a), -12 * cos(a), 0}};
        td_cross3(forward, right, down);
        for (int k = 0; k < 3; k++) {
            expected.rotation[3 * k] = right[k];
            expected.rotation[3 * k + 1] = down[k];
            expected.rotation[3 * k + 2] = forward[k];
        }
        spin(expected.rotation, omega, expected.rotation_dot);
        tides_pose pose = pose_at(path, time);
        worst = fmax(worst, pose_error(&pose, &expected, o.radius, 6.0));
    }
    print_message("    orbit: off by %.2g with %zu samples\n", worst, tides_trajectory_count(path));
    assert_true(worst < LIMIT);
    tides_trajectory_destroy(path);
}

static void short_and_resting_orbits(void **state) {
    (void)state;
    tides_orbit o = {.up = {1, 0, 0}, .radius = 2, .angular_speed = 1e-3, .stop = 0.5};
    tides_trajectory *path = NULL;
    assert_int_equal(tides_trajectory_create_orbit(&o, &path, NULL), TIDES_OK);
    assert_near(pose_at(path, 0.0).position[1], 2.0, 1e-14); /* up is x: angles count from y */
    assert_near(pose_at(path, 0.3).position[2], 2.0 * sin(3e-4), 1e-14);
    tides_trajectory_destroy(path);
    o.angular_speed = 0.0;
    assert_int_equal(tides_trajectory_create_orbit(&o, &path, NULL), TIDES_OK);
    tides_pose pose = pose_at(path, 0.25);
    for (int k = 0; k < 9; k++) assert_near(pose.rotation_dot[k], 0.0, 1e-15);
    tides_trajectory_destroy(path);
}

/* The formula again, written out: position on the line; forward, right, down by normalised cross products. */
static void dolly_pose(const tides_dolly *d, double time, tides_pose *pose) {
    double fraction = (time - d->start) / (d->stop - d->start), forward[3], right[3], down[3];
    for (int k = 0; k < 3; k++) {
        pose->position_dot[k] = (d->to[k] - d->from[k]) / (d->stop - d->start);
        pose->position[k] = d->from[k] + fraction * (d->to[k] - d->from[k]);
        forward[k] = d->target[k] - pose->position[k];
    }
    td_cross3(forward, d->up, right);
    td_cross3(forward, right, down);
    for (int k = 0; k < 3; k++) {
        pose->rotation[3 * k] = right[k] / td_length3(right);
        pose->rotation[3 * k + 1] = down[k] / td_length3(down);
        pose->rotation[3 * k + 2] = forward[k] / td_length3(forward);
    }
}

static void dolly_follows_its_formula(void **state) {
    (void)state;
    const tides_dolly paths[] = {
        {.from = {-3, 0, 1}, .to = {3, 1, 1}, .target = {0, 3, 0}, .up = {0, 0, 1}, .start = -1, .stop = 1},
        {.from = {-3, 0, 1}, .to = {3, 0, 1}, .target = {0, 0.2, 0}, .up = {0, 0, 1}, .start = 0, .stop = 2}, /* close by */
        {.from = {0, -5, 0}, .to = {0, -1, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .start = 0, .stop = 2},  /* straight on */
        {.from = {0, -5, 0}, .to = {0, -5, 4}, .target = {0, 0, 0}, .up = {0, 0, 1}, .start = 0, .stop = 2},  /* upwards */
    };
    for (size_t p = 0; p < sizeof paths / sizeof *paths; p++) {
        const tides_dolly *d = paths + p;
        tides_trajectory *path = NULL;
        assert_int_equal(tides_trajectory_create_dolly(d, &path, NULL), TIDES_OK);
        double worst = 0.0;
        for (int i = 1; i < 3000; i++) {
            double time = d->start + (d->stop - d->start) * i / 3000.0, h = 1e-4;
            tides_pose expected, before, after, pose = pose_at(path, time);
            dolly_pose(d, time - h, &before);
            dolly_pose(d, time + h, &after);
            dolly_pose(d, time, &expected);
            /* The formula's rate by differences, good to h^2 times its third derivative. */
            for (int k = 0; k < 9; k++) expected.rotation_dot[k] = (after.rotation[k] - before.rotation[k]) / (2.0 * h);
            double rates = 0.0;
            for (int k = 0; k < 9; k++) rates = fmax(rates, fabs(pose.rotation_dot[k] - expected.rotation_dot[k]));
            assert_true(rates < 1e-4);
            memcpy(expected.rotation_dot, pose.rotation_dot, sizeof pose.rotation_dot);
            worst = fmax(worst, pose_error(&pose, &expected, 6.0, 3.0));
        }
        print_message("    dolly %zu: off by %.2g with %zu samples\n", p, worst, tides_trajectory_count(path));
        assert_true(worst < LIMIT);
        tides_trajectory_destroy(path);
    }
}

static const tides_handheld shaky = {.position = {0, -3, 1},
                                     .target = {0, 0, 1},
                                     .up = {0, 0, 1},
                                     .position_amplitude = 0.02,
                                     .rotation_amplitude = 0.03,
                                     .frequency = 1.5,
                                     .seed = 11,
                                     .start = 5,
                                     .stop = 205};

/* Sum of the four sines with unit rms whose phases are fitted to a generated path: the formula, found from the outside. */
static double residual_of_sines(const double *signal, int count, double step, double amplitude) {
    double residual = 0.0, energy = 0.0, rest[4096];
    memcpy(rest, signal, (size_t)count * sizeof *rest);
    for (int sweep = 0; sweep < 60; sweep++) /* Gauss-Seidel on least squares: take out one frequency after the other */
        for (int f = 0; f < 4; f++) {
            double w = 2.0 * PI * shaky.frequency * pow(5.0, f / 3.0), c = 0.0, s = 0.0;
            for (int i = 0; i < count; i++) {
                c += rest[i] * cos(w * step * i) * 2.0 / count;
                s += rest[i] * sin(w * step * i) * 2.0 / count;
            }
            for (int i = 0; i < count; i++) rest[i] -= c * cos(w * step * i) + s * sin(w * step * i);
        }
    for (int i = 0; i < count; i++) {
        residual = fmax(residual, fabs(rest[i]));
        energy += signal[i] * signal[i] / count;
    }
    assert_true(fabs(sqrt(energy) / amplitude - 1.0) < 0.05);
    return residual / amplitude;
}

/* Position is the sines' sum exactly, rms as asked, and mean 0; rotation's rms is as asked. */
static void handheld_is_a_sum_of_sines(void **state) {
    (void)state;
    tides_trajectory *path = NULL;
    assert_int_equal(tides_trajectory_create_handheld(&shaky, &path, NULL), TIDES_OK);
    double signal[3][4096], turn = 0.0, base[9];
    const double still[3] = {0};
    td_look_at(shaky.position, still, shaky.target, shaky.up, base, NULL);
    for (int i = 0; i < 4096; i++) {
        tides_pose pose = pose_at(path, shaky.start + 200.0 * i / 4096.0);
        double trace = 0.0;
        for (int k = 0; k < 3; k++) signal[k][i] = pose.position[k] - shaky.position[k];
        for (int k = 0; k < 9; k++) trace += pose.rotation[k] * base[k];
        turn += pow(acos(fmin(1.0, 0.5 * (trace - 1.0))), 2.0) / 4096.0;
    }
    for (int k = 0; k < 3; k++) {
        double residual = residual_of_sines(signal[k], 4096, 200.0 / 4096.0, shaky.position_amplitude);
        print_message("    axis %d: off by %.2g with %zu samples\n", k, residual, tides_trajectory_count(path));
        assert_true(residual < LIMIT);
    }
    assert_near(sqrt(turn / 3.0), shaky.rotation_amplitude, 0.05 * shaky.rotation_amplitude);
    tides_trajectory_destroy(path);
}

static void handheld_depends_on_its_seed_alone(void **state) {
    (void)state;
    tides_handheld other = shaky;
    other.stop = shaky.start + 4.0;
    tides_trajectory *a = NULL, *b = NULL, *c = NULL;
    assert_int_equal(tides_trajectory_create_handheld(&other, &a, NULL), TIDES_OK);
    assert_int_equal(tides_trajectory_create_handheld(&other, &b, NULL), TIDES_OK);
    other.seed++;
    assert_int_equal(tides_trajectory_create_handheld(&other, &c, NULL), TIDES_OK);
    tides_pose pose_a = pose_at(a, 6.0), pose_b = pose_at(b, 6.0), pose_c = pose_at(c, 6.0);
    assert_memory_equal(&pose_a, &pose_b, sizeof pose_a);
    assert_true(fabs(pose_a.position[0] - pose_c.position[0]) > 1e-4);
    tides_trajectory_destroy(a);
    tides_trajectory_destroy(b);
    tides_trajectory_destroy(c);
}

/* The samples' rates, which are analytic, against the formula by differences of a path with twice the density. */
static void handheld_rates_are_those_of_the_formula(void **state) {
    (void)state;
    tides_handheld h = shaky, dense = shaky;
    h.stop = dense.stop = h.start + 2.0;
    h.rotation_amplitude = dense.rotation_amplitude = 0.5; /* angles beyond pi: all of the exponential's terms count */
    tides_trajectory *path = NULL;
    assert_int_equal(tides_trajectory_create_handheld(&h, &path, NULL), TIDES_OK);
    for (size_t i = 3; i + 3 < tides_trajectory_count(path); i++) {
        /* Poses at neighbouring samples come from the formula: a seven-point difference of their matrices. */
        static const double weight[7] = {-1.0 / 60, 3.0 / 20, -3.0 / 4, 0, 3.0 / 4, -3.0 / 20, 1.0 / 60};
        tides_pose_sample s, at;
        double difference[9] = {0}, rotation[9], rate[9], step = 0.0;
        for (size_t j = 0; j < 7; j++) {
            assert_int_equal(tides_trajectory_sample(path, i + j - 3, &s, NULL), TIDES_OK);
            if (j == 3) at = s;
            if (j == 4) step = s.time - at.time;
            td_rotation_from_quaternion(s.quaternion, rotation);
            for (int k = 0; k < 9; k++) difference[k] += weight[j] * rotation[k];
        }
        td_rotation_from_quaternion(at.quaternion, rotation);
        spin(rotation, at.angular_velocity, rate);
        for (int k = 0; k < 9; k++) assert_near(rate[k], difference[k] / step, 1e-3);
    }
    tides_trajectory_destroy(path);
}

#define expect_refusal(call, words)                                                         \
    do {                                                                                    \
        tides_trajectory *path = NULL;                                                      \
        tides_error error = {0, ""};                                                        \
        assert_int_equal(call, TIDES_BAD_ARGUMENT);                                         \
        assert_null(path);                                                                  \
        if (!strstr(error.text, words)) fail_msg("\"%s\" lacks \"%s\"", error.text, words); \
    } while (0)

static void bad_generators_are_refused(void **state) {
    (void)state;
    const tides_orbit orbit = {.up = {0, 0, 1}, .radius = 2, .angular_speed = 1, .stop = 1};
    const tides_dolly dolly = {.from = {-1, -1, 0}, .to = {1, -1, 0}, .up = {0, 0, 1}, .stop = 1};
    tides_orbit o = orbit;
    o.radius = 0.0;
    expect_refusal(tides_trajectory_create_orbit(&o, &path, &error), "orbit: radius must be above 0");
    o = orbit, o.up[2] = 0.0;
    expect_refusal(tides_trajectory_create_orbit(&o, &path, &error), "orbit: `up` must be");
    o = orbit, o.stop = 0.0;
    expect_refusal(tides_trajectory_create_orbit(&o, &path, &error), "must come after start");
    o = orbit, o.angular_speed = 1e9;
    expect_refusal(tides_trajectory_create_orbit(&o, &path, &error), "samples, more than");
    o = orbit, o.target[1] = NAN;
    expect_refusal(tides_trajectory_create_orbit(&o, &path, &error), "finite");
    tides_dolly d = dolly;
    d.from[1] = d.to[1] = 0.0;
    expect_refusal(tides_trajectory_create_dolly(&d, &path, &error), "dolly: the way from");
    d = dolly, d.from[1] = d.to[1] = 0.0, d.from[2] = d.to[2] = 4.0; /* over the target's head */
    expect_refusal(tides_trajectory_create_dolly(&d, &path, &error), "straight over it");
    d = dolly, d.start = 2.0;
    expect_refusal(tides_trajectory_create_dolly(&d, &path, &error), "must come after start");
    d = dolly, memset(d.up, 0, sizeof d.up);
    expect_refusal(tides_trajectory_create_dolly(&d, &path, &error), "dolly: `up` must be");
    d = dolly, d.from[0] = d.to[0] = d.from[1] = d.to[1] = 0.0;
    expect_refusal(tides_trajectory_create_dolly(&d, &path, &error), "dolly: ");
    tides_handheld h = shaky;
    h.frequency = 0.0;
    expect_refusal(tides_trajectory_create_handheld(&h, &path, &error), "frequency must be above 0");
    h = shaky, h.rotation_amplitude = 2.0;
    expect_refusal(tides_trajectory_create_handheld(&h, &path, &error), "rotation_amplitude is 2 rad");
    h = shaky, h.up[1] = 1.0, h.up[2] = 0.0;
    expect_refusal(tides_trajectory_create_handheld(&h, &path, &error), "looks along `up`");
    expect_refusal(tides_trajectory_create_orbit(NULL, &path, &error), "orbit: needs parameters");
    expect_refusal(tides_trajectory_create_dolly(NULL, &path, &error), "dolly: needs parameters");
    expect_refusal(tides_trajectory_create_handheld(NULL, &path, &error), "handheld: needs parameters");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(camera_looks_at_its_target),
        cmocka_unit_test(orbit_follows_its_formula),
        cmocka_unit_test(short_and_resting_orbits),
        cmocka_unit_test(dolly_follows_its_formula),
        cmocka_unit_test(handheld_is_a_sum_of_sines),
        cmocka_unit_test(handheld_depends_on_its_seed_alone),
        cmocka_unit_test(handheld_rates_are_those_of_the_formula),
        cmocka_unit_test(bad_generators_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
