/* Steps of 4x4 blocks (stepping.unit) on a signal in closed form: a block is composited only where something asks for it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/signal_world.h"

enum { WIDTH = 41, HEIGHT = 23, MACRO_STEPS = 2, LAMP_X = 21, LAMP_Y = 6 }; /* tiles and blocks cut at both borders */

/* All pixels rise by less than a threshold; one flickers. */
static void one_lamp(const void *about, int x, int y, double time, double *S, double *S_dot) {
    const double rate = 2 * 3.141592653589793 * 700;
    int is_lamp = x == LAMP_X && y == LAMP_Y;
    (void)about;
    *S = 1e-3 * (x + y) + 0.5 * time + (is_lamp ? 0.4 * sin(rate * time) : 0);
    *S_dot = 0.5 + (is_lamp ? 0.4 * rate * cos(rate * time) : 0);
}

/* How often the lamp's pixel was rendered more than the macro steps' ends and their first cuts ask for. */
static void test_only_what_asks_is_composited(void **state) {
    const uint64_t blocks = (WIDTH + 3) / 4 * ((HEIGHT + 3) / 4), tiles = (WIDTH + 15) / 16 * ((HEIGHT + 15) / 16);
    const uint64_t least = 1 + 2 * MACRO_STEPS;
    signal_class lamp = {.signal = one_lamp};
    tides_scene *scene;
    tides_trajectory *path;
    (void)state;
    make_signal_scene(&scene, &path);
    job j = signal_job(scene, path, WIDTH, HEIGHT);
    j.stop = MACRO_STEPS * j.stepping.step_s;
    outcome whole = run_signal(&j, &lamp);
    j.stepping.unit = TIDES_UNIT_BLOCK;
    outcome parts = run_signal(&j, &lamp);
    check_stream(&j, &parts);
    check_state(&j, &parts);
    expect_same(&whole, &parts, "one lamp"); /* its pixel has the same steps */
    uint64_t asked = parts.stats.render.tile_jobs - least * tiles;
    assert_true(asked > 10);
    assert_int_equal(parts.stats.render.blocks, least * blocks + asked);
    assert_int_equal(whole.stats.render.tile_jobs, parts.stats.render.tile_jobs);
    assert_int_equal(whole.stats.render.blocks, TD_TILE_BLOCKS * whole.stats.render.tile_jobs);
    assert_int_equal(parts.stats.steps, MACRO_STEPS * 2 * blocks + asked);
    free_outcome(&whole);
    free_outcome(&parts);
    tides_scene_destroy(scene);
    tides_trajectory_destroy(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_only_what_asks_is_composited)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
