/* tides info: what a file or folder holds. The kind of file is found from its content. */
#include "info_preset.h"
#include "reading.h"
#include "recording_folder.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <sys/stat.h>

/* -- scenes --------------------------------------------------------------------------------------------------------- */

enum { SWEEP_TIMES = 3 }; /* at the start, middle and end: networks take seconds for each */

/* 1 where the object moves as a whole. */
static int32_t is_carried(const tides_object *object) {
    return object->trajectory && !tides_trajectory_is_static(object->trajectory);
}

/* Number of its Gaussians that move, with the object or by themselves; -1: out of memory. */
static int64_t count_moving(const tides_object *object) {
    if (is_carried(object)) return object->gaussians.count;
    return object->motion ? tides_motion_moving(object->motion, &object->gaussians) : 0;
}

/* Adds facts of a motion: model, number of Gaussians, its own time and how long that lasts here, knots. */
static void add_motion(cJSON *json, const tides_object *object) {
    double start, stop;
    tides_motion_range(object->motion, &start, &stop);
    cJSON_AddStringToObject(json, "motion", tides_motion_model(object->motion));
    cJSON_AddNumberToObject(json, "gaussians_moving", (double)tides_motion_moving(object->motion, &object->gaussians));
    cJSON_AddNumberToObject(json, "own_start", start);
    cJSON_AddNumberToObject(json, "own_stop", stop);
    cJSON_AddNumberToObject(json, "duration_s", object->duration_s);
    cJSON_AddNumberToObject(json, "knots", (double)tides_motion_knots(object->motion));
}

static cJSON *object_json(const tides_object *object) {
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", object->name && object->name[0] ? object->name : "-");
    cJSON_AddNumberToObject(json, "gaussians", (double)object->gaussians.count);
    cJSON_AddNumberToObject(json, "sh_degree", object->gaussians.sh_degree);
    cJSON_AddNumberToObject(json, "scale", object->scale);
    const double *origin = object->gaussians.origin;
    if (fabs(origin[0]) + fabs(origin[1]) + fabs(origin[2]) > 0)
        cJSON_AddItemToObject(json, "origin", cJSON_CreateDoubleArray(origin, 3));
    cJSON_AddBoolToObject(json, "moving", object->motion || is_carried(object));
    double start, stop;
    if (object->trajectory) {
        tides_trajectory_range(object->trajectory, &start, &stop);
        if (isfinite(start) && isfinite(stop)) {
            cJSON_AddNumberToObject(json, "start_s", start);
            cJSON_AddNumberToObject(json, "stop_s", stop);
        }
    }
    if (object->motion) add_motion(json, object);
    return json;
}

/* The box of the means at a few times of the run. */
static tides_status sweep_facts(const tides_scene *scene, double start, double stop, cJSON *facts, tides_error *error) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < SWEEP_TIMES; i++) {
        const double share = (double)i / (SWEEP_TIMES - 1);
        double low[3], high[3];
        tides_status status = tides_scene_bounds_at(scene, (1 - share) * start + share * stop, low, high, error);
        if (status != TIDES_OK) return status;
        for (int k = 0; k < 3; k++) {
            lower[k] = fmin(lower[k], low[k]);
            upper[k] = fmax(upper[k], high[k]);
        }
    }
    cJSON_AddItemToObject(facts, "swept_lower", cJSON_CreateDoubleArray(lower, 3));
    cJSON_AddItemToObject(facts, "swept_upper", cJSON_CreateDoubleArray(upper, 3));
    return TIDES_OK;
}

/* Facts of a scene in which something moves: the share of Gaussians that move, the time that all objects cover, and the box of
 * the means. */
static tides_status motion_facts(const tides_scene *scene, cJSON *facts, tides_error *error) {
    int64_t moving = 0;
    for (int32_t i = 0; i < tides_scene_objects(scene); i++) {
        tides_object object;
        tides_status status = tides_scene_object(scene, i, &object, error);
        if (status != TIDES_OK) return status;
        const int64_t count = count_moving(&object);
        if (count < 0) return cli_error(error, TIDES_NO_MEMORY, "out of memory: counting what moves");
        moving += count;
    }
    cJSON_AddNumberToObject(facts, "gaussians_moving", (double)moving);
    cJSON_AddNumberToObject(facts, "moving_percent", 100.0 * (double)moving / (double)tides_scene_count(scene));
    double start, stop;
    tides_scene_range(scene, &start, &stop);
    if (!isfinite(start) || !isfinite(stop) || start > stop) return TIDES_OK; /* nothing moves, or never all at once */
    cJSON_AddNumberToObject(facts, "start_s", start);
    cJSON_AddNumberToObject(facts, "stop_s", stop);
    return sweep_facts(scene, start, stop, facts, error);
}

