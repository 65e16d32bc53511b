/* Splats of glTF made by the test: values, transforms of nodes, drafts of the extension, containers; and .glb by the
 * library. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/gltf_make.h"
#include "tests/support/scene_folder.h"

#include <math.h>

static td_gaussians parsed(const gltf_recipe *r) {
    scene_bytes b = gltf_glb(r);
    td_gaussians g = splat_parse(gltf_parse, &b);
    free(b.data);
    return g;
}

/* -- values -------------------------------------------------------------------------------------------------------------- */

/* m of coefficient k. */
static int order_of(int k) {
    const int l = (int)sqrt((double)k);
    return k - l * l - l;
}

/* Half a turn about z: x and y change signs, (w x y z) becomes (-z -y x w), and SH of odd m change theirs. */
static void check_turned(const td_gaussians *g, int degree, double tolerance) {
    const size_t wide = 3 * td_sh_coefficients(degree);
    assert_int_equal(g->count, GLTF_COUNT);
    assert_int_equal(g->sh_degree, degree);
    for (int i = 0; i < GLTF_COUNT; i++) {
        const double mean[3] = {-gltf_value(0, i, 0), -gltf_value(0, i, 1), gltf_value(0, i, 2)};
        const double turn[4] = {-gltf_value(1, i, 2), -gltf_value(1, i, 1), gltf_value(1, i, 0), gltf_value(1, i, 3)};
        const double logit = log(gltf_value(3, i, 0) / (1 - gltf_value(3, i, 0)));
        splat_near("mean", g->mean + 3 * i, mean, 3, 1e-6);
        splat_near("quaternion", g->quaternion + 4 * i, turn, 4, 1e-6);
        splat_near("opacity", g->opacity_logit + i, &logit, 1, 1e-6);
        for (int c = 0; c < 3; c++) {
            const double scale = log(gltf_value(2, i, c));
            splat_near("scale", g->log_scale + 3 * i + c, &scale, 1, tolerance);
            for (int k = 0; k < (int)wide / 3; k++) {
                const double sh = (order_of(k) % 2 ? -1 : 1) * gltf_value(4 + k, i, c);
                splat_near("sh", g->sh + wide * (size_t)i + 3 * k + c, &sh, 1, 0);
            }
        }
    }
}

static void values(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) { /* the second four as drafts had scales */
        td_gaussians g = parsed(&(gltf_recipe){.degree = k % 4, .logarithms = k / 4});
        check_turned(&g, k % 4, 1e-6);
        td_gaussians_free(&g);
    }
}

/* Integers, of each kind that the extension has; interleaved, by a byteStride. */
static void quantised(void **state) {
    (void)state;
    static const char json[] =
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":"
        "0,"
        "\"KHR_gaussian_splatting:ROTATION\":1,\"KHR_gaussian_splatting:SCALE\":2,\"KHR_gaussian_splatting:OPACITY\":3,"
        "\"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0\":4},\"extensions\":{\"KHR_gaussian_splatting\":{}}}]}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5122,\"count\":2,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":6,\"componentType\":5120,\"normalized\":true,\"count\":2,\"type\":\"VEC4\"},"
        "{\"bufferView\":0,\"byteOffset\":10,\"componentType\":%d,\"normalized\":true,\"count\":2,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":16,\"componentType\":5121,\"normalized\":true,\"count\":2,\"type\":\"SCALAR\"},"
        "{\"bufferView\":0,\"byteOffset\":20,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}],\"bufferViews\":["
        "{\"buffer\":0,\"byteOffset\":4,\"byteStride\":32,\"byteLength\":64}],\"buffers\":[{\"byteLength\":68}]}";
    for (int is_signed = 0; is_signed < 2; is_signed++) { /* then scales are logarithms */
        char text[GLTF_ROOM];
        scene_bytes words = {0}, chunk = {0};
        snprintf(text, sizeof text, json, is_signed ? 5122 : 5123);
        scene_bytes_add(&words, text, strlen(text));
        splat_zeros(&chunk, 4);
        for (unsigned i = 0; i < 2; i++) {
            const unsigned row[] = {3, 0xfffe, 5 + i}, scale[] = {is_signed ? 0x8000 : 65535, 16384, 1};
            for (int c = 0; c < 3; c++) splat_u16(&chunk, row[c]);
            splat_u32(&chunk, i ? 0x00800000 : 0x7f000000); /* x y z w: -1 in z as -128, 1 in w */
            for (int c = 0; c < 3; c++) splat_u16(&chunk, scale[c]);
            splat_u32(&chunk, 51 + 51 * i);
            for (int c = 0; c < 3; c++) splat_float(&chunk, (float)(i + 1) / (float)(c + 1));
        }
        scene_bytes b = gltf_glb_of(words, chunk);
        td_gaussians g = splat_parse(gltf_parse, &b);
        for (int i = 0; i < 2; i++) {
            const double mean[3] = {-3, 2, 5 + i}, turn[4] = {i, 0, 0, !i}, opacity = 0.2 * (i + 1);
            const double logit = log(opacity / (1 - opacity)), dc[3] = {i + 1, (i + 1) / 2.0, (i + 1) / 3.0};
            const double linear[3] = {0, log(16384 / 65535.0), log(1 / 65535.0)}, logs[3] = {-1, 16384 / 32767.0, 1 / 32767.0};
            splat_near("mean", g.mean + 3 * i, mean, 3, 0);
            splat_near("quaternion", g.quaternion + 4 * i, turn, 4, 0);
            splat_near("scale", g.log_scale + 3 * i, is_signed ? logs : linear, 3, 1e-6);
            splat_near("opacity", g.opacity_logit + i, &logit, 1, 1e-6);
            splat_near("dc", g.sh + 3 * i, dc, 3, 1e-6);
        }
        td_gaussians_free(&g);
        free(b.data);
    }
}

