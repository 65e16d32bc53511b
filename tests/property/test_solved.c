/* Events by look-ups in the image (stepping.solve): their times against exact ones, with and without blocks of the sensor;
 * reported errors; equal events in any windows, cuts and batches; and settings with which it is refused.
 *
 * TIDES_TRIALS=N: N random scenes instead of a handful. TIDES_SEED=N: the first one's seed. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "refine_world.h"
#include "sensor/td_single.h"
#include "solver/td_simulator.h"
#include "tests/support/grazing_world.h"
#include "tests/support/number_of.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 1461;

/* -- against exact events ------------------------------------------------------------------------------------------------ */

/* Ten times the default: steps needn't be good, only find the crossings. */
#define LOOSE 0.1

/* What a scene's events may be off by, beyond what the last halving moved the exact ones by: the time asked for, and what
 * record paths do to L, 25 ns at 20 /s. */
#define MOST_P95_US 0.03

/* What is looked up in double has every splat: so must the frames that exact events come of. */
#define ALL_LIGHT 1e-14

enum { FEW = 5 };

static void check_scene(uint64_t seed, double *reported, double *measured) {
    const judged_scale scale = {0.1, 0.01, 4000};
    judged j = grazing_world_make(seed);
    judged_stream exact = {0};
    int settled = 0;
    j.stepping.tolerance = LOOSE;
    j.image.smoothing.stop_change = ALL_LIGHT;
    judged_verdict v = judged_against_exact(&j, "reference", &scale, &settled, &exact);
    j.stepping.solve = TIDES_SOLVE_DOUBLE;
    judged_verdict w = judged_against(&j, "reference", 0.01, &exact);
    w.halved = v.halved;
    judged_print(&j, "solved", &w);
    assert_int_equal(w.stats.events_caught_up, 0);
    assert_true(w.stats.events_solved <= w.stats.events && (w.stats.points_looked_up > 0 || w.stats.events_solved == 0));
    if (!judged_honest(&w)) fail_msg("seed %llu: reported errors are too small", (unsigned long long)seed);
    if (w.match.mismatch_percent > v.match.mismatch_percent)
        fail_msg("seed %llu: %g %% mismatched", (unsigned long long)seed, w.match.mismatch_percent);
    if (w.timing.matched > 0 && w.timing.dt_p95_us - w.halved.dt_p95_us > MOST_P95_US)
        fail_msg("seed %llu: p95 %g us", (unsigned long long)seed, w.timing.dt_p95_us);
    *reported = fmax(*reported, w.stats.error_p95_s);
    *measured += w.timing.matched > 0;
    free(exact.events);
    judged_free(&j);
}

static void test_exact_events(void **state) {
    (void)state;
    double reported = 0, scenes = 0;
    for (uint64_t k = 0; k < number_of("TIDES_TRIALS", FEW); k++)
        check_scene(number_of("TIDES_SEED", 15) + k, &reported, &scenes);
    assert_true(scenes > 0);
    if (!(reported < 2e-7)) fail_msg("a p95 of %g s was reported, where 10 ns are asked for", reported);
}

/* -- with blocks --------------------------------------------------------------------------------------------------------- */

static job loose_job(const world *w) {
    job j = job_in(w);
    j.device = "reference";
    j.stepping.tolerance = LOOSE;
    j.stepping.solve = TIDES_SOLVE_DOUBLE;
    j.stop_change = ALL_LIGHT;
    return j;
}

static void leak(tides_sensor *s) { s->leak_rate_hz = 5; }
static void mismatch(tides_sensor *s) { s->threshold_sigma = 0.02; }
static void hold(tides_sensor *s) { s->refractory_s = 1e-3; }
static void keep(tides_sensor *s) {
    s->refractory_s = 1e-3;
    s->refractory_law = TIDES_REFRACTORY_DROP_KEEP;
}
static void consume(tides_sensor *s) {
    s->refractory_s = 1e-3;
    s->refractory_law = TIDES_REFRACTORY_DROP_CONSUME;
    s->threshold_off = 0.07;
}
static void unseen(tides_sensor *s) { s->b_min = 0.3; }

/* What is reported is worth something: p95 within so many times of the true one. */
#define MOST_RATIO 5.0

