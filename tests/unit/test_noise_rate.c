/* The rate of events by additive noise, against the process itself: the Ornstein-Uhlenbeck process through the comparator. With
 * the signal at rest by its closed form. With moving signals, refractory periods and unequal thresholds by an independent
 * simulation in steps so short that shorter ones don't matter. All within 3 standard errors. */
#include "sensor_rig.h"
#include "td_random.h"
#include "signal/td_event_sort.h"

#include <float.h>
#include <stdio.h>

static const uint64_t SEED = 52711;
static const double pi = 3.14159265358979323846, cutoff_hz = 500;

/* Prints what was found, and fails beyond 3 standard errors. */
static void expect_near(const char *name, double found, double expected, double standard_error) {
    printf("%-28s %.6g, wanted %.6g, %+.2f standard errors\n", name, found, expected, (found - expected) / standard_error);
    assert_true(fabs(found - expected) <= 3 * standard_error);
}

static double tau(void) { return 1 / (2 * pi * cutoff_hz); }

/* -- the closed form ------------------------------------------------------------------------------------------------------- */

/* x' = -x + sqrt(2) white noise (variance and correlation time 1) leaves (y - C, y + C) from y after a mean time T, above with
 * probability p: with s(x) = e^(x^2 / 2), A and B its integrals below and above y, and I(x) the integral of 1 / s from the
 * lower end, all by the trapezoid rule,
 *   p = A / (A + B),   T = p int_(y - C)^(y + C) s I - int_(y - C)^y s I */
typedef struct passage {
    double up, down, T;
} passage;

static passage leave(double y, double C) {
    enum { HALF = 400 };
    double h = C / HALF, S[2] = {0}, G[2] = {0}, I = 0;
    for (int i = 0; i < 2 * HALF; i++) {
        double x0 = y + (i - HALF) * h, x1 = x0 + h;
        double s0 = exp(0.5 * (x0 * x0 - y * y)), s1 = exp(0.5 * (x1 * x1 - y * y)); /* over s(y), which p and T don't see */
        double I1 = I + 0.5 * h * (1 / s0 + 1 / s1);
        G[i >= HALF] += 0.5 * h * (s0 * I + s1 * I1);
        S[i >= HALF] += 0.5 * h * (s0 + s1);
        I = I1;
    }
    passage p = {S[0] / (S[0] + S[1]), S[1] / (S[0] + S[1]), 0};
    p.T = p.up * G[1] - p.down * G[0];
    return p;
}

/* Events per correlation time. Each event takes the reference by C to where the process is: events are at y + n C, a chain that
 * steps up and down and is in detailed balance; y, where the process began, is normal. */
static double exact_rate(double C) {
    enum { OFFSETS = 16 };
    double rate = 0, weight = 0;
    for (int j = 0; j < OFFSETS; j++) {
        double up = 0, chain = 1, sum = 0, time = 0, share = 0;
        for (int n = -(int)(7 / C) - 1; n <= 7 / C; n++) {
            double y = C * ((j + 0.5) / OFFSETS + n);
            passage p = leave(y, C);
            if (share > 0) chain *= up / p.down;
            up = p.up;
            sum += chain;
            time += chain * p.T;
            share += exp(-0.5 * y * y);
        }
        rate += share * sum / time;
        weight += share;
    }
    return rate / weight;
}

/* -- at rest --------------------------------------------------------------------------------------------------------------- */

enum { TILES = 6 };

static void still(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    (void)i;
    (void)t;
    *S = -1;
    *S_dot = 0;
}

/* The rate after the first 20 correlation times [1 / tau], and its standard error from pixel to pixel. */
static double rate_of(const tides_sensor *sensor, rig_signal signal, double taus, int steps, double *error) {
    rig *r = rig_make(sensor, TILES, 0, signal, NULL);
    double begin = 20 * tau(), sum = 0, squares = 0;
    double *count = rig_alloc(r->pixels, sizeof *count);
    rig_run(r, begin + taus * tau(), steps);
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        if ((double)e->t * 1e-9 >= begin) count[(e->x / RIG_WIDTH) * RIG_PIXELS + e->y * RIG_WIDTH + e->x % RIG_WIDTH]++;
    }
    for (size_t i = 0; i < r->pixels; i++) {
        sum += count[i];
        squares += count[i] * count[i];
    }
    double n = (double)r->pixels, mean = sum / n;
    *error = sqrt((squares / n - mean * mean) / n) / taus;
    free(count);
    rig_free(r);
    return mean / taus;
}

