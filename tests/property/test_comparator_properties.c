/* What must hold of the comparator for any signals: random cubics against dense sampling, steps cut in pieces, the invariant
 * after every step, whole tiles against solving every pixel, and against pixels by themselves. The seed is printed;
 * TIDES_TEST_SEED sets it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/td_sensor.h"
#include "sensor/td_between.h"
#include "sensor/td_single.h"
#include "signal/td_crossing.h"
#include "td_base.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS = 256 };

typedef struct rig {
    td_sensor sensor;
    double S0[PIXELS], S0_dot[PIXELS], S1[PIXELS], S1_dot[PIXELS];
    td_work work;
} rig;

/* -- random input -------------------------------------------------------------------------------------------------------- */

static uint64_t random_state;

static uint64_t next_random(void) { /* xorshift64*: Vigna 2016 */
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return random_state * 2685821657736338717ULL;
}

static double uniform(double low, double high) { return low + (high - low) * ((double)(next_random() >> 11) * 0x1p-53); }

/* Sizes from far below a threshold to many of them. */
static double any_size(double typical) {
    double sign = next_random() >> 63 ? 1.0 : -1.0;
    return sign * typical * pow(10.0, uniform(-3.0, 1.3));
}

static void seed_tests(uint64_t salt) {
    const char *text = getenv("TIDES_TEST_SEED");
    uint64_t seed = text ? strtoull(text, NULL, 10) : 20240611;
    print_message("seed %" PRIu64 "\n", seed);
    random_state = (seed ^ salt) * 0x9E3779B97F4A7C15ULL | 1;
}

/* -- the rig ------------------------------------------------------------------------------------------------------------- */

static rig *new_rig(int32_t model, double on, double off) {
    rig *r = td_alloc(1, sizeof *r, NULL);
    assert_non_null(r);
    const td_tile tile = {0, 0, 16, PIXELS};
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = on;
    sensor.threshold_off = off;
    sensor.max_events_per_step = 1000;
    assert_int_equal(td_sensor_create(&sensor, model, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, 16}, &r->sensor, NULL),
                     TIDES_OK);
    return r;
}

static void free_rig(rig *r) {
    td_sensor_release(&r->sensor);
    free(r->work.events.events);
    free(r);
}

static void reset(rig *r) {
    td_sensor_begin(&r->sensor, r->S0, NULL);
    r->work.events.count = 0;
    memset(&r->work.counts, 0, sizeof r->work.counts);
}

static void advance(rig *r, int32_t count, double start, double stop) {
    td_tile tile = {0, 0, 16, count};
    td_signals signals = {r->S0, r->S0_dot, r->S1, r->S1_dot};
    td_step step;
    tides_error error = {0, ""};
    if (td_step_between(start, stop, &step, &error) != TIDES_OK ||
        td_sensor_step(&r->sensor, &step, &tile, 0, &(td_seen){.signals = &signals}, &r->work, &error) != TIDES_OK)
        fail_msg("%s", error.text);
}

static void assert_invariant(const rig *r, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        double residual = r->S1[i] - r->sensor.pixels.reference[i];
        assert_true(residual < r->sensor.sensor.threshold_on);
        assert_true(residual > -r->sensor.sensor.threshold_off);
        assert_true(r->sensor.pixels.reference[i] ==
                    td_reference_at(r->sensor.sensor.threshold_on, r->sensor.sensor.threshold_off, r->sensor.pixels.initial[i],
                                    r->sensor.pixels.count_on[i], r->sensor.pixels.count_off[i]));
    }
}

/* -- the oracle ---------------------------------------------------------------------------------------------------------- */

/* a0 + a1 s + a2 s^2 + a3 s^3, in powers: another form than the solver's, evaluated in long double. */
typedef struct power {
    long double a[4];
} power;

static long double power_value(const power *p, long double s) { return p->a[0] + s * (p->a[1] + s * (p->a[2] + s * p->a[3])); }
static double power_slope(const power *p, double s) { return (double)(p->a[1] + s * (2.0L * p->a[2] + s * 3.0L * p->a[3])); }

static power hermite_power(double S0, double rate0, double S1, double rate1) {
    long double change = (long double)S1 - S0;
    return (power){{S0, rate0, 3.0L * change - 2.0L * rate0 - rate1, (long double)rate0 + rate1 - 2.0L * change}};
}

