/* A part of tides_metrics_compare: how many events, of which polarity, and where, in both streams. */
#include "td_metrics.h"

#include <math.h>

static double on_fraction(const td_stream *stream) {
    size_t on = 0;
    for (size_t i = 0; i < stream->count; i++) on += stream->events[i].polarity > 0;
    return stream->count ? (double)on / (double)stream->count : NAN;
}

/* Pearson's correlation over all pixels; NaN where either stream has the same count everywhere. */
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
    m->reference.on_fraction = on_fraction(&c->reference);
    m->simulated.on_fraction = on_fraction(&c->simulated);
    m->count_ratio = c->reference.count ? (double)c->simulated.count / (double)c->reference.count : NAN;
    m->count_correlation = correlation(c);
    return TIDES_OK;
}
