/* Loops over many doubles, for the vectors that the processor has. */
#ifndef TD_WIDE_H
#define TD_WIDE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Such a function is compiled more than once, and the loader takes the widest that runs here (gcc's target_clones). The library
 * itself is built for any x86-64, whose vectors hold two doubles. All have the same bits: nothing is contracted (-ffp-contract)
 * or reordered. Loops of comparisons gain most: with AVX-512 a comparison is a mask. Sanitizers aren't up yet when the loader
 * asks. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TD_WIDE __attribute__((__target_clones__("avx512f", "avx2", "default")))
#else
#define TD_WIDE
#endif

/* A function that such a loop calls must be in the loop, however long it is: a call is never on whole vectors. */
#if defined(__GNUC__)
#define TD_WITHIN static inline __attribute__((__always_inline__))
#else
#define TD_WITHIN static inline
#endif

/* floor, in additions that vectorise with any vectors; of numbers in [0, 2^51). */
static inline double td_whole(double x) {
    const double nearest = (x + 0x1p52) - 0x1p52;
    return nearest - (nearest > x ? 1.0 : 0.0);
}

/* Numbers that a loop's vectors fill, of so many: at most 7 more. Where what is there is filled up with more of the like, no
 * number is left over to be done by itself, which takes as long as eight do. */
static inline int td_whole_vectors(int count) { return (int)(((unsigned)count + 7) & ~7U); }

/* A whole number in [0, 2^52) as an integer, likewise. */
static inline int64_t td_integer(double x) {
    const double shifted = x + 0x1p52, none = 0x1p52;
    int64_t bits, bits_of_none;
    memcpy(&bits, &shifted, sizeof bits);
    memcpy(&bits_of_none, &none, sizeof bits_of_none);
    return bits - bits_of_none;
}

/* Asks for memory that is read soon. */
#if defined(__GNUC__)
#define TD_SOON(place) __builtin_prefetch(place)
#else
#define TD_SOON(place) ((void)(place))
#endif

/* The first k' >= k with mark[k'] != 0, or count. Marks are 0.0 or 1.0, and few are 1: eight are passed over at a time. */
static inline size_t td_next_mark(const double *mark, size_t k, size_t count) {
    enum { EACH = 8 };
    for (; k + EACH <= count; k += EACH) {
        uint64_t bits[EACH], any = 0;
        memcpy(bits, mark + k, sizeof bits);
        for (int i = 0; i < EACH; i++) any |= bits[i];
        if (any) break;
    }
    /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): it doesn't follow td_whole_vectors */
    while (k < count && mark[k] == 0.0) k++;
    return k;
}

#endif
