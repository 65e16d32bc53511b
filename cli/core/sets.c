/* Paths in --set. Typed in a shell, they are relative to the shell's folder, but paths of the run file are relative to its own.
 * A path that doesn't exist in the shell's folder is taken as relative to the run file's folder. */
#include "sets.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int32_t of_manifest; /* 1: sets come from a file, and all paths are relative to the run file */

void cli_sets_of_manifest(void) { of_manifest = 1; }

/* 1 where both names exist and are different files. */
static int32_t differ(const char *here, const char *beside) {
    struct stat a, b;
    return stat(here, &a) == 0 && stat(beside, &b) == 0 && (a.st_dev != b.st_dev || a.st_ino != b.st_ino);
}

/* The absolute path of a relative one that exists in the shell's folder; NULL where it doesn't, or needn't be changed. */
static char *placed(const char *run, const char *path, const cli_common *common) {
    char here[PATH_MAX], beside[2 * PATH_MAX], line[600];
    const int folder = (int)(strrchr(run, '/') - run) + 1;
    if (path[0] == '/' || strcmp(path, "-") == 0 || access(path, F_OK) != 0 || !getcwd(here, sizeof here)) return NULL;
    snprintf(beside, sizeof beside, "%.*s%s", folder, run, path);
    if (differ(path, beside)) {
        snprintf(line, sizeof line,
                 "--set: %.200s is in the shell's folder, and another one beside %.200s: the shell's is taken", path, run);
        cli_tell_lines(common, line);
    }
    const size_t bytes = strlen(here) + strlen(path) + 2;
    char *whole = malloc(bytes);
    if (whole) snprintf(whole, bytes, "%s/%s", here, path);
    return whole;
}

/* Makes paths in a list of objects absolute; returns their number. */
static int32_t place_objects(cJSON *list, const char *run, const cli_common *common) {
    static const char *const names[] = {"file", "trajectory"};
    int32_t count = 0;
    cJSON *object;
    cJSON_ArrayForEach(object, list) {
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
            cJSON *text = cJSON_GetObjectItemCaseSensitive(object, names[i]);
            char *whole = cJSON_IsString(text) ? placed(run, text->valuestring, common) : NULL;
            if (whole) cJSON_SetValuestring(text, whole), count++;
            free(whole);
        }
    }
    return count;
}

static char *joined(const char *set, int key, const char *value) {
    const size_t bytes = (size_t)key + strlen(value) + 2;
    char *made = malloc(bytes);
    if (made) snprintf(made, bytes, "%.*s=%s", key, set, value);
    return made;
}

/* The assignment with absolute paths; NULL where it stays unchanged. */
static char *place(const char *set, const char *run, const cli_common *common) {
    char name[96];
    const char *equals = strchr(set, '=');
    const int key = equals ? (int)(equals - set) : 0;
    snprintf(name, sizeof name, "%.*s", key, set);
    if (!equals || !tides_param_is_path(name)) return NULL;
    const char *value = equals + 1;
    cJSON *json = value[0] == '"' || value[0] == '[' ? cJSON_Parse(value) : NULL;
    char *made = NULL, *whole = NULL;
    if (cJSON_IsArray(json)) {
        char *text = place_objects(json, run, common) ? cJSON_PrintUnformatted(json) : NULL;
        made = text ? joined(set, key, text) : NULL;
        cJSON_free(text);
    } else if ((whole = placed(run, cJSON_IsString(json) ? json->valuestring : value, common))) {
        made = joined(set, key, whole);
    }
    free(whole);
    cJSON_Delete(json);
    return made;
}

void cli_sets_place(const cli_list *sets, const char *run, const cli_common *common, cli_placed *placed_sets) {
    placed_sets->list = *sets;
    placed_sets->owned = 0;
    if (of_manifest || !strchr(run, '/')) return; /* both folders are the same */
    for (size_t i = 0; i < sets->count; i++) {
        char *made = place(sets->items[i], run, common);
        if (!made) continue;
        placed_sets->list.items[i] = placed_sets->own[placed_sets->owned++] = made;
    }
}

void cli_sets_free(cli_placed *placed_sets) {
    while (placed_sets->owned) free(placed_sets->own[--placed_sets->owned]);
}
