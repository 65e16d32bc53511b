/* Test support: reads numpy's files by the library's own reader (lib/archive/td_npy.h), and prints errors on stderr. */
#ifndef TESTS_SUPPORT_NPZ_H
#define TESTS_SUPPORT_NPZ_H

#include "archive/td_npy.h"

typedef td_npz npz;
typedef td_npy_array npz_array;

/* Opens an .npz, or an .npy as one array called "data". NULL, with the reason on stderr, where that fails. */
npz *npz_open(const char *path);

/* NULL is fine. */
void npz_close(npz *file);

/* Number of arrays and the name of each (without ".npy"), in file order; NULL out of range. */
size_t npz_count(const npz *file);
const char *npz_name(const npz *file, size_t index);

/* One array, read at the first call; NULL if absent (silent) or unreadable (reason on stderr). */
const npz_array *npz_get(npz *file, const char *name);

/* Any numeric array as doubles, `*count` (nullable) of them; the caller frees it. NULL where absent or not numeric. */
double *npz_doubles(npz *file, const char *name, size_t *count);

/* The first element as an integer; LONG_MIN, with the reason on stderr, where absent or not numeric. */
long npz_int(npz *file, const char *name);

/* A text scalar (<U) as UTF-8, cut to fit; "" where absent or no text. */
void npz_string(npz *file, const char *name, char *out, size_t size);

#endif