/* The name of the colours' transfer in .ply files, or "mixed" where objects differ. */
static const char *transfer_of(const tides_scene *scene) {
    int32_t transfer;
    double gamma;
    return tides_scene_transfer(scene, &transfer, &gamma, NULL) == TIDES_OK ? tides_transfer_name(transfer) : "mixed";
}

/* Facts on the scene's training, and its limits. */
static void tag_facts(const tides_scene *scene, cJSON *facts) {
    static const char *const names[] = {NULL, "plain", "antialiased", "mixed"}; /* TIDES_TRAINED_* */
    const char *trained = names[tides_scene_trained(scene)];
    if (trained) cJSON_AddStringToObject(facts, "trained", trained);
    cJSON_AddStringToObject(facts, "colour_transfer", transfer_of(scene));
    cli_add_notes(facts, tides_scene_notes(scene));
}

static tides_status scene_facts(const char *file, cJSON *facts, tides_error *error) {
    tides_scene *scene = NULL;
    tides_status status = tides_scene_create(&scene, error);
    if (status == TIDES_OK) status = tides_scene_add_file(scene, file, NULL, 1.0, error);
    if (status != TIDES_OK) goto done;
    double lower[3], upper[3], up[3];
    tides_scene_bounds(scene, lower, upper);
    cJSON_AddStringToObject(facts, "kind", "scene");
    cJSON_AddNumberToObject(facts, "gaussians", (double)tides_scene_count(scene));
    cJSON_AddNumberToObject(facts, "sh_degree", tides_scene_sh_degree(scene));
    cJSON_AddItemToObject(facts, "lower", cJSON_CreateDoubleArray(lower, 3));
    cJSON_AddItemToObject(facts, "upper", cJSON_CreateDoubleArray(upper, 3));
    if (tides_scene_up(scene, up)) cJSON_AddItemToObject(facts, "up", cJSON_CreateDoubleArray(up, 3));
    tag_facts(scene, facts);
    status = motion_facts(scene, facts, error);
    cJSON *objects = cJSON_AddArrayToObject(facts, "objects");
    for (int32_t i = 0; i < tides_scene_objects(scene) && status == TIDES_OK; i++) {
        tides_object object;
        status = tides_scene_object(scene, i, &object, error);
        if (status == TIDES_OK) cJSON_AddItemToArray(objects, object_json(&object));
    }
done:
    tides_scene_destroy(scene);
    return status;
}

/* -- paths ---------------------------------------------------------------------------------------------------------- */

static void lens_facts(const tides_lens *lens, cJSON *facts) {
    const struct {
        const char *name;
        double value;
    } all[] = {{"k1", lens->k1}, {"k2", lens->k2}, {"k3", lens->k3}, {"k4", lens->k4}, {"p1", lens->p1}, {"p2", lens->p2}};
    if (lens->model == TIDES_LENS_NONE) return;
    cJSON_AddStringToObject(facts, "lens", tides_lens_name(lens->model));
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (all[i].value > 0 || all[i].value < 0) cJSON_AddNumberToObject(facts, all[i].name, all[i].value);
}

static void intrinsics_facts(const tides_intrinsics *camera, cJSON *facts) {
    if (camera->width) cJSON_AddNumberToObject(facts, "width", camera->width);
    if (camera->height) cJSON_AddNumberToObject(facts, "height", camera->height);
    const struct {
        const char *name;
        double value;
    } rest[] = {{"fx", camera->fx}, {"fy", camera->fy}, {"cx", camera->cx}, {"cy", camera->cy}};
    for (size_t i = 0; i < sizeof rest / sizeof rest[0]; i++)
        if (rest[i].value > 0 || rest[i].value < 0) cJSON_AddNumberToObject(facts, rest[i].name, rest[i].value);
    lens_facts(&camera->lens, facts);
}

