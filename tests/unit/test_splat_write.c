/* .spz and .splat by the library: they read back as saved, to the precision of their bytes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tests/support/splat_make.h"

#include "td_endian.h"

#include <math.h>
#include <zstd.h>

enum { COUNT = 200 };

static double sigmoid(double logit) { return 1 / (1 + exp(-logit)); }

static void near(const char *what, size_t i, double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) fail_msg("%s of %zu: %.9g, expected %.9g", what, i, got, expected);
}

/* Rotations are one where q and -q are. */
static void same_rotation(size_t i, const float *got, const float *expected, double tolerance) {
    double dot = 0, a = 0, b = 0;
    for (int k = 0; k < 4; k++) {
        dot += (double)got[k] * expected[k];
        a += (double)got[k] * got[k];
        b += (double)expected[k] * expected[k];
    }
    near("rotation", i, fabs(dot) / sqrt(a * b), 1, tolerance);
}

/* Saved as `name` at `scale`, and read again. */
static tides_scene *round_trip(void **state, const td_gaussians *g, double scale, const char *name) {
    tides_scene *scene = scene_new(), *again = scene_new();
    scene_add(scene, g, NULL, scale, "a");
    scene_save(scene, scene_in_folder(*state, name));
    scene_load(again, scene_in_folder(*state, name), NULL, 1);
    tides_scene_destroy(scene);
    return again;
}

static void spz(void **state) {
    for (int degree = 0; degree <= 4; degree++) {
        td_gaussians g = scene_random(7 + (uint64_t)degree, COUNT, degree, SCENE_TRAINED);
        tides_scene *again = round_trip(state, &g, 2, "a.spz");
        const tides_object object = scene_object_of(again, 0);
        const tides_gaussians *r = &object.gaussians;
        const size_t width = 3 * td_sh_coefficients(degree);
        double largest = 0;
        assert_int_equal(r->count, COUNT);
        assert_int_equal(r->sh_degree, degree);
        for (size_t i = 0; i < 3 * COUNT; i++) largest = fmax(largest, fabs(2.0 * (double)g.mean[i]));
        for (size_t i = 0; i < COUNT; i++) {
            for (size_t k = 0; k < 3; k++) {
                const double log_scale = g.log_scale[3 * i + k] + log(2), dc = g.sh[width * i + k];
                near("mean", i, (double)r->mean[3 * i + k], 2 * (double)g.mean[3 * i + k], largest * 0x1p-22);
                near("scale", i, (double)r->log_scale[3 * i + k], fmin(fmax(log_scale, -10), 5.9375), 0.5001 / 16);
                near("colour", i, (double)r->sh[width * i + k], fmin(fmax(dc, -0.5 / 0.15), 0.5 / 0.15), 0.501 / 255 / 0.15);
            }
            for (size_t k = 3; k < width; k++) {
                const double sh = g.sh[width * i + k]; /* bytes end at -1 on one side, and at 127/128 on the other */
                near("sh", i, (double)r->sh[width * i + k], fmin(fmax(sh, -1), 1),
                     (fabs(sh) > 127 / 128.0 ? 1.01 : 0.501) / 128);
            }
            near("opacity", i, sigmoid((double)r->opacity_logit[i]), sigmoid((double)g.opacity_logit[i]), 0.501 / 255);
            same_rotation(i, r->quaternion + 4 * i, g.quaternion + 4 * i, 5e-6);
        }
        tides_scene_destroy(again);
        td_gaussians_free(&g);
    }
}

/* The file by its layout alone: header, the record of its axes, the table, and positions in right, up, back. */
static void check_layout(const unsigned char *b, size_t size, const td_gaussians *g) {
    const uint32_t words[] = {0x5053474e, 4, COUNT};
    const unsigned streams = g->sh_degree ? 6 : 5;
    const size_t plain = 9 * COUNT, first = 44 + 16 * streams;
    unsigned char positions[9 * COUNT];
    for (size_t i = 0; i < 3; i++) assert_int_equal(td_le32(b + 4 * i), words[i]);
    assert_int_equal(b[12], g->sh_degree);
    assert_int_equal(b[14], g->trained == TIDES_TRAINED_ANTIALIASED ? 3 : 2);
    assert_int_equal(b[15], streams);
    assert_int_equal(td_le32(b + 16), 44);
    for (size_t i = 20; i < 32; i++) assert_int_equal(b[i], 0);
    assert_int_equal(td_le32(b + 32), 0xadbe0003);
    assert_int_equal(td_le32(b + 36), 4);
    assert_int_equal(td_le32(b + 40), 4); /* RUB */
    size_t end = first;
    for (unsigned i = 0; i < streams; i++) end += td_le64(b + 44 + 16 * i);
    assert_int_equal(end, size);
    assert_int_equal(td_le64(b + 52), plain);
    assert_int_equal(ZSTD_decompress(positions, plain, b + first, td_le64(b + 44)), plain);
    for (size_t i = 0; i < 3 * (size_t)COUNT; i++) {
        const unsigned char *p = positions + 3 * i;
        const int32_t fixed = (int32_t)((uint32_t)p[2] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[0] << 8) / 256;
        near("position", i, ldexp(fixed, -b[13]), (double)g->mean[i] * (i % 3 ? -1 : 1), ldexp(0.5, -b[13]));
    }
}

