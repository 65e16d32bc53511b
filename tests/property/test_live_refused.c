/* Live runs with wrong input, or that fail: the call is refused, and does no harm. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/live_run.h"

static void refused_to_open(tides_session *session, const tides_live_options *options, tides_status status, const char *words) {
    tides_error error = {0, ""};
    tides_live *live = NULL;
    scene_expect_error(tides_live_open(session, options, NULL, NULL, &live, &error), status, &error, words);
    assert_null(live);
}

static void what_needs_the_whole_run_is_refused(void **state) {
    random_scene scene;
    tides_error error = {0, ""};
    static const int32_t none[] = {5};
    tides_session *session = plain(*state, &scene, 0, NULL), *other = NULL;
    tides_live_options options;
    tides_live_options_defaults(&options);
    const char *const frames[] = {"method=esim"}, *const truth[] = {"sensor.truth=true"};
    scene_expect_ok(tides_session_vary(session, frames, 1, &other, &error), &error);
    refused_to_open(other, NULL, TIDES_UNSUPPORTED, "esim|frames");
    tides_session_close(other);
    scene_expect_ok(tides_session_vary(session, truth, 1, &other, &error), &error);
    refused_to_open(other, NULL, TIDES_UNSUPPORTED, "sensor.truth");
    tides_session_close(other);
    refused_to_open(NULL, NULL, TIDES_BAD_ARGUMENT, "session");
    options.most_speed = NAN;
    refused_to_open(session, &options, TIDES_BAD_ARGUMENT, "most_speed");
    options.most_speed = 0;
    options.object_count = 1;
    refused_to_open(session, &options, TIDES_BAD_ARGUMENT, "objects is NULL");
    options.objects = none;
    refused_to_open(session, &options, TIDES_BAD_ARGUMENT, "object 5");
    tides_live_options_defaults(&options);
    options.camera = 0;
    options.stop = 7; /* the camera's path has 1 s */
    refused_to_open(session, &options, TIDES_OUT_OF_RANGE, "camera's path|7");
    tides_session_close(session);
    random_scene_free(&scene);
}

static void refused_to_tell(tides_live *live, tides_pose_sample pose, const char *words) {
    tides_error error = {0, ""};
    scene_expect_error(tides_live_tell(live, TIDES_LIVE_CAMERA, &pose, 1, &error), TIDES_BAD_ARGUMENT, &error, words);
}