/* Length of the path, and the box around its samples. */
static tides_status extent_facts(const tides_trajectory *path, cJSON *facts, tides_error *error) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY}, last[3] = {0}, length = 0;
    for (size_t i = 0; i < tides_trajectory_count(path); i++) {
        tides_pose_sample sample;
        tides_status status = tides_trajectory_sample(path, i, &sample, error);
        if (status != TIDES_OK) return status;
        double square = 0;
        for (int k = 0; k < 3; k++) {
            lower[k] = fmin(lower[k], sample.position[k]);
            upper[k] = fmax(upper[k], sample.position[k]);
            square += (sample.position[k] - last[k]) * (sample.position[k] - last[k]);
            last[k] = sample.position[k];
        }
        if (i) length += sqrt(square);
    }
    cJSON_AddNumberToObject(facts, "length", length);
    if (tides_trajectory_count(path)) {
        cJSON_AddItemToObject(facts, "lower", cJSON_CreateDoubleArray(lower, 3));
        cJSON_AddItemToObject(facts, "upper", cJSON_CreateDoubleArray(upper, 3));
    }
    return TIDES_OK;
}

static tides_status path_facts(const char *file, cJSON *facts, tides_error *error) {
    tides_path_options options;
    tides_path_options_defaults(&options);
    tides_path path = {.trajectory = NULL};
    tides_status status = tides_path_load(file, &options, &path, error);
    if (status != TIDES_OK) return status;
    double start, stop;
    tides_trajectory_range(path.trajectory, &start, &stop);
    cJSON_AddStringToObject(facts, "kind", "path");
    cJSON_AddStringToObject(facts, "format", path.format);
    cJSON_AddNumberToObject(facts, "samples", (double)tides_trajectory_count(path.trajectory));
    cJSON_AddBoolToObject(facts, "static", tides_trajectory_is_static(path.trajectory));
    if (isfinite(start) && isfinite(stop)) {
        cJSON_AddNumberToObject(facts, "start_s", start);
        cJSON_AddNumberToObject(facts, "stop_s", stop);
        cJSON_AddNumberToObject(facts, "duration_s", stop - start);
    }
    intrinsics_facts(&path.intrinsics, facts);
    if (path.distorted) cJSON_AddStringToObject(facts, "lens", "unknown");
    if (path.untimed) cJSON_AddStringToObject(facts, "times", "none: spread evenly over camera.duration_s");
    cli_add_notes(facts, path.notes);
    status = extent_facts(path.trajectory, facts, error);
    tides_trajectory_destroy(path.trajectory);
    return status;
}

/* -- events --------------------------------------------------------------------------------------------------------- */

static void label_facts(int32_t labels, cJSON *facts) {
    static const struct {
        int32_t label;
        const char *name;
    } all[] = {{TIDES_LABEL_CAUSE, "cause"}, {TIDES_LABEL_FIRED, "fired"}, {TIDES_LABEL_FRONTEND, "frontend"}};
    cJSON *names = labels ? cJSON_AddArrayToObject(facts, "labels") : NULL;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (labels & all[i].label) cJSON_AddItemToArray(names, cJSON_CreateString(all[i].name));
}

static void event_facts(const tides_event_summary *s, cJSON *facts) {
    const double duration = 1e-9 * (double)(s->last_ns - s->first_ns);
    cJSON_AddStringToObject(facts, "kind", "events");
    cJSON_AddStringToObject(facts, "layout", s->layout);
    if (s->version[0]) cJSON_AddStringToObject(facts, "version", s->version);
    cJSON_AddNumberToObject(facts, "width", s->width ? s->width : s->right);
    cJSON_AddNumberToObject(facts, "height", s->height ? s->height : s->bottom);
    cJSON_AddStringToObject(facts, "size_from", s->width ? "file" : "events");
    cJSON_AddNumberToObject(facts, "events", (double)s->count);
    cJSON_AddNumberToObject(facts, "events_on", (double)s->count_on);
    cJSON_AddNumberToObject(facts, "events_off", (double)(s->count - s->count_on));
    cli_add_ns(facts, "first_ns", s->first_ns);
    cli_add_ns(facts, "last_ns", s->last_ns);
    cli_add_seconds(facts, "first_s", s->first_ns); /* the times that `tides cut` and `view` take as --start */
    cJSON_AddNumberToObject(facts, "duration_s", duration);
    if (duration > 0) cJSON_AddNumberToObject(facts, "rate_hz", (double)s->count / duration);
    if (s->count) cJSON_AddNumberToObject(facts, "on_percent", 100.0 * (double)s->count_on / (double)s->count);
    cJSON_AddNumberToObject(facts, "disorder", (double)s->disorder);
    label_facts(s->labels, facts);
}

