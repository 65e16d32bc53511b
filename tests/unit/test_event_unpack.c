/* LZ4 frames of AEDAT 4's packets: all that the format allows unpacks; damaged, incomplete or too large ones are reported. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "events/td_aedat4.h"

#include <lz4frame.h>
#include <stdlib.h>
#include <string.h>

enum { BYTES = 300000, MOST = 1 << 20 };

static unsigned char plain[BYTES], packed[2 * BYTES];

static void fill(void) {
    for (int i = 0; i < BYTES; i++) plain[i] = (unsigned char)((int64_t)i * i >> 9 ^ i % 23);
}

static size_t pack(int size, const LZ4F_preferences_t *preferences) {
    const size_t made = LZ4F_compressFrame(packed, sizeof packed, plain, (size_t)size, preferences);
    assert_false(LZ4F_isError(made));
    return made;
}

typedef struct unpacked {
    unsigned char *bytes;
    size_t capacity, got;
    tides_error error;
} unpacked;

static tides_status unpack(unpacked *u, size_t size, size_t most) {
    *u = (unpacked){.bytes = NULL};
    return td_lz4_unpack(packed, size, most, &u->bytes, &u->capacity, &u->got, &u->error);
}

/* Every block size, linked and independent blocks, with and without checksums and the size; nothing at all, and much. */
static void frames_unpack(void **state) {
    (void)state;
    fill();
    for (int kind = 0; kind < 32; kind++) {
        const LZ4F_preferences_t preferences = {
            .frameInfo = {.blockSizeID = kind & 1 ? LZ4F_max64KB : LZ4F_max1MB,
                          .blockMode = kind & 2 ? LZ4F_blockLinked : LZ4F_blockIndependent,
                          .contentChecksumFlag = kind & 4 ? LZ4F_contentChecksumEnabled : LZ4F_noContentChecksum,
                          .blockChecksumFlag = kind & 8 ? LZ4F_blockChecksumEnabled : LZ4F_noBlockChecksum,
                          .contentSize = kind & 16 ? BYTES : 0}};
        unpacked u;
        const size_t size = pack(BYTES, &preferences);
        assert_int_equal(unpack(&u, size, MOST), TIDES_OK);
        assert_int_equal(u.got, BYTES);
        assert_memory_equal(u.bytes, plain, BYTES);
        free(u.bytes);
        assert_int_equal(unpack(&u, size, BYTES), TIDES_OK); /* exactly as much as is allowed */
        assert_int_equal(u.got, BYTES);
        free(u.bytes);
        assert_int_equal(unpack(&u, size, BYTES - 1), TIDES_BAD_FILE);
        free(u.bytes);
    }
    unpacked u;
    assert_int_equal(unpack(&u, pack(0, NULL), MOST), TIDES_OK);
    assert_int_equal(u.got, 0);
    free(u.bytes);
}

/* With a checksum of the content no byte of a frame can change unnoticed: literals, that nothing else tells, neither. */
static void damage_is_noticed(void **state) {
    (void)state;
    fill();
    const int length = 2000;
    const LZ4F_preferences_t preferences = {.frameInfo = {.contentChecksumFlag = LZ4F_contentChecksumEnabled}};
    const size_t size = pack(length, &preferences);
    for (size_t at = 0; at < size; at++) {
        unpacked u;
        packed[at] ^= 0x10;
        const tides_status status = unpack(&u, size, MOST);
        if (status == TIDES_OK) fail_msg("byte %zu of %zu may be wrong", at, size);
        assert_int_equal(status, TIDES_BAD_FILE);
        assert_non_null(strstr(u.error.text, "LZ4"));
        packed[at] ^= 0x10;
        free(u.bytes);
    }
    for (size_t kept = 0; kept < size; kept++) {
        unpacked u;
        assert_int_equal(unpack(&u, kept, MOST), TIDES_BAD_FILE);
        free(u.bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_unpack), cmocka_unit_test(damage_is_noticed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
