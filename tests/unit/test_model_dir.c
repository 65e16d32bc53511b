/* Model directories: which trainer wrote a folder, which of its files count, and what opens as a scene. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/td_model_dir.h"
#include "motion/td_motion.h"
#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"

#include <stdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Writes FOLDER/a/b/c, with the folders above it. */
static void put(void *folder, const char *name, const void *data, size_t size) {
    char path[1024];
    snprintf(path, sizeof path, "%s", scene_in_folder(folder, name));
    for (char *slash = path + strlen(folder) + 1; (slash = strchr(slash, '/')); *slash++ = '/') {
        *slash = 0;
        mkdir(path, 0700);
    }
    scene_file_write(path, data, size);
}

static void put_text(void *folder, const char *name, const char *text) { put(folder, name, text, strlen(text)); }

/* A plain scene of `count` Gaussians. */
static void put_ply(void *folder, const char *name, int64_t count) {
    td_gaussians g = scene_random(1, count, 0, SCENE_TRAINED);
    scene_bytes bytes = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    put(folder, name, bytes.data, bytes.size);
    free(bytes.data);
    td_gaussians_free(&g);
}

static void expect_path(const char *found, void *folder, const char *expected) {
    if (!expected) {
        assert_null(found);
        return;
    }
    assert_non_null(found);
    assert_string_equal(found, scene_in_folder(folder, expected));
}

static void expect(void *folder, const char *named, int method, int64_t iteration, const char *points, const char *weights) {
    td_model_dir dir;
    tides_error error;
    const char *path = scene_in_folder(folder, named);
    assert_true(td_model_dir_is(path));
    scene_expect_ok(td_model_dir_find(path, NULL, &dir, &error), &error);
    assert_string_equal(td_method_name(dir.method), td_method_name(method));
    assert_int_equal(dir.iteration, iteration);
    expect_path(dir.points, folder, points);
    expect_path(dir.weights, folder, weights);
    td_model_dir_free(&dir);
    td_model_dir_free(&dir);
}

static int64_t gaussians_in(void *folder, const char *named, char name[80]) {
    tides_scene *scene = scene_new();
    tides_error error;
    scene_expect_ok(tides_scene_add_file(scene, scene_in_folder(folder, named), NULL, 1, &error), &error);
    assert_int_equal(tides_scene_objects(scene), 1);
    int64_t count = tides_scene_count(scene);
    snprintf(name, 80, "%s", scene_object_of(scene, 0).name);
    tides_scene_destroy(scene);
    return count;
}

static void expect_refused(void *folder, const char *named, tides_status status, const char *expected) {
    tides_scene *scene = scene_new();
    tides_error error;
    scene_expect_error(tides_scene_add_file(scene, scene_in_folder(folder, named), NULL, 1, &error), status, &error, expected);
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
}

