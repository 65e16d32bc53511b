/* Motion and light that return to their state within one longest step. No event may be lost or invented because the nodes of a
 * step, or of the paths on which events are looked up, don't show it. Exact events come from frames 10 us apart and closer, or
 * from a formula. Runs are in double and in single precision, with and without look-ups (random motions: test_band_limited.c).
 * TIDES_TRIALS=1 runs each case at all its phases, otherwise at one of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/judged_run.h"
#include "tests/support/pulsing_callback.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t SEED = 20261;

/* Of the exact events of all cases, in percent; of a single case's, which may be few, within three standard errors: a touch
 * that is lost takes the event with it that would undo it, so that mismatches come in pairs. */
#define MOST_MISMATCH 0.05
/* Honesty is asked of errors that the exact events are ten times better than, or of what is left of them. */
enum { FRAMES = 2000, FRAMES_OF_ALL_PHASES = 8000 };

/* Phases of sines against the steps' ends, most of which are whole periods apart: zero (the same place and the same speed at
 * both), a quarter (at rest at both, in the same place), and one without symmetry. */
static const double phases[] = {0, 0.5 * WORLD_PI, 0.7};

/* -- scenes ---------------------------------------------------------------------------------------------------------------- */

enum { WIDTH = 20, HEIGHT = 10 }; /* two tiles; the double reference takes 0.2 ms for a frame */
#define FOCAL (1.25 * WIDTH)
#define PIXEL_AT_2 (2 / FOCAL) /* scene units of a pixel at depth 2 */

/* Thresholds differ, so that a signal that comes back to where it began doesn't touch a level there. */
static judged small(const char *name, double stop, int frames) {
    judged j = judged_make(name, WIDTH, HEIGHT, stop);
    j.sensor.threshold_on = 0.04;
    j.sensor.threshold_off = 0.0415;
    j.frames = frames;
    return j;
}

static void add_wall(judged *j, uint64_t seed) {
    splat_set wall = {0};
    splat_set_texture(&wall, &seed, 24, 3, 1.3, 1.0, 0.25);
    world_add(j->scene, &wall, NULL);
}

static splat_set thing(uint64_t seed) {
    splat_set set = {0};
    splat_set_texture(&set, &seed, 10, 2, 0.45, 0.35, 0.12);
    return set;
}

/* A wall whose lamp is on keyframes. */
static judged lamp(const char *name, double hz, double depth, double interval, double phase) {
    const double stop = hz < 500 ? 0.02 : 0.0123; /* two steps, the second a part */
    judged j = small(name, stop, 2 * (int)(125 * hz * stop));
    uint64_t seed = SEED;
    splat_set wall = {0};
    splat_set_texture(&wall, &seed, 16, 3, 1.3, 1.0, 0.3);
    j.sensor.threshold_on = 0.1;
    j.sensor.threshold_off = 0.1037;
    const pulsing p = {.light = waves_one(depth, hz, phase)};
    tides_motion *motion = pulsing_keyframes(&wall, &p, j.stop, interval);
    world_add_moving(j.scene, &wall, motion, 0);
    return j;
}
static judged lamp_100(double phase) { return lamp("lamp at 100 Hz", 100, 0.8, 0.5e-3, phase); }
static judged lamp_1k(double phase) { return lamp("lamp at 1 kHz", 1000, 0.8, 0.05e-3, phase); }
/* Two keys a period: a spline's own ends swing further, but not to black. */
static judged lamp_1k_coarse(double phase) { return lamp("lamp at 1 kHz, keys every 0.5 ms", 1000, 0.5, 0.5e-3, phase + 0.3); }

static judged vibrating_object(double phase) {
    judged j = small("object vibrating by 2 px at 100 Hz", 0.03, 1000);
    const shaking s = {.shift = {waves_one(2 * PIXEL_AT_2, 100, phase)}};
    tides_trajectory *path = shaking_path(&s, 0, j.stop, 0.5e-3, 1);
    splat_set set = thing(SEED + 1);
    add_wall(&j, SEED);
    world_add(j.scene, &set, path);
    tides_trajectory_destroy(path);
    return j;
}

