/* tides metrics: its result as JSON, and the table made from that. */
#include "metrics_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void add(cJSON *object, const char *name, double value) {
    if (isfinite(value))
        cJSON_AddNumberToObject(object, name, value);
    else
        cJSON_AddNullToObject(object, name);
}

/* "fano_200us" */
static const char *bin_name(const char *prefix, double bin_s, char name[48]) {
    const double us = round(1e6 * bin_s);
    if (us >= 1000 && fmod(us, 1000) == 0)
        snprintf(name, 48, "%s_%.0fms", prefix, us / 1000);
    else
        snprintf(name, 48, "%s_%.6gus", prefix, 1e6 * bin_s);
    return name;
}

static const char *pairs_name(const char *prefix, int pairs, char name[48]) {
    static const char *const kinds[TIDES_PAIRS] = {"", "_same", "_split"};
    snprintf(name, 48, "%s%s", prefix, kinds[pairs]);
    return name;
}

static cJSON *stream_json(const tides_stream_metrics *s, const tides_metrics_options *o) {
    cJSON *json = cJSON_CreateObject();
    char name[48];
    add(json, "events", (double)s->events);
    if (o->wanted & TIDES_METRIC_COUNTS) add(json, "on_fraction", s->on_fraction);
    for (int pairs = 0; pairs < TIDES_PAIRS && o->wanted & TIDES_METRIC_ISI; pairs++) {
        const tides_interval_fit *fit = &s->intervals[pairs];
        add(json, pairs_name("isi", pairs, name), (double)fit->count);
        add(json, pairs_name("isi_floored", pairs, name), (double)fit->floored);
        add(json, pairs_name("isi_mean_s", pairs, name), fit->mean_s);
        add(json, pairs_name("isi_shape_s", pairs, name), fit->shape_s);
    }
    if (o->wanted & TIDES_METRIC_ISI) add(json, "isi_spike", s->isi_spike);
    if (o->wanted & TIDES_METRIC_SAME_TIME) {
        add(json, "same_ts", s->same_time);
        add(json, "same_ts_tile", s->same_time_tile);
    }
    for (int i = 0; i < TIDES_FANO_BINS && o->wanted & TIDES_METRIC_FANO; i++)
        add(json, bin_name("fano", o->fano_bin_s[i], name), s->fano[i]);
    if (o->wanted & TIDES_METRIC_VAN_ROSSUM) add(json, "van_rossum_norm", s->van_rossum_norm);
    return json;
}

/* ---- the comparison, family by family ---- */

static void add_isi(cJSON *json, const tides_metrics *m) {
    char name[48];
    for (int pairs = 0; pairs < TIDES_PAIRS; pairs++) {
        add(json, pairs_name("ig_nll", pairs, name), m->ig_nll[pairs]);
        add(json, pairs_name("ig_nll_self", pairs, name), m->ig_nll_self[pairs]);
        add(json, pairs_name("ig_nll_excess", pairs, name), m->ig_nll_excess[pairs]);
    }
    add(json, "isi_w1_decades", m->isi_w1);
}

static void add_fano(cJSON *json, const tides_metrics *m, const tides_metrics_options *o) {
    char name[48];
    for (int i = 0; i < TIDES_FANO_BINS; i++) {
        add(json, bin_name("fano_error", o->fano_bin_s[i], name), m->fano_error[i]);
        add(json, bin_name("fano_tiles", o->fano_bin_s[i], name), (double)m->fano_tiles[i]);
        add(json, bin_name("fano_coverage", o->fano_bin_s[i], name), m->fano_coverage[i]);
    }
}

static void add_chamfer(cJSON *json, const tides_metrics *m) {
    add(json, "chamfer_px", m->chamfer_px);
    add(json, "chamfer_fraction", m->chamfer_fraction);
    add(json, "chamfer_to_simulated_px", m->chamfer_to_simulated_px);
    add(json, "chamfer_to_reference_px", m->chamfer_to_reference_px);
    add(json, "chamfer_limit_px", m->chamfer_limit_px);
    add(json, "chamfer_terms", (double)m->chamfer_terms);
    add(json, "chamfer_one_sided", (double)m->chamfer_one_sided);
    add(json, "speed_px_per_s", m->speed_px_per_s);
}

static void add_trains(cJSON *json, const tides_metrics *m, uint32_t wanted) {
    if (wanted & TIDES_METRIC_VICTOR_PURPURA) {
        add(json, "victor_purpura", m->victor_purpura);
        add(json, "victor_purpura_fraction", m->victor_purpura_fraction);
    }
    if (wanted & TIDES_METRIC_VAN_ROSSUM) {
        add(json, "van_rossum", m->van_rossum);
        add(json, "van_rossum_fraction", m->van_rossum_fraction);
    }
    if (wanted & TIDES_METRIC_TIME_DIFFERENCE) {
        add(json, "time_difference_us", m->time_difference_us);
        add(json, "time_difference_over", (double)m->time_difference_over);
    }
    if (wanted & TIDES_METRIC_KERNEL) add(json, "kernel_distance", m->kernel_distance);
}

static void add_match(cJSON *json, const tides_match *match) {
    add(json, "matched", (double)match->matched);
    add(json, "missing", (double)match->missing);
    add(json, "spurious", (double)match->spurious);
    add(json, "mismatch_percent", match->mismatch_percent);
    add(json, "dt_median_us", match->dt_median_us);
    add(json, "dt_p95_us", match->dt_p95_us);
    add(json, "dt_p99_us", match->dt_p99_us);
    add(json, "dt_max_us", match->dt_max_us);
    add(json, "dt_mean_us", match->dt_mean_us);
}

