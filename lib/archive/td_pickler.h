/* Internal: writes plain values as a pickle: dicts, lists, text, numbers, and arrays of numbers. In .npy and .npz files numpy
 * stores an object array as a pickle. Put a container's contents between begin and end; in a dict each value follows its key.
 * Protocol 5 (Python 3.8 on) is needed: arrays made of its byte arrays can be changed in numpy, others are read-only. */
#ifndef TD_PICKLER_H
#define TD_PICKLER_H

#include "archive/td_npy.h"

typedef struct td_pickler {
    unsigned char *bytes;
    size_t size, room;
    tides_status status; /* first failure of all calls; td_pickler_end returns it */
    tides_error *error;
} td_pickler;

/* Begins an object array without dimensions. Its one value is put next: numpy.load(..., allow_pickle=True).item(). */
void td_pickler_begin(td_pickler *p, tides_error *error);

void td_pickler_dict(td_pickler *p);
void td_pickler_dict_end(td_pickler *p);
void td_pickler_list(td_pickler *p);
void td_pickler_list_end(td_pickler *p);
void td_pickler_text(td_pickler *p, const char *text); /* also a key */
void td_pickler_integer(td_pickler *p, int32_t value);
void td_pickler_number(td_pickler *p, double value);

/* Puts an array of `ndim` extents in C order, little-endian; `dtype` as in numpy ("<f4"). */
void td_pickler_array(td_pickler *p, const char *dtype, size_t item, int ndim, const size_t *shape, const void *values);

/* td_pickler_end writes the pickle as array `name`, frees it, and returns the status of all calls. td_pickler_drop frees it;
 * a second drop does nothing. */
tides_status td_pickler_end(td_pickler *p, td_npy_writer *npy, const char *name);
void td_pickler_drop(td_pickler *p);

#endif
