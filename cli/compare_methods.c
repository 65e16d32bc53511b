/* The methods of a comparison: what makes each an ideal pixel with the run's thresholds, and running it.
 *
 * An ideal pixel fires where the logarithm has moved by the threshold since its last event, and does nothing else: no noise, no
 * spread, no latency, no low-pass, no refractory period. What is left of a method then is how it sees the image and where it
 * puts events in time. */
#include "compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- settings ------------------------------------------------------------------------------------------------------------ */

/* What a method's settings are made from. */
typedef struct pixel {
    double on, off, log_eps;
} pixel;

/* "key=value" texts for tides_session_vary. */
enum { SETTINGS_MAX = 24 };
typedef struct settings {
    char texts[SETTINGS_MAX][80];
    int32_t count;
} settings;

static void set(settings *s, const char *key, double value) {
    snprintf(s->texts[s->count++], sizeof s->texts[0], "%s=%.12g", key, value);
}

static void put(settings *s, const char *key, const char *value) {
    snprintf(s->texts[s->count++], sizeof s->texts[0], "%s%s", key, value);
}

static void zero(settings *s, const char *const *keys) {
    for (; *keys; keys++) set(s, *keys, 0);
}

static void ideal_tides(settings *s, const pixel *p) {
    static const char *const off[] = {"sensor.threshold_sigma",
                                      "sensor.refractory_s",
                                      "sensor.leak_rate_hz",
                                      "sensor.b_min",
                                      "sensor.dead_pixel_fraction",
                                      "frontend.psf_sigma_px",
                                      "frontend.photoreceptor_cutoff_hz",
                                      "frontend.shot_noise_hz",
                                      "frontend.noise_rms",
                                      "frontend.hot_pixel_fraction",
                                      NULL};
    static const char *const texts[] = {"sensor.preset=null", "frontend.bandwidth=first_order", "frontend.center_surround=null",
                                        "readout.enabled=false"};
    set(s, "sensor.threshold_on", p->on);
    set(s, "sensor.threshold_off", p->off);
    zero(s, off);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) put(s, texts[i], "");
}

static void threshold_esim(settings *s, const pixel *p) {
    set(s, "esim.contrast_threshold_pos", p->on);
    set(s, "esim.contrast_threshold_neg", p->off);
}

static void ideal_esim(settings *s, const pixel *p) {
    static const char *const off[] = {"esim.contrast_threshold_sigma_pos", "esim.contrast_threshold_sigma_neg",
                                      "esim.refractory_period_ns", NULL};
    set(s, "esim.log_eps", p->log_eps);
    zero(s, off);
}

static void threshold_v2e(settings *s, const pixel *p) {
    set(s, "v2e.pos_thres", p->on);
    set(s, "v2e.neg_thres", p->off);
}

static void ideal_v2e(settings *s, const pixel *p) {
    static const char *const off[] = {"v2e.sigma_thres",
                                      "v2e.cutoff_hz",
                                      "v2e.leak_rate_hz",
                                      "v2e.shot_noise_rate_hz",
                                      "v2e.refractory_period",
                                      "v2e.cs_lambda_pixels",
                                      NULL};
    (void)p;
    zero(s, off);
    put(s, "v2e.photoreceptor_noise=", "false");
}

/* DN / (DN + k2) is ln(Y + k2 / 255) to second order of a step, and the barriers are at +-1: k1 is the inverse threshold, and
 * there is only one, so that the mean of both is taken. */
static void threshold_voltmeter(settings *s, const pixel *p) { set(s, "voltmeter.k1", 2 / (p->on + p->off)); }

static void ideal_voltmeter(settings *s, const pixel *p) {
    static const char *const off[] = {"voltmeter.k3", "voltmeter.k4", "voltmeter.k5", NULL};
    set(s, "voltmeter.k2", fmax(255 * p->log_eps, 1e-6));
    zero(s, off);
    set(s, "voltmeter.k6", 1e-9); /* the original gives nothing at 0, so that this is its "no noise" */
}

static void threshold_iebcs(settings *s, const pixel *p) {
    set(s, "iebcs.th_pos", p->on);
    set(s, "iebcs.th_neg", p->off);
}

/* ln(scale Y + 1) is ln(Y + log_eps) but for a constant where the scale is 1 / log_eps. The time constant goes with the inverse
 * of light: at Y = 1 it is as short as with IEBCS's own parameters. Shorter, and a reference taken at a whole microsecond would
 * no longer be that of the event. */
