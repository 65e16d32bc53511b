/* The front end's contribution to events, against closed forms; and the low-passes of a whole tile against its pixels one by
 * one, the constant one to the bit. */
#include "sensor_rig.h"
#include "sensor/td_between.h"

static const double TAU = 1 / (2 * 3.14159265358979323846 * 300); /* of 300 Hz [s] */

static tides_sensor sensor_of(double threshold, double cutoff_hz) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = sensor.threshold_off = threshold;
    sensor.photoreceptor_cutoff_hz = cutoff_hz;
    sensor.labels = 1;
    return sensor;
}

/* Pixel i climbs or falls, by i's own slope [1/s]. */
static double slope_of(int i) { return (i % 2 ? -1 : 1) * (0.5 + 0.1 * i); }

static void ramps(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    *S = slope_of(i) * t - 3;
    *S_dot = slope_of(i);
}

/* Within what binary16 leaves. */
static void expect_added(const tides_event *event, double expected) {
    double added = tides_event_frontend(event);
    if (!(fabs(added - expected) <= 1e-9 + fmax(0x1p-11 * fabs(expected), 0x1p-25))) /* the latter for its subnormals */
        fail_msg("pixel %d at %lld ns: %g was added, not %g", event->x + RIG_WIDTH * event->y, (long long)event->t, added,
                 expected);
}

/* S lags behind a ramp that begins at 0 by slope tau (1 - e^(-t / tau)): in the end by tau; a leak changes nothing of that. */
static void test_ramp_through_a_low_pass(void **state) {
    (void)state;
    static const int lengths[] = {3, 50, 400};
    for (int k = 0; k < 3; k++)
        for (int leaks = 0; leaks < 2; leaks++) {
            tides_sensor sensor = sensor_of(0.02, 300);
            sensor.leak_rate_hz = leaks ? 20 : 0;
            rig *r = rig_make(&sensor, 1, 0, ramps, NULL);
            rig_run(r, 0.05, lengths[k]);
            assert_true(r->work.events.count > 500);
            for (size_t e = 0; e < r->work.events.count; e++) {
                const tides_event *event = &r->work.events.events[e];
                double slope = slope_of(event->x + RIG_WIDTH * event->y), t = 1e-9 * (double)event->t;
                double late = 0.5e-9 * fabs(slope); /* times are floored */
                expect_added(event, -slope * TAU * (1 - exp(-t / TAU)));
                if (t > 20 * TAU) assert_true(fabs(-tides_event_frontend(event) / slope - TAU) <= 0x1p-11 * TAU + late);
            }
            rig_free(r);
        }
}

/* Nothing is added where nothing is on that could, nor where nobody asks. */
static void test_nothing_added(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        tides_sensor sensor = sensor_of(0.02, k ? 300 : 0);
        sensor.labels = !k;
        sensor.leak_rate_hz = 20;
        sensor.shot_noise_hz = 100;
        sensor.refractory_s = 1e-4;
        rig *r = rig_make(&sensor, 1, 0, ramps, NULL);
        rig_run(r, 0.05, 50);
        assert_true(r->work.events.count > 500);
        for (size_t e = 0; e < r->work.events.count; e++) assert_int_equal(r->work.events.events[e].frontend, 0);
        rig_free(r);
    }
}

static void rest(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user, (void)t;
    *S = -0.01 * i;
    *S_dot = 0;
}

/* A pixel at rest fires where its noise is a threshold off what it was at the start: that is what was added. */
static void test_noise(void **state) {
    (void)state;
    tides_sensor sensor = sensor_of(0.02, 0);
    int seen[RIG_PIXELS] = {0}, count = 0;
    double first[RIG_PIXELS];
    sensor.noise_rms = 0.02;
    sensor.seed = 5;
    rig *r = rig_make(&sensor, 1, 0, rest, NULL);
    for (size_t i = 0; i < r->pixels; i++) first[i] = td_sensor_noise_at(&r->sensor, i, 0);
    rig_run(r, 0.005, 20);
    for (size_t e = 0; e < r->work.events.count; e++) {
        const tides_event *event = &r->work.events.events[e];
        int i = event->x + RIG_WIDTH * event->y;
        if (!seen[i]) expect_added(event, first[i] + 0.02 * event->polarity);
        count += !seen[i];
        seen[i] = 1;
    }
    assert_true(count > RIG_PIXELS / 2);
    rig_free(r);
}

/* -- a tile at once ------------------------------------------------------------------------------------------------------ */

/* Still pixels, slow ones and such that fire in each step. */
static void waves(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    double size = i % 3 ? 0.002 * i : 0, rate = 40 + i;
    *S = size * sin(rate * t) - 2;
    *S_dot = size * rate * cos(rate * t);
    if (i == 77 && t > 0.02 && t < 0.03) *S = NAN;
}

