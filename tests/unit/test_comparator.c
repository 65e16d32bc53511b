/* The comparator: closed forms over many steps, events at a step's ends, and failures that change nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "sensor/td_sensor.h"
#include "sensor/td_between.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS_MAX = 300 };

/* A tile and all that belongs to it. */
typedef struct rig {
    td_sensor sensor;
    td_tile tile;
    double S0[PIXELS_MAX], S0_dot[PIXELS_MAX], S1[PIXELS_MAX], S1_dot[PIXELS_MAX];
    td_work work;
    tides_error error;
} rig;

static rig *new_rig(int32_t model, double on, double off, td_tile tile) {
    rig *r = td_alloc(1, sizeof *r, NULL);
    assert_non_null(r);
    tides_sensor sensor;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = on;
    sensor.threshold_off = off;
    r->tile = tile;
    assert_int_equal(td_sensor_create(&sensor, model, 1e-3, 0, &(const td_sensor_tiles){&tile, 1, tile.x0 + tile.width},
                                      &r->sensor, NULL),
                     TIDES_OK);
    assert_false(r->sensor.on);
    return r;
}

static void free_rig(rig *r) {
    td_sensor_release(&r->sensor);
    free(r->work.events.events);
    free(r);
}

static void reset(rig *r) { td_sensor_begin(&r->sensor, r->S0, NULL); }

static tides_status advance(rig *r, const td_step *step) {
    td_signals signals = {r->S0, r->S0_dot, r->S1, r->S1_dot};
    return td_sensor_step(&r->sensor, step, &r->tile, 0, &(td_seen){.signals = &signals}, &r->work, &r->error);
}

static td_step step_between(double start, double stop) {
    td_step step;
    assert_int_equal(td_step_between(start, stop, &step, NULL), TIDES_OK);
    return step;
}

static void assert_invariant(const rig *r) {
    for (int i = 0; i < r->tile.count; i++) {
        double residual = r->S1[i] - r->sensor.pixels.reference[i];
        assert_true(residual < r->sensor.sensor.threshold_on);
        assert_true(residual > -r->sensor.sensor.threshold_off);
    }
}

static const td_tile ONE = {0, 0, 1, 1};

/* A rig of one pixel, already reset to S0, with the signals of its step. */
static rig *one_pixel(int32_t model, double S0, double S0_dot, double S1, double S1_dot) {
    rig *r = new_rig(model, 0.2, 0.2, ONE);
    r->S0[0] = S0;
    r->S0_dot[0] = S0_dot;
    r->S1[0] = S1;
    r->S1_dot[0] = S1_dot;
    reset(r);
    return r;
}

static void assert_event(const rig *r, size_t index, int64_t t, int polarity) {
    assert_true(index < r->work.events.count);
    assert_int_equal(r->work.events.events[index].t, t);
    assert_int_equal(r->work.events.events[index].polarity, polarity);
}

/* -- closed forms ---------------------------------------------------------------------------------------------------------- */

/* S = 3.7 t from 1000 s on, 2 s in steps of 1 ms: event k at 1000 + k C / 3.7, by every model. */
static void ramps_at_a_thousand_seconds(void **state) {
    (void)state;
    const double slope = 3.7, on = 0.02, origin = 1000.0;
    for (int32_t model = TIDES_MODEL_LINEAR; model <= TIDES_MODEL_SECANT; model++) {
        rig *r = new_rig(model, on, 0.5, ONE);
        r->S0[0] = -4.0;
        r->S0_dot[0] = r->S1_dot[0] = slope;
        reset(r);
        for (int k = 0; k < 2000; k++) {
            td_step step = step_between(origin + k * 1e-3, origin + (k + 1) * 1e-3);
            r->S0[0] = -4.0 + slope * (k * 1e-3);
            r->S1[0] = -4.0 + slope * ((k + 1) * 1e-3);
            assert_int_equal(advance(r, &step), TIDES_OK);
            assert_invariant(r);
        }
        assert_in_range(r->work.events.count, 369, 370); /* 2 x 3.7 / 0.02 = 370: the last is at the very end */
        for (size_t k = 0; k < r->work.events.count; k++) {
            double exact = 1e12 + 1e9 * on * (double)(k + 1) / slope;
            assert_int_equal(r->work.events.events[k].polarity, 1);
            assert_true(fabs((double)r->work.events.events[k].t + 0.5 - exact) <=
                        1.0); /* floored: within half a ns, and rounding */
        }
        free_rig(r);
    }
}

