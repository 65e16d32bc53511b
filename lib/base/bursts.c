/* Finds bursts of events that a DAVIS makes when it reads out a frame: short leaps in the rate of events over all pixels. */
#include "td_bursts.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

enum {
    AROUND = 40,  /* bins on either side whose median is the usual rate: 10 ms */
    LONGEST = 20, /* bins: a longer leap (5 ms) comes from the scene */
    SILENT = 6,   /* bins between the two leaps of one readout: in between the pixels are held */
    WIDER = 2     /* bins on either side that are marked, too: a burst's edges are lower than its top */
};
#define ABOVE 1.5  /* a burst's rate is above this multiple of the usual rate */
#define SIGMAS 6.0 /* a burst's rate is above the usual rate by this multiple of the usual rate's Poisson scatter */

static double usual(const uint32_t *rate, size_t bins, size_t bin) {
    double around[2 * AROUND + 1];
    size_t count = 0;
    const size_t from = bin > AROUND ? bin - AROUND : 0, to = bin + AROUND < bins ? bin + AROUND : bins - 1;
    for (size_t i = from; i <= to; i++) around[count++] = rate[i];
    qsort(around, count, sizeof around[0], td_ascending);
    return around[count / 2];
}

static int32_t leaps(const uint32_t *rate, size_t bins, size_t bin) {
    const double here = rate[bin];
    if (here <= SIGMAS) return 0; /* too few events to be a burst, whatever the usual rate is */
    const double there = usual(rate, bins, bin);
    return here > ABOVE * there && here > there + SIGMAS * sqrt(there + 1);
}

int32_t td_bursts_in(const uint32_t *rate, size_t bins, uint8_t *burst) {
    int32_t count = 0;
    for (size_t i = 0; i < bins; i++) {
        size_t end = i + 1, last = i;
        if (!leaps(rate, bins, i)) continue;
        for (; end < bins && end - last <= SILENT; end++)
            if (leaps(rate, bins, end)) last = end;
        if (last - i < LONGEST) {
            for (size_t k = i > WIDER ? i - WIDER : 0; k <= last + WIDER && k < bins; k++) burst[k] = 1;
            count++;
        }
        i = last;
    }
    return count;
}
