/* LLFF's poses_bounds.npy (also used by Neu3D): n rows of 17 numbers, a 3x5 matrix by rows and two depths. The matrix's
 * columns are the camera's down, right and back directions in the world, its centre, and (height, width, focal length) [px].
 * There are no times: poses are spread over `duration` in the order of the rows. The principal point is the image's middle. */
#include "camera/td_path_reader.h"

#include "archive/td_npy.h"
#include "td_base.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 17 };

static tides_status read_row(td_path_reader *reader, const td_npy_array *array, size_t row) {
    double v[COLUMNS], rotation[9];
    char where[40];
    snprintf(where, sizeof where, "poses[%zu]", row);
    for (size_t k = 0; k < COLUMNS; k++)
        if (!td_npy_number(array, &array->fields[0], COLUMNS * row + k, v + k) || !isfinite(v[k]))
            return td_json_fail(reader, where, "", "must be finite numbers");
    td_path_sample *sample = td_path_append(reader, row);
    if (!sample) return TIDES_NO_MEMORY;
    for (int i = 0; i < 3; i++) {
        rotation[3 * i] = v[5 * i + 1];
        rotation[3 * i + 1] = v[5 * i];
        rotation[3 * i + 2] = -v[5 * i + 2];
        sample->pose.position[i] = v[5 * i + 3];
    }
    const double height = v[4], width = v[9], focal = v[14];
    if (!(width >= 1 && width <= INT32_MAX && height >= 1 && height <= INT32_MAX && focal > 0))
        return td_json_fail(reader, where, "", "height, width and focal length (columns 5, 10, 15) must be above 0");
    const td_path_view view = {
        .intrinsics = {(int32_t)floor(width), (int32_t)floor(height), focal, focal, 0.5 * width, 0.5 * height, {0}}};
    tides_status status = td_path_set_view(reader, sample, &view);
    return status ? status : td_json_rotation(reader, where, "pose", rotation, sample->pose.quaternion);
}

tides_status td_path_read_llff(td_path_reader *reader) {
    td_npz *npz = NULL;
    const td_npy_array *array = NULL;
    reader->list = "poses";
    strcpy(reader->path.format, "llff");
    tides_status status = td_npz_parse(reader->file, reader->text, reader->bytes, &npz, reader->error);
    if (!status) status = td_npz_get(npz, "data", &array, reader->error);
    if (!status && (array->ndim != 2 || array->shape[1] != COLUMNS || array->fields[0].name[0]))
        status =
            td_fail(reader->error, TIDES_BAD_FILE, "%s: is no poses_bounds.npy: it must have the shape [n, 17]", reader->file);
    for (size_t row = 0; !status && row < array->shape[0]; row++) status = read_row(reader, array, row);
    td_npz_close(npz);
    if (!status) td_path_spread(reader);
    return status;
}
