/* Every value of $TIDES_SHARED/golden/metrics, to 1e-9 of it, and null where it is undefined. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/metrics.h"

#include "tests/support/npz.h"
#include "tests/support/golden_folder.h"
#include "tests/support/metrics_of.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOLERANCE 1e-9
enum { TEXT = 8192 };

typedef struct stream {
    tides_event *events;
    size_t count;
} stream;

/* The columns PREFIX_t [us], _x, _y, _p (0, 1). */
static stream read_stream(npz *archive, const char *prefix) {
    static const char *const columns[] = {"t", "x", "y", "p"};
    double *values[4];
    stream made = {NULL, 0};
    for (int i = 0; i < 4; i++) {
        char name[32];
        size_t count = 0;
        snprintf(name, sizeof name, "%s_%s", prefix, columns[i]);
        values[i] = npz_doubles(archive, name, &count);
        assert_non_null(values[i]);
        if (i) assert_int_equal(count, made.count);
        made.count = count;
    }
    made.events = calloc(made.count + 1, sizeof *made.events);
    assert_non_null(made.events);
    for (size_t i = 0; i < made.count; i++)
        made.events[i] = (tides_event){.t = llround(1e3 * values[0][i]),
                                       .x = (uint16_t)values[1][i],
                                       .y = (uint16_t)values[2][i],
                                       .polarity = values[3][i] > 0 ? 1 : -1};
    for (int i = 0; i < 4; i++) free(values[i]);
    return made;
}

static cJSON *read_json(npz *archive, const char *name) {
    char text[TEXT];
    npz_string(archive, name, text, sizeof text);
    cJSON *json = cJSON_Parse(text);
    if (!json) fail_msg("%s is no JSON", name);
    return json;
}

static double number(const cJSON *params, const char *name) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(params, name);
    if (!cJSON_IsNumber(item)) fail_msg("params has no %s", name);
    return item->valuedouble;
}

static tides_metrics_options read_options(const cJSON *params) {
    tides_metrics_options o;
    tides_metrics_options_defaults(&o);
    o.wanted = TIDES_METRICS_ALL & ~(uint32_t)TIDES_METRIC_KERNEL;
    o.width = (int32_t)number(params, "width");
    o.height = (int32_t)number(params, "height");
    o.start_ns = llround(1e3 * number(params, "t0"));
    o.stop_ns = llround(1e3 * number(params, "t1"));
    o.speed_px_per_s = number(params, "v");
    o.window_s = 1e-6 * number(params, "window");
    o.cell_px = number(params, "h");
    o.fano_tile_px = (int32_t)number(params, "tile");
    o.fano_bin_s[0] = 1e-6 * number(params, "fano_dt");
    o.fano_events_min = (int32_t)number(params, "fano_n_min");
    o.fano_epsilon = number(params, "fano_eps");
    o.isi_floor_s = 1e-6 * number(params, "tau_floor_us");
    return o;
}

/* ---- the values by their names in the files ---- */

typedef struct value {
    const char *name;
    double got;
} value;

enum { VALUES_MAX = 80 };

typedef struct list {
    value values[VALUES_MAX];
    size_t count;
} list;

static void add(list *l, const char *name, double got) {
    assert_true(l->count < VALUES_MAX);
    l->values[l->count++] = (value){name, got};
}

static void add_streams(list *l, const tides_metrics *m) {
    const tides_stream_metrics *a = &m->reference, *b = &m->simulated;
    const tides_interval_fit *fit_a = &a->intervals[TIDES_PAIRS_ANY], *fit_b = &b->intervals[TIDES_PAIRS_ANY];
    add(l, "n_real", (double)a->events), add(l, "n_sim", (double)b->events);
    add(l, "mu_real", fit_a->mean_s), add(l, "mu_sim", fit_b->mean_s);
    add(l, "lam_real", fit_a->shape_s), add(l, "lam_sim", fit_b->shape_s);
    add(l, "n_isi_real", (double)fit_a->count), add(l, "n_isi_sim", (double)fit_b->count);
    add(l, "n_floored_real", (double)fit_a->floored), add(l, "n_floored_sim", (double)fit_b->floored);
    add(l, "same_ts_real", a->same_time), add(l, "same_ts_sim", b->same_time);
    add(l, "same_ts16_real", a->same_time_tile), add(l, "same_ts16_sim", b->same_time_tile);
    add(l, "isi_spike_real", a->isi_spike), add(l, "isi_spike_sim", b->isi_spike);
    add(l, "fano_real", a->fano[0]), add(l, "fano_sim", b->fano[0]);
    add(l, "on_frac_real", a->on_fraction), add(l, "on_frac_sim", b->on_fraction);
}

