/* Reads ground truth from the files of data sets as named planes. Files that TIDES has written give the same values, except
 * for rounding to integers. */
#include "archive/td_npy.h"
#include "image/td_exr.h"
#include "td_folder.h"
#include "td_frames.h"
#include "tides/truth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const displacement[] = {"displacement_u", "displacement_v"};

/* Makes planes filled with NaN. */
static tides_status make_planes(int32_t width, int32_t height, const char *const *names, int32_t count, tides_exr **planes,
                                tides_error *error) {
    const size_t pixels = (size_t)width * (size_t)height;
    tides_exr *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->width = width, made->height = height;
    made->names = td_alloc((size_t)count, sizeof *made->names, error);
    made->pixels = td_alloc(pixels * (size_t)count, sizeof *made->pixels, error);
    int ok = made->names && made->pixels;
    for (int32_t c = 0; c < count && ok; c++, made->count++) ok = (made->names[c] = td_strdup(names[c], error)) != NULL;
    if (!ok) {
        tides_exr_destroy(made);
        return TIDES_NO_MEMORY;
    }
    for (size_t i = 0; i < pixels * (size_t)count; i++) made->pixels[i] = NAN;
    *planes = made;
    return TIDES_OK;
}

/* -- pictures -------------------------------------------------------------------------------------------------------------- */

/* A value as it is stored, a whole number. */
static float stored(const td_picture_values *p, size_t i) {
    return (float)rint((double)p->values[i] * (p->bits == 16 ? 65535.0 : 255.0));
}

static tides_status take_dsec_flow(const td_picture_values *p, tides_exr **planes, tides_error *error) {
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    tides_status status = make_planes(p->width, p->height, displacement, 2, planes, error);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++)
        for (size_t c = 0; c < 2 && stored(p, 3 * i + 2) > 0; c++)
            (*planes)->pixels[c * pixels + i] = (stored(p, 3 * i + c) - 32768) / 128;
    return status;
}

/* Takes the stored numbers divided by `scale` as a plane; with a scale, 0 means no value. */
static tides_status take_plane(const td_picture_values *p, const char *name, float scale, tides_exr **planes,
                               tides_error *error) {
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    tides_status status = make_planes(p->width, p->height, &name, 1, planes, error);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++) {
        const float value = stored(p, i);
        if (value > 0 || scale == 1) (*planes)->pixels[i] = value / scale;
    }
    return status;
}

static tides_status read_png(const char *path, tides_exr **planes, tides_error *error) {
    td_picture_values p = {.values = NULL};
    tides_status status = td_frame_png(path, &p, error);
    if (status != TIDES_OK) return status;
    if (p.bits == 16 && p.channels == 3)
        status = take_dsec_flow(&p, planes, error);
    else if (p.bits == 16)
        status = strstr(path, "disparity/") ? take_plane(&p, "disparity", 256, planes, error)
                                            : take_plane(&p, "depth", 5000, planes, error);
    else if (p.channels == 1)
        status = take_plane(&p, "instance", 1, planes, error);
    else
        status = td_fail(error, TIDES_UNSUPPORTED,
                         "%s: a picture in colour of 8 bits isn't ground truth: that is of 16 bits, or grey", path);
    free(p.values);
    return status;
}

/* -- arrays ---------------------------------------------------------------------------------------------------------------- */

static tides_status check_shape(const char *path, const td_npy_array *a, tides_error *error) {
    const int image = a->ndim == 2 || (a->ndim == 3 && (a->shape[2] == 2 || a->shape[2] == 3));
    if (image && a->field_count == 1 && strchr("fiub", a->fields[0].kind) && a->shape[0] && a->shape[1] &&
        a->shape[0] <= TD_FRAME_SIDE_MAX && a->shape[1] <= TD_FRAME_SIDE_MAX)
        return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED,
                   "%s: ground truth is an array of numbers (height, width) or (height, width, 2 or 3), each up to %d px", path,
                   TD_FRAME_SIDE_MAX);
}

static double number_of(const td_npy_array *a, size_t i) {
    double value = NAN;
    td_npy_number(a, &a->fields[0], i, &value);
    return value;
}

static tides_status take_array(const char *path, const td_npy_array *a, tides_exr **planes, tides_error *error) {
    tides_status status = check_shape(path, a, error);
    if (status != TIDES_OK) return status;
    const size_t each = a->ndim == 3 ? a->shape[2] : 1, pixels = a->shape[0] * a->shape[1];
    const char *one = a->fields[0].kind == 'f' ? "depth" : "instance", *const *names = each > 1 ? displacement : &one;
    const size_t count = each > 1 ? 2 : 1;
    status = make_planes((int32_t)a->shape[1], (int32_t)a->shape[0], names, (int32_t)count, planes, error);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++)
        for (size_t c = 0; c < count; c++)
            if (each < 3 || number_of(a, each * i + 2) > 0)
                (*planes)->pixels[c * pixels + i] = (float)number_of(a, each * i + c);
    return status;
}

static tides_status read_npy(const char *path, tides_exr **planes, tides_error *error) {
    td_npz *npz = NULL;
    const td_npy_array *array = NULL;
    tides_status status = td_npz_open(path, &npz, error);
    if (status == TIDES_OK) status = td_npz_get(npz, "data", &array, error);
    if (status == TIDES_OK) status = take_array(path, array, planes, error);
    td_npz_close(npz);
    return status;
}

tides_status tides_truth_read(const char *path, tides_exr **planes, tides_error *error) {
    if (!path || !planes) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_truth_read: path or planes is NULL");
    if (td_ends_in(path, ".exr")) return tides_exr_read(path, planes, error);
    if (td_ends_in(path, ".png")) return read_png(path, planes, error);
    if (td_ends_in(path, ".npy")) return read_npy(path, planes, error);
    return td_fail(error, TIDES_UNSUPPORTED, "%s: ground truth is read from .exr, .png and .npy", path);
}