static void ideal_iebcs(settings *s, const pixel *p) {
    tides_baseline_params defaults;
    tides_baseline_params_defaults(&defaults);
    const tides_iebcs *own = &defaults.iebcs;
    static const char *const off[] = {"iebcs.th_noise", "iebcs.lat", "iebcs.jit", "iebcs.bgnp", "iebcs.bgnn", NULL};
    set(s, "iebcs.scale", 1 / p->log_eps);
    set(s, "iebcs.ref", 1); /* [us] the resolution of its clock: without, a large step is taken again and again at one time */
    set(s, "iebcs.tau", own->tau * (1 / p->log_eps + 1) / (own->scale + 1));
    zero(s, off);
    put(s, "iebcs.noise_pos=", "null");
    put(s, "iebcs.noise_neg=", "null");
    put(s, "iebcs.arbiter=", "none");
}

/* -- the methods --------------------------------------------------------------------------------------------------------- */

/* clang-format off */
static const struct method {
    const char *name, *method; /* of the row, in the run file */
    void (*threshold)(settings *s, const pixel *p), (*ideal)(settings *s, const pixel *p); /* NULL: nothing to set */
    const char *always;   /* a setting that makes the row what it is, or NULL */
    const char *own[2];   /* the run file has thresholds for it where it gives one of these keys */
    const char *shown[3]; /* the keys that the results tell */
    const char *pace;     /* and of a scene the one that says how often it is rendered */
    int32_t scenes_only;
} methods[] = {
    {"tides", "tides", NULL, ideal_tides, NULL, {NULL, NULL},
     {"sensor.threshold_on", "sensor.threshold_off"}, "stepping.tolerance", 0},
    {"esim", "esim", threshold_esim, ideal_esim, NULL, {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg"},
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg", "esim.simulation_adaptive_sampling_method"},
     "esim.simulation_adaptive_sampling_lambda", 0},
    {"esim-fixed", "esim", threshold_esim, ideal_esim, "esim.simulation_adaptive_sampling_method=none",
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg"},
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg"}, "frames_per_second", 1},
    {"v2e", "v2e", threshold_v2e, ideal_v2e, NULL, {"v2e.pos_thres", "v2e.neg_thres"},
     {"v2e.pos_thres", "v2e.neg_thres"}, "frames_per_second", 0},
    {"dvs-voltmeter", "dvs-voltmeter", threshold_voltmeter, ideal_voltmeter, NULL, {"voltmeter.k1", NULL},
     {"voltmeter.k1", "voltmeter.k2"}, "frames_per_second", 0},
    {"iebcs", "iebcs", threshold_iebcs, ideal_iebcs, NULL, {"iebcs.th_pos", "iebcs.th_neg"},
     {"iebcs.th_pos", "iebcs.th_neg", "iebcs.scale"}, "frames_per_second", 0},
};
/* clang-format on */
enum { METHODS = sizeof methods / sizeof methods[0] };

const char *compare_method(size_t index) { return index < METHODS ? methods[index].name : NULL; }

static const struct method *find_method(const char *name) {
    size_t i = 0;
    while (strcmp(methods[i].name, name) != 0) i++;
    return &methods[i];
}

static int32_t has_thresholds(const struct method *m, const tides_run *run) {
    for (int i = 0; i < 2; i++)
        if (m->own[i] && tides_run_gives(run, m->own[i])) return 1;
    return 0;
}

int32_t compare_scenes_only(const char *method) { return find_method(method)->scenes_only; }

/* -- a run of one's own -------------------------------------------------------------------------------------------------- */

const cJSON *compare_find(const cJSON *object, const char *path) {
    char name[64];
    while (object && *path) {
        const size_t length = strcspn(path, ".");
        if (length >= sizeof name) return NULL;
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        object = cJSON_GetObjectItemCaseSensitive(object, name);
        path += length + (path[length] == '.');
    }
    return object;
}

/* What the results say of the row's run; 0: out of memory. */
static int32_t tell(compare_row *row, const settings *s, const struct method *m, const tides_session_facts *session) {
    row->settings = cJSON_CreateArray();
    row->parameters = cJSON_CreateObject();
    cJSON *run = cJSON_Parse(session->values.json);
    int32_t ok = row->settings && row->parameters && run;
    for (int32_t i = 0; ok && i < s->count; i++) ok = cJSON_AddItemToArray(row->settings, cJSON_CreateString(s->texts[i]));
    for (size_t i = 0; ok && i < sizeof m->shown / sizeof m->shown[0] && m->shown[i]; i++)
        ok = cJSON_AddItemToObject(row->parameters, m->shown[i], cJSON_Duplicate(compare_find(run, m->shown[i]), 1));
    if (ok && !session->frames)
        ok = cJSON_AddItemToObject(row->parameters, m->pace, cJSON_Duplicate(compare_find(run, m->pace), 1));
    cJSON_Delete(run);
    return ok;
}

/* Readout and labels are the other methods' neither on scenes nor on frames: they are compared without. TIDES's own are refused
 * where they can't be had. */
static const char *const of_tides[] = {"readout.enabled=false", "sensor.labels=false"};
enum { OF_TIDES = sizeof of_tides / sizeof of_tides[0] };

tides_status compare_configure(const comparison *c, const char *method, int32_t ideal, compare_row *row,
                               tides_session **session, tides_error *error) {
    const struct method *m = find_method(method);
    const tides_run_values *given = &c->session.values;
    const pixel p = {given->sensor.threshold_on, given->sensor.threshold_off, given->image.log_eps};
    const char *texts[SETTINGS_MAX + OF_TIDES];
    size_t count = 0;
    settings s = {.count = 0};
    put(&s, "method=", m->method);
    if (m->threshold && (ideal || !has_thresholds(m, c->session.run))) m->threshold(&s, &p);
    if (ideal) m->ideal(&s, &p);
    if (m->always) put(&s, m->always, "");
    for (int32_t i = 0; i < s.count; i++) texts[count++] = s.texts[i];
    for (int i = 0; i < OF_TIDES && strcmp(m->method, "tides") != 0; i++) texts[count++] = of_tides[i];
    tides_session *made = NULL;
    tides_session_facts facts;
    tides_status status = tides_session_vary(c->open, texts, count, &made, error);
    if (status != TIDES_OK) return status;
    tides_session_get(made, &facts);
    if (row && !tell(row, &s, m, &facts)) {
        tides_session_close(made);
        return cli_error(error, TIDES_NO_MEMORY, "out of memory: settings of %s", method);
    }
    *session = made;
    return TIDES_OK;
}

/* -- running ------------------------------------------------------------------------------------------------------------- */

/* A stream against another one. */
static tides_status measure(const comparison *c, const tides_event *events, size_t count, uint32_t wanted,
                            const compare_row *row, cli_progress *progress, cJSON **json, tides_error *error) {
    tides_metrics_options options;
    tides_metrics metrics;
    tides_metrics_options_defaults(&options);
    options.wanted = wanted;
    options.width = c->session.intrinsics.width;
    options.height = c->session.intrinsics.height;
    options.match_limit_s = BENCH_MATCH_LIMIT_S;
    compare_interval(c, &options.start_ns, &options.stop_ns);
    tides_status status = tides_metrics_compare(events, count, row->stream.events, row->stream.count, &options,
                                                cli_progress_step, progress, &metrics, error);
    if (status != TIDES_OK) return status;
    *json = cli_metrics_json(&metrics, &options);
    return *json ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: metrics of %s", row->name);
}

/* The row's session as it is configured, run and measured. */
static tides_status work(comparison *c, compare_row *row, tides_session *session, tides_error *error) {
    tides_session_facts facts;
    tides_session_get(session, &facts);
    tides_status status =
        tides_session_run(session, bench_keep, &row->stream, cli_progress_step, &c->progress, &row->stats, error);
    cli_progress_end(&c->progress);
    if (status == TIDES_OK)
        status = measure(c, c->exact.stream.events, c->exact.stream.count, TIDES_METRICS_DEFAULT | TIDES_METRIC_MATCH, row,
                         &c->progress, &row->against_exact, error);
    if (status == TIDES_OK && c->recording_file)
        status = measure(c, c->recording.events, c->recording.count, TIDES_METRICS_DEFAULT, row, &c->progress,
                         &row->against_recording, error);
    cli_progress_end(&c->progress);
    return status == TIDES_OK ? compare_keep_events(c, row->name, &facts, &row->stream, error) : status;
}

tides_status compare_run(comparison *c, compare_row *row, tides_error *error) {
    tides_session *session = NULL;
    c->progress.label = row->name;
    row->error = (tides_error){TIDES_OK, ""};
    tides_status status = compare_configure(c, row->name, !c->as_configured, row, &session, &row->error);
    if (status == TIDES_OK) status = work(c, row, session, &row->error);
    tides_session_close(session);
    row->error.status = status;
    if (status == TIDES_CANCELLED) *error = row->error;
    return status == TIDES_CANCELLED ? status : TIDES_OK;
}

void compare_row_free(compare_row *row) {
    cJSON_Delete(row->settings);
    cJSON_Delete(row->parameters);
    cJSON_Delete(row->against_exact);
    cJSON_Delete(row->against_recording);
    free(row->stream.events);
}
