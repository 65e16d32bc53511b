/* Counter-based random numbers: Philox4x32-10 and what is drawn from its bits. */
#include "td_random.h"

#include <math.h>

/* Multipliers and the key's increments (golden ratio, sqrt(3) - 1), from the paper. */
static const uint32_t multiplier[2] = {0xD2511F53u, 0xCD9E8D57u};
static const uint32_t weyl[2] = {0x9E3779B9u, 0xBB67AE85u};

td_random_bits td_philox(const uint32_t counter[4], const uint32_t key[2]) {
    uint32_t c[4] = {counter[0], counter[1], counter[2], counter[3]}, k[2] = {key[0], key[1]};
    for (int round = 0; round < 10; round++) {
        uint64_t a = (uint64_t)multiplier[0] * c[0], b = (uint64_t)multiplier[1] * c[2];
        uint32_t next[4] = {(uint32_t)(b >> 32) ^ c[1] ^ k[0], (uint32_t)b, (uint32_t)(a >> 32) ^ c[3] ^ k[1], (uint32_t)a};
        for (int i = 0; i < 4; i++) c[i] = next[i];
        for (int i = 0; i < 2; i++) k[i] += weyl[i];
    }
    return (td_random_bits){{c[0], c[1], c[2], c[3]}};
}

td_random_bits td_random(uint64_t seed, uint32_t pixel, uint64_t index, uint32_t purpose) {
    const uint32_t counter[4] = {(uint32_t)index, (uint32_t)(index >> 32), pixel, purpose};
    const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    return td_philox(counter, key);
}

double td_random_uniform(const td_random_bits *bits, int half) {
    uint64_t high = bits->word[2 * half], low = bits->word[2 * half + 1];
    uint64_t whole = (high << 32 | low) >> 12; /* 52 bits, then half a unit: neither 0 nor 1 */
    return ((double)whole + 0.5) * 0x1p-52;
}

void td_random_normals(const td_random_bits *bits, double normal[2]) {
    const double two_pi = 6.28318530717958647693;
    double radius = sqrt(-2 * log(td_random_uniform(bits, 0))), angle = two_pi * td_random_uniform(bits, 1);
    normal[0] = radius * cos(angle);
    normal[1] = radius * sin(angle);
}

double td_random_exponential(const td_random_bits *bits, int half) { return -log(td_random_uniform(bits, half)); }
