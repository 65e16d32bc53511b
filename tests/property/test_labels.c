/* Labels in whole runs: asking for them changes no event. An event leaves no earlier than it fired, except by jitter. Behind a
 * readout the labels are those that the pixels gave. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"

static const uint64_t SEED = 161803;

/* Normal jitter of busy_readout, 2 us and 10 us of activity, goes no further back. */
enum { EARLY_NS = 9 * 12000 };

/* A run with its label `fired`. */
typedef struct labelled {
    outcome run;
    int64_t *fired;
    size_t fired_capacity;
    tides_simulator *simulator;
    int reads;
} labelled;

static int collect_labels(void *user, const tides_event *events, size_t count) {
    labelled *l = user;
    size_t before = l->run.count;
    collect(&l->run, events, count);
    const int64_t *fired = tides_simulator_fired(l->simulator);
    assert_true(l->reads || !fired);
    scene_expect_ok(td_reserve((void **)&l->fired, &l->fired_capacity, l->run.count, sizeof *l->fired, NULL), NULL);
    for (size_t i = 0; i < count; i++) {
        l->fired[before + i] = fired ? fired[i] : events[i].t;
        assert_true(l->fired[before + i] <= events[i].t + (fired ? EARLY_NS : 0));
    }
    return 0;
}

static labelled run_labelled(const job *j, tides_device *device, const tides_readout *readout) {
    labelled l = {.reads = readout != NULL};
    tides_error error;
    l.simulator = make_simulator(j, device);
    if (readout) scene_expect_ok(tides_simulator_readout(l.simulator, readout, &error), &error);
    scene_expect_ok(tides_simulator_run(l.simulator, j->stop, collect_labels, &l, NULL, NULL, &error), &error);
    tides_simulator_stats(l.simulator, &l.run.stats);
    tides_simulator_destroy(l.simulator);
    return l;
}

static void free_labelled(labelled *l) {
    free_outcome(&l->run);
    free(l->fired);
}

enum { NOTHING, LEAK_AND_SHOT, LOW_PASS, CIRCUIT, SURROUND, NOISE, BLOCKS };

static job block_job(const random_scene *scene, int block, int adaptive) {
    job j = adaptive ? adaptive_job_of(scene, 1) : job_of(scene);
    if (block == LEAK_AND_SHOT) j.sensor.leak_rate_hz = j.sensor.shot_noise_hz = 30;
    if (block == LOW_PASS) j.sensor.photoreceptor_cutoff_hz = 150;
    if (block == CIRCUIT) j.sensor.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
    if (block == SURROUND) {
        j.sensor.surround_lambda_px = 3;
        j.sensor.surround_tau_s = 2e-3;
    }
    if (block == NOISE) j.sensor.noise_rms = 0.02;
    return j;
}

static void test_events_stay(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED);
    tides_device *device = open_device("reference-f32");
    printf("seed %llu\n", (unsigned long long)SEED);
    for (int adaptive = 0; adaptive < 2; adaptive++)
        for (int block = NOTHING; block < BLOCKS; block++) {
            job j = block_job(&scene, block, adaptive);
            labelled plain = run_labelled(&j, device, NULL);
            j.sensor.labels = 1;
            labelled asked = run_labelled(&j, device, NULL);
            size_t added = 0;
            for (size_t i = 0; i < asked.run.count; i++) {
                double value = tides_event_frontend(&asked.run.events[i]);
                assert_true(isfinite(value));
                assert_true((i >= plain.run.count || plain.run.events[i].frontend == 0));
                added += value < 0 || value > 0;
                asked.run.events[i].frontend = 0;
            }
            expect_same(&plain.run, &asked.run, "labels");
            assert_true(asked.run.count > 500);
            if (block < LOW_PASS) assert_int_equal(added, 0);
            if (block >= LOW_PASS) assert_true(added > asked.run.count * 9 / 10);
            free_labelled(&plain);
            free_labelled(&asked);
        }
    tides_device_close(device);
    random_scene_free(&scene);
}

static int by_firing(const void *a, const void *b) { return compare_events(a, b); }

/* What leaves the readout, put back to when it fired, is what went in, less what was dropped. */
static void test_readout_keeps_labels(void **state) {
    (void)state;
    random_scene scene = make_scene(SEED + 1);
    tides_device *device = open_device("reference-f32");
    tides_readout readout = busy_readout();
    readout.p0 = 0;
    for (int block = LEAK_AND_SHOT; block <= LOW_PASS; block++) {
        job j = block_job(&scene, block, 1);
        j.sensor.labels = 1;
        labelled in = run_labelled(&j, device, NULL), out = run_labelled(&j, device, &readout);
        size_t late = 0, at = 0;
        for (size_t i = 0; i < out.run.count; i++) {
            late += out.fired[i] < out.run.events[i].t;
            out.run.events[i].t = out.fired[i];
        }
        qsort(out.run.events, out.run.count, sizeof *out.run.events, by_firing);
        for (size_t i = 0; i < out.run.count; i++, at++) {
            while (at < in.run.count && memcmp(&in.run.events[at], &out.run.events[i], sizeof *in.run.events) != 0) at++;
            assert_true(at < in.run.count);
        }
        printf("%zu in, %zu out, %zu late\n", in.run.count, out.run.count, late);
        assert_true(late > 100);
        assert_true(out.run.count < in.run.count);
        free_labelled(&in);
        free_labelled(&out);
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_events_stay),
        cmocka_unit_test(test_readout_keeps_labels),
    };
    return cmocka_run_group_tests_name("labels in runs", tests, NULL, NULL);
}
