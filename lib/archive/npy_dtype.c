/* Parses numpy's dtypes from an .npy header (numpy.lib.format, "descr"): "<f4", or a list of (name, dtype) pairs for packed
 * structures. Object dtypes are refused: reading them would execute code from the file. */
#include "archive/td_npy_parts.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

/* Parses a plain dtype such as "<i2": byte order, kind, bytes. For kind U the number counts letters of four bytes. */
static tides_status read_plain(const char *what, const char *text, td_npy_field *field, tides_error *error) {
    if (text && text[0] && strchr("<>|=", text[0]) && text[1] == 'O')
        return td_fail(error, TIDES_UNSUPPORTED, "%s: holds Python objects, which would have to be executed: save numbers",
                       what);
    char *end = NULL;
    int known =
        text && text[0] && strchr("<>|", text[0]) && text[1] && strchr("fiubcSUV", text[1]) && text[2] >= '0' && text[2] <= '9';
    unsigned long bytes = known ? strtoul(text + 2, &end, 10) : 0;
    if (!known || *end || bytes > 1u << 24)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: has dtype %s: numbers, texts and structures of them are read", what,
                       text ? text : "of an unknown form");
    field->kind = text[1];
    field->bytes = bytes * (text[1] == 'U' ? 4 : 1);
    return TIDES_OK;
}

static tides_status read_field(const char *what, const td_value *pair, td_npy_array *array, tides_error *error) {
    const char *name = td_value_text(td_value_item(pair, 0)), *type = td_value_text(td_value_item(pair, 1));
    if (!name || !type || pair->count != 2)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: field %zu of its dtype isn't a name and a plain dtype", what,
                       array->field_count);
    if (array->field_count == TD_NPY_FIELDS_MAX || strlen(name) >= TD_NPY_NAME_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: field %.80s: at most %d fields with names below %d letters are read",
                       what, name, TD_NPY_FIELDS_MAX, TD_NPY_NAME_MAX);
    td_npy_field *field = &array->fields[array->field_count];
    tides_status status = read_plain(what, type, field, error);
    if (status) return status;
    memcpy(field->name, name, strlen(name) + 1);
    field->offset = array->item;
    array->item += field->bytes;
    array->field_count++;
    return TIDES_OK;
}

/* The dtype of field `i` as stored, from the byte order on. */
static const char *stored_type(const td_value *descr, size_t i) {
    const char *plain = td_value_text(descr);
    return plain ? plain : td_value_text(td_value_item(td_value_item(descr, i), 1));
}

/* Writes the dtype as text in numpy's form, with little-endian byte order. */
static tides_status write_dtype(const char *what, const td_value *descr, td_npy_array *array, tides_error *error) {
    int plain = descr->kind == TD_VALUE_TEXT;
    size_t used = 0, room = sizeof array->dtype;
    for (size_t i = 0; i < array->field_count && used < room; i++) {
        const char *type = stored_type(descr, i);
        char order = type[0] == '>' ? '<' : type[0];
        int added = plain ? snprintf(array->dtype, room, "%c%s", order, type + 1)
                          : snprintf(array->dtype + used, room - used, "%s('%s', '%c%s')", i ? ", " : "[",
                                     array->fields[i].name, order, type + 1);
        used += (size_t)added;
    }
    if (!plain && used < room) used += (size_t)snprintf(array->dtype + used, room - used, "]");
    if (used < room) return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED, "%s: its dtype takes more than %zu letters", what, room);
}

tides_status td_npy_read_dtype(const char *what, const td_value *descr, td_npy_array *array, int *swap, tides_error *error) {
    tides_status status = TIDES_OK;
    array->item = array->field_count = 0;
    if (descr->kind == TD_VALUE_LIST) {
        for (size_t i = 0; i < descr->count && !status; i++) status = read_field(what, descr->as.items[i], array, error);
    } else {
        status = read_plain(what, td_value_text(descr), &array->fields[0], error);
        array->fields[0].offset = 0;
        array->fields[0].name[0] = 0;
        array->item = array->fields[0].bytes;
        array->field_count = 1;
    }
    if (!status && array->field_count == 0) status = td_fail(error, TIDES_UNSUPPORTED, "%s: its dtype has no fields", what);
    if (!status) status = write_dtype(what, descr, array, error);
    *swap = 0;
    for (size_t i = 0; i < array->field_count && !status; i++) *swap = *swap || stored_type(descr, i)[0] == '>';
    return status;
}

static void reverse(unsigned char *bytes, size_t count) {
    for (size_t i = 0; i < count / 2; i++) {
        unsigned char kept = bytes[i];
        bytes[i] = bytes[count - 1 - i];
        bytes[count - 1 - i] = kept;
    }
}

void td_npy_swap(td_npy_array *array, const td_value *descr, unsigned char *elements) {
    for (size_t f = 0; f < array->field_count; f++) {
        const td_npy_field *field = &array->fields[f];
        if (stored_type(descr, f)[0] != '>') continue;
        /* A text has letters of four bytes, a complex number two halves; bytes and raw data have no order. */
        size_t unit = field->kind == 'U' ? 4 : field->kind == 'c' ? field->bytes / 2 : field->bytes;
        if (field->kind == 'S' || field->kind == 'V' || unit < 2) continue;
        for (size_t i = 0; i < array->count; i++)
            for (size_t at = 0; at + unit <= field->bytes; at += unit)
                reverse(elements + i * array->item + field->offset + at, unit);
    }
}

const td_npy_field *td_npy_find_field(const td_npy_array *array, const char *name) {
    for (size_t i = 0; i < array->field_count; i++)
        if (strcmp(array->fields[i].name, name ? name : "") == 0) return &array->fields[i];
    return NULL;
}
