/* Numbers as files store them, of any width and half precision too, and shapes as messages show them: for the readers of
 * .npy and of tensors, and for the labels of events. */
#include "archive/td_numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* IEEE 754 binary16: 5 bits of exponent (bias 15), 10 of fraction. */
static double half(uint32_t bits) {
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

double td_float_bits(uint64_t bits, size_t bytes) {
    if (bytes == 2) return half((uint32_t)bits & 0xffffu);
    if (bytes == 4) {
        uint32_t low = (uint32_t)bits;
        float value;
        memcpy(&value, &low, sizeof value);
        return (double)value;
    }
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

const char *td_shape_text(int ndim, const int64_t *shape, char text[TD_SHAPE_BYTES]) {
    size_t used = (size_t)snprintf(text, TD_SHAPE_BYTES, "[");
    for (int d = 0; d < ndim && d < 8; d++) { /* 8 times at most 22 characters */
        const char *comma = d ? ", " : "";
        used += shape[d] < 0 ? (size_t)snprintf(text + used, TD_SHAPE_BYTES - used, "%sany", comma)
                             : (size_t)snprintf(text + used, TD_SHAPE_BYTES - used, "%s%lld", comma, (long long)shape[d]);
    }
    snprintf(text + used, TD_SHAPE_BYTES - used, "]");
    return text;
}
