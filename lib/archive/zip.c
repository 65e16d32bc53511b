/* ZIP archives in memory: end record, central directory, local headers, inflate. */
#include "archive/td_zip.h"
#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { END_BYTES = 22, CENTRAL_BYTES = 46, LOCAL_BYTES = 30, COMMENT_MAX = 65535 };

int td_zip_is(const void *bytes, size_t size) {
    return size >= 4 && (memcmp(bytes, "PK\3\4", 4) == 0 || memcmp(bytes, "PK\5\6", 4) == 0);
}

/* Position of the end-of-central-directory record, or `size`: it is searched backwards, since a comment may follow it. */
static size_t find_end(const unsigned char *bytes, size_t size) {
    size_t lowest = size > END_BYTES + COMMENT_MAX ? size - END_BYTES - COMMENT_MAX : 0;
    for (size_t at = size < END_BYTES ? 0 : size - END_BYTES + 1; at-- > lowest;)
        if (memcmp(bytes + at, "PK\5\6", 4) == 0) return at;
    return size;
}

/* A 32-bit field full of ones says that the truth is in a ZIP64 record. */
static tides_status check_member(const td_zip *zip, const td_zip_member *m, unsigned flags, tides_error *error) {
    if (m->packed == UINT32_MAX || m->size == UINT32_MAX || m->offset == UINT32_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: %s is stored as ZIP64 (4 GiB or more), which isn't read", zip->path,
                       m->name);
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

/* One central directory record at `*at`, which moves past it; `end` is where the directory must have ended. */
static tides_status read_central(const td_zip *zip, size_t end, size_t *at, td_zip_member *member, tides_error *error) {
    const unsigned char *p = zip->bytes + *at;
    size_t left = end - *at;
    if (left < CENTRAL_BYTES || memcmp(p, "PK\1\2", 4) != 0 ||
        left - CENTRAL_BYTES < (size_t)td_le16(p + 28) + td_le16(p + 30) + td_le16(p + 32))
        return td_fail(error, TIDES_BAD_FILE, "%s: the ZIP directory is damaged at byte %zu", zip->path, *at);
    size_t length = td_le16(p + 28);
    *member = (td_zip_member){.offset = td_le32(p + 42),
                              .packed = td_le32(p + 20),
                              .size = td_le32(p + 24),
                              .method = td_le16(p + 10),
                              .crc = td_le32(p + 16)};
    if (!(member->name = td_alloc(length + 1, 1, error))) return TIDES_NO_MEMORY;
    memcpy(member->name, p + CENTRAL_BYTES, length);
    *at += CENTRAL_BYTES + length + td_le16(p + 30) + td_le16(p + 32);
    return check_member(zip, member, td_le16(p + 8), error);
}

static tides_status read_directory(td_zip *zip, size_t end, size_t at, tides_error *error) {
    size_t packed = 0;
    for (size_t i = 0; i < zip->count; i++) {
        tides_status status = read_central(zip, end, &at, &zip->members[i], error);
        if (status) return status;
        packed += zip->members[i].packed; /* at most 65535 times 4 GiB */
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

tides_status td_zip_open(td_zip *zip, const char *path, const void *bytes, size_t size, tides_error *error) {
    td_zip opened = {.path = path, .bytes = bytes, .size = size};
    size_t end = find_end(bytes, size);
    if (end == size)
        return td_fail(error, TIDES_BAD_FILE, "%s: no ZIP directory was found at its end: it is cut short or no ZIP archive",
                       path);
    const unsigned char *p = opened.bytes + end;
    size_t start = td_le32(p + 16), count = td_le16(p + 10);
    /* Torch adds ZIP64's end records to every archive; only ones here say that they are needed. */
    if (count == UINT16_MAX || start == UINT32_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: is a ZIP64 archive (4 GiB or more), which isn't read", path);
    if (td_le16(p + 8) != count)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: is one part of a ZIP archive in several, which isn't read", path);
    if (start > end || count > (end - start) / CENTRAL_BYTES)
        return td_fail(error, TIDES_BAD_FILE, "%s: the ZIP directory (%zu entries at byte %zu) doesn't fit in the file", path,
                       count, start);
    opened.members = td_alloc(count, sizeof *opened.members, error);
    opened.by_name = opened.members ? td_alloc(count, sizeof *opened.by_name, error) : NULL;
    opened.count = opened.by_name ? count : 0;
    tides_status status = opened.by_name ? read_directory(&opened, end, start, error) : TIDES_NO_MEMORY;
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

/* Raw deflate, the whole member at once; 0 where it gives exactly `size` bytes. */
static int inflate_into(const unsigned char *packed, size_t packed_bytes, unsigned char *data, size_t size) {
    z_stream stream = {0};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return -1;
    /* zlib's pointer isn't const (ZLIB_CONST is a build choice), but inflate never writes there. */
    memcpy(&stream.next_in, &packed, sizeof packed);
    stream.avail_in = (uInt)packed_bytes;
    stream.next_out = data;
    stream.avail_out = (uInt)size;
    int result = inflate(&stream, Z_FINISH);
    size_t written = stream.total_out;
    inflateEnd(&stream);
    return result == Z_STREAM_END && written == size ? 0 : -1;
}

/* Where the member's bytes start; 0 where they aren't all in the archive. The local header has its own extra field (numpy and
 * torch pad with it), so only its lengths say. */
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
    if (crc32(0, found, (uInt)member->size) != member->crc) {
        free(made);
        return td_fail(error, TIDES_BAD_FILE, "%s: %s has the wrong checksum: the archive is damaged", zip->path, member->name);
    }
    *data = found;
    *owned = made;
    return TIDES_OK;
}
