/* The error estimate of a tile's step against closed forms, and the pixels that count in it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/td_estimate.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <string.h>

static const uint64_t SEED = 31415;

static const double H = 0.01, C = 0.2; /* [s], [log units] */
static const double BULGE = 4.0 / 27.0;

/* Ideal pixels. */
static td_sensor sensor_of(double on, double off) {
    td_sensor sensor = {.model = TIDES_MODEL_HERMITE};
    sensor.sensor.threshold_on = on;
    sensor.sensor.threshold_off = off;
    return sensor;
}

/* One pixel: signals at both ends of [0, h], and the reference. */
typedef struct pixel {
    double S0, S0_dot, S1, S1_dot, reference;
} pixel;

static td_estimate estimate_of(td_sensor *sensor, double h, const pixel *p) {
    td_signals signals = {&p->S0, &p->S0_dot, &p->S1, &p->S1_dot};
    const td_estimated step = {h, &signals, &p->reference, NULL, 0, 1};
    return td_sensor_estimate(sensor, &step, 0, 0, 0);
}

static void expect_near(double got, double want, double size, const char *what) {
    if (!(fabs(got - want) <= 1e-12 * size)) fail_msg("%s: %.17g, not %.17g", what, got, want);
}

/* S(t) = a + b t + c t^2 + d t^3 on [0, h]; the reference is the signal's beginning, a level: every pixel counts. */
static pixel cubic(double h, double a, double b, double c, double d) {
    pixel p = {a, b, a + h * (b + h * (c + h * d)), b + h * (2 * c + 3 * h * d), a};
    return p;
}

/* -- closed forms -------------------------------------------------------------------------------------------------- */

/* Of a cubic, rate1 + rate0 - 2 rise is d h^3, so the estimate is 4/27 |d| h^3; and that is the greatest distance between the
 * cubic and the quadratic through S0, S0_dot and S1, found here by looking. */
static void test_cubic_signals(void **state) {
    (void)state;
    td_sensor sensor = sensor_of(C, C);
    uint64_t seed = SEED;
    for (int trial = 0; trial < 200; trial++) {
        double h = scene_between(&seed, 1e-4, 0.1), b = scene_between(&seed, -1, 1) / h,
               c = scene_between(&seed, -1, 1) / (h * h);
        double d = scene_between(&seed, -1, 1) / (h * h * h), a = scene_between(&seed, -5, 5);
        pixel p = cubic(h, a, b, c, d);
        td_estimate estimate = estimate_of(&sensor, h, &p);
        double error = BULGE * fabs(d) * h * h * h, moved = fmax(fabs(p.S1 - p.S0), error), most = 0;
        expect_near(estimate.error, error, 10, "error");
        expect_near(estimate.error, BULGE * fabs(h * p.S1_dot + h * p.S0_dot - 2 * (p.S1 - p.S0)), 1, "error as DESIGN has it");
        expect_near(estimate.seconds, fmax(error - 1e-6, 0) * h / moved, 100 * h, "seconds");
        for (int i = 0; i <= 3000; i++) {
            double s = i / 3000.0, t = s * h, rise = p.S1 - p.S0;
            double quadratic = a + b * t + (rise - b * h) * s * s;
            most = fmax(most, fabs(a + t * (b + t * (c + t * d)) - quadratic));
        }
        assert_true(fabs(most - estimate.error) < 1e-6); /* 2/3 is among the places looked at */
    }
}

static void test_quadratic_signals_have_no_error(void **state) {
    (void)state;
    td_sensor sensor = sensor_of(C, C);
    uint64_t seed = SEED + 1;
    for (int trial = 0; trial < 100; trial++) {
        pixel p = cubic(H, scene_between(&seed, -1, 1), scene_between(&seed, -99, 99), scene_between(&seed, -1e4, 1e4), 0);
        expect_near(estimate_of(&sensor, H, &p).error, 0, 1, "error");
    }
    pixel still = {0.3, 0, 0.3, 0, 0.3};
    td_estimate estimate = estimate_of(&sensor, H, &still);
    assert_true(estimate.error == 0 && estimate.seconds == 0);
}

