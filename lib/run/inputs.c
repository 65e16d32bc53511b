/* Lists the files that a run reads: those named by its keys, and those that the readers of scenes, paths and frames look for
 * beside these. The list serves fingerprints and tides info, and ensures that no output replaces an input. */
#include "tides/inputs.h"

#include "camera/td_path_reader.h"
#include "run/td_params.h"
#include "run/td_run.h"
#include "scene/td_model_dir.h"
#include "scene/td_splat.h"
#include "td_folder.h"

#include <stdlib.h>
#include <string.h>

/* Inputs, in the order in which they are found. */
typedef struct found {
    const char *key;
    char *path;
} found;
typedef struct list {
    found *items;
    size_t count, capacity;
    tides_error *error;
} list;

/* Takes over `path`, which is allocated; NULL: out of memory. */
static tides_status add(list *l, const char *key, char *path) {
    if (!path) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < l->count; i++) {
        if (strcmp(l->items[i].path, path) != 0) continue;
        free(path);
        return TIDES_OK;
    }
    void *items = l->items;
    tides_status status = td_reserve(&items, &l->capacity, l->count + 1, sizeof *l->items, l->error);
    l->items = items;
    if (status == TIDES_OK)
        l->items[l->count++] = (found){key, path};
    else
        free(path);
    return status;
}

/* -- files beside a file -------------------------------------------------------------------------------------------- */

/* Adds those files of `names` (NULL-terminated) that exist in a folder; for a file, in the folder that holds it. */
static tides_status add_beside(list *l, const char *key, const char *path, const char *const *names) {
    char *folder = td_is_folder(path) ? td_format(l->error, "%s/", path) : td_folder_prefix(path, l->error);
    tides_status status = folder ? TIDES_OK : TIDES_NO_MEMORY;
    for (; *names && status == TIDES_OK; names++) {
        char *beside = td_format(l->error, "%s%s", folder, *names);
        if (beside && !td_is_file(beside))
            free(beside);
        else
            status = add(l, key, beside);
    }
    free(folder);
    return status;
}

/* Adds a path and the files that path readers look for beside it: COLMAP's cameras, EuRoC's sensor.yaml, nerfies' scene.json
 * and metadata.json. */
static tides_status add_path_file(list *l, const char *key, const char *path) {
    static const char *const names[] = {"cameras.bin",         "cameras.txt",      "sensor.yaml",
                                        "../cam0/sensor.yaml", "scene.json",       "metadata.json",
                                        "../scene.json",       "../metadata.json", NULL};
    tides_status status = add(l, key, td_strdup(path, l->error));
    return status == TIDES_OK ? add_beside(l, key, path, names) : status;
}

/* Adds the path of a camera or object. For a folder it is the one file in it that is read, however many pictures there are;
 * nerfies has a folder of cameras. */
static tides_status add_path(list *l, const char *key, const char *path) {
    static const char *const names[] = {"scene.json", "metadata.json", "../scene.json", "../metadata.json", NULL};
    char *file = NULL;
    if (!td_is_folder(path)) return add_path_file(l, key, path);
    tides_status status = td_path_find(path, &file, l->error);
    const char *read = file ? file : path;
    if (status == TIDES_OK && file && !td_is_folder(file))
        status = add_path_file(l, key, file);
    else if (status == TIDES_OK && (status = add(l, key, td_strdup(read, l->error))) == TIDES_OK)
        status = add_beside(l, key, read, names);
    free(file);
    return status;
}

/* Adds the file of frames' times, if neither a key nor a rate gives these. */
static tides_status add_frames(list *l, const char *key, const char *path, const tides_run_values *values) {
    static const char *const beside_file[] = {"timestamps.txt", "image_timestamps.txt", NULL};
    static const char *const beside_folder[] = {"../timestamps.txt", "../image_timestamps.txt", "../images_timestamps.txt",
                                                "../images.txt", NULL};
    if (values->frames.timestamps || values->frames.frames_per_second > 0) return TIDES_OK;
    return add_beside(l, key, path, td_is_folder(path) ? beside_folder : beside_file);
}

/* Adds the files with this ending beside `path`. */
static tides_status add_ending(list *l, const char *key, const char *path, const char *ending) {
    char *folder = td_folder_of(path, l->error);
    td_folder beside = {NULL, 0, 0};
    tides_status status = folder ? td_folder_list(&beside, folder, ending, l->error) : TIDES_NO_MEMORY;
    for (size_t i = 0; status == TIDES_OK && i < beside.count; i++) status = add(l, key, td_strdup(beside.files[i], l->error));
    td_folder_free(&beside);
    free(folder);
    return status;
}