static judged vibrating_camera(const char *name, double hz, double phase) {
    judged j = small(name, 0.03, 1000);
    const shaking s = {.turn = {[1] = waves_one(0.13 / FOCAL, hz, phase)}};
    judged_camera(&j, shaking_path(&s, 0, j.stop, 0.5e-3, 0));
    add_wall(&j, SEED + 2);
    j.sensor.threshold_on = 0.02;
    j.sensor.threshold_off = 0.0207;
    return j;
}
static judged vibrating_100(double phase) { return vibrating_camera("camera by 0.13 px at 100 Hz, C 0.02", 100, phase); }
static judged vibrating_200(double phase) { return vibrating_camera("camera by 0.13 px at 200 Hz, C 0.02", 200, phase); }

static judged shaken_camera(double phase) {
    judged j = small("camera by 6 px at 100 Hz, steps 2 ms", 0.02, 1000);
    /* Shifted, not turned: turning by a quarter of the view swaps depths within microseconds. */
    const shaking s = {.shift = {waves_one(6 * PIXEL_AT_2, 100, phase)}};
    judged_camera(&j, shaking_path(&s, 0, j.stop, 0.5e-3, 1));
    add_wall(&j, SEED + 3);
    j.stepping.step_s = 2e-3;
    return j;
}

static judged rolling_camera(double phase) {
    judged j = small("camera rolling by 0.05 at 200 Hz", 0.02, 1000);
    const shaking s = {.turn = {[2] = waves_one(0.05, 200, phase)}};
    judged_camera(&j, shaking_path(&s, 0, j.stop, 0.25e-3, 1));
    add_wall(&j, SEED + 4);
    return j;
}

/* Its mean stays where it is: only the shape moves, half a turn per step. */
static judged spinning(double phase) {
    judged j = small("needle spinning at 50 rev/s", 0.03, 1000);
    const shaking s = {.place = {0, 0, 2}, .spin = {0, 0, 2 * WORLD_PI * 50}, .centre_time = -phase / (100 * WORLD_PI)};
    tides_trajectory *path = shaking_path(&s, 0, j.stop, 0.5e-3, 1);
    const splat needle = {{0, 0, 0}, {0.35, 0.03, 0.03}, {1, 0, 0, 0}, 0.95, {0.9, 0.9, 0.9}};
    splat_set set = {0};
    splat_set_add(&set, &needle);
    add_wall(&j, SEED + 5);
    world_add(j.scene, &set, path);
    tides_trajectory_destroy(path);
    return j;
}

/* Parameters that pulse, by keyframes, or by a function that declares its time scale. */
static judged by_keyframes(const char *name, const pulsing *p, uint64_t seed, double interval) {
    judged j = small(name, 0.02, 1000);
    splat_set set = thing(seed);
    tides_motion *motion = pulsing_keyframes(&set, p, j.stop, interval);
    add_wall(&j, SEED + 5);
    world_add_moving(j.scene, &set, motion, 0);
    return j;
}
static judged by_function(const char *name, const pulsing *p, uint64_t seed, double time_scale) {
    judged j = small(name, 0.02, 1000);
    splat_set set = thing(seed);
    j.user = malloc(sizeof *p);
    assert_non_null(j.user);
    memcpy(j.user, p, sizeof *p);
    tides_motion *motion = pulsing_callback(&set, j.user, j.stop, time_scale);
    add_wall(&j, SEED + 5);
    world_add_moving(j.scene, &set, motion, 0);
    return j;
}
static judged turning_keyframes(double phase) {
    const pulsing p = {.turn = waves_one(0.8, 100, phase)};
    return by_keyframes("needles turned by keyframes, 100 Hz", &p, SEED + 6, 0.25e-3);
}
static judged breathing_keyframes(double phase) {
    const pulsing p = {.log_size = waves_one(0.4, 200, phase)};
    return by_keyframes("sizes that pulse at 200 Hz", &p, SEED + 7, 0.25e-3);
}
static judged fading_keyframes(double phase) {
    const pulsing p = {.logit = waves_one(1.5, 300, phase)};
    return by_keyframes("opacities that pulse at 300 Hz", &p, SEED + 8, 0.2e-3);
}
/* Whole periods in a step: nothing but the declared scale tells of them. */
static judged fading_function(double phase) {
    const pulsing p = {.logit = waves_one(1.5, 300, phase), .light = waves_one(0.3, 700, phase)};
    judged j = by_function("opacities by a function, 300 and 700 Hz", &p, SEED + 13, 1.0 / 700);
    j.sensor.leak_rate_hz = 0.3; /* without it one of 30 748 events is a tie: a pixel returns exactly to a level */
    return j;
}
static judged shaking_function(double phase) {
    const pulsing p = {.shift = {waves_one(1.5 * PIXEL_AT_2, 400, phase), waves_one(PIXEL_AT_2, 100, phase)},
                       .turn = waves_one(0.4, 200, phase)};
    return by_function("places by a function, 400 Hz", &p, SEED + 14, 1.0 / 400);
}

