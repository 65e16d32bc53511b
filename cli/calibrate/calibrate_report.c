/* The result of a calibration as JSON, and as a table on a terminal. */
#include "calibrate_report.h"

#include <math.h>
#include <string.h>

const char *calibrate_state(int32_t state) {
    static const char *const names[] = {"unknown", "measured", "uncertain", "at most", "given"};
    return state >= 0 && state <= TIDES_CALIBRATED_GIVEN ? names[state] : "";
}

const char *calibrate_transition(int32_t index) {
    static const char *const names[CALIBRATE_TRANSITIONS] = {"ON after ON", "ON after OFF", "OFF after OFF", "OFF after ON"};
    return names[index];
}

static cJSON *value_json(const tides_calibrated *v, const tides_calibrated_row *row) {
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "name", row->name);
    cJSON_AddStringToObject(item, "key", row->key);
    cJSON_AddStringToObject(item, "unit", row->unit);
    cJSON_AddStringToObject(item, "state", calibrate_state(v->state));
    cli_add_number(item, "value", v->value);
    cli_add_number(item, "error", v->error);
    cli_add_number(item, "uncorrected", v->raw);
    cli_add_number(item, "first_half", v->early);
    cli_add_number(item, "second_half", v->late);
    cli_add_number(item, "left_half", v->left);
    cli_add_number(item, "right_half", v->right);
    return item;
}

static void add_transitions(const tides_calibration *f, cJSON *facts) {
    cJSON *rows = cJSON_AddArrayToObject(facts, "transitions");
    for (int32_t i = 0; i < CALIBRATE_TRANSITIONS; i++) {
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "transition", calibrate_transition(i));
        cli_add_number(row, "change_thresholds", f->transitions[i]);
        cJSON_AddNumberToObject(row, "pairs", (double)f->transition_pairs[i]);
        cJSON_AddItemToArray(rows, row);
    }
}

static void add_starts(const tides_calibration *f, cJSON *facts) {
    static const char *const names[] = {"recording", "rest", "random", "steady"};
    cJSON *rows = cJSON_AddArrayToObject(facts, "starts");
    for (int32_t i = 0; i < 4; i++) {
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "of", names[i]);
        cli_add_number(row, "below", f->starts[i][0]);
        cli_add_number(row, "above", f->starts[i][1]);
        cJSON_AddItemToArray(rows, row);
    }
    cJSON_AddStringToObject(facts, "initial", f->initial < 0 ? "unknown" : names[1 + f->initial]);
}

static void add_lines(cJSON *facts, const char *name, const char *lines) {
    cJSON *list = cJSON_AddArrayToObject(facts, name);
    while (lines && *lines) {
        char line[1024];
        const size_t length = strcspn(lines, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, lines);
        cJSON_AddItemToArray(list, cJSON_CreateString(line));
        lines += length + (lines[length] == '\n');
    }
}

static void add_counts(const tides_calibration *f, cJSON *facts) {
    cli_add_seconds(facts, "start_s", f->start_ns);
    cli_add_seconds(facts, "stop_s", f->stop_ns);
    cJSON_AddNumberToObject(facts, "events", (double)f->events);
    cJSON_AddNumberToObject(facts, "events_in_bursts", (double)f->burst_events);
    cJSON_AddNumberToObject(facts, "bursts", f->bursts);
    cJSON_AddNumberToObject(facts, "pairs", (double)f->pairs);
    cJSON_AddNumberToObject(facts, "pixels", (double)f->pixels);
    cJSON_AddNumberToObject(facts, "pixels_at_rest", (double)f->still_pixels);
    cJSON_AddNumberToObject(facts, "samples_of_light", f->samples);
    cJSON_AddNumberToObject(facts, "deviation", f->deviation);
    cJSON_AddNumberToObject(facts, "agreement", f->agreement);
    cJSON_AddNumberToObject(facts, "correlation_eps_threshold_on", f->correlation);
    cJSON_AddNumberToObject(facts, "dead_share", f->dead_share);
    cJSON_AddNumberToObject(facts, "hot_pixels", f->hot_count);
}

static void add_hot(const tides_calibration *f, cJSON *facts) {
    cJSON *list = cJSON_AddArrayToObject(facts, "hot");
    for (int32_t i = 0; i < f->hot_count && i < TIDES_CALIBRATION_HOT; i++) {
        const int place[2] = {f->hot[i][0], f->hot[i][1]};
        cJSON_AddItemToArray(list, cJSON_CreateIntArray(place, 2));
    }
}

cJSON *calibrate_json(const calibrate_report *report) {
    const tides_calibration *f = report->found;
    cJSON *facts = cJSON_CreateObject(), *values = cJSON_AddArrayToObject(facts, "values");
    tides_calibrated_row row;
    cJSON_AddStringToObject(facts, "recording", report->recording);
    cJSON_AddStringToObject(facts, "run", report->run);
    cJSON_AddBoolToObject(facts, "refused", f->refused);
    for (int32_t i = 0; tides_calibrated_at(i, &row); i++) cJSON_AddItemToArray(values, value_json(&f->values[i], &row));
    cJSON_AddStringToObject(facts, "photoreceptor_law", f->law == TIDES_PHOTORECEPTOR_INTENSITY ? "intensity" : "constant");
    add_transitions(f, facts);
    add_starts(f, facts);
    add_counts(f, facts);
    add_hot(f, facts);
    add_lines(facts, "notes", f->notes);
    return facts;
}

/* -- on a terminal ---------------------------------------------------------------------------------------- */

static void print_value(const tides_calibrated *v, const tides_calibrated_row *row) {
    if (v->state == TIDES_CALIBRATED_UNKNOWN)
        printf("%-16s unknown\n", row->name);
    else if (v->state == TIDES_CALIBRATED_BOUND)
        printf("%-16s at most %.3g%s%s\n", row->name, fabs(v->value) + 2 * v->error, row->unit[0] ? " " : "", row->unit);
    else
        printf("%-16s %.4g +- %.2g%s%s%s\n", row->name, v->value, v->error, row->unit[0] ? " " : "", row->unit,
               v->state == TIDES_CALIBRATED_MEASURED ? ""
               : v->state == TIDES_CALIBRATED_GIVEN  ? " (given)"
                                                     : " (uncertain)");
}

void calibrate_print(const calibrate_report *report) {
    const tides_calibration *f = report->found;
    tides_calibrated_row row;
    char texts[2][24];
    if (!f->refused)
        for (int32_t i = 0; tides_calibrated_at(i, &row); i++) print_value(&f->values[i], &row);
    printf("of %s pairs of events in %s pixels; changes differ by %.0f %%, and %.1f %% have their event's sign\n",
           cli_count((double)f->pairs, texts[0]), cli_count((double)f->pixels, texts[1]), 100 * f->deviation,
           100 * f->agreement);
    for (int32_t i = 0; i < CALIBRATE_TRANSITIONS && !f->refused; i++)
        printf("%-16s %.3f thresholds\n", calibrate_transition(i), f->transitions[i]);
}
