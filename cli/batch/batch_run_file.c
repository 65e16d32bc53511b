/* Writes a run's own run file, with every value, and with absolute paths of its files. */
#include "batch.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Makes a text that names a file relative to the run file's folder absolute; a preset's name stays. */
static int32_t place(cJSON *item, const char *folder) {
    const char *name = cJSON_GetStringValue(item);
    if (!name || name[0] == '/' || strcmp(name, "-") == 0) return 1;
    char *path = batch_text("%s%s", folder, name);
    const int32_t there = path && access(path, F_OK) == 0, ok = path && (!there || cJSON_SetValuestring(item, path));
    free(path);
    return ok;
}

/* The absolute path of the run file's folder, with a slash at the end. */
static char *folder_of(const char *file) {
    char here[PATH_MAX] = "";
    const char *slash = strrchr(file, '/');
    const int length = slash ? (int)(slash - file) + 1 : 0;
    if (file[0] != '/' && !getcwd(here, sizeof here)) return NULL;
    return batch_text("%s%s%.*s", here, here[0] ? "/" : "", length, file);
}

static cJSON *find(cJSON *root, const char *key) {
    cJSON *at = root;
    for (const char *part = key; at && part; part = strchr(part, '.') ? strchr(part, '.') + 1 : NULL) {
        char name[96];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(part, "."), part);
        at = cJSON_GetObjectItemCaseSensitive(at, name);
    }
    return at;
}

static int32_t place_all(cJSON *root, const char *folder) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    int32_t ok = 1;
    for (size_t i = 0; ok && i < count; i++) {
        cJSON *item = tides_param_is_path(rows[i].key) ? find(root, rows[i].key) : NULL, *object;
        if (cJSON_IsString(item)) ok = place(item, folder);
        if (!cJSON_IsArray(item)) continue;
        cJSON_ArrayForEach(object, item) {
            ok = ok && place(cJSON_GetObjectItemCaseSensitive(object, "file"), folder) &&
                 place(cJSON_GetObjectItemCaseSensitive(object, "trajectory"), folder);
        }
    }
    return ok;
}

tides_status batch_write_run(const batch_run *run, tides_error *error) {
    tides_run *loaded = NULL;
    tides_run_values values;
    tides_status status = tides_run_load(run->file, (const char *const *)run->sets, run->count, &loaded, error);
    if (status != TIDES_OK) return status;
    tides_run_get(loaded, &values);
    char *folder = folder_of(run->file);
    char *path = batch_text("%s/run.json", run->directory);
    cJSON *root = cJSON_Parse(values.json);
    if (folder && path && root && place_all(root, folder))
        status = batch_write_json(path, root, error);
    else
        status = batch_no_memory(error);
    cJSON_Delete(root);
    free(path);
    free(folder);
    tides_run_destroy(loaded);
    return status;
}
