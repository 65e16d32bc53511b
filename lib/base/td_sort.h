/* Internal: putting numbers in order. One comparator for qsort, and the pass of a radix sort for whoever has a key. */
#ifndef TD_SORT_H
#define TD_SORT_H

#include <stddef.h>
#include <stdint.h>

/* For qsort and bsearch of doubles without NaN: ascending. */
static inline int td_ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#endif
