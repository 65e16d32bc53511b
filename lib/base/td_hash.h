/* Internal: the library's two hashes of 64 bits. td_hash_bytes is FNV-1a (Fowler, Noll and Vo, with their offset and prime).
 * td_hash_words is a faster relative of it, for arrays. Both detect changes, mix-ups and damage, and are no defence against
 * malice. Neither function may change, because files hold their values: checkpoints those of td_hash_words, results of a
 * batch those of td_hash_bytes. */
#ifndef TD_HASH_H
#define TD_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define TD_HASH_START UINT64_C(0xcbf29ce484222325)
#define TD_HASH_PRIME UINT64_C(0x100000001b3)

/* Hashes bytes. It continues from `hash`, TD_HASH_START at first. Bytes hashed in pieces give the hash of the whole. */
static inline uint64_t td_hash_bytes(uint64_t hash, const void *data, size_t bytes) {
    const unsigned char *at = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ at[i]) * TD_HASH_PRIME;
    return hash;
}

/* A hash for arrays, by 8-byte words: eight times as fast as td_hash_bytes. It continues from `sum`, 0 at first. The number of
 * bytes of each call is hashed, too, so pieces give another hash than the whole. Multiplication carries a bit only to higher
 * bits, so the high half is then folded into the low one. */
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
