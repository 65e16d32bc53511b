/* Reads streamed SOG (PlayCanvas): a lod-meta.json beside folders with a SOG each. It has a spatial tree, whose leaves name
 * runs of Gaussians in these, and may have an environment:
 *
 *     {"version": 1, "lodLevels": 2, "environment": "env/meta.json", "filenames": ["0_0/meta.json", "1_0/meta.json"],
 *      "tree": {"bound": .., "children": [{"bound": .., "lods": {"0": {"file": 0, "offset": 0, "count": 600}, "1": ..}}, ..]}}
 *
 * Level 0 is the finest; it is read unless another one is requested, together with the environment. A file has Gaussians of
 * one level only, and all belong to leaves. So whole files are read, and runs are only counted. Before version 1, "version"
 * was missing, and "environment" could be null. */
#include "td_base.h"
#include "td_folder.h"
#include "td_levels.h"
#include "td_model_files.h"
#include "td_scene.h"
#include "td_splat.h"
#include "td_splat_json.h"

#include <stdlib.h>
#include <string.h>

typedef struct lod {
    const char *path;
    cJSON *meta;
    const char **names; /* paths of all files; files in use have a count */
    int64_t *counts, files;
    const char *level; /* the level to read: "0" */
    int64_t coarsest;  /* coarsest level of a leaf */
    tides_error *error;
} lod;

static const char file_name[] = "lod-meta.json";

int td_sog_is_lod(const char *path) { return strcmp(td_base_name(path), file_name) == 0; }

/* Fails unless the name is that of a meta.json below the folder. */
static tides_status check_name(const lod *l, const char *key, const char *name) {
    if (name && td_json_is_below(name) && td_sog_is_meta(name)) return TIDES_OK;
    return td_fail(l->error, TIDES_BAD_FILE, "%s: %s must name meta.json files in folders beside it", l->path, key);
}

static tides_status read_names(lod *l) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(l->meta, "filenames"), *item;
    const size_t count = cJSON_IsArray(list) ? (size_t)cJSON_GetArraySize(list) : 0;
    l->names = td_alloc(count, sizeof *l->names, l->error);
    l->counts = l->names ? td_alloc(count, sizeof *l->counts, l->error) : NULL;
    tides_status status = l->counts ? TIDES_OK : TIDES_NO_MEMORY;
    cJSON_ArrayForEach(item, list) {
        if (status) break;
        status = check_name(l, "filenames", cJSON_IsString(item) ? item->valuestring : NULL);
        if (!status) l->names[l->files++] = item->valuestring;
    }
    return status;
}

static void find_coarsest(lod *l, const cJSON *levels) {
    const cJSON *level;
    cJSON_ArrayForEach(level, levels) {
        const int64_t number = td_numbered(level->string, "", "");
        if (number > l->coarsest) l->coarsest = number;
    }
}

/* Adds up the level's runs in a node and below it; cJSON limits the depth. */
static tides_status count_node(lod *l, const cJSON *node) {
    const cJSON *children = cJSON_GetObjectItemCaseSensitive(node, "children"), *child;
    const cJSON *levels = cJSON_GetObjectItemCaseSensitive(node, "lods");
    const cJSON *run = cJSON_GetObjectItemCaseSensitive(levels, l->level);
    if (cJSON_IsObject(levels)) find_coarsest(l, levels);
    const int64_t most = INT64_C(1) << 40; /* so that sums can't overflow */
    tides_status status = TIDES_OK;
    if (run) {
        const int64_t file = td_json_whole(run, "file", 0, l->files - 1), count = td_json_whole(run, "count", 0, most);
        if (file < 0 || count < 0 || td_json_whole(run, "offset", 0, most) < 0)
            return td_fail(l->error, TIDES_BAD_FILE,
                           "%s: tree: a leaf's run must have a file of filenames, an offset and a count", l->path);
        l->counts[file] += count;
    }
    cJSON_ArrayForEach(child, children) {
        if (!status) status = count_node(l, child);
    }
    return status;
}

static void lod_close(lod *l) {
    cJSON_Delete(l->meta);
    free(l->names);
    free(l->counts);
}

