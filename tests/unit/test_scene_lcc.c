/* LCC scenes made by the test, byte by byte: two units of two levels, harmonics, an environment; what each level holds, turned
 * to the axes of a 3DGS .ply; and every way of being wrong. */
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

/* Gaussians by unit and level, and where each begins: data.bin has them in this order. */
enum { UNITS = 2, LEVELS = 2, ALL = 6, RECORD = 32 };
static const uint32_t counts[UNITS][LEVELS] = {{2, 1}, {1, 2}};

static const char quality[] = "{\"fileType\":\"Quality\",\"totalLevel\":2,\"splats\":[3,3],\"attributes\":["
                              "{\"name\":\"scale\",\"min\":[0.25,0.5,1],\"max\":[2,4,8]},"
                              "{\"name\":\"shcoef\",\"min\":[-1,-2,-3],\"max\":[1,2,3]},"
                              "{\"name\":\"envscale\",\"min\":[10,10,10],\"max\":[10,10,10]}]}";
static const char portable[] = "{\"fileType\":\"Portable\",\"totalLevel\":2,\"attributes\":["
                               "{\"name\":\"scale\",\"min\":[0.25,0.5,1],\"max\":[2,4,8]}]}";

/* Record i: mean (i, 10 + i, 20 + i); scale parts 0, 1 and 0; the largest of x y z w number i is left out, the others are 0 but
 * for the first, which is the largest that ten bits hold. */
static void add_record(scene_bytes *b, unsigned i) {
    for (unsigned k = 0; k < 3; k++) splat_float(b, (float)(10 * k + i));
    for (unsigned k = 0; k < 4; k++) splat_u8(b, 51 * k);
    splat_u16(b, 0);
    splat_u16(b, 65535);
    splat_u16(b, 0);
    splat_u32(b, (i % 4) << 30 | 512u << 20 | 512u << 10 | 1023u);
    splat_zeros(b, 6);
}

/* All coefficients at their least, but number i, whose r g b are at their most. */
static void add_harmonics(scene_bytes *b, unsigned i) {
    for (unsigned k = 1; k < 16; k++) splat_u32(b, k == i + 1 ? 2047u | 1023u << 11 | 2047u << 21 : 0);
    splat_zeros(b, 4);
}

static void put(void **state, const char *name, const scene_bytes *b) {
    scene_file_write(scene_in_folder(*state, name), b->data, b->size);
}

static void make_scene(void **state, const char *meta) {
    scene_bytes index = {0}, data = {0}, sh = {0};
    unsigned at = 0;
    for (unsigned u = 0; u < UNITS; u++) {
        splat_u32(&index, u);
        for (unsigned level = 0; level < LEVELS; level++) {
            splat_u32(&index, counts[u][level]);
            splat_u32(&index, RECORD * at);
            splat_u32(&index, 0);
            splat_u32(&index, RECORD * counts[u][level]);
            for (unsigned i = 0; i < counts[u][level]; i++, at++) {
                add_record(&data, at);
                add_harmonics(&sh, at);
            }
        }
    }
    scene_file_write(scene_in_folder(*state, "a.lcc"), meta, strlen(meta));
    put(state, "index.bin", &index);
    put(state, "data.bin", &data);
    put(state, "shcoef.bin", &sh);
    free(index.data);
    free(data.data);
    free(sh.data);
}

static tides_status read_part(void **state, const char *part, tides_scene *scene, tides_error *error) {
    tides_scene_options how;
    tides_scene_options_defaults(&how);
    how.part = part;
    return tides_scene_read(scene, scene_in_folder(*state, "a.lcc"), &how, NULL, 1, error);
}

static void near(const char *what, double got, double wanted) {
    if (!(fabs(got - wanted) <= 2e-6 * (1 + fabs(wanted)))) fail_msg("%s: %.9g, not %.9g", what, got, wanted);
}

/* Gaussian `row` of the scene is record i: z, which is up, has become -y. */
static void check_record(const tides_gaussians *g, size_t row, unsigned i, const double scale[3]) {
    static const double axes[4] = {1023, 512, 512, 0}; /* the three that are stored, in order */
    double xyzw[4], rest = 1;
    const float *m = g->mean + 3 * row, *q = g->quaternion + 4 * row;
    near("x", (double)m[0], i);
    near("y", (double)m[1], -(20.0 + i));
    near("z", (double)m[2], 10.0 + i);
    for (unsigned k = 0, next = 0; k < 4; k++) {
        if (k == i % 4) continue;
        xyzw[k] = axes[next++] / 1023 * sqrt(2) - sqrt(0.5);
        rest -= xyzw[k] * xyzw[k];
    }
    xyzw[i % 4] = sqrt(fmax(rest, 0));
    const double h = sqrt(0.5); /* times the quarter turn about x, (h, h, 0, 0) */
    const double wanted[4] = {h * (xyzw[3] - xyzw[0]), h * (xyzw[0] + xyzw[3]), h * (xyzw[1] - xyzw[2]),
                              h * (xyzw[2] + xyzw[1])};
    double dot = 0;
    for (int k = 0; k < 4; k++) dot += wanted[k] * (double)q[k];
    near("rotation", fabs(dot), 1);
    for (size_t k = 0; k < 3; k++) {
        near("scale", exp((double)g->log_scale[3 * row + k]), scale[k]);
        near("colour", 0.5 + 0.28209479177387814 * (double)g->sh[3 * td_sh_coefficients(g->sh_degree) * row + k],
             0.2 * (double)k);
    }
    near("opacity", 1 / (1 + exp(-(double)g->opacity_logit[row])), 0.6);
}