/* Times are whole nanoseconds: what is true is known to half of one, which is a twentieth of the p95 that are asked for
 * here. */
static const double half_a_ns_us = 5e-4;

static const struct block {
    const char *name;
    void (*set)(tides_sensor *);
    double most_p95_us; /* of a mask coverage decides, which is linear in a step */
} blocks[] = {{"leak", leak, 0.1}, {"mismatch", mismatch, 0.1},    {"hold", hold, 0.1},
              {"keep", keep, 0.1}, {"drop_consume", consume, 0.1}, {"mask", unseen, INFINITY}};

static void test_blocks(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) {
        world w = make_world(SEED + k % 2, CAMERA_MOVES);
        job j = loose_job(&w);
        blocks[k].set(&j.sensor);
        outcome solved = run(&j);
        j.stepping.solve = TIDES_SOLVE_OFF;
        outcome off = run(&j), truth = truth_of(&j, 5e-5);
        const tides_match m = match(&truth, &solved), before = match(&truth, &off);
        print_message("%-12s %zu events, p95 %.3g <= %.3g us (%.3g without), mismatched %.3g %% (%.3g)\n", blocks[k].name,
                      solved.count, m.dt_p95_us, 1e6 * solved.stats.error_p95_s, before.dt_p95_us, m.mismatch_percent,
                      before.mismatch_percent);
        assert_true(solved.count > 500 && solved.stats.events_solved > 0);
        if (!(m.dt_p95_us < blocks[k].most_p95_us && m.dt_p95_us < 0.5 * before.dt_p95_us))
            fail_msg("%s: p95 %g us, %g without", blocks[k].name, m.dt_p95_us, before.dt_p95_us);
        if (!(1e-6 * m.dt_p95_us <= solved.stats.error_p95_s && 1e-6 * m.dt_median_us <= solved.stats.error_p50_s))
            fail_msg("%s: p95 %g us, reported %g s", blocks[k].name, m.dt_p95_us, solved.stats.error_p95_s);
        if (isfinite(blocks[k].most_p95_us) && 1e6 * solved.stats.error_p95_s > MOST_RATIO * (m.dt_p95_us + half_a_ns_us))
            fail_msg("%s: p95 %g us, %g s is reported", blocks[k].name, m.dt_p95_us, solved.stats.error_p95_s);
        assert_true(m.mismatch_percent <= before.mismatch_percent + 0.05);
        assert_true(solved.stats.worst_residual < 1);
        free_outcome(&solved);
        free_outcome(&off);
        free_outcome(&truth);
        free_world(&w);
    }
}

/* -- the same events whatever the order ---------------------------------------------------------------------------------- */

/* In three calls. */
static outcome run_cut(const job *j) {
    outcome o = {0};
    tides_error error;
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &o);
    for (int k = 1; k <= 3; k++)
        scene_expect_ok(tides_simulator_run(s, j->start + (j->stop - j->start) * k / 3, collect, &o, NULL, NULL, &error),
                        &error);
    finish(s, &o);
    tides_simulator_destroy(s);
    tides_device_close(device);
    return o;
}

static void test_any_window_and_cut(void **state) {
    static const double memory_mb[] = {1, 1.7, 4};
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        world w = make_world(SEED + 10 + (uint64_t)trial, trial % KINDS);
        job j = loose_job(&w);
        j.stepping.tolerance = 0.003; /* many samples */
        if (trial >= 2) hold(&j.sensor);
        if (trial % 2) j.device = "reference-f32";
        outcome whole = run(&j), cut = run_cut(&j);
        expect_same(&whole, &cut, "cuts");
        assert_true(whole.stats.points_looked_up == cut.stats.points_looked_up && whole.stats.events_solved > 100);
        for (size_t k = 0; k < sizeof memory_mb / sizeof *memory_mb; k++) {
            j.stepping.memory_mb = memory_mb[k];
            outcome windows = run(&j);
            expect_same(&whole, &windows, "windows");
            assert_true(whole.stats.error_p95_s == windows.stats.error_p95_s);
            assert_true(whole.stats.events_uncertain == windows.stats.events_uncertain);
            free_outcome(&windows);
        }
        free_outcome(&whole);
        free_outcome(&cut);
        free_world(&w);
    }
}