/* S = sin(w t) by steps of a 200th of a period: the cubic is good to h^4 / 384 = 2.5e-9, so times to 2.5e-9 / slope. */
static void sinusoids_against_arcsines(void **state) {
    (void)state;
    const double pi = acos(-1.0), w = 2.0 * pi * 50.0, h = 1e-4, on = 0.11, off = 0.07;
    rig *r = new_rig(TIDES_MODEL_HERMITE, on, off, ONE);
    reset(r);
    for (int k = 0; k < 2000; k++) {
        td_step step = step_between(k * h, (k + 1) * h);
        r->S0[0] = sin(w * (k * h));
        r->S1[0] = sin(w * ((k + 1) * h));
        r->S0_dot[0] = w * cos(w * (k * h));
        r->S1_dot[0] = w * cos(w * ((k + 1) * h));
        assert_int_equal(advance(r, &step), TIDES_OK);
        assert_invariant(r);
    }
    /* Truth: the same comparator on the exact curve. Between turning points the next level's time is an arcsine. */
    double reference = 0.0;
    size_t index = 0;
    for (int half = 0; half <= 20; half++) { /* rising to the quarter period, then 19 half periods, then the rest */
        double sign = half % 2 ? -1.0 : 1.0, step = sign > 0.0 ? on : -off, end = half < 20 ? sign : 0.0;
        for (; sign * (end - (reference + step)) >= 0.0; index++) {
            reference += step;
            double t = (half * pi + sign * asin(reference)) / w, slope = w * sqrt(1.0 - reference * reference);
            assert_true(index < r->work.events.count);
            assert_int_equal(r->work.events.events[index].polarity, sign > 0.0 ? 1 : -1);
            assert_true(fabs((double)r->work.events.events[index].t + 0.5 - 1e9 * t) <= 1.0 + 1e9 * 4e-9 / slope);
        }
    }
    assert_in_range(r->work.events.count, index, index + 1); /* one more may fire at the last instant, S = 0 */
    assert_int_equal(r->work.counts.caught_up, 0);
    free_rig(r);
}

/* Very short and very long steps only stretch time. */
static void any_length_of_step(void **state) {
    (void)state;
    double h = 1e-11;
    for (int decade = -11; decade <= 5; decade += 4, h *= 1e4) {
        rig *r = one_pixel(TIDES_MODEL_HERMITE, 0.0, 1.1 / h, 1.1, 1.1 / h);
        td_step step = step_between(0.0, h);
        assert_int_equal(advance(r, &step), TIDES_OK);
        assert_int_equal(r->work.events.count, 5);
        for (int k = 0; k < 5; k++) {
            double exact = 1e9 * h * 0.2 * (k + 1) / 1.1;
            assert_true(fabs((double)r->work.events.events[k].t + 0.5 - exact) <= 0.51 + 1e-15 * exact);
        }
        assert_invariant(r);
        free_rig(r);
    }
}

static void a_signal_at_rest_fires_nothing(void **state) {
    (void)state;
    for (int32_t model = TIDES_MODEL_LINEAR; model <= TIDES_MODEL_SECANT; model++) {
        rig *r = one_pixel(model, -2.0, 0.0, -2.0, 0.0);
        for (int k = 0; k < 100; k++) {
            td_step step = step_between(k * 1e-3, (k + 1) * 1e-3);
            assert_int_equal(advance(r, &step), TIDES_OK);
        }
        assert_int_equal(r->work.events.count, 0);
        assert_int_equal(r->work.counts.solved, 0);
        free_rig(r);
    }
}

/* -- ends of steps --------------------------------------------------------------------------------------------------------- */

