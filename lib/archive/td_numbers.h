/* Internal: decodes floating-point numbers of files, and formats shapes for messages. */
#ifndef TD_NUMBERS_H
#define TD_NUMBERS_H

#include "tides/base.h"

/* The IEEE 754 number of `bytes` = 2, 4 or 8 bytes with these bits. */
double td_float_bits(uint64_t bits, size_t bytes);

/* Formats a shape: "[3, any]" for {3, -1}, at most 8 extents. The text of TD_SHAPE_TEXT lives until the end of the enclosing
 * block. */
enum { TD_SHAPE_BYTES = 192 };
const char *td_shape_text(int ndim, const int64_t *shape, char text[TD_SHAPE_BYTES]);
#define TD_SHAPE_TEXT(ndim, shape) td_shape_text(ndim, shape, (char[TD_SHAPE_BYTES]){""})

#endif
