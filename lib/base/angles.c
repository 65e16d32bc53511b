/* Sine, cosine, tangent, arc functions and hypot, from basic operations only. C libraries differ in the last bits of these,
 * and event times must not. */
#include "td_math.h"
#include "td_two.h"

#include <math.h>
#include <stdint.h>

/* pi/2 and pi: each as the nearest double and the rest. */
static const td_two quarter = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
static const td_two half_turn = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};

/* An angle, split into a whole number of quarter turns (modulo 4) and a rest from -pi/4 to pi/4. */
typedef struct folded {
    unsigned quarters;
    td_two rest;
} folded;

/* -- the rest of a large angle (Payne and Hanek 1983) ---------------------------------------------------------------------- */

enum { WORDS = 7, LIMBS = WORDS + 2 }; /* 32-bit words of 2/pi that are used, and of their product with 64 bits */

/* The bits of 2/pi behind the binary point. */
static const uint32_t two_per_pi[] = {0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab,
                                      0xdebbc561, 0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e,
                                      0xe88235f5, 0x2ebb4484, 0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b,
                                      0xbdf9283b, 0x1ff897ff, 0xde05980f, 0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7,
                                      0x4f463f66, 0x9e5fea2d, 0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1,
                                      0x1f8d5d08, 0x56033046, 0xfc7b6bab};

/* product = m times WORDS words, the lowest limb first. */
static void multiply(uint64_t m, const uint32_t *words, uint32_t product[LIMBS]) {
    for (int i = 0; i < LIMBS; i++) product[i] = 0;
    for (int half = 0; half < 2; half++) {
        const uint64_t by = half ? m >> 32 : m & 0xffffffff;
        uint64_t carry = 0;
        for (int i = 0; i < WORDS; i++) {
            carry += by * words[WORDS - 1 - i] + product[i + half];
            product[i + half] = (uint32_t)carry;
            carry >>= 32;
        }
        product[WORDS + half] = (uint32_t)carry;
    }
}

/* 32 bits of the product, from bit `at` >= 0 on; bits above the highest limb are 0. */
static uint32_t bits_from(const uint32_t product[LIMBS], int at) {
    const uint64_t low = product[at / 32], high = at / 32 + 1 < LIMBS ? product[at / 32 + 1] : 0;
    return (uint32_t)((high << 32 | low) >> (at % 32));
}

/* Reduces a large x = m 2^e. Words of 2/pi before `first` make whole turns and are left out. The product is right to 138
 * bits behind the point; DIGITS words (128 bits) of them are used. */
static folded fold_large(double x) {
    enum { DIGITS = 4 }; /* of 32 bits each */
    int e;
    const uint64_t m = (uint64_t)(frexp(x, &e) * 0x1p53);
    const int first = e < 55 ? 0 : (e - 55) / 32;
    uint32_t product[LIMBS];
    multiply(m, two_per_pi + first, product);
    const int point = 32 * (first + WORDS) - (e - 53);
    folded at = {bits_from(product, point) & 3, {0, 0}};
    const int beyond = (bits_from(product, point - 32) >> 31) != 0; /* the nearest quarter is the next one */
    at.quarters += (unsigned)beyond;
    td_two part = {beyond ? -1 : 0, 0};
    double unit = 1;
    for (int i = 1; i <= DIGITS; i++) {
        unit *= 0x1p-32;
        part = td_two_add(part, (td_two){bits_from(product, point - 32 * i) * unit, 0});
    }
    at.rest = td_two_times(part, quarter);
    return at;
}

/* -- sine and cosine ------------------------------------------------------------------------------------------------------- */

/* Splits x >= 0 into quarter turns and a rest. Up to 2^20 it subtracts pi/2 in three parts (Cody and Waite): k times the first
 * and the second are exact. */
static folded fold(double x) {
    if (x <= 0.785) return (folded){0, {x, 0}};
    if (x >= 0x1p20) return fold_large(x);
    const double k = (x * 0.63661977236758134308 + 0x1.8p52) - 0x1.8p52;
    const td_two rest = td_two_sum(x - k * 0x1.921fb544p+0, -(k * 0x1.0b4611a6p-34));
    return (folded){(unsigned)k & 3, td_two_sum(rest.high, rest.low - k * 0x1.3198a2e037073p-69)};
}