/* Colour and opacity in COLOR_0, names with a bar: as Cesium's first tiles have them. */
static void early_drafts(void **state) {
    (void)state;
    gltf_recipe r = {.find = "\"KHR_gaussian_splatting:ROTATION\":1,\"KHR_gaussian_splatting:SCALE\":2,"
                             "\"KHR_gaussian_splatting:OPACITY\":3,\"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0\":4",
                     .replacement = "\"_ROTATION\":1,\"_SCALE\":2,\"COLOR_0\":1"};
    scene_bytes chunk = gltf_binary(&r);
    for (size_t i = 0; i < GLTF_COUNT; i++) { /* rotations that can be colours, too */
        static const float numbers[4] = {0.25f, 0.5f, 0.75f, 0.5f};
        uint32_t bits;
        for (size_t c = 0; c < 4; c++) {
            memcpy(&bits, &numbers[c], sizeof bits);
            splat_patch(&chunk, 12 * GLTF_COUNT + 16 * i + 4 * c, bits);
        }
    }
    scene_bytes b = gltf_glb_of(gltf_text(&r, ""), chunk);
    td_gaussians g = splat_parse(gltf_parse, &b);
    for (int i = 0; i < GLTF_COUNT; i++) {
        const double dc[3] = {-0.25 / 0.28209479177387814, 0, 0.25 / 0.28209479177387814}, logit = 0;
        splat_near("dc", g.sh + 3 * i, dc, 3, 1e-6);
        splat_near("opacity", g.opacity_logit + i, &logit, 1, 1e-6);
    }
    td_gaussians_free(&g);
    free(b.data);
}

/* -- places -------------------------------------------------------------------------------------------------------------- */

/* A node's map, and its parent's: the first Gaussian is at (-1, -0.75, -0.5). What isn't in the scene isn't shown. */
static void nodes(void **state) {
    (void)state;
    static const struct {
        const char *nodes;
        double mean[3]; /* of the first Gaussian, in glTF's axes */
        double grown;   /* times */
        int64_t count;
    } cases[] = {
        {"[{\"mesh\":0}]", {-1, -0.75, -0.5}, 1, GLTF_COUNT},
        {"[{\"mesh\":0,\"translation\":[10,20,30]}]", {9, 19.25, 29.5}, 1, GLTF_COUNT},
        {"[{\"mesh\":0,\"scale\":[2,2,2]}]", {-2, -1.5, -1}, 2, GLTF_COUNT},
        {"[{\"mesh\":0,\"matrix\":[0,1,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1]}]", {5.75, 5, 6.5}, 1, GLTF_COUNT},
        {"[{\"children\":[1],\"scale\":[4,4,4],\"translation\":[1,0,0]},{\"mesh\":0,\"rotation\":[0,0,1,1]}]",
         {4 * 0.75 + 1, -4, -2},
         4,
         GLTF_COUNT}, /* a quarter about z, its quaternion of any length */
        {"[{\"mesh\":0,\"children\":[1]},{\"mesh\":0},{\"mesh\":0,\"scale\":[0,0,0]}]", {-1, -0.75, -0.5}, 1, 2 * GLTF_COUNT},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char with[400];
        snprintf(with, sizeof with, "\"nodes\":%s", cases[k].nodes);
        td_gaussians g = parsed(&(gltf_recipe){.find = "\"nodes\":[{\"mesh\":0}]", .replacement = with});
        const double mean[3] = {-cases[k].mean[0], -cases[k].mean[1], cases[k].mean[2]}, scale = log(0.01 * cases[k].grown);
        assert_int_equal(g.count, cases[k].count);
        splat_near(cases[k].nodes, g.mean, mean, 3, 1e-5);
        splat_near(cases[k].nodes, g.log_scale, &scale, 1, 1e-5);
        td_gaussians_free(&g);
    }
}

