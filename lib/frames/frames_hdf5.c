/* Frames in an HDF5 file: a dataset (frames, height, width), read frame by frame, and their times. */
#include "archive/td_h5.h"
#include "archive/td_h5_driver.h"
#include "td_frames.h"

#include <hdf5.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct hdf5_file {
    hid_t file, data;
    double scale; /* factor of integers */
} hdf5_file;

static void close_file(void *state) {
    hdf5_file *f = state;
    if (f->data >= 0) H5Dclose(f->data);
    if (f->file >= 0) H5Fclose(f->file);
    free(f);
}

/* Opens the first of `names` that exists; negative if none does. */
static hid_t open_first(hid_t file, const char *const *names) {
    for (; *names; names++)
        if (H5Lexists(file, *names, H5P_DEFAULT) > 0) return H5Dopen2(file, *names, H5P_DEFAULT);
    return H5I_INVALID_HID;
}

/* Gets rank and extents; -1 if it isn't an array. */
static int shape_of(hid_t data, hsize_t shape[TD_FRAME_DIMS_MAX]) {
    hid_t space = H5Dget_space(data);
    int rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : -1;
    if (rank < 1 || rank > TD_FRAME_DIMS_MAX || H5Sget_simple_extent_dims(space, shape, NULL) != rank) rank = -1;
    if (space >= 0) H5Sclose(space);
    return rank;
}

static tides_status read_slab(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    const hdf5_file *f = frames->state;
    hsize_t start[TD_FRAME_DIMS_MAX] = {0}, count[TD_FRAME_DIMS_MAX], values = td_frames_values(frames);
    hid_t space = H5Dget_space(f->data), memory = H5Screate_simple(1, &values, NULL);
    /* selects one frame; a file of a single frame is read as a whole */
    if (shape_of(f->data, count) > 0 && count[0] == frames->count && frames->count > 1) {
        start[0] = index;
        count[0] = 1;
    }
    int read = space >= 0 && memory >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
               H5Dread(f->data, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, Y) >= 0;
    if (memory >= 0) H5Sclose(memory);
    if (space >= 0) H5Sclose(space);
    return read ? TIDES_OK
                : td_fail(error, TIDES_BAD_FILE, "%s: frame %zu can't be read: damaged, or a filter's plugin is missing",
                          frames->path, index);
}

static tides_status read_frame(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    const hdf5_file *f = frames->state;
    tides_status status;
    H5E_BEGIN_TRY { status = read_slab(frames, index, Y, error); }
    H5E_END_TRY
    if (status != TIDES_OK) return status;
    for (size_t i = 0, values = td_frames_values(frames); i < values; i++) Y[i] = td_frame_light(frames, Y[i], f->scale * Y[i]);
    return TIDES_OK;
}

static tides_status read_times(tides_frames *frames, hid_t data, tides_error *error) {
    hsize_t shape[TD_FRAME_DIMS_MAX] = {0};
    if (shape_of(data, shape) != 1 || shape[0] != frames->count)
        return td_fail(error, TIDES_BAD_FILE, "%s: its times aren't one number for each of %zu frames", frames->path,
                       frames->count);
    if (!(frames->times = td_alloc(frames->count, sizeof *frames->times, error))) return TIDES_NO_MEMORY;
    if (H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, frames->times) < 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: its times can't be read", frames->path);
    frames->stored = 1;
    return TIDES_OK;
}

/* Factor by which integers become 1 at their type's largest value, `most`; 0 if the values aren't numbers. */
static double scale_of(hid_t data, double *most) {
    hid_t type = H5Dget_type(data);
    double scale = 0;
    H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    if (class == H5T_FLOAT) scale = 1;
    if (class == H5T_INTEGER) {
        int bits = (int)(8 * H5Tget_size(type)) - (H5Tget_sign(type) == H5T_SGN_2);
        *most = ldexp(1.0, bits) - 1.0;
        scale = 1.0 / *most;
    }
    if (type >= 0) H5Tclose(type);
    return scale;
}

/* 1 if the stored bytes can hold so many values: deflate packs by at most 1032 (zlib's documentation). */
static int holds(hid_t data, const hsize_t *shape, int rank) {
    double stored = (double)H5Dget_storage_size(data), values = 1;
    for (int i = 0; i < rank; i++) values *= (double)shape[i];
    return values <= 1032.0 * stored;
}

/* The error for a file without frames, which lists the names of its datasets. */
static tides_status refuse_names(const char *path, hid_t file, tides_error *error) {
    char list[256] = "", name[64];
    H5G_info_t info = {.nlinks = 0};
    if (H5Gget_info(file, &info) < 0) info.nlinks = 0;
    for (hsize_t i = 0; i < info.nlinks; i++) {
        const size_t used = strlen(list);
        const ssize_t length = H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
        if (length > 0) snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", name);
    }
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: has no dataset Y, frames, images or voxels, but %s: call the frames so, with their times as t or "
                   "timestamps",
                   path, list[0] ? list : "none");
}

static tides_status open_data(tides_frames *frames, hdf5_file *f, tides_error *error) {
    hsize_t shape[TD_FRAME_DIMS_MAX] = {0};
    size_t dims[TD_FRAME_DIMS_MAX];
    f->file = td_h5_open_disk(frames->path);
    if (f->file < 0) return td_fail(error, TIDES_BAD_FILE, "%s: isn't an HDF5 file, or is damaged", frames->path);
    f->data = open_first(f->file, td_frame_arrays);
    if (f->data < 0) return refuse_names(frames->path, f->file, error);
    f->scale = scale_of(f->data, &frames->most);
    const int rank = shape_of(f->data, shape);
    if (rank < 0 || !(f->scale > 0))
        return td_fail(error, TIDES_BAD_FILE, "%s: its frames aren't an array of numbers", frames->path);
    if (frames->options.planes > 1) f->scale = 1; /* integers in voxels are counts */
    tides_status status = td_h5_check_filters(frames->path, "the dataset of frames", f->data, error);
    if (status != TIDES_OK) return status;
    if (!holds(f->data, shape, rank))
        return td_fail(error, TIDES_BAD_FILE, "%s: claims %llu frames of %llu x %llu px, more than its bytes can hold",
                       frames->path, (unsigned long long)shape[0], (unsigned long long)shape[rank - 1],
                       (unsigned long long)shape[rank > 1 ? rank - 2 : 0]);
    for (int i = 0; i < rank; i++) dims[i] = (size_t)shape[i];
    status = td_frames_take_dims(frames, frames->path, dims, rank, error);
    hid_t times = status == TIDES_OK ? open_first(f->file, td_frame_time_arrays) : H5I_INVALID_HID;
    if (times >= 0) {
        status = read_times(frames, times, error);
        H5Dclose(times);
    }
    return status;
}

tides_status td_frames_hdf5(tides_frames *frames, tides_error *error) {
    static const td_frame_source source = {read_frame, close_file};
    hdf5_file *f = td_alloc(1, sizeof *f, error);
    if (!f) return TIDES_NO_MEMORY;
    *f = (hdf5_file){H5I_INVALID_HID, H5I_INVALID_HID, 0};
    frames->source = &source;
    frames->state = f;
    tides_status status;
    H5E_BEGIN_TRY { status = open_data(frames, f, error); }
    H5E_END_TRY
    return status;
}
