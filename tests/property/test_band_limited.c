/* Random band-limited motions, 0 to 2 kHz, commensurate with the steps or not, of camera, objects, opacity, colour, size and
 * rotation, at default settings: no event is lost or invented, and reported errors are no smaller than true ones.
 * test_blindness.c has the cases that were once lost.
 *
 * TIDES_TRIALS=N: N trials instead of a handful. TIDES_SEED=N: the first one's seed. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/judged_run.h"
#include "tests/support/number_of.h"
#include "tests/support/pulsing_callback.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 20, HEIGHT = 10, FEW = 6 };
#define FOCAL (1.25 * WIDTH)
#define PIXEL_AT_2 (2 / FOCAL) /* scene units of a pixel at depth 2 */
#define HIGHEST_HZ 2000.0
#define STEP_S 0.01 /* the default longest step, which frequencies are commensurate with */
#define MOST_FRAMES 8000

/* Of all trials' events, in percent; and of one trial's, which may be few. */
#define MOST_MISMATCH 0.05
#define MOST_OF_ONE 0.25

/* -- one trial ------------------------------------------------------------------------------------------------------------- */

enum { COMMENSURATE = 0, HALF_COMMENSURATE, ANY, ANY_DECADE, LAWS };

typedef struct trial {
    uint64_t seed;
    int law;
    double highest;  /* [Hz] of this trial */
    double fastest;  /* that came */
    int by_function; /* what pulses does so by a function that declares its time scale, not by keyframes */
} trial;

static double draw_hz(trial *t) {
    double hz = t->law == ANY_DECADE ? world_between_log(&t->seed, 5, t->highest) : scene_between(&t->seed, 0, t->highest);
    const double unit = (t->law == COMMENSURATE ? 1 : 0.5) / STEP_S;
    if (t->law == COMMENSURATE || t->law == HALF_COMMENSURATE) hz = unit * fmax(1, round(hz / unit));
    t->fastest = fmax(t->fastest, hz);
    return hz;
}

/* One to three sines; half of the commensurate ones at rest where steps end. */
static waves draw_waves(trial *t, double amplitude) {
    waves w = {.count = 1 + (int)(scene_next(&t->seed) % 3)};
    const int symmetric = scene_next(&t->seed) % 2;
    for (int i = 0; i < w.count; i++) {
        w.hz[i] = draw_hz(t);
        w.amplitude[i] = amplitude / w.count;
        w.phase[i] = symmetric ? 0.5 * WORLD_PI : scene_between(&t->seed, 0, 2 * WORLD_PI);
    }
    return w;
}

static int tossed(trial *t, double share) { return scene_between(&t->seed, 0, 1) < share; }
static double pixels(trial *t) { return world_between_log(&t->seed, 0.2, 4); }

/* As recorded (no rates, 8 samples or more of the fastest period), or exact. */
static tides_trajectory *sampled(trial *t, const shaking *s, double stop) {
    const int rates = tossed(t, 0.5);
    return shaking_path(s, 0, stop, 1 / (scene_between(&t->seed, rates ? 6 : 8, 20) * fmax(t->fastest, 50)), rates);
}

static void add_camera(judged *j, trial *t) {
    shaking s = {.place = {0, 0, 0}};
    if (tossed(t, 0.7)) s.turn[0] = draw_waves(t, pixels(t) / FOCAL);
    if (tossed(t, 0.7)) s.turn[1] = draw_waves(t, pixels(t) / FOCAL);
    if (tossed(t, 0.3)) s.turn[2] = draw_waves(t, 0.1 * pixels(t));
    if (tossed(t, 0.5)) s.shift[0] = draw_waves(t, pixels(t) * PIXEL_AT_2);
    if (tossed(t, 0.3)) s.shift[2] = draw_waves(t, 2 * pixels(t) * PIXEL_AT_2);
    judged_camera(j, sampled(t, &s, j->stop));
}

static void add_object(judged *j, trial *t, splat_set *set) {
    shaking s = {.place = {0, 0, 0}};
    if (tossed(t, 0.7)) s.shift[0] = draw_waves(t, pixels(t) * PIXEL_AT_2);
    if (tossed(t, 0.7)) s.shift[1] = draw_waves(t, pixels(t) * PIXEL_AT_2);
    if (tossed(t, 0.3)) s.shift[2] = draw_waves(t, 2 * pixels(t) * PIXEL_AT_2);
    if (tossed(t, 0.6)) s.turn[2] = draw_waves(t, 0.2 * pixels(t));
    if (tossed(t, 0.3)) s.spin[2] = 2 * WORLD_PI * draw_hz(t) * 0.1;
    tides_trajectory *path = sampled(t, &s, j->stop);
    world_add(j->scene, set, path);
    tides_trajectory_destroy(path);
}

