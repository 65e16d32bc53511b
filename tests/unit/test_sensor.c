/* The sensor's comparator against closed forms: leak, each refractory law, mask, catching up; every time to a nanosecond. */
#include "sensor_rig.h"

static tides_sensor sensor_of(double threshold) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = sensor.threshold_off = threshold;
    return sensor;
}

enum { EVENTS_MAX = 4096 };
static tides_event got[EVENTS_MAX];

/* Pixel (0, 0)'s events are at `expected` [s], each within a nanosecond, of that polarity and cause. */
static void expect_times(const rig *r, const double *expected, const int *polarity, size_t count, int cause) {
    size_t found = rig_events(r, 0, 0, got, EVENTS_MAX);
    for (size_t k = 0; k < found && k < count; k++) {
        if (!(fabs((double)got[k].t - expected[k] * 1e9) <= 1.001)) /* floored */
            fail_msg("event %zu is at %lld ns, not %.3f", k, (long long)got[k].t, expected[k] * 1e9);
        assert_int_equal(got[k].polarity, polarity ? polarity[k] : 1);
        if (cause >= 0) assert_int_equal(got[k].cause, cause);
    }
    if (found != count) fail_msg("%zu events, not %zu", found, count);
}

/* -- signals ------------------------------------------------------------------------------------------------------------- */

typedef struct line {
    double slope; /* [1/s] */
} line;

static void ramp(const void *user, int i, double t, double *S, double *S_dot) {
    (void)i;
    *S = ((const line *)user)->slope * t;
    *S_dot = ((const line *)user)->slope;
}

static const int lengths[] = {1, 7, 64, 1000}; /* steps of a run */
enum { LENGTHS = sizeof lengths / sizeof *lengths };

/* -- leak ---------------------------------------------------------------------------------------------------------------- */

/* A pixel at rest fires ON at n / rate, and every one is leak's. */
static void test_leak_at_rest(void **state) {
    (void)state;
    const line still = {0};
    tides_sensor sensor = sensor_of(0.2);
    sensor.leak_rate_hz = 37;
    double expected[40];
    for (int n = 0; n < 37; n++) expected[n] = 5 + (n + 1) / 37.0;
    for (int k = 0; k < LENGTHS; k++) {
        rig *r = rig_make(&sensor, 1, 5, ramp, &still);
        rig_run(r, 5 + 36.5 / 37, lengths[k]);
        expect_times(r, expected, NULL, 36, TIDES_CAUSE_LEAK);
        assert_true(r->work.counts.cause[TIDES_CAUSE_LEAK] == r->work.events.count);
        rig_free(r);
    }
}

/* Against a falling signal: OFF events come late by the leak, ON events where it wins; far on in time. */
static void test_leak_on_a_ramp(void **state) {
    (void)state;
    static const struct {
        double slope, leak;
        int cause;
    } cases[] = {{-9, 10, TIDES_CAUSE_SIGNAL},
                 {-1, 20, TIDES_CAUSE_LEAK},
                 {9, 5, TIDES_CAUSE_SIGNAL},
                 {3, 20, TIDES_CAUSE_LEAK}};
    const double start = 1000;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
        for (int k = 0; k < LENGTHS; k++) {
            const line falling = {cases[c].slope};
            tides_sensor sensor = sensor_of(0.2);
            sensor.leak_rate_hz = cases[c].leak;
            sensor.max_events_per_step = 1000;
            double total = cases[c].slope + 0.2 * cases[c].leak, expected[64];
            int polarity[64], count = 20;
            for (int n = 0; n < count; n++) {
                expected[n] = start + (n + 1) * 0.2 / fabs(total);
                polarity[n] = total > 0 ? 1 : -1;
            }
            rig *r = rig_make(&sensor, 1, start, ramp, &falling);
            rig_run(r, start + 20.5 * 0.2 / fabs(total), lengths[k]);
            expect_times(r, expected, polarity, (size_t)count, cases[c].cause);
            rig_free(r);
        }
}

/* -- refractory ----------------------------------------------------------------------------------------------------------- */

