/* The readout arbiter: properties of any stream, and the behaviour of each kind of scanner. */
#include "tides/readout.h"

#include "td_random.h"
#include "signal/td_event_sort.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { WIDTH = 40, HEIGHT = 24, EVENTS = 20000, SEED = 11 };

/* What came out. */
typedef struct stream {
    tides_event *events;
    int64_t *fired;
    size_t count;
} stream;

static int collect(void *user, const tides_event *events, const int64_t *fired, size_t count) {
    stream *s = user;
    s->events = realloc(s->events, (s->count + count) * sizeof *s->events);
    s->fired = realloc(s->fired, (s->count + count) * sizeof *s->fired);
    assert_non_null(s->events);
    assert_non_null(s->fired);
    memcpy(s->events + s->count, events, count * sizeof *events);
    memcpy(s->fired + s->count, fired, count * sizeof *fired);
    s->count += count;
    return 0;
}

static void stream_free(stream *s) {
    free(s->events);
    free(s->fired);
}

/* Sorted events, `per_us` a microsecond on average, in bursts around one pixel now and then. */
static tides_event *make_events(size_t count, double per_us) {
    tides_event *events = calloc(count, sizeof *events);
    tides_event *scratch = calloc(count, sizeof *scratch);
    assert_non_null(events);
    assert_non_null(scratch);
    double t = 0;
    for (size_t i = 0; i < count; i++) {
        td_random_bits bits = td_random(SEED, 0, i, TD_RANDOM_NOISE);
        t += 1000 / per_us * td_random_exponential(&bits, 0);
        int burst = i / 500 % 4 == 0;
        events[i].t = (int64_t)t;
        events[i].x = (uint16_t)(burst ? 3 + bits.word[3] % 4 : bits.word[3] % WIDTH);
        events[i].y = (uint16_t)(burst ? 5 + bits.word[2] % 4 : bits.word[2] % HEIGHT);
        events[i].polarity = (int8_t)(bits.word[1] & 1 ? 1 : -1);
    }
    td_event_sort(events, scratch, count);
    free(scratch);
    return events;
}

static stream run(const tides_readout *readout, const tides_event *events, size_t count, size_t step,
                  tides_readout_stats *stats) {
    tides_error error = {0};
    tides_arbiter *arbiter = NULL;
    stream out = {0};
    assert_int_equal(tides_arbiter_create(readout, WIDTH, HEIGHT, SEED, &arbiter, &error), TIDES_OK);
    for (size_t i = 0; i < count; i += step) {
        size_t part = count - i < step ? count - i : step;
        assert_int_equal(tides_arbiter_push(arbiter, events + i, part, collect, &out, &error), TIDES_OK);
        tides_readout_stats now;
        tides_arbiter_stats(arbiter, &now);
        assert_int_equal(now.in, i + part);
        assert_int_equal(now.in, out.count + now.dropped + now.overflowed + now.waiting);
    }
    assert_int_equal(tides_arbiter_finish(arbiter, collect, &out, &error), TIDES_OK);
    tides_arbiter_stats(arbiter, stats);
    assert_int_equal(stats->waiting, 0);
    assert_int_equal(stats->out, out.count);
    assert_int_equal(stats->in, stats->out + stats->dropped + stats->overflowed);
    tides_arbiter_destroy(arbiter);
    return out;
}

/* In order, nothing more than `early` [ns] before it fired, and every event an event of the input. */
static void check_early(const stream *out, const tides_event *events, size_t count, int64_t early) {
    size_t found = 0;
    assert_true(out->count > 0);
    for (size_t i = 0; i < out->count; i++) {
        assert_true(i == 0 || td_event_compare(&out->events[i - 1], &out->events[i]) <= 0);
        assert_true(out->events[i].t >= out->fired[i] - early);
    }
    tides_event *back = malloc((out->count + 1) * sizeof *back), *scratch = malloc((out->count + 1) * sizeof *scratch);
    assert_non_null(back);
    assert_non_null(scratch);
    for (size_t i = 0; i < out->count; i++) {
        back[i] = out->events[i];
        back[i].t = out->fired[i];
    }
    td_event_sort(back, scratch, out->count);
    for (size_t i = 0; i < count && found < out->count; i++) found += memcmp(&back[found], &events[i], sizeof events[i]) == 0;
    assert_int_equal(found, out->count);
    free(back);
    free(scratch);
}