/* Behind the camera at both ends of a step, in front of it between: half a period of 50 Hz. */
static judged through_the_camera(double phase) {
    judged j = small("ball behind the camera at both ends", 0.01, 2000);
    const shaking s = {.place = {0.15, 0.1, -0.5}, .shift = {[2] = waves_one(2.5, 50, phase > 0.6 && phase < 0.8 ? 0.2 : 0)}};
    tides_trajectory *path = shaking_path(&s, 0, j.stop, 0.25e-3, 1);
    splat_set set = {0};
    splat_set_ball(&set, 0, 0, 0, 0.15, 0.9, 0.9);
    add_wall(&j, SEED + 9);
    world_add(j.scene, &set, path);
    tides_trajectory_destroy(path);
    return j;
}

/* Crosses the view in less than a millisecond, in the middle of a step (or off it), on a straight path of two samples. */
static judged dart(double phase) {
    judged j = small("ball that crosses the view in 0.8 ms", 0.01, 2000);
    const shaking s = {.place = {0, 0.1, 2}, .velocity = {2000, 0, 0}, .centre_time = 0.005 - 1e-3 * (phase - phases[0])};
    tides_trajectory *path = shaking_path(&s, 0, j.stop, j.stop, 1);
    splat_set set = {0};
    splat_set_ball(&set, 0, 0, 0, 0.15, 0.9, 0.9);
    add_wall(&j, SEED + 9);
    world_add(j.scene, &set, path);
    tides_trajectory_destroy(path);
    return j;
}

/* SpacetimeGaussians: opacity exp(-(dt / width)^2), here 0.7 ms wide, anywhere in 40 ms. */
static judged bells(double phase) {
    enum { COUNT = 40 };
    judged j = small("SpacetimeGaussians bells of 0.7 ms", 0.03, 2000);
    float centre[COUNT], width[COUNT], mean[9 * COUNT] = {0}, turn[4 * COUNT] = {0};
    uint64_t seed = SEED + 10 + (uint64_t)(10 * phase);
    splat_set set = {0};
    tides_motion *motion = NULL;
    tides_error error;
    splat_set_texture(&set, &seed, COUNT, 2, 0.8, 0.6, 0.15);
    for (int i = 0; i < COUNT; i++) {
        centre[i] = (float)scene_between(&seed, 0.02, 0.98);
        width[i] = (float)log(0.7e-3 / j.stop);
        for (int k = 0; k < 3; k++) mean[9 * i + k] = (float)scene_between(&seed, -0.5, 0.5);
    }
    const tides_polynomial_motion arrays = {COUNT, 0, 1, centre, width, mean, turn, .plain_colour = 0};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    add_wall(&j, SEED + 11);
    world_add_moving(j.scene, &set, motion, j.stop);
    return j;
}

/* 4d-gaussian-splatting: bells of 0.7 ms, and colours with harmonics of 1 and 2 kHz. */
static judged rotor_bells(double phase) {
    enum { COUNT = 24, HARMONICS = 2 };
    judged j = small("4-D Gaussians of 0.7 ms, colours at 1 kHz", 0.02, 2000);
    float centre[COUNT], width[COUNT], harmonic[3 * HARMONICS * COUNT];
    uint64_t seed = SEED + 12 + (uint64_t)(10 * phase);
    splat_set set = {0};
    tides_motion *motion = NULL;
    tides_error error;
    splat_set_texture(&set, &seed, COUNT, 2, 0.8, 0.6, 0.2);
    for (int i = 0; i < COUNT; i++) {
        const double sigma = i % 2 ? 0.7e-3 : 0.1; /* half of them are there all the time */
        centre[i] = (float)scene_between(&seed, 0, j.stop);
        width[i] = (float)(2 * log(sigma)); /* without quaternion_right e^log_scale_time is the variance */
    }
    for (int i = 0; i < 3 * HARMONICS * COUNT; i++) harmonic[i] = (float)scene_between(&seed, -0.3, 0.3);
    const tides_rotor_motion arrays = {.count = COUNT,
                                       .start = 0,
                                       .stop = j.stop,
                                       .period = 1e-3,
                                       .centre = centre,
                                       .log_scale_time = width,
                                       .sh_harmonic = harmonic,
                                       .harmonics = HARMONICS};
    scene_expect_ok(tides_motion_create_rotor(&arrays, &motion, &error), &error);
    add_wall(&j, SEED + 11);
    world_add_moving(j.scene, &set, motion, 0);
    return j;
}

