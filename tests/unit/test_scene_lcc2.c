/* LCC2 scenes made by the test: a tree whose nodes share files, whose branches end early, with an environment; what each level
 * holds, in the axes of a 3DGS .ply, from files of each kind; names of early files; and every way of being wrong. */
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
#include "tides/inputs.h"

#include <math.h>
#include <sys/stat.h>
#include <webp/encode.h>

/* Three levels. Files: 0 is level 2 (rows 0 to 2 are A's, 3 and 4 are B's), 1 is level 1 (A's), 2 level 0 (rows 0, 1 and 2 to 5
 * of two nodes), 3 the environment. B ends at level 2. */
#define NODE(file, start, count, rest) \
    "{\"data\":{\"3dgs\":{\"name\":" #file ",\"start\":" #start ",\"count\":" #count "}}" rest "}"
#define FINEST "\"child\":{\"0\":" NODE(2, 2, 4, "") ",\"1\":" NODE(2, 0, 2, "") "}"
#define TREE \
    "\"child\":[" NODE(0, 0, 3, ",\"child\":{\"0\":" NODE(1, 0, 3, "," FINEST) "}") "," NODE(0, 3, 2, ",\"childNum\":0") "]"
#define ROOT(names, environment) "\"root\":{\"splatFiles\":[" names "],\"data\":" environment "," TREE "}}"
#define FOUR(e) "\"3dgs/0" e "\",\"3dgs/1" e "\",\"3dgs/2" e "\",\"3dgs/3" e "\""

enum { FILES = 4 };
static const int64_t counts[FILES] = {5, 3, 6, 2};

static const char plain[] =
    "{\"version\":\"0.0.3\",\"totalLevels\":3,\"splatType\":\".ply\"," ROOT(FOUR(".ply"), "{\"env\":{\"name\":3}}");

static td_gaussians content(int file) { return scene_random(50 + (uint64_t)file, counts[file], 1, SCENE_TRAINED); }

static void put(void **state, const char *name, const scene_bytes *b) {
    scene_file_write(scene_in_folder(*state, name), b->data, b->size);
}

static void make_scene(void **state, const char *meta) {
    mkdir(scene_in_folder(*state, "3dgs"), 0700);
    scene_file_write(scene_in_folder(*state, "a.lcc2"), meta, strlen(meta));
    for (int i = 0; i < FILES; i++) {
        td_gaussians g = content(i);
        const scene_recipe recipe = {.format = SCENE_LITTLE, .type = SCENE_FLOAT};
        scene_bytes bytes = scene_ply(&g, &recipe);
        char name[16];
        snprintf(name, sizeof name, "3dgs/%d.ply", i);
        put(state, name, &bytes);
        free(bytes.data);
        td_gaussians_free(&g);
    }
}

static tides_status read_part(void **state, const char *part, tides_scene *scene, tides_error *error) {
    tides_scene_options how;
    tides_scene_options_defaults(&how);
    how.part = part;
    return tides_scene_read(scene, scene_in_folder(*state, "a.lcc2"), &how, NULL, 1, error);
}

static void near(const char *what, double got, double wanted) {
    if (!(fabs(got - wanted) <= 2e-6 * (1 + fabs(wanted)))) fail_msg("%s: %.9g, not %.9g", what, got, wanted);
}

/* z, which is up, becomes -y, and the rotation is preceded by that quarter turn about x. */
static void check_turned(const tides_gaussians *g, size_t row, const float mean[3], const float q[4]) {
    const double h = sqrt(0.5), length = sqrt((double)(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]));
    const double wanted[4] = {h * (double)(q[0] - q[1]), h * (double)(q[0] + q[1]), h * (double)(q[2] - q[3]),
                              h * (double)(q[2] + q[3])};
    const float *own = g->quaternion + 4 * row;
    double dot = 0, norm = 0;
    near("x", (double)g->mean[3 * row], (double)mean[0]);
    near("y", (double)g->mean[3 * row + 1], -(double)mean[2]);
    near("z", (double)g->mean[3 * row + 2], (double)mean[1]);
    for (int k = 0; k < 4; k++) {
        dot += wanted[k] * (double)own[k];
        norm += (double)own[k] * (double)own[k];
    }
    near("rotation", fabs(dot), length * sqrt(norm));
}

