/* Test support: Gaussians that a deformation network moves, before a camera that moves. */
#ifndef TESTS_PROPERTY_NETWORK_SCENE_H
#define TESTS_PROPERTY_NETWORK_SCENE_H

#include "renderer_of.h"
#include "tests/support/random_network.h"

typedef struct network_scene {
    random_scene base; /* camera and path */
    random_gaussians gaussians;
    tides_scene *scene;
} network_scene;

/* A HexPlane model of small sizes, whose time planes have a knot every 1/12 of the second that the motion lasts. */
static inline network_scene network_scene_make(uint64_t seed, double strength) {
    network_scene made;
    tides_error error;
    random_recipe recipe = recipe_of(seed);
    random_hexplane_recipe network = random_hexplane_defaults(seed);
    network.channels = 8, network.width = 16, network.levels = 1, network.strength = strength;
    for (int k = 0; k < 4; k++) network.size[k] = 13;
    recipe.camera_speed = 0.3;
    made.base = random_scene_make(&recipe);
    made.gaussians = random_gaussians_make(seed, 300, 1, 1.2);
    made.scene = NULL;
    scene_expect_ok(tides_scene_create(&made.scene, &error), &error);
    scene_expect_ok(tides_scene_add_moving(made.scene, &made.gaussians.view, random_hexplane_make(&network), 1, NULL, 1, NULL,
                                           NULL, &error),
                    &error);
    return made;
}

static inline void network_scene_free(network_scene *s) {
    tides_scene_destroy(s->scene);
    random_gaussians_free(&s->gaussians);
    random_scene_free(&s->base);
}

#endif
