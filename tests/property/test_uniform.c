/* Light is conserved however many splats share a depth (issue 12, A). The weights sum to 1 - T, where T is the product of the
 * transmittances of the single splats. A scene of one colour has it everywhere, and gives no event under any motion. Where
 * splats pass through one another, L keeps its value and its slope. The test is by mathematics alone, and doesn't use how
 * splats are mixed. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/judged_run.h"
#include "tests/support/opencl.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const uint64_t SEED = 19;
static const char *const devices[] = {"reference", "reference-f32", "cpu"};
enum { DEVICES = 3, WIDTH = 20, HEIGHT = 14, PIXELS = WIDTH * HEIGHT };

#define GREY 0.4
#define NEAR 2e-4 /* relative spread of depths: about what a soft order mixes */
/* Of weights in single precision, and in double. */
static double rounding(int device) { return device == 0 ? 1e-11 : 1e-6; }
/* What may be behind the place where compositing stops: smoothing.stop_change of L. */
#define STOPPED 2e-5

/* -- images ---------------------------------------------------------------------------------------------------------------- */

enum { Y, ALPHA, COVERAGE, L, L_DOT, ALPHA_DOT, PLANES };
typedef struct image {
    double plane[PLANES][PIXELS];
} image;

typedef struct viewer {
    tides_device *device;
    tides_renderer *renderer;
    const judged *j;
} viewer;

/* 0 where there's no such device. */
static int viewer_open(viewer *v, const judged *j, const char *spec) {
    tides_error error;
    *v = (viewer){.j = j};
    const tides_status status = tides_device_open(spec, &v->device, &error);
    if (status == TIDES_NO_DEVICE) return 0;
    scene_expect_ok(status, &error);
    scene_expect_ok(tides_renderer_create(v->device, j->scene, &j->intrinsics, &j->image, NULL, NULL, &v->renderer, &error),
                    &error);
    return 1;
}

static void viewer_close(viewer *v) {
    tides_renderer_destroy(v->renderer);
    tides_device_close(v->device);
}

static void look(const viewer *v, double time, image *to) {
    tides_error error;
    const tides_frame frame = {.plane = {[TIDES_Y] = to->plane[Y],
                                         [TIDES_ALPHA] = to->plane[ALPHA],
                                         [TIDES_COVERAGE] = to->plane[COVERAGE],
                                         [TIDES_L] = to->plane[L],
                                         [TIDES_L_DOT] = to->plane[L_DOT],
                                         [TIDES_ALPHA_DOT] = to->plane[ALPHA_DOT]}};
    scene_expect_ok(tides_renderer_frame(v->renderer, v->j->camera, time, &frame, &error), &error);
}

static judged small(double backdrop) {
    judged j = judged_make("", WIDTH, HEIGHT, 0.05);
    for (int k = 0; k < 3; k++) j.image.background[k] = backdrop;
    return j;
}

/* -- one depth ------------------------------------------------------------------------------------------------------------- */

/* White splats of one opacity on one spot, much larger than the view. */
static void test_coincident(void **state) {
    static const int counts[] = {1, 2, 3, 4, 5, 8, 31, 32, 33, 64, 1000, 5000};
    static image seen;
    (void)state;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        const int n = counts[i];
        const double opacity = n <= 8 ? 0.9 : n <= 64 ? 0.2 : 0.006, through = pow(1 - opacity, n);
        judged j = small(0);
        splat_set set = {0};
        for (int k = 0; k < n; k++) splat_set_ball(&set, 0, 0, 2, 1000, opacity, 1);
        world_add(j.scene, &set, NULL);
        for (int d = 0; d < DEVICES; d++) {
            viewer v;
            if (!viewer_open(&v, &j, devices[d])) continue;
            look(&v, 0, &seen);
            for (int p = 0; p < PIXELS; p++) {
                const double y = seen.plane[Y][p], alpha = seen.plane[ALPHA][p], coverage = seen.plane[COVERAGE][p];
                if (!(fabs(y - (1 - through)) < STOPPED) || !(fabs(alpha - (1 - through)) < STOPPED) ||
                    !(fabs(coverage - alpha) <= rounding(d)))
                    fail_msg("%s, %d splats of %g: Y %.9g, A %.9g, coverage %.9g for %.9g", devices[d], n, opacity, y, alpha,
                             coverage, 1 - through);
            }
            viewer_close(&v);
        }
        judged_free(&j);
    }
    skip_without_opencl();
}

