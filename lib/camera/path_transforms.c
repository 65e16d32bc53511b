/* transforms.json as nerfstudio, instant-ngp, Blender and D-NeRF write it.
 *
 * `transform_matrix` is camera-to-world in OpenGL axes (x right, y up, z back), so its y and z columns change sign here.
 * Intrinsics are fl_x fl_y cx cy w h, for all frames or per frame. fl_x and fl_y may be given as camera_angle_x and
 * camera_angle_y; a missing fl_y equals fl_x, and a missing principal point is the image's middle. A Blender file without a
 * size sets only path.field_of_view_x. The lens is k1 k2 p1 p2 k3 (OPENCV, or no camera_model), k1 to k4 (OPENCV_FISHEYE, and
 * instant-ngp's is_fisheye), or nerfstudio's distortion_params k1 k2 k3 k4 p1 p2. Any other lens sets path.distorted.
 *
 * Frames with `time` (or `timestamp`) are sorted by it. Trainers scale time to [0, 1]: such times are multiplied by the
 * option `duration`. Larger times have a unit, which is guessed if no option gives it. Frames without times are spread over
 * `duration` in the order of file_path, since trainers write the list in any order. Unknown keys are ignored. */
#include "camera/td_path_reader.h"

#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

/* Reads a positive number from the frame, or else from the root; without either, `value` is unchanged. */
static tides_status inherited(td_path_reader *reader, const cJSON *frame, const cJSON *root, const char *where, const char *key,
                              double *value) {
    int own = td_json_has(frame, key);
    if (!own && !td_json_has(root, key)) return TIDES_OK;
    double number = 0.0;
    tides_status status = td_json_number(reader, own ? frame : root, own ? where : "", key, &number);
    if (status != TIDES_OK) return status;
    if (!(number > 0.0)) return td_json_fail(reader, own ? where : "", key, "must be above 0");
    *value = number;
    return TIDES_OK;
}

/* Focal length [px] for a field of view `angle` [rad] across `pixels`. */
static double focal_length(double angle, double pixels) { return 0.5 * pixels / td_tan(0.5 * angle); }

static tides_status read_intrinsics(td_path_reader *reader, const cJSON *frame, const cJSON *root, const char *where,
                                    tides_intrinsics *out, double *angle_x) {
    static const char *const keys[] = {"w", "h", "fl_x", "fl_y", "cx", "cy", "camera_angle_x", "camera_angle_y"};
    double v[8] = {0};
    for (int k = 0; k < 8; k++) {
        tides_status status = inherited(reader, frame, root, where, keys[k], v + k);
        if (status != TIDES_OK) return status;
    }
    for (int k = 0; k < 2; k++) {
        if (v[k] > INT32_MAX || v[k] != floor(v[k]))
            return td_json_fail(reader, where, keys[k], "must be a whole number of pixels");
        if (v[6 + k] >= TD_PI)
            return td_json_fail(reader, where, keys[6 + k], "is a field of view in radians and must be below pi");
        if (v[2 + k] <= 0.0 && v[6 + k] > 0.0 && v[k] > 0.0) v[2 + k] = focal_length(v[6 + k], v[k]);
    }
    if (v[3] <= 0.0) v[3] = v[2];
    out->width = (int32_t)v[0];
    out->height = (int32_t)v[1];
    out->fx = v[2];
    out->fy = v[3];
    out->cx = v[4] > 0.0 ? v[4] : 0.5 * v[0];
    out->cy = v[5] > 0.0 ? v[5] : 0.5 * v[1];
    *angle_x = v[6];
    return TIDES_OK;
}

/* A key's item in the frame, or else in the root. */
static const cJSON *inherited_item(const cJSON *frame, const cJSON *root, const char *key) {
    const cJSON *own = cJSON_GetObjectItemCaseSensitive(frame, key);
    return own ? own : cJSON_GetObjectItemCaseSensitive(root, key);
}

/* A coefficient from the frame, or else the root, or 0. */
static double coefficient(const cJSON *frame, const cJSON *root, const char *key) {
    const cJSON *item = inherited_item(frame, root, key);
    return cJSON_IsNumber(item) ? item->valuedouble : 0;
}

