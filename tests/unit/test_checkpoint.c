/* Checkpoints: a run that is cut, saved and restored in a new simulator gives the same events, state and totals to the bit,
 * wherever it is cut; damaged files and files of other runs are refused with one line that says why. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "solver/td_checkpoint.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static const uint64_t SEED = 4711;

static uint64_t random_next(uint64_t *state) { /* splitmix64 */
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* -- running ----------------------------------------------------------------------------------------------------------------- */

enum { WIDTH = 43, HEIGHT = 37, PIXELS = WIDTH * HEIGHT };

/* What to simulate; `change` spoils it. */
typedef struct job {
    const char *device;
    random_scene scene;
    tides_image_params image;
    tides_intrinsics camera;
    tides_sensor sensor;
    tides_stepping stepping;
    double start, stop;
} job;

static random_scene make_scene(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.objects = 2;
    recipe.sh_degree = 1;
    recipe.width = WIDTH;
    recipe.height = HEIGHT;
    recipe.size = 0.2;
    recipe.camera_speed = 2;
    return random_scene_make(&recipe);
}

/* 16 steps, the last one shorter. */
static job make_job(int mode, const char *device) {
    job j = {.device = device, .scene = make_scene(SEED), .start = 0.2, .stop = 0.2795};
    j.camera = j.scene.camera;
    tides_image_params_defaults(&j.image);
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    j.sensor.threshold_on = 0.1;
    j.sensor.threshold_off = 0.13;
    j.stepping.mode = mode;
    j.stepping.step_s = 5e-3;
    j.stepping.tolerance = 0.01;
    return j;
}

static void free_job(job *j) { random_scene_free(&j->scene); }

/* What came out. */
typedef struct outcome {
    tides_event *events;
    size_t count, capacity;
    double signal[PIXELS], reference[PIXELS];
    uint32_t on[PIXELS], off[PIXELS];
    tides_stats stats;
} outcome;

static int collect(void *user, const tides_event *events, size_t count) {
    outcome *o = user;
    scene_expect_ok(td_reserve((void **)&o->events, &o->capacity, o->count + count, sizeof *events, NULL), NULL);
    memcpy(o->events + o->count, events, count * sizeof *events);
    o->count += count;
    return 0;
}

static outcome *new_outcome(void) {
    outcome *o = calloc(1, sizeof *o);
    assert_non_null(o);
    return o;
}

static void free_outcome(outcome *o) {
    free(o->events);
    free(o);
}

static tides_device *open_device(const job *j) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open(j->device, &device, &error);
    if (status == TIDES_NO_DEVICE) return NULL;
    scene_expect_ok(status, &error);
    return device;
}

static tides_simulator *make_simulator(const job *j, tides_device *device) {
    tides_simulator *s = NULL;
    tides_error error;
    scene_expect_ok(tides_simulator_create(device, j->scene.scene, j->scene.path, &j->camera, &j->image, &j->sensor, &j->stepping,
                                           j->start, j->stop, NULL, NULL, &s, &error),
                    &error);
    return s;
}

static void advance(tides_simulator *s, double until, outcome *o) {
    tides_error error;
    scene_expect_ok(tides_simulator_run(s, until, collect, o, NULL, NULL, &error), &error);
}

static void finish(tides_simulator *s, outcome *o) {
    tides_simulator_state(s, o->signal, o->reference, o->on, o->off);
    tides_simulator_stats(s, &o->stats);
    tides_simulator_destroy(s);
}

static outcome *run_whole(const job *j, tides_device *device) {
    outcome *o = new_outcome();
    tides_simulator *s = make_simulator(j, device);
    advance(s, j->stop, o);
    finish(s, o);
    assert_true(o->count > 1000);
    return o;
}

/* Cuts `*s` here: saved, gone, and restored in a new one. */
static void cut(const job *j, tides_device *device, const char *path, tides_simulator **s) {
    tides_error error;
    scene_expect_ok(tides_simulator_save(*s, "{}", path, &error), &error);
    tides_simulator_destroy(*s);
    *s = make_simulator(j, device);
    scene_expect_ok(tides_simulator_restore(*s, "{}", path, &error), &error);
}

static void expect_same(const outcome *a, const outcome *b) {
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->events, b->events, a->count * sizeof *a->events);
    assert_memory_equal(a->signal, b->signal, sizeof a->signal);
    assert_memory_equal(a->reference, b->reference, sizeof a->reference);
    assert_memory_equal(a->on, b->on, sizeof a->on);
    assert_memory_equal(a->off, b->off, sizeof a->off);
}

