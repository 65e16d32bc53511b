/* Pixels that are passed over because their additive noise is found quiet: the same events and states, to the bit, as where
 * every pixel is walked through, and far fewer walks. */
#include "sensor_rig.h"

#include <stdio.h>

static const double two_pi = 6.283185307179586;

/* Waves of all heights and places from pixel to pixel. */
static void waves(const void *user, int i, double t, double *S, double *S_dot) {
    const double size = 0.004 * (i % 113), turn = two_pi * 12, at = 0.37 * i;
    (void)user;
    *S = -1 + size * sin(turn * t + at);
    *S_dot = turn * size * cos(turn * t + at);
}

typedef struct world {
    const char *what;
    double rms, cutoff, spread, photoreceptor, on, refractory, kick;
    int light;
} world;

static const world worlds[] = {
    {"fast", 0.03, 2000, 0, 0, 0.2, 0, 0, 0},
    {"slow", 0.04, 20, 0, 0, 0.2, 1e-3, 0, 0},
    {"deep trees", 0.15, 200, 0, 0, 0.12, 0, 0, 0},
    {"sizes", 0.03, 60, 0.15, 0, 0.2, 1e-4, 0, 0},
    {"filtered", 0.04, 300, 0, 80, 0.2, 1e-4, 0, 0},
    {"kicked", 0.04, 100, 0, 0, 0.2, 0, 0.03, 0},
    {"photocurrent", 0.02, 0, 0.04, 60, 0.2, 1e-4, 0, 1},
};

static rig *make(const world *w, int exhaustive) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.seed = 7301;
    sensor.threshold_on = w->on;
    sensor.threshold_off = 1.1 * w->on;
    sensor.threshold_sigma = 0.01;
    sensor.leak_rate_hz = 0.3;
    sensor.shot_noise_hz = 2;
    sensor.noise_rms = w->rms;
    if (w->cutoff > 0) sensor.noise_cutoff_hz = w->cutoff;
    sensor.noise_sigma = w->spread;
    sensor.photoreceptor_cutoff_hz = w->photoreceptor;
    sensor.refractory_s = w->refractory;
    sensor.kick = w->kick;
    sensor.kick_rate_hz = 40;
    sensor.kick_recovery_s = 0.01;
    sensor.max_events_per_step = 1 << 20;
    if (w->light) {
        sensor.noise_law = TIDES_NOISE_PHOTOCURRENT;
        sensor.circuit.photocurrent_a = 2e-14;
        sensor.circuit.dark_current_a = 5e-16;
    }
    rig *r = rig_make(&sensor, 2, 0, waves, NULL);
    r->sensor.exhaustive = exhaustive;
    return r;
}

/* Steps of changing length; `resumes`: what follows from the state is computed anew between them. */
static void run(rig *r, int resumes) {
    for (int n = 0; r->now < 0.25; n++) {
        rig_step(r, r->now + 1e-3 * (0.1 + 0.4 * (n % 5)));
        if (resumes && n % 3 == 0) td_sensor_resume(&r->sensor);
    }
}

static void expect_same(const rig *a, const rig *b) {
    assert_int_equal(a->work.events.count, b->work.events.count);
    assert_memory_equal(a->work.events.events, b->work.events.events, a->work.events.count * sizeof(tides_event));
    assert_memory_equal(a->sensor.pixels.reference, b->sensor.pixels.reference, a->pixels * sizeof(double));
}

static void test_same(void **state) {
    (void)state;
    for (size_t c = 0; c < sizeof worlds / sizeof *worlds; c++) {
        rig *all = make(&worlds[c], 1), *some = make(&worlds[c], 0), *resumed = make(&worlds[c], 0);
        run(all, 0);
        run(some, 0);
        run(resumed, 1);
        const double share = (double)some->work.counts.solved / (double)all->work.counts.solved;
        printf("%-12s %6zu events, %.3f of all walks\n", worlds[c].what, all->work.events.count, share);
        assert_true(all->work.events.count > 1000);
        assert_true(share < (c == 2 ? 1 : 0.5));
        expect_same(all, some);
        expect_same(all, resumed);
        assert_memory_equal(all->sensor.segment.number, some->sensor.segment.number, all->pixels * sizeof(double));
        assert_memory_equal(all->sensor.segment.value, some->sensor.segment.value, all->pixels * sizeof(double));
        rig_free(all);
        rig_free(some);
        rig_free(resumed);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
