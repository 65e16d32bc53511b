/* Sorts many numbers, and sums numbers without loss of precision, for the metrics. */
#include "td_metrics.h"

#include "td_sort.h"

#include <math.h>
#include <string.h>

static inline uint64_t value_itself(const void *none, const void *value) {
    (void)none;
    return *(const uint64_t *)value;
}

void td_sort_values(uint64_t *values, uint64_t *scratch, size_t count) {
    uint64_t used = 0;
    for (size_t i = 0; i < count; i++) used |= values[i];
    uint64_t *from = values, *to = scratch;
    for (int shift = 0; shift < 64 && used >> shift; shift += TD_RADIX_BITS) {
        td_radix_pass(value_itself, NULL, shift, from, to, count, sizeof *from);
        uint64_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != values && count) memcpy(values, from, count * sizeof *values);
}

double td_median(const uint64_t *sorted, size_t count) {
    const size_t low = (count - 1) / 2, high = count / 2;
    return 0.5 * ((double)sorted[low] + (double)sorted[high]);
}

void td_sum_add(td_sum *sum, double value) {
    double total = sum->total + value;
    sum->lost += fabs(sum->total) >= fabs(value) ? sum->total - total + value : value - total + sum->total;
    sum->total = total;
}
