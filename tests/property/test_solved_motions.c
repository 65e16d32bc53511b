/* Events by look-ups in double (stepping.solve), of Gaussians that move by themselves faster than record paths can follow in
 * one piece: lamps, engines, bells. Every attribute that moves, by every model, against exact events of the double reference:
 * reported errors are no smaller than true ones.
 *
 * TIDES_TRIALS=1: all rows instead of a handful. TIDES_ROW=text: only rows whose name contains it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/judged_run.h"

#include "tests/support/pulsing_callback.h"
#include "tests/support/random_network.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Within one macro step; no whole number of periods, after which all would be where it was, on its levels. */
enum { WIDTH = 20, HEIGHT = 10 };
#define STOP 0.0097
#define FOCAL (1.25 * WIDTH)
#define PX (3 / FOCAL) /* scene units of a pixel at depth 3, where things are */

/* What is looked up in double has every splat: so must the frames that exact events come of. */
#define ALL_LIGHT 1e-14

/* -- what moves ------------------------------------------------------------------------------------------------------------ */

static splat_set textured(uint64_t seed, int count) {
    splat_set wall = {0};
    splat_set_texture(&wall, &seed, count, 3, 1.5, 0.9, 0.3);
    return wall;
}

/* One of the attributes, at `hz`. */
enum { LIGHT, LOGIT, SIZE, TURN, SHIFT, ALL };
static pulsing pulse_of(int which, double hz, double strength) {
    pulsing p = {.catmull_rom = 0};
    if (which == LIGHT || which == ALL) p.light = waves_one(0.3 * strength, hz, 0.7);
    if (which == LOGIT || which == ALL) p.logit = waves_one(1.0 * strength, hz, 0.7);
    if (which == SIZE || which == ALL) p.log_size = waves_one(0.3 * strength, hz, 0.7);
    if (which == TURN || which == ALL) p.turn = waves_one(0.6 * strength, hz, 0.7);
    if (which == SHIFT || which == ALL) p.shift[0] = waves_one(1.5 * PX * strength, hz, 0.7);
    if (which == SHIFT || which == ALL) p.shift[1] = waves_one(0.7 * PX * strength, 0.5 * hz, 0.2);
    return p;
}

typedef struct row {
    const char *name;
    void (*fill)(judged *j, const struct row *row);
    int which;
    double hz, strength, other; /* other: a row's own */
} row;

/* Twenty frames a period, as a lamp's are. */
static void keyframes(judged *j, const row *r) {
    splat_set wall = textured(7, 16);
    pulsing p = pulse_of(r->which, r->hz, r->strength);
    p.catmull_rom = r->other > 0;
    tides_motion *motion = pulsing_keyframes(&wall, &p, j->stop, 0.05 / r->hz);
    world_add_moving(j->scene, &wall, motion, j->stop);
}

static void callback(judged *j, const row *r) {
    splat_set wall = textured(8, 16);
    pulsing *p = malloc(sizeof *p);
    assert_non_null(p);
    *p = pulse_of(r->which, r->hz, r->strength);
    j->user = p;
    tides_motion *motion = pulsing_callback(&wall, p, j->stop, 0.1 / r->hz);
    world_add_moving(j->scene, &wall, motion, j->stop);
}

/* A few that flicker among many that don't, seen by a camera that moves. */
static void few(judged *j, const row *r) {
    splat_set wall = textured(9, 60), lamp = {0};
    pulsing p = pulse_of(r->which, r->hz, r->strength);
    const shaking s = {.velocity = {r->other * PX, 0, 0}};
    splat_set_ball(&lamp, 0.1, 0.05, 2.5, 0.4, 0.6, 0.9);
    tides_motion *motion = pulsing_keyframes(&lamp, &p, j->stop, 0.05 / r->hz);
    world_add(j->scene, &wall, NULL);
    world_add_moving(j->scene, &lamp, motion, j->stop);
    judged_camera(j, shaking_path(&s, 0, j->stop, 1e-3, 1));
}

