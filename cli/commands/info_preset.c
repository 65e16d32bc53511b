/* Facts of a sensor preset for tides info: its subject, and the keys that it sets. */
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
    if (!cJSON_IsObject(json)) return 0; /* items of a list have no names */
    cJSON_ArrayForEach(item, json) {
        const int32_t group = strcmp(item->string, "sensor") == 0 || strcmp(item->string, "frontend") == 0 ||
                              strcmp(item->string, "readout") == 0 || strcmp(item->string, "image") == 0 ||
                              strcmp(item->string, "filters") == 0;
        const int32_t told = strcmp(item->string, "about") == 0 || strcmp(item->string, "version") == 0 ||
                             strcmp(item->string, "resolution") == 0;
        if (!group && !told) return 0;
        groups += group;
    }
    return groups > 0;
}

/* Checks keys and values by a run that uses the preset. */
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

/* Adds a source: "documented, 0.15 to 0.25: 25 % nominal ...". */
static void add_source(cJSON *sources, const char *key, const cJSON *item, const char *kind) {
    char text[1024] = "";
    const cJSON *spread = cJSON_GetObjectItemCaseSensitive(item, "spread");
    const char *source = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "source"));
    if (cJSON_GetArraySize(spread) == 2)
        snprintf(text, sizeof text, ", %.10g to %.10g", cJSON_GetArrayItem(spread, 0)->valuedouble,
                 cJSON_GetArrayItem(spread, 1)->valuedouble);
    const size_t used = strlen(text);
    if (source) snprintf(text + used, sizeof text - used, ": %s", source);
    char *line = malloc(strlen(kind) + strlen(text) + 1);
    if (line) sprintf(line, "%s%s", kind, text);
    if (line) cJSON_AddStringToObject(sources, key, line);
    free(line);
}

static const char *kind_of(const cJSON *item) {
    const char *kind = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "kind"));
    return kind ? kind : "not said";
}

int32_t info_preset_kinds(const cJSON *json, const char *kind) {
    const cJSON *group, *item;
    int32_t count = 0;
    cJSON_ArrayForEach(group, json) {
        if (!cJSON_IsObject(group)) continue;
        cJSON_ArrayForEach(item, group) count += strcmp(kind_of(item), kind) == 0;
    }
    return count;
}

/* Adds values: "sensor.threshold_on": 0.25. */
static void add_values(const cJSON *json, cJSON *values, cJSON *sources) {
    const cJSON *group, *item;
    cJSON_ArrayForEach(group, json) {
        if (!cJSON_IsObject(group)) continue; /* such as resolution */
        cJSON_ArrayForEach(item, group) {
            char key[96];
            const cJSON *value = cJSON_IsObject(item) ? cJSON_GetObjectItemCaseSensitive(item, "value") : item;
            snprintf(key, sizeof key, "%s.%s", group->string, item->string);
            cJSON_AddItemToObject(values, key, cJSON_Duplicate(value, 1));
            add_source(sources, key, item, kind_of(item));
        }
    }
}

static void add_facts(const cJSON *json, cJSON *facts) {
    static const char *const told[] = {"about", "version", "resolution"};
    cJSON_AddStringToObject(facts, "kind", "preset");
    for (size_t i = 0; i < sizeof told / sizeof *told; i++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, told[i]);
        if (item) cJSON_AddItemToObject(facts, told[i], cJSON_Duplicate(item, 1));
    }
    cJSON_AddStringToObject(facts, "use", "sensor.preset");
    cJSON *values = cJSON_AddObjectToObject(facts, "values");
    add_values(json, values, cJSON_AddObjectToObject(facts, "sources"));
    cJSON_AddNumberToObject(facts, "guesses", info_preset_kinds(json, "guess"));
    cJSON_AddNumberToObject(facts, "of_unknown_kind", info_preset_kinds(json, "not said"));
    cJSON_AddNumberToObject(facts, "value_count", cJSON_GetArraySize(values));
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
