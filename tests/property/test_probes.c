/* Step control on signals in closed form whose values at a step's ends say nothing, or mislead: pulses, lamps, kinks and
 * touches. Each must give the events that a thousand times shorter steps give, and report errors that bound the true ones. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/signal_world.h"
#include "tides/metrics.h"

static const double PI = 3.14159265358979323846;

/* -- signals ----------------------------------------------------------------------------------------------------------- */

/* What varies; every signal is about so long a period [s] and so high [log units]; `phase` in turns, and by pixel. */
typedef struct shape {
    double period, height, phase, phase_x;
} shape;

/* A pulse in the first 10 ms, nearly even about the middle: a little early, so that it ends below where it began. */
static void pulse(const void *about, int x, int y, double time, double *S, double *S_dot) {
    const shape *p = about;
    double u = (time - 4.9e-3 - p->phase_x * x) / p->period, bell = p->height * exp(-u * u);
    (void)y;
    *S = -2 + bell;
    *S_dot = -2 * u / p->period * bell;
}

static void lamp(const void *about, int x, int y, double time, double *S, double *S_dot) {
    const shape *p = about;
    double w = 2 * PI / p->period, angle = w * time + 2 * PI * (p->phase + p->phase_x * x);
    (void)y;
    *S = -1 + p->height * cos(angle);
    *S_dot = -p->height * w * sin(angle);
}

/* Triangles: straight lines between kinks. */
static void zigzag(const void *about, int x, int y, double time, double *S, double *S_dot) {
    const shape *p = about;
    double u = time / p->period + p->phase + p->phase_x * x, v = u - floor(u);
    (void)y;
    *S = p->height * (v < 0.5 ? 2 * v : 2 - 2 * v);
    *S_dot = p->height * (v < 0.5 ? 2 : -2) / p->period;
}

/* Rises to just above, on or below multiples of the threshold 0.2, pixel by pixel, and turns there. */
static void grazing(const void *about, int x, int y, double time, double *S, double *S_dot) {
    const shape *p = about;
    double w = 2 * PI / p->period, top = 0.2 * (1 + y % 3) + (x - 8) * p->phase_x, angle = w * time;
    *S = 0.5 * top * (1 - cos(angle));
    *S_dot = 0.5 * top * w * sin(angle);
}

/* -- runs against the truth ---------------------------------------------------------------------------------------------- */

typedef struct world {
    tides_scene *scene;
    tides_trajectory *path;
} world;

static world make_world(void) {
    world w;
    make_signal_scene(&w.scene, &w.path);
    return w;
}

static void free_world(world *w) {
    tides_trajectory_destroy(w->path);
    tides_scene_destroy(w->scene);
}

/* The run's events are those of the truth but for `lost` in a hundred, and its reported errors bound the true ones. */
static void expect_seen(const job *j, signal_of signal, const shape *about, double lost, size_t least, const char *what) {
    signal_class s = {.signal = signal, .about = about};
    outcome truth = truth_of_signal(j, &s), o = run_signal(j, &s);
    tides_match m;
    tides_error error;
    scene_expect_ok(tides_match_events(truth.events, truth.count, o.events, o.count, 1e-3, &m, &error), &error);
    double mismatched = (double)(m.missing + m.spurious), allowed = lost / 100 * (double)truth.count;
    allowed += 2 * (double)o.stats.events_uncertain; /* one that is doubtful takes the next one back with it */
    if (truth.count < least || mismatched > allowed || 1e-6 * m.dt_median_us > o.stats.error_p50_s ||
        1e-6 * m.dt_p95_us > o.stats.error_p95_s || 1e-6 * m.dt_p99_us > o.stats.error_p99_s)
        fail_msg("%s, period %g s: %zu events for %zu, %g mismatched and %g allowed, |dt| %g %g %g us, reported %g %g %g us",
                 what, about->period, o.count, truth.count, mismatched, allowed, m.dt_median_us, m.dt_p95_us, m.dt_p99_us,
                 1e6 * o.stats.error_p50_s, 1e6 * o.stats.error_p95_s, 1e6 * o.stats.error_p99_s);
    assert_true(o.stats.steps_probed == o.stats.steps);
    assert_true(o.stats.worst_deviation > 0);
    check_stream(j, &o);
    check_state(j, &o);
    free_outcome(&truth);
    free_outcome(&o);
}

/* One pulse in one step, at both of whose ends nothing moves: without a look inside there is no event. */
static void test_pulse(void **state) {
    (void)state;
    world w = make_world();
    job j = signal_job(w.scene, w.path, 16, 16);
    for (double width = 2.2e-3; width > 1.5e-3; width -= 0.2e-3) {
        const shape about = {.period = width, .height = 1.9};
        expect_seen(&j, pulse, &about, 0, 16 * 256, "pulse");
    }
    const shape moves = {.period = 2e-3, .height = 1.9, .phase_x = 1e-4};
    expect_seen(&j, pulse, &moves, 0, 16 * 256, "pulse that moves");
    free_world(&w);
}

/* Lamps whose periods are parts of the step and whose phases are all alike: the worst that there is, since no pixel sees more
 * than another. */
