/* The photoreceptor's filters on random cubics and parameters: against an independent integration, cut into parts, bounds, and
 * crossings against a dense search. The seed is printed; TIDES_TEST_SEED sets it. */
#include "tests/support/seeded.h"
#include "tests/support/frontend_oracle.h"
#include "sensor/response/td_frontend.h"
#include "sensor/response/td_lowpass.h"
#include "td_base.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define LOG_EPS 0.001

static void seed(uint64_t salt) { seed_from(20240611, salt); }

/* -- random filters and inputs --------------------------------------------------------------------------------------------- */

static tides_sensor random_sensor(int kind) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.photoreceptor_cutoff_hz = any_power(1, 3000);
    sensor.photoreceptor_law = kind == TD_FRONTEND_INTENSITY;
    sensor.bandwidth = kind == TD_FRONTEND_CIRCUIT;
    sensor.circuit.photocurrent_a = any_power(1e-15, 1e-11);
    sensor.circuit.dark_current_a = any_power(1e-15, 1e-14);
    sensor.circuit.gain = any_power(5, 500);
    if (uniform(0, 1) < 0.3) sensor.circuit.source_follower_hz = 0;
    if (uniform(0, 1) < 0.3) sensor.circuit.difference_hz = 0;
    if (uniform(0, 1) < 0.1) sensor.circuit.difference_hz = sensor.circuit.source_follower_hz;
    return sensor;
}

static td_frontend make(const tides_sensor *sensor) {
    td_frontend frontend;
    tides_error error;
    if (td_frontend_make(sensor, &frontend, &error) != TIDES_OK) fail_msg("%s", error.text);
    return frontend;
}

/* Log-luminance from `L` on, as an image makes it: from still to a few log units in a step. */
static td_model random_input(double L) {
    double size = any_power(1e-4, 2);
    td_model model = {{L, 0, 0, 0}};
    for (int i = 1; i < 4; i++) model.control[i] = fmin(fmax(L + uniform(-size, size), -6.9), 0.5);
    return model;
}

static const int kinds[] = {TD_FRONTEND_CONSTANT, TD_FRONTEND_INTENSITY, TD_FRONTEND_CIRCUIT};

/* -- against the oracle ---------------------------------------------------------------------------------------------------- */

static void follows_the_equations(void **state) {
    (void)state;
    seed(0);
    double worst[3] = {0};
    for (int trial = 0; trial < 90; trial++) {
        int kind = kinds[trial % 3];
        tides_sensor sensor = random_sensor(kind);
        td_frontend frontend = make(&sensor);
        double memory[TD_FRONTEND_STATE], L = uniform(-6, 0), h = any_power(1e-5, 3e-3);
        td_frontend_rest(&frontend, L, LOG_EPS, memory);
        long double exact[4] = {L, L, 0, L};
        L += uniform(-0.1, 0.1); /* a jump, so that there is something to forget */
        for (int k = 0; k < 4; k++) {
            td_model input = random_input(L);
            td_response response;
            double s = uniform(0, 1);
            long double within[4] = {exact[0], exact[1], exact[2], exact[3]};
            td_frontend_step(&frontend, h, &input, LOG_EPS, memory, &response, NULL);
            long double there = oracle_advance(&sensor, h, &input, LOG_EPS, s, 0.003, within);
            long double after = oracle_advance(&sensor, h, &input, LOG_EPS, 1, 0.003, exact);
            worst[trial % 3] = fmax(worst[trial % 3], (double)fabsl(td_response_value(&response, s) - there));
            worst[trial % 3] = fmax(worst[trial % 3], (double)fabsl(memory[0] - after));
            L = input.control[3];
        }
    }
    print_message("worst errors: constant %.2g, intensity %.2g, circuit %.2g log units\n", worst[0], worst[1], worst[2]);
    assert_true(worst[0] < 3e-11); /* the error of Runge and Kutta; test_frontend.c has closed forms to 1e-15 */
    assert_true(worst[1] < TD_FRONTEND_TOLERANCE);
    assert_true(worst[2] < TD_FRONTEND_TOLERANCE);
}

