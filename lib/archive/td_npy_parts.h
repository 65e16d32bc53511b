/* Internal: declarations shared by the parser of an .npy (header and elements) and the parser of its dtype. */
#ifndef TD_NPY_PARTS_H
#define TD_NPY_PARTS_H

#include "archive/td_npy.h"
#include "archive/td_value.h"

/* Fills dtype, fields, field_count and item from the header's 'descr', which is a text or a list of tuples. `what` begins
 * messages ("FILE: array t"). `*swap`: some field is big-endian (npy_dtype.c). */
tides_status td_npy_read_dtype(const char *what, const td_value *descr, td_npy_array *array, int *swap, tides_error *error);

/* Reverses the bytes of each big-endian field of all elements, and makes the dtype little-endian. */
void td_npy_swap(td_npy_array *array, const td_value *descr, unsigned char *elements);

/* Parses one .npy. `*owned`: memory that the caller frees. */
tides_status td_npy_parse(const char *what, const unsigned char *npy, size_t size, td_npy_array *array, void **owned,
                          tides_error *error);

#endif
