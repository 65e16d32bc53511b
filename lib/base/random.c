/* Counter-based random numbers: the generator Philox4x32-10, and the distributions drawn from its bits.
 *
 * The inline functions make single numbers as well as TD_RANDOM_LANES numbers at a time. They are straight-line code without
 * tables or calls of libm. Compilers vectorise them, and their numbers are the same with every C library. */
#include "td_exponential.h"
#include "td_random.h"
#include "td_wide.h"

#include <math.h>
#include <string.h>

/* -- bits ------------------------------------------------------------------------------------------------------------------ */

/* Multipliers of the counter's words, and increments of the key. Both are those of Salmon et al., SC 2011; the increments are
 * the fractions of the golden ratio and of sqrt(3), times 2^32. */
static const uint32_t multiplier[2] = {0xD2511F53u, 0xCD9E8D57u};
static const uint32_t weyl[2] = {0x9E3779B9u, 0xBB67AE85u};

/* Ten rounds of Philox over `lanes` counters. c0 to c3 hold the words of the counters, which become the random bits; k0 and k1
 * are the key. */
static inline void philox(int lanes, uint32_t *restrict c0, uint32_t *restrict c1, uint32_t *restrict c2, uint32_t *restrict c3,
                          uint32_t k0, uint32_t k1) {
    for (int round = 0; round < 10; round++) {
        for (int i = 0; i < lanes; i++) {
            const uint64_t a = (uint64_t)multiplier[0] * c0[i], b = (uint64_t)multiplier[1] * c2[i];
            c0[i] = (uint32_t)(b >> 32) ^ c1[i] ^ k0;
            c1[i] = (uint32_t)b;
            c2[i] = (uint32_t)(a >> 32) ^ c3[i] ^ k1;
            c3[i] = (uint32_t)a;
        }
        k0 += weyl[0];
        k1 += weyl[1];
    }
}

td_random_bits td_philox(const uint32_t counter[4], const uint32_t key[2]) {
    td_random_bits bits = {{counter[0], counter[1], counter[2], counter[3]}};
    philox(1, &bits.word[0], &bits.word[1], &bits.word[2], &bits.word[3], key[0], key[1]);
    return bits;
}

td_random_bits td_random(uint64_t seed, uint32_t pixel, uint64_t index, uint32_t purpose) {
    const uint32_t counter[4] = {(uint32_t)index, (uint32_t)(index >> 32), pixel, purpose};
    const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    return td_philox(counter, key);
}

TD_WIDE static void philox_lanes(uint32_t c[4][TD_RANDOM_LANES], uint64_t seed) {
    philox(TD_RANDOM_LANES, c[0], c[1], c[2], c[3], (uint32_t)seed, (uint32_t)(seed >> 32));
}

void td_random_many(uint64_t seed, const uint32_t *pixel, const uint64_t *index, uint32_t purpose, td_random_lanes *bits) {
    uint32_t each[TD_RANDOM_LANES];
    for (int i = 0; i < TD_RANDOM_LANES; i++) each[i] = purpose;
    td_random_each(seed, pixel, index, each, bits);
}

void td_random_each(uint64_t seed, const uint32_t *pixel, const uint64_t *index, const uint32_t *purpose,
                    td_random_lanes *bits) {
    uint32_t c[4][TD_RANDOM_LANES];
    for (int i = 0; i < TD_RANDOM_LANES; i++) {
        c[0][i] = (uint32_t)index[i];
        c[1][i] = (uint32_t)(index[i] >> 32);
        c[2][i] = pixel[i];
        c[3][i] = purpose[i];
    }
    philox_lanes(c, seed);
    memcpy(bits->word, c, sizeof c);
}

/* -- uniforms -------------------------------------------------------------------------------------------------------------- */

enum { MANTISSA = 52, BIAS = 1023 }; /* bits of a double's mantissa; what its exponent field adds */
static const uint64_t bits_of_1 = (uint64_t)BIAS << MANTISSA;

/* A uniform number, (whole + 1/2) / 2^52, which is never 0 or 1. `whole` is the 52 highest bits of `high` and `low`. As the
 * mantissa of a number in [1, 2) it makes 1 + whole / 2^52; subtracting 1 - 2^-53 from that is exact. */
static inline double uniform(uint32_t high, uint32_t low) {
    const uint64_t whole = ((uint64_t)high << 32 | low) >> (64 - MANTISSA);
    return td_double_of(whole | bits_of_1) - (1 - 0x1p-53);
}

double td_random_uniform(const td_random_bits *bits, int half) {
    return uniform(bits->word[2 * half], bits->word[2 * half + 1]);
}

double td_random_exponential(const td_random_bits *bits, int half) { return -td_logarithm(td_random_uniform(bits, half)); }

/* -- normals --------------------------------------------------------------------------------------------------------------- */

