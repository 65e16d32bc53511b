/* Soft depth order (kernels/soft_order.h) in the double reference: the image is continuous in time while splats swap places in
 * depth, with exact rates; it is the closed form
 *   Y = sum_k w_k l_k + T B,   w_k = tau_k prod_{j != k} (1 - tau_j f_kj),
 *   f_kj = smootherstep(1/2 + (z_k - z_j) / (2 delta z)),
 * with z the farther depth; and it is hard order where splats are apart. Each tau is what the splat shows alone. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_render.h"

#include "kernels/soft_order.h"
#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 27182;

enum { WIDTH = 24, HEIGHT = 20, PIXELS = WIDTH * HEIGHT, MOST_SPLATS = 60 };
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

/* Each splat an object of its own. */
static tides_scene *scene_of(const splat *splats, int count) {
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    for (int i = 0; i < count; i++) {
        const float mean[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0}, log_sigma = (float)log(splats[i].sigma);
        const float log_scale[3] = {log_sigma, log_sigma, log_sigma}, grey = (float)splats[i].grey;
        const float logit = (float)log(splats[i].opacity / (1 - splats[i].opacity)), sh[3] = {grey, grey, grey};
        tides_gaussians gaussian = {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .sh = sh};
        gaussian.opacity_logit = &logit;
        tides_trajectory *path = path_of(&splats[i]);
        scene_expect_ok(tides_scene_add(scene, &gaussian, path, 1, NULL, NULL, &error), &error);
        tides_trajectory_destroy(path);
    }
    return scene;
}

/* smooth without its bound on termination: nothing but depth order is left to jump. */
static td_image image_of(int count, int order) {
    tides_intrinsics camera = {WIDTH, HEIGHT, 30, 30, 12.2, 9.7};
    tides_image_params params;
    td_image image;
    tides_error error;
    tides_image_params_defaults(&params);
    scene_expect_ok(td_image_resolve(&params, &camera, 0, &image, &error), &error);
    assert_true(image.soft_order == 1); /* smooth has it by default */
    image.stop = 0;
    image.soft_order = order == SOFT;
    image.soft_depth = DELTA;
    image.objects = count;
    return image;
}

static double *render(const splat *splats, int count, double time, int order) {
    static const double position[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0};
    tides_scene *scene = scene_of(splats, count);
    tides_trajectory *camera = NULL;
    td_store store;
    td_image image = image_of(count, order);
    td_image_numbers numbers = td_image_pack(&image);
    td_view *views = calloc((size_t)count, sizeof *views);
    td_backdrop backdrop = {{BACKDROP, BACKDROP, BACKDROP}, BACKDROP, {0}, 0};
    td_backend *backend = NULL;
    tides_error error;
    assert_non_null(views);
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &camera, &error), &error);
    scene_expect_ok(td_store_create(scene, 1, &store, &error), &error);
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

static double between(uint64_t *seed, double lower, double upper) {
    return lower + (upper - lower) * (double)(scene_next(seed) >> 11) * 0x1p-53;
}

/* Splats that overlap, with depths within `spread` of DEPTH, relatively; some of them the very same. */
static void draw(splat *splats, int count, double spread, uint64_t *seed) {
    for (int i = 0; i < count; i++) {
        splat s = {between(seed, -0.6, 0.6),
                   between(seed, -0.5, 0.5),
                   DEPTH * (1 + between(seed, -spread, spread)),
                   0,
                   between(seed, 0.2, 0.6),
                   between(seed, 0.1, 0.95),
                   between(seed, -1.5, 2)};
        if (i > 0 && i % 5 == 0) s.z = splats[i - 1].z;
        splats[i] = s;
    }
}

