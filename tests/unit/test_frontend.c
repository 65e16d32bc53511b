/* The photoreceptor's filters against closed forms: ramps, steps and sinusoids through the low-pass and the circuit, crossings
 * included, from 1e-12 to 1e12 time constants per step. */
#include "sensor/response/td_frontend.h"
#include "td_base.h"

#include <complex.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846264338327950288L
#define LOG_EPS 0.001

typedef long double complex complex_long;

static void assert_close(long double found, long double asked, long double within, const char *what, double at) {
    if (!(fabsl(found - asked) <= within)) fail_msg("%s at %g: %.20Lg, not %.20Lg +- %Lg", what, at, found, asked, within);
}

static tides_sensor low_pass(double cutoff_hz) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.photoreceptor_cutoff_hz = cutoff_hz;
    return sensor;
}

/* The circuit in unchanging light. */
static tides_sensor still_circuit(double current_a) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
    sensor.circuit.photocurrent_a = 0;
    sensor.circuit.dark_current_a = current_a;
    return sensor;
}

static td_frontend make(const tides_sensor *sensor) {
    td_frontend frontend;
    tides_error error;
    if (td_frontend_make(sensor, &frontend, &error) != TIDES_OK) fail_msg("%s", error.text);
    return frontend;
}

/* -- the low-pass ---------------------------------------------------------------------------------------------------------- */

/* 1 - (1 - e^-x) / x, without cancellation: the ramp's response over its input's change. */
static long double ramp_share(long double x) {
    if (x > 0.01L) return 1 + expm1l(-x) / x;
    long double sum = 0, term = x / 2;
    for (int k = 3; k < 16; term *= -x / k, k++) sum += term;
    return sum;
}

/* From rest at 0 with L = s: S = s ramp_share(lambda s). Crossings of what S is at s come back at s. */
static void ramps(void **state) {
    (void)state;
    for (int power = -12; power <= 12; power++) {
        double lambda = pow(10, power), h = 1e-3;
        tides_sensor sensor = low_pass((double)(lambda / h / (2 * PI)));
        td_frontend frontend = make(&sensor);
        lambda = frontend.rate * h;
        td_model ramp = td_model_fit(TIDES_MODEL_HERMITE, h, 0, 1 / h, 1, 1 / h);
        double memory[TD_FRONTEND_STATE];
        td_response response;
        td_frontend_rest(&frontend, 0, LOG_EPS, memory);
        td_frontend_step(&frontend, h, &ramp, LOG_EPS, memory, &response, NULL);
        for (int i = 1; i <= 16; i++) {
            double s = i / 16.0, found;
            long double S = s * ramp_share((long double)lambda * s);
            assert_close(td_response_value(&response, s), S, 4e-15L * S + 1e-15L * s * fminl(1, lambda), "ramp", lambda);
            if (i == 16) continue; /* an end short of its level by the last bit is the next step's */
            assert_int_equal(td_response_crossing(&response, 0, (double)S, 1, 0, 1, &found), 1);
            assert_close(found, s, 2e-14L, "the ramp's crossing", lambda);
        }
        assert_true(memory[0] == td_response_value(&response, 1));
    }
}

/* From rest at 0 with L = 1: S = 1 - e^(-lambda s). */
static void steps(void **state) {
    (void)state;
    for (int power = 0; power <= 12; power++) {
        double h = 1e-3, memory[TD_FRONTEND_STATE], found;
        tides_sensor sensor = low_pass((double)(pow(10, power) / h / (2 * PI)));
        td_frontend frontend = make(&sensor);
        double lambda = frontend.rate * h;
        td_model one = {{1, 1, 1, 1}};
        td_response response;
        td_frontend_rest(&frontend, 0, LOG_EPS, memory);
        td_frontend_step(&frontend, h, &one, LOG_EPS, memory, &response, NULL);
        for (double level = 0.03125; level < 1; level += 0.03125) {
            long double s = -log1pl(-level) / lambda;
            int polarity = td_response_crossing(&response, 0, level, 1, 0, 1, &found);
            assert_int_equal(polarity, s <= 1);
            if (polarity) assert_close(found, s, 1e-14L * (s + 1e-3L / lambda) / (1 - level), "the step's crossing", lambda);
        }
    }
}

