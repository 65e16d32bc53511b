/* Reading PLY scenes: every encoding, type, order and degree, made by the test itself; mip-splatting's filter; every way
 * of being wrong, with its message; real files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/npz.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/shared.h"

#include <locale.h>
#include <math.h>

/* Parses from memory that ends where the file does, so that a sanitizer sees each byte read beyond it. */
static tides_status parse(const scene_bytes *bytes, td_gaussians *g, tides_error *error) {
    char *exact = malloc(bytes->size ? bytes->size : 1);
    assert_non_null(exact);
    memcpy(exact, bytes->data, bytes->size);
    tides_status status = td_ply_parse("t.ply", exact, bytes->size, g, error);
    free(exact);
    return status;
}

static void check_recipe(const td_gaussians *g, const scene_recipe *recipe) {
    tides_error error = {0, ""};
    td_gaussians read;
    scene_bytes bytes = scene_ply(g, recipe);
    tides_status status = parse(&bytes, &read, &error);
    tides_gaussians view = td_gaussians_view(&read);
    if (status || !scene_same(g, &view))
        fail_msg("format %d type %d mixed %d shuffle %d extras %d crlf %d seed %llu: %s", recipe->format, recipe->type,
                 recipe->mixed, recipe->shuffle, recipe->extras, recipe->crlf, (unsigned long long)recipe->seed,
                 status ? error.text : "other values");
    td_gaussians_free(&read);
    free(bytes.data);
}

static void test_types_and_encodings(void **state) {
    (void)state;
    td_gaussians g = scene_random(1, 7, 1, SCENE_SMALL_INTEGERS);
    for (int format = SCENE_ASCII; format <= SCENE_BIG; format++)
        for (int type = 0; type < SCENE_TYPES; type++)
            for (int sized = 0; sized < 2; sized++)
                check_recipe(&g, &(scene_recipe){.format = format, .type = type, .sized_names = sized});
    td_gaussians_free(&g);
}

static void test_negative_integers(void **state) {
    (void)state;
    td_gaussians g = scene_random(2, 7, 1, SCENE_SMALL_INTEGERS);
    for (size_t i = 0; i < 21; i++) g.mean[i] = -g.mean[i] - 1;
    for (int format = SCENE_ASCII; format <= SCENE_BIG; format++)
        for (int type = 0; type < SCENE_TYPES; type += type < 4 ? 2 : 1)
            if (type != 5) check_recipe(&g, &(scene_recipe){.format = format, .type = type});
    td_gaussians_free(&g);
}

static void test_degrees_keep_every_bit(void **state) {
    (void)state;
    for (int32_t degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        td_gaussians g = scene_random(10 + (uint64_t)degree, 11, degree, SCENE_TRAINED);
        for (int format = SCENE_ASCII; format <= SCENE_BIG; format++)
            for (int type = SCENE_FLOAT; type <= SCENE_DOUBLE; type++)
                check_recipe(&g, &(scene_recipe){.format = format, .type = type, .shuffle = 1, .extras = 1, .seed = 5});
        td_gaussians_free(&g);
    }
}

static void test_random_recipes(void **state) {
    (void)state;
    for (uint64_t seed = 100; seed < 200; seed++) {
        uint64_t choice = seed;
        uint64_t bits = scene_next(&choice);
        td_gaussians g = scene_random(seed, 1 + (int64_t)(bits % 5), (int32_t)(bits >> 8) % 5 & 3, SCENE_SMALL_INTEGERS);
        check_recipe(&g, &(scene_recipe){.format = (int)(bits >> 16 & 0xff) % 3,
                                         .mixed = 1,
                                         .sized_names = (int)(bits >> 24 & 1),
                                         .shuffle = (int)(bits >> 25 & 1),
                                         .extras = (int)(bits >> 26 & 1),
                                         .crlf = (int)(bits >> 27 & 1),
                                         .seed = seed});
        td_gaussians_free(&g);
    }
}