/* S reaches the level exactly at 1 ms and rises on: once, at 1000000 ns, in the first step. */
static void a_crossing_between_two_steps_fires_once(void **state) {
    (void)state;
    for (int32_t model = TIDES_MODEL_LINEAR; model <= TIDES_MODEL_SECANT; model++) {
        rig *r = one_pixel(model, 0.0, 250.0, 0.25, 250.0);
        r->sensor.sensor.threshold_on = 0.25;
        td_step first = step_between(0.0, 1e-3), second = step_between(1e-3, 2e-3);
        assert_int_equal(advance(r, &first), TIDES_OK);
        assert_int_equal(r->work.events.count, 1);
        assert_event(r, 0, 1000000, 1);
        r->S0[0] = 0.25;
        r->S1[0] = 0.375;
        r->S0_dot[0] = r->S1_dot[0] = 125.0;
        assert_int_equal(advance(r, &second), TIDES_OK);
        assert_int_equal(r->work.events.count, 1);
        free_rig(r);
    }
}

/* The linear model predicts three ON events; S1 says that nothing happened: they are taken back at the end. */
static void what_the_end_denies_is_taken_back(void **state) {
    (void)state;
    rig *r = one_pixel(TIDES_MODEL_LINEAR, 0.0, 640.0, 0.0, -640.0); /* 0.2 at 312500 ns */
    td_step step = step_between(0.0, 1e-3);
    assert_int_equal(advance(r, &step), TIDES_OK);
    assert_int_equal(r->work.events.count, 6);
    for (int k = 0; k < 3; k++) {
        assert_in_range(r->work.events.events[k].t, 312500 * (k + 1) - 1, 312500 * (k + 1));
        assert_event(r, k, r->work.events.events[k].t, 1);
        assert_event(r, k + 3, 1000000, -1);
    }
    assert_int_equal(r->work.counts.caught_up, 3);
    assert_int_equal(r->work.counts.truncated, 0);
    assert_true(r->sensor.pixels.reference[0] == 0.0);
    free_rig(r);
}

/* An overshoot of less than a threshold stays: S is within (-C-, C+) of the new reference. */
static void a_small_overshoot_stands(void **state) {
    (void)state;
    rig *r = one_pixel(TIDES_MODEL_LINEAR, 0.0, 210.0, 0.15, 0.0);
    td_step step = step_between(0.0, 1e-3);
    assert_int_equal(advance(r, &step), TIDES_OK);
    assert_int_equal(r->work.events.count, 1);
    assert_int_equal(r->work.counts.caught_up, 0);
    assert_invariant(r);
    free_rig(r);
}

/* The linear model sees nothing; S1 is three thresholds up: three events at the end. The paper's literal rule would lose
 * them. */
static void what_the_model_missed_is_caught_up(void **state) {
    (void)state;
    rig *r = one_pixel(TIDES_MODEL_LINEAR, 0.0, 0.0, 0.65, 0.0);
    td_step step = step_between(0.0, 1e-3);
    assert_int_equal(advance(r, &step), TIDES_OK);
    assert_int_equal(r->work.events.count, 3);
    for (size_t k = 0; k < 3; k++) assert_event(r, k, 1000000, 1);
    assert_int_equal(r->work.counts.caught_up, 3);
    free_rig(r);
}

/* Equality fires in catching up too, for both polarities. */
static void an_end_on_a_level_is_caught_up(void **state) {
    (void)state;
    td_step step = step_between(0.0, 1e-3);
    for (int polarity = -1; polarity <= 1; polarity += 2) {
        rig *r = one_pixel(TIDES_MODEL_LINEAR, 0.0, 0.0, 0.5 * polarity, 0.0);
        r->sensor.sensor.threshold_on = r->sensor.sensor.threshold_off = 0.25;
        assert_int_equal(advance(r, &step), TIDES_OK);
        assert_int_equal(r->work.events.count, 2);
        assert_event(r, 1, 1000000, polarity);
        assert_true(r->sensor.pixels.reference[0] == 0.5 * polarity);
        free_rig(r);
    }
}

