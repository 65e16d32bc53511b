/* Parses one .npy in memory (numpy.lib.format): magic, version, a Python dict as text, the elements. The caller supplies the
 * bytes and knows what the numbers mean. */
#include "archive/td_npy_parts.h"
#include "archive/td_numbers.h"
#include "archive/td_pyrepr.h"
#include "archive/td_tree.h"
#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

/* Reads "(3, 4)", "(3,)" or "()". An element count that overflows size_t is refused: no file can hold it. */
static int read_shape(const td_value *shape, td_npy_array *array) {
    if (!shape || shape->kind != TD_VALUE_TUPLE || shape->count > TD_NPY_DIMENSIONS_MAX) return 0;
    array->count = 1;
    array->ndim = (int)shape->count;
    for (size_t i = 0; i < TD_NPY_DIMENSIONS_MAX; i++) {
        int64_t extent = 1;
        if (i < shape->count && (!td_value_integer(shape->as.items[i], &extent) || extent < 0)) return 0;
        if (extent && array->count > SIZE_MAX / (size_t)extent) return 0;
        array->shape[i] = (size_t)extent;
        array->count *= (size_t)extent;
    }
    return 1;
}

/* Copies elements from Fortran order, where the first index runs fastest, into C order. */
static void from_fortran(const unsigned char *stored, const td_npy_array *array, unsigned char *out) {
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

/* Positions of the header's text and of the elements. */
typedef struct layout {
    const char *header;
    size_t header_bytes;
    const unsigned char *elements;
    size_t element_bytes;
} layout;

static tides_status find_parts(const char *what, const unsigned char *npy, size_t size, layout *parts, tides_error *error) {
    if (size < 12 || memcmp(npy, "\x93NUMPY", 6) != 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: isn't an .npy (no '\\x93NUMPY' at byte 0)", what);
    if (npy[6] < 1 || npy[6] > 3)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: is .npy format %u.%u: 1.0 to 3.0 are read", what, (unsigned)npy[6],
                       (unsigned)npy[7]);
    size_t start = npy[6] == 1 ? 10 : 12, length = npy[8] | (size_t)npy[9] << 8;
    if (start == 12) length |= (size_t)npy[10] << 16 | (size_t)npy[11] << 24;
    if (size - start < length)
        return td_fail(error, TIDES_BAD_FILE, "%s: is truncated in its header of %zu bytes", what, length);
    if (length > 65536) /* numpy itself writes a few hundred bytes, and reads 10000 at most */
        return td_fail(error, TIDES_BAD_FILE, "%s: has a header of %zu bytes: 65536 are the most that is read", what, length);
    parts->header = (const char *)npy + start;
    parts->header_bytes = length;
    parts->elements = npy + start + length;
    parts->element_bytes = size - start - length;
    return TIDES_OK;
}

static tides_status check_bytes(const char *what, const td_npy_array *array, size_t bytes, tides_error *error) {
    if (array->item == 0 ? bytes == 0 : (array->count <= bytes / array->item && array->count * array->item == bytes))
        return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: %zu elements of %zu bytes were declared, but %zu bytes follow: it is truncated or damaged", what,
                   array->count, array->item, bytes);
}

static tides_status take_elements(const layout *parts, const td_value *header, int fortran, int swap, td_npy_array *array,
                                  void **owned, tides_error *error) {
    unsigned char *made = td_alloc(parts->element_bytes, 1, error);
    if (!made) return TIDES_NO_MEMORY;
    if (fortran && array->ndim > 1 && parts->element_bytes)
        from_fortran(parts->elements, array, made);
    else if (parts->element_bytes)
        memcpy(made, parts->elements, parts->element_bytes);
    if (swap) td_npy_swap(array, td_value_get(header, "descr"), made);
    array->data = *owned = made;
    return TIDES_OK;
}

tides_status td_npy_parse(const char *what, const unsigned char *npy, size_t size, td_npy_array *array, void **owned,
                          tides_error *error) {
    layout parts = {.header = NULL};
    td_npy_array made = {.ndim = 0};
    td_tree *tree = NULL;
    int fortran = 0, swap = 0;
    tides_status status = find_parts(what, npy, size, &parts, error);
    if (!status) status = td_pyrepr_parse(what, parts.header, parts.header_bytes, &tree, error);
    if (status) return status;
    const td_value *header = td_tree_root(tree), *descr = td_value_get(header, "descr");
    if (!descr || !td_value_bool(td_value_get(header, "fortran_order"), &fortran) ||
        !read_shape(td_value_get(header, "shape"), &made))
        status = td_fail(error, TIDES_BAD_FILE, "%s: its header lacks a usable 'descr', 'fortran_order' or 'shape'", what);
    if (!status) status = td_npy_read_dtype(what, descr, &made, &swap, error);
    if (!status) status = check_bytes(what, &made, parts.element_bytes, error);
    if (!status) status = take_elements(&parts, header, fortran, swap, &made, owned, error);
    if (!status) *array = made;
    td_tree_free(tree);
    return status;
}

/* The bytes of a field of one element as an unsigned integer. */
static uint64_t load_bits(const td_npy_array *array, const td_npy_field *field, size_t index) {
    return td_le_number((const unsigned char *)array->data + index * array->item + field->offset, field->bytes);
}

int td_npy_integer(const td_npy_array *array, const td_npy_field *field, size_t index, int64_t *value) {
    if (!field || !field->bytes || field->bytes > 8 || (field->bytes & (field->bytes - 1)) || !strchr("iub", field->kind))
        return 0;
    uint64_t bits = load_bits(array, field, index);
    unsigned unused = 64 - 8 * (unsigned)field->bytes;
    if (field->kind == 'i') /* sign-extends: all common compilers shift signed numbers arithmetically */
        *value = (int64_t)(bits << unused) >> unused;
    else if (bits > INT64_MAX)
        return 0;
    else
        *value = (int64_t)bits;
    return 1;
}

int td_npy_number(const td_npy_array *array, const td_npy_field *field, size_t index, double *value) {
    int64_t integer = 0;
    if (td_npy_integer(array, field, index, &integer)) {
        *value = (double)integer;
        return 1;
    }
    if (!field) return 0;
    int is_float = field->kind == 'f' && (field->bytes == 2 || field->bytes == 4 || field->bytes == 8);
    if (!is_float && !(field->kind == 'u' && field->bytes == 8)) return 0;
    uint64_t bits = load_bits(array, field, index);
    *value = !is_float ? (double)bits : td_float_bits(bits, field->bytes);
    return 1;
}
