/* Internal: the structure of a network motion, found from the shapes of its arrays.
 *
 * Arrays have the names and shapes of Deformable-3D-Gaussians' deform.pth, each .weight with a .bias:
 *   linear.{0, 1, ..}.weight (width x inputs), gaussian_rotation.weight (4 x width), gaussian_scaling.weight (3 x width),
 *   gaussian_warp.weight (3 x width), or for a rigid motion (is_6dof) branch_w.weight and branch_v.weight (3 x width),
 *   and for Blender scenes the small network over the time, timenet.{0, 2}.weight.
 * Setting: position_octaves (10), the sines and cosines of a mean. Own time is the trainer's t in [0, 1]. */
#ifndef TD_NETWORK_H
#define TD_NETWORK_H

#include "td_motion.h"

#include "kernels/motion_network.h"

/* Trainers use 6 octaves for Blender scenes, else 10. With 40, rounding would leave no digits of the time. */
enum { TD_OCTAVES_MAX = 30, TD_TIME_WIDTH_MAX = 1024, TD_POSITION_OCTAVES = 10 };

typedef struct td_network {
    int width, layers;
    int skip;                 /* the layer that gets the inputs again; 0: none */
    int positions, times;     /* numbers of inputs from mean and time */
    int screw;                /* 1: is_6dof */
    int time_width, time_sum; /* hidden values and inputs of timenet; 0: it has none */
} td_network;

/* Measures a motion. TIDES_BAD_FILE names the array that is missing or doesn't fit, or a size beyond the kernels' limits. */
tides_status td_network_measure(const tides_motion *motion, td_network *network, tides_error *error);

/* Names of the heads in the order of their weights, NULL at the end. */
const char *const *td_network_heads(const td_network *network);

/* Computes v, sin v, cos v, sin 2 v, cos 2 v .. up to 2^(octaves - 1), for `count` numbers side by side, (1 + 2 octaves)
 * count in all. `rate` (may be NULL): their derivatives by v. */
void td_network_embed(const double *number, int count, int octaves, double *value, double *rate);

/* The pack function of the class. */
tides_status td_network_pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                             tides_error *error);

extern const td_motion_class td_network_class;

#endif
