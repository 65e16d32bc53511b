/* The dialect: one spelling of scalars, lanes and masks for OpenCL C and for C.
 *
 * A td_lanes is TD_LANES reals that go through the same arithmetic: sixteen pixels (or Gaussians) on a CPU, eight or four in
 * double precision, one on a GPU, one in the scalar reference. The including file has declared the dialect:
 *   TD_OPENCL         set by the program's prelude, together with TD_LANES = 1, 4, 8 or 16
 *   TD_REAL_DOUBLE    double precision, with the functions of exact.h
 *   TD_UNFUSED        in OpenCL, on devices without an fma instruction: multiplies and adds, close to the reference's bits
 * Masks are the results of comparisons, and as wide as the reals. Indices are combined with masks, so that they are longs in
 * double.
 *
 * Rules for all code with it: operations aren't contracted (the prelude's first line, -ffp-contract=off on the host), and fma()
 * is written where it is wanted. rint, floor, convert_*_rte, fmin, fmax, any and all aren't used, since they are slow in
 * PoCL. */
#ifndef TD_LANES_H
#define TD_LANES_H

#ifdef TD_OPENCL

#define TD_GLOBAL __global
#define TD_INLINE static inline __attribute__((always_inline))
/* Marks a kernel's body as a function that isn't inlined. PoCL makes three functions of a kernel, each with the whole body
 * inlined otherwise: three times as much to optimise and to translate, of which one runs. */
#if TD_LANES > 1
#define TD_APART static __attribute__((noinline))
#else
#define TD_APART static
#endif

#define TD_JOIN_(a, b) a##b
#define TD_JOIN(a, b) TD_JOIN_(a, b)
#if TD_LANES == 1
#define TD_VECTOR(type) type
#else
#define TD_VECTOR(type) TD_JOIN(type, TD_LANES)
#endif
#ifdef TD_REAL_DOUBLE
typedef double td_real;
typedef TD_VECTOR(ulong) td_word; /* bits of reals */
#define td_bits(x) TD_VECTOR(as_ulong)(x)
#define td_from_bits(x) TD_VECTOR(as_double)(x)
typedef TD_VECTOR(double) td_lanes;
#if TD_LANES == 1
typedef int td_mask;
#else
typedef TD_VECTOR(long) td_mask;
#define td_widen_ints(ints) TD_VECTOR(convert_long)(ints)
#define td_narrow_ints(index) TD_VECTOR(convert_int)(index)
#define td_mask_to_real(m) TD_VECTOR(convert_double)(-(m))
#endif
#else
typedef float td_real;
typedef TD_VECTOR(float) td_lanes;
typedef TD_VECTOR(int) td_mask;
#define td_bits(x) TD_VECTOR(as_int)(x)
#define td_from_bits(x) TD_VECTOR(as_float)(x)
#if TD_LANES > 1
#define td_mask_to_real(m) TD_VECTOR(convert_float)(-(m))
#endif
#endif
#if TD_LANES == 1
#define td_mask_to_real(m) ((td_real)((m) != 0))
#endif
#define td_splat(x) ((td_lanes)(x))
#ifdef TD_UNFUSED
#define td_fma_of(type, a, b, c) ((type)(a) * (type)(b) + (type)(c))
#else
#define td_fma_of(type, a, b, c) fma((type)(a), (type)(b), (type)(c))
#endif
#define td_fma(a, b, c) td_fma_of(td_lanes, a, b, c)
#define td_fma_real(a, b, c) td_fma_of(td_real, a, b, c) /* fma of single reals, which all lanes share */
#define td_sqrt(x) sqrt(x)
#if defined(TD_REAL_DOUBLE) && TD_LANES == 1 /* select() would want a long here */
#define td_select(otherwise, then, mask) ((mask) ? (td_lanes)(then) : (td_lanes)(otherwise))
#else
#define td_select(otherwise, then, mask) select((td_lanes)(otherwise), (td_lanes)(then), (mask))
#endif

#else /* C: one lane */

#include <math.h>
#include <stdint.h>
#include <string.h>
#define TD_GLOBAL
#define TD_INLINE static inline
#define TD_LANES 1
#ifdef TD_REAL_DOUBLE
typedef double td_real;
typedef uint64_t td_word; /* bits of reals */
#define td_fma(a, b, c) td_kept(fma(a, b, c))
#define td_sqrt(x) sqrt(x)
#else
typedef float td_real;
typedef int32_t td_word;
#define td_fma(a, b, c) td_kept(fmaf(a, b, c))
#define td_sqrt(x) sqrtf(x)
#endif
/* Hides where x comes from. gcc 12 makes one instruction of -fma(a, b, c) where the processor has one, also with
 * -frounding-math, and clang does so for arm64. The sign of a result of 0 then differs. */
