/* Event-stream metrics: closed forms on streams made by hand. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/metrics.h"

#include "tests/support/event_stream.h"
#include "tests/support/metrics_of.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MS 1000000 /* [ns] */

static tides_metrics_options options_for(uint32_t wanted, int width, int height, int64_t stop_ns) {
    tides_metrics_options o;
    tides_metrics_options_defaults(&o);
    o.wanted = wanted;
    o.width = width;
    o.height = height;
    o.stop_ns = stop_ns;
    return o;
}

static void assert_near(const char *what, double got, double expected) {
    if (!(fabs(got - expected) <= 1e-12 * fmax(1.0, fabs(expected))))
        fail_msg("%s: got %.17g, expected %.17g", what, got, expected);
}

/* Events of one pixel and polarity. */
static size_t train(const double *times_ms, size_t count, int x, tides_event *events) {
    for (size_t i = 0; i < count; i++) events[i] = event_at(llround(times_ms[i] * MS), x, 0, 1);
    return count;
}

/* ---- intervals ---- */

/* Intervals of 1 and 3 ms against 2 and 6: both fits' every number by hand, and the divergence of two that differ by scale. */
static void inverse_gaussians_of_two_intervals(void **state) {
    (void)state;
    tides_event a[3], b[3];
    train((const double[]){0, 1, 4}, 3, 0, a);
    train((const double[]){0, 6, 8}, 3, 0, b);
    const tides_metrics_options o = options_for(TIDES_METRIC_ISI, 4, 1, 20 * MS);
    const tides_metrics m = metrics_of(a, 3, b, 3, &o);
    const tides_interval_fit fit = m.reference.intervals[TIDES_PAIRS_ANY];
    assert_int_equal(fit.count, 2);
    assert_near("mean", fit.mean_s, 2e-3);
    assert_near("1 / shape", 1e-3 / fit.shape_s, 1e-3 * (2000.0 / 3.0 - 500.0));
    assert_near("scaled shape", m.simulated.intervals[TIDES_PAIRS_ANY].shape_s / fit.shape_s, 2.0);
    const double log_shape = log(6e-3), mean_log = 0.5 * (log(1e-3) + log(3e-3));
    assert_near("self", m.ig_nll_self[0], 0.5 * (log(2.0 * 3.14159265358979323846) + 3.0 * mean_log - log_shape) + 0.5);
    assert_near("excess", m.ig_nll_excess[0], 0.5 * (1.0 - log(2.0)) + 6.0 / (4.0 * 2.0));
    assert_near("raw", m.ig_nll[0] - m.ig_nll_self[0], m.ig_nll_excess[0]);
    assert_near("w1", m.isi_w1, log10(2.0));
}

/* + - + + at 0, 1, 3, 4: any 1 2 1; same 1; split (0, 3), (3, 4). */
static void pairs_of_each_kind(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, 1), event_at(MS, 0, 0, -1), event_at(3 * MS, 0, 0, 1), event_at(4 * MS, 0, 0, 1)};
    const tides_metrics_options o = options_for(TIDES_METRIC_ISI, 1, 1, 10 * MS);
    const tides_stream_metrics s = metrics_of(a, 4, a, 4, &o).reference;
    assert_int_equal(s.intervals[TIDES_PAIRS_ANY].count, 3);
    assert_int_equal(s.intervals[TIDES_PAIRS_SAME].count, 1);
    assert_int_equal(s.intervals[TIDES_PAIRS_SPLIT].count, 2);
    assert_near("any", s.intervals[TIDES_PAIRS_ANY].mean_s, 4e-3 / 3);
    assert_near("same", s.intervals[TIDES_PAIRS_SAME].mean_s, 1e-3);
    assert_near("split", s.intervals[TIDES_PAIRS_SPLIT].mean_s, 2e-3);
}