/* Sine of |r| < 0.79 by Taylor's series. The first terms left out, of sine and cosine, are below 1e-19 and 3e-18. */
static double sine_of(td_two r) {
    const double z = r.high * r.high;
    double sum = 1 / 355687428096000.0; /* 1 / 17! */
    sum = sum * z - 1 / 1307674368000.0;
    sum = sum * z + 1 / 6227020800.0;
    sum = sum * z - 1 / 39916800.0;
    sum = sum * z + 1 / 362880.0;
    sum = sum * z - 1 / 5040.0;
    sum = sum * z + 1 / 120.0;
    sum = sum * z - 1 / 6.0;
    return r.high + (r.high * z * sum + r.low * (1 - 0.5 * z));
}

static double cosine_of(td_two r) {
    const double z = r.high * r.high, half = 0.5 * z, line = 1 - half;
    double sum = 1 / 20922789888000.0; /* 1 / 16! */
    sum = sum * z - 1 / 87178291200.0;
    sum = sum * z + 1 / 479001600.0;
    sum = sum * z - 1 / 3628800.0;
    sum = sum * z + 1 / 40320.0;
    sum = sum * z - 1 / 720.0;
    sum = sum * z + 1 / 24.0;
    return line + (((1 - line) - half) + (z * z * sum - r.high * r.low));
}

/* The sine of `quarters` quarter turns plus `rest`. */
static double sine_at(unsigned quarters, td_two rest) {
    const double size = quarters & 1 ? cosine_of(rest) : sine_of(rest);
    return quarters & 2 ? -size : size;
}

double td_sin(double x) {
    if (!isfinite(x)) return NAN;
    const folded at = fold(fabs(x));
    return copysign(1, x) * sine_at(at.quarters, at.rest);
}

double td_cos(double x) {
    if (!isfinite(x)) return NAN;
    const folded at = fold(fabs(x));
    return sine_at(at.quarters + 1, at.rest);
}

double td_tan(double x) { return td_sin(x) / td_cos(x); }

/* -- angles ---------------------------------------------------------------------------------------------------------------- */

/* atan(i / 8) */
enum { ATANS = 9 };
static const td_two atan_of[ATANS] = {{0, 0},
                                      {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                      {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                      {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                      {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                      {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                      {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                      {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                      {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};

/* The angle of (x, y), 0 <= y <= x, x > 0. With c, the nearest of the tabled tangents i/8, the tangent of the remaining
 * angle is (y - c x) / (x + c y), below 1/16. The first term left out of its series is below 1e-18. */
static double small_angle(double y, double x) {
    const double scale = x > 0x1p1000 ? 0x1p-60 : x < 0x1p-900 ? 0x1p60 : 1;
    y *= scale;
    x *= scale;
    const int i = (int)(8 * (y / x) + 0.5);
    const double c = 0.125 * i, t = (y - c * x) / (x + c * y), z = t * t;
    double sum = 1.0 / 13;
    for (int n = 11; n >= 3; n -= 2) sum = 1.0 / n - sum * z;
    return atan_of[i].high + (t + (atan_of[i].low - t * z * sum));
}

double td_atan2(double y, double x) {
    if (isnan(x) || isnan(y)) return NAN;
    double a = fabs(y), b = fabs(x), angle = 0;
    if (isinf(a) && isinf(b)) a = b = 1;
    if (isinf(a) || isinf(b)) {
        a = isinf(a);
        b = isinf(b);
    }
    if (a > b)
        angle = (quarter.high - small_angle(b, a)) + quarter.low;
    else if (a > 0)
        angle = small_angle(a, b);
    if (signbit(x)) angle = (half_turn.high - angle) + half_turn.low;
    return copysign(angle, y);
}

double td_acos(double x) { return fabs(x) <= 1 ? 2 * td_atan2(sqrt(1 - x), sqrt(1 + x)) : NAN; }

double td_hypot(double x, double y) {
    const double a = fmax(fabs(x), fabs(y)), b = fmin(fabs(x), fabs(y));
    if (isinf(a)) return a;
    if (isnan(x) || isnan(y)) return NAN;
    const double scale = a > 0x1p500 ? 0x1p-600 : a < 0x1p-450 ? 0x1p600 : 1;
    return sqrt(scale * a * (scale * a) + scale * b * (scale * b)) / scale;
}