/* A hump within the step whose ends are equal: invisible to the secant, an ON and an OFF to the cubic. */
static void an_excursion_within_a_step_is_seen(void **state) {
    (void)state;
    rig *cubic = one_pixel(TIDES_MODEL_HERMITE, 0.0, 1000.0, 0.0, -1000.0); /* 1000 t (1 - t / h): peak 0.25 */
    rig *secant = one_pixel(TIDES_MODEL_SECANT, 0.0, 1000.0, 0.0, -1000.0);
    td_step step = step_between(0.0, 1e-3);
    assert_int_equal(advance(cubic, &step), TIDES_OK);
    assert_int_equal(advance(secant, &step), TIDES_OK);
    assert_int_equal(secant->work.events.count, 0);
    assert_int_equal(cubic->work.events.count, 2);
    double s = 0.5 - sqrt(0.05); /* s - s^2 = 0.2 */
    assert_true(fabs((double)cubic->work.events.events[0].t + 0.5 - 1e6 * s) <= 0.51);
    assert_event(cubic, 1, 1000000, -1); /* back at 0 = 0.2 - C-, which is reached exactly at the end */
    free_rig(cubic);
    free_rig(secant);
}

/* -- many events ----------------------------------------------------------------------------------------------------------- */

static void a_jump_of_a_thousand_thresholds(void **state) {
    (void)state;
    for (int32_t model = TIDES_MODEL_LINEAR; model <= TIDES_MODEL_SECANT; model++) {
        for (int whole = 0; whole < 2; whole++) {
            rig *r = one_pixel(model, 0.0, 250.125 / 1e-3, 250.125, 250.125 / 1e-3);
            r->sensor.sensor.threshold_on = 0.25;
            r->sensor.sensor.max_events_per_step = whole ? 1000 : 64;
            td_step step = step_between(0.0, 1e-3);
            assert_int_equal(advance(r, &step), TIDES_OK);
            assert_int_equal(r->work.events.count, 1000);
            assert_int_equal(r->work.counts.truncated, whole ? 0 : 936);
            assert_int_equal(r->work.counts.caught_up, 0);
            for (size_t k = 0; k < 1000; k++) {
                double exact = whole || k < 64 ? 1e6 * 0.25 * (double)(k + 1) / 250.125 : 1e6;
                assert_true(fabs((double)r->work.events.events[k].t + 0.5 - exact) <= 0.51);
            }
            assert_invariant(r);
            free_rig(r);
        }
    }
}

/* Cut off in mid-flight, with the signal on its way back by the end: only what is left of it is caught up. */
static void a_cut_excursion_cancels(void **state) {
    (void)state;
    rig *r = one_pixel(TIDES_MODEL_HERMITE, 0.0, 40000.0, 0.0, -40000.0); /* peak 10 = 50 C */
    r->sensor.sensor.max_events_per_step = 5;
    td_step step = step_between(0.0, 1e-3);
    assert_int_equal(advance(r, &step), TIDES_OK);
    assert_int_equal(r->work.events.count, 10);
    for (size_t k = 0; k < 5; k++) assert_event(r, k, r->work.events.events[k].t, 1);
    for (size_t k = 5; k < 10; k++) assert_event(r, k, 1000000, -1);
    assert_int_equal(r->work.counts.truncated, 5);
    assert_invariant(r);
    free_rig(r);
}

/* The limit met exactly is no truncation. */
static void the_last_allowed_event_is_not_truncated(void **state) {
    (void)state;
    rig *r = one_pixel(TIDES_MODEL_HERMITE, 0.0, 700.0, 0.7, 700.0);
    r->sensor.sensor.max_events_per_step = 3;
    td_step step = step_between(0.0, 1e-3);
    assert_int_equal(advance(r, &step), TIDES_OK);
    assert_int_equal(r->work.events.count, 3);
    assert_int_equal(r->work.counts.truncated + r->work.counts.caught_up, 0);
    free_rig(r);
}

/* -- bad signals ----------------------------------------------------------------------------------------------------------- */

