/* Sensor presets: values of a sensor for keys that overrides don't give. The run file's own values are kept, too, unless an
 * override names the preset.
 *
 * A preset is a JSON object { "about": text, "version": 1, "resolution": [width, height], group: { name: value, ... } }.
 * Groups are sensor, frontend, readout and filters, and `image` for log_eps, the sensor's black level. The first three
 * members are optional: the version is that of the values, and the resolution is only reported. A value may be { "value":
 * value, "spread": [low, high], "kind": kind, "source": text }. The presets of share/presets are in the library, named as
 * their files; a user's own are searched by name in ~/.config/tides/presets. */
#include "device/td_kernel_source.h"
#include "td_folder.h"
#include "td_kinds.h"
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

/* The files of share/presets, embedded in the library. */
extern const td_kernel_source td_preset_sources[];

enum { PRESET_LIMIT = 1 << 20, PRESETS_MAX = 64, NAME_MAX_BYTES = 64 };

/* -- text ---------------------------------------------------------------------------------------------------------------- */

/* Length of a preset's name: that of "dvs128.json" is dvs128. */
static size_t name_length(const char *file) { return strlen(file) - strlen(".json"); }

int32_t tides_preset_at(size_t index, char name[TIDES_PRESET_NAME]) {
    const td_kernel_source *p = td_preset_sources;
    for (size_t i = 0; p->name && i < index; i++) p++;
    if (p->name && name) snprintf(name, TIDES_PRESET_NAME, "%.*s", (int)name_length(p->name), p->name);
    return p->name != NULL;
}

static tides_status unknown(const tides_run *run, const char *name, tides_error *error) {
    char all[512] = "", shown[NAME_MAX_BYTES], suggestion[TD_SUGGESTION_MAX];
    size_t used = 0;
    for (const td_kernel_source *p = td_preset_sources; p->name && used < sizeof all; p++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%.*s", used ? ", " : "", (int)name_length(p->name), p->name);
    snprintf(shown, sizeof shown, "%.40s", name);
    td_one_line(shown);
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: sensor.preset = \"%s\" is none of %s, nor one of ~/.config/tides/presets, nor the path of a .json "
                   "file%s",
                   run->origin, shown, all, td_suggest(shown, all, ", ", suggestion));
}

/* Joins the lines of an embedded preset to one text. */
static char *join_lines(const char *const *lines, tides_error *error) {
    size_t bytes = 1;
    for (const char *const *line = lines; *line; line++) bytes += strlen(*line);
    char *text = td_alloc(bytes, 1, error), *at = text;
    for (const char *const *line = lines; text && *line; line++) {
        memcpy(at, *line, strlen(*line));
        at += strlen(*line);
    }
    return text;
}

int32_t td_preset_is_file(const char *name) {
    const size_t length = strlen(name);
    return strchr(name, '/') || (length > 5 && strcmp(name + length - 5, ".json") == 0);
}

/* The file of a user's own preset: NAME.json in $XDG_CONFIG_HOME/tides/presets, or else ~/.config/tides/presets. Allocated;
 * NULL if it doesn't exist. */
