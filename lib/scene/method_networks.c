/* Helpers for methods whose motion is a deformation network: read the canonical points, hand the network's arrays to a motion
 * (which checks them), and read training options. */
#include "scene/td_method_networks.h"

#include "motion/td_motion.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

tides_status td_method_points(const td_model_dir *dir, td_gaussians *gaussians, tides_error *error) {
    char *data = NULL;
    size_t bytes = 0;
    if (!dir->points) return td_fail(error, TIDES_BAD_FILE, "%s: there is no point_cloud.ply", dir->folder);
    tides_status status = td_read_file(dir->points, SIZE_MAX / 2, &data, &bytes, error);
    if (status != TIDES_OK) return status;
    status = td_ply_parse(dir->points, data, bytes, gaussians, error);
    free(data);
    return status;
}

static tides_status take_tensor(tides_motion *motion, const char *name, const td_tensor *tensor, tides_error *error) {
    uint64_t shape[TD_FIELD_RANK_MAX];
    float *values = NULL;
    if (tensor->ndim < 1 || tensor->ndim > TD_FIELD_RANK_MAX)
        return td_fail(error, TIDES_BAD_FILE, "tensor %s has %d dimensions, must have 1 to %d", name, tensor->ndim,
                       TD_FIELD_RANK_MAX);
    for (int i = 0; i < tensor->ndim; i++) {
        if (tensor->shape[i] < 1) return td_fail(error, TIDES_BAD_FILE, "tensor %s is empty", name);
        shape[i] = (uint64_t)tensor->shape[i];
    }
    tides_status status = td_tensor_floats(tensor, &values, error);
    return status == TIDES_OK ? td_motion_take_field(motion, name, tensor->ndim, shape, values, error) : status;
}

tides_status td_method_fields(tides_motion *motion, const td_value *dict, const char *prefix,
                              int (*wanted)(const tides_motion *motion, const char *name), tides_error *error) {
    size_t length = strlen(prefix);
    if (!dict || dict->kind != TD_VALUE_DICT)
        return td_fail(error, TIDES_BAD_FILE, "a %s was saved: a state dictionary of tensors was expected",
                       td_value_kind(dict));
    for (size_t i = 0; i < dict->count; i++) {
        const char *key = td_value_text(dict->as.items[2 * i]);
        const td_value *value = dict->as.items[2 * i + 1];
        if (!key || strncmp(key, prefix, length) != 0 || value->kind != TD_VALUE_TENSOR) continue;
        if (!wanted(motion, key + length)) continue;
        tides_status status = take_tensor(motion, key + length, value->as.tensor, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

double td_method_option(const td_model_dir *dir, const char *key, double fallback) {
    const td_value *value = td_value_get(dir->cfg ? td_tree_root(dir->cfg) : NULL, key);
    double number = fallback;
    return td_value_number(value, &number) ? number : fallback;
}
