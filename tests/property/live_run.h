/* Test support: sessions of a random scene for live runs, the poses given to them, and their events. */
#ifndef TESTS_PROPERTY_LIVE_RUN_H
#define TESTS_PROPERTY_LIVE_RUN_H

#include "camera/td_rotation.h"
#include "run/td_session.h"
#include "scene/td_scene.h"
#include "solver/td_simulator.h"
#include "tests/support/event_list.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tides.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECT = 1 };

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

static tides_session *opened(void *folder, const random_scene *scene, const char *const *sets, size_t count) {
    return random_scene_session(folder, scene, run_text, sets, count);
}

static void same(const stream *a, const stream *b, const char *what) {
    if (a->count != b->count) fail_msg("%s: %zu events and %zu", what, a->count, b->count);
    for (size_t i = 0; i < a->count; i++)
        if (memcmp(&a->events[i], &b->events[i], sizeof *a->events) != 0)
            fail_msg("%s: event %zu of %zu differs", what, i, a->count);
    if (a->stats.error_p50_s != b->stats.error_p50_s || a->stats.error_p95_s != b->stats.error_p95_s ||
        a->stats.error_p99_s != b->stats.error_p99_s)
        fail_msg("%s: reported errors differ", what);
}

/* One object at rest, in a run that begins at `start`. */
static inline tides_session *plain(void *folder, random_scene *scene, double start, const char *more) {
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

#endif
