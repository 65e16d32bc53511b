/* Run files as objects: loads, parses and varies them, and checks rules across several keys. */
#include "frames/td_frames.h"
#include "scene/td_splat.h"
#include "td_folder.h"
#include "td_kinds.h"
#include "td_params.h"
#include "td_run.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* Largest run file: a larger one is another kind of file, given by mistake. */
enum { RUN_FILE_LIMIT = 1 << 22 };

/* The text of a row; NULL if its value is null. */
static const char *run_text(const tides_run *run, const char *key) {
    const cJSON *value = td_run_value(run, key);
    return cJSON_IsString(value) ? value->valuestring : NULL;
}

/* Checks rules that no single row of the table can express. */
static tides_status check_whole(const tides_run *run, tides_error *error) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    const int32_t frames = run_text(run, "frames.file") != NULL; /* then neither scene nor camera is needed */
    const int32_t orbit = cJSON_IsNumber(td_run_value(run, "camera.orbit_s"));
    for (size_t i = 0; i < count; i++)
        if (!run->values[i] && !((frames || orbit) && strcmp(rows[i].key, "camera.file") == 0))
            return td_fail(error, TIDES_BAD_CONFIG, "%s: %s is missing: %s%s", run->origin, rows[i].key, rows[i].sentence,
                           strcmp(rows[i].key, "camera.file") == 0 ? "; or camera.orbit_s, for an orbit without a file" : "");
    if (orbit && run_text(run, "camera.file"))
        return td_fail(error, TIDES_BAD_CONFIG, "%s: camera.file and camera.orbit_s are both given; keep one", run->origin);
    if (frames && run_text(run, "scene.file"))
        return td_fail(error, TIDES_BAD_CONFIG, "%s: scene.file and frames.file are both given; keep one", run->origin);
    if (!frames && !run_text(run, "scene.file") && cJSON_GetArraySize(td_run_value(run, "scene.objects")) == 0)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: scene.file is missing: name a splat file, here or in scene.objects",
                       run->origin);
    if (!frames && strcmp(run_text(run, "method"), "ldati") == 0)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: method \"ldati\" takes voxel grids: name their .npy, .npz or .h5 in frames.file", run->origin);
    double start = td_run_number(run, "time.start"), stop = td_run_number(run, "time.stop");
    if (stop <= start && !(frames && !tides_run_gives(run, "time.stop"))) /* otherwise the frames give the end */
        return td_fail(error, TIDES_BAD_CONFIG, "%s: time.stop = %.15g s is not after time.start = %.15g s", run->origin, stop,
                       start);
    const char *mode = run_text(run, "stepping.mode"), *model = run_text(run, "stepping.model");
    if (strncmp(mode, "error", 5) == 0 && strcmp(model, "hermite") != 0)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: stepping.model = \"%s\": error control estimates the error of the hermite "
                       "model only; set stepping.mode to \"fixed\" or \"risk\"",
                       run->origin, model);
    return TIDES_OK;
}

/* Makes the texts that follow from the values: resolved paths, and the whole run as JSON. */
static tides_status derive(tides_run *run, tides_error *error) {
    for (size_t i = 0; i < td_params_count; i++) {
        if (!td_params[i].is_file || !cJSON_IsString(run->values[i])) continue;
        run->files[i] = td_run_resolve(run, run->values[i]->valuestring, error);
        if (!run->files[i]) return TIDES_NO_MEMORY;
    }
    return td_run_print(run->values, &run->json, error);
}

/* Makes an empty run with the table's defaults. */
static tides_status create(const char *origin, const char *directory, tides_run **run, tides_error *error) {
    tides_run *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->origin = td_strdup(origin, error);
    made->directory = made->origin ? td_strdup(directory, error) : NULL;
    made->values = made->directory ? td_run_defaults(error) : NULL;
    made->given = made->values ? td_alloc(td_params_count, sizeof *made->given, error) : NULL;
    made->beneath = made->given ? td_alloc(td_params_count, sizeof *made->beneath, error) : NULL;
    made->files = made->beneath ? td_alloc(td_params_count, sizeof *made->files, error) : NULL;
    const tides_status status = made->files ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK)
        *run = made;
    else
        tides_run_destroy(made);
    return status;
}

static int32_t is_given(const tides_run *run, const char *key, int by) {
    return run->given[td_param_find(key) - tides_params(NULL)] == by;
}

/* Notes that the image's size was overridden while the file gives the focal length: that crops or extends the view around its
 * middle. Most people want the same view in fewer pixels, and get it if the path file gives the focal length. */