static void signals_that_are_no_numbers_fire_nothing(void **state) {
    (void)state;
    static const double odd[] = {NAN, INFINITY, -INFINITY};
    td_step step = step_between(0.0, 1e-3);
    for (int32_t model = TIDES_MODEL_LINEAR; model <= TIDES_MODEL_SECANT; model++) {
        for (int k = 0; k < 6; k++) {
            rig *r = one_pixel(model, 0.0, 0.0, 0.0, 0.0);
            *(k < 3 ? &r->S0[0] : &r->S1[0]) = odd[k % 3];
            assert_int_equal(advance(r, &step), TIDES_OK);
            assert_int_equal(r->work.events.count, 0);
            assert_int_equal(r->work.counts.nonfinite, 1);
            assert_true(r->sensor.pixels.reference[0] == 0.0);
            free_rig(r);
        }
    }
    for (int k = 0; k < 3; k++) { /* reset to no number: silent, and counted each time */
        rig *r = one_pixel(TIDES_MODEL_HERMITE, odd[k], 0.0, 0.0, 0.0);
        r->S0[0] = 1.0;
        assert_int_equal(advance(r, &step), TIDES_OK);
        assert_int_equal(r->work.events.count, 0);
        assert_int_equal(r->work.counts.nonfinite, 1);
        free_rig(r);
    }
    /* After NaN: caught up at the end of a step whose start is NaN; or at the start of one whose start is finite again. */
    rig *ends = one_pixel(TIDES_MODEL_HERMITE, 0.0, 0.0, 0.5, 0.0),
        *starts = one_pixel(TIDES_MODEL_HERMITE, 0.0, 0.0, 0.5, 0.0);
    ends->S0[0] = NAN;
    starts->S0[0] = 0.5;
    assert_int_equal(advance(ends, &step), TIDES_OK);
    assert_int_equal(advance(starts, &step), TIDES_OK);
    for (size_t k = 0; k < 2; k++) {
        assert_event(ends, k, 1000000, 1);
        assert_event(starts, k, 0, 1);
    }
    assert_int_equal(ends->work.counts.caught_up, 2);
    assert_int_equal(starts->work.counts.caught_up, 2);
    free_rig(ends);
    free_rig(starts);
}

/* One pixel of a tile asks for 5e8 events: an error that names it, and the tile is as it was. */
static void too_many_events_leave_no_trace(void **state) {
    (void)state;
    rig *r = new_rig(TIDES_MODEL_HERMITE, 0.2, 0.2, (td_tile){32, 48, 16, 256});
    reset(r);
    td_step step = step_between(0.0, 1e-3);
    for (int i = 0; i < 256; i++) r->S1[i] = i % 2 ? 1.0 : -1.0;
    assert_int_equal(advance(r, &step), TIDES_OK);
    for (int i = 0; i < 256; i++) {
        r->S0[i] = r->S1[i];
        r->S1[i] = r->S0[i] > 0.0 ? -3.0 : 0.5;
    }
    r->S1[16 * 6 + 5] = 1e8;
    const size_t events = r->work.events.count;
    const td_sensor_counts counts = r->work.counts;
    double reference[256];
    uint32_t on[256], off[256];
    memcpy(reference, r->sensor.pixels.reference, sizeof reference);
    memcpy(on, r->sensor.pixels.count_on, sizeof on);
    memcpy(off, r->sensor.pixels.count_off, sizeof off);
    assert_int_equal(advance(r, &step), TIDES_OUT_OF_RANGE);
    assert_non_null(strstr(r->error.text, "(37, 54)"));
    assert_memory_equal(r->sensor.pixels.reference, reference, sizeof reference);
    assert_memory_equal(r->sensor.pixels.count_on, on, sizeof on);
    assert_memory_equal(r->sensor.pixels.count_off, off, sizeof off);
    assert_memory_equal(&r->work.counts, &counts, sizeof counts);
    assert_int_equal(r->work.events.count, events);
    r->S1[16 * 6 + 5] = 0.5; /* mended, it goes on */
    assert_int_equal(advance(r, &step), TIDES_OK);
    assert_invariant(r);
    free_rig(r);
}