/* Splats of all sizes on a tilted plane, of one grey, all within NEAR of it, or of their neighbours' depths. */
static splat_set sheet(uint64_t *seed, int count, double tilt, double sigma_px) {
    const double px = 2 / (1.25 * WIDTH);
    splat_set set = {0};
    for (int i = 0; i < count; i++) {
        const double x = scene_between(seed, -1, 1) * 0.75 * WIDTH * px, y = scene_between(seed, -1, 1) * 0.75 * HEIGHT * px;
        const double s = sigma_px * px * world_between_log(seed, 0.5, 2), angle = scene_between(seed, 0, WORLD_PI);
        const splat one = {{x, y, (2 + tilt * x) * (1 + NEAR * scene_between(seed, -1, 1))},
                           {s, 0.5 * s, 0.01 * s},
                           {cos(0.5 * angle), 0, 0, sin(0.5 * angle)},
                           scene_between(seed, 0.01, 0.97),
                           {GREY, GREY, GREY}};
        splat_set_add(&set, &one);
    }
    return set;
}

/* Y is grey where there is anything, the backdrop behind it, and the weights sum to 1 - T; so do their rates. */
static void check_sheet(const viewer *v, int device, int count, double backdrop, const image *seen) {
    const double *const *planes = (const double *const[]){seen->plane[Y], seen->plane[ALPHA], seen->plane[COVERAGE],
                                                          seen->plane[L_DOT], seen->plane[ALPHA_DOT]};
    const double grey = world_colour(world_sh(GREY));
    for (int p = 0; p < PIXELS; p++) {
        const double y = planes[0][p], alpha = planes[1][p], coverage = planes[2][p];
        const double expected = grey * alpha + backdrop * (1 - alpha);
        if (!(fabs(y - expected) <= rounding(device)) || !(fabs(coverage - alpha) <= rounding(device)))
            fail_msg("%s, %d splats, pixel %d: Y %.9g for %.9g, coverage %.9g, A %.9g", devices[device], count, p, y, expected,
                     coverage, alpha);
        const double y_dot = planes[3][p] * (y + v->j->image.log_eps), expected_dot = (grey - backdrop) * planes[4][p];
        if (device == 0 && !(fabs(y_dot - expected_dot) <= 1e-9 * (1 + fabs(planes[4][p]))))
            fail_msg("%d splats, pixel %d: Y_dot %.9g for %.9g", count, p, y_dot, expected_dot);
    }
}

static void test_sheets(void **state) {
    static const int counts[] = {1, 2, 3, 5, 17, 50, 280, 1400, 5000};
    static image seen;
    (void)state;
    for (size_t i = 0; i < 2 * sizeof counts / sizeof *counts; i++) {
        const int count = counts[i / 2];
        const double backdrop = i % 2 ? 0.15 : 0, tilt = i % 4 < 2 ? 0 : 0.4;
        uint64_t seed = SEED + i;
        judged j = small(backdrop);
        const shaking s = {.velocity = {0.3, 0, 0.2}, .spin = {0, 0.6, 0}};
        splat_set set = sheet(&seed, count, tilt, count < 100 ? 4 : 1);
        world_add(j.scene, &set, NULL);
        judged_camera(&j, shaking_path(&s, 0, j.stop, j.stop, 1));
        for (int d = 0; d < DEVICES; d++) {
            viewer v;
            if (!viewer_open(&v, &j, devices[d])) continue;
            look(&v, 0.5 * j.stop, &seen);
            check_sheet(&v, d, count, backdrop, &seen);
            viewer_close(&v);
        }
        judged_free(&j);
    }
    skip_without_opencl();
}