static void add_pulsing(judged *j, trial *t, splat_set *set) {
    pulsing p = {.logit = {0}};
    if (tossed(t, 0.5)) p.logit = draw_waves(t, scene_between(&t->seed, 0.2, 1.5));
    if (tossed(t, 0.3)) p.log_size = draw_waves(t, scene_between(&t->seed, 0.05, 0.4));
    if (tossed(t, 0.3)) p.turn = draw_waves(t, scene_between(&t->seed, 0.1, 1));
    if (tossed(t, 0.3)) p.shift[0] = draw_waves(t, pixels(t) * PIXEL_AT_2);
    if (tossed(t, 0.5) || t->fastest == 0) p.light = draw_waves(t, scene_between(&t->seed, 0.1, 0.7));
    const double fastest = fmax(t->fastest, 50), interval = 1 / (scene_between(&t->seed, 8, 20) * fastest);
    tides_motion *motion;
    if (t->by_function) {
        j->user = malloc(sizeof p);
        assert_non_null(j->user);
        memcpy(j->user, &p, sizeof p);
        motion = pulsing_callback(set, j->user, j->stop, 1 / fastest);
    } else {
        motion = pulsing_keyframes(set, &p, j->stop, interval);
    }
    world_add_moving(j->scene, set, motion, 0);
}

static judged draw_trial(uint64_t seed) {
    trial t = {.seed = seed, .by_function = seed % 3 == 0};
    char name[64];
    t.law = (int)(scene_next(&t.seed) % LAWS);
    t.highest = world_between_log(&t.seed, 200, HIGHEST_HZ);
    judged j = judged_make("", WIDTH, HEIGHT, t.highest > 700 ? STEP_S : 2 * STEP_S);
    splat_set wall = {0}, thing = {0}, lit = {0};
    splat_set_texture(&wall, &t.seed, 14, 3, 1.3, 0.8, 0.3);
    splat_set_texture(&thing, &t.seed, 6, 2, 0.5, 0.3, 0.15);
    splat_set_texture(&lit, &t.seed, 6, 2.5, 0.9, 0.5, 0.2);
    const int camera = tossed(&t, 0.5), object = tossed(&t, 0.5), pulse = tossed(&t, 0.5) || (!camera && !object);
    world_add(j.scene, &wall, NULL);
    if (camera) add_camera(&j, &t);
    if (object)
        add_object(&j, &t, &thing);
    else
        world_add(j.scene, &thing, NULL);
    if (pulse)
        add_pulsing(&j, &t, &lit);
    else
        world_add(j.scene, &lit, NULL);
    snprintf(name, sizeof name, "%llu: law %d, %s%s%sto %.0f Hz", (unsigned long long)seed, t.law, camera ? "camera " : "",
             object ? "object " : "", pulse ? t.by_function ? "function " : "light " : "", t.fastest);
    snprintf(j.name, sizeof j.name, "%s", name);
    j.sensor.threshold_on = world_between_log(&t.seed, 0.02, 0.1);
    j.sensor.threshold_off = 1.037 * j.sensor.threshold_on; /* what comes back to where it began touches no level there */
    j.image.log_eps = tossed(&t, 0.5) ? 1e-3 : 1e-2;
    j.frames = 2 * (int)fmax(250, 60 * t.fastest * j.stop);
    return j;
}

/* -- all of them ----------------------------------------------------------------------------------------------------------- */

typedef struct tally {
    double exact, mismatched, unknown;
    int failures;
} tally;

static void count(tally *all, const judged *j, const char *device, const judged_verdict *v) {
    const double unknown = (double)(v->halved.missing + v->halved.spurious); /* to the exact stream itself */
    const double mismatched = (double)(v->match.missing + v->match.spurious), exact = (double)v->match.reference;
    const int fine = mismatched <= unknown + fmax(2, 0.01 * MOST_OF_ONE * exact) && judged_honest(v);
    all->exact += exact;
    all->mismatched += mismatched;
    all->unknown += unknown;
    all->failures += !fine;
    judged_print(j, device, v);
}

static void test_random_motions(void **state) {
    static const char *const devices[] = {"reference", "reference-f32"};
    static const char *const looked_up[] = {"reference, looked up", "reference-f32, looked up"};
    static const judged_scale scale = {0.1, JUDGED_LIMIT_S, MOST_FRAMES};
    (void)state;
    const uint64_t first = number_of("TIDES_SEED", 1202), trials = number_of("TIDES_TRIALS", FEW);
    tally tallies[4] = {{.exact = 0}};
    for (uint64_t k = 0; k < trials; k++) {
        judged j = draw_trial(first + k);
        judged_stream exact = {0};
        judged_verdict v = judged_against_exact(&j, devices[0], &scale, NULL, &exact), twin;
        count(&tallies[0], &j, devices[0], &v);
        twin = judged_against(&j, devices[1], JUDGED_LIMIT_S, &exact);
        twin.halved = v.halved;
        count(&tallies[1], &j, devices[1], &twin);
        judged_look_up(&j);
        for (int d = 0; d < 2; d++) {
            twin = judged_against(&j, devices[d], JUDGED_LIMIT_S, &exact);
            twin.halved = v.halved;
            count(&tallies[2 + d], &j, looked_up[d], &twin);
        }
        free(exact.events);
        judged_free(&j);
    }
    int failures = 0;
    for (int d = 0; d < 4; d++) {
        const tally *all = &tallies[d];
        print_message("%s: %llu trials, %.0f events, %.0f mismatched (%.3g %%), %.0f unknown, %d failed\n",
                      d < 2 ? devices[d] : looked_up[d - 2], (unsigned long long)trials, all->exact, all->mismatched,
                      100 * all->mismatched / all->exact, all->unknown, all->failures);
        failures += all->failures + (all->mismatched > all->unknown + 0.01 * MOST_MISMATCH * all->exact);
    }
    assert_true(tallies[0].exact > 1000);
    assert_int_equal(failures, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_motions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
