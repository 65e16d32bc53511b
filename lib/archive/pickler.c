/* Writes pickles, which are programs for a small stack machine (Python's Lib/pickletools.py). A program pushes values, '('
 * marks where a collection's items begin, and an instruction of one letter takes them all. An array is a call:
 * numpy.ndarray(shape, dtype, bytes). */
#include "archive/td_pickler.h"

#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

static void put(td_pickler *p, const void *bytes, size_t size) {
    void *all = p->bytes;
    if (p->status == TIDES_OK) p->status = td_reserve(&all, &p->room, p->size + size, 1, p->error);
    p->bytes = all;
    if (p->status != TIDES_OK || size == 0) return;
    memcpy(p->bytes + p->size, bytes, size);
    p->size += size;
}

static void op(td_pickler *p, const char *letters) { put(p, letters, strlen(letters)); }

/* Writes a length or an integer, little-endian. */
static void count(td_pickler *p, uint64_t value, int bytes) {
    unsigned char out[8];
    for (int i = 0; i < bytes; i++) out[i] = (unsigned char)(value >> 8 * i & 255);
    put(p, out, (size_t)bytes);
}

void td_pickler_begin(td_pickler *p, tides_error *error) {
    *p = (td_pickler){.status = TIDES_OK, .error = error};
    op(p, "\x80\x05" /* protocol */ "cnumpy\narray\n" /* the function */ "(");
}

void td_pickler_dict(td_pickler *p) { op(p, "}("); }
void td_pickler_dict_end(td_pickler *p) { op(p, "u"); }
void td_pickler_list(td_pickler *p) { op(p, "]("); }
void td_pickler_list_end(td_pickler *p) { op(p, "e"); }

void td_pickler_text(td_pickler *p, const char *text) {
    op(p, "X");
    count(p, strlen(text), 4);
    op(p, text);
}

void td_pickler_integer(td_pickler *p, int32_t value) {
    op(p, "J");
    count(p, (uint32_t)value, 4);
}

/* Floats are big-endian, unlike all other numbers of a pickle. */
void td_pickler_number(td_pickler *p, double value) {
    uint64_t bits;
    unsigned char out[9] = {'G'};
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++) out[1 + i] = (unsigned char)(bits >> (56 - 8 * i) & 255);
    put(p, out, sizeof out);
}

void td_pickler_array(td_pickler *p, const char *dtype, size_t item, int ndim, const size_t *shape, const void *values) {
    size_t size = item;
    op(p, "cnumpy\nndarray\n((");
    for (int d = 0; d < ndim; d++) {
        td_pickler_integer(p, (int32_t)shape[d]);
        size *= shape[d];
    }
    op(p, "t");
    td_pickler_text(p, dtype);
    op(p, "\x96" /* a byte array */);
    count(p, size, 8);
    put(p, values, size);
    op(p, "tR");
}

void td_pickler_drop(td_pickler *p) {
    free(p->bytes);
    *p = (td_pickler){.bytes = NULL};
}

tides_status td_pickler_end(td_pickler *p, td_npy_writer *npy, const char *name) {
    td_pickler_text(p, "O");
    op(p, "tR.");
    tides_status status = p->status;
    if (status == TIDES_OK)
        status = td_npy_writer_put(npy, &(td_npy_form){name, "'|O'", p->size, 0, NULL}, p->bytes, 1, p->error);
    td_pickler_drop(p);
    return status;
}
