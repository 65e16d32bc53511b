/* The table of a batch: a row per run. It doesn't depend on the machine's speed, or on how often the batch was interrupted, so
 * that two batches can be compared file by file. Run times are in each run's stats.json. */
#include "batch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const columns[] = {"events", "events_on", "events_off", "events_truncated", "simulated_s", "width",
                                      "height", "seed",      "device"};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* The row of a run: result.json if the run is done, else the name, hash, run file and settings that the manifest gave it. */
static cJSON *row_of(const batch_run *run) {
    static const char *const states[] = {"waiting", "waiting", "done", "failed"}; /* BATCH_WAITING, _RUNNING, _DONE, _FAILED */
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

/* The keys that runs set, in the order of their first use: a column for each. */
static cJSON *keys_of(const cJSON *runs) {
    cJSON *keys = cJSON_CreateObject();
    const cJSON *row, *set;
    cJSON_ArrayForEach(row, runs) {
        cJSON_ArrayForEach(set, cJSON_GetObjectItemCaseSensitive(row, "set")) {
            char key[96]; /* longer than any key of the run file */
            snprintf(key, sizeof key, "%.*s", (int)strcspn(set->valuestring, "="), set->valuestring);
            if (!cJSON_HasObjectItem(keys, key)) cJSON_AddNullToObject(keys, key);
        }
    }
    return keys;
}

/* Prints the value of `key` in `sets`, a run's list of "key=value". If the list has the key twice, the last one holds; if it
 * doesn't have the key, the field is empty. */
static void put_value(FILE *file, const cJSON *sets, const char *key) {
    const cJSON *set, *found = NULL;
    const size_t length = strlen(key);
    cJSON_ArrayForEach(set, sets) {
        if (strncmp(set->valuestring, key, length) == 0 && set->valuestring[length] == '=') found = set;
    }
    cJSON *value = found ? cJSON_Parse(found->valuestring + length + 1) : NULL;
    if (cJSON_IsNumber(value) || cJSON_IsString(value)) {
        cli_csv_value(file, value);
    } else {
        putc(',', file);
        if (found) cli_csv_text(file, found->valuestring + length + 1);
    }
    cJSON_Delete(value);
}

static void put_csv(FILE *file, const void *root) {
    const cJSON *row = NULL;
    fputs("name,state", file);
    for (size_t i = 0; i < COLUMNS; i++) fprintf(file, ",%s", columns[i]);
    fputs(",command,set,error", file);
    cJSON *keys = keys_of(cJSON_GetObjectItemCaseSensitive(root, "runs"));
    for (const cJSON *key = keys ? keys->child : NULL; key; key = key->next) fprintf(file, ",%s", key->string);
    putc('\n', file);
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(root, "runs")) {
        cli_csv_text(file, cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "name")));
        cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(row, "state"));
        for (size_t i = 0; i < COLUMNS; i++) cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(row, columns[i]));
        const char *command = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "command"));
        putc(',', file);
        cli_csv_text(file, command ? command : "simulate");
        put_sets(file, cJSON_GetObjectItemCaseSensitive(row, "set"));
        cli_csv_value(file, cJSON_GetObjectItemCaseSensitive(row, "error"));
        for (const cJSON *key = keys ? keys->child : NULL; key; key = key->next)
            put_value(file, cJSON_GetObjectItemCaseSensitive(row, "set"), key->string);
        putc('\n', file);
    }
    cJSON_Delete(keys);
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
