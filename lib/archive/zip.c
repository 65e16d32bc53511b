/* ZIP archives in memory: end records, central directory, local headers, inflate. Numbers as in PKWARE's APPNOTE 4.3 and 4.5.3
 * (ZIP64). */
#include "archive/td_zip.h"
#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Sizes of the end record, and of central and local records without names; the longest comment [bytes]. */
enum { END_BYTES = 22, CENTRAL_BYTES = 46, LOCAL_BYTES = 30, COMMENT_MAX = 65535 };
enum { WIDE_EXTRA = 1, WIDE_END_BYTES = 56, LOCATOR_BYTES = 20 }; /* sizes of ZIP64's parts */

int td_zip_is(const void *bytes, size_t size) {
    return size >= 4 && (memcmp(bytes, "PK\3\4", 4) == 0 || memcmp(bytes, "PK\5\6", 4) == 0);
}

/* Position of the end-of-central-directory record, or `size`. The search goes backwards, since a comment of any length may
 * follow it. */
static size_t find_end(const unsigned char *bytes, size_t size) {
    size_t lowest = size > END_BYTES + COMMENT_MAX ? size - END_BYTES - COMMENT_MAX : 0;
    for (size_t at = size < END_BYTES ? 0 : size - END_BYTES + 1; at-- > lowest;)
        if (memcmp(bytes + at, "PK\5\6", 4) == 0) return at;
    return size;
}

/* A 32-bit field of all ones means that its value is in ZIP64's extra field. `wide` points to size, packed and offset; the
 * extra field has a value, in this order, for each of them that is all ones. 0 if the extra field is missing. */
static int widen(const unsigned char *extra, size_t bytes, uint64_t *const wide[3]) {
    if (*wide[0] != UINT32_MAX && *wide[1] != UINT32_MAX && *wide[2] != UINT32_MAX) return 1;
    for (size_t at = 0; bytes - at >= 4;) {
        size_t length = td_le16(extra + at + 2);
        if (length > bytes - at - 4) return 0;
        const unsigned char *p = extra + at + 4;
        at += 4 + length;
        if (td_le16(p - 4) != WIDE_EXTRA) continue;
        for (int k = 0; k < 3; k++) {
            if (*wide[k] != UINT32_MAX) continue;
            if (length < 8) return 0;
            *wide[k] = td_le64(p);
            p += 8;
            length -= 8;
        }
        return 1;
    }
    return 0;
}

static tides_status check_member(const td_zip *zip, const td_zip_member *m, unsigned flags, tides_error *error) {
    if (flags & 1u) return td_fail(error, TIDES_UNSUPPORTED, "%s: %s is encrypted, which isn't read", zip->path, m->name);
    if (m->method != 0 && m->method != 8)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: %s is compressed by method %u: only stored and deflated ones are read",
                       zip->path, m->name, m->method);
    if (m->method == 0 && m->packed != m->size)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s is stored but its two sizes differ (%zu and %zu): the archive is damaged",
                       zip->path, m->name, m->packed, m->size);
    if (m->size / TD_ZIP_RATIO > m->packed)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s claims to unpack from %zu to %zu bytes, more than deflate can", zip->path,
                       m->name, m->packed, m->size);
    return TIDES_OK;
}

/* Reads the central directory record at `*at` and moves `*at` past it; the directory ends at `end`. */
static tides_status read_central(const td_zip *zip, size_t end, size_t *at, td_zip_member *member, tides_error *error) {
    const unsigned char *p = zip->bytes + *at;
    size_t left = end - *at;
    if (left < CENTRAL_BYTES || memcmp(p, "PK\1\2", 4) != 0 ||
        left - CENTRAL_BYTES < (size_t)td_le16(p + 28) + td_le16(p + 30) + td_le16(p + 32))
        return td_fail(error, TIDES_BAD_FILE, "%s: the ZIP directory is damaged at byte %zu", zip->path, *at);
    const size_t length = td_le16(p + 28), extra = td_le16(p + 30);
    uint64_t offset = td_le32(p + 42), packed = td_le32(p + 20), size = td_le32(p + 24);
    *member = (td_zip_member){.method = td_le16(p + 10), .crc = td_le32(p + 16)};
    if (!(member->name = td_alloc(length + 1, 1, error))) return TIDES_NO_MEMORY;
    memcpy(member->name, p + CENTRAL_BYTES, length);
    *at += CENTRAL_BYTES + length + extra + td_le16(p + 32);
    if (!widen(p + CENTRAL_BYTES + length, extra, (uint64_t *const[]){&size, &packed, &offset}))
        return td_fail(error, TIDES_BAD_FILE, "%s: %s lacks the ZIP64 field that has its sizes: the archive is damaged",
                       zip->path, member->name);
    if (packed > zip->size || offset > zip->size || size > SIZE_MAX)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s lies outside the archive, or its members overlap: it is damaged",
                       zip->path, member->name);
    member->offset = (size_t)offset;
    member->packed = (size_t)packed;
    member->size = (size_t)size;
    return check_member(zip, member, td_le16(p + 8), error);
}

