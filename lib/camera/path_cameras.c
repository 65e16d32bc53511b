/* INRIA's cameras.json: a list of {id, img_name, width, height, position, rotation, fx, fy}. `position` is the camera's
 * centre; `rotation` is its camera-to-world matrix by rows, in OpenCV axes. The file has no times: poses are spread evenly
 * over the option `duration`, in the order of img_name. The file's own order isn't that of the recording: INRIA's training with
 * its flag --eval lists the test views first. The file has no principal point: INRIA's renderer takes the image's middle.
 * Unknown keys are ignored. */
#include "camera/td_path_reader.h"

#include "td_base.h"

#include <stdio.h>
#include <string.h>

static tides_status read_intrinsics(td_path_reader *reader, const cJSON *item, const char *where, tides_intrinsics *out) {
    const struct {
        const char *key;
        double *value;
    } focal[] = {{"fx", &out->fx}, {"fy", &out->fy}};
    tides_status status = td_json_pixels(reader, item, where, "width", &out->width);
    if (status == TIDES_OK) status = td_json_pixels(reader, item, where, "height", &out->height);
    for (int k = 0; k < 2 && status == TIDES_OK; k++) {
        status = td_json_number(reader, item, where, focal[k].key, focal[k].value);
        if (status == TIDES_OK && !(*focal[k].value > 0.0)) return td_json_fail(reader, where, focal[k].key, "must be above 0");
    }
    out->cx = 0.5 * out->width;
    out->cy = 0.5 * out->height;
    return status;
}

tides_status td_path_read_cameras(td_path_reader *reader, const cJSON *root) {
    const cJSON *item;
    size_t index = 0;
    reader->list = "";
    strcpy(reader->path.format, "cameras");
    cJSON_ArrayForEach(item, root) {
        char where[48];
        double rotation[9];
        td_path_view view = {.distorted = 0};
        snprintf(where, sizeof where, "[%zu]", index);
        td_path_sample *sample = td_path_append(reader, index++);
        if (!sample) return TIDES_NO_MEMORY;
        td_path_set_name(sample, item, "img_name");
        tides_status status = td_json_vector(reader, item, where, "position", sample->pose.position, 3);
        if (status == TIDES_OK) status = td_json_matrix(reader, item, where, "rotation", rotation, 3, 3);
        if (status == TIDES_OK) status = td_json_rotation(reader, where, "rotation", rotation, sample->pose.quaternion);
        if (status == TIDES_OK) status = read_intrinsics(reader, item, where, &view.intrinsics);
        if (status == TIDES_OK) status = td_path_set_view(reader, sample, &view);
        if (status != TIDES_OK) return status;
    }
    td_path_order(reader, 1);
    return TIDES_OK;
}