/* Crossings of filters that follow the light, where S moves by 5 / s and more: within 1 ns of where the oracle's S is at the
 * level. */
static void crosses_when_the_equations_do(void **state) {
    (void)state;
    seed(8);
    int events = 0;
    double worst = 0;
    for (int trial = 0; trial < 30; trial++) {
        tides_sensor sensor = random_sensor(kinds[trial % 3]);
        sensor.photoreceptor_cutoff_hz = any_power(100, 1000);
        td_frontend frontend = make(&sensor);
        double memory[TD_FRONTEND_STATE], L = uniform(-4, -1), h = any_power(3e-4, 3e-3), rise = uniform(0.1, 0.4), s, from = 0;
        td_model input = {{L, L + 0.2 * rise, L + 0.7 * rise, L + rise}};
        td_response response;
        double reference = td_frontend_rest(&frontend, L, LOG_EPS, memory);
        td_frontend_step(&frontend, h, &input, LOG_EPS, memory, &response, NULL);
        for (int polarity; (polarity = td_response_crossing(&response, reference, 0.02, 0.02, from, 1, &s)) != 0;) {
            long double exact[4] = {L, L, 0, L};
            reference += 0.02 * polarity;
            from = s;
            double slope = td_response_slope(&response, s) / h;
            if (fabs(slope) < 5) continue;
            double off = (double)((oracle_advance(&sensor, h, &input, LOG_EPS, s, 0.01, exact) - reference) / slope);
            worst = fmax(worst, fabs(off));
            events++;
        }
    }
    print_message("worst of %d crossings: %.2g ns\n", events, 1e9 * worst);
    assert_true(events > 50);
    assert_true(worst < 1e-9);
}

/* -- cutting --------------------------------------------------------------------------------------------------------------- */

/* De Casteljau: the cubic on [0, at] and on [at, 1]. */
static void split(const td_model *model, double at, td_model *left, td_model *right) {
    double b[4];
    memcpy(b, model->control, sizeof b);
    for (int i = 0; i < 4; i++) {
        left->control[i] = b[0];
        right->control[3 - i] = b[3 - i];
        for (int k = 0; k < 3 - i; k++) b[k] += at * (b[k + 1] - b[k]);
    }
}

/* By rounding only where rates stand still. */
static void cutting_a_step_changes_nothing(void **state) {
    (void)state;
    seed(1);
    for (int trial = 0; trial < 3000; trial++) {
        int kind = kinds[trial % 3];
        tides_sensor sensor = random_sensor(kind);
        int still = kind == TD_FRONTEND_CONSTANT || trial % 2;
        if (kind == TD_FRONTEND_CIRCUIT && still) sensor.circuit.photocurrent_a = 0;
        if (kind == TD_FRONTEND_INTENSITY) still = 0;
        sensor.circuit.difference_hz = 16000; /* no poles that meet: they lose digits */
        td_frontend frontend = make(&sensor);
        double whole[TD_FRONTEND_STATE], parts[TD_FRONTEND_STATE], L = uniform(-6, 0), h = any_power(1e-6, 1e-1);
        double at = uniform(0, 1), bound = still ? 2e-12 : 2 * TD_FRONTEND_TOLERANCE;
        td_frontend_rest(&frontend, L + uniform(-1, 1), LOG_EPS, whole);
        memcpy(parts, whole, sizeof parts);
        td_model input = random_input(L), left, right;
        td_response response, first, second;
        split(&input, at, &left, &right);
        td_frontend_step(&frontend, h, &input, LOG_EPS, whole, &response, NULL);
        td_frontend_step(&frontend, at * h, &left, LOG_EPS, parts, &first, NULL);
        td_frontend_step(&frontend, (1 - at) * h, &right, LOG_EPS, parts, &second, NULL);
        for (int i = 0; i <= 4; i++) {
            double u = i / 4.0, a = td_response_value(&response, at * u), b = td_response_value(&response, at + (1 - at) * u);
            if (!(fabs(a - td_response_value(&first, u)) <= bound) || !(fabs(b - td_response_value(&second, u)) <= bound))
                fail_msg("trial %d, kind %d, cut at %g: %g and %g", trial, kind, at, a - td_response_value(&first, u),
                         b - td_response_value(&second, u));
        }
        assert_true(fabs(whole[0] - parts[0]) <= bound);
    }
}

