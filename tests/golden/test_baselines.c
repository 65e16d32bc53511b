/* The baselines against the streams that the originals made from the same frames: NAME_*.npz in the folders of golden/ of the
 * shared data, each with its NAME_input_frames.npz.
 *
 *   rpg_esim, esim_py, ideal_linear   the same events, times within 2 us: float32 logarithms move theirs by that much. Times of
 *                                     esim_py's first interval are wrong (its reference and its last image are one array then),
 *                                     and left out
 *   v2e                               the same events at each sub-time
 *   iebcs                             the same integers
 *   voltmeter                         without noise within 1 us; with noise the same law of intervals and number of events */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/golden_events.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- comparing ------------------------------------------------------------------------------------------------------------- */

/* Same pixels and polarities in each pixel's order; the largest |dt| [ns] is at most `tolerance_ns`, but for events before
 * `from_ns`, whose times don't count. */
static void assert_same_order(const char *name, golden_stream *ours, golden_stream *theirs, double tolerance_ns,
                              int64_t from_ns) {
    double most = 0;
    size_t differ = 0;
    qsort(ours->events, ours->count, sizeof *ours->events, golden_compare_places);
    qsort(theirs->events, theirs->count, sizeof *theirs->events, golden_compare_places);
    for (size_t k = 0; k < ours->count && k < theirs->count; k++) {
        const tides_event *a = &ours->events[k], *b = &theirs->events[k];
        differ += a->x != b->x || a->y != b->y || a->polarity != b->polarity;
        if (differ == 0 && a->t >= from_ns) most = fmax(most, fabs((double)(a->t - b->t)));
    }
    print_message("%s: %zu events, ours %zu, |dt| at most %.1f ns\n", name, theirs->count, ours->count, most);
    assert_int_equal(ours->count, theirs->count);
    assert_int_equal(differ, 0);
    assert_true(most <= tolerance_ns);
}

/* The same events at each distinct time, and the times within `tolerance_ns`; both sorted by time. */
static void assert_same_groups(const char *name, const golden_stream *ours, const golden_stream *theirs, double tolerance_ns) {
    double most = 0;
    size_t differ = 0;
    for (size_t k = 0; k < ours->count && k < theirs->count; k++) {
        const tides_event *a = &ours->events[k], *b = &theirs->events[k];
        int boundary_ours = k > 0 && a->t != a[-1].t, boundary_theirs = k > 0 && b->t != b[-1].t;
        if (boundary_ours != boundary_theirs || a->x != b->x || a->y != b->y || a->polarity != b->polarity) {
            if (differ++ < 5)
                print_message("  event %zu: ours %lld (%d,%d) %d theirs %lld (%d,%d) %d\n", k, (long long)a->t, a->x, a->y,
                              a->polarity, (long long)b->t, b->x, b->y, b->polarity);
        }
        most = fmax(most, fabs((double)(a->t - b->t)));
    }
    print_message("%s: %zu events, ours %zu, |dt| at most %.1f ns, %zu differ\n", name, theirs->count, ours->count, most,
                  differ);
    assert_int_equal(ours->count, theirs->count);
    assert_int_equal(differ, 0);
    assert_true(most <= tolerance_ns);
}

/* Intervals between a pixel's events, in whole microseconds, ascending. */
static double *intervals(golden_stream *s, size_t *count) {
    double *made = golden_allocate(s->count + 1, sizeof *made);
    *count = 0;
    qsort(s->events, s->count, sizeof *s->events, golden_compare_places);
    for (size_t k = 1; k < s->count; k++) {
        const tides_event *a = &s->events[k - 1], *b = &s->events[k];
        if (a->x == b->x && a->y == b->y) made[(*count)++] = nearbyint(1e-3 * (double)b->t) - nearbyint(1e-3 * (double)a->t);
    }
    qsort(made, *count, sizeof *made, td_ascending);
    return made;
}