/* Facts of an event file: how it was read, if the file leaves that open, and what in it isn't an event. `out` (nullable) gets
 * the summary. */
static tides_status events_facts(const char *file, const tides_event_reading *how, cJSON *facts, tides_event_summary *out,
                                 tides_error *error) {
    tides_event_reader *reader = NULL;
    tides_event_summary summary;
    tides_event_facts told;
    tides_status status = tides_event_reader_open_as(file, how, &reader, error);
    if (status == TIDES_OK) status = tides_event_reader_summary(reader, &summary, error);
    if (status == TIDES_OK) {
        event_facts(&summary, facts);
        tides_event_reader_facts(reader, &told);
        if (told.read_as[0]) cJSON_AddStringToObject(facts, "read_as", told.read_as);
        if (told.dropped) cJSON_AddNumberToObject(facts, "invalid_dropped", (double)told.dropped);
        if (told.zero != TIDES_ZERO_EVENT) cli_add_seconds(facts, "zero_s", told.zero_ns);
        if (out) *out = summary;
    }
    tides_event_reader_close(reader);
    return status;
}

/* 1 where the file opens as an event file. */
static tides_status open_events(const char *file) {
    tides_event_reader *reader = NULL;
    tides_error error;
    tides_status status = tides_event_reader_open(file, NULL, &reader, &error);
    tides_event_reader_close(reader);
    return status;
}

/* HDF5 holds events or a scene. For a file that is neither, both reasons are reported. */
static tides_status hdf5_facts(const char *file, cJSON *facts, tides_error *error) {
    tides_error events = {TIDES_OK, ""}, scene = {TIDES_OK, ""};
    if (events_facts(file, NULL, facts, NULL, &events) == TIDES_OK) return TIDES_OK;
    /* The file has events, and their reader lacks a part or an option. */
    if (events.status == TIDES_UNSUPPORTED || events.status == TIDES_BAD_ARGUMENT) {
        *error = events;
        return error->status;
    }
    if (scene_facts(file, facts, &scene) == TIDES_OK) return TIDES_OK;
    return cli_error(error, TIDES_BAD_FILE, "%s: HDF5, but neither events (%.300s) nor a scene (%.300s)", file, events.text,
                     scene.text);
}

/* -- images --------------------------------------------------------------------------------------------------------- */

static cJSON *channel_json(const char *name, const float *pixels, size_t count) {
    double least = INFINITY, most = -INFINITY, sum = 0;
    size_t finite = 0;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(pixels[i])) continue;
        least = fmin(least, pixels[i]);
        most = fmax(most, pixels[i]);
        sum += pixels[i];
        finite++;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", name);
    if (finite) {
        cJSON_AddNumberToObject(json, "min", least);
        cJSON_AddNumberToObject(json, "max", most);
        cJSON_AddNumberToObject(json, "mean", sum / (double)finite);
    }
    if (finite < count) cJSON_AddNumberToObject(json, "not_finite", (double)(count - finite));
    return json;
}

static tides_status exr_facts(const char *file, cJSON *facts, tides_error *error) {
    tides_exr *exr = NULL;
    tides_status status = tides_exr_read(file, &exr, error);
    if (status != TIDES_OK) return status;
    int32_t width, height, count;
    tides_exr_size(exr, &width, &height, &count);
    cJSON_AddStringToObject(facts, "kind", "exr");
    cJSON_AddNumberToObject(facts, "width", width);
    cJSON_AddNumberToObject(facts, "height", height);
    cJSON *channels = cJSON_AddArrayToObject(facts, "channels");
    for (int32_t i = 0; i < count; i++)
        cJSON_AddItemToArray(channels,
                             channel_json(tides_exr_name(exr, i), tides_exr_pixels(exr, i), (size_t)width * (size_t)height));
    tides_exr_destroy(exr);
    return TIDES_OK;
}