/* A regular train's shape is held at 1e6 means; a simultaneous pair counts as the floor. */
static void floors(void **state) {
    (void)state;
    tides_event a[4], b[] = {event_at(5, 0, 0, 1), event_at(5, 0, 0, 1)};
    train((const double[]){0, 2, 4, 6}, 4, 0, a);
    const tides_metrics_options o = options_for(TIDES_METRIC_ISI, 1, 1, 10 * MS);
    const tides_metrics m = metrics_of(a, 4, b, 2, &o);
    assert_near("shape", m.reference.intervals[0].shape_s, 2e3);
    assert_int_equal(m.simulated.intervals[0].floored, 1);
    assert_near("floor", 1e6 * m.simulated.intervals[0].mean_s, 0.5);
    assert_true(isnan(m.ig_nll[0]));
    assert_true(isnan(m.ig_nll_excess[0])); /* one interval is no distribution */
    assert_false(isnan(m.ig_nll_self[0]));
    assert_near("near zero", m.simulated.isi_spike, 1.0);
}

/* 40 intervals of 4 ms and 60 of all lengths: the 40 stand out. With a clock of 2 ms they count as well, with one of 3.1 they
 * don't. */
static void spikes_on_a_clock(void **state) {
    (void)state;
    tides_event a[101];
    int64_t time = 0;
    for (int i = 0; i <= 100; i++) {
        a[i] = event_at(time, 0, 0, 1);
        time += i < 40 ? 4 * MS : 5500000 + 130000 * i + 1000 * (i % 7);
    }
    tides_metrics_options o = options_for(TIDES_METRIC_ISI, 1, 1, 0);
    assert_near("found", metrics_of(a, 101, a, 101, &o).simulated.isi_spike, 0.4);
    o.clock_s = 2e-3;
    const double known = metrics_of(a, 101, a, 101, &o).simulated.isi_spike;
    assert_true(known >= 0.4);
    assert_true(known < 0.5);
    o.clock_s = 3.1e-3;
    assert_true(metrics_of(a, 101, a, 101, &o).simulated.isi_spike < 0.1);
}

/* ---- simultaneous events, bursts, counts ---- */

/* At one time two events in one tile and one in another; and one alone. */
static void same_time_in_sensor_and_tile(void **state) {
    (void)state;
    tides_event a[] = {event_at(1400, 3, 0, 1), event_at(1500, 15, 0, 1), event_at(1999, 16, 0, 1), event_at(2000, 3, 0, 1)};
    const tides_metrics_options o = options_for(TIDES_METRIC_SAME_TIME, 32, 1, MS);
    tides_metrics_options unclocked = o;
    unclocked.tick_ns = 0;
    assert_near("sensor", metrics_of(a, 4, a, 0, &o).reference.same_time, 0.75);
    assert_near("tile", metrics_of(a, 4, a, 0, &o).reference.same_time_tile, 0.5);
    assert_near("without a clock", metrics_of(a, 4, a, 0, &unclocked).reference.same_time, 0.0);
}

/* 20 bins with one event each have F = 0; with 0 and 2 in turn F = 20 / 19. */
static void fano_factors(void **state) {
    (void)state;
    tides_event a[20], b[20];
    for (int i = 0; i < 20; i++) {
        a[i] = event_at(i * MS + 500, i % 16, 0, 1);
        b[i] = event_at((i / 2 * 2 + 1) * MS + i, 3, 0, 1);
    }
    const tides_metrics_options o = options_for(TIDES_METRIC_FANO, 32, 1, 20 * MS);
    const tides_metrics m = metrics_of(a, 20, b, 20, &o);
    assert_near("reference", m.reference.fano[0], 0.0);
    assert_near("simulated", m.simulated.fano[0], 20.0 / 19.0);
    assert_near("error", m.fano_error[0], log((20.0 / 19.0 + 1e-3) / 1e-3));
    assert_int_equal(m.fano_tiles[0], 1);
    assert_near("coverage", m.fano_coverage[0], 1.0);
    assert_near("few", metrics_of(a, 20, b, 19, &o).fano_coverage[0], 0.0);
}

