/* Internal: FNV-1a of 64 bits (Fowler, Noll and Vo; the offset and the prime are theirs), the one hash of the library: for what
 * changed, mix-ups and damage, no defence against malice. Files store its values (seals of checkpoints, fingerprints and names
 * of a batch's runs): neither form may change. */
#ifndef TD_HASH_H
#define TD_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define TD_HASH_START UINT64_C(0xcbf29ce484222325)
#define TD_HASH_PRIME UINT64_C(0x100000001b3)

/* Goes on from `hash`, TD_HASH_START to begin: bytes in pieces hash as the whole does. */
static inline uint64_t td_hash_bytes(uint64_t hash, const void *data, size_t bytes) {
    const unsigned char *at = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ at[i]) * TD_HASH_PRIME;
    return hash;
}

/* On words of 8 bytes instead of bytes: eight times as fast, for arrays. Goes on from `sum`, 0 to begin; each call's number of
 * bytes counts, so pieces hash otherwise than the whole. The odd multiplier carries each bit only upwards, so the high half is
 * folded down again. */
static inline uint64_t td_hash_words(uint64_t sum, const void *data, size_t bytes) {
    const unsigned char *at = data;
    uint64_t hash = sum ^ TD_HASH_START ^ (uint64_t)bytes;
    for (; bytes > 0; at += 8) {
        const size_t taken = bytes < 8 ? bytes : 8;
        uint64_t word = 0;
        memcpy(&word, at, taken);
        hash = (hash ^ word) * TD_HASH_PRIME;
        hash ^= hash >> 32;
        bytes -= taken;
    }
    return hash;
}

#endif
