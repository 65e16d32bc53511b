/* What tides info says of a sensor preset: what it is about, and the keys that it sets. */
#include "info_preset.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 1 << 20 };

static cJSON *read_json(const char *file) {
    FILE *stream = fopen(file, "rb");
    char *text = stream ? malloc(LIMIT + 1) : NULL;
    const size_t got = text ? fread(text, 1, LIMIT, stream) : 0;
    if (stream) fclose(stream);
    if (text) text[got] = '\0';
    cJSON *json = text && strlen(text) == got ? cJSON_Parse(text) : NULL;
    free(text);
    return json;
}

static int32_t is_preset(const cJSON *json) {
    int32_t groups = 0;
    const cJSON *item;
    if (!cJSON_IsObject(json)) return 0; /* what a list holds has no names */
    cJSON_ArrayForEach(item, json) {
        const int32_t group = strcmp(item->string, "sensor") == 0 || strcmp(item->string, "frontend") == 0 ||
                              strcmp(item->string, "readout") == 0 || strcmp(item->string, "filters") == 0;
        if (!group && strcmp(item->string, "about") != 0) return 0;
        groups += group;
    }
    return groups > 0;
}

/* A run that names it says whether its keys and values are right. */
static tides_status check(const char *file, int32_t is_file, tides_error *error) {
    char folder[PATH_MAX] = "", name[PATH_MAX];
    const char *slash = strrchr(file, '/');
    if (slash) snprintf(folder, sizeof folder, "%.*s", (int)(slash - file) + 1, file);
    snprintf(name, sizeof name, "%s%s", is_file ? "./" : "", slash ? slash + 1 : file);
    cJSON *root = cJSON_Parse("{\"frames\": {\"file\": \"-\"}, \"sensor\": {}}");
    cJSON_AddStringToObject(cJSON_GetObjectItem(root, "sensor"), "preset", name);
    char *text = root ? cJSON_PrintUnformatted(root) : NULL;
    tides_run *run = NULL;
    tides_status status = text ? tides_run_parse(text, folder, NULL, 0, &run, error)
                               : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", file);
    tides_run_destroy(run);
    cJSON_free(text);
    cJSON_Delete(root);
    return status;
}

/* "sensor.threshold_on": 0.25 */
static void add_values(const cJSON *json, cJSON *values) {
    const cJSON *group, *item;
    cJSON_ArrayForEach(group, json) {
        cJSON_ArrayForEach(item, group) {
            char key[96];
            const cJSON *value = cJSON_IsObject(item) ? cJSON_GetObjectItemCaseSensitive(item, "value") : item;
            snprintf(key, sizeof key, "%s.%s", group->string, item->string);
            cJSON_AddItemToObject(values, key, cJSON_Duplicate(value, 1));
        }
    }
}

static void add_facts(const cJSON *json, cJSON *facts) {
    const cJSON *about = cJSON_GetObjectItemCaseSensitive(json, "about");
    cJSON_AddStringToObject(facts, "kind", "preset");
    if (cJSON_IsString(about)) cJSON_AddStringToObject(facts, "about", about->valuestring);
    cJSON_AddStringToObject(facts, "use", "sensor.preset");
    add_values(json, cJSON_AddObjectToObject(facts, "values"));
}

tides_status info_named_preset(const char *name, cJSON *facts, tides_error *error) {
    char *text = NULL;
    tides_status status = tides_preset_read(name, &text, error);
    cJSON *json = status == TIDES_OK ? cJSON_Parse(text) : NULL;
    tides_free(text);
    if (status != TIDES_OK) return status;
    if (is_preset(json))
        status = check(name, 0, error);
    else
        status = cli_error(error, TIDES_BAD_FILE, "%s: isn't a preset: { \"about\": .., \"sensor\": {..} }", name);
    if (status == TIDES_OK) add_facts(json, facts);
    cJSON_Delete(json);
    return status;
}

int32_t info_preset(const char *file, cJSON *facts, tides_status *status, tides_error *error) {
    cJSON *json = read_json(file);
    const int32_t found = is_preset(json);
    if (found && (*status = check(file, 1, error)) == TIDES_OK) add_facts(json, facts);
    cJSON_Delete(json);
    return found;
}
