/* Files written by trainers of dynamic models: every folder of $TIDES_SHARED/golden/{fourdgs,deformable,stg,fudan4d,dyn3dgs} is
 * recognised, its files open, and the tensors are those that numpy and torch themselves stored beside them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_pickle.h"
#include "archive/td_pyrepr.h"
#include "scene/td_model_dir.h"
#include "tests/support/npz.h"
#include "tests/support/scene_folder.h"
#include "tests/support/golden_folder.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One model: its folder, the golden results beside it, and what its weights hold. */
typedef struct model {
    td_model_dir dir;
    npz *golden;
    td_tree *tree;
} model;

typedef void check(const model *m);

typedef struct visit {
    int method;
    const char *golden;
    check *check;
} visit;

static td_tree *open_torch(const char *path) {
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_ok(td_torch_open(path, &tree, &error), &error);
    return tree;
}

static int visit_model(void *user, const char *path, const char *name) {
    const visit *v = user;
    model m = {.golden = NULL};
    tides_error error;
    char golden[1100];
    scene_expect_ok(td_model_dir_find(path, NULL, &m.dir, &error), &error);
    assert_string_equal(td_method_name(m.dir.method), td_method_name(v->method));
    snprintf(golden, sizeof golden, "%s/%s", path, v->golden);
    assert_non_null(m.golden = npz_open(golden));
    size_t length = m.dir.weights ? strlen(m.dir.weights) : 0;
    if (length && strcmp(m.dir.weights + length - 4, ".npz") != 0) m.tree = open_torch(m.dir.weights);
    v->check(&m);
    print_message("    %s\n", name);
    td_tree_free(m.tree);
    npz_close(m.golden);
    td_model_dir_free(&m.dir);
    return 0;
}

static void visit_all(const char *folder, int method, const char *golden, check *checked) {
    visit v = {method, golden, checked};
    golden_folder(folder, "", visit_model, &v);
}

/* Same shape, same bits. */
static void expect_tensor(const td_value *value, npz *golden, const char *name) {
    const npz_array *array = npz_get(golden, name);
    float *values = NULL;
    assert_non_null(array);
    assert_non_null(value);
    assert_int_equal(value->kind, TD_VALUE_TENSOR);
    int64_t shape[TD_NPY_DIMENSIONS_MAX];
    for (int d = 0; d < array->ndim; d++) shape[d] = (int64_t)array->shape[d];
    tides_error error;
    scene_expect_ok(td_tensor_check_shape(value->as.tensor, name, array->ndim, shape, &error), &error);
    scene_expect_ok(td_tensor_floats(value->as.tensor, &values, &error), &error);
    assert_string_equal(array->dtype, "<f4");
    assert_memory_equal(values, array->data, array->count * sizeof *values);
    free(values);
}

/* -- fudan's 4d-gaussian-splatting -- */

static void check_fudan(const model *m) {
    static const struct {
        size_t item;
        const char *name;
    } tensors[] = {{1, "raw_xyz"},     {2, "raw_features_dc"}, {3, "raw_features_rest"},
                   {4, "raw_scaling"}, {5, "raw_rotation"},    {6, "raw_opacity"},
                   {13, "raw_t"},      {14, "raw_scaling_t"}};
    const td_value *root = td_tree_root(m->tree), *capture = td_value_item(root, 0);
    int64_t iteration = 0;
    int rot_4d = -1;
    assert_true(td_value_integer(td_value_item(root, 1), &iteration));
    assert_true(iteration == m->dir.iteration);
    assert_int_equal(capture->count, 19);
    for (size_t i = 0; i < sizeof tensors / sizeof *tensors; i++)
        expect_tensor(td_value_item(capture, tensors[i].item), m->golden, tensors[i].name);
    assert_true(td_value_bool(td_value_item(capture, 16), &rot_4d));
    assert_true(rot_4d == npz_int(m->golden, "rot_4d"));
    if (rot_4d) expect_tensor(td_value_item(capture, 15), m->golden, "raw_rotation_r");
    int64_t degree_t = -1;
    assert_true(td_value_integer(td_value_item(capture, 18), &degree_t));
    assert_true(degree_t == npz_int(m->golden, "sh_degree_t"));
    assert_non_null(td_value_get(td_value_item(capture, 11), "param_groups"));
    assert_non_null(td_value_get(td_tree_root(m->dir.cfg), "prefilter_var"));
}