static void spz_bytes(void **state) {
    for (int degree = 0; degree <= 4; degree += 2) {
        td_gaussians g = scene_random(7, COUNT, degree, SCENE_TRAINED);
        tides_scene *scene = scene_new();
        g.trained = degree ? TIDES_TRAINED_ANTIALIASED : TIDES_TRAINED_UNKNOWN;
        scene_add(scene, &g, NULL, 1, "a");
        scene_save(scene, scene_in_folder(*state, "a.spz"));
        size_t size = 0;
        char *data = NULL;
        assert_int_equal(td_read_file(scene_in_folder(*state, "a.spz"), SIZE_MAX - 1, &data, &size, NULL), TIDES_OK);
        check_layout((const unsigned char *)data, size, &g);
        free(data);
        tides_scene_destroy(scene);
        td_gaussians_free(&g);
    }
}

/* Packed to almost nothing, which a reader may take for a header that lies. */
static void all_alike(void **state) {
    enum { MANY = 300000 };
    td_gaussians g;
    assert_int_equal(td_gaussians_create(&g, MANY, 3, NULL), TIDES_OK);
    for (size_t i = 0; i < MANY; i++) g.quaternion[4 * i] = 1;
    tides_scene *again = round_trip(state, &g, 1, "a.spz");
    assert_int_equal(scene_object_of(again, 0).gaussians.count, MANY);
    tides_scene_destroy(again);
    td_gaussians_free(&g);
}

static void splat(void **state) {
    td_gaussians g = scene_random(3, COUNT, 2, SCENE_TRAINED);
    tides_scene *again = round_trip(state, &g, 0.5, "a.splat");
    const tides_object object = scene_object_of(again, 0);
    const tides_gaussians *r = &object.gaussians;
    const size_t width = 3 * td_sh_coefficients(2);
    assert_int_equal(r->count, COUNT);
    assert_int_equal(r->sh_degree, 0);
    for (size_t i = 0; i < COUNT; i++) {
        for (size_t k = 0; k < 3; k++) {
            const double colour = fmin(fmax(0.5 + 0.28209479177387814 * (double)g.sh[width * i + k], 0), 1);
            near("mean", i, (double)r->mean[3 * i + k], 0.5 * (double)g.mean[3 * i + k], 1e-12);
            near("scale", i, (double)r->log_scale[3 * i + k], g.log_scale[3 * i + k] + log(0.5), 1e-5);
            near("colour", i, 0.5 + 0.28209479177387814 * (double)r->sh[3 * i + k], colour, 0.501 / 255);
        }
        near("opacity", i, sigmoid((double)r->opacity_logit[i]), sigmoid((double)g.opacity_logit[i]), 0.501 / 255);
        same_rotation(i, r->quaternion + 4 * i, g.quaternion + 4 * i, 1e-4);
    }
    tides_scene_destroy(again);
    td_gaussians_free(&g);
}

static void refuse(void **state, const td_gaussians *g, const char *name, tides_status wanted, const char *words) {
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    scene_add(scene, g, NULL, 1, "a");
    scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, name), &error), wanted, &error, words);
    tides_scene_destroy(scene);
}

static void refused(void **state) {
    td_gaussians far = scene_random(5, 4, 0, SCENE_TRAINED);
    tides_error error = {0, ""};
    far.mean[3] = 9e6f;
    refuse(state, &far, "a.spz", TIDES_UNSUPPORTED, "coordinates below 8388607");
    refuse(state, &far, "gone/a.splat", TIDES_WRITE_FAILED, "gone/a.splat");
    tides_scene *scene = scene_new();
    scene_add(scene, &far, NULL, 1, "a");
    scene_add(scene, &far, NULL, 1, "b");
    scene_expect_error(tides_scene_save(scene, "a.spz", &error), TIDES_UNSUPPORTED, &error, "a .spz holds one object");
    scene_expect_error(tides_scene_save(scene, "a.splat", &error), TIDES_UNSUPPORTED, &error, "a .splat holds one object");
    tides_scene_destroy(scene);
    td_gaussians_free(&far);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {IN_FOLDER(spz), IN_FOLDER(spz_bytes), IN_FOLDER(all_alike), IN_FOLDER(splat),
                                       IN_FOLDER(refused)};
    return cmocka_run_group_tests_name("splat_write", tests, NULL, NULL);
}
