/* Readouts without ticks, against independent ones in every time stamp: a row's turn, its latch and its events, and frames,
 * computed from the whole stream at once, with lists in place of queues. */
#include "readout/td_arbiter.h"

#include "signal/td_event_sort.h"
#include "td_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { WIDTH = 40, HEIGHT = 24, EVENTS = 30000, SEED = 77 };

typedef struct stream {
    tides_event *events; /* (EVENTS) as fired, or as they left */
    int64_t *fired;      /* of those that left */
    size_t count;
} stream;

static void *room(size_t count, size_t size) {
    void *made = calloc(count, size);
    assert_non_null(made);
    return made;
}

/* Sorted, of `gap` ns on average from `start` on, in bursts; half of them on whole multiples of 100 ns, so that events fall on
 * the bus's own times. */
static tides_event *make_events(double gap, int64_t start) {
    tides_event *events = room(EVENTS, sizeof *events), *scratch = room(EVENTS, sizeof *scratch);
    double t = 0;
    for (size_t i = 0; i < EVENTS; i++) {
        const td_random_bits bits = td_random(SEED, 1, i, TD_RANDOM_NOISE);
        t += (i / 600 % 3 ? 0.2 : 2.6) * gap * td_random_exponential(&bits, 0);
        events[i] = (tides_event){.t = start + (int64_t)t, .polarity = bits.word[1] & 1 ? 1 : -1, .cause = 0};
        if (bits.word[1] & 2) events[i].t -= ((events[i].t % 100) + 100) % 100;
        events[i].x = (uint16_t)(bits.word[3] % WIDTH);
        events[i].y = (uint16_t)(bits.word[2] % (i % 2 ? HEIGHT : 3));
    }
    td_event_sort(events, scratch, EVENTS);
    free(scratch);
    return events;
}

/* -- plain ----------------------------------------------------------------------------------------------------------------- */

enum { WAITS = -2, LOST = -1 }; /* in place of when it left */

/* Lists the events that fire up to `until` as waiting, where their row has room; `next` is the first that isn't listed. */
static void arrive(const tides_readout *r, const tides_event *events, int64_t *left, int *waiting, size_t *next,
                   int64_t until) {
    for (; *next < EVENTS && events[*next].t <= until; ++*next) {
        int *row = &waiting[events[*next].y];
        left[*next] = *row < r->queue_capacity ? WAITS : LOST;
        *row += left[*next] == WAITS;
    }
}

static void plain_requested(const tides_readout *r, const tides_event *events, int64_t *left) {
    const int64_t row_ns = llround(r->row_s * 1e9), event_ps = llround(r->event_s * 1e12);
    int waiting[HEIGHT] = {0}, after = 0;
    size_t next = 0, first = 0;
    int64_t free_at = INT64_MIN;
    for (;;) {
        while (first < next && left[first] != WAITS) first++;
        if (first == EVENTS) return;
        /* the bus is free, and somebody asks */
        const int64_t given = first < next || events[first].t <= free_at ? free_at : events[first].t;
        arrive(r, events, left, waiting, &next, given);
        int row = after;
        while (!waiting[row % HEIGHT]) row++;
        row %= HEIGHT;
        after = row + 1;
        const int64_t latch = given + row_ns;
        arrive(r, events, left, waiting, &next, latch);
        int64_t k = 0;
        for (size_t i = first; i < next; i++) {
            if (left[i] != WAITS || events[i].y != row) continue;
            k++;
            left[i] = r->stamp == TIDES_STAMP_ROW ? latch : latch + k * event_ps / 1000;
        }
        waiting[row] = 0;
        free_at = latch + (int64_t)ceil((double)(k * event_ps) / 1000);
    }
}

static void plain_scanned(const tides_readout *r, const tides_event *events, int64_t *left) {
    const int64_t frame_ns = llround(r->frame_s * 1e9), event_ps = llround(r->event_s * 1e12);
    char held[WIDTH * HEIGHT];
    int64_t frame = (int64_t)floor((double)events[0].t / (double)frame_ns) * frame_ns;
    for (size_t i = 0; i < EVENTS;) { /* every frame, empty ones too */
        int64_t n = 0;
        memset(held, 0, sizeof held);
        for (; i < EVENTS && events[i].t <= frame; i++) {
            char *pixel = &held[events[i].y * WIDTH + events[i].x];
            left[i] = *pixel ? LOST : frame;
            n += !*pixel;
            *pixel = 1;
        }
        const int64_t bus = (int64_t)ceil((double)(n * event_ps) / 1000);
        frame += bus > frame_ns ? bus : frame_ns;
    }
}

