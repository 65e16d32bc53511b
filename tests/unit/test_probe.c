/* Probes: where steps are cut, a cubic's deviation there against closed forms, and how well the deviation bounds the parts'
 * errors, wherever a kink is. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "signal/td_crossing.h"
#include "signal/td_model_error.h"
#include "solver/td_probe.h"
#include "tests/support/scene_make.h"

#include <math.h>

static const uint64_t SEED = 27182;

/* -- places ---------------------------------------------------------------------------------------------------------- */

static void test_places(void **state) {
    (void)state;
    uint64_t seed = SEED;
    int before = 0, distinct = 0;
    for (int trial = 0; trial < 1000; trial++) {
        uint32_t from = (uint32_t)(scene_next(&seed) >> 40), length = 64 + (uint32_t)(scene_next(&seed) >> 44);
        uint64_t macro = (uint64_t)trial;
        uint32_t at = td_probe_place(macro, from, from + length), other = td_probe_place(macro + 1, from, from + length);
        double theta = (double)(at - from) / length, away = fabs(theta - 0.5), unit = 0.5 / length;
        if (!(away > 0.01 - unit && away < 0.02 + unit)) fail_msg("%g of the step", theta);
        assert_true(at == td_probe_place(macro, from, from + length));
        before += theta < 0.5;
        distinct += length > 1000 && at != other;
    }
    assert_true(before > 400 && before < 600 && distinct > 800);
    for (uint32_t length = 2; length < 64; length++) { /* always inside */
        uint32_t at = td_probe_place(7, 100, 100 + length);
        assert_true(at > 100 && at < 100 + length);
    }
}

/* -- deviations ------------------------------------------------------------------------------------------------------ */

/* Ends and inside of a signal on [0, h]. */
typedef struct looked {
    double S0, S0_dot, S1, S1_dot, S, S_dot;
} looked;

static double deviation_of(double h, double theta, const looked *l) {
    const td_signals ends = {&l->S0, &l->S0_dot, &l->S1, &l->S1_dot};
    double deviation;
    td_probe_deviation(h, theta, &ends, &l->S, &l->S_dot, 1, &deviation);
    return deviation;
}

/* Of a cubic nothing; of m t^4 / 24, m h^4 theta^2 (1 - theta)^2 / 24 in value, and half the derivative of that in rate. */
static void test_polynomials(void **state) {
    (void)state;
    uint64_t seed = SEED + 1;
    for (int trial = 0; trial < 200; trial++) {
        double h = scene_between(&seed, 1e-4, 0.1), theta = scene_between(&seed, 0.4, 0.6), t = theta * h, rest = 1 - theta;
        double a = scene_between(&seed, -1, 1), b = scene_between(&seed, -1, 1) / h, c = scene_between(&seed, -1, 1) / (h * h),
               d = scene_between(&seed, -1, 1) / (h * h * h);
        double m = trial % 2 ? scene_between(&seed, -9, 9) / (h * h * h * h) : 0;
        looked l = {a, b, 0, 0, 0, 0};
        l.S1 = a + h * (b + h * (c + h * (d + h * m / 24)));
        l.S1_dot = b + h * (2 * c + h * (3 * d + h * m / 6));
        l.S = a + t * (b + t * (c + t * (d + t * m / 24)));
        l.S_dot = b + t * (2 * c + t * (3 * d + t * m / 6));
        double m4 = fabs(m) * h * h * h * h / 24;
        double want = m4 * theta * theta * rest * rest + 0.5 * m4 * 2 * theta * rest * fabs(1 - 2 * theta);
        if (!(fabs(deviation_of(h, theta, &l) - want) < 1e-12)) fail_msg("%g, not %g", deviation_of(h, theta, &l), want);
    }
    looked nothing = {0, 0, (double)NAN, 0, 0, 0};
    assert_true(isnan(deviation_of(1, 0.5, &nothing)));
}

/* Even about the middle with both ends alike, at rest or not: the ends say nothing, the probe does; and of whatever returns
 * within the step, its rate where its value doesn't. */
static void test_sees_what_ends_hide(void **state) {
    const double PI = 3.14159265358979323846;
    (void)state;
    for (int periods = 1; periods <= 40; periods++)
        for (int side = -1; side <= 1; side += 2) {
            double w = 2 * PI * periods, theta = 0.5 + side * 0.013;
            looked rests = {1, 0, 1, 0, cos(w * theta), -w * sin(w * theta)};
            looked turns = {0, w, 0, w, sin(w * theta), w * cos(w * theta)};
            assert_true(deviation_of(1, theta, &rests) > 0.3 && deviation_of(1, theta, &turns) > 0.3);
        }
}

/* The largest distance between the cubic of [from, to] and the signal that is 0 until `kink` and then rises by 1 a second. */
static double error_between(double from, double to, double kink) {
    double h = to - from, most = 0;
    td_model model = td_model_fit(TIDES_MODEL_HERMITE, h, fmax(from - kink, 0), from > kink, fmax(to - kink, 0), to > kink);
    for (int i = 0; i <= 200; i++) {
        double s = i / 200.0;
        most = fmax(most, fabs(td_model_value(&model, s) - fmax(from + s * h - kink, 0)));
    }
    return most;
}

static void test_bounds_the_parts_of_a_kink(void **state) {
    (void)state;
    double worst = 0;
    for (int i = 1; i < 400; i++)
        for (int side = -1; side <= 1; side += 2) {
            double kink = i / 400.0, theta = 0.5 + side * 0.015;
            looked l = {0, 0, 1 - kink, 1, fmax(theta - kink, 0), theta > kink};
            double deviation = deviation_of(1, theta, &l);
            double error = fmax(error_between(0, theta, kink), error_between(theta, 1, kink));
            worst = fmax(worst, error / deviation);
        }
    if (!(worst < 1.42 && worst > 0.5)) fail_msg("%g of the deviation", worst);
}

