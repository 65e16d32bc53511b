/* The sensor in whole runs. Blocks that are off change nothing. Cuts, batches, steps of tiles and checkpoints give equal events
 * with all blocks on, readout included. Halving the steps moves no event by more than the reported error. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tides/metrics.h"

#include <unistd.h>

static const uint64_t SEED = 271828;

/* All blocks, each strong enough to show in 80 ms. */
static job noisy_job(const random_scene *scene, int adaptive) {
    job j = adaptive ? adaptive_job_of(scene, 1) : job_of(scene);
    j.sensor.seed = 99;
    j.sensor.labels = 1;
    j.sensor.threshold_sigma = 0.02;
    j.sensor.threshold_min = 0.05;
    j.sensor.refractory_s = 1.7e-3;
    j.sensor.leak_rate_hz = 30;
    j.sensor.leak_sigma = 0.1;
    j.sensor.shot_noise_hz = 20;
    j.sensor.hot_pixel_fraction = 0.01;
    j.sensor.hot_pixel_rate_hz = 500;
    j.sensor.dead_pixel_fraction = 0.02;
    j.sensor.b_min = 0.2;
    return j;
}

/* Every filter once: the constant pole, v2e's, the circuit. */
static void filter_by(job *j, int which) {
    j->sensor.photoreceptor_cutoff_hz = which < 2 ? 150 : 0;
    j->sensor.photoreceptor_law = which == 1 ? TIDES_PHOTORECEPTOR_INTENSITY : TIDES_PHOTORECEPTOR_CONSTANT;
    j->sensor.bandwidth = which == 2 ? TIDES_BANDWIDTH_CIRCUIT : TIDES_BANDWIDTH_FIRST_ORDER;
}

/* All filters, each of which drops some of the run's events. */
static tides_filters all_filters(void) {
    tides_filters filters;
    tides_filters_defaults(&filters);
    filters.background_s = 2e-3;
    filters.activity_high_start = 35e3;
    filters.activity_high_stop = 30e3;
    filters.afk = TIDES_AFK_BAND_STOP;
    filters.afk_start = 2;
    filters.afk_stop = 1;
    filters.trail = TIDES_TRAIL_TRAIL;
    filters.erc_events = 2;
    return filters;
}

static const tides_filters *behind; /* every run has these filters; NULL: none */

static tides_simulator *simulator_of(const job *j, tides_device *device, const tides_readout *readout) {
    tides_simulator *s = make_simulator(j, device);
    tides_error error;
    if (behind) scene_expect_ok(tides_simulator_filters(s, behind, &error), &error);
    if (readout) scene_expect_ok(tides_simulator_readout(s, readout, &error), &error);
    return s;
}

static void go(tides_simulator *s, double until, outcome *o) {
    tides_error error;
    scene_expect_ok(tides_simulator_run(s, until, collect, o, NULL, NULL, &error), &error);
}

static outcome whole_run(const job *j, tides_device *device, const tides_readout *readout) {
    outcome o = {0};
    tides_simulator *s = simulator_of(j, device, readout);
    go(s, j->stop, &o);
    tides_simulator_stats(s, &o.stats);
    tides_simulator_destroy(s);
    return o;
}

/* Cut into pieces, the second half by another simulator from a checkpoint. */
static outcome cut_run(const job *j, tides_device *device, const tides_readout *readout, const char *path) {
    outcome o = {0};
    tides_error error;
    tides_simulator *s = simulator_of(j, device, readout);
    for (int k = 1; k <= 5; k++) go(s, j->start + (j->stop - j->start) * k / 10, &o);
    scene_expect_ok(tides_simulator_save(s, NULL, path, &error), &error);
    tides_simulator_destroy(s);
    s = simulator_of(j, device, readout);
    scene_expect_ok(tides_simulator_restore(s, NULL, path, &error), &error);
    for (int k = 6; k <= 10; k++) go(s, j->start + (j->stop - j->start) * k / 10, &o);
    go(s, j->stop, &o);
    tides_simulator_stats(s, &o.stats);
    tides_simulator_destroy(s);
    return o;
}

static void expect_same_stats(const tides_stats *a, const tides_stats *b) {
    for (int c = 0; c < TIDES_CAUSES; c++) assert_true(a->events_by_cause[c] == b->events_by_cause[c]);
    assert_true(a->events_suppressed == b->events_suppressed);
    assert_true(a->events_refractory == b->events_refractory);
    assert_true(a->events_written == b->events_written);
    assert_true(a->events_dropped == b->events_dropped);
    assert_true(a->events_delayed == b->events_delayed);
    assert_true(a->worst_residual == b->worst_residual);
}

