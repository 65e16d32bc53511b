/* Internal: the structure of a HexPlane motion, found from the shapes of its arrays.
 *
 * Arrays have the names and shapes of 4DGaussians' deformation.pth, without the leading "deformation_net.":
 *   grid.aabb (2 x 3), grid.grids.LEVEL.PLANE (1 x C x size[j] x size[i]) for plane (i, j) = xy xz xt yz yt zt,
 *   feature_out.{0, 2, ..}.weight (width x inputs) and .bias: the trunk,
 *   {pos, scales, rotations, opacity, shs}_deform.{1, 3}.weight and .bias: the heads; one that is off may be missing.
 * Settings: no_dx, no_ds, no_dr, no_do, no_dshs, apply_rotation (0 or 1). Own time is the trainer's t in [0, 1]. */
#ifndef TD_HEXPLANE_H
#define TD_HEXPLANE_H

#include "td_motion.h"

#include "kernels/motion_hexplane.h"

typedef struct td_hexplane {
    int levels, channels;
    int rows;                            /* of the time axis, which runs from t = -1 to 1 */
    int size[TD_HEXPLANE_LEVELS_MAX][3]; /* of x, y, z */
    int width, layers;                   /* hidden values; number of layers of the trunk */
    int heads;                           /* TD_HEAD_* bits of the heads that are on */
    int turns;                           /* 1: apply_rotation is set, and the head of rotations is on */
} td_hexplane;

/* Measures a motion. TIDES_BAD_FILE names the array that is missing or doesn't fit, or a size beyond the kernels' limits. */
tides_status td_hexplane_measure(const tides_motion *motion, td_hexplane *hexplane, tides_error *error);

/* 1 if a head is on by the settings. */
int td_hexplane_has_heads(const tides_motion *motion);

/* The array of plane 0 .. 5; not NULL after a successful measurement. */
const td_field *td_hexplane_plane(const tides_motion *motion, int level, int plane);

/* The field names of heads 0 .. 4, without ".1.weight". */
extern const char *const td_hexplane_heads[TD_HEADS];

/* The first row of the time axis that is needed for t >= 0. */
static inline int td_hexplane_first_row(int rows) { return (rows - 1) / 2; }

/* The pack function of the class. */
tides_status td_hexplane_pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                              tides_error *error);

extern const td_motion_class td_hexplane_class;

#endif
