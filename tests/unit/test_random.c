/* Counter-based random numbers: the published values, independence of purposes, and their distributions. */
#include "td_random.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <cmocka.h>

/* Known answers of Random123's kat_vectors for philox4x32, ten rounds. */
static void test_published_values(void **state) {
    (void)state;
    static const uint32_t counter[3][4] = {{0, 0, 0, 0},
                                           {~0u, ~0u, ~0u, ~0u},
                                           {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}};
    static const uint32_t key[3][2] = {{0, 0}, {~0u, ~0u}, {0xa4093822, 0x299f31d0}};
    static const uint32_t expected[3][4] = {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8},
                                            {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd},
                                            {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}};
    for (int i = 0; i < 3; i++) {
        td_random_bits bits = td_philox(counter[i], key[i]);
        assert_memory_equal(bits.word, expected[i], sizeof bits.word);
    }
}

/* Each argument changes the number. */
static void test_arguments_matter(void **state) {
    (void)state;
    td_random_bits base = td_random(7, 3, 5, TD_RANDOM_THRESHOLD);
    td_random_bits others[] = {td_random(8, 3, 5, TD_RANDOM_THRESHOLD),
                               td_random(7 + (1ull << 32), 3, 5, TD_RANDOM_THRESHOLD),
                               td_random(7, 4, 5, TD_RANDOM_THRESHOLD),
                               td_random(7, 3, 6, TD_RANDOM_THRESHOLD),
                               td_random(7, 3, 5 + (1ull << 32), TD_RANDOM_THRESHOLD),
                               td_random(7, 3, 5, TD_RANDOM_LEAK)};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) assert_memory_not_equal(&base, &others[i], sizeof base);
}

enum { DRAWS = 200000 };

/* Mean and variance within 5 standard errors of what the distribution has; the seed is fixed. */
static void check_moments(const char *name, const double *x, double mean, double variance, double fourth) {
    double sum = 0, squares = 0;
    for (int i = 0; i < DRAWS; i++) sum += x[i];
    for (int i = 0; i < DRAWS; i++) squares += (x[i] - mean) * (x[i] - mean);
    printf("%s: mean %.5f (%.5f), variance %.5f (%.5f)\n", name, sum / DRAWS, mean, squares / DRAWS, variance);
    assert_true(fabs(sum / DRAWS - mean) < 5 * sqrt(variance / DRAWS));
    assert_true(fabs(squares / DRAWS - variance) < 5 * sqrt((fourth - variance * variance) / DRAWS));
}

static void test_distributions(void **state) {
    (void)state;
    static double uniform[DRAWS], normal[DRAWS], exponential[DRAWS];
    for (int i = 0; i < DRAWS; i++) {
        td_random_bits bits = td_random(1, (uint32_t)i, 0, TD_RANDOM_NOISE);
        double pair[2];
        td_random_normals(&bits, pair);
        uniform[i] = td_random_uniform(&bits, i & 1);
        assert_true(uniform[i] > 0);
        assert_true(uniform[i] < 1);
        normal[i] = pair[i & 1];
        exponential[i] = td_random_exponential(&bits, i & 1);
    }
    check_moments("uniform", uniform, 0.5, 1.0 / 12, 1.0 / 80);
    check_moments("normal", normal, 0, 1, 3);
    check_moments("exponential", exponential, 1, 1, 9);
}

/* The ends of the uniform's range are never drawn, whatever the bits. */
static void test_uniform_ends(void **state) {
    (void)state;
    td_random_bits none = {{0, 0, 0, 0}}, all = {{~0u, ~0u, ~0u, ~0u}};
    assert_true(td_random_uniform(&none, 0) > 0);
    assert_true(td_random_uniform(&all, 1) < 1);
    assert_true(isfinite(td_random_exponential(&none, 0)));
}

