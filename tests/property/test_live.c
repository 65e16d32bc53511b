/* Live runs: what is told as it goes gives, to the bit, the events of a run that knows the same open paths as a whole; whatever
 * the options, however far ahead poses are told, wherever it is asked for events; and wrong use is refused and harmless. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "camera/td_rotation.h"
#include "run/td_session.h"
#include "scene/td_scene.h"
#include "solver/td_simulator.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tides.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define START 0.2
#define STOP 0.235
enum { POSES = 120, OBJECT = 1, BASE = 3 };

static const char run_text[] =
    "{\"scene\": {\"file\": \"scene.h5\"}, \"camera\": {\"file\": \"path.json\"}, \"time\": {\"start\": 0.2, \"stop\": 0.235},"
    "\"sensor\": {\"threshold_on\": 0.1, \"threshold_off\": 0.13}, \"device\": \"reference-f32\","
    "\"stepping\": {\"step_s\": 0.005, \"min_step_s\": 0.0001, \"tolerance\": 0.05}}";

static uint32_t noise = 20261123u; /* xorshift32 */
static double uniform(void) {
    noise ^= noise << 13;
    noise ^= noise >> 17;
    noise ^= noise << 5;
    return noise / 4294967296.0;
}

/* -- what is told --------------------------------------------------------------------------------------------------- */

typedef struct told {
    tides_pose_sample camera[POSES], object[POSES];
    int count;
} told;

static tides_pose_sample sample_of(const tides_trajectory *path, double time, int rates) {
    tides_pose pose;
    tides_pose_sample sample = {.time = time, .has_rates = rates};
    assert_int_equal(tides_trajectory_at(path, time, &pose, NULL), TIDES_OK);
    td_quaternion_from_rotation(pose.rotation, sample.quaternion);
    memcpy(sample.position, pose.position, sizeof sample.position);
    memcpy(sample.velocity, pose.position_dot, sizeof sample.velocity);
    for (int k = 0; k < 3; k++) sample.angular_velocity[k] = uniform() - 0.5; /* any: a path that bends at its samples */
    return sample;
}

/* Poses of the scene's paths, 1 ns to 2 ms apart; with rates, without, or with some of each. */
static void make_poses(const random_scene *scene, int rates, told *all) {
    tides_object object;
    assert_int_equal(tides_scene_object(scene->scene, OBJECT, &object, NULL), TIDES_OK);
    double time = START;
    for (all->count = 0; all->count < POSES; all->count++) {
        const int own = rates == 2 ? uniform() < 0.5 : rates;
        all->camera[all->count] = sample_of(scene->path, time, own);
        all->object[all->count] = sample_of(object.trajectory, time, own);
        if (time > STOP) break;
        time += uniform() < 0.1 ? 1e-9 : 2e-3 * uniform();
    }
    assert_true(all->count < POSES);
    all->count++;
}

/* -- a run that knows, and one that is told --------------------------------------------------------------------------- */

typedef struct stream {
    tides_event *events;
    size_t count, capacity;
} stream;

static int keep(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    assert_int_equal(td_reserve((void **)&s->events, &s->capacity, s->count + count + 1, sizeof *events, NULL), TIDES_OK);
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

static tides_session *opened(void *folder, const random_scene *scene, const char *const *sets, size_t count) {
    tides_error error = {0, ""};
    tides_session *session = NULL;
    scene_expect_ok(tides_scene_save(scene->scene, scene_in_folder(folder, "scene.h5"), &error), &error);
    scene_expect_ok(tides_path_save(scene_in_folder(folder, "path.json"), scene->path, &scene->camera, &error), &error);
    scene_file_write(scene_in_folder(folder, "run.json"), run_text, sizeof run_text - 1);
    scene_expect_ok(tides_session_load(scene_in_folder(folder, "run.json"), sets, count, NULL, &session, &error), &error);
    return session;
}

static stream run_known(const tides_session *session, const told *all) {
    const tides_session_facts *f = &session->facts;
    const tides_run_values *v = &f->values;
    tides_error error = {0, ""};
    stream s = {0};
    tides_scene *scene = NULL;
    tides_trajectory *camera = NULL;
    tides_simulator *simulator = NULL;
    scene_expect_ok(td_scene_lend(f->scene, &scene, &error), &error);
    scene_expect_ok(td_scene_tell(scene, OBJECT, all->object, &error), &error);
    scene_expect_ok(tides_scene_append(scene, OBJECT, all->object + 1, (size_t)all->count - 1, &error), &error);
    scene_expect_ok(tides_trajectory_create_open(all->camera, (size_t)all->count, &camera, &error), &error);
    scene_expect_ok(tides_simulator_create(f->device, scene, camera, &f->intrinsics, &v->image, &v->sensor, &v->stepping,
                                           v->start, 1, NULL, NULL, &simulator, &error),
                    &error);
    scene_expect_ok(tides_simulator_readout(simulator, &v->readout, &error), &error);
    scene_expect_ok(tides_simulator_run(simulator, v->stop + 1e-12, keep, &s, NULL, NULL, &error), &error);
    tides_simulator_destroy(simulator);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return s;
}

/* Poses that a run to `until` needs and haven't been told, or `ahead` more. */
static int tell(tides_live *live, const told *all, int told_so_far, double until, int ahead) {
    tides_error error = {0, ""};
    int last = told_so_far;
    while (last < all->count && all->camera[last - 1].time < until) last++;
    last = last + ahead < all->count ? last + ahead : all->count;
    const size_t count = (size_t)(last - told_so_far);
    if (count == 0) return last;
    scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, all->camera + told_so_far, count, &error), &error);
    scene_expect_ok(tides_live_tell(live, OBJECT, all->object + told_so_far, count, &error), &error);
    return last;
}

