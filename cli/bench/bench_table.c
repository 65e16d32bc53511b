/* Writes the results of a benchmark as JSON and CSV. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* The columns of a row, for both JSON and CSV. */
static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const bench_row *r = (const bench_row *)rows + index;
    const bench_cell made[] = {
        {"scene", r->scene, 0},
        {"method", r->method, 0},
        {"setting", NULL, r->setting},
        {"unit", r->unit, 0},
        {"image", r->image, 0},
        {"run_time_s", NULL, r->run_time_s},
        {"renders", NULL, r->stats.renders_full_frame_equivalent},
        {"frames", NULL, r->frames > 0 ? r->frames : NAN},
        {"dt_median_us", NULL, r->match.dt_median_us},
        {"dt_p95_us", NULL, r->match.dt_p95_us},
        {"dt_p99_us", NULL, r->match.dt_p99_us},
        {"dt_max_us", NULL, r->match.dt_max_us},
        {"dt_mean_us", NULL, r->match.dt_mean_us},
        {"mismatch_percent", NULL, r->match.mismatch_percent},
        {"missing", NULL, (double)r->match.missing},
        {"spurious", NULL, (double)r->match.spurious},
        {"events", NULL, (double)r->match.simulated},
        {"events_exact", NULL, (double)r->match.reference},
        {"estimated_p50_us", NULL, 1e6 * r->stats.error_p50_s},
        {"estimated_p95_us", NULL, 1e6 * r->stats.error_p95_s},
        {"estimated_p99_us", NULL, 1e6 * r->stats.error_p99_s},
        {"honest", NULL, bench_is_honest(r) < 0 ? NAN : (double)bench_is_honest(r)},
        {"exact_share", NULL, r->exact_share},
        {"worst_error", NULL, r->stats.worst_error},
        {"worst_residual", NULL, r->stats.worst_residual},
        {"steps", NULL, (double)r->stats.steps},
        {"steps_rejected", NULL, (double)r->stats.steps_rejected},
        {"steps_at_minimum", NULL, (double)r->stats.steps_at_minimum},
        {"events_solved", NULL, (double)r->stats.events_solved},
        {"gaussians_projected", NULL, (double)r->stats.render.gaussians_projected},
        {"points_looked_up", NULL, (double)r->stats.points_looked_up},
        {"runs", NULL, r->runs},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

tides_status bench_path(const bench *b, const char *name, const char *ending, char *path, size_t size, tides_error *error) {
    int length = snprintf(path, size, "%s/%s%s", b->directory, name, ending);
    if (length >= 0 && (size_t)length < size) return TIDES_OK;
    return cli_error(error, TIDES_BAD_ARGUMENT, "%.100s...: the path is too long", b->directory);
}

/* -- JSON ------------------------------------------------------------------------------------------------------------------ */

cJSON *bench_header(const bench *b, const char *name) {
    char date[32] = "";
    const time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc)) strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    cJSON *header = cJSON_CreateObject();
    int32_t ok = header && cJSON_AddStringToObject(header, "bench", name);
    ok = ok && cJSON_AddStringToObject(header, "version", tides_version());
    ok = ok && cJSON_AddNumberToObject(header, "numerics", TIDES_NUMERICS);
    ok = ok && cJSON_AddStringToObject(header, "device", b->info.name);
    ok = ok && cJSON_AddStringToObject(header, "platform", b->info.platform);
    ok = ok && cJSON_AddNumberToObject(header, "lanes", b->info.lanes);
    ok = ok && cJSON_AddNumberToObject(header, "cores", (double)sysconf(_SC_NPROCESSORS_ONLN));
    ok = ok && cJSON_AddStringToObject(header, "date", date);
    ok = ok && cJSON_AddBoolToObject(header, "quick", b->quick);
    ok = ok && cJSON_AddNumberToObject(header, "match_limit_us", 1e6 * TIDES_MATCH_LIMIT_S);
    ok = ok && cJSON_AddArrayToObject(header, "scenes");
    if (ok) return header;
    cJSON_Delete(header);
    return NULL;
}

static int32_t add_truth(cJSON *list, const tides_exact *truth, int32_t rules) {
    cJSON *json = cJSON_CreateObject();
    if (!cJSON_AddItemToArray(list, json)) return 0;
    return cJSON_AddStringToObject(json, "image", bench_rules_name(rules)) &&
           cJSON_AddNumberToObject(json, "events", (double)truth->count) &&
           cJSON_AddNumberToObject(json, "steps_per_s", truth->steps_per_s) &&
           cJSON_AddNumberToObject(json, "tolerance", truth->tolerance) &&
           cJSON_AddNumberToObject(json, "halved_median_us", truth->moved.dt_median_us) &&
           cJSON_AddNumberToObject(json, "halved_p95_us", truth->moved.dt_p95_us) &&
           cJSON_AddNumberToObject(json, "halved_p99_us", truth->moved.dt_p99_us) &&
           cJSON_AddNumberToObject(json, "halved_max_us", truth->moved.dt_max_us) &&
           cJSON_AddNumberToObject(json, "halved_mismatch_percent", truth->moved.mismatch_percent) &&
           cJSON_AddNumberToObject(json, "worst_residual", truth->worst_residual);
}

/* Adds a number; NaN (no event matched, no frames, no such row) becomes null. */
static int32_t add_or_null(cJSON *json, const char *name, double number) {
    return (isfinite(number) ? cJSON_AddNumberToObject(json, name, number) : cJSON_AddNullToObject(json, name)) != NULL;
}

