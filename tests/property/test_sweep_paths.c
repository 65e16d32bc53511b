/* Sweeps hold for any motion: at random times within an interval no splat's box exceeds the swept one, whatever camera, objects
 * and Gaussians do in between. Motions are band-limited vibrations up to 2 kHz, commensurate with the interval or not, bells
 * far narrower than it, and passages of the near plane. Changes that are over between two samples ask for shorter steps; slow
 * ones don't. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/sweep_world.h"

static const uint64_t SEED = 1912;

/* -- boxes ---------------------------------------------------------------------------------------------------------- */

static void sweep(tides_renderer *renderer, const tides_trajectory *path, double start, double stop) {
    tides_error error;
    scene_expect_ok(td_renderer_sweep(renderer, path, start, stop, &error), &error);
}

/* How far a box at one time reaches out of a swept one, within the image [px]; 0 where it is outside of the image. */
static double overhang(const tides_renderer *renderer, const float *swept, const float *now) {
    double right = renderer->image.width, bottom = renderer->image.height;
    if (!(now[0] < right && now[1] < bottom && now[2] > 0 && now[3] > 0)) return 0;
    double x = fmax(swept[0] - fmax(now[0], 0), fmin(now[2], right) - swept[2]);
    double y = fmax(swept[1] - fmax(now[1], 0), fmin(now[3], bottom) - swept[3]);
    return fmax(fmax(x, y), 0);
}

/* By how many times swept boxes are larger than need be: summed over splats, and how many there are. */
typedef struct areas {
    double ratio, count;
} areas;

static double area_of(const tides_renderer *renderer, const float *box) {
    double x = fmin(box[2], renderer->image.width) - fmax(box[0], 0),
           y = fmin(box[3], renderer->image.height) - fmax(box[1], 0);
    return x > 0 && y > 0 ? x * y : 0;
}

/* The most over random times within [start, start + length]. */
static double worst_overhang(tides_renderer *renderer, const world *w, uint64_t *seed, double start, double length,
                             areas *sum) {
    enum { TIMES = 24 };
    size_t bytes = (size_t)renderer->store.count * 4 * sizeof(float);
    float *swept = malloc(bytes), *joined = malloc(bytes);
    double worst = 0;
    assert_true(swept && joined);
    sweep(renderer, w->path, start, start + length);
    memcpy(swept, renderer->sweep.boxes, bytes);
    for (int k = 0; k < TIMES; k++) {
        double time = scene_between(seed, start, start + length);
        sweep(renderer, w->path, time, time);
        for (int i = 0; i < 4 * renderer->store.count; i++) {
            float now = renderer->sweep.boxes[i];
            joined[i] = k == 0 || (i % 4 < 2 ? now < joined[i] : now > joined[i]) ? now : joined[i];
            if (i % 4 == 0) worst = fmax(worst, overhang(renderer, swept + i, renderer->sweep.boxes + i));
        }
    }
    for (int i = 0; i < renderer->store.count; i++) {
        double needed = area_of(renderer, joined + 4 * (size_t)i);
        if (!(needed > 16)) continue;
        sum->ratio += area_of(renderer, swept + 4 * (size_t)i) / needed;
        sum->count++;
    }
    free(joined);
    free(swept);
    return worst;
}

/* What the camera sees through, as wide as 150 degrees from corner to corner. */
static void bend(tides_intrinsics *camera, int lens) {
    static const tides_lens bent[] = {{0},
                                      {TIDES_LENS_RADTAN, 0, -0.25, 0.09, -0.01, 0, 2e-3, -1e-3},
                                      {TIDES_LENS_EQUIDISTANT, 0, -0.03, 0.006, -0.001, 1e-4, 0, 0}};
    camera->lens = bent[lens];
    if (lens == TIDES_LENS_EQUIDISTANT) camera->fx = camera->fy = 158;
    if (lens == TIDES_LENS_RADTAN) camera->fx = camera->fy = 230;
}

static void check_kind(int kind, const char *name, int trials, int lens) {
    static const double steps[] = {1e-3, 3.3e-3, 10e-3};
    const char *more = getenv("TIDES_TRIALS");
    double worst = 0;
    areas sum = {0, 0};
    tides_device *device = open_device("reference-f32");
    if (more) trials *= atoi(more);
    for (int trial = 0; trial < trials; trial++) {
        uint64_t seed = SEED + 1000 * (uint64_t)kind + (uint64_t)trial;
        double step = steps[trial % 3];
        world w = make_world(&seed, kind, trial % 2 ? step : 0);
        if (lens) bend(&w.camera, lens);
        tides_renderer *renderer = make_renderer(device, w.scene, &w.camera, trial % RULES);
        for (int i = 0; i < 3; i++) {
            double start = i == 0 ? 0 : i == 1 ? step : scene_between(&seed, 0, LASTS - step);
            double most = worst_overhang(renderer, &w, &seed, start, step, &sum);
            if (!(most < 0.01))
                print_message("%s, trial %d: a splat reaches out by %g px, step %g from %.9g\n", name, trial, most, step,
                              start);
            worst = fmax(worst, most);
        }
        tides_renderer_destroy(renderer);
        free_world(&w);
    }
    print_message("%s: splats reach out by at most %.3g px; boxes are %.3g times what is needed\n", name, worst,
                  sum.ratio / sum.count);
    assert_true(worst < 0.01); /* boxes are that much wider than splats, for rounding */
    tides_device_close(device);
}

static void test_shaken_camera(void **state) {
    (void)state;
    check_kind(CAMERA, "camera", 24, TIDES_LENS_NONE);
}
static void test_shaken_object(void **state) {
    (void)state;
    check_kind(OBJECT, "object", 24, TIDES_LENS_NONE);
}
static void test_shaken_gaussians(void **state) {
    (void)state;
    check_kind(FRAMES, "frames", 12, TIDES_LENS_NONE);
}
static void test_narrow_bells(void **state) {
    (void)state;
    check_kind(BELLS, "bells", 12, TIDES_LENS_NONE);
}
static void test_callbacks(void **state) {
    (void)state;
    check_kind(CALLBACK, "callback", 6, TIDES_LENS_NONE);
}
static void test_near_plane(void **state) {
    (void)state;
    check_kind(NEAR, "around the camera", 24, TIDES_LENS_NONE);
}

/* Bounds hold through lenses too. */
static void test_lenses(void **state) {
    (void)state;
    for (int lens = TIDES_LENS_RADTAN; lens <= TIDES_LENS_EQUIDISTANT; lens++) {
        check_kind(CAMERA, lens == TIDES_LENS_RADTAN ? "radtan, camera" : "equidistant, camera", 6, lens);
        check_kind(OBJECT, lens == TIDES_LENS_RADTAN ? "radtan, object" : "equidistant, object", 6, lens);
        check_kind(FRAMES, lens == TIDES_LENS_RADTAN ? "radtan, frames" : "equidistant, frames", 3, lens);
        check_kind(NEAR, lens == TIDES_LENS_RADTAN ? "radtan, around" : "equidistant, around", 12, lens);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shaken_camera),
                                       cmocka_unit_test(test_shaken_object),
                                       cmocka_unit_test(test_shaken_gaussians),
                                       cmocka_unit_test(test_narrow_bells),
                                       cmocka_unit_test(test_callbacks),
                                       cmocka_unit_test(test_near_plane),
                                       cmocka_unit_test(test_lenses)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