/* Far from the origin, where single precision has a step of half a unit, nothing is lost. */
static void far_away(void **state) {
    gltf_recipe r = {.find = "{\"mesh\":0}", .replacement = "{\"mesh\":0,\"translation\":[6378137.25,0,0]}"};
    scene_bytes b = gltf_glb(&r);
    scene_file_write(scene_in_folder(*state, "far.glb"), b.data, b.size);
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "far.glb"), NULL, 1);
    const tides_object object = scene_object_of(scene, 0);
    for (int i = 0; i < GLTF_COUNT; i++)
        assert_true(fabs(object.gaussians.origin[0] + (double)object.gaussians.mean[3 * i] + 6378137.25 + gltf_value(0, i, 0)) <
                    1e-6);
    tides_scene_destroy(scene);
    free(b.data);
}

/* -- containers ---------------------------------------------------------------------------------------------------------- */

static char *base64(const scene_bytes *b) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = calloc(b->size / 3 + 2, 4), *to = text;
    assert_non_null(text);
    for (size_t i = 0; i < b->size; i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; k++) word = word << 8 | (i + k < b->size ? (unsigned char)b->data[i + k] : 0u);
        for (size_t k = 0; k < 4; k++) *to++ = i + k <= b->size ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

static void load_and_check(const char *path) {
    char *data = NULL;
    size_t size = 0;
    td_gaussians g;
    tides_error error = {0, ""};
    assert_int_equal(tides_scene_is_file(path), 1);
    data = scene_file_read(path, &size);
    scene_expect_ok(gltf_parse(path, data, size, &g, &error), &error);
    check_turned(&g, 1, 1e-6);
    td_gaussians_free(&g);
    free(data);
}

/* A .glb of any name; a .gltf with its buffer in the text, and beside it. */
static void containers(void **state) {
    const gltf_recipe r = {.degree = 1};
    scene_bytes b = gltf_glb(&r), chunk = gltf_binary(&r);
    char *digits = base64(&chunk), *uri = malloc(strlen(digits) + 100);
    assert_non_null(uri);
    scene_file_write(scene_in_folder(*state, "a.bin"), b.data, b.size);
    load_and_check(scene_in_folder(*state, "a.bin"));
    free(b.data);
    sprintf(uri, "\"uri\":\"data:application/octet-stream;base64,%s\",", digits);
    assert_true(strlen(uri) < GLTF_ROOM / 2);
    b = gltf_text(&r, uri);
    scene_file_write(scene_in_folder(*state, "b.gltf"), b.data, b.size);
    load_and_check(scene_in_folder(*state, "b.gltf"));
    free(b.data);
    b = gltf_text(&r, "\"uri\":\"two%20words.bin\",");
    scene_file_write(scene_in_folder(*state, "c.gltf"), b.data, b.size);
    scene_file_write(scene_in_folder(*state, "two words.bin"), chunk.data, chunk.size);
    load_and_check(scene_in_folder(*state, "c.gltf"));
    scene_file_write(scene_in_folder(*state, "two words.bin"), chunk.data, chunk.size - 1);
    tides_scene *scene = scene_new();
    tides_error error = {0, ""};
    scene_expect_error(tides_scene_add_file(scene, scene_in_folder(*state, "c.gltf"), NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "c.gltf: buffer 0 has 275 bytes, but its byteLength is 276");
    remove(scene_in_folder(*state, "two words.bin"));
    scene_expect_error(tides_scene_add_file(scene, scene_in_folder(*state, "c.gltf"), NULL, 1, &error), TIDES_FILE_NOT_FOUND,
                       &error, "c.gltf: its buffer |two words.bin isn't there");
    tides_scene_destroy(scene);
    free(b.data);
    free(chunk.data);
    free(digits);
    free(uri);
}

/* A .spz in a bufferView is what the .spz by itself is, whatever its draft is called. */
static void compressed(void **state) {
    static const char *const extensions[] =
        {"\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{\"bufferView\":0}}}",
         "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz\":{\"bufferView\":0}}}",
         "\"KHR_spz_gaussian_splats_compression\":{\"bufferView\":0}"};
    td_gaussians made = scene_random(9, 40, 2, SCENE_TRAINED);
    const char *path = scene_in_folder(*state, "a.spz");
    tides_scene *scene = scene_new();
    scene_add(scene, &made, NULL, 1, "a");
    scene_save(scene, path);
    size_t size = 0;
    char *data = scene_file_read(path, &size);
    scene_bytes spz = {0};
    scene_bytes_add(&spz, data, size);
    td_gaussians alone = splat_parse(td_spz_parse, &spz);
    for (size_t k = 0; k < 3; k++) {
        char text[1000];
        scene_bytes json = {0}, chunk = {0};
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{},"
                 "\"extensions\":{%s}}]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu}],\"buffers\":[{\"byteLength\":%zu}"
                 "]}",
                 extensions[k], size, size);
        scene_bytes_add(&json, text, strlen(text));
        scene_bytes_add(&chunk, data, size);
        scene_bytes b = gltf_glb_of(json, chunk);
        td_gaussians g = splat_parse(gltf_parse, &b);
        const tides_gaussians view = td_gaussians_view(&alone);
        assert_true(scene_same(&g, &view));
        td_gaussians_free(&g);
        free(b.data);
    }
    tides_scene_destroy(scene);
    td_gaussians_free(&made);
    td_gaussians_free(&alone);
    free(spz.data);
    free(data);
}