static void counts(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, 1), event_at(1, 0, 0, 1), event_at(2, 1, 0, -1)};
    tides_event b[] = {event_at(0, 0, 0, 1), event_at(1, 1, 0, -1), event_at(1, 1, 0, -1), event_at(2, 1, 0, -1)};
    tides_metrics_options o = options_for(TIDES_METRIC_COUNTS, 2, 1, MS);
    const tides_metrics m = metrics_of(a, 3, b, 4, &o);
    assert_near("ratio", m.count_ratio, 4.0 / 3.0);
    assert_near("on", m.reference.on_fraction, 2.0 / 3.0);
    assert_near("on", m.simulated.on_fraction, 0.25);
    assert_near("correlation", m.count_correlation, -1.0);
    assert_near("ratio of ON", m.count_ratio_on, 0.5);
    assert_near("ratio of OFF", m.count_ratio_off, 3.0);
    o.width = 1; /* the same everywhere: there is one pixel */
    assert_true(isnan(metrics_of(a, 2, a, 2, &o).count_correlation));
}

/* Events in another bin are one too few there and one too many here; bins and tiles that neither stream has tell nothing. */
static void rates_and_regions(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, 1), event_at(MS, 0, 0, 1), event_at(9 * MS, 40, 0, 1),
                       event_at(9 * MS + 1, 40, 0, -1)};
    tides_event b[] = {event_at(500, 15, 0, 1), event_at(2 * MS, 16, 0, 1), event_at(9 * MS, 40, 0, 1)};
    const tides_metrics_options o = options_for(TIDES_METRIC_COUNTS, 64, 1, 10 * MS);
    const tides_metrics m = metrics_of(a, 4, b, 3, &o);
    assert_near("1 ms", m.rate_error[0], 3.0 / 4.0);
    assert_near("5 ms", m.rate_error[2], 1.0 / 4.0);
    assert_near("regions", m.region_error, 3.0 / 4.0);
    assert_near("itself", metrics_of(a, 4, a, 4, &o).rate_error[1], 0.0);
    assert_true(isnan(metrics_of(a, 0, b, 3, &o).rate_error[0]) && isnan(metrics_of(a, 0, b, 3, &o).region_error));
}

/* Tenfold intervals after OFF, equal ones after ON. */
static void intervals_after_each_polarity(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, -1), event_at(MS, 0, 0, 1), event_at(2 * MS, 0, 0, 1)};
    tides_event b[] = {event_at(0, 0, 0, -1), event_at(10 * MS, 0, 0, 1), event_at(11 * MS, 0, 0, 1)};
    const tides_metrics_options o = options_for(TIDES_METRIC_ISI, 1, 1, 20 * MS);
    const tides_metrics m = metrics_of(a, 3, b, 3, &o);
    assert_near("after OFF", m.isi_w1_after[0], 1.0);
    assert_near("after ON", m.isi_w1_after[1], 0.0);
    assert_true(isnan(metrics_of(a, 1, b, 3, &o).isi_w1_after[1]));
}

/* A burst of all pixels at 100 ms among a steady rate, a hot pixel beside one that is merely busy, and a thin line whose
 * pixels are all as busy as one another. */
