/* Test support: seeded random networks of 4DGaussians and Deformable-3DGS, and Gaussians for them. Memory errors abort. */
#ifndef TESTS_SUPPORT_RANDOM_NETWORK_H
#define TESTS_SUPPORT_RANDOM_NETWORK_H

#include "motion/td_motion.h"

typedef struct random_gaussians {
    tides_gaussians view;
    float *values; /* owned; the view points into it */
} random_gaussians;

/* Means uniform in a box of half side `spread` around the origin. */
random_gaussians random_gaussians_make(uint64_t seed, int count, int sh_degree, double spread);
void random_gaussians_free(random_gaussians *gaussians);

/* 4DGaussians; its box is the cube from +1.6 to -1.6. */
typedef struct random_hexplane_recipe {
    uint64_t seed;
    int channels, size[4]; /* x y z t, of the first level */
    int levels;            /* level l has (l + 1) times the first's size in space */
    int width, layers;     /* layers of the trunk: 1 or more */
    int heads;             /* bits TD_HEAD_... */
    int turns;             /* apply_rotation */
    double strength;       /* of the last layers: order of what they add */
} random_hexplane_recipe;

/* D-NeRF's configuration: 32 channels, 64 64 64 75, 2 levels, width 64, 1 layer, mean scale rotation. */
random_hexplane_recipe random_hexplane_defaults(uint64_t seed);
tides_motion *random_hexplane_make(const random_hexplane_recipe *recipe);

/* Deformable-3DGS. */
typedef struct random_network_recipe {
    uint64_t seed;
    int width, layers, skip; /* skip: the layer that gets the inputs once more */
    int octaves;             /* of the time */
    int time_width, times;   /* of a network over the time; 0: none */
    int screw;               /* is_6dof */
    double strength;         /* of the last layers: order of what they add */
} random_network_recipe;

/* The trainer's: width 256, 8 layers, inputs again at 5, 10 octaves. */
random_network_recipe random_network_defaults(uint64_t seed);
tides_motion *random_network_make(const random_network_recipe *recipe);

/* Adds an array of uniform numbers in [-1, 1] * strength + offset. */
void random_field(tides_motion *motion, uint64_t *state, const char *name, int rank, const uint64_t *shape, double strength,
                  double offset);

#endif
