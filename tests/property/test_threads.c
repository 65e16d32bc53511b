/* Several threads at once, as far as the headers allow: simulators that share a device, a scene and a path, and live runs of
 * one session, give the events of a run alone. `make check-tsan` checks their accesses. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "camera/td_rotation.h"
#include "tests/property/simulator_run.h"
#include "tides.h"

#include <pthread.h>
#include <stdio.h>

enum { THREADS = 3, KINDS = 3 };

/* -- simulators --------------------------------------------------------------------------------------------------------- */

typedef struct worker {
    pthread_barrier_t *gate;
    job what;
    tides_device *device;
    outcome result;
} worker;

/* What each kind of run builds: programs of its own, which the others may be building too. */
static job kind_of(const random_scene *scene, int kind) {
    job j = kind == 0 ? job_of(scene) : adaptive_job_of(scene, 1);
    j.stop = j.start + 0.02;
    if (kind == 2) {
        j.stepping.solve = TIDES_SOLVE_DOUBLE;
        j.stepping.unit = TIDES_UNIT_BLOCK;
    }
    return j;
}

static void *simulate(void *user) {
    worker *w = user;
    pthread_barrier_wait(w->gate);
    w->result = run_on(&w->what, w->device);
    return NULL;
}

/* Each kind in a thread, all on one device that has built nothing yet. */
static void share_a_device(const char *spec) {
    random_scene scene = make_scene(4711);
    tides_device *device = open_device(spec);
    if (!device) {
        random_scene_free(&scene);
        skip();
    }
    worker w[THREADS] = {{.device = NULL}};
    pthread_t thread[THREADS];
    pthread_barrier_t gate;
    assert_int_equal(pthread_barrier_init(&gate, NULL, THREADS), 0);
    for (int i = 0; i < THREADS; i++) {
        w[i] = (worker){.gate = &gate, .what = kind_of(&scene, i % KINDS), .device = device};
        assert_int_equal(pthread_create(&thread[i], NULL, simulate, &w[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) assert_int_equal(pthread_join(thread[i], NULL), 0);
    pthread_barrier_destroy(&gate);
    for (int i = 0; i < THREADS; i++) {
        outcome alone = run_on(&w[i].what, device);
        assert_true(alone.count > 100);
        expect_same(&alone, &w[i].result, spec);
        free_outcome(&alone);
        free_outcome(&w[i].result);
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

static void test_simulators_share_the_reference(void **state) {
    (void)state;
    share_a_device("reference-f32");
}

static void test_simulators_share_a_device(void **state) {
    (void)state;
    share_a_device("cpu");
}

/* -- live runs ---------------------------------------------------------------------------------------------------------- */

enum { TOLD = 9 };

typedef struct listener {
    pthread_barrier_t *gate;
    tides_session *session;
    const tides_pose_sample *poses; /* (TOLD) */
    outcome heard;
} listener;

static void *listen(void *user) {
    listener *l = user;
    tides_live *live = NULL;
    tides_error error;
    if (l->gate) pthread_barrier_wait(l->gate);
    scene_expect_ok(tides_live_open(l->session, NULL, NULL, NULL, &live, &error), &error);
    for (int i = 0; i < TOLD; i++) {
        const tides_event *events = NULL;
        size_t count = 0;
        scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, l->poses + i, 1, &error), &error);
        scene_expect_ok(tides_live_run(live, l->poses[i].time, &events, &count, &error), &error);
        collect(&l->heard, events, count);
    }
    tides_live_close(live);
    return NULL;
}

static void make_poses(const random_scene *scene, double start, tides_pose_sample *poses) {
    for (int i = 0; i < TOLD; i++) {
        tides_pose pose;
        poses[i] = (tides_pose_sample){.time = start + 2e-3 * i};
        assert_int_equal(tides_trajectory_at(scene->path, poses[i].time, &pose, NULL), TIDES_OK);
        td_quaternion_from_rotation(pose.rotation, poses[i].quaternion);
        memcpy(poses[i].position, pose.position, sizeof poses[i].position);
    }
}

static tides_session *open_session(void *folder, const random_scene *scene, const char *device) {
    static const char text[] = "{\"scene\": {\"file\": \"scene.h5\"}, \"camera\": {\"file\": \"path.json\"},"
                               "\"time\": {\"start\": 0.2, \"stop\": 0.3}, \"stepping\": {\"step_s\": 0.002},"
                               "\"sensor\": {\"threshold_on\": 0.1, \"threshold_off\": 0.13}}";
    char set[64];
    const char *const sets[] = {set};
    snprintf(set, sizeof set, "device=%s", device);
    return random_scene_session(folder, scene, text, sets, 1);
}

static void share_a_session(void *folder, const char *device) {
    random_scene scene = make_scene(4712);
    tides_session *session = open_session(folder, &scene, device);
    tides_pose_sample poses[TOLD];
    listener l[THREADS] = {{.gate = NULL}}, alone = {.session = session, .poses = poses};
    pthread_t thread[THREADS];
    pthread_barrier_t gate;
    make_poses(&scene, 0.2, poses);
    assert_int_equal(pthread_barrier_init(&gate, NULL, THREADS), 0);
    for (int i = 0; i < THREADS; i++) {
        l[i] = (listener){.gate = &gate, .session = session, .poses = poses};
        assert_int_equal(pthread_create(&thread[i], NULL, listen, &l[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) assert_int_equal(pthread_join(thread[i], NULL), 0);
    pthread_barrier_destroy(&gate);
    listen(&alone);
    assert_true(alone.heard.count > 100);
    for (int i = 0; i < THREADS; i++) {
        expect_same(&alone.heard, &l[i].heard, device);
        free_outcome(&l[i].heard);
    }
    free_outcome(&alone.heard);
    tides_session_close(session);
    random_scene_free(&scene);
}

static void test_live_runs_share_a_session(void **state) { share_a_session(*state, "reference-f32"); }

static void test_live_runs_share_a_device(void **state) {
    tides_device *device = open_device("cpu");
    if (!device) skip();
    tides_device_close(device);
    share_a_session(*state, "cpu");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simulators_share_the_reference),
        cmocka_unit_test(test_simulators_share_a_device),
        cmocka_unit_test_setup_teardown(test_live_runs_share_a_session, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_live_runs_share_a_device, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
