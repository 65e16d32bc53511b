/* Guards the bits: a fixed list of runs (runs_list.h) gives the events whose number and hash are in runs.txt, so that changes
 * which aren't meant to change an event don't. It has every stepping mode and model, image rules, motion model, block of the
 * sensor, method and readout; scenes and frames; the cpu device if there is one, to the same bits as the float reference; and
 * runs that are resumed.
 *
 * A change that is meant to change events writes runs.txt anew: TIDES_WRITE=1 build/release/tests/golden/test_runs. It raises
 * TIDES_NUMERICS (include/tides/base.h), and its commit says why. The hashes hold for x86-64 with and without FMA and for
 * aarch64: events don't depend on libm. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "runs_list.h"
#include "tests/support/opencl.h"
#include "tests/support/run_worlds.h"
#include "tests/support/scene_folder.h"
#include "tides/run.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char FILE_NAME[] = "tests/golden/runs.txt";

/* -- what came out --------------------------------------------------------------------------------------------------- */

/* A stream in two numbers. The hash is FNV-1a, 64 bits, over each event's fields, little-endian: written here again, so that
 * the guard leans on nothing that it guards. */
typedef struct stream {
    uint64_t count, hash;
    const tides_simulator *simulator; /* asked when events fired; NULL: a method on frames */
} stream;

static stream stream_of(void) { return (stream){0, UINT64_C(0xcbf29ce484222325), NULL}; }

static void mix(uint64_t *hash, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) *hash = (*hash ^ (value >> (8 * i) & 0xff)) * UINT64_C(0x100000001b3);
}

static int take(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    const int64_t *fired = s->simulator ? tides_simulator_fired(s->simulator) : NULL;
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &events[i];
        mix(&s->hash, (uint64_t)e->t, 8);
        mix(&s->hash, e->x, 2);
        mix(&s->hash, e->y, 2);
        mix(&s->hash, (uint8_t)e->polarity, 1);
        mix(&s->hash, e->cause, 1);
        mix(&s->hash, e->frontend, 2);
        mix(&s->hash, (uint64_t)(fired ? fired[i] : e->t), 8);
    }
    s->count += count;
    return 0;
}

/* -- running --------------------------------------------------------------------------------------------------------- */

/* `settings` are cut at their spaces into `out`, whose texts lie in `text`. */
static size_t cut(const char *settings, char *text, const char **out, size_t capacity) {
    size_t count = 0;
    strcpy(text, settings);
    for (char *word = strtok(text, " "); word; word = strtok(NULL, " ")) {
        assert_true(count < capacity);
        out[count++] = word;
    }
    return count;
}

static tides_run *settings_of(const run_entry *entry, tides_run_values *values) {
    char text[4096];
    const char *words[64];
    tides_run *run = NULL;
    tides_error error;
    char all[2048];
    /* Files that nobody opens: a run file must name some. */
    const char *inputs = entry->flags & RUN_SEQUENCE ? "frames.file=none" : "scene.file=none camera.file=none";
    assert_true((size_t)snprintf(all, sizeof all, "%s %s %s", common, inputs, entry->settings) < sizeof all);
    size_t count = cut(all, text, words, sizeof words / sizeof *words);
    scene_expect_ok(tides_run_parse("{}", ".", words, count, &run, &error), &error);
    tides_run_get(run, values);
    if (entry->flags & RUN_DIFFERENCE) values->stepping.slope = TIDES_SLOPE_DIFFERENCE;
    return run;
}

static tides_simulator *make_simulator(const run_world *world, const tides_run_values *v, tides_device *device) {
    tides_simulator *s = NULL;
    tides_error error;
    scene_expect_ok(tides_simulator_create(device, world->scene, world->path, &world->camera, &v->image, &v->sensor,
                                           &v->stepping, v->start, v->stop, NULL, NULL, &s, &error),
                    &error);
    scene_expect_ok(tides_simulator_readout(s, &v->readout, &error), &error);
    return s;
}

static void advance(tides_simulator *s, double until, stream *out) {
    tides_error error;
    out->simulator = s;
    scene_expect_ok(tides_simulator_run(s, until, take, out, NULL, NULL, &error), &error);
    out->simulator = NULL;
}

/* The whole run; with a `checkpoint` (a file's name) one that was to stop earlier, within a step, is cut before that step and
 * gone on with by the whole run's simulator: what was to come later has no part in what was before. */
