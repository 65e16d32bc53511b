/* Writes .npy and .npz files as a stream. The number of rows is known only at the end: room is left for it in the array's
 * header and the archive's records, which are then completed. */
#include "archive/td_npy.h"
#include "td_base.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { LOCAL_BYTES = 30, HEADER_MAX = 8192, COUNT_DIGITS = 20, ALIGNMENT = 64 /* numpy's own */ };

typedef struct member {
    char *name; /* with ".npy" */
    uint64_t offset, size;
    uint32_t crc;
} member;

struct td_npy_writer {
    FILE *file;
    char *path, *part;
    int zipped, is_open; /* an array was begun and not yet ended */
    uint64_t at;         /* bytes written so far */
    member *members;
    size_t count, capacity;
    char *dtype;
    int ndim;
    size_t inner[TD_NPY_DIMENSIONS_MAX], row_bytes, header_bytes;
    uint64_t rows, start; /* start: position of the array's header */
    uint32_t crc;         /* checksum of the rows */
};

static tides_status put(td_npy_writer *w, const void *bytes, size_t size, tides_error *error) {
    if (w->zipped && size > UINT32_MAX - w->at)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: an .npz of 4 GiB or more isn't written: write .npy files instead",
                       w->path);
    if (fwrite(bytes, 1, size, w->file) != size)
        return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", w->part, strerror(errno));
    w->at += size;
    return TIDES_OK;
}

/* Overwrites bytes at `at`, then returns to the end of the file. */
static tides_status put_at(td_npy_writer *w, uint64_t at, const void *bytes, size_t size, tides_error *error) {
    if (fseeko(w->file, (off_t)at, SEEK_SET) == 0 && fwrite(bytes, 1, size, w->file) == size &&
        fseeko(w->file, 0, SEEK_END) == 0)
        return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", w->part, strerror(errno));
}

static void free_writer(td_npy_writer *w) {
    for (size_t i = 0; i < w->count; i++) free(w->members[i].name);
    free(w->members);
    free(w->dtype);
    free(w->part);
    free(w->path);
    free(w);
}

tides_status td_npy_writer_open(const char *path, int zipped, td_npy_writer **writer, tides_error *error) {
    td_npy_writer *w = td_alloc(1, sizeof *w, error);
    if (!w) return TIDES_NO_MEMORY;
    w->zipped = zipped;
    tides_status status = (w->path = td_strdup(path, error)) ? td_part_name(path, 0, &w->part, error) : TIDES_NO_MEMORY;
    if (!status && !(w->file = td_part_open(w->part, w->path)))
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", w->part, strerror(errno));
    if (status)
        free_writer(w);
    else
        *writer = w;
    return status;
}

/* -- the array's header -- */

/* Writes the shape as "(12, 3)", "(12,)" or "()"; `rows` is the first extent. */
static size_t write_shape(const td_npy_writer *w, uint64_t rows, char *text, size_t room) {
    if (w->ndim == 0) return (size_t)snprintf(text, room, "()");
    size_t used = (size_t)snprintf(text, room, "(%llu,", (unsigned long long)rows);
    for (int d = 1; d < w->ndim; d++)
        used += (size_t)snprintf(text + used, room - used, "%s%zu", d > 1 ? ", " : " ", w->inner[d]);
    return used + (size_t)snprintf(text + used, room - used, ")");
}

