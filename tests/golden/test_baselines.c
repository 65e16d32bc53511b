/* The baselines against the streams that the originals made from the same frames: NAME_*.npz in the folders of golden/ of the
 * shared data, each with its NAME_input_frames.npz (golden/simulators/README.md there).
 *
 *   rpg_esim, esim_py, ideal_linear   the same events, times within 2 us: float32 logarithms move theirs by that much; the times
 *                                     of esim_py's first interval are wrong (reference/simulators.md 1.2) and left out
 *   v2e                               the same events at each sub-time
 *   iebcs                             the same integers
 *   voltmeter                         without noise within 1 us; with noise the same law of intervals and number of events */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "baselines/td_baseline.h"
#include "solver/td_event_sort.h"
#include "tests/support/npz.h"
#include "tests/support/shared.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void *allocate(size_t count, size_t size) {
    void *memory = td_alloc(count, size, NULL);
    if (!memory) abort();
    return memory;
}

/* -- frames and streams ---------------------------------------------------------------------------------------------------- */

typedef struct movie {
    char path[1024];
    double *Y, *t;
    size_t frames, pixels;
    int32_t width, height;
} movie;

static int load_movie(movie *m, const char *path) {
    if (strcmp(m->path, path) == 0) return 0;
    free(m->Y);
    free(m->t);
    *m = (movie){.path = ""};
    npz *file = npz_open(path);
    const npz_array *Y = file ? npz_get(file, "Y") : NULL;
    if (Y && Y->ndim == 3) {
        m->frames = Y->shape[0];
        m->height = (int32_t)Y->shape[1];
        m->width = (int32_t)Y->shape[2];
        m->pixels = Y->shape[1] * Y->shape[2];
        m->Y = npz_doubles(file, "Y", NULL);
        m->t = npz_doubles(file, "t", NULL);
    }
    npz_close(file);
    if (!m->Y || !m->t) return -1;
    snprintf(m->path, sizeof m->path, "%s", path);
    return 0;
}

/* Events by (t, y, x, polarity). */
typedef struct stream {
    tides_event *events;
    size_t count, capacity;
} stream;

