/* tides_metrics_compare: gets two streams ready (stream.c), and asks each part that is wanted, each in its own file. */
#include "td_metrics.h"

#include "td_struct.h"

#include <math.h>
#include <string.h>

#define PIXELS_MAX ((size_t)1 << 26) /* eight times the largest event sensor: a bound on memory, whatever a file claims */

tides_status td_compare_report(const td_compare *c, double fraction, const char *stage) {
    if (!c->progress || c->progress(c->user, fraction, stage) == 0) return TIDES_OK;
    return td_fail(c->error, TIDES_CANCELLED, "stopped on request");
}

/* -- what is compared ----------------------------------------------------------------------------------------------- */

static tides_status set_region(td_compare *c, const td_extent *a, const td_extent *b) {
    const tides_metrics_options *o = c->options;
    c->width = o->width ? o->width : a->width > b->width ? a->width : b->width;
    c->height = o->height ? o->height : a->height > b->height ? a->height : b->height;
    if (o->roi[2]) {
        if (o->width && (o->roi[0] + o->roi[2] > o->width || o->roi[1] + o->roi[3] > o->height))
            return td_fail(c->error, TIDES_BAD_ARGUMENT, "the region %d,%d,%d,%d reaches outside the sensor of %dx%d px",
                           o->roi[0], o->roi[1], o->roi[2], o->roi[3], o->width, o->height);
        c->width = o->roi[2];
        c->height = o->roi[3];
    }
    if (td_compare_pixels(c) > PIXELS_MAX)
        return td_fail(c->error, TIDES_UNSUPPORTED,
                       "the events need %dx%d px, more than %zu pixels: give the sensor's size or a region", c->width,
                       c->height, PIXELS_MAX);
    c->metrics->width = c->width;
    c->metrics->height = c->height;
    return TIDES_OK;
}

/* Recordings of two clocks would be compared with nothing, event for event, and their counts still agree. */
static tides_status check_clocks(const td_compare *c, const td_extent *a, size_t count_a, const td_extent *b, size_t count_b) {
    const int given = c->options->start_ns != c->options->stop_ns;
    if (given || !count_a || !count_b || (a->first_ns <= b->last_ns && b->first_ns <= a->last_ns)) return TIDES_OK;
    return td_fail(c->error, TIDES_BAD_ARGUMENT,
                   "the reference lasts from %.15g to %.15g s and the simulated stream from %.15g to %.15g s, which share no "
                   "time: "
                   "count both from their recording's zero (--rebase), shift one (--offset), or give the interval",
                   1e-9 * (double)a->first_ns, 1e-9 * (double)a->last_ns, 1e-9 * (double)b->first_ns,
                   1e-9 * (double)b->last_ns);
}

static void set_interval(td_compare *c, const td_extent *a, size_t count_a, const td_extent *b, size_t count_b) {
    const tides_metrics_options *o = c->options;
    const int64_t tick = o->tick_ns > 0 ? o->tick_ns : 1;
    int64_t start = o->start_ns, stop = o->stop_ns;
    if (start == stop) {
        const td_extent *first = count_a && (!count_b || a->first_ns <= b->first_ns) ? a : b;
        const td_extent *last = count_a && (!count_b || a->last_ns >= b->last_ns) ? a : b;
        start = first->first_ns;
        stop = count_a + count_b ? td_floor_to(last->last_ns, tick) + tick : start;
    }
    c->metrics->start_ns = td_floor_to(start, tick);
    c->metrics->stop_ns = stop;
    c->span_ns = stop - c->metrics->start_ns;
}

/* NaN everywhere, but for what is counted. */
static void clear(tides_metrics *m, uint32_t wanted) {
    *m = (tides_metrics){.computed = wanted};
    double *const values[] = {&m->count_ratio,
                              &m->count_correlation,
                              &m->isi_w1,
                              &m->speed_px_per_s,
                              &m->chamfer_px,
                              &m->chamfer_fraction,
                              &m->chamfer_limit_px,
                              &m->chamfer_to_simulated_px,
                              &m->chamfer_to_reference_px,
                              &m->victor_purpura,
                              &m->victor_purpura_fraction,
                              &m->van_rossum,
                              &m->van_rossum_fraction,
                              &m->time_difference_us,
                              &m->kernel_distance};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) *values[i] = NAN;
    for (int i = 0; i < TIDES_PAIRS; i++) m->ig_nll[i] = m->ig_nll_self[i] = m->ig_nll_excess[i] = NAN;
    for (int i = 0; i < TIDES_FANO_BINS; i++) m->fano_error[i] = m->fano_coverage[i] = NAN;
    tides_stream_metrics *const streams[] = {&m->reference, &m->simulated};
    for (int s = 0; s < 2; s++) {
        tides_stream_metrics *out = streams[s];
        out->on_fraction = out->isi_spike = out->same_time = out->same_time_tile = out->van_rossum_norm = NAN;
        for (int i = 0; i < TIDES_FANO_BINS; i++) out->fano[i] = NAN;
        for (int i = 0; i < TIDES_PAIRS; i++) out->intervals[i].mean_s = out->intervals[i].shape_s = NAN;
    }
    m->match.dt_median_us = m->match.dt_p95_us = m->match.dt_p99_us = m->match.dt_max_us = m->match.dt_mean_us = NAN;
    m->match.mismatch_percent = NAN;
}

