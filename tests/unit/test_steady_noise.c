/* References when a run with additive noise begins: a steady sensor at rest fires from its first moment as often as ten seconds
 * later. */
#include "sensor_rig.h"

#include <stdio.h>

static void still(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    (void)t;
    *S = -1;
    *S_dot = 0;
}

enum { TILES = 16 };

typedef struct kind {
    const char *what;
    double rms, cutoff, on, off, leak, shot, refractory;
    int32_t law;
} kind;

/* Events from the rig's time to `stop`, in steps of at most `step`. */
static double count_to(rig *r, double stop, double step) {
    td_work_clear(&r->work);
    while (r->now < stop - 1e-9) rig_step(r, r->now + step < stop ? r->now + step : stop);
    return (double)r->work.events.count;
}

/* Additive noise, whose events come in pairs: a count's variance is up to twice its mean. */
static void expect_same(const char *when, double found, double wanted) {
    printf("  %-9s %6.0f, wanted %8.1f, %+.2f sigma\n", when, found, wanted, (found - wanted) / sqrt(2 * wanted));
    assert_true(fabs(found - wanted) <= 3 * sqrt(2 * wanted));
}

static const kind noisy[] = {
    {"held", 0.05, 20, 0.2, 0.2, 0, 0, 1e-3, TIDES_REFRACTORY_HOLD},
    {"leak", 0.04, 20, 0.2, 0.2, 0.2, 0, 1e-4, TIDES_REFRACTORY_HOLD},
    {"unequal", 0.05, 20, 0.18, 0.2, 0.05, 0, 1e-4, TIDES_REFRACTORY_HOLD},
    {"shot, dropped", 0.03, 20, 0.2, 0.2, 0.1, 1, 1e-3, TIDES_REFRACTORY_DROP_KEEP},
    {"far levels", 0.03, 40, 0.2, 0.2, 0.1, 0, 1e-3, TIDES_REFRACTORY_HOLD},
};

static rig *rig_of(const kind *k, int tiles) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = k->on;
    sensor.threshold_off = k->off;
    sensor.threshold_sigma = 0.005;
    sensor.noise_rms = k->rms;
    sensor.noise_cutoff_hz = k->cutoff;
    sensor.leak_rate_hz = k->leak;
    sensor.shot_noise_hz = k->shot;
    sensor.refractory_s = k->refractory;
    sensor.refractory_law = k->law;
    sensor.initial = TIDES_INITIAL_STEADY;
    sensor.seed = 8102;
    printf("%s\n", k->what);
    return rig_make(&sensor, tiles, 3, still, NULL);
}

static void test_noisy(void **state) {
    (void)state;
    for (size_t c = 0; c < sizeof noisy / sizeof *noisy; c++) {
        rig *r = rig_of(&noisy[c], TILES);
        const double first = count_to(r, 3.01, 0.002), next = count_to(r, 3.11, 0.01);
        count_to(r, 12, 0.5);
        const double tenth = count_to(r, 13, 0.5);
        expect_same("10 ms", first, tenth / 100);
        expect_same("100 ms", next, tenth / 10);
        rig_free(r);
    }
}

/* Many events, so that a bias shows: pixels that fire more often than 50 times a second (light of some 20 lux), and levels that
 * the leak comes near to slowly. */
static const struct {
    kind kind;
    int tiles;
    double most; /* bias that passes */
} many[] = {
    {{"often", 0.065, 200, 0.223, 0.223, 0, 0.066, 7.9e-5, TIDES_REFRACTORY_HOLD}, 12, 0.05},
    {{"unequal", 0.05, 20, 0.18, 0.2, 0.05, 0, 1e-4, TIDES_REFRACTORY_HOLD}, 32, 0.05},
    {{"far levels", 0.03, 40, 0.2, 0.2, 0.1, 0, 1e-3, TIDES_REFRACTORY_HOLD}, 160, 0.1},
};

static void test_many(void **state) {
    (void)state;
    for (size_t c = 0; c < sizeof many / sizeof *many; c++) {
        rig *r = rig_of(&many[c].kind, many[c].tiles);
        const double first = count_to(r, 3.4, 0.1);
        count_to(r, 4, 0.5);
        const double wanted = 0.4 * count_to(r, 5, 0.5);
        const double sigma = sqrt(2 * wanted * 1.4) / wanted, bias = first / wanted - 1;
        printf("  400 ms: %6.0f, wanted %8.1f: %+.3f, %+.2f sigma\n", first, wanted, bias, bias / sigma);
        assert_true(fabs(bias) <= many[c].most);
        assert_true(sigma <= 0.5 * many[c].most);
        rig_free(r);
    }
}

/* References are the same to the bit however many threads share the pixels, and whichever pixels share a block. */
static void test_shared(void **state) {
    (void)state;
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.noise_rms = 0.05;
    sensor.noise_sigma = 0.1;
    sensor.noise_cutoff_hz = 20;
    sensor.refractory_s = 1e-3;
    sensor.initial = TIDES_INITIAL_STEADY;
    sensor.seed = 8103;
    rig *r = rig_make(&sensor, TILES + 1, 3, still, NULL), *few = rig_make(&sensor, 1, 3, still, NULL);
    double *reference = rig_alloc(2 * r->pixels, sizeof *reference), *since = reference + r->pixels;
    for (size_t i = 0; i < r->pixels; i++) {
        reference[i] = r->sensor.pixels.reference[i];
        since[i] = r->sensor.since[i];
        r->sensor.pixels.reference[i] = r->sensor.since[i] = NAN;
    }
    td_pool *pool = NULL;
    assert_int_equal(td_pool_create(3, &pool, NULL), TIDES_OK);
    td_sensor_begin(&r->sensor, r->plane[0], pool);
    for (size_t i = 0; i < r->pixels; i++) {
        assert_true(r->sensor.pixels.reference[i] == reference[i]);
        assert_true(r->sensor.since[i] == since[i]);
    }
    for (size_t i = 0; i < RIG_WIDTH; i++) assert_true(few->sensor.pixels.reference[i] == reference[i]);
    td_pool_release(pool);
    free(reference);
    rig_free(few);
    rig_free(r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_noisy), cmocka_unit_test(test_many),
                                       cmocka_unit_test(test_shared)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