/* Adds the files that a file refers to, each meta.json with its pictures. Errors in the file are left for its reader. */
static tides_status add_parts(list *l, const char *key, const char *path, const char *part,
                              tides_status (*find)(const char *path, const char *part, td_folder *files, tides_error *error)) {
    td_folder parts = {NULL, 0, 0};
    tides_status status = find(path, part, &parts, NULL) == TIDES_NO_MEMORY
                              ? td_fail(l->error, TIDES_NO_MEMORY, "out of memory: %s", path)
                              : TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < parts.count; i++) {
        status = add(l, key, td_strdup(parts.files[i], l->error));
        if (status == TIDES_OK && td_sog_is_meta(parts.files[i])) status = add_ending(l, key, parts.files[i], ".webp");
    }
    td_folder_free(&parts);
    return status;
}

/* Adds the files of a trained model that are read: of a folder only the newest iteration, without other checkpoints and
 * pictures. */
static tides_status add_model(list *l, const char *key, const td_model_dir *model) {
    static const char *const names[] = {"cfg_args", "cfg.yml", "../cfg.yml", NULL};
    tides_status status = TIDES_OK;
    if (model->points) status = add(l, key, td_strdup(model->points, l->error));
    if (status == TIDES_OK && model->weights) status = add(l, key, td_strdup(model->weights, l->error));
    for (size_t i = 0; status == TIDES_OK && i < model->frame_count; i++)
        status = add(l, key, td_strdup(model->frames[i], l->error));
    return status == TIDES_OK ? add_beside(l, key, model->folder, names) : status;
}

/* Adds a scene's files. A path that is no scene is left for the reader to refuse. */
static tides_status add_scene(list *l, const char *key, const char *path, const cJSON *chosen) {
    td_model_dir model;
    const char *part = cJSON_IsString(chosen) ? chosen->valuestring : NULL;
    if (td_model_dir_is(path) && td_model_dir_find(path, part, &model, NULL) == TIDES_OK) {
        tides_status status = add_model(l, key, &model);
        td_model_dir_free(&model);
        return status;
    }
    tides_status status = add(l, key, td_strdup(path, l->error));
    if (status != TIDES_OK || !td_is_file(path)) return status;
    if (td_sog_is_meta(path)) status = add_ending(l, key, path, ".webp");
    if (td_lcc_is(path)) status = add_parts(l, key, path, part, td_lcc_files);
    if (td_lcc2_is(path)) status = add_parts(l, key, path, part, td_lcc2_files);
    if (td_sog_is_lod(path)) status = add_parts(l, key, path, part, td_sog_lod_files);
    if (td_ends_in(path, ".gltf") || td_ends_in(path, ".glb")) status = add_parts(l, key, path, part, td_gltf_files);
    return status;
}

/* -- files named by keys ----------------------------------------------------------------------------------------------- */

static tides_status add_objects(list *l, const tides_run *run, const char *key) {
    const cJSON *object;
    tides_status status = TIDES_OK;
    cJSON_ArrayForEach(object, td_run_value(run, key)) {
        const cJSON *file = cJSON_GetObjectItemCaseSensitive(object, "file");
        const cJSON *motion = cJSON_GetObjectItemCaseSensitive(object, "trajectory");
        for (int i = 0; i < 2 && status == TIDES_OK; i++) {
            const cJSON *name = i ? motion : file;
            if (!cJSON_IsString(name)) continue;
            char *path = td_run_resolve(run, name->valuestring, l->error);
            if (!path) return TIDES_NO_MEMORY;
            status = i ? add_path(l, key, path) : add_scene(l, key, path, cJSON_GetObjectItemCaseSensitive(object, "part"));
            free(path);
        }
    }
    return status;
}

/* Adds a key's file, and the files that belong to it. */
static tides_status add_row(list *l, const tides_run *run, const td_param *row, const char *file) {
    if (strcmp(row->key, "scene.file") == 0) return add_scene(l, row->key, file, td_run_value(run, "scene.part"));
    if (strcmp(row->key, "camera.file") == 0) return add_path(l, row->key, file);
    tides_status status = add(l, row->key, td_strdup(file, l->error));
    if (status != TIDES_OK || strcmp(row->key, "frames.file") != 0) return status;
    tides_run_values values;
    tides_run_get(run, &values);
    return add_frames(l, row->key, file, &values);
}

