/* Scenes that frames and runs are timed on (bench_worlds.c). */
#ifndef CLI_BENCH_WORLDS_H
#define CLI_BENCH_WORLDS_H

#include "bench.h"

/* Names of the built-in ones, NULL-terminated; another name is one of bench_scene_names, or a file. */
const char *const *bench_world_names(void);
tides_status bench_world_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error);

/* Random splats in a cube of 2, as dense whatever their number; flat ones on spheres, which cover them whatever their
 * number. */
tides_status bench_add_random(tides_scene *scene, int64_t count, tides_error *error);
tides_status bench_add_surfaces(tides_scene *scene, int64_t count, tides_error *error);
/* A camera in orbit about all that is there. */
tides_status bench_orbit_all(bench_scene *scene, double rad_per_s, tides_error *error);
/* Another size, with 45 degrees from top to bottom. */
void bench_resize(bench_scene *scene, int32_t width, int32_t height);

#endif
