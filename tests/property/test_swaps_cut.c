/* Tiles with more pairs of splats than are searched for swaps of depth (lib/render/swaps.c, MOST_PAIRS): swaps of the splats
 * that show most are found, and the tile counts in events_uncertain. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"

/* FEW^2 / 2 pairs are searched, and MANY^2 / 2 are 4 % more than that. While they were searched in order of depth, 600 of 2428
 * events were lost. */
enum { FEW = 800, MANY = 1480, MOST = MANY / 2 + 1, SAMPLES = 41 };
#define STOP 0.02

typedef struct columns {
    float mean[3 * MOST], quaternion[4 * MOST], log_scale[3 * MOST], logit[MOST], sh[3 * MOST];
} columns;

/* A splat on the camera's axis. */
static void put(columns *c, int i, double z, double opacity, double light) {
    for (int k = 0; k < 3; k++) {
        c->mean[3 * i + k] = k == 2 ? (float)z : 0;
        c->log_scale[3 * i + k] = (float)log(0.4);
        c->sh[3 * i + k] = (float)((light - 0.5) / 0.28209479177387814);
    }
    c->quaternion[4 * i] = 1;
    c->logit[i] = (float)log(opacity / (1 - opacity));
}

/* Adds `dust` splats that hardly show at depth 1, and one that does at depth z. */
static void add_body(tides_scene *scene, int dust, double z, double light, const tides_trajectory *path) {
    columns *c = calloc(1, sizeof *c);
    tides_error error;
    assert_non_null(c);
    for (int i = 0; i < dust; i++) put(c, i, 1, 6e-4, 0.2);
    put(c, dust, z, 0.9, light);
    const tides_gaussians all = {.count = dust + 1,
                                 .mean = c->mean,
                                 .log_scale = c->log_scale,
                                 .quaternion = c->quaternion,
                                 .opacity_logit = c->logit,
                                 .sh = c->sh};
    scene_expect_ok(tides_scene_add(scene, &all, path, 1, NULL, NULL, &error), &error);
    free(c);
}

/* A path whose depth is a parabola: 1e-3 before 0 at 13.3 ms, and behind it 0.3 ms earlier and later. */
static tides_trajectory *make_dip(void) {
    const double past = 1e-3, half = 3e-4, centre = 0.0133;
    tides_pose_sample samples[SAMPLES];
    tides_trajectory *path = NULL;
    tides_error error;
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < SAMPLES; i++) {
        const double t = i + 1 < SAMPLES ? STOP * i / (SAMPLES - 1) : STOP, off = (t - centre) / half;
        samples[i].time = t;
        samples[i].position[2] = past * (off * off - 1);
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, SAMPLES, &path, &error), &error);
    return path;
}

/* Two splats, one before the other, that change places for 0.6 ms. Each has as much dust with it. */
static outcome run_with(tides_device *device, int dust) {
    static const double here[3] = {0, 0, 0}, ahead[4] = {1, 0, 0, 0};
    job j = {.camera = {16, 16, 20, 20, 8, 8, {0}}, .stop = STOP};
    tides_scene *scene = NULL;
    tides_trajectory *camera = NULL, *dip = make_dip();
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    add_body(scene, dust, 2.5, 0.2, NULL);
    add_body(scene, dust, 2.5, 2, dip);
    scene_expect_ok(tides_trajectory_create_static(here, ahead, &camera, &error), &error);
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    j.scene = scene;
    j.path = camera;
    const outcome o = run_on(&j, device);
    tides_trajectory_destroy(dip);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return o;
}

static void test_cut(void **state) {
    tides_device *device = open_device("cpu");
    (void)state;
    if (!device) skip();
    outcome few = run_with(device, FEW / 2), many = run_with(device, MANY / 2);
    const unsigned long long certain = few.stats.events_uncertain, cut = many.stats.events_uncertain;
    print_message("%zu events, %llu uncertain; with too many pairs %zu, %llu uncertain\n", few.count, certain, many.count, cut);
    assert_true(few.count > 2000 && certain == 0);
    assert_true(many.count == few.count && cut > 0);
    free_outcome(&few);
    free_outcome(&many);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cut)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