static void test_inria(void **state) {
    char name[80];
    put_text(*state, "m/cfg_args", "Namespace(sh_degree=3, source_path='D:\\\\x')");
    put_ply(*state, "m/point_cloud/iteration_7000/point_cloud.ply", 3);
    put_ply(*state, "m/point_cloud/iteration_30000/point_cloud.ply", 5);
    put_ply(*state, "m/point_cloud/iteration_x/point_cloud.ply", 7);
    put_ply(*state, "m/point_cloud/coarse_iteration_90000/point_cloud.ply", 2);
    put_text(*state, "m/point_cloud/iteration_99999/other", ""); /* begun, not ended */
    expect(*state, "m", TD_METHOD_INRIA, 30000, "m/point_cloud/iteration_30000/point_cloud.ply", NULL);
    expect(*state, "m/", TD_METHOD_INRIA, 30000, "m/point_cloud/iteration_30000/point_cloud.ply", NULL);
    expect(*state, "m/point_cloud", TD_METHOD_INRIA, 30000, "m/point_cloud/iteration_30000/point_cloud.ply", NULL);
    expect(*state, "m/point_cloud/iteration_7000", TD_METHOD_INRIA, 7000, "m/point_cloud/iteration_7000/point_cloud.ply", NULL);
    expect(*state, "m/point_cloud/coarse_iteration_90000", TD_METHOD_INRIA, 90000,
           "m/point_cloud/coarse_iteration_90000/point_cloud.ply", NULL);
    assert_int_equal(gaussians_in(*state, "m", name), 5);
    assert_string_equal(name, "m");
    assert_int_equal(gaussians_in(*state, "m/point_cloud/iteration_7000", name), 3);
    assert_int_equal(gaussians_in(*state, "m/point_cloud/iteration_7000/point_cloud.ply", name), 3);
    td_model_dir dir;
    assert_int_equal(td_model_dir_find(scene_in_folder(*state, "m"), NULL, &dir, NULL), TIDES_OK);
    assert_string_equal(td_value_text(td_value_get(td_tree_root(dir.cfg), "source_path")), "D:\\x");
    td_model_dir_free(&dir);
    put_text(*state, "m/cfg_args", "Namespace(sh_degree=");
    expect_refused(*state, "m", TIDES_BAD_FILE, "cfg_args|column 21");
}

static void test_deformed(void **state) {
    put_ply(*state, "f/point_cloud/iteration_14000/point_cloud.ply", 3);
    put_text(*state, "f/point_cloud/iteration_14000/deformation.pth", "");
    expect(*state, "f", TD_METHOD_FOURDGS, 14000, "f/point_cloud/iteration_14000/point_cloud.ply",
           "f/point_cloud/iteration_14000/deformation.pth");
    put_ply(*state, "f/gaussian_pertimestamp/time_00000.ply", 1);
    expect(*state, "f", TD_METHOD_FOURDGS, 14000, "f/point_cloud/iteration_14000/point_cloud.ply",
           "f/point_cloud/iteration_14000/deformation.pth");
    expect_refused(*state, "f", TIDES_BAD_FILE, "no cfg_args");
    put_ply(*state, "d/point_cloud/iteration_10/point_cloud.ply", 3);
    put_ply(*state, "d/point_cloud/iteration_20/point_cloud.ply", 3);
    put_text(*state, "d/deform/iteration_10/deform.pth", ""); /* 20 was cut short before its network was written */
    expect(*state, "d", TD_METHOD_DEFORMABLE, 10, "d/point_cloud/iteration_10/point_cloud.ply",
           "d/deform/iteration_10/deform.pth");
    expect_refused(*state, "d", TIDES_BAD_FILE, "deform.pth");
    put_text(*state, "e/deform/iteration_20/deform.pth", "");
    put_ply(*state, "e/point_cloud/iteration_10/point_cloud.ply", 3);
    expect_refused(*state, "e", TIDES_BAD_FILE, "deform/iteration_N/deform.pth");
}

static const char stg[] = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float trbf_center\nend_header\n";
static const char stg_of_one[] = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float trbf_center\n"
                                 "end_header\n1 0.5\n";
static const char ex4dgs[] = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float xyz_disp_0\nend_header\n";

