/* Live runs in which little happens at first: a camera at rest, a hand that is held still, an object that waits. Pixels look up
 * the image at the run's start when they first may act, long after open paths have dropped it. Whatever the rest, the sensor
 * and what is kept, the events are those of a run that knew the paths from the start. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/live_run.h"

enum { REST_MAX = 200, MOVES = 8, POSES_MAX = REST_MAX + MOVES + 1 };
static const double step_s = 0.001, start_s = 0.2;

/* Who rests at first, and how. */
enum { CAMERA_RESTS, HAND_HELD_STILL, OBJECT_RESTS, KINDS };

typedef struct told {
    tides_pose_sample camera[POSES_MAX], object[POSES_MAX];
    size_t count;
} told;

/* `rest` steps of rest, then all that moves is on its way. */
static void make_poses(const random_scene *scene, int kind, int rest, told *all) {
    tides_object object;
    assert_int_equal(tides_scene_object(scene->scene, OBJECT, &object, NULL), TIDES_OK);
    all->count = (size_t)(rest + MOVES + 1);
    for (int k = 0; k < (int)all->count; k++) {
        const double gone = k > rest ? 5 * step_s * (k - rest) : 0;
        tides_pose_sample *camera = &all->camera[k], *own = &all->object[k];
        *camera = sample_of(scene->path, start_s + (kind == OBJECT_RESTS ? 0 : gone), 0);
        *own = sample_of(object.trajectory, start_s + (kind == OBJECT_RESTS ? 2 * gone : 0), 0);
        for (int i = 0; i < 3 && kind == HAND_HELD_STILL; i++) camera->position[i] += 2e-4 * (uniform() - 0.5);
        camera->time = own->time = start_s + step_s * k;
    }
}

static stream run_known(const tides_session *session, const told *all) {
    const tides_session_facts *f = &session->facts;
    const tides_run_values *v = &f->values;
    const double stop = all->camera[all->count - 1].time;
    tides_error error = {0, ""};
    stream s = {0};
    tides_scene *scene = NULL;
    tides_trajectory *camera = NULL;
    tides_simulator *simulator = NULL;
    scene_expect_ok(td_scene_lend(f->scene, &scene, &error), &error);
    scene_expect_ok(td_scene_tell(scene, OBJECT, all->object, &error), &error);
    scene_expect_ok(tides_scene_append(scene, OBJECT, all->object + 1, all->count - 1, &error), &error);
    scene_expect_ok(tides_trajectory_create_open(all->camera, all->count, &camera, &error), &error);
    scene_expect_ok(tides_simulator_create(f->device, scene, camera, &f->intrinsics, &v->image, &v->sensor, &v->stepping,
                                           v->start, 9, NULL, NULL, &simulator, &error),
                    &error);
    scene_expect_ok(tides_simulator_readout(simulator, &v->readout, &error), &error);
    scene_expect_ok(tides_simulator_run(simulator, stop + 1e-12, collect, &s, NULL, NULL, &error), &error);
    tides_simulator_destroy(simulator);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return s;
}

/* Told just in time, a pose a step. */
static stream run_told(tides_session *session, const told *all, int32_t keep) {
    static const int32_t both[] = {TIDES_LIVE_CAMERA, OBJECT};
    tides_error error = {0, ""};
    stream s = {0};
    tides_live *live = NULL;
    tides_live_options options;
    tides_live_options_defaults(&options);
    options.objects = both + 1;
    options.object_count = 1;
    options.keep = keep;
    scene_expect_ok(tides_live_open(session, &options, NULL, NULL, &live, &error), &error);
    for (size_t k = 0; k < all->count; k++) {
        const tides_pose_sample now[] = {all->camera[k], all->object[k]};
        const tides_event *events = NULL;
        size_t count = 0;
        scene_expect_ok(tides_live_step(live, both, now, 2, now->time, &events, &count, &error), &error);
        assert_int_equal((int)tides_live_simulator(live)->step, (int)k);
        assert_true(keep || tides_trajectory_count(tides_live_path(live, TIDES_LIVE_CAMERA)) < 10); /* memory is bounded */
        assert_true(keep || tides_trajectory_count(tides_live_path(live, OBJECT)) < 10);
        collect(&s, events, count);
    }
    tides_live_close(live);
    return s;
}

/* Its events, either way kept. */
static size_t expect_same(tides_session *session, const random_scene *scene, int kind, int rest, const char *what) {
    told all;
    char words[96];
    make_poses(scene, kind, rest, &all);
    const stream known = run_known(session, &all);
    for (int32_t keep = 0; keep < 2; keep++) {
        const stream in_time = run_told(session, &all, keep);
        snprintf(words, sizeof words, "%s, kind %d, a rest of %d steps, keep %d", what, kind, rest, (int)keep);
        same(&known, &in_time, words);
        free(in_time.events);
    }
    free(known.events);
    return known.count;
}

static tides_session *session_of(void *folder, random_scene *scene, const char *more) {
    const char *const sets[] = {"stepping.step_s=0.001", "stepping.min_step_s=0.00001", more};
    random_recipe recipe = random_recipe_defaults(79);
    recipe.objects = 2;
    recipe.count = 16;
    recipe.sh_degree = 0;
    recipe.width = 20;
    recipe.height = 16;
    recipe.size = 0.3;
    recipe.camera_speed = 2;
    *scene = random_scene_make(&recipe);
    return opened(folder, scene, sets, more ? 3 : 2);
}

static void rests_of_any_length(void **state) {
    static const int rests[] = {1, 2, 3, 5, 17, 50, REST_MAX};
    random_scene scene;
    tides_session *session = session_of(*state, &scene, NULL);
    for (int kind = 0; kind < KINDS; kind++)
        for (size_t i = 0; i < sizeof rests / sizeof *rests; i++)
            assert_true(expect_same(session, &scene, kind, rests[i], "the run's sensor") > 20);
    tides_session_close(session);
    random_scene_free(&scene);
}

static void rests_before_any_sensor(void **state) {
    char name[TIDES_PRESET_NAME], preset[TIDES_PRESET_NAME + 32];
    size_t presets = 0;
    for (; tides_preset_at(presets, name); presets++) {
        random_scene scene;
        snprintf(preset, sizeof preset, "sensor.preset=%s", name);
        tides_session *session = session_of(*state, &scene, preset);
        assert_true(expect_same(session, &scene, (int)(presets % KINDS), 11 + 4 * (int)presets, name) > 10);
        tides_session_close(session);
        random_scene_free(&scene);
    }
    assert_true(presets >= 9);
}

/* Through a colour filter each channel has a renderer, which keeps the start itself; without looks nothing is
 * kept. */
static void rests_however_events_are_looked_up(void **state) {
    static const char *const ways[] = {"sensor.colour_filter=rggb", "stepping.solve=off", "stepping.mode=fixed",
                                       "sensor.leak_rate_hz=2"};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        random_scene scene;
        tides_session *session = session_of(*state, &scene, ways[i]);
        assert_true(expect_same(session, &scene, HAND_HELD_STILL, 23, ways[i]) > 20);
        tides_session_close(session);
        random_scene_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(rests_of_any_length, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(rests_before_any_sensor, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(rests_however_events_are_looked_up, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