/* The estimate bounds the error of the cubic where halving helps: S = A sin(w t + phase) with w h small. */
static void test_bounds_the_models_error(void **state) {
    (void)state;
    td_sensor sensor = sensor_of(C, C);
    uint64_t seed = SEED + 2;
    for (int trial = 0; trial < 200; trial++) {
        double w = scene_between(&seed, 0.05, 0.3) / H,
               phase = scene_between(&seed, -1.2, 1.2); /* away from where the third rate is 0 */
        pixel p = {sin(phase), w * cos(phase), sin(w * H + phase), w * cos(w * H + phase), sin(phase)};
        double worst = 0, rise = p.S1 - p.S0, r0 = H * p.S0_dot, r1 = H * p.S1_dot;
        for (int i = 0; i <= 100; i++) {
            double s = i / 100.0, model = p.S0 + s * (r0 + s * (3 * rise - 2 * r0 - r1 + s * (r0 + r1 - 2 * rise)));
            worst = fmax(worst, fabs(model - sin(w * s * H + phase)));
        }
        assert_true(worst <= estimate_of(&sensor, H, &p).error);
    }
}

/* -- which pixels count -------------------------------------------------------------------------------------------- */

/* A pixel that bends by `bend` (estimate BULGE * bend) around a signal of 0, its hull (Bezier values) within +- bend / 3. */
static pixel bending(double bend, double reference) {
    pixel p = {0, bend / H, 0, bend / H, reference};
    p.S0_dot = p.S1_dot = 0.5 * bend / H; /* rate0 + rate1 = bend, rise 0: Bezier values 0, bend/6, -bend/6, 0 */
    return p;
}

static void test_only_pixels_near_a_level_count(void **state) {
    (void)state;
    td_sensor equal = sensor_of(C, C), unequal = sensor_of(C, 1.3 * C);
    const double bend = 0.06, error = BULGE * bend, reach = bend / 6 + error; /* 0.0189 */
    static const int levels[] = {-3, -1, 0, 1, 2, 40};
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        double level = levels[i] * C; /* the reference is so far below: a level is at 0 */
        for (int side = -1; side <= 1; side += 2) {
            pixel touches = bending(bend, -level + side * 0.999 * reach), misses = bending(bend, -level + side * 1.001 * reach);
            expect_near(estimate_of(&equal, H, &touches).error, error, 1, "hull on a level");
            assert_true(estimate_of(&equal, H, &misses).error == 0);
            assert_true(estimate_of(&equal, H, &misses).seconds == 0);
            expect_near(estimate_of(&unequal, H, &misses).error, error, 1, "unequal thresholds");
        }
    }
    pixel middle = bending(bend, 0.5 * C);
    assert_true(estimate_of(&equal, H, &middle).error == 0);
    expect_near(estimate_of(&unequal, H, &middle).error, error, 1, "unequal thresholds, half-way");
}

/* Of many pixels the worst counts, whatever their order; NaN is passed over. */
static void test_worst_of_many(void **state) {
    (void)state;
    enum { COUNT = 64 };
    td_sensor sensor = sensor_of(C, C);
    double S0[COUNT], S0_dot[COUNT], S1[COUNT], S1_dot[COUNT], reference[COUNT];
    td_signals signals = {S0, S0_dot, S1, S1_dot};
    uint64_t seed = SEED + 3;
    for (int trial = 0; trial < 100; trial++) {
        td_estimate worst = {0, 0, 0, 0, 0};
        for (int i = 0; i < COUNT; i++) {
            pixel p = {scene_between(&seed, -0.1, 0.1), scene_between(&seed, -3, 3), scene_between(&seed, -0.1, 0.1),
                       scene_between(&seed, -3, 3), scene_between(&seed, -1, 1)};
            if (i % 7 == 3) p.S0 = NAN;
            if (i % 7 == 4) p.S1_dot = NAN;
            S0[i] = p.S0, S0_dot[i] = p.S0_dot, S1[i] = p.S1, S1_dot[i] = p.S1_dot, reference[i] = p.reference;
            td_estimate one = estimate_of(&sensor, H, &p);
            assert_true(i % 7 != 3 && i % 7 != 4 ? !isnan(one.error) : one.error == 0 && one.seconds == 0);
            worst.error = fmax(worst.error, one.error);
            worst.seconds = fmax(worst.seconds, one.seconds);
            worst.crossings = fmax(worst.crossings, one.crossings);
        }
        td_estimated step = {H, &signals, reference, NULL, 0, COUNT};
        td_estimate all = td_sensor_estimate(&sensor, &step, 0, 0, 0);
        assert_true(all.error == worst.error && all.seconds == worst.seconds && all.error > 0);
        assert_true(all.crossings == worst.crossings);
    }
    const td_estimated empty = {H, &signals, reference, NULL, 0, 0};
    td_estimate none = td_sensor_estimate(&sensor, &empty, 0, 0, 0);
    assert_true(none.error == 0 && none.seconds == 0);
}