/* Bells of opacity, `other` seconds wide, and means that go with them. */
static void bells(judged *j, const row *r) {
    enum { COUNT = 10 };
    float centre[COUNT], width[COUNT], mean[9 * COUNT] = {0}, turn[4 * COUNT] = {0};
    splat_set set = textured(10, COUNT), ground = textured(11, 16);
    tides_motion *motion = NULL;
    tides_error error;
    for (int i = 0; i < COUNT; i++) {
        centre[i] = (float)(0.05 + 0.1 * i);
        width[i] = (float)log(r->other / j->stop);
        mean[9 * i] = (float)(r->strength * PX), turn[4 * i + 3] = (float)r->strength;
    }
    const tides_polynomial_motion arrays = {COUNT, 0, 1, centre, width, mean, turn, .plain_colour = 0};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    world_add(j->scene, &ground, NULL);
    world_add_moving(j->scene, &set, motion, j->stop);
}

static void fudan(judged *j, const row *r) {
    enum { COUNT = 10, HARMONICS = 2 };
    float centre[COUNT], width[COUNT], right[4 * COUNT], harmonic[HARMONICS * 3 * COUNT];
    splat_set set = textured(12, COUNT), ground = textured(13, 16);
    tides_motion *motion = NULL;
    tides_error error;
    uint64_t seed = 14;
    for (int i = 0; i < COUNT; i++) {
        centre[i] = (float)scene_between(&seed, 0, 10);
        width[i] = (float)log(r->other / j->stop * 10);
        for (int k = 0; k < 4; k++) right[4 * i + k] = (float)scene_between(&seed, -1, 1);
    }
    for (int i = 0; i < HARMONICS * 3 * COUNT; i++) harmonic[i] = (float)scene_between(&seed, -0.3, 0.3);
    tides_rotor_motion arrays = {.count = COUNT, .start = 0, .stop = 10, .centre = centre, .log_scale_time = width};
    arrays.harmonics = HARMONICS;
    arrays.sh_harmonic = harmonic;
    if (r->which) arrays.quaternion_right = right;
    scene_expect_ok(tides_motion_create_rotor(&arrays, &motion, &error), &error);
    world_add(j->scene, &ground, NULL);
    world_add_moving(j->scene, &set, motion, j->stop);
}

static void hexplane(judged *j, const row *r) {
    splat_set set = {0};
    uint64_t seed = 15;
    splat_set_texture(&set, &seed, 16, 1, 0.5, 0.3, 0.1);
    random_hexplane_recipe recipe = {21, 8, {8, 8, 8, (int)r->other}, 2, 16, 1, r->which ? 31 : 7, 0, r->strength};
    tides_motion *motion = random_hexplane_make(&recipe);
    world_add_moving(j->scene, &set, motion, j->stop);
}

static void network(judged *j, const row *r) {
    splat_set set = {0};
    uint64_t seed = 16;
    splat_set_texture(&set, &seed, 16, 1, 0.5, 0.3, 0.1);
    random_network_recipe recipe = {22, 32, 3, 2, (int)r->other, 0, 0, r->which, r->strength};
    tides_motion *motion = random_network_make(&recipe);
    world_add_moving(j->scene, &set, motion, j->stop);
}

/* A path with samples: `other` of them a period. */
static void path(judged *j, const row *r) {
    splat_set wall = textured(17, 16);
    const shaking s = {.shift = {waves_one(r->strength * PX, r->hz, 0.7), waves_one(0.5 * r->strength * PX, 0.6 * r->hz, 0)},
                       .turn = {{0}, {0}, waves_one(0.05 * r->strength, r->hz, 1)}};
    tides_trajectory *way = shaking_path(&s, 0, j->stop, 1 / (r->other * r->hz), r->which);
    world_add(j->scene, &wall, way);
    tides_trajectory_destroy(way);
}

