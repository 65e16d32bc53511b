/* Internal: deflate's codes, and bits to memory, for deflate.c. */
#ifndef TD_DEFLATE_CODE_H
#define TD_DEFLATE_CODE_H

#include "td_endian.h"

#include <stddef.h>
#include <stdint.h>

/* -- bits, the lowest first ------------------------------------------------------------------------------------------------ */

/* Eight bytes after `to` may be written at any time. */
typedef struct td_bits {
    unsigned char *to;
    uint64_t waiting;
    unsigned count; /* of them: below 8 after a flush */
} td_bits;

static inline void td_bits_begin(td_bits *b, unsigned char *to) { *b = (td_bits){to, 0, 0}; }

/* Without a flush: 56 bits between two. */
static inline void td_bits_add(td_bits *b, uint32_t bits, unsigned count) {
    b->waiting |= (uint64_t)bits << b->count;
    b->count += count;
}

static inline void td_bits_flush(td_bits *b) {
    td_put_le64(b->to, b->waiting);
    b->to += b->count >> 3;
    b->waiting >>= b->count & ~7u;
    b->count &= 7;
}

static inline void td_bits_put(td_bits *b, uint32_t bits, unsigned count) {
    td_bits_add(b, bits, count);
    td_bits_flush(b);
}

/* To the next whole byte. */
static inline void td_bits_align(td_bits *b) { td_bits_put(b, 0, (8 - b->count) & 7); }

/* -- codes ----------------------------------------------------------------------------------------------------------------- */

enum { TD_END_OF_BLOCK = 256, TD_SYMBOLS = 286, TD_DISTANCES = 30 };

typedef struct td_code {
    uint16_t bits; /* the first one lowest */
    uint8_t length;
} td_code;

/* A symbol and what follows it. */
typedef struct td_extra {
    uint32_t symbol, extra;
    unsigned bits;
} td_extra;

/* RFC 1951, 3.2.5: four symbols for each further bit, from 3 bytes on; two from 1 byte back on. */
static inline td_extra td_length_code(uint32_t length) {
    if (length == 258) return (td_extra){285, 0, 0};
    const uint32_t n = length - 3;
    unsigned bits = 0;
    while (n >> (bits + 3)) bits++;
    return (td_extra){257 + 4 * bits + (n >> bits), n & ((1u << bits) - 1), bits};
}

static inline td_extra td_distance_code(uint32_t distance) {
    const uint32_t n = distance - 1;
    unsigned bits = 0;
    while (n >> (bits + 2)) bits++;
    return (td_extra){2 * bits + (n >> bits), n & ((1u << bits) - 1), bits};
}

typedef struct td_codes {
    td_code symbol[TD_SYMBOLS], distance[TD_DISTANCES];
    /* how they are told: the lengths of both, runs of them as one symbol */
    int symbols, distances, told_count;
    td_extra told[TD_SYMBOLS + TD_DISTANCES];
    td_code tell[19];
    int tells;
} td_codes;

/* For symbols seen so often, TD_END_OF_BLOCK among them; what the block takes [bits]. */
uint64_t td_codes_make(td_codes *codes, const uint32_t *symbols, const uint32_t *distances);

/* A coded block's beginning. */
void td_codes_put(td_bits *out, const td_codes *codes, int is_last);

#endif