static void test_other_layouts(void **state) {
    put_text(*state, "s/point_cloud/iteration_25000/point_cloud.ply", stg);
    expect(*state, "s", TD_METHOD_STG, 25000, "s/point_cloud/iteration_25000/point_cloud.ply", NULL);
    expect(*state, "s/point_cloud/iteration_25000/point_cloud.ply", TD_METHOD_STG, 25000,
           "s/point_cloud/iteration_25000/point_cloud.ply", NULL);
    put_text(*state, "s/point_cloud/iteration_25000/point_cloud.pt", "");
    expect(*state, "s", TD_METHOD_STG, 25000, "s/point_cloud/iteration_25000/point_cloud.ply",
           "s/point_cloud/iteration_25000/point_cloud.pt");
    expect_refused(*state, "s", TIDES_BAD_FILE, "point_cloud.ply|no Gaussian");
    put_text(*state, "s/point_cloud/iteration_25000/point_cloud.ply", stg_of_one);
    expect_refused(*state, "s", TIDES_BAD_FILE, "point_cloud.ply|no number 'y'");
    put_text(*state, "x/point_cloud/iteration_1/point_cloud.ply", ex4dgs);
    put_text(*state, "x/point_cloud/iteration_1/dynamic_point_cloud.ply", ex4dgs);
    expect(*state, "x", TD_METHOD_EX4DGS, 1, "x/point_cloud/iteration_1/point_cloud.ply",
           "x/point_cloud/iteration_1/dynamic_point_cloud.ply");
    put_text(*state, "c/chkpnt7000.pth", "");
    put_text(*state, "c/chkpnt30000.pth", "");
    put_text(*state, "c/chkpnt_best.pth", "");
    expect(*state, "c", TD_METHOD_FUDAN4D, 30000, NULL, "c/chkpnt30000.pth");
    put_text(*state, "b/chkpnt_best.pth", "");
    expect(*state, "b", TD_METHOD_FUDAN4D, -1, NULL, "b/chkpnt_best.pth");
    put_text(*state, "p/params.npz", "");
    expect(*state, "p", TD_METHOD_DYN3DGS, -1, NULL, "p/params.npz");
    expect_refused(*state, "p", TIDES_BAD_FILE, "params.npz");
    expect_refused(*state, "c", TIDES_BAD_FILE, "chkpnt30000.pth");
    put_text(*state, "nothing/readme", "");
    expect_refused(*state, "nothing", TIDES_BAD_FILE, "nothing: is no folder of a trained model|params.npz");
    expect_refused(*state, "absent", TIDES_FILE_NOT_FOUND, "absent");
}

static void test_frames(void **state) {
    char name[32];
    td_model_dir dir;
    tides_error error;
    for (int i = 11; i >= 0; i--) {
        snprintf(name, sizeof name, "t/time_%05d.ply", i);
        put_ply(*state, name, 1);
    }
    scene_expect_ok(td_model_dir_find(scene_in_folder(*state, "t"), NULL, &dir, &error), &error);
    assert_int_equal(dir.method, TD_METHOD_FRAMES);
    assert_int_equal(dir.frame_count, 12);
    expect_path(dir.frames[0], *state, "t/time_00000.ply");
    expect_path(dir.frames[10], *state, "t/time_00010.ply");
    td_model_dir_free(&dir);
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "t"), NULL, 1);
    const tides_motion *motion = scene_object_of(scene, 0).motion;
    assert_string_equal(tides_motion_model(motion), "keyframes");
    assert_true(motion->start == 0);
    assert_true(motion->stop == 1);
    assert_true(td_motion_field(motion, "mean")->shape[0] == 12);
    assert_null(td_motion_field(motion, "sh")); /* the same in every frame */
    tides_scene_destroy(scene);
    put_ply(*state, "t/time_00005.ply", 2);
    expect_refused(*state, "t", TIDES_BAD_FILE, "time_00005.ply|2 Gaussians");
}

/* -- gsplat -- */

static void add_tensor(scene_bytes *pickle, const char *name, int storage, int ndim, const int32_t *shape) {
    int32_t stride[3] = {1, 1, 1}, count = 1;
    char key[8];
    for (int d = ndim; d-- > 0; count *= shape[d]) stride[d] = count;
    snprintf(key, sizeof key, "%d", storage);
    pickle_text(pickle, name);
    pickle_tensor(pickle, "FloatStorage", key, count, 0, ndim, shape, stride);
}

enum { PLAIN, NOT_FINITE, NO_SH, WRONG_SH, FREETIME, FREETIME_NOT_FINITE, NO_TIMES };