static void check_sound(const stream *out, const tides_event *events, size_t count) { check_early(out, events, count, 0); }

static tides_readout slow(int32_t kind) {
    tides_readout readout;
    tides_readout_defaults(&readout);
    readout.kind = kind;
    readout.tile_px = 8;
    readout.k0 = 2;
    readout.eta = readout.gamma_sigma_s = 0;
    readout.row_s = 0.2e-6;
    readout.event_s = 0.5e-6;
    readout.frame_s = 5e-6;
    return readout;
}

static void test_identity(void **state) {
    (void)state;
    tides_readout_stats stats;
    tides_event *events = make_events(EVENTS, 3);
    tides_readout instant = slow(TIDES_READOUT_TILES), wide = slow(TIDES_READOUT_BOTTLENECK);
    instant.tick_s = 0;
    wide.k0 = 1000000;
    const tides_readout *both[2] = {&instant, &wide};
    for (int i = 0; i < 2; i++) {
        stream out = run(both[i], events, EVENTS, 700, &stats);
        assert_int_equal(out.count, EVENTS);
        assert_memory_equal(out.events, events, EVENTS * sizeof *events);
        assert_int_equal(stats.delayed, 0);
        stream_free(&out);
    }
    free(events);
}

/* How the stream is cut into pushes doesn't show, for any kind, with drops and jitter too. */
static void test_cuts(void **state) {
    (void)state;
    tides_event *events = make_events(EVENTS, 3);
    for (int32_t kind = TIDES_READOUT_TILES; kind <= TIDES_READOUT_SCANNED; kind++) {
        tides_readout readout = slow(kind);
        tides_readout_stats stats;
        readout.p0 = 0.1;
        readout.sigma0_s = 2e-6;
        readout.jitter_law = kind % 2 ? TIDES_JITTER_DELAY : TIDES_JITTER_GAUSSIAN;
        stream whole = run(&readout, events, EVENTS, EVENTS, &stats);
        check_early(&whole, events, EVENTS, kind % 2 ? 0 : (int64_t)(8.6 * 2000));
        assert_true(stats.delayed > EVENTS / 20);
        const size_t steps[] = {1, 37, 5000};
        for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
            stream cut = run(&readout, events, EVENTS, steps[i], &stats);
            assert_int_equal(cut.count, whole.count);
            assert_memory_equal(cut.events, whole.events, whole.count * sizeof *whole.events);
            assert_memory_equal(cut.fired, whole.fired, whole.count * sizeof *whole.fired);
            stream_free(&cut);
        }
        stream_free(&whole);
    }
    free(events);
}

/* Events of a tick that leave as they come go past the queues, where the push shows that the tick is over; one by one each
 * queues. It must not show, in the statistics either, for ticks that hold few or many, and queues that are short. */
static void test_prompt(void **state) {
    (void)state;
    const struct {
        double per_us;
        int32_t kind, k0, capacity;
    } cases[] = {{0.3, TIDES_READOUT_TILES, 32, 65536},    {8, TIDES_READOUT_TILES, 32, 65536},
                 {8, TIDES_READOUT_TILES, 32, 3},          {20, TIDES_READOUT_BOTTLENECK, 40, 65536},
                 {20, TIDES_READOUT_BOTTLENECK, 100, 19},  {60, TIDES_READOUT_BOTTLENECK, 90, 65536},
                 {100, TIDES_READOUT_BOTTLENECK, 80, 200}, {60, TIDES_READOUT_ROWS, 40, 65536}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        tides_event *events = make_events(EVENTS, cases[c].per_us);
        tides_readout readout = slow(cases[c].kind);
        tides_readout_stats at_once, by_one;
        readout.k0 = cases[c].k0;
        readout.queue_capacity = cases[c].capacity;
        stream whole = run(&readout, events, EVENTS, EVENTS, &at_once), cut = run(&readout, events, EVENTS, 1, &by_one);
        check_sound(&whole, events, EVENTS);
        assert_int_equal(cut.count, whole.count);
        assert_memory_equal(cut.events, whole.events, whole.count * sizeof *whole.events);
        assert_memory_equal(cut.fired, whole.fired, whole.count * sizeof *whole.fired);
        assert_memory_equal(&by_one, &at_once, sizeof by_one);
        stream_free(&whole);
        stream_free(&cut);
        free(events);
    }
}