/* On a ramp. HOLD: every (C / slope + T). DROP_KEEP: first at C / slope, then as often as the period lets it, or the ramp where
 * that is slower. DROP_CONSUME: the ramp's events less those within T of one that fired. */
static void ramp_expected(int law, double threshold, double slope, double T, double *expected, size_t count) {
    double time = threshold / slope, interval = threshold / slope;
    for (size_t n = 0; n < count; n++) {
        expected[n] = time;
        if (law == TIDES_REFRACTORY_HOLD) time += T + interval;
        if (law == TIDES_REFRACTORY_DROP_KEEP) time = fmax(time + T, interval * (double)(n + 2));
        if (law == TIDES_REFRACTORY_DROP_CONSUME) time += interval * ceil(T / interval);
    }
}

static void test_refractory_on_a_ramp(void **state) {
    (void)state;
    static const double periods[] = {3.3e-3, 26.7e-3, 71e-3}; /* shorter and longer than C / slope = 20 ms, than steps */
    const line rising = {10};
    for (int law = TIDES_REFRACTORY_HOLD; law <= TIDES_REFRACTORY_DROP_CONSUME; law++)
        for (size_t p = 0; p < sizeof periods / sizeof *periods; p++)
            for (int k = 0; k < LENGTHS; k++) {
                tides_sensor sensor = sensor_of(0.2);
                sensor.refractory_s = periods[p];
                sensor.refractory_law = law;
                double expected[64];
                size_t count = 0;
                ramp_expected(law, 0.2, 10, periods[p], expected, 64);
                while (count < 64 && expected[count] < 0.9876) count++;
                rig *r = rig_make(&sensor, 1, 0, ramp, &rising);
                rig_run(r, 0.9876, lengths[k]);
                expect_times(r, expected, NULL, count, TIDES_CAUSE_SIGNAL);
                rig_free(r);
            }
}

/* A square pulse, as steep as the steps: consumed crossings are gone, kept ones fire later, held ones never. */
typedef struct pulse {
    double up, down, edge, height;
} pulse;

static void square(const void *user, int i, double t, double *S, double *S_dot) {
    const pulse *p = user;
    (void)i;
    double rise = fmin(fmax((t - p->up) / p->edge, 0), 1), fall = fmin(fmax((t - p->down) / p->edge, 0), 1);
    *S = p->height * (rise - fall);
    *S_dot = 0; /* steps end where the slope jumps; the ends' rates are set by the tests' steps */
}

static void test_refractory_at_an_edge(void **state) {
    (void)state;
    const pulse p = {0.1, 0.5, 0.01, 0.7}; /* 3.5 thresholds up within a period, and down again */
    static const size_t counts[] = {2, 8, 2};
    for (int law = TIDES_REFRACTORY_HOLD; law <= TIDES_REFRACTORY_DROP_CONSUME; law++) {
        tides_sensor sensor = sensor_of(0.2);
        sensor.refractory_s = 0.02;
        sensor.refractory_law = law;
        rig *r = rig_make(&sensor, 1, 0, square, &p);
        const double ends[] = {0.1, 0.11, 0.3, 0.5, 0.51, 1};
        for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) rig_step(r, ends[k]);
        size_t found = rig_events(r, 0, 0, got, EVENTS_MAX);
        printf("law %d: %zu events\n", law, found);
        if (law == TIDES_REFRACTORY_HOLD) { /* one up and one down, from the new reference */
            assert_int_equal(found, counts[0]);
            assert_int_equal(got[1].polarity, -1);
            assert_true(r->work.counts.refractory == 0);
        } else if (law == TIDES_REFRACTORY_DROP_KEEP) { /* 3 up, 20 ms apart; down to 0.1 below the first level: 3 */
            assert_int_equal(found, 6);
            for (size_t n = 1; n < 3; n++) assert_true(llabs(got[n].t - got[n - 1].t - 20000000) <= 1);
        } else { /* the first of each side; the others are counted */
            assert_int_equal(found, counts[2]);
            assert_true(r->work.counts.refractory / RIG_PIXELS == 4);
        }
        rig_free(r);
    }
}

/* -- sinusoids through leak ------------------------------------------------------------------------------------------------ */

static const double amplitude = 0.5, omega = 40;