/* Reads the lens; returns 0 if TIDES has no such lens. */
static int read_lens(const cJSON *frame, const cJSON *root, tides_lens *lens) {
    static const char *const keys[] = {"k1", "k2", "k3", "k4", "p1", "p2"};
    static const char *const models[] = {"OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "PERSPECTIVE"};
    const cJSON *model = inherited_item(frame, root, "camera_model"), *list = inherited_item(frame, root, "distortion_params");
    const char *name = cJSON_IsString(model) ? model->valuestring : "OPENCV";
    int fisheye = strcmp(name, "OPENCV_FISHEYE") == 0 || cJSON_IsTrue(inherited_item(frame, root, "is_fisheye"));
    int known = fisheye || !cJSON_IsString(model);
    double c[6] = {0};
    for (int k = 0; k < 6; k++) {
        const cJSON *item = cJSON_GetArrayItem(list, k);
        c[k] = cJSON_IsNumber(item) ? item->valuedouble : coefficient(frame, root, keys[k]);
    }
    for (size_t k = 0; k < sizeof models / sizeof *models; k++) known |= strcmp(name, models[k]) == 0;
    if (fisheye)
        *lens = td_equidistant(c);
    else
        *lens = td_radtan((const double[5]){c[0], c[1], c[4], c[5], c[2]});
    const double rest = fisheye ? fabs(c[4]) + fabs(c[5]) : fabs(c[3]);
    if (known && !(rest > 0)) return 1;
    *lens = (tides_lens){.model = TIDES_LENS_NONE};
    return 0;
}

static tides_status read_pose(td_path_reader *reader, const cJSON *frame, const char *where, tides_pose_sample *pose) {
    double matrix[16] = {[15] = 1.0};
    int rows = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(frame, "transform_matrix")) == 3 ? 3 : 4;
    tides_status status = td_json_matrix(reader, frame, where, "transform_matrix", matrix, rows, 4);
    return status == TIDES_OK ? td_json_opengl_pose(reader, where, "transform_matrix", matrix, pose) : status;
}

/* Sorts and scales the times of all frames, or spreads the frames evenly if the file has no times. */
static tides_status settle_times(td_path_reader *reader, size_t timed) {
    if (timed == 0) {
        td_path_order(reader, 1);
        return TIDES_OK;
    }
    if (timed != reader->count)
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: only %zu of %zu frames have a \"time\": give it to all or to none",
                       reader->file, timed, reader->count);
    td_path_sort(reader);
    for (size_t i = 0; i < reader->count; i++) reader->samples[i].word = NULL; /* these times are numbers already, not texts */
    int normalised = reader->samples[0].time >= 0.0 && reader->samples[reader->count - 1].time <= 1.0, digits;
    if (normalised && reader->options->time_unit == TIDES_TIME_AUTO) {
        for (size_t i = 0; i < reader->count; i++) reader->samples[i].time *= reader->options->duration;
        return TIDES_OK;
    }
    tides_status status = td_path_find_unit(reader, -1, 9, &digits);
    if (status == TIDES_OK && digits < 0) td_path_spread(reader);
    for (size_t i = 0; status == TIDES_OK && digits >= 0 && i < reader->count; i++)
        reader->samples[i].time /= td_pow(10, 9 - digits);
    return status;
}

/* Reads a frame's time, under the names that trainers use. */
static tides_status read_time(td_path_reader *reader, const cJSON *frame, const char *where, td_path_sample *sample,
                              size_t *timed) {
    const char *key = td_json_has(frame, "time") ? "time" : "timestamp";
    if (!td_json_has(frame, key)) return TIDES_OK;
    ++*timed;
    return td_json_number(reader, frame, where, key, &sample->time);
}

tides_status td_path_read_transforms(td_path_reader *reader, const cJSON *root) {
    const cJSON *frames = cJSON_GetObjectItemCaseSensitive(root, "frames"), *frame;
    if (!cJSON_IsArray(frames)) return td_json_fail(reader, "", "frames", "must be a list");
    size_t index = 0, timed = 0;
    reader->list = "frames";
    strcpy(reader->path.format, "transforms");
    cJSON_ArrayForEach(frame, frames) {
        char where[48];
        td_path_view view = {.distorted = 0};
        snprintf(where, sizeof where, "frames[%zu]", index);
        td_path_sample *sample = td_path_append(reader, index++);
        if (!sample) return TIDES_NO_MEMORY;
        td_path_set_name(sample, frame, "file_path");
        tides_status status = read_pose(reader, frame, where, &sample->pose);
        if (status == TIDES_OK) status = read_intrinsics(reader, frame, root, where, &view.intrinsics, &view.field_of_view_x);
        if (status == TIDES_OK) status = read_time(reader, frame, where, sample, &timed);
        view.distorted = !read_lens(frame, root, &view.intrinsics.lens);
        if (status == TIDES_OK) status = td_path_set_view(reader, sample, &view);
        if (status != TIDES_OK) return status;
    }
    const tides_status status = settle_times(reader, timed);
    return status == TIDES_OK ? td_path_apply_frame(reader, root) : status;
}