static tides_status note_view(tides_run *run, tides_error *error) {
    const int32_t resized = is_given(run, "camera.width", TD_GIVEN_SET) || is_given(run, "camera.height", TD_GIVEN_SET);
    if (!resized || !is_given(run, "camera.fx", TD_GIVEN_FILE) || is_given(run, "camera.scale", TD_GIVEN_SET)) return TIDES_OK;
    char line[300];
    snprintf(line, sizeof line,
             "%.100s: camera.fx = %.10g px stays the run file's: another size shows more or less of the scene; "
             "camera.scale shows the same in other pixels",
             run->origin, td_run_number(run, "camera.fx"));
    td_one_line(line);
    return td_run_note(run, line, error);
}

/* Completes a run after its text: overrides, rig, preset, checks, derived texts. On failure it is destroyed. */
static tides_status finish(tides_run *made, const char *const *overrides, size_t count, tides_run **run, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < count; i++) status = td_run_override(made, overrides[i], error);
    if (status == TIDES_OK) status = td_rig_read_file(made, error);
    if (status == TIDES_OK) status = td_rig_apply(made, error);
    if (status == TIDES_OK) status = td_run_preset(made, error);
    if (status == TIDES_OK) status = td_run_biases(made, error);
    if (status == TIDES_OK) status = td_run_light(made, error);
    if (status == TIDES_OK) status = check_whole(made, error);
    if (status == TIDES_OK) status = note_view(made, error);
    if (status == TIDES_OK) status = derive(made, error);
    if (status == TIDES_OK)
        *run = made;
    else
        tides_run_destroy(made);
    return status;
}

static tides_status parse(const char *text, size_t bytes, const char *origin, const char *directory,
                          const char *const *overrides, size_t count, tides_run **run, tides_error *error) {
    tides_run *made = NULL;
    tides_status status = create(origin, directory, &made, error);
    if (status != TIDES_OK) return status;
    status = td_run_read(made, text, bytes, error);
    if (status == TIDES_OK) return finish(made, overrides, count, run, error);
    tides_run_destroy(made);
    return status;
}

/* Prints the JSON of a run that was made from `file`. `ok` 0: memory was short. */
static char *print_run(cJSON *root, int32_t ok, const char *file, tides_error *error) {
    char *printed = ok ? cJSON_PrintUnformatted(root) : NULL, *text = printed ? td_strdup(printed, error) : NULL;
    if (!printed) td_fail(error, TIDES_NO_MEMORY, "out of memory: %s", file);
    cJSON_free(printed);
    cJSON_Delete(root);
    return text;
}

/* The run for a splat file given instead of a run file: the file alone, on an orbit, for a tenth of a second. */
static char *run_of_scene(const char *file, tides_error *error) {
    cJSON *root = cJSON_CreateObject();
    int32_t ok = root && cJSON_AddStringToObject(cJSON_AddObjectToObject(root, "scene"), "file", td_base_name(file));
    ok = ok && cJSON_AddNumberToObject(cJSON_AddObjectToObject(root, "camera"), "orbit_s", 12.0);
    ok = ok && cJSON_AddNumberToObject(cJSON_AddObjectToObject(root, "time"), "stop", 0.1);
    return print_run(root, ok, file, error);
}

/* 1 if the argument is a splat file or a model's folder instead of a run file. */
static int32_t is_scene(const char *file) {
    return (!td_ends_in(file, ".json") || td_sog_is_meta(file) || td_sog_is_lod(file)) && tides_scene_is_file(file);
}

/* The run for frames given alone. A video is taken as sRGB, and by default the run ends with the frames. */
static char *run_of_frames(const char *file, tides_error *error) {
    cJSON *root = cJSON_CreateObject(), *frames = root ? cJSON_AddObjectToObject(root, "frames") : NULL;
    int32_t ok = frames && cJSON_AddStringToObject(frames, "file", td_base_name(file));
    if (ok && td_frames_is_video(file)) ok = cJSON_AddStringToObject(frames, "transfer", "srgb") != NULL;
    return print_run(root, ok, file, error);
}

/* Notes that pictures which don't give their transfer are taken as linear light. */
static tides_status note_frames(tides_run *run, const char *file, tides_error *error) {
    char line[300];
    if (!td_is_folder(file) || is_given(run, "frames.transfer", TD_GIVEN_SET)) return TIDES_OK;
    snprintf(line, sizeof line,
             "%.100s: pictures without a run file: their values are taken as linear light; --set frames.transfer=srgb decodes "
             "those of photographs and videos",
             run->origin);
    td_one_line(line);
    return td_run_note(run, line, error);
}