/* -- judging --------------------------------------------------------------------------------------------------------------- */

static int all_phases(void) {
    const char *trials = getenv("TIDES_TRIALS");
    return trials && atoi(trials) > 0;
}

/* Of all cases, in double and in single precision. */
static double all_exact, all_mismatched;

static int expect_seen(const judged *j, const char *device, const judged_verdict *v) {
    /* What the exact stream itself doesn't know, nobody can be asked for. */
    const double unknown = (double)(v->halved.missing + v->halved.spurious);
    const double expected = 0.01 * MOST_MISMATCH * (double)v->match.reference,
                 allowed = unknown + expected + 3 * sqrt(2 * expected);
    const double wrong = (double)(v->match.missing + v->match.spurious);
    all_exact += (double)v->match.reference;
    all_mismatched += fmax(0, wrong - unknown);
    judged_print(j, device, v);
    /* A run knows of them itself: each is a touch, one event or two. (In single precision vibrating_100 has one more pair than
     * in double, 0.17 % of its few: there the top is 4e-8 below its level, here 2e-7 above, and rounding is 7e-7.) */
    const int told = wrong <= unknown + 2.0 * (double)v->stats.events_uncertain;
    return wrong <= allowed && told && judged_honest(v);
}

typedef judged (*case_maker)(double phase);
/* `first`: the phase that it is judged at where there's time for one. */
static void judge(case_maker make, int first) {
    static const char *const runs[] = {"reference", "reference-f32", "looked up", "looked up, f32"};
    const judged_scale scale = {0.1, JUDGED_LIMIT_S, all_phases() ? FRAMES_OF_ALL_PHASES : FRAMES};
    int failures = 0;
    for (int i = 0; i < (all_phases() ? 3 : 1); i++) {
        judged j = make(phases[(first + i) % 3]);
        judged_stream exact = {0};
        int settled = 0;
        judged_verdict v = judged_against_exact(&j, "reference", &scale, &settled, &exact);
        if (!settled)
            print_message("%s: the exact events moved by p99 %.3g us at %d frames\n", j.name, v.halved.dt_p99_us, v.frames);
        assert_true(exact.count > 700);
        failures += !expect_seen(&j, runs[0], &v);
        const tides_match halved = v.halved;
        for (int k = 1; k < 4; k++) {
            if (k == 2) judged_look_up(&j);
            v = judged_against(&j, k % 2 ? "reference-f32" : "reference", JUDGED_LIMIT_S, &exact);
            v.halved = halved;
            failures += !expect_seen(&j, runs[k], &v) || (v.stats.events_solved > 0) != (k >= 2);
        }
        free(exact.events);
        judged_free(&j);
    }
    assert_int_equal(failures, 0);
}

#define CASE(name, first) \
    static void test_##name(void **state) { (void)state, judge(name, first); }
CASE(lamp_100, 0)
CASE(lamp_1k, 1)
CASE(lamp_1k_coarse, 1)
CASE(vibrating_object, 0)
CASE(vibrating_100, 0)
CASE(vibrating_200, 1)
CASE(shaken_camera, 1)
CASE(rolling_camera, 1)
CASE(spinning, 1)
CASE(turning_keyframes, 1)
CASE(breathing_keyframes, 1)
CASE(fading_keyframes, 0)
CASE(fading_function, 1)
CASE(shaking_function, 0)
CASE(through_the_camera, 0)
CASE(dart, 0)
CASE(bells, 0)
CASE(rotor_bells, 0)

