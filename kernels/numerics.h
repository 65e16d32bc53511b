/* The dialect: one spelling of scalars, lanes and masks for OpenCL C and for C, and exp and log made of basic operations, so
 * that host and device agree to the bit.
 *
 * A td_lanes is TD_LANES reals that go through the same arithmetic: sixteen pixels (or Gaussians) on a CPU, one on a GPU, one
 * in the scalar reference. Whoever includes this has declared the dialect:
 *   TD_OPENCL         set by the program's prelude, together with TD_LANES = 1, 4, 8 or 16
 *   TD_REAL_DOUBLE    C only: the double-precision reference
 * Rules for everything above it: no contraction (the prelude's first line, -ffp-contract=off on the host), fma() is written
 * where it is wanted; no rint, floor, convert_*_rte, fmin, fmax, any, all (slow in PoCL: DESIGN 3.5). */
#ifndef TD_NUMERICS_H
#define TD_NUMERICS_H

#ifdef TD_OPENCL

#define TD_GLOBAL __global
#define TD_INLINE static inline __attribute__((always_inline))
typedef float td_real;
#if TD_LANES == 1
typedef float td_lanes;
typedef int td_mask;
#define td_bits(x) as_int(x)
#define td_from_bits(x) as_float(x)
#define td_mask_to_real(m) ((float)((m) != 0))
#elif TD_LANES == 4
typedef float4 td_lanes;
typedef int4 td_mask;
#define td_bits(x) as_int4(x)
#define td_from_bits(x) as_float4(x)
#define td_mask_to_real(m) convert_float4(-(m))
#elif TD_LANES == 8
typedef float8 td_lanes;
typedef int8 td_mask;
#define td_bits(x) as_int8(x)
#define td_from_bits(x) as_float8(x)
#define td_mask_to_real(m) convert_float8(-(m))
#elif TD_LANES == 16
typedef float16 td_lanes;
typedef int16 td_mask;
#define td_bits(x) as_int16(x)
#define td_from_bits(x) as_float16(x)
#define td_mask_to_real(m) convert_float16(-(m))
#endif
#define td_splat(x) ((td_lanes)(x))
#define td_fma(a, b, c) fma((td_lanes)(a), (td_lanes)(b), (td_lanes)(c))
#define td_fma_real(a, b, c) fma((td_real)(a), (td_real)(b), (td_real)(c)) /* of numbers that all lanes share */
#define td_sqrt(x) sqrt(x)
#define td_select(otherwise, then, mask) select((td_lanes)(otherwise), (td_lanes)(then), (mask))

#else /* C: one lane */