/* -- the library's --------------------------------------------------------------------------------------------------------- */

static int collect(void *user, const tides_event *events, const int64_t *fired, size_t count) {
    stream *s = user;
    assert_true(s->count + count <= EVENTS);
    memcpy(s->events + s->count, events, count * sizeof *events);
    memcpy(s->fired + s->count, fired, count * sizeof *fired);
    s->count += count;
    return 0;
}

/* As numbers and back, as a checkpoint has it. */
static tides_arbiter *reborn(const tides_readout *r, tides_arbiter *arbiter) {
    int64_t *numbers;
    size_t count;
    tides_arbiter *made;
    tides_error error;
    assert_int_equal(td_arbiter_pack(arbiter, &numbers, &count, &error), TIDES_OK);
    tides_arbiter_destroy(arbiter);
    assert_int_equal(tides_arbiter_create(r, WIDTH, HEIGHT, SEED, &made, &error), TIDES_OK);
    if (td_arbiter_unpack(made, numbers, count, &error) != TIDES_OK) fail_msg("%s", error.text);
    free(numbers);
    return made;
}

static stream run(const tides_readout *r, const tides_event *events, size_t step, tides_readout_stats *stats) {
    tides_arbiter *arbiter;
    tides_error error;
    stream out = {room(EVENTS, sizeof *out.events), room(EVENTS, sizeof *out.fired), 0};
    assert_int_equal(tides_arbiter_create(r, WIDTH, HEIGHT, SEED, &arbiter, &error), TIDES_OK);
    for (size_t i = 0, k = 0; i < EVENTS; i += step, k++) {
        const size_t part = EVENTS - i < step ? EVENTS - i : step;
        assert_int_equal(tides_arbiter_push(arbiter, events + i, part, collect, &out, &error), TIDES_OK);
        if (step > 100 && k % 3 == 1) arbiter = reborn(r, arbiter);
    }
    assert_int_equal(tides_arbiter_finish(arbiter, collect, &out, &error), TIDES_OK);
    tides_arbiter_stats(arbiter, stats);
    assert_true(stats->in == EVENTS && stats->out == out.count && stats->waiting == 0);
    assert_true(stats->in == stats->out + stats->overflowed);
    tides_arbiter_destroy(arbiter);
    return out;
}

typedef struct departure {
    tides_event event;
    int64_t fired;
} departure;

static int in_order(const void *a, const void *b) {
    const departure *x = a, *y = b;
    const int order = td_event_compare(&x->event, &y->event);
    return order ? order : (x->fired > y->fired) - (x->fired < y->fired);
}

static void expect_plain(const char *name, const tides_readout *r, double gap, int64_t start) {
    static const size_t steps[] = {1, 113, 7001, EVENTS};
    tides_event *events = make_events(gap, start);
    int64_t *left = room(EVENTS, sizeof *left);
    departure *wanted = room(EVENTS, sizeof *wanted);
    size_t count = 0, late = 0;
    if (r->kind == TIDES_READOUT_SCANNED)
        plain_scanned(r, events, left);
    else
        plain_requested(r, events, left);
    for (size_t i = 0; i < EVENTS; i++) {
        if (left[i] == LOST) continue;
        wanted[count] = (departure){events[i], events[i].t};
        wanted[count++].event.t = left[i];
        late += left[i] > events[i].t;
    }
    qsort(wanted, count, sizeof *wanted, in_order);
    for (size_t s = 0; s < sizeof steps / sizeof steps[0]; s++) {
        tides_readout_stats stats;
        stream out = run(r, events, steps[s], &stats);
        assert_int_equal(out.count, count);
        assert_int_equal(stats.delayed, late);
        assert_int_equal(stats.overflowed, EVENTS - count);
        for (size_t i = 0; i < count; i++)
            if (memcmp(&out.events[i], &wanted[i].event, sizeof(tides_event)) != 0 || out.fired[i] != wanted[i].fired)
                fail_msg("%s, pushes of %zu: event %zu left at %lld, and not %lld", name, steps[s], i,
                         (long long)out.events[i].t, (long long)wanted[i].event.t);
        free(out.events);
        free(out.fired);
        if (s == 0)
            print_message("%-28s %zu left, %zu late, by %.3g s at most, in %llu readings\n", name, count, late,
                          stats.worst_delay_s, (unsigned long long)stats.ticks);
    }
    free(events);
    free(left);
    free(wanted);
}

