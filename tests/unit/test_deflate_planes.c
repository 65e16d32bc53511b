/* Planes of bytes of every kind, alone and together: zlib and libdeflate unpack them, none takes more bytes than it should, and
 * without room nothing is written beyond the end. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "archive/td_deflate_planes.h"

#include <libdeflate.h>
#include <zlib.h>

static uint64_t random_next(uint64_t *state) { /* xorshift64*: Vigna 2016 */
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 2685821657736338717ULL >> 16;
}

typedef enum kind { NOISE, SAME, TWO, RUNS, RAMP, KINDS } kind;

static void fill(kind what, size_t count, uint64_t *seed, unsigned char *plane) {
    const unsigned char one = (unsigned char)random_next(seed), other = (unsigned char)random_next(seed);
    const uint64_t rarely = 2 + random_next(seed) % 8;
    unsigned char now = one;
    for (size_t i = 0; i < count; i++) {
        const uint64_t drawn = random_next(seed);
        if (drawn % 20 == 0) now = (unsigned char)(drawn >> 8);
        switch (what) {
            case NOISE: plane[i] = (unsigned char)drawn; break;
            case SAME: plane[i] = one; break;
            case TWO: plane[i] = drawn % rarely == 0 ? other : one; break;
            case RUNS: plane[i] = now; break;
            default: plane[i] = (unsigned char)(i / 5); break;
        }
    }
}

static void assert_comes_back(const unsigned char *bytes, size_t size, const unsigned char *packed, size_t length) {
    unsigned char *back = malloc(size + 1);
    uLongf got = (uLongf)size + 1;
    assert_int_equal(uncompress(back, &got, packed, (uLong)length), Z_OK);
    assert_int_equal(got, size);
    assert_memory_equal(back, bytes, size);
    memset(back, 0, size);
    struct libdeflate_decompressor *decoder = libdeflate_alloc_decompressor();
    assert_int_equal(libdeflate_zlib_decompress(decoder, packed, length, back, size, NULL), LIBDEFLATE_SUCCESS);
    assert_memory_equal(back, bytes, size);
    libdeflate_free_decompressor(decoder);
    free(back);
}

/* Packed in just so many bytes, and not in fewer. */
static size_t check(const unsigned char *bytes, size_t count, size_t planes) {
    const size_t size = planes * count, room = size + size / 64 + 1024;
    unsigned char *packed = malloc(room);
    const size_t length = td_deflate_planes(bytes, count, planes, packed, room);
    assert_true(length > 0 && length <= room);
    assert_comes_back(bytes, size, packed, length);
    for (size_t less = 0; less < length; less += 1 + length / 7) {
        unsigned char *exact = malloc(less + 1); /* so that the sanitisers see a byte written behind it */
        exact[less] = 0x5a;
        assert_int_equal(td_deflate_planes(bytes, count, planes, exact, less), 0);
        assert_int_equal(exact[less], 0x5a);
        free(exact);
    }
    free(packed);
    return length;
}

static const size_t counts[] = {1, 2, 3, 7, 8, 9, 128, 129, 258, 259, 260, 4099, 65536, 70001};
enum { COUNTS = sizeof counts / sizeof *counts };

static void test_kinds(void **state) {
    unsigned char *plane = malloc(counts[COUNTS - 1]);
    uint64_t seed = 1;
    (void)state;
    for (int c = 0; c < COUNTS; c++)
        for (int what = 0; what < KINDS; what++) {
            fill((kind)what, counts[c], &seed, plane);
            check(plane, counts[c], 1);
        }
    free(plane);
}

/* Every byte throughout, and every distance between two of them, at the ends of the alphabet too. */
static void test_alphabet(void **state) {
    enum { COUNT = 1000 };
    unsigned char plane[COUNT];
    uint64_t seed = 2;
    (void)state;
    for (unsigned byte = 0; byte < 256; byte++) {
        memset(plane, (int)byte, COUNT);
        assert_true(check(plane, COUNT, 1) < 80);
        const unsigned other = byte < 128 ? 255 - byte : byte - 1;
        for (int i = 0; i < COUNT; i++)
            if (random_next(&seed) % 3 == 0) plane[i] = (unsigned char)other;
        assert_true(check(plane, COUNT, 1) < COUNT / 8 * 4 / 3 + 80);
    }
}

static void test_together(void **state) {
    enum { COUNT = 5000, ROUNDS = 200 };
    unsigned char *planes = malloc(COUNT * TD_DEFLATE_PLANES);
    uint64_t seed = 3;
    (void)state;
    for (int round = 0; round < ROUNDS; round++) {
        const size_t count = 1 + random_next(&seed) % COUNT, some = 1 + random_next(&seed) % TD_DEFLATE_PLANES;
        for (size_t k = 0; k < some; k++) {
            fill((kind)(random_next(&seed) % KINDS), count, &seed, planes + k * count);
            if (k > 0 && random_next(&seed) % 3 == 0) memcpy(planes + k * count, planes + (k - 1) * count, count);
        }
        check(planes, count, some);
    }
    free(planes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_alphabet),
        cmocka_unit_test(test_together),
    };
    return cmocka_run_group_tests_name("archive: planes of bytes deflated", tests, NULL, NULL);
}