static void test_fudan(void **state) {
    (void)state;
    visit_all("golden/fudan4d", TD_METHOD_FUDAN4D, "golden.npz", check_fudan);
}

/* -- Deformable-3D-Gaussians -- */

static void check_deformable(const model *m) {
    char path[1100];
    size_t size = 0;
    snprintf(path, sizeof path, "%s/state_dict_shapes.json", m->dir.folder);
    char *text = scene_file_read(path, &size);
    cJSON *shapes = cJSON_Parse(text), *entry = NULL;
    const td_value *root = td_tree_root(m->tree);
    assert_non_null(shapes);
    assert_int_equal(root->count, cJSON_GetArraySize(shapes));
    cJSON_ArrayForEach(entry, shapes) {
        int64_t shape[4];
        int ndim = cJSON_GetArraySize(entry);
        float *values = NULL;
        tides_error error;
        for (int d = 0; d < ndim; d++) shape[d] = (int64_t)cJSON_GetArrayItem(entry, d)->valuedouble;
        scene_expect_ok(td_value_floats(root, entry->string, ndim, shape, &values, &error), &error);
        free(values);
    }
    cJSON_Delete(shapes);
    free(text);
    int is_6dof = -1;
    assert_true(td_value_bool(td_value_get(td_tree_root(m->dir.cfg), "is_6dof"), &is_6dof));
    assert_int_equal(is_6dof, td_value_get(root, "branch_w.weight") != NULL);
}

static void test_deformable(void **state) {
    (void)state;
    visit_all("golden/deformable", TD_METHOD_DEFORMABLE, "golden_theta.npz", check_deformable);
}

/* -- 4DGaussians -- */

static void check_beside(const model *m, const char *name, int ndim, int dtype) {
    char path[1100];
    tides_error error;
    const int64_t shape[2] = {(int64_t)npz_get(m->golden, "xyz")->shape[0], 3};
    snprintf(path, sizeof path, "%.*s%s", (int)(strrchr(m->dir.weights, '/') + 1 - m->dir.weights), m->dir.weights, name);
    td_tree *tree = open_torch(path);
    const td_value *root = td_tree_root(tree);
    assert_int_equal(root->kind, TD_VALUE_TENSOR);
    assert_int_equal(root->as.tensor->dtype, dtype);
    scene_expect_ok(td_tensor_check_shape(root->as.tensor, name, ndim, shape, &error), &error);
    td_tree_free(tree);
}

static void check_fourdgs(const model *m) {
    const td_value *root = td_tree_root(m->tree), *cfg = td_tree_root(m->dir.cfg);
    expect_tensor(td_value_get(root, "deformation_net.grid.aabb"), m->golden, "aabb");
    for (size_t i = 0; i < root->count; i++) {
        tides_error error;
        assert_int_equal(root->as.items[2 * i + 1]->kind, TD_VALUE_TENSOR);
        scene_expect_ok(td_tensor_check_finite(root->as.items[2 * i + 1]->as.tensor, "any", &error), &error);
    }
    int64_t width = 0, channels = 0;
    assert_true(td_value_integer(td_value_get(cfg, "net_width"), &width));
    assert_true(td_value_integer(td_value_get(td_value_get(cfg, "kplanes_config"), "output_coordinate_dim"), &channels));
    tides_error error;
    float *values = NULL;
    scene_expect_ok(td_value_floats(root, "deformation_net.pos_deform.3.weight", 2, (const int64_t[]){3, width}, &values,
                                    &error),
                    &error);
    free(values);
    scene_expect_ok(td_value_floats(root, "deformation_net.grid.grids.1.5", 4, (const int64_t[]){1, channels, -1, -1}, &values,
                                    &error),
                    &error);
    free(values);
    check_beside(m, "deformation_table.pth", 1, TD_TENSOR_BOOL);
    check_beside(m, "deformation_accum.pth", 2, TD_TENSOR_FLOAT32);
}

static void test_fourdgs(void **state) {
    (void)state;
    visit_all("golden/fourdgs", TD_METHOD_FOURDGS, "golden_theta.npz", check_fourdgs);
}

/* -- SpacetimeGaussians: the decoder's weights turn the golden features into the golden pictures -- */