static void parameters_are_checked(void **state) {
    (void)state;
    const int32_t cubic = TIDES_MODEL_HERMITE;
    const tides_sensor good = {.threshold_on = 0.2, .threshold_off = 0.3, .max_events_per_step = 1};
    static const double bad[] = {0.0, -1.0, NAN, INFINITY};
    tides_error error;
    assert_int_equal(td_sensor_check_levels(&good, cubic, &error), TIDES_OK);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        tides_sensor on = good, off = good;
        on.threshold_on = bad[i];
        off.threshold_off = bad[i];
        assert_int_equal(td_sensor_check_levels(&on, cubic, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "threshold_on"));
        assert_int_equal(td_sensor_check_levels(&off, cubic, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "threshold_off"));
    }
    tides_sensor most = good;
    most.max_events_per_step = 0;
    assert_int_equal(td_sensor_check_levels(&good, 4, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(td_sensor_check_levels(&most, cubic, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(td_sensor_check_levels(&most, cubic, NULL), TIDES_BAD_ARGUMENT);
}

/* -- tiles ----------------------------------------------------------------------------------------------------------------- */

/* Every pixel of an odd tile fires once, in its own place; the counts and the reference agree. */
static void pixels_have_their_places(void **state) {
    (void)state;
    static const td_tile tiles[] = {{0, 0, 16, 256}, {320, 256, 13, 52}, {65533, 65534, 2, 4}, {7, 9, 1, 65}};
    for (size_t k = 0; k < sizeof tiles / sizeof *tiles; k++) {
        rig *r = new_rig(TIDES_MODEL_SECANT, 0.2, 0.1, tiles[k]);
        reset(r);
        for (int i = 0; i < tiles[k].count; i++) r->S1[i] = i % 2 ? 0.3 : -0.15;
        td_step step = step_between(0.0, 1e-3);
        assert_int_equal(advance(r, &step), TIDES_OK);
        assert_int_equal(r->work.events.count, tiles[k].count);
        for (int i = 0; i < tiles[k].count; i++) {
            const tides_event *event = &r->work.events.events[i];
            assert_int_equal(event->x, tiles[k].x0 + i % tiles[k].width);
            assert_int_equal(event->y, tiles[k].y0 + i / tiles[k].width);
            assert_int_equal(event->polarity, i % 2 ? 1 : -1);
            assert_int_equal(event->cause | event->frontend, 0);
            assert_int_equal(r->sensor.pixels.count_on[i], i % 2);
            assert_int_equal(r->sensor.pixels.count_off[i], 1 - i % 2);
            assert_true(r->sensor.pixels.reference[i] == (i % 2 ? 0.2 : -0.1));
        }
        assert_int_equal(r->work.counts.events_on, tiles[k].count / 2);
        assert_int_equal(r->work.counts.events_off, (tiles[k].count + 1) / 2);
        free_rig(r);
    }
}

static void the_worst_residual_is_relative(void **state) {
    (void)state;
    rig *r = new_rig(TIDES_MODEL_SECANT, 0.4, 0.1, (td_tile){0, 0, 4, 4});
    reset(r);
    const double up[4] = {0.1, 0.2, NAN, 0.0}, down[4] = {0.1, -0.08, NAN, 0.0};
    assert_true(td_sensor_worst_residual(&r->sensor, up, NULL, 0) == 0.5);
    assert_true(td_sensor_worst_residual(&r->sensor, down, NULL, 0) == 0.08 / 0.1);
    free_rig(r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ramps_at_a_thousand_seconds),
        cmocka_unit_test(sinusoids_against_arcsines),
        cmocka_unit_test(any_length_of_step),
        cmocka_unit_test(a_signal_at_rest_fires_nothing),
        cmocka_unit_test(a_crossing_between_two_steps_fires_once),
        cmocka_unit_test(what_the_end_denies_is_taken_back),
        cmocka_unit_test(a_small_overshoot_stands),
        cmocka_unit_test(what_the_model_missed_is_caught_up),
        cmocka_unit_test(an_end_on_a_level_is_caught_up),
        cmocka_unit_test(an_excursion_within_a_step_is_seen),
        cmocka_unit_test(a_jump_of_a_thousand_thresholds),
        cmocka_unit_test(a_cut_excursion_cancels),
        cmocka_unit_test(the_last_allowed_event_is_not_truncated),
        cmocka_unit_test(signals_that_are_no_numbers_fire_nothing),
        cmocka_unit_test(too_many_events_leave_no_trace),
        cmocka_unit_test(parameters_are_checked),
        cmocka_unit_test(pixels_have_their_places),
        cmocka_unit_test(the_worst_residual_is_relative),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
