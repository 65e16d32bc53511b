/* Victor-Purpura distance (Victor & Purpura 1996): the least cost of turning one train into another. Adding or removing an
 * event costs 1, and shifting it `cost` per time.
 *
 * A shift pays if it is cheaper than removing and adding. So the distance is count_a + count_b minus the largest sum of (2 -
 * cost |dt|) over order-preserving pairings. Events further apart than 2 / cost are never paired. So a row of the dynamic
 * programming table only needs the window of b around a's time. Only the sum is wanted: one row is kept, and columns left of
 * the window keep their values. */
#include "td_metrics.h"

double td_edit_cost(const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, double cost_per_ns, double *score) {
    const double reach = 2.0 / cost_per_ns;
    size_t low = 0, high = 0; /* the window: columns before `high` are filled */
    score[0] = 0;
    for (size_t i = 0; i < count_a; i++) {
        while (low < count_b && (double)(a[i] - b[low]) > reach) low++;
        while (high < count_b && (high < low || (double)(b[high] - a[i]) <= reach)) {
            score[high + 1] = score[high];
            high++;
        }
        double before = score[low]; /* value of the previous row, one column to the left */
        for (size_t j = low; j < high; j++) {
            const int64_t dt = a[i] - b[j];
            const double pair = before + 2.0 - cost_per_ns * (double)(dt < 0 ? -dt : dt);
            before = score[j + 1];
            if (pair > score[j + 1]) score[j + 1] = pair;
            if (score[j] > score[j + 1]) score[j + 1] = score[j];
        }
    }
    return (double)count_a + (double)count_b - score[high];
}
