/* ISI spike ratio (paper, Sec. 4.3): the fraction of inter-spike intervals near zero or at multiples of a clock's period. An
 * interval is the time between successive events of a pixel.
 *
 * Near zero means at most 1 us. With a known clock, intervals within 1 us of a multiple of its period count. Without one,
 * spikes are searched in a histogram of intervals up to 50 ms. Its bins are as wide as a tick, the unit to which event times
 * were rounded down, but at least 1 us. A bin is a spike if it holds at least 8 (m + 1) intervals, where m is the median of
 * the bins up to 50 bins away. Of a spike, all intervals but m count. With these limits the ratio equals the golden values of
 * tests/golden/test_metrics.c. */
#include "td_metrics.h"

#include <math.h>
#include <stdlib.h>

enum { REACH = 50, FACTOR = 8 }; /* bins to each side of a bin for its median; least ratio of a spike to m + 1 */

static const uint64_t near_ns = 1000, longest_ns = 50000000;

static int ascending(const void *left, const void *right) {
    const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return (a > b) - (a < b);
}

static double median_around(const uint64_t *histogram, size_t bins, size_t bin) {
    uint64_t around[2 * REACH + 1] = {0};
    const size_t low = bin > REACH ? bin - REACH : 0, high = bin + REACH + 1 < bins ? bin + REACH + 1 : bins;
    for (size_t i = low; i < high; i++) around[i - low] = histogram[i];
    qsort(around, high - low, sizeof *around, ascending);
    return td_median(around, high - low);
}

static double spikes(const uint64_t *histogram, size_t bins, size_t first) {
    double held = 0;
    for (size_t bin = first; bin < bins; bin++) {
        if (histogram[bin] < FACTOR) continue;
        const double median = median_around(histogram, bins, bin), here = (double)histogram[bin];
        if (here >= FACTOR * (median + 1.0)) held += here - median;
    }
    return held;
}

static int on_clock(uint64_t interval_ns, double period_ns) {
    const double multiple = round((double)interval_ns / period_ns);
    return multiple >= 1 && fabs((double)interval_ns - multiple * period_ns) <= (double)near_ns;
}

tides_status td_isi_spike(const uint64_t *intervals, size_t count, const tides_metrics_options *options, double *spike,
                          tides_error *error) {
    const double period_ns = 1e9 * options->clock_s;
    /* A bin is a tick, but at least a microsecond, to keep the histogram small. */
    const uint64_t tick = options->tick_ns > 1000 ? (uint64_t)options->tick_ns : 1000;
    const size_t bins = (size_t)(longest_ns / tick + 1);
    double counted = 0;
    if (count == 0) return TIDES_OK;
    uint64_t *histogram = td_alloc(bins, sizeof *histogram, error);
    if (!histogram) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const uint64_t bin = (intervals[i] + tick / 2) / tick;
        if (bin < bins) histogram[bin]++;
        if (intervals[i] <= near_ns || (period_ns > 0 && on_clock(intervals[i], period_ns))) counted++;
    }
    /* The loop above counted the intervals near zero: bins centred there are left out. */
    if (!(period_ns > 0)) counted += spikes(histogram, bins, (size_t)(near_ns / tick + 1));
    free(histogram);
    *spike = counted / (double)count;
    return TIDES_OK;
}
