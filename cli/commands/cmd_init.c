/* tides init: writes a run file to begin with: the keys that most runs set, or with --all every key, each with its default and
 * an explanation. Defaults are written as comments, because a value that is given would keep a preset from setting it. */
#include "recording_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct template {
    FILE *file;
    const tides_param *rows;
    size_t count;
    const char *scene, *camera;        /* file names; no camera: an orbit */
    int32_t all;                       /* every key, not only the common ones */
    const recording_folder *recording; /* NULL: a scene's run */
    const char *folder;                /* the recording's, as the run file names it */
}
template;

/* The next row to be written, from `i` on, in the group of `prefix`'s first `length` characters. */
static size_t next_row(const template *t, size_t i, const char *prefix, size_t length) {
    for (; i < t->count; i++) {
        const tides_param *row = &t->rows[i];
        const int32_t written = t->all || row->common || (t->recording && strncmp(row->key, "camera.", 7) == 0); /* its lens */
        if (written && strncmp(row->key, prefix, length) == 0) break;
    }
    return i;
}

static void put_quoted(FILE *file, const char *text) {
    cJSON *value = cJSON_CreateString(text);
    char *quoted = value ? cJSON_PrintUnformatted(value) : NULL;
    if (quoted) fputs(quoted, file);
    cJSON_free(quoted);
    cJSON_Delete(value);
}

/* Writes the recording's value of this row; 0: it has none. */
static int32_t put_recorded(const template *t, const tides_param *row) {
    static const char *const lens[RECORDING_LENS] = {"camera.fx", "camera.fy", "camera.cx", "camera.cy", "camera.k1",
                                                     "camera.k2", "camera.p1", "camera.p2", "camera.k3"};
    const recording_folder *r = t->recording;
    char path[2 * RECORDING_PATH];
    for (int32_t i = 0; r && i < r->lens_count; i++)
        if (strcmp(row->key, lens[i]) == 0) return fprintf(t->file, "%.12g", r->lens[i]) > 0;
    if (r && r->lens_count > 4 && strcmp(row->key, "camera.lens") == 0) return fputs("\"radtan\"", t->file) >= 0;
    const double first = r ? fmax(r->first_s, 1e-9 * (double)r->events.first_ns) : 0;
    const double last = r ? fmin(r->last_s, 1e-9 * (double)r->events.last_ns) : 0;
    if (r && strcmp(row->key, "time.start") == 0) return fprintf(t->file, "%.9f", first < last ? first : r->first_s) > 0;
    if (r && strcmp(row->key, "time.stop") == 0) return fprintf(t->file, "%.9f", first < last ? last : r->last_s) > 0;
    if (!r || (strcmp(row->key, "frames.file") != 0 && strcmp(row->key, "camera.file") != 0)) return 0;
    const char *name = row->key[0] == 'f' ? r->frames : r->poses;
    if (!*name) return 0;
    snprintf(path, sizeof path, "%s/%s", t->folder, name);
    put_quoted(t->file, path);
    return 1;
}

static void put_value(const template *t, const tides_param *row) {
    if (put_recorded(t, row)) return;
    if (strcmp(row->key, "scene.file") == 0)
        put_quoted(t->file, t->scene);
    else if (strcmp(row->key, "camera.file") == 0)
        put_quoted(t->file, t->camera ? t->camera : "path.json");
    else if (strcmp(row->key, "camera.orbit_s") == 0 && !t->camera)
        fputs("12.0", t->file);
    else
        fputs(row->fallback ? row->fallback : "null", t->file);
}

static int32_t is_key(const tides_param *row, const char *key) { return strcmp(row->key, key) == 0; }

/* 1 for rows that most users set and that no preset sets. */
static int32_t is_open(const template *t, const tides_param *row) {
    if (t->recording) return is_key(row, "frames.file") || strncmp(row->key, "time.st", 7) == 0;
    return is_key(row, "scene.file") || is_key(row, t->camera ? "camera.file" : "camera.orbit_s") ||
           strncmp(row->key, "time.", 5) == 0;
}

/* Writes a row: // "key": default, // sentence [unit]: choices */
static void put_row(const template *t, const tides_param *row, const char *name, int indent) {
    fprintf(t->file, "%*s%s\"%s\": ", indent, "", is_open(t, row) ? "" : "// ", name);
    put_value(t, row);
    fprintf(t->file, ", // %s", row->sentence);
    if (row->unit[0]) fprintf(t->file, " [%s]", row->unit);
    if (row->choices) fprintf(t->file, ": %s", row->choices);
    putc('\n', t->file);
}

/* Writes the rows of a group, which are neighbours in the table, and returns the index behind them. */
static size_t put_group(const template *t, size_t i, size_t length, int indent) {
    const char *prefix = t->rows[i].key;
    for (size_t next = i; next < t->count; i = next) {
        const char *name = t->rows[next].key + length;
        const size_t part = strcspn(name, ".");
        if (name[part]) {
            fprintf(t->file, "%*s\"%.*s\": {\n", indent, "", (int)part, name);
            i = put_group(t, next, length + part + 1, indent + 2);
            next = next_row(t, i, prefix, length);
            fprintf(t->file, "%*s},\n", indent, "");
        } else {
            const tides_param *row = &t->rows[next];
            i = next + 1;
            next = next_row(t, i, prefix, length);
            put_row(t, row, name, indent);
        }
        if (next == t->count) break;
    }
    return i;
}

