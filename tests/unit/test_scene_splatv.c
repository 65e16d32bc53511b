/* .splatv files made by the test, byte by byte: places of Gaussians at times, by the formula of splaTV's shader, and every
 * error. */
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

#include <math.h>

enum { COUNT = 3, ROW = 64, TEXTURE = 4096 * 16 };

/* IEEE half of what one holds exactly. */
static unsigned half_of(double value) {
    int exponent = 0;
    if (value == 0) return 0;
    const double part = frexp(fabs(value), &exponent); /* 0.5 to 1 */
    const unsigned bits = (unsigned)(exponent + 14) << 10 | (unsigned)(part * 2048 - 1024);
    assert_true(part * 2048 == floor(part * 2048) && exponent > -14 && exponent < 16);
    return (value < 0 ? 0x8000u : 0) | bits;
}

/* Eighths from -2 to 2, all different enough. */
static double number(size_t i, size_t k) { return ((double)((7 * i + 5 * k + i * k) % 33) - 16) / 8; }

static void add_halves(scene_bytes *b, size_t i, size_t first, size_t count, size_t room) {
    for (size_t k = 0; k < room; k++) splat_u16(b, k < count ? half_of(number(i, first + k)) : 0);
}

static double width_of(size_t i) { return 0.25 * (double)(i + 1); }
static double scale_of(size_t i, size_t k) { return ldexp(1, -(int)(i + k + 1)); }

static void add_row(scene_bytes *b, size_t i) {
    for (size_t k = 0; k < 3; k++) splat_float(b, (float)number(i, k));
    splat_u16(b, half_of(1));
    for (size_t k = 1; k < 4; k++) splat_u16(b, half_of(number(i, 10 + k)));
    for (size_t k = 0; k < 4; k++) splat_u16(b, k < 3 ? half_of(scale_of(i, k)) : 0);
    for (size_t k = 0; k < 3; k++) splat_u8(b, (unsigned)(51 * (k + i)));
    splat_u8(b, 204);
    add_halves(b, i, 20, 9, 10);
    add_halves(b, i, 30, 4, 4);
    splat_u16(b, half_of(0.5 + 0.125 * (double)i));
    splat_u16(b, half_of(width_of(i)));
}

static scene_bytes make_file(const char *json, size_t before) {
    scene_bytes b = {0};
    splat_u32(&b, 0x674b);
    splat_u32(&b, (uint32_t)strlen(json));
    scene_bytes_add(&b, json, strlen(json));
    splat_zeros(&b, before);
    for (size_t i = 0; i < COUNT; i++) add_row(&b, i);
    splat_zeros(&b, TEXTURE - COUNT * ROW);
    return b;
}

static const char plain[] = "[{\"type\":\"splat\",\"size\":65536,\"texwidth\":4096,\"texheight\":1,\"cameras\":[{\"id\":0}]}]";
static const char behind[] =
    "[{\"type\":\"other\",\"size\":5},{\"type\":\"splat\",\"size\":65536,\"texwidth\":4096,\"texheight\":1}]";

static const char *put_file(void **state, const char *name, const scene_bytes *b, size_t bytes) {
    const char *path = scene_in_folder(*state, name);
    assert_int_equal(tides_file_write(path, b->data, bytes, NULL), TIDES_OK);
    return path;
}

static void near(const char *what, size_t i, double got, double wanted) {
    if (!(fabs(got - wanted) <= 2e-6 * (1 + fabs(wanted)))) fail_msg("%s of %zu: %.9g, not %.9g", what, i, got, wanted);
}