/* Two splats that meet at 0.5 s, or three, one after the other within the swap. The swap lasts 2 delta z / speed. */
static int draw_swap(splat *splats, int count, double speed, uint64_t *seed) {
    draw(splats, count, 0, seed);
    for (int i = 0; i < count; i++) {
        splats[i].x *= 0.3; /* so that they overlap where both are opaque */
        splats[i].y *= 0.3;
        splats[i].opacity = between(seed, 0.6, 0.95);
        splats[i].grey = i % 2 ? 2.0 : -1.2;
        splats[i].z_dot = i == 0 ? speed : i == 1 ? 0 : -0.7 * speed;
        splats[i].z = DEPTH - 0.5 * splats[i].z_dot + (i == 2 ? 0.3 * DELTA * DEPTH : 0);
    }
    return count;
}

/* -- the closed form ----------------------------------------------------------------------------------------------- */

static double in_front(double z, double of) {
    double x = 0.5 + (z - of) / (2 * DELTA * fmax(z, of));
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * x * (x * (6 * x - 15) + 10);
}

static double luminance_of(const splat *s) { return fmax(0.5 + SH_CONSTANT * (double)(float)s->grey, 0); }

/* The header's formula for Y and 1 - T, at time 0. */
static void closed_form(const splat *splats, int count, double *y, double *alpha) {
    double *taus[MOST_SPLATS];
    for (int k = 0; k < count; k++) taus[k] = render(&splats[k], 1, 0, HARD);
    for (int i = 0; i < PIXELS; i++) {
        double t = 1, sum = 0;
        for (int k = 0; k < count; k++) {
            double w = plane(taus[k], TD_OUT_ALPHA)[i];
            t *= 1 - w;
            for (int j = 0; j < count; j++)
                if (j != k) w *= 1 - plane(taus[j], TD_OUT_ALPHA)[i] * in_front(splats[k].z, splats[j].z);
            sum += w * luminance_of(&splats[k]);
        }
        y[i] = sum + t * BACKDROP;
        alpha[i] = 1 - t;
    }
    for (int k = 0; k < count; k++) free(taus[k]);
}

static void expect_closed_form(const splat *splats, int count) {
    double y[PIXELS], alpha[PIXELS], *frame = render(splats, count, 0, SOFT);
    closed_form(splats, count, y, alpha);
    for (int i = 0; i < PIXELS; i++) {
        double got_y = plane(frame, TD_OUT_Y)[i], got_alpha = plane(frame, TD_OUT_ALPHA)[i];
        if (!(fabs(got_y - y[i]) < 1e-13) || !(fabs(got_alpha - alpha[i]) < 1e-13))
            fail_msg("%d splats, pixel %d: Y %.17g, not %.17g; alpha %.17g, not %.17g", count, i, got_y, y[i], got_alpha,
                     alpha[i]);
    }
    free(frame);
}

static void test_pair_formula(void **state) {
    (void)state;
    uint64_t seed = SEED;
    for (int step = -12; step <= 12; step++) {
        splat pair[2];
        draw(pair, 2, 0, &seed);
        pair[1].z = DEPTH * (1 + 0.1 * step * DELTA); /* from beyond delta on one side to beyond on the other */
        expect_closed_form(pair, 2);
    }
}

static void test_formula_of_many(void **state) {
    (void)state;
    uint64_t seed = SEED + 1;
    for (int count = 3; count <= 31; count += 7) {
        splat splats[MOST_SPLATS];
        for (int spread = 1; spread <= 16; spread *= 4) { /* all near each other; some; hardly any */
            draw(splats, count, spread * DELTA, &seed);
            expect_closed_form(splats, count);
        }
    }
}

/* Two splats of one colour: however they stand, they show 1 - T of it. */
static void test_pair_weights_sum_to_opacity(void **state) {
    (void)state;
    uint64_t seed = SEED + 2;
    for (int step = -12; step <= 12; step++) {
        splat pair[2];
        draw(pair, 2, 0, &seed);
        pair[0].grey = pair[1].grey;
        pair[1].z = DEPTH * (1 + 0.1 * step * DELTA);
        double *frame = render(pair, 2, 0, SOFT);
        for (int i = 0; i < PIXELS; i++) {
            double want = BACKDROP + plane(frame, TD_OUT_ALPHA)[i] * (luminance_of(&pair[0]) - BACKDROP);
            assert_true(fabs(plane(frame, TD_OUT_Y)[i] - want) < 1e-13);
        }
        free(frame);
    }
}

