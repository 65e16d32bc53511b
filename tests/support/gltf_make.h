/* Test support: glTF files of splats, piece by piece and without the library's code. */
#ifndef TESTS_SUPPORT_GLTF_MAKE_H
#define TESTS_SUPPORT_GLTF_MAKE_H

#include "tests/support/splat_make.h"

enum { GLTF_COUNT = 3, GLTF_ROOM = 1 << 14 };

/* The file to make. A test changes fields of a plain one, {0}. */
typedef struct gltf_recipe {
    int degree;
    const char *find, *replacement; /* replaced once in the JSON; NULL: nothing */
    int logarithms;                 /* 1: scales are logarithms */
} gltf_recipe;

/* Number c of an attribute of Gaussian i. Attributes: 0 POSITION, 1 ROTATION, 2 SCALE, 3 OPACITY, then coefficients of SH. */
double gltf_value(int attribute, int i, int c);

/* The file's only buffer: all attributes as floats, one after the other. Then its JSON, with the text `buffer` in the
 * description of that buffer. */
scene_bytes gltf_binary(const gltf_recipe *r);
scene_bytes gltf_text(const gltf_recipe *r, const char *buffer);

/* A .glb file of both parts, which are freed. */
scene_bytes gltf_glb_of(scene_bytes json, scene_bytes chunk);
scene_bytes gltf_glb(const gltf_recipe *r);

/* td_gltf_parse of the default scene, refusing what is out of range. */
tides_status gltf_parse(const char *path, const void *data, size_t size, td_gaussians *g, tides_error *error);

#endif
