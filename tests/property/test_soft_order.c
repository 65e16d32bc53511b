/* Soft depth order (kernels/soft_order.h, docs/soft_order.md) in the double reference. Densities behind the splats take light
 * out,
 *   Y = sum_k w_k l_k + T B,   w_k = integral of a_k f(s - s_k) T(s) ds,   T(s) = prod_j (1 - tau_j)^F(s - s_j),
 * s = ln z / delta, f(s) = exp(-s) and F(s) = 1 - exp(-s) from 0 on. Here these are computed by quadrature, with each tau from
 * the splat alone. The weights add up to 1 - T for any number of splats. The image has a continuous slope while splats swap
 * places, with exact rates, and it is that of hard order where splats are apart. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "kernels/soft_order.h"
#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 27182;

enum { WIDTH = 24, HEIGHT = 20, PIXELS = WIDTH * HEIGHT, MOST_SPLATS = 5000, MOST_FORMULA = 21 };
static const double DELTA = 4e-4, DEPTH = 4, BACKDROP = 0.15;
static const double SH_CONSTANT = 0.28209479177387814;

/* A round splat that moves along the line of sight. */
typedef struct splat {
    double x, y, z, z_dot, sigma, opacity, grey;
} splat;

enum { HARD, SOFT };

/* -- rendering ----------------------------------------------------------------------------------------------------- */

static tides_trajectory *path_of(const splat *s) {
    tides_pose_sample samples[3] = {{0}};
    tides_trajectory *path = NULL;
    tides_error error;
    for (int i = 0; i < 3; i++) { /* splines reproduce straight lines */
        samples[i].time = 0.5 * i;
        samples[i].position[0] = s->x;
        samples[i].position[1] = s->y;
        samples[i].position[2] = s->z + s->z_dot * samples[i].time;
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, 3, &path, &error), &error);
    return path;
}

static int moves(const splat *splats, int count) {
    for (int i = 0; i < count; i++)
        if (splats[i].z_dot != 0) return 1;
    return 0;
}

