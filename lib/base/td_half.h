/* Internal: half-precision numbers, IEEE 754 binary16: 5 bits of exponent (bias 15), 10 of fraction. For readers of files that
 * store them, and the labels of events. */
#ifndef TD_HALF_H
#define TD_HALF_H

#include <stdint.h>

/* The number that these 16 bits are. */
double td_half_of(uint32_t bits);

/* The bits of the number that is nearest to `value`, of two the even one; NaN and what is too large stay so. */
uint16_t td_half_bits(double value);

#endif
