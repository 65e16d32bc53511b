/* Writes the results of a comparison as JSON, and a CSV made of it. */
#include "compare.h"

#include <stdio.h>
#include <string.h>

/* -- JSON -------------------------------------------------------------------------------------------------------------- */

static const char *const against[COMPARE_REFERENCES] = {"against_exact", "against_recording"};
static const char *const parts[] = {"reference", "simulated", "comparison"};
enum { PARTS = sizeof parts / sizeof parts[0] };

const cJSON *compare_against(const cJSON *row, int32_t reference) {
    return cJSON_GetObjectItemCaseSensitive(row, against[reference]);
}

static int32_t add_exact(cJSON *root, const comparison *c) {
    const tides_exact *e = &c->exact;
    cJSON *json = c->with_exact ? cJSON_AddObjectToObject(root, compare_exact_name(c)) : NULL;
    if (!c->with_exact) return 1;
    int32_t ok = json && cJSON_AddStringToObject(json, "what", compare_exact_what(c)) &&
                 cJSON_AddNumberToObject(json, "events", (double)e->count);
    if (!ok || c->session.frames) return ok; /* closed form, without halvings */
    return cJSON_AddNumberToObject(json, "steps_per_s", e->steps_per_s) &&
           cJSON_AddNumberToObject(json, "tolerance", e->tolerance) &&
           cJSON_AddNumberToObject(json, "halved_median_us", e->moved.dt_median_us) &&
           cJSON_AddNumberToObject(json, "halved_p95_us", e->moved.dt_p95_us) &&
           cJSON_AddNumberToObject(json, "halved_p99_us", e->moved.dt_p99_us) &&
           cJSON_AddNumberToObject(json, "halved_mismatch_percent", e->moved.mismatch_percent);
}

static int32_t add_row(cJSON *list, const compare_row *row) {
    cJSON *json = cJSON_CreateObject();
    if (!cJSON_AddItemToArray(list, json)) return 0;
    int32_t ok = cJSON_AddStringToObject(json, "method", row->name) != NULL;
    if (row->error.status != TIDES_OK) return ok && cJSON_AddStringToObject(json, "error", row->error.text);
    ok = ok && cJSON_AddItemToObject(json, "parameters", cJSON_Duplicate(row->parameters, 1)) &&
         cJSON_AddItemToObject(json, "settings", cJSON_Duplicate(row->settings, 1)) &&
         cJSON_AddNumberToObject(json, "renders", row->stats.renders_full_frame_equivalent) &&
         cJSON_AddNumberToObject(json, "run_time_s", row->stats.run_time_s - row->stats.render.time_build_s);
    for (int32_t i = 0; ok && i < COMPARE_REFERENCES; i++)
        if (row->against[i]) ok = cJSON_AddItemToObject(json, against[i], cJSON_Duplicate(row->against[i], 1));
    return ok;
}

/* Adds the part of the recording that was compared, and the floors: how near to it a stream can be. */
static int32_t add_recording(cJSON *root, const comparison *c) {
    static const char *const names[COMPARE_FLOORS] = {"seeds", "pixels"};
    const compare_fair *f = &c->fair;
    cJSON *json, *floors, *hot;
    int32_t ok = cJSON_AddStringToObject(root, "recording", c->recording_file) &&
                 (json = cJSON_AddObjectToObject(root, "compared")) &&
                 cJSON_AddNumberToObject(json, "start_s", 1e-9 * (double)f->start_ns) &&
                 cJSON_AddNumberToObject(json, "stop_s", 1e-9 * (double)f->stop_ns) &&
                 cJSON_AddNumberToObject(json, "tolerance_s", f->tolerance_s) &&
                 cJSON_AddNumberToObject(json, "masked_events", (double)f->masked) &&
                 cJSON_AddNumberToObject(json, "bursts", (double)f->blemishes.bursts) &&
                 cJSON_AddNumberToObject(json, "burst_events", (double)f->blemishes.burst_events) &&
                 cJSON_AddNumberToObject(json, "hot_events", (double)f->blemishes.hot_events) &&
                 (hot = cJSON_AddArrayToObject(json, "hot")) && (floors = cJSON_AddObjectToObject(root, "floors"));
    for (size_t i = 0; ok && i < f->blemishes.hots; i++) {
        const int place[2] = {f->blemishes.hot[2 * i], f->blemishes.hot[2 * i + 1]};
        ok = cJSON_AddItemToArray(hot, cJSON_CreateIntArray(place, 2));
    }
    for (int32_t i = 0; ok && i < COMPARE_FLOORS; i++)
        if (c->floors[i]) ok = cJSON_AddItemToObject(floors, names[i], cJSON_Duplicate(c->floors[i], 1));
    return ok;
}