typedef struct oracle_event {
    double s; /* the first sample at which it had happened */
    int polarity;
} oracle_event;

enum { ORACLE_SAMPLES = 4000, ORACLE_MAX = 4000 };

/* The highest (sign > 0) or lowest place in [low, high], by golden section. */
static double find_extremum(const power *p, double low, double high, double sign) {
    const double golden = 0.61803398874989485;
    for (int i = 0; i < 60; i++) {
        double a = high - golden * (high - low), b = low + golden * (high - low);
        if (sign * (double)(power_value(p, a) - power_value(p, b)) > 0.0)
            high = b;
        else
            low = a;
    }
    return 0.5 * (low + high);
}

static int oracle_visit(long double value, double s, double on, double off, double *reference, oracle_event *events,
                        int count) {
    while (count < ORACLE_MAX && (value - *reference >= on || value - *reference <= -off)) {
        int polarity = value - *reference >= on ? 1 : -1;
        *reference += polarity > 0 ? on : -off;
        events[count++] = (oracle_event){s, polarity};
    }
    return count;
}

/* A comparator that looks at 4000 samples in turn, and at the extremum wherever three samples show one. */
static int run_oracle(const power *p, double on, double off, oracle_event *events) {
    double reference = (double)p->a[0];
    int count = 0;
    for (int k = 1; k <= ORACLE_SAMPLES; k++) {
        double width = 1.0 / ORACLE_SAMPLES, s = k * width;
        long double before = power_value(p, s - width), here = power_value(p, s), after = power_value(p, s + width);
        long double earlier = power_value(p, s - 2.0 * width);
        for (int look = 0; look < 2; look++) { /* an extremum in this interval shows in one of the triples about it */
            long double left = look ? before : earlier, middle = look ? here : before, right = look ? after : here;
            double sign = middle > left && middle >= right ? 1.0 : middle < left && middle <= right ? -1.0 : 0.0;
            double from = look ? s - width : s - 2.0 * width, peak;
            if (sign == 0.0) continue;
            peak = find_extremum(p, from, from + 2.0 * width, sign);
            if (peak > s - width && peak <= s)
                count = oracle_visit(power_value(p, peak), peak, on, off, &reference, events, count);
        }
        count = oracle_visit(here, s, on, off, &reference, events, count);
    }
    return count;
}

/* -- properties ---------------------------------------------------------------------------------------------------------- */

/* The cubic's events are those of a comparator that samples the same polynomial densely: the same polarities in the same order,
 * each no later than the sample that shows it and no more than an interval before. */
static void events_equal_dense_sampling(void **state) {
    (void)state;
    seed_tests(1);
    static oracle_event expected[ORACLE_MAX];
    for (int trial = 0; trial < 600; trial++) {
        double on = uniform(0.05, 0.5), off = uniform(0.05, 0.5);
        rig *r = new_rig(TIDES_MODEL_HERMITE, on, off);
        r->S0[0] = uniform(-5.0, 1.0);
        r->S1[0] = r->S0[0] + any_size(0.3);
        r->S0_dot[0] = any_size(1.0);
        r->S1_dot[0] = any_size(1.0);
        reset(r);
        advance(r, 1, 0.0, 1.0);
        power p = hermite_power(r->S0[0], r->S0_dot[0], r->S1[0], r->S1_dot[0]);
        int count = run_oracle(&p, on, off, expected);
        if ((size_t)count != r->work.events.count) fail_msg("trial %d: %zu events, not %d", trial, r->work.events.count, count);
        for (int k = 0; k < count; k++) {
            double s = 1e-9 * (double)r->work.events.events[k].t;
            assert_int_equal(r->work.events.events[k].polarity, expected[k].polarity);
            assert_true(s <= expected[k].s + 1e-12);
            assert_true(s >= expected[k].s - 1.0 / ORACLE_SAMPLES - 2e-9);
        }
        assert_int_equal(r->work.counts.caught_up + r->work.counts.truncated, 0);
        assert_invariant(r, 1);
        free_rig(r);
    }
}

