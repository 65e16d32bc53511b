/* Internal: half-precision numbers, IEEE 754 binary16: 5 bits of exponent (bias 15), 10 of fraction. Files store them, and
 * so do the truth labels of events. */
#ifndef TD_HALF_H
#define TD_HALF_H

#include <stdint.h>

/* The value of a half-precision number from its 16 bits. */
double td_half_of(uint32_t bits);

/* The bits of the half-precision number nearest to `value`; a tie goes to the even one. NaN stays NaN, and 65520 and above
 * becomes infinity. */
uint16_t td_half_bits(double value);

#endif