static int32_t add_all(cJSON *root, const comparison *c) {
    const tides_session_facts *s = &c->session;
    int32_t ok =
        root && cJSON_AddStringToObject(root, "run", c->run) && cJSON_AddStringToObject(root, "version", tides_version()) &&
        cJSON_AddStringToObject(root, "device", s->info.name) &&
        cJSON_AddBoolToObject(root, "as_configured", c->as_configured) &&
        cJSON_AddNumberToObject(root, "start_s", s->values.start) && cJSON_AddNumberToObject(root, "stop_s", s->values.stop) &&
        cJSON_AddNumberToObject(root, "width", s->intrinsics.width) &&
        cJSON_AddNumberToObject(root, "height", s->intrinsics.height) &&
        cJSON_AddNumberToObject(root, "threshold_on", s->values.sensor.threshold_on) &&
        cJSON_AddNumberToObject(root, "threshold_off", s->values.sensor.threshold_off) &&
        cJSON_AddNumberToObject(root, "match_limit_us", 1e6 * TIDES_MATCH_LIMIT_S) && add_exact(root, c);
    if (ok && c->recording_file) ok = add_recording(root, c);
    cJSON *list = ok ? cJSON_AddArrayToObject(root, "methods") : NULL;
    ok = list != NULL;
    for (int32_t i = 0; ok && i < c->count; i++) ok = add_row(list, &c->rows[i]);
    return ok;
}

tides_status compare_report(const comparison *c, cJSON **report, tides_error *error) {
    *report = cJSON_CreateObject();
    if (add_all(*report, c)) return TIDES_OK;
    return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
}

/* -- CSV --------------------------------------------------------------------------------------------------------------- */

const cJSON *compare_names(const cJSON *report, int32_t reference) {
    const cJSON *row, *found = NULL;
    cJSON_ArrayForEach(row, compare_find(report, "methods")) {
        if (!found) found = compare_against(row, reference);
    }
    return found;
}

static void put_header(FILE *file, const cJSON *names) {
    fputs("method,reference,error,settings,renders,run_time_s", file);
    for (size_t i = 0; i < PARTS; i++)
        for (const cJSON *name = names ? compare_find(names, parts[i])->child : NULL; name; name = name->next)
            fprintf(file, ",%s%s%s", i + 1 < PARTS ? parts[i] : "", i + 1 < PARTS ? "_" : "", name->string);
}

static void put_row(FILE *file, const cJSON *row, int32_t reference, const char *name_of, const cJSON *names) {
    const cJSON *setting, *settings = compare_find(row, "settings"), *metrics = compare_against(row, reference);
    putc('\n', file);
    cli_csv_text(file, compare_find(row, "method")->valuestring);
    fprintf(file, ",%s", name_of);
    cli_csv_value(file, compare_find(row, "error"));
    fputs(",\"", file);
    cJSON_ArrayForEach(setting, settings) {
        fprintf(file, "%s%s", setting == settings->child ? "" : " ", setting->valuestring);
    }
    putc('"', file);
    cli_csv_value(file, compare_find(row, "renders"));
    cli_csv_value(file, compare_find(row, "run_time_s"));
    for (size_t i = 0; i < PARTS; i++)
        for (const cJSON *name = names ? compare_find(names, parts[i])->child : NULL; name; name = name->next)
            cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(compare_find(metrics, parts[i]), name->string));
}

static void put_csv(FILE *file, const void *report) {
    const int32_t of_frames = compare_find(report, "lines") != NULL;
    const cJSON *methods = compare_find(report, "methods"), *row, *names = compare_names(report, COMPARE_RECORDING);
    if (!names) names = compare_names(report, COMPARE_EXACT);
    put_header(file, names);
    cJSON_ArrayForEach(row, methods) {
        if (of_frames || compare_find(report, "exact")) put_row(file, row, COMPARE_EXACT, of_frames ? "lines" : "exact", names);
        if (compare_find(report, "recording")) put_row(file, row, COMPARE_RECORDING, "recording", names);
    }
    putc('\n', file);
}

tides_status compare_write_tables(const comparison *c, const cJSON *report, tides_error *error) {
    char path[COMPARE_PATH];
    char *text = cJSON_Print(report);
    snprintf(path, sizeof path, "%s/compare.json", c->directory);
    tides_status status =
        text ? cli_write_text(path, text, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    cJSON_free(text);
    snprintf(path, sizeof path, "%s/compare.csv", c->directory);
    return status == TIDES_OK ? cli_write_file(path, put_csv, report, error) : status;
}
