/* The table of a batch: a row per run. It holds nothing that depends on how fast the machine was or how often the batch was
 * interrupted, so that two batches can be compared file by file; times are in each run's stats.json. */
#include "batch.h"

#include <stdio.h>
#include <stdlib.h>

static const char *const columns[] = {"events", "events_on", "events_off", "events_truncated", "simulated_s", "width",
                                      "height", "seed",      "device"};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* The result that the run left, else what was asked for. */
static cJSON *row_of(const batch_run *run) {
    static const char *const states[] = {"waiting", "waiting", "done", "failed"};
    char *path = batch_text("%s/result.json", run->directory);
    cJSON *row = run->state == BATCH_DONE && path ? batch_read_json(path) : NULL;
    free(path);
    if (!row && !(row = batch_describe(run))) return NULL;
    cJSON_AddStringToObject(row, "state", states[run->state]);
    if (run->error) cJSON_AddStringToObject(row, "error", run->error);
    return row;
}

static cJSON *make_json(const batch *b) {
    cJSON *root = cJSON_CreateObject(), *runs = root ? cJSON_AddArrayToObject(root, "runs") : NULL;
    size_t done = 0, failed = 0, waiting = 0;
    for (size_t i = 0; runs && i < b->count; i++) {
        cJSON *row = row_of(&b->runs[i]);
        if (!row || !cJSON_AddItemToArray(runs, row)) runs = NULL;
        done += b->runs[i].state == BATCH_DONE;
        failed += b->runs[i].state == BATCH_FAILED;
        waiting += b->runs[i].state == BATCH_WAITING;
    }
    if (runs && cJSON_AddNumberToObject(root, "done", (double)done) &&
        cJSON_AddNumberToObject(root, "failed", (double)failed) && cJSON_AddNumberToObject(root, "waiting", (double)waiting))
        return root;
    cJSON_Delete(root);
    return NULL;
}

static void put_sets(FILE *file, const cJSON *sets) {
    char *joined = batch_text("%s", "");
    for (const cJSON *item = sets ? sets->child : NULL; joined && item; item = item->next) {
        char *longer = batch_text("%s%s%s", joined, joined[0] ? " " : "", item->valuestring);
        free(joined);
        joined = longer;
    }
    putc(',', file);
    if (joined) cli_csv_text(file, joined);
    free(joined);
}

static void put_csv(FILE *file, const void *root) {
    const cJSON *row = NULL;
    fputs("name,state", file);
    for (size_t i = 0; i < COLUMNS; i++) fprintf(file, ",%s", columns[i]);
    fputs(",command,set,error\n", file);
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(root, "runs")) {
        cli_csv_text(file, cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "name")));
        cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(row, "state"));
        for (size_t i = 0; i < COLUMNS; i++) cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(row, columns[i]));
        const char *command = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "command"));
        putc(',', file);
        cli_csv_text(file, command ? command : "simulate");
        put_sets(file, cJSON_GetObjectItemCaseSensitive(row, "set"));
        cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(row, "error"));
        putc('\n', file);
    }
}

static char *summary_path(const batch *b, const char *ending) {
    if (b->shards == 1) return batch_text("%s/summary.%s", b->directory, ending);
    return batch_text("%s/summary-%d-of-%d.%s", b->directory, b->shard + 1, b->shards, ending);
}

static tides_status write_files(const batch *b, const cJSON *root, tides_error *error) {
    char *json = summary_path(b, "json"), *csv = summary_path(b, "csv");
    tides_status status = json && csv ? batch_write_json(json, root, error) : batch_no_memory(error);
    if (status == TIDES_OK) status = cli_write_file(csv, put_csv, root, error);
    free(json);
    free(csv);
    return status;
}

int batch_summary(const batch *b) {
    tides_error error = {TIDES_OK, ""};
    cJSON *root = make_json(b);
    tides_status status = root ? TIDES_OK : batch_no_memory(&error);
    if (status == TIDES_OK && b->only->count == 0) status = write_files(b, root, &error);
    if (status == TIDES_OK && b->common->json) return cli_print_facts(root, 1);
    cJSON_Delete(root);
    return status == TIDES_OK ? CLI_OK : cli_fail(&error);
}
