/* numpy files: the .npy header (format 1.0 to 3.0, a Python dict in text) and the members of an .npz. */
#include "npz.h"

#include "zip.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct entry {
    char name[256];
    zip_member member; /* unused for an .npy */
    npz_array array;
    void *owned; /* array.data once read */
} entry;

struct npz {
    char *path;
    unsigned char *bytes; /* the file */
    size_t size;
    entry *entries;
    size_t count;
};

static unsigned char *read_all(const char *path, size_t *size) {
    unsigned char *bytes = NULL;
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    long length = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (length >= 0 && fseek(file, 0, SEEK_SET) == 0) bytes = malloc((size_t)length + 1);
    if (bytes && fread(bytes, 1, (size_t)length, file) != (size_t)length) {
        free(bytes);
        bytes = NULL;
    }
    fclose(file);
    *size = bytes ? (size_t)length : 0;
    return bytes;
}

/* Where the value of `key` starts in the header's dict, or NULL. */
static const char *header_value(const char *header, const char *key) {
    const char *at = strstr(header, key);
    if (!at) return NULL;
    at += strlen(key);
    return at + strspn(at, ": ");
}

/* A quoted string without its quotes, or a list with its brackets. */
static int read_descr(const char *at, char *out, size_t size) {
    const char *stop = NULL;
    if (*at == '\'')
        stop = strchr(++at, '\'');
    else if (*at == '[' && (stop = strstr(at, "], '")) != NULL)
        stop++;
    if (!stop || (size_t)(stop - at) >= size) return -1;
    memcpy(out, at, (size_t)(stop - at));
    out[stop - at] = 0;
    return 0;
}

/* "(3, 4)", "(3,)" or "()". */
static int read_shape(const char *at, npz_array *array) {
    if (*at++ != '(') return -1;
    array->count = 1;
    for (int i = 0; i < NPZ_DIMENSIONS_MAX; i++) array->shape[i] = 1;
    for (array->ndim = 0; *at != ')'; array->ndim++) {
        char *stop;
        unsigned long long extent = strtoull(at, &stop, 10);
        if (stop == at || array->ndim == NPZ_DIMENSIONS_MAX) return -1;
        if (extent && array->count > SIZE_MAX / extent) return -1;
        array->shape[array->ndim] = (size_t)extent;
        array->count *= (size_t)extent;
        at = stop + strspn(stop, ", ");
    }
    return 0;
}

/* Bytes of one element of a plain dtype; 0 for structured or unknown ones. */
static size_t item_size(const char *dtype) {
    if (!strchr("<|", dtype[0]) || !dtype[0] || !strchr("fiubcSUV", dtype[1])) return 0;
    size_t size = (size_t)strtoul(dtype + 2, NULL, 10);
    return dtype[1] == 'U' ? 4 * size : size;
}

/* Checks the extents against the bytes that follow the header. */
static int read_item(npz_array *array, size_t data_bytes) {
    array->item = array->dtype[0] == '[' ? (array->count ? data_bytes / array->count : 0) : item_size(array->dtype);
    if (array->dtype[0] != '[' && array->item == 0) return -1;
    if (array->item && array->count > SIZE_MAX / array->item) return -1;
    return array->count * array->item == data_bytes ? 0 : -1;
}

/* Copies elements stored with the first index running fastest into C order. */
static void from_fortran(const unsigned char *stored, const npz_array *array, unsigned char *out) {
    for (size_t i = 0; i < array->count; i++) {
        size_t rest = i, from = 0;
        for (int d = array->ndim; d-- > 0;) {
            size_t stride = 1;
            for (int lower = 0; lower < d; lower++) stride *= array->shape[lower];
            from += rest % array->shape[d] * stride;
            rest /= array->shape[d];
        }
        memcpy(out + i * array->item, stored + from * array->item, array->item);
    }
}

/* Fills `array` from an .npy in memory; data is copied to `*owned`. */
static const char *read_npy(const unsigned char *npy, size_t size, npz_array *array, void **owned) {
    if (size < 12 || memcmp(npy, "\x93NUMPY", 6) != 0) return "isn't an .npy";
    size_t start = npy[6] == 1 ? 10 : 12;
    size_t length = npy[8] | (size_t)npy[9] << 8;
    if (start == 12) length |= (size_t)npy[10] << 16 | (size_t)npy[11] << 24;
    if (size - start < length) return "is truncated in its header";
    char *header = malloc(length + 1);
    if (!header) return "is too large";
    memcpy(header, npy + start, length);
    header[length] = 0;
    const char *descr = header_value(header, "'descr'"), *order = header_value(header, "'fortran_order'");
    const char *shape = header_value(header, "'shape'"), *problem = NULL;
    int fortran = order && strncmp(order, "True", 4) == 0;
    size_t data_bytes = size - start - length;
    if (!descr || !order || !shape || read_shape(shape, array) != 0)
        problem = "has a header that can't be read";
    else if (read_descr(descr, array->dtype, sizeof array->dtype) != 0)
        problem = "has a dtype that can't be read";
    else if (read_item(array, data_bytes) != 0)
        problem = "has a dtype that isn't supported, or the wrong number of bytes";
    else if (!(*owned = malloc(data_bytes ? data_bytes : 1)))
        problem = "is too large";
    free(header);
    if (problem) return problem;
    if (fortran)
        from_fortran(npy + start + length, array, *owned);
    else
        memcpy(*owned, npy + start + length, data_bytes);
    array->data = *owned;
    return NULL;
}