static void add_splat(tides_scene *scene, const splat *s) {
    const float mean[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0}, log_sigma = (float)log(s->sigma);
    const float log_scale[3] = {log_sigma, log_sigma, log_sigma}, grey = (float)s->grey;
    const float logit = (float)log(s->opacity / (1 - s->opacity)), sh[3] = {grey, grey, grey};
    tides_gaussians gaussian =
        {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = &logit, .sh = sh};
    tides_trajectory *path = path_of(s);
    tides_error error;
    scene_expect_ok(tides_scene_add(scene, &gaussian, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
}

/* All in one object, at rest. */
static void add_still(tides_scene *scene, const splat *splats, int count) {
    static float mean[3 * MOST_SPLATS], log_scale[3 * MOST_SPLATS], quaternion[4 * MOST_SPLATS], logit[MOST_SPLATS],
        sh[3 * MOST_SPLATS];
    tides_error error;
    for (int i = 0; i < count; i++) {
        const splat *s = &splats[i];
        const double at[3] = {s->x, s->y, s->z};
        for (int k = 0; k < 3; k++) {
            mean[3 * i + k] = (float)at[k];
            log_scale[3 * i + k] = (float)log(s->sigma);
            sh[3 * i + k] = (float)s->grey;
        }
        quaternion[4 * i] = 1;
        logit[i] = (float)log(s->opacity / (1 - s->opacity));
    }
    tides_gaussians gaussians =
        {.count = count, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    scene_expect_ok(tides_scene_add(scene, &gaussians, NULL, 1, NULL, NULL, &error), &error);
}

/* Each splat an object of its own, where they move. */
static tides_scene *scene_of(const splat *splats, int count) {
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    if (!moves(splats, count)) add_still(scene, splats, count);
    for (int i = 0; i < count && moves(splats, count); i++) add_splat(scene, &splats[i]);
    return scene;
}

/* smooth without its bound on termination: nothing but depth order is left to jump. */
static td_image image_of(int objects, int order) {
    tides_intrinsics camera = {WIDTH, HEIGHT, 30, 30, 12.2, 9.7, {0}};
    tides_image_params params;
    td_image image;
    tides_error error;
    tides_image_params_defaults(&params);
    scene_expect_ok(td_image_resolve(&params, &camera, 0, &image, &error), &error);
    assert_true(image.soft_order == 1); /* smooth has it by default */
    image.stop = 0;
    image.soft_order = order == SOFT;
    image.soft_depth = DELTA;
    image.objects = objects;
    return image;
}

static double *render(const splat *splats, int count, double time, int order) {
    static const double position[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0};
    tides_scene *scene = scene_of(splats, count);
    tides_trajectory *camera = NULL;
    td_store store;
    int objects = moves(splats, count) ? count : 1;
    td_image image = image_of(objects, order);
    td_image_numbers numbers = td_image_pack(&image);
    td_view *views = calloc((size_t)objects, sizeof *views);
    td_backdrop backdrop = {{BACKDROP, BACKDROP, BACKDROP}, BACKDROP, {0}, 0};
    td_backend *backend = NULL;
    tides_error error;
    assert_non_null(views);
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &camera, &error), &error);
    scene_expect_ok(td_store_create(scene, NULL, 1, 0, &store, &error), &error);
    scene_expect_ok(td_views_at(scene, camera, 0, time, views, &error), &error);
    scene_expect_ok(td_backend_create_f64(&store, &numbers, &backend, &error), &error);
    frame_input input = {&store, &numbers, (const double *)views, (const double *)&backdrop, WIDTH, HEIGHT, TD_OUT_COLOUR};
    double *frame = frame_render(backend, &input, FRAME_ALL);
    backend->type->destroy(backend);
    td_store_release(&store);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    free(views);
    return frame;
}

static const double *plane(const double *frame, int which) { return frame + (size_t)which * PIXELS; }

static double largest_difference(const double *a, const double *b, int which) {
    double most = 0;
    for (int i = 0; i < PIXELS; i++) {
        double d = fabs(plane(a, which)[i] - plane(b, which)[i]);
        if (!(d <= most)) most = d; /* NaN shows */
    }
    return most;
}

/* -- scenes -------------------------------------------------------------------------------------------------------- */

/* Splats that overlap, with depths within `spread` of DEPTH, relatively; some of them the very same. */
static void draw(splat *splats, int count, double spread, uint64_t *seed) {
    for (int i = 0; i < count; i++) {
        splat s = {scene_between(seed, -0.6, 0.6),
                   scene_between(seed, -0.5, 0.5),
                   (double)(float)(DEPTH * (1 + scene_between(seed, -spread, spread))),
                   0,
                   scene_between(seed, 0.2, 0.6),
                   scene_between(seed, 0.1, 0.95),
                   scene_between(seed, -1.5, 2)};
        if (i > 0 && i % 5 == 0) s.z = splats[i - 1].z;
        splats[i] = s;
    }
}

/* Splats that meet about 0.5 s, each through all others within the swap, which lasts some delta z / speed. */
static void draw_swap(splat *splats, int count, double speed, uint64_t *seed) {
    draw(splats, count, 0, seed);
    for (int i = 0; i < count; i++) {
        splats[i].x *= 0.3; /* so that they overlap where both are opaque */
        splats[i].y *= 0.3;
        splats[i].opacity = count <= 3 ? scene_between(seed, 0.6, 0.95) : scene_between(seed, 0.02, 0.2);
        splats[i].grey = i % 2 ? 2.0 : -1.2;
        splats[i].z_dot = i == 0 ? speed : i == 1 ? 0 : scene_between(seed, -0.7, 0.7) * speed;
        splats[i].z = DEPTH - 0.5 * splats[i].z_dot + (i < 2 ? 0 : scene_between(seed, -0.3, 0.3) * DELTA * DEPTH);
    }
}

/* -- the definition ------------------------------------------------------------------------------------------------ */

static double luminance_of(const splat *s) { return fmax(0.5 + SH_CONSTANT * (double)(float)s->grey, 0); }

static int by_depth(const void *a, const void *b) {
    double x = ((const splat *)a)->z, y = ((const splat *)b)->z;
    return x < y ? -1 : x > y;
}

/* T(s) and the light that comes in per s. */
static double light_at(const splat *splats, const double *tau, const double *place, int count, double s, double *t) {
    double path = 0, gain = 0;
    for (int k = 0; k < count && place[k] < s; k++) {
        double a = -log1p(-tau[k]), left = exp(place[k] - s);
        path += a * (1 - left);
        gain += a * left * luminance_of(&splats[k]);
    }
    *t = exp(-path);
    return gain * *t;
}

/* Y of one pixel by Gauss and Legendre, from each splat to the next in pieces, for splats in order; what is behind 45 of the
 * last one is below 1e-18. */
static double quadrature(const splat *splats, const double *tau, const double *place, int count) {
    static const double node[3] = {0.23861918608319691, 0.66120938646626451, 0.93246951420315203};
    static const double weight[3] = {0.46791393457269105, 0.36076157304813861, 0.17132449237917036};
    double y = 0, t = 1;
    for (int k = 0; k < count; k++) {
        double begin = place[k], end = k + 1 < count ? fmin(place[k + 1], begin + 45) : begin + 45;
        int pieces = (int)ceil((end - begin) / 0.05);
        for (int i = 0; i < pieces; i++)
            for (int n = 0; n < 6; n++) {
                double at = begin + (end - begin) / pieces * (i + 0.5 + 0.5 * (n % 2 ? node[n / 2] : -node[n / 2]));
                y += light_at(splats, tau, place, count, at, &t) * weight[n / 2] * 0.5 * (end - begin) / pieces;
            }
    }
    light_at(splats, tau, place, count, place[count - 1] + 45, &t);
    return y + t * BACKDROP;
}

static void expect_definition(splat *splats, int count) {
    enum { EVERY = 37 }; /* of the pixels */
    double *taus[MOST_FORMULA], *frame = render(splats, count, 0, SOFT), tau[MOST_FORMULA], place[MOST_FORMULA];
    qsort(splats, (size_t)count, sizeof *splats, by_depth);
    for (int k = 0; k < count; k++) {
        taus[k] = render(&splats[k], 1, 0, HARD);
        place[k] = log(splats[k].z / DEPTH) / DELTA;
    }
    for (int i = 0; i < PIXELS; i += EVERY) {
        double t = 1, y = plane(frame, TD_OUT_Y)[i], alpha = plane(frame, TD_OUT_ALPHA)[i];
        for (int k = 0; k < count; k++) t *= 1 - (tau[k] = plane(taus[k], TD_OUT_ALPHA)[i]);
        double want = quadrature(splats, tau, place, count);
        if (!(fabs(y - want) < 1e-12) || !(fabs(alpha - (1 - t)) < 1e-13))
            fail_msg("%d splats, pixel %d: Y %.17g, not %.17g; alpha %.17g, not %.17g", count, i, y, want, alpha, 1 - t);
    }
    for (int k = 0; k < count; k++) free(taus[k]);
    free(frame);
}

static void test_pair_definition(void **state) {
    (void)state;
    uint64_t seed = SEED;
    for (int step = -12; step <= 12; step += 2) {
        splat pair[2];
        draw(pair, 2, 0, &seed);
        pair[1].z = (double)(float)(DEPTH * (1 + 0.3 * step * DELTA));
        expect_definition(pair, 2);
    }
}

static void test_definition_of_many(void **state) {
    (void)state;
    uint64_t seed = SEED + 1;
    for (int count = 3; count <= MOST_FORMULA; count += 9) {
        splat splats[MOST_FORMULA];
        for (int spread = 1; spread <= 16; spread *= 4) { /* all near each other; some; hardly any */
            draw(splats, count, spread * DELTA, &seed);
            expect_definition(splats, count);
        }
    }
}

/* -- light --------------------------------------------------------------------------------------------------------- */

/* However many stand however near, their weights add up to 1 - T; and splats of one colour show that much of it. */
static void test_weights_sum_to_opacity(void **state) {
    static const int counts[] = {1, 2, 3, 8, 50, 500, 5000};
    static splat splats[MOST_SPLATS];
    (void)state;
    uint64_t seed = SEED + 2;
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
        for (int faint = 0; faint < 2; faint++) {
            draw(splats, counts[c], 2e-4, &seed);
            for (int i = 0; i < counts[c]; i++) {
                splats[i].grey = 1;
                if (faint) splats[i].opacity = scene_between(&seed, 0.005, 0.02);
            }
            double *frame = render(splats, counts[c], 0, SOFT), most = 0;
            for (int i = 0; i < PIXELS; i++) {
                double alpha = plane(frame, TD_OUT_ALPHA)[i], coverage = plane(frame, TD_OUT_COVERAGE)[i];
                double want = BACKDROP + alpha * (luminance_of(&splats[0]) - BACKDROP);
                if (!(fabs(coverage - alpha) < 1e-14) || !(fabs(plane(frame, TD_OUT_Y)[i] - want) < 2e-14))
                    fail_msg("%d splats: coverage - alpha %g, Y off by %g", counts[c], coverage - alpha,
                             plane(frame, TD_OUT_Y)[i] - want);
                most = fmax(most, alpha);
            }
            assert_true(most > 0.001);
            free(frame);
        }
}

/* White splats of opacity 0.9 at one depth, which a pixel looks through the middle of: what hard order shows. */
static void test_coincident_as_hard(void **state) {
    (void)state;
    splat splats[8];
    for (int count = 1; count <= 8; count++) {
        for (int i = 0; i < count; i++) splats[i] = (splat){0.04, 0.8 / 30 * DEPTH, DEPTH, 0, 0.5, 0.9, 0.5 / SH_CONSTANT};
        double *soft = render(splats, count, 0, SOFT), *hard = render(splats, count, 0, HARD);
        assert_true(largest_difference(soft, hard, TD_OUT_Y) < 1e-7); /* white to a float's digits */
        assert_true(largest_difference(soft, hard, TD_OUT_ALPHA) < 1e-14);
        double most = 0;
        for (int i = 0; i < PIXELS; i++) most = fmax(most, plane(soft, TD_OUT_ALPHA)[i]);
        assert_true(fabs(most - (1 - pow(0.1, count))) < 1e-6);
        free(soft);
        free(hard);
    }
}

/* -- continuity ---------------------------------------------------------------------------------------------------- */

/* Largest differences over `steps` + 1 times through a swap: of L and of L_dot (per length of the swap) between neighbours, and
 * of the slopes of L on both sides. */
typedef struct swap_changes {
    double value, rate, slope;
} swap_changes;

static swap_changes changes_of(const splat *splats, int count, double speed, int steps, int order) {
    double length = 8 * DELTA * DEPTH / speed, from = 0.5 - 0.5 * length + 0.0123 * length;
    swap_changes most = {0, 0, 0};
    double *frames[3] = {NULL, NULL, NULL};
    for (int i = 0; i <= steps; i++) {
        free(frames[0]);
        frames[0] = frames[1];
        frames[1] = frames[2];
        frames[2] = render(splats, count, from + length * i / steps, order);
        if (!frames[0]) continue;
        most.value = fmax(most.value, largest_difference(frames[1], frames[2], TD_OUT_L));
        most.rate = fmax(most.rate, length * largest_difference(frames[1], frames[2], TD_OUT_L_DOT));
        for (int p = 0; p < PIXELS; p++) {
            const double bend =
                plane(frames[2], TD_OUT_L)[p] - 2 * plane(frames[1], TD_OUT_L)[p] + plane(frames[0], TD_OUT_L)[p];
            most.slope = fmax(most.slope, fabs(bend) * steps);
        }
    }
    for (int i = 0; i < 3; i++) free(frames[i]);
    return most;
}

/* Values, slopes and rates change by half as much in half the time. */
static void test_swaps_are_smooth(void **state) {
    static const int counts[] = {2, 3, 50};
    const double speed = 0.1;
    (void)state;
    uint64_t seed = SEED + 3;
    for (int c = 0; c < 3; c++) {
        splat splats[50];
        int count = counts[c], steps = count == 50 ? 100 : 200;
        draw_swap(splats, count, speed, &seed);
        swap_changes coarse = changes_of(splats, count, speed, steps, SOFT);
        swap_changes fine = changes_of(splats, count, speed, 4 * steps, SOFT);
        swap_changes hard = changes_of(splats, count, speed, steps, HARD);
        if (!(fine.value < 0.3 * coarse.value && fine.rate < 0.3 * coarse.rate && fine.slope < 0.3 * coarse.slope) ||
            !(hard.value > 5 * coarse.value))
            fail_msg("%d splats: value %g then %g, rate %g then %g, slope %g then %g; hard %g", count, coarse.value, fine.value,
                     coarse.rate, fine.rate, coarse.slope, fine.slope, hard.value);
    }
}

static void test_rates_through_swaps(void **state) {
    static const int pairs[][2] = {{TD_OUT_L, TD_OUT_L_DOT},
                                   {TD_OUT_ALPHA, TD_OUT_ALPHA_DOT},
                                   {TD_OUT_R, TD_OUT_R_DOT},
                                   {TD_OUT_Z, TD_OUT_Z_DOT}};
    const double speed = 1, h = 1e-6, swap = DELTA * DEPTH / speed;
    (void)state;
    uint64_t seed = SEED + 4;
    for (int trial = 0; trial < 21; trial++) {
        splat splats[30];
        int count = trial < 14 ? 2 + trial % 2 : 30;
        draw_swap(splats, count, speed, &seed);
        double at = 0.5 + swap * (trial % 14 / 7.0 - 0.93), *frames[5]; /* not where the first two meet: rates bend there */
        for (int k = 0; k < 5; k++) frames[k] = render(splats, count, at + 0.5 * h * (k - 2), SOFT);
        for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++) {
            double largest = 1, worst = 0;
            for (int i = 0; i < PIXELS; i++) {
                double f[5], rate = plane(frames[2], pairs[p][1])[i];
                if (pairs[p][0] == TD_OUT_Z && plane(frames[2], TD_OUT_ALPHA)[i] < 0.01) continue; /* depth of nothing */
                for (int k = 0; k < 5; k++) f[k] = plane(frames[k], pairs[p][0])[i];
                largest = fmax(largest, fabs(rate));
                worst = fmax(worst, fabs(rate - (8 * (f[3] - f[1]) - (f[4] - f[0])) / (6 * h)));
            }
            if (!(worst < 1e-6 * largest)) fail_msg("trial %d, plane %d: off by %g of %g", trial, pairs[p][0], worst, largest);
            if (pairs[p][0] == TD_OUT_L && trial == 7) assert_true(largest > 20); /* near the middle of the swap */
        }
        for (int k = 0; k < 5; k++) free(frames[k]);
    }
}

