/* Makes random scenes on which estimates of timing errors are tested. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/grazing_world.h"

#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 20, HEIGHT = 10 };
#define FOCAL (1.25 * WIDTH)
#define PX (2 / FOCAL) /* scene units of a pixel at depth 2, where things are */

/* Each number is picked in a statement of its own: compilers choose the order in which arguments are evaluated, and two
 * compilers would make different worlds. */
static double pick(uint64_t *seed, double lower, double upper) { return scene_between(seed, lower, upper); }
static double pick_log(uint64_t *seed, double lower, double upper) { return world_between_log(seed, lower, upper); }
static double sign(uint64_t *seed) { return scene_next(seed) % 2 ? 1 : -1; }

static void flat_ground(judged *j, uint64_t *seed) {
    const double grey = pick_log(seed, 0.02, 0.8);
    for (int k = 0; k < 3; k++) j->image.background[k] = grey;
}

static void textured_ground(judged *j, uint64_t *seed) {
    splat_set wall = {0};
    splat_set_texture(&wall, seed, 16, 3, 1.5, 0.9, 0.3);
    world_add(j->scene, &wall, NULL);
}

/* Adds the set on a path: steady, plus the shaking of `s`. */
static void add_on_path(judged *j, splat_set *set, const shaking *s) {
    tides_trajectory *path = shaking_path(s, 0, j->stop, 1e-3, 1);
    world_add(j->scene, set, path);
    tides_trajectory_destroy(path);
}

/* A ball that passes the view at a random time, at `pixels_per_s`. */
static void add_ball(judged *j, uint64_t *seed, double pixels_per_s, double opacity) {
    const double angle = pick(seed, 0, 2 * WORLD_PI), speed = pixels_per_s * PX;
    const double x = pick(seed, -5, 5) * PX, y = pick(seed, -3, 3) * PX, time = pick(seed, 0, j->stop);
    const shaking s = {.place = {x, y, 2}, .velocity = {speed * cos(angle), speed * sin(angle), 0}, .centre_time = time};
    splat_set set = {0};
    const double grey = pick_log(seed, 0.02, 1), radius = PX * pick_log(seed, 0.7, 4);
    splat_set_ball(&set, 0, 0, 0, radius, opacity, grey);
    add_on_path(j, &set, &s);
}

/* A ball that isn't quite opaque, at a random speed from `slow` to `fast` [px/s]. */
static void add_any_ball(judged *j, uint64_t *seed, double slow, double fast) {
    const double opacity = pick(seed, 0.2, 0.99), pixels_per_s = pick_log(seed, slow, fast);
    add_ball(j, seed, pixels_per_s, opacity);
}

static double either_way(uint64_t *seed, double lower, double upper) {
    const double way = sign(seed);
    return way * pick_log(seed, lower, upper);
}

/* -- kinds ----------------------------------------------------------------------------------------------------------------- */

static void ball(judged *j, uint64_t *seed) {
    flat_ground(j, seed);
    add_any_ball(j, seed, 20, 3000);
}

static void balls(judged *j, uint64_t *seed) {
    flat_ground(j, seed);
    for (int i = 0; i < 4; i++) add_any_ball(j, seed, 20, 1000);
}

/* Turning points: a ball comes, stops and goes back. */
static void ball_that_turns(judged *j, uint64_t *seed) {
    flat_ground(j, seed);
    const double hz = pick_log(seed, 5, 60), y = pick(seed, -1, 1) * PX, phase = pick(seed, 0, 6);
    const double amplitude = pick(seed, 0.5, 6) * PX;
    const shaking s = {.place = {0, y, 2}, .shift = {waves_one(amplitude, hz, phase)}};
    splat_set set = {0};
    const double grey = pick_log(seed, 0.02, 1), opacity = pick(seed, 0.2, 0.99), radius = PX * pick_log(seed, 0.7, 4);
    splat_set_ball(&set, 0, 0, 0, radius, opacity, grey);
    add_on_path(j, &set, &s);
}

