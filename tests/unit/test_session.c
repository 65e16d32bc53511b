/* Sessions: a run file run whole gives the results of its parts by hand, into a sink or a file, in one piece or two. Variations
 * share open inputs, and impossible ones are refused before anything is made. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tides.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char splats[] = "ply\nformat ascii 1.0\ncomment ColourTransfer: linear\nelement vertex 2\n"
                             "property float x\nproperty float y\nproperty float z\n"
                             "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
                             "property float scale_0\nproperty float scale_1\nproperty float scale_2\n"
                             "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
                             "end_header\n0 0 4 1 1 1 2 -1 -1 -1 1 0 0 0\n0.4 0.3 5 2 1 1 2 -2 -2 -2 1 0 0 0\n";
static const char path[] = "0 0 0 0 0 0 0 1\n0.05 0.1 0.02 0 0 0 0 1\n0.1 0.3 0 0 0 0 0 1\n";
static const char run_text[] =
    "{\"scene\": {\"file\": \"two.ply\"}, \"camera\": {\"file\": \"path.txt\", \"width\": 24, \"height\": 18, \"fx\": 20},"
    "\"time\": {\"stop\": 0.1}, \"sensor\": {\"threshold_on\": 0.1, \"threshold_off\": 0.1}, \"device\": \"reference\","
    "\"stepping\": {\"step_s\": 0.005}}";

/* What a sink was given. */
typedef struct stream {
    tides_event events[20000];
    size_t count;
} stream;

static stream one, two;

static int keep(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    assert_true(s->count + count <= sizeof s->events / sizeof s->events[0]);
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

static int refuse(void *user, const tides_event *events, size_t count) {
    (void)user;
    (void)events;
    return count > 0;
}

static void same(const stream *a, const stream *b) {
    assert_true(a->count > 50);
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->events, b->events, a->count * sizeof *a->events);
}

static tides_session *opened(void *folder, const char *const *sets, size_t count) {
    tides_error error = {0, ""};
    tides_session *session = NULL;
    scene_file_write(scene_in_folder(folder, "two.ply"), splats, sizeof splats - 1);
    scene_file_write(scene_in_folder(folder, "path.txt"), path, sizeof path - 1);
    scene_file_write(scene_in_folder(folder, "run.json"), run_text, sizeof run_text - 1);
    scene_expect_ok(tides_session_load(scene_in_folder(folder, "run.json"), sets, count, NULL, &session, &error), &error);
    return session;
}

static void run_into(tides_session *session, stream *s) {
    tides_error error = {0, ""};
    tides_stats stats;
    s->count = 0;
    scene_expect_ok(tides_session_run(session, keep, s, NULL, NULL, &stats, &error), &error);
    assert_int_equal(stats.events_written, s->count);
}

static void read_file(const char *file, stream *s) {
    tides_error error = {0, ""};
    tides_event_reader *reader = NULL;
    size_t got = 1;
    s->count = 0;
    scene_expect_ok(tides_event_reader_open(file, NULL, &reader, &error), &error);
    while (got > 0) {
        scene_expect_ok(tides_event_reader_read(reader, s->events + s->count, 1000, &got, &error), &error);
        s->count += got;
    }
    tides_event_reader_close(reader);
}

static void whole_runs_are_their_parts_by_hand(void **state) {
    tides_error error = {0, ""};
    tides_session *session = opened(*state, NULL, 0);
    tides_session_facts f;
    tides_session_get(session, &f);
    assert_true(f.scene && f.camera && f.device);
    assert_true(!f.frames);
    assert_true(!f.sees_frames);
    assert_int_equal(f.intrinsics.width, 24);
    assert_int_equal(f.info.kind, TIDES_DEVICE_REFERENCE);
    run_into(session, &one);
    tides_simulator *simulator = NULL;
    scene_expect_ok(tides_session_simulator(session, NULL, NULL, &simulator, &error), &error);
    two.count = 0;
    scene_expect_ok(tides_simulator_run(simulator, 0.04, keep, &two, NULL, NULL, &error), &error);
    scene_expect_ok(tides_simulator_run(simulator, 0.1, keep, &two, NULL, NULL, &error), &error);
    tides_simulator_destroy(simulator);
    same(&one, &two);
    tides_renderer *renderer = NULL;
    scene_expect_ok(tides_session_renderer(session, NULL, NULL, &renderer, &error), &error);
    tides_renderer_destroy(renderer);
    assert_int_equal(tides_session_run(session, refuse, NULL, NULL, NULL, NULL, &error), TIDES_CANCELLED);
    tides_session_close(session);
    tides_session_close(NULL);
}

