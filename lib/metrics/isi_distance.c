/* Wasserstein-1 distance of the distributions of log10 of intervals, in decades: the area between the cumulative
 * distributions. */
#include "td_metrics.h"

#include "td_math.h"

#include <math.h>

double td_isi_distance(const uint64_t *a, size_t count_a, const uint64_t *b, size_t count_b, double floor_ns) {
    if (count_a == 0 || count_b == 0) return NAN;
    td_sum area = {0, 0};
    size_t i = 0, j = 0;
    double left = 0;
    while (i < count_a || j < count_b) {
        const uint64_t next = j == count_b || (i < count_a && a[i] <= b[j]) ? a[i] : b[j];
        const double right = td_ln(fmax((double)next, floor_ns)) * 0.43429448190325182765;
        if (i + j) td_sum_add(&area, fabs((double)i / (double)count_a - (double)j / (double)count_b) * (right - left));
        while (i < count_a && a[i] == next) i++;
        while (j < count_b && b[j] == next) j++;
        left = right;
    }
    return td_sum_of(&area);
}
