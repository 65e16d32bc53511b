/* Test support: renderers of random scenes, for the properties of images and of candidate lists. */
#ifndef TESTS_PROPERTY_RENDERER_OF_H
#define TESTS_PROPERTY_RENDERER_OF_H

#include "render/td_renderer.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

enum { RULES = 3 };

static inline tides_device *open_device(const char *spec) {
    tides_device *device = NULL;
    tides_error error;
    scene_expect_ok(tides_device_open(spec, &device, &error), &error);
    return device;
}

/* The OpenCL CPU device, or the reference where there's none. */
static inline tides_device *open_fast_device(void) {
    tides_device *device = NULL;
    return tides_device_open("cpu", &device, NULL) == TIDES_OK ? device : open_device("reference-f32");
}

static inline tides_renderer *make_renderer(tides_device *device, const tides_scene *scene, const tides_intrinsics *camera,
                                            int rules) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.rules = rules;
    params.background[1] = 0.2;
    scene_expect_ok(tides_renderer_create(device, scene, camera, &params, NULL, NULL, &renderer, &error), &error);
    return renderer;
}

static inline random_recipe recipe_of(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.count = 120;
    recipe.objects = 3;
    recipe.sh_degree = 1;
    recipe.width = 61;
    recipe.height = 43;
    return recipe;
}

#endif
