/* Makes ZIP archives, .npy files and pickles byte by byte. Aborts if memory runs out. */
#include "archive_make.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

void archive_number(scene_bytes *to, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++, value >>= 8) scene_bytes_add(to, &(unsigned char){(unsigned char)(value & 255)}, 1);
}

static size_t deflate_raw(const void *data, size_t size, unsigned char **out) {
    z_stream stream = {0};
    size_t room = size + 1000;
    if (!(*out = malloc(room)) || deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) abort();
    memcpy(&stream.next_in, &data, sizeof data); /* zlib's pointer isn't const */
    stream.avail_in = (uInt)size;
    stream.next_out = *out;
    stream.avail_out = (uInt)room;
    if (deflate(&stream, Z_FINISH) != Z_STREAM_END) abort();
    size_t packed = stream.total_out;
    deflateEnd(&stream);
    return packed;
}

/* The fields that local and central headers share, from "version needed" to the lengths. */
static void add_facts(scene_bytes *to, int deflated, unsigned long crc, size_t packed, size_t size, size_t name, size_t extra) {
    archive_number(to, 20, 2);
    archive_number(to, 0, 2);
    archive_number(to, deflated ? 8 : 0, 2);
    archive_number(to, 0, 4);
    archive_number(to, crc, 4);
    archive_number(to, packed, 4);
    archive_number(to, size, 4);
    archive_number(to, name, 2);
    archive_number(to, extra, 2);
}

/* Adds a member's entry to the directory. In a wide archive another extra field comes before ZIP64's. */
static void add_central(archive_make *archive, const char *name, int deflated, unsigned long crc, size_t packed, size_t size,
                        size_t offset) {
    scene_bytes *to = &archive->central;
    const uint64_t ones = UINT32_MAX;
    scene_bytes_add(to, "PK\1\2", 4);
    archive_number(to, 20, 2);
    add_facts(to, deflated, crc, archive->wide ? ones : packed, archive->wide ? ones : size, strlen(name),
              archive->wide ? 5 + 4 + 24 : 0);
    archive_number(to, 0, 8);
    archive_number(to, 0, 2);
    archive_number(to, archive->wide ? ones : offset, 4);
    scene_bytes_add(to, name, strlen(name));
    if (!archive->wide) return;
    scene_bytes_add(to, "UT\1\0x", 5);
    archive_number(to, 1 | 24 << 16, 4);
    archive_number(to, size, 8);
    archive_number(to, packed, 8);
    archive_number(to, offset, 8);
}

void archive_add(archive_make *archive, const char *name, const void *data, size_t size, int deflated) {
    unsigned char *packed = NULL;
    size_t bytes = deflated ? deflate_raw(data, size, &packed) : size, offset = archive->bytes.size;
    unsigned long crc = crc32(0, data, (uInt)size);
    scene_bytes_add(&archive->bytes, "PK\3\4", 4);
    add_facts(&archive->bytes, deflated, crc, bytes, size, strlen(name), 8);
    scene_bytes_add(&archive->bytes, name, strlen(name));
    archive_number(&archive->bytes, 0, 8);
    scene_bytes_add(&archive->bytes, deflated ? packed : data, bytes);
    add_central(archive, name, deflated, crc, bytes, size, offset);
    archive->count++;
    free(packed);
}

/* ZIP64's end record, and the locator that points to it. */
static void add_wide_end(archive_make *archive, size_t offset) {
    const size_t record = archive->bytes.size;
    scene_bytes_add(&archive->bytes, "PK\6\6", 4);
    archive_number(&archive->bytes, 44, 8);
    archive_number(&archive->bytes, 45 | 45 << 16, 4); /* versions */
    archive_number(&archive->bytes, 0, 8);             /* disks */
    archive_number(&archive->bytes, archive->count, 8);
    archive_number(&archive->bytes, archive->count, 8);
    archive_number(&archive->bytes, archive->central.size, 8);
    archive_number(&archive->bytes, offset, 8);
    scene_bytes_add(&archive->bytes, "PK\6\7\0\0\0\0", 8);
    archive_number(&archive->bytes, record, 8);
    archive_number(&archive->bytes, 1, 4);
}

scene_bytes archive_end(archive_make *archive) {
    size_t offset = archive->bytes.size;
    if (archive->count) scene_bytes_add(&archive->bytes, archive->central.data, archive->central.size);
    if (archive->wide) add_wide_end(archive, offset);
    const uint64_t ones = UINT32_MAX;
    scene_bytes_add(&archive->bytes, "PK\5\6\0\0\0\0", 8);
    archive_number(&archive->bytes, archive->wide ? ones : archive->count, 2);
    archive_number(&archive->bytes, archive->wide ? ones : archive->count, 2);
    archive_number(&archive->bytes, archive->wide ? ones : archive->central.size, 4);
    archive_number(&archive->bytes, archive->wide ? ones : offset, 4);
    archive_number(&archive->bytes, 2, 2);
    scene_bytes_add(&archive->bytes, "hi", 2);
    free(archive->central.data);
    return archive->bytes;
}

void archive_npy(scene_bytes *to, int version, const char *header, const void *data, size_t size) {
    scene_bytes_add(to, "\x93NUMPY", 6);
    archive_number(to, (uint64_t)version, 1);
    archive_number(to, 0, 1);
    archive_number(to, strlen(header), version == 1 ? 2 : 4);
    scene_bytes_add(to, header, strlen(header));
    scene_bytes_add(to, data, size);
}

void pickle_text(scene_bytes *to, const char *text) {
    PICKLE(to, "X");
    archive_number(to, strlen(text), 4);
    scene_bytes_add(to, text, strlen(text));
}

void pickle_integer(scene_bytes *to, int32_t value) {
    PICKLE(to, "J");
    archive_number(to, (uint64_t)(uint32_t)value, 4);
}

void pickle_tuple(scene_bytes *to, int count, const int32_t *values) {
    PICKLE(to, "(");
    for (int i = 0; i < count; i++) pickle_integer(to, values[i]);
    PICKLE(to, "t");
}

void pickle_storage(scene_bytes *to, const char *type, const char *key, int32_t count) {
    char global[64];
    int length = snprintf(global, sizeof global, "ctorch\n%s\n", type);
    PICKLE(to, "(");
    pickle_text(to, "storage");
    scene_bytes_add(to, global, (size_t)length);
    pickle_text(to, key);
    pickle_text(to, "cuda:0");
    pickle_integer(to, count);
    PICKLE(to, "tQ");
}

void pickle_tensor(scene_bytes *to, const char *type, const char *key, int32_t count, int32_t offset, int ndim,
                   const int32_t *shape, const int32_t *stride) {
    PICKLE(to, "ctorch._utils\n_rebuild_tensor_v2\n(");
    pickle_storage(to, type, key, count);
    pickle_integer(to, offset);
    pickle_tuple(to, ndim, shape);
    pickle_tuple(to, ndim, stride);
    PICKLE(to, "\x89"
               "ccollections\nOrderedDict\n)RtR");
}

scene_bytes pickle_archive(const scene_bytes *pickle, const pickle_storage_bytes *storages, int count) {
    archive_make archive = {.count = 0};
    char name[32];
    archive_add(&archive, "made/data.pkl", pickle->data, pickle->size, 0);
    archive_add(&archive, "made/byteorder", "little", 6, 0);
    for (int i = 0; i < count; i++) {
        snprintf(name, sizeof name, "made/data/%d", i);
        archive_add(&archive, name, storages[i].data, storages[i].size, 0);
    }
    archive_add(&archive, "made/version", "3\n", 2, 0);
    return archive_end(&archive);
}