#include <math.h>
#include <stdint.h>
#include <string.h>
#define TD_GLOBAL
#define TD_INLINE static inline
#define TD_LANES 1
#ifdef TD_REAL_DOUBLE
typedef double td_real;
#define td_fma(a, b, c) fma(a, b, c)
#define td_sqrt(x) sqrt(x)
#else
typedef float td_real;
#define td_fma(a, b, c) fmaf(a, b, c)
#define td_sqrt(x) sqrtf(x)
#endif
typedef td_real td_lanes;
typedef int td_mask;
#define td_fma_real(a, b, c) td_fma(a, b, c)
#define td_splat(x) ((td_real)(x))
#define td_select(otherwise, then, mask) ((mask) ? (td_real)(then) : (td_real)(otherwise))
#define td_mask_to_real(m) ((td_real)((m) != 0))
TD_INLINE int32_t td_bits(float x) {
    int32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
TD_INLINE float td_from_bits(int32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

#endif

/* A literal in the working precision: never a double rounded twice. */
#ifdef TD_REAL_DOUBLE
#define TD_REAL(x) x
#else
#define TD_REAL(x) x##f
#endif
typedef td_mask td_index;

/* array[index] for each lane. */
TD_INLINE td_lanes td_gather(TD_GLOBAL const td_real *array, td_index i) {
#if TD_LANES == 16
    return (float16)(array[i.s0], array[i.s1], array[i.s2], array[i.s3], array[i.s4], array[i.s5], array[i.s6], array[i.s7],
                     array[i.s8], array[i.s9], array[i.sa], array[i.sb], array[i.sc], array[i.sd], array[i.se], array[i.sf]);
#elif TD_LANES == 8
    return (float8)(array[i.s0], array[i.s1], array[i.s2], array[i.s3], array[i.s4], array[i.s5], array[i.s6], array[i.s7]);
#elif TD_LANES == 4
    return (float4)(array[i.x], array[i.y], array[i.z], array[i.w]);
#else
    return array[i];
#endif
}

/* The same for ints. */
TD_INLINE td_index td_gather_ints(TD_GLOBAL const int *array, td_index i) {
#if TD_LANES == 16
    return (int16)(array[i.s0], array[i.s1], array[i.s2], array[i.s3], array[i.s4], array[i.s5], array[i.s6], array[i.s7],
                   array[i.s8], array[i.s9], array[i.sa], array[i.sb], array[i.sc], array[i.sd], array[i.se], array[i.sf]);
#elif TD_LANES == 8
    return (int8)(array[i.s0], array[i.s1], array[i.s2], array[i.s3], array[i.s4], array[i.s5], array[i.s6], array[i.s7]);
#elif TD_LANES == 4
    return (int4)(array[i.x], array[i.y], array[i.z], array[i.w]);
#else
    return array[i];
#endif
}

/* first, first + 1 .. in each lane */
TD_INLINE td_index td_count_from(int first) {
#if TD_LANES == 16
    return first + (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif TD_LANES == 8
    return first + (int8)(0, 1, 2, 3, 4, 5, 6, 7);
#elif TD_LANES == 4
    return first + (int4)(0, 1, 2, 3);
#else
    return first;
#endif
}

/* The larger of an index and 0. */
TD_INLINE td_index td_not_below_0(td_index i) { return i & ~(i >> 31); }

/* TD_LANES neighbours of an int or real array. */
TD_INLINE td_index td_load_ints(TD_GLOBAL const int *array) {
#if TD_LANES == 16
    return vload16(0, array);
#elif TD_LANES == 8
    return vload8(0, array);
#elif TD_LANES == 4
    return vload4(0, array);
#else
    return array[0];
#endif
}
TD_INLINE void td_store_ints(TD_GLOBAL int *array, td_index value) {
#if TD_LANES == 16
    vstore16(value, 0, array);
#elif TD_LANES == 8
    vstore8(value, 0, array);
#elif TD_LANES == 4
    vstore4(value, 0, array);
#else
    array[0] = value;
#endif
}

/* TD_LANES neighbours of an array. */
TD_INLINE td_lanes td_load_lanes(TD_GLOBAL const td_real *array) {
#if TD_LANES == 16
    return vload16(0, array);
#elif TD_LANES == 8
    return vload8(0, array);
#elif TD_LANES == 4
    return vload4(0, array);
#else
    return array[0];
#endif
}

/* TD_LANES neighbours of a plane. */
TD_INLINE void td_store_lanes(TD_GLOBAL td_real *plane, td_lanes value) {
#if TD_LANES == 16
    vstore16(value, 0, plane);
#elif TD_LANES == 8
    vstore8(value, 0, plane);
#elif TD_LANES == 4
    vstore4(value, 0, plane);
#else
    plane[0] = value;
#endif
}

/* The lanes, one by one, and back: of the work-item's own arrays. */
TD_INLINE void td_spread(td_lanes value, td_real lane[TD_LANES]) {
#if TD_LANES == 16
    vstore16(value, 0, lane);
#elif TD_LANES == 8
    vstore8(value, 0, lane);
#elif TD_LANES == 4
    vstore4(value, 0, lane);
#else
    lane[0] = value;
#endif
}
TD_INLINE td_lanes td_collect(const td_real lane[TD_LANES]) {
#if TD_LANES == 16
    return vload16(0, lane);
#elif TD_LANES == 8
    return vload8(0, lane);
#elif TD_LANES == 4
    return vload4(0, lane);
#else
    return lane[0];
#endif
}

/* Entry k of TD_LANES records `stride` apart. */
TD_INLINE void td_scatter(TD_GLOBAL td_real *records, int stride, int k, td_lanes value) {
#if TD_LANES == 1
    (void)stride;
    records[k] = value;
#else
    td_real lane[TD_LANES];
#if TD_LANES == 16
    vstore16(value, 0, lane);
#elif TD_LANES == 8
    vstore8(value, 0, lane);
#else
    vstore4(value, 0, lane);
#endif
    for (int i = 0; i < TD_LANES; i++) records[i * stride + k] = lane[i];
#endif
}

/* Larger and smaller of two; the second where they are unordered. */
TD_INLINE td_lanes td_larger(td_lanes a, td_lanes b) { return td_select(b, a, a > b); }
TD_INLINE td_lanes td_smaller(td_lanes a, td_lanes b) { return td_select(b, a, a < b); }
/* |a| */
TD_INLINE td_lanes td_size(td_lanes a) { return td_larger(a, -a); }

TD_INLINE td_lanes td_clamp(td_lanes x, td_real lower, td_real upper) {
    return td_smaller(td_larger(x, td_splat(lower)), td_splat(upper));
}

/* (otherwise, then) by mask, for masks. */
TD_INLINE td_mask td_select_mask(td_mask otherwise, td_mask then, td_mask mask) {
#if TD_LANES == 1
    return mask ? then : otherwise;
#else
    return (mask & then) | (~mask & otherwise);
#endif
}

/* `bits` where the mask is set, else 0. */
#if TD_LANES == 1
#define td_mask_bit(mask, bits) ((mask) ? (bits) : 0)
#else
#define td_mask_bit(mask, bits) ((mask) & (bits))
#endif

/* 1 if the mask is set in any lane. Halves are joined as longs: any() on 16 lanes becomes extracts and branches in PoCL. */
TD_INLINE int td_any(td_mask mask) {
#if TD_LANES == 16
    long8 a = as_long8(mask);
    long4 b = a.lo | a.hi;
    long2 c = b.lo | b.hi;
    return (c.x | c.y) != 0;
#elif TD_LANES == 8
    long4 b = as_long4(mask);
    long2 c = b.lo | b.hi;
    return (c.x | c.y) != 0;
#elif TD_LANES == 4
    long2 c = as_long2(mask);
    return (c.x | c.y) != 0;
#else
    return mask != 0;
#endif
}

/* 2^-e for x in [2^e, 2^(e + 1)), 1 <= x < 2^127. */
TD_INLINE td_lanes td_inverse_power(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    return exp2(-floor(log2(x)));
#else
    return td_from_bits(0x7f000000 - (td_bits(x) & 0x7f800000));
#endif
}

/* Not a number, in the same bits everywhere. */
TD_INLINE td_lanes td_not_a_number(void) {
#ifdef TD_REAL_DOUBLE
    return NAN;
#else
    return td_from_bits((td_mask)(0x7fc00000));
#endif
}

/* Lanes that are infinite or not a number. */
TD_INLINE td_mask td_is_broken(td_lanes x) { return x - x != 0.0f; }

/* 2^x for x <= 127, error < 1.8 ulp on the float side, exact for whole x. Below -126 it stays at 2^-126. Degree 5 polynomial on
 * [-1/2, 1/2] through 1 at 0, its coefficients searched as floats for the least error in ulp as evaluated here (a rounded
 * minimax polynomial is at 2.6); the magic constant 1.5 * 2^23 rounds. */
TD_INLINE td_lanes td_exp2(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    return exp2(x);
#else
    td_lanes clamped = td_larger(x, td_splat(-126.0f));
    td_lanes shifted = clamped + 12582912.0f;
    td_lanes r = clamped - (shifted - 12582912.0f);
    td_lanes p = td_fma(1.31917966e-3f, r, 9.67185199e-3f);
    p = td_fma(p, r, 5.55099323e-2f);
    p = td_fma(p, r, 2.40222335e-1f);
    p = td_fma(p, r, 6.93146765e-1f);
    p = td_fma(p, r, 1.0f);
#ifdef TD_OPENCL
    return td_from_bits(td_bits(p) + (td_bits(shifted) << 23));
#else
    return td_from_bits((int32_t)((uint32_t)td_bits(p) + ((uint32_t)td_bits(shifted) << 23)));
#endif
#endif
}

/* Natural logarithm of a positive normal number, < 2 ulp. x = m 2^e with m in [sqrt(1/2), sqrt(2)), s = (m - 1)/(m + 1),
 * ln m = 2 s + s^3 Q(s^2) with Q the degree 2 minimax polynomial (Remez, 1.6e-9); ln 2 is split in two (Cody and Waite). */
#ifndef TD_REAL_DOUBLE
/* x = m 2^e */
TD_INLINE td_lanes td_mantissa(td_lanes x, td_lanes *e) {
    td_mask bits = td_bits(x);
    td_mask exponent = (bits - 0x3f3504f3) >> 23; /* 0x3f3504f3 is sqrt(1/2) */
#ifdef TD_OPENCL
#if TD_LANES == 1
    *e = (float)exponent;
#elif TD_LANES == 4
    *e = convert_float4(exponent);
#elif TD_LANES == 8
    *e = convert_float8(exponent);
#else
    *e = convert_float16(exponent);
#endif
    return td_from_bits(bits - (exponent << 23));
#else
    *e = (float)exponent;
    return td_from_bits((int32_t)((uint32_t)bits - ((uint32_t)exponent << 23)));
#endif
}

/* ln x from s and e */
TD_INLINE td_lanes td_log_from(td_lanes s, td_lanes e) {
    td_lanes z = s * s;
    td_lanes q = td_fma(2.98717277e-1f, z, 3.99775416e-1f);
    q = td_fma(q, z, 6.66667764e-1f);
    td_lanes ln_m = td_fma(s * z, q, s + s);
    return td_fma(e, 6.93145752e-1f, td_fma(e, 1.42860677e-6f, ln_m));
}
#endif

TD_INLINE td_lanes td_log(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    return log(x);
#else
    td_lanes e, m = td_mantissa(x, &e);
    return td_log_from((m - 1.0f) / (m + 1.0f), e);
#endif
}

/* The same to some more ulp, and 1/x, with one division for both; x above 1e-18. */
TD_INLINE td_lanes td_log_inverse(td_lanes x, td_lanes *inverse) {
#ifdef TD_REAL_DOUBLE
    *inverse = 1 / x;
    return log(x);
#else
    td_lanes e, m = td_mantissa(x, &e), above = m + 1.0f;
    td_lanes both = 1.0f / (x * above);
    *inverse = both * above;
    return td_log_from((m - 1.0f) * (both * x), e);
#endif
}

/* x^3 (x (6 x - 15) + 10), the C2 step from 0 at 0 to 1 at 1, and its slope 30 x^2 (1 - x)^2; x in [0, 1]. */
TD_INLINE td_lanes td_smootherstep(td_lanes x) { return x * x * x * td_fma(x, td_fma(x, 6.0f, -15.0f), 10.0f); }
TD_INLINE td_lanes td_smootherstep_slope(td_lanes x) {
    td_lanes y = x - x * x;
    return 30.0f * y * y;
}

#endif