static void sinusoid(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    *S = amplitude * sin(omega * t);
    *S_dot = amplitude * omega * cos(omega * t);
}

/* The comparator's rule on the exact signal, by bisection of a fine grid. */
static size_t exact_crossings(double leak, double threshold, double stop, double *times, int *polarity) {
    double reference = 0, dt = 1e-6;
    size_t count = 0;
    for (double t = 0; t < stop; t += dt) {
        double end = amplitude * sin(omega * (t + dt)) + leak * (t + dt) - reference;
        int sign = end >= threshold ? 1 : end <= -threshold ? -1 : 0;
        if (!sign) continue;
        double low = t, high = t + dt;
        for (int i = 0; i < 60; i++) {
            double middle = 0.5 * (low + high), at = amplitude * sin(omega * middle) + leak * middle - reference;
            *(sign * at >= threshold ? &high : &low) = middle;
        }
        times[count] = high;
        polarity[count++] = sign;
        reference += sign * threshold;
    }
    return count;
}

static void test_leak_under_a_sinusoid(void **state) {
    (void)state;
    double expected[256];
    int polarity[256];
    tides_sensor sensor = sensor_of(0.15);
    sensor.leak_rate_hz = 8;
    size_t count = exact_crossings(8 * 0.15, 0.15, 0.5, expected, polarity);
    assert_true(count > 20);
    rig *r = rig_make(&sensor, 1, 0, sinusoid, NULL);
    rig_run(r, 0.5, 8000); /* the cubic's own error is then far below a nanosecond's worth */
    expect_times(r, expected, polarity, count, -1);
    rig_free(r);
}

/* -- behind a low-pass --------------------------------------------------------------------------------------------------- */

/* A ramp that begins at rest comes out as slope (t - tau (1 - e^(-t / tau))), and the leak's ramp on top of it. */
static double filtered_ramp(double slope, double tau, double leak, double t) {
    return slope * (t + tau * expm1(-t / tau)) + leak * t;
}

static void test_ramp_through_a_low_pass(void **state) {
    (void)state;
    const line rising = {10};
    const double tau = 1 / (2 * acos(-1) * 20), leak = 0.2 * 3, period = 2.3e-3;
    tides_sensor sensor = sensor_of(0.2);
    sensor.photoreceptor_cutoff_hz = 20;
    sensor.leak_rate_hz = 3;
    sensor.refractory_s = period;
    double expected[64], reference = 0, from = 0;
    size_t count = 0;
    while (from < 0.6) { /* HOLD: the next level is a threshold above where S_eff is at the end of the period */
        double low = from, high = 1;
        for (int i = 0; i < 80; i++) {
            double middle = 0.5 * (low + high);
            *(filtered_ramp(10, tau, leak, middle) >= reference + 0.2 ? &high : &low) = middle;
        }
        expected[count++] = high;
        from = high + period;
        reference = filtered_ramp(10, tau, leak, from);
    }
    for (int k = 0; k < LENGTHS; k++) {
        rig *r = rig_make(&sensor, 1, 0, ramp, &rising);
        rig_run(r, 0.5 * (expected[count - 2] + expected[count - 1]), lengths[k]);
        expect_times(r, expected, NULL, count - 1, TIDES_CAUSE_SIGNAL);
        rig_free(r);
    }
}

/* -- mask ---------------------------------------------------------------------------------------------------------------- */

/* Dark from 0.3 s to 0.6 s, when coverage passes 0.5 on a straight line between samples at multiples of 0.1 s. */
static double blink(const void *user, int i, double t) {
    (void)user;
    (void)i;
    return t < 0.25 || t > 0.65 ? 1 : t < 0.35 || t > 0.55 ? 0.5 : 0;
}

