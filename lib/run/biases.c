/* sensor.biases: sets keys of the run from a camera's bias settings, unless the file or an override gives them. Notes tell
 * which biases set keys, which keys were kept, and which biases have no published law. */
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

tides_status td_run_biases(tides_run *run, tides_error *error) {
    const cJSON *file = td_run_value(run, "sensor.biases"), *preset = td_run_value(run, "sensor.preset");
    if (!cJSON_IsString(file)) return TIDES_OK;
    td_biases biases;
    char *path = td_run_resolve(run, file->valuestring, error);
    tides_status status = path ? td_biases_read(path, &biases, error) : TIDES_NO_MEMORY;
    if (path && status != TIDES_OK) status = td_fail_within(error, status, "%s: sensor.biases", run->origin);
    free(path);
    if (status != TIDES_OK) return status;
    const char *slash = strrchr(file->valuestring, '/');
    const bias_job job = {run, slash ? slash + 1 : file->valuestring, error};
    if (biases.kind != TD_BIASES_PROPHESEE) return by_formula(&job, &biases);
    const int gen3 = cJSON_IsString(preset) && strcmp(preset->valuestring, "gen3") == 0;
    if (gen3) status = by_ratio(&job, &biases);
    return status == TIDES_OK ? keep_others(&job, &biases, gen3) : status;
}