/* After all the others. */
static void test_all_together(void **state) {
    (void)state;
    print_message("%.0f of %.0f events mismatched: %.3g %%\n", all_mismatched, all_exact, 100 * all_mismatched / all_exact);
    assert_true(all_mismatched <= 0.01 * MOST_MISMATCH * all_exact);
}

/* -- the pulse ------------------------------------------------------------------------------------------------------------- */

/* L = -2 + 1.9 exp(-((t - 5 ms) / 2 ms)^2), the issue's own, over a splat so large and so opaque (alpha_max everywhere) that it
 * alone is seen. */
#define PULSE_LOW -2.0
#define PULSE_HIGH 1.9
#define PULSE_WIDTH_S 2e-3
#define PULSE_CENTRE_S 5e-3
#define ALPHA_MAX 0.99

static double pulse_colour(const judged *j, double t, double *rate) {
    const double u = (t - PULSE_CENTRE_S) / PULSE_WIDTH_S, bell = PULSE_HIGH * exp(-u * u), light = exp(PULSE_LOW + bell);
    *rate = light * bell * -2 * u / PULSE_WIDTH_S / ALPHA_MAX;
    return (light - j->image.log_eps) / ALPHA_MAX;
}

static tides_status pulse_function(void *user, double time, int32_t side, const int32_t *index, int64_t count,
                                   const tides_theta *theta, tides_error *error) {
    (void)side, (void)index, (void)error;
    double rate;
    const double colour = pulse_colour(user, time, &rate);
    for (int64_t i = 0; i < 3 * count; i++) {
        theta->sh[i] = (colour - 0.5) / WORLD_SH0;
        theta->sh_dot[i] = rate / WORLD_SH0;
    }
    return TIDES_OK;
}

static judged pulse(int by_callback, double on, double off) {
    judged j = judged_make(by_callback ? "pulse, callback" : "pulse, keyframes", 8, 6, 0.01);
    tides_motion *motion = NULL;
    tides_error error;
    splat_set set = {0};
    splat_set_ball(&set, 0, 0, 2, 20, 0.9999, 0.5);
    j.sensor.threshold_on = on;
    j.sensor.threshold_off = off;
    if (by_callback) {
        const tides_callback_motion callback = {.count = 1,
                                                .stop = j.stop,
                                                .function = pulse_function,
                                                .user = malloc(sizeof j),
                                                .moves_sh = 1};
        assert_non_null(callback.user);
        j.user = memcpy(callback.user, &j, sizeof j);
        scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    } else {
        enum { KEYS = 201 };
        double time[KEYS], rate;
        float mean[3 * KEYS] = {0}, quaternion[4 * KEYS] = {0}, sh[3 * KEYS];
        for (int f = 0; f < KEYS; f++) {
            time[f] = j.stop * f / (KEYS - 1);
            mean[3 * f + 2] = 2;
            quaternion[4 * f] = 1;
            for (int k = 0; k < 3; k++) sh[3 * f + k] = world_sh(pulse_colour(&j, time[f], &rate));
        }
        const tides_keyframes_motion keys =
            {.frames = KEYS, .count = 1, .time = time, .mean = mean, .quaternion = quaternion, .sh = sh};
        scene_expect_ok(tides_motion_create_keyframes(&keys, &motion, &error), &error);
    }
    world_add_moving(j.scene, &set, motion, 0);
    return j;
}

/* By the formula's inverse: 9 ON on its way up, and OFF on its way down. */
static judged_stream pulse_events(const judged *j) {
    judged_stream s = {calloc(40, sizeof(tides_event)), 0, 40};
    const double first = PULSE_LOW + PULSE_HIGH * exp(-pow(PULSE_CENTRE_S / PULSE_WIDTH_S, 2));
    const double on = j->sensor.threshold_on, off = j->sensor.threshold_off;
    const int ups = (int)floor((PULSE_LOW + PULSE_HIGH - first) / on), downs = (int)floor(ups * on / off - 1e-9);
    for (int k = 1; k <= ups + downs; k++) {
        const double level = first + (k <= ups ? k * on : ups * on - (k - ups) * off);
        const double away = PULSE_WIDTH_S * sqrt(-log((level - PULSE_LOW) / PULSE_HIGH));
        const double t = PULSE_CENTRE_S + (k <= ups ? -away : away);
        s.events[s.count++] = (tides_event){.t = (int64_t)floor(1e9 * t), .polarity = (int8_t)(k <= ups ? 1 : -1)};
    }
    return s;
}

