/* Bursts of events that the readout of frames makes (DAVIS): many pixels at once, both polarities, for a few milliseconds. They
 * are found over all pixels: the rate leaps far above what it is around them, and is back soon. */
#include "td_calibrate.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    AROUND = 40,  /* bins on either side whose median is the usual rate: 10 ms */
    LONGEST = 20, /* bins: what lasts more than 5 ms is the scene */
    SILENT = 6,   /* bins between the two leaps of one readout, while pixels are held */
    WIDER = 2     /* bins on either side that a burst's foot has */
};
#define ABOVE 1.5  /* times the usual rate, */
#define SIGMAS 6.0 /* and so many of its own scatter */

static double usual(const td_taken *t, size_t bin) {
    double around[2 * AROUND + 1];
    size_t count = 0;
    const size_t from = bin > AROUND ? bin - AROUND : 0, to = bin + AROUND < t->bins ? bin + AROUND : t->bins - 1;
    for (size_t i = from; i <= to; i++) around[count++] = t->rate[i];
    qsort(around, count, sizeof around[0], td_ascending);
    return around[count / 2];
}

static int32_t leaps(const td_taken *t, size_t bin) {
    const double here = t->rate[bin], there = usual(t, bin);
    return here > ABOVE * there && here > there + SIGMAS * sqrt(there + 1);
}

/* Marks bins of bursts; how many these are. */
static int32_t find(const td_taken *t, uint8_t *burst) {
    int32_t count = 0;
    for (size_t i = 0; i < t->bins; i++) {
        size_t end = i, last = i;
        if (!leaps(t, i)) continue;
        for (; end < t->bins && end - last <= SILENT; end++)
            if (leaps(t, end)) last = end;
        if (last - i < LONGEST) {
            for (size_t k = i > WIDER ? i - WIDER : 0; k <= last + WIDER && k < t->bins; k++) burst[k] = 1;
            count++;
        }
        i = last;
    }
    return count;
}

void td_bursts_mark(td_taken *taken) {
    taken->in_bursts = 0;
    for (size_t i = 0; i < taken->count; i++) {
        tides_event *e = &taken->events[i];
        e->cause = taken->burst[td_bin(taken, e->t)];
        taken->in_bursts += e->cause;
    }
}

tides_status td_bursts_find(td_taken *taken, tides_error *error) {
    taken->burst = td_alloc(taken->bins, 1, error);
    if (!taken->burst) return TIDES_NO_MEMORY;
    taken->bursts = find(taken, taken->burst);
    td_bursts_mark(taken);
    return TIDES_OK;
}
