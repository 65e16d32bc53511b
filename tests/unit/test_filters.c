/* The filters behind the readout, event for event against an independent implementation of include/tides/filters.h
 * (plain_filters.h): it handles whole streams, one filter after the other, and shares nothing with lib/filters. */
#include "tests/unit/plain_filters.h"

#include "signal/td_event_sort.h"
#include "td_random.h"
#include "tests/support/shared.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { WIDTH = 61, HEIGHT = 37, EVENTS = 1000000 };

/* -- streams -------------------------------------------------------------------------------------------------------------- */

/* Background everywhere, bursts of one polarity, a lamp of 100 Hz over a corner, and twins at one time; all from `start` on. */
static stream make_stream(size_t count, int64_t start) {
    stream s = {room(count, sizeof(tides_event)), count, WIDTH, HEIGHT};
    tides_event *scratch = room(count, sizeof *scratch);
    double t = 0;
    for (size_t i = 0; i < count; i++) {
        const td_random_bits bits = td_random(SEED, 0, i, TD_RANDOM_NOISE);
        tides_event *e = &s.events[i];
        const uint32_t kind = bits.word[0] % 16;
        t += (i / 20000 % 3 ? 900 : 9000) * td_random_exponential(&bits, 1);
        *e = (tides_event){.t = start + (int64_t)t, .polarity = bits.word[1] & 1 ? 1 : -1};
        e->x = (uint16_t)(bits.word[1] / 2 % WIDTH);
        e->y = (uint16_t)(bits.word[0] / 16 % HEIGHT);
        if (kind < 9) e->x = (uint16_t)(e->x % 13), e->y = (uint16_t)(e->y % 11);
        if (kind < 9) e->polarity = fmod(t, 1e7) < 5e6 ? 1 : -1;
        if (kind == 15 && i) e->t = s.events[i - 1].t;
    }
    td_event_sort(s.events, scratch, count);
    free(scratch);
    return s;
}

/* The first events of a real recording (ECD slider_depth); 0 where it isn't there. */
static int real_stream(stream *s) {
    char file[1024];
    if (shared_path(file, sizeof file, "data/events/ecd_slider_depth_davis240_50k.txt") != 0) return 0;
    *s = (stream){room(50000, sizeof(tides_event)), 0, 240, 180};
    assert_int_equal(tides_events_read(file, 0, 50000, s->events, &s->count, NULL), TIDES_OK);
    assert_int_equal(s->count, 50000);
    tides_event *scratch = room(s->count, sizeof *scratch);
    td_event_sort(s->events, scratch, s->count);
    free(scratch);
    return 1;
}

static stream copy(const stream *s) {
    stream made = {room(s->count, sizeof(tides_event)), s->count, s->width, s->height};
    memcpy(made.events, s->events, s->count * sizeof *s->events);
    return made;
}

/* -- the library's -------------------------------------------------------------------------------------------------------- */

/* In calls of up to `most` events; `fired` is each event's number. */
static void filter(const tides_filters *f, stream *s, size_t most, tides_filter_stats *stats) {
    tides_filter *made;
    tides_error error;
    if (tides_filter_create(f, s->width, s->height, SEED, &made, &error) != TIDES_OK) fail_msg("%s", error.text);
    int64_t *fired = room(s->count, sizeof *fired);
    size_t out = 0, kept;
    for (size_t i = 0; i < s->count; i++) fired[i] = (int64_t)i;
    tides_event *all = room(s->count, sizeof *all);
    memcpy(all, s->events, s->count * sizeof *all);
    for (size_t i = 0, n; i < s->count; i += n) {
        n = 1 + (i * 7 + 3) % most;
        if (n > s->count - i) n = s->count - i;
        if (tides_filter_apply(made, s->events + i, fired + i, n, &kept, &error) != TIDES_OK) fail_msg("%s", error.text);
        for (size_t k = 0; k < kept; k++) assert_memory_equal(&s->events[i + k], &all[fired[i + k]], sizeof *all);
        memmove(s->events + out, s->events + i, kept * sizeof *s->events);
        out += kept;
    }
    s->count = out;
    tides_filter_stats_get(made, stats);
    tides_filter_destroy(made);
    free(fired);
    free(all);
}

static void expect_same(const char *name, const tides_filters *f, const stream *s) {
    static const size_t pieces[] = {1, 97, SIZE_MAX / 8};
    uint64_t dropped[TIDES_STAGES];
    stream wanted = copy(s);
    plain(f, &wanted, dropped);
    for (size_t k = s->count > 100000; k < 3; k++) {
        tides_filter_stats stats;
        stream got = copy(s);
        filter(f, &got, pieces[k], &stats);
        assert_int_equal(got.count, wanted.count);
        assert_memory_equal(got.events, wanted.events, got.count * sizeof *got.events);
        assert_memory_equal(stats.dropped, dropped, sizeof dropped);
        assert_true(stats.in == s->count && stats.out == got.count);
        free(got.events);
    }
    print_message("%-24s %zu of %zu events\n", name, wanted.count, s->count);
    if (wanted.count == 0 || wanted.count == s->count) fail_msg("%s: does nothing, or lets nothing pass", name);
    free(wanted.events);
}