/* -- responses --------------------------------------------------------------------------------------------------------- */

/* A response as filters leave them, or modes of any size. */
static td_response random_path(int trial, td_frontend *frontend, tides_sensor *sensor) {
    td_response response = {.modes = 0};
    if (trial % 2) {
        double memory[TD_FRONTEND_STATE], L = uniform(-6, 0);
        *sensor = random_sensor(kinds[trial / 2 % 3]);
        *frontend = make(sensor);
        td_model input = random_input(L);
        td_frontend_rest(frontend, L + uniform(-1, 1), LOG_EPS, memory);
        td_frontend_step(frontend, any_power(1e-5, 1e-2), &input, LOG_EPS, memory, &response, NULL);
        double ramp = uniform(-0.05, 0.05) * (trial % 4 == 1); /* a leak's */
        for (int i = 0; i < 4; i++) response.cubic.control[i] += ramp * (i / 3.0);
        return response;
    }
    response.modes = (int)uniform(0, TD_RESPONSE_MODES_MAX + 1);
    for (int i = 0; i < 4; i++) response.cubic.control[i] = uniform(-1, 1);
    for (int k = 0; k < response.modes; k++) {
        td_mode *mode = &response.mode[k];
        *mode = (td_mode){any_power(1e-3, 1e3), 0, uniform(-1, 1), uniform(-1, 1), 0};
        if (uniform(0, 1) < 0.5) mode->frequency = mode->rate * uniform(0, 5);
        if (hypot(mode->rate, mode->frequency) <= 1) {
            mode->tail = 1;
            mode->cosine *= 20;
        }
    }
    return response;
}

static void bounds_hold_what_is_sampled(void **state) {
    (void)state;
    seed(2);
    for (int trial = 0; trial < 2000; trial++) {
        td_frontend frontend;
        tides_sensor sensor;
        td_response response = random_path(trial, &frontend, &sensor);
        double low, high;
        td_response_range(&response, &low, &high);
        int samples = response.source.frontend ? 16 : 200; /* in substeps: each sample walks them all */
        for (int i = 0; i <= samples; i++) {
            double value = td_response_value(&response, (double)i / samples);
            if (!(value >= low && value <= high)) fail_msg("trial %d: %.17g is not in [%.17g, %.17g]", trial, value, low, high);
        }
    }
}

/* The slope is the value's: by central differences. */
static void slopes_are_derivatives(void **state) {
    (void)state;
    seed(3);
    for (int trial = 0; trial < 2000; trial++) {
        td_frontend frontend;
        tides_sensor sensor;
        td_response response = random_path(trial, &frontend, &sensor);
        double steepest = 1;
        for (int k = 0; k < response.modes; k++)
            steepest = fmax(steepest, hypot(response.mode[k].rate, response.mode[k].frequency));
        if (response.source.frontend)
            continue; /* each substep starts where another ended, within the tolerance: divided by 1e-5 */
        double d = 1e-5 / steepest, s = uniform(d, 1 - d), slope = td_response_slope(&response, s);
        double found = (td_response_value(&response, s + d) - td_response_value(&response, s - d)) / (2 * d);
        assert_true(fabs(found - slope) <= 1e-8 * (1 + steepest));
    }
}

/* Every crossing against the first of many samples that has reached a level: never later than it, never before the last sample
 * that hasn't, unless S really is at the level there. */
