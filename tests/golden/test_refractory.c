/* TIDES' sensor on frames against three refractory laws of other simulators:
 *
 *   drop_consume   rpg_esim's stream, event for event
 *   hold           wengflow's. It holds each pixel at the start for a random part of the period, which shifts its later events.
 *                  The end of that part is computed from the pixel's first event; pixels without events are left out
 *   drop_keep      v2e's. Its events lie at its frames' sub-times, and delayed ones wait for such a time, up to a frame. So
 *                  streams at the frames' rate can't agree to 2 us. TIDES' own v2e gives its stream to the bit (another
 *                  test), and as frames become denser that stream approaches drop_keep's */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "baselines/td_baseline.h"
#include "sensor/td_sensor_parts.h"
#include "tests/support/golden_events.h"

#include <math.h>
#include <stdlib.h>

#define TOLERANCE_NS 2000.0

/* -- comparing ------------------------------------------------------------------------------------------------------------- */

typedef struct difference {
    size_t matched, missing, extra; /* events of both, only theirs, only ours */
    double most_ns, sum_ns;         /* |dt| of the matched */
} difference;

static size_t place_of(const tides_event *event) { return (size_t)event->y << 16 | event->x; }

/* One pixel's events, in order; those within `tolerance_ns` and of one polarity match. */
static void compare_pixel(const tides_event *a, const tides_event *a_end, const tides_event *b, const tides_event *b_end,
                          double tolerance_ns, difference *sum) {
    while (a < a_end || b < b_end) {
        double apart = a < a_end && b < b_end ? (double)(a->t - b->t) : 0;
        if (a < a_end && b < b_end && a->polarity == b->polarity && fabs(apart) <= tolerance_ns) {
            sum->matched++;
            sum->sum_ns += fabs(apart);
            sum->most_ns = fmax(sum->most_ns, fabs(apart));
            a++;
            b++;
        } else if (b == b_end || (a < a_end && apart < 0)) {
            sum->extra++;
            a++;
        } else {
            sum->missing++;
            b++;
        }
    }
}

/* Pixel by pixel; `skip_empty`: not those in which they have no event. Sorts both. */
static difference compare(golden_stream *ours, golden_stream *theirs, double tolerance_ns, int skip_empty) {
    difference sum = {0, 0, 0, 0, 0};
    qsort(ours->events, ours->count, sizeof *ours->events, golden_compare_places);
    qsort(theirs->events, theirs->count, sizeof *theirs->events, golden_compare_places);
    const tides_event *a = ours->events, *a_end = a + ours->count, *b = theirs->events, *b_end = b + theirs->count;
    while (a < a_end || b < b_end) {
        size_t left = a < a_end ? place_of(a) : SIZE_MAX, right = b < b_end ? place_of(b) : SIZE_MAX;
        size_t place = left < right ? left : right;
        const tides_event *a_next = a, *b_next = b;
        while (a_next < a_end && place_of(a_next) == place) a_next++;
        while (b_next < b_end && place_of(b_next) == place) b_next++;
        if (b_next > b || !skip_empty) compare_pixel(a, a_next, b, b_next, tolerance_ns, &sum);
        a = a_next;
        b = b_next;
    }
    return sum;
}

static void report(const char *name, const golden_stream *ours, const golden_stream *theirs, const difference *d) {
    print_message("%s: %zu events, ours %zu; %zu match, |dt| at most %.0f, on average %.0f ns; %zu missing, %zu extra\n", name,
                  theirs->count, ours->count, d->matched, d->most_ns, d->matched ? d->sum_ns / (double)d->matched : 0,
                  d->missing, d->extra);
}

static void free_both(golden_stream *ours, golden_stream *theirs) {
    free(ours->events);
    free(theirs->events);
}

static tides_baseline_params sensor_of(const cJSON *params, int32_t law, double refractory_s) {
    tides_baseline_params made;
    tides_baseline_params_defaults(&made);
    made.method = TIDES_METHOD_TIDES;
    made.sensor.threshold_on = golden_number(params, "Cp", golden_number(params, "pos_thres", NAN));
    made.sensor.threshold_off = golden_number(params, "Cm", golden_number(params, "neg_thres", NAN));
    made.sensor.refractory_law = law;
    made.sensor.refractory_s = refractory_s;
    made.log_eps = golden_number(params, "log_eps", 1e-9); /* v2e has none */
    return made;
}

