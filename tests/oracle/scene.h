/* The oracle's scenes. The oracle is a second simulator for tests: scenes, motion, image formation and comparator in double
 * precision, written from docs/ and the papers. It shares no code with the library, and includes none of its headers.
 *
 * Numbers of Gaussians are those of single precision, widened: what the library is given of them is the same. */
#ifndef TESTS_ORACLE_SCENE_H
#define TESTS_ORACLE_SCENE_H

#include "tests/oracle/curve.h"

enum { ORACLE_SH = 16, ORACLE_OBJECTS = 48 };

/* A Gaussian, raw: logarithms of scales, a logit, spherical harmonics (coefficient, then r g b). */
typedef struct oracle_splat {
    double mean[3], quaternion[4], log_scale[3], logit, sh[ORACLE_SH][3];
} oracle_splat;

/* Its numbers one after the other, and where each part begins. */
enum {
    ORACLE_MEAN = 0,
    ORACLE_QUATERNION = 3,
    ORACLE_LOG_SCALE = 7,
    ORACLE_LOGIT = 10,
    ORACLE_COLOUR = 11,
    ORACLE_NUMBERS = 59
};

/* Parts that keyframes change. */
enum { ORACLE_MOVES_MEAN = 1, ORACLE_MOVES_OPACITY = 2, ORACLE_MOVES_SH = 4, ORACLE_MOVES_SCALE = 8 };

/* Gaussians that move as one, and, where they have keyframes, each by itself. */
typedef struct oracle_object {
    oracle_curve path; /* (7) position, quaternion wxyz: object to world; no samples: at rest in the origin */
    int degree, count, capacity, moves;
    oracle_splat *splat;
    oracle_curve keys;   /* (count x ORACLE_NUMBERS), with `moves` */
    double (*factor)[9]; /* rotation times scales of each as it is at rest, */
    double *opacity;     /* and opacity */
} oracle_object;

typedef struct oracle_scene {
    char kind[32];
    unsigned long long seed;
    double share; /* of a kind's width: 1, or less for small images */
    int width, height;
    int coded; /* colours are display-referred, coded as sRGB: composited as they are, and decoded then */
    double focal, background, log_eps, threshold_on, threshold_off, leak_hz, stop;
    oracle_curve camera; /* (7) camera to world, OpenCV axes; no samples: in the origin */
    oracle_object object[ORACLE_OBJECTS];
    int objects;
    int splats;       /* of all objects, numbered through; */
    int *owner, *own; /* (splats) the object of each, and its number there */
    double spacing;   /* [s] of the samples that the event finder begins with */
} oracle_scene;

/* Appends a Gaussian to an object, its numbers rounded to single precision. */
void oracle_object_add(oracle_object *object, const oracle_splat *splat);
/* Keyframes for all Gaussians of an object: room for `frames` of them, filled with the Gaussians as they are. */
void oracle_object_key(oracle_object *object, int moves, int frames, int law);
/* The numbers of Gaussian i at a frame, to be changed before oracle_scene_finish. */
oracle_splat *oracle_object_frame(oracle_object *object, int frame, int i);
/* A path with room for samples, at rest in the origin. */
oracle_curve oracle_path_make(int count, int law);

/* Works out what is derived: slopes, factors, numbers. */
void oracle_scene_finish(oracle_scene *scene);
void oracle_scene_free(oracle_scene *scene);

#endif
