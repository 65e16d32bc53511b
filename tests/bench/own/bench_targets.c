/* Writes targets as rows of JSON, which the page of results reads, and as text. */
#include "bench_targets.h"

#include <math.h>

tides_status bench_add_target(cJSON *targets, const bench_target *t, tides_error *error) {
    cJSON *row = cJSON_CreateObject();
    int32_t ok = cJSON_AddItemToArray(targets, row);
    ok = ok && cJSON_AddStringToObject(row, "target", t->name) && cJSON_AddStringToObject(row, "of", t->subject);
    ok = ok && cJSON_AddStringToObject(row, "unit", t->unit) && cJSON_AddNumberToObject(row, "bound", t->bound);
    ok = ok && cJSON_AddStringToObject(row, "is", t->least ? "at least" : "at most");
    if (isfinite(t->measured)) {
        ok = ok && cJSON_AddNumberToObject(row, "measured", t->measured);
        ok = ok && cJSON_AddBoolToObject(row, "reached", t->least ? t->measured >= t->bound : t->measured <= t->bound);
    } else {
        ok = ok && cJSON_AddNullToObject(row, "measured") && cJSON_AddNullToObject(row, "reached");
    }
    if (t->note) ok = ok && cJSON_AddStringToObject(row, "note", t->note);
    return ok ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
}

static const char *text_of(const cJSON *row, const char *key) {
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(row, key));
    return text ? text : "";
}

void bench_print_targets(const cJSON *targets, FILE *out) {
    const cJSON *row;
    int32_t reached = 0, measured = 0;
    cJSON_ArrayForEach(row, targets) {
        const cJSON *value = cJSON_GetObjectItem(row, "measured"), *yes = cJSON_GetObjectItem(row, "reached");
        char number[32] = "-";
        if (cJSON_IsNumber(value)) snprintf(number, sizeof number, "%.3g", value->valuedouble);
        fprintf(out, "%-8s %-46s %-22s %9s %s %g %s %s\n",
                cJSON_IsTrue(yes)    ? "reached"
                : cJSON_IsFalse(yes) ? "not yet"
                                     : "unknown",
                text_of(row, "target"), text_of(row, "of"), number, text_of(row, "is"),
                cJSON_GetNumberValue(cJSON_GetObjectItem(row, "bound")), text_of(row, "unit"), text_of(row, "note"));
        measured += cJSON_IsNumber(value);
        reached += cJSON_IsTrue(yes);
    }
    fprintf(out, "targets: %d of %d measured are reached\n", (int)reached, (int)measured);
}
