/* Scenes ("worlds") for benchmarks that time frames and runs (bench_worlds.c). */
#ifndef CLI_BENCH_WORLDS_H
#define CLI_BENCH_WORLDS_H

#include "bench.h"

/* Names of the built-in worlds, NULL-terminated. */
const char *const *bench_world_names(void);
/* Makes the world `name`: a built-in one, a scene of bench_scene_names, or the splat file of this path. */
tides_status bench_world_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error);

/* The world of the demo, `fan` of tides_generate. It lasts duration_s; with 0, it lasts as long as the demo. */
tides_status bench_make_demo(double duration_s, bench_scene *scene, tides_error *error);

/* bench_add_random adds splats at random places in the cube [-1, 1]^3, bench_add_surfaces flat splats on spheres. The size of
 * the splats shrinks with their number, so that the cube is equally dense and the spheres are equally covered at any number. */
tides_status bench_add_random(tides_scene *scene, int64_t count, tides_error *error);
tides_status bench_add_surfaces(tides_scene *scene, int64_t count, tides_error *error);
/* Adds the splats of bench_add_random, and a second cube of `others` splats, shifted by `at`. Both cubes are one object, whose
 * list of splats mixes them evenly, as a splat file may do. */
tides_status bench_add_random_apart(tides_scene *scene, int64_t count, int64_t others, const double at[3], tides_error *error);

/* Textured rectangles (patches) side by side, which fill the view of the camera that faces them. A patch is one or more
 * layers of splats on a square grid. Each layer is shifted at random within one grid spacing. */
typedef struct bench_patch {
    int32_t columns, rows, layers; /* patches across and down; layers of a patch */
    double apart;                  /* distance between layers [scene units] */
    double spacing;                /* distance between neighbouring splats of a layer [scene units] */
    double width;                  /* sigma of a splat along the patch, in units of `spacing` */
    double opacity;                /* in (0, 1) */
    int32_t swinging;              /* number of patches that swing to and fro; the others rest */
} bench_patch;
tides_status bench_add_patches(tides_scene *scene, const bench_patch *patch, tides_error *error);
/* bench_face_patches gives the scene a camera at rest that faces the patches. bench_pass_patches gives it a camera that moves
 * past them, and looks at their middle. */
tides_status bench_face_patches(bench_scene *scene, tides_error *error);
tides_status bench_pass_patches(bench_scene *scene, tides_error *error);
/* Gives the scene a camera in orbit about the middle of its bounding box. */
tides_status bench_orbit_all(bench_scene *scene, double rad_per_s, tides_error *error);
/* Sets the size of the image [px], with a field of view of 45 degrees from top to bottom. */
void bench_resize(bench_scene *scene, int32_t width, int32_t height);

#endif