static int open_zip(npz *file) {
    zip_member *members;
    size_t count;
    if (zip_list(file->bytes, file->size, file->path, &members, &count) != 0) return -1;
    file->entries = calloc(count ? count : 1, sizeof *file->entries);
    for (size_t i = 0; file->entries && i < count; i++) {
        entry *e = &file->entries[i];
        e->member = members[i];
        memcpy(e->name, members[i].name, sizeof e->name);
        size_t length = strlen(e->name);
        if (length > 4 && strcmp(e->name + length - 4, ".npy") == 0) e->name[length - 4] = 0;
    }
    file->count = file->entries ? count : 0;
    free(members);
    return file->entries ? 0 : -1;
}

static int open_npy(npz *file) {
    file->entries = calloc(1, sizeof *file->entries);
    if (!file->entries) return -1;
    file->count = 1;
    memcpy(file->entries[0].name, "data", 5);
    const char *problem = read_npy(file->bytes, file->size, &file->entries[0].array, &file->entries[0].owned);
    if (problem) fprintf(stderr, "%s: %s\n", file->path, problem);
    return problem ? -1 : 0;
}

npz *npz_open(const char *path) {
    npz *file = calloc(1, sizeof *file);
    if (!file) return NULL;
    file->path = malloc(strlen(path) + 1);
    file->bytes = read_all(path, &file->size);
    int fine = file->path != NULL;
    if (fine) memcpy(file->path, path, strlen(path) + 1);
    if (!file->bytes) fprintf(stderr, "%s: can't be read\n", path);
    fine = fine && file->bytes;
    if (fine) fine = (file->size > 0 && file->bytes[0] == 0x93 ? open_npy(file) : open_zip(file)) == 0;
    if (fine) return file;
    npz_close(file);
    return NULL;
}

void npz_close(npz *file) {
    if (!file) return;
    for (size_t i = 0; i < file->count; i++) free(file->entries[i].owned);
    free(file->entries);
    free(file->bytes);
    free(file->path);
    free(file);
}

size_t npz_count(const npz *file) { return file->count; }

const char *npz_name(const npz *file, size_t index) { return index < file->count ? file->entries[index].name : NULL; }

const npz_array *npz_get(npz *file, const char *name) {
    entry *e = file->entries, *stop = e + file->count;
    while (e < stop && strcmp(e->name, name) != 0) e++;
    if (e == stop) return NULL;
    if (e->owned) return &e->array;
    unsigned char *npy = zip_extract(file->bytes, file->size, &e->member, file->path);
    if (!npy) return NULL;
    const char *problem = read_npy(npy, e->member.size, &e->array, &e->owned);
    free(npy);
    if (!problem) return &e->array;
    fprintf(stderr, "%s: %s %s\n", file->path, name, problem);
    return NULL;
}

/* Element `i` of a numeric array; returns -1 for any other dtype. */
static int element(const npz_array *array, size_t i, double *value) {
    const unsigned char *at = (const unsigned char *)array->data + i * array->item;
#define NPZ_AS(code, type)                                \
    if (strcmp(array->dtype + 1, code) == 0) {            \
        type element_value;                               \
        memcpy(&element_value, at, sizeof element_value); \
        *value = (double)element_value;                   \
        return 0;                                         \
    }
    NPZ_AS("f8", double)
    NPZ_AS("f4", float)
    NPZ_AS("i8", int64_t)
    NPZ_AS("i4", int32_t)
    NPZ_AS("i2", int16_t)
    NPZ_AS("i1", int8_t)
    NPZ_AS("u8", uint64_t)
    NPZ_AS("u4", uint32_t)
    NPZ_AS("u2", uint16_t)
    NPZ_AS("u1", uint8_t)
    NPZ_AS("b1", uint8_t)
#undef NPZ_AS
    return -1;
}

double *npz_doubles(npz *file, const char *name, size_t *count) {
    const npz_array *array = npz_get(file, name);
    if (!array) return NULL;
    double *values = malloc((array->count ? array->count : 1) * sizeof *values);
    for (size_t i = 0; values && i < array->count; i++) {
        if (element(array, i, &values[i]) != 0) {
            fprintf(stderr, "%s: %s holds %s, no numbers\n", file->path, name, array->dtype);
            free(values);
            return NULL;
        }
    }
    if (values && count) *count = array->count;
    return values;
}

long npz_int(npz *file, const char *name) {
    const npz_array *array = npz_get(file, name);
    double value;
    if (array && array->count > 0 && element(array, 0, &value) == 0) return (long)value;
    fprintf(stderr, "%s: %s is absent or no number\n", file->path, name);
    return LONG_MIN;
}

/* UTF-8 of one code point; returns its length. */
static size_t utf8(uint32_t c, char out[4]) {
    size_t length = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
    static const unsigned char lead[5] = {0, 0, 0xc0, 0xe0, 0xf0};
    for (size_t i = length; i-- > 1; c >>= 6) out[i] = (char)(0x80 | (c & 0x3f));
    out[0] = (char)(lead[length] | c);
    return length;
}

void npz_string(npz *file, const char *name, char *out, size_t size) {
    const npz_array *array = npz_get(file, name);
    size_t used = 0, letters = array && array->dtype[1] == 'U' && array->count > 0 ? array->item / 4 : 0;
    for (size_t i = 0; i < letters; i++) {
        uint32_t c;
        char text[4];
        memcpy(&c, (const unsigned char *)array->data + 4 * i, 4);
        size_t length = c ? utf8(c, text) : 0;
        if (length == 0 || used + length >= size) break;
        memcpy(out + used, text, length);
        used += length;
    }
    if (size) out[used] = 0;
}