static char *own_file(const char *name) {
    static const char signs[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.+";
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    const int32_t given = config && config[0] == '/';
    if (name[0] == '.' || name[strspn(name, signs)] || (!given && !home)) return NULL;
    char *path = td_format(NULL, "%s%s/tides/presets/%s.json", given ? config : home, given ? "" : "/.config", name);
    if (path && td_is_file(path)) return path;
    free(path);
    return NULL;
}

/* The embedded preset of this name, or NULL. */
static const td_kernel_source *embedded_as(const char *name) {
    const td_kernel_source *p = td_preset_sources;
    while (p->name && (name_length(p->name) != strlen(name) || memcmp(p->name, name, strlen(name)) != 0)) p++;
    return p->name ? p : NULL;
}

char *td_preset_file(const tides_run *run, const char *name, tides_error *error) {
    if (td_preset_is_file(name)) return td_run_resolve(run, name, error);
    return embedded_as(name) ? NULL : own_file(name);
}

/* The text of the embedded preset of this name; NULL if there is none, or memory is short. */
static char *embedded(const char *name, tides_error *error) {
    const td_kernel_source *found = embedded_as(name);
    return found ? join_lines(found->lines, error) : NULL;
}

tides_status tides_preset_read(const char *name, char **text, tides_error *error) {
    if (!name || !text) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_preset_read: name or text is NULL");
    size_t bytes = 0;
    char *path = NULL;
    if ((*text = embedded(name, error)) != NULL) return TIDES_OK;
    tides_status status =
        (path = own_file(name)) != NULL
            ? td_read_file(path, PRESET_LIMIT, text, &bytes, error)
            : td_fail(error, TIDES_FILE_NOT_FOUND, "%.40s: is no preset, neither the library's nor one's own", name);
    free(path);
    return status;
}

/* Reads a preset; the caller frees `text`. */
static tides_status load(const tides_run *run, const char *name, char **text, tides_error *error) {
    size_t bytes = 0;
    if (!td_preset_is_file(name) && (*text = embedded(name, error)) != NULL) return TIDES_OK;
    char *path = td_preset_file(run, name, error);
    if (!path && !td_preset_is_file(name)) return unknown(run, name, error);
    tides_status status = path ? td_kind_refuse(path, TD_WANTS_TEXT, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_read_file(path, PRESET_LIMIT, text, &bytes, error);
    if (path && status != TIDES_OK) status = td_fail_within(error, status, "%s: sensor.preset", run->origin);
    free(path);
    return status;
}

/* -- values -------------------------------------------------------------------------------------------------------------- */

static int may_hold(const char *group) {
    return strcmp(group, "sensor") == 0 || strcmp(group, "frontend") == 0 || strcmp(group, "readout") == 0 ||
           strcmp(group, "filters") == 0 || strcmp(group, "image") == 0;
}

/* Keys that would have got other values from the preset. */
typedef struct kept_keys {
    char names[300];
    size_t used;
    int count, left_out;
} kept_keys;

static void keep(kept_keys *kept, const char *key) {
    const char *comma = kept->count++ ? ", " : "";
    if (kept->used + strlen(comma) + strlen(key) < sizeof kept->names)
        kept->used += (size_t)snprintf(kept->names + kept->used, sizeof kept->names - kept->used, "%s%s", comma, key);
    else
        kept->left_out = 1;
}

/* Sets a row unless a stronger source gives it. The sources from strong to weak: overrides, a preset named by an override,
 * the run file's own values, the preset named in the file. Values and preset of a rig's camera are as strong as overrides. */
static tides_status set(tides_run *run, const tides_param *row, const cJSON *value, kept_keys *kept, tides_error *error) {
    const size_t i = (size_t)(row - tides_params(NULL));
    const int32_t strong = run->given[td_param_find("sensor.preset") - tides_params(NULL)] >= TD_GIVEN_SET;
    if (run->given[i] >= TD_GIVEN_SET || (run->given[i] == TD_GIVEN_FILE && !strong)) {
        if (!cJSON_Compare(run->values[i], value, 1)) keep(kept, row->key);
        return TIDES_OK;
    }
    if (run->given[i] == TD_GIVEN_FILE) {
        run->beneath[i] = run->values[i];
        run->values[i] = NULL;
        run->given[i] = TD_GIVEN_PRESET;
    }
    return td_run_store(run, row, value, error);
}

/* Applies one value of the preset, which may be plain or have a source. */
static tides_status apply(tides_run *run, const char *where, const char *group, const cJSON *item, kept_keys *kept,
                          tides_error *error) {
    char key[TD_KEY_MAX];
    int length = snprintf(key, sizeof key, "%s.%s", group, item->string);
    const tides_param *row = length > 0 && (size_t)length < sizeof key ? td_param_find(key) : NULL;
    if (!row || strcmp(key, "sensor.preset") == 0) return td_param_unknown(where, key, error);
    if (td_is_repeated(item)) return td_given_twice(where, key, error);
    if (strcmp(group, "image") == 0 && strcmp(key, "image.log_eps") != 0)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: %s: of image a preset holds log_eps alone, its sensor's black level; the rest is the scene's",
                       where, key);
    const cJSON *value = NULL;
    tides_status status = td_preset_entry(row, item, where, &value, error);
    return status == TIDES_OK ? set(run, row, value, kept, error) : status;
}

static tides_status apply_all(tides_run *run, const char *where, const cJSON *root, kept_keys *kept, tides_error *error) {
    const cJSON *group, *item;
    tides_status status = TIDES_OK;
    if (!cJSON_IsObject(root)) return td_fail(error, TIDES_BAD_CONFIG, "%s: isn't a JSON object { ... }", where);
    cJSON_ArrayForEach(group, root) {
        const int32_t told = td_preset_tells(group);
        if ((told > 0 || may_hold(group->string)) && td_is_repeated(group)) return td_given_twice(where, group->string, error);
        if (told > 0) continue;
        if (told < 0)
            return td_fail(error, TIDES_BAD_CONFIG,
                           "%s: %s: about is a text, version a whole number from 1, resolution [width, height]", where,
                           group->string);
        if (!may_hold(group->string) || !cJSON_IsObject(group)) {
            char shown[NAME_MAX_BYTES];
            snprintf(shown, sizeof shown, "%.40s", group->string);
            td_one_line(shown);
            return td_fail(error, TIDES_BAD_CONFIG,
                           "%s: \"%s\": a preset holds about, version, resolution, and the objects sensor, frontend, readout, "
                           "filters, image",
                           where, shown);
        }
        cJSON_ArrayForEach(item, group) {
            if (status == TIDES_OK) status = apply(run, where, group->string, item, kept, error);
        }
    }
    return status;
}

/* Notes the preset's keys that have other values: then the sensor isn't quite the preset's. */
static tides_status note_kept(tides_run *run, const char *where, const kept_keys *kept, tides_error *error) {
    if (kept->count == 0) return TIDES_OK;
    char line[600];
    snprintf(line, sizeof line, "%s: given otherwise, and so not set by it: %s%s", where, kept->names,
             kept->left_out ? " ..." : "");
    return td_run_note(run, line, error);
}

tides_status td_run_preset(tides_run *run, tides_error *error) {
    const cJSON *preset = td_run_value(run, "sensor.preset");
    if (!cJSON_IsString(preset)) return TIDES_OK;
    char *text = NULL, where[160];
    tides_status status = load(run, preset->valuestring, &text, error);
    if (status != TIDES_OK) return status;
    snprintf(where, sizeof where, "%.60s: preset %.60s", run->origin, preset->valuestring);
    td_one_line(where);
    cJSON *root = cJSON_Parse(text);
    kept_keys kept = {.count = 0};
    status = root ? apply_all(run, where, root, &kept, error) : td_fail(error, TIDES_BAD_CONFIG, "%s: isn't valid JSON", where);
    if (status == TIDES_OK) status = note_kept(run, where, &kept, error);
    cJSON_Delete(root);
    free(text);
    return status;
}