/* -- run files ------------------------------------------------------------------------------------------------------ */

/* One file or folder that a run reads, and its size, or that it is missing. */
static cJSON *input_json(tides_fingerprints *prints, const tides_run_input *input) {
    tides_fingerprint print;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "key", input->key);
    cJSON_AddStringToObject(json, "path", input->path);
    if (tides_fingerprints_file(prints, input->path, &print, NULL) == TIDES_OK) {
        if (input->folder) cJSON_AddNumberToObject(json, "files", (double)print.files);
        cJSON_AddNumberToObject(json, "bytes", (double)print.bytes);
    } else
        cJSON_AddBoolToObject(json, "missing", 1);
    return json;
}

static tides_status run_facts_of(const tides_run *run, cJSON *facts, tides_error *error) {
    tides_run_values v;
    tides_fingerprints *prints = NULL;
    tides_run_input *inputs = NULL;
    size_t count = 0;
    tides_status status = tides_fingerprints_create(NULL, &prints, error);
    if (status == TIDES_OK) status = tides_run_inputs(run, &inputs, &count, error);
    if (status == TIDES_OK) {
        tides_run_get(run, &v);
        cJSON_AddStringToObject(facts, "kind", "run");
        cJSON_AddStringToObject(facts, "method", v.method);
        cJSON_AddNumberToObject(facts, "start_s", v.start);
        cJSON_AddNumberToObject(facts, "stop_s", v.stop);
        cJSON_AddNumberToObject(facts, "duration_s", v.stop - v.start);
        if (v.intrinsics.width) cJSON_AddNumberToObject(facts, "width", v.intrinsics.width);
        if (v.intrinsics.height) cJSON_AddNumberToObject(facts, "height", v.intrinsics.height);
        cJSON *list = cJSON_AddArrayToObject(facts, "inputs");
        for (size_t i = 0; i < count; i++) cJSON_AddItemToArray(list, input_json(prints, &inputs[i]));
    }
    tides_free(inputs);
    tides_fingerprints_destroy(prints);
    return status;
}

/* 1 where a text that can be read neither as a run nor as a path was meant as a run: the error of the run is then reported. */
static int32_t looks_like_run(const char *text) {
    static const char *const keys[] = {"\"scene\"", "\"sensor\"", "\"stepping\"", "\"time\":"};
    while (*text == ' ' || *text == '\t' || *text == '\r' || *text == '\n') text++;
    if (text[0] == '/' && text[1] == '/') return 1;
    for (size_t i = 0; *text == '{' && !strstr(text, "\"frames\"") && i < sizeof keys / sizeof *keys; i++)
        if (strstr(text, keys[i])) return 1;
    return 0;
}

/* A text is a run file if it can be read as one, which no path can; else a path. `start`: its first bytes. */
static tides_status text_facts(const char *file, const char *start, cJSON *facts, tides_error *error) {
    tides_run *run = NULL;
    tides_error of_run;
    if (tides_run_load(file, NULL, 0, &run, &of_run) != TIDES_OK) {
        tides_status of_preset = TIDES_OK;
        if (info_preset(file, facts, &of_preset, error)) return of_preset;
        tides_status of_path = path_facts(file, facts, error);
        if (of_path != TIDES_OK && looks_like_run(start)) *error = of_run;
        return of_path;
    }
    tides_status status = run_facts_of(run, facts, error);
    tides_run_destroy(run);
    return status;
}

/* -- arrays, and what isn't what it seems ------------------------------------------------------------------------------- */

/* Facts of a .npy without events: type and shape of its header. */
static tides_status array_facts(const char *start, size_t got, cJSON *facts) {
    const size_t at = start[6] == 1 ? 10 : 12;
    char shape[128] = "?", type[32] = "?";
    const char *text = got > at ? start + at : "", *found = strstr(text, "'shape': (");
    if (found) sscanf(found + 10, "%127[^)]", shape);
    found = strstr(text, "'descr': '");
    if (found) sscanf(found + 10, "%31[^']", type);
    cJSON_AddStringToObject(facts, "kind", "array");
    cJSON_AddStringToObject(facts, "type", type);
    cJSON_AddStringToObject(facts, "shape", shape);
    return TIDES_OK;
}