/* The shader's: dt = time - centre; opacity exp(-(dt / width)^2); m0 dt + m1 dt^2 + m2 dt^3; rot + omega dt. */
static void check_at(const tides_scene *scene, double time) {
    double mean[3 * COUNT], log_scale[3 * COUNT], quaternion[4 * COUNT], logit[COUNT], sh[3 * COUNT];
    const tides_theta theta = {.mean = mean,
                               .log_scale = log_scale,
                               .quaternion = quaternion,
                               .opacity_logit = logit,
                               .sh = sh};
    tides_error error = {0, ""};
    scene_expect_ok(tides_scene_gaussians_at(scene, 0, time, &theta, &error), &error);
    for (size_t i = 0; i < COUNT; i++) {
        const double dt = time - (0.5 + 0.125 * (double)i), bell = exp(-(dt / width_of(i)) * (dt / width_of(i)));
        double q[4], length = 0, sign = 1;
        for (size_t k = 0; k < 3; k++) {
            near("mean", i, mean[3 * i + k],
                 number(i, k) + dt * (number(i, 20 + k) + dt * (number(i, 23 + k) + dt * number(i, 26 + k))));
            near("scale", i, exp(log_scale[3 * i + k]), scale_of(i, k));
            near("colour", i, 0.5 + 0.28209479177387814 * sh[3 * i + k], 51 * (double)(k + i) / 255);
        }
        for (size_t k = 0; k < 4; k++) {
            q[k] = (k ? number(i, 10 + k) : 1) + dt * number(i, 30 + k);
            length += q[k] * q[k];
        }
        if (q[0] * quaternion[4 * i] < 0) sign = -1;
        for (size_t k = 0; k < 4; k++) near("quaternion", i, sign * quaternion[4 * i + k], q[k] / sqrt(length));
        near("opacity", i, 1 / (1 + exp(-logit[i])), 0.8 * bell);
    }
}

static void values(void **state) {
    const scene_bytes files[] = {make_file(plain, 0), make_file(behind, 5)};
    for (size_t f = 0; f < 2; f++) {
        tides_scene *scene = scene_new();
        scene_load(scene, put_file(state, "a.splatv", &files[f], files[f].size), NULL, 1);
        scene_is_srgb(scene, *state);
        const tides_object object = scene_object_of(scene, 0);
        assert_int_equal(object.gaussians.count, COUNT);
        assert_string_equal(object.name, "a");
        assert_string_equal(tides_motion_model(object.motion), "polynomial");
        assert_true(object.duration_s == 1);
        for (int k = 0; k <= 8; k++) check_at(scene, k / 8.0);
        tides_scene_destroy(scene);
        free(files[f].data);
    }
}

static void refuse(void **state, const scene_bytes *b, size_t bytes, const char *words) {
    tides_scene *scene = scene_new();
    tides_error error = {0, ""};
    const char *path = put_file(state, "b.splatv", b, bytes);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, words);
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
}

static void refused(void **state) {
    static const struct {
        const char *json, *words;
    } cases[] = {
        {"[]", "b.splatv|lists no chunk of splats"},
        {"[{\"type\":\"splat\",\"size\":65536,\"texwidth\":2048,\"texheight\":2}]", "4096 wide"},
        {"[{\"type\":\"splat\",\"size\":65536,\"texwidth\":4096,\"texheight\":2}]", "4096 wide"},
        {"[{\"type\":\"splat\",\"size\":131072,\"texwidth\":4096,\"texheight\":2}]", "truncated?"},
        {"[{\"type\":\"other\",\"size\":-1},{\"type\":\"splat\"}]", "truncated?"},
        {"[{\"type\":\"splat\",\"size\":0,\"texwidth\":4096,\"texheight\":0}]", "4096 wide"},
        {"[{\"type\":", "b.splatv"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene_bytes b = make_file(cases[i].json, 0);
        refuse(state, &b, b.size, cases[i].words);
        free(b.data);
    }
    scene_bytes b = make_file(plain, 0);
    for (size_t cut = 9; cut < b.size; cut += 1 + b.size / 60) refuse(state, &b, cut, "truncated?");
    memset(b.data + 8 + strlen(plain), 0, COUNT * ROW);
    refuse(state, &b, b.size, "holds no splats");
    free(b.data);
    scene_bytes bad = make_file(plain, 0);
    memset(bad.data + 8 + strlen(plain) + ROW + 12, 0, 8);
    refuse(state, &bad, bad.size, "1|quaternion");
    free(bad.data);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {IN_FOLDER(values), IN_FOLDER(refused)};
    return cmocka_run_group_tests_name("scene_splatv", tests, NULL, NULL);
}