/* Writes a .npy header of exactly `bytes` bytes: magic, version 1.0, length, dict, padding, line end. */
static void write_header(const td_npy_writer *w, char header[HEADER_MAX], size_t bytes) {
    static const char magic[8] = {'\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0};
    char shape[256];
    write_shape(w, w->rows, shape, sizeof shape);
    memset(header, ' ', bytes);
    memcpy(header, magic, sizeof magic);
    header[8] = (char)((bytes - 10) & 255);
    header[9] = (char)((bytes - 10) >> 8);
    int length =
        snprintf(header + 10, HEADER_MAX - 10, "{'descr': %s, 'fortran_order': False, 'shape': %s, }", w->dtype, shape);
    header[10 + length] = ' '; /* overwrites snprintf's NUL */
    header[bytes - 1] = '\n';
}

/* Size of the header, which has room for any number of rows. */
static size_t header_room(const td_npy_writer *w) {
    char shape[256];
    size_t dict = strlen("{'descr': , 'fortran_order': False, 'shape': , }") + strlen(w->dtype) +
                  write_shape(w, 0, shape, sizeof shape) + COUNT_DIGITS;
    return (10 + dict + 1 + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* -- the archive's records -- */

static unsigned char *number(unsigned char *out, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++, value >>= 8) *out++ = (unsigned char)(value & 255);
    return out;
}

/* Writes the 26 bytes that local and central records share, from "version needed" to the lengths. Members are stored, not
 * deflated. Their date is 1980-01-01, the format's first day, so that equal arrays give equal files. */
static unsigned char *member_facts(unsigned char *out, const member *m) {
    out = number(out, 20, 2);
    out = number(out, 0, 4); /* flags, method */
    out = number(out, 0x00210000, 4);
    out = number(out, m->crc, 4);
    out = number(out, m->size, 4);
    out = number(out, m->size, 4);
    out = number(out, strlen(m->name), 2);
    return number(out, 0, 2);
}

static tides_status put_local(td_npy_writer *w, const member *m, tides_error *error) {
    unsigned char record[LOCAL_BYTES] = "PK\3\4";
    member_facts(record + 4, m);
    tides_status status = put(w, record, sizeof record, error);
    return status ? status : put(w, m->name, strlen(m->name), error);
}

static tides_status put_directory(td_npy_writer *w, tides_error *error) {
    uint64_t start = w->at;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < w->count && !status; i++) {
        unsigned char record[46] = "PK\1\2";
        unsigned char *out = member_facts(number(record + 4, 20, 2), &w->members[i]);
        number(number(out, 0, 10), w->members[i].offset, 4); /* no comment, first disk, attributes */
        status = put(w, record, sizeof record, error);
        if (!status) status = put(w, w->members[i].name, strlen(w->members[i].name), error);
    }
    unsigned char end[22] = "PK\5\6";
    unsigned char *out = number(end + 4, 0, 4);
    out = number(number(out, w->count, 2), w->count, 2);
    number(number(number(out, w->at - start, 4), start, 4), 0, 2);
    return status ? status : put(w, end, sizeof end, error);
}

/* -- arrays -- */

static tides_status end_array(td_npy_writer *w, tides_error *error) {
    if (!w->is_open) return TIDES_OK;
    w->is_open = 0;
    if (w->ndim == 0 && w->rows != 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: a scalar was begun, and %llu elements came", w->path,
                       (unsigned long long)w->rows);
    char header[HEADER_MAX];
    write_header(w, header, w->header_bytes);
    tides_status status = put_at(w, w->start, header, w->header_bytes, error);
    if (status || !w->zipped) return status;
    member *m = &w->members[w->count - 1];
    uint64_t data_bytes = w->at - w->start - w->header_bytes;
    uint32_t crc = (uint32_t)crc32(0, (const unsigned char *)header, (uInt)w->header_bytes);
    m->crc = (uint32_t)crc32_combine(crc, w->crc, (z_off_t)data_bytes);
    m->size = w->at - w->start;
    unsigned char record[LOCAL_BYTES] = "PK\3\4";
    member_facts(record + 4, m);
    return put_at(w, m->offset, record, sizeof record, error);
}

static tides_status add_member(td_npy_writer *w, const char *name, tides_error *error) {
    if (!w->zipped && w->count)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: an .npy holds one array: there is no place for %s", w->path, name);
    if (w->count == UINT16_MAX - 1 || strlen(name) > 1000)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: %.40s: too many arrays, or too long a name", w->path, name);
    void *members = w->members;
    tides_status status = td_reserve(&members, &w->capacity, w->count + 1, sizeof *w->members, error);
    w->members = members;
    if (status) return status;
    w->members[w->count] = (member){.name = td_format(error, "%s.npy", name), .offset = w->at};
    if (!w->members[w->count].name) return TIDES_NO_MEMORY;
    w->count++;
    return w->zipped ? put_local(w, &w->members[w->count - 1], error) : TIDES_OK;
}

/* Takes over dtype and shape; TIDES_BAD_ARGUMENT if they are invalid. */
static tides_status set_form(td_npy_writer *w, const td_npy_form *form, tides_error *error) {
    const int ndim = form->ndim;
    if (ndim < 0 || ndim > TD_NPY_DIMENSIONS_MAX || form->item == 0 || strlen(form->dtype) > HEADER_MAX - 1024)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: an array of %d dimensions and elements of %zu bytes can't be written",
                       w->path, ndim, form->item);
    free(w->dtype);
    if (!(w->dtype = td_strdup(form->dtype, error))) return TIDES_NO_MEMORY;
    w->ndim = ndim;
    w->row_bytes = form->item;
    for (int d = 1; d < ndim; d++) {
        w->inner[d] = form->inner[d - 1];
        if (w->inner[d] && w->row_bytes > SIZE_MAX / w->inner[d])
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: a row has more bytes than memory could", w->path);
        w->row_bytes *= w->inner[d];
    }
    return TIDES_OK;
}

