/* Finds an attribute in the object header of an HDF5 file, and its text in a global heap, by the format's specification
 * (https://docs.hdfgroup.org/hdf5/v1_10/_f_m_t3.html: IV.A object headers, IV.A.2.m attributes, III.E global heaps). */
#include "td_h5_text.h"

#include "td_endian.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    MESSAGE_CONTINUATION = 0x10,
    MESSAGE_ATTRIBUTE = 0x0c,
    HEADER_MAX = 1 << 20, /* bytes of one block of an object header; HDF5 writes a few kB, 64 kB for one long attribute */
    BLOCKS_MAX = 256,     /* blocks of one object header; a damaged file may chain them in a circle */
    HEAP_MAX = 64 << 20   /* bytes of a heap; HDF5 makes them of 4 kB, or as long as one text */
};

/* ---- bytes ---- */

/* An open HDF5 file as bytes, on the disk or in memory. */
typedef struct file_bytes {
    int descriptor;              /* -1: in memory */
    const unsigned char *memory; /* NULL: on the disk */
    uint64_t size;
} file_bytes;

static int find_bytes(hid_t file, file_bytes *bytes) {
    hid_t access = H5Fget_access_plist(file), driver = access < 0 ? -1 : H5Pget_driver(access);
    void *handle = NULL;
    struct stat facts;
    hsize_t size = 0;
    int done = driver >= 0 && H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 && handle;
    *bytes = (file_bytes){.descriptor = -1};
    if (done && driver == H5FD_CORE) {
        bytes->memory = *(const unsigned char *const *)handle;
        done = H5Fget_filesize(file, &size) >= 0;
        bytes->size = size;
    } else if (done) {
        bytes->descriptor = *(const int *)handle; /* HDF5's own driver and ours both return a pointer to the descriptor */
        done = fstat(bytes->descriptor, &facts) == 0;
        bytes->size = done ? (uint64_t)facts.st_size : 0;
    }
    if (access >= 0) H5Pclose(access);
    return done;
}

/* Copies `size` bytes from `at`, which the caller frees; NULL if the file ends before that. */
static unsigned char *take(const file_bytes *bytes, uint64_t at, uint64_t size) {
    if (at > bytes->size || size > bytes->size - at) return NULL;
    unsigned char *copy = malloc(size ? (size_t)size : 1);
    if (copy && bytes->memory)
        memcpy(copy, bytes->memory + at, (size_t)size);
    else if (copy && pread(bytes->descriptor, copy, (size_t)size, (off_t)at) != (ssize_t)size) {
        free(copy);
        copy = NULL;
    }
    return copy;
}

/* ---- the heap ---- */

/* The text in object `index` of the heap at `address`. */
static char *text_in_heap(const file_bytes *bytes, uint64_t address, uint64_t index, uint64_t length) {
    enum { HEAD = 16, OBJECT = 16 }; /* bytes of a heap's head, and of an object's */
    unsigned char *head = take(bytes, address, HEAD), *heap = NULL;
    uint64_t size = head && memcmp(head, "GCOL\1", 5) == 0 ? td_le64(head + 8) : 0;
    free(head);
    if (size > HEAD && size <= HEAP_MAX) heap = take(bytes, address, size);
    char *text = NULL;
    for (uint64_t at = HEAD; heap && size - at >= OBJECT;) {
        const unsigned char *object = heap + at;
        uint64_t stored = td_le64(object + 8), room = size - at - OBJECT;
        if (td_le16(object) == 0 || stored > room) break; /* object 0 is the free space, and is last */
        if (td_le16(object) == index) {
            text = stored >= length ? calloc((size_t)length + 1, 1) : NULL;
            if (text) memcpy(text, object + OBJECT, (size_t)length);
            break;
        }
        at += OBJECT + (stored + 7) / 8 * 8;
        if (at > size) break;
    }
    free(heap);
    return text;
}

/* ---- the attribute ---- */

typedef struct search {
    const file_bytes *bytes;
    const char *name;
    size_t most; /* longest text that is read [bytes] */
    int found;   /* 1: the attribute was found, even if its text couldn't be read */
    char *text;
} search;

static uint64_t padded(uint64_t size, int version) { return version == 1 ? (size + 7) / 8 * 8 : size; }

