/* Frames in an .npy or .npz: an array (frames, height, width), or voxels (frames, planes, height, width), and their times. */
#include "td_frames.h"

#include "archive/td_npy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct array_file {
    td_npz *npz;
    const td_npy_array *array;
    double scale; /* factor of integers */
} array_file;

static void close_file(void *state) {
    array_file *f = state;
    td_npz_close(f->npz);
    free(f);
}

static const char *find_name(const td_npz *npz, const char *const *names) {
    for (; *names; names++)
        for (size_t i = 0; i < td_npz_count(npz); i++)
            if (strcmp(td_npz_name(npz, i), *names) == 0) return td_npz_name(npz, i);
    return NULL;
}

static tides_status read_frame(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    const array_file *f = frames->state;
    const td_npy_field *field = td_npy_find_field(f->array, "");
    size_t values = td_frames_values(frames);
    for (size_t i = 0; i < values; i++) {
        double value = 0;
        if (!td_npy_number(f->array, field, index * values + i, &value))
            return td_fail(error, TIDES_BAD_FILE, "%s: frames of %s aren't numbers", frames->path, f->array->dtype);
        Y[i] = td_frame_light(frames, value, f->scale * value);
    }
    return TIDES_OK;
}

/* Reads the times, if the file has them. */
static tides_status read_times(tides_frames *frames, td_npz *npz, tides_error *error) {
    const char *name = find_name(npz, td_frame_time_arrays);
    const td_npy_array *array = NULL;
    if (!name) return TIDES_OK;
    tides_status status = td_npz_get(npz, name, &array, error);
    if (status != TIDES_OK) return status;
    if (array->ndim != 1 || array->count != frames->count)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s has %zu values, but there are %zu frames", frames->path, name,
                       array->count, frames->count);
    double *times = td_alloc(frames->count, sizeof *times, error);
    if (!times) return TIDES_NO_MEMORY;
    frames->times = times;
    frames->stored = 1;
    for (size_t k = 0; k < frames->count; k++) {
        if (!td_npy_number(array, td_npy_find_field(array, ""), k, &times[k]))
            return td_fail(error, TIDES_BAD_FILE, "%s: %s holds %s, not times", frames->path, name, array->dtype);
    }
    return TIDES_OK;
}

/* Factor by which integers become 1 at their type's largest value, `most`; booleans become 0 or 1. */
static double scale_of(const td_npy_array *array, double *most) {
    const td_npy_field *field = td_npy_find_field(array, "");
    if (field && field->kind == 'b') *most = 1;
    if (!field || !strchr("iu", field->kind)) return 1.0;
    *most = ldexp(1.0, (int)(8 * field->bytes) - (field->kind == 'i')) - 1.0;
    return 1.0 / *most;
}

tides_status td_frames_npy(tides_frames *frames, tides_error *error) {
    static const td_frame_source source = {read_frame, close_file};
    array_file *f = td_alloc(1, sizeof *f, error);
    if (!f) return TIDES_NO_MEMORY;
    frames->source = &source;
    frames->state = f;
    tides_status status = td_npz_open(frames->path, &f->npz, error);
    if (status != TIDES_OK) return status;
    const char *name = td_npz_count(f->npz) == 1 ? td_npz_name(f->npz, 0) : find_name(f->npz, td_frame_arrays);
    if (!name)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: has no array Y, frames, images or voxels among its %zu, such as %.60s: call the frames so, with "
                       "their times as t or timestamps",
                       frames->path, td_npz_count(f->npz), td_npz_name(f->npz, 0));
    status = td_npz_get(f->npz, name, &f->array, error);
    if (status == TIDES_OK) status = td_frames_take_dims(frames, frames->path, f->array->shape, f->array->ndim, error);
    if (status != TIDES_OK) return status;
    f->scale = frames->options.planes > 1 ? 1 : scale_of(f->array, &frames->most); /* integers in voxels are counts */
    return read_times(frames, f->npz, error);
}