/* -- tests ---------------------------------------------------------------------------------------------------------------- */

static tides_filters off(void) {
    tides_filters f;
    tides_filters_defaults(&f);
    return f;
}

/* Each filter alone and all at once; numbers in events/s fit the stream's own rate. */
static void hold_all(const stream *s) {
    const double rate = (double)s->count / (1e-9 * (double)(s->events[s->count - 1].t - s->events[0].t));
    tides_filters f = off(), all = off();
    f.background_s = all.background_s = 0.002;
    expect_same("background", &f, s);
    f.background_support = 3;
    expect_same("background, support 3", &f, s);
    f = off();
    f.activity_low_start = 0.4 * rate;
    f.activity_low_stop = rate;
    expect_same("activity, low", &f, s);
    f.activity_high_start = all.activity_high_start = 2 * rate;
    f.activity_high_stop = all.activity_high_stop = 0.7 * rate;
    expect_same("activity, both", &f, s);
    f = off();
    for (f.afk = TIDES_AFK_BAND_STOP; f.afk <= TIDES_AFK_BAND_PASS; f.afk++) {
        f.afk_start = 3;
        f.afk_stop = 1;
        expect_same("afk", &f, s);
    }
    f = off();
    for (f.trail = TIDES_TRAIL_TRAIL; f.trail <= TIDES_TRAIL_STC_KEEP; f.trail++) expect_same("trail", &f, s);
    f = off();
    for (f.erc_law = TIDES_ERC_CHANCE; f.erc_law <= TIDES_ERC_FIRST; f.erc_law++) {
        f.erc_events = all.erc_events = 1 + (int32_t)(0.8 * rate * f.erc_period_s);
        expect_same("erc", &f, s);
    }
    all.afk = TIDES_AFK_BAND_STOP;
    all.trail = TIDES_TRAIL_STC_KEEP;
    expect_same("all", &all, s);
}

static void random_events(void **state) {
    (void)state;
    print_message("seed %d\n", SEED);
    stream s = make_stream(EVENTS, 0);
    hold_all(&s);
    free(s.events);
}

/* Before 0, and as far from it as clocks are that count from 1970. */
static void other_clocks(void **state) {
    (void)state;
    static const int64_t starts[] = {-13000001, 1700000000123456789};
    for (size_t i = 0; i < 2; i++) {
        stream s = make_stream(30000, starts[i]);
        tides_filters f = off();
        f.background_s = 0.001;
        f.trail = TIDES_TRAIL_TRAIL;
        f.afk = TIDES_AFK_BAND_STOP;
        expect_same("another clock", &f, &s);
        if (starts[i] < 0) {
            f = off();
            f.erc_events = 100;
            f.activity_low_start = 5e5;
            expect_same("periods before 0", &f, &s);
        }
        free(s.events);
    }
}

static void real_events(void **state) {
    (void)state;
    stream s;
    if (!real_stream(&s)) {
        print_message("skipped: no recording\n");
        skip();
    }
    hold_all(&s);
    free(s.events);
}

/* What documents say in so many words: the burst's events that pass; what a lamp leaves; a period's first events. */
static void worked_examples(void **state) {
    (void)state;
    static const struct {
        int trail;
        const char *passes;
    } bursts[] = {{TIDES_TRAIL_TRAIL, "101100111"}, {TIDES_TRAIL_STC_CUT, "010010000"}, {TIDES_TRAIL_STC_KEEP, "010011000"}};
    /* [ms] */
    static const int at[] = {0, 5, 30, 31, 32, 33, 60, 70, 81}, polarity[] = {1, 1, -1, 1, 1, 1, 1, -1, -1};
    for (size_t b = 0; b < 3; b++) {
        tides_filters f = off();
        tides_filter *made;
        f.trail = bursts[b].trail;
        assert_int_equal(tides_filter_create(&f, 1, 1, 0, &made, NULL), TIDES_OK);
        for (size_t i = 0; i < 9; i++) {
            tides_event e = {.t = 1000000 * (int64_t)at[i], .polarity = (int8_t)polarity[i]};
            size_t kept;
            assert_int_equal(tides_filter_apply(made, &e, NULL, 1, &kept, NULL), TIDES_OK);
            if ((int)kept != bursts[b].passes[i] - '0') fail_msg("trail %zu: event %zu", b, i);
        }
        tides_filter_destroy(made);
    }
}

static void lamp(void **state) {
    (void)state;
    tides_filters f = off();
    tides_filter *made;
    size_t kept, passed = 0;
    f.afk = TIDES_AFK_BAND_STOP;
    assert_int_equal(tides_filter_create(&f, 8, 8, 0, &made, NULL), TIDES_OK);
    for (int k = 0; k < 200; k++) { /* 100 Hz: ON and OFF in turns every 5 ms */
        tides_event e = {.t = 5000000 * (int64_t)k, .x = (uint16_t)(k % 4), .polarity = k % 2 ? 1 : -1};
        assert_int_equal(tides_filter_apply(made, &e, NULL, 1, &kept, NULL), TIDES_OK);
        passed += kept;
    }
    assert_int_equal(passed, 7); /* two first turns, and five periods until the counter is at 6 */
    tides_event e = {.t = 1000000000, .x = 6, .polarity = 1};
    assert_int_equal(tides_filter_apply(made, &e, NULL, 1, &kept, NULL), TIDES_OK);
    assert_int_equal(kept, 1); /* another cell */
    tides_filter_destroy(made);
}

