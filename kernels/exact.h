/* exp2, log, 1 - exp(-x), sine and cosine in double precision, made of basic operations, so that OpenCL and C give the same
 * bits. Sine and cosine are Taylor series. The other polynomials are minimax (Remez, in 50 digits) with rounded coefficients.
 * Errors are the greatest of a million arguments against long double. */
#ifndef TD_EXACT_H
#define TD_EXACT_H

#include "lanes.h"

#ifdef TD_REAL_DOUBLE

#define TD_EXACT_ROUNDS 6755399441055744.0 /* 1.5 * 2^52: x + this is rounded to a whole number, which is in the low bits */

/* 2^-e for x in [2^e, 2^(e + 1)), 1 <= x < 2^1023. */
TD_INLINE td_lanes td_exact_inverse_power(td_lanes x) {
    return td_from_bits((td_word)(0x7fe0000000000000) - (td_bits(x) & (td_word)(0x7ff0000000000000)));
}

TD_INLINE td_lanes td_exact_not_a_number(void) { return td_from_bits((td_word)(0x7ff8000000000000)); }

/* (2^r - 1) / r on [-1/2, 1/2]: a polynomial of degree 10, 1.8e-17 of itself. */
TD_INLINE td_lanes td_exact_slope(td_lanes r) {
    td_lanes p = td_fma(4.445535797392737e-10, r, 7.072561770574863e-09);
    p = td_fma(p, r, 1.0178121308119217e-07);
    p = td_fma(p, r, 1.3215442723873467e-06);
    p = td_fma(p, r, 1.5252733701195123e-05);
    p = td_fma(p, r, 0.00015403530441481273);
    p = td_fma(p, r, 0.001333355814653165);
    p = td_fma(p, r, 0.009618129107607065);
    p = td_fma(p, r, 0.055504108664821236);
    p = td_fma(p, r, 0.24022650695910097);
    return td_fma(p, r, 0.6931471805599453);
}

/* 2^x for x < 1024, error < 1 ulp, exact for whole x. Below -1022 it stays at 2^-1022. */
TD_INLINE td_lanes td_exact_exp2(td_lanes x) {
    td_lanes clamped = td_select(td_splat(-1022.0), x, x > -1022.0);
    td_lanes shifted = clamped + TD_EXACT_ROUNDS;
    td_lanes r = clamped - (shifted - TD_EXACT_ROUNDS), p = td_fma(td_exact_slope(r), r, 1.0);
    return td_from_bits(td_bits(p) + (td_bits(shifted) << 52));
}

/* 1 - exp(-x), error < 2.5 ulp, for x from 0 to 700. With -x log2(e) = k + r the result is (1 - 2^k) - 2^k (2^r - 1). */
TD_INLINE td_lanes td_exact_taken(td_lanes x) {
    td_lanes y = x * -1.4426950408889634074;
    td_lanes shifted = y + TD_EXACT_ROUNDS, r = y - (shifted - TD_EXACT_ROUNDS);
    td_lanes scale = td_from_bits((td_bits(shifted) + (td_word)(1023)) << 52);
    return td_fma(-scale, td_exact_slope(r) * r, 1.0 - scale);
}

/* sin x and cos x, error < 3e-16 for |x| < 2^20. x = k pi/2 + r with pi/2 in three parts (Cody and Waite), then Taylor's series
 * up to r^17 and r^16. */
