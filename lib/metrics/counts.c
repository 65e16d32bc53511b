/* Compares numbers of events, their polarities, and their distribution over pixels, in two streams. */
#include "td_metrics.h"

#include <math.h>

static double over(size_t events, size_t of) { return of ? (double)events / (double)of : NAN; }

static size_t count_on(const td_stream *stream) {
    size_t on = 0;
    for (size_t i = 0; i < stream->count; i++) on += stream->events[i].polarity > 0;
    return on;
}

/* Pearson's correlation of the counts over all pixels; NaN if a stream has the same count everywhere. */
static double correlation(const td_compare *c) {
    const size_t pixels = td_compare_pixels(c), *a = c->reference.first, *b = c->simulated.first;
    const double mean_a = (double)c->reference.count / (double)pixels, mean_b = (double)c->simulated.count / (double)pixels;
    td_sum both = {0, 0}, square_a = {0, 0}, square_b = {0, 0};
    size_t varied_a = 0, varied_b = 0;
    for (size_t i = 0; i < pixels; i++) {
        const size_t here_a = a[i + 1] - a[i], here_b = b[i + 1] - b[i];
        const double da = (double)here_a - mean_a, db = (double)here_b - mean_b;
        varied_a += here_a != a[1] - a[0];
        varied_b += here_b != b[1] - b[0];
        td_sum_add(&both, da * db);
        td_sum_add(&square_a, da * da);
        td_sum_add(&square_b, db * db);
    }
    return varied_a && varied_b ? td_sum_of(&both) / sqrt(td_sum_of(&square_a) * td_sum_of(&square_b)) : NAN;
}

tides_status td_compare_counts(td_compare *c) {
    tides_metrics *m = c->metrics;
    const size_t on_a = count_on(&c->reference), on_b = count_on(&c->simulated);
    m->reference.on_fraction = over(on_a, c->reference.count);
    m->simulated.on_fraction = over(on_b, c->simulated.count);
    m->count_ratio = over(c->simulated.count, c->reference.count);
    m->count_ratio_on = over(on_b, on_a);
    m->count_ratio_off = over(c->simulated.count - on_b, c->reference.count - on_a);
    m->count_correlation = correlation(c);
    return TIDES_OK;
}