/* -- the rest ------------------------------------------------------------------------------------------------------ */

static void test_apart_is_hard_order(void **state) {
    (void)state;
    uint64_t seed = SEED + 5;
    for (int trial = 0; trial < 10; trial++) {
        splat splats[20];
        draw(splats, 20, 0, &seed);
        for (int i = 0; i < 20; i++) splats[i].z = (double)(float)(DEPTH * exp(1.02 * TD_SOFT_REACH * DELTA * (i * 7 % 20)));
        double *hard = render(splats, 20, 0, HARD), *soft = render(splats, 20, 0, SOFT);
        for (int which = 0; which < TD_OUT_COLOUR; which++) assert_true(largest_difference(hard, soft, which) == 0);
        free(hard);
        free(soft);
        for (int i = 0; i < 20; i++) splats[i].z = (double)(float)(DEPTH * exp(0.98 * TD_SOFT_REACH * DELTA * (i * 7 % 20)));
        hard = render(splats, 20, 0, HARD), soft = render(splats, 20, 0, SOFT);
        for (int which = 0; which < TD_OUT_Z; which++) /* nearly, where the soft way begins */
            assert_true(largest_difference(hard, soft, which) < 1e-12);
        free(hard);
        free(soft);
        for (int i = 0; i < 20; i++) splats[i].z = (double)(float)(DEPTH * (1 + 0.5 * DELTA * (i * 7 % 20)));
        hard = render(splats, 20, 0, HARD), soft = render(splats, 20, 0, SOFT);
        assert_true(largest_difference(hard, soft, TD_OUT_L) > 1e-4); /* nearer than delta it isn't */
        free(hard);
        free(soft);
    }
}

