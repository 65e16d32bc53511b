/* The low-pass whose rate goes with the light, over whole steps of many pixels, against the careful walk with a thousandth of
 * the tolerance, for inputs like images' and for the worst inputs known. */
#include "tests/support/seeded.h"
#include "sensor/response/td_frontend.h"
#include "td_base.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define LOG_EPS 0.01

enum { PIXELS = 203 }; /* blocks, and some left over */

static void seed(uint64_t salt) { seed_from(20261129, salt); }

static tides_sensor sensor_of(double cutoff_hz) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.photoreceptor_cutoff_hz = cutoff_hz;
    sensor.photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
    return sensor;
}

static td_frontend make(const tides_sensor *sensor, double tolerance) {
    td_frontend frontend;
    tides_error error;
    if (td_frontend_make(sensor, &frontend, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (tolerance > 0) frontend.tolerance = tolerance;
    return frontend;
}

typedef struct batch {
    double control[4][PIXELS], S[PIXELS], after[PIXELS], low[PIXELS], high[PIXELS];
} batch;

static void step_many(const td_frontend *frontend, double h, size_t count, batch *b) {
    const td_filter_block pixels = {count,  {b->control[0], b->control[1], b->control[2], b->control[3]},
                                    {b->S}, {b->after},
                                    b->low, b->high};
    td_light_whole(frontend, h, LOG_EPS, &pixels);
}

static td_model model_of(const batch *b, int i) {
    return (td_model){{b->control[0][i], b->control[1][i], b->control[2][i], b->control[3][i]}};
}

/* Pixel i, by the walk. */
static double walk(const td_frontend *frontend, double h, const batch *b, int i, td_response *response) {
    double state[TD_FRONTEND_STATE] = {b->S[i], b->S[i], 0, b->S[i]};
    const td_model input = model_of(b, i);
    td_frontend_step(frontend, h, &input, LOG_EPS, state, response, NULL);
    return state[0];
}

/* What the walk itself may be off by, for the tolerance it is given and in rounding. */
static const double truth = 5e-13, truth_off = 1e-11;

/* Where an answer is given it is within the tolerance, and bounds hold what is sampled; returns how many there were. */
static int check(const td_frontend *exact, double h, const batch *b) {
    int answers = 0;
    for (int i = 0; i < PIXELS; i++) {
        assert_int_equal(isnan(b->low[i]), isnan(b->high[i]));
        if (isnan(b->low[i])) continue;
        td_response response;
        const double S = walk(exact, h, b, i, &response);
        answers++;
        if (!(fabs(S - b->after[i]) <= 0.1 * TD_FRONTEND_TOLERANCE + truth_off))
            fail_msg("%.17g, not %.17g: off by %g; h %g, S %.17g, L %.17g %.17g %.17g %.17g", b->after[i], S, b->after[i] - S,
                     h, b->S[i], b->control[0][i], b->control[1][i], b->control[2][i], b->control[3][i]);
        for (int k = 0; k <= 16; k++) {
            const double value = td_response_value(&response, k / 16.0);
            if (!(value > b->low[i] && value < b->high[i]))
                fail_msg("%.17g at %g isn't within %.17g and %.17g; h %g, S %.17g, L %.17g %.17g %.17g %.17g", value, k / 16.0,
                         b->low[i], b->high[i], h, b->S[i], b->control[0][i], b->control[1][i], b->control[2][i],
                         b->control[3][i]);
        }
    }
    return answers;
}

/* From still to a log unit in a step, bent as what moves past is, rates from 1e-6 to 10 per step; most of what
 * images make has an answer. */
static void is_the_walk(void **state) {
    (void)state;
    seed(0);
    static batch b;
    int answers = 0, asked = 0;
    for (int trial = 0; trial < 60; trial++) {
        const tides_sensor sensor = sensor_of(any_power(1, 3000));
        const double h = any_power(1e-6, 10) / (6.2831853 * sensor.photoreceptor_cutoff_hz);
        const td_frontend frontend = make(&sensor, 0), exact = make(&sensor, truth);
        for (int i = 0; i < PIXELS; i++) {
            const double L = uniform(-4.5, 0.3), size = any_power(1e-5, trial % 2 ? 1 : 0.1);
            b.control[0][i] = L;
            const double slope = uniform(-size, size), bend = size * uniform(-size, size), turn = size * bend;
            for (int k = 1; k < 4; k++) b.control[k][i] = fmax(L + k * slope + k * k * bend + (k == 2 ? turn : 0), -4.6);
            b.S[i] = L + (i % 3 ? uniform(-0.5, 0.5) : uniform(-size, size));
        }
        step_many(&frontend, h, PIXELS, &b);
        const int answered = check(&exact, h, &b);
        answers += trial % 2 ? 0 : answered;
        asked += trial % 2 ? 0 : PIXELS;
    }
    print_message("%d of %d have an answer\n", answers, asked);
    assert_true(answers > 0.9 * asked);
}

/* Light that steps at the step's end or begin, goes from dark to bright and back, turns, is at the black level or below it. */
static void of_the_worst(void **state) {
    (void)state;
    seed(1);
    static batch b;
    const double dark = log(LOG_EPS);
    const double shape[][4] = {{0, 0, 0, 1},  {0, 1, 1, 1},  {0, 0, 1, 1}, {0, 1, 0, 1},      {1, 0, 1, 0},
                               {0, 1, -1, 0}, {0, 3, -3, 0}, {0, 0, 0, 0}, {0, 1e-300, 0, 0}, {1, 0, 0, 0}};
    enum { SHAPES = sizeof shape / sizeof *shape };
    int answers = 0;
    for (int trial = 0; trial < 200; trial++) {
        const tides_sensor sensor = sensor_of(300);
        const double h = any_power(1e-12, trial % 4 ? 1e-2 : 1e6);
        const td_frontend frontend = make(&sensor, 0), exact = make(&sensor, truth);
        for (int i = 0; i < PIXELS; i++) {
            const double *form = shape[i % SHAPES], size = any_power(1e-6, 6), L = i % 7 ? uniform(dark, 0) : dark;
            for (int k = 0; k < 4; k++) b.control[k][i] = L + size * form[k];
            b.S[i] = i % 5 == 1 ? L : i % 5 == 2 ? dark - 3 : uniform(dark, 0.5);
        }
        step_many(&frontend, h, PIXELS, &b);
        answers += check(&exact, h, &b);
    }
    assert_true(answers > 0.3 * 200 * PIXELS);
}

/* Numbers that are none, below the black level, and beyond all light: no answer, never a wrong one. */
static void has_no_answer(void **state) {
    (void)state;
    static batch b;
    const tides_sensor sensor = sensor_of(300);
    const td_frontend frontend = make(&sensor, 0);
    const double odd[] = {NAN, INFINITY, -INFINITY, -5, 80, 1e300};
    for (size_t o = 0; o < sizeof odd / sizeof *odd; o++)
        for (int where = 0; where < 5; where++) {
            for (int i = 0; i < PIXELS; i++) {
                for (int k = 0; k < 4; k++) b.control[k][i] = k == where ? odd[o] : -1;
                b.S[i] = where == 4 ? odd[o] : -1;
            }
            step_many(&frontend, 1e-3, PIXELS, &b);
            const int fine = where == 4 && isfinite(odd[o]); /* a state may be anywhere */
            for (int i = 0; i < PIXELS; i++) assert_int_equal(!isnan(b.low[i]) && !isnan(b.high[i]), fine);
        }
}

/* However many steps there are, and however short they are, S isn't further off than the tolerance: a sum would be, here, by
 * hundreds of times. */
static void steps_do_not_add_up(void **state) {
    (void)state;
    seed(2);
    static batch b;
    enum { STEPS = 3000 };
    for (int trial = 0; trial < 4; trial++) {
        const tides_sensor sensor = sensor_of(300);
        const double h = (double[]){1e-7, 1e-6, 1e-5, 1e-4}[trial];
        const td_frontend frontend = make(&sensor, 0), exact = make(&sensor, truth);
        double S[PIXELS], phase[PIXELS], rate[PIXELS];
        int given = 0;
        for (int i = 0; i < PIXELS; i++) {
            S[i] = b.S[i] = uniform(-4, 0);
            phase[i] = uniform(0, 6.28);
            rate[i] = any_power(1e-3, 0.1);
        }
        for (int step = 0; step < STEPS; step++) {
            td_response response;
            for (int i = 0; i < PIXELS; i++) {
                const double at = phase[i] + rate[i] * step;
                for (int k = 0; k < 4; k++) b.control[k][i] = -2 + 1.5 * sin(at + rate[i] * k / 3);
            }
            step_many(&frontend, h, PIXELS, &b);
            for (int i = 0; i < PIXELS; i += 29) { /* the walk is slow */
                const double mine = b.S[i];
                given += !isnan(b.low[i]);
                if (isnan(b.low[i])) b.after[i] = walk(&frontend, h, &b, i, &response);
                b.S[i] = S[i];
                S[i] = walk(&exact, h, &b, i, &response);
                b.S[i] = mine;
                assert_true(fabs(b.after[i] - S[i]) <= TD_FRONTEND_TOLERANCE); /* some steps are the walk's */
            }
            memcpy(b.S, b.after, sizeof b.S);
        }
        assert_true(given > 0.9 * STEPS * 7);
    }
}

/* A pixel alone, in another place, beside others: the same bits. */
static void depends_on_no_other(void **state) {
    (void)state;
    seed(3);
    static batch b, moved;
    const tides_sensor sensor = sensor_of(300);
    const td_frontend frontend = make(&sensor, 0);
    for (int trial = 0; trial < 50; trial++) {
        const double h = any_power(1e-6, 1e-1);
        for (int i = 0; i < PIXELS; i++) {
            const double L = uniform(-4.7, 0.3);
            for (int k = 0; k < 4; k++) b.control[k][i] = i % 20 == 3 ? NAN : L + uniform(-0.2, 0.2);
            b.S[i] = L + uniform(-0.5, 0.5);
        }
        step_many(&frontend, h, PIXELS, &b);
        const int by = (int)uniform(1, PIXELS);
        const size_t count = (size_t)(PIXELS - by);
        for (int k = 0; k < 4; k++) memcpy(moved.control[k], b.control[k] + by, count * sizeof(double));
        memcpy(moved.S, b.S + by, count * sizeof(double));
        step_many(&frontend, h, count, &moved);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(isnan(moved.low[i]), isnan(b.low[i + (size_t)by]));
            if (isnan(moved.low[i])) continue;
            assert_memory_equal(&moved.after[i], &b.after[i + (size_t)by], sizeof(double));
            assert_memory_equal(&moved.low[i], &b.low[i + (size_t)by], sizeof(double));
            assert_memory_equal(&moved.high[i], &b.high[i + (size_t)by], sizeof(double));
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_the_walk),         cmocka_unit_test(of_the_worst),        cmocka_unit_test(has_no_answer),
        cmocka_unit_test(steps_do_not_add_up), cmocka_unit_test(depends_on_no_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