/* -- continuity ---------------------------------------------------------------------------------------------------- */

/* The largest change of L between neighbours of `steps` + 1 times about the swap. */
static double largest_change(const splat *splats, int count, double speed, int steps, int order) {
    double from = 0.5 - 2 * DELTA * DEPTH / speed, length = 4 * DELTA * DEPTH / speed, most = 0;
    double *last = render(splats, count, from, order);
    for (int i = 1; i <= steps; i++) {
        double *next = render(splats, count, from + length * i / steps, order);
        most = fmax(most, largest_difference(last, next, TD_OUT_L));
        free(last);
        last = next;
    }
    free(last);
    return most;
}

static void test_swaps_are_continuous(void **state) {
    const double speed = 0.1;
    (void)state;
    uint64_t seed = SEED + 3;
    for (int count = 2; count <= 3; count++) {
        splat splats[3];
        draw_swap(splats, count, speed, &seed);
        double coarse = largest_change(splats, count, speed, 50, SOFT), fine = largest_change(splats, count, speed, 400, SOFT);
        double jump = largest_change(splats, count, speed, 50, HARD), same = largest_change(splats, count, speed, 400, HARD);
        if (!(fine < coarse / 6 && coarse < 0.5 * jump && jump > 0.1 && same > 0.9 * jump))
            fail_msg("%d splats: soft %g and %g, hard %g and %g", count, coarse, fine, jump, same);
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
    for (int trial = 0; trial < 14; trial++) {
        splat splats[3];
        int count = draw_swap(splats, 2 + trial % 2, speed, &seed);
        double at = 0.5 + swap * (trial / 7.0 - 0.93), *frames[5]; /* not where a swap begins or ends: rates bend there */
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
            if (pairs[p][0] == TD_OUT_L && trial == 7) assert_true(largest > 20); /* in the middle of the swap */
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
        for (int i = 0; i < 20; i++) splats[i].z = DEPTH * (1 + 1.02 * DELTA * (i * 7 % 20));
        double *hard = render(splats, 20, 0, HARD), *soft = render(splats, 20, 0, SOFT);
        for (int which = 0; which < TD_OUT_COLOUR; which++) assert_true(largest_difference(hard, soft, which) < 1e-12);
        free(hard);
        free(soft);
        for (int i = 0; i < 20; i++) splats[i].z = DEPTH * (1 + 0.5 * DELTA * (i * 7 % 20));
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

/* More splats at one depth than the window holds: hard order decides between some, all the rest is as it must be. */
static void test_more_than_the_window_holds(void **state) {
    (void)state;
    uint64_t seed = SEED + 7;
    for (int count = TD_WINDOW - 1; count <= MOST_SPLATS; count += 4) {
        splat splats[MOST_SPLATS];
        double y[PIXELS], alpha[PIXELS];
        draw(splats, count, 0, &seed);
        for (int i = 0; i < count; i++) splats[i].opacity *= 0.3;
        double *first = render(splats, count, 0, SOFT), *second = render(splats, count, 0, SOFT);
        closed_form(splats, count, y, alpha);
        assert_memory_equal(first, second, (size_t)TD_OUT_COLOUR * PIXELS * sizeof *first);
        for (int i = 0; i < TD_OUT_COLOUR * PIXELS; i++) assert_true(isfinite(first[i]));
        for (int i = 0; i < PIXELS; i++) assert_true(fabs(plane(first, TD_OUT_ALPHA)[i] - alpha[i]) < 1e-12);
        free(first);
        free(second);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pair_formula),
                                       cmocka_unit_test(test_formula_of_many),
                                       cmocka_unit_test(test_pair_weights_sum_to_opacity),
                                       cmocka_unit_test(test_swaps_are_continuous),
                                       cmocka_unit_test(test_rates_through_swaps),
                                       cmocka_unit_test(test_apart_is_hard_order),
                                       cmocka_unit_test(test_numbering_changes_nothing),
                                       cmocka_unit_test(test_more_than_the_window_holds)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
