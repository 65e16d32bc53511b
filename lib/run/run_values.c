/* Converts a run's values to the structs of the library: each row of the parameter table to its field. */
#include "td_params.h"
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

/* The constant of a choice, whose name has been checked before. */
static int32_t constant_of(const td_param *row, const char *name) {
    const size_t length = strlen(name);
    int32_t place = 0;
    const char *at = row->choices;
    while (strcspn(at, "|") != length || memcmp(at, name, length) != 0) {
        at += strcspn(at, "|") + 1;
        place++;
    }
    return row->constants ? row->constants[place] : place;
}

/* The number of a value; 0 if it is null. */
static double number_of(const cJSON *value) { return cJSON_IsNumber(value) ? value->valuedouble : 0.0; }

static void put_vector(const cJSON *value, int count, void *field) {
    double vector[3] = {0};
    for (int i = 0; i < count; i++) vector[i] = number_of(cJSON_GetArrayItem(value, i));
    memcpy(field, vector, (size_t)count * sizeof vector[0]);
}

/* Sets a field. `text` is the value of a STRING row; NULL if it is null. */
static void put(const td_param *row, const cJSON *value, const char *text, void *field) {
    const double number = number_of(value);
    int32_t whole = 0;
    switch (row->type) {
        case TIDES_PARAM_NUMBER: memcpy(field, &number, sizeof number); return;
        case TIDES_PARAM_VECTOR2: put_vector(value, 2, field); return;
        case TIDES_PARAM_VECTOR3: put_vector(value, 3, field); return;
        case TIDES_PARAM_STRING: memcpy(field, &text, sizeof text); return;
        case TIDES_PARAM_INTEGER: whole = (int32_t)number; break;
        case TIDES_PARAM_BOOLEAN: whole = cJSON_IsTrue(value) ? 1 : 0; break;
        default: whole = constant_of(row, value->valuestring);
    }
    memcpy(field, &whole, sizeof whole);
}

/* Sets values that depend on several keys, or are in several structs. */
static void derive(const tides_run *run, tides_run_values *values) {
    tides_baseline_params *baseline = &values->baseline;
    tides_frames_options *frames = &values->frames;
    values->method = td_run_value(run, "method")->valuestring;
    values->json = run->json;
    values->sensor.seed = td_rig_seed(run, strtoull(values->seed, NULL, 10)); /* the number was checked before */
    baseline->seed = values->exposure.seed = values->imu.seed = values->sensor.seed;
    baseline->sensor = values->sensor;
    baseline->log_eps = values->image.log_eps;
    memcpy(frames->luminance, values->image.luminance, sizeof frames->luminance);
    if (baseline->method == TIDES_METHOD_LDATI) {
        frames->planes = 2 * TIDES_LDATI_PLANES;
        /* Voxel grid k begins at k / fps, unless frames.* has times. */
        if (!(frames->frames_per_second > 0) && !frames->timestamps) frames->frames_per_second = baseline->ldati.fps;
    }
}

void td_run_object_path(const cJSON *object, tides_path_options *options) {
    tides_run_values values;
    char key[64];
    td_run_values_defaults(&values);
    for (const char *const *name = td_object_path_keys; *name; name++) {
        const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, *name);
        snprintf(key, sizeof key, "camera.%s", *name);
        for (size_t i = 0; value && i < td_params_count; i++)
            if (strcmp(td_params[i].key, key) == 0) put(&td_params[i], value, NULL, (char *)&values + td_params[i].field);
    }
    *options = values.path;
}

void tides_run_get(const tides_run *run, tides_run_values *values) {
    td_run_values_defaults(values);
    for (size_t i = 0; i < td_params_count; i++) {
        const td_param *row = &td_params[i];
        const cJSON *value = run->values[i]; /* NULL: a camera that a run on frames doesn't need */
        const char *text = row->is_file ? run->files[i] : cJSON_IsString(value) ? value->valuestring : NULL;
        if (row->field != TD_NO_FIELD) put(row, value, text, (char *)values + row->field);
    }
    derive(run, values);
}