/* A progress that stops at a fraction. */
static int stop_at(void *at, double fraction, const char *stage) {
    return strcmp(stage, "simulating") == 0 && fraction >= *(const double *)at;
}

static void a_file_stopped_goes_on(void **state) {
    tides_error error = {0, ""};
    tides_session *session = opened(*state, NULL, 0);
    const char *file = scene_in_folder(*state, "events.h5");
    char checkpoint[512];
    snprintf(checkpoint, sizeof checkpoint, "%s.checkpoint", file);
    run_into(session, &one);
    tides_stats stats;
    tides_recorded done;
    scene_expect_ok(tides_session_write(session, file, NULL, NULL, NULL, &done, &stats, &error), &error);
    assert_true(done.events == one.count);
    assert_true(done.complete);
    assert_true(!done.saved);
    assert_true(stats.events == one.count);
    read_file(file, &two);
    same(&one, &two);
    tides_recording how;
    tides_recording_defaults(&how);
    double half = 0.5;
    how.resume = 1;
    tides_status status = tides_session_write(session, file, &how, NULL, NULL, &done, NULL, &error);
    scene_expect_error(status, TIDES_FILE_NOT_FOUND, &error, "events.h5.checkpoint");
    how.resume = 0;
    status = tides_session_write(session, file, &how, stop_at, &half, &done, NULL, &error);
    assert_int_equal(status, TIDES_CANCELLED);
    assert_true(done.began && done.saved);
    assert_true(!done.complete);
    assert_true(done.events > 0);
    assert_true(done.events < one.count);
    assert_int_equal(access(checkpoint, F_OK), 0);
    how.resume = 1;
    how.checkpoint_s = 1e-9; /* and with checkpoints all the way */
    scene_expect_ok(tides_session_write(session, file, &how, NULL, NULL, &done, &stats, &error), &error);
    assert_true(done.resumed_s > 0);
    assert_true(done.complete);
    assert_true(done.events == one.count);
    assert_true(stats.events == one.count);
    assert_int_not_equal(access(checkpoint, F_OK), 0);
    read_file(file, &two);
    same(&one, &two);
    tides_session_close(session);
}

/* A run that ended at `stop` [s], within a step or at a step's end, with its checkpoint kept. */
static void write_shorter(void *folder, const char *file, const char *const *sets, size_t count, const char *stop) {
    tides_error error = {0, ""};
    const char *all[8];
    tides_recording how;
    tides_recorded done;
    for (size_t i = 0; i < count; i++) all[i] = sets[i];
    all[count] = stop;
    tides_session *session = opened(folder, all, count + 1);
    tides_recording_defaults(&how);
    how.keep_checkpoint = 1;
    how.checkpoint_s = 0; /* none on the way */
    scene_expect_ok(tides_session_write(session, file, &how, NULL, NULL, &done, NULL, &error), &error);
    assert_true(done.complete && done.saved);
    tides_session_close(session);
}

static void expect_whole(const char *file, const tides_session *session) {
    tides_session_facts f;
    tides_event_reader *reader = NULL;
    tides_event_facts facts;
    tides_error error = {0, ""};
    tides_session_get(session, &f);
    read_file(file, &two);
    scene_expect_ok(tides_events_labels(file, 0, two.count, two.events, NULL, &error), &error);
    same(&one, &two);
    scene_expect_ok(tides_event_reader_open(file, NULL, &reader, &error), &error);
    tides_event_reader_facts(reader, &facts);
    assert_true(facts.stop_ns == 100000000 && facts.count == one.count && facts.start_ns == 0);
    tides_event_reader_close(reader);
}

/* A longer run goes on where a finished one kept its checkpoint, to the bit, with readout, labels and ground truth too; stopped
 * on the way it leaves the shorter file as it was. */
