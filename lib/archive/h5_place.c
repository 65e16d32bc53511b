/* Reads and writes groups, attributes and datasets of HDF5 files; each error names the file and the place in it. */
#include "td_h5_place.h"

#include "td_base.h"
#include "td_h5.h"

#include <stdlib.h>
#include <string.h>

/* Deflate, the strongest filter in common use, packs by at most this factor (zlib's documentation). A header that claims more
 * than the file's size times this is damaged. */
enum { DEFLATE_MAX = 1032 };

static tides_status enter(const td_place *parent, const char *name, hid_t id, td_place *place) {
    *place = *parent;
    place->id = id;
    const char *slash = strcmp(parent->where, "/") == 0 ? "" : "/";
    snprintf(place->where, sizeof place->where, "%.40s%s%.20s", parent->where, slash, name);
    return TIDES_OK;
}

tides_status td_place_open(const td_place *parent, const char *name, td_place *place) {
    hid_t id = H5Gopen2(parent->id, name, H5P_DEFAULT);
    if (id >= 0) return enter(parent, name, id, place);
    return td_fail(parent->error, TIDES_BAD_FILE, "%s: group %s is missing in %s, or damaged", parent->file, name,
                   parent->where);
}

static tides_status fail_write(const td_place *place, const char *name) {
    return td_fail(place->error, TIDES_NO_MEMORY, "%s: %s in %s can't be added to the file's image: out of memory?",
                   place->file, name, place->where);
}

