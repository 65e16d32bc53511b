/* Internal: arrays in HDF5 files, in groups, whose first extent grows. The files are in a dataset's unfinished folder. */
#ifndef TD_ARRAYS_H
#define TD_ARRAYS_H

#include "tides/base.h"

#include <hdf5.h>

typedef struct td_arrays {
    hid_t file; /* 0: not open */
    char *path;
    int failed; /* errno of the first failed write, which the file driver hides from HDF5 */
} td_arrays;

typedef struct td_array {
    hid_t dataset; /* 0: not open */
    hid_t memory;  /* type of appended values */
    int ndim;
    hsize_t rows, shape[4]; /* shape[0]: 1 */
} td_array;

/* Creates a file; takes over `path` (NULL: out of memory). */
tides_status td_arrays_open(td_arrays *arrays, char *path, tides_error *error);

typedef struct td_array_form {
    hid_t stored, memory; /* types in the file, and of what is appended */
    int ndim;
    const size_t *inner; /* (ndim - 1) extents beyond the first, which grows */
    size_t chunk;        /* rows that form a chunk */
} td_array_form;

/* Creates an array "group/name" without rows. */
tides_status td_array_begin(td_arrays *arrays, const char *name, const td_array_form *form, td_array *array,
                            tides_error *error);
tides_status td_array_append(td_arrays *arrays, td_array *array, size_t rows, const void *values, tides_error *error);
/* Reads row number `row`. */
tides_status td_array_read(td_arrays *arrays, td_array *array, size_t row, void *values, tides_error *error);
void td_array_end(td_array *array); /* does nothing if it isn't open */

/* Closes the file; all arrays must have ended before. */
tides_status td_arrays_close(td_arrays *arrays, tides_error *error);
void td_arrays_drop(td_arrays *arrays);

#endif
