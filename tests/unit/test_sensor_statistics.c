/* Random values of the sensor, on 10^5 draws or more: rates, their law, Poisson intervals, mismatch, spreads, fractions; each
 * within 3 standard errors. They depend only on the seed and the pixel. */
#include "sensor_rig.h"
#include "signal/td_event_sort.h"
#include "td_sort.h"

static const uint64_t SEED = 31337;

static tides_sensor quiet(void) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.seed = SEED;
    return sensor;
}

/* Prints what was found, and fails beyond 3 standard errors. */
static void expect_near(const char *name, double found, double expected, double standard_error) {
    printf("%-28s %.6g, asked %.6g, %+.2f standard errors\n", name, found, expected, (found - expected) / standard_error);
    assert_true(fabs(found - expected) <= 3 * standard_error);
}

/* -- shot noise ---------------------------------------------------------------------------------------------------------- */

enum { LEVELS = 4, TILES = 16 };
static const double luminance[LEVELS] = {0, 0.1, 0.5, 2}; /* the last one beyond DN 255 */

static void levels(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)t;
    *S = log(luminance[i % LEVELS] + 1e-3);
    *S_dot = 0;
}

static void test_shot_rate_and_law(void **state) {
    (void)state;
    const double asked = 80, duration = 2;
    tides_sensor sensor = quiet();
    sensor.shot_noise_hz = asked;
    rig *r = rig_make(&sensor, TILES, 3, levels, NULL);
    rig_run(r, 3 + duration, 5);
    double found[LEVELS][2] = {{0}};
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        assert_int_equal(e->cause, TIDES_CAUSE_SHOT);
        found[e->x % LEVELS][e->polarity > 0]++;
    }
    printf("seed %llu, %zu events\n", (unsigned long long)SEED, r->work.events.count);
    assert_true(r->work.events.count > 100000);
    for (int l = 0; l < LEVELS; l++)
        for (int p = 0; p < 2; p++) {
            double dn = fmin(255 * luminance[l], 255), rate = asked / 2 * (1 - 0.75 * (dn + 20) / 275) / (1 - 0.75 * 20 / 275);
            double expected = rate * duration * TILES * RIG_PIXELS / LEVELS;
            expect_near(p ? "ON events" : "OFF events", found[l][p], expected, sqrt(expected));
        }
    rig_free(r);
}

/* Kolmogorov and Smirnov's distance from the exponential, times the root of the count that makes its law the limit one:
 * p > 0.01 below 1.628. */
static double exponential_distance(double *gaps, size_t count, double mean) {
    qsort(gaps, count, sizeof *gaps, td_ascending);
    double worst = 0;
    for (size_t i = 0; i < count; i++) {
        double cumulative = 1 - exp(-gaps[i] / mean);
        worst = fmax(worst, fmax(cumulative - (double)i / (double)count, (double)(i + 1) / (double)count - cumulative));
    }
    double root = sqrt((double)count);
    return worst * (root + 0.12 + 0.11 / root);
}

/* Pixels laid end to end: what is left of one's last interval and the next one's first make an interval of the same law. */
static size_t intervals(const rig *r, int polarity, double duration, double *gaps) {
    size_t count = 0;
    double last = 0;
    for (int pixel = 0; pixel < RIG_PIXELS; pixel++)
        for (size_t k = 0; k < r->work.events.count; k++) {
            const tides_event *e = &r->work.events.events[k];
            if (e->y * RIG_WIDTH + e->x != pixel || e->polarity != polarity) continue;
            double at = pixel * duration + (double)e->t * 1e-9;
            gaps[count++] = at - last;
            last = at;
        }
    return count;
}

static void dark(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    (void)t;
    *S = log(1e-3);
    *S_dot = 0;
}

static void test_shot_intervals(void **state) {
    (void)state;
    const double asked = 2000, rate = asked / 2, duration = 0.5;
    tides_sensor sensor = quiet();
    sensor.shot_noise_hz = asked;
    rig *r = rig_make(&sensor, 1, 0, dark, NULL);
    rig_run(r, duration, 3);
    double *gaps = rig_alloc(r->work.events.count, sizeof *gaps);
    for (int polarity = -1; polarity <= 1; polarity += 2) {
        size_t count = intervals(r, polarity, duration, gaps);
        double distance = exponential_distance(gaps, count, 1 / rate);
        printf("%zu intervals: Kolmogorov-Smirnov %.3f (1.628 is p = 0.01)\n", count, distance);
        assert_true(count > 100000);
        assert_true(distance < 1.628);
    }
    free(gaps);
    rig_free(r);
}

static void rest(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    (void)t;
    *S = -1;
    *S_dot = 0;
}

/* Leak events of pixels at rest, whatever their own thresholds: leak_rate_hz each; with a spread of leak_sigma decades that is
 * the median, and the mean is e^((leak_sigma ln 10)^2 / 2) times as much. */
