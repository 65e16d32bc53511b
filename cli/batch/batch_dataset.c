/* A run of a batch that makes a dataset (dataset.layout): DIR/NAME/dataset in place of events.h5. The dataset appears whole or
 * not at all; stats.json is written after it. */
#include "batch.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static tides_status remove_inside(const char *folder, tides_error *error) {
    DIR *entries = opendir(folder);
    if (!entries) return cli_error(error, TIDES_WRITE_FAILED, "%s: can't be removed: %s", folder, strerror(errno));
    tides_status status = TIDES_OK;
    for (const struct dirent *entry; status == TIDES_OK && (entry = readdir(entries));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        char *path = batch_text("%s/%s", folder, entry->d_name);
        status = path ? batch_remove(path, error) : batch_no_memory(error);
        free(path);
    }
    closedir(entries);
    return status;
}

tides_status batch_remove(const char *path, tides_error *error) {
    struct stat facts;
    if (lstat(path, &facts) != 0) return TIDES_OK;
    const tides_status status = S_ISDIR(facts.st_mode) ? remove_inside(path, error) : TIDES_OK;
    if (status != TIDES_OK || remove(path) == 0) return status;
    return cli_error(error, TIDES_WRITE_FAILED, "%s: can't be removed: %s", path, strerror(errno));
}

static tides_status write_stats(const batch_run *run, const tides_session *session, const tides_dataset_report *report,
                                const char *path, tides_error *error) {
    tides_session_facts facts;
    tides_session_get(session, &facts);
    cJSON *stats = cJSON_CreateObject();
    cJSON_AddStringToObject(stats, "layout", run->layouts);
    cJSON_AddNumberToObject(stats, "cameras", report->cameras);
    cJSON_AddNumberToObject(stats, "unseeing", report->unseeing);
    cJSON_AddNumberToObject(stats, "events", (double)report->events);
    cJSON_AddNumberToObject(stats, "pictures", report->pictures);
    cJSON_AddNumberToObject(stats, "truths", report->truths);
    cJSON_AddNumberToObject(stats, "poses", report->poses);
    cJSON_AddNumberToObject(stats, "simulated_s", facts.values.stop - facts.values.start);
    cJSON_AddNumberToObject(stats, "width", facts.intrinsics.width);
    cJSON_AddNumberToObject(stats, "height", facts.intrinsics.height);
    cJSON_AddStringToObject(stats, "device", facts.info.name);
    cJSON_AddStringToObject(stats, "version", tides_version());
    cJSON_AddStringToObject(stats, "seed", facts.values.seed);
    const tides_status status = batch_write_json(path, stats, error);
    cJSON_Delete(stats);
    return status;
}

tides_status batch_dataset(const batch *b, const batch_run *run, const char *stats, tides_error *error) {
    cli_list sets = {.count = 0};
    const cli_common quiet = {.quiet = 1, .device = b->common->device};
    tides_session *session = NULL;
    tides_dataset_report report;
    if (run->count > CLI_LIST_MAX)
        return cli_error(error, TIDES_BAD_CONFIG, "the run sets over %d keys: write some of them into its run file",
                         CLI_LIST_MAX);
    for (size_t i = 0; i < run->count; i++) sets.items[sets.count++] = run->sets[i];
    char *folder = batch_text("%s/dataset", run->directory);
    cli_progress progress = {.quiet = 1};
    cli_catch_interrupt();
    tides_status status =
        folder ? cli_session_open(run->file, &sets, &quiet, NULL, 0, &session, error) : batch_no_memory(error);
    if (status == TIDES_OK)
        status = tides_dataset_write(session, folder, run->layouts, cli_progress_step, &progress, &report, error);
    if (status == TIDES_OK) status = write_stats(run, session, &report, stats, error);
    tides_session_close(session);
    free(folder);
    return status;
}
