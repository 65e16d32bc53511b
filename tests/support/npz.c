/* Reads numpy's files for tests, by the library's reader, and prints errors on stderr. */
#include "npz.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

npz *npz_open(const char *path) {
    td_npz *file = NULL;
    tides_error error;
    if (td_npz_open(path, &file, &error) != TIDES_OK) fprintf(stderr, "%s\n", error.text);
    return file;
}

void npz_close(npz *file) { td_npz_close(file); }

size_t npz_count(const npz *file) { return td_npz_count(file); }

const char *npz_name(const npz *file, size_t index) { return td_npz_name(file, index); }

const npz_array *npz_get(npz *file, const char *name) {
    const npz_array *array = NULL;
    tides_error error;
    size_t i = 0;
    while (i < td_npz_count(file) && strcmp(td_npz_name(file, i), name) != 0) i++;
    if (i < td_npz_count(file) && td_npz_get(file, name, &array, &error) != TIDES_OK) fprintf(stderr, "%s\n", error.text);
    return array;
}

double *npz_doubles(npz *file, const char *name, size_t *count) {
    const npz_array *array = npz_get(file, name);
    const td_npy_field *field = array ? td_npy_find_field(array, NULL) : NULL;
    if (!array) return NULL;
    double *values = malloc((array->count ? array->count : 1) * sizeof *values);
    for (size_t i = 0; values && i < array->count; i++) {
        if (!field || !td_npy_number(array, field, i, &values[i])) {
            fprintf(stderr, "%s holds %s, no numbers\n", name, array->dtype);
            free(values);
            return NULL;
        }
    }
    if (values && count) *count = array->count;
    return values;
}

long npz_int(npz *file, const char *name) {
    const npz_array *array = npz_get(file, name);
    const td_npy_field *field = array ? td_npy_find_field(array, NULL) : NULL;
    double value;
    if (field && array->count > 0 && td_npy_number(array, field, 0, &value)) return (long)value;
    fprintf(stderr, "%s is absent or no number\n", name);
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
    size_t used = 0, letters = array && array->fields[0].kind == 'U' && array->count > 0 ? array->item / 4 : 0;
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