/* Totals that don't depend on how launches are put together; and none that starts again. */
static void expect_same_totals(const tides_stats *a, const tides_stats *b) {
    assert_true(a->events == b->events && a->events_on == b->events_on && a->events_off == b->events_off);
    assert_true(a->events_truncated == b->events_truncated && a->events_caught_up == b->events_caught_up);
    assert_true(a->steps == b->steps && a->steps_rejected == b->steps_rejected && a->steps_at_minimum == b->steps_at_minimum);
    assert_true(a->worst_error == b->worst_error && a->worst_residual == b->worst_residual);
    assert_true(a->error_p50_s == b->error_p50_s && a->error_p99_s == b->error_p99_s);
    assert_true(a->simulated_s == b->simulated_s);
    assert_true(a->renders_full_frame_equivalent == b->renders_full_frame_equivalent);
    assert_true(b->render.gaussians_projected > a->render.gaussians_projected / 4);
    assert_true(b->render.pairs_evaluated > a->render.pairs_evaluated / 4);
    assert_true(b->run_time_s > 0 && b->time_compare_s > 0);
}

/* -- cutting ----------------------------------------------------------------------------------------------------------------- */

static const struct {
    int mode;
    const char *device;
} kinds[] = {
    {TIDES_STEPPING_FIXED, "reference"}, {TIDES_STEPPING_ERROR, "reference"},
    {TIDES_STEPPING_FIXED, "cpu"},       {TIDES_STEPPING_ERROR, "cpu"},
};

static void test_cut_at_every_step(void **state) {
    const char *path = scene_in_folder(*state, "every.checkpoint");
    char kept[4096];
    snprintf(kept, sizeof kept, "%s", path);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        job j = make_job(kinds[k].mode, kinds[k].device);
        tides_device *device = open_device(&j);
        if (device) {
            outcome *whole = run_whole(&j, device), *pieces = new_outcome();
            tides_simulator *s = make_simulator(&j, device);
            for (int64_t step = 0; step <= s->steps; step++) {
                advance(s, td_grid_time(s, step), pieces);
                cut(&j, device, kept, &s);
                assert_true(s->step == step);
            }
            advance(s, j.stop, pieces); /* nothing is left */
            finish(s, pieces);
            expect_same(whole, pieces);
            expect_same_totals(&whole->stats, &pieces->stats);
            free_outcome(whole);
            free_outcome(pieces);
        }
        tides_device_close(device);
        free_job(&j);
    }
}

/* Like a progress bar whose user presses Ctrl-C now and then: `user` counts down the calls. */
static int stop_after(void *user, double fraction, const char *stage) {
    int *calls = user;
    (void)fraction;
    (void)stage;
    return --*calls == 0;
}

/* At times in the run, and at stops by progress, which come wherever a packet ends. */
static void test_cut_anywhere(void **state) {
    uint64_t random = SEED;
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "any.checkpoint"));
    print_message("seed %llu\n", (unsigned long long)SEED);
    for (size_t k = 0; k < 12; k++) {
        job j = make_job(kinds[k % 2].mode, "reference-f32");
        tides_device *device = open_device(&j);
        outcome *whole = run_whole(&j, device), *pieces = new_outcome();
        tides_simulator *s = make_simulator(&j, device);
        for (double until = j.start; until < j.stop; until += (double)(random_next(&random) % 1000) * 4e-5) {
            advance(s, until, pieces);
            if (random_next(&random) % 2) cut(&j, device, path, &s);
            int calls = 1 + (int)(random_next(&random) % 3);
            tides_status status = tides_simulator_run(s, until + 0.01, collect, pieces, stop_after, &calls, NULL);
            assert_true(status == TIDES_OK || status == TIDES_CANCELLED);
            if (status == TIDES_CANCELLED) cut(&j, device, path, &s);
        }
        advance(s, j.stop, pieces);
        finish(s, pieces);
        expect_same(whole, pieces);
        expect_same_totals(&whole->stats, &pieces->stats);
        free_outcome(whole);
        free_outcome(pieces);
        tides_device_close(device);
        free_job(&j);
    }
}

