/* Estimated errors of event times: of one crossing against closed forms, and their histogram. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_render.h"
#include "sensor/td_between.h"
#include "solver/td_probe.h"
#include "solver/td_timing.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <string.h>

static const uint64_t SEED = 31415;
static const double H = 0.01; /* [s] */

/* -- one crossing ---------------------------------------------------------------------------------------------------- */

static void test_straight(void **state) {
    (void)state;
    uint64_t seed = SEED;
    for (int trial = 0; trial < 100; trial++) {
        double v = scene_between(&seed, 0.1, 2), error = scene_between(&seed, 0, 0.3);
        int touches;
        double reach = td_timing_reach(v, 0, error, &touches);
        assert_true(fabs(reach - fmin(error / v, 1)) < 1e-9 && !touches);
    }
}

/* The farther of the two places where the parabola is `error` away: found here by looking. */
static void test_parabolas(void **state) {
    (void)state;
    uint64_t seed = SEED + 1;
    int touched = 0;
    for (int trial = 0; trial < 400; trial++) {
        double v = scene_between(&seed, 0, 1), a = scene_between(&seed, -3, 3), error = scene_between(&seed, 0, 0.02);
        int touches;
        double reach = td_timing_reach(v, a, error, &touches), turn = v / fabs(a);
        int can_undo = a < 0 && v * turn / 2 < error; /* it turns before it is `error` beyond the level */
        assert_int_equal(touches, can_undo && reach < 1);
        touched += touches;
        double most = 0;
        for (int i = 1; i <= 4000; i++) { /* the nearest place on either side that is as far off; of a touch the farthest */
            double d = i / 4000.0, after = v * d + a * d * d / 2, before = v * d - a * d * d / 2;
            if (fabs(after) < error) most = fmax(most, d);
            if (fabs(before) < error && !(a > 0 && v * turn / 2 > error && d > turn)) most = fmax(most, d);
            if (after >= error || before >= error || (touches && after <= -error)) {
                if (!touches) break;
                if (after <= -error) break;
            }
        }
        if (reach < 0.9 && !(reach >= most - 1e-3)) fail_msg("v %g, a %g, error %g: %g, found %g", v, a, error, reach, most);
        assert_true(reach <= 1 && reach >= fmin(error / (v + sqrt(v * v + 2 * fabs(a) * error)), 1));
    }
    assert_true(touched > 20);
}

/* At a touch the square root of the error counts, however small the slope. */
static void test_touch(void **state) {
    (void)state;
    int touches;
    assert_true(fabs(td_timing_reach(0, -2, 1e-4, &touches) - 1e-2) < 1e-9 && touches);
    /* One that leaves the level can't be undone. */
    assert_true(fabs(td_timing_reach(0, 2, 1e-4, &touches) - 1e-2) < 1e-9 && !touches);
    assert_true(td_timing_reach(0, 0, 1e-4, &touches) == 1);
}

/* -- many ------------------------------------------------------------------------------------------------------------ */

/* One pixel that rises by 1 in a step of H, which may be the run's last, where single precision makes an error of `error`. */
typedef struct rise {
    td_tile tile;
    td_step step;
    double S0, S1, rate;
    td_signals signals;
    tides_event event;
    td_timed timed;
} rise;

static rise *rising(td_timing *timing, rise *r, double error, int is_last) {
    *r = (rise){{0, 0, 1, 1}, {0, 10000000, 0, 1e7, H}, .S1 = 1, .rate = 1 / H, .event = {.t = 5000000, .polarity = 1}};
    r->signals = (td_signals){&r->S0, &r->rate, &r->S1, &r->rate};
    r->timed = (td_timed){.step = &r->step,
                          .tile = &r->tile,
                          .signals = &r->signals,
                          .events = &r->event,
                          .count = 1,
                          .adds = 1,
                          .is_last = is_last};
    timing->epsilon = error / 4; /* 2 (1 + |S|) of them; a straight line: the model's own estimate is 0 */
    return r;
}

/* Adds events of such a pixel. */
static void add(td_timing *timing, double error, size_t count) {
    rise r;
    rising(timing, &r, error, 0);
    for (size_t i = 0; i < count; i++) td_timing_add(timing, &r.timed);
}

