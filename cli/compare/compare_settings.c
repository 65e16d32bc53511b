/* The methods of a comparison and their settings. Each runs as an ideal pixel with the run's thresholds (tides_ideal_settings),
 * or as configured. */
#include "compare.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- the methods --------------------------------------------------------------------------------------------------------- */

/* clang-format off */
static const struct method {
    const char *name, *method; /* the row's name; its name in run files */
    const char *always;   /* a setting that defines the row, or NULL */
    const char *shown[3]; /* keys that results show */
    const char *pace;     /* for scenes, the key that sets how often it renders */
    const char *searched[COMPARE_SEARCHED + 1];
    int32_t scenes_only;
} methods[] = {
    {"tides", "tides", NULL, {"sensor.threshold_on", "sensor.threshold_off"}, "stepping.tolerance",
     {"sensor.threshold_on", "sensor.threshold_off", "frontend.photoreceptor_cutoff_hz", "image.log_eps", NULL}, 0},
    {"esim", "esim", NULL,
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg", "esim.simulation_adaptive_sampling_method"},
     "esim.simulation_adaptive_sampling_lambda",
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg", "esim.log_eps", NULL}, 0},
    {"esim-fixed", "esim", "esim.simulation_adaptive_sampling_method=none",
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg"}, "frames_per_second",
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg", "esim.log_eps", NULL}, 1},
    {"v2e", "v2e", NULL, {"v2e.pos_thres", "v2e.neg_thres"}, "frames_per_second",
     {"v2e.pos_thres", "v2e.neg_thres", "v2e.cutoff_hz", "v2e.added_dn", NULL}, 0},
    {"dvs-voltmeter", "dvs-voltmeter", NULL, {"voltmeter.k1", "voltmeter.k2"}, "frames_per_second",
     {"voltmeter.k1", "voltmeter.k2", "voltmeter.k4", "voltmeter.k6", NULL}, 0},
    {"iebcs", "iebcs", NULL, {"iebcs.th_pos", "iebcs.th_neg", "iebcs.scale"}, "frames_per_second",
     {"iebcs.th_pos", "iebcs.th_neg", "iebcs.tau", "iebcs.scale", NULL}, 0},
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

const char *const *compare_searched(const char *method) { return find_method(method)->searched; }

/* A recording is of a real sensor: each method is given this sensor, as far as its own parameters can express it. */
int32_t compare_ideal(const comparison *c) {
    if (!c->as_configured) return TIDES_IDEAL_PIXEL;
    return c->recording_file ? TIDES_IDEAL_SENSOR : TIDES_IDEAL_THRESHOLDS;
}

/* -- a run of one's own -------------------------------------------------------------------------------------------------- */

/* Notes the settings and parameters of the row's run for the results; 0: out of memory. */
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

/* Settings that other methods don't have, neither on scenes nor on frames: readout, filters and labels are off for them. TIDES
 * keeps the run's, and the library refuses combinations that it can't have. */
static const char *const of_tides[] =
    {"readout.enabled=false",         "sensor.labels=false", "filters.background_s=0", "filters.activity_low_start=0",
     "filters.activity_high_start=0", "filters.afk=off",     "filters.trail=off",      "filters.erc_events=0"};
enum { OF_TIDES = sizeof of_tides / sizeof of_tides[0] };

enum { SETTINGS_MAX = 64 };

tides_status compare_configure(const comparison *c, const char *method, int32_t what, const cli_list *more, compare_row *row,
                               tides_session **session, tides_error *error) {
    const struct method *m = find_method(method);
    const char *texts[SETTINGS_MAX], **ideal = NULL;
    size_t count = 0, told;
    tides_status status = tides_ideal_settings(c->session.run, m->method, what, &ideal, &count, error);
    if (status != TIDES_OK) return status;
    const size_t added = more ? more->count : 0;
    if (count + added > SETTINGS_MAX - 1 - OF_TIDES) {
        tides_free(ideal);
        return cli_error(error, TIDES_UNSUPPORTED, "%s: over %d settings", method, SETTINGS_MAX);
    }
    memcpy(texts, ideal, count * sizeof texts[0]);
    if (m->always) texts[count++] = m->always;
    for (size_t i = 0; i < added; i++) texts[count++] = more->items[i];
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