/* Parses an attribute's message: a head, then name, type, extent and value. Sets `text` if the name is the wanted one. */
static void look_at_attribute(search *s, const unsigned char *p, uint64_t size) {
    enum { LENGTH = 4, ADDRESS = 8, INDEX = 4, VLEN = 9, STRING = 1 }; /* bytes of the value's three numbers; class and kind */
    int version = size >= 9 ? p[0] : 0;
    if (version < 1 || version > 3 || (version > 1 && p[1] != 0)) return; /* shared types (versions 2 and 3) aren't followed */
    uint64_t name = td_le16(p + 2), type = td_le_number(p + 4, 2), extent = td_le_number(p + 6, 2), head = version == 3 ? 9 : 8;
    uint64_t type_at = head + padded(name, version), value_at = type_at + padded(type, version) + padded(extent, version);
    if (name != strlen(s->name) + 1 || value_at > size || memcmp(p + head, s->name, (size_t)name) != 0) return;
    s->found = 1;
    if (type < 8 || (p[type_at] & 15) != VLEN || (p[type_at + 1] & 15) != STRING) return;
    if (size - value_at < LENGTH + ADDRESS + INDEX) return;
    const unsigned char *value = p + value_at;
    uint64_t length = td_le_number(value, LENGTH);
    if (length <= s->most)
        s->text = length ? text_in_heap(s->bytes, td_le_number(value + LENGTH, ADDRESS),
                                        td_le_number(value + LENGTH + ADDRESS, INDEX), length)
                         : calloc(1, 1);
}

/* ---- the object header ---- */

typedef struct block {
    uint64_t at, size;
} block;

typedef struct header {
    int version, tracked; /* tracked: version 2 stores the order of creation with each message */
    block blocks[BLOCKS_MAX];
    int count;
} header;

static void add_block(header *h, uint64_t at, uint64_t size) {
    if (h->count < BLOCKS_MAX && size <= HEADER_MAX) h->blocks[h->count++] = (block){at, size};
}

/* Looks through the messages of one block. */
static void look_at_block(search *s, header *h, const unsigned char *p, uint64_t size) {
    uint64_t head = h->version == 1 ? 8 : 4 + 2 * (uint64_t)h->tracked;
    for (uint64_t at = 0; !s->found && size - at >= head;) {
        const unsigned char *m = p + at;
        uint64_t type = td_le_number(m, h->version == 1 ? 2 : 1), bytes = td_le_number(m + (h->version == 1 ? 2 : 1), 2);
        int shared = (h->version == 1 ? m[4] : m[3]) & 2;
        if (bytes > size - at - head) return;
        if (type == MESSAGE_CONTINUATION && bytes >= 16) add_block(h, td_le64(m + head), td_le64(m + head + 8));
        if (type == MESSAGE_ATTRIBUTE && !shared) look_at_attribute(s, m + head, bytes);
        at += head + bytes;
    }
}

/* Finds where the messages of the object at `at` begin. */
static int begin(const file_bytes *bytes, uint64_t at, header *h) {
    enum { PROLOGUE = 16, TIMES = 16, PHASES = 4 }; /* bytes of a header's parts */
    unsigned char *p = take(bytes, at, PROLOGUE);
    h->count = 0;
    h->version = p && p[0] == 1 ? 1 : p && memcmp(p, "OHDR\2", 5) == 0 ? 2 : 0;
    if (h->version == 1) add_block(h, at + PROLOGUE, td_le_number(p + 8, 4));
    int flags = h->version == 2 ? p[5] : 0, width = 1 << (flags & 3);
    free(p);
    if (h->version == 2) {
        uint64_t first = 6 + (flags & 0x20 ? TIMES : 0) + (flags & 0x10 ? PHASES : 0);
        h->tracked = (flags & 4) != 0;
        if ((p = take(bytes, at + first, (uint64_t)width))) add_block(h, at + first + (uint64_t)width, td_le_number(p, width));
        free(p);
    }
    return h->count == 1;
}

static void look_at_object(search *s, uint64_t at) {
    header h = {0};
    if (!begin(s->bytes, at, &h)) return;
    for (int i = 0; i < h.count && !s->found; i++) {
        const block *b = &h.blocks[i];
        unsigned char *p = take(s->bytes, b->at, b->size);
        int framed = h.version == 2 && i > 0; /* begins with "OCHK" and ends with a checksum */
        if (p && !framed) look_at_block(s, &h, p, b->size);
        if (p && framed && b->size >= 8 && memcmp(p, "OCHK", 4) == 0) look_at_block(s, &h, p + 4, b->size - 8);
        free(p);
    }
}

/* ---- all of it ---- */

/* 1 if the file begins at byte 0. A user's own bytes may stand before it; then addresses count from their end. */
static int is_plain(hid_t file) {
    hid_t creation = H5Fget_create_plist(file);
    hsize_t block_before = 1;
    size_t address = 0, length = 0;
    int plain = creation >= 0 && H5Pget_userblock(creation, &block_before) >= 0 && block_before == 0 &&
                H5Pget_sizes(creation, &address, &length) >= 0 && address == 8 && length == 8;
    if (creation >= 0) H5Pclose(creation);
    return plain;
}

char *td_h5_free_text(hid_t object, const char *name, size_t most) {
    H5O_info_t info;
    file_bytes bytes;
    search s = {.bytes = &bytes, .name = name, .most = most};
    hid_t file = H5Iget_file_id(object);
    int ready = file >= 0 && is_plain(file) && find_bytes(file, &bytes) && H5Oget_info2(object, &info, H5O_INFO_BASIC) >= 0;
    if (ready) look_at_object(&s, info.addr);
    if (file >= 0) H5Fclose(file);
    return s.text;
}