static void test_at_rest(void **state) {
    static const double ratio[] = {0.5, 1, 2, 3, 4}, taus[] = {10, 30, 100, 300, 600};
    (void)state;
    for (size_t i = 0; i < sizeof ratio / sizeof *ratio; i++) {
        tides_sensor sensor;
        char name[60];
        double error;
        tides_sensor_defaults(&sensor);
        sensor.seed = SEED + i;
        sensor.noise_cutoff_hz = cutoff_hz;
        sensor.noise_rms = sensor.threshold_on / ratio[i];
        sensor.max_events_per_step = 1 << 20;
        double found = rate_of(&sensor, still, taus[i], 40, &error);
        snprintf(name, sizeof name, "C / rms = %g, per tau", ratio[i]);
        expect_near(name, found, exact_rate(ratio[i]), error);
    }
}

/* -- moving signals, held pixels, unequal thresholds ------------------------------------------------------------------ */

/* In units of noise_rms and tau: slope of the signal, thresholds, refractory period (HOLD). */
typedef struct world {
    const char *name;
    double slope, on, off, hold;
} world;

enum { PER_TAU = 500, WALKERS = 80 };

/* Steps of tau / PER_TAU, on each of which the process is a Brownian bridge with its maximum and minimum; one event at most. */
typedef struct walker {
    double x, reference, held;
    uint32_t pixel;
    uint64_t drawn;
} walker;

static int walk_step(const world *w, double t, walker *p, double normal, double u, double u2) {
    const double h = 1.0 / PER_TAU, rho = exp(-h), v = 2 * h;
    double a = p->x + w->slope * t, x = rho * p->x + sqrt(1 - rho * rho) * normal, b = x + w->slope * (t + h);
    p->x = x;
    if (p->held > t) { /* to the nearest step */
        if (p->held <= t + h) p->reference = b;
        return 0;
    }
    double up = p->reference + w->on, down = p->reference - w->off;
    int fires = a >= up || b >= up || u < exp(-2 * (up - a) * (up - b) / v)            ? 1
                : a <= down || b <= down || u2 < exp(-2 * (a - down) * (b - down) / v) ? -1
                                                                                       : 0;
    if (fires) p->reference += fires > 0 ? w->on : -w->off;
    if (fires && w->hold > 0) p->held = t + 0.5 * h + w->hold;
    return fires;
}

/* Events per tau of each polarity after 20 tau, and the squares of their standard errors. */
typedef struct rates {
    double rate[2], variance[2];
} rates;

static rates rates_of(const double *count[2], size_t pixels, double taus) {
    rates r = {{0}, {0}};
    for (int k = 0; k < 2; k++) {
        double sum = 0, squares = 0, n = (double)pixels;
        for (size_t i = 0; i < pixels; i++) {
            sum += count[k][i];
            squares += count[k][i] * count[k][i];
        }
        r.rate[k] = sum / n / taus;
        r.variance[k] = (squares / n - sum / n * (sum / n)) / n / (taus * taus);
    }
    return r;
}

static rates walk_all(const world *w, size_t pixels, double taus) {
    double *count[2] = {rig_alloc(pixels, sizeof(double)), rig_alloc(pixels, sizeof(double))};
    for (size_t i = 0; i < pixels; i++) {
        walker p = {0, 0, -1, (uint32_t)i, 0};
        double normal[2];
        for (int k = 0; k < (20 + taus) * PER_TAU; k++) {
            td_random_bits bits = td_random(SEED, (uint32_t)i, (uint64_t)k, 1000), more;
            td_random_normals(&bits, normal);
            more = td_random(SEED, (uint32_t)i, (uint64_t)k, 1001);
            if (k == 0) p.x = p.reference = normal[1];
            int fires =
                walk_step(w, (double)k / PER_TAU, &p, normal[0], td_random_uniform(&more, 0), td_random_uniform(&more, 1));
            if (fires && k >= 20 * PER_TAU) count[fires > 0][i]++;
        }
    }
    rates r = rates_of((const double *[]){count[0], count[1]}, pixels, taus);
    free(count[0]);
    free(count[1]);
    return r;
}

static void ramp(const void *user, int i, double t, double *S, double *S_dot) {
    const world *w = user;
    (void)i;
    *S_dot = w->slope * 0.1 / tau();
    *S = *S_dot * t;
}