static tides_status read_directory(td_zip *zip, size_t end, size_t at, tides_error *error) {
    size_t packed = 0;
    for (size_t i = 0; i < zip->count; i++) {
        tides_status status = read_central(zip, end, &at, &zip->members[i], error);
        if (status) return status;
        packed += zip->members[i].packed; /* no overflow: each was checked against the archive's size */
        if (packed > zip->size)
            return td_fail(error, TIDES_BAD_FILE,
                           "%s: its members together claim more bytes than the archive's %zu: they overlap", zip->path,
                           zip->size);
    }
    return TIDES_OK;
}

static int compare_names(const void *a, const void *b) {
    const td_zip_member *const *first = a, *const *second = b;
    return strcmp((*first)->name, (*second)->name);
}

static void sort_names(td_zip *zip) {
    for (size_t i = 0; i < zip->count; i++) zip->by_name[i] = &zip->members[i];
    qsort(zip->by_name, zip->count, sizeof *zip->by_name, compare_names);
}

/* Where the directory begins and must end, and its number of entries. */
typedef struct directory {
    uint64_t start, end, count;
} directory;

/* Reads ZIP64's end record, which a locator before the plain record at `end` points to; 0 if there is none. */
static int find_wide_end(const td_zip *zip, size_t end, directory *found) {
    if (end < LOCATOR_BYTES + WIDE_END_BYTES) return 0;
    const size_t locator = end - LOCATOR_BYTES;
    if (memcmp(zip->bytes + locator, "PK\6\7", 4) != 0) return 0;
    const uint64_t at = td_le64(zip->bytes + locator + 8);
    if (at > locator - WIDE_END_BYTES || memcmp(zip->bytes + at, "PK\6\6", 4) != 0) return 0;
    const unsigned char *p = zip->bytes + at;
    if (td_le64(p + 24) != td_le64(p + 32)) return 0; /* entries on this disk differ from all entries */
    *found = (directory){.start = td_le64(p + 48), .end = at, .count = td_le64(p + 32)};
    return 1;
}

static tides_status find_directory(const td_zip *zip, directory *found, tides_error *error) {
    const size_t end = find_end(zip->bytes, zip->size);
    if (end == zip->size)
        return td_fail(error, TIDES_BAD_FILE, "%s: no ZIP directory was found at its end: it is cut short or no ZIP archive",
                       zip->path);
    const unsigned char *p = zip->bytes + end;
    *found = (directory){.start = td_le32(p + 16), .end = end, .count = td_le16(p + 10)};
    /* Torch adds ZIP64's end records to every archive. They are needed only if a field of the plain record is all ones. If
     * there are none, all ones are a plain number: an archive may have 65535 members. */
    const int wide = found->count == UINT16_MAX || found->start == UINT32_MAX || td_le32(p + 12) == UINT32_MAX;
    if (!(wide && find_wide_end(zip, end, found)) && td_le16(p + 8) != found->count)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: is one part of a ZIP archive in several, which isn't read", zip->path);
    if (found->start > found->end || found->count > (found->end - found->start) / CENTRAL_BYTES)
        return td_fail(error, TIDES_BAD_FILE, "%s: the ZIP directory (%llu entries at byte %llu) doesn't fit in the file",
                       zip->path, (unsigned long long)found->count, (unsigned long long)found->start);
    return TIDES_OK;
}