static void occluder(judged *j, uint64_t *seed) {
    textured_ground(j, seed);
    add_ball(j, seed, pick_log(seed, 200, 3000), 0.99);
}

static void disc(judged *j, uint64_t *seed) {
    enum { SECTORS = 16 };
    flat_ground(j, seed);
    splat_set set = {0};
    const double radius = PX * pick(seed, 2, 5), fill = pick(seed, 0.2, 0.5);
    for (int i = 0; i < SECTORS; i++) {
        const double angle = 2 * WORLD_PI * i / SECTORS;
        splat_set_ball(&set, radius * cos(angle), radius * sin(angle), 1e-3 * i, fill * radius, 0.95,
                       i % 2 ? 0.9 : pick_log(seed, 0.05, 0.5));
    }
    const shaking s = {.place = {0, 0, 2}, .spin = {0, 0, either_way(seed, 1, 200)}};
    add_on_path(j, &set, &s);
}

static void needles(judged *j, uint64_t *seed) {
    flat_ground(j, seed);
    for (int i = 0; i < 3; i++) {
        const double s = PX * pick_log(seed, 1, 5), opacity = pick(seed, 0.3, 0.98);
        const splat needle = {{0, 0, 0}, {s, 0.1 * s, 0.1 * s}, {1, 0, 0, 0}, opacity, {0.9, 0.9, 0.9}};
        const double x = pick(seed, -5, 5) * PX, y = pick(seed, -3, 3) * PX;
        const double across = pick(seed, -200, 200) * PX, down = pick(seed, -200, 200) * PX, spin = pick(seed, -100, 100);
        const shaking path = {.place = {x, y, 2 + 0.1 * i}, .velocity = {across, down, 0}, .spin = {0, 0, spin}};
        splat_set set = {0};
        splat_set_add(&set, &needle);
        add_on_path(j, &set, &path);
    }
}

static void camera_over(judged *j, uint64_t *seed, const shaking *s) {
    textured_ground(j, seed);
    judged_camera(j, shaking_path(s, 0, j->stop, 1e-3, 1));
}

static void yaw(judged *j, uint64_t *seed) {
    const shaking s = {.spin = {0, either_way(seed, 20, 2000) / FOCAL, 0}};
    camera_over(j, seed, &s);
}

static void slow_drift(judged *j, uint64_t *seed) {
    const double across = either_way(seed, 0.5, 20) * PX, down = either_way(seed, 0.5, 20) * PX;
    const shaking s = {.velocity = {across, down, 0}};
    camera_over(j, seed, &s);
}

static void dolly(judged *j, uint64_t *seed) {
    const shaking s = {.velocity = {0, 0, either_way(seed, 0.2, 20)}};
    camera_over(j, seed, &s);
}

/* Shaking with an amplitude of up to two pixels. */
static waves pick_shaking(uint64_t *seed, double pixel) {
    const double phase = pick(seed, 0, 6), hz = pick_log(seed, 2, 40), amplitude = pick(seed, 0, 2) * pixel;
    return waves_one(amplitude, hz, phase);
}