static stream simulate(const run_world *world, const tides_run_values *v, tides_device *device, const char *checkpoint) {
    stream out = stream_of();
    tides_error error;
    tides_run_values shorter = *v;
    if (checkpoint) shorter.stop = v->start + 0.78 * (v->stop - v->start);
    tides_simulator *s = make_simulator(world, &shorter, device);
    if (checkpoint) {
        advance(s, 0.5 * (v->start + v->stop), &out);
        scene_expect_ok(tides_simulator_save(s, NULL, checkpoint, &error), &error);
        tides_simulator_destroy(s);
        s = make_simulator(world, v, device);
        scene_expect_ok(tides_simulator_restore(s, NULL, checkpoint, &error), &error);
    }
    advance(s, v->stop, &out);
    tides_simulator_destroy(s);
    return out;
}

/* A baseline on a scene's renders. */
static stream render_frames(const run_world *world, const tides_run_values *v, tides_device *device) {
    stream out = stream_of();
    tides_baseline *baseline = NULL;
    tides_renderer *renderer = NULL;
    tides_error error;
    scene_expect_ok(tides_baseline_create(&v->baseline, RUN_WIDTH, RUN_HEIGHT, &baseline, &error), &error);
    scene_expect_ok(tides_renderer_create(device, world->scene, &world->camera, &v->image, NULL, NULL, &renderer, &error),
                    &error);
    const tides_frame_supply supply = {NULL, renderer, world->path, v->frames_per_second, v->start, v->stop};
    scene_expect_ok(tides_baseline_run(baseline, &supply, take, &out, NULL, NULL, NULL, &error), &error);
    tides_renderer_destroy(renderer);
    tides_baseline_destroy(baseline);
    return out;
}

static void push_frames(tides_baseline *baseline, const tides_run_values *v, stream *out) {
    double *Y = calloc(RUN_FRAMES * RUN_HEIGHT * RUN_WIDTH, sizeof *Y), times[RUN_FRAMES];
    tides_frames *frames = NULL;
    tides_error error;
    assert_non_null(Y);
    run_frames(Y, times);
    scene_expect_ok(tides_frames_from_memory(Y, times, RUN_FRAMES, RUN_WIDTH, RUN_HEIGHT, &frames, &error), &error);
    const tides_frame_supply supply = {frames, NULL, NULL, 0, v->start, v->stop};
    scene_expect_ok(tides_baseline_run(baseline, &supply, take, out, NULL, NULL, NULL, &error), &error);
    tides_frames_close(frames);
    free(Y);
}

static void push_voxels(tides_baseline *baseline, const tides_run_values *v, stream *out) {
    double *voxels = calloc(RUN_VOXELS * RUN_HEIGHT * RUN_WIDTH, sizeof *voxels);
    tides_error error;
    assert_non_null(voxels);
    run_voxels(voxels);
    for (int k = 0; k < 2; k++)
        scene_expect_ok(tides_baseline_push(baseline, v->start + k / v->baseline.ldati.fps, voxels, take, out, &error), &error);
    scene_expect_ok(tides_baseline_finish(baseline, take, out, &error), &error);
    free(voxels);
}

static stream see_sequence(const tides_run_values *v) {
    stream out = stream_of();
    tides_baseline *baseline = NULL;
    tides_error error;
    scene_expect_ok(tides_baseline_create(&v->baseline, RUN_WIDTH, RUN_HEIGHT, &baseline, &error), &error);
    if (v->baseline.method == TIDES_METHOD_LDATI)
        push_voxels(baseline, v, &out);
    else
        push_frames(baseline, v, &out);
    tides_baseline_destroy(baseline);
    return out;
}

/* `spec` is the entry's device, or another. */
static stream run_entry_on(const run_entry *entry, const char *spec, const char *checkpoint) {
    tides_run_values values;
    tides_device *device = NULL;
    tides_error error;
    stream out;
    tides_run *run = settings_of(entry, &values);
    if (entry->flags & RUN_SEQUENCE) {
        out = see_sequence(&values);
    } else {
        run_world world = run_world_make(entry->world);
        scene_expect_ok(tides_device_open(spec, &device, &error), &error);
        out = values.baseline.method == TIDES_METHOD_TIDES ? simulate(&world, &values, device, checkpoint)
                                                           : render_frames(&world, &values, device);
        tides_device_close(device);
        run_world_free(&world);
    }
    tides_run_destroy(run);
    return out;
}

/* -- comparing ------------------------------------------------------------------------------------------------------- */

static stream expected[RUNS], found[RUNS];
static int has_line[RUNS];

static int writes(void) { return getenv("TIDES_WRITE") != NULL; }

static int index_of(const char *name) {
    for (int i = 0; i < RUNS; i++)
        if (strcmp(runs[i].name, name) == 0) return i;
    return -1;
}