cJSON *cli_metrics_json(const tides_metrics *m, const tides_metrics_options *o) {
    cJSON *report = cJSON_CreateObject(), *json = cJSON_CreateObject();
    cJSON_AddItemToObject(report, "reference", stream_json(&m->reference, o));
    cJSON_AddItemToObject(report, "simulated", stream_json(&m->simulated, o));
    add(json, "width", m->width);
    add(json, "height", m->height);
    cli_add_ns(json, "start_ns", m->start_ns);
    cli_add_ns(json, "stop_ns", m->stop_ns);
    if (o->wanted & TIDES_METRIC_COUNTS) {
        add(json, "count_ratio", m->count_ratio);
        add(json, "count_correlation", m->count_correlation);
    }
    if (o->wanted & TIDES_METRIC_ISI) add_isi(json, m);
    if (o->wanted & TIDES_METRIC_FANO) add_fano(json, m, o);
    if (o->wanted & TIDES_METRIC_CHAMFER) add_chamfer(json, m);
    add_trains(json, m, o->wanted);
    if (o->wanted & TIDES_METRIC_MATCH) add_match(json, &m->match);
    cJSON_AddItemToObject(report, "comparison", json);
    return report;
}

/* ---- text ---- */

/* What a number of the comparison means, and which way is better: the first row whose name it begins with. A number that only
 * says what was compared has no better. */
static const struct {
    const char *name, *meaning;
} meanings[] = {
    {"width", "[px] compared"},
    {"height", "[px] compared"},
    {"start_ns", "the stretch compared"},
    {"stop_ns", "its end"},
    {"count_ratio", "simulated events / reference events; 1 is best"},
    {"count_correlation", "of events per pixel; 1 is best"},
    {"ig_nll_self", "the reference's intervals under their own fit: what ig_nll can be at least"},
    {"ig_nll_excess", "ig_nll above ig_nll_self: divergence of the laws of intervals; lower is better"},
    {"ig_nll", "[nats] the reference's intervals under a law fitted to the simulated ones; lower is better"},
    {"isi_w1", "distance of log10 intervals; lower is better, 1 is a factor of 10"},
    {"fano_error", "|ln| of the ratio of Fano factors (burstiness), mean of tiles; lower is better"},
    {"fano_tiles", "tiles that had enough events to be compared"},
    {"fano_coverage", "of the reference's tiles with enough events; 1 is best"},
    {"chamfer_px", "distance to the nearest event of the other stream in (x, y, v t); lower is better"},
    {"chamfer_fraction", "the same over the image's diagonal; lower is better"},
    {"chamfer_to_simulated", "from reference events: what the simulation misses; lower is better"},
    {"chamfer_to_reference", "from simulated events: what it invents; lower is better"},
    {"chamfer_limit", "what an event counts that has nothing near"},
    {"chamfer_terms", "windows of a polarity compared"},
    {"chamfer_one_sided", "of them with one stream empty; fewer is better"},
    {"speed", "v: found or given, turns seconds into pixels"},
    {"victor_purpura_fraction", "Victor-Purpura cost: 0 for equal trains, 1 where nothing is near; lower is better"},
    {"victor_purpura", "cost of shifting, adding, removing events until trains agree; lower is better"},
    {"van_rossum_fraction", "van Rossum distance: 0 for equal trains, 1 where nothing is near; lower is better"},
    {"van_rossum", "squared distance of smoothed trains; lower is better"},
    {"time_difference_us", "to the pixel's nearest event of that polarity, mean; lower is better"},
    {"time_difference_over", "reference events without one within the limit; fewer is better"},
    {"kernel_distance", "squared distance of the streams blurred in x, y and t; lower is better"},
    {"matched", "reference events found, one by one; more is better"},
    {"missing", "reference events not found; fewer is better"},
    {"spurious", "simulated events that the reference lacks; fewer is better"},
    {"mismatch", "(missing + spurious) / reference events; lower is better"},
    {"dt_mean", "simulated minus reference time of matched events: negative is early; 0 is best"},
    {"dt_", "|time difference| of matched events; lower is better"},
};

const char *cli_metric_meaning(const char *name) {
    for (size_t i = 0; i < sizeof meanings / sizeof *meanings; i++)
        if (strncmp(name, meanings[i].name, strlen(meanings[i].name)) == 0) return meanings[i].meaning;
    return NULL;
}

static const char *text_of(const cJSON *item, char text[32]) {
    if (cJSON_IsString(item) || cJSON_IsRaw(item)) return item->valuestring;
    if (!cJSON_IsNumber(item)) return "-";
    const double value = item->valuedouble;
    snprintf(text, 32, value == floor(value) && fabs(value) < 1e15 ? "%.0f" : "%.6g", value);
    return text;
}

void cli_metrics_print(const cJSON *report) {
    const cJSON *simulated = cJSON_GetObjectItemCaseSensitive(report, "simulated");
    char left[32], right[32];
    printf("%-26s %16s %16s\n", "", "reference", "simulated");
    for (const cJSON *a = cJSON_GetObjectItemCaseSensitive(report, "reference")->child; a; a = a->next)
        printf("%-26s %16s %16s\n", a->string, text_of(a, left),
               text_of(cJSON_GetObjectItemCaseSensitive(simulated, a->string), right));
    putchar('\n');
    for (const cJSON *a = cJSON_GetObjectItemCaseSensitive(report, "comparison")->child; a; a = a->next)
        printf("%-26s %16s  %s\n", a->string, text_of(a, left), cli_metric_meaning(a->string));
}
