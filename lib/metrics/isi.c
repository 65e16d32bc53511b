/* Intervals between the events of each pixel, and inverse Gaussian distributions fitted to them: IG-NLL (paper, Sec. 4.3).
 *
 * The density is sqrt(shape / (2 pi tau^3)) exp(-shape (tau - mean)^2 / (2 mean^2 tau)). So everything follows from the
 * number of intervals, and the means of tau, 1/tau and log tau. */
#include "td_metrics.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>

typedef struct moments {
    uint64_t count, floored;
    td_sum tau, inverse, logarithm; /* tau in seconds */
} moments;

static void add_interval(moments *m, int64_t interval_ns, double floor_s) {
    double tau = 1e-9 * (double)interval_ns;
    m->count++;
    if (tau < floor_s) {
        tau = floor_s;
        m->floored++;
    }
    td_sum_add(&m->tau, tau);
    td_sum_add(&m->inverse, 1.0 / tau);
    td_sum_add(&m->logarithm, td_ln(tau));
}

/* Adds the intervals of a pixel to each kind. The intervals between consecutive events also go to `list`, whose new length is
 * returned. */
static size_t pixel_intervals(const uint64_t *train, size_t count, double floor_s, moments kinds[TIDES_PAIRS], uint64_t *list,
                              size_t length) {
    int64_t last[2] = {-1, -1}; /* time of each polarity's last event */
    for (size_t i = 0; i < count; i++) {
        const int64_t time = td_train_time(train[i]);
        const int on = td_train_on(train[i]);
        if (i) {
            const int64_t interval = time - td_train_time(train[i - 1]);
            add_interval(&kinds[TIDES_PAIRS_ANY], interval, floor_s);
            if (on == td_train_on(train[i - 1])) add_interval(&kinds[TIDES_PAIRS_SAME], interval, floor_s);
            list[length++] = (uint64_t)interval;
        }
        if (last[on] >= 0) add_interval(&kinds[TIDES_PAIRS_SPLIT], time - last[on], floor_s);
        last[on] = time;
    }
    return length;
}

static double mean_tau(const moments *m) { return td_sum_of(&m->tau) / (double)m->count; }

/* mean(1/tau) - 1/mean(tau): the estimate of 1/shape. It is 0 for a regular train, so fit() bounds the shape by 1e6 means. */
static double spread(const moments *m) {
    const double difference = td_sum_of(&m->inverse) / (double)m->count - 1.0 / mean_tau(m);
    return difference > 0 ? difference : 0.0; /* below 0 only by rounding (Jensen) */
}

static tides_interval_fit fit(const moments *m) {
    tides_interval_fit fitted = {m->count, m->floored, NAN, NAN};
    if (m->count == 0) return fitted;
    fitted.mean_s = mean_tau(m);
    fitted.shape_s = 1.0 / fmax(spread(m), 1e-6 / fitted.mean_s);
    return fitted;
}

/* Negative log density, averaged over the intervals. */
static double negative_log_likelihood(const moments *m, const tides_interval_fit *f) {
    const double log_2_pi = 1.8378770664093453;
    const double n = (double)m->count, mean_log = td_sum_of(&m->logarithm) / n, mean_inverse = td_sum_of(&m->inverse) / n;
    return 0.5 * (log_2_pi + 3.0 * mean_log - td_ln(f->shape_s)) +
           f->shape_s / (2.0 * f->mean_s * f->mean_s) * (mean_tau(m) - 2.0 * f->mean_s + f->mean_s * f->mean_s * mean_inverse);
}

/* The difference of two negative log-likelihoods, without the terms that cancel. */
static double excess(const moments *m, const tides_interval_fit *own, const tides_interval_fit *other) {
    const double away = own->mean_s - other->mean_s;
    return 0.5 * (td_ln(own->shape_s / other->shape_s) + (other->shape_s - own->shape_s) * spread(m)) +
           other->shape_s * away * away / (2.0 * other->mean_s * other->mean_s * own->mean_s);
}

static void compare_fits(const moments *reference, const moments *simulated, tides_metrics *out) {
    for (int pairs = 0; pairs < TIDES_PAIRS; pairs++) {
        const tides_interval_fit a = fit(&reference[pairs]), b = fit(&simulated[pairs]);
        out->reference.intervals[pairs] = a;
        out->simulated.intervals[pairs] = b;
        if (a.count == 0) continue;
        out->ig_nll_self[pairs] = negative_log_likelihood(&reference[pairs], &a);
        if (b.count < 2) continue;
        out->ig_nll[pairs] = negative_log_likelihood(&reference[pairs], &b);
        out->ig_nll_excess[pairs] = excess(&reference[pairs], &a, &b);
    }
}

/* All intervals of a stream: moments, spike ratio, and the sorted list (*list, allocated). */
static tides_status stream_intervals(const td_compare *c, const td_stream *stream, moments kinds[TIDES_PAIRS], uint64_t **list,
                                     size_t *length, tides_stream_metrics *out) {
    const size_t pixels = td_compare_pixels(c);
    uint64_t *scratch = NULL;
    *list = td_alloc(stream->count, sizeof **list, c->error);
    if (!*list) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < pixels; i++)
        *length = pixel_intervals(stream->train + stream->first[i], stream->first[i + 1] - stream->first[i],
                                  c->options->isi_floor_s, kinds, *list, *length);
    tides_status status = td_isi_spike(*list, *length, c->options, &out->isi_spike, c->error);
    if (status == TIDES_OK) scratch = td_alloc(*length, sizeof *scratch, c->error);
    if (status == TIDES_OK && !scratch) status = TIDES_NO_MEMORY;
    if (status == TIDES_OK) td_sort_values(*list, scratch, *length);
    free(scratch);
    return status;
}

tides_status td_compare_isi(td_compare *c) {
    moments a[TIDES_PAIRS] = {{0, 0, {0, 0}, {0, 0}, {0, 0}}}, b[TIDES_PAIRS] = {{0, 0, {0, 0}, {0, 0}, {0, 0}}};
    uint64_t *list_a = NULL, *list_b = NULL;
    size_t length_a = 0, length_b = 0;
    tides_status status = stream_intervals(c, &c->reference, a, &list_a, &length_a, &c->metrics->reference);
    if (status == TIDES_OK) status = td_compare_report(c, 0.5, "intervals");
    if (status == TIDES_OK) status = stream_intervals(c, &c->simulated, b, &list_b, &length_b, &c->metrics->simulated);
    if (status == TIDES_OK) {
        compare_fits(a, b, c->metrics);
        c->metrics->isi_w1 = td_isi_distance(list_a, length_a, list_b, length_b, 1e9 * c->options->isi_floor_s);
    }
    free(list_a);
    free(list_b);
    return status;
}