/* Refuses a folder that holds neither a scene nor frames. */
static tides_status refuse_folder(const char *file, tides_error *error) {
    td_folder jpeg = {NULL, 0, 0};
    tides_frames_options options;
    tides_frames *frames = NULL;
    tides_status status = td_folder_list(&jpeg, file, ".jpg", error);
    tides_frames_options_defaults(&options);
    if (status == TIDES_OK && jpeg.count)
        status = tides_frames_open(file, &options, &frames, error); /* its error says what to do */
    tides_frames_close(frames);
    td_folder_free(&jpeg);
    if (status != TIDES_OK) return status;
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: is a folder, and neither a trained model's (point_cloud/iteration_N/point_cloud.ply, params.npz, "
                   "chkpntN.pth, ckpt_N.pt, time_N.ply), nor one of .png or .exr pictures",
                   file);
}

static tides_status note_scene(tides_run *run, tides_error *error) {
    char line[400];
    snprintf(line, sizeof line,
             "%.100s: a scene without a run file: an orbit is found for it (camera.up = [x, y, z] turns it); "
             "tides init --scene %.100s writes a run file to change",
             run->origin, run->origin);
    td_one_line(line);
    return td_run_note(run, line, error);
}

tides_status tides_run_load(const char *file, const char *const *overrides, size_t count, tides_run **run, tides_error *error) {
    if (!file || !run || (count && !overrides))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_load: file, run or overrides is NULL");
    char *text = NULL, *plain = NULL, *directory = NULL;
    size_t bytes = 0;
    /* An HDF5 file may be a scene or frames, and a model's folder may hold pictures, too. */
    const int32_t video = td_frames_is_video(file),
                  scene = !video && (td_is_folder(file) || !td_frames_is(file)) && is_scene(file);
    const int32_t frames = video || (!scene && td_frames_is(file));
    tides_status status = TIDES_OK;
    if (!(plain = td_plain_path(file, error)) || !(directory = td_folder_prefix(plain, error)))
        status = TIDES_NO_MEMORY;
    else if (!scene && !frames)
        status = td_is_folder(file) ? refuse_folder(file, error) : td_read_file(file, RUN_FILE_LIMIT, &text, &bytes, error);
    else if (!(text = scene ? run_of_scene(plain, error) : run_of_frames(plain, error)))
        status = TIDES_NO_MEMORY;
    if (scene || frames) bytes = text ? strlen(text) : 0;
    if (status == TIDES_OK) status = parse(text, bytes, file, directory, overrides, count, run, error);
    if (!scene && !frames) status = td_kind_judge(file, TD_WANTS_RUN, status, error);
    if (status == TIDES_OK && scene) status = note_scene(*run, error);
    if (status == TIDES_OK && frames) status = note_frames(*run, file, error);
    if (status == TIDES_OK && !((*run)->file = td_strdup(file, error))) status = TIDES_NO_MEMORY;
    free(directory);
    free(plain);
    free(text);
    return status;
}

tides_status tides_run_parse(const char *text, const char *directory, const char *const *overrides, size_t count,
                             tides_run **run, tides_error *error) {
    if (!text || !run || (count && !overrides))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_parse: text, run or overrides is NULL");
    return parse(text, strlen(text), "run", directory ? directory : "", overrides, count, run, error);
}

/* Makes a variation from the given values only: a preset is applied again, because the overrides may name another one. */
tides_status tides_run_vary(const tides_run *base, const char *const *overrides, size_t count, tides_run **run,
                            tides_error *error) {
    if (!base || !run || (count && !overrides))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_vary: base, run or overrides is NULL");
    tides_run *made = NULL;
    tides_status status = create(base->origin, base->directory, &made, error);
    if (status == TIDES_OK && base->file && !(made->file = td_strdup(base->file, error))) status = TIDES_NO_MEMORY;
    for (size_t i = 0; status == TIDES_OK && i < td_params_count; i++) {
        const int32_t hidden = base->given[i] > TD_GIVEN_SET; /* the rig's camera or the preset may change */
        const cJSON *value = hidden ? base->beneath[i] : base->given[i] ? base->values[i] : NULL;
        if (!value) continue;
        made->given[i] = hidden ? TD_GIVEN_FILE : base->given[i];
        status = td_run_store(made, &tides_params(NULL)[i], value, error);
    }
    if (status == TIDES_OK) return finish(made, overrides, count, run, error);
    tides_run_destroy(made);
    return status;
}

void tides_run_destroy(tides_run *run) {
    if (!run) return;
    for (size_t i = 0; run->files && i < td_params_count; i++) free(run->files[i]);
    td_run_free_values(run->values);
    td_run_free_values(run->beneath);
    free(run->notes);
    free(run->files);
    free(run->given);
    free(run->origin);
    free(run->file);
    free(run->directory);
    free(run->json);
    free(run);
}
