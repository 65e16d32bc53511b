/* Maps of a sensor's pixels: read from numpy's files and HDF5, and written as HDF5. */
#include "td_maps.h"

#include "archive/td_h5.h"
#include "archive/td_h5_driver.h"
#include "archive/td_npy.h"
#include "td_folder.h"
#include "td_hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const td_map_names[TD_MAPS] = {"threshold_on", "threshold_off", "leak", "noise", "hot", "dead", "noise_size"};

static const double most_hz = 1e6, most_threshold = 100;

void td_maps_release(td_maps *maps) {
    for (int m = 0; m < TD_MAPS; m++) free(maps->map[m]);
    memset(maps, 0, sizeof *maps);
}

static tides_status bad_shape(const char *path, int m, int32_t width, int32_t height, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: %s isn't an array of %d x %d numbers, the image's rows and columns", path,
                   td_map_names[m], (int)height, (int)width);
}

/* -- numpy ----------------------------------------------------------------------------------------------------------------- */

static tides_status take_array(const char *path, const td_npy_array *array, const td_npy_field *field, int m, int32_t width,
                               int32_t height, td_maps *maps, tides_error *error) {
    const size_t count = (size_t)width * (size_t)height;
    if (array->ndim != 2 || array->shape[0] != (size_t)height || array->shape[1] != (size_t)width)
        return bad_shape(path, m, width, height, error);
    maps->map[m] = td_alloc(count, sizeof **maps->map, error);
    if (!maps->map[m]) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++)
        if (!td_npy_number(array, field, i, &maps->map[m][i])) return bad_shape(path, m, width, height, error);
    return TIDES_OK;
}

static int has_array(const td_npz *npz, const char *name) {
    for (size_t i = 0; i < td_npz_count(npz); i++)
        if (strcmp(td_npz_name(npz, i), name) == 0) return 1;
    return 0;
}

static tides_status read_numpy(const char *path, int32_t width, int32_t height, td_maps *maps, tides_error *error) {
    td_npz *npz = NULL;
    const td_npy_array *array = NULL;
    const int whole = td_ends_in(path, ".npy");
    tides_status status = td_npz_open(path, &npz, error);
    if (status == TIDES_OK && whole) status = td_npz_get(npz, "data", &array, error);
    for (int m = 0; m < TD_MAPS && status == TIDES_OK; m++) {
        if (!whole && !has_array(npz, td_map_names[m])) continue;
        if (!whole) status = td_npz_get(npz, td_map_names[m], &array, error);
        const td_npy_field *field = status == TIDES_OK ? td_npy_find_field(array, whole ? td_map_names[m] : NULL) : NULL;
        if (status == TIDES_OK && (field || !whole)) status = take_array(path, array, field, m, width, height, maps, error);
    }
    td_npz_close(npz);
    return status;
}

/* -- HDF5 ------------------------------------------------------------------------------------------------------------------ */

static tides_status take_dataset(const char *path, hid_t file, int m, int32_t width, int32_t height, td_maps *maps,
                                 tides_error *error) {
    const hid_t data = H5Dopen2(file, td_map_names[m], H5P_DEFAULT), space = data < 0 ? -1 : H5Dget_space(data);
    hsize_t shape[2] = {0, 0};
    const int fits = space >= 0 && H5Sget_simple_extent_ndims(space) == 2 &&
                     H5Sget_simple_extent_dims(space, shape, NULL) == 2 && shape[0] == (hsize_t)height &&
                     shape[1] == (hsize_t)width;
    tides_status status =
        fits ? td_h5_check_filters(path, td_map_names[m], data, error) : bad_shape(path, m, width, height, error);
    if (status == TIDES_OK) {
        maps->map[m] = td_alloc((size_t)width * (size_t)height, sizeof **maps->map, error);
        status = maps->map[m] ? TIDES_OK : TIDES_NO_MEMORY;
    }
    if (status == TIDES_OK && H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, maps->map[m]) < 0)
        status = bad_shape(path, m, width, height, error);
    td_h5_close(space);
    td_h5_close(data);
    return status;
}