static tides_status lod_open(lod *l, const char *path, const char *part, tides_error *error) {
    char *text = NULL;
    size_t size = 0;
    *l = (lod){.path = path, .level = part ? part : "0", .error = error};
    tides_status status = td_read_file(path, SIZE_MAX - 1, &text, &size, error);
    if (!status) status = td_splat_json(path, NULL, text, size, &l->meta, error);
    free(text);
    if (status) return status;
    if (cJSON_GetObjectItemCaseSensitive(l->meta, "version") && td_json_whole(l->meta, "version", 1, 1) != 1)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: is a streamed SOG of another version than 1", path);
    status = read_names(l);
    if (!status && !cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(l->meta, "tree")))
        status = td_fail(error, TIDES_BAD_FILE, "%s: is no streamed SOG's: it has no tree", path);
    if (!status) status = count_node(l, cJSON_GetObjectItemCaseSensitive(l->meta, "tree"));
    const cJSON *environment = cJSON_GetObjectItemCaseSensitive(l->meta, "environment");
    if (!status && environment && !cJSON_IsNull(environment))
        status = check_name(l, "environment", td_json_text(l->meta, "environment"));
    return status;
}

/* Reads a part, which must have `wanted` Gaussians; -1: any number. */
static tides_status read_part(const lod *l, const char *name, int64_t wanted, td_gaussians *part) {
    char *file = td_beside(l->path, name, l->error);
    tides_status status = file ? td_sog_read_folder(file, part, l->error) : TIDES_NO_MEMORY;
    if (!status && wanted >= 0 && part->count != wanted)
        status = td_fail(l->error, TIDES_BAD_FILE, "%s: %.80s has %lld Gaussians, but the tree's leaves say %lld", l->path,
                         name, (long long)part->count, (long long)wanted);
    free(file);
    return status;
}

static tides_status note_levels(const lod *l, td_gaussians *gaussians) {
    const td_levels levels = {td_numbered(l->level, "", ""), l->coarsest + 1};
    return td_levels_note(&levels, &gaussians->notes, l->error);
}

static tides_status read_parts(const lod *l, td_gaussians *gaussians) {
    const char *environment = td_json_text(l->meta, "environment");
    size_t count = 0;
    td_gaussians *parts = td_alloc((size_t)l->files + 1, sizeof *parts, l->error);
    tides_status status = parts ? TIDES_OK : TIDES_NO_MEMORY;
    for (int64_t i = 0; i < l->files && !status; i++)
        if (l->counts[i] > 0) status = read_part(l, l->names[i], l->counts[i], &parts[count++]);
    if (!status && count == 0 && strcmp(l->level, "0") != 0)
        status = td_levels_refuse(l->path, l->level, l->coarsest + 1, l->error);
    if (!status && count == 0)
        status = td_fail(l->error, TIDES_BAD_FILE, "%s: no leaf of its tree has Gaussians at level 0, the finest", l->path);
    if (!status && environment) status = read_part(l, environment, -1, &parts[count++]);
    if (!status) status = td_gaussians_join(parts, count, gaussians, l->error);
    if (!status && (status = note_levels(l, gaussians)) != TIDES_OK) td_gaussians_free(gaussians);
    for (size_t i = 0; i < count; i++) td_gaussians_free(&parts[i]);
    free(parts);
    return status;
}

/* The path of lod-meta.json: the path itself, or the file in that folder. */
static char *named(const char *path, tides_error *error) {
    return td_sog_is_lod(path) ? td_strdup(path, error) : td_format(error, "%s/%s", path, file_name);
}

tides_status td_sog_read_lod(const char *path, const char *part, td_gaussians *gaussians, tides_error *error) {
    lod l = {.path = path};
    char *file = named(path, error);
    tides_status status = file ? lod_open(&l, file, part, error) : TIDES_NO_MEMORY;
    if (!status) status = read_parts(&l, gaussians);
    lod_close(&l);
    free(file);
    return status;
}

tides_status td_sog_lod_files(const char *path, const char *part, td_folder *files, tides_error *error) {
    lod l = {.path = path};
    char *file = named(path, error);
    tides_status status = file ? lod_open(&l, file, part, error) : TIDES_NO_MEMORY;
    const char *environment = status ? NULL : td_json_text(l.meta, "environment");
    char *folder = status ? NULL : td_folder_of(file, error);
    if (!status && !folder) status = TIDES_NO_MEMORY;
    for (int64_t i = 0; i < l.files && !status; i++)
        if (l.counts[i] > 0) status = td_folder_add(files, folder, l.names[i], error);
    if (!status && environment) status = td_folder_add(files, folder, environment, error);
    lod_close(&l);
    free(folder);
    free(file);
    return status;
}
