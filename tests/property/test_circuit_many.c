/* The pixel's circuit over whole steps of many pixels, against the careful walk with a ten thousandth of the tolerance, for
 * inputs like images' and for the worst inputs known. */
#include "tests/support/frontend_oracle.h"
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

enum { PIXELS = 77, STATES = TD_FRONTEND_STATE }; /* blocks, and some left over */

static void seed(uint64_t salt) { seed_from(20261130, salt); }

static tides_sensor usual(void) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
    return sensor;
}

/* Photodiodes, gains and lights a hundredfold apart; stages left out, and two that meet. */
static tides_sensor any(void) {
    tides_sensor sensor = usual();
    sensor.circuit.photocurrent_a = any_power(1e-14, 1e-11);
    sensor.circuit.dark_current_a = any_power(1e-15, 1e-14);
    sensor.circuit.gain = any_power(5, 300);
    sensor.circuit.output_s = any_power(1e-5, 1e-2);
    if (uniform(0, 1) < 0.3) sensor.circuit.source_follower_hz = 0;
    if (uniform(0, 1) < 0.3) sensor.circuit.difference_hz = 0;
    if (uniform(0, 1) < 0.1) sensor.circuit.difference_hz = sensor.circuit.source_follower_hz;
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
    double control[4][PIXELS], state[STATES][PIXELS], after[STATES][PIXELS], low[PIXELS], high[PIXELS];
} batch;

static void step_many(const td_frontend *frontend, double h, size_t count, batch *b) {
    const td_filter_block pixels = {count,
                                    {b->control[0], b->control[1], b->control[2], b->control[3]},
                                    {b->state[0], b->state[1], b->state[2], b->state[3]},
                                    {b->after[0], b->after[1], b->after[2], b->after[3]},
                                    b->low,
                                    b->high};
    td_circuit_step_many(frontend, h, LOG_EPS, &pixels);
}

static void put(batch *b, int i, double S, double y, double y_dot, double z) {
    b->state[0][i] = S;
    b->state[1][i] = y;
    b->state[2][i] = y_dot;
    b->state[3][i] = z;
}

static void walk(const td_frontend *frontend, double h, const batch *b, int i, double state[STATES], td_response *response) {
    const td_model input = {{b->control[0][i], b->control[1][i], b->control[2][i], b->control[3][i]}};
    for (int s = 0; s < STATES; s++) state[s] = b->state[s][i];
    td_frontend_step(frontend, h, &input, LOG_EPS, state, response, NULL);
}

/* What the walk is given; more takes it minutes. */
static const double truth = 5e-13;

/* Where an answer is given S, y and z are within half of the tolerance: five times what is proven of the input, which a swing
 * enlarges. Bounds hold what is sampled. Returns how many there were. */
static int check(const td_frontend *exact, double h, const batch *b) {
    int answers = 0;
    for (int i = 0; i < PIXELS; i++) {
        assert_int_equal(isnan(b->low[i]), isnan(b->high[i]));
        if (isnan(b->low[i])) continue;
        td_response response;
        double state[STATES];
        walk(exact, h, b, i, state, &response);
        answers++;
        for (int s = 0; s < STATES; s++) {
            if (s == 2) continue; /* a rate: seen in the other's next steps */
            if (!(fabs(state[s] - b->after[s][i]) <= 0.5 * TD_FRONTEND_TOLERANCE))
                fail_msg("state %d is %.17g, not %.17g: off by %g; h %g, from %.17g, L %.17g %.17g %.17g %.17g", s,
                         b->after[s][i], state[s], b->after[s][i] - state[s], h, b->state[s][i], b->control[0][i],
                         b->control[1][i], b->control[2][i], b->control[3][i]);
        }
        for (int k = 0; k <= 16; k++) {
            const double value = td_response_value(&response, k / 16.0);
            if (!(value > b->low[i] && value < b->high[i]))
                fail_msg("%.17g at %g isn't within %.17g and %.17g; h %g, S %.17g, L %.17g %.17g %.17g %.17g", value, k / 16.0,
                         b->low[i], b->high[i], h, b->state[0][i], b->control[0][i], b->control[1][i], b->control[2][i],
                         b->control[3][i]);
        }
    }
    return answers;
}