static void handheld(judged *j, uint64_t *seed) {
    shaking s = {.place = {0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        s.turn[k] = pick_shaking(seed, 1 / FOCAL);
        s.shift[k] = pick_shaking(seed, PX);
    }
    camera_over(j, seed, &s);
}

static void leak(judged *j, uint64_t *seed) {
    slow_drift(j, seed);
    j->sensor.leak_rate_hz = pick_log(seed, 1, 300);
}

static void leak_and_ball(judged *j, uint64_t *seed) {
    ball(j, seed);
    j->sensor.leak_rate_hz = pick_log(seed, 1, 300);
}

/* A wall whose light swings by a little more or less than a whole number of thresholds. */
static void near_touch(judged *j, uint64_t *seed) {
    splat_set wall = {0};
    splat_set_ball(&wall, 0, 0, 2, 20, 0.9999, 0.5);
    splat_set_texture(&wall, seed, 4, 1.9, 0.8, 0.4, 0.2);
    const double on = j->sensor.threshold_on, levels = floor(pick(seed, 1, 5));
    const double high = exp(on * levels * (1 + either_way(seed, 1e-6, 3e-2)));
    const pulsing p = {.light = waves_one(high - 1, pick_log(seed, 10, 80), 0)};
    tides_motion *motion = pulsing_keyframes(&wall, &p, j->stop, 0.5e-3);
    j->image.log_eps = scene_next(seed) % 2 ? 1e-6 : 0.05; /* all pixels touch alike, or each by its own brightness */
    world_add_moving(j->scene, &wall, motion, 0);
}

static void flicker(judged *j, uint64_t *seed) {
    splat_set wall = {0};
    splat_set_texture(&wall, seed, 16, 3, 1.5, 0.9, 0.3);
    const double hz = pick_log(seed, 10, 200), phase = pick(seed, 0, 6), amplitude = pick(seed, 0.05, 0.7);
    const pulsing p = {.light = waves_one(amplitude, hz, phase)};
    tides_motion *motion = pulsing_keyframes(&wall, &p, j->stop, 0.05 / hz);
    world_add_moving(j->scene, &wall, motion, 0);
}

static void bells(judged *j, uint64_t *seed) {
    enum { COUNT = 10 };
    float centre[COUNT], width[COUNT], mean[9 * COUNT] = {0}, turn[4 * COUNT] = {0};
    splat_set set = {0};
    tides_motion *motion = NULL;
    tides_error error;
    splat_set_texture(&set, seed, COUNT, 2, 0.7, 0.35, 0.15);
    for (int i = 0; i < COUNT; i++) {
        centre[i] = (float)pick(seed, 0, 1);
        width[i] = (float)log(pick_log(seed, 2e-3, 0.1) / j->stop);
        for (int k = 0; k < 2; k++) mean[9 * i + k] = (float)pick(seed, -0.3, 0.3);
    }
    const tides_polynomial_motion arrays = {COUNT, 0, 1, centre, width, mean, turn, .plain_colour = 0};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    flat_ground(j, seed);
    world_add_moving(j->scene, &set, motion, j->stop);
}

/* -- the table ------------------------------------------------------------------------------------------------------------- */

typedef struct kind {
    const char *name;
    void (*fill)(judged *j, uint64_t *seed);
} kind;
static const kind kinds[] = {{"ball", ball},
                             {"near touch", near_touch},
                             {"needles", needles},
                             {"yaw", yaw},
                             {"ball that turns", ball_that_turns},
                             {"leak", leak},
                             {"disc", disc},
                             {"slow drift", slow_drift},
                             {"balls", balls},
                             {"flicker", flicker},
                             {"occluder", occluder},
                             {"dolly", dolly},
                             {"leak and ball", leak_and_ball},
                             {"bells", bells},
                             {"handheld", handheld}};
enum { KINDS = sizeof kinds / sizeof *kinds };

int grazing_world_kinds(void) { return KINDS; }

judged grazing_world_make(uint64_t seed) {
    const kind *k = &kinds[seed % KINDS];
    uint64_t draws = seed * 0x9e3779b97f4a7c15u;
    char name[64];
    snprintf(name, sizeof name, "%llu: %s", (unsigned long long)seed, k->name);
    judged j = judged_make(name, WIDTH, HEIGHT, 0.02);
    j.sensor.threshold_on = pick_log(&draws, 0.03, 0.3);
    j.sensor.threshold_off = j.sensor.threshold_on * pick(&draws, 0.8, 1.25);
    j.image.log_eps = scene_next(&draws) % 2 ? 1e-3 : 1e-2;
    j.stop = scene_next(&draws) % 2 ? 0.02 : 0.035;
    j.frames = 500;
    k->fill(&j, &draws);
    return j;
}