/* The order of f_rest in the file, spelt out once by hand. */
static void test_sh_order(void **state) {
    (void)state;
    td_gaussians g = scene_random(3, 1, 1, SCENE_TRAINED), read;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++) g.sh[3 * k + c] = (float)(10 * k + c);
    scene_bytes bytes = scene_ply(&g, &(scene_recipe){.type = SCENE_FLOAT});
    const char *row = strstr(bytes.data, "end_header\n");
    assert_non_null(strstr(row, " 0 1 2 10 20 30 11 21 31 12 22 32 ")); /* dc r g b, then r's coefficients, g's, b's */
    tides_error error;
    scene_expect_ok(parse(&bytes, &read, &error), &error);
    assert_true(read.sh[3 * 2 + 1] == 21.0f);
    td_gaussians_free(&read);
    td_gaussians_free(&g);
    free(bytes.data);
}

/* strtod under a locale with decimal commas would read 0.5 as 0. */
static void test_decimal_comma(void **state) {
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8") && !setlocale(LC_NUMERIC, "fr_FR.UTF-8")) skip();
    td_gaussians g = scene_random(4, 3, 0, SCENE_TRAINED), read;
    setlocale(LC_NUMERIC, "C");
    scene_bytes bytes = scene_ply(&g, &(scene_recipe){.type = SCENE_FLOAT});
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8")) setlocale(LC_NUMERIC, "fr_FR.UTF-8");
    tides_error error;
    tides_status status = parse(&bytes, &read, &error);
    setlocale(LC_NUMERIC, "C");
    scene_expect_ok(status, &error);
    tides_gaussians view = td_gaussians_view(&read);
    assert_true(scene_same(&g, &view));
    td_gaussians_free(&read);
    td_gaussians_free(&g);
    free(bytes.data);
}

/* Against the formula as it is written, in opacities and scales instead of logarithms. */
static void test_filter(void **state) {
    (void)state;
    td_gaussians g = scene_random(5, 50, 0, SCENE_TRAINED), read;
    float filter[50];
    for (size_t i = 0; i < 50; i++) filter[i] = i ? 0.02f * (float)i : 0.0f;
    scene_bytes bytes = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT, .filter = filter});
    tides_error error;
    scene_expect_ok(parse(&bytes, &read, &error), &error);
    for (size_t i = 0; i < 50; i++) {
        double f = filter[i], before = 1, after = 1;
        for (size_t axis = 0; axis < 3; axis++) {
            double s = exp((double)g.log_scale[3 * i + axis]), grown = sqrt(s * s + f * f);
            assert_true(fabs(exp((double)read.log_scale[3 * i + axis]) - grown) <= 1e-6 * grown);
            before *= s * s;
            after *= grown * grown;
        }
        double opacity = 1 / (1 + exp(-(double)g.opacity_logit[i])) * sqrt(before / after);
        assert_true(fabs(1 / (1 + exp(-(double)read.opacity_logit[i])) - opacity) <= 1e-6 * opacity);
    }
    assert_memory_equal(g.log_scale, read.log_scale, 3 * sizeof(float)); /* a filter of 0 keeps the bits */
    assert_memory_equal(g.opacity_logit, read.opacity_logit, sizeof(float));
    td_gaussians_free(&read);
    td_gaussians_free(&g);
    free(bytes.data);
}

/* Extreme logits and scales: neither overflow nor cancellation. */
static void test_filter_extremes(void **state) {
    (void)state;
    td_gaussians g;
    assert_int_equal(td_gaussians_create(&g, 4, 0, NULL), TIDES_OK);
    const float logits[] = {1000, -1000, 1000, 40}, scales[] = {-200, -200, 80, 0}, filter[] = {1, 1, 1, 1e-30f};
    for (size_t i = 0; i < 4; i++) {
        g.opacity_logit[i] = logits[i];
        for (size_t axis = 0; axis < 3; axis++) g.log_scale[3 * i + axis] = scales[i];
    }
    td_gaussians_fold_filter(&g, filter);
    for (size_t i = 0; i < 4; i++) assert_true(isfinite(g.opacity_logit[i]) && isfinite(g.log_scale[3 * i]));
    assert_true(fabsf(g.opacity_logit[0] + 600) < 1e-3f);  /* opacity 1, mass e^-600 spread over size 1 */
    assert_true(fabsf(g.opacity_logit[1] + 1600) < 1e-3f); /* and e^-1000 of that */
    assert_true(g.opacity_logit[2] > 150);
    assert_true(g.log_scale[6] == 80);
    assert_true(g.opacity_logit[3] == 40);
    td_gaussians_free(&g);
}

