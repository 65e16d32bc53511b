/* Checks heaps, trees and object headers of an HDF5 file before HDF5 reads them. HDF5 1.10 trusts the numbers in them, and
 * a damaged file makes it crash or hang. Specification: https://docs.hdfgroup.org/hdf5/v1_10/_f_m_t3.html, II.A superblock,
 * III.A.1 trees, III.D local heaps, IV.A.1 object headers, IV.A.2 their messages. */
#include "td_h5_check.h"

#include "td_endian.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Reads `count` bytes at an address of the file; 0 on failure. */
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

/* Follows the list of free blocks: each begins with the offset of the next one (1: none) and its own size. A list with more
 * blocks than fit has a circle: damaged. */
static int check_free_blocks(const unsigned char *data, uint64_t size, uint64_t at) {
    enum { BLOCK = 16 }; /* bytes of the two numbers at a block's beginning */
    for (uint64_t most = size / BLOCK; at != 1; most--) {
        if (most == 0 || size < BLOCK || at > size - BLOCK) return 0;
        uint64_t length = td_le64(data + at + 8);
        if (length < BLOCK || length > size - at) return 0;
        at = td_le64(data + at);
    }
    return 1;
}

int td_h5_check_heap(const td_h5_disk *disk, const unsigned char *bytes, size_t count) {
    enum { PREFIX = 32, MOST = 1 << 26 };                          /* MOST: the names of a million links */
    if (count < PREFIX || memcmp(bytes, "HEAP", 4) != 0) return 1; /* not whole, or no heap: HDF5's own check reports it */
    uint64_t size = td_le64(bytes + 8), at = td_le64(bytes + 24);
    unsigned char *data = size <= MOST ? malloc(size ? (size_t)size : 1) : NULL;
    int fine = data && take(disk, at, data, (size_t)size) && check_free_blocks(data, size, td_le64(bytes + 16));
    free(data);
    return fine;
}

/* ---- trees: the links of a group, the chunks of a dataset ---- */

/* Size of a key in a node of `count` bytes; 0 if unknown. A chunk's key has one offset for each dimension, whose number
 * follows from the node's size, and from the number of children that a node has room for. */
static size_t key_bytes(int chunks, size_t count) {
    enum { HEAD = 24, ADDRESS = 8, GROUP_KEY = 8, CHILDREN = 64 /* HDF5's default, which nothing changes */ };
    if (!chunks) return GROUP_KEY;
    size_t keys = count > HEAD + CHILDREN * ADDRESS ? count - HEAD - CHILDREN * ADDRESS : 0;
    return keys % (CHILDREN + 1) == 0 ? keys / (CHILDREN + 1) : 0;
}

/* A child's level must be one lower, so that no node is its own descendant and HDF5's recursion ends. */
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

/* The bits of a whole number must lie within its bytes: HDF5 converts bit by bit, without a check of its own. */
static int check_type(const unsigned char *message, size_t count) {
    enum { LENGTH = 12, WHOLE = 0, BITFIELD = 4 }; /* bytes of such a type; classes of types */
    if (count < LENGTH || ((message[0] & 15) != WHOLE && (message[0] & 15) != BITFIELD)) return 1;
    const uint64_t bits = 8 * td_le_number(message + 4, 4), offset = td_le16(message + 8), precision = td_le16(message + 10);
    return precision > 0 && offset + precision <= bits;
}

/* No extent of a chunk, nor its last number (the bytes of a value), may be 0: HDF5 divides by them. */
static int check_layout(const unsigned char *message, size_t count) {
    /* HEAD, EACH: bytes before the extents, and of an extent. LEAST: a dimension, and the bytes of a value. */
    enum { VERSION = 3, CHUNKED = 2, HEAD = 11, EACH = 4, LEAST = 2 };
    if (count < HEAD || message[0] != VERSION || message[1] != CHUNKED) return 1;
    const size_t dimensions = message[2];
    if (dimensions < LEAST || dimensions > (count - HEAD) / EACH) return 0;
    for (size_t k = 0; k < dimensions; k++)
        if (td_le_number(message + HEAD + k * EACH, EACH) == 0) return 0;
    return 1;
}

/* Checks a message that holds a type or a layout itself. */
static int check_message(int kind, int flags, const unsigned char *message, size_t length) {
    enum { SHARED = 2, TYPE = 3, LAYOUT = 8 }; /* a flag; kinds of messages */
    if (flags & SHARED) return 1;
    return kind == TYPE ? check_type(message, length) : kind != LAYOUT || check_layout(message, length);
}

static int check_messages(const unsigned char *bytes, size_t count, size_t at) {
    enum { HEAD = 8 }; /* bytes before a message's own */
    while (at <= count && count - at >= HEAD) {
        const unsigned char *message = bytes + at;
        const size_t length = (size_t)td_le16(message + 2);
        if (length > count - at - HEAD) return 1; /* damaged or in the next block: HDF5 checks this itself */
        if (!check_message((int)td_le16(message), message[4], message + HEAD, length)) return 0;
        at += HEAD + length;
    }
    return 1;
}

/* A header of version 2 has a checksum, which finds damage by chance, but not a file made to do harm. A block that
 * continues such a header (OCHK) isn't checked: the length of its messages' heads isn't stored in it. */
static int check_header_2(const unsigned char *bytes, size_t count) {
    enum { FLAGS = 5, PREFIX = 6, TIMES = 16, PHASES = 4, ORDER = 2 }; /* position of the flags; bytes of the other parts */
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

/* Checks an object header of version 1 or 2. A block that continues a header of version 1 has messages only. If its first
 * message is a dataspace, it looks like a header. But where a header has its size, a multiple of eight, such a block has the
 * dataspace's version, 1 or 2. HDF5 may read past a header's end: those bytes belong to something else. */
int td_h5_check_header(const unsigned char *bytes, size_t count) {
    enum { PREFIX = 16, SIZE = 8 }; /* bytes of a version 1 header before its messages; position of the size */
    if (count >= 4 && memcmp(bytes, "OHDR", 4) == 0) return check_header_2(bytes, count);
    if (count < PREFIX || memcmp(bytes, "OCHK", 4) == 0) return 1;
    const uint64_t size = td_le_number(bytes + SIZE, 4);
    if (bytes[0] != 1 || bytes[1] != 0 || size % 8 != 0) return check_messages(bytes, count, 0);
    return check_messages(bytes, size < count - PREFIX ? PREFIX + (size_t)size : count, PREFIX);
}