/* Two-sample Kolmogorov-Smirnov: the asymptotic probability of a distance this large. */
static double ks_probability(const double *a, size_t n, const double *b, size_t m) {
    double most = 0, p = 0;
    for (size_t i = 0, j = 0; i < n && j < m;) {
        double at = fmin(a[i], b[j]);
        while (i < n && a[i] <= at) i++;
        while (j < m && b[j] <= at) j++;
        most = fmax(most, fabs((double)i / (double)n - (double)j / (double)m));
    }
    double lambda = most * sqrt((double)n * (double)m / (double)(n + m));
    for (int k = 1; k <= 100; k++) p += (k % 2 ? 2 : -2) * exp(-2.0 * k * k * lambda * lambda);
    return lambda < 0.2 ? 1.0 : fmin(1.0, p);
}

/* -- the methods ----------------------------------------------------------------------------------------------------------- */

static void run_esim(golden_file *g, double unit, double to_ns, int64_t from_ns) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_ESIM;
    tides_esim *p = &params.esim;
    p->contrast_threshold_pos = golden_number(g->params, "Cp", golden_number(g->params, "contrast_threshold_pos", NAN));
    p->contrast_threshold_neg =
        golden_number(g->params, "Cm", golden_number(g->params, "Cn", golden_number(g->params, "contrast_threshold_neg", NAN)));
    p->contrast_threshold_sigma_pos = p->contrast_threshold_sigma_neg = golden_number(g->params, "sigma_Cp", 0);
    if (p->contrast_threshold_sigma_pos > 0) return; /* drawn at random */
    p->refractory_period_ns =
        golden_number(g->params, "refractory_period_ns", to_ns * golden_number(g->params, "refractory_period", 0));
    p->log_eps = golden_number(g->params, "log_eps", NAN);
    golden_stream theirs = golden_stream_read(g->file, unit), ours = golden_simulate(&params, g->movie);
    assert_same_order(g->name, &ours, &theirs, 2000.0, from_ns);
    free(theirs.events);
    free(ours.events);
    g->compared = 1;
}

static void run_v2e(golden_file *g) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_V2E;
    tides_v2e *p = &params.v2e;
    p->pos_thres = golden_number(g->params, "pos_thres", NAN);
    p->neg_thres = golden_number(g->params, "neg_thres", NAN);
    p->sigma_thres = golden_number(g->params, "sigma_thres", NAN);
    p->cutoff_hz = golden_number(g->params, "cutoff_hz", NAN);
    p->leak_rate_hz = golden_number(g->params, "leak_rate_hz", NAN);
    p->leak_jitter_fraction = golden_number(g->params, "leak_jitter_fraction", 0.1);
    p->noise_rate_cov_decades = golden_number(g->params, "noise_rate_cov_decades", 0.1);
    p->refractory_period = golden_number(g->params, "refractory_period_s", NAN);
    p->shot_noise_rate_hz = golden_number(g->params, "shot_noise_rate_hz", NAN);
    p->cs_lambda_pixels = golden_number(g->params, "cs_lambda_pixels", 0);
    p->cs_tau_p_ms = golden_number(g->params, "cs_tau_p_ms", 0);
    p->float32_timestamps = 1;
    int leaks_alike = !(p->leak_rate_hz > 0) || (p->leak_jitter_fraction == 0 && p->noise_rate_cov_decades == 0);
    if (p->sigma_thres > 0 || p->shot_noise_rate_hz > 0 || !leaks_alike) return;
    golden_stream theirs = golden_stream_read(g->file, 1e9), ours = golden_simulate(&params, g->movie);
    assert_same_groups(g->name, &ours, &theirs, 0.0);
    free(theirs.events);
    free(ours.events);
    g->compared = 1;
}

static void run_iebcs(golden_file *g) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_IEBCS;
    tides_iebcs *p = &params.iebcs;
    p->th_pos = golden_number(g->params, "th_pos", NAN);
    p->th_neg = golden_number(g->params, "th_neg", NAN);
    p->th_noise = golden_number(g->params, "th_noise", NAN);
    p->lat = golden_number(g->params, "lat", NAN);
    p->jit = golden_number(g->params, "jit", NAN);
    p->ref = golden_number(g->params, "ref", NAN);
    p->tau = golden_number(g->params, "tau", NAN);
    if (p->th_noise > 0 || p->jit > 0 || golden_number(g->params, "bgnp", 1) > 1e-6) return;
    p->bgnp = p->bgnn = 0; /* one event in 30 years */
    if (strstr(g->name, "_syncarb")) p->arbiter = TIDES_ARBITER_SYNCHRONOUS;
    golden_stream theirs = golden_stream_read(g->file, 1e3), ours = golden_simulate(&params, g->movie);
    assert_same_groups(g->name, &ours, &theirs, 0.0);
    free(theirs.events);
    free(ours.events);
    g->compared = 1;
}