/* -- what is refused -- */

static const char valid[] = "ply\n"
                            "format ascii 1.0\n"
                            "element vertex 2\n"
                            "property float x\nproperty float y\nproperty float z\n"
                            "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n"
                            "property float opacity\n"
                            "property float scale_0\nproperty float scale_1\nproperty float scale_2\n"
                            "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
                            "end_header\n"
                            "1 2 3 0 0 0 0 -1 -1 -1 1 0 0 0\n"
                            "4 5 6 0 0 0 0 -2 -2 -2 1 0 0 0\n";

/* `valid` with its first `find` replaced. */
static scene_bytes edited(const char *find, const char *replacement) {
    const char *at = strstr(valid, find);
    assert_non_null(at);
    scene_bytes bytes = {0};
    scene_bytes_add(&bytes, valid, (size_t)(at - valid));
    scene_bytes_add(&bytes, replacement, strlen(replacement));
    scene_bytes_add(&bytes, at + strlen(find), strlen(at + strlen(find)));
    return bytes;
}

/* `find` is replaced in `valid`; the message must hold each part of `expected`. */
static const struct {
    const char *find, *replacement;
    tides_status status;
    const char *expected;
} refusals[] = {
    {valid, "", TIDES_BAD_FILE, "empty"},
    {"ply\n", "", TIDES_BAD_FILE, "line 1|should be 'ply'|format ascii"},
    {"ply\n", "ply", TIDES_BAD_FILE, "line 1|should be 'ply'"},
    {"format ascii 1.0\n", "", TIDES_BAD_FILE, "line 17|no format line"},
    {"format ascii 1.0\n", "format ascii 1.0\nformat ascii 1.0\n", TIDES_BAD_FILE, "line 3|second format"},
    {"format ascii 1.0", "format ascii", TIDES_BAD_FILE, "line 2|format ENCODING 1.0"},
    {"ascii 1.0", "ascii 2.0", TIDES_BAD_FILE, "line 2|1.0|'2.0'"},
    {"ascii", "binary_middle_endian", TIDES_BAD_FILE, "line 2|binary_middle_endian|binary_little_endian"},
    {"vertex 2", "vertex", TIDES_BAD_FILE, "line 3|element NAME COUNT"},
    {"vertex 2", "vertex -2", TIDES_BAD_FILE, "line 3|'-2'"},
    {"vertex 2", "vertex 2.5", TIDES_BAD_FILE, "line 3|'2.5'"},
    {"vertex 2", "vertex 0x2", TIDES_BAD_FILE, "line 3|'0x2'"},
    {"vertex 2", "vertex 18446744073709551616", TIDES_BAD_FILE, "line 3|18446744073709551616"},
    {"vertex 2", "vertex 18446744073709551615", TIDES_BAD_FILE, "line 3|18446744073709551615 rows|truncated"},
    {"vertex 2", "vertex 9223372036854775808", TIDES_BAD_FILE, "line 3|9223372036854775808 rows"},
    {"vertex 2", "vertex 1000000000", TIDES_BAD_FILE, "line 3|1000000000 rows|62 bytes are left|byte 351"},
    {"vertex 2", "vertex 0", TIDES_BAD_FILE, "line 3|0 rows"},
    {"vertex 2", "vertex 3", TIDES_BAD_FILE, "3 rows|left"},
    {"vertex 2", "vertices 2", TIDES_BAD_FILE, "no element vertex"},
    {"vertex 2\n", "vertex 2\nelement vertex 2\n", TIDES_BAD_FILE, "line 4|second element|vertex"},
    {"element vertex 2\n", "", TIDES_BAD_FILE, "line 3|before any element"},
    {"float x", "uint packed_position", TIDES_BAD_FILE, "compressed PLY|binary_little_endian"},
    {"float x", "float trbf_center", TIDES_UNSUPPORTED, "SpacetimeGaussians"},
    {"float x", "float scale_t", TIDES_UNSUPPORTED, "4-D Gaussians"},
    {"float x", "float motion_xyz_0_0", TIDES_UNSUPPORTED, "Ex4DGS"},
    {"float x", "half x", TIDES_BAD_FILE, "line 4|unknown type|'half'"},
    {"float x", "float", TIDES_BAD_FILE, "line 4|property TYPE NAME"},
    {"float x", "list float float x", TIDES_BAD_FILE, "line 4|integer type|'float'"},
    {"float x", "list uchar x", TIDES_BAD_FILE, "line 4|property list"},
    {"float x", "list uchar float x", TIDES_BAD_FILE, "property x|list"},
    {"float x", "float y", TIDES_BAD_FILE, "no property x"},
    {"float x", "float x\nproperty float x", TIDES_BAD_FILE, "two properties x"},
    {"float opacity", "float opacities", TIDES_BAD_FILE, "line 3|no property opacity"},
    {"float f_dc_1", "float g", TIDES_BAD_FILE, "no property f_dc_1"},
    {"float scale_2", "float g", TIDES_UNSUPPORTED, "2-D Gaussians|2DGS"},
    {"float rot_3", "float g", TIDES_BAD_FILE, "no property rot_3"},
    {"float opacity", "float opacity\nproperty float f_rest_0", TIDES_BAD_FILE, "1 f_rest|0, 9, 24, 45 or 72"},
    {"end_header\n", "", TIDES_BAD_FILE, "line 18|end_header|1 2 3"},
    {"end_header\n", "\xff\x01 rubbish\x7f\n", TIDES_BAD_FILE, "line 18|'?? rubbish?'"},
    {"end_header\n1 2 3 0 0 0 0 -1 -1 -1 1 0 0 0\n4 5 6 0 0 0 0 -2 -2 -2 1 0 0 0\n", "", TIDES_BAD_FILE,
     "breaks off|without an end_header"},
    {"end_header\n1 2 3 0 0 0 0 -1 -1 -1 1 0 0 0\n4 5 6 0 0 0 0 -2 -2 -2 1 0 0 0\n", "end_header", TIDES_BAD_FILE,
     "breaks off in line 18"},
    {"1 2 3 0 0", "1 2 3 0", TIDES_BAD_FILE, "line 19|ends before property rot_3, number 14 of 14"},
    {"1 2 3", "1 2 3 4", TIDES_BAD_FILE, "line 19|more values than the 14"},
    {"4 5 6", "4 five 6", TIDES_BAD_FILE, "line 20|property y is 'five'"},
    {"4 5 6", "4 5, 6", TIDES_BAD_FILE, "line 20|property y is '5,'"},
    {"\n4 5 6 0 0 0 0 -2 -2 -2 1 0 0 0\n", "                                        \n", TIDES_BAD_FILE, "row 1 of 2|byte"},
    {"element vertex 2\n", "element a 1\nproperty list char char b\nelement vertex 2\n", TIDES_BAD_FILE, "line 21|more values"},
};

