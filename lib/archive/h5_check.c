/* Looks at heaps, trees and object headers of HDF5 files before HDF5 takes their numbers at their word, for h5_driver.c
 * (td_h5_check.h says why). The format's specification: https://docs.hdfgroup.org/hdf5/v1_10/_f_m_t3.html, II.A superblock,
 * III.A.1 trees, III.D local heaps, IV.A.1 object headers, IV.A.2 their messages. */
#include "td_h5_check.h"

#include "td_endian.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Reads `count` bytes at an address of the file; 0 where it can't. */
static int take(const td_h5_disk *disk, uint64_t address, void *out, size_t count) {
    if (address > disk->size - disk->base || count > disk->size - disk->base - address) return 0;
    return pread(disk->descriptor, out, count, (off_t)(disk->base + address)) == (ssize_t)count;
}

/* Checks the superblock. It lies at the file's beginning, or at 512, 1024, 2048 ... behind a user's own bytes. */
int td_h5_check_superblock(td_h5_disk *disk) {
    unsigned char p[16];
    disk->base = 0;
    for (uint64_t at = 0; at < disk->size; at = at ? 2 * at : 512) {
        if (!take(disk, at, p, sizeof p) || memcmp(p, "\x89HDF\r\n\x1a\n", 8) != 0) continue;
        disk->base = at;
        return p[8] < 2 ? p[13] == 8 && p[14] == 8 : p[9] == 8 && p[10] == 8;
    }
    return 0;
}

/* ---- local heaps: the names of a group's links ---- */

/* The free blocks: each begins with where the next one is (1: nowhere) and its own size. There are no more than fit. */
static int check_free_blocks(const unsigned char *data, uint64_t size, uint64_t at) {
    enum { BLOCK = 16 };
    for (uint64_t most = size / BLOCK; at != 1; most--) {
        if (most == 0 || size < BLOCK || at > size - BLOCK) return 0;
        uint64_t length = td_le64(data + at + 8);
        if (length < BLOCK || length > size - at) return 0;
        at = td_le64(data + at);
    }
    return 1;
}

int td_h5_check_heap(const td_h5_disk *disk, const unsigned char *bytes, size_t count) {
    enum { PREFIX = 32, MOST = 1 << 26 };                          /* the names of a group with a million links */
    if (count < PREFIX || memcmp(bytes, "HEAP", 4) != 0) return 1; /* the names; or HDF5 says what it is not */
    uint64_t size = td_le64(bytes + 8), at = td_le64(bytes + 24);
    unsigned char *data = size <= MOST ? malloc(size ? (size_t)size : 1) : NULL;
    int fine = data && take(disk, at, data, (size_t)size) && check_free_blocks(data, size, td_le64(bytes + 16));
    free(data);
    return fine;
}

/* ---- trees: the links of a group, the chunks of a dataset ---- */

/* Bytes of a key; 0 where it can't be told. A chunk's key has as many offsets as the dataset has dimensions. The node doesn't
 * tell their number: it follows from its size, and from the number of children that nodes have room for. */
static size_t key_bytes(int chunks, size_t count) {
    enum { HEAD = 24, ADDRESS = 8, GROUP_KEY = 8, CHILDREN = 64 /* HDF5's default, which nothing changes */ };
    if (!chunks) return GROUP_KEY;
    size_t keys = count > HEAD + CHILDREN * ADDRESS ? count - HEAD - CHILDREN * ADDRESS : 0;
    return keys % (CHILDREN + 1) == 0 ? keys / (CHILDREN + 1) : 0;
}

/* Children are one level below, so that no node is its own descendant. */
int td_h5_check_tree(const td_h5_disk *disk, const unsigned char *bytes, size_t count) {
    enum { HEAD = 24, ADDRESS = 8 };
    if (count < HEAD || memcmp(bytes, "TREE", 4) != 0) return 1;
    int level = bytes[5];
    size_t key = key_bytes(bytes[4] != 0, count), children = (size_t)td_le16(bytes + 6);
    if (level == 0 || key == 0) return 1;
    for (size_t i = 0, at = HEAD + key; i < children; i++, at += ADDRESS + key) {
        unsigned char child[6];
        if (count < ADDRESS || at > count - ADDRESS) return 0;
        if (!take(disk, td_le_number(bytes + at, ADDRESS), child, sizeof child) || memcmp(child, "TREE", 4) != 0) return 0;
        if (child[4] != bytes[4] || child[5] != level - 1) return 0;
    }
    return 1;
}