/* With noise: intervals by Kolmogorov and Smirnov, and the count within three standard deviations of what seeds give. */
static void compare_noisy(golden_file *g, tides_baseline_params *params, golden_stream *theirs) {
    enum { SEEDS = 6 };
    double sum = 0, squares = 0, chance = 0;
    for (int seed = 0; seed < SEEDS; seed++) {
        params->seed = (uint64_t)seed;
        golden_stream ours = golden_simulate(params, g->movie);
        sum += (double)ours.count;
        squares += (double)ours.count * (double)ours.count;
        size_t n, m;
        double *a = intervals(&ours, &n), *b = intervals(theirs, &m);
        if (seed == 0) chance = ks_probability(a, n, b, m);
        free(a);
        free(b);
        free(ours.events);
    }
    double mean = sum / SEEDS,
           deviation = sqrt(fmax(0.0, squares / SEEDS - mean * mean) * SEEDS / (SEEDS - 1) * (1 + 1.0 / SEEDS));
    print_message("%s: %zu events, ours %.1f +- %.1f (seeds 0 to %d), KS p %.3f\n", g->name, theirs->count, mean, deviation,
                  SEEDS - 1, chance);
    assert_true(chance > 0.01);
    assert_true(fabs((double)theirs->count - mean) <= 3 * fmax(deviation, 1.0)); /* a count is whole */
}

static void run_voltmeter(golden_file *g) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_VOLTMETER;
    double *k[6] = {&params.voltmeter.k1, &params.voltmeter.k2, &params.voltmeter.k3,
                    &params.voltmeter.k4, &params.voltmeter.k5, &params.voltmeter.k6};
    const cJSON *K = cJSON_GetObjectItemCaseSensitive(g->params, "K");
    for (int i = 0; i < 6; i++) {
        const cJSON *item = cJSON_GetArrayItem(K, i);
        assert_true(cJSON_IsNumber(item));
        *k[i] = item->valuedouble;
    }
    int noisy = params.voltmeter.k3 > 0 || params.voltmeter.k6 > 1e-8;
    golden_stream theirs = golden_stream_read(g->file, 1e3);
    if (noisy) {
        compare_noisy(g, &params, &theirs);
    } else {
        golden_stream ours = golden_simulate(&params, g->movie);
        for (size_t n = 0; n < ours.count; n++)
            ours.events[n].t = 1000 * llround(1e-3 * (double)ours.events[n].t); /* as theirs */
        assert_same_order(g->name, &ours, &theirs, 1000.0, 0);
        free(ours.events);
    }
    free(theirs.events);
    g->compared = 1;
}

/* -- by file name ---------------------------------------------------------------------------------------------------------- */

static void run_ideal_linear(golden_file *g) { run_esim(g, 1e9, 1e9, 0); }

static void run_rpg_esim(golden_file *g) { run_esim(g, 1, 1, 0); }

static void run_esim_py(golden_file *g) { run_esim(g, 1e9, 1e9, llround(1e9 * g->movie->t[1])); }

static void compare_method(const char *part, void (*run)(golden_file *g)) {
    if (golden_visit(part, run) == 0) skip();
}

static void ideal_linear(void **state) {
    (void)state;
    compare_method("_ideal_linear_", run_ideal_linear);
}

static void rpg_esim(void **state) {
    (void)state;
    compare_method("_rpg_esim_", run_rpg_esim);
}

static void esim_py(void **state) {
    (void)state;
    compare_method("_esim_py_", run_esim_py);
}

static void v2e(void **state) {
    (void)state;
    compare_method("_v2e_", run_v2e);
}

static void iebcs(void **state) {
    (void)state;
    compare_method("_iebcs_", run_iebcs);
}

static void voltmeter(void **state) {
    (void)state;
    compare_method("_voltmeter_", run_voltmeter);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ideal_linear), cmocka_unit_test(rpg_esim), cmocka_unit_test(esim_py),
        cmocka_unit_test(v2e),          cmocka_unit_test(iebcs),    cmocka_unit_test(voltmeter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
