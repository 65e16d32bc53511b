/* Shared by the fuzz targets of HDF5 files: datasets and attributes of any name, type, shape and values. HDF5 itself writes the
 * files, so that they are whole: its library (1.10.8) reads freed memory if a file's metadata are damaged.
 *
 * The input is a list of items: name, type, shape (number of extents, bit 7: times 65536), three extents, storage, number of
 * bytes, bytes, which are repeated to fill the item. */
#ifndef TESTS_FUZZ_HDF5_ITEMS_H
#define TESTS_FUZZ_HDF5_ITEMS_H

#include "fuzz.h"

#include <hdf5.h>

static const char *const h5_names[] = {"events/p",
                                       "events/t",
                                       "events/x",
                                       "events/y",
                                       "events/t_ns",
                                       "events/height",
                                       "events/width",
                                       "events/ps",
                                       "events/ts",
                                       "events/xs",
                                       "events/ys",
                                       "p",
                                       "t",
                                       "x",
                                       "y",
                                       "events",
                                       "t_offset",
                                       "ms_to_idx",
                                       "CD/events",
                                       "prophesee/left/p",
                                       "prophesee/left/t",
                                       "prophesee/left/x",
                                       "prophesee/left/y",
                                       "prophesee/left/calib/resolution",
                                       "davis/left/events",
                                       "Y",
                                       "frames",
                                       "images",
                                       "timestamps",
                                       "@width",
                                       "@height",
                                       "@sensor_resolution",
                                       "@format",
                                       "@version",
                                       "@count",
                                       "@stop_ns",
                                       "@geometry",
                                       "rectify_map"};
enum { H5_NAMES = sizeof h5_names / sizeof *h5_names, H5_TYPES = 13, H5_HEAD = 7, H5_ITEMS_MAX = 12, H5_VALUES_MAX = 1 << 16 };
enum { H5_CONTIGUOUS, H5_CHUNKED, H5_DEFLATED, H5_SHUFFLED, H5_CODEC, H5_STORAGES };

/* Prophesee's x u16, y u16, p i16, t i64 (16 bytes). */
static inline hid_t h5_make_record(void) {
    hid_t type = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(type, "x", 0, H5T_STD_U16LE);
    H5Tinsert(type, "y", 2, H5T_STD_U16LE);
    H5Tinsert(type, "p", 4, H5T_STD_I16LE);
    H5Tinsert(type, "t", 8, H5T_STD_I64LE);
    return type;
}

static inline hid_t h5_make_boolean(void) {
    hid_t type = H5Tenum_create(H5T_STD_I8LE);
    for (int8_t v = 0; v < 2; v++) H5Tenum_insert(type, v ? "TRUE" : "FALSE", &v);
    return type;
}

static inline hid_t h5_make_text(size_t bytes) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, bytes);
    return type;
}

/* Closed by the caller. */
static inline hid_t h5_make_type(int kind) {
    const hid_t plain[] = {H5T_STD_U8LE,  H5T_STD_I8LE,  H5T_STD_U16LE, H5T_STD_I16LE,  H5T_STD_U32LE,
                           H5T_STD_I32LE, H5T_STD_U64LE, H5T_STD_I64BE, H5T_IEEE_F32LE, H5T_IEEE_F64LE};
    switch (kind) {
        case 10: return h5_make_boolean();
        case 11: return h5_make_text(12);
        case 12: return h5_make_record();
        default: return H5Tcopy(plain[kind]);
    }
}

/* Values of the item's bytes, over and over. */
static inline uint8_t *h5_fill(size_t bytes, const uint8_t *from, size_t count) {
    uint8_t *values = calloc(bytes ? bytes : 1, 1);
    for (size_t i = 0; values && count && i < bytes; i++) values[i] = from[i % count];
    return values;
}

static inline hid_t h5_make_creation(int storage, int rank, const hsize_t *extents) {
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t chunk[3];
    for (int d = 0; d < rank; d++) chunk[d] = extents[d] < 1 ? 1 : extents[d] < 64 ? extents[d] : 64;
    if (rank && storage != H5_CONTIGUOUS) H5Pset_chunk(creation, rank, chunk);
    if (rank && storage == H5_SHUFFLED) H5Pset_shuffle(creation);
    if (rank && (storage == H5_DEFLATED || storage == H5_SHUFFLED)) H5Pset_deflate(creation, 1);
    if (rank && storage == H5_CODEC) H5Pset_filter(creation, 0x8ECF, H5Z_FLAG_OPTIONAL, 0, NULL);
    return creation;
}

static inline void h5_put_dataset(hid_t file, const char *name, hid_t type, hid_t space, int storage, int rank,
                                  const hsize_t *extents, const uint8_t *from, size_t count) {
    hid_t links = H5Pcreate(H5P_LINK_CREATE), creation = h5_make_creation(storage, rank, extents);
    H5Pset_create_intermediate_group(links, 1);
    hid_t data = H5Dcreate2(file, name, type, space, links, creation, H5P_DEFAULT);
    const hsize_t first[3] = {0, 0, 0};
    hssize_t points = H5Sget_simple_extent_npoints(space);
    if (data >= 0 && storage == H5_CODEC) {
        if (rank && count && points > 0) H5Dwrite_chunk(data, H5P_DEFAULT, 0, first, count, from);
    } else if (data >= 0 && points > 0 && points <= H5_VALUES_MAX) { /* else what is said isn't there */
        uint8_t *values = h5_fill((size_t)points * H5Tget_size(type), from, count);
        if (values) H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        free(values);
    }
    H5Dclose(data);
    H5Pclose(creation);
    H5Pclose(links);
}

static inline void h5_put_attribute(hid_t file, const char *name, hid_t type, hid_t space, const uint8_t *from, size_t count) {
    hssize_t points = H5Sget_simple_extent_npoints(space);
    hid_t attribute = points > 256 ? H5I_INVALID_HID : H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    uint8_t *values = attribute < 0 ? NULL : h5_fill((size_t)points * H5Tget_size(type), from, count);
    if (values) H5Awrite(attribute, type, values);
    free(values);
    if (attribute >= 0) H5Aclose(attribute);
}

static inline void h5_put_item(hid_t file, const uint8_t *item, const uint8_t *from, size_t count) {
    const char *name = h5_names[item[0] % H5_NAMES];
    int rank = item[2] % 4;
    hsize_t extents[3];
    for (int d = 0; d < 3; d++) extents[d] = (hsize_t)item[3 + d] * (item[2] & 128 ? 65536 : 1);
    hid_t type = h5_make_type(item[1] % H5_TYPES), space = rank ? H5Screate_simple(rank, extents, NULL) : H5Screate(H5S_SCALAR);
    if (name[0] == '@')
        h5_put_attribute(file, name + 1, type, space, from, count);
    else
        h5_put_dataset(file, name, type, space, item[6] % H5_STORAGES, rank, extents, from, count);
    H5Sclose(space);
    H5Tclose(type);
}

static inline void h5_make_file(const char *path, const uint8_t *data, size_t size) {
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (file < 0) abort();
    for (int items = 0; size > H5_HEAD && items < H5_ITEMS_MAX; items++) {
        size_t count = data[H5_HEAD] < size - H5_HEAD - 1 ? data[H5_HEAD] : size - H5_HEAD - 1;
        h5_put_item(file, data, data + H5_HEAD + 1, count);
        data += H5_HEAD + 1 + count, size -= H5_HEAD + 1 + count;
    }
    if (H5Fclose(file) < 0) abort();
}

#endif
