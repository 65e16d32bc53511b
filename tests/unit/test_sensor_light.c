/* Values of a sensor that depend on the run's light, on temperature, and on the parity of columns; and the cause of a pixel's
 * first event, which began on its way to a level. */
#include "sensor_rig.h"
#include "sensor/td_between.h"

#include <stdio.h>

static void still(const void *user, int i, double t, double *S, double *S_dot) {
    (void)i;
    *S_dot = *(const double *)user;
    *S = -1 + *S_dot * t;
}

static rig *make(const tides_sensor *sensor, const double *speed) { return rig_make(sensor, 4, 0, still, speed); }

static void test_parity(void **state) {
    (void)state;
    const double speed = 0;
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_off = 0.3;
    sensor.threshold_parity = 0.1;
    rig *r = make(&sensor, &speed);
    for (size_t i = 0; i < r->pixels; i++) {
        const double part = i % 2 ? 1.1 : 0.9; /* tiles are 16 wide */
        assert_true(fabs(td_sensor_threshold_on(&r->sensor, i) - 0.2 * part) < 1e-15);
        assert_true(fabs(td_sensor_threshold_off(&r->sensor, i) - 0.3 * part) < 1e-15);
    }
    rig_free(r);
}

/* Leak in Hz of all pixels. */
static double leak_of(const tides_sensor *sensor) {
    const double speed = 0;
    rig *r = make(sensor, &speed);
    const double leak = 1e9 * r->sensor.leak[0] / td_sensor_threshold_on(&r->sensor, 0);
    rig_free(r);
    return leak;
}

static void test_leak(void **state) {
    (void)state;
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.leak_rate_hz = 0.1;
    assert_true(fabs(leak_of(&sensor) - 0.1) < 1e-14);
    sensor.temperature_c = 41;
    assert_true(fabs(leak_of(&sensor) - 0.4) < 1e-14);
    sensor.temperature_c = 9;
    assert_true(fabs(leak_of(&sensor) - 0.025) < 1e-14);
    sensor.circuit.photocurrent_a = 2e-12;
    sensor.circuit.dark_current_a = 1e-12;
    sensor.leak_hz_per_a = 1e11;
    assert_true(fabs(leak_of(&sensor) - 0.225) < 1e-14);
}

static void test_bandwidth(void **state) {
    (void)state;
    tides_sensor sensor;
    td_frontend frontend;
    tides_error error = {TIDES_OK, ""};
    tides_sensor_defaults(&sensor);
    sensor.photoreceptor_cutoff_hz = 100;
    sensor.circuit.photocurrent_a = 2e-12;
    sensor.circuit.dark_current_a = 1e-12;
    sensor.photoreceptor_half_a = 6e-12;
    assert_int_equal(td_frontend_make(&sensor, &frontend, &error), TIDES_OK);
    assert_true(fabs(frontend.rate - 6.283185307179586 * 25) < 1e-9);
    sensor.photoreceptor_half_a = NAN;
    assert_int_equal(td_frontend_make(&sensor, &frontend, &error), TIDES_BAD_ARGUMENT);
    sensor.photoreceptor_half_a = 1e-12;
    sensor.circuit.photocurrent_a = sensor.circuit.dark_current_a = 0;
    assert_int_equal(td_frontend_make(&sensor, &frontend, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "camera.lux"));
}

/* At rest all are leak's; where the signal rises by a threshold in 10 ms, hardly any, though pixels began anywhere. */
static void test_cause(void **state) {
    (void)state;
    for (int moves = 0; moves < 2; moves++) {
        const double speed = 20 * moves;
        tides_sensor sensor;
        tides_sensor_defaults(&sensor);
        sensor.leak_rate_hz = 0.1;
        sensor.initial = TIDES_INITIAL_STEADY;
        rig *r = make(&sensor, &speed);
        rig_run(r, moves ? 0.01 : 9.9, 10);
        const td_sensor_counts *counts = &r->work.counts;
        printf("%s: %d of leak, %d of the signal\n", moves ? "moving" : "at rest", (int)counts->cause[TIDES_CAUSE_LEAK],
               (int)counts->cause[TIDES_CAUSE_SIGNAL]);
        assert_true(counts->events_on > 900);
        assert_true(counts->cause[moves ? TIDES_CAUSE_LEAK : TIDES_CAUSE_SIGNAL] == 0);
        rig_free(r);
    }
}

static void test_refused(void **state) {
    (void)state;
    const td_tile tile = {0, 0, 16, 256};
    for (int i = 0; i < 3; i++) {
        td_sensor made;
        tides_error error = {TIDES_OK, ""};
        tides_sensor sensor;
        tides_sensor_defaults(&sensor);
        if (i == 0) sensor.threshold_parity = 1;
        if (i == 1) sensor.temperature_c = NAN;
        if (i == 2) sensor.leak_hz_per_a = -1;
        assert_int_equal(td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, 16}, &made,
                                          &error),
                         TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, i == 0 ? "parity" : i == 1 ? "temperature" : "leak_hz_per_a"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_parity), cmocka_unit_test(test_leak),
                                       cmocka_unit_test(test_bandwidth), cmocka_unit_test(test_cause),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
