/* Writes a calibration as a preset: values and their sources, in the format that run files use. */
#include "td_calibrate.h"
#include "td_math.h"
#include "td_text.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Writes the source, such as "measured: threshold_on 0.573 +- 0.012 log units; halves of the time 0.565 and 0.583 ...". */
static void source_of(const tides_calibrated *v, const tides_calibrated_row *row, char *text, size_t size) {
    if (v->state == TIDES_CALIBRATED_GIVEN) {
        snprintf(text, size, "given");
        return;
    }
    const int used = snprintf(text, size, "measured%s: %s %.4g +- %.2g %s (68 %%)",
                              v->state == TIDES_CALIBRATED_UNCERTAIN ? ", uncertain" : "", row->name, v->value, v->error,
                              row->unit[0] ? row->unit : "of full scale");
    if (v->early == v->early && used > 0 && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, "; halves of the time %.4g and %.4g, of the image %.4g and %.4g", v->early,
                 v->late, v->left, v->right);
}

/* A number rounded to six digits: more than was measured, and readable. */
static cJSON *number(double value) {
    char text[32];
    snprintf(text, sizeof text, "%.6g", value);
    return cJSON_CreateNumber(strtod(text, NULL));
}

/* Adds "key": {"value": .., "kind": .., "source": ..} to the group that the key names, and takes `value` over. */
static cJSON *add(cJSON *root, const char *key, cJSON *value, const char *source) {
    char group[32];
    const char *dot = strchr(key, '.');
    snprintf(group, sizeof group, "%.*s", (int)(dot - key), key);
    cJSON *place = cJSON_GetObjectItem(root, group);
    if (!place) place = cJSON_AddObjectToObject(root, group);
    cJSON *item = cJSON_AddObjectToObject(place, dot + 1);
    cJSON_AddItemToObject(item, "value", value);
    if (strcmp(source, "given") != 0) cJSON_AddStringToObject(item, "kind", "measured");
    cJSON_AddStringToObject(item, "source", source);
    return item;
}

/* Adds the spread: one sigma on either side of the measured value. */
static void add_spread(cJSON *item, double low, double high) {
    cJSON *spread = cJSON_AddArrayToObject(item, "spread");
    cJSON_AddItemToArray(spread, number(low));
    cJSON_AddItemToArray(spread, number(high));
}

static double cutoff_hz(double pole_s) { return 1 / (2 * TD_PI * pole_s); }

static void put_pole(cJSON *root, const tides_calibration *found, const char *key, const char *source) {
    const tides_calibrated *v = &found->values[TIDES_CALIBRATED_POLE];
    const int32_t goes = found->law == TIDES_PHOTORECEPTOR_INTENSITY;
    if (!(v->value > 0)) return;
    cJSON *item = add(root, key, number(cutoff_hz(v->value)), source);
    if (v->error > 0 && v->error < v->value) add_spread(item, cutoff_hz(v->value + v->error), cutoff_hz(v->value - v->error));
    add(root, "frontend.photoreceptor_law", cJSON_CreateString(goes ? "intensity" : "constant"),
        goes ? "measured: it fits better than a constant pole" : "measured: a pole that goes with light fits no better");
}

static void put(cJSON *root, const tides_calibration *found, int32_t index) {
    const tides_calibrated *v = &found->values[index];
    tides_calibrated_row row;
    char source[280];
    if (!tides_calibrated_at(index, &row) || !row.key[0]) return;
    if (v->state == TIDES_CALIBRATED_UNKNOWN || v->state == TIDES_CALIBRATED_BOUND) return;
    source_of(v, &row, source, sizeof source);
    if (index == TIDES_CALIBRATED_POLE) {
        put_pole(root, found, row.key, source);
        return;
    }
    cJSON *item = add(root, row.key, number(v->value), source);
    if (v->error > 0) add_spread(item, fmax(v->value - v->error, 0), v->value + v->error);
}

/* Where references begin, where it is a sensor's property: what leak and noise leave. */
static void put_start(cJSON *root, const tides_calibration *found) {
    char source[200];
    if (found->initial != TIDES_INITIAL_STEADY) return;
    const double(*s)[2] = found->starts;
    snprintf(source, sizeof source,
             "measured: %.0f and %.0f %% of the pixels began below and above their reference; in a simulation %.0f and %.0f %%",
             100 * s[0][0], 100 * s[0][1], 100 * s[1 + found->initial][0], 100 * s[1 + found->initial][1]);
    add(root, "sensor.initial", cJSON_CreateString("steady"), source);
}

tides_status tides_calibration_preset(const tides_calibration *found, const char *about, char **text, tides_error *error) {
    td_plain_numbers numbers;
    if (!found || !text) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_calibration_preset: found or text is NULL");
    if (found->refused) return td_fail(error, TIDES_BAD_ARGUMENT, "no preset: %.800s", found->notes ? found->notes : "");
    tides_status status = td_plain_begin(&numbers, "a preset", error);
    if (status != TIDES_OK) return status;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "about", about ? about : "measured by tides calibrate");
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) put(root, found, i);
    put_start(root, found);
    char *made = root ? cJSON_Print(root) : NULL;
    *text = made ? td_strdup(made, error) : NULL;
    cJSON_free(made);
    cJSON_Delete(root);
    td_plain_end(&numbers);
    return *text ? TIDES_OK : made ? TIDES_NO_MEMORY : td_fail(error, TIDES_NO_MEMORY, "out of memory: a preset");
}
