/* Counter-based random numbers: the published values, independence of what they are for, and their distributions. */
#include "sensor/td_random.h"

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
        assert_true(uniform[i] > 0 && uniform[i] < 1);
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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_published_values), cmocka_unit_test(test_arguments_matter),
                                       cmocka_unit_test(test_distributions), cmocka_unit_test(test_uniform_ends)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