static void test_leak_rate(void **state) {
    (void)state;
    const double asked = 40, duration = 5.0125, decades = 0.2, spread = decades * log(10);
    for (int spreads = 0; spreads < 2; spreads++) {
        tides_sensor sensor = quiet();
        sensor.threshold_sigma = 0.03;
        sensor.leak_rate_hz = asked;
        sensor.leak_sigma = spreads ? decades : 0;
        rig *r = rig_make(&sensor, TILES, 0, rest, NULL);
        rig_run(r, duration, 20);
        double pixels = TILES * RIG_PIXELS, mean = asked * (spreads ? exp(0.5 * spread * spread) : 1);
        double error = spreads ? mean * sqrt(expm1(spread * spread) / pixels) : 0;
        /* A pixel's last interval is cut off: half an event on average, none to one; without a spread, 200.5 is cut to 200. */
        double found = ((double)r->work.events.count + 0.5 * pixels) / (pixels * duration);
        expect_near("leak events [Hz]", found, mean, error + 1 / (duration * sqrt(12 * pixels)));
        rig_free(r);
    }
}

static void climb(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    *S = 40 * t;
    *S_dot = 40;
}

/* Rates of a signal that would fire 200 times a second: HOLD adds the refractory period to each interval, DROP_KEEP fires at
 * its end, DROP_CONSUME at the first crossing behind it. */
static void test_refractory_rates(void **state) {
    (void)state;
    const double interval[] = {0.005 + 0.0075, 0.0075, 0.010};
    for (int law = TIDES_REFRACTORY_HOLD; law <= TIDES_REFRACTORY_DROP_CONSUME; law++) {
        tides_sensor sensor = quiet();
        sensor.refractory_s = 0.0075;
        sensor.refractory_law = law;
        rig *r = rig_make(&sensor, 1, 0, climb, NULL);
        tides_event events[400];
        rig_run(r, 1, 37);
        size_t count = rig_events(r, 3, 3, events, 400);
        assert_true(count > 70);
        for (size_t k = 1; k < count; k++)
            assert_true(fabs(1e-9 * (double)(events[k].t - events[k - 1].t) - interval[law]) < 3e-9);
        rig_free(r);
    }
}

/* The same events whatever the steps. */
static void test_noise_at_any_step(void **state) {
    (void)state;
    static const int counts[] = {1, 3, 50, 777};
    tides_sensor sensor = quiet();
    sensor.shot_noise_hz = 300;
    sensor.hot_pixel_fraction = 0.1;
    sensor.refractory_s = 1e-3;
    rig *first = NULL;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        rig *r = rig_make(&sensor, 2, 17.123456789, levels, NULL);
        rig_run(r, 17.5, counts[k]);
        tides_event *scratch = rig_alloc(r->work.events.count, sizeof *scratch);
        td_event_sort(r->work.events.events, scratch, r->work.events.count);
        free(scratch);
        if (first) {
            assert_int_equal(r->work.events.count, first->work.events.count);
            assert_memory_equal(r->work.events.events, first->work.events.events, r->work.events.count * sizeof(tides_event));
            rig_free(r);
        } else {
            first = r;
            assert_true(r->work.events.count > 10000);
            assert_true(r->work.counts.cause[TIDES_CAUSE_HOT] > 1000);
        }
    }
    rig_free(first);
}

/* -- drawn once ---------------------------------------------------------------------------------------------------------- */

enum { MANY = 512, DRAWS = MANY * RIG_PIXELS };

static void check_normal(const char *name, const double *x, double mean, double sigma) {
    double sum = 0, squares = 0;
    char label[64];
    for (int i = 0; i < DRAWS; i++) sum += x[i];
    for (int i = 0; i < DRAWS; i++) squares += (x[i] - mean) * (x[i] - mean);
    snprintf(label, sizeof label, "%s: mean", name);
    expect_near(label, sum / DRAWS, mean, sigma / sqrt(DRAWS));
    snprintf(label, sizeof label, "%s: sigma", name);
    expect_near(label, sqrt(squares / DRAWS), sigma, sigma / sqrt(2.0 * DRAWS));
}