tides_status td_place_create(const td_place *parent, const char *name, td_place *place) {
    hid_t id = H5Gcreate2(parent->id, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    return id >= 0 ? enter(parent, name, id, place) : fail_write(parent, name);
}

int td_place_has(const td_place *place, const char *name) { return H5Lexists(place->id, name, H5P_DEFAULT) > 0; }

/* -- attributes -- */

static tides_status fail_attribute(const td_place *place, const char *name, const char *expected) {
    return td_fail(place->error, TIDES_BAD_FILE, "%s: attribute %s of %s is missing or isn't %s", place->file, name,
                   place->where, expected);
}

/* Opens an attribute that holds exactly one value; negative if there is none. */
static hid_t open_attribute(const td_place *place, const char *name) {
    hid_t attribute = H5Aexists(place->id, name) > 0 ? H5Aopen(place->id, name, H5P_DEFAULT) : H5I_INVALID_HID;
    if (attribute < 0) return H5I_INVALID_HID;
    hid_t space = H5Aget_space(attribute);
    hssize_t points = space >= 0 ? H5Sget_simple_extent_npoints(space) : -1;
    if (space >= 0) H5Sclose(space);
    if (points == 1) return attribute;
    H5Aclose(attribute);
    return H5I_INVALID_HID;
}

/* 1 if the attribute holds an integer or, with `real`, any number. */
static int is_number(hid_t attribute, int real) {
    hid_t type = H5Aget_type(attribute);
    H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
    if (type >= 0) H5Tclose(type);
    return class == H5T_INTEGER || (real && class == H5T_FLOAT);
}

static tides_status read_number(const td_place *place, const char *name, hid_t memory_type, int real, void *value) {
    hid_t attribute = open_attribute(place, name);
    int done = attribute >= 0 && is_number(attribute, real) && H5Aread(attribute, memory_type, value) >= 0;
    if (attribute >= 0) H5Aclose(attribute);
    return done ? TIDES_OK : fail_attribute(place, name, real ? "a number" : "a whole number");
}

tides_status td_place_read_int(const td_place *place, const char *name, int32_t *value) {
    return read_number(place, name, H5T_NATIVE_INT32, 0, value);
}

tides_status td_place_read_double(const td_place *place, const char *name, double *value) {
    return read_number(place, name, H5T_NATIVE_DOUBLE, 1, value);
}

tides_status td_place_read_text(const td_place *place, const char *name, char **text) {
    char *found = td_h5_text(place->id, name);
    if (!found) return fail_attribute(place, name, "a text");
    *text = found;
    return TIDES_OK;
}

static tides_status write_number(const td_place *place, const char *name, hid_t file_type, hid_t memory_type,
                                 const void *value) {
    return td_h5_write_number(place->id, name, file_type, memory_type, value) >= 0 ? TIDES_OK : fail_write(place, name);
}

tides_status td_place_write_int(const td_place *place, const char *name, int32_t value) {
    return write_number(place, name, H5T_STD_I32LE, H5T_NATIVE_INT32, &value);
}

tides_status td_place_write_double(const td_place *place, const char *name, double value) {
    return write_number(place, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

tides_status td_place_write_text(const td_place *place, const char *name, const char *text) {
    return td_h5_write_text(place->id, name, text) >= 0 ? TIDES_OK : fail_write(place, name);
}

/* -- datasets -- */

/* Opens a dataset of floating-point numbers; negative if there is none. */
static hid_t open_floats(const td_place *place, const char *name) {
    hid_t set = td_place_has(place, name) ? H5Dopen2(place->id, name, H5P_DEFAULT) : H5I_INVALID_HID;
    if (set < 0) return H5I_INVALID_HID;
    hid_t type = H5Dget_type(set);
    int floats = type >= 0 && H5Tget_class(type) == H5T_FLOAT;
    if (type >= 0) H5Tclose(type);
    if (floats) return set;
    H5Dclose(set);
    return H5I_INVALID_HID;
}

/* 1 if a shape (unused extents are 1) claims no more values than the dataset's stored bytes, and the file, can hold. */
static int is_plausible(const td_place *place, hid_t set, const uint64_t shape[TD_PLACE_RANK_MAX]) {
    hsize_t file_bytes = 0, stored = H5Dget_storage_size(set);
    hid_t file = H5Iget_file_id(place->id);
    int known = file >= 0 && H5Fget_filesize(file, &file_bytes) >= 0;
    if (file >= 0) H5Fclose(file);
    if (!known || stored > file_bytes) return 0;
    uint64_t room = (uint64_t)stored * DEFLATE_MAX;
    for (int i = 0; i < TD_PLACE_RANK_MAX; i++) {
        if (shape[i] == 0) return 1;
        room /= shape[i]; /* dividing step by step and rounding down gives the same as one division */
    }
    return room >= 1;
}

tides_status td_place_shape(const td_place *place, const char *name, int rank, uint64_t shape[TD_PLACE_RANK_MAX]) {
    hsize_t found[TD_PLACE_RANK_MAX] = {0};
    uint64_t result[TD_PLACE_RANK_MAX] = {1, 1, 1, 1};
    hid_t set = open_floats(place, name);
    if (set < 0)
        return td_fail(place->error, TIDES_BAD_FILE, "%s: dataset %s of %s is missing or doesn't hold floating-point numbers",
                       place->file, name, place->where);
    tides_status status = td_h5_check_filters(place->file, name, set, place->error);
    hid_t space = status ? H5I_INVALID_HID : H5Dget_space(set);
    if (!status &&
        (space < 0 || H5Sget_simple_extent_ndims(space) != rank || H5Sget_simple_extent_dims(space, found, NULL) != rank))
        status = td_fail(place->error, TIDES_BAD_FILE, "%s: dataset %s of %s should have %d dimensions", place->file, name,
                         place->where, rank);
    for (int i = 0; i < rank && i < TD_PLACE_RANK_MAX && !status; i++) result[i] = found[i];
    if (!status && !is_plausible(place, set, result))
        status = td_fail(place->error, TIDES_BAD_FILE,
                         "%s: dataset %s of %s claims %llu rows, more than the file holds: is it truncated?", place->file, name,
                         place->where, (unsigned long long)result[0]);
    if (space >= 0) H5Sclose(space);
    H5Dclose(set);
    if (!status) memcpy(shape, result, (size_t)rank * sizeof *shape);
    return status;
}

int td_place_is_wide(const td_place *place, const char *name) {
    hid_t set = open_floats(place, name), type = set >= 0 ? H5Dget_type(set) : H5I_INVALID_HID;
    int wide = type >= 0 && H5Tget_size(type) > sizeof(float);
    if (type >= 0) H5Tclose(type);
    if (set >= 0) H5Dclose(set);
    return wide;
}

tides_status td_place_read(const td_place *place, const char *name, hid_t memory_type, void *values) {
    hid_t set = open_floats(place, name);
    int done = set >= 0 && H5Dread(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
    if (set >= 0) H5Dclose(set);
    if (done) return TIDES_OK;
    return td_fail(place->error, TIDES_BAD_FILE, "%s: dataset %s of %s can't be read: is the file truncated or damaged?",
                   place->file, name, place->where);
}

tides_status td_place_write(const td_place *place, const char *name, hid_t file_type, hid_t memory_type, int rank,
                            const uint64_t *shape, const void *values) {
    hsize_t extent[TD_PLACE_RANK_MAX] = {0};
    for (int i = 0; i < rank && i < TD_PLACE_RANK_MAX; i++) extent[i] = shape[i];
    hid_t space = H5Screate_simple(rank, extent, NULL), set = H5I_INVALID_HID;
    hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    /* Without the times of creation, the same scene makes the same bytes. */
    if (space >= 0 && properties >= 0 && H5Pset_obj_track_times(properties, 0) >= 0)
        set = H5Dcreate2(place->id, name, file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    int done = set >= 0 && H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
    if (set >= 0 && H5Dclose(set) < 0) done = 0;
    if (properties >= 0) H5Pclose(properties);
    if (space >= 0) H5Sclose(space);
    return done ? TIDES_OK : fail_write(place, name);
}
