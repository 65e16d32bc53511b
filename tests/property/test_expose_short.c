/* Exposed frames of what is short: flashes, trains of pulses, bells of opacity and leaps of 5 us to 1 ms in 10 and 30 ms. Light
 * is within the tolerance or its pixels are counted, and no further off than said. The truth is a sum of our own over the
 * formula that the scene was made from: one splat at rest, what it is weighed by in each pixel, and its light or opacity. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"
#include "tides/exposure.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 20, HEIGHT = 16, PIXELS = WIDTH * HEIGHT, KEYS_MAX = 20001, POINTS = 400 };

/* What rounding, and our own sum, may be off by. */
static const double own_error = 2e-6;

/* -- light that is keyed --------------------------------------------------------------------------------------------------- */

typedef struct keyed {
    int count;
    double time[KEYS_MAX], light[KEYS_MAX];
} keyed;

static void add_key(keyed *k, double time, double light) {
    assert_true(k->count < KEYS_MAX && (k->count == 0 || time > k->time[k->count - 1]));
    k->time[k->count] = time;
    k->light[k->count++] = light;
}

static double slope_at(const keyed *k, int i) {
    const int before = i > 0 ? i - 1 : i, after = i + 1 < k->count ? i + 1 : i;
    const double slope = (k->light[after] - k->light[before]) / (k->time[after] - k->time[before]);
    return before == i || after == i ? 0.5 * slope : slope;
}

/* The mean of the light over [start, stop], negative light being none: point by point in each key's stretch. */
static double mean_light(const keyed *k, double start, double stop) {
    double sum = 0;
    for (int i = 0; i + 1 < k->count; i++) {
        const double from = fmax(start, k->time[i]), to = fmin(stop, k->time[i + 1]), span = k->time[i + 1] - k->time[i];
        for (int p = 0; p < POINTS && to > from; p++) {
            const double s = (from + (to - from) * (p + 0.5) / POINTS - k->time[i]) / span, r = 1 - s;
            const double light = r * r * (1 + 2 * s) * k->light[i] + s * s * (1 + 2 * r) * k->light[i + 1] +
                                 span * s * r * (r * slope_at(k, i) - s * slope_at(k, i + 1));
            sum += fmax(light, 0) * (to - from) / POINTS;
        }
    }
    return sum / (stop - start);
}

static float coefficient_of(double light) { return (float)((light - 0.5) / WORLD_SH0); }

/* One splat before black that is as wide as the image, with this light. */
static tides_scene *keyed_scene(keyed *k) {
    splat_set set = {0};
    tides_scene *scene = scene_new();
    tides_motion *motion = NULL;
    tides_error error;
    splat_set_ball(&set, 0.1, 0.05, 4, 0.5, 0.8, 0.5);
    float *mean = calloc((size_t)k->count * 11, sizeof *mean), *quaternion = mean + 3 * k->count;
    float *sh = quaternion + 4 * k->count;
    const double from = k->time[0];
    for (int i = 0; i < k->count; i++) {
        for (int c = 0; c < 3; c++) {
            mean[3 * i + c] = set.mean[c];
            sh[3 * i + c] = coefficient_of(k->light[i]);
            assert_true(from >= 0);
        }
        quaternion[4 * i] = 1;
        k->light[i] = 0.5 + WORLD_SH0 * (double)sh[3 * i]; /* as it was rounded */
    }
    const tides_keyframes_motion arrays = {.frames = k->count,
                                           .count = 1,
                                           .time = k->time,
                                           .mean = mean,
                                           .quaternion = quaternion,
                                           .sh = sh,
                                           .catmull_rom = 1};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    world_add_moving(scene, &set, motion, k->time[k->count - 1]);
    free(mean);
    return scene;
}

/* -- a frame of it --------------------------------------------------------------------------------------------------------- */

typedef struct rig {
    tides_device *device;
    tides_renderer *renderer;
    tides_trajectory *still;
    double light[PIXELS];
    tides_exposed done;
} rig;

static rig rig_of(const tides_scene *scene) {
    static const double origin[3] = {0, 0, 0}, upright[4] = {1, 0, 0, 0};
    const tides_intrinsics lens = {.width = WIDTH, .height = HEIGHT, .fx = 30, .fy = 30, .cx = 9.5, .cy = 8};
    rig r = {.device = open_device("reference")};
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    scene_expect_ok(tides_renderer_create(r.device, scene, &lens, &params, NULL, NULL, &r.renderer, &error), &error);
    scene_expect_ok(tides_trajectory_create_static(origin, upright, &r.still, &error), &error);
    return r;
}

static void free_rig(rig *r) {
    tides_trajectory_destroy(r->still);
    tides_renderer_destroy(r->renderer);
    tides_device_close(r->device);
}