static void test_refusals(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        td_gaussians g;
        memset(&g, 0x5a, sizeof g);
        td_gaussians untouched = g;
        tides_error error = {0, ""};
        scene_bytes bytes = edited(refusals[i].find, refusals[i].replacement);
        scene_expect_error(parse(&bytes, &g, &error), refusals[i].status, &error, refusals[i].expected);
        scene_expect_error(error.status, refusals[i].status, &error, "t.ply");
        assert_memory_equal(&g, &untouched, sizeof g);
        assert_int_equal(parse(&bytes, &g, NULL), refusals[i].status); /* the error is nullable */
        free(bytes.data);
    }
}

/* Rows without bytes fit any file, however many: what is missing must be found before memory is asked for. */
static void test_no_properties(void **state) {
    (void)state;
    static const char text[] = "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000000\nend_header\n";
    scene_bytes bytes = {0};
    scene_bytes_add(&bytes, text, sizeof text - 1);
    tides_error error = {0, ""};
    td_gaussians g;
    scene_expect_error(parse(&bytes, &g, &error), TIDES_BAD_FILE, &error, "line 3|no property x among its 0");
    free(bytes.data);
}

static void test_bad_lists(void **state) {
    (void)state;
    static const char *const lists[] = {"-1", "1.5", "nan", "9999999999"};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        scene_bytes bytes = edited("element vertex 2\n", "element a 1\nproperty list char char b\nelement vertex 2\n");
        char row[64], *at = strstr(bytes.data, "end_header\n") + strlen("end_header\n");
        int length = snprintf(row, sizeof row, "%s\n", lists[i]);
        scene_bytes whole = {0};
        scene_bytes_add(&whole, bytes.data, (size_t)(at - bytes.data));
        scene_bytes_add(&whole, row, (size_t)length);
        scene_bytes_add(&whole, at, strlen(at));
        tides_error error = {0, ""};
        td_gaussians g;
        scene_expect_error(parse(&whole, &g, &error), TIDES_BAD_FILE, &error, "line 21|list b has");
        free(whole.data);
        free(bytes.data);
    }
    /* binary: -1 entries, and more than the file has */
    static const char header[] =
        "ply\nformat binary_big_endian 1.0\nelement a 1\nproperty list char char b\nelement vertex 1\n";
    for (int longer = 0; longer < 2; longer++) {
        scene_bytes bytes = {0};
        scene_bytes_add(&bytes, header, sizeof header - 1);
        const char *rest = strchr(strstr(valid, "element vertex"), '\n') + 1, *end = strstr(valid, "end_header\n") + 11;
        scene_bytes_add(&bytes, rest, (size_t)(end - rest));
        char payload[1 + 14 * 4] = {longer ? 120 : -1};
        scene_bytes_add(&bytes, payload, sizeof payload);
        tides_error error = {0, ""};
        td_gaussians g;
        scene_expect_error(parse(&bytes, &g, &error), TIDES_BAD_FILE, &error,
                           longer ? "ends at byte|element a (property b)" : "list b of row 0 has -1");
        free(bytes.data);
    }
}

