/* Levels that are met exactly: splats pass before an even backdrop, and their pixels return to the value with which they began.
 * That is on a level, and touching a level fires. So each pixel has as many events of either polarity, and hardly any is in
 * doubt. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/judged_run.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 40, HEIGHT = 30, SPLATS = 3 };
#define STOP 0.03
#define DEPTH 4
/* Half a way [scene units]: splats begin and end out of sight. */
#define WAY 4

/* A bright, a dark and a faint splat, one above the other and at their own depths. */
static void add_splats(judged *j) {
    static const float quaternion[4 * SPLATS] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const float mean[3 * SPLATS] = {0, -0.7f, 0, 0.1f, 0, 0.3f, -0.2f, 0.6f, 0.6f}, logit[SPLATS] = {2, 1, -2};
    static const float sh[3 * SPLATS] = {3, 3, 3, -1.5f, -1.5f, -1.5f, 5, 5, 5};
    float log_scale[3 * SPLATS];
    tides_error error;
    tides_trajectory *path;
    const tides_pose_sample samples[2] = {{.time = 0, .position = {-WAY, 0, DEPTH}, .quaternion = {1, 0, 0, 0}},
                                          {.time = STOP, .position = {WAY, 0, DEPTH}, .quaternion = {1, 0, 0, 0}}};
    for (int i = 0; i < 3 * SPLATS; i++) log_scale[i] = logf(0.25f);
    const tides_gaussians view = {.count = SPLATS,
                                  .sh_degree = 0,
                                  .mean = mean,
                                  .log_scale = log_scale,
                                  .quaternion = quaternion,
                                  .opacity_logit = logit,
                                  .sh = sh};
    scene_expect_ok(tides_trajectory_create(samples, 2, &path, &error), &error);
    scene_expect_ok(tides_scene_add(j->scene, &view, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
}

static void pass(const char *device, double threshold, double backdrop, double refractory_s, int32_t law) {
    judged j = judged_make("ties", WIDTH, HEIGHT, STOP);
    judged_stream stream = {0};
    tides_stats stats;
    int net[WIDTH * HEIGHT] = {0};
    judged_look_up(&j);
    add_splats(&j);
    j.sensor.threshold_on = j.sensor.threshold_off = threshold;
    j.sensor.refractory_s = refractory_s;
    j.sensor.refractory_law = law;
    for (int c = 0; c < 3; c++) j.image.background[c] = backdrop;
    const int is_there = judged_simulate(&j, device, &stream, &stats);
    judged_free(&j);
    if (!is_there) return;
    for (size_t k = 0; k < stream.count; k++) net[stream.events[k].y * WIDTH + stream.events[k].x] += stream.events[k].polarity;
    print_message("%s, C %g before %g: %zu events, %d uncertain, p99 %.3g ns\n", device, threshold, backdrop, stream.count,
                  (int)stats.events_uncertain, 1e9 * stats.error_p99_s);
    assert_true(stream.count > 500);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (net[i] != 0) fail_msg("pixel (%d, %d) ends %d levels off", i % WIDTH, i / WIDTH, net[i]);
    assert_true(stats.events_uncertain <= 2 * (1 + stream.count / 20000)); /* a level in doubt counts as two events */
    assert_true(stats.error_p99_s < 1e-6);
    free(stream.events);
}

static void test_returns(void **state) {
    static const double thresholds[] = {0.2, 0.15, 0.07}, backdrops[] = {0.1, 0.3};
    (void)state;
    for (size_t k = 0; k < sizeof thresholds / sizeof *thresholds; k++)
        for (size_t i = 0; i < sizeof backdrops / sizeof *backdrops; i++) {
            pass("reference", thresholds[k], backdrops[i], 0, TIDES_REFRACTORY_HOLD);
            pass("cpu", thresholds[k], backdrops[i], 0, TIDES_REFRACTORY_HOLD);
        }
}

/* A refractory period of a nanosecond drops nothing, but has pixels with blocks. */
static void test_returns_with_blocks(void **state) {
    static const int32_t laws[] = {TIDES_REFRACTORY_DROP_KEEP, TIDES_REFRACTORY_DROP_CONSUME};
    (void)state;
    for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
        pass("reference", 0.2, 0.3, 1e-9, laws[k]);
        pass("cpu", 0.2, 0.3, 1e-9, laws[k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_returns), cmocka_unit_test(test_returns_with_blocks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