/* Facts of a folder. If it holds no events, the path's reader gives the best reason. */
static tides_status folder_facts(const char *file, cJSON *facts, tides_error *error) {
    if (tides_scene_is_file(file)) return scene_facts(file, facts, error);
    if (open_events(file) != TIDES_FILE_NOT_FOUND) {
        tides_event_summary summary;
        const tides_status events = events_facts(file, NULL, facts, &summary, error);
        if (events == TIDES_OK) recording_folder_facts(file, &summary, facts);
        return events;
    }
    const tides_status status = path_facts(file, facts, error);
    if (status != TIDES_FILE_NOT_FOUND) return status;
    if (tides_file_foreign(file, error) != TIDES_OK) return TIDES_BAD_FILE;
    return cli_error(error, status,
                     "%s: is a folder in which nothing is known: no trained model, no events of DSEC, EDS, ECD, MVSEC, "
                     "BlinkFlow, HS-ERGB, BS-ERGB or rpg_vid2e, no camera path of COLMAP, nerfstudio, INRIA, LLFF, nerfies or "
                     "EuRoC; pictures are for frames.file",
                     file);
}

static tides_status facts_of(const char *file, cJSON *facts, tides_error *error) {
    char head[4096] = {0};
    struct stat folder;
    if (stat(file, &folder) == 0 && S_ISDIR(folder.st_mode)) return folder_facts(file, facts, error);
    FILE *stream = fopen(file, "rb");
    if (!stream && !strchr(file, '/') && access(file, F_OK) != 0) {
        const tides_status named = info_named_preset(file, facts, error);
        if (named != TIDES_FILE_NOT_FOUND) return named;
        return cli_error(error, named, "%s: can't be opened: there is no such file, nor a preset of that name", file);
    }
    if (!stream) return cli_error(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", file, strerror(errno));
    size_t got = fread(head, 1, sizeof head - 1, stream);
    const int32_t failed = ferror(stream);
    fclose(stream);
    if (failed) return cli_error(error, TIDES_BAD_FILE, "%s: can't be read: %s", file, strerror(errno));
    if (got == 0) return cli_error(error, TIDES_BAD_FILE, "%s: is empty", file);
    if (memcmp(head, "\x89HDF\r\n\x1a\n", 8) == 0) return hdf5_facts(file, facts, error);
    if (memcmp(head, "\x76\x2f\x31\x01", 4) == 0) return exr_facts(file, facts, error);
    const tides_status events = open_events(file);
    if (events == TIDES_OK || events == TIDES_BAD_ARGUMENT) return events_facts(file, NULL, facts, NULL, error);
    if (tides_scene_is_file(file)) return scene_facts(file, facts, error);
    if (memcmp(head, "\x93NUMPY", 6) == 0) return array_facts(head, got, facts);
    const tides_status foreign = tides_file_foreign(file, error);
    if (foreign != TIDES_OK) return foreign;
    return text_facts(file, head, facts, error); /* the path's reader gives the best reason */
}

int cmd_info(const cli_command *command, int argc, char **argv) {
    cli_common common;
    const char *file = NULL;
    cli_reading reading = {.format = NULL};
    tides_event_reading how;
    const cli_option options[] = {
        CLI_READING_FILE(reading),
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &file);
    if (code == CLI_GO) code = cli_reading_parse(command, &reading, &how);
    if (code != CLI_GO) return code;
    const int as_events = how.format || how.columns || how.unit || how.stream || how.drop_invalid;
    tides_error error = {TIDES_OK, ""};
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "file", file);
    const tides_status status = !facts      ? TIDES_OK
                                : as_events ? events_facts(file, &how, facts, NULL, &error)
                                            : facts_of(file, facts, &error);
    if (status != TIDES_OK) {
        cJSON_Delete(facts);
        return cli_fail(&error);
    }
    return cli_report_facts(facts, &common);
}
