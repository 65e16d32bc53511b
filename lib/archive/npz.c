/* Reads .npz archives of arrays; a lone .npy is treated as an archive with one array. */
#include "archive/td_npy_parts.h"
#include "archive/td_numbers.h"
#include "archive/td_zip.h"
#include "td_base.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct entry {
    char *name;
    td_npy_array array;
    void *owned; /* the array's memory, once read */
} entry;

struct td_npz {
    char *path, *file; /* file: the bytes that td_npz_open read and owns, else NULL */
    td_zip zip;        /* without members for an .npy */
    entry *entries;
    size_t count;
};

static tides_status name_entries(td_npz *npz, tides_error *error) {
    for (size_t i = 0; i < npz->zip.count; i++) {
        const char *name = npz->zip.members[i].name;
        size_t length = strlen(name), cut = length > 4 && strcmp(name + length - 4, ".npy") == 0 ? 4 : 0;
        if (!(npz->entries[i].name = td_format(error, "%.*s", (int)(length - cut), name))) return TIDES_NO_MEMORY;
    }
    return TIDES_OK;
}

static tides_status open_parts(td_npz *npz, const void *bytes, size_t size, tides_error *error) {
    int zipped = td_zip_is(bytes, size);
    tides_status status = zipped ? td_zip_open(&npz->zip, npz->path, bytes, size, error) : TIDES_OK;
    if (status) return status;
    size_t count = zipped ? npz->zip.count : 1;
    if (!(npz->entries = td_alloc(count, sizeof *npz->entries, error))) return TIDES_NO_MEMORY;
    npz->count = count;
    if (zipped) return name_entries(npz, error);
    if (!(npz->entries[0].name = td_strdup("data", error))) return TIDES_NO_MEMORY;
    return td_npy_parse(npz->path, bytes, size, &npz->entries[0].array, &npz->entries[0].owned, error);
}

tides_status td_npz_parse(const char *path, const void *bytes, size_t size, td_npz **npz, tides_error *error) {
    td_npz *made = td_alloc(1, sizeof *made, error);
    tides_status status = made ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status && !(made->path = td_strdup(path, error))) status = TIDES_NO_MEMORY;
    if (!status) status = open_parts(made, bytes, size, error);
    if (status)
        td_npz_close(made);
    else
        *npz = made;
    return status;
}

tides_status td_npz_open(const char *path, td_npz **npz, tides_error *error) {
    char *file = NULL;
    size_t size = 0;
    td_npz *made = NULL;
    tides_status status = td_read_file(path, SIZE_MAX - 1, &file, &size, error);
    if (!status) status = td_npz_parse(path, file, size, &made, error);
    if (status || made->zip.count == 0) { /* the array of a lone .npy is a copy, so the file's bytes can go */
        free(file);
        file = NULL;
    }
    if (status) return status;
    made->file = file;
    *npz = made;
    return TIDES_OK;
}

void td_npz_close(td_npz *npz) {
    if (!npz) return;
    for (size_t i = 0; i < npz->count; i++) {
        free(npz->entries[i].name);
        free(npz->entries[i].owned);
    }
    free(npz->entries);
    td_zip_close(&npz->zip);
    free(npz->file);
    free(npz->path);
    free(npz);
}

size_t td_npz_count(const td_npz *npz) { return npz->count; }

const char *td_npz_name(const td_npz *npz, size_t index) { return index < npz->count ? npz->entries[index].name : NULL; }

static tides_status read_entry(td_npz *npz, size_t index, tides_error *error) {
    entry *e = &npz->entries[index];
    const unsigned char *npy = NULL;
    void *unpacked = NULL;
    char *what = td_format(error, "%s: array %.80s", npz->path, e->name);
    tides_status status = what ? td_zip_read(&npz->zip, &npz->zip.members[index], &npy, &unpacked, error) : TIDES_NO_MEMORY;
    if (!status) status = td_npy_parse(what, npy, npz->zip.members[index].size, &e->array, &e->owned, error);
    free(unpacked);
    free(what);
    return status;
}

tides_status td_npz_get(td_npz *npz, const char *name, const td_npy_array **array, tides_error *error) {
    size_t i = 0;
    while (i < npz->count && strcmp(npz->entries[i].name, name) != 0) i++;
    if (i == npz->count) {
        td_fail(error, TIDES_BAD_FILE, "%s: holds no array %s", npz->path, name);
        return TIDES_BAD_FILE;
    }
    tides_status status = npz->entries[i].owned ? TIDES_OK : read_entry(npz, i, error);
    if (!status) *array = &npz->entries[i].array;
    return status;
}

static tides_status check_shape(const td_npz *npz, const char *name, const td_npy_array *array, int ndim, const int64_t *shape,
                                tides_error *error) {
    int64_t found[TD_NPY_DIMENSIONS_MAX] = {0};
    int fits = array->ndim == ndim;
    for (int d = 0; d < array->ndim; d++) found[d] = (int64_t)array->shape[d];
    for (int d = 0; d < ndim && fits; d++) fits = shape[d] < 0 || shape[d] == found[d];
    if (fits) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: array %s has shape %s: %s was expected", npz->path, name,
                   TD_SHAPE_TEXT(array->ndim, found), TD_SHAPE_TEXT(ndim, shape));
}

tides_status td_npz_floats(td_npz *npz, const char *name, int ndim, const int64_t *shape, float **values, tides_error *error) {
    const td_npy_array *array = NULL;
    tides_status status = td_npz_get(npz, name, &array, error);
    if (!status) status = check_shape(npz, name, array, ndim, shape, error);
    if (status) return status;
    float *made = td_alloc(array->count, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    const td_npy_field *field = td_npy_find_field(array, NULL);
    for (size_t i = 0; i < array->count && !status; i++) {
        double value = NAN;
        if (!field || !td_npy_number(array, field, i, &value))
            status = td_fail(error, TIDES_BAD_FILE, "%s: array %s has dtype %s: numbers were expected", npz->path, name,
                             array->dtype);
        else if (!(fabs(value) <= FLT_MAX))
            status =
                td_fail(error, TIDES_BAD_FILE, "%s: array %s: element %zu is %g: it must be finite", npz->path, name, i, value);
        else
            made[i] = (float)value;
    }
    if (status)
        free(made);
    else
        *values = made;
    return status;
}
