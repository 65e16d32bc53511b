/* Results of a comparison: JSON, CSV and the table on the terminal, all from the JSON. */
#include "compare.h"

#include "html.h"
#include "metrics_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* -- JSON -------------------------------------------------------------------------------------------------------------- */

static int32_t add_exact(cJSON *root, const comparison *c) {
    const tides_exact *e = &c->exact;
    cJSON *json = cJSON_AddObjectToObject(root, "exact");
    int32_t ok = json && cJSON_AddStringToObject(json, "what", compare_exact_what(c)) &&
                 cJSON_AddNumberToObject(json, "events", (double)e->count);
    if (!ok || c->session.frames) return ok; /* closed form: nothing was halved */
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
         cJSON_AddNumberToObject(json, "run_time_s", row->stats.run_time_s - row->stats.render.time_build_s) &&
         cJSON_AddItemToObject(json, "against_exact", cJSON_Duplicate(row->against_exact, 1));
    if (ok && row->against_recording)
        ok = cJSON_AddItemToObject(json, "against_recording", cJSON_Duplicate(row->against_recording, 1));
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
    if (ok && c->recording_file) ok = cJSON_AddStringToObject(root, "recording", c->recording_file) != NULL;
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

static const char *const references[] = {"exact", "recording"};
static const char *const against[] = {"against_exact", "against_recording"};
static const char *const parts[] = {"reference", "simulated", "comparison"};
enum { REFERENCES = 2, PARTS = 3 };

/* The metrics of the first method that ran: the names of the columns. */
static const cJSON *names_of(const cJSON *methods) {
    const cJSON *row, *found = NULL;
    cJSON_ArrayForEach(row, methods) {
        if (!found) found = cJSON_GetObjectItemCaseSensitive(row, against[0]);
    }
    return found;
}

static void put_header(FILE *file, const cJSON *names) {
    fputs("method,reference,error,settings,renders,run_time_s", file);
    for (size_t i = 0; i < PARTS; i++)
        for (const cJSON *name = names ? compare_find(names, parts[i])->child : NULL; name; name = name->next)
            fprintf(file, ",%s%s%s", i + 1 < PARTS ? parts[i] : "", i + 1 < PARTS ? "_" : "", name->string);
}

static void put_row(FILE *file, const cJSON *row, size_t reference, const cJSON *names) {
    const cJSON *setting, *settings = compare_find(row, "settings"), *metrics = compare_find(row, against[reference]);
    putc('\n', file);
    cli_csv_text(file, compare_find(row, "method")->valuestring);
    fprintf(file, ",%s", references[reference]);
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
    const size_t count = compare_find(report, "recording") ? REFERENCES : 1;
    const cJSON *methods = compare_find(report, "methods"), *names = names_of(methods), *row;
    put_header(file, names);
    cJSON_ArrayForEach(row, methods) {
        for (size_t i = 0; i < count; i++) put_row(file, row, i, names);
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

/* -- text -------------------------------------------------------------------------------------------------------------- */

/* A column: of `own` the reference has a value too. */
typedef struct column {
    const char *title, *own, *path;
    int32_t matched; /* only against the exact stream */
} column;

static const column columns[] = {
    {"events", "events", "simulated.events", 0},
    {"ratio", NULL, "comparison.count_ratio", 0},
    {"median us", NULL, "comparison.dt_median_us", 1},
    {"p95 us", NULL, "comparison.dt_p95_us", 1},
    {"mismatch %", NULL, "comparison.mismatch_percent", 1},
    {"Same-ts", "same_ts", "simulated.same_ts", 0},
    {"IG-NLL+", NULL, "comparison.ig_nll_excess", 0},
    {"log ISI W1", NULL, "comparison.isi_w1_decades", 0},
    {"Fano 1ms", NULL, "comparison.fano_error_1ms", 0},
    {"Chamfer px", NULL, "comparison.chamfer_px", 0},
    {"VP", NULL, "comparison.victor_purpura_fraction", 0},
};
enum { COLUMNS = sizeof columns / sizeof columns[0], NAME_WIDTH = 14, WIDTH = 11 };

const char *compare_number(double value, char text[32]) {
    snprintf(text, 32, value == floor(value) || fabs(value) >= 1000 ? "%.0f" : "%.3g", value);
    return text;
}

static void put_number(const cJSON *value) {
    char text[32];
    printf("%*s", WIDTH, cJSON_IsNumber(value) ? compare_number(value->valuedouble, text) : "-");
}

static void print_row(const cJSON *row, size_t reference) {
    const cJSON *failed = compare_find(row, "error");
    printf("%-*s", NAME_WIDTH, compare_find(row, "method")->valuestring);
    if (failed) {
        printf("   failed: %s\n", failed->valuestring);
        return;
    }
    for (size_t i = 0; i < COLUMNS; i++)
        if (reference == 0 || !columns[i].matched)
            put_number(compare_find(compare_find(row, against[reference]), columns[i].path));
    if (reference == 0) {
        put_number(compare_find(row, "renders"));
        put_number(compare_find(row, "run_time_s"));
    }
    putchar('\n');
}

/* The reference first, with its own values. */
static void print_table(const cJSON *report, size_t reference) {
    const cJSON *methods = compare_find(report, "methods"), *first = names_of(methods), *row;
    if (!first) return;
    printf("%-*s", NAME_WIDTH, "");
    for (size_t i = 0; i < COLUMNS; i++)
        if (reference == 0 || !columns[i].matched) printf("%*s", WIDTH, columns[i].title);
    if (reference == 0) printf("%*s%*s", WIDTH, "renders", WIDTH, "seconds");
    printf("\n%-*s", NAME_WIDTH, references[reference]);
    cJSON_ArrayForEach(row, methods) {
        const cJSON *metrics = compare_find(row, against[reference]);
        if (!metrics) continue;
        for (size_t i = 0; i < COLUMNS; i++)
            if (reference == 0 || !columns[i].matched)
                put_number(columns[i].own ? compare_find(compare_find(metrics, "reference"), columns[i].own) : NULL);
        break;
    }
    putchar('\n');
    cJSON_ArrayForEach(row, methods) { print_row(row, reference); }
    putchar('\n');
}

/* What a column means, and which way is better; NULL for one of a stream alone. */
static const char *meaning_of(const column *c, char text[CLI_MEANING]) {
    static const char part[] = "comparison.";
    const size_t prefix = sizeof part - 1;
    if (strcmp(c->title, "Same-ts") == 0) return "events that share their time with another; the reference's value is best";
    return strncmp(c->path, part, prefix) == 0 ? cli_metric_meaning(c->path + prefix, text) : NULL;
}

static void print_meanings(void) {
    char text[CLI_MEANING];
    for (size_t i = 0; i < COLUMNS; i++)
        if (meaning_of(&columns[i], text)) printf("%-*s %s\n", NAME_WIDTH, columns[i].title, meaning_of(&columns[i], text));
    putchar('\n');
}

void compare_put_meanings(FILE *file) {
    fputs("<table class=small>\n", file);
    for (size_t i = 0; i < COLUMNS; i++) {
        char text[CLI_MEANING];
        const char *meaning = meaning_of(&columns[i], text);
        if (!meaning) continue;
        fprintf(file, "<tr><td class=text>%s</td><td class=text>", columns[i].title);
        html_text(file, meaning);
        fputs("</td></tr>\n", file);
    }
    fputs("</table>\n", file);
}

/* -- HTML -------------------------------------------------------------------------------------------------------------- */

static void put_cell(FILE *file, const cJSON *value) {
    char text[32];
    fprintf(file, "<td>%s</td>", value && cJSON_IsNumber(value) ? compare_number(value->valuedouble, text) : "-");
}

static void put_table_row(FILE *file, const char *name, const cJSON *row, const cJSON *metrics, size_t reference) {
    fputs("<tr><td class=text>", file);
    html_text(file, name);
    fputs("</td>", file);
    for (size_t i = 0; i < COLUMNS; i++) {
        if (reference != 0 && columns[i].matched) continue;
        if (row)
            put_cell(file, compare_find(metrics, columns[i].path));
        else
            put_cell(file, columns[i].own ? compare_find(compare_find(metrics, "reference"), columns[i].own) : NULL);
    }
    if (reference == 0) {
        put_cell(file, row ? compare_find(row, "renders") : NULL);
        put_cell(file, row ? compare_find(row, "run_time_s") : NULL);
    }
    fputs("</tr>\n", file);
}

void compare_put_table(FILE *file, const cJSON *report, size_t reference) {
    const cJSON *methods = compare_find(report, "methods"), *row, *first = NULL;
    html_table_begin(file);
    fputs("<tr><th class=text>stream</th>", file);
    for (size_t i = 0; i < COLUMNS; i++)
        if (reference == 0 || !columns[i].matched) fprintf(file, "<th>%s</th>", columns[i].title);
    fputs(reference == 0 ? "<th>renders</th><th>seconds</th></tr></thead><tbody>\n" : "</tr></thead><tbody>\n", file);
    cJSON_ArrayForEach(row, methods) {
        if (!first) first = compare_find(row, against[reference]);
    }
    if (first) put_table_row(file, references[reference], NULL, first, reference);
    cJSON_ArrayForEach(row, methods) {
        const cJSON *metrics = compare_find(row, against[reference]);
        if (metrics) put_table_row(file, compare_find(row, "method")->valuestring, row, metrics, reference);
    }
    html_table_end(file);
}

/* -- text, again: what stands below the tables ------------------------------------------------------------------------- */

/* "esim           esim.contrast_threshold_pos 0.2, ..." */
static void print_parameters(const cJSON *row) {
    const cJSON *parameters = compare_find(row, "parameters"), *one;
    if (!parameters) return;
    printf("%-*s", NAME_WIDTH, compare_find(row, "method")->valuestring);
    cJSON_ArrayForEach(one, parameters) {
        printf("%s%s ", one == parameters->child ? " " : ", ", one->string);
        if (cJSON_IsString(one))
            printf("%s", one->valuestring);
        else
            printf("%.6g", one->valuedouble);
    }
    putchar('\n');
}

void compare_print(const comparison *c, const cJSON *report) {
    const tides_exact *e = &c->exact;
    const cJSON *row;
    print_table(report, 0);
    if (c->recording_file) print_table(report, 1);
    print_meanings();
    cJSON_ArrayForEach(row, compare_find(report, "methods")) { print_parameters(row); }
    printf("%-*s %s", NAME_WIDTH, "exact", compare_exact_what(c));
    if (!c->session.frames)
        printf(": the last halving moved median %.2g, p95 %.2g, p99 %.2g us, %.2g %% mismatched", e->moved.dt_median_us,
               e->moved.dt_p95_us, e->moved.dt_p99_us, e->moved.mismatch_percent);
    printf("\n%-*s %s\n", NAME_WIDTH, "pixels",
           c->as_configured ? "as the run file says"
                            : "ideal, with the run's thresholds (--as-configured takes the run file's)");
    printf("%-*s %s/: index.html, compare.png, compare.json, compare.csv\n", NAME_WIDTH, "files", c->directory);
}
