/* Vectors of sixteen numbers, as the compiler has them, and masks, which AVX-512 keeps in registers of their own. Comparisons
 * of the compiler's own vectors would serve other machines too. They were tried and left out, because gcc 12 splits them lane
 * by lane, which is forty times as slow. */
#ifndef LIMIT_VECTOR_H
#define LIMIT_VECTOR_H

#include <immintrin.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#define LIMIT_INLINE static inline __attribute__((always_inline))

enum { LANES = 16 };
typedef float vec __attribute__((vector_size(64)));
typedef int32_t ivec __attribute__((vector_size(64)));

LIMIT_INLINE vec splat(float x) { return x - (vec){0}; }
LIMIT_INLINE vec load(const float *at) {
    vec v;
    memcpy(&v, at, sizeof v);
    return v;
}
LIMIT_INLINE void store(float *at, vec v) { memcpy(at, &v, sizeof v); }
LIMIT_INLINE ivec bits_of(vec v) { return (ivec)v; }
LIMIT_INLINE vec from_bits(ivec v) { return (vec)v; }

typedef __mmask16 mask;
LIMIT_INLINE mask at_least(vec a, vec b) { return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GE_OQ); }
LIMIT_INLINE mask above(vec a, vec b) { return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GT_OQ); }
LIMIT_INLINE vec choose(mask m, vec yes, vec no) { return (vec)_mm512_mask_blend_ps(m, (__m512)no, (__m512)yes); }
LIMIT_INLINE vec keep(mask m, vec v) { return (vec)_mm512_maskz_mov_ps(m, (__m512)v); }
LIMIT_INLINE mask below_where(mask m, vec a, vec b) { return _mm512_mask_cmp_ps_mask(m, (__m512)a, (__m512)b, _CMP_LT_OQ); }
LIMIT_INLINE mask both(mask a, mask b) { return _kand_mask16(a, b); }
LIMIT_INLINE mask but(mask a, mask b) { return _kandn_mask16(b, a); }
LIMIT_INLINE int any(mask m) { return m != 0; }
LIMIT_INLINE uint32_t bits(mask m) { return m; }
LIMIT_INLINE mask all_lanes(void) { return 0xffff; }
LIMIT_INLINE vec smaller(vec a, vec b) { return (vec)_mm512_min_ps((__m512)a, (__m512)b); }
LIMIT_INLINE vec larger(vec a, vec b) { return (vec)_mm512_max_ps((__m512)a, (__m512)b); }
LIMIT_INLINE vec root(vec a) { return (vec)_mm512_sqrt_ps((__m512)a); }
/* Writes the numbers, from `first` on, of those of sixteen masks that have the bit side by side. Returns how many there are. It
 * writes a whole vector. */
LIMIT_INLINE int32_t put_reaching(const uint16_t masks[LANES], int32_t bit, int32_t first, int32_t *to) {
    const __m512i number = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    const __m512i all = _mm512_cvtepu16_epi32(_mm256_loadu_si256((const void *)masks));
    const mask has = _mm512_test_epi32_mask(all, _mm512_set1_epi32(1 << bit));
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(has, _mm512_add_epi32(number, _mm512_set1_epi32(first))));
    return __builtin_popcount(has);
}

/* 2^x, as kernels/numerics.h has it; x above -126. */
LIMIT_INLINE vec power_of_2(vec x) {
    const vec shifted = x + 12582912.0f; /* 1.5 2^23: rounds */
    const vec r = x - (shifted - 12582912.0f);
    vec p = 1.31917966e-3f * r + 9.67185199e-3f;
    p = p * r + 5.55099323e-2f;
    p = p * r + 2.40222335e-1f;
    p = p * r + 6.93146765e-1f;
    p = p * r + 1.0f;
    return from_bits(bits_of(p) + (bits_of(shifted) << 23));
}

/* ln x of normal positive numbers: x = 2^e m with m about 1, ln m = 2 artanh((m - 1) / (m + 1)). */
LIMIT_INLINE vec natural_log(vec x) {
    const ivec from = bits_of(x) - 0x3f3504f3; /* sqrt(1/2) */
    const vec e = __builtin_convertvector(from >> 23, vec);
    const vec m = from_bits((from & 0x7fffff) + 0x3f3504f3);
    const vec s = (m - 1.0f) / (m + 1.0f), q = s * s;
    return e * 0.693147181f + 2.0f * s * (1.0f + q * (1 / 3.0f + q * (1 / 5.0f + q * (1 / 7.0f + q * (1 / 9.0f)))));
}

/* A number, and its rate. */
typedef struct dual {
    vec v, d;
} dual;

LIMIT_INLINE dual make(vec v, vec d) { return (dual){v, d}; }
LIMIT_INLINE dual add(dual a, dual b) { return make(a.v + b.v, a.d + b.d); }
LIMIT_INLINE dual sub(dual a, dual b) { return make(a.v - b.v, a.d - b.d); }
LIMIT_INLINE dual scale(dual a, float s) { return make(a.v * s, a.d * s); }
LIMIT_INLINE dual mul(dual a, dual b) { return make(a.v * b.v, a.d * b.v + a.v * b.d); }
LIMIT_INLINE dual reciprocal(dual a) {
    const vec r = 1.0f / a.v;
    return make(r, -a.d * r * r);
}

#endif
