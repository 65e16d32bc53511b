/* The library's events against the oracle's: 20 small scenes of the hard kinds, by the criteria of `make check-lost`. The
 * oracle itself is tested first: its L equals the library's double reference's, and its events are those of four times as many
 * samples. Exact events are computed while the test runs.
 *
 * TIDES_SEED=N: the first scene's seed. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/oracle/trial.h"
#include "tests/oracle/worlds.h"

#include <stdlib.h>

enum { SCENES = 20, TIMES = 9, JOBS = 2, FINER = 4 };
#define SHARE 0.5
/* Largest effect of rounding on L in dark pixels. */
#define SAME_L 2e-12

static unsigned long long first_seed(void) {
    const char *text = getenv("TIDES_SEED");
    return text && *text ? strtoull(text, NULL, 10) : 1;
}

static void compare_images(int coded) {
    for (int kind = 0; kind < oracle_world_kinds(); kind++) {
        oracle_scene scene = oracle_world_make(kind, first_seed(), SHARE);
        library_difference d;
        scene.coded = coded;
        tides_error error;
        if (!library_compare_images(&scene, TIMES, &d, &error)) fail_msg("%s: %s", scene.kind, error.text);
        if (!(d.most < SAME_L)) fail_msg("%s: L off by %g at (%d, %d), %.9g s", scene.kind, d.most, d.x, d.y, d.time);
        oracle_scene_free(&scene);
    }
}

static void test_images(void **state) {
    (void)state;
    compare_images(0);
}

static void test_coded_images(void **state) {
    (void)state;
    compare_images(1);
}

static void run_all(const trial_options *options, int count) {
    trial_result results[SCENES];
    assert_int_equal(trial_run_all(options, -1, first_seed(), count, JOBS, results), count);
    assert_int_equal(trial_sum_up(options, results, count), 0);
}

static void test_oracle_is_sure(void **state) {
    trial_options options = trial_defaults();
    (void)state;
    options.finer = FINER;
    options.share = 0.5 * SHARE;
    run_all(&options, oracle_world_kinds());
}

/* Limits per million events: MOST_WRONG lost or false ones, MOST_UNCERTAIN uncertain ones, and UNCERTAIN_EACH more for each
 * wrong one. `make check-lost` holds them over 500 scenes. None of these scenes' 255 328 events is wrong; at commit 7d58106
 * they had 59 926 wrong events. */
#define MOST_WRONG 5
#define UNCERTAIN_EACH 20
#define MOST_UNCERTAIN 50

static void test_few_are_lost(void **state) {
    trial_options options = trial_defaults();
    trial_result results[SCENES];
    double events = 0, wrong = 0, uncertain = 0;
    (void)state;
    options.share = SHARE;
    assert_int_equal(trial_run_all(&options, -1, first_seed(), SCENES, JOBS, results), SCENES);
    for (int i = 0; i < SCENES; i++) {
        const verdict *v = &results[i].v;
        assert_int_equal(results[i].failed, 0);
        assert_int_equal(verdict_dishonest(v), 0);
        events += (double)v->events;
        wrong += (double)(v->lost + v->false_ones);
        uncertain += (double)v->uncertain;
    }
    print_message("%.0f events, %.0f lost or false, %.0f uncertain\n", events, wrong, uncertain);
    assert_true(events > 1e5);
    if (wrong > 1e-6 * MOST_WRONG * events) fail_msg("%.0f events are lost or false", wrong);
    assert_true(uncertain <= UNCERTAIN_EACH * wrong + 1e-6 * MOST_UNCERTAIN * events);
}

static trial_result run_one(const char *kind, unsigned long long seed, double share, int coded) {
    trial_options options = trial_defaults();
    trial_result result;
    const int number = oracle_world_named(kind);
    assert_true(number >= 0);
    options.share = share;
    options.coded = coded;
    assert_int_equal(trial_run_all(&options, number, seed, 1, 1, &result), 1);
    return result;
}

/* Scenes that failed once. Swaps within one body that a turning camera makes: one late event each, not counted as uncertain.
 * Many swaps in steps as short as min_step_s, in which no sample showed that a level was near: events 570 and 281 ns late,
 * with a reported p99 of 4 ns. Swaps of splats that keyframes move: a wrong pixel each, not counted. A cubic that passed a
 * level beyond a clamp of colour, where its tangents met beside its end (lamps 205). A swap that hid a turn after a look in
 * either half (spin 401), and a p99 that was too small (spin 211). A kink a little further than its tangents said (lights
 * 403). At srgb, a splat that fades over a brighter one: the signal passed a level by 0.003 thresholds, turned, and passed it
 * again, where the event was found 0.4 ms late (fade 301). An object that leaps: the oracle's samples missed a pair of events
 * of splats that pass a pixel within a microsecond (leap 704). In dark pixels, where a sample was off by 7e-5: an end of a
 * step, short of which a crossing was sought in vain (taper 404), and turns below a level (taper 1111). Swaps within a body,
 * and of keyframed splats, of 5 to 25 % of a step (stack 102, stops 1108). A taper of opacity that splats pass within 80 us
 * while they fade at the near plane (near 402). A swap that was sought beside its time, because a joint of keyframes was
 * between samples (stops 2003). A splat that swings between keyframes of one place (stops 1103). A kink in a piece that seemed
 * smooth, by 1.16 of what its probe saw (harmonics 1110); one after a look that found little by chance (near 1110); kinks 60
 * ns behind a look (lights 1113); a level touched 0.6 ms before a flat crossing (near 2002). Splines that swing between equal
 * frames, of which the oracle didn't know that they are calmed (stops 3005). Reported p99 that were too small: a slope that
 * was the model's alone (leap 402), and a sample of 512 events, all of them better than that (stack 1104). A swap within a
 * body of 5.03 % of a step, in a tile of more than 128 splats (crowd 4020). A record path with the clamp of a keyframed colour
 * between two of its nodes: 960 false events (lamp 20001). Kinks that a look took for smooth, and beyond what a cut saw (lights
 * 9002; 9014, 20002 and 30022). */
