/* Test support: seeded scenes in which Gaussians move by themselves, as objects of several kinds: at rest, polynomial, and rows
 * from the host with a knot; rigid motion and scale on top. Some Gaussians of the moving objects rest. */
#ifndef TESTS_SUPPORT_MOVING_SCENE_H
#define TESTS_SUPPORT_MOVING_SCENE_H

#include "tests/support/random_scene.h"

/* The motion "bent", which the host computes: the mean moves on a straight line with a bend at the knot; colour (SH) and
 * opacity change with time. Own time is [2, 5], the knot at 2 + 3 MOVING_KNOT. Gaussians whose number is a multiple of 3
 * rest. */
tides_motion *bent_motion_make(uint64_t seed, double speed);

#define MOVING_KNOT 0.4375 /* of the duration */

/* A polynomial for `count` Gaussians with means of about `speed` per unit of own time, [0, 1]; every fourth rests. */
tides_motion *polynomial_motion_make(uint64_t seed, int64_t count, double speed);

typedef struct moving_scene {
    random_scene base; /* camera and path; its scene has the objects without motions */
    tides_scene *scene;
} moving_scene;

/* Objects 0 (at rest), 1 (polynomial, rigid motion), 2 (bent, rigid motion); all motions last 1 s. */
moving_scene moving_scene_make(const random_recipe *recipe, double speed);
/* A small scene for runs: 43x37 px, a moving camera, SH of degree 1, motions of speed 1. */
moving_scene moving_scene_small(uint64_t seed);
void moving_scene_free(moving_scene *scene);

#endif