/* A sinusoid as cubics of 1/256 radian: amplitude x gain(frequency), late by its phase. Every crossing of a comparator with
 * threshold 0.05, in continuous time, within 1 ns of where the analytic S is at its level, however many time constants a step
 * is. */
typedef struct wave {
    long double amplitude, omega;
    complex_long gain;
} wave;

static double wave_input(const wave *w, double t, double *dot) {
    *dot = (double)(w->amplitude * w->omega * cosl(w->omega * t));
    return (double)(w->amplitude * sinl(w->omega * t));
}

static long double wave_output(const wave *w, long double t) {
    return w->amplitude * cimagl(w->gain * cexpl(I * w->omega * t));
}

static long double wave_slope(const wave *w, long double t) {
    return w->amplitude * w->omega * creall(w->gain * cexpl(I * w->omega * t));
}

/* The crossing at t of what S is there: its distance from the analytic crossing, to first order, or the bound where S turns. */
static void check_wave(const td_frontend *frontend, const wave *w, double h, int count, int skip) {
    double memory[TD_FRONTEND_STATE], reference = 0, threshold = 0.05, s, dot0, dot1;
    td_response response;
    int events = 0;
    td_frontend_rest(frontend, 0, LOG_EPS, memory);
    for (int k = 0; k < count; k++) {
        double L0 = wave_input(w, k * h, &dot0), L1 = wave_input(w, (k + 1) * h, &dot1), from = 0;
        td_model model = td_model_fit(TIDES_MODEL_HERMITE, h, L0, dot0, L1, dot1);
        td_frontend_step(frontend, h, &model, LOG_EPS, memory, &response, NULL);
        if (k == skip) reference = td_response_value(&response, 0);
        for (int polarity;
             k >= skip && (polarity = td_response_crossing(&response, reference, threshold, threshold, from, 1, &s)) != 0;) {
            reference += polarity * threshold;
            from = s;
            events++;
            long double t = (k + (long double)s) * h, slope = wave_slope(w, t), off = wave_output(w, t) - reference;
            if (fabsl(slope) < 0.1L * w->amplitude * w->omega * cabsl(w->gain)) continue;
            long double cubics = w->amplitude * powl(w->omega * h, 4) / 384; /* what they differ from the sinusoid by */
            assert_close(off / slope, 0, fmaxl(1e-9L, 2 * cubics / fabsl(slope)), "the sinusoid's crossing", (double)t);
            assert_true(slope * polarity > 0);
        }
    }
    assert_true(events > 10);
}

static void sinusoids_through_the_low_pass(void **state) {
    (void)state;
    double h = 1e-5;
    wave w = {.amplitude = 1, .omega = 1 / (256 * 1e-5L)};
    for (int power = -3; power <= 3; power++) {
        tides_sensor sensor = low_pass((double)(powl(10, power) / h / (2 * PI)));
        td_frontend frontend = make(&sensor);
        w.gain = 1 / (1 + I * w.omega / frontend.rate);
        w.amplitude = 1 / cabsl(w.gain);
        check_wave(&frontend, &w, h, power < 0 ? 60000 : 4000, power < 0 ? 50000 : 1000);
    }
}

/* -- the circuit ----------------------------------------------------------------------------------------------------------- */

/* Poles of the whole chain: lambda such that S' = -lambda S is one of its motions. */
static int chain_poles(const tides_circuit *c, long double I_a, complex_long pole[4]) {
    long double in = c->photodiode_f * c->thermal_v / I_a, miller = c->miller_f * c->thermal_v / I_a;
    long double loop = (long double)c->gain * c->kappa + 1;
    long double omega = sqrtl(loop / ((in + miller) * c->output_s));
    long double damping = (in + c->output_s + (c->gain + 1) * miller) / (2 * sqrtl((in + miller) * c->output_s * loop));
    complex_long root = csqrtl((complex_long)(damping * damping - 1));
    int count = 0;
    pole[count++] = omega * (damping - root);
    pole[count++] = omega * (damping + root);
    if (c->source_follower_hz > 0) pole[count++] = 2 * PI * c->source_follower_hz;
    if (c->difference_hz > 0) pole[count++] = 2 * PI * c->difference_hz;
    return count;
}