tides_status td_zip_open(td_zip *zip, const char *path, const void *bytes, size_t size, tides_error *error) {
    td_zip opened = {.path = path, .bytes = bytes, .size = size};
    directory found = {0, 0, 0};
    tides_status status = find_directory(&opened, &found, error);
    if (status != TIDES_OK) return status;
    const size_t count = (size_t)found.count; /* bounded by the archive's size */
    opened.members = td_alloc(count, sizeof *opened.members, error);
    opened.by_name = opened.members ? td_alloc(count, sizeof *opened.by_name, error) : NULL;
    opened.count = opened.by_name ? count : 0;
    status = opened.by_name ? read_directory(&opened, (size_t)found.end, (size_t)found.start, error) : TIDES_NO_MEMORY;
    if (!status) sort_names(&opened);
    if (status)
        td_zip_close(&opened);
    else
        *zip = opened;
    return status;
}

void td_zip_close(td_zip *zip) {
    for (size_t i = 0; i < zip->count; i++) free(zip->members[i].name);
    free(zip->members);
    free(zip->by_name);
    *zip = (td_zip){.path = NULL};
}

const td_zip_member *td_zip_find(const td_zip *zip, const char *name) {
    for (size_t low = 0, high = zip->count; low < high;) {
        size_t middle = low + (high - low) / 2;
        int side = strcmp(name, zip->by_name[middle]->name);
        if (side == 0) return zip->by_name[middle];
        if (side < 0)
            high = middle;
        else
            low = middle + 1;
    }
    return NULL;
}

/* The part of `left` that fits into zlib's 32-bit counters. */
static uInt piece_of(size_t left) { return left < UINT32_MAX ? (uInt)left : UINT32_MAX; }

/* Inflates a whole member (raw deflate); 0 if it gives exactly `size` bytes. */
static int inflate_into(const unsigned char *packed, size_t packed_bytes, unsigned char *data, size_t size) {
    z_stream stream = {0};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return -1;
    /* zlib's pointer isn't const (ZLIB_CONST is a build choice), but inflate never writes there. */
    memcpy(&stream.next_in, &packed, sizeof packed);
    stream.next_out = data;
    int result = Z_OK;
    while (result == Z_OK) { /* ends with Z_BUF_ERROR if the input ends too soon */
        const size_t read = (size_t)(stream.next_in - packed), written = (size_t)(stream.next_out - data);
        stream.avail_in = piece_of(packed_bytes - read);
        stream.avail_out = piece_of(size - written);
        result = inflate(&stream, Z_NO_FLUSH);
    }
    const size_t written = (size_t)(stream.next_out - data);
    inflateEnd(&stream);
    return result == Z_STREAM_END && written == size ? 0 : -1;
}

/* Position of the member's bytes; 0 if they aren't all in the archive. It follows from lengths in the local header, whose
 * extra field may differ from the central directory's: numpy and torch pad with it. */
static size_t data_start(const td_zip *zip, const td_zip_member *member) {
    if (member->offset > zip->size || zip->size - member->offset < LOCAL_BYTES) return 0;
    const unsigned char *local = zip->bytes + member->offset;
    size_t left = zip->size - member->offset, skip = LOCAL_BYTES + (size_t)td_le16(local + 26) + td_le16(local + 28);
    int fits = memcmp(local, "PK\3\4", 4) == 0 && skip <= left && member->packed <= left - skip;
    return fits ? member->offset + skip : 0;
}

tides_status td_zip_read(const td_zip *zip, const td_zip_member *member, const unsigned char **data, void **owned,
                         tides_error *error) {
    size_t start = data_start(zip, member);
    if (!start)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s lies outside the archive: the file is cut short or damaged", zip->path,
                       member->name);
    const unsigned char *found = zip->bytes + start;
    unsigned char *made = NULL;
    if (member->method == 8) {
        if (!(made = td_alloc(member->size, 1, error))) return TIDES_NO_MEMORY;
        if (inflate_into(found, member->packed, made, member->size) != 0) {
            free(made);
            return td_fail(error, TIDES_BAD_FILE, "%s: %s doesn't unpack to the %zu bytes it claims: the archive is damaged",
                           zip->path, member->name, member->size);
        }
        found = made;
    }
    if (crc32_z(0, found, member->size) != member->crc) {
        free(made);
        return td_fail(error, TIDES_BAD_FILE, "%s: %s has the wrong checksum: the archive is damaged", zip->path, member->name);
    }
    *data = found;
    *owned = made;
    return TIDES_OK;
}
