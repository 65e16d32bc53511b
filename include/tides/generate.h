/* Worlds made by the library: scenes with a matching camera, for tests, demos and first steps.
 *
 * The same options give the same numbers on one machine; on others, the last digits of sines may differ. Units are metres; y
 * is up, and cameras look along -z. */
#ifndef TIDES_GENERATE_H
#define TIDES_GENERATE_H

#include "tides/camera.h"
#include "tides/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A kind of world, and its defaults. */
typedef struct tides_generator {
    const char *name;     /* "fan" */
    const char *sentence; /* what is to be seen */
    const char *counted;  /* what options.count counts: "balls"; NULL: nothing */
    int32_t count;        /* default count; 0 if `counted` is NULL */
    int32_t count_most;   /* largest options.count */
    int64_t gaussians;    /* default number for each moving object (the plane, the fan's blades); 0: can't be chosen */
    double duration_s;    /* default duration of motions and path [s] */
} tides_generator;

/* All kinds; static storage, `count` (nullable) receives how many. */
TIDES_API const tides_generator *tides_generators(size_t *count);

/* Options of a generated world; fill with tides_generate_options_defaults. */
typedef struct tides_generate_options {
    uint32_t size;         /* sizeof this struct, set by the defaults function */
    int32_t count;         /* number of what the kind counts; 0: its default */
    int64_t gaussians;     /* about the number for each moving object (its grids are rounded); 0: the kind's default */
    double duration_s;     /* duration of motions and camera path, from second 0 [s], up to 600; 0: the kind's default */
    double speed;          /* objects (of the plane: the camera) are this many times as fast, in (0, 1000] */
    uint64_t seed;         /* of colours, places, phases and the camera's shake */
    int32_t width, height; /* of the image [px]; the field of view is always 60 degrees across */
} tides_generate_options;
TIDES_API void tides_generate_options_defaults(tides_generate_options *options); /* 0, 0, 0, 1, 1, 346, 260 */

/* A generated world. The caller releases it. */
typedef struct tides_world {
    tides_scene *scene;          /* with its objects' motions */
    tides_trajectory *camera;    /* the path of a camera that sees the scene */
    tides_intrinsics intrinsics; /* of that camera */
    double background[3];        /* for scene.background: linear r g b */
    double duration_s;           /* of motions and path [s] */
} tides_world;

/* Makes a world of `kind`. TIDES_BAD_ARGUMENT: an unknown kind (the nearest is named), options out of range or that the kind
 * doesn't have, more than 20 million Gaussians. */
TIDES_MUST_CHECK TIDES_API tides_status tides_generate(const char *kind, const tides_generate_options *options,
                                                       tides_world *world, tides_error *error);

/* Destroys scene and path, and zeroes the struct, so that it may be called twice. */
TIDES_API void tides_world_release(tides_world *world);

#ifdef __cplusplus
}
#endif
#endif
