/* The high-pass against a fine integration of its equations, for cubics, with rates from slow to fast and equal ones; cut into
 * pieces; and its response to an edge. */
#include "sensor_rig.h"

#include <stdio.h>

static const double two_pi = 6.28318530717958647693;

static td_frontend make(double low_hz, double high_hz, tides_sensor *sensor) {
    td_frontend frontend;
    tides_error error = {TIDES_OK, ""};
    tides_sensor_defaults(sensor);
    sensor->photoreceptor_cutoff_hz = low_hz;
    sensor->highpass_hz = high_hz;
    if (td_frontend_make(sensor, &frontend, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_true(frontend.on);
    return frontend;
}

/* S' = low (L - S), z' = high (S - z), by Runge and Kutta's fourth order. */
static void integrate(const td_model *L, double h, double low, double high, double *S, double *z) {
    enum { PARTS = 40000 };
    const double d = h / PARTS;
    for (int i = 0; i < PARTS; i++) {
        double k[4][2], s[2] = {*S, *z};
        for (int r = 0; r < 4; r++) {
            const double at = r == 0 ? 0 : r == 3 ? 1 : 0.5, input = td_model_value(L, (i + at) / PARTS);
            const double a = low > 0 ? s[0] + (r ? at * d * k[r - 1][0] : 0) : input, b = s[1] + (r ? at * d * k[r - 1][1] : 0);
            k[r][0] = low > 0 ? low * (input - a) : 0;
            k[r][1] = high * (a - b);
        }
        *S += d / 6 * (k[0][0] + 2 * k[1][0] + 2 * k[2][0] + k[3][0]);
        *z += d / 6 * (k[0][1] + 2 * k[1][1] + 2 * k[2][1] + k[3][1]);
    }
    if (!(low > 0)) *S = td_model_value(L, 1);
}

static void test_against_integration(void **state) {
    (void)state;
    static const double rates[][2] = {{0, 1}, {0, 100}, {0, 1e-4}, {300, 5}, {50, 50}, {50, 50.00001}, {2, 400}, {1000, 1e-3}};
    const double h = 0.01;
    for (size_t r = 0; r < sizeof rates / sizeof *rates; r++) {
        tides_sensor sensor;
        const td_frontend frontend = make(rates[r][0], rates[r][1], &sensor);
        double states[TD_FRONTEND_STATE] = {0}, S = -1, z = -1;
        assert_true(td_frontend_rest(&frontend, -1, 1e-3, states) == 0);
        double from = -1;
        for (int k = 0; k < 5; k++) {
            const double to = from + sin(3.7 * k + (double)r);
            const td_model L = {{from, from + 0.7, to - 0.4, to}};
            td_response response;
            td_frontend_step(&frontend, h, &L, 1e-3, states, &response, NULL);
            integrate(&L, h, two_pi * rates[r][0], two_pi * rates[r][1], &S, &z);
            const int meet = fabs(rates[r][0] - rates[r][1]) < 1e-3 * rates[r][0]; /* such are moved by a millionth */
            if (fabs(states[0] - (S - z)) > (meet ? 1e-6 : 1e-10))
                fail_msg("%g and %g Hz, step %d: %.12g, not %.12g", rates[r][0], rates[r][1], k, states[0], S - z);
            assert_true(td_response_value(&response, 1) == states[0]);
            from = to;
        }
    }
}

/* Part [a, b] of a cubic. */
static td_model part(const td_model *m, double a, double b) {
    const double A = td_model_value(m, a), B = td_model_value(m, b);
    const double dA = td_model_slope(m, a) * (b - a) / 3, dB = td_model_slope(m, b) * (b - a) / 3;
    return (td_model){{A, A + dA, B - dB, B}};
}

static void test_cut(void **state) {
    (void)state;
    static const double rates[][2] = {{0, 3}, {80, 0.01}, {80, 600}, {1e5, 20}};
    const td_model L = {{-1, 0.5, -0.7, 0.2}};
    for (size_t r = 0; r < sizeof rates / sizeof *rates; r++) {
        tides_sensor sensor;
        const td_frontend frontend = make(rates[r][0], rates[r][1], &sensor);
        double whole[TD_FRONTEND_STATE] = {0.3, -0.8}, cut[TD_FRONTEND_STATE] = {0.3, -0.8};
        td_response response, piece;
        td_frontend_step(&frontend, 0.02, &L, 1e-3, whole, &response, NULL);
        for (int k = 0; k < 7; k++) {
            const td_model m = part(&L, k / 7.0, (k + 1) / 7.0);
            td_frontend_step(&frontend, 0.02 / 7, &m, 1e-3, cut, &piece, NULL);
            assert_true(fabs(cut[0] - td_response_value(&response, (k + 1) / 7.0)) < 1e-12);
        }
        assert_true(fabs(cut[1] - whole[1]) < 1e-12);
        double low, high;
        td_response_range(&response, &low, &high);
        for (int k = 0; k <= 100; k++) {
            const double value = td_response_value(&response, k / 100.0);
            assert_true(value >= low && value <= high);
        }
    }
}

static void edge(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    *S = t < 0.05 ? -1 : 0.0;
    *S_dot = 0;
}

/* y jumps by 1 and decays as e^(-t / tau): thresholds 0.3 make 3 ON events, then 2 OFF on the way back, whose times are in
 * closed form. */
static void test_edge(void **state) {
    (void)state;
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = sensor.threshold_off = 0.3;
    sensor.highpass_hz = 2;
    rig *r = rig_make(&sensor, 1, 0, edge, NULL);
    rig_run(r, 0.0499, 5);
    rig_step(r, 0.050001);
    rig_run(r, 1, 40);
    tides_event events[16];
    const size_t count = rig_events(r, 3, 3, events, 16);
    assert_int_equal(count, 5);
    for (int k = 0; k < 3; k++) assert_int_equal(events[k].polarity, 1);
    for (int k = 3; k < 5; k++) { /* from the reference 0.9: at 0.6 and 0.3, and 0 is never reached */
        assert_int_equal(events[k].polarity, -1);
        const double t = 0.05 + log(1 / (0.6 - 0.3 * (k - 3))) / (two_pi * 2);
        assert_true(fabs(1e-9 * (double)events[k].t - t) < 1.2e-4); /* the edge takes 101 us */
    }
    rig_free(r);
}

static void wave(const void *user, int i, double t, double *S, double *S_dot) {
    const double f = 3 + 0.1 * i;
    (void)user;
    *S = 0.8 * sin(f * t) + 0.3 * sin(7.1 * f * t);
    *S_dot = f * (0.8 * cos(f * t) + 2.13 * cos(7.1 * f * t));
}

/* What is passed over unsolved has no events: the same as with every pixel solved. */
static void test_exhaustive(void **state) {
    (void)state;
    for (int behind = 0; behind < 2; behind++) {
        tides_sensor sensor;
        tides_sensor_defaults(&sensor);
        sensor.highpass_hz = 3;
        sensor.photoreceptor_cutoff_hz = behind ? 40 : 0;
        rig *a = rig_make(&sensor, 1, 0, wave, NULL), *b = rig_make(&sensor, 1, 0, wave, NULL);
        b->sensor.exhaustive = 1;
        rig_run(a, 1, 50);
        rig_run(b, 1, 50);
        assert_true(a->work.events.count > 500);
        assert_int_equal(a->work.events.count, b->work.events.count);
        assert_memory_equal(a->work.events.events, b->work.events.events, a->work.events.count * sizeof(tides_event));
        rig_free(a);
        rig_free(b);
    }
}

static void test_refused(void **state) {
    (void)state;
    tides_sensor sensor;
    td_frontend frontend;
    tides_error error = {TIDES_OK, ""};
    tides_sensor_defaults(&sensor);
    sensor.highpass_hz = -1;
    assert_int_equal(td_frontend_make(&sensor, &frontend, &error), TIDES_BAD_ARGUMENT);
    sensor.highpass_hz = 1;
    sensor.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
    assert_int_equal(td_frontend_make(&sensor, &frontend, &error), TIDES_UNSUPPORTED);
    sensor.bandwidth = TIDES_BANDWIDTH_FIRST_ORDER;
    sensor.photoreceptor_cutoff_hz = 100;
    sensor.photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
    assert_int_equal(td_frontend_make(&sensor, &frontend, &error), TIDES_UNSUPPORTED);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_against_integration), cmocka_unit_test(test_cut),
                                       cmocka_unit_test(test_edge), cmocka_unit_test(test_exhaustive),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
