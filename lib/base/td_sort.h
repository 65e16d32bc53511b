/* Internal: a comparator of doubles for qsort, and one pass of a radix sort for items with a whole-number key. */
#ifndef TD_SORT_H
#define TD_SORT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* For qsort and bsearch of doubles without NaN: ascending. */
static inline int td_ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A radix sort makes a pass for each digit of the key, the lowest first, and exchanges `in` and `out` after each. 2048
 * counters fill half of a 32 KiB L1 cache: digits of 8 bits would take more passes, and 16 would miss the cache. */
enum { TD_RADIX_BITS = 11, TD_RADIX_DIGITS = 1 << TD_RADIX_BITS };

/* Returns an item's key; a pass sorts by the digit at bit `shift` of it. */
typedef uint64_t (*td_radix_key)(const void *context, const void *item);

/* One stable pass over `count` items of `size` bytes. Call it with constant `key` and `size`: inlined, the compiler then
 * makes a loop for exactly this type. */
#if defined(__GNUC__)
__attribute__((__always_inline__))
#endif
static inline void
td_radix_pass(td_radix_key key, const void *context, int shift, const void *in, void *out, size_t count, size_t size) {
    const char *from = in;
    size_t place[TD_RADIX_DIGITS] = {0}, next = 0;
    for (size_t i = 0; i < count; i++) place[key(context, from + i * size) >> shift & (TD_RADIX_DIGITS - 1)]++;
    for (int digit = 0; digit < TD_RADIX_DIGITS; digit++) {
        const size_t here = place[digit];
        place[digit] = next;
        next += here;
    }
    for (size_t i = 0; i < count; i++)
        memcpy((char *)out + size * place[key(context, from + i * size) >> shift & (TD_RADIX_DIGITS - 1)]++, from + i * size,
               size);
}

#endif