/* Within a tile events leave in the order in which they fired. */
static void test_fifo(void **state) {
    (void)state;
    tides_event *events = make_events(EVENTS, 3);
    tides_readout readout = slow(TIDES_READOUT_TILES);
    tides_readout_stats stats;
    stream out = run(&readout, events, EVENTS, 900, &stats);
    int64_t last_fired[15] = {0}, last_left[15] = {0};
    for (size_t i = 0; i < out.count; i++) {
        int tile = out.events[i].y / 8 * 5 + out.events[i].x / 8;
        if (out.events[i].t > last_left[tile]) assert_true(out.fired[i] >= last_fired[tile]);
        last_left[tile] = out.events[i].t;
        last_fired[tile] = out.fired[i] > last_fired[tile] ? out.fired[i] : last_fired[tile];
    }
    stream_free(&out);
    free(events);
}

/* Saturated, each tick carries k0 events: no more, no fewer. */
static void test_throughput(void **state) {
    (void)state;
    tides_event *events = make_events(EVENTS, 50);
    const int32_t kinds[2] = {TIDES_READOUT_TILES, TIDES_READOUT_BOTTLENECK};
    for (int i = 0; i < 2; i++) {
        tides_readout readout = slow(kinds[i]);
        tides_readout_stats stats;
        stream out = run(&readout, events, EVENTS, 1000, &stats);
        assert_int_equal(out.count, EVENTS);
        double seconds = (double)(out.events[EVENTS - 1].t - out.events[0].t) * 1e-9;
        double rate = EVENTS / seconds, asked = readout.k0 / readout.tick_s;
        printf("kind %d: %.6g events/s of %.6g\n", (int)kinds[i], rate, asked);
        assert_true(rate <= asked * 1.001);
        assert_true(rate > asked * 0.97); /* the last ticks find tiles with a single event */
        stream_free(&out);
    }
    free(events);
}

/* A tile's activity lowers what it may send: floor(8 (1 - 0.5 psi)) a tick. */
static void test_activity(void **state) {
    (void)state;
    tides_error error = {0};
    tides_readout readout = slow(TIDES_READOUT_TILES);
    readout.k0 = 8;
    for (int active = 0; active < 2; active++) {
        tides_arbiter *arbiter = NULL;
        tides_event events[64];
        double psi[15] = {0};
        stream out = {0};
        int per_tick = active ? 4 : 8;
        memset(events, 0, sizeof events);
        for (int i = 0; i < 64; i++) {
            events[i].x = (uint16_t)(i % 8);
            events[i].y = (uint16_t)(i / 8);
            events[i].polarity = 1;
        }
        psi[0] = active;
        assert_int_equal(tides_arbiter_create(&readout, WIDTH, HEIGHT, SEED, &arbiter, &error), TIDES_OK);
        assert_int_equal(tides_arbiter_activity(arbiter, psi, &error), TIDES_OK);
        assert_int_equal(tides_arbiter_push(arbiter, events, 64, collect, &out, &error), TIDES_OK);
        assert_int_equal(tides_arbiter_finish(arbiter, collect, &out, &error), TIDES_OK);
        for (int i = 0; i < 64; i++) assert_int_equal(out.events[i].t, i / per_tick * 1000);
        psi[3] = 1.5;
        assert_int_equal(tides_arbiter_activity(arbiter, psi, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "tile 3"));
        tides_arbiter_destroy(arbiter);
        stream_free(&out);
    }
}