/* Pixels that have fired nothing keep a negative zero and a NaN. */
static void test_bits_of_pixels(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "bits.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference");
    tides_device *device = open_device(&j);
    tides_simulator *s = make_simulator(&j, device);
    outcome *before = new_outcome(), *after = new_outcome();
    advance(s, j.start, before);
    const double odd[] = {-0.0, (double)NAN, (double)INFINITY, 5e-324, 0.1 + 0.2};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        s->pixels.initial[i] = s->pixels.reference[i] = s->now.S[i] = s->now.S_dot[i] = odd[i];
    s->pixels.count_on[3] = UINT32_MAX;
    s->pixels.count_off[3] = UINT32_MAX - 1;
    s->pixels.reference[3] = td_reference(&s->comparator, 5e-324, UINT32_MAX, UINT32_MAX - 1);
    tides_simulator_state(s, before->signal, before->reference, before->on, before->off);
    cut(&j, device, path, &s);
    tides_simulator_state(s, after->signal, after->reference, after->on, after->off);
    expect_same(before, after);
    tides_simulator_destroy(s);
    free_outcome(before);
    free_outcome(after);
    tides_device_close(device);
    free_job(&j);
}

/* -- what is refused --------------------------------------------------------------------------------------------------------- */

/* A checkpoint of `j` in the middle of its run, with the run's text. */
static void save_middle(const job *j, const char *run, const char *path) {
    tides_device *device = open_device(j);
    tides_simulator *s = make_simulator(j, device);
    outcome *o = new_outcome();
    tides_error error;
    advance(s, 0.2401, o);
    scene_expect_ok(tides_simulator_save(s, run, path, &error), &error);
    tides_simulator_destroy(s);
    free_outcome(o);
    tides_device_close(device);
}

/* Restoring `path` in a simulator of `j` ends with `wanted` and a text of these words, and leaves the simulator as it was. */
static void refuse(const job *j, const char *run, const char *path, tides_status wanted, const char *words) {
    tides_device *device = open_device(j);
    tides_simulator *s = make_simulator(j, device);
    tides_error error = {0};
    scene_expect_error(tides_simulator_restore(s, run, path, &error), wanted, &error, words);
    assert_false(s->started);
    assert_true(s->step == 0 && s->counts.events_on == 0);
    tides_simulator_destroy(s);
    tides_device_close(device);
}

static void accept(const job *j, const char *run, const char *path) {
    tides_device *device = open_device(j);
    tides_simulator *s = make_simulator(j, device);
    tides_error error = {0};
    scene_expect_ok(tides_simulator_restore(s, run, path, &error), &error);
    assert_true(s->step == 8);
    tides_simulator_destroy(s);
    tides_device_close(device);
}

static void test_damage(void **state) {
    char path[4096], spoilt[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "good.checkpoint"));
    snprintf(spoilt, sizeof spoilt, "%s", scene_in_folder(*state, "spoilt.checkpoint"));
    job j = make_job(TIDES_STEPPING_ERROR, "reference-f32");
    save_middle(&j, NULL, path);
    accept(&j, NULL, path);
    size_t size, lengths[] = {0, 1, 34, 35, 36, 2000, 0, 0};
    char *bytes = scene_file_read(path, &size);
    lengths[6] = size - 1;
    lengths[7] = size - 35; /* the HDF5 file alone */
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        scene_file_write(spoilt, bytes, lengths[i]);
        refuse(&j, NULL, spoilt, TIDES_BAD_FILE, "spoilt.checkpoint|damaged or cut short");
    }
    uint64_t random = SEED;
    for (int i = 0; i < 300; i++) {
        size_t at = i == 0 ? 0 : i == 1 ? size - 1 : (size_t)(random_next(&random) % size);
        char bit = (char)(1 << random_next(&random) % 8);
        bytes[at] = (char)(bytes[at] ^ bit);
        scene_file_write(spoilt, bytes, size);
        hid_t image = -1;
        tides_error error;
        scene_expect_error(td_checkpoint_image_read(spoilt, &image, &error), TIDES_BAD_FILE, &error, "seal");
        bytes[at] = (char)(bytes[at] ^ bit);
    }
    scene_file_write(spoilt, "not a checkpoint", 16);
    refuse(&j, NULL, spoilt, TIDES_BAD_FILE, "isn't a checkpoint");
    refuse(&j, NULL, scene_in_folder(*state, "none"), TIDES_FILE_NOT_FOUND, "none|can't be opened");
    refuse(&j, NULL, *state, TIDES_BAD_FILE, "more than");
    free(bytes);
    free_job(&j);
}