/* From rest at 0 with L = 1: 1 - sum of e^(-pole t) times prod over the others of other / (other - pole). */
static long double step_response(const complex_long *pole, int count, long double t) {
    complex_long sum = 1;
    for (int k = 0; k < count; k++) {
        complex_long share = 1;
        for (int j = 0; j < count; j++)
            if (j != k) share *= pole[j] / (pole[j] - pole[k]);
        sum -= share * cexpl(-pole[k] * t);
    }
    return creall(sum);
}

static complex_long chain_gain(const complex_long *pole, int count, long double omega) {
    complex_long gain = 1;
    for (int k = 0; k < count; k++) gain /= 1 + I * omega / pole[k];
    return gain;
}

static const double currents[] = {2000e-15, 200e-15, 20e-15, 4e-15, 1e-15};
enum { CURRENTS = sizeof currents / sizeof *currents };

/* Rising, ringing and settling in one step, or in 1000: each time at which S passes a level. */
static void steps_through_the_circuit(void **state) {
    (void)state;
    for (int i = 0; i < CURRENTS * 4; i++) {
        tides_sensor sensor = still_circuit(currents[i / 4]);
        if (i & 1) sensor.circuit.source_follower_hz = 0;
        if (i & 2) sensor.circuit.difference_hz = 0;
        td_frontend frontend = make(&sensor);
        complex_long pole[4];
        int count = chain_poles(&sensor.circuit, currents[i / 4], pole);
        for (int cuts = 1; cuts <= 1000; cuts *= 10) {
            double h = 0.05 / cuts, memory[TD_FRONTEND_STATE], reference = 0, threshold = 0.01, s;
            td_frontend_rest(&frontend, 0, LOG_EPS, memory);
            td_model one = {{1, 1, 1, 1}};
            int events = 0;
            for (int k = 0; k < cuts; k++) {
                td_response response;
                double from = 0;
                td_frontend_step(&frontend, h, &one, LOG_EPS, memory, &response, NULL);
                for (int polarity;
                     (polarity = td_response_crossing(&response, reference, threshold, threshold, from, 1, &s)) != 0;) {
                    reference += polarity * threshold;
                    from = s;
                    events++;
                    long double t = (k + (long double)s) * h, off = step_response(pole, count, t) - reference;
                    long double slope = (step_response(pole, count, t + 1e-9L) - step_response(pole, count, t - 1e-9L)) / 2e-9L;
                    assert_true(fabsl(slope) < 1 || fabsl(off / slope) < 1e-9L);
                    assert_close(off, 0, 1e-12L, "the circuit's step response", (double)t);
                }
            }
            assert_close(td_response_value(&(td_response){.cubic = {{memory[0], 0, 0, 0}}}, 0),
                         step_response(pole, count, 0.05L), 1e-12L, "the circuit's state", cuts);
            assert_true(events > 50);
        }
    }
}

static void sinusoids_through_the_circuit(void **state) {
    (void)state;
    for (int i = 0; i < CURRENTS; i++) {
        tides_sensor sensor = still_circuit(currents[i]);
        td_frontend frontend = make(&sensor);
        complex_long pole[4];
        int count = chain_poles(&sensor.circuit, currents[i], pole);
        for (int power = -3; power <= 2; power++) { /* steps of 1e-3 to 100 periods of the photoreceptor's own swing */
            double h = (double)(powl(10, power) / cabsl(pole[0]));
            wave w = {.omega = 1 / (256 * (long double)h)};
            w.gain = chain_gain(pole, count, w.omega);
            w.amplitude = 1 / cabsl(w.gain);
            int settled = (int)fmaxl(100, 40 / (h * fminl(creall(pole[0]), creall(pole[1]))));
            check_wave(&frontend, &w, h, settled + 3300, settled);
        }
    }
}