static void check_crossings(int trial, const td_response *response, double on, double off) {
    enum { SAMPLES = 4000 };
    static double value[SAMPLES + 1];
    for (int i = 0; i <= SAMPLES; i++) value[i] = td_response_value(response, (double)i / SAMPLES);
    double reference = value[0], from = 0, s;
    double tiny = (response->source.frontend ? TD_FRONTEND_TOLERANCE : 1e-12) * (1 + fabs(reference));
    int next = 0;
    for (int events = 0; events < 200; events++) {
        int polarity = td_response_crossing(response, reference, on, off, from, 1, &s);
        int sample = next;
        while (sample <= SAMPLES && value[sample] - reference < on - tiny && value[sample] - reference > -off + tiny) sample++;
        if (!polarity) {
            for (; sample <= SAMPLES; sample++)
                if (value[sample] - reference >= on + tiny || value[sample] - reference <= -off - tiny)
                    fail_msg("trial %d: no crossing from %g on, but S is %g beyond at %g", trial, from,
                             value[sample] - reference, (double)sample / SAMPLES);
            return;
        }
        double level = reference + (polarity > 0 ? on : -off), there = td_response_value(response, s);
        if (s < from || s > 1) fail_msg("trial %d: crossing at %g, not in [%g, 1]", trial, s, from);
        if (s > from && fabs(there - level) > tiny * (1 + fabs(td_response_slope(response, s))))
            fail_msg("trial %d: S is %g off its level at %g", trial, there - level, s);
        if (sample <= SAMPLES && s > (double)(sample + 1) / SAMPLES)
            fail_msg("trial %d: crossing at %g, but a level was reached by %g", trial, s, (double)sample / SAMPLES);
        reference = level;
        from = s;
        next = (int)ceil(s * SAMPLES);
    }
}

static void crossings_are_those_of_a_dense_search(void **state) {
    (void)state;
    seed(4);
    for (int trial = 0; trial < 1500; trial++) {
        td_frontend frontend;
        tides_sensor sensor;
        td_response response = random_path(trial, &frontend, &sensor);
        if (response.source.frontend && trial % 64 != 3 && trial % 32 != 5) continue;
        check_crossings(trial, &response, any_power(0.01, 1), any_power(0.01, 1));
    }
}

/* A level put exactly where S turns: touched, it fires; a hair beyond, it doesn't. */
static void touching_counts(void **state) {
    (void)state;
    seed(5);
    for (int trial = 0; trial < 2000; trial++) {
        /* S = s - a (1 - e^(-rate s)) turns once, at log(a rate) / rate. */
        double rate = any_power(4, 1e3), a = any_power(2, 50) / rate, turn = log(a * rate) / rate, s;
        if (!(turn < 0.9)) continue;
        td_response response = {.cubic = {{-a, -a + 1.0 / 3, -a + 2.0 / 3, -a + 1}}, .modes = 1};
        response.mode[0] = (td_mode){rate, 0, a, 0, 0};
        double lowest = turn - a + 1 / rate, hair = 4e-15 * (1 + a);
        assert_int_equal(td_response_crossing(&response, 0, 1e9, -lowest - hair, 0, 1, &s), -1);
        assert_true(fabs(s - turn) < 1e-6 / sqrt(rate));
        assert_int_equal(td_response_crossing(&response, 0, 1e9, -lowest + hair, 0, 1, &s), 0);
        assert_int_equal(td_response_crossing(&response, 0, 1e9, -lowest + hair, turn, turn, &s), 0);
    }
}

/* Odd numbers anywhere end, and what isn't finite reaches nothing. */
static void values_that_are_no_numbers_do_no_harm(void **state) {
    (void)state;
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 0, 1, 1e-300, 1e15};
    enum { ODD = sizeof odd / sizeof *odd };
    seed(6);
    double s, low, high;
    for (int trial = 0; trial < 3000; trial++) {
        td_response response = {.modes = 2};
        int bad = 0;
        double *field[] = {&response.cubic.control[0], &response.cubic.control[3], &response.mode[0].rate,
                           &response.mode[0].cosine,   &response.mode[1].sine,     &response.mode[1].rate,
                           &response.mode[1].frequency};
        for (size_t i = 0; i < sizeof field / sizeof *field; i++) {
            double value = odd[(int)uniform(0, ODD)];
            if (field[i] == &response.mode[0].rate || field[i] == &response.mode[1].rate) value = fabs(value);
            bad |= !isfinite(value);
            *field[i] = value;
        }
        int polarity = td_response_crossing(&response, 0, 0.2, 0.3, trial % 3 ? 0 : 0.5, 1, &s);
        assert_true(!bad || polarity == 0);
        assert_true(polarity == 0 || (s >= 0 && s <= 1));
        td_response_range(&response, &low, &high);
        if (trial % 16 == 0) td_response_crossing(&response, odd[(int)uniform(0, ODD)], NAN, 0.3, 0, NAN, &s);
    }
}

