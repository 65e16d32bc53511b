/* Compares intervals between a pixel's events separately by the polarity of the first event, as distances of distributions.
 * Differences of thresholds, refractory periods and front ends show here. */
#include "td_metrics.h"

#include <math.h>
#include <stdlib.h>

/* Collects the intervals of all pixels that begin with an event of polarity `on`; returns their number. */
static size_t collect(const td_stream *stream, size_t pixels, int on, uint64_t *list) {
    size_t count = 0;
    for (size_t p = 0; p < pixels; p++)
        for (size_t i = stream->first[p] + 1; i < stream->first[p + 1]; i++)
            if (td_train_on(stream->train[i - 1]) == on)
                list[count++] = (uint64_t)(td_train_time(stream->train[i]) - td_train_time(stream->train[i - 1]));
    return count;
}

tides_status td_compare_isi_after(td_compare *c) {
    const td_stream *streams[2] = {&c->reference, &c->simulated};
    const size_t longest = streams[0]->count > streams[1]->count ? streams[0]->count : streams[1]->count;
    uint64_t *lists[3];
    tides_status status = TIDES_OK;
    for (int i = 0; i < 3; i++) {
        lists[i] = td_alloc(longest, sizeof *lists[i], c->error);
        if (!lists[i]) status = TIDES_NO_MEMORY;
    }
    for (int on = 0; on < 2 && status == TIDES_OK; on++) {
        size_t counts[2];
        for (int i = 0; i < 2; i++) {
            counts[i] = collect(streams[i], td_compare_pixels(c), on, lists[i]);
            td_sort_values(lists[i], lists[2], counts[i]);
        }
        c->metrics->isi_w1_after[on] = td_isi_distance(lists[0], counts[0], lists[1], counts[1], 1e9 * c->options->isi_floor_s);
    }
    for (int i = 0; i < 3; i++) free(lists[i]);
    return status;
}