/* What control takes for the error lies between its bounds, and follows the embedded estimate there. */
static void test_error(void **state) {
    (void)state;
    assert_true(td_probe_error(0, 1) == TD_PROBE_LEAST && td_probe_error(1e9, 1) == TD_PROBE_MOST);
    assert_true(td_probe_error(1, 1) == TD_PROBE_EMBEDDED && td_probe_error(1, 0) == 0);
}

/* -- what is left in the parts ------------------------------------------------------------------------------------------- */

/* A signal that is 0 until `kink` and then rises as the power of time, looked at twice: [-1, 1] or [0, 2] is cut near its
 * middle, and of the part [0, 1] what the cubic of its own part is off by at a place that is drawn. */
typedef struct twice {
    double before, deviation, s, error;
} twice;

static double risen(double t, double kink, int power) { return t > kink ? pow(t - kink, power) : 0; }
static double rises(double t, double kink, int power) { return t > kink ? power * pow(t - kink, power - 1) : 0; }

static double looked_at(double from, double to, double theta, double kink, int power) {
    double h = to - from, at = from + theta * h;
    looked l = {risen(from, kink, power), rises(from, kink, power), risen(to, kink, power),
                rises(to, kink, power),   risen(at, kink, power),   rises(at, kink, power)};
    return deviation_of(h, theta, &l);
}

static twice look_twice(uint64_t *seed, double kink, int power) {
    int left = scene_between(seed, 0, 1) < 0.5;
    double theta = 0.5 + (scene_between(seed, 0, 1) < 0.5 ? -1 : 1) * scene_between(seed, 0.01, 0.02);
    double from = kink < theta ? 0 : theta, to = kink < theta ? theta : 1, h = to - from, s = scene_between(seed, 0, 1);
    td_model part = td_model_fit(TIDES_MODEL_HERMITE, h, risen(from, kink, power), rises(from, kink, power),
                                 risen(to, kink, power), rises(to, kink, power));
    return (twice){looked_at(left ? 0 : -1, left ? 2 : 1, 0.5, kink, power), looked_at(0, 1, theta, kink, power), s,
                   fabs(td_model_value(&part, s) - risen(from + s * h, kink, power))};
}

/* The law holds for a kink of the slope at a place that is drawn: errors of the part that it is in are above what the law says
 * of the median and of a quarter no more often than that. And what is smooth has a sixteenth of the deviation left. */
static void test_left(void **state) {
    (void)state;
    enum { KINKS = 4000 };
    uint64_t seed = SEED + 3;
    int is_kink = 0, above[2] = {0, 0};
    for (int i = 0; i < KINKS; i++) {
        twice t = look_twice(&seed, scene_between(&seed, 0, 1), 1);
        const uint8_t fall = td_probe_fall(t.deviation, t.before);
        td_probe_law law = td_probe_left(fall);
        double bow = t.deviation * 4 * t.s * (1 - t.s);
        is_kink += fall >= TD_PROBE_KINK_LEAST;
        above[0] += t.error > law.share[0] * bow;
        above[1] += t.error > law.share[1] * bow;
    }
    print_message("kinks of the slope: %.3g told by their fall, above the first share %.3g, the second %.3g\n",
                  is_kink / (double)KINKS, above[0] / (double)KINKS, above[1] / (double)KINKS);
    assert_true(is_kink > KINKS / 2);
    assert_true(above[0] < 0.5 * KINKS && above[1] < 0.25 * KINKS);
    twice smooth = look_twice(&seed, -3, 4); /* a quartic */
    td_probe_law law = td_probe_left(td_probe_fall(smooth.deviation, smooth.before));
    assert_true(law.is_smooth && law.share[0] >= 1.0 / 16 && law.share[0] < 2.0 / 16);
}

/* Whatever the fall, shares ascend and weights sum to 1, to the bit; smooth ones promise least. */
static void test_laws(void **state) {
    (void)state;
    for (int fall = 0; fall <= UINT8_MAX; fall++) {
        td_probe_law law = td_probe_left((uint8_t)fall);
        assert_true(law.weight[0] + law.weight[1] + law.weight[2] == 1);
        assert_true(0 < law.share[0] && law.share[0] <= law.share[1] && law.share[1] <= law.share[2] && law.share[2] <= 1);
        assert_int_equal(law.is_smooth, fall >= TD_PROBE_SMOOTH_LEAST && fall <= TD_PROBE_SMOOTH_MOST);
    }
    assert_int_equal(td_probe_fall(1, 16), 16);
    assert_int_equal(td_probe_fall(1, 1e9), 1);
    assert_int_equal(td_probe_fall(1, 1), TD_PROBE_FALLS);
    assert_int_equal(td_probe_fall(1, 0), TD_PROBE_FALLS);
    assert_int_equal(td_probe_fall((double)NAN, 1), TD_PROBE_FALLS);
    assert_int_equal(td_probe_fall(1, (double)NAN), TD_PROBE_FALLS);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_places),
                                       cmocka_unit_test(test_polynomials),
                                       cmocka_unit_test(test_sees_what_ends_hide),
                                       cmocka_unit_test(test_bounds_the_parts_of_a_kink),
                                       cmocka_unit_test(test_error),
                                       cmocka_unit_test(test_left),
                                       cmocka_unit_test(test_laws)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
