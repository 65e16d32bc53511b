/* Reads 4d-gaussian-splatting (Yang et al. 2024): chkpntN.pth = (capture, iteration); capture is a tuple of 19:
 *     0 active_sh_degree   1 xyz [N, 3]         2 features_dc [N, 1, 3]   3 features_rest [N, K - 1, 3]   4 scaling [N, 3]
 *     5 rotation [N, 4]    6 opacity [N, 1]     7 .. 12 of training       13 t [N, 1]      14 scaling_t [N, 1]
 *     15 rotation_r [N, 4] 16 rot_4d            17 env_map                18 active_sh_degree_t
 * N is the number of Gaussians, and K that of the coefficients of a colour channel. Coefficient 16 k + j belongs to SH
 * coefficient j and to harmonic k in time. Without harmonics, 33 coefficients are stored and 16 used.
 *
 * The range of time isn't in this file, and in cfg_args (time_duration) only in some versions. The trainer spreads the
 * centres evenly over the range, and a tenth of it beyond. So the centres tell which of the ranges in its configurations was
 * used: 0 to 1, -1/2 to 1/2, or 0 to 10 s. */
#include "scene/td_method_arrays.h"

#include "archive/td_pickle.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

enum { XYZ = 1, DC, REST, SCALING, ROTATION, OPACITY, T = 13, SCALING_T, ROTATION_R, ROT_4D, HARMONICS = 18, ITEMS = 19 };
enum { K = 16, ENTRIES = 3 * K }; /* SH coefficients of degree 3: of one channel, and of all three */

/* Item `index` as floats with `ndim` extents (-1: any); the caller frees them. */
static tides_status read_item(const td_value *capture, size_t index, const char *name, int ndim, const int64_t *shape,
                              float **out, tides_error *error) {
    const td_value *item = td_value_item(capture, index);
    if (!item || item->kind != TD_VALUE_TENSOR) {
        td_fail(error, TIDES_BAD_FILE, "item %zu, %s, is %s: a tensor was expected", index, name, td_value_kind(item));
        return TIDES_BAD_FILE; /* repeats the status for static analysers, which don't follow td_fail */
    }
    tides_status status = td_tensor_check_shape(item->as.tensor, name, ndim, shape, error);
    if (status == TIDES_OK) status = td_tensor_check_finite(item->as.tensor, name, error);
    if (status == TIDES_OK) status = td_tensor_floats(item->as.tensor, out, error);
    return status;
}

/* Owned arrays for the motion's constructor. */
typedef struct fudan_arrays {
    float *centre, *log_scale, *right, *harmonic;
    int harmonics;
} fudan_arrays;

static void arrays_free(fudan_arrays *a) {
    free(a->centre);
    free(a->log_scale);
    free(a->right);
    free(a->harmonic);
}

static tides_status copy_item(const td_value *capture, size_t index, const char *name, int ndim, const int64_t *shape,
                              float *out, size_t reals, tides_error *error) {
    float *values = NULL;
    tides_status status = read_item(capture, index, name, ndim, shape, &values, error);
    if (status == TIDES_OK) memcpy(out, values, reals * sizeof *out);
    free(values);
    return status;
}

/* Finds the number of coefficients stored per Gaussian, and of harmonics used. */
static tides_status find_colours(const td_value *capture, int64_t count, int64_t *stored, int *harmonics, tides_error *error) {
    const td_value *rest = td_value_item(capture, REST);
    int64_t used = 0;
    if (!rest || rest->kind != TD_VALUE_TENSOR || rest->as.tensor->ndim != 3 || rest->as.tensor->shape[0] != count)
        return td_fail(error, TIDES_BAD_FILE, "item %d, features_rest, isn't a tensor [%lld, K - 1, 3]", REST,
                       (long long)count);
    *stored = 1 + rest->as.tensor->shape[1];
    if (!td_value_integer(td_value_item(capture, HARMONICS), &used) || used < 0 || used > 4 || *stored < K * (used + 1))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%lld colour coefficients with active_sh_degree_t %lld: degree 3, 16 of each harmonic, is read",
                       (long long)*stored, (long long)used);
    *harmonics = (int)used;
    return TIDES_OK;
}

static tides_status read_colours(const td_value *capture, td_gaussians *g, fudan_arrays *a, tides_error *error) {
    int64_t stored = 0;
    float *dc = NULL, *rest = NULL;
    tides_status status = find_colours(capture, g->count, &stored, &a->harmonics, error);
    if (status == TIDES_OK) status = read_item(capture, DC, "features_dc", 3, (int64_t[]){g->count, 1, 3}, &dc, error);
    if (status == TIDES_OK)
        status = read_item(capture, REST, "features_rest", 3, (int64_t[]){g->count, stored - 1, 3}, &rest, error);
    size_t more = (size_t)a->harmonics * ENTRIES;
    if (status == TIDES_OK && more > 0 && !(a->harmonic = td_alloc((size_t)g->count, more * sizeof *a->harmonic, error)))
        status = TIDES_NO_MEMORY;
    for (size_t i = 0; i < (size_t)g->count && status == TIDES_OK; i++) {
        const float *own = rest + i * 3 * (size_t)(stored - 1);
        memcpy(g->sh + i * ENTRIES, dc + 3 * i, 3 * sizeof *dc);
        memcpy(g->sh + i * ENTRIES + 3, own, (ENTRIES - 3) * sizeof *own);
        if (more > 0) memcpy(a->harmonic + i * more, own + ENTRIES - 3, more * sizeof *own);
    }
    free(dc);
    free(rest);
    return status;
}

