/* Checks that objects of an HDF5 file of events exist, and reads rows of a column. */
#include "td_event_h5_source.h"

#include <stdio.h>
#include <string.h>

int td_h5_exists(hid_t file, const char *path) {
    char part[128];
    for (size_t length = 1; path[length - 1];) {
        length += strcspn(path + length, "/");
        snprintf(part, sizeof part, "%.*s", (int)length, path);
        if (H5Lexists(file, part, H5P_DEFAULT) <= 0) return 0;
        length++;
    }
    return 1;
}

/* Reads rows [first, first + count) of a column as 64-bit integers or doubles, so that no value is clipped. */
herr_t td_h5_column_rows(const td_h5_column *c, uint64_t first, size_t count, int64_t *out) {
    const hsize_t start[2] = {first, c->column < 0 ? 0 : (hsize_t)c->column}, rows[2] = {count, 1};
    hid_t type = H5Dget_type(c->dataset), memory = H5Screate_simple(1, rows, NULL), file = H5Dget_space(c->dataset);
    int bytes = type >= 0 && H5Tget_class(type) == H5T_ENUM; /* HDF5 can't convert from enumerations */
    herr_t failed = -1;
    if (memory >= 0 && file >= 0 && H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, rows, NULL) >= 0)
        failed = H5Dread(c->dataset,
                         bytes     ? type
                         : c->real ? H5T_NATIVE_DOUBLE
                                   : H5T_NATIVE_INT64,
                         memory, file, H5P_DEFAULT, out);
    if (failed >= 0 && bytes) /* widens bytes to 64 bits in place, the last one first */
        for (size_t i = count; i-- > 0;) out[i] = ((const int8_t *)out)[i];
    td_h5_close(file);
    td_h5_close(memory);
    td_h5_close(type);
    return failed;
}