/* -- writing ------------------------------------------------------------------------------------------------------------- */

static void written(void **state) {
    for (int degree = 0; degree <= 3; degree++) {
        td_gaussians g = scene_random(11 + (uint64_t)degree, 50, degree, SCENE_TRAINED);
        tides_scene *scene = scene_new(), *again = scene_new();
        const char *path = scene_in_folder(*state, "a.glb");
        scene_add(scene, &g, NULL, 2, "a");
        scene_save(scene, path);
        scene_load(again, path, NULL, 1);
        const tides_object object = scene_object_of(again, 0);
        const tides_gaussians *r = &object.gaussians;
        const size_t wide = 3 * td_sh_coefficients(degree);
        assert_int_equal(r->count, 50);
        assert_memory_equal(r->sh, g.sh, 50 * wide * sizeof(float));
        for (int i = 0; i < 50; i++) {
            double dot = 0, square = 0;
            for (int c = 0; c < 3; c++) {
                const double mean = 2 * (double)g.mean[3 * i + c], scale = (double)g.log_scale[3 * i + c] + log(2);
                splat_near("mean", r->mean + 3 * i + c, &mean, 1, 0);
                splat_near("scale", r->log_scale + 3 * i + c, &scale, 1, 1e-6);
            }
            for (int c = 0; c < 4; c++) {
                dot += (double)r->quaternion[4 * i + c] * (double)g.quaternion[4 * i + c];
                square += (double)g.quaternion[4 * i + c] * (double)g.quaternion[4 * i + c];
            }
            assert_true(fabs(fabs(dot) / sqrt(square) - 1) < 1e-6);
            const double logit = (double)g.opacity_logit[i], step = 0x1p-24 * (2 + exp(fabs(logit)));
            splat_near("opacity", r->opacity_logit + i, &logit, 1, step);
        }
        tides_scene_destroy(scene);
        tides_scene_destroy(again);
        td_gaussians_free(&g);
    }
    td_gaussians g = scene_random(5, 4, 4, SCENE_TRAINED);
    tides_scene *scene = scene_new();
    tides_error error = {0, ""};
    scene_add(scene, &g, NULL, 1, "a");
    scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, "b.glb"), &error), TIDES_UNSUPPORTED, &error,
                       "b.glb: glTF holds SH up to degree 3");
    scene_add(scene, &g, NULL, 1, "b");
    scene_expect_error(tides_scene_save(scene, scene_in_folder(*state, "b.glb"), &error), TIDES_UNSUPPORTED, &error,
                       "a .glb holds one object");
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values), cmocka_unit_test(quantised), cmocka_unit_test(early_drafts), cmocka_unit_test(nodes),
        IN_FOLDER(far_away),      IN_FOLDER(containers),       IN_FOLDER(compressed),          IN_FOLDER(written),
    };
    return cmocka_run_group_tests_name("scene_gltf", tests, NULL, NULL);
}
