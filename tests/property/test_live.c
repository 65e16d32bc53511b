/* Live runs: poses that are given during the run give, to the bit, the events of a run that knows the same open paths from the
 * start. This holds for all options, however far ahead poses are given, and wherever events are asked for. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/live_run.h"

#include <malloc.h>
#include <unistd.h>

#define START 0.2
#define STOP 0.235
enum { POSES = 120 };

/* -- what is told --------------------------------------------------------------------------------------------------- */

typedef struct told {
    tides_pose_sample camera[POSES], object[POSES];
    int count;
} told;

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
    scene_expect_ok(tides_simulator_run(simulator, v->stop + 1e-12, collect, &s, NULL, NULL, &error), &error);
    tides_simulator_stats(simulator, &s.stats);
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
        collect(&s, events, count);
    }
    tides_simulator_stats(tides_live_simulator(live), &s.stats);
    tides_live_close(live);
    return s;
}

/* -- the same events -------------------------------------------------------------------------------------------------- */

enum { SETTINGS = 8 };
static const char *const settings[][SETTINGS] = {
    {"stepping.mode=fixed", "stepping.step_s=0.0005"},
    {"stepping.mode=error"},
    {"stepping.mode=risk", "stepping.local=false"},
    {"stepping.unit=block", "stepping.solve=off", "stepping.step_s=0.001"},
    {"stepping.solve=double", "stepping.tolerance=0.1", "stepping.unit=block"},
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

/* The events up to `until` of a run from `start` to `stop` that knew these poses. */
static stream run_of_poses(const tides_session_facts *f, const tides_pose_sample *poses, size_t count, double start,
                           double stop, double until) {
    tides_error error = {0, ""};
    stream events = {0};
    tides_trajectory *path = NULL;
    tides_simulator *simulator = NULL;
    scene_expect_ok(tides_trajectory_create_open(poses, count, &path, &error), &error);
    scene_expect_ok(tides_simulator_create(f->device, f->scene, path, &f->intrinsics, &f->values.image, &f->values.sensor,
                                           &f->values.stepping, start, stop, NULL, NULL, &simulator, &error),
                    &error);
    scene_expect_ok(tides_simulator_run(simulator, until, collect, &events, NULL, NULL, &error), &error);
    tides_simulator_destroy(simulator);
    tides_trajectory_destroy(path);
    return events;
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
        stream in_time = {0};
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
            collect(&in_time, events, count);
        }
        const stream known = run_of_poses(f, poses, 61, starts[k], starts[k] + 1, poses[60].time + 1e-7);
        assert_true(known.count > 20);
        same(&known, &in_time, "a late clock");
        free(known.events);
        free(in_time.events);
        tides_live_close(live);
        tides_session_close(session);
        random_scene_free(&scene);
    }
}

/* Milliseconds as people write them, which doubles often have before or behind the product: each call ends at its step, told
 * as it goes or known, and the step before isn't left again. */