/* The first ones are tried always, all of them with TIDES_TRIALS. */
static const row rows[] = {
    {"keyframes light 1 kHz", keyframes, LIGHT, 1000, 1, 0},
    {"keyframes all 1 kHz", keyframes, ALL, 1000, 0.5, 0},
    {"catmull-rom all 1 kHz", keyframes, ALL, 1000, 0.5, 1},
    {"few 1 kHz", few, LIGHT, 1000, 1, 50},
    {"callback all 1 kHz", callback, ALL, 1000, 0.5, 0},
    {"hexplane 10 planes", hexplane, 0, 0, 0.05, 10},
    {"keyframes opacity 1 kHz", keyframes, LOGIT, 1000, 1, 0},
    {"keyframes scale 1 kHz", keyframes, SIZE, 1000, 1, 0},
    {"keyframes rotation 1 kHz", keyframes, TURN, 1000, 1, 0},
    {"keyframes position 1 kHz", keyframes, SHIFT, 1000, 1, 0},
    {"keyframes all 200 Hz", keyframes, ALL, 200, 0.5, 0},
    {"catmull-rom light 1 kHz", keyframes, LIGHT, 1000, 1, 1},
    {"callback light 200 Hz", callback, LIGHT, 200, 1, 0},
    {"callback light 1 kHz", callback, LIGHT, 1000, 1, 0},
    {"callback all 4 kHz", callback, ALL, 4000, 0.5, 0},
    {"bells 5 ms", bells, 0, 0, 10, 5e-3},
    {"bells 1 ms", bells, 0, 0, 10, 1e-3},
    {"bells 0.2 ms", bells, 0, 0, 10, 2e-4},
    {"fudan standing 3 ms", fudan, 0, 0, 0, 3e-3},
    {"fudan tilting 3 ms", fudan, 1, 0, 0, 3e-3},
    {"fudan tilting 0.3 ms", fudan, 1, 0, 0, 3e-4},
    {"hexplane 75 planes, all heads", hexplane, 1, 0, 0.05, 75},
    {"network 4 octaves", network, 0, 0, 0.05, 4},
    {"network 10 octaves", network, 0, 0, 0.05, 10},
    {"network screw 4 octaves", network, 1, 0, 0.05, 4},
    {"path 100 Hz", path, 1, 100, 2, 20},
    {"path 1 kHz", path, 1, 1000, 1, 20},
    {"path 1 kHz, few samples", path, 0, 1000, 1, 8},
    {"path 5 kHz", path, 1, 5000, 1, 20},
};
enum { ROWS = sizeof rows / sizeof *rows, BOUND = 5, ALWAYS };

/* -- the judgement --------------------------------------------------------------------------------------------------------- */

/* Of most that are tried always times are as good as solving makes them, too: what an honest report of bad ones isn't. Only
 * networks bend too often for that. */
#define MOST_P95_US 0.03

static void check_row(const row *r, int is_bound) {
    const judged_scale scale = {0.1, 0.01, 51200};
    judged j = judged_make(r->name, WIDTH, HEIGHT, STOP);
    int settled = 0;
    j.frames = 776; /* a multiple of those of 1 kHz */
    j.image.smoothing.stop_change = ALL_LIGHT;
    for (int k = 0; k < 3; k++) j.image.background[k] = 0.2;
    j.sensor.threshold_on = j.sensor.threshold_off = 0.1;
    r->fill(&j, r);
    j.stepping.tolerance = 0.03;
    j.stepping.solve = TIDES_SOLVE_DOUBLE;
    const judged_verdict v = judged_against_exact(&j, "reference", &scale, &settled, NULL);
    judged_print(&j, settled ? "" : "not settled", &v);
    if (!judged_honest(&v)) fail_msg("%s: reported errors are too small", r->name);
    if (v.match.reference == 0 || v.match.mismatch_percent > 2)
        fail_msg("%s: %g %% mismatched", r->name, v.match.mismatch_percent);
    if (is_bound && (v.match.mismatch_percent > 0 || v.timing.dt_p95_us > MOST_P95_US))
        fail_msg("%s: p95 %g us, %g %% mismatched", r->name, v.timing.dt_p95_us, v.match.mismatch_percent);
    judged_free(&j);
}

static void test_rows(void **state) {
    (void)state;
    const char *only = getenv("TIDES_ROW");
    const int rows_tried = only || getenv("TIDES_TRIALS") ? ROWS : ALWAYS;
    for (int k = 0; k < rows_tried; k++)
        if (!only || strstr(rows[k].name, only)) check_row(&rows[k], k < BOUND);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
