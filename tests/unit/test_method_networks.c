/* Readers of 4DGaussians and Deformable-3DGS: a trainer's arrays read back, options of cfg_args count, and missing or unknown
 * parts are reported. Files are made here byte by byte. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_pyrepr.h"
#include "motion/td_hexplane.h"
#include "scene/td_method_networks.h"
#include "tests/support/archive_make.h"
#include "tests/support/random_network.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 5 };

/* torch.save of an OrderedDict of the motion's arrays with `prefix` before their names, and one more key that no reader knows
 * of. */
static void write_weights(const char *path, const tides_motion *motion, const char *prefix) {
    scene_bytes pickle = {0};
    pickle_storage_bytes storages[TD_FIELDS_MAX];
    PICKLE(&pickle, "\x80\x02"
                    "ccollections\nOrderedDict\n)R(");
    for (int i = 0; i < motion->fields; i++) {
        const td_field *field = &motion->field[i];
        int32_t shape[TD_FIELD_RANK_MAX], stride[TD_FIELD_RANK_MAX], count = 1;
        char key[96], number[8];
        for (int k = field->rank; k-- > 0;) {
            shape[k] = (int32_t)field->shape[k];
            stride[k] = count;
            count *= shape[k];
        }
        snprintf(key, sizeof key, "%s%s", prefix, field->name);
        snprintf(number, sizeof number, "%d", i);
        pickle_text(&pickle, key);
        pickle_tensor(&pickle, "FloatStorage", number, count, 0, field->rank, shape, stride);
        storages[i] = (pickle_storage_bytes){field->value, (size_t)count * sizeof(float)};
    }
    pickle_text(&pickle, "epoch");
    pickle_integer(&pickle, 7);
    PICKLE(&pickle, "u.");
    scene_bytes archive = pickle_archive(&pickle, storages, motion->fields);
    scene_file_write(path, archive.data, archive.size);
    free(archive.data);
    free(pickle.data);
}

/* A model directory in the test's folder; `cfg` NULL: no cfg_args. Freed with free_model. */
static td_model_dir make_model(void *folder, const tides_motion *motion, const char *prefix, const char *cfg) {
    random_gaussians gaussians = random_gaussians_make(51, COUNT, 3, 1);
    td_model_dir dir = {0};
    td_gaussians copy;
    tides_error error = {0, ""};
    dir.folder = td_strdup(folder, NULL);
    dir.points = td_strdup(scene_in_folder(folder, "point_cloud.ply"), NULL);
    dir.weights = td_strdup(scene_in_folder(folder, "weights.pth"), NULL);
    scene_expect_ok(td_gaussians_copy(&copy, &gaussians.view, &error), &error);
    scene_expect_ok(td_ply_write(dir.points, &copy, 1, &error), &error);
    write_weights(dir.weights, motion, prefix);
    if (cfg) scene_expect_ok(td_pyrepr_parse("cfg_args", cfg, strlen(cfg), &dir.cfg, &error), &error);
    td_gaussians_free(&copy);
    random_gaussians_free(&gaussians);
    return dir;
}

static void free_model(td_model_dir *dir) {
    free(dir->folder);
    free(dir->points);
    free(dir->weights);
    td_tree_free(dir->cfg);
}

typedef tides_status opener(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);

/* What was read has `expected`'s arrays, and no others. */
static void expect_same_arrays(const tides_motion *read, const tides_motion *expected) {
    assert_int_equal(read->fields, expected->fields);
    for (int i = 0; i < expected->fields; i++) {
        const td_field *wanted = &expected->field[i], *field = td_motion_field(read, wanted->name);
        assert_non_null(field);
        size_t count = 1;
        assert_int_equal(field->rank, wanted->rank);
        for (int k = 0; k < wanted->rank; k++) {
            assert_int_equal(field->shape[k], wanted->shape[k]);
            count *= wanted->shape[k];
        }
        assert_memory_equal(field->value, wanted->value, count * sizeof(float));
    }
}

static void expect_opens(opener *open, const td_model_dir *dir, const tides_motion *expected, int heads) {
    tides_error error = {0, ""};
    td_gaussians gaussians = {0};
    tides_motion *motion = NULL;
    td_hexplane shape;
    scene_expect_ok(open(dir, &gaussians, &motion, &error), &error);
    assert_int_equal(gaussians.count, COUNT);
    if (expected) expect_same_arrays(motion, expected);
    if (heads >= 0) {
        scene_expect_ok(td_hexplane_measure(motion, &shape, &error), &error);
        assert_int_equal(shape.heads, heads);
    }
    tides_motion_destroy(motion);
    td_gaussians_free(&gaussians);
}

static void expect_refused(opener *open, const td_model_dir *dir, tides_status wanted, const char *expected) {
    tides_error error = {0, ""};
    td_gaussians gaussians = {0};
    tides_motion *motion = NULL;
    scene_expect_error(open(dir, &gaussians, &motion, &error), wanted, &error, expected);
    assert_null(motion);
    assert_null(gaussians.mean);
}

static tides_motion *hexplane(void) {
    const random_hexplane_recipe recipe = {52, 3, {4, 5, 6, 7}, 2, 10, 2, 31, 0, 0.2};
    return random_hexplane_make(&recipe);
}