static void blemishes_of_a_recording(void **state) {
    enum { EVENTS = 40000, W = 40, H = 30 };
    (void)state;
    tides_event *e = calloc(EVENTS, sizeof *e);
    tides_blemishes b;
    tides_error error = {0, ""};
    size_t n = 0, burst = 0, hot = 0;
    assert_non_null(e);
    for (int64_t t = 0; t < 200 * MS; t += 10000) { /* every 10 us */
        const int64_t k = t / 10000;
        e[n++] = k % 5 == 0 ? event_at(t, 20, 15, 1)
                            : event_at(t, (int)(k * 37 % (W * H) % W), (int)(k * 37 % (W * H) / W), k % 2 ? 1 : -1);
        if (k % 10 == 3) e[n++] = event_at(t, 5 + (int)(k / 10 % H), (int)(k / 10 % H), 1);
        for (int i = 0; t >= 100 * MS && t < 101 * MS && i < 20; i++) e[n++] = event_at(t, i * 2, (int)(k % H), i % 2 ? 1 : -1);
    }
    assert_int_equal(tides_blemishes_find(e, n, W, H, &b, &error), TIDES_OK);
    assert_int_equal(b.bursts, 1);
    assert_true(b.burst[0] <= 100 * MS && b.burst[0] > 98 * MS && b.burst[1] >= 101 * MS && b.burst[1] < 103 * MS);
    assert_int_equal(b.hots, 1);
    assert_true(b.hot[0] == 20 && b.hot[1] == 15);
    for (size_t i = 0; i < n; i++) {
        const int inside = e[i].t >= b.burst[0] && e[i].t < b.burst[1];
        burst += (size_t)inside;
        hot += !inside && e[i].x == 20 && e[i].y == 15;
    }
    assert_int_equal(b.burst_events, burst);
    assert_int_equal(b.hot_events, hot);
    assert_int_equal(tides_blemishes_leave_out(&b, e, n), n - burst - hot);
    tides_blemishes_free(&b);
    assert_null(b.burst);
    tides_blemishes_free(NULL);
    assert_int_equal(tides_blemishes_find(e, 0, W, H, &b, &error), TIDES_OK);
    assert_int_equal(b.bursts + b.hots, 0);
    tides_blemishes_free(&b);
    e[0].t = 5, e[1].t = 4;
    assert_int_equal(tides_blemishes_find(e, 2, W, H, &b, &error), TIDES_BAD_ARGUMENT);
    e[1] = event_at(6, W, 0, 1);
    assert_int_equal(tides_blemishes_find(e, 2, W, H, &b, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_blemishes_find(e, 0, 0, H, &b, &error), TIDES_BAD_ARGUMENT);
    e[0].t = 0, e[1] = event_at(INT64_C(30000000000000), 0, 0, 1);
    assert_int_equal(tides_blemishes_find(e, 2, W, H, &b, &error), TIDES_UNSUPPORTED);
    free(e);
}

/* ---- space and time ---- */

/* Lone events far apart: a delay of 2 ms at 1000 px/s is 2 px, a shift is a shift, and both together their hypotenuse. */
static void chamfer_of_delay_and_shift(void **state) {
    (void)state;
    tides_event a[6], late[6], beside[6], both[6];
    for (int i = 0; i < 6; i++) {
        a[i] = event_at(30 * MS * i + 10 * MS, 20 * (i % 3) + 5, 7, i % 2 ? 1 : -1);
        late[i] = event_at(a[i].t + 2 * MS, a[i].x, a[i].y, a[i].polarity);
        beside[i] = event_at(a[i].t, a[i].x, a[i].y + 1, a[i].polarity);
        both[i] = event_at(a[i].t + 3 * MS, a[i].x + 4, a[i].y, a[i].polarity);
    }
    tides_metrics_options o = options_for(TIDES_METRIC_CHAMFER, 60, 20, 200 * MS);
    o.speed_px_per_s = 1000;
    const tides_metrics m = metrics_of(a, 6, late, 6, &o);
    assert_near("delay", m.chamfer_px, 2.0);
    assert_near("fraction", m.chamfer_fraction, 2.0 / hypot(60, 20));
    assert_near("limit", m.chamfer_limit_px, 50.0);
    assert_int_equal(m.chamfer_one_sided, 0);
    assert_near("shift", metrics_of(a, 6, beside, 6, &o).chamfer_px, 1.0);
    assert_near("both", metrics_of(a, 6, both, 6, &o).chamfer_px, 5.0);
}

static void chamfer_of_one_side_and_of_duplicates(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, 1), event_at(0, 9, 0, 1)}, b[] = {event_at(0, 0, 0, -1)};
    tides_event twice[] = {event_at(0, 0, 0, 1), event_at(0, 0, 0, 1), event_at(0, 9, 0, 1), event_at(0, 9, 0, 1)};
    tides_metrics_options o = options_for(TIDES_METRIC_CHAMFER, 30, 40, 50 * MS);
    o.speed_px_per_s = 10000;
    tides_metrics m = metrics_of(a, 2, b, 1, &o);
    assert_near("limit", m.chamfer_limit_px, 50.0); /* the diagonal, not 500 px */
    assert_near("one side", m.chamfer_px, 50.0);
    assert_int_equal(m.chamfer_terms, 2);
    assert_int_equal(m.chamfer_one_sided, 2);
    m = metrics_of(a, 2, twice, 4, &o);
    assert_near("twice", m.chamfer_px, 0.0);
}