static int32_t add_verdict(cJSON *json, const bench_rows *rows, const char *scene) {
    const bench_verdict v = bench_judge(rows, scene);
    return cJSON_AddNumberToObject(json, "runs", v.rows) && cJSON_AddNumberToObject(json, "runs_with_estimate", v.estimated) &&
           cJSON_AddNumberToObject(json, "runs_with_honest_estimate", v.honest) &&
           cJSON_AddNumberToObject(json, "runs_with_exact_enough_truth", v.within_share[0] + v.within_share[1]) &&
           add_or_null(json, "mismatch_percent_at_0.003", v.mismatch_percent) &&
           add_or_null(json, "mismatch_percent_by_default", v.default_mismatch_percent) &&
           cJSON_AddNumberToObject(json, "worst_residual", v.worst_residual);
}

int32_t bench_header_scene(cJSON *header, const bench_scene *scene, const bench_rows *rows) {
    cJSON *json = cJSON_CreateObject();
    if (!cJSON_AddItemToArray(cJSON_GetObjectItem(header, "scenes"), json)) return 0;
    int32_t ok =
        cJSON_AddStringToObject(json, "scene", scene->name) && cJSON_AddStringToObject(json, "what", scene->sentence) &&
        cJSON_AddNumberToObject(json, "gaussians", (double)tides_scene_count(scene->scene)) &&
        cJSON_AddNumberToObject(json, "width", scene->intrinsics.width) &&
        cJSON_AddNumberToObject(json, "height", scene->intrinsics.height) &&
        cJSON_AddNumberToObject(json, "start_s", scene->start) && cJSON_AddNumberToObject(json, "stop_s", scene->stop) &&
        cJSON_AddNumberToObject(json, "macro_step_s", scene->macro_step_s) &&
        cJSON_AddNumberToObject(json, "threshold", scene->sensor.threshold_on) &&
        cJSON_AddNumberToObject(json, "log_eps", scene->image.log_eps) &&
        cJSON_AddStringToObject(json, "transfer", tides_transfer_name(scene->image.transfer));
    cJSON *truths = ok ? cJSON_AddArrayToObject(json, "exact") : NULL;
    ok = truths != NULL;
    for (int32_t rules = 0; ok && rules < BENCH_RULES; rules++)
        if (scene->truth[rules].count) ok = add_truth(truths, &scene->truth[rules], rules);
    cJSON *verdict = ok && rows ? cJSON_AddObjectToObject(json, "verdict") : NULL;
    return ok && (!rows || (verdict && add_verdict(verdict, rows, scene->name)));
}

static int32_t add_row(cJSON *list, const bench_table *table, size_t index) {
    bench_cell cells[BENCH_CELLS_MAX];
    const int32_t count = table->cells(table->rows, index, cells);
    cJSON *json = cJSON_CreateObject();
    if (!cJSON_AddItemToArray(list, json)) return 0;
    int32_t ok = 1;
    for (int32_t i = 0; ok && i < count; i++)
        if (cells[i].text)
            ok = cJSON_AddStringToObject(json, cells[i].name, cells[i].text) != NULL;
        else
            ok = add_or_null(json, cells[i].name, cells[i].number);
    return ok;
}

static tides_status write_json(const bench *b, const char *name, cJSON *header, const bench_table *table, tides_error *error) {
    char path[4200];
    tides_status status = bench_path(b, name, ".json", path, sizeof path, error);
    if (status != TIDES_OK) return status;
    cJSON *list = cJSON_AddArrayToObject(header, "results");
    int32_t ok = list != NULL;
    for (size_t i = 0; ok && i < table->count; i++) ok = add_row(list, table, i);
    char *text = ok ? cJSON_Print(header) : NULL;
    status = text ? cli_write_text(path, text, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    if (status == TIDES_OK && b->common->json) puts(text);
    cJSON_free(text);
    return status;
}

/* -- CSV ------------------------------------------------------------------------------------------------------------------- */

static void put_cell(FILE *file, const bench_cell *cell) {
    if (cell->text && strchr(cell->text, ','))
        cli_csv_text(file, cell->text);
    else if (cell->text)
        fputs(cell->text, file);
    else if (isfinite(cell->number))
        fprintf(file, "%.9g", cell->number);
}

static void put_csv(FILE *file, const void *what) {
    const bench_table *table = what;
    bench_cell cells[BENCH_CELLS_MAX];
    for (size_t i = 0; i < table->count; i++) {
        const int32_t count = table->cells(table->rows, i, cells);
        for (int32_t k = 0; i == 0 && k < count; k++) fprintf(file, "%s%s", k ? "," : "", cells[k].name);
        if (i == 0) putc('\n', file);
        for (int32_t k = 0; k < count; k++) {
            if (k) putc(',', file);
            put_cell(file, &cells[k]);
        }
        putc('\n', file);
    }
}

tides_status bench_write_csv(const bench *b, const char *name, const bench_table *table, tides_error *error) {
    char path[4200];
    tides_status status = bench_path(b, name, ".csv", path, sizeof path, error);
    return status == TIDES_OK ? cli_write_file(path, put_csv, table, error) : status;
}

tides_status bench_write_table(const bench *b, const char *name, cJSON *header, const bench_table *table, tides_error *error) {
    tides_status status = write_json(b, name, header, table, error);
    return status == TIDES_OK ? bench_write_csv(b, name, table, error) : status;
}

tides_status bench_write(const bench *b, const char *name, cJSON *header, const bench_rows *rows, tides_error *error) {
    const bench_table table = {rows->rows, rows->count, cells_of};
    return bench_write_table(b, name, header, &table, error);
}
