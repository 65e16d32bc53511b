/* Finds the sizes of 4DGaussians' deformation from its arrays, and checks that all arrays and settings exist. */
#include "td_hexplane.h"

#include "td_dense.h"

#include <math.h>
#include <string.h>

const char *const td_hexplane_heads[TD_HEADS] = {"pos_deform", "scales_deform", "rotations_deform", "opacity_deform",
                                                 "shs_deform"};
static const char *const head_flags[TD_HEADS] = {"no_dx", "no_ds", "no_dr", "no_do", "no_dshs"};
static const uint64_t head_outputs[TD_HEADS] = {3, 3, 4, 1, TD_HEXPLANE_SH_MAX};

/* The axes of each plane, 0 to 3 for x y z t: that of its width, and that of its height. */
static const int plane_axes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

const td_field *td_hexplane_plane(const tides_motion *motion, int level, int plane) {
    char name[32];
    snprintf(name, sizeof name, "grid.grids.%d.%d", level, plane);
    return td_motion_field(motion, name);
}

static tides_status measure_plane(const tides_motion *motion, td_hexplane *hexplane, int level, int plane, int size[4],
                                  tides_error *error) {
    char name[32];
    const td_field *field = NULL;
    int *width = &size[plane_axes[plane][0]], *height = &size[plane_axes[plane][1]];
    const uint64_t shape[4] = {1, (uint64_t)hexplane->channels, (uint64_t)*height, (uint64_t)*width};
    snprintf(name, sizeof name, "grid.grids.%d.%d", level, plane);
    tides_status status = td_motion_need_field(motion, name, 4, shape, &field, error);
    if (status != TIDES_OK) return status;
    for (int i = 1; i < 4; i++)
        if (field->shape[i] < 1 || field->shape[i] > 65535)
            return td_fail(error, TIDES_BAD_FILE, "hexplane motion: array '%s' has a side of %llu, must be 1 to 65535", name,
                           (unsigned long long)field->shape[i]);
    hexplane->channels = (int)field->shape[1];
    *height = (int)field->shape[2];
    *width = (int)field->shape[3];
    return TIDES_OK;
}

static tides_status measure_grid(const tides_motion *motion, td_hexplane *hexplane, tides_error *error) {
    do {
        int size[4] = {0, 0, 0, hexplane->rows};
        tides_status status = TIDES_OK;
        if (hexplane->levels == TD_HEXPLANE_LEVELS_MAX)
            return td_fail(error, TIDES_BAD_FILE, "hexplane motion: more than %d levels (multires)", TD_HEXPLANE_LEVELS_MAX);
        for (int plane = 0; plane < 6 && status == TIDES_OK; plane++)
            status = measure_plane(motion, hexplane, hexplane->levels, plane, size, error);
        if (status != TIDES_OK) return status;
        memcpy(hexplane->size[hexplane->levels++], size, 3 * sizeof *size);
        hexplane->rows = size[3];
    } while (td_hexplane_plane(motion, hexplane->levels, 0));
    int features = hexplane->levels * td_padded(hexplane->channels, TD_HEXPLANE_CHANNEL_PAD);
    if (features > TD_HEXPLANE_FEATURES_MAX)
        return td_fail(error, TIDES_BAD_FILE, "hexplane motion: %d channels of all levels, at most %d are supported", features,
                       TD_HEXPLANE_FEATURES_MAX);
    return TIDES_OK;
}

/* Measures the trunk, the layers in front of all heads: feature_out.0, and .2, .4 .. if it has more layers. */
static tides_status measure_trunk(const tides_motion *motion, td_hexplane *hexplane, tides_error *error) {
    const td_field *weight = NULL, *bias = NULL;
    char name[48] = "feature_out.0";
    uint64_t inputs = (uint64_t)hexplane->levels * (uint64_t)hexplane->channels, width = 0;
    do {
        tides_status status = td_dense_fields(motion, name, width, inputs, &weight, &bias, error);
        if (status != TIDES_OK) return status;
        inputs = width = weight->shape[0];
        if (width < 1 || width > TD_HEXPLANE_WIDTH_MAX)
            return td_fail(error, TIDES_BAD_FILE, "hexplane motion: array '%s.weight' has %llu rows, must be 1 to %d", name,
                           (unsigned long long)width, TD_HEXPLANE_WIDTH_MAX);
        hexplane->width = (int)width;
        snprintf(name, sizeof name, "feature_out.%d.weight", 2 * ++hexplane->layers);
    } while (td_motion_field(motion, name) && (*strrchr(name, '.') = '\0', 1));
    return TIDES_OK;
}

int td_hexplane_has_heads(const tides_motion *motion) {
    for (int head = 0; head < TD_HEADS; head++)
        if (td_motion_setting(motion, head_flags[head], 0) == 0) return 1;
    return 0;
}

static tides_status measure_heads(const tides_motion *motion, td_hexplane *hexplane, tides_error *error) {
    const td_field *weight = NULL, *bias = NULL;
    uint64_t width = (uint64_t)hexplane->width;
    char name[48];
    for (int head = 0; head < TD_HEADS; head++) {
        if (td_motion_setting(motion, head_flags[head], 0) != 0) continue;
        snprintf(name, sizeof name, "%s.1", td_hexplane_heads[head]);
        tides_status status = td_dense_fields(motion, name, width, width, &weight, &bias, error);
        snprintf(name, sizeof name, "%s.3", td_hexplane_heads[head]);
        if (status == TIDES_OK) status = td_dense_fields(motion, name, head_outputs[head], width, &weight, &bias, error);
        if (status != TIDES_OK) return status;
        hexplane->heads |= 1 << head;
    }
    hexplane->turns = td_motion_setting(motion, "apply_rotation", 0) != 0 && (hexplane->heads & TD_HEAD_ROTATION);
    return TIDES_OK;
}

static tides_status measure_box(const tides_motion *motion, tides_error *error) {
    const uint64_t shape[2] = {2, 3};
    const td_field *box = NULL;
    tides_status status = td_motion_need_field(motion, "grid.aabb", 2, shape, &box, error);
    for (int i = 0; i < 3 && status == TIDES_OK; i++)
        if (box->value[i] == box->value[3 + i])
            status =
                td_fail(error, TIDES_BAD_FILE, "hexplane motion: array 'grid.aabb' is a box without extent along %c", "xyz"[i]);
    return status;
}

tides_status td_hexplane_measure(const tides_motion *motion, td_hexplane *hexplane, tides_error *error) {
    memset(hexplane, 0, sizeof *hexplane);
    tides_status status = measure_box(motion, error);
    if (status == TIDES_OK) status = measure_grid(motion, hexplane, error);
    if (status == TIDES_OK) status = measure_trunk(motion, hexplane, error);
    if (status == TIDES_OK) status = measure_heads(motion, hexplane, error);
    return status;
}