TD_INLINE void td_exact_sin_cos(td_lanes x, td_lanes *sine, td_lanes *cosine) {
    td_lanes shifted = td_fma(x, 0.63661977236758134308, td_splat(TD_EXACT_ROUNDS)), k = shifted - TD_EXACT_ROUNDS;
    td_lanes r = td_fma(-k, 1.5707963267948966, x);
    r = td_fma(-k, 6.123233995736766e-17, r);
    r = td_fma(-k, -1.4973849048591698e-33, r);
    td_lanes z = r * r;
    td_lanes s = td_fma(2.8114572543455206e-15, z, -7.647163731819816e-13);
    s = td_fma(s, z, 1.6059043836821613e-10);
    s = td_fma(s, z, -2.505210838544172e-08);
    s = td_fma(s, z, 2.7557319223985893e-06);
    s = td_fma(s, z, -0.0001984126984126984);
    s = td_fma(s, z, 0.008333333333333333);
    s = td_fma(s, z, -0.16666666666666666);
    td_lanes c = td_fma(4.779477332387385e-14, z, -1.1470745597729725e-11);
    c = td_fma(c, z, 2.08767569878681e-09);
    c = td_fma(c, z, -2.755731922398589e-07);
    c = td_fma(c, z, 2.48015873015873e-05);
    c = td_fma(c, z, -0.001388888888888889);
    c = td_fma(c, z, 0.041666666666666664);
    s = td_fma(s, z * r, r);
    c = td_fma(td_fma(c, z, -0.5), z, 1.0);
    td_word quadrant = td_bits(shifted);
    td_mask swapped = (quadrant & 1) != 0, below = (quadrant & 2) != 0, left = ((quadrant + 1) & 2) != 0;
    td_lanes a = td_select(s, c, swapped), b = td_select(c, s, swapped);
    *sine = td_select(a, -a, below);
    *cosine = td_select(b, -b, left);
}

/* x = m 2^e with m in [sqrt(1/2), sqrt(2)); returns f = m - 1. */
TD_INLINE td_lanes td_exact_mantissa(td_lanes x, td_lanes *e) {
    const td_lanes bias = td_splat(6755399441056767.0); /* TD_EXACT_ROUNDS + 1023 */
    /* Adds the bits between sqrt(1/2) and 1, so that m in [sqrt(1/2), 1) counts as the next exponent. */
    td_word above = td_bits(x) + (td_word)(0x3ff0000000000000 - 0x3fe6a09e667f3bcd);
    *e = td_from_bits((above >> 52) + td_bits(td_splat(TD_EXACT_ROUNDS))) - bias;
    return td_from_bits((above & (td_word)(0x000fffffffffffff)) + (td_word)(0x3fe6a09e667f3bcd)) - 1.0;
}

/* ln x of f, s = f/(2 + f) and e: ln(1 + f) = f - (f^2/2 - s (f^2/2 + R)), R = s^2 Q(s^2) with Q of degree 6, good to 5e-18. f
 * is exact, and an error of s counts only in second order. */
TD_INLINE td_lanes td_exact_log_from(td_lanes f, td_lanes s, td_lanes e) {
    td_lanes z = s * s, square = 0.5 * f * f;
    td_lanes q = td_fma(0.14617736790073002, z, 0.15331607998056482);
    q = td_fma(q, z, 0.1818289288483782);
    q = td_fma(q, z, 0.222222110774591);
    q = td_fma(q, z, 0.2857142862637063);
    q = td_fma(q, z, 0.3999999999989851);
    q = td_fma(q, z, 0.666666666666667);
    td_lanes ln_m = f - td_fma(-s, td_fma(q, z, square), square);
    return td_fma(e, 0.6931471805599453094, td_fma(e, 2.3190468138462996e-17, ln_m)); /* ln 2 rounded, and the rest of ln 2 */
}

/* ln x of a positive normal number, < 1.5 ulp. */
TD_INLINE td_lanes td_exact_log(td_lanes x) {
    td_lanes e, f = td_exact_mantissa(x, &e);
    return td_exact_log_from(f, f / (2.0 + f), e);
}

/* ln x and 1/x, with one division for both; x between 1e-300 and 1e300. */
TD_INLINE td_lanes td_exact_log_inverse(td_lanes x, td_lanes *inverse) {
    td_lanes e, f = td_exact_mantissa(x, &e), above = 2.0 + f;
    td_lanes both = 1.0 / (x * above);
    *inverse = both * above;
    return td_exact_log_from(f, f * (both * x), e);
}

#endif
#endif