/* Against the long double functions of libm: within a few units in the last place of the radius, ends of the range included. */
static void test_normals(void **state) {
    (void)state;
    const long double two_pi = 6.283185307179586476925286766559L;
    double worst = 0;
    for (uint32_t i = 0; i < DRAWS; i++) {
        td_random_bits bits = td_random(2, i, 0, TD_RANDOM_NOISE);
        if (i % 8 == 0) bits.word[0] = i % 16 ? ~0u : 0; /* near an end, by powers of 2 */
        if (i % 8 == 0) bits.word[1] = i % 16 ? ~0u << i % 32 : ~0u >> i % 32;
        double normal[2];
        td_random_normals(&bits, normal);
        long double radius = sqrtl(-2 * logl(td_random_uniform(&bits, 0))), angle = two_pi * td_random_uniform(&bits, 1);
        double off = (double)fmaxl(fabsl(normal[0] - radius * cosl(angle)), fabsl(normal[1] - radius * sinl(angle)));
        worst = fmax(worst, off / (double)radius);
    }
    printf("normals: off by %.2f units in the last place of their radius\n", worst / DBL_EPSILON);
    assert_true(worst < 4 * DBL_EPSILON);
}

/* In single precision, against the long double functions of libm; all ends of both ranges included, where they stay finite. */
static void test_short(void **state) {
    (void)state;
    const long double two_pi = 6.283185307179586476925286766559L;
    static double normal[DRAWS], exponential[DRAWS];
    double worst = 0;
    for (uint32_t i = 0; i < DRAWS; i++) {
        td_random_bits bits = td_random(3, i, 0, TD_RANDOM_NOISE);
        const int half = (int)(i / 2 % 2);
        float pair[2];
        td_random_short_normals(&bits, half, pair);
        normal[i] = (double)pair[i & 1];
        exponential[i] = td_random_short_exponential(&bits, half);
        if (i % 8 == 0) bits.word[2 * half] = i % 16 ? ~0u << i % 31 : ~0u >> i % 32; /* near an end, by powers of 2 */
        if (i % 16 == 8) bits.word[2 * half + 1] = i % 32 == 8 ? ~0u << i % 31 : 1u << i % 31;
        td_random_short_normals(&bits, half, pair);
        const long double u = (long double)(float)((double)(float)(bits.word[2 * half] >> 1) + 0.5) * 0x1p-31L;
        const long double radius = sqrtl(-2 * logl(u)), turn = (long double)(int32_t)bits.word[2 * half + 1] * 0x1p-32L;
        const long double angle = two_pi * turn;
        worst = fmax(worst, (double)fabsl((long double)pair[0] + radius * cosl(angle)));
        worst = fmax(worst, (double)fabsl((long double)pair[1] + radius * sinl(angle)));
        worst = fmax(worst, (double)fabsl((long double)td_random_short_exponential(&bits, half) + logl(u)) / 22);
        assert_true(isfinite(pair[0]) && isfinite(pair[1]) && fabsf(pair[0]) < 6.7f && fabsf(pair[1]) < 6.7f);
    }
    printf("short normals: off by %.2g at most\n", worst);
    assert_true(worst < 2e-6);
    check_moments("short normal", normal, 0, 1, 3);
    check_moments("short exponential", exponential, 1, 1, 9);
}

/* In lanes, to the bit what they are one by one. */
static void test_lanes(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 1000; i++) {
        uint32_t pixel[TD_RANDOM_LANES];
        uint64_t index[TD_RANDOM_LANES];
        float four[4][TD_RANDOM_LANES], two[2][TD_RANDOM_LANES];
        for (uint32_t k = 0; k < TD_RANDOM_LANES; k++) {
            pixel[k] = i * k;
            index[k] = ((uint64_t)k << 33) + i;
        }
        td_random_lanes lanes;
        td_random_many(i, pixel, index, TD_RANDOM_NOISE, &lanes);
        td_random_short_normals_many(&lanes, four);
        td_random_short_exponentials_many(&lanes, two);
        for (int k = 0; k < TD_RANDOM_LANES; k++) {
            td_random_bits bits = td_random(i, pixel[k], index[k], TD_RANDOM_NOISE);
            float normal[4];
            for (int half = 0; half < 2; half++) td_random_short_normals(&bits, half, normal + 2 * half);
            for (int w = 0; w < 4; w++) assert_int_equal(lanes.word[w][k], bits.word[w]);
            for (int n = 0; n < 4; n++) assert_true(four[n][k] == normal[n]);
            for (int half = 0; half < 2; half++) assert_true((double)two[half][k] == td_random_short_exponential(&bits, half));
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_published_values),
                                       cmocka_unit_test(test_arguments_matter),
                                       cmocka_unit_test(test_distributions),
                                       cmocka_unit_test(test_uniform_ends),
                                       cmocka_unit_test(test_normals),
                                       cmocka_unit_test(test_short),
                                       cmocka_unit_test(test_lanes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