static void test_lamps(void **state) {
    static const double hertz[] = {50, 100, 120, 200, 300, 400, 500, 1000, 2000};
    (void)state;
    world w = make_world();
    job j = signal_job(w.scene, w.path, 16, 16);
    j.stop = 0.04;
    for (size_t k = 0; k < sizeof hertz / sizeof *hertz; k++)
        for (int phase = 0; phase < 5; phase++) {
            const shape about = {.period = 1 / hertz[k], .height = phase % 2 ? 0.9 : 0.35, .phase = (phase + 0.35) / 5};
            expect_seen(&j, lamp, &about, 0.05, 256, "lamp");
        }
    free_world(&w);
}

/* Kinks that turn well away from the levels of every pixel: the ends of a step with one in its middle say nothing, and steps go
 * down to where a fourth of what was seen before is within the tolerance. */
static void test_kinks(void **state) {
    static const double periods[] = {10e-3, 10e-3, 10e-3, 6.7e-3, 7.7e-3, 4.1e-3};
    (void)state;
    world w = make_world();
    job j = signal_job(w.scene, w.path, 16, 16);
    j.stop = 0.05;
    for (int k = 0; k < 6; k++) { /* from half a threshold above a level to half a threshold above one */
        const shape about = {.period = periods[k], .height = 0.8, .phase = 0.1875 + 1e-3 * k, .phase_x = k % 2 * 2e-4};
        expect_seen(&j, zigzag, &about, 0.05, 256, "kinks");
    }
    free_world(&w);
}

/* Signals that turn on a level, a little above or below it: what comes out may differ from the truth, but no more than the run
 * says itself. */
static void test_touches(void **state) {
    (void)state;
    world w = make_world();
    job j = signal_job(w.scene, w.path, 16, 16);
    j.stop = 0.05;
    for (int k = 0; k < 4; k++) {
        const shape about = {.period = 7.3e-3 + 2.1e-3 * k, .phase_x = 2e-4 * pow(0.3, k)};
        expect_seen(&j, grazing, &about, 0, 256, "touches");
    }
    free_world(&w);
}

/* A single-precision device's S is off by 1e-5 here and there: no step shows less, and those below say so. */
static void test_rounding_ends_it(void **state) {
    (void)state;
    world w = make_world();
    job j = signal_job(w.scene, w.path, 16, 16);
    const shape about = {.period = 9e-3, .height = 0.9, .phase = 0.07};
    j.device = "reference-f32";
    j.stepping.tolerance = 1e-6;
    for (int k = 0; k < 2; k++) {
        signal_class s = {.signal = lamp, .about = &about, .noise = k ? 2e-4 : 1e-5};
        outcome o = run_signal(&j, &s);
        if (!(o.stats.steps < 1500 && o.stats.steps_at_rounding > o.stats.steps / 4 && o.stats.steps_at_minimum == 0))
            fail_msg("noise %g: %llu steps, %llu at rounding, %llu at the minimum", s.noise, (unsigned long long)o.stats.steps,
                     (unsigned long long)o.stats.steps_at_rounding, (unsigned long long)o.stats.steps_at_minimum);
        free_outcome(&o);
    }
    free_world(&w);
}

/* However little memory there is, and however the run is cut: the same steps and events. */
static void test_memory_changes_nothing(void **state) {
    static const double cuts[] = {0.2, 0.6};
    (void)state;
    world w = make_world();
    for (int k = 0; k < 6; k++) {
        job j = signal_job(w.scene, w.path, 60, 45);
        const shape about = {.period = 3.1e-3, .height = 0.9, .phase = 0.07, .phase_x = 3e-3};
        signal_class s = {.signal = k % 2 ? lamp : zigzag, .about = &about};
        j.stop = 0.05;
        j.stepping.tolerance = 1e-5;
        j.stepping.local = k != 2;
        j.sensor.threshold_off = k < 3 ? 0.2 : 0.17;
        j.sensor.threshold_sigma = k < 4 ? 0 : 0.01;
        j.sensor.refractory_s = k == 5 ? 2e-4 : 0;
        outcome ample = run_signal(&j, &s);
        for (double mb = 1; mb < 40; mb *= 6) {
            j.stepping.memory_mb = mb;
            outcome scarce = run_signal_in(&j, &s, cuts, 2);
            size_t tiles = 12, least = 6 * tiles; /* without `local`, and while a sensor's first cuts are judged, all tiles' */
            if (s.most > s.limit + least) fail_msg("%g MB: %zu samples for %zu", mb, s.most, s.limit);
            assert_true(s.early || mb > 1);
            expect_same(&ample, &scarce, "memory");
            assert_true(ample.stats.steps == scarce.stats.steps);
            assert_true(ample.stats.steps_rejected == scarce.stats.steps_rejected);
            assert_true(ample.stats.error_p99_s == scarce.stats.error_p99_s);
            assert_true(ample.stats.events_uncertain == scarce.stats.events_uncertain);
            free_outcome(&scarce);
        }
        free_outcome(&ample);
    }
    free_world(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pulse),
                                       cmocka_unit_test(test_lamps),
                                       cmocka_unit_test(test_kinks),
                                       cmocka_unit_test(test_touches),
                                       cmocka_unit_test(test_rounding_ends_it),
                                       cmocka_unit_test(test_memory_changes_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