/* -- many pixels at once --------------------------------------------------------------------------------------------------- */

/* To the bit; some inputs and states are no numbers. */
static void many_pixels_are_like_one(void **state) {
    (void)state;
    seed(7);
    enum { PIXELS = 300 };
    static double control[4][PIXELS], S[PIXELS], after[PIXELS], one[PIXELS], low[PIXELS], high[PIXELS];
    const td_filter_block pixels = {PIXELS, {control[0], control[1], control[2], control[3]}, {S}, {after}, low, high};
    for (int trial = 0; trial < 200; trial++) {
        tides_sensor sensor = random_sensor(TD_FRONTEND_CONSTANT);
        double h = any_power(1e-12, 1e6) / sensor.photoreceptor_cutoff_hz;
        td_frontend frontend = make(&sensor);
        for (int i = 0; i < PIXELS; i++) {
            td_model input = random_input(uniform(-6, 0));
            if (i % 50 == 7) input.control[trial % 4] = trial % 3 ? NAN : INFINITY;
            for (int k = 0; k < 4; k++) control[k][i] = input.control[k];
            S[i] = i % 50 == 9 ? NAN : uniform(-6, 0);
        }
        td_frontend_step_many(&frontend, h, &pixels);
        for (int i = 0; i < PIXELS; i++) {
            td_model input = {{control[0][i], control[1][i], control[2][i], control[3][i]}};
            double memory[TD_FRONTEND_STATE] = {S[i], S[i], 0, S[i]};
            td_response response;
            td_frontend_step(&frontend, h, &input, LOG_EPS, memory, &response, NULL);
            one[i] = memory[0];
            assert_int_equal(td_model_is_finite(&input), low[i] <= high[i]);
            for (int k = 0; k <= 32 && low[i] <= high[i]; k++) {
                double value = td_response_value(&response, k / 32.0);
                assert_true(value >= low[i] && value <= high[i]);
            }
        }
        assert_memory_equal(one, after, sizeof one);
    }
}

/* Inputs of the kinds that images make, and of those that they don't: still, jumping, in the dark, beyond all numbers. */
static td_model odd_input(int trial, int i) {
    td_model input = random_input(uniform(-6, 0));
    if (i % 7 == 0) input = (td_model){{input.control[0], input.control[0], input.control[0], input.control[0]}};
    if (i % 11 == 0) input.control[3] = input.control[2] = uniform(-7, 3); /* below log_eps, too */
    if (i % 13 == 0)
        for (int k = 0; k < 4; k++) input.control[k] = uniform(-6.9, 9);
    if (i % 50 == 7) input.control[trial % 4] = trial % 3 ? NAN : INFINITY;
    if (i % 50 == 19) input.control[trial % 4] = 80;
    return input;
}

/* The low-pass whose rate goes with the light: within what both may be off by (test_light_whole.c has how little it is where no
 * substeps are taken); and of what an image makes it hardly leaves any. */