/* Every prefix of a valid file is refused with one line: none crashes, none is taken for whole. */
static void test_every_truncation(void **state) {
    (void)state;
    td_gaussians g = scene_random(6, 2, 1, SCENE_TRAINED), read;
    for (int format = SCENE_LITTLE; format <= SCENE_BIG; format++) {
        scene_bytes bytes = scene_ply(&g, &(scene_recipe){.format = format, .type = SCENE_FLOAT, .extras = 1, .seed = 9});
        for (size_t size = 0; size < bytes.size; size++) {
            scene_bytes prefix = {bytes.data, size, 0};
            tides_error error = {0, ""};
            scene_expect_error(parse(&prefix, &read, &error), TIDES_BAD_FILE, &error, "t.ply");
        }
        free(bytes.data);
    }
    td_gaussians_free(&g);
}

static void test_bad_filter(void **state) {
    (void)state;
    td_gaussians g = scene_random(7, 3, 0, SCENE_TRAINED), read;
    const float filter[] = {0, NAN, 1};
    scene_bytes bytes = scene_ply(&g, &(scene_recipe){.format = SCENE_BIG, .type = SCENE_FLOAT, .filter = filter});
    tides_error error = {0, ""};
    scene_expect_error(parse(&bytes, &read, &error), TIDES_BAD_FILE, &error, "Gaussian 1|filter_3D");
    free(bytes.data);
    td_gaussians_free(&g);
}

/* -- real files -- */

/* The rows of an INRIA file, with the normals (floats 3 to 5), which are not kept, made 0. Points into `bytes`. */
static char *rows_without_normals(char *bytes, size_t size, int64_t count, size_t *row_bytes) {
    char *rows = strstr(bytes, "end_header\n");
    assert_non_null(rows);
    rows += strlen("end_header\n");
    *row_bytes = (size - (size_t)(rows - bytes)) / (size_t)count;
    for (size_t i = 0; i < (size_t)count; i++) memset(rows + i * *row_bytes + 12, 0, 12);
    return rows;
}

