/* Internal: numbers as files store them, and shapes as messages show them; for the readers of archives. */
#ifndef TD_NUMBERS_H
#define TD_NUMBERS_H

#include "tides/base.h"

/* The IEEE 754 number of `bytes` = 2, 4 or 8 bytes that these bits are. */
double td_float_bits(uint64_t bits, size_t bytes);

/* "[3, any]" for {3, -1}; the buffer lives as long as the caller's block. At most 8 extents. */
enum { TD_SHAPE_BYTES = 192 };
const char *td_shape_text(int ndim, const int64_t *shape, char text[TD_SHAPE_BYTES]);
#define TD_SHAPE_TEXT(ndim, shape) td_shape_text(ndim, shape, (char[TD_SHAPE_BYTES]){""})

#endif
