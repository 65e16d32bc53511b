/* Converts between half-precision numbers (IEEE 754 binary16) and double. Files store such numbers, and so do the truth
 * labels of events. */
#include "td_half.h"

#include <math.h>

double td_half_of(uint32_t bits) {
    int exponent = (int)(bits >> 10 & 31), fraction = (int)(bits & 1023);
    double magnitude = exponent == 31 ? (fraction ? NAN : INFINITY)
                       : exponent     ? ldexp(1024 + fraction, exponent - 25)
                                      : ldexp(fraction, -24);
    return bits & 0x8000u ? -magnitude : magnitude;
}

uint16_t td_half_bits(double value) {
    int exponent = 0, bits;
    double size = fabs(value), fraction = frexp(size, &exponent);
    if (isnan(value)) return 0x7e00;
    if (size >= 65520) /* half way from the largest number to 2^16 */
        bits = 0x7c00;
    else if (size < 0x1p-14)
        bits = (int)rint(ldexp(size, 24));
    else
        /* a mantissa that rounds up to 2048 carries into the exponent, as it should */
        bits = ((exponent + 14) << 10) + (int)rint(ldexp(fraction, 11)) - 1024;
    return (uint16_t)(bits | (signbit(value) ? 0x8000 : 0));
}