/* From still to a log unit in a step, bent as what moves past is, from a nanosecond to some time constants: most of what images
 * make has an answer. */
static void is_the_walk(void **state) {
    (void)state;
    seed(0);
    static batch b;
    int answers = 0, asked = 0;
    for (int trial = 0; trial < 60; trial++) {
        const tides_sensor sensor = trial % 3 ? usual() : any();
        const double h = any_power(1e-9, 3e-3);
        const td_frontend frontend = make(&sensor, 0), exact = make(&sensor, truth);
        for (int i = 0; i < PIXELS; i++) {
            const double L = uniform(-4.5, 0.3), size = any_power(1e-5, trial % 2 ? 1 : 0.1);
            const double slope = uniform(-size, size), bend = size * uniform(-size, size), turn = size * bend;
            b.control[0][i] = L;
            for (int k = 1; k < 4; k++) b.control[k][i] = fmax(L + k * slope + k * k * bend + (k == 2 ? turn : 0), -4.6);
            const double lag = i % 3 ? 0.1 : size;
            put(&b, i, L + uniform(-lag, lag), L + uniform(-lag, lag), uniform(-30, 30), L + uniform(-lag, lag));
        }
        step_many(&frontend, h, PIXELS, &b);
        const int answered = check(&exact, h, &b);
        answers += trial % 2 ? 0 : answered;
        asked += trial % 2 ? 0 : PIXELS;
    }
    print_message("%d of %d have an answer\n", answers, asked);
    assert_true(answers > 0.95 * asked);
}

/* Light that steps at the step's end or begin, goes from dark to bright and back, turns, is at the black level or below it;
 * steps of a picosecond, and of a second. */
static void of_the_worst(void **state) {
    (void)state;
    seed(1);
    static batch b;
    const double dark = log(LOG_EPS);
    const double shape[][4] = {{0, 0, 0, 1},  {0, 1, 1, 1},  {0, 0, 1, 1}, {0, 1, 0, 1},      {1, 0, 1, 0},
                               {0, 1, -1, 0}, {0, 3, -3, 0}, {0, 0, 0, 0}, {0, 1e-300, 0, 0}, {1, 0, 0, 0}};
    enum { SHAPES = sizeof shape / sizeof *shape };
    int answers = 0;
    for (int trial = 0; trial < 60; trial++) {
        const tides_sensor sensor = trial % 2 ? usual() : any();
        const double h = any_power(1e-12, trial % 4 ? 1e-3 : 1);
        const td_frontend frontend = make(&sensor, 0), exact = make(&sensor, truth);
        for (int i = 0; i < PIXELS; i++) {
            const double *form = shape[i % SHAPES], size = any_power(1e-6, 5), L = i % 7 ? uniform(dark, 0) : dark;
            for (int k = 0; k < 4; k++) b.control[k][i] = L + size * form[k];
            const double y = i % 5 == 1 ? L : i % 5 == 2 ? dark - 3 : uniform(dark, 0.5);
            put(&b, i, uniform(dark, 0.5), y, i % 5 == 1 ? 0 : uniform(-1e3, 1e3), y);
        }
        step_many(&frontend, h, PIXELS, &b);
        answers += check(&exact, h, &b);
    }
    print_message("%d of %d have an answer\n", answers, 60 * PIXELS);
    assert_true(answers > 0.4 * 60 * PIXELS);
}

/* Numbers that are none, below the black level, and beyond all light: no answer, never a wrong one. */
static void has_no_answer(void **state) {
    (void)state;
    static batch b;
    const tides_sensor sensor = usual();
    const td_frontend frontend = make(&sensor, 0);
    const double odd[] = {NAN, INFINITY, -INFINITY, -5, 80, 1e300};
    for (size_t o = 0; o < sizeof odd / sizeof *odd; o++)
        for (int where = 0; where < 4 + STATES; where++) {
            for (int i = 0; i < PIXELS; i++) {
                for (int k = 0; k < 4; k++) b.control[k][i] = k == where ? odd[o] : -1;
                put(&b, i, -1, -1, 0, -1);
                if (where >= 4) b.state[where - 4][i] = odd[o];
            }
            step_many(&frontend, 1e-4, PIXELS, &b);
            for (int i = 0; i < PIXELS; i++) {
                assert_int_equal(isnan(b.low[i]), isnan(b.high[i]));
                if (where < 4 || !isfinite(odd[o])) assert_true(isnan(b.low[i]));
                if (where >= 4 && odd[o] == -5) assert_false(isnan(b.low[i])); /* a state may be anywhere */
            }
        }
}