static void test_fourdgs_options(void **state) {
    static const struct {
        const char *cfg;
        int heads;
    } cases[] = {{"Namespace(no_dx=False, no_ds=False, no_dr=False, no_do=False, no_dshs=False)", 31},
                 {"Namespace(sh_degree=3)", 7}, /* the trainer's defaults */
                 {"Namespace(no_dx=True, no_ds=True, no_dr=True)", 0},
                 {"Namespace(no_dx=True, no_do=False, apply_rotation=True)", 14}};
    tides_motion *motion = hexplane();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        td_model_dir dir = make_model(*state, motion, "deformation_net.", cases[i].cfg);
        expect_opens(td_fourdgs_open, &dir, cases[i].heads == 31 ? motion : NULL, cases[i].heads);
        free_model(&dir);
    }
    tides_motion_destroy(motion);
}

static void test_fourdgs_refuses(void **state) {
    static const char *const options[] = {"no_grid", "static_mlp", "empty_voxel"};
    tides_motion *motion = hexplane();
    char cfg[64], expected[96];
    for (int i = 0; i < 3; i++) {
        snprintf(cfg, sizeof cfg, "Namespace(%s=True)", options[i]);
        snprintf(expected, sizeof expected, "weights.pth|cfg_args|%s", options[i]);
        td_model_dir dir = make_model(*state, motion, "deformation_net.", cfg);
        expect_refused(td_fourdgs_open, &dir, TIDES_UNSUPPORTED, expected);
        free_model(&dir);
    }
    td_model_dir dir = make_model(*state, motion, "deformation_net.", NULL);
    expect_refused(td_fourdgs_open, &dir, TIDES_BAD_FILE, "no cfg_args");
    free_model(&dir);
    dir = make_model(*state, motion, "other_net.", "Namespace()");
    expect_refused(td_fourdgs_open, &dir, TIDES_BAD_FILE, "weights.pth|'grid.aabb'|missing");
    remove(dir.points);
    expect_refused(td_fourdgs_open, &dir, TIDES_FILE_NOT_FOUND, "point_cloud.ply");
    free_model(&dir);
    tides_motion_destroy(motion);
}

/* A head that is missing matters only where it is on; so does one with a number that isn't finite. */
static void test_fourdgs_heads(void **state) {
    tides_motion *motion = hexplane();
    td_field *last = &motion->field[motion->fields - 1]; /* shs_deform.3.bias */
    assert_string_equal(last->name, "shs_deform.3.bias");
    last->value[3] = (float)NAN;
    td_model_dir dir = make_model(*state, motion, "deformation_net.", "Namespace(no_dshs=False)");
    expect_refused(td_fourdgs_open, &dir, TIDES_BAD_FILE, "weights.pth|value 3|shs_deform.3.bias|nan");
    free_model(&dir);
    dir = make_model(*state, motion, "deformation_net.", "Namespace()");
    expect_opens(td_fourdgs_open, &dir, NULL, 7);
    free_model(&dir);
    motion->fields--;
    free(last->value);
    dir = make_model(*state, motion, "deformation_net.", "Namespace(no_dshs=False)");
    expect_refused(td_fourdgs_open, &dir, TIDES_BAD_FILE, "weights.pth|'shs_deform.3.bias'|missing");
    free_model(&dir);
    tides_motion_destroy(motion);
}

static void test_deformable(void **state) {
    random_network_recipe recipe = {53, 12, 4, 2, 3, 9, 30, 1, 0.2};
    tides_motion *motion = random_network_make(&recipe);
    td_model_dir dir = make_model(*state, motion, "", NULL);
    expect_opens(td_deformable_open, &dir, motion, -1);
    free_model(&dir);
    dir = make_model(*state, motion, "module.", NULL);
    expect_refused(td_deformable_open, &dir, TIDES_BAD_FILE, "weights.pth|'linear.0.weight'|missing");
    free_model(&dir);
    tides_motion_destroy(motion);
}

static void test_no_state_dictionary(void **state) {
    random_network_recipe recipe = {54, 12, 2, 0, 3, 0, 0, 0, 0.2};
    tides_motion *motion = random_network_make(&recipe);
    td_model_dir dir = make_model(*state, motion, "", NULL);
    scene_bytes pickle = {0};
    PICKLE(&pickle, "\x80\x02]."); /* a list */
    scene_bytes archive = pickle_archive(&pickle, NULL, 0);
    scene_file_write(dir.weights, archive.data, archive.size);
    expect_refused(td_deformable_open, &dir, TIDES_BAD_FILE, "weights.pth|a list was saved|state dictionary");
    free(archive.data);
    free(pickle.data);
    free_model(&dir);
    tides_motion_destroy(motion);
}

int main(void) {
    const struct CMUnitTest tests[] =
        {cmocka_unit_test_setup_teardown(test_fourdgs_options, scene_folder_setup, scene_folder_teardown),
         cmocka_unit_test_setup_teardown(test_fourdgs_refuses, scene_folder_setup, scene_folder_teardown),
         cmocka_unit_test_setup_teardown(test_fourdgs_heads, scene_folder_setup, scene_folder_teardown),
         cmocka_unit_test_setup_teardown(test_deformable, scene_folder_setup, scene_folder_teardown),
         cmocka_unit_test_setup_teardown(test_no_state_dictionary, scene_folder_setup, scene_folder_teardown)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
