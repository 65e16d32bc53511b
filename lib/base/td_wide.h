/* Internal: makes loops over many doubles use the widest vectors of the processor. */
#ifndef TD_WIDE_H
#define TD_WIDE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A function marked TD_WIDE is compiled for several instruction sets, and the loader picks the widest that runs here (gcc's
 * target_clones). The library itself is built for any x86-64, whose vectors hold two doubles. The bits are the same in all
 * versions: nothing is contracted (-ffp-contract) or reordered. Not with sanitizers: these aren't ready yet when the loader
 * picks. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TD_WIDE_CLONES 1
#define TD_WIDE __attribute__((__target_clones__("avx512f", "avx2", "default")))
#else
#define TD_WIDE_CLONES 0
#define TD_WIDE
#endif

/* Bits of the vectors that such loops have here: of AVX-512, AVX2, and SSE2 or NEON; those of a double elsewhere. */
static inline int32_t td_wide_bits(void) {
#if TD_WIDE_CLONES
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f")) return 512;
    if (__builtin_cpu_supports("avx2")) return 256;
#endif
#if defined(__x86_64__) || defined(__aarch64__)
    return 128;
#else
    return 64;
#endif
}

/* For functions called in such loops: they must be inlined, however long, because a call stops vectorisation. */
#if defined(__GNUC__)
#define TD_WITHIN static inline __attribute__((__always_inline__))
#else
#define TD_WITHIN static inline
#endif

/* For functions that mustn't be inlined. */
#if defined(__GNUC__)
#define TD_BESIDE __attribute__((__noinline__))
#else
#define TD_BESIDE
#endif

/* floor of x in [0, 2^51), by additions, which vectorise everywhere. */
static inline double td_whole(double x) {
    const double nearest = (x + 0x1p52) - 0x1p52;
    return nearest - (nearest > x ? 1.0 : 0.0);
}

/* `count` rounded up to a multiple of 8. A loop whose array is padded so far has no remainder; a remainder of one number
 * takes as long as eight. */
static inline int td_whole_vectors(int count) { return (int)(((unsigned)count + 7) & ~7U); }

/* Converts a whole number in [0, 2^52) to an integer by an addition, which vectorises everywhere. */
static inline int64_t td_integer(double x) {
    const double shifted = x + 0x1p52, none = 0x1p52;
    int64_t bits, bits_of_none;
    memcpy(&bits, &shifted, sizeof bits);
    memcpy(&bits_of_none, &none, sizeof bits_of_none);
    return bits - bits_of_none;
}

/* Prefetches memory that is read a little later. */
#if defined(__GNUC__)
#define TD_PREFETCH(place) __builtin_prefetch(place)
#else
#define TD_PREFETCH(place) ((void)(place))
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
    /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): the analyzer doesn't follow td_whole_vectors */
    while (k < count && mark[k] == 0.0) k++;
    return k;
}

#endif
