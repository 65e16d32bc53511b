/* Half-precision numbers from and to their bits, for files and the labels of events. */
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
        bits = ((exponent + 14) << 10) + (int)rint(ldexp(fraction, 11)) - 1024; /* a carry goes up by itself */
    return (uint16_t)(bits | (signbit(value) ? 0x8000 : 0));
}