/* The template's text; `t` has no rows and file yet. */
static char *make_template(template t) {
    char *text = NULL;
    size_t bytes = 0;
    t.rows = tides_params(&t.count);
    t.file = open_memstream(&text, &bytes);
    if (!t.file) return NULL;
    fputs("// A run file of TIDES: tides simulate FILE -o events.h5. Paths are relative to this file. What stands "
          "behind // is\n"
          "// the default: take the // away in front of a key to change it. A sensor: \"preset\": \"dvs128\".\n",
          t.file);
    if (!t.all) fputs("// tides init --all writes all keys; tides simulate --help-all explains them.\n", t.file);
    if (t.recording)
        fputs("// Light is the recording's frames here. Of a scene trained from them: scene.file, camera.file and the lens "
              "below in "
              "place of frames.file.\n",
              t.file);
    fputs("{\n", t.file);
    put_group(&t, next_row(&t, 0, "", 0), 0, 2);
    fputs("}", t.file);
    const int32_t whole = !ferror(t.file);
    if (fclose(t.file) == 0 && whole) return text;
    free(text);
    return NULL;
}

/* Reads the template, which must be valid: an error here is a bug of TIDES. */
static tides_status check(const char *text, tides_error *error) {
    tides_run *run = NULL;
    tides_status status = tides_run_parse(text, "", NULL, 0, &run, error);
    tides_run_destroy(run);
    return status;
}

/* Refuses to replace the scene and the path that the run file names, also with --force. */
static tides_status check_output(const char *output, const char *scene, const char *camera, tides_error *error) {
    const cli_output written = {output, ".json"};
    const tides_status status = cli_check_outputs(scene, &written, 1, error);
    return status == TIDES_OK ? cli_check_outputs(camera, &written, 1, error) : status;
}

/* Finds the files of a recording's run file. Their paths are relative to the folder in which the command runs, so that the
 * output must be written there. */
static tides_status look_into(const char *folder, const char *output, recording_folder *found, char *lines, size_t size,
                              tides_error *error) {
    tides_status status = recording_folder_read(folder, found, error);
    if (status != TIDES_OK) return status;
    if (!found->frames[0] || found->frame_count < 2)
        return cli_error(error, TIDES_FILE_NOT_FOUND,
                         "%s: has events and %s frames with times (images/ with images.txt or timestamps.txt): a run needs "
                         "light, of two frames or of a scene (--scene)",
                         folder, found->frames[0] ? "less than two" : "no");
    if (strchr(output, '/'))
        return cli_error(error, TIDES_BAD_ARGUMENT, "-o %s: a recording's run file goes into this folder, as its paths do",
                         output);
    recording_folder_lines(found, lines, size);
    return TIDES_OK;
}

int cmd_init(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *output = NULL, *scene = NULL, *camera = NULL, *folder = NULL;
    recording_folder recording;
    char lines[512] = "";
    tides_error error = {TIDES_OK, ""};
    int32_t force = 0, all = 0;
    const cli_option options[] = {
        {"--output", 'o', "RUN.json", "the file to write (run.json)", NULL, &output, NULL},
        {"--scene", 0, "FILE", "scene.file (scene.ply)", NULL, &scene, NULL},
        {"--camera", 0, "FILE", "camera.file (with a scene alone: an orbit about it)", NULL, &camera, NULL},
        {"--all", 0, NULL, "every key, not only those that most runs set", &all, NULL, NULL},
        {"--force", 0, NULL, "replace a file that is there", &force, NULL, NULL},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &folder);
    if (code != CLI_GO) return code;
    if (!output) output = "run.json";
    if (!force && access(output, F_OK) == 0)
        return cli_failed("%s: is there already; name another with -o, or replace it with --force", output);

    if (folder && (scene || camera)) return cli_usage(command, "%s: a recording has no --scene or --camera", folder);
    if (folder && look_into(folder, output, &recording, lines, sizeof lines, &error) != TIDES_OK) return cli_fail(&error);
    char *text = make_template((template){.scene = scene ? scene : "scene.ply",
                                          .camera = camera || scene ? camera : "path.json",
                                          .all = all,
                                          .folder = folder,
                                          .recording = folder ? &recording : NULL});
    if (!text) return cli_failed("out of memory: %s", output);
    tides_status status = check_output(output, scene, camera, &error);
    if (status == TIDES_OK) status = check(text, &error);
    if (status == TIDES_OK) status = cli_write_text(output, text, &error);
    free(text);
    if (status != TIDES_OK) return cli_fail(&error);
    if (common.json) {
        cJSON *facts = cJSON_CreateObject();
        cJSON_AddStringToObject(facts, "file", output);
        return cli_print_facts(facts, 1);
    }
    cli_tell_lines(&common, lines);
    if (!common.quiet && folder)
        printf("%s: tides calibrate %s %s -o sensor.json measures its sensor; then set sensor.preset\n", output, folder,
               output);
    else if (!common.quiet)
        printf("%s: %stides simulate %s -o events.h5\n", output,
               scene ? "" : "name your scene and camera path in it, then: ", output);
    return CLI_OK;
}