/* Each of these is another run. */
static void test_other_runs(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "run.checkpoint"));
    job j = make_job(TIDES_STEPPING_ERROR, "reference-f32");
    save_middle(&j, NULL, path);
#define OTHER(assignment, words)                                 \
    do {                                                         \
        job other = make_job(TIDES_STEPPING_ERROR, j.device);    \
        other.assignment;                                        \
        refuse(&other, NULL, path, TIDES_BAD_CONFIG, words);     \
        free_job(&other);                                        \
    } while (0)
    OTHER(camera.width = 44, "run.checkpoint|another run|camera.width is 43 there and 44 here");
    OTHER(camera.height = 20, "camera.height is 37 there and 20 here");
    OTHER(camera.cx += 0.25, "image parameters or intrinsics changed");
    OTHER(image.log_eps = 0.002, "image parameters or intrinsics changed");
    OTHER(image.background[1] = 0.5, "image parameters or intrinsics changed");
    OTHER(image.rules = TIDES_RULES_INRIA, "image parameters or intrinsics changed");
    OTHER(sensor.threshold_on = 0.2, "sensor.threshold_on is 0.1 there and 0.2 here");
    OTHER(sensor.threshold_off = 0.1, "sensor.threshold_off is 0.13 there and 0.1 here");
    OTHER(sensor.max_events_per_step = 3, "sensor.max_events_per_step is 64 there and 3 here");
    OTHER(stepping.mode = TIDES_STEPPING_FIXED, "stepping.mode is 2 there and 0 here");
    OTHER(stepping.step_s = 2e-3, "stepping.step_s is 0.005 there and 0.002 here");
    OTHER(stepping.min_step_s = 1e-4, "stepping.min_step_s");
    OTHER(stepping.tolerance = 0.02, "stepping.tolerance is 0.01 there and 0.02 here");
    OTHER(stepping.time_tolerance_s = 1e-4, "stepping.time_tolerance_s");
    OTHER(stepping.local = 0, "stepping.local is 1 there and 0 here");
    OTHER(start = 0.195, "time.start is 0.2 there and 0.195 here");
    OTHER(stop = 0.23, "was made at 0.24 s, after time.stop = 0.23 s");
    OTHER(device = "reference", "precision of the device in bits is 32 there and 64 here");
    random_scene scene = make_scene(SEED + 1), kept = j.scene;
    j.scene.scene = scene.scene;
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "the scene changed");
    j.scene = kept;
    j.scene.path = scene.path;
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "the camera path changed");
    j.scene = kept;
    j.device = "cpu"; /* as precise: may go on */
    tides_device *cpu = open_device(&j);
    tides_device_close(cpu);
    if (cpu) accept(&j, NULL, path);
    random_scene_free(&scene);
    free_job(&j);
}

static void test_run_files(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "json.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference-f32");
    save_middle(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0, \"stop\": 1}, \"objects\": [{\"file\": \"a\"}]}", path);
    accept(&j, NULL, path);
    accept(&j, "{\"device\": \"cpu\", \"seed\": \"1\", \"time\": {\"stop\": 2, \"start\": 0}, \"objects\": [{\"file\": \"a\"}]}", path);
    refuse(&j, "{\"seed\": \"2\", \"time\": {\"start\": 0}, \"objects\": [{\"file\": \"a\"}]}", path, TIDES_BAD_CONFIG,
           "seed is \"1\" there and \"2\" here");
    refuse(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0.5}, \"objects\": [{\"file\": \"a\"}]}", path, TIDES_BAD_CONFIG,
           "time.start is 0 there and 0.5 here");
    refuse(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0}, \"objects\": [{\"file\": \"b\"}]}", path, TIDES_BAD_CONFIG,
           "objects is [{\"file\":\"a\"}] there and [{\"file\":\"b\"}] here");
    refuse(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0}}", path, TIDES_BAD_CONFIG, "objects is|here|not set");
    refuse(&j, "{\"seed\": \"1\", \"new\": 1, \"time\": {\"start\": 0}, \"objects\": [{\"file\": \"a\"}]}", path, TIDES_BAD_CONFIG,
           "new is not set there and 1 here");
    refuse(&j, "{", path, TIDES_BAD_ARGUMENT, "isn't JSON");
    free_job(&j);
}