/* Events of the model, counted by looking at many places between which it passes no level twice. */
static int events_of(const pixel *p, double on, double off) {
    const td_model model = td_model_fit(TIDES_MODEL_HERMITE, H, p->S0, p->S0_dot, p->S1, p->S1_dot);
    double reference = p->reference;
    int events = 0;
    for (int i = 0; i <= 2000; i++) {
        const double S = td_model_value(&model, i / 2000.0);
        for (; S - reference >= on; events++) reference += on;
        for (; S - reference <= -off; events++) reference -= off;
    }
    return events;
}

/* Never fewer than there are, and of a signal that only rises hardly more. */
static void test_crossings(void **state) {
    (void)state;
    uint64_t seed = SEED + 4;
    for (int trial = 0; trial < 400; trial++) {
        const double on = scene_between(&seed, 0.02, 0.3), off = trial % 2 ? on : scene_between(&seed, 0.02, 0.3);
        const pixel any = {scene_between(&seed, -0.02, 0.02), scene_between(&seed, -900, 900), scene_between(&seed, -3, 3),
                           scene_between(&seed, -900, 900), 0};
        const pixel rises = {any.S0, 300, any.S0 + 3, 300, 0};
        td_sensor sensor = sensor_of(on, off);
        const double most = estimate_of(&sensor, H, &any).crossings, all = estimate_of(&sensor, H, &rises).crossings;
        const int found = events_of(&any, on, off), of_rise = events_of(&rises, on, off);
        if (found > ceil(most)) fail_msg("trial %d: %d events, where %g were the most", trial, found, most);
        expect_near(all, 3 / fmin(on, off), 100, "crossings of a line");
        assert_true(of_rise <= ceil(all));
        assert_true(off < on || of_rise >= floor(all) - 1);
    }
}

/* Behind a filter every pixel counts, in what its own threshold is worth, with its own leak: here each by the formula, NaN
 * among them, with a probe's deviations and without. */
static void test_behind_a_filter(void **state) {
    (void)state;
    enum { COUNT = 203, FIRST = 5 };
    static double S0[COUNT], S0_dot[COUNT], S1[COUNT], S1_dot[COUNT], deviation[COUNT];
    static double on[FIRST + COUNT], off[FIRST + COUNT], leak[FIRST + COUNT];
    const double rounding = 2e-6, time = 3e7;
    td_sensor sensor = sensor_of(0.3, C);
    uint64_t seed = SEED + 5;
    sensor.on = sensor.frontend.on = 1;
    sensor.threshold_on = on;
    sensor.threshold_off = off;
    sensor.leak = leak;
    for (int trial = 0; trial < 60; trial++) {
        const int probed = trial % 2;
        td_estimate worst = {0, 0, 0, 0, 0};
        for (int i = 0; i < COUNT; i++) {
            const double size = pow(10, scene_between(&seed, -7, 0));
            S0[i] = scene_between(&seed, -5, 0);
            S1[i] = S0[i] + scene_between(&seed, -size, size);
            S0_dot[i] = scene_between(&seed, -size, size) / H;
            S1_dot[i] = !probed && i % 41 == 3 ? NAN : scene_between(&seed, -size, size) / H;
            deviation[i] = i % 11 == 4 ? 1e-6 : scene_between(&seed, 0, size);
            on[FIRST + i] = scene_between(&seed, 0.2, 0.4);
            off[FIRST + i] = scene_between(&seed, 0.1, 0.3);
            leak[FIRST + i] = i % 3 ? scene_between(&seed, 0, 1e-9) : 0;
            if (isnan(S1_dot[i])) continue;
            const double first = H * S0_dot[i], last = H * S1_dot[i], rise = S1[i] - S0[i], ramp = leak[FIRST + i] * H * 1e9;
            const double embedded = BULGE * fabs(last + first - 2 * rise), bump = probed ? deviation[i] : embedded;
            const double error = probed ? fmin(fmax(0.7 * embedded, 0.25 * bump), bump) : embedded;
            const double own = fmin(on[FIRST + i], off[FIRST + i]), moved = fmax(fabs(rise + ramp), error);
            const double way = fabs(first / 3) + fabs(rise - (first + last) / 3) + fabs(last / 3) + ramp;
            worst.crossings = fmax(worst.crossings, way / own);
            worst.rounded = fmax(worst.rounded, error * C / own);
            if (probed && bump <= rounding) continue;
            worst.error = fmax(worst.error, error * C / own);
            worst.seconds = fmax(worst.seconds, fmax(error - 1e-6, 0) * H / moved);
            if (probed) worst.deviation = fmax(worst.deviation, bump * C / own);
        }
        const td_signals signals = {S0, S0_dot, S1, S1_dot};
        const td_estimated step = {H, &signals, trial % 3 ? S0 : NULL, probed ? deviation : NULL, rounding, COUNT};
        const td_estimate all = td_sensor_estimate(&sensor, &step, FIRST, 0, time);
        expect_near(all.error, worst.error, 1, "error");
        expect_near(all.seconds, worst.seconds, 1, "seconds");
        expect_near(all.deviation, worst.deviation, 1, "deviation");
        expect_near(all.rounded, worst.rounded, 1, "error without rounding");
        expect_near(all.crossings, worst.crossings, 100, "crossings");
    }
}