static void test_tile_is_its_pixels(void **state) {
    (void)state;
    static const double cutoffs[] = {3, 300, 30000};
    for (int k = 0; k < 3; k++) {
        tides_sensor sensor = sensor_of(0.05, cutoffs[k]);
        sensor.threshold_sigma = 0.01;
        sensor.leak_rate_hz = 3;
        rig *r = rig_make(&sensor, 2, 0, waves, NULL);
        double S[2 * RIG_PIXELS];
        memcpy(S, r->sensor.filtered.state[0], sizeof S);
        for (int n = 1; n <= 60; n++) {
            const double *now = r->plane[0], *rate = r->plane[1], *next = r->plane[3], *next_rate = r->plane[4];
            td_step step;
            assert_int_equal(td_step_between(r->now, 1e-3 * n, &step, NULL), TIDES_OK);
            rig_step(r, 1e-3 * n);
            for (size_t i = 0; i < r->pixels; i++) {
                td_model input = td_model_fit(TIDES_MODEL_HERMITE, step.length_s, now[i], rate[i], next[i], next_rate[i]);
                double memory[TD_FRONTEND_STATE] = {S[i], S[i], 0, S[i]};
                td_response response;
                td_frontend_step(&r->sensor.frontend, step.length_s, &input, 1e-3, memory, &response, NULL);
                S[i] = memory[0];
            }
            assert_memory_equal(S, r->sensor.filtered.state[0], sizeof S);
        }
        assert_true(r->work.counts.solved > 100 && r->work.counts.solved < 60 * r->pixels / 2); /* both ways were taken */
        rig_free(r);
    }
}

/* Where rates go with the light, the pixels that are passed over are within TD_FRONTEND_TOLERANCE of their walk. All fire
 * as if each took it, at times that this moves by less than the nanosecond that they are rounded to; where a signal turns at a
 * level, by the root of 2 TD_FRONTEND_TOLERANCE over its curvature, which is more than 10 / s^2 here wherever a pixel fires. */
static void expect_as_its_pixels(const tides_sensor *sensor, double length, int steps) {
    const double most_ns = 1e9 * sqrt(2 * TD_FRONTEND_TOLERANCE / 10);
    rig *fast = rig_make(sensor, 2, 0, waves, NULL), *slow = rig_make(sensor, 2, 0, waves, NULL);
    slow->sensor.exhaustive = 1;
    for (int n = 1; n <= steps; n++) {
        rig_step(fast, length * n);
        rig_step(slow, length * n);
    }
    const td_event_buffer *events = &fast->work.events, *expected = &slow->work.events;
    size_t moved = 0;
    assert_int_equal(events->count, expected->count);
    for (size_t e = 0; e < events->count; e++) {
        const tides_event *a = &events->events[e], *b = &expected->events[e];
        const double apart = fabs((double)(a->t - b->t));
        assert_true(a->x == b->x && a->y == b->y && a->polarity == b->polarity && a->cause == b->cause);
        assert_true(apart <= most_ns);
        moved += apart > 1;
    }
    assert_true(moved <= events->count / 100);
    for (size_t i = 0; i < fast->pixels; i++) {
        assert_true(fabs(fast->sensor.filtered.state[0][i] - slow->sensor.filtered.state[0][i]) <= TD_FRONTEND_TOLERANCE);
        assert_int_equal(fast->sensor.pixels.count_on[i], slow->sensor.pixels.count_on[i]);
    }
    if (length <= 1e-3) assert_true(fast->work.counts.solved < slow->work.counts.solved / 2); /* both ways were taken */
    rig_free(fast);
    rig_free(slow);
}

static tides_sensor with_blocks(int on, double cutoff_hz) {
    tides_sensor sensor = sensor_of(0.05, cutoff_hz);
    sensor.threshold_sigma = on ? 0.01 : 0;
    sensor.leak_rate_hz = 3;
    sensor.refractory_s = on ? 0.002 : 0;
    sensor.shot_noise_hz = on ? 5 : 0;
    sensor.seed = 3;
    return sensor;
}

static void test_tile_by_light_is_its_pixels(void **state) {
    (void)state;
    static const double cutoffs[] = {3, 300, 3000}, lengths[] = {1e-3, 1e-4, 1e-2};
    for (int k = 0; k < 9; k++) {
        tides_sensor sensor = with_blocks(k % 2, cutoffs[k % 3]);
        sensor.photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY;
        expect_as_its_pixels(&sensor, lengths[k / 3], 60);
    }
}

static void test_tile_of_circuits_is_its_pixels(void **state) {
    (void)state;
    static const double lengths[] = {1e-3, 1e-4, 1e-2};
    static const int steps[] = {30, 60, 4}; /* the walk is slow */
    for (int k = 0; k < 6; k++) {
        tides_sensor sensor = with_blocks(k % 2, 0);
        sensor.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
        expect_as_its_pixels(&sensor, lengths[k / 2], steps[k / 2]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ramp_through_a_low_pass),
        cmocka_unit_test(test_nothing_added),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_tile_is_its_pixels),
        cmocka_unit_test(test_tile_by_light_is_its_pixels),
        cmocka_unit_test(test_tile_of_circuits_is_its_pixels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