static void test_mismatch_and_leak(void **state) {
    (void)state;
    tides_sensor sensor = quiet();
    sensor.threshold_on = 0.3;
    sensor.threshold_off = 0.25;
    sensor.threshold_sigma = 0.03;
    sensor.leak_rate_hz = 0.5;
    sensor.leak_sigma = 0.2;
    rig *r = rig_make(&sensor, MANY, 0, dark, NULL);
    check_normal("threshold_on", r->sensor.threshold_on, 0.3, 0.03);
    check_normal("threshold_off", r->sensor.threshold_off, 0.25, 0.03);
    double product = 0, *decades = rig_alloc(DRAWS, sizeof *decades);
    for (int i = 0; i < DRAWS; i++) {
        product += (r->sensor.threshold_on[i] - 0.3) * (r->sensor.threshold_off[i] - 0.25) / (0.03 * 0.03);
        decades[i] = log10(r->sensor.leak[i] * 1e9 / (0.5 * r->sensor.threshold_on[i]));
    }
    expect_near("correlation of both", product / DRAWS, 0, 1 / sqrt(DRAWS));
    check_normal("leak [decades]", decades, 0, 0.2);
    free(decades);
    rig_free(r);
    sensor.threshold_sigma = 0.3;
    sensor.threshold_min = 0.1;
    r = rig_make(&sensor, 8, 0, dark, NULL);
    int at_least = 0;
    for (size_t i = 0; i < r->pixels; i++) {
        assert_true(r->sensor.threshold_on[i] >= 0.1);
        assert_true(r->sensor.threshold_off[i] >= 0.1);
        at_least += r->sensor.threshold_on[i] == 0.1;
    }
    assert_true(at_least > 100);
    rig_free(r);
}

static void shake(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    *S = 10 * t;
    *S_dot = 10;
}

static void test_hot_and_dead(void **state) {
    (void)state;
    tides_sensor sensor = quiet();
    sensor.hot_pixel_fraction = 0.02;
    sensor.hot_pixel_rate_hz = 50;
    rig *r = rig_make(&sensor, MANY, 0, dark, NULL);
    double hot = 0, events;
    for (size_t i = 0; i < r->pixels; i++) hot += isfinite(r->sensor.noise.due[TD_NOISE_HOT][i]) ? 1 : 0;
    expect_near("hot pixels", hot, 0.02 * DRAWS, sqrt(0.02 * 0.98 * DRAWS));
    rig_run(r, 1, 2);
    events = (double)r->work.events.count;
    expect_near("their events", events, 50 * hot, sqrt(50 * hot));
    for (size_t k = 0; k < r->work.events.count; k++)
        assert_true(r->work.events.events[k].polarity == 1 && r->work.events.events[k].cause == TIDES_CAUSE_HOT);
    rig_free(r);
    sensor = quiet();
    sensor.dead_pixel_fraction = 0.1;
    sensor.shot_noise_hz = 1000;
    sensor.leak_rate_hz = 10;
    r = rig_make(&sensor, MANY, 0, shake, NULL);
    rig_run(r, 0.05, 1);
    double silent = DRAWS;
    unsigned char *fired = rig_alloc(r->pixels, 1);
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        size_t i = (size_t)e->x / RIG_WIDTH * RIG_PIXELS + (size_t)e->y * RIG_WIDTH + (size_t)e->x % RIG_WIDTH;
        silent -= !fired[i];
        fired[i] = 1;
    }
    expect_near("dead pixels", silent, 0.1 * DRAWS, sqrt(0.1 * 0.9 * DRAWS));
    free(fired);
    rig_free(r);
}

/* However the image is cut into tiles, a pixel is the same; another seed makes others. */
static void test_pixels_are_the_image_s(void **state) {
    (void)state;
    tides_sensor sensor = quiet();
    sensor.threshold_sigma = 0.02;
    sensor.leak_rate_hz = sensor.leak_sigma = 0.1;
    sensor.shot_noise_hz = 3;
    const td_tile wide[1] = {{0, 0, 32, 32 * 16}};
    td_tile small[8];
    for (int t = 0; t < 8; t++) small[t] = (td_tile){t % 4 * 8, t / 4 * 8, 8, 64};
    td_sensor a, b, c;
    assert_int_equal(td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){wide, 1, 32}, &a, NULL),
                     TIDES_OK);
    assert_int_equal(td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){small, 8, 32}, &b, NULL),
                     TIDES_OK);
    sensor.seed++;
    assert_int_equal(td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){wide, 1, 32}, &c, NULL),
                     TIDES_OK);
    for (int t = 0; t < 8; t++)
        for (int i = 0; i < 64; i++) {
            int from = (small[t].y0 + i / 8) * 32 + small[t].x0 + i % 8, to = 64 * t + i;
            assert_true(a.threshold_on[from] == b.threshold_on[to]);
            assert_true(a.threshold_off[from] == b.threshold_off[to]);
            assert_true(a.leak[from] == b.leak[to]);
            assert_true(a.wake[from] == b.wake[to]);
            assert_true(a.threshold_on[from] != c.threshold_on[from]);
            assert_true(a.wake[from] != c.wake[from]);
        }
    td_sensor_release(&a);
    td_sensor_release(&b);
    td_sensor_release(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shot_rate_and_law), cmocka_unit_test(test_shot_intervals),
        cmocka_unit_test(test_leak_rate),         cmocka_unit_test(test_refractory_rates),
        cmocka_unit_test(test_noise_at_any_step), cmocka_unit_test(test_mismatch_and_leak),
        cmocka_unit_test(test_hot_and_dead),      cmocka_unit_test(test_pixels_are_the_image_s),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
