/* Runs at any absolute time: 1000 random (start, duration, step) triples up to 2e9 s run to their end. If every input is exact
 * in a double, the events are those of the same run at time 0, later by the start, to the nanosecond. Otherwise they differ by
 * as much as the inputs' rounding moves the path. Cutting a run, and saving and restoring it, changes nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

enum { TRIALS = 1000, INEXACT_TRIALS = 400, SAMPLES = 5 };

static const double tick = 1.0 / (1 << 22); /* what doubles between 2^30 and 2^31 are multiples of */

/* -- a run, moved ---------------------------------------------------------------------------------------------------------- */

typedef struct world {
    random_scene base;
    double start; /* of the paths below, which last as long as the run */
    tides_trajectory *camera, *object;
    tides_scene *scene;
} world;

/* The base's path over [start, start + duration]. */
static tides_trajectory *path_over(const tides_trajectory *base, double start, double duration) {
    tides_pose_sample samples[SAMPLES];
    tides_trajectory *path = NULL;
    tides_error error;
    assert_int_equal(tides_trajectory_count(base), SAMPLES);
    for (size_t i = 0; i < SAMPLES; i++) {
        scene_expect_ok(tides_trajectory_sample(base, i, &samples[i], &error), &error);
        samples[i].time = start + samples[i].time * duration; /* exact where a quarter of the duration is */
        samples[i].has_rates = 0;
    }
    scene_expect_ok(tides_trajectory_create(samples, SAMPLES, &path, &error), &error);
    return path;
}

static world make_world(uint64_t seed) {
    world w;
    memset(&w, 0, sizeof w);
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.count = 5;
    recipe.objects = 1;
    recipe.sh_degree = 0;
    recipe.size = 0.3;
    recipe.width = 20; /* 2 x 1 tiles */
    recipe.height = 9;
    recipe.camera_speed = 1;
    w.base = random_scene_make(&recipe);
    return w;
}

/* The camera and one of two objects move. */
static void place(world *w, double start, double duration) {
    tides_object object = scene_object_of(w->base.scene, 0);
    tides_error error;
    w->start = start;
    w->camera = path_over(w->base.path, start, duration);
    w->object = path_over(w->base.path, start, duration);
    scene_expect_ok(tides_scene_create(&w->scene, &error), &error);
    scene_expect_ok(tides_scene_add(w->scene, &object.gaussians, NULL, 1, "still", NULL, &error), &error);
    scene_expect_ok(tides_scene_add(w->scene, &object.gaussians, w->object, 0.5, "moving", NULL, &error), &error);
}

static void take_away(world *w) {
    tides_scene_destroy(w->scene);
    tides_trajectory_destroy(w->camera);
    tides_trajectory_destroy(w->object);
}

static void free_world(world *w) { random_scene_free(&w->base); }

/* What a trial is made of. */
typedef struct triple {
    double start, duration, step_s;
    int mode, sensor;
} triple;

static job job_in(const world *w, const triple *t) {
    job j = job_of(&w->base);
    j.device = "reference";
    j.sensor.threshold_on = j.sensor.threshold_off = 0.4;
    j.scene = w->scene;
    j.path = w->camera;
    j.start = t->start;
    j.stop = t->start + t->duration;
    j.stepping.mode = t->mode;
    j.stepping.step_s = t->step_s;
    j.stepping.min_step_s = t->step_s / 10;
    if (!t->sensor) return j;
    const double rate = fmin(1 / t->duration, 1e5); /* less than parameters go to */
    j.sensor.leak_rate_hz = rate;
    j.sensor.shot_noise_hz = 3 * rate;
    j.sensor.photoreceptor_cutoff_hz = 3 * rate;
    j.sensor.refractory_s = 0.01 * t->duration;
    j.sensor.labels = 1;
    return j;
}