/* Each crossing lies where the polynomial has its level, to rounding. */
static void crossings_lie_on_their_levels(void **state) {
    (void)state;
    seed_tests(2);
    for (int trial = 0; trial < 20000; trial++) {
        double on = uniform(0.05, 0.5), off = uniform(0.05, 0.5), reference = uniform(-5.0, 1.0);
        double S0 = reference, S1 = reference + any_size(0.3), rate0 = any_size(1.0), rate1 = any_size(1.0);
        power p = hermite_power(S0, rate0, S1, rate1);
        td_model model = td_model_fit(TIDES_MODEL_HERMITE, 1.0, S0, rate0, S1, rate1);
        td_crossing_walk walk;
        td_crossing_begin(&walk, &model, NULL);
        double before = 0.0, size = fabs(S0) + fabs(S1 - S0) + fabs(rate0) + fabs(rate1);
        int polarity;
        while ((polarity = td_crossing_next(&walk, reference, on, off)) != 0) {
            reference += polarity > 0 ? on : -off;
            double error = fabs((double)(power_value(&p, walk.s) - reference)), slope = fabs(power_slope(&p, walk.s));
            if (!(error <= 4e-16 * (4.0 * size + slope)))
                fail_msg("trial %d: %g off the level at s = %.17g", trial, error, walk.s);
            assert_true(walk.s >= before);
            assert_true(walk.s <= 1.0);
            before = walk.s;
        }
    }
}

/* A walk that is told its step stops at places of the same nanoseconds as one that is not, and is spared most places. */
static void times_of_crossings_are_those_of_their_places(void **state) {
    (void)state;
    seed_tests(5);
    int near[2] = {0, 0}, crossings[2] = {0, 0};
    for (int trial = 0; trial < 150000; trial++) {
        double on = uniform(0.02, 0.5), off = uniform(0.02, 0.5), reference = uniform(-5.0, 1.0), S0 = reference;
        double S1 = S0 + any_size(0.3), rate0 = any_size(1.0), rate1 = any_size(1.0), length = exp(uniform(0.0, 21.0));
        td_step step = {0, (int64_t)length + 1, uniform(0.0, 1.0), length, length * 1e-9};
        td_model model = td_model_fit(TIDES_MODEL_HERMITE, 1.0, S0, rate0, S1, rate1);
        const int at_end = trial % 3 == 1;
        if (at_end) reference = (trial % 2 ? S0 : S1) - on + any_size(1e-6); /* at an end, as of a piece */
        td_crossing_walk timed, placed;
        td_crossing_begin(&timed, &model, &step);
        td_crossing_begin(&placed, &model, NULL);
        int polarity;
        while ((polarity = td_crossing_next(&placed, reference, on, off)) != 0) {
            assert_int_equal(td_crossing_next(&timed, reference, on, off), polarity);
            reference += polarity > 0 ? on : -off;
            int64_t t = td_step_time(&step, timed.s), expected = td_step_time(&step, placed.s);
            if (t != expected) fail_msg("trial %d: at %lld ns, not %lld", trial, (long long)t, (long long)expected);
            crossings[at_end]++;
            near[at_end] += timed.near > 0 && length > 1e4 && length < 1e7;
        }
        assert_int_equal(td_crossing_next(&timed, reference, on, off), 0);
        assert_true(timed.s == placed.s);
    }
    assert_true(crossings[0] > 100000 && crossings[1] > 50000);
    assert_true(near[0] > 0.3 * crossings[0]); /* a third of the steps are between 10 us and 10 ms */
    assert_true(near[1] > 0.2 * crossings[1]);
}