static void times_are_as_people_write_them(void **state) {
    static const int wholes[] = {0, 1305031102};
    for (size_t w = 0; w < sizeof wholes / sizeof *wholes; w++) {
        char text[32];
        random_scene scene;
        tides_error error = {0, ""};
        snprintf(text, sizeof text, "%d.3", wholes[w]);
        const double start = strtod(text, NULL);
        tides_session *session = plain(*state, &scene, start, "stepping.tolerance=0.5");
        const tides_session_facts *f = &session->facts;
        tides_trajectory *rest = NULL;
        tides_simulator *known = NULL;
        tides_live *live = NULL;
        tides_pose_sample pose = sample_of(scene.path, 0, 0);
        scene_expect_ok(tides_trajectory_create_static(pose.position, pose.quaternion, &rest, &error), &error);
        scene_expect_ok(tides_simulator_create(f->device, f->scene, rest, &f->intrinsics, &f->values.image, &f->values.sensor,
                                               &f->values.stepping, start, start + 1, NULL, NULL, &known, &error),
                        &error);
        scene_expect_ok(tides_live_open(session, NULL, NULL, NULL, &live, &error), &error);
        for (int i = 0; i <= 120; i++) {
            snprintf(text, sizeof text, "%d.%03d", wholes[w], 300 + i);
            pose.time = strtod(text, NULL);
            scene_expect_ok(tides_simulator_run(known, pose.time, NULL, NULL, NULL, NULL, &error), &error);
            scene_expect_ok(tides_live_tell(live, TIDES_LIVE_CAMERA, &pose, 1, &error), &error);
            scene_expect_ok(tides_live_run(live, pose.time, NULL, NULL, &error), &error);
            scene_expect_ok(tides_live_run(live, nextafter(pose.time, -INFINITY), NULL, NULL, &error), &error);
            if (known->step != i || tides_live_simulator(live)->step != i)
                fail_msg("%s s is step %d, and known runs reach %d, live ones %d", text, i, (int)known->step,
                         (int)tides_live_simulator(live)->step);
        }
        tides_live_close(live);
        tides_simulator_destroy(known);
        tides_trajectory_destroy(rest);
        tides_session_close(session);
        random_scene_free(&scene);
    }
}

/* What the process has taken from the heap [bytes]; 0 where malloc is another one's, of the sanitizers. */
static size_t heap_in_use(void) {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
#else
    return 0;
#endif
}

/* A thousand steps of a millisecond, of a camera that swings: what isn't needed any more is forgotten, after step 400 the heap
 * doesn't grow, and the events of that second are those of a run that knew it. */
static void long_runs_forget_and_leak_nothing(void **state) {
    enum { STEPS = 1000, SETTLED = 400, EVENTS_MAX = 1 << 17, LEAST_LEAK = (STEPS - SETTLED) * 16 };
    static tides_pose_sample poses[STEPS + 1];
    random_scene scene;
    tides_error error = {0, ""};
    tides_live *live = NULL;
    tides_session *session = plain(*state, &scene, 0, "stepping.tolerance=0.5");
    const tides_session_facts *f = &session->facts;
    stream in_time = {0};
    size_t settled = 0;
    assert_int_equal(td_reserve((void **)&in_time.events, &in_time.capacity, EVENTS_MAX, sizeof *in_time.events, NULL),
                     TIDES_OK);
    scene_expect_ok(tides_live_open(session, NULL, NULL, NULL, &live, &error), &error);
    for (int i = 0; i <= STEPS; i++) {
        const int32_t camera = TIDES_LIVE_CAMERA;
        const tides_event *events;
        size_t count;
        poses[i] = sample_of(scene.path, 0.02 + 0.01 * sin(0.1 * i), 0);
        poses[i].time = 0.001 * i;
        scene_expect_ok(tides_live_step(live, &camera, poses + i, 1, poses[i].time, &events, &count, &error), &error);
        assert_true(tides_trajectory_count(tides_live_path(live, TIDES_LIVE_CAMERA)) < 10);
        assert_true(in_time.count + count < EVENTS_MAX);
        collect(&in_time, events, count);
        if (i == SETTLED) settled = heap_in_use();
    }
    const size_t in_the_end = heap_in_use();
    print_message("heap after %d steps %zu bytes, after %d %zu\n", SETTLED, settled, STEPS, in_the_end);
    assert_true(in_the_end < settled + LEAST_LEAK);
    const stream known = run_of_poses(f, poses, STEPS + 1, 0, 2, 1 + 1e-10);
    assert_true(known.count > 5000);
    same(&known, &in_time, "a second");
    free(known.events);
    free(in_time.events);
    tides_live_close(live);
    tides_session_close(session);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(told_runs_are_those_that_know, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(times_are_as_doubles_add_up, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(times_are_as_people_write_them, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(long_runs_forget_and_leak_nothing, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