/* Whole, cut by `cuts` - 1 calls, or (cuts < 0) saved and restored between these. */
static outcome run_cut(const job *j, tides_device *device, int cuts, const char *checkpoint) {
    outcome o = {0};
    tides_error error;
    int pieces = abs(cuts);
    tides_simulator *s = make_simulator(j, device);
    for (int k = 1; k <= pieces; k++) {
        double until = k < pieces ? j->start + (j->stop - j->start) * k / pieces : j->stop;
        scene_expect_ok(tides_simulator_run(s, until, collect, &o, NULL, NULL, &error), &error);
        if (cuts > 0 || k == pieces) continue;
        scene_expect_ok(tides_simulator_save(s, NULL, checkpoint, &error), &error);
        tides_simulator_destroy(s);
        s = make_simulator(j, device);
        scene_expect_ok(tides_simulator_restore(s, NULL, checkpoint, &error), &error);
    }
    size_t pixels = (size_t)pixels_of(j);
    o.signal = calloc(pixels, sizeof *o.signal);
    assert_non_null(o.signal);
    tides_simulator_state(s, o.signal, NULL, NULL, NULL);
    tides_simulator_stats(s, &o.stats);
    assert_true(s->step == s->grid.steps); /* it ran to its end */
    if (o.stats.simulated_s != j->stop - j->start) fail_msg("%.17g s of %.17g", o.stats.simulated_s, j->stop - j->start);
    tides_simulator_destroy(s);
    return o;
}

/* The run of a triple, in a world that is there for as long. */
static outcome run_at(world *w, const triple *t, tides_device *device, int cuts, const char *checkpoint) {
    place(w, t->start, t->duration);
    const job j = job_in(w, t);
    outcome o = run_cut(&j, device, cuts, checkpoint);
    take_away(w);
    return o;
}

static size_t pixels_in(const world *w) {
    const job j = job_of(&w->base);
    return (size_t)pixels_of(&j);
}

/* -- triples --------------------------------------------------------------------------------------------------------------- */

/* Steps of a microsecond to a second, up to a dozen and a bit of them, often with a sliver at the end; starts near 0, 1e6 and
 * 1.4e9 s and anywhere to 2e9. Dyadic: all times are multiples of 2^-22 s, and quarters of the duration too. */
static triple random_triple(uint64_t *seed, int dyadic) {
    static const double starts[] = {0.3, 1e6, 1.305031102e9, 1.4e9, 2e9}, steps[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1};
    static const double slivers[] = {0, 0, 1e-12, 1e-7, 1e-4, 9e-4, 1e-2, -1e-7, -1e-3};
    static const int modes[] = {TIDES_STEPPING_FIXED, TIDES_STEPPING_FIXED, TIDES_STEPPING_ERROR, TIDES_STEPPING_ERROR};
    triple t;
    t.step_s = steps[scene_next(seed) % 6] * (scene_next(seed) % 2 ? 1 : 0.5 + scene_between(seed, 0, 1));
    double count = scene_next(seed) % 2 ? (double)(1 + scene_next(seed) % 9) : 0.3 + 9 * scene_between(seed, 0, 1);
    t.duration = t.step_s * (count + slivers[scene_next(seed) % 9]);
    t.start = scene_next(seed) % 3 ? starts[scene_next(seed) % 5] + scene_between(seed, 0, 1) : 2e9 * scene_between(seed, 0, 1);
    t.mode = modes[scene_next(seed) % 4];
    t.sensor = scene_next(seed) % 4 == 0;
    if (t.duration < 4 * tick) t.duration = 4 * tick;
    if (!dyadic) return t;
    t.start = floor(t.start / tick) * tick;
    t.duration = ceil(t.duration / (4 * tick)) * (4 * tick);
    return t;
}

/* -- the tests ------------------------------------------------------------------------------------------------------------- */

/* The same events `start` later; the start in whole nanoseconds is its nearest. */
static void expect_moved(const outcome *early, const outcome *late, const triple *t, size_t pixels) {
    int64_t whole = (int64_t)floor(t->start) * 1000000000, ns = whole + (int64_t)round((t->start - floor(t->start)) * 1e9);
    if (early->count != late->count)
        fail_msg("start %.17g, duration %.17g, step %.17g: %zu events, %zu at 0", t->start, t->duration, t->step_s, late->count,
                 early->count);
    for (size_t k = 0; k < early->count; k++) {
        tides_event moved = early->events[k];
        moved.t += ns;
        if (memcmp(&moved, &late->events[k], sizeof moved) != 0)
            fail_msg("start %.17g, duration %.17g, step %.17g: event %zu at %lld, not %lld ns", t->start, t->duration,
                     t->step_s, k, (long long)late->events[k].t, (long long)moved.t);
    }
    assert_memory_equal(early->signal, late->signal, pixels * sizeof *early->signal);
    assert_true(early->stats.steps == late->stats.steps);
}