/* Where poles meet: the source follower on the amplifier's pole, or the photoreceptor critically damped. */
static void poles_that_meet(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        tides_sensor sensor = still_circuit(4e-15);
        tides_circuit *c = &sensor.circuit;
        complex_long pole[4];
        if (i == 0) c->source_follower_hz = c->difference_hz = 500;
        chain_poles(c, 4e-15L, pole);
        if (i == 1) c->source_follower_hz = (double)(creall(pole[0]) / (2 * PI));
        if (i == 2) c->miller_f = 0.13742e-15; /* nearly critical; bisected below */
        for (double low = 0.05e-15, high = 0.6e-15; i == 2 && high - low > 1e-30;) {
            c->miller_f = 0.5 * (low + high);
            chain_poles(c, 4e-15L, pole);
            if (cimagl(pole[0]) != 0)
                low = c->miller_f;
            else
                high = c->miller_f;
            if (c->miller_f == low && c->miller_f == high) break;
            if (0.5 * (low + high) == low || 0.5 * (low + high) == high) break;
        }
        td_frontend frontend = make(&sensor);
        /* The analytic answer for poles a ten-thousandth apart about their mean is within 1e-8 of the one for a double pole. */
        int count = chain_poles(c, 4e-15L, pole), first = i == 0 ? 2 : 0, second = i == 0 ? 3 : i == 1 ? 2 : 1;
        complex_long mean = 0.5L * (pole[first] + pole[second]);
        pole[first] = mean * (1 - 0.5e-4L);
        pole[second] = mean * (1 + 0.5e-4L);
        double memory[TD_FRONTEND_STATE];
        td_model one = {{1, 1, 1, 1}};
        td_response response;
        td_frontend_rest(&frontend, 0, LOG_EPS, memory);
        td_frontend_step(&frontend, 0.02, &one, LOG_EPS, memory, &response, NULL);
        for (double s = 0; s <= 1; s += 0.015625)
            assert_close(td_response_value(&response, s), step_response(pole, count, 0.02L * s), 1e-6L, "poles that meet",
                         i + s);
    }
}

/* -- v2e's law ------------------------------------------------------------------------------------------------------------- */

/* A small sinusoid about a brightness: down by 3 dB at cutoff x (255 Y + 20) / 275. */
static void the_intensity_law_has_its_corner_where_it_says(void **state) {
    (void)state;
    static const double Y[] = {0.01, 0.2, 1};
    for (int i = 0; i < 3; i++) {
        tides_sensor sensor = low_pass(300);
        sensor.photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
        td_frontend frontend = make(&sensor);
        double corner = 2 * (double)PI * 300 * (255 * Y[i] + 20) / 275, h = 0.05 / corner, bias = log(Y[i] + LOG_EPS);
        double memory[TD_FRONTEND_STATE], amplitude = 1e-4, high = -INFINITY, low = INFINITY;
        td_frontend_rest(&frontend, bias, LOG_EPS, memory);
        for (int k = 0; k < 1200; k++) {
            double t = k * h;
            td_model L =
                td_model_fit(TIDES_MODEL_HERMITE, h, bias + amplitude * sin(corner * t), amplitude * corner * cos(corner * t),
                             bias + amplitude * sin(corner * (t + h)), amplitude * corner * cos(corner * (t + h)));
            td_response response;
            td_frontend_step(&frontend, h, &L, LOG_EPS, memory, &response, NULL);
            for (int j = 0; k > 600 && j < 8; j++) {
                high = fmax(high, td_response_value(&response, j / 8.0));
                low = fmin(low, td_response_value(&response, j / 8.0));
            }
        }
        assert_close((high - low) / (2 * amplitude), sqrtl(0.5L), 3e-5L, "v2e's corner", Y[i]);
    }
}

/* -- parameters and odd input ---------------------------------------------------------------------------------------------- */

static void off_is_the_cubic_itself(void **state) {
    (void)state;
    tides_sensor sensor = low_pass(0);
    td_frontend frontend = make(&sensor);
    td_model model = {{0, 1, -1, 2}};
    td_response response;
    double memory[TD_FRONTEND_STATE];
    assert_int_equal(frontend.on, 0);
    assert_true(td_frontend_rest(&frontend, 0.5, LOG_EPS, memory) == 0.5);
    td_frontend_step(&frontend, 1e-3, &model, LOG_EPS, memory, &response, NULL);
    assert_int_equal(response.modes, 0);
    assert_memory_equal(&response.cubic, &model, sizeof model);
}

static void check_refused(const tides_sensor *sensor, const char *field) {
    td_frontend frontend;
    tides_error error;
    assert_int_equal(td_frontend_make(sensor, &frontend, &error), TIDES_BAD_ARGUMENT);
    if (!strstr(error.text, field)) fail_msg("'%s' does not name %s", error.text, field);
}

