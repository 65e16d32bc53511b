/* Test support: random numbers of a property test, from a seed that is printed; TIDES_TEST_SEED sets it. */
#ifndef SEEDED_H
#define SEEDED_H

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static uint64_t random_state;

/* `usual` is the test's own seed, `salt` that of one of its cases. */
static inline void seed_from(uint64_t usual, uint64_t salt) {
    const char *text = getenv("TIDES_TEST_SEED");
    const uint64_t seed = text ? strtoull(text, NULL, 10) : usual;
    print_message("seed %" PRIu64 "\n", seed);
    random_state = (seed ^ salt) * 0x9E3779B97F4A7C15ULL | 1;
}

/* xorshift64*: Vigna 2016. */
static inline double uniform(double low, double high) {
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return low + (high - low) * ((double)(random_state * 2685821657736338717ULL >> 11) * 0x1p-53);
}

static inline double any_power(double low, double high) { return exp(uniform(log(low), log(high))); }

#endif