/* -- tests ----------------------------------------------------------------------------------------------------------------- */

static tides_readout of_kind(int32_t kind) {
    tides_readout r;
    tides_readout_defaults(&r);
    r.kind = kind;
    return r; /* eta and gamma_sigma_s as they are: these kinds don't read them */
}

static void requested(void **state) {
    (void)state;
    print_message("seed %d\n", SEED);
    tides_readout r = of_kind(TIDES_READOUT_REQUESTED);
    expect_plain("no time at all", &r, 100, 0);
    for (r.stamp = TIDES_STAMP_EVENT; r.stamp <= TIDES_STAMP_ROW; r.stamp++) {
        r.row_s = 100e-9;
        r.event_s = 83.333e-9; /* 12 million events a second */
        expect_plain("DAVIS346, busy", &r, 120, 0);
        expect_plain("DAVIS346, calm", &r, 3000, -40000);
        expect_plain("far from 0", &r, 120, 1700000000123456789);
    }
    r.stamp = TIDES_STAMP_EVENT;
    r.row_s = 0;
    r.event_s = 1e-9;
    expect_plain("events alone", &r, 100, 0);
    r.row_s = 2e-6;
    r.event_s = 0;
    expect_plain("rows alone", &r, 100, 0);
    r.queue_capacity = 3;
    expect_plain("short queues", &r, 100, 0);
}

static void scanned(void **state) {
    (void)state;
    tides_readout r = of_kind(TIDES_READOUT_SCANNED);
    expect_plain("200 us", &r, 1000, 0);
    r.event_s = 6.06e-9;
    expect_plain("165 million events/s", &r, 100, 0);
    r.event_s = 400e-9;
    expect_plain("frames that last longer", &r, 400, 0);
    expect_plain("before 0", &r, 400, -700001);
    expect_plain("before 0, on a frame", &r, 400, -600000);
    r.frame_s = 1e-9;
    r.event_s = 0;
    expect_plain("as they fire", &r, 3, 0);
}

/* A row that never rests doesn't starve the others: each is read after at most all others. */
static void no_starving(void **state) {
    (void)state;
    enum { COUNT = 3000 };
    tides_readout r = of_kind(TIDES_READOUT_REQUESTED);
    tides_event events[COUNT];
    tides_arbiter *arbiter;
    stream out = {room(EVENTS, sizeof *out.events), room(EVENTS, sizeof *out.fired), 0};
    r.row_s = 1e-6;
    for (int i = 0; i < COUNT; i++)
        events[i] = (tides_event){.t = 100 * (int64_t)i, .x = (uint16_t)(i % WIDTH), .y = i % 30 ? 5 : 20, .polarity = 1};
    assert_int_equal(tides_arbiter_create(&r, WIDTH, HEIGHT, 0, &arbiter, NULL), TIDES_OK);
    assert_int_equal(tides_arbiter_push(arbiter, events, COUNT, collect, &out, NULL), TIDES_OK);
    assert_int_equal(tides_arbiter_finish(arbiter, collect, &out, NULL), TIDES_OK);
    assert_int_equal(out.count, COUNT);
    for (size_t i = 0; i < out.count; i++) assert_true(out.events[i].t - out.fired[i] <= 3000);
    tides_arbiter_destroy(arbiter);
    free(out.events);
    free(out.fired);
}

static void refused(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t at;
        double bad;
    } rows[] = {{"row_s", offsetof(tides_readout, row_s), -1},
                {"row_s", offsetof(tides_readout, row_s), NAN},
                {"event_s", offsetof(tides_readout, event_s), 1.1e-3},
                {"frame_s", offsetof(tides_readout, frame_s), 0},
                {"frame_s", offsetof(tides_readout, frame_s), 1.5}};
    for (size_t i = 0; i <= sizeof rows / sizeof rows[0]; i++) {
        tides_readout r = of_kind(TIDES_READOUT_REQUESTED);
        tides_arbiter *arbiter = NULL;
        tides_error error = {TIDES_OK, ""};
        const int last = i == sizeof rows / sizeof rows[0];
        if (last)
            r.stamp = 2;
        else
            memcpy((char *)&r + rows[i].at, &rows[i].bad, sizeof rows[i].bad);
        assert_int_equal(tides_arbiter_create(&r, WIDTH, HEIGHT, 0, &arbiter, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, last ? "stamp" : rows[i].name));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(requested), cmocka_unit_test(scanned), cmocka_unit_test(no_starving),
                                       cmocka_unit_test(refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