static void a_finished_file_is_extended(void **state) {
    static const char *const plain[] = {"stepping.mode=error"}, *const much[] = {"readout.enabled=true", "sensor.labels=true",
                                                                                 "sensor.truth=true", "frontend.noise_rms=0.02",
                                                                                 "sensor.leak_rate_hz=5"};
    static const char *const stops[] = {"time.stop=0.05", "time.stop=0.0523", "time.stop=0.002", "time.stop=0.0999"};
    tides_error error = {0, ""};
    for (size_t k = 0; k < 8; k++) {
        const char *const *sets = k % 2 ? much : plain;
        const size_t count = k % 2 ? 5 : 1;
        char file[512], checkpoint[600], part[600];
        snprintf(file, sizeof file, "%s", scene_in_folder(*state, "longer.h5"));
        snprintf(checkpoint, sizeof checkpoint, "%s.checkpoint", file);
        snprintf(part, sizeof part, "%s.part", file);
        write_shorter(*state, file, sets, count, stops[k / 2]);
        read_file(file, &two);
        const size_t shorter = two.count;
        tides_session *session = opened(*state, sets, count);
        run_into(session, &one);
        assert_true(shorter < one.count);
        tides_recording how;
        tides_recorded done;
        tides_recording_defaults(&how);
        how.resume = how.keep_checkpoint = 1;
        double most = 0.995, half = 0.5;
        double *at = k / 2 == 3 ? &most : k / 2 == 2 ? &half : NULL;
        if (at) {
            assert_int_equal(tides_session_write(session, file, &how, stop_at, at, &done, NULL, &error), TIDES_CANCELLED);
            read_file(file, &two);
            assert_int_equal(two.count, shorter);
            assert_int_equal(access(part, F_OK), 0);
        }
        tides_stats stats;
        scene_expect_ok(tides_session_write(session, file, &how, NULL, NULL, &done, &stats, &error), &error);
        assert_true(done.complete && stats.events_written == one.count);
        expect_whole(file, session);
        assert_int_equal(access(checkpoint, F_OK), 0);
        assert_int_not_equal(access(part, F_OK), 0);
        scene_expect_ok(tides_session_write(session, file, &how, NULL, NULL, &done, NULL, &error), &error); /* no further */
        expect_whole(file, session);
        tides_session_close(session);
        remove(file);
    }
}

/* Another run, or an earlier stop, is refused, and nothing is touched. */
static void only_the_same_run_is_extended(void **state) {
    static const char *const other[] = {"sensor.threshold_on=0.11"}, *const earlier[] = {"time.stop=0.02"};
    tides_error error = {0, ""};
    char file[512], part[600];
    snprintf(file, sizeof file, "%s", scene_in_folder(*state, "same.h5"));
    snprintf(part, sizeof part, "%s.part", file);
    write_shorter(*state, file, NULL, 0, "time.stop=0.05");
    read_file(file, &one);
    tides_recording how;
    tides_recording_defaults(&how);
    how.resume = 1;
    for (int k = 0; k < 2; k++) {
        tides_session *session = opened(*state, k ? earlier : other, 1);
        tides_status status = tides_session_write(session, file, &how, NULL, NULL, NULL, NULL, &error);
        scene_expect_error(status, TIDES_BAD_CONFIG, &error, k ? "after time.stop" : "sensor.threshold_on is 0.1 there");
        tides_session_close(session);
        assert_int_not_equal(access(part, F_OK), 0);
        read_file(file, &two);
        same(&one, &two);
    }
}

/* Ctrl-C before the first step of a run in long ones is done: nothing is written, and all is still to come. */
static void a_file_stopped_within_a_step_goes_on(void **state) {
    static const char *const long_steps[] = {"stepping.mode=error", "stepping.step_s=0.05"};
    tides_error error = {0, ""};
    tides_session *session = opened(*state, long_steps, 2);
    const char *file = scene_in_folder(*state, "within.h5");
    double early = 0.1;
    tides_recorded done;
    run_into(session, &one);
    tides_status status = tides_session_write(session, file, NULL, stop_at, &early, &done, NULL, &error);
    scene_expect_error(status, TIDES_CANCELLED, &error, "request");
    assert_true(done.began && done.saved && !done.complete);
    assert_int_equal(done.events, 0);
    tides_recording how;
    tides_recording_defaults(&how);
    how.resume = 1;
    scene_expect_ok(tides_session_write(session, file, &how, NULL, NULL, &done, NULL, &error), &error);
    assert_true(done.complete && done.events == one.count);
    read_file(file, &two);
    same(&one, &two);
    tides_session_close(session);
}