/* Row y is read at the end of ticks y, y + HEIGHT, ...; all of it at once. */
static void test_rows(void **state) {
    (void)state;
    tides_event *events = make_events(EVENTS, 3);
    tides_readout readout = slow(TIDES_READOUT_ROWS);
    tides_readout_stats stats;
    stream out = run(&readout, events, EVENTS, 900, &stats);
    assert_int_equal(out.count, EVENTS);
    check_sound(&out, events, EVENTS);
    for (size_t i = 0; i < out.count; i++) {
        int64_t tick = out.events[i].t / 1000 - 1;
        assert_int_equal(out.events[i].t % 1000, 0);
        assert_int_equal(tick % HEIGHT, out.events[i].y);
        assert_true(out.events[i].t - out.fired[i] <= HEIGHT * 1000);
    }
    stream_free(&out);
    free(events);
}

/* Mean and standard deviation of what jitter made of the times, in units of `sigma`, within 3 standard errors. `kurtosis`: the
 * law's fourth central moment over sigma^4, which the standard deviation's error goes with. */
static void check_moments(const stream *out, double sigma, double mean, double kurtosis) {
    double sum = 0, squares = 0, n = (double)out->count;
    for (size_t i = 0; i < out->count; i++) {
        double moved = (double)(out->events[i].t - out->fired[i]) * 1e-9 / sigma;
        sum += moved;
        squares += moved * moved;
    }
    double spread = sqrt(squares / n - sum / n * (sum / n));
    printf("jitter: mean %.4f sigma, asked %.4f; standard deviation %.4f sigma\n", sum / n, mean, spread);
    assert_true(fabs(sum / n - mean) < 3 / sqrt(n));
    assert_true(fabs(spread - 1) < 3 * sqrt((kurtosis - 1) / 4 / n));
}

/* All tiles with this activity. */
static stream run_active(const tides_readout *readout, const tides_event *events, double psi, tides_readout_stats *stats) {
    enum { TILES = WIDTH * HEIGHT };
    double activity[TILES];
    tides_arbiter *arbiter;
    tides_error error;
    stream out = {0};
    for (int i = 0; i < TILES; i++) activity[i] = psi;
    assert_int_equal(tides_arbiter_create(readout, WIDTH, HEIGHT, SEED, &arbiter, &error), TIDES_OK);
    assert_int_equal(tides_arbiter_activity(arbiter, activity, &error), TIDES_OK);
    assert_int_equal(tides_arbiter_push(arbiter, events, EVENTS, collect, &out, &error), TIDES_OK);
    assert_int_equal(tides_arbiter_finish(arbiter, collect, &out, &error), TIDES_OK);
    tides_arbiter_stats(arbiter, stats);
    tides_arbiter_destroy(arbiter);
    return out;
}

/* Drops and jitter, p0 + eta psi and sigma0 + gamma psi, within 3 standard errors of what was asked. */
static void test_chance(void **state) {
    (void)state;
    /* Of |n|: mean sqrt(2 / pi) over its standard deviation sqrt(1 - 2 / pi); fourth moment 3.869 (half-normal). */
    static const double mean[] = {0, 1.3236}, kurtosis[] = {3, 3.869};
    tides_event *events = make_events(EVENTS, 3);
    for (int law = TIDES_JITTER_GAUSSIAN; law <= TIDES_JITTER_DELAY; law++) {
        tides_readout readout = slow(TIDES_READOUT_BOTTLENECK);
        tides_readout_stats stats;
        readout.k0 = 1000000;
        readout.p0 = 0.1;
        readout.eta = 0.2;
        readout.sigma0_s = 2e-6;
        readout.gamma_sigma_s = 6e-6;
        readout.jitter_law = law;
        stream out = run_active(&readout, events, 0.5, &stats);
        double dropped = (double)stats.dropped / EVENTS;
        printf("dropped %.4f of 0.2\n", dropped);
        assert_true(fabs(dropped - 0.2) < 3 * sqrt(0.2 * 0.8 / EVENTS));
        check_moments(&out, 5e-6, mean[law], kurtosis[law]);
        check_early(&out, events, EVENTS, law == TIDES_JITTER_DELAY ? 0 : (int64_t)(8.6 * 5000));
        stream_free(&out);
    }
    free(events);
}