/* Rewrites an attribute, as other versions would, and seals the file again. */
static void edit(const char *path, const char *attribute, int32_t value) {
    size_t size;
    char *bytes = scene_file_read(path, &size), seal[36];
    scene_file_write(path, bytes, size - 35);
    free(bytes);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), id = H5Aopen(file, attribute, H5P_DEFAULT);
    assert_true(H5Awrite(id, H5T_NATIVE_INT32, &value) >= 0);
    H5Aclose(id);
    H5Fclose(file);
    bytes = scene_file_read(path, &size);
    snprintf(seal, sizeof seal, "\ntides-checkpoint %016llx\n", (unsigned long long)td_checksum(0, bytes, size));
    bytes = realloc(bytes, size + 35);
    assert_non_null(bytes);
    memcpy(bytes + size, seal, 35);
    scene_file_write(path, bytes, size + 35);
    free(bytes);
}

static void test_versions_and_nonsense(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "edited.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference-f32");
    save_middle(&j, NULL, path);
    edit(path, "version", TD_CHECKPOINT_VERSION);
    accept(&j, NULL, path);
    edit(path, "version", TD_CHECKPOINT_VERSION + 1);
    refuse(&j, NULL, path, TIDES_UNSUPPORTED, "edited.checkpoint|version 2|reads version 1");
    edit(path, "version", TD_CHECKPOINT_VERSION);
    edit(path, "step", -1);
    refuse(&j, NULL, path, TIDES_BAD_FILE, "step is -1");
    edit(path, "step", 7);
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "no end of a step");
    edit(path, "step", 1000);
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "after time.stop");
    free_job(&j);
}

/* -- other stops ------------------------------------------------------------------------------------------------------------- */

static void test_extending(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "longer.checkpoint"));
    job j = make_job(TIDES_STEPPING_ERROR, "reference-f32"), longer = make_job(TIDES_STEPPING_ERROR, "reference-f32");
    longer.stop = 0.311;
    tides_device *device = open_device(&j);
    outcome *whole = run_whole(&longer, device), *pieces = new_outcome();
    tides_simulator *s = make_simulator(&j, device);
    advance(s, 0.26, pieces);
    cut(&longer, device, path, &s);
    advance(s, longer.stop, pieces);
    finish(s, pieces);
    expect_same(whole, pieces);
    /* A run at its end stands where its stop cut a step short: that step isn't one of a longer run. */
    s = make_simulator(&j, device);
    advance(s, j.stop, pieces);
    tides_error error;
    scene_expect_ok(tides_simulator_save(s, NULL, path, &error), &error);
    tides_simulator_destroy(s);
    refuse(&longer, NULL, path, TIDES_BAD_CONFIG, "no end of a step now that time.stop is 0.311 s");
    free_outcome(whole);
    free_outcome(pieces);
    tides_device_close(device);
    free_job(&j);
    free_job(&longer);
}

/* -- misuse ------------------------------------------------------------------------------------------------------------------ */

static void test_misuse(void **state) {
    char path[4096], nowhere[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "kept.checkpoint"));
    snprintf(nowhere, sizeof nowhere, "%s", scene_in_folder(*state, "none/x.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference-f32");
    tides_device *device = open_device(&j);
    tides_simulator *s = make_simulator(&j, device);
    outcome *o = new_outcome();
    tides_error error = {0};
    scene_expect_error(tides_simulator_save(s, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "hasn't begun");
    scene_expect_error(tides_simulator_save(s, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "must be given");
    scene_expect_error(tides_simulator_restore(NULL, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "must be given");
    advance(s, 0.2401, o);
    scene_expect_error(tides_simulator_save(s, NULL, nowhere, &error), TIDES_WRITE_FAILED, &error, "x.checkpoint|can't be written");
    scene_expect_ok(tides_simulator_save(s, NULL, path, &error), &error);
    scene_expect_error(tides_simulator_restore(s, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "has run already");
    assert_int_equal(access(scene_in_folder(*state, "kept.checkpoint.part"), F_OK), -1);
    s->broken = 1;
    scene_expect_error(tides_simulator_save(s, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "half done");
    tides_simulator_destroy(s);
    accept(&j, NULL, path); /* none of that has touched it */
    free_outcome(o);
    tides_device_close(device);
    free_job(&j);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_cut_at_every_step, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_cut_anywhere, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_bits_of_pixels, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_damage, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_other_runs, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_run_files, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_versions_and_nonsense, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_extending, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_misuse, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("checkpoints", tests, NULL, NULL);
}
