/* Internal: arrays of HDF5 files whose first extent grows, in groups, in a dataset's (unfinished) folder. */
#ifndef TD_ARRAYS_H
#define TD_ARRAYS_H

#include "tides/base.h"

#include <hdf5.h>

typedef struct td_arrays {
    hid_t file; /* 0: none open */
    char *path;
    int failed; /* errno of a write that HDF5 doesn't see (archive/td_h5_driver.h) */
} td_arrays;

typedef struct td_array {
    hid_t dataset; /* 0: none open */
    hid_t memory;  /* the type of what is appended */
    int ndim;
    hsize_t rows, shape[4]; /* shape[0]: 1 */
} td_array;

/* A new file; takes over `path`, NULL being out of memory. */
tides_status td_arrays_open(td_arrays *arrays, char *path, tides_error *error);

typedef struct td_array_form {
    hid_t stored, memory; /* types in the file, and of what is appended */
    int ndim;
    const size_t *inner; /* (ndim - 1) extents beyond the first, which grows */
    size_t chunk;        /* rows that are packed together */
} td_array_form;

/* A new array "group/name" of no rows. */
tides_status td_array_begin(td_arrays *arrays, const char *name, const td_array_form *form, td_array *array,
                            tides_error *error);
tides_status td_array_append(td_arrays *arrays, td_array *array, size_t rows, const void *values, tides_error *error);
tides_status td_array_read(td_arrays *arrays, td_array *array, size_t row, void *values, tides_error *error); /* a row back */
void td_array_end(td_array *array); /* one that isn't open is fine */

/* Arrays must have ended. */
tides_status td_arrays_close(td_arrays *arrays, tides_error *error);
void td_arrays_drop(td_arrays *arrays);

#endif