/* A new beginning and a jump after it: refused, and the beginning stays as it was. */
static void refuses_all_or_none(tides_live *live) {
    tides_pose_sample was, now, pair[2];
    tides_error error = {0, ""};
    const tides_trajectory *path = tides_live_path(live, TIDES_LIVE_CAMERA);
    scene_expect_ok(tides_trajectory_sample(path, 0, &was, &error), &error);
    pair[0] = pair[1] = was;
    pair[0].position[0] += 0.001;
    pair[1].time += 1e-3;
    pair[1].position[0] += 1;
    scene_expect_error(tides_live_tell(live, TIDES_LIVE_CAMERA, pair, 2, &error), TIDES_BAD_ARGUMENT, &error, "camera|jump");
    scene_expect_ok(tides_trajectory_sample(path, 0, &now, &error), &error);
    assert_memory_equal(&was, &now, sizeof was);
    scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, pair, 0, &error), &error); /* nothing */
    const int32_t both[] = {TIDES_LIVE_CAMERA, OBJECT};
    for (int later = 0; later < 2; later++) { /* the beginning, or a pose after it, and an object that gets no poses */
        pair[0].time = was.time + 1e-3 * later;
        tides_status status = tides_live_step(live, both, pair, 2, pair[0].time, NULL, NULL, &error);
        scene_expect_error(status, TIDES_BAD_ARGUMENT, &error, "object|gets no poses from the caller");
        scene_expect_ok(tides_trajectory_sample(path, 0, &now, &error), &error);
        assert_memory_equal(&was, &now, sizeof was);
        assert_int_equal(tides_trajectory_count(path), 1);
    }
    assert_int_equal(tides_live_step(live, NULL, pair, 1, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_live_step(NULL, both, pair, 1, 1, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
}

/* Everything that is refused leaves the run as it was: its events are those of one that was asked nothing wrong. */
static void wrong_use_is_harmless(void **state) {
    random_scene scene;
    tides_error error = {0, ""};
    tides_session *session = plain(*state, &scene, 0, NULL);
    tides_live *live = NULL, *quiet = NULL;
    tides_live_options options;
    stream one = {0}, two = {0};
    const tides_event *events;
    size_t count;
    tides_live_options_defaults(&options);
    options.most_speed = 100;
    options.most_turn_rate = 2000;
    options.stop = 0.02;
    scene_expect_ok(tides_live_open(session, &options, NULL, NULL, &live, &error), &error);
    options.most_speed = options.most_turn_rate = 0;
    scene_expect_ok(tides_live_open(session, &options, NULL, NULL, &quiet, &error), &error);
    scene_expect_ok(tides_live_run(live, 0, &events, &count, &error), &error); /* nothing to do, and nothing told */
    refuses_all_or_none(live);
    for (int i = 1; i <= 20; i++) {
        const tides_pose_sample pose = sample_of(scene.path, 0.001 * i, i % 2);
        tides_pose_sample bad = pose;
        scene_expect_error(tides_live_run(live, pose.time, NULL, NULL, &error), TIDES_OUT_OF_RANGE, &error,
                           "camera's path|its poses end before");
        bad.time = 0.001 * (i - 1) - (i == 1); /* another beginning is none */
        refused_to_tell(live, bad, "camera|times must strictly increase");
        bad = pose;
        bad.position[1] = NAN;
        refused_to_tell(live, bad, "camera|");
        bad = pose;
        bad.position[1] += 1;
        refused_to_tell(live, bad, "camera|jump|most_speed is 100");
        bad = pose;
        memset(bad.quaternion, 0, sizeof bad.quaternion);
        refused_to_tell(live, bad, "camera|quaternion");
        bad = pose;
        bad.quaternion[0] = -pose.quaternion[1], bad.quaternion[1] = pose.quaternion[0];
        bad.quaternion[2] = -pose.quaternion[3], bad.quaternion[3] = pose.quaternion[2];
        refused_to_tell(live, bad, "camera|jump|most_turn_rate");
        scene_expect_error(tides_live_tell(live, 0, &pose, 1, &error), TIDES_BAD_ARGUMENT, &error,
                           "object|gets no poses from the caller");
        scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, &pose, 1, &error), &error);
        scene_expect_ok(tides_live_tell(quiet, TIDES_LIVE_CAMERA, &pose, 1, &error), &error);
        scene_expect_ok(tides_live_run(live, pose.time, &events, &count, &error), &error);
        collect(&one, events, count);
        scene_expect_ok(tides_live_run(quiet, pose.time, &events, &count, &error), &error);
        collect(&two, events, count);
        scene_expect_error(tides_live_run(live, pose.time - 1e-4, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "go back");
        scene_expect_error(tides_live_run(live, 0.03, NULL, NULL, &error), TIDES_OUT_OF_RANGE, &error, "ends at 0.02");
        refused_to_tell(quiet, bad, "camera|");
    }
    assert_true(one.count > 0);
    same(&one, &two, "after wrong use");
    free(one.events);
    free(two.events);
    tides_live_close(quiet);
    tides_live_close(live);
    tides_live_close(NULL);
    tides_session_close(session);
    random_scene_free(&scene);
}

/* A step failed behind one that was done, the one to 0.011 s: however often, its events come with the next call that succeeds,
 * once, also of a simulator that goes no further. */
static void gives_what_was_done(tides_live *live, tides_live *quiet, const tides_pose_sample *pose) {
    const int32_t camera = TIDES_LIVE_CAMERA;
    tides_error error = {0, ""};
    const tides_event *events;
    size_t count;
    stream one = {0}, two = {0};
    assert_int_equal((int)tides_live_simulator(live)->step, 11);
    scene_expect_error(tides_live_run(live, 0.013, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "aren't finite");
    tides_live_simulator(live)->broken = 1;
    scene_expect_error(tides_live_run(live, 0.013, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "half done");
    for (int i = 0; i < 2; i++) {
        scene_expect_ok(tides_live_run(live, tides_live_reached(live), &events, &count, &error), &error);
        collect(&one, events, count);
    }
    scene_expect_ok(tides_live_step(quiet, &camera, pose, 1, 0.011, &events, &count, &error), &error);
    collect(&two, events, count);
    assert_true(two.count > 0);
    same(&one, &two, "before a failure");
    free(one.events);
    free(two.events);
}

/* A pose so far off that pixels aren't finite. In the first step of a call: nothing was told, and with the right one the run
 * goes on as if nothing had been. In a later step of it: what was told stays, since the steps before were done with it. */
static void a_failure_half_way(void **state) {
    random_scene scene;
    tides_error error = {0, ""};
    tides_session *session = plain(*state, &scene, 0, "stepping.mode=error");
    const int32_t camera[] = {TIDES_LIVE_CAMERA, TIDES_LIVE_CAMERA};
    tides_live *live = NULL, *quiet = NULL;
    const tides_event *events;
    size_t count;
    stream one = {0}, two = {0};
    scene_expect_ok(tides_live_open(session, NULL, NULL, NULL, &live, &error), &error);
    scene_expect_ok(tides_live_open(session, NULL, NULL, NULL, &quiet, &error), &error);
    for (int i = 1; i <= 10; i++) {
        const tides_pose_sample pose = sample_of(scene.path, 0.001 * i, 0);
        tides_pose_sample bad = pose;
        bad.position[2] = -1e300;
        if (i > 1)
            scene_expect_error(tides_live_step(live, camera, &bad, 1, pose.time, NULL, NULL, &error), TIDES_BAD_ARGUMENT,
                               &error, "aren't finite");
        scene_expect_ok(tides_live_step(live, camera, &pose, 1, pose.time, &events, &count, &error), &error);
        collect(&one, events, count);
        scene_expect_ok(tides_live_step(quiet, camera, &pose, 1, pose.time, &events, &count, &error), &error);
        collect(&two, events, count);
    }
    assert_true(one.count > 0);
    same(&one, &two, "after a failure");
    tides_pose_sample pair[2] = {sample_of(scene.path, 0.011, 0), sample_of(scene.path, 0.013, 0)};
    pair[1].position[2] = -1e300;
    scene_expect_error(tides_live_step(live, camera, pair, 2, 0.013, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                       "aren't finite");
    gives_what_was_done(live, quiet, &pair[0]);
    scene_expect_error(tides_live_tell(live, TIDES_LIVE_CAMERA, pair, 1, &error), TIDES_BAD_ARGUMENT, &error,
                       "times must strictly increase");
    free(one.events);
    free(two.events);
    tides_live_close(quiet);
    tides_live_close(live);
    tides_session_close(session);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_needs_the_whole_run_is_refused, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(wrong_use_is_harmless, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(a_failure_half_way, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