/* What a ramp piles up in the dark fires at the moment of light; then it goes on as if nothing had been. */
static void test_mask_defers(void **state) {
    (void)state;
    const line rising = {2};
    tides_sensor sensor = sensor_of(0.2);
    sensor.b_min = 0.5;
    rig *r = rig_make(&sensor, 1, 0, ramp, &rising);
    r->coverage = blink;
    rig_run(r, 1.05, 1);
    rig_free(r);
    r = rig_make(&sensor, 1, 0, ramp, &rising);
    r->coverage = blink;
    for (int k = 1; k <= 10; k++) rig_step(r, 0.1 * k + 1e-12);
    static const double expected[] = {0.1, 0.2, 0.3, 0.6, 0.6, 0.6, 0.7, 0.8, 0.9, 1.0};
    expect_times(r, expected, NULL, 10, TIDES_CAUSE_SIGNAL);
    assert_true(r->work.counts.suppressed / RIG_PIXELS == 2 || r->work.counts.suppressed / RIG_PIXELS == 3);
    rig_free(r);
}

/* -- what is cut off, and what is off -------------------------------------------------------------------------------------- */

static void test_truncated(void **state) {
    (void)state;
    const line rising = {10};
    tides_sensor sensor = sensor_of(0.2);
    sensor.threshold_sigma = 1e-9; /* on, and hardly anything */
    sensor.max_events_per_step = 3;
    rig *r = rig_make(&sensor, 1, 0, ramp, &rising);
    rig_run(r, 0.1000001, 1);
    assert_int_equal(rig_events(r, 0, 0, got, EVENTS_MAX), 5);
    assert_true(got[4].t == 100000 * 1000 + 100 - 1);
    assert_true(got[3].t == got[4].t);
    assert_true(r->work.counts.truncated == 2 * RIG_PIXELS);
    assert_true(r->work.counts.caught_up == 0);
    rig_free(r);
    sensor.refractory_s = 1e-3; /* the end fires one event only */
    sensor.refractory_law = TIDES_REFRACTORY_DROP_KEEP;
    r = rig_make(&sensor, 1, 0, ramp, &rising);
    rig_run(r, 0.1000001, 1);
    assert_int_equal(rig_events(r, 0, 0, got, EVENTS_MAX), 4);
    rig_free(r);
}

/* NaN silences a pixel; what it missed fires when it is back. */
static void gap(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    *S = i == 0 && t > 0.15 && t < 0.25 ? NAN : 3 * t;
    *S_dot = 3;
}

static void test_nan(void **state) {
    (void)state;
    tides_sensor sensor = sensor_of(0.2);
    sensor.refractory_s = 1e-6;
    sensor.shot_noise_hz = 100;
    rig *r = rig_make(&sensor, 1, 0, gap, NULL);
    rig_run(r, 0.4, 4);
    assert_true(r->work.counts.nonfinite == 2);
    for (size_t k = 0; k < r->work.events.count; k++)
        assert_true(r->work.events.events[k].t >= 0 && r->work.events.events[k].t < 400000000);
    for (size_t i = 0; i < r->pixels; i++) assert_true(isfinite(r->sensor.pixels.reference[i]));
    rig_free(r);
}

static void test_refused(void **state) {
    (void)state;
    tides_sensor sensor = sensor_of(0.2);
    tides_error error;
    struct {
        double *field;
        double value;
        const char *name;
    } cases[] = {{&sensor.threshold_sigma, -1, "threshold_sigma"},   {&sensor.refractory_s, NAN, "refractory_s"},
                 {&sensor.leak_rate_hz, 1e7, "leak_rate_hz"},        {&sensor.b_min, 1.5, "b_min"},
                 {&sensor.shot_noise_hz, INFINITY, "shot_noise_hz"}, {&sensor.dead_pixel_fraction, 2, "dead_pixel_fraction"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double before = *cases[k].field;
        *cases[k].field = cases[k].value;
        assert_int_equal(td_sensor_check(&sensor, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, cases[k].name));
        *cases[k].field = before;
    }
    assert_int_equal(td_sensor_check(&sensor, &error), TIDES_OK);
    sensor.refractory_law = 3;
    assert_int_equal(td_sensor_check(&sensor, &error), TIDES_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_leak_at_rest),
        cmocka_unit_test(test_leak_on_a_ramp),
        cmocka_unit_test(test_refractory_on_a_ramp),
        cmocka_unit_test(test_refractory_at_an_edge),
        cmocka_unit_test(test_leak_under_a_sinusoid),
        cmocka_unit_test(test_mask_defers),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_nan),
        cmocka_unit_test(test_ramp_through_a_low_pass),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