/* Two Gaussians of degree 1, values 0.01, 0.02 .. in each storage. */
static void put_checkpoint(void *folder, const char *name, int kind) {
    static float values[24];
    scene_bytes pickle = {0};
    for (int i = 0; i < 24; i++) values[i] = 0.01f * (float)(i + 1);
    PICKLE(&pickle, "\x80\x02}(");
    pickle_text(&pickle, "step");
    pickle_integer(&pickle, 29999);
    pickle_text(&pickle, "splats");
    PICKLE(&pickle, "ccollections\nOrderedDict\n)R(");
    add_tensor(&pickle, "means", 0, 2, (const int32_t[]){2, 3});
    add_tensor(&pickle, "scales", 1, 2, (const int32_t[]){2, 3});
    add_tensor(&pickle, "quats", 2, 2, (const int32_t[]){2, 4});
    add_tensor(&pickle, "opacities", 3, 1, (const int32_t[]){2});
    add_tensor(&pickle, "sh0", 4, 3, (const int32_t[]){2, 1, 3});
    if (kind != NO_SH) add_tensor(&pickle, "shN", 5, 3, (const int32_t[]){2, kind == WRONG_SH ? 4 : 3, 3});
    if (kind >= FREETIME) add_tensor(&pickle, "velocities", 1, 2, (const int32_t[]){2, 3});
    if (kind == FREETIME || kind == FREETIME_NOT_FINITE) add_tensor(&pickle, "times", 3, 2, (const int32_t[]){2, 1});
    if (kind == FREETIME || kind == FREETIME_NOT_FINITE) add_tensor(&pickle, "durations", 3, 2, (const int32_t[]){2, 1});
    PICKLE(&pickle, "uu.");
    float means[6];
    memcpy(means, values, sizeof means);
    if (kind == NOT_FINITE || kind == FREETIME_NOT_FINITE) means[4] = 1.0f / 0.0f;
    const pickle_storage_bytes storages[] = {{means, 24}, {values, 24}, {values, 32},
                                             {values, 8}, {values, 24}, {values, kind == WRONG_SH ? 96 : 72}};
    scene_bytes file = pickle_archive(&pickle, storages, 6);
    put(folder, name, file.data, file.size);
    free(pickle.data);
    free(file.data);
}

static void test_gsplat(void **state) {
    char name[80];
    put_checkpoint(*state, "g/ckpts/ckpt_6999_rank0.pt", NO_SH);
    put_checkpoint(*state, "g/ckpts/ckpt_29999_rank0.pt", PLAIN);
    expect(*state, "g", TD_METHOD_GSPLAT, 29999, NULL, "g/ckpts/ckpt_29999_rank0.pt");
    expect(*state, "g/ckpts/ckpt_6999_rank0.pt", TD_METHOD_GSPLAT, 6999, NULL, "g/ckpts/ckpt_6999_rank0.pt");
    assert_int_equal(gaussians_in(*state, "g/ckpts/ckpt_6999_rank0.pt", name), 2);
    assert_string_equal(name, "ckpts");
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "g"), NULL, 1);
    tides_gaussians g = scene_object_of(scene, 0).gaussians;
    assert_int_equal(g.count, 2);
    assert_int_equal(g.sh_degree, 1);
    assert_true(g.mean[4] == 0.01f * 5);
    assert_true(g.log_scale[5] == 0.01f * 6);
    assert_true(g.quaternion[7] == 0.01f * 8);
    assert_true(g.opacity_logit[1] == 0.02f);
    assert_true(g.sh[12] == 0.01f * 4);
    assert_true(g.sh[3] == 0.01f);
    assert_true(g.sh[15] == 0.01f * 10);
    assert_true(g.sh[23] == 0.01f * 18);
    tides_scene_destroy(scene);
    put_checkpoint(*state, "n.pt", NOT_FINITE);
    expect_refused(*state, "n.pt", TIDES_BAD_FILE, "n.pt|Gaussian 1: mean[1] is inf|scene.invalid = drop");
    tides_scene_options options;
    tides_error error = {TIDES_OK, ""};
    tides_scene_options_defaults(&options);
    options.invalid = TIDES_INVALID_DROP;
    scene = scene_new();
    scene_expect_ok(tides_scene_read(scene, scene_in_folder(*state, "n.pt"), &options, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_dropped(scene), 1);
    assert_int_equal(scene_object_of(scene, 0).gaussians.count, 1);
    put_checkpoint(*state, "m.pt", FREETIME_NOT_FINITE); /* whose rows a motion has, too */
    scene_expect_error(tides_scene_read(scene, scene_in_folder(*state, "m.pt"), &options, NULL, 1, &error), TIDES_BAD_FILE,
                       &error, "m.pt|Gaussian 1: mean[1] is inf");
    tides_scene_destroy(scene);
    put_checkpoint(*state, "w.pt", WRONG_SH);
    expect_refused(*state, "w.pt", TIDES_BAD_FILE, "w.pt|shN");
    put_checkpoint(*state, "v.pt", NO_TIMES);
    expect_refused(*state, "v.pt", TIDES_BAD_FILE, "v.pt|times");
}

