/* Splat files against independent decoders: each $TIDES_SHARED/golden/formats/NAME.npz has the first Gaussians of the file
 * below $TIDES_SHARED/data that it names as `source`, in INRIA's units, decoded in double precision. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/scene.h"

#include "tests/support/npz.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Both sides do the same arithmetic in double, and ours is rounded to float once: half a unit in the last place. */
#define ROUNDING 0x1p-24

/* The test normalises our quaternions: rounding of four components instead of one. */
#define QUATERNION_ROUNDING 0x1p-23

/* Opacities 0 and 1 have infinite logits there, finite ones of 2^-24 and 1 - 2^-24 here. */
#define EDGE_OF_OPACITY 16.6

static tides_scene *load(const char *path) {
    tides_error error = {0, ""};
    tides_scene *scene = NULL;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    return scene;
}

static tides_gaussians only_object(const tides_scene *scene) {
    tides_object object;
    assert_int_equal(tides_scene_objects(scene), 1);
    assert_int_equal(tides_scene_object(scene, 0, &object, NULL), TIDES_OK);
    return object.gaussians;
}

/* Rows of `width` values, ours `stride` apart. */
static void compare(npz *golden, const char *name, const float *ours, size_t width, size_t stride) {
    size_t count = 0;
    double *expected = npz_doubles(golden, name, &count);
    assert_true(expected);
    assert_true(count > 0);
    assert_true(count % width == 0);
    for (size_t i = 0; i < count; i++) {
        double got = (double)ours[i / width * stride + i % width];
        int same = isinf(expected[i]) ? got * (expected[i] > 0 ? 1 : -1) > EDGE_OF_OPACITY
                                      : fabs(got - expected[i]) <= ROUNDING * fabs(expected[i]) + 1e-15;
        if (!same) fail_msg("%s[%zu][%zu] is %.9g, expected %.17g", name, i / width, i % width, got, expected[i]);
    }
    free(expected);
}

static void compare_rotations(npz *golden, const float *ours) {
    size_t count = 0;
    double *expected = npz_doubles(golden, "quat_wxyz", &count);
    assert_true(expected);
    assert_true(count > 0);
    assert_true(count % 4 == 0);
    for (size_t i = 0; i < count; i++) {
        const float *q = ours + (i & ~(size_t)3);
        double length = sqrt((double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2] + (double)q[3] * q[3]);
        double got = (double)ours[i] / length;
        if (!(fabs(got - expected[i]) <= QUATERNION_ROUNDING))
            fail_msg("quat_wxyz[%zu][%zu] is %.9g, expected %.17g", i / 4, i % 4, got, expected[i]);
    }
    free(expected);
}

static int check_file(void *visited, const char *path, const char *name) {
    char source[512], relative[600], data[1200];
    npz *golden = npz_open(path);
    assert_non_null(golden);
    npz_string(golden, "source", source, sizeof source);
    snprintf(relative, sizeof relative, "data/%s", source);
    if (shared_path(data, sizeof data, relative) != 0) fail_msg("%s names %s, which isn't there", name, relative);
    print_message("    %s: %s\n", name, source);
    tides_scene *scene = load(data);
    tides_gaussians g = only_object(scene);
    size_t sh = 3 * (size_t)(g.sh_degree + 1) * (size_t)(g.sh_degree + 1);
    assert_int_equal(g.count, npz_int(golden, "total"));
    compare(golden, "xyz", g.mean, 3, 3);
    compare(golden, "log_scale", g.log_scale, 3, 3);
    compare(golden, "opacity_logit", g.opacity_logit, 1, 1);
    compare(golden, "f_dc", g.sh, 3, sh);
    assert_int_equal(npz_get(golden, "f_rest_coef") != NULL, g.sh_degree > 0);
    if (g.sh_degree > 0) compare(golden, "f_rest_coef", g.sh + 3, sh - 3, sh);
    compare_rotations(golden, g.quaternion);
    tides_scene_destroy(scene);
    npz_close(golden);
    ++*(int *)visited;
    return 0;
}

static void every_golden_file(void **state) {
    (void)state;
    char folder[1024];
    int visited = 0;
    if (shared_path(folder, sizeof folder, "golden/formats") != 0) skip();
    shared_scan(folder, ".npz", check_file, &visited);
    assert_true(visited > 0);
}

/* -- the same splats in two formats: each agrees with the .ply within what the format can hold ----------------------------- */

static tides_scene *load_data(const char *relative) {
    char path[1024];
    return shared_path(path, sizeof path, relative) == 0 ? load(path) : NULL;
}

static void assert_close(const char *what, size_t i, double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance))
        fail_msg("%s[%zu]: %.9g and %.9g differ by more than %g", what, i, got, expected, tolerance);
}

static double opacity_of(float logit) { return 1 / (1 + exp(-(double)logit)); }

/* The same rotation: |cosine| of half the angle. */
static double likeness(const float *a, const float *b) {
    double dot = 0, aa = 0, bb = 0;
    for (int k = 0; k < 4; k++) {
        dot += (double)a[k] * b[k];
        aa += (double)a[k] * a[k];
        bb += (double)b[k] * b[k];
    }
    return fabs(dot) / sqrt(aa * bb);
}

