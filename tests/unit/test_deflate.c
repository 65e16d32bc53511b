/* Our deflate against zlib's inflate: every kind of plane that columns of events have, and those that try its bounds. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_deflate.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { LARGEST = 8 * 65536, GUARD = 64 };

static unsigned char bytes[LARGEST], back[LARGEST + 1], packed[TD_DEFLATE_ROOM(LARGEST) + GUARD];

static uint64_t next_random(uint64_t *state) { /* xorshift64*: Vigna 2016 */
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 2685821657736338717ULL;
}

/* Comes back as it was, within its room; how long it became. */
static size_t check(size_t count, size_t plane) {
    const size_t room = TD_DEFLATE_ROOM(count);
    memset(packed + room, 0xa5, GUARD);
    const size_t length = td_deflate(bytes, count, plane, packed);
    assert_true(length <= room);
    for (int k = 0; k < GUARD; k++) assert_int_equal(packed[room + (size_t)k], 0xa5);
    uLongf got = LARGEST + 1;
    assert_int_equal(uncompress(back, &got, packed, length), Z_OK);
    assert_int_equal(got, count);
    assert_memory_equal(back, bytes, count);
    return length;
}

enum { ZERO, NOISE, TWO, RUNS, RAMP, SKEWED, BURSTS, TEXT, KINDS };

static void fill(unsigned char *to, size_t count, int kind, uint64_t *random) {
    static const char words[] = "events of a camera that moves, ";
    unsigned char value = (unsigned char)next_random(random);
    for (size_t i = 0; i < count; i++) {
        const uint64_t r = next_random(random) >> 32;
        switch (kind) {
            case ZERO: to[i] = 0; break;
            case NOISE: to[i] = (unsigned char)r; break;
            case TWO: to[i] = r % 4 == 0; break;
            case RUNS: to[i] = value = r % 30 ? value : (unsigned char)(r >> 8); break;
            case RAMP: to[i] = value = (unsigned char)(value + (r % 4 == 0)); break;
            case SKEWED: /* half of them 0, a quarter 1 ..: codes as long as they come */
                to[i] = 0;
                while (to[i] < 30 && r >> to[i] & 1) to[i]++;
                break;
            case BURSTS: to[i] = i / 5000 % 2 ? (unsigned char)r : 7; break;
            default: to[i] = (unsigned char)words[(i + r % 50 / 49) % (sizeof words - 1)]; break;
        }
    }
}

static void all_kinds_come_back(void **state) {
    (void)state;
    uint64_t random = 1;
    static const size_t counts[] = {0, 1, 2, 3, 4, 5, 7, 8, 63, 258, 259, 1000, 32768, 65535, 65536, 65537, 200001};
    for (int kind = 0; kind < KINDS; kind++)
        for (size_t k = 0; k < sizeof counts / sizeof counts[0]; k++) {
            fill(bytes, counts[k], kind, &random);
            check(counts[k], 0);
            check(counts[k], 1000);
        }
}

/* Planes of different kinds after one another, as a column has them, of any length. */
static void planes_come_back(void **state) {
    (void)state;
    uint64_t random = 2;
    for (int trial = 0; trial < 100; trial++) {
        const size_t plane = trial % 4 ? next_random(&random) % 20000 + 1 : 65536, planes = next_random(&random) % 8 + 1;
        for (size_t k = 0; k < planes; k++) fill(bytes + k * plane, plane, (int)(next_random(&random) % KINDS), &random);
        check(plane * planes, plane);
    }
}

/* Weights like Fibonacci's numbers make Huffman's deepest trees: deeper than deflate's 15. */
static void deep_trees_are_bounded(void **state) {
    (void)state;
    size_t count = 0, a = 1, b = 1;
    for (unsigned char value = 0; count + a <= 120000; value++) {
        for (size_t k = 0; k < a; k++) bytes[count++] = value;
        const size_t sum = a + b;
        a = b;
        b = sum;
    }
    uint64_t random = 3;
    for (size_t k = count - 1; k > 0; k--) { /* shuffled: no runs */
        const size_t other = next_random(&random) % (k + 1);
        const unsigned char kept = bytes[k];
        bytes[k] = bytes[other];
        bytes[other] = kept;
    }
    for (size_t length = 3; length <= count; length += length / 3) check(length, 0);
    check(count, 0);
}

/* What zlib makes of a plane at its level 1, ours makes no more than a twentieth longer, whatever the plane. */
static void planes_become_short(void **state) {
    (void)state;
    uint64_t random = 4;
    for (int kind = 0; kind < KINDS; kind++) {
        fill(bytes, 65536, kind, &random);
        uLongf theirs = LARGEST;
        assert_int_equal(compress2(back, &theirs, bytes, 65536, 1), Z_OK);
        const size_t ours = check(65536, 65536);
        if (ours > theirs + theirs / 20 + 64) fail_msg("kind %d: %zu bytes, zlib takes %lu", kind, ours, theirs);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_kinds_come_back),
        cmocka_unit_test(planes_come_back),
        cmocka_unit_test(deep_trees_are_bounded),
        cmocka_unit_test(planes_become_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
