/* Internal: half-precision numbers, IEEE 754 binary16: 5 bits of exponent (bias 15), 10 of fraction. Arrays in
 * .npy files and pickles may hold them. A simulated event may carry one: the part of its signal that the front end added. */
#ifndef TD_HALF_H
#define TD_HALF_H

#include <stdint.h>

/* The value of a half-precision number from its 16 bits. */
double td_half_of(uint32_t bits);

/* The bits of the half-precision number nearest to `value`; a tie goes to the even one. NaN stays NaN. Magnitudes from
 * 65520, half way between the largest half-precision number (65504) and 65536, become infinity of the same sign. */
uint16_t td_half_bits(double value);

#endif