/* sin(2 pi v) for |v| <= 1/4, by Taylor's series. The first term that is left out is below 2^-59. */
static inline double sine_of(double v) {
    const double two_pi = 6.28318530717958647693, x = two_pi * v, z = x * x;
    double sum = 1 / 51090942171709440000.0; /* 1 / 21! */
    sum = sum * z - 1 / 121645100408832000.0;
    sum = sum * z + 1 / 355687428096000.0;
    sum = sum * z - 1 / 1307674368000.0;
    sum = sum * z + 1 / 6227020800.0;
    sum = sum * z - 1 / 39916800.0;
    sum = sum * z + 1 / 362880.0;
    sum = sum * z - 1 / 5040.0;
    sum = sum * z + 1 / 120.0;
    sum = sum * z - 1 / 6.0;
    return x + x * (z * sum);
}

/* Two normal numbers from two uniform ones (Box and Muller): the radius comes from `u`, and the angle is `turn` [turns]. The
 * angle is folded without rounding into the range of sine_of, which ends at a quarter turn. */
static inline void normals(double u, double turn, double *cosine, double *sine) {
    const double radius = sqrt(-2 * td_logarithm(u)), v = turn - 0.5, beyond = fabs(v) - 0.25;
    *cosine = radius * sine_of(beyond);
    *sine = -copysign(radius * sine_of(0.25 - fabs(beyond)), v);
}

void td_random_normals(const td_random_bits *bits, double normal[2]) {
    normals(td_random_uniform(bits, 0), td_random_uniform(bits, 1), &normal[0], &normal[1]);
}

/* -- normals in single precision ------------------------------------------------------------------------------------------- */

/* -log u of u = (word / 2 + 1/2) / 2^31, which is in (0, 1]. The logarithm is td_logarithm's series; its first term that
 * is left out is below 2^-28 of it. */
static inline float short_exponential(uint32_t word) {
    const float u = ((float)(int32_t)(word >> 1) + 0.5f) * 0x1p-31f;
    const uint32_t root = 0x3f3504f3, one = 0x3f800000, whole = ((uint32_t)1 << 23) - 1;
    uint32_t bits;
    float m;
    memcpy(&bits, &u, sizeof bits);
    const uint32_t shifted = bits + (one - root), mantissa = (shifted & whole) + root;
    const float e = (float)((int32_t)(shifted >> 23) - 127);
    memcpy(&m, &mantissa, sizeof m);
    const float s = (m - 1) / (m + 1), z = s * s;
    const float sum = ((1.0f / 9 * z + 1.0f / 7) * z + 1.0f / 5) * z + 1.0f / 3;
    return -(e * 0.69314718f + 2 * (s + s * (z * sum)));
}

/* sin(2 pi v) for |v| <= 1/4, by Taylor's series. The first term that is left out is below 2^-24. */
static inline float short_sine_of(float v) {
    const float x = 6.2831853f * v, z = x * x;
    const float sum = ((((-1.0f / 39916800) * z + 1.0f / 362880) * z - 1.0f / 5040) * z + 1.0f / 120) * z - 1.0f / 6;
    return x + x * (z * sum);
}

/* Two normal numbers from two random words (Box and Muller): the radius comes from `word`, and the angle is `turn`, as a signed
 * number, over 2^32 [turns]. */
static inline void short_normals(uint32_t word, uint32_t turn, float *cosine, float *sine) {
    const float radius = sqrtf(2 * short_exponential(word)), v = (float)(int32_t)turn * 0x1p-32f, beyond = fabsf(v) - 0.25f;
    *cosine = radius * short_sine_of(beyond);
    *sine = -copysignf(radius * short_sine_of(0.25f - fabsf(beyond)), v);
}

void td_random_short_normals(const td_random_bits *bits, int half, float normal[2]) {
    short_normals(bits->word[2 * half], bits->word[2 * half + 1], &normal[0], &normal[1]);
}

double td_random_short_exponential(const td_random_bits *bits, int half) {
    return (double)short_exponential(bits->word[2 * half]);
}

TD_WIDE static void short_lanes(const td_random_lanes *restrict bits, float (*restrict normal)[TD_RANDOM_LANES]) {
    for (int i = 0; i < TD_RANDOM_LANES; i++) short_normals(bits->word[0][i], bits->word[1][i], &normal[0][i], &normal[1][i]);
    for (int i = 0; i < TD_RANDOM_LANES; i++) short_normals(bits->word[2][i], bits->word[3][i], &normal[2][i], &normal[3][i]);
}

void td_random_short_normals_many(const td_random_lanes *bits, float normal[4][TD_RANDOM_LANES]) { short_lanes(bits, normal); }

TD_WIDE static void short_exponentials(const td_random_lanes *restrict bits, float (*restrict value)[TD_RANDOM_LANES]) {
    for (int i = 0; i < TD_RANDOM_LANES; i++) value[0][i] = short_exponential(bits->word[0][i]);
    for (int i = 0; i < TD_RANDOM_LANES; i++) value[1][i] = short_exponential(bits->word[2][i]);
}

void td_random_short_exponentials_many(const td_random_lanes *bits, float value[2][TD_RANDOM_LANES]) {
    short_exponentials(bits, value);
}
