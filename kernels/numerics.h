/* exp and log for every dialect, made of basic operations, so that host and device agree to the bit. In double precision they
 * are the functions of exact.h. */
#ifndef TD_NUMERICS_H
#define TD_NUMERICS_H

#include "exact.h"
#include "lanes.h"

/* 2^-e for x in [2^e, 2^(e + 1)), 1 <= x < 2^127 (2^1023 in double). */
TD_INLINE td_lanes td_inverse_power(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    return td_exact_inverse_power(x);
#else
    return td_from_bits(0x7f000000 - (td_bits(x) & 0x7f800000));
#endif
}

/* NaN, in the same bits everywhere. */
TD_INLINE td_lanes td_not_a_number(void) {
#ifdef TD_REAL_DOUBLE
    return td_exact_not_a_number();
#else
    return td_from_bits((td_mask)(0x7fc00000));
#endif
}

/* Lanes that are infinite or not a number. */
TD_INLINE td_mask td_is_broken(td_lanes x) { return x - x != 0.0f; }

/* 2^x for x <= 127, error < 1.8 ulp in single precision, exact for whole x. Below -126 it stays at 2^-126. On [-1/2, 1/2] it is
 * a polynomial of degree 5 through 1 at 0. Its coefficients were searched as floats for the least error in ulp as evaluated
 * here; a rounded minimax polynomial has 2.6. Adding the magic constant 1.5 * 2^23 rounds. */
TD_INLINE td_lanes td_exp2(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    return td_exact_exp2(x);
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

/* Natural logarithm of a positive normal number, < 2 ulp. x = m 2^e with m in [sqrt(1/2), sqrt(2)), s = (m - 1)/(m + 1), and ln
 * m = 2 s + s^3 Q(s^2). Q is the minimax polynomial of degree 2 (Remez, 1.6e-9). ln 2 is split in two (Cody and Waite). */
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
    return td_exact_log(x);
#else
    td_lanes e, m = td_mantissa(x, &e);
    return td_log_from((m - 1.0f) / (m + 1.0f), e);
#endif
}

/* ln x and 1/x with one division for both, for x above 1e-18. The error of ln x is some ulp more than td_log's. */
TD_INLINE td_lanes td_log_inverse(td_lanes x, td_lanes *inverse) {
#ifdef TD_REAL_DOUBLE
    return td_exact_log_inverse(x, inverse);
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