/* In batches of so many points. */
static outcome run_in_batches(const job *j, size_t enough) {
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    s->solve.enough = enough;
    outcome o = run_made(j, s);
    tides_device_close(device);
    return o;
}

/* A device is at one batch while the next is asked for. */
static void test_any_batches(void **state) {
    static const size_t enough[] = {1, 7, 100};
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        world w = make_world(SEED + 10 + (uint64_t)trial, trial % KINDS);
        job j = loose_job(&w);
        j.device = "cpu";
        if (trial >= 2) hold(&j.sensor);
        if (trial == 3) j.stepping.unit = TIDES_UNIT_BLOCK;
        outcome whole = run(&j);
        assert_true(whole.stats.points_looked_up > 200);
        for (size_t k = 0; k < sizeof enough / sizeof *enough; k++) {
            outcome o = run_in_batches(&j, enough[k]);
            expect_same(&whole, &o, "batches");
            assert_true(whole.stats.points_looked_up == o.stats.points_looked_up);
            assert_true(whole.stats.error_p95_s == o.stats.error_p95_s);
            free_outcome(&o);
        }
        free_outcome(&whole);
        free_world(&w);
    }
}

/* -- references ----------------------------------------------------------------------------------------------------------- */

/* What all pixels have at the run's start, in double; the worst that references in single precision are off by, as a share of
 * what they are taken to be off by. */
static double know_all(tides_simulator *s) {
    double worst = 0;
    for (int t = 0; t < s->layout.units; t++) {
        const td_tile *tile = &s->layout.unit[t];
        const size_t first = s->layout.first_pixel[t];
        double doubt[TD_TILE_PIXELS];
        td_point points[TD_TILE_PIXELS];
        td_point_value values[TD_TILE_PIXELS];
        tides_error error;
        td_solve_doubt(s, t, doubt);
        for (int i = 0; i < tile->count; i++) points[i] = (td_point){0, tile->x0 + i % tile->width, tile->y0 + i / tile->width};
        scene_expect_ok(td_renderer_points(s->renderer, s->camera, points, (size_t)tile->count, values, &error), &error);
        for (int i = 0; i < tile->count; i++) {
            const size_t pixel = first + (size_t)i;
            worst = fmax(worst, fabs(s->sensor.pixels.initial[pixel] - values[i].L) / doubt[i]);
            td_sensor_refer(&s->sensor, pixel, values[i].L);
            s->solve.known[pixel] = 1;
        }
    }
    return worst;
}

/* References that are looked up when pixels first may act make the events of references that all have from the start, in the
 * first macro step and later ones, whether they wait at rest or where something moves. */
static void test_references_in_time(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        world w = make_world(SEED + 20, kind);
        job j = loose_job(&w);
        outcome early = {0};
        tides_error error;
        j.device = "reference-f32";
        j.stop_change = 0; /* as it is by default, so that samples end sooner than what is looked up */
        outcome late = run(&j);
        tides_device *device = open_device(j.device);
        tides_simulator *s = make_simulator(&j, device);
        begin(&j, s, &early);
        scene_expect_ok(tides_simulator_run(s, j.start, collect, &early, NULL, NULL, &error), &error);
        const double worst = know_all(s);
        scene_expect_ok(tides_simulator_run(s, j.stop, collect, &early, NULL, NULL, &error), &error);
        finish(s, &early);
        tides_simulator_destroy(s);
        tides_device_close(device);
        const tides_match m = match(&early, &late);
        print_message("%zu events, %d pixels, %llu looks (%llu with all references known): off by %.2g of the bound, p99 %g "
                      "us\n",
                      late.count, w.scene.camera.width * w.scene.camera.height, (unsigned long long)late.stats.points_looked_up,
                      (unsigned long long)early.stats.points_looked_up, worst, m.dt_p99_us);
        assert_true(late.count == early.count && m.mismatch_percent == 0 && m.dt_p99_us < 0.001);
        assert_true(worst > 0.001 && worst < 1);
        assert_true(late.stats.points_looked_up > early.stats.points_looked_up);
        free_outcome(&late);
        free_outcome(&early);
        free_world(&w);
    }
}

/* -- samples in single precision ----------------------------------------------------------------------------------------- */

