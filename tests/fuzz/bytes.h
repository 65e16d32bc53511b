/* Shared by the fuzz targets that make worlds: numbers from the input; beyond its end they are 0. */
#ifndef TESTS_FUZZ_BYTES_H
#define TESTS_FUZZ_BYTES_H

#include <stddef.h>
#include <stdint.h>

typedef struct fuzz_bytes {
    const uint8_t *at;
    size_t left;
} fuzz_bytes;

static inline uint32_t fuzz_byte(fuzz_bytes *b) {
    if (!b->left) return 0;
    b->left--;
    return *b->at++;
}

/* In [low, high], by 16 bits. */
static inline double fuzz_between(fuzz_bytes *b, double low, double high) {
    const uint32_t first = fuzz_byte(b);
    return low + (high - low) * (first | fuzz_byte(b) << 8) / 65535;
}

#endif
