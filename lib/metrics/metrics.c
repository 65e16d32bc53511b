/* tides_metrics_compare: prepares two streams (checked, cropped, sorted), and computes all requested families of metrics. */
#include "td_metrics.h"

#include "td_struct.h"

#include <math.h>
#include <string.h>

#define PIXELS_MAX ((size_t)1 << 26) /* eight times the largest event sensor: limits memory, whatever a file claims */

/* -- region and interval ----------------------------------------------------------------------------------------------- */

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

/* Refuses recordings that don't overlap in time: they have different clocks, and only their counts would agree. */
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

/* Sets all metrics to NaN, and counts to 0. */
static void clear(tides_metrics *m, uint32_t wanted) {
    static const int repeats[] =
        {[TIDES_REPEATS_ONCE] = 1, [TIDES_REPEATS_PAIRS] = TIDES_PAIRS, [TIDES_REPEATS_BINS] = TIDES_FANO_BINS};
    const double nothing = NAN;
    size_t count;
    const tides_metric *table = tides_metrics_table(&count);
    *m = (tides_metrics){.computed = wanted};
    for (const tides_metric *row = table; row < table + count; row++) {
        for (int i = 0; row->is_real && i < repeats[row->repeats]; i++) {
            const size_t at = row->offset + (size_t)i * row->stride;
            char *const both = (char *)m;
            if (row->of == TIDES_OF_BOTH) memcpy(both + at, &nothing, sizeof nothing);
            if (row->of == TIDES_OF_STREAM) memcpy((char *)&m->reference + at, &nothing, sizeof nothing);
            if (row->of == TIDES_OF_STREAM) memcpy((char *)&m->simulated + at, &nothing, sizeof nothing);
        }
    }
}

/* -- the parts ------------------------------------------------------------------------------------------------------ */

/* Matches exact times, which aren't rounded to a clock. It comes first, because it makes copies of the streams. */
static tides_status match(td_compare *c, const tides_event *reference, size_t reference_count, const tides_event *simulated,
                          size_t simulated_count) {
    if (!(c->options->wanted & TIDES_METRIC_MATCH)) return TIDES_OK;
    tides_status status = td_compare_report(c, 0.0, "matching");
    if (status == TIDES_OK) status = td_stream_make(reference, reference_count, c, 0, 0, &c->reference);
    if (status == TIDES_OK) status = td_stream_make(simulated, simulated_count, c, 0, 0, &c->simulated);
    if (status == TIDES_OK)
        status = tides_match_events(c->reference.events, c->reference.count, c->simulated.events, c->simulated.count,
                                    c->options->match_limit_s, &c->metrics->match, c->error);
    const tides_match *m = &c->metrics->match;
    const double events = (double)m->reference + (double)m->simulated;
    if (status == TIDES_OK && events > 0) c->metrics->matched_share = 2 * (double)m->matched / events;
    td_stream_release(&c->reference);
    td_stream_release(&c->simulated);
    return status;
}

static tides_status compute(td_compare *c, const tides_event *reference, size_t reference_count, const tides_event *simulated,
                            size_t simulated_count) {
    int with_trains = 0;
    for (const td_metric_part *part = td_metric_parts; part->compute; part++)
        with_trains |= part->by_pixel && (c->options->wanted & part->wanted);
    const int64_t tick = c->options->tick_ns;
    tides_status status = td_stream_make(reference, reference_count, c, tick, with_trains, &c->reference);
    if (status == TIDES_OK) status = td_stream_make(simulated, simulated_count, c, tick, with_trains, &c->simulated);
    c->metrics->reference.events = c->reference.count;
    c->metrics->simulated.events = c->simulated.count;
    for (const td_metric_part *part = td_metric_parts; part->compute && status == TIDES_OK; part++) {
        if (!(c->options->wanted & part->wanted)) continue;
        status = td_compare_report(c, 0.0, part->stage);
        if (status == TIDES_OK) status = part->compute(c);
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