/* An edge that crosses a pixel per millisecond: 1000 px/s, and the found speed is used. */
static void speed_of_an_edge(void **state) {
    (void)state;
    tides_event a[40 * 4];
    for (int x = 0; x < 40; x++)
        for (int y = 0; y < 4; y++) a[4 * x + y] = event_at(x * MS, x, y, 1);
    const tides_metrics_options o = options_for(TIDES_METRIC_CHAMFER, 40, 4, 50 * MS);
    const tides_metrics m = metrics_of(a, 160, a, 160, &o);
    assert_near("speed", m.speed_px_per_s, 1000.0);
    assert_near("distance", m.chamfer_px, 0.0);
    assert_true(isnan(metrics_of(a, 1, a, 1, &o).speed_px_per_s)); /* nothing moves */
    assert_true(isnan(metrics_of(a, 1, a, 1, &o).chamfer_px));
}

/* ---- spike trains ---- */

static void trains_of_one_event(void **state) {
    (void)state;
    const uint32_t wanted = TIDES_METRIC_VICTOR_PURPURA | TIDES_METRIC_VAN_ROSSUM | TIDES_METRIC_TIME_DIFFERENCE;
    tides_event a[] = {event_at(10 * MS, 0, 0, 1)}, near[] = {event_at(15 * MS, 0, 0, 1)}, far[] = {event_at(40 * MS, 0, 0, 1)};
    const tides_metrics_options o = options_for(wanted, 1, 1, 100 * MS);
    tides_metrics m = metrics_of(a, 1, near, 1, &o);
    assert_near("shifted", m.victor_purpura, 0.5); /* 100 /s over 5 ms */
    assert_near("filtered", m.van_rossum, 2.0 - 2.0 * exp(-0.5));
    assert_near("norm", m.reference.van_rossum_norm, 1.0);
    assert_near("difference", m.time_difference_us, 5000.0);
    m = metrics_of(a, 1, far, 1, &o);
    assert_near("removed and added", m.victor_purpura, 2.0);
    assert_near("fraction", m.victor_purpura_fraction, 1.0);
    assert_near("capped", m.time_difference_us, 10000.0);
    assert_int_equal(m.time_difference_over, 1);
    m = metrics_of(a, 1, NULL, 0, &o);
    assert_near("against nothing", m.victor_purpura, 1.0);
    assert_near("against nothing", m.van_rossum, 1.0);
    assert_near("against nothing", m.van_rossum_fraction, 1.0);
    assert_near("against nothing", m.time_difference_us, 10000.0);
}

/* An event too many in the middle costs one; pixels and polarities are apart. */
static void trains_with_one_event_more(void **state) {
    (void)state;
    tides_event a[3], b[4], other[] = {event_at(MS, 1, 0, 1), event_at(2 * MS, 0, 0, -1)};
    train((const double[]){1, 2, 3}, 3, 0, a);
    train((const double[]){1, 1.5, 2, 3}, 4, 0, b);
    const tides_metrics_options o = options_for(TIDES_METRIC_VICTOR_PURPURA, 2, 1, 100 * MS);
    assert_near("one more", metrics_of(a, 3, b, 4, &o).victor_purpura, 1.0);
    assert_near("one less", metrics_of(b, 4, a, 3, &o).victor_purpura, 1.0);
    assert_near("apart", metrics_of(a, 3, other, 2, &o).victor_purpura, 5.0);
}

static void kernel_of_single_events(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, 1)}, other[] = {event_at(0, 0, 0, -1)}, away[] = {event_at(5 * MS, 2, 0, 1)};
    const tides_metrics_options o = options_for(TIDES_METRIC_KERNEL, 4, 4, 100 * MS);
    assert_near("alone", metrics_of(a, 1, NULL, 0, &o).kernel_distance, 1.0);
    assert_near("opposite", metrics_of(a, 1, other, 1, &o).kernel_distance, 4.0);
    assert_near("a deviation off in space and in time", metrics_of(a, 1, away, 1, &o).kernel_distance, 2.0 - 2.0 * exp(-1.0));
}