static void add_comparisons(list *l, const tides_metrics *m) {
    add(l, "ig_nll", m->ig_nll[0]), add(l, "ig_nll_self", m->ig_nll_self[0]), add(l, "ig_nll_excess", m->ig_nll_excess[0]);
    add(l, "ig_nll_any", m->ig_nll[TIDES_PAIRS_ANY]), add(l, "ig_nll_excess_any", m->ig_nll_excess[TIDES_PAIRS_ANY]);
    add(l, "ig_nll_same", m->ig_nll[TIDES_PAIRS_SAME]), add(l, "ig_nll_excess_same", m->ig_nll_excess[TIDES_PAIRS_SAME]);
    add(l, "ig_nll_split", m->ig_nll[TIDES_PAIRS_SPLIT]), add(l, "ig_nll_excess_split", m->ig_nll_excess[TIDES_PAIRS_SPLIT]);
    add(l, "chamfer_px", m->chamfer_px), add(l, "chamfer_norm", m->chamfer_fraction), add(l, "d_max", m->chamfer_limit_px);
    add(l, "r2s", m->chamfer_to_simulated_px), add(l, "s2r", m->chamfer_to_reference_px);
    add(l, "n_terms", (double)m->chamfer_terms), add(l, "one_sided", (double)m->chamfer_one_sided);
    add(l, "fano_error", m->fano_error[0]), add(l, "fano_coverage", m->fano_coverage[0]);
    add(l, "fano_bins", (double)m->fano_tiles[0]);
    add(l, "count_ratio", m->count_ratio), add(l, "count_corr", m->count_correlation), add(l, "w1_log10_isi", m->isi_w1);
    add(l, "v2ce_tdiff_us", m->time_difference_us), add(l, "v2ce_overflow", (double)m->time_difference_over);
}

static double find(const list *l, const char *name) {
    for (size_t i = 0; i < l->count; i++)
        if (strcmp(l->values[i].name, name) == 0) return l->values[i].got;
    fail_msg("no value is called %s", name);
    return NAN;
}

/* ---- comparison ---- */

static tides_metrics compare(const stream *a, const stream *b, const tides_metrics_options *options) {
    return metrics_of(a->events, a->count, b->events, b->count, options);
}

/* The kernel is quadratic, and a clock another definition of the spike ratio: computed where the file has them. */
static void add_special(list *l, const stream *a, const stream *b, tides_metrics_options options, const cJSON *expected) {
    options.clock_s = 1e-3;
    options.wanted = TIDES_METRIC_ISI;
    add(l, "isi_spike_clock1000_sim", compare(a, b, &options).simulated.isi_spike);
    options.wanted = TIDES_METRIC_KERNEL;
    if (cJSON_HasObjectItem(expected, "kernel2_signed")) add(l, "kernel2_signed", compare(a, b, &options).kernel_distance);
}

static void check_value(const char *file, const cJSON *expected, double got) {
    if (cJSON_IsNull(expected)) {
        if (!isnan(got)) fail_msg("%s: %s is %.17g, but undefined", file, expected->string, got);
        return;
    }
    const double wanted = expected->valuedouble;
    assert_true(cJSON_IsNumber(expected));
    if (!(fabs(got - wanted) <= TOLERANCE * fabs(wanted)))
        fail_msg("%s: %s is %.17g, expected %.17g", file, expected->string, got, wanted);
}

static int check_file(void *user, const char *path, const char *file) {
    size_t *checked = user;
    npz *archive = npz_open(path);
    assert_non_null(archive);
    stream a = read_stream(archive, "real"), b = read_stream(archive, "sim");
    cJSON *params = read_json(archive, "params"), *expected = read_json(archive, "expected");
    const tides_metrics_options options = read_options(params);
    const tides_metrics m = compare(&a, &b, &options);
    list l = {.count = 0};
    add_streams(&l, &m);
    add_comparisons(&l, &m);
    add_special(&l, &a, &b, options, expected);
    for (const cJSON *item = expected->child; item; item = item->next, ++*checked)
        check_value(file, item, find(&l, item->string));
    cJSON_Delete(params);
    cJSON_Delete(expected);
    free(a.events);
    free(b.events);
    npz_close(archive);
    return 0;
}

static void every_value_of_every_file(void **state) {
    (void)state;
    size_t values = 0;
    const size_t files = golden_folder("golden/metrics", ".npz", check_file, &values);
    print_message("%zu values of %zu files\n", values, files);
    assert_true(values > files);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_value_of_every_file)};
    return cmocka_run_group_tests_name("metrics golden", tests, NULL, NULL);
}
