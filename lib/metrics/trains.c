/* Compares the trains of each pixel and polarity: Victor-Purpura distance, van Rossum distance, and time to the nearest
 * event. */
#include "td_metrics.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>

enum { REPORT_EVERY = 4096 }; /* pixels */

typedef struct train {
    int64_t *times; /* [ns], ascending */
    size_t count;
} train;

typedef struct sums {
    td_sum victor_purpura, van_rossum, norm[2], difference;
    uint64_t over;
} sums;

/* D^2 is the sum of w_i w_j exp(-|t_i - t_j| / tau) over all pairs of events, and of each with itself. w is 1 for events of
 * a, -1 for b (van Rossum 2001; scaled so that one event against none gives 1). In order of time, the sum over earlier events
 * decays from one time to the next. Simultaneous events are added together, so that equal trains give exactly 0. */
static double van_rossum(const train *a, const train *b, double tau_ns) {
    size_t i = 0, j = 0;
    double square = 0, filtered = 0;
    int64_t last = 0;
    while (i < a->count || j < b->count) {
        const int64_t now = j == b->count || (i < a->count && a->times[i] <= b->times[j]) ? a->times[i] : b->times[j];
        double weight = 0;
        for (; i < a->count && a->times[i] == now; i++) weight += 1;
        for (; j < b->count && b->times[j] == now; j++) weight -= 1;
        filtered *= td_exp(-(double)(now - last) / tau_ns);
        square += weight * (weight + 2.0 * filtered);
        filtered += weight;
        last = now;
    }
    return square;
}

/* Sums the times from each event of `from` to the nearest one of `to`, each at most `limit`. */
static void differences(const train *from, const train *to, double limit_ns, sums *s) {
    size_t j = 0;
    for (size_t i = 0; i < from->count; i++) {
        const int64_t time = from->times[i];
        double nearest = INFINITY;
        while (j < to->count && to->times[j] < time) j++;
        if (j < to->count) nearest = (double)(to->times[j] - time);
        if (j > 0) nearest = fmin(nearest, (double)(time - to->times[j - 1]));
        s->over += nearest > limit_ns;
        td_sum_add(&s->difference, fmin(nearest, limit_ns));
    }
}

static void take(const td_stream *stream, size_t pixel, int on, train *out) {
    out->count = 0;
    for (size_t i = stream->first[pixel]; i < stream->first[pixel + 1]; i++)
        if (td_train_on(stream->train[i]) == on) out->times[out->count++] = td_train_time(stream->train[i]);
}

static void compare_trains(const td_compare *c, const train *a, const train *b, double *score, sums *s) {
    static const train none = {NULL, 0};
    const tides_metrics_options *o = c->options;
    if (a->count + b->count == 0) return;
    if (o->wanted & TIDES_METRIC_VICTOR_PURPURA)
        td_sum_add(&s->victor_purpura,
                   td_edit_cost(a->times, a->count, b->times, b->count, 1e-9 * o->victor_purpura_per_s, score));
    if (o->wanted & TIDES_METRIC_VAN_ROSSUM) {
        const double tau_ns = 1e9 * o->van_rossum_s;
        td_sum_add(&s->van_rossum, van_rossum(a, b, tau_ns));
        td_sum_add(&s->norm[0], van_rossum(a, &none, tau_ns));
        td_sum_add(&s->norm[1], van_rossum(b, &none, tau_ns));
    }
    if (o->wanted & TIDES_METRIC_TIME_DIFFERENCE) differences(a, b, 1e9 * o->difference_limit_s, s);
}

static void summarise(td_compare *c, const sums *s) {
    const tides_metrics_options *o = c->options;
    const double events = (double)c->reference.count + (double)c->simulated.count;
    tides_metrics *m = c->metrics;
    if (o->wanted & TIDES_METRIC_VICTOR_PURPURA) {
        m->victor_purpura = td_sum_of(&s->victor_purpura);
        if (events > 0) m->victor_purpura_fraction = m->victor_purpura / events;
    }
    if (o->wanted & TIDES_METRIC_VAN_ROSSUM) {
        m->van_rossum = td_sum_of(&s->van_rossum);
        m->reference.van_rossum_norm = td_sum_of(&s->norm[0]);
        m->simulated.van_rossum_norm = td_sum_of(&s->norm[1]);
        if (events > 0) m->van_rossum_fraction = m->van_rossum / (m->reference.van_rossum_norm + m->simulated.van_rossum_norm);
    }
    if (o->wanted & TIDES_METRIC_TIME_DIFFERENCE && c->reference.count) {
        m->time_difference_us = 1e-3 * td_sum_of(&s->difference) / (double)c->reference.count;
        m->time_difference_over = s->over;
    }
}

static size_t longest(const td_stream *stream, size_t pixels) {
    size_t most = 0;
    for (size_t i = 0; i < pixels; i++)
        if (stream->first[i + 1] - stream->first[i] > most) most = stream->first[i + 1] - stream->first[i];
    return most;
}

tides_status td_compare_trains(td_compare *c) {
    const size_t pixels = td_compare_pixels(c), most_b = longest(&c->simulated, pixels);
    train a = {td_alloc(longest(&c->reference, pixels), sizeof *a.times, c->error), 0};
    train b = {td_alloc(most_b, sizeof *b.times, c->error), 0};
    double *score = td_alloc(most_b + 1, sizeof *score, c->error);
    tides_status status = a.times && b.times && score ? TIDES_OK : TIDES_NO_MEMORY;
    sums s = {{0, 0}, {0, 0}, {{0, 0}, {0, 0}}, {0, 0}, 0};
    for (size_t pixel = 0; status == TIDES_OK && pixel < pixels; pixel++) {
        for (int on = 0; on < 2; on++) {
            take(&c->reference, pixel, on, &a);
            take(&c->simulated, pixel, on, &b);
            compare_trains(c, &a, &b, score, &s);
        }
        if (pixel % REPORT_EVERY == 0) status = td_compare_report(c, (double)pixel / (double)pixels, "spike trains");
    }
    if (status == TIDES_OK) summarise(c, &s);
    free(a.times);
    free(b.times);
    free(score);
    return status;
}
