/* Internal: the library's one hash, FNV-1a of 64 bits (Fowler, Noll and Vo, with their offset and prime). It detects
 * changes, mix-ups and damage, and is no defence against malice. Checkpoints and batches store its values in files, so
 * neither function may change. */
#ifndef TD_HASH_H
#define TD_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define TD_HASH_START UINT64_C(0xcbf29ce484222325)
#define TD_HASH_PRIME UINT64_C(0x100000001b3)

/* Continues from `hash`, TD_HASH_START at first. Bytes hashed in pieces give the hash of the whole. */
static inline uint64_t td_hash_bytes(uint64_t hash, const void *data, size_t bytes) {
    const unsigned char *at = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ at[i]) * TD_HASH_PRIME;
    return hash;
}

/* A hash of 8-byte words, eight times as fast, for arrays. It continues from `sum`, 0 at first. The number of bytes of each
 * call is hashed, too, so pieces give another hash than the whole. The odd multiplier carries each bit only upwards, so the
 * high half is folded down again. */
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
