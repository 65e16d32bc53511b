/* How far a run of a batch has come, by the files in its folder: result.json of a finished run, failure.json of a failed one.
 * The folder is DIR/NAME: the batch's folder, and the run's name. Both files carry the hash of the run and its inputs; a file
 * with another hash is of other values or inputs, and doesn't count. */
#include "batch.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int32_t add_texts(cJSON *json, const char *key, char *const *texts, size_t count) {
    cJSON *array = cJSON_AddArrayToObject(json, key);
    int32_t ok = array != NULL;
    for (size_t i = 0; ok && i < count; i++) {
        cJSON *text = cJSON_CreateString(texts[i]);
        ok = text && cJSON_AddItemToArray(array, text);
    }
    return ok;
}

cJSON *batch_describe(const batch_run *run) {
    cJSON *json = cJSON_CreateObject();
    int32_t ok = cJSON_AddStringToObject(json, "name", run->name) && cJSON_AddStringToObject(json, "hash", run->hash);
    ok = ok && cJSON_AddStringToObject(json, "file", run->file);
    ok = ok && add_texts(json, "set", run->sets, run->count);
    if (ok && run->command)
        ok = cJSON_AddStringToObject(json, "command", run->command) && add_texts(json, "options", run->option, run->options);
    if (ok) return json;
    cJSON_Delete(json);
    return NULL;
}

static int32_t carries(const cJSON *json, const batch_run *run) {
    const char *hash = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "hash"));
    return hash && strcmp(hash, run->hash) == 0;
}

int32_t batch_has_hash(const char *path, const batch_run *run) {
    cJSON *json = batch_read_json(path);
    const int32_t equal = carries(json, run);
    cJSON_Delete(json);
    return equal;
}

/* Whether the run's folder holds a readable file or folder `name`. */
static int32_t is_there(const batch_run *run, const char *name) {
    char *path = batch_text("%s/%s", run->directory, name);
    const int32_t there = path && access(path, R_OK) == 0;
    free(path);
    return there;
}

int32_t batch_is_made(const batch_run *run) {
    return is_there(run, batch_output(run)) && (run->command || is_there(run, "stats.json"));
}

int32_t batch_is_finished(const batch_run *run) {
    char *path = batch_text("%s/result.json", run->directory);
    const int32_t finished = path && batch_is_made(run) && batch_has_hash(path, run);
    free(path);
    return finished;
}

void batch_leave_failure(const batch_run *run) {
    tides_error ignored = {TIDES_OK, ""};
    char *path = batch_text("%s/failure.json", run->directory);
    cJSON *json = path ? batch_describe(run) : NULL;
    if (cJSON_AddStringToObject(json, "error", run->error)) (void)batch_write_json(path, json, &ignored);
    cJSON_Delete(json);
    free(path);
}

static tides_status look(batch_run *run, tides_error *error) {
    run->earlier = batch_is_finished(run);
    if (run->earlier) {
        run->state = BATCH_DONE;
        return TIDES_OK;
    }
    char *path = batch_text("%s/failure.json", run->directory);
    cJSON *json = path ? batch_read_json(path) : NULL;
    const char *words = carries(json, run) ? cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "error")) : NULL;
    if (words) {
        run->state = BATCH_FAILED;
        run->error = batch_text("%s", words);
    }
    const int32_t ok = path && (!words || run->error);
    cJSON_Delete(json);
    free(path);
    return ok ? TIDES_OK : batch_no_memory(error);
}

tides_status batch_look(batch *b, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->count; i++) /* a run without its inputs has failed already */
        if (b->runs[i].state == BATCH_WAITING) status = look(&b->runs[i], error);
    return status;
}