/* Read and written again, a file keeps every bit. */
static void check_real(const char *relative, int64_t count, int32_t degree, void *folder) {
    char path[4096];
    if (shared_path(path, sizeof path, relative)) skip();
    tides_error error = {0, ""};
    tides_scene *scene = NULL;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_count(scene), count);
    assert_int_equal(tides_scene_sh_degree(scene), degree);
    const char *copy = scene_in_folder(folder, "copy.ply");
    scene_expect_ok(tides_scene_save(scene, copy, &error), &error);
    size_t size, copy_size, row, copy_row;
    char *bytes = scene_file_read(path, &size), *copy_bytes = scene_file_read(copy, &copy_size);
    const char *rows = rows_without_normals(bytes, size, count, &row);
    const char *copy_rows = rows_without_normals(copy_bytes, copy_size, count, &copy_row);
    assert_int_equal(row, copy_row);
    assert_memory_equal(rows, copy_rows, row * (size_t)count);
    free(bytes);
    free(copy_bytes);
    tides_scene_destroy(scene);
}

static void test_guitar(void **state) { check_real("data/playcanvas/guitar_20k_inria_sh0.ply", 20000, 0, *state); }
static void test_playbot(void **state) { check_real("data/playcanvas/playbot_lod5_inria_sh2.ply", 3000, 2, *state); }
static void test_train(void **state) { check_real("data/formats/test-splat.3-points-from-train.ply", 3, 3, *state); }

/* The same splats as another project's decoder gave them: in particular, coefficient and channel of each f_rest. */
static void test_playbot_values(void **state) {
    (void)state;
    char path[4096], golden[4096];
    if (shared_path(path, sizeof path, "data/playcanvas/playbot_lod5_inria_sh2.ply")) skip();
    if (shared_path(golden, sizeof golden, "golden/formats/sog_playbot5.npz")) skip();
    npz *file = npz_open(golden);
    assert_non_null(file);
    tides_error error;
    tides_scene *scene = NULL;
    tides_object object;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    scene_expect_ok(tides_scene_object(scene, 0, &object, &error), &error);
    assert_string_equal(object.name, "playbot_lod5_inria_sh2");
    assert_string_equal(object.source, path);
    const tides_gaussians *g = &object.gaussians;
    const struct {
        const char *name;
        const float *values;
        size_t width, stride; /* per Gaussian: in the golden file, in ours */
    } arrays[] = {{"xyz", g->mean, 3, 3},
                  {"log_scale", g->log_scale, 3, 3},
                  {"quat_wxyz", g->quaternion, 4, 4},
                  {"opacity_logit", g->opacity_logit, 1, 1},
                  {"f_dc", g->sh, 3, 27},
                  {"f_rest_coef", g->sh + 3, 24, 27}};
    for (size_t a = 0; a < sizeof arrays / sizeof arrays[0]; a++) {
        size_t count = 0;
        double *expected = npz_doubles(file, arrays[a].name, &count);
        assert_non_null(expected);
        assert_true(count > 0);
        assert_true(count % arrays[a].width == 0);
        assert_true(count / arrays[a].width <= 3000);
        for (size_t i = 0; i < count; i++) {
            double value = arrays[a].values[i / arrays[a].width * arrays[a].stride + i % arrays[a].width];
            if (fabs(value - expected[i]) > 1e-5 * (1 + fabs(expected[i])))
                fail_msg("%s[%zu] is %.9g, expected %.9g", arrays[a].name, i, value, expected[i]);
        }
        free(expected);
    }
    npz_close(file);
    tides_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types_and_encodings),
        cmocka_unit_test(test_negative_integers),
        cmocka_unit_test(test_degrees_keep_every_bit),
        cmocka_unit_test(test_random_recipes),
        cmocka_unit_test(test_sh_order),
        cmocka_unit_test(test_decimal_comma),
        cmocka_unit_test(test_filter),
        cmocka_unit_test(test_filter_extremes),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_no_properties),
        cmocka_unit_test(test_bad_lists),
        cmocka_unit_test(test_every_truncation),
        cmocka_unit_test(test_bad_filter),
        cmocka_unit_test_setup_teardown(test_guitar, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_playbot, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_train, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_playbot_values),
    };
    return cmocka_run_group_tests_name("scene_ply", tests, NULL, NULL);
}
