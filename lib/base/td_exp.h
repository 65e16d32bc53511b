/* e^x in operations that vectorise, and have the same bits everywhere: libm's differs from one libm to the next, and takes a
 * call for each. */
#ifndef TD_EXP_H
#define TD_EXP_H

#include <stdint.h>
#include <string.h>

/* Of |x| < 700, to 2 units in the last place; beyond, and of NaN, anything. With x = n log 2 + r, |r| <= log(2) / 2, whose
 * series' first term left out is below 2^-56. */
static inline double td_exp(double x) {
    const double by_log_2 = 1.44269504088896340736, high = 0x1.62e42feep-1, low = 0x1.a39ef35793c76p-33; /* log 2: high + low */
    const double shifted = x * by_log_2 + 0x1.8p52, n = shifted - 0x1.8p52, r = (x - n * high) - n * low, one = 1;
    uint64_t bits, bits_of_one;
    double power, sum = 1 / 6227020800.0; /* 1 / 13! */
    sum = sum * r + 1 / 479001600.0;
    sum = sum * r + 1 / 39916800.0;
    sum = sum * r + 1 / 3628800.0;
    sum = sum * r + 1 / 362880.0;
    sum = sum * r + 1 / 40320.0;
    sum = sum * r + 1 / 5040.0;
    sum = sum * r + 1 / 720.0;
    sum = sum * r + 1 / 120.0;
    sum = sum * r + 1 / 24.0;
    sum = sum * r + 1 / 6.0;
    sum = sum * r + 0.5;
    memcpy(&bits, &shifted, sizeof bits); /* n is what ends it */
    memcpy(&bits_of_one, &one, sizeof bits_of_one);
    bits = (bits << 52) + bits_of_one;
    memcpy(&power, &bits, sizeof power);
    return power * (1 + (r + r * r * sum));
}

#endif
