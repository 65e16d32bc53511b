/* Reads 4DGaussians (Wu et al. 2024): point_cloud.ply, deformation.pth beside it, and training options from cfg_args. */
#include "archive/td_pickle.h"
#include "motion/td_hexplane.h"
#include "scene/td_method_arrays.h"
#include "scene/td_method_networks.h"

#include <string.h>

/* Options that TIDES supports, with the trainer's defaults for files that lack them. */
static const struct {
    const char *key;
    double fallback;
} options[] = {{"no_dx", 0}, {"no_ds", 0}, {"no_dr", 0}, {"no_do", 1}, {"no_dshs", 1}, {"apply_rotation", 0}};

/* Options that need a different network: refused. */
static const char *const refused[] = {"no_grid", "static_mlp", "empty_voxel"};

static tides_status set_options(tides_motion *motion, const td_model_dir *dir, tides_error *error) {
    tides_status status = TIDES_OK;
    if (!dir->cfg)
        return td_fail(error, TIDES_BAD_FILE, "%s: there is no cfg_args, which says what the network changes", dir->folder);
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        if (td_method_option(dir, refused[i], 0) != 0)
            return td_fail(error, TIDES_UNSUPPORTED, "cfg_args: models trained with %s are not supported", refused[i]);
    for (size_t i = 0; i < sizeof options / sizeof *options && status == TIDES_OK; i++)
        status = td_motion_set(motion, options[i].key, td_method_option(dir, options[i].key, options[i].fallback) != 0, error);
    return status;
}

/* 1 for arrays that are needed: the grid, the trunk, and heads that are on. The file has all five heads, and unused ones may
 * be large. */
static int wanted(const tides_motion *motion, const char *name) {
    static const char *const flags[TD_HEADS] = {"no_dx", "no_ds", "no_dr", "no_do", "no_dshs"};
    for (int head = 0; head < TD_HEADS; head++)
        if (strncmp(name, td_hexplane_heads[head], strlen(td_hexplane_heads[head])) == 0)
            return td_motion_setting(motion, flags[head], 0) == 0;
    return strcmp(name, "grid.aabb") == 0 || strncmp(name, "grid.grids.", 11) == 0 || strncmp(name, "feature_out.", 12) == 0;
}

tides_status td_fourdgs_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    td_tree *tree = NULL;
    td_gaussians points = {0};
    tides_motion *made = NULL;
    tides_status status = td_method_points(dir, &points, error);
    if (status != TIDES_OK) return status;
    status = td_motion_create(&td_hexplane_class, 0, 1, &made, error);
    if (status == TIDES_OK) status = set_options(made, dir, error);
    if (status == TIDES_OK) status = td_torch_open(dir->weights, &tree, error);
    if (status == TIDES_OK) status = td_method_fields(made, td_tree_root(tree), "deformation_net.", wanted, error);
    td_tree_free(tree);
    return td_arrays_finish(status, dir->weights, &points, made, gaussians, motion, error);
}