/* Every pixel sees the same. */
static judged_stream in_every_pixel(const judged *j, const judged_stream *one) {
    const int pixels = j->intrinsics.width * j->intrinsics.height;
    judged_stream s = {calloc((size_t)pixels * one->count + 1, sizeof(tides_event)), 0, (size_t)pixels * one->count};
    assert_non_null(s.events);
    for (int i = 0; i < pixels; i++)
        for (size_t k = 0; k < one->count; k++) {
            s.events[s.count] = one->events[k];
            s.events[s.count].x = (uint16_t)(i % j->intrinsics.width);
            s.events[s.count++].y = (uint16_t)(i / j->intrinsics.width);
        }
    return s;
}

/* With a threshold of OFF that doesn't end where the run began; with the issue's own, where the last OFF falls on the run's end
 * to the bit, either answer is right for that one. */
static void test_pulse(void **state) {
    static const double offs[] = {0.21, 0.2};
    static const char *const devices[] = {"reference", "reference-f32"};
    (void)state;
    int failures = 0;
    for (int i = 0; i < 16; i++) {
        const double off = offs[i / 2 % 2];
        judged j = pulse(i / 4 % 2, 0.2, off);
        if (i >= 8) judged_look_up(&j);
        judged_stream one = pulse_events(&j), exact = in_every_pixel(&j, &one);
        judged_verdict v = judged_against(&j, devices[i % 2], JUDGED_LIMIT_S, &exact);
        const uint64_t pixels = (uint64_t)j.intrinsics.width * (uint64_t)j.intrinsics.height;
        judged_print(&j, devices[i % 2], &v);
        assert_int_equal(one.count, 17);
        const int complete = v.match.missing == 0 && v.match.spurious <= (off == 0.2 ? pixels : 0);
        failures += !complete || !judged_honest(&v);
        free(one.events);
        free(exact.events);
        judged_free(&j);
    }
    assert_int_equal(failures, 0);
}

/* The exact events of frames are those of the formula. */
static void test_exact_events(void **state) {
    (void)state;
    judged j = pulse(1, 0.2, 0.21);
    judged_stream one = pulse_events(&j), formula = in_every_pixel(&j, &one), fine = {0}, coarse = {0};
    tides_match match;
    tides_error error;
    judged_exact(&j, 2000, &fine, &coarse);
    scene_expect_ok(tides_match_events(formula.events, formula.count, fine.events, fine.count, 1e-3, &match, &error), &error);
    assert_true(match.missing == 0 && match.spurious == 0 && match.dt_max_us <= 1e-3);
    scene_expect_ok(tides_match_events(formula.events, formula.count, coarse.events, coarse.count, 1e-3, &match, &error),
                    &error);
    assert_true(match.missing == 0 && match.spurious == 0 && match.dt_max_us <= 1e-3);
    free(one.events);
    free(formula.events);
    free(fine.events);
    free(coarse.events);
    judged_free(&j);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_exact_events),
                                       cmocka_unit_test(test_pulse),
                                       cmocka_unit_test(test_lamp_100),
                                       cmocka_unit_test(test_lamp_1k),
                                       cmocka_unit_test(test_lamp_1k_coarse),
                                       cmocka_unit_test(test_vibrating_object),
                                       cmocka_unit_test(test_vibrating_100),
                                       cmocka_unit_test(test_vibrating_200),
                                       cmocka_unit_test(test_shaken_camera),
                                       cmocka_unit_test(test_rolling_camera),
                                       cmocka_unit_test(test_spinning),
                                       cmocka_unit_test(test_turning_keyframes),
                                       cmocka_unit_test(test_breathing_keyframes),
                                       cmocka_unit_test(test_fading_keyframes),
                                       cmocka_unit_test(test_fading_function),
                                       cmocka_unit_test(test_shaking_function),
                                       cmocka_unit_test(test_through_the_camera),
                                       cmocka_unit_test(test_dart),
                                       cmocka_unit_test(test_bells),
                                       cmocka_unit_test(test_rotor_bells),
                                       cmocka_unit_test(test_all_together)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