/* Events are solved in double on any device that has it: as good as those of the double reference. */
static void test_single_precision(void **state) {
    (void)state;
    world w = make_world(SEED, CAMERA_MOVES);
    job j = loose_job(&w), off = j;
    j.device = off.device = "reference-f32";
    off.stepping.solve = TIDES_SOLVE_OFF;
    outcome solved = run(&j), before = run(&off);
    off.device = "reference";
    outcome truth = truth_of(&off, 5e-5);
    const tides_match m = match(&truth, &solved), loose = match(&truth, &before);
    print_message("single precision, %zu events: p95 %.3g us (%.3g without), mismatched %.3g %% (%.3g)\n", solved.count,
                  m.dt_p95_us, loose.dt_p95_us, m.mismatch_percent, loose.mismatch_percent);
    assert_true(solved.count > 500 && solved.stats.events_solved > 0);
    assert_true(m.dt_p95_us < 0.1 && m.dt_p95_us < 0.5 * loose.dt_p95_us);
    assert_true(m.mismatch_percent <= loose.mismatch_percent + 0.05);
    free_outcome(&solved);
    free_outcome(&before);
    free_outcome(&truth);
    free_world(&w);
}

/* -- what comes back ------------------------------------------------------------------------------------------------------ */

/* A ball that passes a textured wall leaves every pixel as it was, which is a level: the last event there is when the ball's
 * edge ends, and not what single precision makes of the sample behind it. */
static void test_what_comes_back(void **state) {
    enum { OCCLUDERS = 10, SCENES = 6 }; /* of grazing_world's kinds */
    const judged_scale scale = {0.1, 0.01, 2000};
    size_t wrong = 0, before = 0, events = 0;
    (void)state;
    for (int k = 0; k < SCENES; k++) {
        judged j = grazing_world_make(OCCLUDERS + (uint64_t)grazing_world_kinds() * (uint64_t)(k + 1));
        judged_stream exact = {0};
        j.sensor.threshold_off = j.sensor.threshold_on; /* or levels aren't come back to */
        j.stepping.tolerance = LOOSE;
        j.image.smoothing.stop_change = ALL_LIGHT;
        judged_verdict v = judged_against_exact(&j, "reference", &scale, NULL, &exact);
        j.stepping.solve = TIDES_SOLVE_DOUBLE;
        judged_verdict w = judged_against(&j, "reference-f32", 0.01, &exact);
        judged_print(&j, "reference", &v);
        judged_print(&j, "solved", &w);
        before += v.match.missing + v.match.spurious;
        wrong += w.match.missing + w.match.spurious;
        events += exact.count;
        assert_int_equal(w.stats.events_caught_up, 0);
        free(exact.events);
        judged_free(&j);
    }
    assert_true(events > 1000);
    if (wrong > before) fail_msg("%zu events of %zu are wrong, %zu without looking them up", wrong, events, before);
}

/* -- what it is refused with --------------------------------------------------------------------------------------------- */

static void expect_refused(const job *j, int32_t rules, const char *said) {
    tides_image_params params;
    tides_error error;
    tides_simulator *s = NULL;
    tides_device *device = open_device(j->device);
    tides_image_params_defaults(&params);
    params.rules = rules;
    assert_int_equal(tides_simulator_create(device, j->scene, j->path, &j->camera, &params, &j->sensor, &j->stepping, j->start,
                                            j->stop, NULL, NULL, &s, &error),
                     TIDES_UNSUPPORTED);
    assert_null(s);
    if (!strstr(error.text, "stepping.solve") || !strstr(error.text, said)) fail_msg("%s", error.text);
    tides_device_close(device);
}

static void test_refused(void **state) {
    (void)state;
    world w = make_world(SEED, CAMERA_MOVES);
    const job good = loose_job(&w);
    job j = good;
    j.stepping.mode = TIDES_STEPPING_FIXED;
    expect_refused(&j, TIDES_RULES_SMOOTH, "fixed steps");
    j = good;
    j.sensor.psf_sigma_px = 1;
    expect_refused(&j, TIDES_RULES_SMOOTH, "PSF");
    j = good;
    j.sensor.photoreceptor_cutoff_hz = 300;
    expect_refused(&j, TIDES_RULES_SMOOTH, "filter");
    j = good;
    j.sensor.noise_rms = 0.01;
    expect_refused(&j, TIDES_RULES_SMOOTH, "additive noise");
    j = good;
    j.device = "reference-f32";
    expect_refused(&j, TIDES_RULES_INRIA, "abruptly"); /* where pixels are looked up one by one */
    j.stepping.solve = 4;
    expect_refused(&j, TIDES_RULES_SMOOTH, "none of");
    free_world(&w);
}

