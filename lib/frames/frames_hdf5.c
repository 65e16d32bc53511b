/* Frames in HDF5: a dataset (frames, height, width), read frame by frame, and its times. */
#include "td_frames.h"

#include <hdf5.h>

#include <math.h>
#include <stdlib.h>

typedef struct hdf5_file {
    hid_t file, data;
    double scale; /* of integers */
} hdf5_file;

static void close_file(void *state) {
    hdf5_file *f = state;
    if (f->data >= 0) H5Dclose(f->data);
    if (f->file >= 0) H5Fclose(f->file);
    free(f);
}

/* The first of `names` that is there; negative where none is. */
static hid_t open_first(hid_t file, const char *const *names) {
    for (; *names; names++)
        if (H5Lexists(file, *names, H5P_DEFAULT) > 0) return H5Dopen2(file, *names, H5P_DEFAULT);
    return H5I_INVALID_HID;
}

/* Rank and extents of at most three dimensions; -1 where it is something else. */
static int shape_of(hid_t data, hsize_t shape[3]) {
    hid_t space = H5Dget_space(data);
    int rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : -1;
    if (rank < 1 || rank > 3 || H5Sget_simple_extent_dims(space, shape, NULL) != rank) rank = -1;
    if (space >= 0) H5Sclose(space);
    return rank;
}

static tides_status read_slab(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    const hdf5_file *f = frames->state;
    hsize_t start[3] = {index, 0, 0}, count[3] = {1, (hsize_t)frames->height, (hsize_t)frames->width};
    hid_t space = H5Dget_space(f->data), memory = H5Screate_simple(3, count, NULL);
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
    size_t pixels = (size_t)frames->width * (size_t)frames->height;
    for (size_t i = 0; i < pixels; i++) Y[i] = td_frame_decode(&frames->options, f->scale * Y[i]);
    return TIDES_OK;
}

static tides_status read_times(tides_frames *frames, hid_t data, tides_error *error) {
    hsize_t shape[3] = {0};
    if (shape_of(data, shape) != 1 || shape[0] != frames->count)
        return td_fail(error, TIDES_BAD_FILE, "%s: its times aren't one number for each of %zu frames", frames->path,
                       frames->count);
    double unit = td_frame_unit(&frames->options, "");
    if (!(frames->times = td_alloc(frames->count, sizeof *frames->times, error))) return TIDES_NO_MEMORY;
    if (H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, frames->times) < 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: its times can't be read", frames->path);
    for (size_t k = 0; unit < 1 && k < frames->count; k++) frames->times[k] /= round(1 / unit);
    return TIDES_OK;
}

/* Integers count to 1 at their type's largest value; 0 where the values are no numbers. */
static double scale_of(hid_t data) {
    hid_t type = H5Dget_type(data);
    double scale = 0;
    H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    if (class == H5T_FLOAT) scale = 1;
    if (class == H5T_INTEGER) {
        int bits = (int)(8 * H5Tget_size(type)) - (H5Tget_sign(type) == H5T_SGN_2);
        scale = 1.0 / (ldexp(1.0, bits) - 1.0);
    }
    if (type >= 0) H5Tclose(type);
    return scale;
}

/* Whether what is stored can be this many values; deflate shrinks by at most 1032 (zlib's documentation). */
static int holds(hid_t data, const hsize_t shape[3]) {
    double stored = (double)H5Dget_storage_size(data);
    return (double)shape[0] * (double)shape[1] * (double)shape[2] <= 1032.0 * stored;
}

static tides_status open_data(tides_frames *frames, hdf5_file *f, tides_error *error) {
    hsize_t shape[3] = {0};
    f->file = H5Fopen(frames->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (f->file < 0) return td_fail(error, TIDES_BAD_FILE, "%s: isn't an HDF5 file, or is damaged", frames->path);
    f->data = open_first(f->file, td_frame_arrays);
    if (f->data < 0) return td_fail(error, TIDES_BAD_FILE, "%s: has no dataset Y, frames or images", frames->path);
    f->scale = scale_of(f->data);
    if (shape_of(f->data, shape) != 3 || !(f->scale > 0))
        return td_fail(error, TIDES_BAD_FILE, "%s: its frames aren't numbers of the shape (frames, height, width)",
                       frames->path);
    if (!holds(f->data, shape))
        return td_fail(error, TIDES_BAD_FILE, "%s: claims %llu frames of %llu x %llu px, more than its bytes can hold",
                       frames->path, (unsigned long long)shape[0], (unsigned long long)shape[2], (unsigned long long)shape[1]);
    tides_status status =
        td_frames_take_shape(frames, frames->path, (size_t)shape[0], (size_t)shape[1], (size_t)shape[2], error);
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