static tides_live *live_of(tides_session *session, const told *all, int32_t kept) {
    static const int32_t objects[] = {OBJECT};
    tides_error error = {0, ""};
    tides_live *live = NULL;
    tides_live_options options;
    tides_live_options_defaults(&options);
    options.objects = objects;
    options.object_count = 1;
    options.keep = kept;
    scene_expect_ok(tides_live_open(session, &options, NULL, NULL, &live, &error), &error);
    scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, all->camera, 1, &error), &error);
    scene_expect_ok(tides_live_tell(live, OBJECT, all->object, 1, &error), &error);
    return live;
}

/* Advances by steps of 1 ns to some steps of the run, just in time or told ahead. */
static stream run_told(tides_session *session, const told *all, int ahead) {
    tides_error error = {0, ""};
    stream s = {0};
    tides_live *live = live_of(session, all, ahead > 0);
    double until = START;
    for (int now = 1; until < STOP;) {
        const double step = uniform() < 0.2 ? 1e-9 : uniform() < 0.2 ? 12e-3 * uniform() : 1e-3;
        const tides_event *events = NULL;
        size_t count = 0;
        until = until + step < STOP ? until + step : STOP;
        now = tell(live, all, now, until, ahead);
        scene_expect_ok(tides_live_run(live, until, &events, &count, &error), &error);
        assert_true(tides_live_reached(live) <= until + 1e-12 && tides_live_reached(live) > until - 0.005 - 1e-12);
        for (size_t i = 0; i < count; i++) assert_true(events[i].t <= (int64_t)(until * 1e9));
        keep(&s, events, count);
    }
    tides_live_close(live);
    return s;
}

static void same(const stream *a, const stream *b, const char *what) {
    if (a->count != b->count) fail_msg("%s: %zu events and %zu", what, a->count, b->count);
    for (size_t i = 0; i < a->count; i++)
        if (memcmp(&a->events[i], &b->events[i], sizeof *a->events) != 0)
            fail_msg("%s: event %zu of %zu differs", what, i, a->count);
}

/* -- the same events -------------------------------------------------------------------------------------------------- */

enum { SETTINGS = 8 };
static const char *const settings[][SETTINGS] = {
    {"stepping.mode=fixed", "stepping.step_s=0.0005"},
    {"stepping.mode=error"},
    {"stepping.mode=error_risk", "stepping.local=false"},
    {"stepping.unit=block", "stepping.paths=true", "stepping.step_s=0.001"},
    {"stepping.solve=double", "stepping.tolerance=0.1", "stepping.unit=block", "stepping.paths=true"},
    {"stepping.solve=float", "stepping.tolerance=0.1"},
    {"sensor.leak_rate_hz=5", "sensor.threshold_sigma=0.03", "sensor.refractory_s=0.0005", "frontend.shot_noise_hz=50",
     "frontend.hot_pixel_fraction=0.01", "stepping.solve=double", "sensor.labels=true"},
    {"frontend.photoreceptor_cutoff_hz=300", "frontend.noise_rms=0.02", "frontend.psf_sigma_px=0.7"},
    {"frontend.center_surround=[2,0.001]", "sensor.b_min=0.1"},
    {"readout.enabled=true", "readout.tile_px=8", "readout.k0=2", "readout.queue_capacity=64"},
};

static void told_runs_are_those_that_know(void **state) {
    random_recipe recipe = random_recipe_defaults(77);
    recipe.objects = 3;
    recipe.sh_degree = 1;
    recipe.width = 33;
    recipe.height = 18;
    recipe.size = 0.2;
    recipe.camera_speed = 2;
    random_scene scene = random_scene_make(&recipe);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        told all;
        size_t count = 0;
        while (count < SETTINGS && settings[i][count]) count++;
        tides_session *session = opened(*state, &scene, settings[i], count);
        make_poses(&scene, (int)(i % 3), &all);
        stream known = run_known(session, &all), in_time = run_told(session, &all, 0), ahead = run_told(session, &all, 7);
        assert_true(known.count > 100);
        same(&known, &in_time, settings[i][0]);
        same(&known, &ahead, "told ahead");
        free(known.events);
        free(in_time.events);
        free(ahead.events);
        tides_session_close(session);
    }
    random_scene_free(&scene);
}

/* -- at a robot's clock --------------------------------------------------------------------------------------------- */