/* What a stack lets through is the product of what its splats let through one by one. */
static void test_transmittance_is_the_product(void **state) {
    static const int counts[] = {2, 3, 7, 20};
    static image seen, one;
    (void)state;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        static double through[PIXELS];
        uint64_t seed = SEED + 100 + i;
        splat_set set = sheet(&seed, counts[i], 0.2, 5);
        for (int p = 0; p < PIXELS; p++) through[p] = 1;
        for (int k = -1; k < counts[i]; k++) {
            judged j = small(0);
            tides_gaussians g = splat_set_view(&set);
            viewer v;
            tides_error error;
            if (k >= 0)
                g = (tides_gaussians){.count = 1,
                                      .mean = g.mean + 3 * k,
                                      .log_scale = g.log_scale + 3 * k,
                                      .quaternion = g.quaternion + 4 * k,
                                      .opacity_logit = g.opacity_logit + k,
                                      .sh = g.sh + 3 * k};
            scene_expect_ok(tides_scene_add(j.scene, &g, NULL, 1, NULL, NULL, &error), &error);
            assert_true(viewer_open(&v, &j, "reference"));
            look(&v, 0, k < 0 ? &seen : &one);
            for (int p = 0; p < PIXELS && k >= 0; p++) through[p] *= 1 - one.plane[ALPHA][p];
            viewer_close(&v);
            judged_free(&j);
        }
        for (int p = 0; p < PIXELS; p++)
            if (!(fabs(seen.plane[ALPHA][p] - (1 - through[p])) < STOPPED))
                fail_msg("%d splats, pixel %d: A %.9g for %.9g", counts[i], p, seen.plane[ALPHA][p], 1 - through[p]);
        splat_set_free(&set);
    }
}

/* Splats far apart in depth are composited as in hard order. */
static void test_far_apart_is_hard_order(void **state) {
    static image soft, hard;
    (void)state;
    uint64_t seed = SEED + 200;
    judged j = small(0.1);
    splat_set set = {0};
    splat_set_texture(&set, &seed, 60, 3, 1, 0.8, 0.2);
    for (int i = 0; i < set.count; i++) set.mean[3 * i + 2] = (float)(3 * (1 - 0.01 * i)); /* a hundred soft_depth apart */
    world_add(j.scene, &set, NULL);
    j.image.smoothing.stop_change = 1e-14; /* where compositing stops is another matter */
    for (int k = 0; k < 2; k++) {
        viewer v;
        if (k) j.image.smoothing.soft_depth = 0;
        assert_true(viewer_open(&v, &j, "reference"));
        look(&v, 0, k ? &hard : &soft);
        viewer_close(&v);
    }
    for (int p = 0; p < PIXELS; p++)
        if (!(fabs(soft.plane[Y][p] - hard.plane[Y][p]) < 1e-12))
            fail_msg("pixel %d: Y %.15g, in hard order %.15g", p, soft.plane[Y][p], hard.plane[Y][p]);
    judged_free(&j);
}

/* -- nothing to fire ------------------------------------------------------------------------------------------------------- */

typedef struct walk {
    const char *name;
    shaking path;
} walk;

/* The yaw of 0.03 rad in 50 ms, and others. */
static const walk walks[] = {{"yaw", {.spin = {0, 0.6, 0}}},
                             {"dolly", {.velocity = {0, 0, 2}}},
                             {"roll", {.spin = {0, 0, 3}}},
                             {"truck", {.velocity = {1, 0.5, 0}, .spin = {0, 0.3, 0}}},
                             {"shake", {.turn = {{0}, {1, {0.02}, {100}, {0.3}}}}}};
enum { WALKS = sizeof walks / sizeof *walks };

/* Splats per pixel of a wall as wide as 1.5 views; from `covered` on nothing is seen through it, and its backdrop is black. */
static void test_no_events(void **state) {
    static const double densities[] = {1, 4, 15, 50};
    static const double covered = 15;
    (void)state;
    int failures = 0;
    for (int i = 0; i < 4 * WALKS; i++) {
        const double density = densities[i / WALKS];
        const walk *w = &walks[i % WALKS];
        const int count = (int)(density * 2.25 * PIXELS), dark = density >= covered;
        uint64_t seed = SEED + 300 + (uint64_t)i;
        judged j = small(dark ? 0 : world_colour(world_sh(GREY)));
        splat_set set = sheet(&seed, count, i % 2 ? 0.3 : 0, 1.5);
        world_add(j.scene, &set, NULL);
        judged_camera(&j, shaking_path(&w->path, 0, j.stop, 1e-3, 1));
        j.sensor.threshold_on = j.sensor.threshold_off = 0.02;
        for (int d = density < covered ? 0 : 1; d < DEVICES; d++) {
            judged_stream events = {0};
            tides_stats stats;
            if (d == 1 && density >= covered) continue; /* the kernels are quicker at that */
            if (!judged_simulate(&j, devices[d], &events, &stats)) continue;
            if (events.count > 0) {
                print_message("%s, %g splats per pixel, %s: %zu events\n", w->name, density, devices[d], events.count);
                failures++;
            }
            free(events.events);
        }
        judged_free(&j);
    }
    assert_int_equal(failures, 0);
    skip_without_opencl();
}

