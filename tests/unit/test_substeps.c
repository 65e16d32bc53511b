/* Substeps of filters whose rates go with the light: those that are kept give the same bits as those that are solved again, and
 * so do tails of modes side by side. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/response/td_modes.h"
#include "sensor/response/td_substeps.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <string.h>

static const uint64_t SEED = 4107;
static const double LOG_EPS = 0.01;

static td_frontend make(int circuit, tides_sensor *sensor) {
    td_frontend frontend;
    tides_error error;
    tides_sensor_defaults(sensor);
    sensor->bandwidth = circuit ? TIDES_BANDWIDTH_CIRCUIT : TIDES_BANDWIDTH_FIRST_ORDER;
    sensor->photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
    sensor->photoreceptor_cutoff_hz = 300;
    if (td_frontend_make(sensor, &frontend, &error) != TIDES_OK) fail_msg("%s", error.text);
    return frontend;
}

static void expect_bits(double a, double b) {
    if (memcmp(&a, &b, sizeof a) != 0) fail_msg("%.17g is not %.17g", a, b);
}

static void compare(const td_response *kept, const td_response *again, uint64_t *seed) {
    double low[2], high[2];
    td_response_range(kept, &low[0], &high[0]);
    td_response_range(again, &low[1], &high[1]);
    expect_bits(low[0], low[1]);
    expect_bits(high[0], high[1]);
    for (int i = 0; i < 12; i++) {
        const double s = scene_between(seed, 0, 1), from = scene_between(seed, 0, s);
        const double reference = scene_between(seed, low[0], high[0]), level = scene_between(seed, 0.001, 0.1);
        double at[2];
        expect_bits(td_response_value(kept, s), td_response_value(again, s));
        expect_bits(td_response_slope(kept, s), td_response_slope(again, s));
        assert_int_equal(td_response_crossing(kept, reference, level, level, from, s, &at[0]),
                         td_response_crossing(again, reference, level, level, from, s, &at[1]));
        expect_bits(at[0], at[1]);
    }
}

/* Steps from hardly any change to so many substeps that they don't fit. */
static void test_kept(void **state) {
    uint64_t seed = SEED;
    int fit = 0, many = 0, segments = 0;
    (void)state;
    for (int trial = 0; trial < 400; trial++) {
        tides_sensor sensor;
        const td_frontend frontend = make(trial % 2, &sensor);
        const double L = scene_between(&seed, -4, 0), change = pow(10, scene_between(&seed, -4, 0.5));
        const double h = pow(10, scene_between(&seed, -5, -1));
        td_model input;
        for (int k = 0; k < 4; k++) input.control[k] = fmax(L + change * scene_between(&seed, -1, 1), -4.6); /* above black */
        double memory[2][TD_FRONTEND_STATE];
        td_response response[2];
        td_kept_substeps kept;
        td_frontend_rest(&frontend, L, LOG_EPS, memory[0]);
        memcpy(memory[1], memory[0], sizeof memory[1]);
        td_frontend_step(&frontend, h, &input, LOG_EPS, memory[0], &response[0], &kept);
        td_frontend_step(&frontend, h, &input, LOG_EPS, memory[1], &response[1], NULL);
        assert_memory_equal(memory[0], memory[1], sizeof memory[0]);
        if (response[0].source.frontend) {
            fit += response[0].source.kept != NULL;
            many += response[0].source.kept == NULL;
            segments += response[0].source.segments > 1;
            assert_null(response[1].source.kept);
        }
        compare(&response[0], &response[1], &seed);
    }
    print_message("%d responses keep their substeps, %d have too many; %d have several segments\n", fit, many, segments);
    assert_true(fit > 100 && many > 10 && segments > 100);
}

static void test_tails(void **state) {
    uint64_t seed = SEED + 1;
    (void)state;
    for (int trial = 0; trial < 1000; trial++) {
        const double size = pow(10, scene_between(&seed, -3, 0)), turn = scene_between(&seed, -1.5, 1.5);
        const td_complex rate = {size * cos(turn), trial % 3 ? size * sin(turn) : 0};
        td_mode_places places;
        for (int i = 0; i < TD_MODE_PLACES; i++) places.s[i] = i == 0 ? 0 : scene_between(&seed, 0, 1);
        td_mode_tails_many(rate, &places);
        for (int i = 0; i < TD_MODE_PLACES; i++) {
            td_complex tail[5];
            td_mode_tails(rate, places.s[i], tail);
            assert_true(places.value_re[i] == tail[4].re && places.value_im[i] == tail[4].im);
            assert_true(places.slope_re[i] == tail[3].re && places.slope_im[i] == tail[3].im);
        }
    }
}

int main(void) {
    print_message("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kept), cmocka_unit_test(test_tails)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
