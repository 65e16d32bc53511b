/* Reads the rows of one element of a PLY file, in binary of either byte order or in ASCII, into columns of floats.
 *
 * Rows are read property by property, since a list has its own length in each row. An ASCII row is a line, as the format
 * demands, so a missing or superfluous value is reported at its line; blank lines are skipped. */
#include "td_base.h"
#include "td_endian.h"
#include "td_ply.h"
#include "td_scene.h"
#include "td_text.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* State of reading an element. */
typedef struct reader {
    const td_ply_file *file;
    const td_ply_element *element;
    const td_ply_property *properties;
    const td_ply_column *columns; /* NULL: skip */
    int format;
    size_t at, line;
    tides_error *error;
} reader;

static void store(const reader *r, size_t property, uint64_t row, double value) {
    const td_ply_column *column = r->columns ? &r->columns[property] : NULL;
    if (column && column->base) column->base[row * column->stride] = td_narrow(value);
    if (column && column->wide) column->wide[row * column->stride] = value;
}

/* Least number of bytes in a row: lists may be empty, and numbers may have one digit. */
static size_t least_row_bytes(const td_ply_property *properties, size_t count, int format) {
    if (format == TD_PLY_ASCII) return 2 * count; /* each a digit and a blank or line end */
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += td_ply_type_bytes(properties[i].count_type ? properties[i].count_type : properties[i].type);
    return bytes;
}

tides_status td_ply_rows_fit(const td_ply_file *file, const td_ply_header *header, const td_ply_element *element,
                             const td_ply_cursor *cursor, tides_error *error) {
    if (element->properties == 0) return TIDES_OK; /* rows have no bytes */
    size_t row = least_row_bytes(header->properties + element->first_property, element->properties, header->format);
    size_t left = file->size - cursor->at;
    size_t usable = left + (header->format == TD_PLY_ASCII); /* the last line end may be missing */
    if (element->count <= usable / row) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: line %zu: element %s declares %llu rows of at least %zu bytes, but only %zu bytes are left at "
                   "byte %zu: the file is truncated or its header wrong",
                   file->path, element->line, TD_PLY_QUOTE(element->name), (unsigned long long)element->count, row, left,
                   cursor->at);
}

/* -- binary -- */

static uint32_t load16(const unsigned char *b, int big) { return big ? td_be16(b) : td_le16(b); }
static uint32_t load32(const unsigned char *b, int big) { return big ? td_be32(b) : td_le32(b); }