/* -- where it can be had -------------------------------------------------------------------------------------------------- */

/* "auto" is double, to the bit, or nothing; which it was is said. */
static void test_auto(void **state) {
    (void)state;
    world w = make_world(SEED, CAMERA_MOVES);
    for (int has = 0; has < 2; has++) {
        job j = loose_job(&w);
        if (!has) j.sensor.photoreceptor_cutoff_hz = 300;
        j.stepping.solve = has ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
        outcome named = run(&j);
        j.stepping.solve = TIDES_SOLVE_AUTO;
        outcome automatic = run(&j);
        expect_same(&named, &automatic, "auto");
        assert_true(named.count > 500 && (named.stats.events_solved > 0) == has);
        assert_int_equal(automatic.stats.solve, has ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF);
        assert_int_equal(named.stats.solve, automatic.stats.solve);
        free_outcome(&named);
        free_outcome(&automatic);
    }
    free_world(&w);
}

/* What the defaults are in a run, and why, is said; a tolerance that is given stays. */
static void test_what_the_defaults_choose(void **state) {
    static const struct {
        int32_t why, unit;
        double given, tolerance;
    } cases[] = {{TIDES_UNSOLVED_NOT, TIDES_UNIT_BLOCK, 0, 0.1},    {TIDES_UNSOLVED_NOT, TIDES_UNIT_BLOCK, 0.03, 0.03},
                 {TIDES_UNSOLVED_ASKED, TIDES_UNIT_TILE, 0, 0.01},  {TIDES_UNSOLVED_FIXED, TIDES_UNIT_TILE, 0, 0.01},
                 {TIDES_UNSOLVED_MODEL, TIDES_UNIT_TILE, 0, 0.01},  {TIDES_UNSOLVED_SENSOR, TIDES_UNIT_TILE, 0, 0.01},
                 {TIDES_UNSOLVED_SENSOR, TIDES_UNIT_TILE, 0.2, 0.2}};
    (void)state;
    world w = make_world(SEED, CAMERA_MOVES);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        job j = loose_job(&w);
        tides_stepping_defaults(&j.stepping);
        j.stepping.tolerance = cases[i].given;
        if (cases[i].why == TIDES_UNSOLVED_ASKED) j.stepping.solve = TIDES_SOLVE_OFF;
        if (cases[i].why == TIDES_UNSOLVED_FIXED) j.stepping.mode = TIDES_STEPPING_FIXED;
        if (cases[i].why == TIDES_UNSOLVED_MODEL) j.stepping.mode = TIDES_STEPPING_RISK;
        if (cases[i].why == TIDES_UNSOLVED_MODEL) j.stepping.model = TIDES_MODEL_LINEAR;
        if (cases[i].why == TIDES_UNSOLVED_SENSOR) j.sensor.noise_rms = 0.01;
        j.stop = j.start + 0.25 * (j.stop - j.start);
        outcome o = run(&j);
        const int solved = cases[i].why == TIDES_UNSOLVED_NOT;
        assert_int_equal(o.stats.unsolved, cases[i].why);
        assert_int_equal(o.stats.solve, solved ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF);
        assert_int_equal(o.stats.unit, cases[i].unit);
        assert_true(o.stats.tolerance == cases[i].tolerance && (o.stats.events_solved > 0) == solved);
        free_outcome(&o);
    }
    free_world(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_exact_events),
                                       cmocka_unit_test(test_blocks),
                                       cmocka_unit_test(test_any_window_and_cut),
                                       cmocka_unit_test(test_any_batches),
                                       cmocka_unit_test(test_references_in_time),
                                       cmocka_unit_test(test_single_precision),
                                       cmocka_unit_test(test_what_comes_back),
                                       cmocka_unit_test(test_refused),
                                       cmocka_unit_test(test_auto),
                                       cmocka_unit_test(test_what_the_defaults_choose)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