/* Pixels with noise, many side by side: the worst of them is the worst of each by itself, to the bit, on early cuts and on late
 * ones. A pixel far from its levels doesn't count. */
static void test_noisy_pixels(void **state) {
    (void)state;
    enum { COUNT = 203, FIRST = 5 };
    static double S0[COUNT], S0_dot[COUNT], S1[COUNT], S1_dot[COUNT], deviation[COUNT], reference[COUNT];
    static double on[FIRST + COUNT], off[FIRST + COUNT], leak[FIRST + COUNT], held[FIRST + COUNT];
    static uint8_t reach[FIRST + COUNT];
    td_sensor sensor = sensor_of(C, C);
    uint64_t seed = SEED + 6;
    sensor.on = sensor.additive.on = 1;
    sensor.additive.sigma = 0.005;
    sensor.threshold_on = on;
    sensor.threshold_off = off;
    sensor.leak = leak;
    sensor.held_until = held;
    sensor.reach = reach;
    int left_out = 0;
    for (int trial = 0; trial < 60; trial++) {
        const int probed = trial % 2, cuts = trial % 3 ? TD_FEW_CUTS + 1 : 0;
        for (int i = 0; i < COUNT; i++) {
            const double size = pow(10, scene_between(&seed, -7, -1.5));
            S0[i] = scene_between(&seed, -5, 0);
            S1[i] = S0[i] + scene_between(&seed, -size, size);
            S0_dot[i] = scene_between(&seed, -size, size) / H;
            S1_dot[i] = i % 41 == 3 ? NAN : scene_between(&seed, -size, size) / H;
            reference[i] = S0[i] + scene_between(&seed, -C, C);
            deviation[i] = i % 11 == 4 ? 1e-6 : scene_between(&seed, 0, size);
            on[FIRST + i] = scene_between(&seed, 0.2, 0.4);
            off[FIRST + i] = trial % 4 < 2 ? on[FIRST + i] : scene_between(&seed, 0.1, 0.3);
            leak[FIRST + i] = i % 3 ? scene_between(&seed, 0, 1e-10) : 0;
            held[FIRST + i] = i % 17 == 5 ? 1 : -INFINITY;
        }
        const td_signals signals = {S0, S0_dot, S1, S1_dot};
        const td_estimated step = {H, &signals, reference, probed ? deviation : NULL, 2e-6, COUNT};
        td_sensor_begin_estimates(&sensor, FIRST, COUNT);
        const td_estimate all = td_sensor_estimate(&sensor, &step, FIRST, cuts, 3e7);
        td_estimate worst = {0, 0, 0, 0, 0};
        td_sensor_begin_estimates(&sensor, FIRST, COUNT);
        for (int i = 0; i < COUNT; i++) {
            const td_signals own = {S0 + i, S0_dot + i, S1 + i, S1_dot + i};
            const td_estimated single = {H, &own, reference + i, probed ? deviation + i : NULL, 2e-6, 1};
            const td_estimate one = td_sensor_estimate(&sensor, &single, FIRST + (size_t)i, cuts, 3e7);
            left_out += one.rounded == 0;
            worst.error = fmax(worst.error, one.error);
            worst.seconds = fmax(worst.seconds, one.seconds);
            worst.deviation = fmax(worst.deviation, one.deviation);
            worst.rounded = fmax(worst.rounded, one.rounded);
            worst.crossings = fmax(worst.crossings, one.crossings);
        }
        assert_true(all.error > 0 && all.seconds > 0 && all.crossings > 0);
        assert_memory_equal(&all, &worst, sizeof all);
    }
    assert_true(left_out > 60 * COUNT / 2 && left_out < 60 * COUNT * 9 / 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cubic_signals),
                                       cmocka_unit_test(test_quadratic_signals_have_no_error),
                                       cmocka_unit_test(test_bounds_the_models_error),
                                       cmocka_unit_test(test_only_pixels_near_a_level_count),
                                       cmocka_unit_test(test_worst_of_many),
                                       cmocka_unit_test(test_crossings),
                                       cmocka_unit_test(test_behind_a_filter),
                                       cmocka_unit_test(test_noisy_pixels)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