static double load_float32(const unsigned char *b, int big) {
    uint32_t bits = load32(b, big);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static double load_float64(const unsigned char *b, int big) {
    uint64_t bits = big ? td_be64(b) : td_le64(b);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double load(const unsigned char *b, int type, int big) {
    switch (type) {
        case TD_PLY_INT8: return b[0] < 0x80 ? b[0] : (int)b[0] - 0x100;
        case TD_PLY_UINT8: return b[0];
        case TD_PLY_INT16: return (int32_t)load16(b, big) - (load16(b, big) & 0x8000u ? 0x10000 : 0);
        case TD_PLY_UINT16: return load16(b, big);
        case TD_PLY_INT32: return (double)((int64_t)load32(b, big) - (load32(b, big) & 0x80000000u ? INT64_C(0x100000000) : 0));
        case TD_PLY_UINT32: return load32(b, big);
        case TD_PLY_FLOAT64: return load_float64(b, big);
        default: return load_float32(b, big);
    }
}

static tides_status fail_truncated(const reader *r, size_t property, uint64_t row) {
    return td_fail(r->error, TIDES_BAD_FILE,
                   "%s: ends at byte %zu, within row %llu of %llu of element %s (property %s): truncated?", r->file->path,
                   r->file->size, (unsigned long long)row, (unsigned long long)r->element->count,
                   TD_PLY_QUOTE(r->element->name), TD_PLY_QUOTE(r->properties[property].name));
}

static tides_status skip_binary_list(reader *r, size_t property, uint64_t row) {
    const td_ply_property *list = &r->properties[property];
    size_t size = td_ply_type_bytes(list->count_type);
    if (r->file->size - r->at < size) return fail_truncated(r, property, row);
    double length = load(r->file->data + r->at, list->count_type, r->format == TD_PLY_BIG_ENDIAN);
    if (length < 0)
        return td_fail(r->error, TIDES_BAD_FILE, "%s: byte %zu: list %s of row %llu has %.0f entries", r->file->path, r->at,
                       TD_PLY_QUOTE(list->name), (unsigned long long)row, length);
    r->at += size;
    uint64_t bytes = (uint64_t)length * td_ply_type_bytes(list->type); /* below 2^32 times 8: no overflow */
    if (r->file->size - r->at < bytes) return fail_truncated(r, property, row);
    r->at += (size_t)bytes;
    return TIDES_OK;
}

static tides_status read_binary_row(reader *r, uint64_t row) {
    int big = r->format == TD_PLY_BIG_ENDIAN;
    for (size_t i = 0; i < r->element->properties; i++) {
        if (r->properties[i].count_type) {
            tides_status status = skip_binary_list(r, i, row);
            if (status) return status;
            continue;
        }
        size_t size = td_ply_type_bytes(r->properties[i].type);
        if (r->file->size - r->at < size) return fail_truncated(r, i, row);
        if (r->columns && r->columns[i].base) store(r, i, row, load(r->file->data + r->at, r->properties[i].type, big));
        r->at += size;
    }
    return TIDES_OK;
}

/* -- ASCII -- */

/* The next word of [*at, end); length 0 at the end. */
static td_ply_word next_word(const char **at, const char *end) {
    const char *p = *at;
    while (p < end && (*p == ' ' || *p == '\t' || *p == '\r')) p++;
    td_ply_word word = {p, 0};
    while (p < end && *p != ' ' && *p != '\t' && *p != '\r') p++;
    word.length = (size_t)(p - word.text);
    *at = p;
    return word;
}

/* Reads a number of property `i`. It fails if the line ends too early or has no number there. */
static tides_status ascii_number(const reader *r, size_t i, const char **at, const char *end, double *value) {
    td_ply_word word = next_word(at, end);
    if (td_ply_number(word, value)) return TIDES_OK;
    const char *name = TD_PLY_QUOTE(r->properties[i].name);
    if (word.length == 0)
        return td_fail(r->error, TIDES_BAD_FILE, "%s: line %zu: ends before property %s, number %zu of %zu", r->file->path,
                       r->line, name, i + 1, r->element->properties);
    return td_fail(r->error, TIDES_BAD_FILE, "%s: line %zu: property %s is '%s', which is not a number", r->file->path, r->line,
                   name, TD_PLY_QUOTE(word));
}

static tides_status read_ascii_property(const reader *r, size_t i, uint64_t row, const char **at, const char *end) {
    double value = 0, entry;
    tides_status status = ascii_number(r, i, at, end, &value);
    if (status) return status;
    if (!r->properties[i].count_type) {
        store(r, i, row, value);
        return TIDES_OK;
    }
    if (!(value >= 0 && value <= UINT32_MAX && value == floor(value)))
        return td_fail(r->error, TIDES_BAD_FILE, "%s: line %zu: list %s has %g entries", r->file->path, r->line,
                       TD_PLY_QUOTE(r->properties[i].name), value);
    for (double k = 0; k < value && !status; k++) status = ascii_number(r, i, at, end, &entry);
    return status;
}

/* The next line that isn't blank, as [*at, *end). */
static tides_status next_ascii_line(reader *r, uint64_t row, const char **at, const char **end) {
    const char *data_end = (const char *)r->file->data + r->file->size;
    while (r->at < r->file->size) {
        *at = (const char *)r->file->data + r->at;
        *end = memchr(*at, '\n', r->file->size - r->at);
        if (!*end) *end = data_end;
        r->at += (size_t)(*end - *at) + (*end < data_end);
        r->line++;
        const char *probe = *at;
        if (next_word(&probe, *end).length) return TIDES_OK;
    }
    return fail_truncated(r, 0, row);
}

static tides_status read_ascii_row(reader *r, uint64_t row) {
    const char *at = NULL, *end = NULL;
    tides_status status = next_ascii_line(r, row, &at, &end);
    if (status) return status;
    for (size_t i = 0; i < r->element->properties && !status; i++) status = read_ascii_property(r, i, row, &at, end);
    if (status) return status;
    td_ply_word rest = next_word(&at, end);
    if (rest.length == 0) return TIDES_OK;
    return td_fail(r->error, TIDES_BAD_FILE, "%s: line %zu: more values than the %zu that element %s has, from '%s' on",
                   r->file->path, r->line, r->element->properties, TD_PLY_QUOTE(r->element->name), TD_PLY_QUOTE(rest));
}

static tides_status read_ascii_rows(reader *r) {
    td_plain_numbers numbers;
    tides_status status = td_plain_begin(&numbers, r->file->path, r->error);
    if (status != TIDES_OK) return status;
    for (uint64_t row = 0; row < r->element->count && !status; row++) status = read_ascii_row(r, row);
    td_plain_end(&numbers);
    return status;
}

tides_status td_ply_rows_read(const td_ply_file *file, const td_ply_header *header, const td_ply_element *element,
                              const td_ply_column *columns, td_ply_cursor *cursor, tides_error *error) {
    if (element->properties == 0) return TIDES_OK; /* rows have no bytes, or are blank lines */
    tides_status status = td_ply_rows_fit(file, header, element, cursor, error);
    if (status) return status;
    reader r = {.file = file,
                .element = element,
                .properties = header->properties + element->first_property,
                .columns = columns,
                .format = header->format,
                .at = cursor->at,
                .line = cursor->line,
                .error = error};
    if (header->format == TD_PLY_ASCII) status = read_ascii_rows(&r);
    for (uint64_t row = 0; header->format != TD_PLY_ASCII && row < element->count && !status; row++)
        status = read_binary_row(&r, row);
    if (!status) *cursor = (td_ply_cursor){r.at, r.line};
    return status;
}