/* A percentile is at or above the true one, by a quarter octave at most, and the nanosecond that times are floored to. */
static void expect_percentile(const td_timing *timing, double share, double want) {
    double got = td_timing_percentile(timing, share);
    if (!(got >= want * (1 - 1e-9) && got <= (want + 1e-9) * exp2(0.25) * (1 + 1e-9)))
        fail_msg("%g of the events: %g s, not %g s", share, got, want);
}

static void test_percentiles(void **state) {
    (void)state;
    td_timing timing;
    memset(&timing, 0, sizeof timing);
    assert_true(td_timing_percentile(&timing, 0.5) == 0);
    for (int i = 1; i <= 1000; i++) add(&timing, 1e-9 * i * i / H, 1); /* 1 ns to 1 ms */
    expect_percentile(&timing, 0.5, 250e-6);
    expect_percentile(&timing, 0.95, 902.5e-6);
    expect_percentile(&timing, 0.99, 980.1e-6);
    expect_percentile(&timing, 1, 1e-3);
}

/* Where all events are measured, percentiles are theirs. Where each stands for a hundred, in the mean, a share is raised by 2.5
 * standard errors of a sample of 768: 0.95 to 0.9696. */
static void test_measured(void **state) {
    (void)state;
    td_timing all = {.measured = 0}, sample = all, uneven = all;
    for (int i = 1; i <= 100; i++) td_timing_add_solved(&all, 1, 1e-6 * i / H, 1, 0, H);
    for (int i = 1; i <= TD_TIMING_SAMPLE; i++) td_timing_add_solved(&sample, 100, 1e-6 * i / H, 1, 0, H);
    for (int i = 1; i <= TD_TIMING_SAMPLE; i++) td_timing_add_solved(&uneven, i % 2 ? 1 : 199, 1e-6 * i / H, 1, 0, H);
    assert_true(td_timing_events(&all) == 100 && td_timing_events(&sample) == 76800);
    static const double shares[] = {0.25, 0.5, 0.95, 0.99, 1};
    for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) expect_percentile(&all, shares[k], 1e-4 * shares[k]);
    expect_percentile(&sample, 0.5, 419e-6);
    expect_percentile(&sample, 0.95, 745e-6);
    expect_percentile(&sample, 0.99, 767e-6);
    expect_percentile(&uneven, 0.95, 745e-6);
}

/* No error is above the step; none but rounding is the nanosecond. */
static void test_ends(void **state) {
    (void)state;
    td_timing timing;
    memset(&timing, 0, sizeof timing);
    add(&timing, 0, 10);
    expect_percentile(&timing, 0.99, 1e-9);
    add(&timing, 1e9, 90);
    expect_percentile(&timing, 0.99, H);
    add(&timing, NAN, 1); /* counted, and as late as can be */
    expect_percentile(&timing, 1, H);
}

/* -- events that might have been --------------------------------------------------------------------------------------- */

/* Parabolas that turn in the middle of the step, upwards or downwards, half of which have fired since: those count whose turn
 * is short of a level, of the reference that was there, by less than half of what a probe saw. Few of many are so near. */