static void test_exact_times(void **state) {
    const char *checkpoint = scene_in_folder(*state, "checkpoint.h5");
    world w = make_world(11);
    uint64_t seed = 20261122;
    size_t events = 0, fewest = SIZE_MAX;
    tides_device *device = open_device("reference");
    for (int i = 0; i < TRIALS; i++) {
        triple t = random_triple(&seed, 1), at_zero = t;
        at_zero.start = 0;
        assert_true(t.start + t.duration - t.start == t.duration);
        outcome early = run_at(&w, &at_zero, device, 1, NULL);
        outcome late = run_at(&w, &t, device, i % 40 == 7 ? -3 : 1 + (i % 5 == 3) * 2, checkpoint);
        expect_moved(&early, &late, &t, pixels_in(&w));
        events += early.count;
        fewest = early.count < fewest ? early.count : fewest;
        free_outcome(&early);
        free_outcome(&late);
    }
    print_message("%zu events, at least %zu of a run\n", events, fewest);
    assert_true(fewest > 20);
    tides_device_close(device);
    free_world(&w);
}

/* Any doubles: what differs is how far the rounding of start, stop and samples moves the path within the run. */
static void test_any_times(void **state) {
    const char *checkpoint = scene_in_folder(*state, "checkpoint.h5");
    world w = make_world(12);
    uint64_t seed = 7;
    tides_device *device = open_device("reference");
    for (int i = 0; i < INEXACT_TRIALS; i++) {
        triple t = random_triple(&seed, 0), at_zero = t;
        const double rounding = nextafter(t.start + t.duration, INFINITY) - (t.start + t.duration);
        if (t.duration < 20 * rounding) t.duration = at_zero.duration = 20 * rounding; /* its samples must be told apart */
        t.mode = at_zero.mode = TIDES_STEPPING_FIXED;                                  /* others may halve a step more */
        t.sensor = at_zero.sensor = 0;
        at_zero.start = 0;
        outcome early = run_at(&w, &at_zero, device, 1, NULL);
        outcome late = run_at(&w, &t, device, i % 40 == 7 ? -3 : 1, checkpoint);
        int64_t first = (int64_t)floor(t.start) * 1000000000;
        for (size_t k = 0; k < late.count; k++)
            assert_true(late.events[k].t >= first && late.events[k].t - first <= (int64_t)((2 + t.duration) * 1e9));
        double most = 0;
        for (size_t p = 0; p < pixels_in(&w); p++) most = fmax(most, fabs(late.signal[p] - early.signal[p]));
        /* The path ends a rounding of the stop away from where it should: S goes by less than 60 over the run. */
        if (!(most <= 60 * 2 * rounding / t.duration + 1e-9))
            fail_msg("start %.17g, duration %.17g, step %.17g: S is off by %g", t.start, t.duration, t.step_s, most);
        free_outcome(&early);
        free_outcome(&late);
    }
    tides_device_close(device);
    free_world(&w);
}

/* Microseconds at 2e9 s, where doubles are 0.24 us apart: the steps are as even as near 0, and so are the events. */
static void test_steps_below_the_rounding(void **state) {
    (void)state;
    world w = make_world(13);
    const triple t = {2e9 + 0.5, 64 * tick, 0.1e-6, TIDES_STEPPING_FIXED, 0};
    tides_device *device = open_device("reference");
    outcome o = run_at(&w, &t, device, 1, NULL);
    assert_true(o.stats.steps == 2 * (uint64_t)ceil(t.duration / t.step_s)); /* 2 tiles */
    size_t between = 0;
    for (size_t k = 0; k < o.count; k++) between += (o.events[k].t - INT64_C(2000000000500000000)) % 238 > 1;
    assert_true(o.count > 100);
    assert_true(between > o.count / 2);
    free_outcome(&o);
    tides_device_close(device);
    free_world(&w);
}

/* Before time 0 as after it. */
static void test_negative_times(void **state) {
    (void)state;
    world w = make_world(14);
    const triple zero = {0, 0.0625, 0.01, TIDES_STEPPING_ERROR, 1},
                 negative = {-5.03125, 0.0625, 0.01, TIDES_STEPPING_ERROR, 1};
    tides_device *device = open_device("reference");
    outcome early = run_at(&w, &zero, device, 1, NULL);
    outcome late = run_at(&w, &negative, device, 2, NULL);
    expect_moved(&early, &late, &negative, pixels_in(&w));
    free_outcome(&early);
    free_outcome(&late);
    tides_device_close(device);
    free_world(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(test_exact_times, scene_folder_setup,
                                                                       scene_folder_teardown),
                                       cmocka_unit_test_setup_teardown(test_any_times, scene_folder_setup,
                                                                       scene_folder_teardown),
                                       cmocka_unit_test(test_steps_below_the_rounding), cmocka_unit_test(test_negative_times)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
