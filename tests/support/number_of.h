/* Test support: numbers that the user of a test sets in the environment. */
#ifndef TESTS_SUPPORT_NUMBER_OF_H
#define TESTS_SUPPORT_NUMBER_OF_H

#include <stdint.h>
#include <stdlib.h>

/* The number in an environment variable; `fallback` if it isn't set. */
static inline uint64_t number_of(const char *variable, uint64_t fallback) {
    const char *text = getenv(variable);
    return text && *text ? strtoull(text, NULL, 10) : fallback;
}

#endif