static void many_pixels_in_the_light_are_like_one(void **state) {
    (void)state;
    seed(9);
    enum { PIXELS = 300 };
    static double control[4][PIXELS], S[PIXELS], after[PIXELS], low[PIXELS], high[PIXELS];
    const td_filter_block pixels = {PIXELS, {control[0], control[1], control[2], control[3]}, {S}, {after}, low, high};
    int done = 0, left = 0, left_in_the_light = 0;
    for (int trial = 0; trial < 150; trial++) {
        tides_sensor sensor = random_sensor(TD_FRONTEND_INTENSITY);
        const double h = any_power(1e-9, trial % 8 ? 10 : 1e6) / sensor.photoreceptor_cutoff_hz;
        td_frontend frontend = make(&sensor);
        for (int i = 0; i < PIXELS; i++) {
            const td_model input = odd_input(trial, i);
            for (int k = 0; k < 4; k++) control[k][i] = input.control[k];
            S[i] = i % 50 == 9 ? NAN : i % 3 ? input.control[0] + uniform(-0.1, 0.1) : uniform(-6, 0);
        }
        td_frontend_step_light(&frontend, h, LOG_EPS, &pixels);
        for (int i = 0; i < PIXELS; i++) {
            const td_model input = {{control[0][i], control[1][i], control[2][i], control[3][i]}};
            double memory[TD_FRONTEND_STATE] = {S[i], S[i], 0, S[i]};
            td_response response;
            if (!(low[i] <= high[i])) {
                int lit = isfinite(S[i]);
                for (int k = 0; k < 4; k++) lit = lit && input.control[k] > -6.9 && input.control[k] < 1;
                left_in_the_light += lit;
                left++;
                continue;
            }
            done++;
            td_frontend_step(&frontend, h, &input, LOG_EPS, memory, &response, NULL);
            assert_true(fabs(memory[0] - after[i]) <= TD_FRONTEND_TOLERANCE);
            assert_true(fabs(td_response_value(&response, 1) - memory[0]) <= 1e-12 * (1 + fabs(memory[0])));
            for (int k = 0; k <= 32; k++) {
                const double value = td_response_value(&response, k / 32.0);
                assert_true(value >= low[i] && value <= high[i]);
            }
        }
    }
    print_message("%d pixels, %d left to one by one, %d of them in the light\n", done, left, left_in_the_light);
    assert_true(done > 30000);
    assert_true(left_in_the_light < done / 500); /* swings that take hundreds of substeps */
}

/* td_pole_respond is td_poles_respond of one real pole, and a mode that doesn't swing is like one that hardly does. */
static void one_real_pole_is_like_many(void **state) {
    (void)state;
    seed(8);
    for (int trial = 0; trial < 20000; trial++) {
        const double rate = any_power(1e-9, 1e6), S = uniform(-6, 0), s = uniform(0, 1);
        const td_model input = random_input(uniform(-6, 0));
        const td_poles poles = td_poles_first_order(rate, S, input.control[0]);
        td_response one, many;
        td_pole_respond(rate, S, &input, &one);
        td_poles_respond(&poles, &input, &many);
        assert_memory_equal(&one.cubic, &many.cubic, sizeof one.cubic);
        assert_int_equal(one.modes, many.modes);
        assert_true(one.mode[0].cosine == many.mode[0].cosine && one.mode[0].rate == many.mode[0].rate);
        assert_int_equal(one.mode[0].tail, many.mode[0].tail);
        many.mode[0].frequency = 1e-300; /* takes the way of those that swing */
        many.mode[0].sine = 0;
        const double value = td_response_value(&many, s), slope = td_response_slope(&many, s);
        assert_true(fabs(td_response_value(&one, s) - value) <= 1e-13 * (1 + fabs(value)));
        assert_true(fabs(td_response_slope(&one, s) - slope) <= 1e-13 * (1 + fabs(slope)));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(follows_the_equations),
        cmocka_unit_test(crosses_when_the_equations_do),
        cmocka_unit_test(cutting_a_step_changes_nothing),
        cmocka_unit_test(bounds_hold_what_is_sampled),
        cmocka_unit_test(slopes_are_derivatives),
        cmocka_unit_test(crossings_are_those_of_a_dense_search),
        cmocka_unit_test(touching_counts),
        cmocka_unit_test(values_that_are_no_numbers_do_no_harm),
        cmocka_unit_test(many_pixels_are_like_one),
        cmocka_unit_test(many_pixels_in_the_light_are_like_one),
        cmocka_unit_test(one_real_pole_is_like_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
