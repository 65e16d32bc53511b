/* LZ4 frames (https://github.com/lz4/lz4/blob/dev/doc/lz4_Frame_format.md) and Zstandard, as AEDAT 4 packets use them. LZ4 is
 * a page of code, and needs no library. Checksums aren't verified: a damaged frame shows in the events' own structure. */
#include "td_aedat4.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>
#include <zstd.h>

/* ---- LZ4 ---- */

enum { FRAME_MAGIC = 0x184D2204, FLAG_DICTIONARY = 1, FLAG_CHECKSUM = 4, FLAG_SIZE = 8, FLAG_BLOCK_CHECKSUM = 16, STORED = 31 };

/* Bytes that are left, and what was unpacked so far. `out` grows with `capacity`. */
typedef struct lz4 {
    const unsigned char *at, *end;
    unsigned char **out;
    size_t *capacity, got, most;
    tides_error *error;
} lz4;

static tides_status damaged(const lz4 *z) { return td_fail(z->error, TIDES_BAD_FILE, "an LZ4 frame is damaged"); }

static tides_status make_room(lz4 *z, size_t bytes) {
    if (bytes > z->most - z->got) return damaged(z);
    return td_reserve((void **)z->out, z->capacity, z->got + bytes, 1, z->error);
}

/* A length whose first four bits are `nibble`: 15 goes on in bytes, of which 255 goes on. 0 at the end of the block. */
static int take_length(const unsigned char **at, const unsigned char *end, size_t nibble, size_t *length) {
    *length = nibble;
    if (nibble < 15) return 1;
    while (*at < end) {
        unsigned char more = *(*at)++;
        *length += more;
        if (more < 255) return 1;
    }
    return 0;
}

static tides_status copy_literals(lz4 *z, const unsigned char **at, const unsigned char *end, size_t length) {
    if (length > (size_t)(end - *at)) return damaged(z);
    tides_status status = make_room(z, length);
    if (status != TIDES_OK) return status;
    if (length) memcpy(*z->out + z->got, *at, length);
    z->got += length;
    *at += length;
    return TIDES_OK;
}

/* Byte by byte: what is copied may be what was just written. */
static tides_status copy_match(lz4 *z, size_t offset, size_t length) {
    if (offset == 0 || offset > z->got) return damaged(z);
    tides_status status = make_room(z, length);
    if (status != TIDES_OK) return status;
    unsigned char *to = *z->out + z->got;
    for (size_t i = 0; i < length; i++) to[i] = to[(ptrdiff_t)i - (ptrdiff_t)offset];
    z->got += length;
    return TIDES_OK;
}

/* Sequences of literals and a match; the last has no match. */
static tides_status unpack_block(lz4 *z, const unsigned char *at, const unsigned char *end) {
    while (at < end) {
        unsigned token = *at++;
        size_t length;
        if (!take_length(&at, end, token >> 4, &length)) return damaged(z);
        tides_status status = copy_literals(z, &at, end, length);
        if (status != TIDES_OK || at == end) return status;
        if (end - at < 2) return damaged(z);
        size_t offset = td_le16(at);
        at += 2;
        if (!take_length(&at, end, token & 15, &length)) return damaged(z);
        status = copy_match(z, offset, length + 4);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

static tides_status unpack_blocks(lz4 *z, int checksums) {
    for (;;) {
        if (z->end - z->at < 4) return damaged(z);
        uint32_t word = td_le32(z->at), bytes = word & ~(UINT32_C(1) << STORED);
        z->at += 4;
        if (word == 0) return TIDES_OK;
        if (bytes > (size_t)(z->end - z->at)) return damaged(z);
        const unsigned char *at = z->at;
        tides_status status = word >> STORED ? copy_literals(z, &at, at + bytes, bytes) : unpack_block(z, at, at + bytes);
        if (status != TIDES_OK) return status;
        z->at += bytes;
        if (!checksums) continue;
        if (z->end - z->at < 4) return damaged(z);
        z->at += 4;
    }
}

tides_status td_lz4_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                           size_t *got, tides_error *error) {
    lz4 z = {.at = data, .end = data + bytes, .out = out, .most = most, .error = error};
    z.capacity = capacity;
    if (bytes < 7 || td_le32(data) != FRAME_MAGIC || data[4] >> 6 != 1) return damaged(&z);
    unsigned flags = data[4];
    size_t header = 7 + (flags & FLAG_SIZE ? 8 : 0) + (flags & FLAG_DICTIONARY ? 4 : 0);
    if (bytes < header) return damaged(&z);
    z.at += header;
    tides_status status = unpack_blocks(&z, (flags & FLAG_BLOCK_CHECKSUM) != 0);
    *got = z.got;
    return status;
}

/* ---- Zstandard ---- */

tides_status td_zstd_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                            size_t *got, tides_error *error) {
    ZSTD_DCtx *context = ZSTD_createDCtx();
    if (!context) return td_fail(error, TIDES_NO_MEMORY, "out of memory: Zstandard");
    ZSTD_inBuffer input = {data, bytes, 0};
    tides_status status = TIDES_OK;
    size_t left = 1;
    *got = 0;
    while (left != 0 && status == TIDES_OK) {
        size_t room = *got + ZSTD_DStreamOutSize() < most ? *got + ZSTD_DStreamOutSize() : most;
        status = td_reserve((void **)out, capacity, room, 1, error);
        if (status != TIDES_OK) break;
        ZSTD_outBuffer output = {*out, room, *got};
        left = ZSTD_decompressStream(context, &output, &input);
        int stuck = output.pos == *got && input.pos == input.size;
        *got = output.pos;
        if (ZSTD_isError(left) || (left != 0 && (stuck || *got == most)))
            status = td_fail(error, TIDES_BAD_FILE, "a Zstandard frame is damaged");
    }
    ZSTD_freeDCtx(context);
    return status;
}
