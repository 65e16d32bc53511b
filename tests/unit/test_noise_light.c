/* Noise of the photocurrent, against a direct simulation of the pixel: electrons' white noise on ln I, the photoreceptor's
 * equation driven by it in steps of a fraction of its time constants, and a comparator behind it. Compared within 10 %: rates
 * of ON and OFF, and the share of successive events that alternate, over light, thresholds and bandwidth. */
#include "sensor_rig.h"
#include "sensor/td_between.h"
#include "td_random.h"
#include "signal/td_event_sort.h"

#include <stdio.h>

static const uint64_t SEED = 90210;
static const double two_pi = 6.283185307179586, charge = 1.602176634e-19;

typedef struct world {
    const char *name;
    double Y, photocurrent, on, off;
    double cutoff;
    int32_t law;
    double hold;
} world;

static const world worlds[] = {
    {"middle", 0.5, 2e-14, 0.22, 0.22, 100, TIDES_PHOTORECEPTOR_CONSTANT, 1e-4},
    {"dim", 0.1, 2e-14, 0.45, 0.45, 100, TIDES_PHOTORECEPTOR_CONSTANT, 1e-4},
    {"dim, far levels", 0.1, 2e-14, 0.7, 0.6, 100, TIDES_PHOTORECEPTOR_CONSTANT, 0},
    {"bright", 2, 2e-14, 0.1, 0.13, 100, TIDES_PHOTORECEPTOR_CONSTANT, 5e-4},
    {"slow", 0.5, 2e-14, 0.1, 0.1, 10, TIDES_PHOTORECEPTOR_CONSTANT, 1e-3},
    {"fast", 0.5, 2e-14, 0.6, 0.5, 1000, TIDES_PHOTORECEPTOR_CONSTANT, 1e-5},
    {"in the dark", 0, 2e-14, 1.1, 1.1, 50, TIDES_PHOTORECEPTOR_CONSTANT, 1e-4},
    {"pole with light, dim", 0.05, 2e-14, 0.3, 0.25, 200, TIDES_PHOTORECEPTOR_INTENSITY, 1e-4},
    {"pole with light, bright", 1, 2e-14, 0.3, 0.25, 200, TIDES_PHOTORECEPTOR_INTENSITY, 1e-4},
};

static const double dark = 5e-16;

static tides_sensor sensor_of(const world *w) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.seed = SEED;
    sensor.noise_law = TIDES_NOISE_PHOTOCURRENT;
    sensor.circuit.photocurrent_a = w->photocurrent;
    sensor.circuit.dark_current_a = dark;
    sensor.threshold_on = w->on;
    sensor.threshold_off = w->off;
    sensor.photoreceptor_cutoff_hz = w->cutoff;
    sensor.photoreceptor_law = w->law;
    sensor.refractory_s = w->hold;
    sensor.max_events_per_step = 1 << 20;
    return sensor;
}

/* -- the direct simulation ------------------------------------------------------------------------------------------------- */

/* x' = rate (white noise - x) */
typedef struct pixel {
    double x, reference, held;
} pixel;

typedef struct plant {
    double rate, density; /* density: two-sided, of ln I [s] */
} plant;

static plant plant_of(const world *w) {
    plant p = {two_pi * w->cutoff, 2 * charge / (w->photocurrent * w->Y + dark)};
    if (w->law == TIDES_PHOTORECEPTOR_INTENSITY) p.rate *= (255 * w->Y + 20) / 275;
    return p;
}

typedef struct tally {
    double on, off, pairs, alternate, seconds;
} tally;

static void count(tally *all, int *last, int polarity) {
    *(polarity > 0 ? &all->on : &all->off) += 1;
    if (*last) all->pairs++;
    if (*last == -polarity) all->alternate++;
    *last = polarity;
}

/* Between two steps paths are Brownian bridges. */
static int look(const world *w, double variance, double a, const td_random_bits *bits, const pixel *at) {
    const double up = at->reference + w->on, down = at->reference - w->off, b = at->x;
    if (a >= up || b >= up || td_random_uniform(bits, 0) < exp(-2 * (up - a) * (up - b) / variance)) return 1;
    if (a <= down || b <= down || td_random_uniform(bits, 1) < exp(-2 * (a - down) * (b - down) / variance)) return -1;
    return 0;
}