tides_status td_npy_writer_begin(td_npy_writer *writer, const td_npy_form *form, tides_error *error) {
    tides_status status = end_array(writer, error);
    if (!status) status = set_form(writer, form, error);
    if (!status) status = add_member(writer, form->name, error);
    if (status) return status;
    char header[HEADER_MAX];
    writer->rows = 0;
    writer->crc = (uint32_t)crc32(0, NULL, 0);
    writer->start = writer->at;
    writer->header_bytes = header_room(writer);
    writer->is_open = 1;
    write_header(writer, header, writer->header_bytes);
    return put(writer, header, writer->header_bytes, error);
}

tides_status td_npy_writer_append(td_npy_writer *writer, const void *rows, size_t count, tides_error *error) {
    if (!writer->is_open) return td_fail(error, TIDES_BAD_ARGUMENT, "%s: rows came before an array was begun", writer->path);
    if (writer->row_bytes && count > SIZE_MAX / writer->row_bytes)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: %zu rows have more bytes than memory could", writer->path, count);
    size_t bytes = count * writer->row_bytes;
    tides_status status = bytes ? put(writer, rows, bytes, error) : TIDES_OK;
    if (status) return status;
    if (writer->zipped && bytes)
        writer->crc = (uint32_t)crc32(writer->crc, rows, (uInt)bytes); /* fits: `put` refuses 4 GiB and more */
    writer->rows += count;
    return TIDES_OK;
}

tides_status td_npy_writer_put(td_npy_writer *writer, const td_npy_form *form, const void *rows, size_t count,
                               tides_error *error) {
    const tides_status status = td_npy_writer_begin(writer, form, error);
    return status == TIDES_OK ? td_npy_writer_append(writer, rows, count, error) : status;
}

tides_status td_npy_writer_close(td_npy_writer *writer, tides_error *error) {
    tides_status status = end_array(writer, error);
    if (!status && !writer->zipped && !writer->count)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: an .npy holds one array, and none was begun", writer->path);
    if (!status && writer->zipped) status = put_directory(writer, error);
    int closed = fclose(writer->file);
    writer->file = NULL;
    if (!status && closed != 0)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", writer->part, strerror(errno));
    if (!status) status = td_commit_file(writer->part, writer->path, error);
    if (status) td_remove_part(writer->part, writer->path);
    free_writer(writer);
    return status;
}

void td_npy_writer_discard(td_npy_writer *writer) {
    if (!writer) return;
    fclose(writer->file);
    td_remove_part(writer->part, writer->path);
    free_writer(writer);
}

tides_status td_npy_writer_end(td_npy_writer *writer, tides_status status, tides_error *error) {
    if (status == TIDES_OK) return td_npy_writer_close(writer, error);
    td_npy_writer_discard(writer);
    return status;
}