static void decode(const float *w1, const float *w2, const double *feature, const double *ray, int act, double rgb[3]) {
    double hidden[6];
    for (int h = 0; h < 6; h++) {
        hidden[h] = 0;
        for (int k = 0; k < 12; k++) hidden[h] += (double)w1[12 * h + k] * (k < 6 ? feature[3 + k] : ray[k - 6]);
        hidden[h] = fmax(hidden[h], 0);
    }
    for (int c = 0; c < 3; c++) {
        rgb[c] = feature[c];
        for (int h = 0; h < 6; h++) rgb[c] += (double)w2[6 * c + h] * hidden[h];
        rgb[c] = act ? 1 / (1 + exp(-rgb[c])) : fmin(fmax(rgb[c], 0), 1);
    }
}

static void check_stg(const model *m) {
    char decoder[32];
    npz_string(m->golden, "decoder", decoder, sizeof decoder);
    if (!m->tree) {
        assert_null(npz_get(m->golden, "rays")); /* lite: nothing to decode */
        return;
    }
    float *w1 = NULL, *w2 = NULL;
    tides_error error;
    const td_value *root = td_tree_root(m->tree);
    scene_expect_ok(td_value_floats(root, "mlp1.weight", 4, (const int64_t[]){6, 12, 1, 1}, &w1, &error), &error);
    scene_expect_ok(td_value_floats(root, "mlp2.weight", 4, (const int64_t[]){3, 6, 1, 1}, &w2, &error), &error);
    size_t count = 0;
    double *features = npz_doubles(m->golden, "image_feat", NULL), *rays = npz_doubles(m->golden, "rays", NULL);
    double *expected = npz_doubles(m->golden, "image_rgb", &count), worst = 0;
    for (size_t i = 0; i < count / 3; i++) {
        double rgb[3];
        decode(w1, w2, features + 9 * i, rays + 6 * i, strstr(m->dir.folder, "noact") == NULL, rgb);
        for (int c = 0; c < 3; c++) worst = fmax(worst, fabs(rgb[c] - expected[3 * i + c]));
    }
    print_message("    decoded pictures differ by %.2g\n", worst);
    assert_true(count > 0);
    assert_true(worst < 1e-12);
    free(features);
    free(rays);
    free(expected);
    free(w1);
    free(w2);
}

static void test_stg(void **state) {
    (void)state;
    visit_all("golden/stg", TD_METHOD_STG, "golden.npz", check_stg);
}

/* -- Dynamic3DGaussians -- */

static void test_dyn3dgs(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int ndim;
        int64_t shape[3];
    } arrays[] = {{"means3D", 3, {6, 40, 3}},      {"rgb_colors", 3, {6, 40, 3}}, {"unnorm_rotations", 3, {6, 40, 4}},
                  {"logit_opacities", 2, {40, 1}}, {"log_scales", 2, {40, 3}},    {"seg_colors", 2, {40, 3}}};
    char path[1024];
    td_model_dir dir;
    td_npz *params = NULL;
    tides_error error;
    if (shared_path(path, sizeof path, "golden/dyn3dgs") != 0) skip();
    scene_expect_ok(td_model_dir_find(path, NULL, &dir, &error), &error);
    assert_int_equal(dir.method, TD_METHOD_DYN3DGS);
    scene_expect_ok(td_npz_open(dir.weights, &params, &error), &error);
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        float *values = NULL;
        scene_expect_ok(td_npz_floats(params, arrays[i].name, arrays[i].ndim, arrays[i].shape, &values, &error), &error);
        free(values);
    }
    td_npz_close(params);
    td_model_dir_free(&dir);
}

/* A real one, from a trainer under Windows. */
static void test_cfg_args(void **state) {
    (void)state;
    char path[1024];
    td_tree *tree = NULL;
    tides_error error;
    if (shared_path(path, sizeof path, "data/snowmiku/cfg_args") != 0) skip();
    scene_expect_ok(td_pyrepr_open(path, &tree, &error), &error);
    const td_value *root = td_tree_root(tree);
    const char *source = td_value_text(td_value_get(root, "source_path"));
    int64_t degree = 0;
    assert_int_equal(root->count, 8);
    assert_true(source);
    assert_true(strncmp(source, "D:\\noname\\Projects", 18) == 0);
    assert_true(td_value_integer(td_value_get(root, "sh_degree"), &degree));
    assert_true(degree == 3);
    td_tree_free(tree);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fudan),   cmocka_unit_test(test_deformable),
                                       cmocka_unit_test(test_fourdgs), cmocka_unit_test(test_stg),
                                       cmocka_unit_test(test_dyn3dgs), cmocka_unit_test(test_cfg_args)};
    return cmocka_run_group_tests_name("trained_files", tests, NULL, NULL);
}
