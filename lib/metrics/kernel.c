/* Squared distance of two streams as sums of 3-D Gaussians with the polarity as sign (after Li et al. 2019):
 *     sum over all pairs of p_i p_j w_i w_j exp(-(dx^2 + dy^2) / (2 s_px^2) - dt^2 / (2 s_s^2)),
 * where p is an event's polarity, and w is 1 for events of one stream and -1 for those of the other. */
#include "td_metrics.h"

#include "td_math.h"

#include <math.h>

enum { REPORT_EVERY = 1024 }; /* events */

static const double reach = 9.0; /* standard deviations: beyond, exp(-9^2 / 2) is below the rounding of 1 */

/* The sum over the pairs of an event of each stream. All three sums have their pairs in the same order, so that equal streams
 * give exactly 0. */
static tides_status inner(const td_compare *c, const td_stream *a, const td_stream *b, double done, double *result) {
    const double px = 0.5 / (c->options->kernel_px * c->options->kernel_px);
    const double sigma_ns = 1e9 * c->options->kernel_s, ns = 0.5 / (sigma_ns * sigma_ns);
    td_sum total = {0, 0};
    size_t low = 0;
    for (size_t i = 0; i < a->count; i++) {
        const tides_event *e = &a->events[i];
        double sum = 0;
        while (low < b->count && (double)(e->t - b->events[low].t) > reach * sigma_ns) low++;
        for (size_t j = low; j < b->count && (double)(b->events[j].t - e->t) <= reach * sigma_ns; j++) {
            const double x = e->x - b->events[j].x, y = e->y - b->events[j].y, t = (double)(e->t - b->events[j].t);
            const double exponent = px * (x * x + y * y) + ns * t * t;
            if (exponent <= 0.5 * reach * reach) sum += e->polarity * b->events[j].polarity * td_exp(-exponent);
        }
        td_sum_add(&total, sum);
        if (i % REPORT_EVERY != 0) continue;
        tides_status status = td_compare_report(c, (done + (double)i / (double)a->count) / 3.0, "kernel distance");
        if (status != TIDES_OK) return status;
    }
    *result = td_sum_of(&total);
    return TIDES_OK;
}

tides_status td_compare_kernel(td_compare *c) {
    double within_a = 0, within_b = 0, between = 0;
    tides_status status = inner(c, &c->reference, &c->reference, 0, &within_a);
    if (status == TIDES_OK) status = inner(c, &c->simulated, &c->simulated, 1, &within_b);
    if (status == TIDES_OK) status = inner(c, &c->reference, &c->simulated, 2, &between);
    if (status == TIDES_OK) c->metrics->kernel_distance = within_a + within_b - 2.0 * between;
    return status;
}