/* One cubic over a millisecond at 1000 s, in one step and in n: the same events, each within 2 ns. */
static void cutting_a_step_changes_nothing(void **state) {
    (void)state;
    seed_tests(3);
    for (int trial = 0; trial < 500; trial++) {
        double on = uniform(0.05, 0.5), off = uniform(0.05, 0.5), h = 1e-3, start = 1000.0;
        rig *whole = new_rig(TIDES_MODEL_HERMITE, on, off), *cut = new_rig(TIDES_MODEL_HERMITE, on, off);
        int pieces = 2 + (int)(next_random() % 20);
        double S0 = uniform(-5.0, 1.0), S1 = S0 + any_size(0.3), rate0 = any_size(1.0), rate1 = any_size(1.0);
        power p = hermite_power(S0, rate0, S1, rate1);
        whole->S0[0] = cut->S0[0] = S0;
        whole->S1[0] = S1;
        whole->S0_dot[0] = rate0 / h;
        whole->S1_dot[0] = rate1 / h;
        reset(whole);
        reset(cut);
        advance(whole, 1, start, start + h);
        for (int k = 0; k < pieces; k++) {
            double a = (double)k / pieces, b = (double)(k + 1) / pieces;
            cut->S0[0] = k ? cut->S1[0] : S0;
            cut->S1[0] = k + 1 < pieces ? (double)power_value(&p, b) : S1;
            cut->S0_dot[0] = power_slope(&p, a) / h;
            cut->S1_dot[0] = power_slope(&p, b) / h;
            advance(cut, 1, start + a * h, start + b * h);
            assert_invariant(cut, 1);
        }
        if (whole->work.events.count != cut->work.events.count)
            fail_msg("trial %d: %zu events in %d pieces, not %zu", trial, cut->work.events.count, pieces,
                     whole->work.events.count);
        for (size_t k = 0; k < cut->work.events.count; k++) {
            assert_int_equal(cut->work.events.events[k].polarity, whole->work.events.events[k].polarity);
            assert_in_range(cut->work.events.events[k].t - whole->work.events.events[k].t + 2, 0, 4);
        }
        assert_true(cut->sensor.pixels.reference[0] == whole->sensor.pixels.reference[0]);
        free_rig(whole);
        free_rig(cut);
    }
}

/* What any run must satisfy: checked pixel by pixel on the events of one step. */
static void assert_orderly(const rig *r, size_t first, int64_t start_ns, int64_t stop_ns) {
    int64_t last[PIXELS];
    for (int i = 0; i < PIXELS; i++) last[i] = start_ns;
    for (size_t k = first; k < r->work.events.count; k++) {
        const tides_event *event = &r->work.events.events[k];
        int i = event->y * 16 + event->x;
        assert_true(event->t >= last[i]);
        assert_true(event->t <= stop_ns);
        assert_true(event->polarity == 1 || event->polarity == -1);
        last[i] = event->t;
    }
}

/* Signals that jump, with rates that have nothing to do with them, by every model and with few events allowed per step. */
static void the_invariant_holds_after_every_step(void **state) {
    (void)state;
    seed_tests(4);
    for (int trial = 0; trial < 40; trial++) {
        rig *r = new_rig(trial % 4, uniform(0.01, 0.5), uniform(0.01, 0.5));
        r->sensor.sensor.max_events_per_step = 1 + (int32_t)(next_random() % 8);
        for (int i = 0; i < PIXELS; i++) r->S1[i] = r->S0[i] = uniform(-7.0, 1.0);
        reset(r);
        for (int k = 0; k < 30; k++) {
            for (int i = 0; i < PIXELS; i++) {
                r->S0[i] = r->S1[i];
                r->S1[i] = next_random() % 4 ? r->S0[i] + any_size(0.02) : uniform(-7.0, 1.0);
                r->S0_dot[i] = any_size(1e3);
                r->S1_dot[i] = any_size(1e3);
            }
            size_t first = r->work.events.count;
            advance(r, PIXELS, k * 1e-3, (k + 1) * 1e-3);
            assert_invariant(r, PIXELS);
            assert_orderly(r, first, k * 1000000LL, (k + 1) * 1000000LL);
        }
        uint64_t on = 0, off = 0;
        for (int i = 0; i < PIXELS; i++) {
            on += r->sensor.pixels.count_on[i];
            off += r->sensor.pixels.count_off[i];
        }
        assert_true(on == r->work.counts.events_on);
        assert_true(off == r->work.counts.events_off);
        assert_true(on + off == r->work.events.count);
        assert_true(r->work.counts.truncated > 0);
        free_rig(r);
    }
}

/* A value on the grid of C/4: control values and extrema then land exactly on levels all the time. */
static double on_grid(double step, int range) {
    return step * (double)((int)(next_random() % (uint64_t)(2 * range + 1)) - range);
}

/* Rejecting whole tiles never keeps a pixel from firing: events and state equal those of solving every pixel, to the bit, for
 * random signals and for signals that sit exactly on levels, and for NaN and infinities among them. */