static void check_row(const tides_gaussians *g, size_t row, int file, size_t from) {
    td_gaussians source = content(file);
    check_turned(g, row, source.mean + 3 * from, source.quaternion + 4 * from);
    near("opacity", (double)g->opacity_logit[row], (double)source.opacity_logit[from]);
    for (size_t k = 0; k < 3; k++) {
        near("scale", (double)g->log_scale[3 * row + k], (double)source.log_scale[3 * from + k]);
        near("colour", (double)g->sh[12 * row + k], (double)source.sh[12 * from + k]);
        /* Band 1 is -c1 y + c2 z - c3 x; with y = z' and z = -y' that is c1' = c2, c2' = -c1, c3' = c3. */
        near("c1", (double)g->sh[12 * row + 3 + k], (double)source.sh[12 * from + 6 + k]);
        near("c2", (double)g->sh[12 * row + 6 + k], -(double)source.sh[12 * from + 3 + k]);
    }
    td_gaussians_free(&source);
}

/* What is read of which file at each level, the early end of B and the environment among it. */
static void levels(void **state) {
    static const struct {
        const char *part;
        size_t count;
        int file[16], row[16];
    } wanted[] = {{NULL, 10, {0, 0, 2, 2, 2, 2, 2, 2, 3, 3}, {3, 4, 0, 1, 2, 3, 4, 5, 0, 1}},
                  {"1", 7, {0, 0, 1, 1, 1, 3, 3}, {3, 4, 0, 1, 2, 0, 1}},
                  {"2", 7, {0, 0, 0, 0, 0, 3, 3}, {0, 1, 2, 3, 4, 0, 1}}};
    make_scene(state, plain);
    for (size_t level = 0; level < 3; level++) {
        tides_scene *scene = scene_new();
        tides_error error = {0, ""};
        double up[3];
        scene_expect_ok(read_part(state, wanted[level].part, scene, &error), &error);
        const tides_object object = scene_object_of(scene, 0);
        assert_int_equal(object.gaussians.count, wanted[level].count);
        for (size_t i = 0; i < wanted[level].count; i++)
            check_row(&object.gaussians, i, wanted[level].file[i], (size_t)wanted[level].row[i]);
        assert_int_equal(tides_scene_up(scene, up), 1);
        assert_true(up[0] == 0 && up[1] == -1 && up[2] == 0);
        assert_non_null(strstr(tides_scene_notes(scene), "level of detail"));
        tides_scene_destroy(scene);
    }
}

/* A .spz of version 3 without gzip: its numbers are in LCC's axes. */
static void spz_files(void **state) {
    static const int raw[2][3] = {{4096, -8192, 2048}, {-1024, 512, 12288}}; /* of 2^-12 */
    /* What the file holds, a quarter turn about y, after half a turn about x, which leaves an ellipsoid as it is. */
    static const float q[4] = {0, 0.70710678f, 0, -0.70710678f};
    scene_bytes b = {0};
    splat_u32(&b, 0x5053474e);
    splat_u32(&b, 3);
    splat_u32(&b, 2);
    splat_u32(&b, 12u << 8);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            for (int byte = 0; byte < 3; byte++) splat_u8(&b, (unsigned)raw[i][k] >> 8 * byte & 255);
    for (int i = 0; i < 2 + 6 + 6; i++) splat_u8(&b, 128);
    for (int i = 0; i < 2; i++) splat_u32(&b, 3u << 30 | 511u << 10); /* w is left out; x, y, z by ten bits, y the largest */
    mkdir(scene_in_folder(*state, "3dgs"), 0700);
    put(state, "3dgs/0.spz", &b);
    free(b.data);
    const char meta[] = "{\"totalLevels\":1,\"splatType\":\".spz\",\"root\":{\"splatFiles\":[\"3dgs/0.spz\"],\"data\":null,"
                        "\"child\":{\"0\":{\"data\":{\"3dgs\":{\"name\":0}}}}}}";
    scene_file_write(scene_in_folder(*state, "a.lcc2"), meta, strlen(meta));
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "a.lcc2"), NULL, 1);
    const tides_object object = scene_object_of(scene, 0);
    assert_int_equal(object.gaussians.count, 2);
    for (size_t i = 0; i < 2; i++) {
        const float mean[3] = {(float)raw[i][0] / 4096, (float)raw[i][1] / 4096, (float)raw[i][2] / 4096};
        check_turned(&object.gaussians, i, mean, q);
    }
    tides_scene_destroy(scene);
}