/* -- the parts ------------------------------------------------------------------------------------------------------ */

static const struct part {
    uint32_t wanted; /* any of these */
    const char *stage;
    tides_status (*compute)(td_compare *);
} parts[] = {
    {TIDES_METRIC_COUNTS, "counts", td_compare_counts},
    {TIDES_METRIC_SAME_TIME, "Same-ts", td_compare_same_time},
    {TIDES_METRIC_FANO, "Fano factors", td_compare_fano},
    {TIDES_METRIC_ISI, "intervals", td_compare_isi},
    {TIDES_METRIC_VICTOR_PURPURA | TIDES_METRIC_VAN_ROSSUM | TIDES_METRIC_TIME_DIFFERENCE, "spike trains", td_compare_trains},
    {TIDES_METRIC_KERNEL, "kernel distance", td_compare_kernel},
    {TIDES_METRIC_CHAMFER, "Chamfer", td_compare_chamfer},
};

/* Parts that go through the events pixel by pixel. */
enum {
    NEED_TRAINS = TIDES_METRIC_COUNTS | TIDES_METRIC_ISI | TIDES_METRIC_VICTOR_PURPURA | TIDES_METRIC_VAN_ROSSUM |
                  TIDES_METRIC_TIME_DIFFERENCE
};

/* Exact times are matched as they are, without a clock. Before anything else: matching makes copies of its own. */
static tides_status match(td_compare *c, const tides_event *reference, size_t reference_count, const tides_event *simulated,
                          size_t simulated_count) {
    if (!(c->options->wanted & TIDES_METRIC_MATCH)) return TIDES_OK;
    tides_status status = td_compare_report(c, 0.0, "matching");
    if (status == TIDES_OK) status = td_stream_make(reference, reference_count, c, 0, 0, &c->reference);
    if (status == TIDES_OK) status = td_stream_make(simulated, simulated_count, c, 0, 0, &c->simulated);
    if (status == TIDES_OK)
        status = tides_match_events(c->reference.events, c->reference.count, c->simulated.events, c->simulated.count,
                                    c->options->match_limit_s, &c->metrics->match, c->error);
    td_stream_release(&c->reference);
    td_stream_release(&c->simulated);
    return status;
}

static tides_status compute(td_compare *c, const tides_event *reference, size_t reference_count, const tides_event *simulated,
                            size_t simulated_count) {
    const int with_trains = (c->options->wanted & NEED_TRAINS) != 0;
    const int64_t tick = c->options->tick_ns;
    tides_status status = td_stream_make(reference, reference_count, c, tick, with_trains, &c->reference);
    if (status == TIDES_OK) status = td_stream_make(simulated, simulated_count, c, tick, with_trains, &c->simulated);
    c->metrics->reference.events = c->reference.count;
    c->metrics->simulated.events = c->simulated.count;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && status == TIDES_OK; i++) {
        if (!(c->options->wanted & parts[i].wanted)) continue;
        status = td_compare_report(c, 0.0, parts[i].stage);
        if (status == TIDES_OK) status = parts[i].compute(c);
    }
    td_stream_release(&c->reference);
    td_stream_release(&c->simulated);
    return status;
}

tides_status tides_metrics_compare(const tides_event *reference, size_t reference_count, const tides_event *simulated,
                                   size_t simulated_count, const tides_metrics_options *given, tides_progress progress,
                                   void *user, tides_metrics *metrics, tides_error *error) {
    if ((!reference && reference_count) || (!simulated && simulated_count) || !given || !metrics)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_metrics_compare: both streams, options and metrics must be given");
    tides_metrics made;
    tides_metrics_options own;
    const tides_metrics_options *options = &own;
    td_extent a, b;
    tides_metrics_options_defaults(&own);
    tides_status status = TD_TAKE_STRUCT(tides_metrics_options, &own, given, error);
    if (status == TIDES_OK) status = td_metrics_options_check(options, error);
    if (status != TIDES_OK) return status;
    clear(&made, options->wanted);
    td_compare c = {.options = options, .progress = progress, .user = user, .metrics = &made, .error = error};
    status = td_stream_check(reference, reference_count, "reference", options, &a, error);
    if (status == TIDES_OK) status = td_stream_check(simulated, simulated_count, "simulated", options, &b, error);
    if (status == TIDES_OK) status = check_clocks(&c, &a, reference_count, &b, simulated_count);
    if (status == TIDES_OK) status = set_region(&c, &a, &b);
    if (status != TIDES_OK) return status;
    set_interval(&c, &a, reference_count, &b, simulated_count);
    status = match(&c, reference, reference_count, simulated, simulated_count);
    if (status == TIDES_OK) status = compute(&c, reference, reference_count, simulated, simulated_count);
    if (status == TIDES_OK) *metrics = made;
    return status;
}
