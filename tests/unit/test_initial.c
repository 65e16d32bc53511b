/* Where references are when a run begins: at rest a steady sensor fires from its first moment as often as ten seconds later,
 * whatever resets its pixels, and with the causes that it has later; a random one is anywhere between its levels. */
#include "sensor_rig.h"
#include "sensor/td_between.h"

#include <stdio.h>

static void still(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    (void)t;
    *S = -1;
    *S_dot = 0;
}

enum { TILES = 60 };

typedef struct window {
    double events, leaks;
} window;

/* Events from the rig's time to `stop`, in steps of at most `step`. */
static window count_to(rig *r, double stop, double step) {
    td_work_clear(&r->work);
    while (r->now < stop - 1e-9) rig_step(r, r->now + step < stop ? r->now + step : stop);
    window w = {(double)r->work.events.count, (double)r->work.counts.cause[TIDES_CAUSE_LEAK]};
    return w;
}

static void expect_same(const char *what, const char *when, double found, double expected) {
    const double error = sqrt(expected);
    printf("%-24s %-9s %7.0f, wanted %8.1f, %+.2f sigma\n", what, when, found, expected, (found - expected) / error);
    assert_true(fabs(found - expected) <= 3 * error);
}

static const struct {
    const char *what;
    double leak, leak_sigma, shot, hot, refractory;
    int32_t law;
} cases[] = {
    {"leak", 2, 0, 0, 0, 0, TIDES_REFRACTORY_HOLD},
    {"leak that differs", 2, 0.5, 0, 0, 0, TIDES_REFRACTORY_HOLD},
    {"leak and shot", 2, 0.1, 5, 0, 0, TIDES_REFRACTORY_HOLD},
    {"leak, shot, hot", 1, 0.3, 2, 30, 0.001, TIDES_REFRACTORY_HOLD},
    {"held", 4, 0.2, 3, 0, 0.2, TIDES_REFRACTORY_HOLD},
    {"dropped, kept", 3, 0, 6, 0, 0.1, TIDES_REFRACTORY_DROP_KEEP},
    {"dropped, consumed", 3, 0, 6, 0, 0.1, TIDES_REFRACTORY_DROP_CONSUME},
    {"shot alone", 0, 0, 8, 0, 0.05, TIDES_REFRACTORY_HOLD},
};

static rig *make(size_t c, int32_t initial) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_sigma = 0.03;
    sensor.threshold_min = 0.05;
    sensor.leak_rate_hz = cases[c].leak;
    sensor.leak_sigma = cases[c].leak_sigma;
    sensor.shot_noise_hz = cases[c].shot;
    sensor.hot_pixel_fraction = cases[c].hot > 0 ? 0.05 : 0;
    sensor.hot_pixel_rate_hz = cases[c].hot;
    sensor.refractory_s = cases[c].refractory;
    sensor.refractory_law = cases[c].law;
    sensor.initial = initial;
    sensor.seed = 8101;
    return rig_make(&sensor, TILES, 3, still, NULL);
}

static void test_steady(void **state) {
    (void)state;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        rig *r = make(c, TIDES_INITIAL_STEADY);
        const window first = count_to(r, 3.01, 0.002), next = count_to(r, 3.11, 0.01);
        count_to(r, 12, 0.05);
        const window tenth = count_to(r, 13, 0.05);
        expect_same(cases[c].what, "10 ms", first.events, tenth.events / 100);
        expect_same(cases[c].what, "100 ms", next.events, tenth.events / 10);
        if (cases[c].leak > 0) expect_same("", "leak", first.leaks + next.leaks, 0.11 * tenth.leaks);
        rig_free(r);
        r = make(c, TIDES_INITIAL_REST); /* the same test says no where leaks begin in phase */
        const window phased = count_to(r, 3.01, 0.002);
        if (c == 0) assert_int_equal(phased.events, 0);
        rig_free(r);
    }
}

static void test_random(void **state) {
    (void)state;
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = 0.4;
    sensor.initial = TIDES_INITIAL_RANDOM;
    for (int with = 0; with < 2; with++) {
        sensor.threshold_sigma = with ? 0.02 : 0;
        rig *r = rig_make(&sensor, TILES, 0, still, NULL);
        double sum = 0, square = 0;
        for (size_t i = 0; i < r->pixels; i++) {
            const double on = td_sensor_threshold_on(&r->sensor, i), off = td_sensor_threshold_off(&r->sensor, i);
            const double share = (-1 - r->sensor.pixels.reference[i] + off) / (on + off);
            assert_true(share > 0 && share < 1);
            sum += share;
            square += share * share;
        }
        const double n = (double)r->pixels, mean = sum / n;
        assert_true(fabs(mean - 0.5) < 4 * sqrt(1 / (12 * n)));
        assert_true(fabs(square / n - 1.0 / 3) < 4 * sqrt(4.0 / 45 / n));
        assert_int_equal(count_to(r, 1, 0.1).events, 0);
        rig_free(r);
    }
}

static void test_refused(void **state) {
    (void)state;
    tides_sensor sensor;
    td_sensor made;
    tides_error error = {TIDES_OK, ""};
    const td_tile tile = {0, 0, 16, 256};
    tides_sensor_defaults(&sensor);
    sensor.initial = 3;
    assert_int_equal(td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, 16}, &made,
                                      &error),
                     TIDES_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steady), cmocka_unit_test(test_random),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
