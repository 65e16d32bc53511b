/* Scenes that frames and runs are timed on (bench_worlds.c). */
#ifndef CLI_BENCH_WORLDS_H
#define CLI_BENCH_WORLDS_H

#include "bench.h"

/* Names of the built-in ones, NULL-terminated; another name is one of bench_scene_names, or a file. */
const char *const *bench_world_names(void);
tides_status bench_world_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error);

/* The demo's world, which lasts so long [s]; 0: as the demo's does. */
tides_status bench_make_demo(double duration_s, bench_scene *scene, tides_error *error);

/* Random splats in a cube of 2, as dense whatever their number; flat ones on spheres, which cover them whatever their
 * number. */
tides_status bench_add_random(tides_scene *scene, int64_t count, tides_error *error);
tides_status bench_add_surfaces(tides_scene *scene, int64_t count, tides_error *error);
/* The former and `others` in a cube about `at`, as one object in which they come by turns, as they may in a file. */
tides_status bench_add_random_apart(tides_scene *scene, int64_t count, int64_t others, const double at[3], tides_error *error);

/* Textured rectangles side by side, which fill the view of a camera that faces them: splats in rows, or in several layers,
 * their rows shifted. */
typedef struct bench_patch {
    int32_t columns, rows, layers;
    double apart;     /* between layers [scene units] */
    double spacing;   /* of splats [scene units], */
    double width;     /* and their sigma over it */
    double opacity;   /* in (0, 1) */
    int32_t swinging; /* so many of the rectangles go to and fro */
} bench_patch;
tides_status bench_add_patches(tides_scene *scene, const bench_patch *patch, tides_error *error);
/* A camera at rest before them, and one that passes by. */
tides_status bench_face_patches(bench_scene *scene, tides_error *error);
tides_status bench_pass_patches(bench_scene *scene, tides_error *error);
/* A camera in orbit about all that is there. */
tides_status bench_orbit_all(bench_scene *scene, double rad_per_s, tides_error *error);
/* Another size, with 45 degrees from top to bottom. */
void bench_resize(bench_scene *scene, int32_t width, int32_t height);

#endif