static void test_cuts(void **state) {
    random_scene scene = make_scene(SEED);
    tides_device *device = open_device("reference-f32");
    tides_readout readout = busy_readout();
    printf("seed %llu\n", (unsigned long long)SEED);
    for (int adaptive = 0; adaptive < 2; adaptive++)
        for (int law = TIDES_REFRACTORY_HOLD; law <= TIDES_REFRACTORY_DROP_CONSUME; law++)
            for (int reads = 0; reads < 2; reads++) {
                job j = noisy_job(&scene, adaptive);
                j.sensor.refractory_law = law;
                filter_by(&j, law);
                outcome whole = whole_run(&j, device, reads ? &readout : NULL);
                outcome pieces = cut_run(&j, device, reads ? &readout : NULL, scene_in_folder(*state, "cut.checkpoint"));
                expect_same(&whole, &pieces, "cut");
                expect_same_stats(&whole.stats, &pieces.stats);
                if (law == TIDES_REFRACTORY_HOLD)
                    printf("%s%s: %zu events; signal %llu, leak %llu, shot %llu, hot %llu; suppressed %llu, dropped %llu\n",
                           adaptive ? "adaptive" : "fixed", reads ? ", readout" : "", whole.count,
                           (unsigned long long)whole.stats.events_by_cause[0],
                           (unsigned long long)whole.stats.events_by_cause[1],
                           (unsigned long long)whole.stats.events_by_cause[2],
                           (unsigned long long)whole.stats.events_by_cause[3],
                           (unsigned long long)whole.stats.events_suppressed, (unsigned long long)whole.stats.events_dropped);
                for (int c = 0; c < TIDES_CAUSES; c++) assert_true(whole.stats.events_by_cause[c] > 0);
                assert_true(whole.stats.events_suppressed > 0);
                assert_true(whole.stats.worst_residual < 1 + 1e-9);
                assert_true(whole.stats.events_written == whole.count);
                assert_true(!reads || (whole.stats.events_dropped > 0 && whole.stats.events_delayed > 0 &&
                                       whole.stats.events == whole.count + whole.stats.events_dropped));
                free_outcome(&whole);
                free_outcome(&pieces);
            }
    tides_device_close(device);
    random_scene_free(&scene);
}

/* The frames that kick_rate_hz 45 and kick_first_s give, as a list. */
static void list_kicks(const char *path, const job *j) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int k = 0; k < 200; k++) assert_true(fprintf(file, "%.17g\n", j->start + 1e-3 + k / 45.0) > 0);
    assert_int_equal(fclose(file), 0);
}

/* Kicks of a frame's readout in whole runs, fixed and adaptive: over cuts, through a checkpoint, and they make events. With the
 * frames' times from a file they are the same. */
