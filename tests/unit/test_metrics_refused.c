/* Event-stream metrics with few events or none, and refusals. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/metrics.h"

#include "tests/support/event_stream.h"
#include "tests/support/metrics_of.h"

#include <math.h>
#include <string.h>

static tides_metrics_options everything(void) {
    tides_metrics_options o;
    tides_metrics_options_defaults(&o);
    o.wanted = TIDES_METRICS_ALL;
    return o;
}

/* ---- little or nothing ---- */

static void nothing_against_nothing(void **state) {
    (void)state;
    tides_metrics_options o = everything();
    for (int sized = 0; sized < 2; sized++) {
        o.width = o.height = sized ? 8 : 0;
        const tides_metrics m = metrics_of(NULL, 0, NULL, 0, &o);
        const double undefined[] = {m.count_ratio,
                                    m.count_correlation,
                                    m.ig_nll[0],
                                    m.ig_nll_self[0],
                                    m.ig_nll_excess[0],
                                    m.isi_w1,
                                    m.fano_error[0],
                                    m.chamfer_px,
                                    m.speed_px_per_s,
                                    m.victor_purpura_fraction,
                                    m.van_rossum_fraction,
                                    m.time_difference_us,
                                    m.match.dt_median_us,
                                    m.reference.on_fraction,
                                    m.reference.same_time,
                                    m.reference.same_time_tile,
                                    m.reference.isi_spike,
                                    m.reference.fano[2],
                                    m.reference.intervals[1].mean_s};
        for (size_t i = 0; i < sizeof undefined / sizeof undefined[0]; i++)
            if (!isnan(undefined[i])) fail_msg("value %zu is %g", i, undefined[i]);
        assert_true(m.victor_purpura == 0);
        assert_true(m.van_rossum == 0);
        assert_true(m.kernel_distance == 0);
        assert_true(m.match.mismatch_percent == 0);
    }
}

static void one_side_empty(void **state) {
    (void)state;
    tides_event a[] = {event_at(1000, 0, 0, 1), event_at(5000000, 1, 0, 1), event_at(9000000, 0, 0, -1)};
    const tides_metrics_options o = everything();
    tides_metrics m = metrics_of(a, 3, NULL, 0, &o);
    assert_true(m.count_ratio == 0);
    assert_true(m.chamfer_px == m.chamfer_limit_px);
    assert_true(m.victor_purpura == 3);
    assert_true(isnan(m.ig_nll[0]));
    assert_true(!isnan(m.ig_nll_self[0]));
    assert_true(isnan(m.simulated.same_time));
    assert_true(m.match.missing == 3);
    assert_true(m.time_difference_over == 3);
    m = metrics_of(NULL, 0, a, 3, &o);
    assert_true(isnan(m.count_ratio));
    assert_true(isnan(m.ig_nll_self[0]));
    assert_true(isnan(m.time_difference_us));
    assert_true(m.victor_purpura == 3);
    assert_true(isinf(m.match.mismatch_percent));
}

static void one_event_per_pixel(void **state) {
    (void)state;
    tides_event a[4];
    for (int i = 0; i < 4; i++) a[i] = event_at(1000000 * i, i, 0, 1);
    const tides_metrics_options o = everything();
    const tides_metrics m = metrics_of(a, 4, a, 4, &o);
    assert_true(m.reference.intervals[0].count == 0);
    assert_true(isnan(m.reference.intervals[0].mean_s));
    assert_true(isnan(m.isi_w1));
    assert_true(isnan(m.reference.isi_spike));
    assert_true(isnan(m.ig_nll_self[0]));
    assert_true(m.chamfer_px == 0);
    assert_true(m.victor_purpura == 0);
    assert_true(m.speed_px_per_s == 1000);
}