static void test_mended(void **state) {
    static const struct {
        const char *kind;
        unsigned long long seed;
        double share;
        size_t events;
        int coded;
    } scenes[] = {{"sweep", 6, SHARE, 1000, 0},     {"crowd", 3, SHARE, 1000, 0}, {"leap", 2, 0.25, 60, 0},
                  {"leap", 111, 0.25, 100, 0},      {"stops", 105, 0.25, 700, 0}, {"stops", 203, 0.3, 800, 0},
                  {"stops", 205, 0.3, 100, 0},      {"lamps", 205, 0.3, 1000, 0}, {"spin", 401, 1, 1000, 0},
                  {"spin", 211, 0.3, 30, 0},        {"lights", 403, 1, 1000, 0},  {"fade", 301, 0.3, 200, 1},
                  {"leap", 704, 1, 20000, 0},       {"taper", 404, 1, 90000, 0},  {"taper", 1111, 1, 90000, 0},
                  {"stack", 102, 0.25, 300, 0},     {"stops", 1108, 1, 7000, 0},  {"near", 402, 1, 70000, 0},
                  {"leap", 2012, 1, 17000, 0},      {"stops", 2003, 1, 3000, 0},  {"stops", 1103, 1, 4500, 0},
                  {"harmonics", 1110, 1, 11000, 0}, {"near", 1110, 1, 12000, 0},  {"lights", 1113, 1, 85000, 0},
                  {"near", 2002, 1, 9000, 0},       {"stops", 3005, 1, 4500, 0},  {"leap", 402, 0.3, 80, 0},
                  {"stack", 1104, 1, 17000, 0},     {"crowd", 4020, 1, 7000, 0},  {"lamp", 20001, 1, 250000, 0},
                  {"lights", 9002, 1, 30000, 0},    {"lights", 9014, 1, 9000, 0}, {"lights", 20002, 1, 90000, 0},
                  {"lights", 30022, 1, 45000, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        const trial_result result = run_one(scenes[i].kind, scenes[i].seed, scenes[i].share, scenes[i].coded);
        assert_true(result.v.events > scenes[i].events);
        assert_int_equal(result.v.lost + result.v.false_ones, 0);
        assert_int_equal(verdict_dishonest(&result.v), 0);
    }
}

/* Signals that turn 3e-8 short of a level (veil 3004), 5e-8 beyond one (stack 4038), or at a kink on one, in four pixels (lamp
 * 9017) and in one (few 20002): looks are less accurate than that (5e-7), and say the opposite. So each is counted, with its
 * pixel's next event, which it takes with it. */
static void test_grazes_count(void **state) {
    const trial_result results[] = {run_one("veil", 3004, 1, 0), run_one("stack", 4038, 1, 0), run_one("few", 20002, 1, 0),
                                    run_one("lamp", 9017, 1, 0)};
    static const size_t events[] = {50000, 50000, 3000, 200000};
    static const unsigned long long most[] = {4, 4, 2, 16};
    (void)state;
    for (int i = 0; i < 4; i++) {
        const verdict *v = &results[i].v;
        assert_true(v->events > events[i]);
        assert_true(v->uncertain > 0 && v->lost + v->false_ones <= v->uncertain);
        assert_true(v->uncertain <= most[i]);
    }
}

/* Where rows are rounded, looks that are nanoseconds apart have values that say nothing of bends: cubics between them turned
 * where the signal rises, and 5 events were uncertain here. */
static void test_rounding_bends_nothing(void **state) {
    const trial_result result = run_one("lamps", 5005, 1, 0);
    (void)state;
    assert_true(result.v.events > 25000);
    assert_int_equal(result.v.lost + result.v.false_ones, 0);
    assert_int_equal(result.v.uncertain, 0);
}

int main(void) {
    /* Tests that start processes come first, before this process opens a device. */
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_oracle_is_sure),
                                       cmocka_unit_test(test_few_are_lost),
                                       cmocka_unit_test(test_mended),
                                       cmocka_unit_test(test_grazes_count),
                                       cmocka_unit_test(test_rounding_bends_nothing),
                                       cmocka_unit_test(test_images),
                                       cmocka_unit_test(test_coded_images)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
