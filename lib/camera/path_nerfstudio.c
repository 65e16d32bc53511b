/* nerfstudio's camera_path.json, as its viewer and its Blender add-on write it for ns-render:
 *
 *   {"camera_type": "perspective", "render_width": 1920, "render_height": 1080, "fps": 24, "seconds": 4,
 *    "camera_path": [{"camera_to_world": [16 numbers by rows], "fov": 50}, ...], "keyframes": [...], ...}
 *
 * camera_to_world is in OpenGL axes; fov [degrees] is over the image's height. Pose k of n is at k seconds / n, as in
 * ns-render's film (so a Blender file's last frame is one frame before its end). Without "seconds" it is at k / fps, and
 * without "fps" poses are spread over `duration`. nerfstudio's fisheye is the equidistant lens without coefficients, with a
 * focal length from the same fov. "keyframes", from which the viewer made the path by its own splines, have had several
 * forms, and aren't read. Keys that aren't named here are ignored. */
#include "camera/td_path_reader.h"

#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

/* The camera model and size, common to all poses; only fov may vary. */
static tides_status read_camera(td_path_reader *reader, const cJSON *root, tides_intrinsics *out) {
    const cJSON *type = cJSON_GetObjectItemCaseSensitive(root, "camera_type");
    const char *name = cJSON_IsString(type) ? type->valuestring : "perspective";
    const int fisheye = strcmp(name, "fisheye") == 0;
    if (!fisheye && strcmp(name, "perspective") != 0)
        return td_json_fail(reader, "", "camera_type", "must be \"perspective\" or \"fisheye\": others aren't rendered");
    tides_status status = td_json_pixels(reader, root, "", "render_width", &out->width);
    if (status == TIDES_OK) status = td_json_pixels(reader, root, "", "render_height", &out->height);
    out->cx = 0.5 * out->width;
    out->cy = 0.5 * out->height;
    out->lens = fisheye ? td_equidistant((const double[4]){0}) : (tides_lens){.model = TIDES_LENS_NONE};
    return status;
}

/* Reads the time between poses [s]; 0 if the file has none. */
static tides_status read_interval(td_path_reader *reader, const cJSON *root, int count, double *interval) {
    static const char *const keys[] = {"seconds", "fps"};
    *interval = 0;
    for (int k = 0; k < 2; k++) {
        double value;
        if (!td_json_has(root, keys[k])) continue;
        tides_status status = td_json_number(reader, root, "", keys[k], &value);
        if (status == TIDES_OK && !(value > 0)) status = td_json_fail(reader, "", keys[k], "must be above 0");
        if (status == TIDES_OK) *interval = k == 0 ? value / count : 1 / value;
        return status;
    }
    return TIDES_OK;
}

static tides_status read_pose(td_path_reader *reader, const cJSON *item, const char *where, const tides_intrinsics *camera,
                              td_path_sample *sample) {
    static const double degree = TD_PI / 180;
    double matrix[16], angle = 0;
    td_path_view view = {.intrinsics = *camera};
    tides_status status = td_json_vector(reader, item, where, "camera_to_world", matrix, 16);
    if (status == TIDES_OK) status = td_json_opengl_pose(reader, where, "camera_to_world", matrix, &sample->pose);
    if (status == TIDES_OK) status = td_json_number(reader, item, where, "fov", &angle);
    if (status != TIDES_OK) return status;
    if (!(angle > 0 && angle < 180)) return td_json_fail(reader, where, "fov", "must be between 0 and 180 degrees");
    view.intrinsics.fx = view.intrinsics.fy = 0.5 * camera->height / td_tan(0.5 * degree * angle);
    return td_path_set_view(reader, sample, &view);
}

tides_status td_path_read_nerfstudio(td_path_reader *reader, const cJSON *root) {
    const cJSON *poses = cJSON_GetObjectItemCaseSensitive(root, "camera_path"), *item;
    const int count = cJSON_GetArraySize(poses);
    tides_intrinsics camera = {0};
    double interval;
    reader->list = "camera_path";
    strcpy(reader->path.format, "camera_path");
    if (!cJSON_IsArray(poses) || count == 0)
        return td_json_fail(reader, "", "camera_path", "must be a list of poses: generate the path in nerfstudio's viewer");
    tides_status status = read_camera(reader, root, &camera);
    if (status == TIDES_OK) status = read_interval(reader, root, count, &interval);
    size_t index = 0;
    if (status == TIDES_OK) cJSON_ArrayForEach(item, poses) {
            char where[48];
            snprintf(where, sizeof where, "camera_path[%zu]", index);
            td_path_sample *sample = td_path_append(reader, index);
            status = sample ? read_pose(reader, item, where, &camera, sample) : TIDES_NO_MEMORY;
            if (status != TIDES_OK) return status;
            sample->time = interval * (double)index++;
        }
    if (status == TIDES_OK && !(interval > 0)) td_path_spread(reader);
    return status;
}
