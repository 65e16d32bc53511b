/* Internal: numpy's .npy files (format 1.0 to 3.0, numpy.lib.format) and .npz archives of them.
 * Reading: plain and structured dtypes, either byte order, C or Fortran order; the result is always in C order and
 * little-endian. Nothing is executed: object arrays (pickles) are TIDES_UNSUPPORTED.
 * Writing: streamed, uncompressed, little-endian, C order. */
#ifndef TD_NPY_H
#define TD_NPY_H

#include "tides/base.h"

/* Limits of these readers; numpy itself allows 32 dimensions (64 from version 2 on). */
enum { TD_NPY_DIMENSIONS_MAX = 8, TD_NPY_FIELDS_MAX = 32, TD_NPY_NAME_MAX = 64 };

/* A number within an element: the element itself for a plain dtype, or a named field of a structured one. */
typedef struct td_npy_field {
    char name[TD_NPY_NAME_MAX]; /* "" for a plain dtype */
    char kind;                  /* numpy's letter: f i u b c S U V */
    size_t bytes, offset;       /* within the element */
} td_npy_field;

typedef struct td_npy_array {
    char dtype[1024]; /* "<f8", or for a structured dtype the list "[('t', '<i8'), ('x', '<i2')]" */
    td_npy_field fields[TD_NPY_FIELDS_MAX];
    size_t field_count;                  /* 1 for a plain dtype */
    int ndim;                            /* 0: a scalar */
    size_t shape[TD_NPY_DIMENSIONS_MAX]; /* entries from ndim on are 1 */
    size_t count, item;                  /* elements, and bytes of one (structured: packed, no padding) */
    const void *data;                    /* aligned to 8 bytes */
} td_npy_array;

/* -- reading ------------------------------------------------------------------------------------------------------------ */

typedef struct td_npz td_npz;

/* Opens an .npz, or an .npy as one array called "data". Only one thread at a time may use it; the caller closes it. */
tides_status td_npz_open(const char *path, td_npz **npz, tides_error *error);

/* Parses an .npz or .npy in memory, which must outlive the td_npz; `path` is for messages only. Statuses as td_npz_open. */
tides_status td_npz_parse(const char *path, const void *bytes, size_t size, td_npz **npz, tides_error *error);
void td_npz_close(td_npz *npz); /* NULL is fine */

/* The number of arrays, and the name of each without ".npy", in the file's order; NULL if `index` is out of range. */
size_t td_npz_count(const td_npz *npz);
const char *td_npz_name(const td_npz *npz, size_t index);

/* An array, which is read on the first request and lives as long as `npz`. TIDES_BAD_FILE if there is none of that name. */
tides_status td_npz_get(td_npz *npz, const char *name, const td_npy_array **array, tides_error *error);

/* An array as floats in C order, which the caller frees. Checked: all are finite, and there are `ndim` extents as in `shape`
 * (-1: any). TIDES_BAD_FILE names the array and its fault. */
tides_status td_npz_floats(td_npz *npz, const char *name, int ndim, const int64_t *shape, float **values, tides_error *error);

/* A structured array's field by name, NULL if there is none. For NULL or "", the only field of a plain dtype. */
const td_npy_field *td_npy_find_field(const td_npy_array *array, const char *name);

/* One field of element `index` < count as a number: 1 and `*value`. The kinds are f (2, 4, 8 bytes), i, u, b; for
 * td_npy_integer i, u (up to INT64_MAX) and b. 0, and `*value` unchanged, for other kinds or if `field` is NULL. */
int td_npy_number(const td_npy_array *array, const td_npy_field *field, size_t index, double *value);
int td_npy_integer(const td_npy_array *array, const td_npy_field *field, size_t index, int64_t *value);

/* -- writing ------------------------------------------------------------------------------------------------------------ */

typedef struct td_npy_writer td_npy_writer;

/* Begins to write "PATH.part". With `zipped`: an .npz with any number of arrays, below 4 GiB (beyond: TIDES_UNSUPPORTED).
 * Otherwise an .npy with exactly one. TIDES_WRITE_FAILED, TIDES_NO_MEMORY. */
tides_status td_npy_writer_open(const char *path, int zipped, td_npy_writer **writer, tides_error *error);

/* An array but for its first extent, which is the number of rows that are appended. */
typedef struct td_npy_form {
    const char *name;
    const char *dtype;   /* as numpy writes it in a header: "'<f4'" with its quotes, or "[('t', '<i8'), ('x', '<i2')]" */
    size_t item;         /* bytes per element */
    int ndim;            /* 0: a scalar, of which exactly one element is appended */
    const size_t *inner; /* (ndim - 1) the other extents; NULL where ndim is 1 */
} td_npy_form;

/* Begins an array, and ends the previous one. */
tides_status td_npy_writer_begin(td_npy_writer *writer, const td_npy_form *form, tides_error *error);

/* Appends `count` rows, little-endian and packed. A row is one element times the inner extents. */
tides_status td_npy_writer_append(td_npy_writer *writer, const void *rows, size_t count, tides_error *error);

/* Writes a whole array: begins it and appends its `count` rows. */
tides_status td_npy_writer_put(td_npy_writer *writer, const td_npy_form *form, const void *rows, size_t count,
                               tides_error *error);

/* Completes the file and renames it. Frees the writer in any case; on failure removes the partial file. */
tides_status td_npy_writer_close(td_npy_writer *writer, tides_error *error);

/* Removes the partial file and frees the writer, which may be NULL. */
void td_npy_writer_discard(td_npy_writer *writer);

/* Closes the writer if `status` is TIDES_OK, otherwise discards it. Returns `status`, or the reason why it couldn't be
 * closed. */
tides_status td_npy_writer_end(td_npy_writer *writer, tides_status status, tides_error *error);

#endif
