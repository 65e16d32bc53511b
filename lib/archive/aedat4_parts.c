/* Reads the parts of AEDAT 4 files that events and frames share: tables of flatbuffers, the header, and the XML in the
 * header that describes the streams. */
#include "td_aedat4_parts.h"

#include "td_endian.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int has(td_flat f, size_t at, size_t bytes) { return at <= f.bytes && bytes <= f.bytes - at; }

size_t td_flat_root(td_flat f, const char *identifier) {
    if (!has(f, 0, 8) || memcmp(f.data + 4, identifier, 4) != 0) return 0;
    size_t at = td_le32(f.data);
    return has(f, at, 4) ? at : 0;
}

size_t td_flat_field(td_flat f, size_t table, size_t field, size_t bytes) {
    int64_t virtual_table = (int64_t)table - (int32_t)td_le32(f.data + table);
    size_t entry = 4 + 2 * field;
    if (virtual_table < 0 || !has(f, (size_t)virtual_table, 4)) return 0;
    size_t at = (size_t)virtual_table, length = td_le16(f.data + at);
    if (entry + 2 > length || !has(f, at, length)) return 0;
    size_t offset = td_le16(f.data + at + entry);
    return offset && has(f, table + offset, bytes) ? table + offset : 0;
}

const unsigned char *td_flat_vector(td_flat f, size_t table, size_t field, size_t size, size_t *count) {
    size_t at = td_flat_field(f, table, field, 4);
    if (!at) return NULL;
    size_t vector = at + td_le32(f.data + at);
    if (!has(f, vector, 4)) return NULL;
    *count = td_le32(f.data + vector);
    return *count <= (f.bytes - vector - 4) / size ? f.data + vector + 4 : NULL;
}

const char *td_aedat4_attribute(const char *from, const char *key) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "key=\"%s\"", key);
    const char *at = strstr(from, quoted), *value = at ? strchr(at, '>') : NULL;
    return value ? value + 1 : NULL;
}

/* The number of the stream whose attribute is at `inside`: the name of the last XML node that begins before `inside`; -1 if
 * there is none. */
static int32_t stream_number(const char *xml, const char *inside) {
    static const char mark[] = "<node name=\"";
    const char *found = NULL;
    for (const char *at = strstr(xml, mark); at && at < inside; at = strstr(at + 1, mark)) found = at;
    return found ? (int32_t)strtol(found + sizeof mark - 1, NULL, 10) : -1;
}

static void take_text(const char *value, char *out, size_t size) {
    const size_t length = value ? strcspn(value, "<") : 0;
    snprintf(out, size, "%.*s", (int)(length < size ? length : size - 1), value ? value : "");
}

int td_aedat4_next(const char *xml, const char *from, const char *type, td_aedat4_stream *t) {
    for (t->type = td_aedat4_attribute(from, "typeIdentifier"); t->type && strncmp(t->type, type, 4) != 0;)
        t->type = td_aedat4_attribute(t->type, "typeIdentifier");
    if (!t->type) return 0;
    t->number = stream_number(xml, t->type);
    t->end = td_aedat4_attribute(t->type, "typeIdentifier");
    const char *source = td_aedat4_attribute(t->type, "source");
    take_text(source && (!t->end || source < t->end) ? source : NULL, t->name, sizeof t->name);
    return 1;
}

tides_status td_aedat4_damaged(const char *path, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: its AEDAT 4 header (IOHE) is damaged", path);
}

tides_status td_aedat4_header(td_flat header, const char *path, int32_t *compression, uint64_t *end, char **xml,
                              tides_error *error) {
    size_t table = td_flat_root(header, "IOHE"), length = 0;
    if (!table) return td_aedat4_damaged(path, error);
    size_t packing = td_flat_field(header, table, 0, 4), position = td_flat_field(header, table, 1, 8);
    const unsigned char *text = td_flat_vector(header, table, 2, 1, &length);
    if (!text) return td_aedat4_damaged(path, error);
    *compression = packing ? (int32_t)td_le32(header.data + packing) : TD_AEDAT4_NONE;
    if (*compression < 0 || *compression > TD_AEDAT4_ZSTD_HIGH)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: its packets have compression %d, but only 0 to 4 are read (none, LZ4, LZ4 high, Zstandard, "
                       "Zstandard high): save it with one of these",
                       path, *compression);
    *end = position ? td_le64(header.data + position) : 0;
    *xml = td_alloc(length + 1, 1, error);
    if (!*xml) return TIDES_NO_MEMORY;
    memcpy(*xml, text, length);
    return TIDES_OK;
}