static void rejection_changes_nothing(void **state) {
    (void)state;
    seed_tests(5);
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1e300};
    for (int trial = 0; trial < 400; trial++) {
        rig *fast = new_rig(trial % 4, 0.25, trial % 8 < 4 ? 0.25 : 0.5);
        int exact = trial % 3 == 0;
        fast->sensor.sensor.max_events_per_step = 16;
        for (int i = 0; i < PIXELS; i++) {
            double S0 = fast->S0[i] = exact ? on_grid(0.0625, 8) : uniform(-5.0, 1.0);
            fast->S1[i] = S0 + (exact ? on_grid(0.0625, 6) : any_size(0.05));
            fast->S0_dot[i] = exact ? on_grid(0.0625, 12) : any_size(0.1);
            fast->S1_dot[i] = exact ? on_grid(0.0625, 12) : any_size(0.1);
            double *where[] = {&fast->S0[i], &fast->S0_dot[i], &fast->S1_dot[i]};
            uint64_t which = next_random() % 3; /* from a reference of 1e300 it would fire for ever, and is refused */
            if (next_random() % 100 == 0) *where[which] = odd[next_random() % (which ? 4 : 3)];
        }
        reset(fast);
        rig *slow = new_rig(fast->sensor.model, fast->sensor.sensor.threshold_on, fast->sensor.sensor.threshold_off);
        slow->sensor.sensor.max_events_per_step = fast->sensor.sensor.max_events_per_step;
        slow->sensor.exhaustive = 1;
        memcpy(slow->S0, fast->S0, sizeof slow->S0);
        memcpy(slow->S0_dot, fast->S0_dot, sizeof slow->S0_dot);
        memcpy(slow->S1, fast->S1, sizeof slow->S1);
        memcpy(slow->S1_dot, fast->S1_dot, sizeof slow->S1_dot);
        reset(slow);
        advance(fast, PIXELS, 0.0, 1.0);
        advance(slow, PIXELS, 0.0, 1.0);
        assert_int_equal(fast->work.events.count, slow->work.events.count);
        if (fast->work.events.count)
            assert_memory_equal(fast->work.events.events, slow->work.events.events,
                                fast->work.events.count * sizeof *fast->work.events.events);
        assert_memory_equal(fast->sensor.pixels.reference, slow->sensor.pixels.reference,
                            PIXELS * sizeof *fast->sensor.pixels.reference);
        assert_memory_equal(fast->sensor.pixels.count_on, slow->sensor.pixels.count_on,
                            PIXELS * sizeof *fast->sensor.pixels.count_on);
        assert_memory_equal(fast->sensor.pixels.count_off, slow->sensor.pixels.count_off,
                            PIXELS * sizeof *fast->sensor.pixels.count_off);
        assert_int_equal(fast->work.counts.nonfinite, slow->work.counts.nonfinite);
        assert_int_equal(slow->work.counts.solved, PIXELS);
        assert_true(fast->work.counts.solved < PIXELS);
        free_rig(fast);
        free_rig(slow);
    }
}

/* With equal thresholds a pixel that comes back has the reference that it had there before, whatever happened meanwhile. */
static void references_do_not_drift(void **state) {
    (void)state;
    seed_tests(6);
    rig *r = new_rig(TIDES_MODEL_SECANT, 0.1, 0.1);
    r->sensor.sensor.max_events_per_step = 100;
    r->S1[0] = r->S0[0] = 0.3;
    reset(r);
    for (int k = 0; k < 20000; k++) {
        r->S0[0] = r->S1[0];
        r->S1[0] = k % 2 ? 0.3 : uniform(-2.0, 2.0);
        advance(r, 1, k * 1e-3, (k + 1) * 1e-3);
        int64_t net = (int64_t)r->sensor.pixels.count_on[0] - (int64_t)r->sensor.pixels.count_off[0];
        assert_true(r->sensor.pixels.reference[0] == 0.3 + (double)net * 0.1);
        if (k % 2) assert_in_range(net + 1, 0, 2); /* hysteresis: within one threshold of the level */
    }
    assert_true(r->work.events.count > 100000);
    free_rig(r);
}

/* A cubic of any kind between the signal where the step before ended, mostly, and any other. */
static void draw_step(rig *r, int32_t i) {
    const int odd = (int)uniform(0.0, 60.0);
    const double h = 1e-3, least = any_size(0.05);
    r->S0[i] = odd == 0 ? uniform(-5.0, 1.0) : r->S1[i];
    r->S1[i] = r->S0[i] + (odd < 30 ? any_size(0.1) : least);
    r->S0_dot[i] = odd % 3 ? (r->S1[i] - r->S0[i]) / h * uniform(0.5, 1.5) : any_size(0.3) / h;
    r->S1_dot[i] = odd % 3 ? (r->S1[i] - r->S0[i]) / h * uniform(0.5, 1.5) : any_size(0.3) / h;
    if (odd == 1) r->S0_dot[i] = NAN;
    if (odd == 2) r->S1_dot[i] = 1e5; /* more levels than are listed at once */
}