/* -- order swaps ----------------------------------------------------------------------------------------------------------- */

/* Splats of different colours that pass through one another's depths within the second 0 to 1, each at its own speed. */
static judged swapping(int count, uint64_t seed) {
    judged j = small(0.1);
    splat_set set = {0};
    tides_motion *motion = NULL;
    tides_error error;
    const size_t n = (size_t)count;
    float *zeros = calloc(4 * n, sizeof *zeros), *centre = calloc(n, sizeof *centre), *width = calloc(n, sizeof *width),
          *mean = calloc(9 * n, sizeof *mean);
    assert_true(zeros && centre && width && mean);
    for (int i = 0; i < count; i++) {
        const double grey = scene_between(&seed, 0.05, 1), speed = scene_between(&seed, -1, 1);
        splat_set_ball(&set, scene_between(&seed, -0.4, 0.4), scene_between(&seed, -0.3, 0.3), 2, 0.5,
                       scene_between(&seed, 0.1, 0.97), grey);
        centre[i] = (float)scene_between(&seed, 0.4, 0.6);
        width[i] = 20; /* the bell of opacity is as good as flat */
        mean[9 * i + 2] = (float)(2 * 2e-3 * speed);
    }
    const tides_polynomial_motion arrays = {count, 0, 1, centre, width, mean, zeros, .plain_colour = 0};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    world_add_moving(j.scene, &set, motion, 1);
    j.stop = 1;
    free(zeros);
    free(centre);
    free(width);
    free(mean);
    return j;
}

/* The largest change of L_dot between neighbours on a grid, and by how much L departs from its slopes' trapezium. */
typedef struct roughness {
    double slope, value;
} roughness;

static roughness roughness_of(const viewer *v, double from, double to, int intervals) {
    static image frames[2];
    const double h = (to - from) / intervals;
    roughness r = {0, 0};
    for (int k = 0; k <= intervals; k++) {
        const image *last = &frames[(k + 1) % 2], *now = &frames[k % 2];
        look(v, from + h * k, &frames[k % 2]);
        for (int p = 0; p < PIXELS && k > 0; p++) {
            const double d0 = last->plane[L_DOT][p], d1 = now->plane[L_DOT][p];
            r.slope = fmax(r.slope, fabs(d1 - d0));
            r.value = fmax(r.value, fabs(now->plane[L][p] - last->plane[L][p] - 0.5 * h * (d0 + d1)));
        }
    }
    return r;
}

/* A slope that jumped would jump by as much on a grid eight times finer; a continuous one jumps by an eighth where it is
 * Lipschitz. Values: of an integral of the slope, and nothing else. */
static void test_swaps_keep_value_and_slope(void **state) {
    static const int counts[] = {2, 3, 50};
    (void)state;
    int failures = 0;
    for (int i = 0; i < 6; i++) {
        const int count = counts[i / 2];
        judged j = swapping(count, SEED + 400 + (uint64_t)i);
        viewer v;
        assert_true(viewer_open(&v, &j, "reference"));
        const int intervals = 100;
        const roughness coarse = roughness_of(&v, 0.3, 0.7, intervals), fine = roughness_of(&v, 0.3, 0.7, 8 * intervals);
        const double h = 0.4 / intervals / 8;
        const int smooth = fine.slope < 0.3 * coarse.slope && fine.value <= h * fine.slope + 1e-13;
        print_message("%d splats: L_dot changes by %.4g between neighbours, by %.4g on a grid 8 times finer; L off by %.3g%s\n",
                      count, coarse.slope, fine.slope, fine.value, smooth ? "" : ": NOT C1");
        assert_true(coarse.slope > 0);
        failures += !smooth;
        viewer_close(&v);
        judged_free(&j);
    }
    assert_int_equal(failures, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_coincident),
                                       cmocka_unit_test(test_sheets),
                                       cmocka_unit_test(test_transmittance_is_the_product),
                                       cmocka_unit_test(test_far_apart_is_hard_order),
                                       cmocka_unit_test(test_no_events),
                                       cmocka_unit_test(test_swaps_keep_value_and_slope)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