static const double scales[3] = {0.25, 4, 1}, environment[3] = {10, 10, 10};

static void levels(void **state) {
    static const unsigned rows[LEVELS][3] = {{0, 1, 3}, {2, 4, 5}};
    static const char *const parts[LEVELS] = {NULL, "1"};
    make_scene(state, portable);
    for (int level = 0; level < LEVELS; level++) {
        tides_scene *scene = scene_new();
        tides_error error = {0, ""};
        double up[3];
        scene_expect_ok(read_part(state, parts[level], scene, &error), &error);
        const tides_object object = scene_object_of(scene, 0);
        assert_int_equal(object.gaussians.count, 3);
        assert_int_equal(object.gaussians.sh_degree, 0);
        for (size_t i = 0; i < 3; i++) check_record(&object.gaussians, i, rows[level][i], scales);
        assert_int_equal(tides_scene_up(scene, up), 1);
        assert_true(up[0] == 0 && up[1] == -1 && up[2] == 0);
        assert_non_null(strstr(tides_scene_notes(scene), "level of detail"));
        tides_scene_destroy(scene);
    }
}

/* Band 1 is -c1 y + c2 z - c3 x; with y = z' and z = -y' that is c1' = c2, c2' = -c1, c3' = c3. */
static void harmonics(void **state) {
    make_scene(state, quality);
    scene_bytes env = {0};
    add_record(&env, 6);
    add_harmonics(&env, 6);
    put(state, "environment.bin", &env);
    free(env.data);
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "a.lcc"), NULL, 1);
    scene_is_srgb(scene, *state);
    const tides_object object = scene_object_of(scene, 0);
    const tides_gaussians *g = &object.gaussians;
    assert_int_equal(g->count, 4);
    assert_int_equal(g->sh_degree, 3);
    check_record(g, 0, 0, scales);
    check_record(g, 3, 6, environment);
    for (size_t i = 0; i < 2; i++) /* of record 0 c1 is at its most, of record 1 c2; else they are at their least */
        for (size_t c = 0; c < 3; c++) {
            const double most = 1.0 + (double)c;
            const float *sh = g->sh + 3 * 16 * i + c;
            near("c1", (double)sh[3], i == 1 ? most : -most);
            near("c2", (double)sh[6], i == 0 ? -most : most);
            near("c3", (double)sh[9], -most);
        }
    tides_scene_destroy(scene);
}

static void refuse(void **state, const char *part, const char *words) {
    tides_scene *scene = scene_new();
    tides_error error = {0, ""};
    const tides_status status = read_part(state, part, scene, &error);
    scene_expect_error(status, part ? TIDES_BAD_ARGUMENT : TIDES_BAD_FILE, &error, words);
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
}

static void cut(void **state, const char *name, size_t left, const char *words) {
    size_t size = 0;
    char *data = scene_file_read(scene_in_folder(*state, name), &size);
    scene_file_write(scene_in_folder(*state, name), data, left < size ? left : size - 1);
    refuse(state, NULL, words);
    scene_file_write(scene_in_folder(*state, name), data, size);
    free(data);
}

static void refused(void **state) {
    static const char *const metas[] = {"{}", "{\"totalLevel\":65}", "{\"totalLevel\":2}", "[",
                                        "{\"totalLevel\":2,\"attributes\":[7]}"};
    for (size_t i = 0; i < sizeof metas / sizeof *metas; i++) {
        make_scene(state, metas[i]);
        refuse(state, NULL, "a.lcc");
    }
    make_scene(state, quality);
    refuse(state, "2", "scene.part|0 to 1");
    refuse(state, "x", "scene.part|0 to 1");
    cut(state, "index.bin", SIZE_MAX, "multiple of the 36");
    cut(state, "index.bin", 0, "a.lcc|index.bin");
    cut(state, "data.bin", 3 * RECORD, "unit 1|truncated?");
    cut(state, "shcoef.bin", 64, "shcoef.bin has 64 bytes");
    scene_bytes env = {0};
    splat_zeros(&env, 95);
    put(state, "environment.bin", &env);
    free(env.data);
    refuse(state, NULL, "environment.bin has 95 bytes");
}

/* Units that say they are the whole of data.bin, many times over. */
static void lies(void **state) {
    make_scene(state, portable);
    scene_bytes index = {0};
    for (unsigned u = 0; u < 1000; u++) {
        splat_u32(&index, u);
        for (unsigned level = 0; level < LEVELS; level++) {
            splat_u32(&index, ALL);
            splat_zeros(&index, 12);
        }
    }
    put(state, "index.bin", &index);
    free(index.data);
    refuse(state, NULL, "6000 Gaussians|6 in all");
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {IN_FOLDER(levels), IN_FOLDER(harmonics), IN_FOLDER(refused), IN_FOLDER(lies)};
    return cmocka_run_group_tests_name("scene_lcc", tests, NULL, NULL);
}
