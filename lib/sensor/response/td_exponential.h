/* Internal: e^x for the loops over many pixels: basic operations alone, so that compilers vectorise it and no C library has a
 * say in the bits. */
#ifndef TD_EXPONENTIAL_H
#define TD_EXPONENTIAL_H

#include "td_wide.h"

#include <stdint.h>
#include <string.h>

/* Below TD_EXPONENT_LEAST it stays at its value there, 5e-304; the largest x whose e^x is finite and a bit. */
#define TD_EXPONENT_LEAST (-698.0)
#define TD_EXPONENT_MOST 709.0

/* Of a finite x, error < 1 ulp (tests/unit/test_exponential.c); above TD_EXPONENT_MOST it stays at its value there. With x =
 * k ln 2 + r, |r| < 0.347, it is 2^k times the Taylor series of e^r, whose first term left out is below 5e-18. ln 2 is in
 * two parts, so that k times the first is exact. */
TD_WITHIN double td_exponential(double x) {
    static const double rounds = 0x1.8p52, per_ln2 = 1.44269504088896340736, ln2 = 0x1.62e42feep-1,
                        more = 0x1.a39ef35793c76p-33;
    const double low = x < TD_EXPONENT_LEAST ? TD_EXPONENT_LEAST : x, within = low > TD_EXPONENT_MOST ? TD_EXPONENT_MOST : low;
    const double shifted = within * per_ln2 + rounds, k = shifted - rounds, r = (within - k * ln2) - k * more;
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
    p = p * r + 1.0 / 6;
    p = p * r + 0.5;
    p = 1 + (r + r * r * p);
    uint64_t bits, power;
    memcpy(&bits, &p, sizeof bits);
    memcpy(&power, &shifted, sizeof power);
    bits += power << 52; /* the exponent's field */
    memcpy(&p, &bits, sizeof p);
    return p;
}

#endif
