/* The parameter table in its public form, with defaults as JSON text. Defaults come from the structs' own _defaults functions
 * (tides_sensor_defaults and others), so that each is written down once. */
#include "td_params.h"
#include "td_run.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Room for rows; must be at least td_params_count. */
enum { ROWS_MAX = 256 };

static tides_param shown[ROWS_MAX];
static char defaults[ROWS_MAX][TD_DEFAULT_MAX];
static pthread_once_t made = PTHREAD_ONCE_INIT;

/* -- defaults -------------------------------------------------------------------------------------------------------------- */

void td_run_values_defaults(tides_run_values *values) {
    memset(values, 0, sizeof *values);
    tides_image_params_defaults(&values->image);
    tides_sensor_defaults(&values->sensor);
    tides_stepping_defaults(&values->stepping);
    tides_readout_defaults(&values->readout);
    tides_filters_defaults(&values->filters);
    tides_baseline_params_defaults(&values->baseline);
    tides_frames_options_defaults(&values->frames);
    tides_path_options_defaults(&values->path);
    tides_scene_options_defaults(&values->scene_options);
    tides_exposure_defaults(&values->exposure);
    tides_imu_defaults(&values->imu);
    values->track_count = 100;
    values->track_rate_hz = 100;
    values->stop = 1.0;
    values->frames_per_second = 1000.0;
    values->dataset_picture_hz = 20.0; /* DSEC's cameras, and MVSEC's ground truth */
    values->dataset_truth_hz = 10.0;   /* DSEC's and BlinkFlow's flow */
    values->dataset_pose_hz = 200.0;   /* motion capture's, as in ECD */
}

/* -- defaults as text ------------------------------------------------------------------------------------------------------ */

const char *td_number_text(double value, char text[32]) {
    int digits = 0;
    do snprintf(text, 32, "%.*e", digits, value);
    while (fabs(strtod(text, NULL) - value) > 0 && ++digits < 17);
    const int exponent = atoi(strchr(text, 'e') + 1), decimals = digits - exponent;
    if (exponent >= -4 && exponent < 16) snprintf(text, 32, "%.*f", decimals > 0 ? decimals : 1, value);
    char *comma = strchr(text, ','); /* the program's locale may have a decimal comma */
    if (comma) *comma = '.';
    return text;
}

/* Formats a vector: "[0.2126,0.7152,0.0722]", whole numbers without a point. */
static void vector_text(const double *values, int count, char text[TD_DEFAULT_MAX]) {
    size_t used = 0;
    for (int i = 0; i < count && used < TD_DEFAULT_MAX; i++) {
        char number[32];
        td_number_text(values[i], number);
        char *end = number + strlen(number);
        if (end - number > 2 && strcmp(end - 2, ".0") == 0) end[-2] = '\0';
        used += (size_t)snprintf(text + used, TD_DEFAULT_MAX - used, "%c%s", i ? ',' : '[', number);
    }
    if (used < TD_DEFAULT_MAX - 1) memcpy(text + used, "]", 2);
}

/* Formats the name of the choice with value `constant`, in quotes. */
static void choice_text(const td_param *row, int32_t constant, char text[TD_DEFAULT_MAX]) {
    const char *name = row->choices;
    for (int32_t i = 0; (row->constants ? row->constants[i] : i) != constant; i++) name += strcspn(name, "|") + 1;
    snprintf(text, TD_DEFAULT_MAX, "\"%.*s\"", (int)strcspn(name, "|"), name);
}

static void default_text(const td_param *row, const tides_run_values *values, char text[TD_DEFAULT_MAX]) {
    const char *field = (const char *)values + row->field;
    double numbers[3];
    int32_t whole;
    char number[32];
    memcpy(&whole, field, sizeof whole);
    memcpy(numbers, field, sizeof numbers[0]);
    switch (row->type) {
        case TIDES_PARAM_NUMBER: snprintf(text, TD_DEFAULT_MAX, "%s", td_number_text(numbers[0], number)); break;
        case TIDES_PARAM_INTEGER: snprintf(text, TD_DEFAULT_MAX, "%d", (int)whole); break;
        case TIDES_PARAM_BOOLEAN: snprintf(text, TD_DEFAULT_MAX, "%s", whole ? "true" : "false"); break;
        case TIDES_PARAM_CHOICE: choice_text(row, whole, text); break;
        default: {
            const int count = row->type == TIDES_PARAM_VECTOR2 ? 2 : 3;
            memcpy(numbers, field, (size_t)count * sizeof *numbers);
            vector_text(numbers, count, text);
        }
    }
}

/* -- the table ------------------------------------------------------------------------------------------------------------- */

static void make(void) {
    tides_run_values values;
    td_run_values_defaults(&values);
    for (size_t i = 0; i < td_params_count && i < ROWS_MAX; i++) {
        const td_param *row = &td_params[i];
        const char *text = row->fallback;
        if (!text && row->type != TIDES_PARAM_STRING) {
            default_text(row, &values, defaults[i]);
            text = defaults[i];
        }
        const char *unit = row->unit ? row->unit : "";
        shown[i] =
            (tides_param){row->key, row->type, unit, row->lower, row->upper, text, row->choices, row->sentence, row->common};
    }
}

const tides_param *tides_params(size_t *count) {
    pthread_once(&made, make);
    if (count) *count = td_params_count;
    return shown;
}

const tides_param *td_param_find(const char *key) {
    const tides_param *rows = tides_params(NULL);
    for (size_t i = 0; i < td_params_count; i++)
        if (strcmp(rows[i].key, key) == 0) return &rows[i];
    return NULL;
}

int32_t tides_param_is_path(const char *key) {
    for (size_t i = 0; key && i < td_params_count; i++)
        if (strcmp(td_params[i].key, key) == 0)
            return td_params[i].is_file || td_params[i].type == TIDES_PARAM_OBJECTS || strcmp(key, "sensor.preset") == 0;
    return 0;
}

int32_t td_param_is_group(const char *key) {
    size_t length = strlen(key);
    for (size_t i = 0; i < td_params_count; i++)
        if (strncmp(td_params[i].key, key, length) == 0 && td_params[i].key[length] == '.') return 1;
    return 0;
}