static void one_time_for_all(void **state) {
    (void)state;
    tides_event a[12];
    for (int i = 0; i < 12; i++) a[i] = event_at(500000, i % 4, 0, 1);
    const tides_metrics_options o = everything();
    const tides_metrics m = metrics_of(a, 12, a, 12, &o);
    assert_true(m.reference.same_time == 1);
    assert_true(m.reference.isi_spike == 1);
    assert_true(m.reference.intervals[0].floored == 8);
    assert_true(m.isi_w1 == 0);
    assert_true(m.victor_purpura == 0);
    assert_true(m.van_rossum == 0);
    assert_true(m.ig_nll_excess[0] == 0);
    assert_true(m.stop_ns - m.start_ns == 1000);
    assert_true(isnan(m.fano_error[0]));
}

/* What isn't wanted isn't computed. */
static void only_what_is_wanted(void **state) {
    (void)state;
    tides_event a[] = {event_at(0, 0, 0, 1), event_at(1000000, 0, 0, -1)};
    for (uint32_t wanted = 1; wanted < TIDES_METRICS_ALL; wanted *= 2) {
        tides_metrics_options o = everything();
        o.wanted = wanted;
        o.speed_px_per_s = 100;
        const tides_metrics m = metrics_of(a, 2, a, 2, &o);
        const struct {
            uint32_t wanted;
            double value;
        } first[] = {{TIDES_METRIC_COUNTS, m.count_ratio},
                     {TIDES_METRIC_ISI, m.ig_nll_self[0]},
                     {TIDES_METRIC_SAME_TIME, m.simulated.same_time},
                     {TIDES_METRIC_CHAMFER, m.chamfer_px},
                     {TIDES_METRIC_VICTOR_PURPURA, m.victor_purpura},
                     {TIDES_METRIC_VAN_ROSSUM, m.van_rossum},
                     {TIDES_METRIC_TIME_DIFFERENCE, m.time_difference_us},
                     {TIDES_METRIC_KERNEL, m.kernel_distance},
                     {TIDES_METRIC_MATCH, m.match.dt_median_us}};
        assert_int_equal(m.computed, wanted);
        for (size_t i = 0; i < sizeof first / sizeof first[0]; i++)
            assert_int_equal(isnan(first[i].value), first[i].wanted != wanted);
    }
}

/* ---- refused ---- */

static void refuse(const tides_event *a, size_t count_a, const tides_event *b, size_t count_b,
                   const tides_metrics_options *options, const char *text) {
    tides_metrics m, before;
    tides_error error = {TIDES_OK, ""};
    memset(&m, 0x5a, sizeof m);
    memcpy(&before, &m, sizeof m);
    const tides_status status = tides_metrics_compare(a, count_a, b, count_b, options, NULL, NULL, &m, &error);
    assert_int_equal(status, error.status);
    if (status == TIDES_OK || !strstr(error.text, text) || strchr(error.text, '\n'))
        fail_msg("%s (%s), expected: %s", tides_status_name(status), error.text, text);
    assert_memory_equal(&m, &before, sizeof m);
}

static void streams_that_are_none(void **state) {
    (void)state;
    tides_event unsorted[] = {event_at(5, 0, 0, 1), event_at(7, 0, 0, 1), event_at(6, 0, 0, 1)};
    tides_event flat[] = {event_at(5, 0, 0, 0)}, late[] = {event_at(INT64_MAX, 0, 0, 1)},
                early[] = {event_at(INT64_MIN, 0, 0, 1)};
    tides_event outside[] = {event_at(5, 0, 0, 1), event_at(5, 3, 4, 1)}, huge[] = {event_at(5, 65535, 65535, 1)};
    tides_metrics_options o = everything();
    refuse(unsorted, 3, unsorted, 2, &o, "event 2 of the reference stream is at 6 ns, before the one ahead of it at 7 ns");
    refuse(unsorted, 2, unsorted, 3, &o, "event 2 of the simulated stream");
    refuse(flat, 1, NULL, 0, &o, "polarity 0");
    refuse(late, 1, NULL, 0, &o, "73 years");
    refuse(NULL, 0, early, 1, &o, "73 years");
    refuse(huge, 1, NULL, 0, &o, "65536x65536 px");
    refuse(NULL, 1, NULL, 0, &o, "must be given");
    o.width = o.height = 4;
    refuse(NULL, 0, outside, 2, &o, "event 1 of the simulated stream is at (3, 4), outside the sensor of 4x4 px");
}