static tides_status read_h5(const char *path, int32_t width, int32_t height, td_maps *maps, tides_error *error) {
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    const hid_t file = td_h5_open_disk(path);
    tides_status status = TIDES_OK;
    if (file < 0) status = td_fail(error, TIDES_BAD_FILE, "%s: isn't an HDF5 file, or isn't there", path);
    for (int m = 0; m < TD_MAPS && status == TIDES_OK; m++)
        if (H5Lexists(file, td_map_names[m], H5P_DEFAULT) > 0) status = take_dataset(path, file, m, width, height, maps, error);
    if (file >= 0) H5Fclose(file);
    td_h5_quiet_end(&quiet);
    return status;
}

/* -- both ------------------------------------------------------------------------------------------------------------------ */

static int in_range(int m, double value) {
    if (m == TD_MAP_DEAD) return value == 0 || value == 1;
    if (m == TD_MAP_ON || m == TD_MAP_OFF) return value > 0 && value <= most_threshold;
    return value >= 0 && value <= most_hz;
}

static tides_status check(const char *path, int32_t width, size_t count, const td_maps *maps, tides_error *error) {
    int some = 0;
    for (int m = 0; m < TD_MAPS; m++) {
        some |= maps->map[m] != NULL;
        for (size_t i = 0; maps->map[m] && i < count; i++)
            if (!isnan(maps->map[m][i]) && !in_range(m, maps->map[m][i]))
                return td_fail(error, TIDES_BAD_FILE,
                               "%s: %s at x %zu, y %zu is %g; it must be %s, or NaN where it isn't known", path,
                               td_map_names[m], i % (size_t)width, i / (size_t)width, maps->map[m][i],
                               m == TD_MAP_DEAD                    ? "0 or 1"
                               : m == TD_MAP_ON || m == TD_MAP_OFF ? "above 0 and at most 100"
                                                                   : "in [0, 1e6]");
    }
    if (some) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: has none of threshold_on, threshold_off, leak, noise, hot, dead, noise_size",
                   path);
}

tides_status td_maps_read(const char *path, int32_t width, int32_t height, td_maps *maps, tides_error *error) {
    memset(maps, 0, sizeof *maps);
    const size_t count = (size_t)width * (size_t)height;
    const int numpy = td_ends_in(path, ".npy") || td_ends_in(path, ".npz");
    tides_status status = (numpy ? read_numpy : read_h5)(path, width, height, maps, error);
    if (status == TIDES_OK) status = check(path, width, count, maps, error);
    maps->checksum = 1;
    for (int m = 0; m < TD_MAPS && status == TIDES_OK; m++)
        if (maps->map[m]) maps->checksum = td_hash_words(maps->checksum + (uint64_t)m, maps->map[m], count * sizeof(double));
    if (status != TIDES_OK) td_maps_release(maps);
    return status;
}

/* -- writing --------------------------------------------------------------------------------------------------------------- */

static herr_t put(hid_t file, const char *name, const hsize_t shape[2], const double *values) {
    const hid_t space = H5Screate_simple(2, shape, NULL), made = H5Pcreate(H5P_DATASET_CREATE);
    hid_t data = -1;
    if (space >= 0 && made >= 0 && H5Pset_obj_track_times(made, 0) >= 0)
        data = H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, made, H5P_DEFAULT);
    const herr_t done = data < 0 ? -1 : H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    td_h5_close(data);
    td_h5_close(made);
    td_h5_close(space);
    return done;
}

/* The maps to be written, and their shape. */
typedef struct all_maps {
    hsize_t shape[2];
    const td_maps *maps;
} all_maps;

static herr_t put_all(hid_t file, const void *user) {
    const all_maps *all = user;
    herr_t done = td_h5_write_text(file, "format", "tides-maps");
    for (int m = 0; m < TD_MAPS && done >= 0; m++)
        if (all->maps->map[m]) done = put(file, td_map_names[m], all->shape, all->maps->map[m]);
    return done;
}

tides_status td_maps_write(const char *path, int32_t width, int32_t height, const td_maps *maps, tides_error *error) {
    const all_maps all = {{(hsize_t)height, (hsize_t)width}, maps};
    return td_h5_save(path, put_all, &all, error);
}