static void train_in_three_formats(void **state) {
    (void)state;
    tides_scene *ply = load_data("data/formats/test-splat.3-points-from-train.ply");
    tides_scene *splat = load_data("data/formats/test-splat.3-points-from-train.splat");
    tides_scene *spz = load_data("data/formats/test-splat.3-points-from-train.spz");
    if (!ply || !splat || !spz) skip();
    tides_gaussians p = only_object(ply), s = only_object(splat), z = only_object(spz);
    assert_true(p.count == 3);
    assert_true(s.count == 3);
    assert_true(z.count == 3);
    assert_true(p.sh_degree == 3);
    assert_true(z.sh_degree == 3);
    for (size_t i = 0; i < 9; i++) {
        assert_close("splat mean", i, (double)s.mean[i], (double)p.mean[i], 0);
        assert_close("spz mean", i, (double)z.mean[i], (double)p.mean[i], 0.5 / 4096 + 1e-7); /* 12 fractional bits */
        assert_close("splat scale", i, (double)s.log_scale[i], (double)p.log_scale[i], 1e-6);
        assert_close("spz scale", i, (double)z.log_scale[i], (double)p.log_scale[i], 0.5 / 16 + 1e-6);
    }
    for (size_t i = 0; i < 3; i++) {
        assert_close("splat opacity", i, opacity_of(s.opacity_logit[i]), opacity_of(p.opacity_logit[i]), 1 / 255.0);
        assert_close("spz opacity", i, opacity_of(z.opacity_logit[i]), opacity_of(p.opacity_logit[i]), 0.501 / 255);
        assert_true(likeness(s.quaternion + 4 * i, p.quaternion + 4 * i) > 0.9999); /* 8 bits: 0.01 rad */
        assert_true(likeness(z.quaternion + 4 * i, p.quaternion + 4 * i) > 0.99999);
        for (size_t k = 0; k < 48; k++) { /* SH has 5 bits in band 1 and 4 beyond, truncated */
            double dc = 0.501 / 255 / 0.15, step = k < 3 ? dc : k < 12 ? 1 / 16.0 : 1 / 8.0;
            assert_close("spz sh", 48 * i + k, (double)z.sh[48 * i + k], (double)p.sh[48 * i + k], step);
        }
        for (size_t c = 0; c < 3; c++) /* a colour is clamped to 0..255 and truncated */
            assert_close("splat colour", i, (double)s.sh[3 * i + c], (double)p.sh[48 * i + c], 1.001 / 255 / 0.282);
    }
    tides_scene_destroy(ply);
    tides_scene_destroy(splat);
    tides_scene_destroy(spz);
}

/* Four splats that splat-transform's fixtures hold in each format; version 2 has another z (README of the goldens). They are
 * spheres, and their rotations differ from file to file. */
static void minimal_in_five_formats(void **state) {
    (void)state;
    static const char *const names[] = {"minimal-v3.spz", "minimal-v4.spz", "minimal.ksplat",
                                        "minimal.splat",  "minimal-v2.spz", "minimal-raw.spz"};
    tides_scene *first = load_data("data/formats/minimal-v3.spz");
    if (!first) skip();
    tides_gaussians a = only_object(first);
    for (size_t n = 1; n < sizeof names / sizeof names[0]; n++) {
        char relative[128];
        snprintf(relative, sizeof relative, "data/formats/%s", names[n]);
        tides_scene *other = load_data(relative);
        assert_non_null(other);
        tides_gaussians b = only_object(other);
        assert_int_equal(b.count, a.count);
        double z_sign = n >= 4 ? -1 : 1; /* version 2 */
        for (size_t i = 0; i < 4; i++) {
            for (size_t k = 0; k < 3; k++) {
                assert_close(names[n], i, (double)b.mean[3 * i + k], (double)a.mean[3 * i + k] * (k == 2 ? z_sign : 1), 0);
                assert_close(names[n], i, (double)b.log_scale[3 * i + k], (double)a.log_scale[3 * i + k], 0.5 / 16);
            }
            assert_close(names[n], i, opacity_of(b.opacity_logit[i]), opacity_of(a.opacity_logit[i]), 0.501 / 255);
        }
        tides_scene_destroy(other);
    }
    tides_scene_destroy(first);
}

/* The plain file is a random choice of the compressed one's Gaussians, by another decoder: each is there. */
static void guitar_is_part_of_its_compressed_self(void **state) {
    (void)state;
    tides_scene *whole = load_data("data/playcanvas/guitar.compressed.ply"),
                *part = load_data("data/playcanvas/guitar_20k_inria_sh0.ply");
    if (!whole || !part) skip();
    tides_gaussians w = only_object(whole), p = only_object(part);
    size_t found = 0;
    for (size_t i = 0; i < (size_t)p.count; i += 500)
        for (size_t k = 0; k < (size_t)w.count; k++) {
            if (memcmp(w.mean + 3 * k, p.mean + 3 * i, 3 * sizeof(float)) != 0) continue;
            found += fabs((double)w.log_scale[3 * k] - (double)p.log_scale[3 * i]) < 1e-6 &&
                     likeness(w.quaternion + 4 * k, p.quaternion + 4 * i) > 1 - 1e-6;
            break;
        }
    assert_int_equal(found, 40);
    tides_scene_destroy(whole);
    tides_scene_destroy(part);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_golden_file),
        cmocka_unit_test(train_in_three_formats),
        cmocka_unit_test(minimal_in_five_formats),
        cmocka_unit_test(guitar_is_part_of_its_compressed_self),
    };
    return cmocka_run_group_tests_name("formats", tests, NULL, NULL);
}