static tally simulate(const world *w, uint32_t pixels, double settle, double seconds, double dt) {
    const plant p = plant_of(w);
    const double step = p.rate * sqrt(p.density * dt); /* the white noise's over dt */
    tally all = {0, 0, 0, 0, pixels * seconds};
    for (uint32_t i = 0; i < pixels; i++) {
        pixel at = {0, 0, -1};
        int last = 0;
        const uint64_t before = (uint64_t)(settle / dt), to = before + (uint64_t)(seconds / dt);
        for (uint64_t k = 0; k < to; k++) {
            double normal[2];
            const double a = at.x, t = (double)k * dt;
            const td_random_bits bits = td_random(SEED, i, k, 1001), more = td_random(SEED, i, k, 1002);
            td_random_normals(&bits, normal);
            at.x += step * normal[0] - p.rate * dt * at.x;
            if (k == before / 2) at.reference = at.x; /* the noise is stationary by then */
            if (k < before / 2) continue;
            if (at.held > t) {
                if (at.held <= t + dt) at.reference = at.x;
                continue;
            }
            const int polarity = look(w, step * step, a, &more, &at);
            if (!polarity) continue;
            at.reference += polarity > 0 ? w->on : -w->off;
            if (w->hold > 0) at.held = t + 0.5 * dt + w->hold;
            if (k >= before) count(&all, &last, polarity);
        }
    }
    return all;
}

/* -- the sensor's ---------------------------------------------------------------------------------------------------------- */

static void still(const void *user, int i, double t, double *S, double *S_dot) {
    (void)i;
    (void)t;
    *S = log(((const world *)user)->Y + 1e-3);
    *S_dot = 0;
}

static tally run(const world *w, int tiles, double settle, double seconds) {
    const tides_sensor sensor = sensor_of(w);
    rig *r = rig_make(&sensor, tiles, 0, still, w);
    tally all = {0, 0, 0, 0, (double)r->pixels * seconds};
    int *last = rig_alloc(r->pixels, sizeof *last);
    rig_run(r, 0.5 * settle + seconds, 23);
    tides_event *scratch = rig_alloc(r->work.events.count, sizeof *scratch);
    td_event_sort(r->work.events.events, scratch, r->work.events.count);
    free(scratch);
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        if ((double)e->t * 1e-9 < 0.5 * settle) continue;
        count(&all, &last[(e->x / RIG_WIDTH) * RIG_PIXELS + e->y * RIG_WIDTH + e->x % RIG_WIDTH], e->polarity);
    }
    free(last);
    rig_free(r);
    return all;
}

static int is_near(double found, double wanted, double part) { return fabs(found - wanted) <= part * wanted; }

static void compare(const world *w) {
    const double tau = 1 / plant_of(w).rate;
    const tally wanted = simulate(w, 100, 40 * tau, 300 * tau, 0.01 * tau), found = run(w, 2, 40 * tau, 300 * tau);
    const double share = found.alternate / found.pairs, wanted_share = wanted.alternate / wanted.pairs;
    printf("%-26s ON %9.4g Hz (wanted %9.4g, %5.0f), OFF %9.4g (%9.4g), alternate %.3f (%.3f)\n", w->name,
           found.on / found.seconds, wanted.on / wanted.seconds, wanted.on, found.off / found.seconds,
           wanted.off / wanted.seconds, share, wanted_share);
    assert_true(wanted.on > 500 && wanted.off > 500);
    assert_true(is_near(found.on / found.seconds, wanted.on / wanted.seconds, 0.1));
    assert_true(is_near(found.off / found.seconds, wanted.off / wanted.seconds, 0.1));
    assert_true(fabs(share - wanted_share) <= 0.03);
}

static void test_one_pole(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof worlds / sizeof *worlds; i++) compare(&worlds[i]);
}

/* -- light that moves, spread, refusals ------------------------------------------------------------------------------------ */

/* From the dark to twice full light, at a constant speed of L, from pixel to pixel another one. */
static void rising(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    *S_dot = 40 + 0.05 * i;
    *S = -5 + *S_dot * t;
}

static rig *moving(const tides_sensor *sensor, int steps, int exhaustive) {
    rig *r = rig_make(sensor, 1, 0, rising, NULL);
    r->sensor.exhaustive = exhaustive;
    rig_run(r, 0.13, steps);
    tides_event *scratch = rig_alloc(r->work.events.count, sizeof *scratch);
    td_event_sort(r->work.events.events, scratch, r->work.events.count);
    free(scratch);
    return r;
}