static tides_sensor sensor_of(const world *w) {
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.seed = SEED;
    sensor.noise_cutoff_hz = cutoff_hz;
    sensor.noise_rms = 0.1;
    sensor.threshold_on = 0.1 * w->on;
    sensor.threshold_off = 0.1 * w->off;
    sensor.refractory_s = w->hold * tau();
    return sensor;
}

static rates rig_rates(const world *w, int tiles, double taus) {
    const tides_sensor sensor = sensor_of(w);
    rig *r = rig_make(&sensor, tiles, 0, ramp, w);
    double *count[2] = {rig_alloc(r->pixels, sizeof(double)), rig_alloc(r->pixels, sizeof(double))};
    rig_run(r, (20 + taus) * tau(), (int)taus / 2);
    for (size_t k = 0; k < r->work.events.count; k++) {
        const tides_event *e = &r->work.events.events[k];
        size_t i = (size_t)(e->x / RIG_WIDTH) * RIG_PIXELS + (size_t)(e->y * RIG_WIDTH + e->x % RIG_WIDTH);
        if ((double)e->t * 1e-9 >= 20 * tau()) count[e->polarity > 0][i]++;
    }
    rates found = rates_of((const double *[]){count[0], count[1]}, r->pixels, taus);
    free(count[0]);
    free(count[1]);
    rig_free(r);
    return found;
}

static void test_against_walkers(void **state) {
    static const world worlds[] = {{"slow ramp", 0.3, 2, 2, 0},    {"ramp", 2, 2, 2, 0},
                                   {"fast ramp", 12, 1.5, 1.5, 0}, {"unequal thresholds", 0, 1.2, 2.2, 0},
                                   {"held", 0, 1.5, 1.5, 0.15},    {"held longer, on a ramp", -1, 1.5, 1.5, 0.4}};
    (void)state;
    for (size_t i = 0; i < sizeof worlds / sizeof *worlds; i++) {
        const world *w = &worlds[i];
        rates wanted = walk_all(w, WALKERS, 60), found = rig_rates(w, 8, 100);
        for (int k = 0; k < 2; k++) {
            char name[60];
            snprintf(name, sizeof name, "%s, %s", w->name, k ? "ON" : "OFF");
            if (wanted.variance[k] == 0 && found.variance[k] == 0) continue; /* neither has any */
            expect_near(name, found.rate[k], wanted.rate[k], sqrt(found.variance[k] + wanted.variance[k]));
        }
    }
}

static void compare_pixel(const rig *a, const rig *b, int i) {
    enum { ROOM = 4096 };
    static tides_event of_a[ROOM], of_b[ROOM];
    size_t count = rig_events(a, i % RIG_WIDTH, i / RIG_WIDTH, of_a, ROOM);
    assert_int_equal(rig_events(b, i % RIG_WIDTH, i / RIG_WIDTH, of_b, ROOM), count);
    for (size_t k = 0; k < count; k++)
        assert_true(of_a[k].polarity == of_b[k].polarity && llabs((long long)(of_a[k].t - of_b[k].t)) <= 1);
}

/* The same events whatever the steps, within a nanosecond: noise is a function of time. Each refractory law; signals that move,
 * in steps far shorter than the noise's parts and far longer. */
static void test_any_steps(void **state) {
    static const int counts[] = {7, 64, 3000};
    (void)state;
    for (int law = TIDES_REFRACTORY_HOLD; law <= TIDES_REFRACTORY_DROP_CONSUME; law++) {
        const world w = {"", -0.7, 1, 1.4, 0.1};
        tides_sensor sensor = sensor_of(&w);
        sensor.refractory_law = law;
        sensor.max_events_per_step = 1 << 20;
        rig *first = NULL;
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
            rig *r = rig_make(&sensor, 1, 0, ramp, &w);
            rig_run(r, 30 * tau(), counts[k]);
            tides_event *scratch = rig_alloc(r->work.events.count, sizeof *scratch);
            td_event_sort(r->work.events.events, scratch, r->work.events.count);
            free(scratch);
            if (!first) {
                first = r;
                continue;
            }
            assert_int_equal(r->work.events.count, first->work.events.count);
            assert_true(r->work.events.count > 3000);
            for (int i = 0; i < RIG_PIXELS; i++) compare_pixel(first, r, i);
            rig_free(r);
        }
        rig_free(first);
    }
}

int main(void) {
    printf("seed %d\n", (int)SEED);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_at_rest), cmocka_unit_test(test_against_walkers),
                                       cmocka_unit_test(test_any_steps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