static tides_status add_all(list *l, const tides_run *run) {
    const int32_t on_frames = td_run_file(run, "frames.file") != NULL; /* then camera.file isn't read */
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < td_params_count && status == TIDES_OK; i++) {
        const td_param *row = &td_params[i];
        if (on_frames && (strncmp(row->key, "camera.", 7) == 0 || strncmp(row->key, "scene.", 6) == 0)) continue;
        if (row->type == TIDES_PARAM_OBJECTS) status = add_objects(l, run, row->key);
        if (run->files[i]) status = add_row(l, run, row, run->files[i]);
        if (strcmp(row->key, "camera.frame") == 0 && td_run_file(run, "camera.file")) {
            char *frame = NULL;
            status = td_run_find_frame(run, &frame, l->error);
            if (frame) status = add(l, row->key, frame);
        }
        if (status == TIDES_OK && strcmp(row->key, "sensor.preset") == 0 && cJSON_IsString(run->values[i])) {
            const char *name = run->values[i]->valuestring;
            char *file = td_preset_file(run, name, l->error);
            if (file || td_preset_is_file(name)) status = add(l, row->key, file);
        }
    }
    return status;
}

/* Copies the list to one block of memory: the inputs, then their texts. */
static tides_run_input *pack(const list *l) {
    size_t bytes = (l->count ? l->count : 1) * sizeof(tides_run_input);
    for (size_t i = 0; i < l->count; i++) bytes += strlen(l->items[i].path) + 1;
    tides_run_input *inputs = td_alloc(bytes, 1, l->error);
    char *text = inputs ? (char *)(inputs + (l->count ? l->count : 1)) : NULL;
    for (size_t i = 0; inputs && i < l->count; i++) {
        const size_t length = strlen(l->items[i].path) + 1;
        memcpy(text, l->items[i].path, length);
        inputs[i] = (tides_run_input){l->items[i].key, text, td_is_folder(text), 0};
        text += length;
    }
    return inputs;
}

tides_status tides_run_inputs(const tides_run *run, tides_run_input **inputs, size_t *count, tides_error *error) {
    if (!run || !inputs || !count) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_inputs: run, inputs or count is NULL");
    list l = {NULL, 0, 0, error};
    tides_status status = add_all(&l, run);
    tides_run_input *made = status == TIDES_OK ? pack(&l) : NULL;
    if (made) {
        *inputs = made;
        *count = l.count;
    } else if (status == TIDES_OK)
        status = TIDES_NO_MEMORY;
    for (size_t i = 0; i < l.count; i++) free(l.items[i].path);
    free(l.items);
    return status;
}

/* -- protection of inputs -------------------------------------------------------------------------------------------- */

/* Fails if one of `outputs` would be among the pictures of a folder of frames. */
static tides_status check_frames(const tides_run_input *input, const char *const *outputs, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < count; i++)
        if (outputs[i] && (td_is_folder(outputs[i]) || td_ends_in(outputs[i], ".png") || td_ends_in(outputs[i], ".exr")))
            status = tides_files_apart(&input->path, 1, &outputs[i], 1, error);
    return status;
}

tides_status tides_run_apart(const tides_run *run, const char *const *outputs, size_t count, tides_error *error) {
    tides_run_input *inputs = NULL;
    size_t inputs_count = 0;
    if (!run || (count && !outputs)) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_apart: run or outputs is NULL");
    tides_status status = tides_run_inputs(run, &inputs, &inputs_count, error);
    const char **paths = status == TIDES_OK ? td_alloc(inputs_count + 1, sizeof *paths, error) : NULL;
    if (!paths) {
        tides_free(inputs);
        return TIDES_NO_MEMORY;
    }
    paths[0] = run->file;
    for (size_t i = 0; i < inputs_count && status == TIDES_OK; i++) {
        const int32_t frames = inputs[i].folder && strcmp(inputs[i].key, "frames.file") == 0;
        if (frames)
            status = check_frames(&inputs[i], outputs, count, error);
        else
            paths[i + 1] = inputs[i].path;
    }
    if (status == TIDES_OK) status = tides_files_apart(paths, inputs_count + 1, outputs, count, error);
    free(paths);
    tides_free(inputs);
    return status;
}