static void test_kicks(void **state) {
    random_scene scene = make_scene(SEED);
    tides_device *device = open_device("reference-f32");
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        job j = noisy_job(&scene, adaptive);
        const char *times = scene_in_folder(*state, "kicks.txt");
        list_kicks(times, &j);
        j.sensor.noise_rms = adaptive ? 0.01 : 0;
        outcome without = whole_run(&j, device, NULL);
        j.sensor.kick = 0.06;
        j.sensor.kick_rate_hz = 45;
        j.sensor.kick_first_s = j.start + 1e-3;
        outcome whole = whole_run(&j, device, NULL);
        j.sensor.kick_times = times;
        outcome pieces = cut_run(&j, device, NULL, scene_in_folder(*state, "kicks.checkpoint"));
        expect_same(&whole, &pieces, "cut");
        expect_same_stats(&whole.stats, &pieces.stats);
        printf("%zu events, %zu without kicks\n", whole.count, without.count);
        assert_true(whole.count > without.count + without.count / 20);
        free_outcome(&without);
        free_outcome(&whole);
        free_outcome(&pieces);
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

/* Rows that ask, and frames: cuts, batches and a checkpoint don't show. */
static void test_asked(void **state) {
    random_scene scene = make_scene(SEED);
    tides_device *device = open_device("reference-f32");
    for (int kind = TIDES_READOUT_REQUESTED; kind <= TIDES_READOUT_SCANNED; kind++)
        for (int adaptive = 0; adaptive < 2; adaptive++) {
            tides_readout readout = busy_readout();
            readout.kind = kind;
            readout.row_s = 20e-6;
            readout.event_s = 2e-6;
            readout.frame_s = 3e-3;
            job j = noisy_job(&scene, adaptive);
            j.batch = 1;
            outcome whole = whole_run(&j, device, &readout);
            outcome pieces = cut_run(&j, device, &readout, scene_in_folder(*state, "asked.checkpoint"));
            j.batch = 7;
            outcome other = whole_run(&j, device, &readout);
            expect_same(&whole, &pieces, "cut");
            expect_same(&whole, &other, "batches");
            expect_same_stats(&whole.stats, &pieces.stats);
            assert_true(whole.stats.events_delayed > whole.count / 2);
            assert_int_equal(whole.stats.events, whole.count + whole.stats.events_dropped);
            free_outcome(&whole);
            free_outcome(&pieces);
            free_outcome(&other);
        }
    tides_device_close(device);
    random_scene_free(&scene);
}

/* Filters, behind the pixels or behind a readout, over cuts and through a checkpoint; what they drop is all that is missing. */
static void test_filters(void **state) {
    random_scene scene = make_scene(SEED);
    tides_device *device = open_device("reference-f32");
    tides_readout readout = busy_readout();
    const tides_filters filters = all_filters();
    for (int adaptive = 0; adaptive < 2; adaptive++)
        for (int reads = 0; reads < 2; reads++) {
            job j = noisy_job(&scene, adaptive);
            j.batch = 1;
            behind = NULL;
            outcome all = whole_run(&j, device, reads ? &readout : NULL);
            behind = &filters;
            outcome whole = whole_run(&j, device, reads ? &readout : NULL);
            outcome pieces = cut_run(&j, device, reads ? &readout : NULL, scene_in_folder(*state, "filters.checkpoint"));
            j.batch = 7;
            outcome other = whole_run(&j, device, reads ? &readout : NULL);
            expect_same(&whole, &pieces, "cut");
            expect_same(&whole, &other, "batches");
            expect_same_stats(&whole.stats, &pieces.stats);
            assert_memory_equal(whole.stats.events_filtered, pieces.stats.events_filtered, sizeof whole.stats.events_filtered);
            size_t left = whole.count;
            for (int f = 0; f < TIDES_STAGES; f++) {
                printf("%llu ", (unsigned long long)whole.stats.events_filtered[f]);
                assert_true(whole.stats.events_filtered[f] > 0);
                left += (size_t)whole.stats.events_filtered[f];
            }
            printf("filtered, %zu of %zu events left\n", whole.count, all.count);
            assert_int_equal(left, all.count);
            assert_true(whole.count > 0 && whole.stats.events_written == whole.count);
            free_outcome(&all);
            free_outcome(&whole);
            free_outcome(&pieces);
            free_outcome(&other);
        }
    behind = NULL;
    tides_device_close(device);
    random_scene_free(&scene);
}

/* How many steps go to the device at once, and with a readout what packets come of it, doesn't show. */
static void test_batches(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 1);
    tides_device *device = open_device("reference-f32");
    tides_readout readout = busy_readout();
    for (int reads = 0; reads < 2; reads++) {
        job j = noisy_job(&scene, 0);
        j.batch = 1;
        outcome one = whole_run(&j, device, reads ? &readout : NULL);
        j.batch = 7;
        outcome seven = whole_run(&j, device, reads ? &readout : NULL);
        expect_same(&one, &seven, "batches");
        free_outcome(&one);
        free_outcome(&seven);
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

/* The general sensor on parameters that do nothing gives the plain comparator's events, to the bit. */
static void test_nothing_on(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 2);
    tides_device *device = open_device("reference-f32");
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        job plain = adaptive ? adaptive_job_of(&scene, 1) : job_of(&scene), general = plain;
        plain.sensor.threshold_off = general.sensor.threshold_off = plain.sensor.threshold_on; /* the same steps are chosen */
        general.sensor.dead_pixel_fraction = 1e-12;
        outcome a = whole_run(&plain, device, NULL), b = whole_run(&general, device, NULL);
        assert_true(a.count > 1000);
        expect_same(&a, &b, "general sensor");
        assert_true(b.stats.steps == a.stats.steps);
        assert_true(b.stats.worst_residual == a.stats.worst_residual);
        tides_readout readout;
        tides_readout_defaults(&readout);
        readout.enabled = 1;
        readout.tick_s = readout.eta = readout.gamma_sigma_s = 0;
        outcome c = whole_run(&plain, device, &readout);
        expect_same(&a, &c, "infinite readout");
        free_outcome(&a);
        free_outcome(&b);
        free_outcome(&c);
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

/* Blocks without noise: a refractory law, a filter (3: none), the blur, and the surround, which takes the constant filter
 * only. */
typedef struct quiet_blocks {
    const char *name;
    int law, filter, psf_domain;
    double psf_sigma_px, surround_lambda_px;
} quiet_blocks;

static job quiet_job(const random_scene *scene, const quiet_blocks *blocks) {
    job j = noisy_job(scene, 1);
    j.sensor.shot_noise_hz = j.sensor.hot_pixel_fraction = j.sensor.b_min = 0;
    j.sensor.refractory_law = blocks->law;
    j.sensor.refractory_s = 0.2e-3;
    if (blocks->filter < 3) filter_by(&j, blocks->filter);
    j.sensor.psf_domain = blocks->psf_domain;
    j.sensor.psf_sigma_px = blocks->psf_sigma_px;
    j.sensor.surround_lambda_px = blocks->surround_lambda_px;
    j.sensor.surround_tau_s = 2e-3;
    j.stepping.tolerance = 1e-4;
    j.stepping.min_step_s = 1e-6;
    return j;
}

/* All blocks without noise: halving the longest step moves events by no more than the runs' own estimates, median
 * by median, p95 by p95 and p99 by p99. */
static void test_halved_steps(void **state) {
    (void)state;
    static const quiet_blocks all[] = {
        {"no filter, hold", TIDES_REFRACTORY_HOLD, 3, TIDES_PSF_LOG, 0, 0},
        {"no filter, drop_keep", TIDES_REFRACTORY_DROP_KEEP, 3, TIDES_PSF_LOG, 0, 0},
        {"no filter, drop_consume", TIDES_REFRACTORY_DROP_CONSUME, 3, TIDES_PSF_LOG, 0, 0},
        {"low-pass, blur of L, surround", TIDES_REFRACTORY_HOLD, 0, TIDES_PSF_LOG, 0.8, 2},
        {"by light, blur of Y", TIDES_REFRACTORY_DROP_KEEP, 1, TIDES_PSF_LINEAR, 0.8, 0},
        {"circuit, blur of L", TIDES_REFRACTORY_DROP_CONSUME, 2, TIDES_PSF_LOG, 0.8, 0},
    };
    const unsigned long long seed = SEED + 4;
    random_scene scene = make_scene(seed);
    tides_device *device = open_device("reference");
    printf("seed %llu\n", seed);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        job j = quiet_job(&scene, &all[k]);
        outcome coarse = whole_run(&j, device, NULL);
        j.stepping.step_s *= 0.5;
        outcome fine = whole_run(&j, device, NULL);
        tides_match m;
        tides_error error;
        scene_expect_ok(tides_match_events(coarse.events, coarse.count, fine.events, fine.count, 1e-3, &m, &error), &error);
        printf("%s: %zu and %zu events, p50 %.3g, p95 %.3g, p99 %.3g, most %.3g s, estimated %.3g, %.3g, %.3g s, missing %llu, "
               "spurious "
               "%llu\n",
               all[k].name, coarse.count, fine.count, 1e-6 * m.dt_median_us, 1e-6 * m.dt_p95_us, 1e-6 * m.dt_p99_us,
               1e-6 * m.dt_max_us, coarse.stats.error_p50_s, coarse.stats.error_p95_s, coarse.stats.error_p99_s,
               (unsigned long long)m.missing, (unsigned long long)m.spurious);
        assert_true(coarse.count > 1000);
        assert_true((m.missing + m.spurious) * 1000 <= coarse.count);
        const double rounded = 1e-9; /* times are floored */
        assert_true(1e-6 * m.dt_median_us <= coarse.stats.error_p50_s + fine.stats.error_p50_s + rounded);
        assert_true(1e-6 * m.dt_p95_us <= coarse.stats.error_p95_s + fine.stats.error_p95_s + rounded);
        assert_true(1e-6 * m.dt_p99_us <= coarse.stats.error_p99_s + fine.stats.error_p99_s + rounded);
        free_outcome(&coarse);
        free_outcome(&fine);
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_cuts, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_kicks, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_asked, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_filters, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_batches),
        cmocka_unit_test(test_nothing_on),
        cmocka_unit_test(test_halved_steps),
    };
    return cmocka_run_group_tests_name("sensor in runs", tests, NULL, NULL);
}
