/* sensor.biases: sets keys of the run from a camera's bias settings, unless the file or an override gives them. Notes tell
 * which biases set keys, which keys were kept, and which biases have no published law. Metavision's settings have the filters
 * of the camera, too. */
#include "td_biases.h"
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

typedef struct bias_job {
    tides_run *run;
    const char *name; /* name of the file, without its folder */
    tides_error *error;
} bias_job;

static tides_status note(const bias_job *job, const char *what, const char *then) {
    char line[512];
    snprintf(line, sizeof line, "%.60s: biases %.60s: %s%s", job->run->origin, job->name, what, then);
    td_one_line(line);
    return td_run_note(job->run, line, job->error);
}

/* Sets the key if the value is in its range; otherwise notes why it stays. */
static tides_status become(const bias_job *job, const char *from, const char *key, double number, const char *otherwise) {
    char text[300];
    const tides_param *row = td_param_find(key);
    if (!(number > 0)) {
        snprintf(text, sizeof text, "%s: %s is kept: %s", from, key, otherwise);
        return note(job, text, "");
    }
    if (tides_run_gives(job->run, key)) {
        snprintf(text, sizeof text, "%s would be %s %.4g, which is given otherwise", from, key, number);
        return note(job, text, "");
    }
    cJSON *value = cJSON_CreateNumber(number < row->lower ? row->lower : number > row->upper ? row->upper : number);
    tides_status status =
        value ? td_run_store(job->run, row, value, job->error) : td_fail(job->error, TIDES_NO_MEMORY, "out of memory: %s", key);
    cJSON_Delete(value);
    snprintf(text, sizeof text, "%s: %s %.4g", from, key, number);
    return status == TIDES_OK ? note(job, text, "") : status;
}

/* Sets keys by jAER's formulas for DAVIS and DVS128. */
static tides_status by_formula(const bias_job *job, const td_biases *biases) {
    const td_bias_units u = td_biases_units(biases);
    const char *missing = "its biases aren't in the file, or in an order that the formula doesn't have";
    tides_status status = become(job, "ON and diff", "sensor.threshold_on", u.threshold_on, missing);
    const char *off = u.off ? "OFF (fine 0: off; taken as 1) and diff" : "OFF and diff";
    if (status == TIDES_OK) status = become(job, off, "sensor.threshold_off", u.threshold_off, missing);
    if (status == TIDES_OK) status = become(job, "Refr", "sensor.refractory_s", u.refractory_s, missing);
    const char *slower = "the photoreceptor is slower than its follower, and of that there is no formula";
    if (status == TIDES_OK)
        status = become(job, "Pr and PrSF", "frontend.photoreceptor_cutoff_hz", u.cutoff_hz, u.limited ? slower : missing);
    return status;
}

static const td_bias *prophesee(const td_biases *biases, const char *name) {
    char whole[TD_BIAS_NAME];
    snprintf(whole, sizeof whole, "bias_%s", name);
    return td_biases_find(biases, whole);
}

/* Sets the thresholds of Gen3.1, whose biases are in millivolts. The preset's thresholds belong to the plugin's default
 * biases (300, 385 and 222 mV), and scale with the distance from bias_diff. No maker publishes a law: this one is TIDES's
 * own, and only its sign is certain. */
static tides_status by_ratio(const bias_job *job, const td_biases *biases) {
    static const double factory_on = 385 - 300, factory_off = 300 - 222;
    const td_bias *diff = prophesee(biases, "diff"), *on = prophesee(biases, "diff_on"), *off = prophesee(biases, "diff_off");
    const double from_on = td_run_number(job->run, "sensor.threshold_on");
    const double from_off = td_run_number(job->run, "sensor.threshold_off");
    const double rise = diff && on ? (on->value - diff->value) / factory_on : 0;
    const double fall = diff && off ? (diff->value - off->value) / factory_off : 0;
    const char *missing = "bias_diff or it isn't in the file, or they are in the wrong order";
    tides_status status =
        become(job, "bias_diff_on by TIDES' own law (ratio of mV to gen3's)", "sensor.threshold_on", from_on * rise, missing);
    if (status == TIDES_OK)
        status = become(job, "bias_diff_off by TIDES' own law (ratio of mV to gen3's)", "sensor.threshold_off", from_off * fall,
                        missing);
    return status;
}

/* Notes the biases for which there is no law. */
static tides_status keep_others(const bias_job *job, const td_biases *biases, int thresholds) {
    char kept[300] = "";
    size_t used = 0;
    for (int32_t i = 0; i < biases->count && used < sizeof kept - TD_BIAS_NAME - 16; i++) {
        const td_bias *b = &biases->bias[i];
        if (thresholds && strncmp(b->name, "bias_diff", 9) == 0) continue;
        used += (size_t)snprintf(kept + used, sizeof kept - used, "%s%s %d", used ? ", " : "", b->name, (int)b->value);
    }
    return used ? note(job, kept, ": kept the run's values, since the maker publishes no law and the unit goes with the chip")
                : TIDES_OK;
}

/* -- filters of Metavision's settings -------------------------------------------------------------------------------------- */

/* A field of a state that is on, and its key: a number times `times`, or one of `words`, "theirs=ours" with | between. */
typedef struct filter_field {
    const char *state, *field, *key;
    double times;
    const char *words;
} filter_field;

