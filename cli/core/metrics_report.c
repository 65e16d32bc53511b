/* The result of tides metrics as JSON, and a table made of it. */
#include "metrics_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Makes a name such as "fano_200us". */
static void bin_name(const char *prefix, double bin_s, char name[48]) {
    const double us = round(1e6 * bin_s);
    if (us >= 1000 && fmod(us, 1000) == 0)
        snprintf(name, 48, "%s_%.0fms", prefix, us / 1000);
    else
        snprintf(name, 48, "%s_%.6gus", prefix, 1e6 * bin_s);
}

/* Name of value `i` of a row; "" behind the last. */
static const char *name_of(const tides_metric *row, int i, const tides_metrics_options *o, char name[48]) {
    static const char *const kinds[TIDES_PAIRS] = {"", "_same", "_split"};
    const int count = row->repeats == TIDES_REPEATS_ONCE    ? 1
                      : row->repeats == TIDES_REPEATS_PAIRS ? TIDES_PAIRS
                                                            : TIDES_FANO_BINS;
    name[0] = '\0';
    if (i >= count) return name;
    if (row->repeats == TIDES_REPEATS_BINS)
        bin_name(row->name, o->fano_bin_s[i], name);
    else
        snprintf(name, 48, "%s%s", row->name, row->repeats == TIDES_REPEATS_PAIRS ? kinds[i] : "");
    return name;
}

/* Adds the values of the table's rows of kind `of`; `fields` has them. */
static void add_rows(cJSON *json, int32_t of, const void *fields, const tides_metrics_options *o) {
    size_t count;
    const tides_metric *table = tides_metrics_table(&count);
    for (const tides_metric *row = table; row < table + count; row++) {
        char name[48];
        if (row->of != of || !(o->wanted & row->wanted)) continue;
        for (int i = 0; name_of(row, i, o, name)[0]; i++) {
            const char *at = (const char *)fields + row->offset + (size_t)i * row->stride;
            double real;
            uint64_t whole;
            memcpy(&real, at, sizeof real);
            memcpy(&whole, at, sizeof whole);
            cli_add_number(json, name, row->is_real ? real : (double)whole);
        }
    }
}

static cJSON *stream_json(const tides_stream_metrics *s, const tides_metrics_options *o) {
    cJSON *json = cJSON_CreateObject();
    cli_add_number(json, "events", (double)s->events);
    add_rows(json, TIDES_OF_STREAM, s, o);
    return json;
}

cJSON *cli_metrics_json(const tides_metrics *m, const tides_metrics_options *o) {
    cJSON *report = cJSON_CreateObject(), *json = cJSON_CreateObject();
    cJSON_AddItemToObject(report, "reference", stream_json(&m->reference, o));
    cJSON_AddItemToObject(report, "simulated", stream_json(&m->simulated, o));
    cli_add_number(json, "width", m->width);
    cli_add_number(json, "height", m->height);
    cli_add_ns(json, "start_ns", m->start_ns);
    cli_add_ns(json, "stop_ns", m->stop_ns);
    add_rows(json, TIDES_OF_BOTH, m, o);
    cJSON_AddItemToObject(report, "comparison", json);
    return report;
}

/* ---- text ---- */

/* The row with the longest name that `name` begins with: for "fano_error_1ms" that of fano_error. */
static const tides_metric *row_of(const char *name) {
    size_t count, longest = 0;
    const tides_metric *table = tides_metrics_table(&count), *found = NULL;
    for (const tides_metric *row = table; row < table + count; row++) {
        const size_t length = strlen(row->name);
        if (row->of != TIDES_OF_BOTH || length <= longest || strncmp(name, row->name, length) != 0) continue;
        found = row;
        longest = length;
    }
    return found;
}

const char *cli_metric_meaning(const char *name, char text[CLI_MEANING]) {
    static const char *const ways[] = {"", "; lower is better", "; more is better", "; 1 is best", "; 0 is best"};
    static const char *const compared[][2] = {{"width", "[px] compared"},
                                              {"height", "[px] compared"},
                                              {"start_ns", "the stretch compared"},
                                              {"stop_ns", "its end"}};
    for (size_t i = 0; i < sizeof compared / sizeof *compared; i++)
        if (strcmp(name, compared[i][0]) == 0) return compared[i][1];
    const tides_metric *row = row_of(name);
    if (!row) return NULL;
    snprintf(text, CLI_MEANING, "%s%s%s%s%s", row->unit[0] ? "[" : "", row->unit, row->unit[0] ? "] " : "", row->sentence,
             ways[row->better]);
    return text;
}

static const char *text_of(const cJSON *item, char text[32]) {
    if (cJSON_IsString(item) || cJSON_IsRaw(item)) return item->valuestring;
    if (!cJSON_IsNumber(item)) return "-";
    const double value = item->valuedouble;
    snprintf(text, 32, value == floor(value) && fabs(value) < 1e15 ? "%.0f" : "%.6g", value);
    return text;
}

void cli_metrics_print(const cJSON *report) {
    char meaning[CLI_MEANING];
    const cJSON *simulated = cJSON_GetObjectItemCaseSensitive(report, "simulated");
    char left[32], right[32];
    printf("%-26s %16s %16s\n", "", "reference", "simulated");
    for (const cJSON *a = cJSON_GetObjectItemCaseSensitive(report, "reference")->child; a; a = a->next)
        printf("%-26s %16s %16s\n", a->string, text_of(a, left),
               text_of(cJSON_GetObjectItemCaseSensitive(simulated, a->string), right));
    putchar('\n');
    for (const cJSON *a = cJSON_GetObjectItemCaseSensitive(report, "comparison")->child; a; a = a->next)
        printf("%-26s %16s  %s\n", a->string, text_of(a, left), cli_metric_meaning(a->string, meaning));
}