/* The same events whatever the steps, and whether pixels are passed over or walked through. */
static void test_any_steps(void **state) {
    (void)state;
    for (int law = TIDES_PHOTORECEPTOR_CONSTANT; law <= TIDES_PHOTORECEPTOR_INTENSITY; law++) {
        const world w = {"", 0, 2e-13, 0.5, 0.4, 300, law, 1e-4};
        tides_sensor sensor = sensor_of(&w);
        sensor.noise_sigma = 0.1;
        sensor.noise_rms = 0.01;
        rig *first = moving(&sensor, 5, 0);
        printf("law %d: %zu events\n", law, first->work.events.count);
        assert_true(first->work.events.count > 2000);
        for (int k = 0; k < 3; k++) {
            rig *r = moving(&sensor, k == 0 ? 5 : k == 1 ? 77 : 1500, k == 0);
            assert_int_equal(r->work.events.count, first->work.events.count);
            for (size_t e = 0; e < r->work.events.count; e++) {
                const tides_event *a = &first->work.events.events[e], *b = &r->work.events.events[e];
                assert_true(llabs((long long)(a->t - b->t)) <= (k == 0 ? 0 : 2));
            }
            if (k == 0) assert_memory_equal(r->sensor.segment.value, first->sensor.segment.value, r->pixels * sizeof(double));
            if (k == 0) assert_memory_equal(r->sensor.segment.light, first->sensor.segment.light, r->pixels * sizeof(double));
            rig_free(r);
        }
        rig_free(first);
    }
}

/* A size of its own per pixel, the same for all time: rates then differ by decades, and few pixels make most of the events. */
static void test_spread(void **state) {
    (void)state;
    const world w = {"", 1, 2e-14, 0.32, 0.32, 100, TIDES_PHOTORECEPTOR_CONSTANT, 1e-4};
    double top[2], sum = 0, square = 0;
    for (int spread = 0; spread < 2; spread++) {
        tides_sensor sensor = sensor_of(&w);
        sensor.noise_sigma = 0.1 * spread;
        rig *r = rig_make(&sensor, 4, 0, still, &w);
        double *events = rig_alloc(r->pixels, sizeof *events), all = 0, most = 0;
        for (size_t i = 0; i < r->pixels; i++) {
            const double size = log10(td_sensor_noise_segment(&r->sensor, i).own);
            sum += size;
            square += size * size;
        }
        rig_run(r, 2, 11);
        for (size_t k = 0; k < r->work.events.count; k++)
            events[r->work.events.events[k].x / RIG_WIDTH * RIG_PIXELS + r->work.events.events[k].y * RIG_WIDTH +
                   r->work.events.events[k].x % RIG_WIDTH]++;
        for (size_t left = r->pixels / 100; left > 0; left--) {
            size_t best = 0;
            for (size_t i = 0; i < r->pixels; i++)
                if (events[i] > events[best]) best = i;
            most += events[best];
            events[best] = 0;
        }
        all = (double)r->work.events.count;
        top[spread] = most / all;
        printf("spread %g: %.0f events, of the top 1 %% of pixels %.3f\n", sensor.noise_sigma, all, top[spread]);
        free(events);
        rig_free(r);
    }
    assert_true(fabs(sqrt(square / 1024 - sum / 1024 * (sum / 1024)) - 0.1) < 0.007);
    assert_true(top[1] > 1.5 * top[0]);
}

static void test_refused(void **state) {
    (void)state;
    const world w = worlds[0];
    static const char *const said[] = {"noise_law",   "dark_current_a", "photoreceptor_cutoff_hz", "circuit", "highpass_hz",
                                       "noise_sigma", "at Y = 1"};
    const td_tile tile = {0, 0, 16, 256};
    for (int i = 0; i < 7; i++) {
        td_sensor made;
        tides_error error = {TIDES_OK, ""};
        tides_sensor sensor = sensor_of(&w);
        if (i == 0) sensor.noise_law = 2;
        if (i == 1) sensor.circuit.dark_current_a = 0;
        if (i == 2) sensor.photoreceptor_cutoff_hz = 0;
        if (i == 3) sensor.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
        if (i == 4) sensor.highpass_hz = 1;
        if (i == 5) sensor.noise_sigma = NAN;
        if (i == 6) sensor.photoreceptor_cutoff_hz = 1e8;
        const tides_status status =
            td_sensor_create(&sensor, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, 16}, &made, &error);
        assert_int_equal(status, i == 3 || i == 4 ? TIDES_UNSUPPORTED : TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, said[i]));
    }
}

int main(void) {
    printf("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_pole), cmocka_unit_test(test_any_steps),
                                       cmocka_unit_test(test_spread), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