/* Events every microsecond from `from` to `to` [us]: how many pass. */
static size_t count_passing(tides_filter *filter, int from, int to) {
    size_t passed = 0, kept;
    for (int t = from; t < to; t++) {
        tides_event e = {.t = 1000 * (int64_t)t, .polarity = 1};
        assert_int_equal(tides_filter_apply(filter, &e, NULL, 1, &kept, NULL), TIDES_OK);
        passed += kept;
    }
    return passed;
}

/* Periods are floored before 0 too, and those in which nothing happens count. */
static void periods(void **state) {
    (void)state;
    tides_filters f = off();
    tides_filter *made;
    f.erc_law = TIDES_ERC_FIRST;
    f.erc_events = 10;
    assert_int_equal(tides_filter_create(&f, 8, 8, 0, &made, NULL), TIDES_OK);
    assert_int_equal(count_passing(made, -500, 500), 60); /* the ends of two periods and four whole ones */
    tides_filter_destroy(made);
    f = off();
    f.activity_low_start = 5e5;
    assert_int_equal(tides_filter_create(&f, 8, 8, 0, &made, NULL), TIDES_OK);
    assert_int_equal(count_passing(made, 0, 1000), 0);
    assert_int_equal(count_passing(made, 1000, 2000), 1000);
    assert_int_equal(count_passing(made, 4500, 4900), 0); /* after two that were empty */
    tides_filter_destroy(made);
}

static void expect_refused(const tides_filters *f, const char *word) {
    tides_filter *made = NULL;
    tides_error error = {TIDES_OK, ""};
    assert_int_equal(tides_filter_create(f, 8, 8, 0, &made, &error), TIDES_BAD_ARGUMENT);
    if (!strstr(error.text, word)) fail_msg("'%s' in '%s'", word, error.text);
}

#define REFUSE(field, value)        \
    do {                            \
        tides_filters f = off();    \
        f.field = value;            \
        expect_refused(&f, #field); \
    } while (0)

static void refused(void **state) {
    (void)state;
    REFUSE(background_s, NAN);
    REFUSE(background_support, 0);
    REFUSE(background_support, 9);
    REFUSE(activity_low_start, -1);
    REFUSE(activity_low_stop, INFINITY);
    REFUSE(activity_period_s, 0);
    REFUSE(afk, 3);
    REFUSE(afk_low_hz, 0);
    REFUSE(afk_low_hz, 521);
    REFUSE(afk_cell_px, 0);
    REFUSE(afk_start, 4);
    REFUSE(afk_stop, -1);
    REFUSE(trail, 4);
    REFUSE(trail_s, -1e-9);
    REFUSE(erc_events, -1);
    REFUSE(erc_period_s, 1e-10);
    REFUSE(erc_law, 2);
    tides_filters f = off();
    f.activity_low_start = 10;
    f.activity_low_stop = 9;
    expect_refused(&f, "activity_low_start");
    f = off();
    f.activity_high_start = 10;
    f.activity_high_stop = 11;
    expect_refused(&f, "activity_high_stop");
}

/* Nothing is taken of a call with an event that can't be. */
static void refused_events(void **state) {
    (void)state;
    tides_filters f = off();
    tides_filter *made;
    tides_filter_stats stats;
    size_t kept = 77;
    f.trail = TIDES_TRAIL_TRAIL;
    assert_int_equal(tides_filter_create(&f, 8, 8, 0, &made, NULL), TIDES_OK);
    const tides_event bad[] = {{.t = 4, .polarity = 1},
                               {.t = 9, .x = 8, .polarity = 1},
                               {.t = 9, .y = 8, .polarity = 1},
                               {.t = 9}};
    tides_event events[2] = {{.t = 5, .polarity = 1}};
    for (size_t i = 0; i < 4; i++) {
        events[1] = bad[i];
        assert_int_equal(tides_filter_apply(made, events, NULL, 2, &kept, NULL), TIDES_BAD_ARGUMENT);
    }
    tides_filter_stats_get(made, &stats);
    assert_true(stats.in == 0 && kept == 77);
    assert_int_equal(tides_filter_apply(made, events, NULL, 0, &kept, NULL), TIDES_OK);
    assert_int_equal(kept, 0);
    tides_filter_destroy(made);
    tides_filter_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_events),   cmocka_unit_test(other_clocks),   cmocka_unit_test(real_events),
        cmocka_unit_test(worked_examples), cmocka_unit_test(lamp),           cmocka_unit_test(periods),
        cmocka_unit_test(refused),         cmocka_unit_test(refused_events),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