/* One object at rest, in a run that begins at `start`. */
static tides_session *plain(void *folder, random_scene *scene, double start, const char *more) {
    char begin[64], shift[64], stop[64];
    const char *const sets[] = {begin, shift, stop, "stepping.step_s=0.001", more};
    random_recipe recipe = random_recipe_defaults(78);
    recipe.count = 20;
    recipe.width = 21;
    recipe.height = 17;
    recipe.size = 0.3;
    *scene = random_scene_make(&recipe);
    snprintf(begin, sizeof begin, "time.start=%.17g", start);
    snprintf(shift, sizeof shift, "camera.start_s=%.17g", -start);
    snprintf(stop, sizeof stop, "time.stop=%.17g", start + 0.01);
    return opened(folder, scene, sets, more ? 5 : 4);
}

/* Times as callers make them: sums of intervals; and at 1.6e9 s, where doubles are 0.2 us apart. Each step gives its events. */
static void times_are_as_doubles_add_up(void **state) {
    static const double starts[] = {0, -3.7, 1.6e9};
    for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
        random_scene scene;
        tides_error error = {0, ""};
        tides_session *session = plain(*state, &scene, starts[k], NULL);
        const tides_session_facts *f = &session->facts;
        tides_live *live = NULL;
        tides_pose_sample poses[61];
        stream in_time = {0}, known = {0};
        double time = starts[k];
        scene_expect_ok(tides_live_open(session, NULL, NULL, NULL, &live, &error), &error);
        for (int i = 0; i <= 60; i++, time = starts[k] > 1e6 ? starts[k] + 1e-3 * i : time + 1e-3) {
            const tides_event *events;
            size_t count;
            poses[i] = sample_of(scene.path, 0.001 * i, 0);
            poses[i].time = time;
            scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, poses + i, 1, &error), &error);
            scene_expect_ok(tides_live_run(live, time, &events, &count, &error), &error);
            assert_int_equal((int)tides_live_simulator(live)->step, i); /* none is late */
            keep(&in_time, events, count);
        }
        tides_trajectory *path = NULL;
        tides_simulator *simulator = NULL;
        scene_expect_ok(tides_trajectory_create_open(poses, 61, &path, &error), &error);
        scene_expect_ok(tides_simulator_create(f->device, f->scene, path, &f->intrinsics, &f->values.image, &f->values.sensor,
                                               &f->values.stepping, starts[k], starts[k] + 1, NULL, NULL, &simulator, &error),
                        &error);
        scene_expect_ok(tides_simulator_run(simulator, poses[60].time + 1e-7, keep, &known, NULL, NULL, &error), &error);
        assert_true(known.count > 20);
        same(&known, &in_time, "a late clock");
        free(known.events);
        free(in_time.events);
        tides_simulator_destroy(simulator);
        tides_trajectory_destroy(path);
        tides_live_close(live);
        tides_session_close(session);
        random_scene_free(&scene);
    }
}

/* A thousand steps: what isn't needed any more is forgotten. */
static void long_runs_forget(void **state) {
    random_scene scene;
    tides_error error = {0, ""};
    tides_live *live = NULL;
    tides_session *session = plain(*state, &scene, 0, "stepping.mode=fixed");
    scene_expect_ok(tides_live_open(session, NULL, NULL, NULL, &live, &error), &error);
    for (int i = 1; i <= 1000; i++) {
        const tides_pose_sample pose = sample_of(scene.path, 0.001 * i, 0);
        scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, &pose, 1, &error), &error);
        scene_expect_ok(tides_live_run(live, pose.time, NULL, NULL, &error), &error);
        assert_true(tides_trajectory_count(tides_live_path(live, TIDES_LIVE_CAMERA)) < 10);
    }
    tides_live_close(live);
    tides_session_close(session);
    random_scene_free(&scene);
}

/* -- wrong use ------------------------------------------------------------------------------------------------------ */

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
    const char *const budget[] = {"stepping.budget=10"}, *const frames[] = {"method=esim"},
                      *const truth[] = {"sensor.truth=true"};
    scene_expect_ok(tides_session_vary(session, budget, 1, &other, &error), &error);
    refused_to_open(other, NULL, TIDES_UNSUPPORTED, "stepping.budget|length|set it to 0");
    tides_session_close(other);
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

/* Everything that is refused leaves the run as it was: its events are those of one that was asked nothing wrong. */
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
}

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
                           "camera's path|hasn't been told");
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
        scene_expect_error(tides_live_tell(live, 0, &pose, 1, &error), TIDES_BAD_ARGUMENT, &error, "object|isn't told");
        scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, &pose, 1, &error), &error);
        scene_expect_ok(tides_live_tell(quiet, TIDES_LIVE_CAMERA, &pose, 1, &error), &error);
        scene_expect_ok(tides_live_run(live, pose.time, &events, &count, &error), &error);
        keep(&one, events, count);
        scene_expect_ok(tides_live_run(quiet, pose.time, &events, &count, &error), &error);
        keep(&two, events, count);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(told_runs_are_those_that_know, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(times_are_as_doubles_add_up, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(long_runs_forget, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(what_needs_the_whole_run_is_refused, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(wrong_use_is_harmless, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
