/* ZIP reading: end record, central directory, local header, inflate (PKWARE APPNOTE 4.3; no ZIP64, no encryption). */
#include "zip.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { END_BYTES = 22, CENTRAL_BYTES = 46, LOCAL_BYTES = 30, COMMENT_MAX = 65535 };

static uint32_t u16(const unsigned char *p) { return (uint32_t)p[0] | (uint32_t)p[1] << 8; }
static uint32_t u32(const unsigned char *p) { return u16(p) | u16(p + 2) << 16; }

/* Position of the end-of-central-directory record, or `bytes`: it is searched backwards, since a comment may follow it. */
static size_t find_end(const unsigned char *archive, size_t bytes) {
    size_t lowest = bytes > END_BYTES + COMMENT_MAX ? bytes - END_BYTES - COMMENT_MAX : 0;
    for (size_t at = bytes < END_BYTES ? 0 : bytes - END_BYTES + 1; at-- > lowest;)
        if (memcmp(archive + at, "PK\5\6", 4) == 0) return at;
    return bytes;
}

/* One central directory record at `*at`, which moves past it. */
static int read_central(const unsigned char *archive, size_t end, size_t *at, zip_member *member) {
    const unsigned char *p = archive + *at;
    if (end - *at < CENTRAL_BYTES || memcmp(p, "PK\1\2", 4) != 0) return -1;
    size_t name = u16(p + 28), rest = name + u16(p + 30) + u16(p + 32);
    if (end - *at - CENTRAL_BYTES < rest || name >= sizeof member->name) return -1;
    *member = (zip_member){.offset = u32(p + 42),
                           .packed = u32(p + 20),
                           .size = u32(p + 24),
                           .method = u16(p + 10),
                           .crc = u32(p + 16)};
    memcpy(member->name, p + CENTRAL_BYTES, name);
    *at += CENTRAL_BYTES + rest;
    return 0;
}

int zip_list(const unsigned char *archive, size_t bytes, const char *what, zip_member **members, size_t *count) {
    size_t end = find_end(archive, bytes);
    if (end == bytes || u32(archive + end + 16) > end) {
        fprintf(stderr, "%s: no ZIP directory was found\n", what);
        return -1;
    }
    size_t total = u16(archive + end + 10), at = u32(archive + end + 16);
    zip_member *list = calloc(total ? total : 1, sizeof *list);
    if (!list) return -1;
    for (size_t i = 0; i < total; i++) {
        if (read_central(archive, end, &at, &list[i]) != 0) {
            fprintf(stderr, "%s: ZIP directory is damaged at entry %zu\n", what, i);
            free(list);
            return -1;
        }
    }
    *members = list;
    *count = total;
    return 0;
}

/* Raw deflate, whole member at once. */
static int inflate_into(const unsigned char *packed, size_t packed_bytes, unsigned char *data, size_t size) {
    z_stream stream = {0};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return -1;
    unsigned char nothing = 0;
    /* zlib's pointer isn't const (ZLIB_CONST is a build choice), but inflate never writes there. */
    memcpy(&stream.next_in, &packed, sizeof packed);
    stream.avail_in = (uInt)packed_bytes;
    stream.next_out = size ? data : &nothing;
    stream.avail_out = (uInt)size;
    int result = inflate(&stream, Z_FINISH);
    size_t written = stream.total_out;
    inflateEnd(&stream);
    return result == Z_STREAM_END && written == size ? 0 : -1;
}

unsigned char *zip_extract(const unsigned char *archive, size_t bytes, const zip_member *member, const char *what) {
    const unsigned char *local = archive + member->offset;
    size_t left = bytes < member->offset ? 0 : bytes - member->offset;
    /* The local header has its own extra field (numpy pads it), so only its lengths say where the data starts. */
    size_t skip = left < LOCAL_BYTES ? 0 : LOCAL_BYTES + u16(local + 26) + u16(local + 28);
    unsigned char *data = NULL;
    if (!skip || memcmp(local, "PK\3\4", 4) != 0 || left < skip || left - skip < member->packed) {
        fprintf(stderr, "%s: %s lies outside the archive\n", what, member->name);
        return NULL;
    }
    data = malloc(member->size ? member->size : 1);
    if (!data) return NULL;
    int fine = 0;
    if (member->method == 0 && member->packed == member->size) {
        memcpy(data, local + skip, member->size);
        fine = 1;
    } else if (member->method == 8) {
        fine = inflate_into(local + skip, member->packed, data, member->size) == 0;
    }
    if (fine && crc32(0, data, (uInt)member->size) == member->crc) return data;
    fprintf(stderr, "%s: %s is damaged or of unknown compression %u\n", what, member->name, member->method);
    free(data);
    return NULL;
}
