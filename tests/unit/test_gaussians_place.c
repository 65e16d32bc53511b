/* Gaussians moved by affine maps: shapes, places, and colours, which must look the same from the moved viewpoint. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>

/* INRIA's basis, degree 3, written out. */
static void basis(const double d[3], double y[16]) {
    const double x = d[0], v = d[1], z = d[2];
    const double all[16] = {0.28209479177387814,
                            -0.4886025119029199 * v,
                            0.4886025119029199 * z,
                            -0.4886025119029199 * x,
                            1.0925484305920792 * x * v,
                            -1.0925484305920792 * v * z,
                            0.31539156525252005 * (2 * z * z - x * x - v * v),
                            -1.0925484305920792 * x * z,
                            0.5462742152960396 * (x * x - v * v),
                            -0.5900435899266435 * v * (3 * x * x - v * v),
                            2.890611442640554 * x * v * z,
                            -0.4570457994644658 * v * (4 * z * z - x * x - v * v),
                            0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * v * v),
                            -0.4570457994644658 * x * (4 * z * z - x * x - v * v),
                            1.445305721320277 * z * (x * x - v * v),
                            -0.5900435899266435 * x * (x * x - 3 * v * v)};
    memcpy(y, all, sizeof all);
}

static double colour(const float *sh, const double d[3]) {
    double y[16], sum = 0;
    basis(d, y);
    for (int k = 0; k < 16; k++) sum += y[k] * (double)sh[3 * k];
    return sum;
}

/* R S S R^T of a Gaussian. */
static void covariance(const td_gaussians *g, int i, double out[9]) {
    const float *q = g->quaternion + 4 * i;
    const double n = (double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2] + (double)q[3] * q[3];
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {w * w + x * x - y * y - z * z, 2 * (x * y - w * z),           2 * (x * z + w * y),
                         2 * (x * y + w * z),           w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
                         2 * (x * z - w * y),           2 * (y * z + w * x),           w * w - x * x - y * y + z * z};
    for (int a = 0; a < 9; a++) {
        out[a] = 0;
        for (int k = 0; k < 3; k++)
            out[a] += r[a / 3 * 3 + k] * r[a % 3 * 3 + k] / (n * n) * exp(2 * (double)g->log_scale[3 * i + k]);
    }
}

/* Any rotation, with factors that differ: ellipsoids become A C A^T, and a colour is seen from where it was. */
static void placed(void **state) {
    (void)state;
    const double turn[9] = {2 / 3.0, -1 / 3.0, 2 / 3.0, 2 / 3.0, 2 / 3.0, -1 / 3.0, -1 / 3.0, 2 / 3.0, 2 / 3.0};
    for (int even = 0; even < 2; even++) {
        const double size[3] = {2, even ? 2 : 0.5, even ? 2 : 3};
        td_gaussians g = scene_random(5, 20, 3, SCENE_TRAINED), old = scene_random(5, 20, 3, SCENE_TRAINED);
        double map[12], before[9], after[9];
        for (int k = 0; k < 12; k++) map[k] = k % 4 < 3 ? turn[k / 4 * 3 + k % 4] * size[k % 4] : k;
        tides_error error = {0, ""};
        scene_expect_ok(td_gaussians_place(&g, map, &error), &error);
        for (int i = 0; i < 20; i++) {
            covariance(&old, i, before);
            covariance(&g, i, after);
            double largest = 0;
            for (int a = 0; a < 9; a += 4) largest = fmax(largest, after[a]);
            for (int a = 0; a < 9; a++) {
                double wanted = 0;
                for (int j = 0; j < 9; j++) wanted += map[a / 3 * 4 + j / 3] * map[a % 3 * 4 + j % 3] * before[j];
                assert_true(fabs(after[a] - wanted) < 2e-6 * largest);
            }
            const double d[3] = {0.6, 0, -0.8},
                         u[3] = {turn[0] * 0.6 - turn[2] * 0.8, turn[3] * 0.6 - turn[5] * 0.8, turn[6] * 0.6 - turn[8] * 0.8};
            assert_true(fabs(colour(g.sh + 48 * i, u) - colour(old.sh + 48 * i, d)) < 1e-6);
            for (int k = 0; k < 3; k++) {
                double mean = map[4 * k + 3];
                for (int c = 0; c < 3; c++) mean += map[4 * k + c] * (double)old.mean[3 * i + c];
                assert_true(fabs(td_gaussians_mean(&g, i, k) - mean) < 1e-12 * (1 + fabs(mean)));
            }
        }
        td_gaussians_free(&g);
        td_gaussians_free(&old);
    }
}

/* Degree 4: two turns after each other are the one that they make, and three thirds of a turn are none. */
static void fourth_degree(void **state) {
    (void)state;
    const double third[12] = {0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0}, tilt[12] = {0.6, 0, 0.8, 0, 0, 1, 0, 0, -0.8, 0, 0.6, 0};
    td_gaussians g = scene_random(6, 10, 4, SCENE_TRAINED), once = scene_random(6, 10, 4, SCENE_TRAINED);
    double made[12] = {0};
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) made[4 * row + c] += tilt[4 * row + k] * third[4 * k + c];
    tides_error error = {0, ""};
    scene_expect_ok(td_gaussians_place(&g, third, &error), &error);
    scene_expect_ok(td_gaussians_place(&g, tilt, &error), &error);
    scene_expect_ok(td_gaussians_place(&once, made, &error), &error);
    for (size_t i = 0; i < 750; i++) assert_true(fabs((double)g.sh[i] - (double)once.sh[i]) < 1e-6);
    td_gaussians_free(&once);
    once = scene_random(6, 10, 4, SCENE_TRAINED);
    td_gaussians_free(&g);
    g = scene_random(6, 10, 4, SCENE_TRAINED);
    for (int k = 0; k < 3; k++) scene_expect_ok(td_gaussians_place(&g, third, &error), &error);
    for (size_t i = 0; i < 750; i++) assert_true(fabs((double)g.sh[i] - (double)once.sh[i]) < 1e-6);
    td_gaussians_free(&g);
    td_gaussians_free(&once);
}

/* A map that isn't one leaves nothing as it was, so that the scene refuses what came of it. */
static void not_a_map(void **state) {
    (void)state;
    const double map[12] = {1, 0, 0, 0, 0, 1, 0, (double)NAN, 0, 0, 1, 0};
    td_gaussians g = scene_random(6, 3, 0, SCENE_TRAINED);
    tides_error error = {0, ""};
    scene_expect_ok(td_gaussians_place(&g, map, &error), &error);
    for (int64_t i = 0; i < 3; i++) assert_true(isnan(td_gaussians_mean(&g, i, 1)));
    td_gaussians_free(&g);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(placed), cmocka_unit_test(fourth_degree), cmocka_unit_test(not_a_map)};
    return cmocka_run_group_tests_name("gaussians_place", tests, NULL, NULL);
}
