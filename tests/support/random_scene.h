/* Test support: seeded random scenes for the renderer's tests: Gaussians of several rigid objects, at rest or with every raw
 * parameter moving, seen by a moving camera, in front of a changing backdrop; as the numbers that a td_backend takes.
 *
 * Everything is a smooth function of time with its exact rate, so a scene can be rendered at any time and differenced. Errors
 * fail the running cmocka test. This header may be included in either precision: reals pass as doubles. */
#ifndef TESTS_SUPPORT_RANDOM_SCENE_H
#define TESTS_SUPPORT_RANDOM_SCENE_H

#include "render/td_backend.h"
#include "tides/session.h"

/* The scene to make. The camera is near (0, 0, -4) and looks along +z; means fill a box around the origin. */
typedef struct random_recipe {
    uint64_t seed;
    int count, objects; /* Gaussians in all; objects >= 1, each with its share: 0 at rest, the others moving and scaled */
    int sh_degree;      /* 0..4 */
    int moving;         /* 1: raw parameters have rates (of the order of `speed`), and the store holds them */
    int width, height;  /* [px] */
    double spread;      /* half a side of the box [scene units]; from 4 on, some are at and behind the camera */
    double size;        /* typical standard deviation [scene units]; each axis 1/3 to 3 times that */
    double opacity_min, opacity_max; /* in (0, 1) */
    double speed;                    /* of raw parameters [1/s] */
    int lens;                        /* TIDES_LENS_*: a strong one of the kind, equidistant as wide as 150 degrees */
    double camera_speed;             /* [scene units/s] and [rad/s], roughly; 0: at rest */
} random_recipe;

/* 60 Gaussians of degree 3 in 1 object at rest, 64x48 px, spread 1.5, size 0.12, opacity 0.1 to 0.9, both speeds 1. */
random_recipe random_recipe_defaults(uint64_t seed);

typedef struct random_scene {
    random_recipe recipe;
    tides_intrinsics camera;
    tides_scene *scene;     /* state at time 0, objects with their trajectories */
    tides_trajectory *path; /* the camera's, for times in [0, 1]; samples every 0.25 s */
    int parameters;         /* raw parameters per Gaussian, in the order of RANDOM_MEAN .. RANDOM_SH */
    double *raw[3];         /* (count x parameters): value at time 0, rate there, second derivative */
} random_scene;
enum { RANDOM_MEAN = 0, RANDOM_LOG_SCALE = 3, RANDOM_QUATERNION = 6, RANDOM_LOGIT = 10, RANDOM_SH = 11 };

random_scene random_scene_make(const random_recipe *recipe);
void random_scene_free(random_scene *scene);

/* The store at `time`: with rates and sh_wide where the scene is moving, else what td_store_create makes of the scene, with SH
 * in float. Freed with td_store_release. */
td_store random_scene_store(const random_scene *scene, double time);

/* Views at `slots` times in [0, 1]: (slots x objects x TD_VIEW_REALS); backdrops: (slots x TD_BACKDROP_REALS), changing with
 * time where the scene is moving. Freed with free(). */
double *random_scene_views(const random_scene *scene, const double *times, int slots);
double *random_scene_backdrops(const random_scene *scene, const double *times, int slots);

/* The image's numbers for rules TIDES_RULES_* (td_image_resolve), outputs and objects set. */
td_image_numbers random_scene_image(const random_scene *scene, int rules, int antialias, int outputs);

/* The same image of colours that code light as TIDES_TRANSFER_* and an exponent say. */
td_image_numbers random_scene_coded(const td_image_numbers *image, int transfer, double gamma);

/* A session of the scene by a run file's text, which names "scene.h5" and "path.json". All three files are written into
 * `folder`. The caller closes it. */
tides_session *random_scene_session(void *folder, const random_scene *scene, const char *run, const char *const *sets,
                                    size_t count);

#endif
