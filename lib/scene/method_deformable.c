/* Reads Deformable-3D-Gaussians (Yang et al. 2024): point_cloud.ply and deform.pth. The shapes of the arrays show all
 * options. */
#include "archive/td_pickle.h"
#include "motion/td_network.h"
#include "scene/td_method_arrays.h"
#include "scene/td_method_networks.h"

#include <string.h>

static int wanted(const tides_motion *motion, const char *name) {
    static const char *const parts[] = {"linear.", "timenet.", "gaussian_", "branch_"};
    (void)motion;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (strncmp(name, parts[i], strlen(parts[i])) == 0) return 1;
    return 0;
}

tides_status td_deformable_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    td_tree *tree = NULL;
    td_gaussians points = {0};
    tides_motion *made = NULL;
    tides_status status = td_method_points(dir, &points, error);
    if (status != TIDES_OK) return status;
    status = td_motion_create(&td_network_class, 0, 1, &made, error);
    if (status == TIDES_OK) status = td_torch_open(dir->weights, &tree, error);
    if (status == TIDES_OK) status = td_method_fields(made, td_tree_root(tree), "", wanted, error);
    td_tree_free(tree);
    return td_arrays_finish(status, dir->weights, &points, made, gaussians, motion, error);
}