/* One pixel after the other, as the solver asks for them. */
static void advance_singly(rig *r, const td_step *step) {
    for (int32_t i = 0; i < PIXELS; i++) {
        const td_ends ends = {1e-3, r->S0[i], r->S0_dot[i], r->S1[i], r->S1_dot[i]};
        td_changes changes;
        const td_sensor_single single =
            {.step = step, .pixel = (size_t)i, .x = i % 16, .y = i / 16, .ends = &ends, .changes = &changes};
        assert_int_equal(td_sensor_advance(&r->sensor, &single, &r->work, NULL), TIDES_OK);
    }
}

/* Places of a tile's crossings are found together; events, counts and references are those of pixels by themselves. */
static void tiles_do_what_their_pixels_do(void **state) {
    (void)state;
    seed_tests(7);
    size_t events = 0;
    for (int trial = 0; trial < 300; trial++) {
        const double on = uniform(0.01, 0.2), off = trial % 2 ? on : uniform(0.01, 0.2), length = exp(uniform(0.0, 17.0));
        rig *together = new_rig(TIDES_MODEL_HERMITE, on, off), *apart = new_rig(TIDES_MODEL_HERMITE, on, off);
        for (int32_t i = 0; i < PIXELS; i++) together->S1[i] = together->S0[i] = apart->S0[i] = uniform(-5.0, 1.0);
        together->sensor.sensor.max_events_per_step = apart->sensor.sensor.max_events_per_step = trial % 3 ? 1000 : 4;
        together->sensor.exhaustive = trial % 5 == 0;
        reset(together);
        reset(apart);
        for (int k = 0; k < 4; k++) {
            const td_tile tile = {0, 0, 16, PIXELS};
            const td_signals signals = {together->S0, together->S0_dot, together->S1, together->S1_dot};
            const td_step step = {(int64_t)k << 30, ((int64_t)k << 30) + (int64_t)length + 1, uniform(0.0, 1.0), length, 1e-3};
            for (int32_t i = 0; i < PIXELS; i++) draw_step(together, i);
            for (int c = 0; c < 4; c++) {
                const double *const from[4] = {signals.S0, signals.S0_dot, signals.S1, signals.S1_dot};
                double *const to[4] = {apart->S0, apart->S0_dot, apart->S1, apart->S1_dot};
                memcpy(to[c], from[c], sizeof apart->S0);
            }
            assert_int_equal(td_sensor_step(&together->sensor, &step, &tile, 0, &(td_seen){.signals = &signals},
                                            &together->work, NULL),
                             TIDES_OK);
            advance_singly(apart, &step);
        }
        together->work.counts.solved = apart->work.counts.solved; /* singly, no pixel is passed over */
        assert_int_equal(together->work.events.count, apart->work.events.count);
        assert_memory_equal(together->work.events.events, apart->work.events.events,
                            apart->work.events.count * sizeof(tides_event));
        assert_memory_equal(&together->work.counts, &apart->work.counts, sizeof apart->work.counts);
        assert_memory_equal(together->sensor.pixels.reference, apart->sensor.pixels.reference, PIXELS * sizeof(double));
        assert_memory_equal(together->sensor.pixels.count_on, apart->sensor.pixels.count_on, PIXELS * sizeof(uint32_t));
        events += apart->work.events.count;
        free_rig(together);
        free_rig(apart);
    }
    assert_true(events > 500000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(events_equal_dense_sampling),
        cmocka_unit_test(crossings_lie_on_their_levels),
        cmocka_unit_test(times_of_crossings_are_those_of_their_places),
        cmocka_unit_test(cutting_a_step_changes_nothing),
        cmocka_unit_test(the_invariant_holds_after_every_step),
        cmocka_unit_test(rejection_changes_nothing),
        cmocka_unit_test(references_do_not_drift),
        cmocka_unit_test(tiles_do_what_their_pixels_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
