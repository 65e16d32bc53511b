/* Internal: e^x and log x for loops over many numbers. They use basic operations only, so that compilers vectorise them,
 * and the bits are the same with every C library. For single numbers and all arguments, td_math.h has td_exp and td_ln. */
#ifndef TD_EXPONENTIAL_H
#define TD_EXPONENTIAL_H

#include "td_wide.h"

#include <stdint.h>
#include <string.h>

/* Outside these bounds td_exponential keeps its value at the bound: 5e-304 below, and almost the largest double above. */
#define TD_EXPONENT_LEAST (-698.0)
#define TD_EXPONENT_MOST 709.0

static inline double td_double_of(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static inline uint64_t td_bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* (e^r - 1 - r - r^2/2) / r^3 and (e^r - 1 - r) / r^2 for |r| < 0.347: Taylor's series. The first term left out of e^r is
 * below 5e-18. */
TD_WITHIN double td_exponential_cubes(double r) {
    double p = 1.0 / 6227020800;
    p = p * r + 1.0 / 479001600;
    p = p * r + 1.0 / 39916800;
    p = p * r + 1.0 / 3628800;
    p = p * r + 1.0 / 362880;
    p = p * r + 1.0 / 40320;
    p = p * r + 1.0 / 5040;
    p = p * r + 1.0 / 720;
    p = p * r + 1.0 / 120;
    p = p * r + 1.0 / 24;
    return p * r + 1.0 / 6;
}
TD_WITHIN double td_exponential_squares(double r) { return td_exponential_cubes(r) * r + 0.5; }

/* e^x of a finite x, error < 1 ulp (tests/unit/test_exponential.c), clamped at the two bounds. With x = k ln 2 + r, |r| <
 * 0.347, it is 2^k times the series of e^r. ln 2 is the sum of two doubles: k times the first is exact. */
TD_WITHIN double td_exponential(double x) {
    static const double rounds = 0x1.8p52, per_ln2 = 1.44269504088896340736, ln2 = 0x1.62e42feep-1,
                        more = 0x1.a39ef35793c76p-33;
    const double low = x < TD_EXPONENT_LEAST ? TD_EXPONENT_LEAST : x, within = low > TD_EXPONENT_MOST ? TD_EXPONENT_MOST : low;
    const double shifted = within * per_ln2 + rounds, k = shifted - rounds, r = (within - k * ln2) - k * more;
    const double p = 1 + (r + r * r * td_exponential_squares(r));
    return td_double_of(td_bits_of(p) + (td_bits_of(shifted) << 52)); /* adds k to the exponent's bits */
}

/* log x of a positive normal number, error 2 ulp. With x = 2^e m, m from sqrt(1/2) to sqrt(2), log m = 2 atanh(s) with s =
 * (m - 1) / (m + 1). |s| < 0.172, so the first term left out of the series is below 2^-56 of the sum. */
TD_WITHIN double td_logarithm(double x) {
    static const double ln_2 = 0.69314718055994530942;
    const uint64_t root = 0x3fe6a09e667f3bcd, one = 0x3ff0000000000000, whole = ((uint64_t)1 << 52) - 1;
    /* e without a branch: the addition carries into the exponent where the mantissa is above sqrt(2) */
    const uint64_t shifted = td_bits_of(x) + (one - root);
    const double e = td_double_of(shifted >> 52 | td_bits_of(0x1p52)) - (0x1p52 + 1023);
    const double m = td_double_of((shifted & whole) + root);
    const double s = (m - 1) / (m + 1), z = s * s;
    double sum = 1.0 / 21;
    sum = sum * z + 1.0 / 19;
    sum = sum * z + 1.0 / 17;
    sum = sum * z + 1.0 / 15;
    sum = sum * z + 1.0 / 13;
    sum = sum * z + 1.0 / 11;
    sum = sum * z + 1.0 / 9;
    sum = sum * z + 1.0 / 7;
    sum = sum * z + 1.0 / 5;
    sum = sum * z + 1.0 / 3;
    return e * ln_2 + 2 * (s + s * (z * sum));
}

#endif