/* ---- object headers: the types of numbers, the chunks of a dataset ---- */

/* A whole number's bits lie within its bytes: HDF5 converts it bit by bit, wherever that is. */
static int check_type(const unsigned char *message, size_t count) {
    enum { LENGTH = 12, WHOLE = 0, BITFIELD = 4 };
    if (count < LENGTH || ((message[0] & 15) != WHOLE && (message[0] & 15) != BITFIELD)) return 1;
    const uint64_t bits = 8 * td_le_number(message + 4, 4), offset = td_le16(message + 8), precision = td_le16(message + 10);
    return precision > 0 && offset + precision <= bits;
}

/* A chunk has some of every dimension, of which a value's bytes are the last: HDF5 divides by them. */
static int check_layout(const unsigned char *message, size_t count) {
    enum { VERSION = 3, CHUNKED = 2, HEAD = 11, EACH = 4, LEAST = 2 };
    if (count < HEAD || message[0] != VERSION || message[1] != CHUNKED) return 1;
    const size_t dimensions = message[2];
    if (dimensions < LEAST || dimensions > (count - HEAD) / EACH) return 0;
    for (size_t k = 0; k < dimensions; k++)
        if (td_le_number(message + HEAD + k * EACH, EACH) == 0) return 0;
    return 1;
}

/* The types and layouts that a header holds itself. */
static int check_message(int kind, int flags, const unsigned char *message, size_t length) {
    enum { SHARED = 2, TYPE = 3, LAYOUT = 8 };
    if (flags & SHARED) return 1;
    return kind == TYPE ? check_type(message, length) : kind != LAYOUT || check_layout(message, length);
}

static int check_messages(const unsigned char *bytes, size_t count, size_t at) {
    enum { HEAD = 8 };
    while (at <= count && count - at >= HEAD) {
        const unsigned char *message = bytes + at;
        const size_t length = (size_t)td_le16(message + 2);
        if (length > count - at - HEAD) return 1; /* HDF5 reads all of it next, or says that it ends too soon */
        if (!check_message((int)td_le16(message), message[4], message + HEAD, length)) return 0;
        at += HEAD + length;
    }
    return 1;
}

/* Version 2 has a checksum, so that damage by chance is told; what was made to do harm has the right one. A block that
 * continues such a header (OCHK) doesn't tell the length of its messages' heads. */
static int check_header_2(const unsigned char *bytes, size_t count) {
    enum { FLAGS = 5, PREFIX = 6, TIMES = 16, PHASES = 4, ORDER = 2 };
    if (count < PREFIX || bytes[4] != 2) return 1;
    const int flags = bytes[FLAGS];
    const size_t wide = (size_t)1 << (flags & 3), head = 4 + (flags & 4 ? ORDER : 0);
    size_t at = PREFIX + (flags & 32 ? TIMES : 0) + (flags & 16 ? PHASES : 0);
    if (count < at + wide) return 1;
    const uint64_t size = td_le_number(bytes + at, wide);
    at += wide;
    const size_t end = size < count - at ? at + (size_t)size : count;
    while (end - at >= head) {
        const unsigned char *message = bytes + at;
        const size_t length = (size_t)td_le16(message + 1);
        if (length > end - at - head) return 1;
        if (!check_message(message[0], message[3], message + head, length)) return 0;
        at += head + length;
    }
    return 1;
}

/* Checks an object header of version 1, and leaves one of version 2 to check_header_2. A block that continues a header has
 * messages only. Where such a block begins with a dataspace it looks like a header, but for the dataspace's version, 1 or 2, in
 * place of a size in eights. HDF5 reads further than a header goes: bytes behind it belong to something else. */
int td_h5_check_header(const unsigned char *bytes, size_t count) {
    enum { PREFIX = 16, SIZE = 8 };
    if (count >= 4 && memcmp(bytes, "OHDR", 4) == 0) return check_header_2(bytes, count);
    if (count < PREFIX || memcmp(bytes, "OCHK", 4) == 0) return 1;
    const uint64_t size = td_le_number(bytes + SIZE, 4);
    if (bytes[0] != 1 || bytes[1] != 0 || size % 8 != 0) return check_messages(bytes, count, 0);
    return check_messages(bytes, size < count - PREFIX ? PREFIX + (size_t)size : count, PREFIX);
}