/* A .sog of one Gaussian at (e - 1, 1 - e, e^2 - 1), which early files name without its ending; and commas that end nothing. */
static void sog_files(void **state) {
    static const char meta[] =
        "{\"version\":2,\"count\":1,\"means\":{\"mins\":[1,-1,2],\"maxs\":[1,-1,2],\"files\":[\"m\",\"m\"]},"
        "\"scales\":{\"codebook\":[%s],\"files\":[\"m\"]},\"quats\":{\"files\":[\"m\"]},\"sh0\":{"
        "\"codebook\":[%s],\"files\":[\"m\"]}}";
    static const char early[] =
        "{\"total_splats\":1,\"lod_3dgs_info\":[1,],\"lod_level\":1,\"root\":{\"files\":[\"/3dgs/a,}\",],"
        "\"child_num\":1,\"child\":[{\"data\":{\"3dgs\":{\"name\":0,\"start\":0,\"count\":1}},},]}}";
    const unsigned char pixel[4] = {128, 128, 128, 252};
    char book[1024] = "0", text[4096];
    for (int i = 1; i < 256; i++) memcpy(book + 2 * i - 1, ",0", 3);
    snprintf(text, sizeof text, meta, book, book);
    uint8_t *data = NULL;
    const size_t size = WebPEncodeLosslessRGBA(pixel, 1, 1, 4, &data);
    splat_zip zip = {{0}, {0}, 0};
    splat_zip_add(&zip, "meta.json", text, strlen(text));
    splat_zip_add(&zip, "m", data, size);
    WebPFree(data);
    scene_bytes b = splat_zip_end(&zip);
    mkdir(scene_in_folder(*state, "3dgs"), 0700);
    put(state, "3dgs/a,}.sog", &b);
    free(b.data);
    scene_file_write(scene_in_folder(*state, "a.lcc2"), early, strlen(early));
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "a.lcc2"), NULL, 1);
    const tides_object object = scene_object_of(scene, 0);
    near("x", (double)object.gaussians.mean[0], exp(1) - 1);
    near("y", (double)object.gaussians.mean[1], 1 - exp(2));
    near("z", (double)object.gaussians.mean[2], 1 - exp(1));
    tides_scene_destroy(scene);
}

/* A scene without its environment is one, and says so; so does one of another version. */
static void notes(void **state) {
    make_scene(state,
               "{\"version\":\"1.2\",\"totalLevels\":3,\"splatType\":\".ply\"," ROOT(FOUR(".ply"), "{\"env\":{\"name\":3}}"));
    remove(scene_in_folder(*state, "3dgs/3.ply"));
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "a.lcc2"), NULL, 1);
    assert_int_equal(scene_object_of(scene, 0).gaussians.count, 8);
    assert_non_null(strstr(tides_scene_notes(scene), "environment isn't there"));
    assert_non_null(strstr(tides_scene_notes(scene), "its version is 1.2"));
    tides_scene_destroy(scene);
}