static tides_status read_gaussians(const td_value *capture, td_gaussians *g, tides_error *error) {
    const td_value *xyz = td_value_item(capture, XYZ);
    if (!xyz || xyz->kind != TD_VALUE_TENSOR || xyz->as.tensor->ndim != 2 || xyz->as.tensor->shape[0] < 1)
        return td_fail(error, TIDES_BAD_FILE, "item %d, xyz, isn't a tensor [N, 3] of Gaussians", XYZ);
    tides_status status = td_gaussians_create(g, xyz->as.tensor->shape[0], 3, error);
    const size_t n = (size_t)g->count;
    const int64_t three[] = {g->count, 3}, four[] = {g->count, 4}, one[] = {g->count, 1};
    if (status == TIDES_OK) status = copy_item(capture, XYZ, "xyz", 2, three, g->mean, 3 * n, error);
    if (status == TIDES_OK) status = copy_item(capture, SCALING, "scaling", 2, three, g->log_scale, 3 * n, error);
    if (status == TIDES_OK) status = copy_item(capture, ROTATION, "rotation", 2, four, g->quaternion, 4 * n, error);
    if (status == TIDES_OK) status = copy_item(capture, OPACITY, "opacity", 2, one, g->opacity_logit, n, error);
    return status;
}

static tides_status read_arrays(const td_value *capture, int64_t count, fudan_arrays *a, tides_error *error) {
    const int64_t one[] = {count, 1}, four[] = {count, 4};
    int tilts = 0;
    if (!td_value_bool(td_value_item(capture, ROT_4D), &tilts)) {
        td_fail(error, TIDES_BAD_FILE, "item %d, rot_4d, isn't True or False", ROT_4D);
        return TIDES_BAD_FILE; /* repeats the status for static analysers, which don't follow td_fail */
    }
    tides_status status = read_item(capture, T, "t", 2, one, &a->centre, error);
    if (status == TIDES_OK) status = read_item(capture, SCALING_T, "scaling_t", 2, one, &a->log_scale, error);
    if (status == TIDES_OK && tilts) status = read_item(capture, ROTATION_R, "rotation_r", 2, four, &a->right, error);
    return status;
}

static void find_range(const td_model_dir *dir, const fudan_arrays *a, int64_t count, double *start, double *stop) {
    const td_value *range = td_value_get(dir->cfg ? td_tree_root(dir->cfg) : NULL, "time_duration");
    if (td_value_number(td_value_item(range, 0), start) && td_value_number(td_value_item(range, 1), stop) && *start < *stop)
        return;
    double least = a->centre[0], most = a->centre[0];
    for (int64_t i = 1; i < count; i++) {
        if (a->centre[i] < least) least = a->centre[i];
        if (a->centre[i] > most) most = a->centre[i];
    }
    *start = 0;
    *stop = most - least > 3 ? 10 : 1; /* centres spread over 1.2 s for the ranges of 1 s, and over 12 s for that of 10 s */
    if (*stop == 1 && least + most < 0.5) *start = -0.5, *stop = 0.5; /* the middle is nearer to 0 than to 1/2 */
}

static tides_status make_motion(const td_model_dir *dir, const fudan_arrays *a, int64_t count, tides_motion **motion,
                                tides_error *error) {
    tides_rotor_motion arrays = {.count = count, .centre = a->centre, .log_scale_time = a->log_scale};
    arrays.quaternion_right = a->right;
    arrays.sh_harmonic = a->harmonic;
    arrays.harmonics = a->harmonics;
    arrays.sh_degree = 3;
    td_value_number(td_value_get(dir->cfg ? td_tree_root(dir->cfg) : NULL, "prefilter_var"), &arrays.time_prefilter);
    find_range(dir, a, count, &arrays.start, &arrays.stop);
    return tides_motion_create_rotor(&arrays, motion, error);
}

static tides_status check_capture(const td_value *capture, tides_error *error) {
    if (capture && capture->kind == TD_VALUE_TUPLE && capture->count == ITEMS) return TIDES_OK;
    if (capture && capture->kind == TD_VALUE_TUPLE && capture->count == 12)
        return td_fail(error, TIDES_UNSUPPORTED, "is of gaussian_dim 3, a model at rest: save it as a .ply");
    return td_fail(error, TIDES_BAD_FILE, "holds %s of %zu: a tuple of %d was expected", td_value_kind(capture),
                   capture ? capture->count : 0, ITEMS);
}

tides_status td_fudan4d_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    td_tree *tree = NULL;
    td_gaussians made = {0};
    tides_motion *moves = NULL;
    fudan_arrays a = {0};
    tides_status status = td_torch_open(dir->weights, &tree, error);
    if (status != TIDES_OK) return status;
    const td_value *capture = td_value_item(td_tree_root(tree), 0);
    status = check_capture(capture, error);
    if (status == TIDES_OK) status = read_gaussians(capture, &made, error);
    if (status == TIDES_OK) status = read_colours(capture, &made, &a, error);
    if (status == TIDES_OK) status = read_arrays(capture, made.count, &a, error);
    if (status == TIDES_OK) status = make_motion(dir, &a, made.count, &moves, error);
    arrays_free(&a);
    td_tree_free(tree);
    return td_arrays_finish(status, dir->weights, &made, moves, gaussians, motion, error);
}