/* The trainer's settings say how: above the folder of checkpoints, or beside one. */
static void test_gsplat_tags(void **state) {
    static const struct {
        const char *cfg;
        int32_t trained;
    } cases[] = {{"absgrad: false\nantialiased: true\napp_opt: false\n", TIDES_TRAINED_ANTIALIASED},
                 {"antialiased: false\n", TIDES_TRAINED_PLAIN},
                 {"not_antialiased: true\n", TIDES_TRAINED_UNKNOWN}};
    put_checkpoint(*state, "g/ckpts/ckpt_6999_rank0.pt", PLAIN);
    for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; i++) {
        tides_scene *scene = scene_new();
        put(*state, "g/cfg.yml", cases[i / 2].cfg, strlen(cases[i / 2].cfg));
        scene_load(scene, scene_in_folder(*state, i % 2 ? "g" : "g/ckpts/ckpt_6999_rank0.pt"), NULL, 1);
        assert_int_equal(tides_scene_trained(scene), cases[i / 2].trained);
        tides_scene_destroy(scene);
    }
    put(*state, "g/cfg.yml", "model_type: 2dgs\n", 17);
    expect_refused(*state, "g", TIDES_UNSUPPORTED, "ckpt_6999_rank0.pt: holds discs|2DGS");
}

/* Velocities become the first coefficients; a duration's bell has a 1/2 that a width's doesn't. */
static void test_freetime(void **state) {
    put_checkpoint(*state, "v.pt", FREETIME);
    tides_scene *scene = scene_new();
    scene_load(scene, scene_in_folder(*state, "v.pt"), NULL, 1);
    const tides_motion *motion = scene_object_of(scene, 0).motion;
    assert_string_equal(tides_motion_model(motion), "polynomial");
    const float *velocity = td_motion_field(motion, "mean_coefficient")->value;
    assert_true(velocity[1] == 0.01f * 2);
    assert_true(velocity[9] == 0.01f * 4);
    assert_true(velocity[3] == 0);
    assert_true(td_motion_field(motion, "opacity_centre")->value[1] == 0.01f * 2);
    double width = exp((double)td_motion_field(motion, "opacity_log_width")->value[1]), duration = exp(0.02);
    assert_true(fabs(width * width - 2 * duration * duration) < 1e-6);
    tides_scene_destroy(scene);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {IN_FOLDER(test_inria),      IN_FOLDER(test_deformed), IN_FOLDER(test_other_layouts),
                                       IN_FOLDER(test_frames),     IN_FOLDER(test_gsplat),   IN_FOLDER(test_freetime),
                                       IN_FOLDER(test_gsplat_tags)};
    return cmocka_run_group_tests_name("model_dir", tests, NULL, NULL);
}