/* Nothing leaves before the run's start, nor is anything lost there; without a start jitter goes beyond. */
static void test_start(void **state) {
    (void)state;
    tides_event *events = make_events(EVENTS, 300);
    for (int starts = 0; starts < 2; starts++) {
        tides_readout readout = slow(TIDES_READOUT_TILES);
        tides_arbiter *arbiter;
        tides_error error;
        stream out = {0};
        readout.tick_s = 0;
        readout.sigma0_s = 1e-5;
        assert_int_equal(tides_arbiter_create(&readout, WIDTH, HEIGHT, SEED, &arbiter, &error), TIDES_OK);
        if (starts) tides_arbiter_start(arbiter, events[0].t);
        assert_int_equal(tides_arbiter_push(arbiter, events, EVENTS, collect, &out, &error), TIDES_OK);
        assert_int_equal(tides_arbiter_finish(arbiter, collect, &out, &error), TIDES_OK);
        tides_arbiter_destroy(arbiter);
        assert_int_equal(out.count, EVENTS);
        assert_int_equal(out.events[0].t >= events[0].t, starts);
        check_early(&out, events, EVENTS, 86000);
        stream_free(&out);
    }
    free(events);
}

static void test_overflow(void **state) {
    (void)state;
    tides_event *events = make_events(EVENTS, 50);
    tides_readout readout = slow(TIDES_READOUT_BOTTLENECK);
    tides_readout_stats stats;
    readout.queue_capacity = 100;
    stream out = run(&readout, events, EVENTS, 900, &stats);
    assert_true(stats.overflowed > EVENTS / 2);
    assert_true(stats.worst_delay_s <= 100 / 2.0 * 1e-6 + 1e-6);
    check_sound(&out, events, EVENTS);
    stream_free(&out);
    free(events);
}

/* A second without events costs no ticks. */
static void test_idle(void **state) {
    (void)state;
    tides_event events[2] = {{.t = 5, .polarity = 1}, {.t = 1000000000, .polarity = 1}};
    tides_readout readout = slow(TIDES_READOUT_TILES);
    tides_readout_stats stats;
    stream out = run(&readout, events, 2, 2, &stats);
    assert_int_equal(stats.ticks, 2);
    assert_memory_equal(out.events, events, sizeof events);
    stream_free(&out);
}

static void test_refusals(void **state) {
    (void)state;
    tides_error error = {0};
    tides_arbiter *arbiter = NULL;
    tides_readout readout = slow(TIDES_READOUT_TILES);
    readout.p0 = 1.5;
    assert_int_equal(tides_arbiter_create(&readout, WIDTH, HEIGHT, 0, &arbiter, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "p0"));
    readout.p0 = NAN;
    assert_int_equal(tides_arbiter_create(&readout, WIDTH, HEIGHT, 0, &arbiter, &error), TIDES_BAD_ARGUMENT);
    readout = slow(TIDES_READOUT_TILES);
    readout.k0 = 0;
    assert_int_equal(tides_arbiter_create(&readout, WIDTH, HEIGHT, 0, &arbiter, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "k0"));
    readout = slow(TIDES_READOUT_TILES);
    assert_int_equal(tides_arbiter_create(&readout, WIDTH, HEIGHT, 0, &arbiter, &error), TIDES_OK);
    tides_event late[2] = {{.t = 5, .polarity = 1}, {.t = 4, .polarity = 1}}, outside = {.t = 9, .x = WIDTH, .polarity = 1};
    assert_int_equal(tides_arbiter_push(arbiter, late, 2, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_arbiter_push(arbiter, &outside, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    tides_readout_stats stats;
    tides_arbiter_stats(arbiter, &stats);
    assert_int_equal(stats.in, 0);
    tides_arbiter_destroy(arbiter);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_identity),   cmocka_unit_test(test_cuts),
                                       cmocka_unit_test(test_prompt),     cmocka_unit_test(test_fifo),
                                       cmocka_unit_test(test_throughput), cmocka_unit_test(test_activity),
                                       cmocka_unit_test(test_rows),       cmocka_unit_test(test_chance),
                                       cmocka_unit_test(test_start),      cmocka_unit_test(test_overflow),
                                       cmocka_unit_test(test_idle),       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
