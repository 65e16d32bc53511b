/* Internal: plain values as a pickle, which is what numpy's object arrays are in .npy and .npz files: dicts, lists, text,
 * numbers, and arrays of numbers. The contents of a container are put between begin and end; in a dict each value follows its
 * key. Protocol 5 (Python 3.8 on), whose byte arrays make numpy's arrays writable. */
#ifndef TD_PICKLER_H
#define TD_PICKLER_H

#include "archive/td_npy.h"

typedef struct td_pickler {
    unsigned char *bytes;
    size_t size, room;
    tides_status status; /* of all so far: who puts looks at it once, in td_pickler_end */
    tides_error *error;
} td_pickler;

/* An object array of no dimensions: numpy.load(..., allow_pickle=True).item() is the one value that is put next. */
void td_pickler_begin(td_pickler *p, tides_error *error);

void td_pickler_dict(td_pickler *p);
void td_pickler_dict_end(td_pickler *p);
void td_pickler_list(td_pickler *p);
void td_pickler_list_end(td_pickler *p);
void td_pickler_text(td_pickler *p, const char *text); /* also a key */
void td_pickler_integer(td_pickler *p, int32_t value);
void td_pickler_number(td_pickler *p, double value);

/* An array of `ndim` extents in C order, its elements little-endian; `dtype` as numpy says it ("<f4"). */
void td_pickler_array(td_pickler *p, const char *dtype, size_t item, int ndim, const size_t *shape, const void *values);

/* Puts it into a file as array `name` and frees it: the status of all that was put. To drop one that was dropped is fine. */
tides_status td_pickler_end(td_pickler *p, td_npy_writer *npy, const char *name);
void td_pickler_drop(td_pickler *p);

#endif