static int keep(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    void *grown = s->events;
    if (td_reserve(&grown, &s->capacity, s->count + count, sizeof *events, NULL) != TIDES_OK) abort();
    s->events = grown;
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

static int compare(const void *a, const void *b) { return td_event_compare(a, b); }

/* `unit`: nanoseconds per unit of the file's times. */
static stream read_stream(npz *file, double unit) {
    stream s = {NULL, 0, 0};
    double *t = npz_doubles(file, "t", &s.count), *x = npz_doubles(file, "x", NULL), *y = npz_doubles(file, "y", NULL);
    double *p = npz_doubles(file, "p", NULL);
    assert_true(t && x && y && p);
    s.events = allocate(s.count, sizeof *s.events);
    for (size_t k = 0; k < s.count; k++) {
        s.events[k].t = (int64_t)llround(unit * t[k]);
        s.events[k].x = (uint16_t)x[k];
        s.events[k].y = (uint16_t)y[k];
        s.events[k].polarity = (int8_t)(p[k] > 0 ? 1 : -1);
    }
    qsort(s.events, s.count, sizeof *s.events, compare);
    free(t);
    free(x);
    free(y);
    free(p);
    return s;
}

static stream simulate(const tides_baseline_params *params, const movie *m) {
    stream s = {NULL, 0, 0};
    tides_error error = {TIDES_OK, ""};
    tides_baseline *baseline = NULL;
    if (tides_baseline_create(params, m->width, m->height, &baseline, &error) != TIDES_OK) fail_msg("%s", error.text);
    for (size_t k = 0; k < m->frames; k++)
        if (tides_baseline_push(baseline, m->t[k], m->Y + k * m->pixels, keep, &s, &error) != TIDES_OK)
            fail_msg("%s", error.text);
    assert_int_equal(tides_baseline_finish(baseline, keep, &s, &error), TIDES_OK);
    tides_baseline_destroy(baseline);
    for (size_t k = 1; k < s.count; k++) assert_true(td_event_compare(&s.events[k - 1], &s.events[k]) <= 0);
    return s;
}

/* -- comparing ------------------------------------------------------------------------------------------------------------- */

/* By pixel, then as the stream is. */
static int compare_places(const void *a, const void *b) {
    const tides_event *left = a, *right = b;
    if (left->y != right->y) return left->y < right->y ? -1 : 1;
    if (left->x != right->x) return left->x < right->x ? -1 : 1;
    if (left->t != right->t) return left->t < right->t ? -1 : 1;
    return (left->polarity > right->polarity) - (left->polarity < right->polarity);
}

/* Same pixels and polarities in each pixel's order; the largest |dt| [ns] is at most `tolerance_ns`, but for events before
 * `from_ns`, whose times don't count. */
static void assert_same_order(const char *name, stream *ours, stream *theirs, double tolerance_ns, int64_t from_ns) {
    double most = 0;
    size_t differ = 0;
    qsort(ours->events, ours->count, sizeof *ours->events, compare_places);
    qsort(theirs->events, theirs->count, sizeof *theirs->events, compare_places);
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
static void assert_same_groups(const char *name, const stream *ours, const stream *theirs, double tolerance_ns) {
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

static int compare_doubles(const void *a, const void *b) {
    double left = *(const double *)a, right = *(const double *)b;
    return left < right ? -1 : left > right;
}

/* Intervals between a pixel's events, in whole microseconds, ascending. */
static double *intervals(stream *s, size_t *count) {
    double *made = allocate(s->count + 1, sizeof *made);
    *count = 0;
    qsort(s->events, s->count, sizeof *s->events, compare_places);
    for (size_t k = 1; k < s->count; k++) {
        const tides_event *a = &s->events[k - 1], *b = &s->events[k];
        if (a->x == b->x && a->y == b->y) made[(*count)++] = nearbyint(1e-3 * (double)b->t) - nearbyint(1e-3 * (double)a->t);
    }
    qsort(made, *count, sizeof *made, compare_doubles);
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

static double number(const cJSON *params, const char *key, double otherwise) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(params, key);
    return cJSON_IsNumber(item) ? item->valuedouble : otherwise;
}

typedef struct golden {
    const char *name;
    const movie *movie;
    npz *file;
    const cJSON *params;
    int compared;
} golden;

static void run_esim(golden *g, double unit, double to_ns, int64_t from_ns) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_ESIM;
    tides_esim *p = &params.esim;
    p->contrast_threshold_pos = number(g->params, "Cp", number(g->params, "contrast_threshold_pos", NAN));
    p->contrast_threshold_neg =
        number(g->params, "Cm", number(g->params, "Cn", number(g->params, "contrast_threshold_neg", NAN)));
    p->contrast_threshold_sigma_pos = p->contrast_threshold_sigma_neg = number(g->params, "sigma_Cp", 0);
    if (p->contrast_threshold_sigma_pos > 0) return; /* drawn at random */
    p->refractory_period_ns = number(g->params, "refractory_period_ns", to_ns * number(g->params, "refractory_period", 0));
    p->log_eps = number(g->params, "log_eps", NAN);
    stream theirs = read_stream(g->file, unit), ours = simulate(&params, g->movie);
    assert_same_order(g->name, &ours, &theirs, 2000.0, from_ns);
    free(theirs.events);
    free(ours.events);
    g->compared = 1;
}

static void run_v2e(golden *g) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_V2E;
    tides_v2e *p = &params.v2e;
    p->pos_thres = number(g->params, "pos_thres", NAN);
    p->neg_thres = number(g->params, "neg_thres", NAN);
    p->sigma_thres = number(g->params, "sigma_thres", NAN);
    p->cutoff_hz = number(g->params, "cutoff_hz", NAN);
    p->leak_rate_hz = number(g->params, "leak_rate_hz", NAN);
    p->leak_jitter_fraction = number(g->params, "leak_jitter_fraction", 0.1);
    p->noise_rate_cov_decades = number(g->params, "noise_rate_cov_decades", 0.1);
    p->refractory_period = number(g->params, "refractory_period_s", NAN);
    p->shot_noise_rate_hz = number(g->params, "shot_noise_rate_hz", NAN);
    p->cs_lambda_pixels = number(g->params, "cs_lambda_pixels", 0);
    p->cs_tau_p_ms = number(g->params, "cs_tau_p_ms", 0);
    p->float32_timestamps = 1;
    int leaks_alike = !(p->leak_rate_hz > 0) || (p->leak_jitter_fraction == 0 && p->noise_rate_cov_decades == 0);
    if (p->sigma_thres > 0 || p->shot_noise_rate_hz > 0 || !leaks_alike) return;
    stream theirs = read_stream(g->file, 1e9), ours = simulate(&params, g->movie);
    assert_same_groups(g->name, &ours, &theirs, 0.0);
    free(theirs.events);
    free(ours.events);
    g->compared = 1;
}

static void run_iebcs(golden *g) {
    tides_baseline_params params;
    tides_baseline_params_defaults(&params);
    params.method = TIDES_METHOD_IEBCS;
    tides_iebcs *p = &params.iebcs;
    p->th_pos = number(g->params, "th_pos", NAN);
    p->th_neg = number(g->params, "th_neg", NAN);
    p->th_noise = number(g->params, "th_noise", NAN);
    p->lat = number(g->params, "lat", NAN);
    p->jit = number(g->params, "jit", NAN);
    p->ref = number(g->params, "ref", NAN);
    p->tau = number(g->params, "tau", NAN);
    if (p->th_noise > 0 || p->jit > 0 || number(g->params, "bgnp", 1) > 1e-6) return;
    p->bgnp = p->bgnn = 0; /* one event in 30 years */
    if (strstr(g->name, "_syncarb")) p->arbiter = TIDES_ARBITER_SYNCHRONOUS;
    stream theirs = read_stream(g->file, 1e3), ours = simulate(&params, g->movie);
    assert_same_groups(g->name, &ours, &theirs, 0.0);
    free(theirs.events);
    free(ours.events);
    g->compared = 1;
}

/* With noise: intervals by Kolmogorov and Smirnov, and the count within three standard deviations of what seeds give. */
static void compare_noisy(golden *g, tides_baseline_params *params, stream *theirs) {
    enum { SEEDS = 6 };
    double sum = 0, squares = 0, chance = 0;
    for (int seed = 0; seed < SEEDS; seed++) {
        params->seed = (uint64_t)seed;
        stream ours = simulate(params, g->movie);
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

static void run_voltmeter(golden *g) {
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
    stream theirs = read_stream(g->file, 1e3);
    if (noisy) {
        compare_noisy(g, &params, &theirs);
    } else {
        stream ours = simulate(&params, g->movie);
        for (size_t n = 0; n < ours.count; n++)
            ours.events[n].t = 1000 * llround(1e-3 * (double)ours.events[n].t); /* as theirs */
        assert_same_order(g->name, &ours, &theirs, 1000.0, 0);
        free(ours.events);
    }
    free(theirs.events);
    g->compared = 1;
}

/* -- the folders ----------------------------------------------------------------------------------------------------------- */

typedef struct visit {
    const char *method; /* part of the names to take */
    movie movie;
    size_t compared;
} visit;

static void run_file(const char *method, golden *g) {
    if (strstr(method, "ideal_linear")) run_esim(g, 1e9, 1e9, 0);
    if (strstr(method, "rpg_esim")) run_esim(g, 1, 1, 0);
    if (strstr(method, "esim_py")) run_esim(g, 1e9, 1e9, llround(1e9 * g->movie->t[1]));
    if (strstr(method, "v2e")) run_v2e(g);
    if (strstr(method, "iebcs")) run_iebcs(g);
    if (strstr(method, "voltmeter")) run_voltmeter(g);
}

static int visit_file(void *user, const char *path, const char *name) {
    visit *v = user;
    char frames[1024], text[4096];
    struct stat facts;
    if (!strstr(name, v->method)) return 0;
    int folder = (int)(strlen(path) - strlen(name)), prefix = (int)strcspn(name, "_");
    int length = snprintf(frames, sizeof frames, "%.*s%.*s_input_frames.npz", folder, path, prefix, name);
    if (length < 0 || (size_t)length >= sizeof frames || stat(frames, &facts) != 0) return 0;
    npz *file = npz_open(path);
    assert_non_null(file);
    npz_string(file, "params", text, sizeof text);
    cJSON *params = cJSON_Parse(text);
    const cJSON *scene = cJSON_GetObjectItemCaseSensitive(params, "scene");
    /* Scene A comes back to its levels exactly: there rounding decides what fires (reference/simulators.md 3). */
    if (!cJSON_IsString(scene) || strcmp(scene->valuestring, "A") != 0) {
        if (load_movie(&v->movie, frames) != 0) fail_msg("%s: can't be read as frames", frames);
        golden g = {name, &v->movie, file, params, 0};
        run_file(v->method, &g);
        v->compared += (size_t)g.compared;
    }
    cJSON_Delete(params);
    npz_close(file);
    return 0;
}

static int visit_folder(void *user, const char *path, const char *name) {
    (void)name;
    shared_scan(path, ".npz", visit_file, user);
    return 0;
}

static void compare_method(const char *method) {
    char root[1024];
    visit v = {.method = method};
    if (shared_path(root, sizeof root, "golden") == 0) shared_scan(root, "", visit_folder, &v);
    free(v.movie.Y);
    free(v.movie.t);
    if (v.compared == 0) skip();
}

static void ideal_linear(void **state) {
    (void)state;
    compare_method("_ideal_linear_");
}

static void rpg_esim(void **state) {
    (void)state;
    compare_method("_rpg_esim_");
}

static void esim_py(void **state) {
    (void)state;
    compare_method("_esim_py_");
}

static void v2e(void **state) {
    (void)state;
    compare_method("_v2e_");
}

static void iebcs(void **state) {
    (void)state;
    compare_method("_iebcs_");
}

static void voltmeter(void **state) {
    (void)state;
    compare_method("_voltmeter_");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ideal_linear), cmocka_unit_test(rpg_esim), cmocka_unit_test(esim_py),
        cmocka_unit_test(v2e),          cmocka_unit_test(iebcs),    cmocka_unit_test(voltmeter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