/* However many steps there are, and however short they are, the state isn't further off than the tolerance. (The walk, whose
 * slopes are differences over the step, is: y by 1.5e-8 after 800 steps of 1e-7 s. So this is held against the integral.) */
static void steps_do_not_add_up(void **state) {
    (void)state;
    seed(2);
    static batch b;
    enum { STEPS = 1500, FEW = 3 };
    for (int trial = 0; trial < 4; trial++) {
        const tides_sensor sensor = usual();
        const double h = (double[]){1e-7, 1e-6, 1e-5, 1e-4}[trial];
        const td_frontend frontend = make(&sensor, 0);
        long double kept[FEW][STATES];
        double phase[PIXELS], rate[PIXELS];
        for (int i = 0; i < PIXELS; i++) {
            const double S = uniform(-4, 0);
            put(&b, i, S, S, 0, S);
            phase[i] = uniform(0, 6.28);
            rate[i] = any_power(1e-3, 0.05);
            for (int s = 0; s < STATES && i < FEW; s++) kept[i][s] = b.state[s][i];
        }
        for (int step = 0; step < STEPS; step++) {
            for (int i = 0; i < PIXELS; i++) {
                const double at = phase[i] + rate[i] * step;
                for (int k = 0; k < 4; k++) b.control[k][i] = -2 + 1.5 * sin(at + rate[i] * k / 3);
            }
            step_many(&frontend, h, PIXELS, &b);
            for (int i = 0; i < FEW; i++) { /* the integral is slow */
                const td_model input = {{b.control[0][i], b.control[1][i], b.control[2][i], b.control[3][i]}};
                oracle_advance(&sensor, h, &input, LOG_EPS, 1, 0.05, kept[i]);
                assert_false(isnan(b.low[i]));
                for (int s = 0; s < STATES; s++)
                    if (s != 2 && !(fabs(b.after[s][i] - (double)kept[i][s]) <= 0.2 * TD_FRONTEND_TOLERANCE))
                        fail_msg("state %d of pixel %d is off by %g after %d steps of %g s", s, i,
                                 b.after[s][i] - (double)kept[i][s], step + 1, h);
            }
            memcpy(b.state, b.after, sizeof b.state);
        }
    }
}

/* A pixel alone, in another place, beside others: the same bits. */
static void depends_on_no_other(void **state) {
    (void)state;
    seed(3);
    static batch b, moved;
    const tides_sensor sensor = usual();
    const td_frontend frontend = make(&sensor, 0);
    for (int trial = 0; trial < 50; trial++) {
        const double h = any_power(1e-6, 1e-2);
        for (int i = 0; i < PIXELS; i++) {
            const double L = uniform(-4.7, 0.3);
            for (int k = 0; k < 4; k++) b.control[k][i] = i % 20 == 3 ? NAN : L + uniform(-0.2, 0.2);
            put(&b, i, L + uniform(-0.5, 0.5), L + uniform(-0.5, 0.5), uniform(-10, 10), L);
        }
        step_many(&frontend, h, PIXELS, &b);
        const int by = (int)uniform(1, PIXELS);
        const size_t count = (size_t)(PIXELS - by);
        for (int k = 0; k < 4; k++) memcpy(moved.control[k], b.control[k] + by, count * sizeof(double));
        for (int s = 0; s < STATES; s++) memcpy(moved.state[s], b.state[s] + by, count * sizeof(double));
        step_many(&frontend, h, count, &moved);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(isnan(moved.low[i]), isnan(b.low[i + (size_t)by]));
            if (isnan(moved.low[i])) continue;
            for (int s = 0; s < STATES; s++)
                assert_memory_equal(&moved.after[s][i], &b.after[s][i + (size_t)by], sizeof(double));
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
