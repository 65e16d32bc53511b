/* Decodes floating-point numbers of 2, 4 or 8 bytes, and formats shapes for messages. Used by the readers of .npy and of
 * tensors. */
#include "archive/td_numbers.h"
#include "td_half.h"

#include <stdio.h>
#include <string.h>

double td_float_bits(uint64_t bits, size_t bytes) {
    if (bytes == 2) return td_half_of((uint32_t)bits & 0xffffu);
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
    for (int d = 0; d < ndim && d < 8; d++) { /* at most 8 extents of 22 characters fit in the buffer */
        const char *comma = d ? ", " : "";
        used += shape[d] < 0 ? (size_t)snprintf(text + used, TD_SHAPE_BYTES - used, "%sany", comma)
                             : (size_t)snprintf(text + used, TD_SHAPE_BYTES - used, "%s%lld", comma, (long long)shape[d]);
    }
    snprintf(text + used, TD_SHAPE_BYTES - used, "]");
    return text;
}