static void bad_parameters_are_named(void **state) {
    (void)state;
    static const double odd[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        tides_sensor sensor = low_pass(odd[i]);
        check_refused(&sensor, "photoreceptor_cutoff_hz");
        const struct {
            size_t offset;
            const char *name;
        } field[] = {{offsetof(tides_circuit, photocurrent_a), "circuit.photocurrent_a"},
                     {offsetof(tides_circuit, dark_current_a), "circuit.dark_current_a"},
                     {offsetof(tides_circuit, gain), "circuit.gain"},
                     {offsetof(tides_circuit, kappa), "circuit.kappa"},
                     {offsetof(tides_circuit, thermal_v), "circuit.thermal_v"},
                     {offsetof(tides_circuit, photodiode_f), "circuit.photodiode_f"},
                     {offsetof(tides_circuit, miller_f), "circuit.miller_f"},
                     {offsetof(tides_circuit, output_s), "circuit.output_s"},
                     {offsetof(tides_circuit, source_follower_hz), "circuit.source_follower_hz"},
                     {offsetof(tides_circuit, difference_hz), "circuit.difference_hz"}};
        for (size_t k = 0; k < sizeof field / sizeof *field; k++) {
            sensor = still_circuit(4e-15);
            memcpy((char *)&sensor.circuit + field[k].offset, &odd[i], sizeof odd[i]);
            check_refused(&sensor, field[k].name);
        }
    }
    tides_sensor sensor = low_pass(300);
    sensor.photoreceptor_law = 2;
    check_refused(&sensor, "photoreceptor_law");
    sensor = low_pass(300);
    sensor.bandwidth = -1;
    check_refused(&sensor, "bandwidth");
    sensor = still_circuit(4e-15);
    sensor.circuit.gain = 1e5;
    check_refused(&sensor, "circuit.gain");
}

/* A step without a signal is left out; a pixel that has never had one starts at rest. */
static void an_input_that_is_no_number_waits(void **state) {
    (void)state;
    tides_sensor kinds[3] = {low_pass(300), low_pass(300), still_circuit(20e-15)};
    kinds[1].photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
    for (int i = 0; i < 3; i++) {
        td_frontend frontend = make(&kinds[i]);
        td_model good = {{0.5, 0.6, 0.7, 0.8}}, bad = {{0.8, NAN, 1, 1}}, bright = {{1e300, 1e300, -1e300, 1e300}};
        double memory[TD_FRONTEND_STATE], kept[TD_FRONTEND_STATE], s;
        td_response response;
        td_frontend_rest(&frontend, NAN, LOG_EPS, memory);
        td_frontend_step(&frontend, 1e-3, &good, LOG_EPS, memory, &response, NULL);
        assert_close(td_response_value(&response, 0), 0.5, 1e-15L, "rest", i);
        assert_true(memory[0] > 0.5 && memory[0] < 0.85);
        memcpy(kept, memory, sizeof kept);
        td_frontend_step(&frontend, 1e-3, &bad, LOG_EPS, memory, &response, NULL);
        assert_memory_equal(kept, memory, sizeof kept);
        assert_true(isnan(td_response_value(&response, 0.5)));
        assert_int_equal(td_response_crossing(&response, 0, 0.1, 0.1, 0, 1, &s), 0);
        td_frontend_step(&frontend, 1e-3, &good, LOG_EPS, memory, &response, NULL);
        assert_close(td_response_value(&response, 0), kept[0], 1e-15L, "the state after NaN", i);
        td_frontend_step(&frontend, 1e-3, &bright, LOG_EPS, memory, &response, NULL);
        td_response_crossing(&response, 0, 0.1, 0.1, 0, 1, &s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ramps),
        cmocka_unit_test(steps),
        cmocka_unit_test(sinusoids_through_the_low_pass),
        cmocka_unit_test(steps_through_the_circuit),
        cmocka_unit_test(sinusoids_through_the_circuit),
        cmocka_unit_test(poles_that_meet),
        cmocka_unit_test(the_intensity_law_has_its_corner_where_it_says),
        cmocka_unit_test(off_is_the_cubic_itself),
        cmocka_unit_test(bad_parameters_are_named),
        cmocka_unit_test(an_input_that_is_no_number_waits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