/* Exact times are matched without the clock, in the region and interval only. */
static void matched_within_the_region(void **state) {
    (void)state;
    tides_event a[] = {event_at(1100, 2, 2, 1), event_at(5000, 0, 0, 1), event_at(9 * MS, 2, 2, 1)};
    tides_event b[] = {event_at(1900, 2, 2, 1), event_at(9 * MS, 2, 2, -1)};
    tides_metrics_options o = options_for(TIDES_METRIC_MATCH, 4, 4, MS);
    memcpy(o.roi, (const int32_t[4]){1, 1, 3, 3}, sizeof o.roi);
    const tides_metrics m = metrics_of(a, 3, b, 2, &o);
    assert_int_equal(m.match.reference, 1);
    assert_int_equal(m.match.matched, 1);
    assert_near("dt", m.match.dt_median_us, 0.8);
    assert_near("mismatch", m.match.mismatch_percent, 0.0);
    assert_int_equal(m.reference.events, 1);
    assert_int_equal(m.width, 3);
}

/* Every byte of what is compared belongs to one value of the table, but for the streams' sizes, which a report has anyway: what
 * isn't computed is NaN by it, and the tool's report is made of it. */
static void test_table(void **state) {
    (void)state;
    static const int repeats[] = {1, TIDES_PAIRS, TIDES_FANO_BINS};
    unsigned char both[sizeof(tides_metrics)] = {0}, stream[sizeof(tides_stream_metrics)] = {0};
    size_t count;
    const tides_metric *table = tides_metrics_table(&count);
    for (const tides_metric *row = table; row < table + count; row++) {
        for (const tides_metric *other = table; other < row; other++) assert_string_not_equal(row->name, other->name);
        for (int i = 0; i < repeats[row->repeats]; i++)
            for (size_t k = 0; k < 8; k++)
                (row->of == TIDES_OF_BOTH ? both : stream)[row->offset + (size_t)i * row->stride + k]++;
    }
    const size_t sizes = offsetof(tides_metrics, match.reference);
    for (size_t k = offsetof(tides_metrics, count_ratio); k < sizeof both; k++)
        assert_int_equal(both[k], k < sizes || k >= sizes + 2 * sizeof(uint64_t));
    for (size_t k = offsetof(tides_stream_metrics, on_fraction); k < sizeof stream; k++) assert_int_equal(stream[k], 1);
    tides_metrics_options options;
    tides_metrics made;
    tides_error error;
    tides_metrics_options_defaults(&options);
    options.wanted = 0;
    assert_int_equal(tides_metrics_compare(NULL, 0, NULL, 0, &options, NULL, NULL, &made, &error), TIDES_OK);
    for (const tides_metric *row = table; row < table + count; row++) {
        double value;
        memcpy(&value,
               (const char *)(row->of == TIDES_OF_BOTH ? (const void *)&made : (const void *)&made.simulated) + row->offset,
               sizeof value);
        assert_int_equal(isnan(value) != 0, row->is_real);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(inverse_gaussians_of_two_intervals),
        cmocka_unit_test(pairs_of_each_kind),
        cmocka_unit_test(floors),
        cmocka_unit_test(spikes_on_a_clock),
        cmocka_unit_test(same_time_in_sensor_and_tile),
        cmocka_unit_test(fano_factors),
        cmocka_unit_test(counts),
        cmocka_unit_test(rates_and_regions),
        cmocka_unit_test(intervals_after_each_polarity),
        cmocka_unit_test(blemishes_of_a_recording),
        cmocka_unit_test(chamfer_of_delay_and_shift),
        cmocka_unit_test(chamfer_of_one_side_and_of_duplicates),
        cmocka_unit_test(speed_of_an_edge),
        cmocka_unit_test(trains_of_one_event),
        cmocka_unit_test(trains_with_one_event_more),
        cmocka_unit_test(kernel_of_single_events),
        cmocka_unit_test(matched_within_the_region),
    };
    return cmocka_run_group_tests_name("metrics", tests, NULL, NULL);
}