static void test_numbering_changes_nothing(void **state) {
    (void)state;
    uint64_t seed = SEED + 6;
    for (int trial = 0; trial < 10; trial++) {
        enum { COUNT = 30 };
        splat splats[COUNT];
        draw(splats, COUNT, (1 + trial) * 0.4 * DELTA, &seed);
        double *first = render(splats, COUNT, 0, SOFT);
        for (int i = COUNT - 1; i > 0; i--) {
            int k = (int)(scene_next(&seed) % (uint64_t)(i + 1));
            splat taken = splats[i];
            splats[i] = splats[k];
            splats[k] = taken;
        }
        double *second = render(splats, COUNT, 0, SOFT);
        assert_true(largest_difference(first, second, TD_OUT_Y) < 1e-13);
        assert_true(largest_difference(first, second, TD_OUT_ALPHA) < 1e-13);
        free(first);
        free(second);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pair_definition),
                                       cmocka_unit_test(test_definition_of_many),
                                       cmocka_unit_test(test_weights_sum_to_opacity),
                                       cmocka_unit_test(test_coincident_as_hard),
                                       cmocka_unit_test(test_swaps_are_smooth),
                                       cmocka_unit_test(test_rates_through_swaps),
                                       cmocka_unit_test(test_apart_is_hard_order),
                                       cmocka_unit_test(test_numbering_changes_nothing)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