static const filter_field filter_fields[] = {
    {"event_rate_activity_filter_state", "lower_start_rate_threshold", "filters.activity_low_start", 1, NULL},
    {"event_rate_activity_filter_state", "lower_stop_rate_threshold", "filters.activity_low_stop", 1, NULL},
    {"event_rate_activity_filter_state", "upper_start_rate_threshold", "filters.activity_high_start", 1, NULL},
    {"event_rate_activity_filter_state", "upper_stop_rate_threshold", "filters.activity_high_stop", 1, NULL},
    {"event_rate_noise_filter_state", "event_rate_threshold", "filters.activity_low_start", 1, NULL},
    {"afk_state", "filtering_mode", "filters.afk", 0, "BAND_STOP=band_stop|BAND_PASS=band_pass"},
    {"afk_state", "band_low_freq", "filters.afk_low_hz", 1, NULL},
    {"afk_state", "band_high_freq", "filters.afk_high_hz", 1, NULL},
    {"afk_state", "start_threshold", "filters.afk_start", 1, NULL},
    {"afk_state", "stop_threshold", "filters.afk_stop", 1, NULL},
    {"event_trail_filter_state", "filtering_type", "filters.trail", 0,
     "TRAIL=trail|STC_CUT_TRAIL=stc_cut|STC_KEEP_TRAIL=stc_keep"},
    {"event_trail_filter_state", "threshold", "filters.trail_s", 1e-6, NULL}, /* [us] */
    {"event_rate_control_state", "cd_event_count", "filters.erc_events", 1, NULL},
};

/* The value of a key from a field; NULL if the field has another form, or memory is short. */
static cJSON *filter_value(const filter_field *f, const cJSON *given) {
    if (!f->words) return cJSON_IsNumber(given) ? cJSON_CreateNumber(given->valuedouble * f->times) : NULL;
    char word[64];
    const char *theirs = cJSON_GetStringValue(given);
    snprintf(word, sizeof word, "%.40s=", theirs ? theirs : "");
    for (const char *at = f->words; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL) {
        if (strncmp(at, word, strlen(word)) != 0) continue;
        at += strlen(word);
        snprintf(word, sizeof word, "%.*s", (int)strcspn(at, "|"), at);
        return cJSON_CreateString(word);
    }
    return NULL;
}

static tides_status set_filter(const bias_job *job, const filter_field *f, const cJSON *given) {
    char from[160], line[300];
    snprintf(from, sizeof from, "%s.%s", f->state, f->field);
    const tides_param *row = td_param_find(f->key);
    cJSON *value = filter_value(f, given);
    if (!value) return td_fail(job->error, TIDES_BAD_CONFIG, "%s: %s has no value for %s", job->name, from, f->key);
    char *text = cJSON_PrintUnformatted(value);
    const int given_otherwise = tides_run_gives(job->run, f->key);
    snprintf(line, sizeof line, given_otherwise ? "%s would be %s %.60s, which is given otherwise" : "%s: %s %.60s", from,
             f->key, text ? text : "");
    cJSON_free(text);
    tides_status status = given_otherwise ? TIDES_OK : td_param_check(row, value, job->name, job->error);
    if (status == TIDES_OK && !given_otherwise) status = td_run_store(job->run, row, value, job->error);
    cJSON_Delete(value);
    return status == TIDES_OK ? note(job, line, "") : status;
}

/* The older of two states for one filter counts where the newer isn't there. */
static int is_replaced(const filter_field *f, const cJSON *settings) {
    return strcmp(f->state, "event_rate_noise_filter_state") == 0 &&
           cJSON_GetObjectItemCaseSensitive(settings, "event_rate_activity_filter_state") != NULL;
}

static int is_enabled(const cJSON *state) { return cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(state, "enabled")); }

/* Sets nothing without `settings`. */
static tides_status set_filters(const bias_job *job, const cJSON *settings) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof filter_fields / sizeof *filter_fields; i++) {
        const filter_field *f = &filter_fields[i];
        const cJSON *state = cJSON_GetObjectItemCaseSensitive(settings, f->state);
        const cJSON *value = cJSON_GetObjectItemCaseSensitive(state, f->field);
        if (!is_enabled(state) || is_replaced(f, settings)) continue;
        if (value) status = set_filter(job, f, value);
    }
    const cJSON *afk = cJSON_GetObjectItemCaseSensitive(settings, "afk_state");
    if (status == TIDES_OK && is_enabled(afk) && cJSON_HasObjectItem(afk, "duty_cycle"))
        status = note(job, "afk_state.duty_cycle", ": has no key, since how the chip uses it isn't published");
    return status;
}

static tides_status set_all(const bias_job *job, const td_biases *biases) {
    const cJSON *preset = td_run_value(job->run, "sensor.preset");
    if (biases->kind != TD_BIASES_PROPHESEE) return by_formula(job, biases);
    const int gen3 = cJSON_IsString(preset) && strcmp(preset->valuestring, "gen3") == 0;
    tides_status status = set_filters(job, biases->settings);
    if (status == TIDES_OK && gen3) status = by_ratio(job, biases);
    return status == TIDES_OK ? keep_others(job, biases, gen3) : status;
}

tides_status td_run_biases(tides_run *run, tides_error *error) {
    const cJSON *file = td_run_value(run, "sensor.biases");
    if (!cJSON_IsString(file)) return TIDES_OK;
    td_biases biases = {.settings = NULL};
    char *path = td_run_resolve(run, file->valuestring, error);
    tides_status status = path ? td_biases_read(path, &biases, error) : TIDES_NO_MEMORY;
    if (path && status != TIDES_OK) status = td_fail_within(error, status, "%s: sensor.biases", run->origin);
    free(path);
    const char *slash = strrchr(file->valuestring, '/');
    const bias_job job = {run, slash ? slash + 1 : file->valuestring, error};
    if (status == TIDES_OK) status = set_all(&job, &biases);
    td_biases_free(&biases);
    return status;
}