static void test_turns(void **state) {
    (void)state;
    enum { PIXELS = TD_TILE_PIXELS };
    static const td_tile tile = {16, 32, 16, PIXELS};
    static const td_step step = {0, 10000000, 0, 1e7, 0.01};
    double S0[PIXELS], S0_dot[PIXELS], S1_dot[PIXELS], deviation[PIXELS], reference[PIXELS], on[PIXELS], off[PIXELS];
    uint8_t fall[PIXELS];
    tides_event events[PIXELS];
    const td_signals signals = {S0, S0_dot, S0, S1_dot};
    uint64_t seed = SEED + 7, found = 0;
    for (int trial = 0; trial < 40; trial++) {
        const int own = trial % 2;
        uint64_t want = 0;
        td_timing timing;
        td_timed timed = {.step = &step,
                          .tile = &tile,
                          .signals = &signals,
                          .deviation = deviation,
                          .fall = fall,
                          .adds = trial % 3 ? 1 : 4,
                          .levels = {on, off, reference, own, NULL, 0},
                          .events = events};
        memset(&timing, 0, sizeof timing);
        for (int i = 0; i < PIXELS; i++) {
            const double bow = scene_between(&seed, -0.3, 0.3), turn = scene_between(&seed, -2, 2);
            on[i] = own || i == 0 ? scene_between(&seed, 0.1, 0.3) : on[0];
            off[i] = own || i == 0 ? scene_between(&seed, 0.1, 0.3) : off[0];
            S0[i] = turn - bow;
            S0_dot[i] = 4 * bow / H;
            S1_dot[i] = -4 * bow / H;
            deviation[i] = scene_between(&seed, 0, 0.05);
            fall[i] = TD_PROBE_SMOOTH_LEAST;
            const double error = TD_PROBE_LEFT_MOST * deviation[i] * timed.adds,
                         residual = scene_between(&seed, -off[i], on[i]);
            const double left = bow > 0 ? on[i] - residual : residual + off[i];
            want += left < error;
            reference[i] = turn - residual;
            if (i % 2) continue;
            const int rises = i % 4 > 0;
            reference[i] += rises ? on[i] : -off[i];
            events[timed.count++] = (tides_event){.t = 9000000,
                                                  .x = (uint16_t)(16 + i % 16),
                                                  .y = (uint16_t)(32 + i / 16),
                                                  .polarity = rises ? 1 : -1};
        }
        td_timing_add_turns(&timing, &timed);
        if (timing.uncertain != want) fail_msg("trial %d: %d uncertain, not %d", trial, (int)timing.uncertain, (int)want);
        found += want;
    }
    assert_true(found > 100);
}

/* -- where the run ends ---------------------------------------------------------------------------------------------- */

/* An event that comes so late that its error would have it after the run may be none: in the run's last step only. */
static void test_late_events(void **state) {
    (void)state;
    static const struct late {
        int64_t t; /* [ns]; the error is 1e5 of them */
        int is_last;
        uint64_t uncertain;
    } cases[] = {{9950000, 1, 1}, {9950000, 0, 0}, {9850000, 1, 0}, {9999999, 1, 1}, {9999999, 0, 0}, {0, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        td_timing timing;
        rise r;
        memset(&timing, 0, sizeof timing);
        rising(&timing, &r, 0.01, cases[i].is_last)->event.t = cases[i].t;
        td_timing_add(&timing, &r.timed);
        if (timing.uncertain != cases[i].uncertain) fail_msg("case %zu: %d uncertain", i, (int)timing.uncertain);
        expect_percentile(&timing, 0.5, 0.01 * H); /* its own error is what it is in any step */
    }
}

/* A signal that ends below a level by less than its error may have reached it: where there is no next step to tell. */
static void test_levels_at_the_end(void **state) {
    (void)state;
    const double error = 0.01;
    static const struct level {
        double on, off; /* errors from where the signal ends to each threshold */
        int is_last;
        uint64_t uncertain;
    } cases[] = {{0.5, 50, 1, 1}, {0.5, 50, 0, 0}, {2, 50, 1, 0},   {50, 0.5, 1, 1},
                 {50, 0.5, 0, 0}, {50, 2, 1, 0},   {-0.5, 50, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        td_timing timing;
        rise r;
        const double reference = 0.7, residual = 1 - reference;
        const double on = residual + cases[i].on * error, off = cases[i].off * error - residual;
        memset(&timing, 0, sizeof timing);
        rising(&timing, &r, error, cases[i].is_last)->timed.count = 0;
        r.timed.levels = (td_levels){.reference = &reference, .threshold_on = &on, .threshold_off = &off, .stride = 1};
        td_timing_add_turns(&timing, &r.timed);
        if (timing.uncertain != cases[i].uncertain) fail_msg("case %zu: %d uncertain", i, (int)timing.uncertain);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_straight),    cmocka_unit_test(test_parabolas),
                                       cmocka_unit_test(test_touch),       cmocka_unit_test(test_percentiles),
                                       cmocka_unit_test(test_ends),        cmocka_unit_test(test_turns),
                                       cmocka_unit_test(test_late_events), cmocka_unit_test(test_levels_at_the_end),
                                       cmocka_unit_test(test_measured)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