static void recordings_are_checked(void **state) {
    tides_error error = {0, ""};
    tides_session *session = opened(*state, NULL, 0);
    tides_recording how;
    tides_recording_defaults(&how);
    how.resume = 1;
    tides_status status = tides_session_write(session, "a.raw", &how, NULL, NULL, NULL, NULL, &error);
    scene_expect_error(status, TIDES_BAD_ARGUMENT, &error, "a.raw|HDF5");
    how = (tides_recording){.size = sizeof how, .keep_checkpoint = 1};
    status = tides_session_write(session, "a.raw", &how, NULL, NULL, NULL, NULL, &error);
    scene_expect_error(status, TIDES_BAD_ARGUMENT, &error, "a.raw|keep_checkpoint");
    how = (tides_recording){.size = sizeof how, .checkpoint_s = -1};
    status = tides_session_write(session, "a.h5", &how, NULL, NULL, NULL, NULL, &error);
    scene_expect_error(status, TIDES_BAD_ARGUMENT, &error, "checkpoint_s");
    how = (tides_recording){.size = sizeof how, .format = "evt9"};
    status = tides_session_write(session, scene_in_folder(*state, "a.raw"), &how, NULL, NULL, NULL, NULL, &error);
    assert_true(status != TIDES_OK);
    assert_true(strstr(error.text, "evt9"));
    assert_int_equal(tides_session_write(session, NULL, NULL, NULL, NULL, NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_session_run(NULL, keep, &one, NULL, NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_simulator_write(NULL, 1, "a", NULL, NULL, NULL, NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
    tides_session_close(session);
    session = NULL;
    assert_int_equal(tides_session_load("none.json", NULL, 0, NULL, &session, &error), TIDES_FILE_NOT_FOUND);
    assert_int_equal(tides_session_open(NULL, NULL, &session, NULL), TIDES_BAD_ARGUMENT);
    assert_null(session);
}

static void variations_share_what_is_open(void **state) {
    tides_error error = {0, ""};
    tides_session *base = opened(*state, NULL, 0), *esim = NULL, *sensitive = NULL, *none = NULL;
    const char *const to_esim[] = {"method=esim", "esim.contrast_threshold_pos=0.1", "esim.contrast_threshold_neg=0.1"};
    const char *const low[] = {"sensor.threshold_on=0.05", "readout.enabled=true"};
    scene_expect_ok(tides_session_vary(base, to_esim, 3, &esim, &error), &error);
    scene_expect_ok(tides_session_vary(base, low, 2, &sensitive, &error), &error);
    run_into(base, &one);
    run_into(esim, &two);
    assert_true(two.count > one.count / 2);
    assert_true(two.count < 2 * one.count);
    run_into(sensitive, &two);
    assert_true(two.count > one.count);
    tides_session *alone = opened(*state, low, 2);
    run_into(alone, &one);
    same(&one, &two);
    tides_simulator *simulator = NULL;
    tides_status status = tides_session_simulator(esim, NULL, NULL, &simulator, &error);
    scene_expect_error(status, TIDES_UNSUPPORTED, &error, "esim|tides_session_run");
    const char *const opens[] = {"camera.width=5", "scene.duration_s=2", "device=cpu",
                                 "scene.objects=[{\"file\": \"two.ply\"}]"};
    for (size_t i = 0; i < sizeof opens / sizeof *opens; i++)
        assert_int_equal(tides_session_vary(base, &opens[i], 1, &none, &error), TIDES_BAD_CONFIG);
    const char *const queued[] = {"readout.enabled=true"};
    scene_expect_ok(tides_session_vary(esim, queued, 1, &none, &error), &error);
    status = tides_session_run(none, keep, &one, NULL, NULL, NULL, &error);
    scene_expect_error(status, TIDES_UNSUPPORTED, &error, "readout.enabled");
    tides_session_close(none);
    tides_session_close(alone);
    tides_session_close(sensitive);
    tides_session_close(esim);
    tides_session_close(base);
}

/* A run that was read before, on a device that is open before, both the caller's. */
static void what_is_the_callers_stays_open(void **state) {
    tides_error error = {0, ""};
    tides_session_close(opened(*state, NULL, 0)); /* for its files */
    tides_run *run = NULL;
    tides_device *device = NULL;
    scene_expect_ok(tides_run_load(scene_in_folder(*state, "run.json"), NULL, 0, &run, &error), &error);
    scene_expect_ok(tides_device_open("reference-f32", &device, &error), &error);
    for (int i = 0; i < 2; i++) {
        tides_session *session = NULL;
        tides_session_facts f;
        scene_expect_ok(tides_session_open(run, device, &session, &error), &error);
        tides_session_get(session, &f);
        assert_ptr_equal(f.device, device);
        assert_ptr_equal(f.run, run);
        run_into(session, i ? &two : &one);
        tides_session_close(session);
    }
    same(&one, &two);
    tides_device_close(device);
    tides_run_destroy(run);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_FOLDER(whole_runs_are_their_parts_by_hand),   IN_FOLDER(a_file_stopped_goes_on),
        IN_FOLDER(a_file_stopped_within_a_step_goes_on), IN_FOLDER(recordings_are_checked),
        IN_FOLDER(a_finished_file_is_extended),          IN_FOLDER(only_the_same_run_is_extended),
        IN_FOLDER(variations_share_what_is_open),        IN_FOLDER(what_is_the_callers_stays_open),
    };
    return cmocka_run_group_tests_name("session", tests, NULL, NULL);
}