/* Lines "count hash name". */
static int read_expected(void **state) {
    char line[256], name[128];
    FILE *file = fopen(FILE_NAME, "r");
    (void)state;
    if (!file) {
        print_error("%s can't be opened: run from the repository's root\n", FILE_NAME);
        return writes() ? 0 : -1;
    }
    while (fgets(line, sizeof line, file)) {
        uint64_t count, hash;
        if (line[0] == '#' || sscanf(line, "%" SCNu64 " %" SCNx64 " %127[^\n]", &count, &hash, name) != 3) continue;
        int i = index_of(name);
        if (i < 0) {
            print_error("%s: no run is called '%s'\n", FILE_NAME, name);
            if (!writes()) return fclose(file), -1;
            continue;
        }
        has_line[i] = 1;
        expected[i].count = count;
        expected[i].hash = hash;
    }
    return fclose(file);
}

static int write_found(void **state) {
    (void)state;
    if (!writes()) return 0;
    for (int i = 0; i < RUNS; i++)
        if (!found[i].count) return print_error("%s isn't written: a run failed\n", FILE_NAME), -1;
    FILE *file = fopen(FILE_NAME, "w");
    if (!file) return -1;
    fprintf(file, "# Events, hash and name of each run of runs_list.h: written by TIDES_WRITE=1 test_runs, which compares.\n");
    for (int i = 0; i < RUNS; i++)
        fprintf(file, "%7" PRIu64 " %016" PRIx64 " %s\n", found[i].count, found[i].hash, runs[i].name);
    return fclose(file);
}

/* 1 where a way of running entry `i` gave other events than it should. */
static int differs(int i, const char *how, stream out, stream wanted) {
    if (out.count == wanted.count && out.hash == wanted.hash) return 0;
    print_error("%s%s: %" PRIu64 " events, hash %016" PRIx64 "; it should be %" PRIu64 ", %016" PRIx64 "\n", runs[i].name, how,
                out.count, out.hash, wanted.count, wanted.hash);
    return 1;
}

static int run_one(int i, const char *folder) {
    const run_entry *entry = &runs[i];
    int wrong = 0;
    found[i] = run_entry_on(entry, entry->device, NULL);
    if (found[i].count < 20) print_error("%s: only %" PRIu64 " events\n", entry->name, found[i].count), wrong++;
    if (!writes() && !has_line[i]) print_error("%s: not in %s\n", entry->name, FILE_NAME), wrong++;
    if (!writes() && has_line[i]) wrong += differs(i, "", found[i], expected[i]);
    if (entry->flags & RUN_RESUME)
        wrong += differs(i, ", resumed", run_entry_on(entry, entry->device, scene_in_folder((void *)(uintptr_t)folder, "c.h5")),
                         found[i]);
    return wrong;
}

/* All runs of one part; those that differ are all named. */
static void check_part(void **state, const char *part) {
    size_t length = strlen(part);
    int wrong = 0, count = 0;
    for (int i = 0; i < RUNS; i++)
        if (strncmp(runs[i].name, part, length) == 0 && runs[i].name[length] == '/') {
            wrong += run_one(i, *state);
            count++;
        }
    assert_true(count > 0);
    if (wrong)
        fail_msg("%d of %d runs don't give the events that they gave (the head of test_runs.c says what to do)", wrong, count);
}

static void test_stepping(void **state) { check_part(state, "stepping"); }
static void test_image(void **state) { check_part(state, "image"); }
static void test_motion(void **state) { check_part(state, "motion"); }
static void test_generated(void **state) { check_part(state, "generated"); }
static void test_sensor(void **state) { check_part(state, "sensor"); }
static void test_readout(void **state) { check_part(state, "readout"); }
static void test_method(void **state) { check_part(state, "method"); }
static void test_frames(void **state) { check_part(state, "frames"); }

/* The kernels: what the float reference gave above, to the bit. */
static void test_on_cpu(void **state) {
    int wrong = 0;
    (void)state;
    skip_without_opencl();
    for (int i = 0; i < RUNS; i++)
        if (runs[i].flags & RUN_CPU) wrong += differs(i, ", on cpu", run_entry_on(&runs[i], "cpu", NULL), found[i]);
    if (wrong) fail_msg("%d runs differ on the cpu device", wrong);
}

#define PART(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {PART(test_stepping),  PART(test_image),  PART(test_motion),
                                       PART(test_generated), PART(test_sensor), PART(test_readout),
                                       PART(test_method),    PART(test_frames), cmocka_unit_test(test_on_cpu)};
    return cmocka_run_group_tests(tests, read_expected, write_found);
}