/* -- drop_consume ---------------------------------------------------------------------------------------------------------- */

static void compare_consume(golden_file *g) {
    double period = 1e-9 * golden_number(g->params, "refractory_period_ns", 0);
    if (!(period > 0) || golden_number(g->params, "sigma_Cp", 0) > 0) return;
    tides_baseline_params params = sensor_of(g->params, TIDES_REFRACTORY_DROP_CONSUME, period);
    golden_stream theirs = golden_stream_read(g->file, 1), ours = golden_simulate(&params, g->movie);
    difference d = compare(&ours, &theirs, TOLERANCE_NS, 0);
    report(g->name, &ours, &theirs, &d);
    assert_int_equal(d.matched, theirs.count);
    assert_int_equal(d.missing + d.extra, 0);
    free_both(&ours, &theirs);
    g->compared = 1;
}

static void drop_consume(void **state) {
    (void)state;
    if (golden_visit("_rpg_esim_", compare_consume) == 0) skip();
}

/* -- hold ------------------------------------------------------------------------------------------------------------------ */

/* Log-luminance of pixel i at `time_ns`, straight between frames. */
static double signal_at(const golden_movie *m, double log_eps, size_t i, double time_ns) {
    double time = 1e-9 * time_ns;
    size_t k = 0;
    while (k + 2 < m->frames && m->t[k + 1] <= time) k++;
    double part = (time - m->t[k]) / (m->t[k + 1] - m->t[k]);
    double L0 = log(m->Y[k * m->pixels + i] + log_eps), L1 = log(m->Y[(k + 1) * m->pixels + i] + log_eps);
    return L0 + part * (L1 - L0);
}

/* A pixel's first event says what its reference was, the signal there less a threshold, and so when the first hold ended: where
 * the signal, straight between the first two frames, was that. `theirs` by time. */
static void set_holds(td_sensor *sensor, const golden_stream *theirs, const golden_movie *m,
                      const tides_baseline_params *params) {
    unsigned char *seen = golden_allocate(m->pixels, 1);
    double length_ns = 1e9 * (m->t[1] - m->t[0]), period_ns = 1e9 * params->sensor.refractory_s;
    for (size_t k = 0; k < theirs->count; k++) {
        const tides_event *event = &theirs->events[k];
        size_t i = (size_t)event->y * (size_t)m->width + event->x;
        if (seen[i]) continue;
        seen[i] = 1;
        double step = event->polarity > 0 ? params->sensor.threshold_on : -params->sensor.threshold_off;
        double reference = signal_at(m, params->log_eps, i, (double)event->t) - step;
        double L0 = signal_at(m, params->log_eps, i, 0), L1 = signal_at(m, params->log_eps, i, length_ns);
        double until_ns = length_ns * (reference - L0) / (L1 - L0);
        if (!(until_ns > 0)) continue; /* rounding: it ended at once */
        sensor->held_until[i] = fmin(until_ns, period_ns);
        td_sensor_set_wake(sensor, i);
    }
    free(seen);
}

static golden_stream simulate_from(const tides_baseline_params *params, const golden_movie *m, const golden_stream *theirs) {
    golden_stream s = {NULL, 0, 0};
    tides_baseline *baseline = NULL;
    assert_int_equal(tides_baseline_create(params, m->width, m->height, &baseline, NULL), TIDES_OK);
    for (size_t k = 0; k < m->frames; k++) {
        assert_int_equal(tides_baseline_push(baseline, m->t[k], m->Y + k * m->pixels, golden_keep, &s, NULL), TIDES_OK);
        if (k == 0) set_holds(td_tides_sensor(baseline), theirs, m, params);
    }
    assert_int_equal(tides_baseline_finish(baseline, golden_keep, &s, NULL), TIDES_OK);
    tides_baseline_destroy(baseline);
    return s;
}

static void compare_hold(golden_file *g) {
    double period = 1e-9 * golden_number(g->params, "refr", 0);
    if (!(period > 0)) return;
    tides_baseline_params params = sensor_of(g->params, TIDES_REFRACTORY_HOLD, period);
    golden_stream theirs = golden_stream_read(g->file, 1), ours = simulate_from(&params, g->movie, &theirs);
    difference d = compare(&ours, &theirs, TOLERANCE_NS, 1);
    report(g->name, &ours, &theirs, &d);
    assert_true((double)(d.missing + d.extra) <= 1e-3 * (double)theirs.count);
    free_both(&ours, &theirs);
    g->compared = 1;
}