static void refuse(void **state, const char *part, tides_status wanted, const char *words) {
    tides_scene *scene = scene_new();
    tides_error error = {0, ""};
    scene_expect_error(read_part(state, part, scene, &error), wanted, &error, words);
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
}

#define ONE(levels, names, run)                                                           \
    "{\"totalLevels\":" levels ",\"splatType\":\".ply\",\"root\":{\"splatFiles\":[" names \
    "],\"child\":[{\"data\":{\"3dgs\":{" run "}}}]}}"

static void refused(void **state) {
    static const struct {
        const char *meta, *words;
        tides_status status;
    } cases[] = {
        {"[", "a.lcc2", TIDES_BAD_FILE},
        {"{}", "totalLevels", TIDES_BAD_FILE},
        {"{\"totalLevels\":65,\"root\":{\"splatFiles\":[]}}", "from 1 to 64", TIDES_BAD_FILE},
        {"{\"totalLevels\":1,\"root\":{}}", "no splatFiles", TIDES_BAD_FILE},
        {"{\"totalLevels\":1,\"splatType\":\".ksplat\",\"root\":{\"splatFiles\":[]}}", ".ksplat|.sog, .spz and .ply",
         TIDES_UNSUPPORTED},
        {"{\"totalLevels\":1,\"root\":{\"splatFiles\":[],\"data\":{\"env\":{\"name\":0}}}}", "env must", TIDES_BAD_FILE},
        {"{\"totalLevels\":1,\"root\":{\"splatFiles\":[]}}", "no node|level 0", TIDES_BAD_FILE},
        {ONE("1", "\"../a.ply\"", "\"name\":0"), "in folders there", TIDES_BAD_FILE},
        {ONE("1", "7", "\"name\":0"), "in folders there", TIDES_BAD_FILE},
        {ONE("1", "\"3dgs/0.ply\"", "\"name\":1"), "a number in splatFiles", TIDES_BAD_FILE},
        {ONE("1", "\"3dgs/0.ply\"", "\"name\":0,\"count\":-1"), "a number in splatFiles", TIDES_BAD_FILE},
        {ONE("1", "\"3dgs/0.ply\"", "\"name\":0,\"start\":2"), "start and count", TIDES_BAD_FILE},
        {ONE("1", "\"3dgs/0.ply\"", "\"name\":0,\"start\":2,\"count\":4"), "3dgs/0.ply|fewer|5", TIDES_BAD_FILE},
        {ONE("1", "\"3dgs/0.ply\"", "\"name\":0}}},{\"data\":{\"3dgs\":{\"name\":0"), "nodes share Gaussians of 3dgs/0.ply",
         TIDES_BAD_FILE},
        {ONE("1", "\"3dgs/9.ply\"", "\"name\":0"), "3dgs/9.ply", TIDES_FILE_NOT_FOUND},
        {ONE("1", "\"a.lcc2\"", "\"name\":0"), "a.lcc2.ply", TIDES_FILE_NOT_FOUND},
        {"{\"totalLevels\":2,\"splatType\":\".ply\"," ROOT(FOUR(".ply"), "null"), "deeper than its 2 levels", TIDES_BAD_FILE},
    };
    make_scene(state, plain);
    refuse(state, "3", TIDES_BAD_ARGUMENT, "scene.part|0 to 2");
    refuse(state, "x", TIDES_BAD_ARGUMENT, "scene.part|0 to 2");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene_file_write(scene_in_folder(*state, "a.lcc2"), cases[i].meta, strlen(cases[i].meta));
        refuse(state, NULL, cases[i].status, cases[i].words);
    }
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {IN_FOLDER(levels), IN_FOLDER(spz_files), IN_FOLDER(sog_files), IN_FOLDER(notes),
                                       IN_FOLDER(refused)};
    return cmocka_run_group_tests_name("scene_lcc2", tests, NULL, NULL);
}