static void options_that_are_none(void **state) {
    (void)state;
    const struct {
        size_t offset;
        double value;
        const char *name;
    } wrong[] = {{offsetof(tides_metrics_options, isi_floor_s), 0, "isi_floor_s"},
                 {offsetof(tides_metrics_options, clock_s), -1, "clock_s"},
                 {offsetof(tides_metrics_options, fano_bin_s), 1e-10, "fano_bin_s[0]"},
                 {offsetof(tides_metrics_options, fano_epsilon), 0, "fano_epsilon"},
                 {offsetof(tides_metrics_options, speed_px_per_s), INFINITY, "speed_px_per_s"},
                 {offsetof(tides_metrics_options, window_s), NAN, "window_s"},
                 {offsetof(tides_metrics_options, cell_px), 0, "cell_px"},
                 {offsetof(tides_metrics_options, victor_purpura_per_s), 0, "victor_purpura_per_s"},
                 {offsetof(tides_metrics_options, van_rossum_s), NAN, "van_rossum_s"},
                 {offsetof(tides_metrics_options, kernel_px), 0, "kernel_px"},
                 {offsetof(tides_metrics_options, match_limit_s), 0, "limit_s"}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        tides_metrics_options o = everything();
        memcpy((char *)&o + wrong[i].offset, &wrong[i].value, sizeof wrong[i].value);
        refuse(NULL, 0, NULL, 0, &o, wrong[i].name);
    }
    tides_metrics_options o = everything();
    o.size = 4;
    refuse(NULL, 0, NULL, 0, &o, "_defaults");
    o = everything();
    o.wanted = 1024;
    refuse(NULL, 0, NULL, 0, &o, "wanted");
    o = everything();
    o.width = 5;
    refuse(NULL, 0, NULL, 0, &o, "5x0 px");
    o.height = 5;
    o.roi[2] = 2;
    refuse(NULL, 0, NULL, 0, &o, "x,y,width,height");
    o.roi[3] = 6;
    refuse(NULL, 0, NULL, 0, &o, "reaches outside the sensor of 5x5 px");
    o = everything();
    o.start_ns = 5;
    refuse(NULL, 0, NULL, 0, &o, "interval");
    o = everything();
    o.tick_ns = -1;
    refuse(NULL, 0, NULL, 0, &o, "tick_ns");
}

static int stop_in(void *stage, double fraction, const char *name) {
    assert_true(fraction >= 0);
    assert_true(fraction <= 1);
    return strcmp(stage, name) == 0;
}

static void cancelled(void **state) {
    (void)state;
    static const char *const stages[] = {"matching",  "counts",       "Same-ts",         "Fano factors",
                                         "intervals", "spike trains", "kernel distance", "Chamfer"};
    tides_event a[] = {event_at(5, 0, 0, 1), event_at(5000000, 1, 0, 1)};
    const tides_metrics_options o = everything();
    for (size_t i = 0; i < sizeof stages / sizeof stages[0]; i++) {
        char stage[32];
        tides_metrics m;
        tides_error error;
        strcpy(stage, stages[i]);
        assert_int_equal(tides_metrics_compare(a, 2, a, 2, &o, stop_in, stage, &m, &error), TIDES_CANCELLED);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_against_nothing), cmocka_unit_test(one_side_empty),
        cmocka_unit_test(one_event_per_pixel),     cmocka_unit_test(one_time_for_all),
        cmocka_unit_test(only_what_is_wanted),     cmocka_unit_test(streams_that_are_none),
        cmocka_unit_test(options_that_are_none),   cmocka_unit_test(cancelled),
    };
    return cmocka_run_group_tests_name("metrics refused", tests, NULL, NULL);
}