TD_INLINE td_real td_kept(td_real x) {
#if defined(__GNUC__) && defined(__aarch64__)
    __asm__("" : "+w"(x));
#elif defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
    __asm__("" : "+x"(x));
#elif defined(__GNUC__) && !defined(__clang__)
    __asm__("" : "+g"(x));
#endif
    return x;
}
typedef td_real td_lanes;
typedef int td_mask;
#define td_fma_real(a, b, c) td_fma(a, b, c)
#define td_splat(x) ((td_real)(x))
#define td_select(otherwise, then, mask) ((mask) ? (td_real)(then) : (td_real)(otherwise))
#define td_mask_to_real(m) ((td_real)((m) != 0))
TD_INLINE td_word td_bits(td_real x) {
    td_word bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
TD_INLINE td_real td_from_bits(td_word bits) {
    td_real x;
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

/* Prefetches the cache line at `at`. */
#if defined(TD_OPENCL) && TD_LANES > 1
#define td_prefetch(place) __builtin_prefetch((const void *)(size_t)(place))
#else
#define td_prefetch(place) ((void)(place))
#endif

/* array[index] for each lane, as a `type`. */
#if TD_LANES == 16
#define TD_GATHER(type, array, i)                                                                                  \
    (type)(array[i.s0], array[i.s1], array[i.s2], array[i.s3], array[i.s4], array[i.s5], array[i.s6], array[i.s7], \
           array[i.s8], array[i.s9], array[i.sa], array[i.sb], array[i.sc], array[i.sd], array[i.se], array[i.sf])
#elif TD_LANES == 8
#define TD_GATHER(type, array, i) \
    (type)(array[i.s0], array[i.s1], array[i.s2], array[i.s3], array[i.s4], array[i.s5], array[i.s6], array[i.s7])
#elif TD_LANES == 4
#define TD_GATHER(type, array, i) (type)(array[i.x], array[i.y], array[i.z], array[i.w])
#else
#define TD_GATHER(type, array, i) ((type)array[i])
#endif
TD_INLINE td_lanes td_gather(TD_GLOBAL const td_real *array, td_index i) { return TD_GATHER(td_lanes, array, i); }
TD_INLINE td_index td_gather_ints(TD_GLOBAL const int *array, td_index i) { return TD_GATHER(td_index, array, i); }

/* first, first + 1 .. in each lane */
TD_INLINE td_index td_count_from(int first) {
#if TD_LANES == 16
    return first + (td_index)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif TD_LANES == 8
    return first + (td_index)(0, 1, 2, 3, 4, 5, 6, 7);
#elif TD_LANES == 4
    return first + (td_index)(0, 1, 2, 3);
#else
    return first;
#endif
}

/* The larger of an index and 0. */
TD_INLINE td_index td_not_below_0(td_index i) { return i & ~(i >> 31); }

/* Indices are as wide as reals, arrays of them are of ints. */
#ifndef td_widen_ints
#define td_widen_ints(ints) (ints)
#define td_narrow_ints(index) (index)
#endif

/* TD_LANES neighbours of an array, in any address space, as a vector; and back. */
#if TD_LANES == 1
#define TD_LOAD_VECTOR(array) ((array)[0])
#define TD_STORE_VECTOR(value, array) ((array)[0] = (value))
#else
#define TD_LOAD_VECTOR(array) TD_VECTOR(vload)(0, array)
#define TD_STORE_VECTOR(value, array) TD_VECTOR(vstore)(value, 0, array)
#endif

TD_INLINE td_index td_load_ints(TD_GLOBAL const int *array) { return td_widen_ints(TD_LOAD_VECTOR(array)); }
TD_INLINE void td_store_ints(TD_GLOBAL int *array, td_index value) { TD_STORE_VECTOR(td_narrow_ints(value), array); }
TD_INLINE td_lanes td_load_lanes(TD_GLOBAL const td_real *array) { return TD_LOAD_VECTOR(array); }
TD_INLINE void td_store_lanes(TD_GLOBAL td_real *plane, td_lanes value) { TD_STORE_VECTOR(value, plane); }
#if defined(TD_REAL_DOUBLE) && TD_LANES > 1
/* Loads TD_LANES values of an array of floats, widened. */
TD_INLINE td_lanes td_load_floats(TD_GLOBAL const float *array) { return TD_VECTOR(convert_double)(TD_LOAD_VECTOR(array)); }
#endif

/* Writes the lanes into an array of the work-item, one by one; td_collect loads them. */
TD_INLINE void td_spread(td_lanes value, td_real lane[TD_LANES]) { TD_STORE_VECTOR(value, lane); }
TD_INLINE td_lanes td_collect(const td_real lane[TD_LANES]) { return TD_LOAD_VECTOR(lane); }
/* td_spread and td_collect for an array of ints. */
TD_INLINE void td_spread_ints(td_index value, int lane[TD_LANES]) { TD_STORE_VECTOR(td_narrow_ints(value), lane); }
TD_INLINE td_index td_collect_ints(const int lane[TD_LANES]) { return td_widen_ints(TD_LOAD_VECTOR(lane)); }

/* Splits TD_LANES pairs into their first and their second values. */
TD_INLINE void td_collect_pairs(const td_real *pair, td_lanes *first, td_lanes *second) {
#if TD_LANES == 1
    *first = pair[0];
    *second = pair[1];
#else
    td_lanes low = td_collect(pair), high = td_collect(pair + TD_LANES);
    *first = (td_lanes)(low.even, high.even);
    *second = (td_lanes)(low.odd, high.odd);
#endif
}

/* Stores entry k of TD_LANES records, `stride` reals apart. */
TD_INLINE void td_scatter(TD_GLOBAL td_real *records, int stride, int k, td_lanes value) {
#if TD_LANES == 1
    (void)stride;
    records[k] = value;
#else
    td_real lane[TD_LANES];
    td_spread(value, lane);
    for (int i = 0; i < TD_LANES; i++) records[i * stride + k] = lane[i];
#endif
}

/* The larger and the smaller of two. If one is NaN, the second is returned. */
TD_INLINE td_lanes td_larger(td_lanes a, td_lanes b) { return td_select(b, a, a > b); }
TD_INLINE td_lanes td_smaller(td_lanes a, td_lanes b) { return td_select(b, a, a < b); }
/* |a| */
TD_INLINE td_lanes td_size(td_lanes a) { return td_larger(a, -a); }

/* The largest of all lanes. None may be NaN. */
TD_INLINE td_real td_largest(td_lanes a) {
#if TD_LANES == 16
    a = td_larger(a, a.s89abcdef01234567);
    a = td_larger(a, a.s456789abcdef0123);
    a = td_larger(a, a.s23456789abcdef01);
    return td_larger(a, a.s123456789abcdef0).s0;
#elif TD_LANES == 8
    a = td_larger(a, a.s45670123);
    a = td_larger(a, a.s23456701);
    return td_larger(a, a.s12345670).s0;
#elif TD_LANES == 4
    a = td_larger(a, a.s2301);
    return td_larger(a, a.s1230).s0;
#else
    return a;
#endif
}

TD_INLINE td_lanes td_clamp(td_lanes x, td_real lower, td_real upper) {
    return td_smaller(td_larger(x, td_splat(lower)), td_splat(upper));
}

/* Where `mask` is set `then`, else `otherwise`; both are masks. */
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
#if TD_LANES == 1
    return mask != 0;
#else
#ifdef TD_REAL_DOUBLE
#define TD_MASK_LONGS TD_LANES
#define td_as_longs(mask) (mask)
#elif TD_LANES == 16
#define TD_MASK_LONGS 8
#define td_as_longs(mask) as_long8(mask)
#elif TD_LANES == 8
#define TD_MASK_LONGS 4
#define td_as_longs(mask) as_long4(mask)
#else
#define TD_MASK_LONGS 2
#define td_as_longs(mask) as_long2(mask)
#endif
#if TD_MASK_LONGS == 16
    long8 a = mask.lo | mask.hi;
    long4 b = a.lo | a.hi;
    long2 c = b.lo | b.hi;
#elif TD_MASK_LONGS == 8
    long8 a = td_as_longs(mask);
    long4 b = a.lo | a.hi;
    long2 c = b.lo | b.hi;
#elif TD_MASK_LONGS == 4
    long4 b = td_as_longs(mask);
    long2 c = b.lo | b.hi;
#else
    long2 c = td_as_longs(mask);
#endif
    return (c.x | c.y) != 0;
#endif
}

#endif
