/* Test support: glTF files of splats, piece by piece and without the library's code. */
#ifndef TESTS_SUPPORT_GLTF_MAKE_H
#define TESTS_SUPPORT_GLTF_MAKE_H

#include "tests/support/splat_make.h"

enum { GLTF_COUNT = 3, GLTF_ROOM = 1 << 14 };

/* What a test may change. */
typedef struct gltf_recipe {
    int degree;
    const char *find, *replacement; /* in the JSON, once; NULL: nothing */
    int logarithms;                 /* of scales: 1 */
} gltf_recipe;

/* Number c of Gaussian i's attribute: POSITION, ROTATION, SCALE, OPACITY, then coefficients of SH. */
double gltf_value(int attribute, int i, int c);

/* Its only buffer, all attributes as floats, one after the other; the JSON, with `buffer` in that one's description. */
scene_bytes gltf_binary(const gltf_recipe *r);
scene_bytes gltf_text(const gltf_recipe *r, const char *buffer);

/* A binary file of the two, which are freed. */
scene_bytes gltf_glb_of(scene_bytes json, scene_bytes chunk);
scene_bytes gltf_glb(const gltf_recipe *r);

#endif
