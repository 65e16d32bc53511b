/* Makes packed splat files for tests, byte by byte. */
#include "splat_make.h"

#include "scene_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>
#include <zlib.h>
#include <zstd.h>

static void add_number(scene_bytes *bytes, uint64_t value, size_t size) {
    unsigned char b[8];
    for (size_t i = 0; i < size; i++) b[i] = (unsigned char)(value >> 8 * i & 255);
    scene_bytes_add(bytes, b, size);
}

void splat_u8(scene_bytes *bytes, unsigned value) { add_number(bytes, value, 1); }
void splat_u16(scene_bytes *bytes, unsigned value) { add_number(bytes, value, 2); }
void splat_u32(scene_bytes *bytes, uint32_t value) { add_number(bytes, value, 4); }
void splat_u64(scene_bytes *bytes, uint64_t value) { add_number(bytes, value, 8); }

void splat_float(scene_bytes *bytes, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    splat_u32(bytes, bits);
}

void splat_zeros(scene_bytes *bytes, size_t count) {
    for (size_t i = 0; i < count; i++) splat_u8(bytes, 0);
}

void splat_patch(scene_bytes *bytes, size_t at, uint32_t value) {
    assert_true(at + 4 <= bytes->size);
    for (size_t i = 0; i < 4; i++) bytes->data[at + i] = (char)(value >> 8 * i & 255);
}

scene_bytes splat_gzip(const scene_bytes *plain) {
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    size_t room = deflateBound(&stream, plain->size) + 64;
    unsigned char *memory = malloc(room);
    assert_non_null(memory);
    stream.next_in = (Bytef *)plain->data;
    stream.avail_in = (unsigned)plain->size;
    stream.next_out = memory;
    stream.avail_out = (unsigned)room;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    scene_bytes packed = {0};
    scene_bytes_add(&packed, memory, room - stream.avail_out);
    deflateEnd(&stream);
    free(memory);
    return packed;
}

scene_bytes splat_zstd(const void *plain, size_t size) {
    size_t room = ZSTD_compressBound(size);
    void *memory = malloc(room);
    assert_non_null(memory);
    size_t made = ZSTD_compress(memory, room, plain, size, 3);
    assert_false(ZSTD_isError(made));
    scene_bytes packed = {0};
    scene_bytes_add(&packed, memory, made);
    free(memory);
    return packed;
}

void splat_streams(scene_bytes *bytes, const char *plain, const size_t *sizes, size_t count) {
    scene_bytes body = {0};
    for (size_t i = 0; i < count; i++) {
        scene_bytes packed = splat_zstd(plain, sizes[i]);
        splat_u64(bytes, packed.size);
        splat_u64(bytes, sizes[i]);
        scene_bytes_add(&body, packed.data, packed.size);
        plain += sizes[i];
        free(packed.data);
    }
    scene_bytes_add(bytes, body.data, body.size);
    free(body.data);
}

/* What the local header and the directory have in common: version to sizes. */
static void add_member(scene_bytes *bytes, const char *name, const void *data, size_t size) {
    splat_u16(bytes, 20);  /* version needed */
    splat_zeros(bytes, 8); /* flags, method: stored, time, date */
    splat_u32(bytes, (uint32_t)crc32(crc32(0, NULL, 0), data, (unsigned)size));
    splat_u32(bytes, (uint32_t)size);
    splat_u32(bytes, (uint32_t)size);
    splat_u16(bytes, (unsigned)strlen(name));
    splat_u16(bytes, 0); /* extra field */
}

void splat_zip_add(splat_zip *zip, const char *name, const void *data, size_t size) {
    size_t at = zip->bytes.size;
    splat_u32(&zip->bytes, 0x04034b50);
    add_member(&zip->bytes, name, data, size);
    scene_bytes_add(&zip->bytes, name, strlen(name));
    scene_bytes_add(&zip->bytes, data, size);
    splat_u32(&zip->directory, 0x02014b50);
    splat_u16(&zip->directory, 20); /* version made by */
    add_member(&zip->directory, name, data, size);
    splat_zeros(&zip->directory, 10); /* comment, disk, attributes */
    splat_u32(&zip->directory, (uint32_t)at);
    scene_bytes_add(&zip->directory, name, strlen(name));
    zip->count++;
}

scene_bytes splat_zip_end(splat_zip *zip) {
    size_t at = zip->bytes.size;
    scene_bytes_add(&zip->bytes, zip->directory.data, zip->directory.size);
    splat_u32(&zip->bytes, 0x06054b50);
    splat_u32(&zip->bytes, 0); /* disks */
    splat_u16(&zip->bytes, zip->count);
    splat_u16(&zip->bytes, zip->count);
    splat_u32(&zip->bytes, (uint32_t)zip->directory.size);
    splat_u32(&zip->bytes, (uint32_t)at);
    splat_u16(&zip->bytes, 0); /* comment */
    free(zip->directory.data);
    return zip->bytes;
}

static tides_status parse_exactly(splat_parser *parse, const char *data, size_t size, td_gaussians *g, tides_error *error) {
    char *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    memcpy(exact, data, size);
    tides_status status = parse("t.splats", exact, size, g, error);
    free(exact);
    return status;
}

td_gaussians splat_parse(splat_parser *parse, const scene_bytes *bytes) {
    td_gaussians g;
    tides_error error = {0, ""};
    scene_expect_ok(parse_exactly(parse, bytes->data, bytes->size, &g, &error), &error);
    return g;
}

static void refused(splat_parser *parse, const char *data, size_t size, tides_status status, const char *words) {
    td_gaussians g, untouched;
    memset(&g, 0x5a, sizeof g);
    untouched = g;
    tides_error error = {0, ""};
    scene_expect_error(parse_exactly(parse, data, size, &g, &error), status, &error, words);
    scene_expect_error(error.status, status, &error, "t.splats: ");
    assert_memory_equal(&g, &untouched, sizeof g);
    assert_int_equal(parse_exactly(parse, data, size, &g, NULL), status); /* the error is nullable */
}

void splat_refused(splat_parser *parse, const scene_bytes *bytes, tides_status status, const char *words) {
    refused(parse, bytes->data, bytes->size, status, words);
}

void splat_truncated(splat_parser *parse, const scene_bytes *bytes) {
    for (size_t size = 0; size < bytes->size; size++) refused(parse, bytes->data, size, TIDES_BAD_FILE, "t.splats");
}

void splat_near(const char *what, const float *got, const double *expected, size_t count, double tolerance) {
    for (size_t i = 0; i < count; i++)
        if (!(fabs((double)got[i] - expected[i]) <= tolerance))
            fail_msg("%s[%zu] is %.9g, expected %.9g", what, i, (double)got[i], expected[i]);
}
