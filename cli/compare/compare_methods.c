/* The methods of a comparison: each run as an ideal pixel with the thresholds of the run (tides_ideal_settings says what that
 * is), or as it is configured. */
#include "compare.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- the methods --------------------------------------------------------------------------------------------------------- */

/* clang-format off */
static const struct method {
    const char *name, *method; /* of the row, in the run file */
    const char *always;   /* a setting that makes the row what it is, or NULL */
    const char *shown[3]; /* the keys that the results tell */
    const char *pace;     /* and of a scene the one that says how often it is rendered */
    int32_t scenes_only;
} methods[] = {
    {"tides", "tides", NULL, {"sensor.threshold_on", "sensor.threshold_off"}, "stepping.tolerance", 0},
    {"esim", "esim", NULL,
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg", "esim.simulation_adaptive_sampling_method"},
     "esim.simulation_adaptive_sampling_lambda", 0},
    {"esim-fixed", "esim", "esim.simulation_adaptive_sampling_method=none",
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg"}, "frames_per_second", 1},
    {"v2e", "v2e", NULL, {"v2e.pos_thres", "v2e.neg_thres"}, "frames_per_second", 0},
    {"dvs-voltmeter", "dvs-voltmeter", NULL, {"voltmeter.k1", "voltmeter.k2"}, "frames_per_second", 0},
    {"iebcs", "iebcs", NULL, {"iebcs.th_pos", "iebcs.th_neg", "iebcs.scale"}, "frames_per_second", 0},
};
/* clang-format on */
enum { METHODS = sizeof methods / sizeof methods[0] };

const char *compare_method(size_t index) { return index < METHODS ? methods[index].name : NULL; }

static const struct method *find_method(const char *name) {
    size_t i = 0;
    while (strcmp(methods[i].name, name) != 0) i++;
    return &methods[i];
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
static int32_t tell(compare_row *row, const char *const *texts, size_t count, const struct method *m,
                    const tides_session_facts *session) {
    row->settings = cJSON_CreateArray();
    row->parameters = cJSON_CreateObject();
    cJSON *run = cJSON_Parse(session->values.json);
    int32_t ok = row->settings && row->parameters && run;
    for (size_t i = 0; ok && i < count; i++) ok = cJSON_AddItemToArray(row->settings, cJSON_CreateString(texts[i]));
    for (size_t i = 0; ok && i < sizeof m->shown / sizeof m->shown[0] && m->shown[i]; i++)
        ok = cJSON_AddItemToObject(row->parameters, m->shown[i], cJSON_Duplicate(compare_find(run, m->shown[i]), 1));
    if (ok && !session->frames)
        ok = cJSON_AddItemToObject(row->parameters, m->pace, cJSON_Duplicate(compare_find(run, m->pace), 1));
    cJSON_Delete(run);
    return ok;
}

/* Readout, filters and labels are the other methods' neither on scenes nor on frames: they are compared without. TIDES's own
 * are refused where they can't be had. */
static const char *const of_tides[] =
    {"readout.enabled=false",         "sensor.labels=false", "filters.background_s=0", "filters.activity_low_start=0",
     "filters.activity_high_start=0", "filters.afk=off",     "filters.trail=off",      "filters.erc_events=0"};
enum { OF_TIDES = sizeof of_tides / sizeof of_tides[0] };

enum { SETTINGS_MAX = 64 };

tides_status compare_configure(const comparison *c, const char *method, int32_t what, compare_row *row, tides_session **session,
                               tides_error *error) {
    const struct method *m = find_method(method);
    const char *texts[SETTINGS_MAX], **ideal = NULL;
    size_t count = 0, told;
    tides_status status = tides_ideal_settings(c->session.run, m->method, what, &ideal, &count, error);
    if (status != TIDES_OK) return status;
    if (count > SETTINGS_MAX - 1 - OF_TIDES) {
        tides_free(ideal);
        return cli_error(error, TIDES_UNSUPPORTED, "%s: over %d settings", method, SETTINGS_MAX);
    }
    memcpy(texts, ideal, count * sizeof texts[0]);
    if (m->always) texts[count++] = m->always;
    told = count;
    for (int i = 0; i < OF_TIDES && strcmp(m->method, "tides") != 0; i++) texts[count++] = of_tides[i];
    tides_session *made = NULL;
    tides_session_facts facts;
    status = tides_session_vary(c->open, texts, count, &made, error);
    if (status == TIDES_OK) {
        tides_session_get(made, &facts);
        if (row && !tell(row, texts, told, m, &facts))
            status = cli_error(error, TIDES_NO_MEMORY, "out of memory: settings of %s", method);
    }
    tides_free(ideal);
    if (status == TIDES_OK)
        *session = made;
    else
        tides_session_close(made);
    return status;
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
    options.match_limit_s = TIDES_MATCH_LIMIT_S;
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
        tides_session_run(session, cli_keep, &row->stream, cli_progress_step, &c->progress, &row->stats, error);
    cli_progress_end(&c->progress);
    if (status == TIDES_OK)
        status = measure(c, c->exact.events, c->exact.count, TIDES_METRICS_DEFAULT | TIDES_METRIC_MATCH, row, &c->progress,
                         &row->against_exact, error);
    if (status == TIDES_OK && c->recording_file)
        status = measure(c, c->recording.events, c->recording.count, TIDES_METRICS_DEFAULT, row, &c->progress,
                         &row->against_recording, error);
    cli_progress_end(&c->progress);
    return status == TIDES_OK ? compare_keep_events(c, row->name, &facts, row->stream.events, row->stream.count, error)
                              : status;
}

/* A tolerance that the run chose for itself, in place of null. */
static tides_status tell_tolerance(compare_row *row, tides_error *error) {
    static const char key[] = "stepping.tolerance";
    if (!cJSON_IsNull(cJSON_GetObjectItemCaseSensitive(row->parameters, key))) return TIDES_OK;
    cJSON *used = cJSON_CreateNumber(row->stats.tolerance);
    if (used && cJSON_ReplaceItemInObjectCaseSensitive(row->parameters, key, used)) return TIDES_OK;
    cJSON_Delete(used);
    return cli_error(error, TIDES_NO_MEMORY, "out of memory: settings of %s", row->name);
}

tides_status compare_run(comparison *c, compare_row *row, tides_error *error) {
    tides_session *session = NULL;
    c->progress.label = row->name;
    row->error = (tides_error){TIDES_OK, ""};
    const int32_t what = c->as_configured ? TIDES_IDEAL_THRESHOLDS : TIDES_IDEAL_PIXEL;
    tides_status status = compare_configure(c, row->name, what, row, &session, &row->error);
    if (status == TIDES_OK) status = work(c, row, session, &row->error);
    if (status == TIDES_OK) status = tell_tolerance(row, &row->error);
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