static void hold(void **state) {
    (void)state;
    if (golden_visit("_wengflow_", compare_hold) == 0) skip();
}

/* -- drop_keep ------------------------------------------------------------------------------------------------------------- */

enum { DENSER = 400, FRAMES = 24 };

/* The frames' logarithms, straight between them, DENSER times as many, through v2e. */
static golden_stream simulate_dense(const tides_baseline_params *params, const golden_movie *m) {
    golden_stream s = {NULL, 0, 0};
    tides_baseline *baseline = NULL;
    double *L = golden_allocate(m->pixels, sizeof *L);
    assert_int_equal(tides_baseline_create(params, m->width, m->height, &baseline, NULL), TIDES_OK);
    for (size_t n = 0; n <= (m->frames - 1) * DENSER; n++) {
        size_t k = n == 0 ? 0 : (n - 1) / DENSER;
        double part = (double)(n - k * DENSER) / DENSER, time = m->t[k] + part * (m->t[k + 1] - m->t[k]);
        const double *Y0 = m->Y + k * m->pixels, *Y1 = Y0 + m->pixels;
        for (size_t i = 0; i < m->pixels; i++) L[i] = (1 - part) * log(Y0[i]) + part * log(Y1[i]);
        assert_int_equal(tides_baseline_push(baseline, time, L, golden_keep, &s, NULL), TIDES_OK);
    }
    assert_int_equal(tides_baseline_finish(baseline, golden_keep, &s, NULL), TIDES_OK);
    tides_baseline_destroy(baseline);
    free(L);
    return s;
}

/* Every other row and column of the first frames: the law is the pixel's, and denser frames cost. */
static golden_movie thin_out(const golden_movie *m) {
    golden_movie thin = {.frames = m->frames < FRAMES ? m->frames : FRAMES, .width = m->width / 2, .height = m->height / 2};
    thin.pixels = (size_t)thin.width * (size_t)thin.height;
    thin.Y = golden_allocate(thin.frames * thin.pixels, sizeof *thin.Y);
    thin.t = golden_allocate(thin.frames, sizeof *thin.t);
    for (size_t k = 0; k < thin.frames; k++) {
        thin.t[k] = m->t[k];
        for (size_t i = 0; i < thin.pixels; i++) {
            size_t x = 2 * (i % (size_t)thin.width), y = 2 * (i / (size_t)thin.width);
            thin.Y[k * thin.pixels + i] = m->Y[k * m->pixels + y * (size_t)m->width + x];
        }
    }
    return thin;
}

static void compare_keep(golden_file *g) {
    double period = golden_number(g->params, "refractory_period_s", 0);
    if (!(period > 0) || golden_number(g->params, "sigma_thres", 1) > 0 || golden_number(g->params, "cutoff_hz", 1) > 0) return;
    golden_movie thin = thin_out(g->movie);
    tides_baseline_params params = sensor_of(g->params, TIDES_REFRACTORY_DROP_KEEP, period), v2e = params;
    v2e.method = TIDES_METHOD_V2E;
    v2e.v2e = (tides_v2e){.pos_thres = params.sensor.threshold_on, .neg_thres = params.sensor.threshold_off, .hdr = 1};
    v2e.v2e.refractory_period = period;
    golden_stream theirs = simulate_dense(&v2e, &thin), ours = golden_simulate(&params, &thin);
    double dense_ns = 1e9 * (thin.t[1] - thin.t[0]) / DENSER;
    difference d = compare(&ours, &theirs, 20 * dense_ns, 0);
    report(g->name, &ours, &theirs, &d);
    assert_true((double)(d.missing + d.extra) <= 1e-3 * (double)theirs.count);
    assert_true(d.sum_ns / (double)d.matched <= dense_ns);
    free_both(&ours, &theirs);
    golden_movie_free(&thin);
    g->compared = 1;
}

static void drop_keep(void **state) {
    (void)state;
    if (golden_visit("_v2e_", compare_keep) == 0) skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(drop_consume), cmocka_unit_test(hold), cmocka_unit_test(drop_keep)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