static void expose(rig *r, double time, double exposure_s, double tolerance) {
    tides_exposure e;
    tides_error error;
    tides_exposure_defaults(&e);
    e.exposure_s = exposure_s;
    e.tolerance = tolerance;
    scene_expect_ok(tides_renderer_expose(r->renderer, r->still, time, &e, r->light, &r->done, &error), &error);
}

static void sharp(rig *r, double time, double *Y) {
    tides_frame frame = {{NULL}};
    tides_error error;
    frame.plane[TIDES_Y] = Y;
    scene_expect_ok(tides_renderer_frame(r->renderer, r->still, time, &frame, &error), &error);
}

/* What was exposed against the truth of each pixel. */
static void expect_honest(const rig *r, const double *truth, double tolerance, const char *what) {
    double off = 0;
    for (int i = 0; i < PIXELS; i++) off = fmax(off, fabs(r->light[i] - truth[i]));
    if (getenv("TIDES_VERBOSE"))
        print_message("%s: off %.3g, said %.3g, unsettled %d, renders %.0f\n", what, off, r->done.error, (int)r->done.unsettled,
                      r->done.renders);
    if (off > r->done.error + own_error || (off > tolerance + own_error && r->done.unsettled == 0))
        fail_msg("%s: off %g, said %g, unsettled %d, renders %g", what, off, r->done.error, (int)r->done.unsettled,
                 r->done.renders);
}

/* A frame of keyed light, whose first key is the quiet light. */
static void check_keyed(keyed *k, double start, double exposure_s, double tolerance, const char *what) {
    double weight[PIXELS], truth[PIXELS];
    tides_scene *scene = keyed_scene(k);
    rig r = rig_of(scene);
    const double mean = mean_light(k, start, start + exposure_s);
    sharp(&r, 0, weight);
    for (int i = 0; i < PIXELS; i++) truth[i] = weight[i] / k->light[0] * mean;
    expose(&r, start + 0.5 * exposure_s, exposure_s, tolerance);
    expect_honest(&r, truth, tolerance, what);
    free_rig(&r);
    tides_scene_destroy(scene);
}

static const double lengths[] = {5e-6, 20e-6, 50e-6, 200e-6, 1e-3};
enum { LENGTHS = sizeof lengths / sizeof *lengths };

static void flashes(void **state) {
    uint64_t seed = 38;
    char what[96];
    (void)state;
    for (int trial = 0; trial < 4 * LENGTHS; trial++) {
        const double length = lengths[trial % LENGTHS], exposure = trial % 2 ? 10e-3 : 30e-3;
        const double at = 0.02 + exposure * scene_between(&seed, 0, 1), peak = trial < 2 * LENGTHS ? 20 : 1.5;
        keyed k = {0};
        add_key(&k, 0, 0.3);
        add_key(&k, at - 0.5 * length, 0.3);
        add_key(&k, at, peak);
        add_key(&k, at + 0.5 * length, 0.3);
        add_key(&k, 0.1, 0.3);
        snprintf(what, sizeof what, "flash of %g us, light %g, in %g ms", 1e6 * length, peak, 1e3 * exposure);
        check_keyed(&k, 0.02, exposure, trial < LENGTHS ? 1e-3 : trial < 2 * LENGTHS ? 1e-2 : 1e-4, what);
    }
}

/* A train of pulses of so long, every five times as long; and one flash in frames as dense as that. */
static void trains_and_dense_frames(void **state) {
    char what[96];
    (void)state;
    for (int trial = 0; trial < 2 * LENGTHS; trial++) {
        const double length = lengths[trial % LENGTHS], exposure = 10e-3;
        static keyed k;
        k.count = 0;
        add_key(&k, 0, 0.1);
        for (double t = 0.0199; t < 0.0311 && trial < LENGTHS; t += 5 * length) {
            add_key(&k, t, 0.1);
            add_key(&k, t + 0.1 * length, 4);
            add_key(&k, t + 0.9 * length, 4);
            add_key(&k, t + length, 0.1);
        }
        for (int i = 0; i * 0.5 * length < 0.0112 && trial >= LENGTHS; i++)
            add_key(&k, 0.0199 + i * 0.5 * length, i * 0.5 * length > 0.0043 && i * 0.5 * length <= 0.0043 + length ? 9 : 0.1);
        add_key(&k, 0.1, 0.1);
        snprintf(what, sizeof what, "%s of %g us", trial < LENGTHS ? "pulses" : "a flash in frames", 1e6 * length);
        check_keyed(&k, 0.02, exposure, 1e-3, what);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(flashes), cmocka_unit_test(trains_and_dense_frames)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
