/* The oracle's scenes. The oracle is a second simulator for tests: scenes, motion, image formation and comparator in double
 * precision, written from docs/ and the papers. It shares no code with the library, and includes none of its headers.
 *
 * The numbers of Gaussians are rounded to single precision, so that the library gets the same values. */
#ifndef TESTS_ORACLE_SCENE_H
#define TESTS_ORACLE_SCENE_H

#include "tests/oracle/curve.h"

enum { ORACLE_SH = 16, ORACLE_OBJECTS = 48 };

/* A Gaussian, raw: logarithms of scales, a logit, spherical harmonics (coefficient, then r g b). */
typedef struct oracle_splat {
    double mean[3], quaternion[4], log_scale[3], logit, sh[ORACLE_SH][3];
} oracle_splat;

/* An oracle_splat is ORACLE_NUMBERS doubles; its parts begin at these. */
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

/* Gaussians that move together along `path`, and with keyframes each by itself. */
typedef struct oracle_object {
    oracle_curve path; /* (7) position, quaternion wxyz: object to world; without samples: at the origin */
    int degree, count, capacity, moves;
    oracle_splat *splat;
    oracle_curve keys;   /* (count x ORACLE_NUMBERS), with `moves` */
    double (*factor)[9]; /* (count) rotation times scales, at rest */
    double *opacity;     /* (count) opacity, at rest */
} oracle_object;

typedef struct oracle_scene {
    char kind[32];
    unsigned long long seed;
    double share; /* factor on the image's width: 1, or less for small images */
    int width, height;
    int coded; /* 1: colours are coded as sRGB; they are composited so, and decoded afterwards */
    double focal, background, log_eps, threshold_on, threshold_off, leak_hz, stop;
    oracle_curve camera; /* (7) camera to world, OpenCV axes; without samples: at the origin */
    oracle_object object[ORACLE_OBJECTS];
    int objects;
    int splats;       /* number of splats of all objects */
    int *owner, *own; /* (splats) each one's object, and its number in it */
    double spacing;   /* [s] between the samples that the event finder begins with */
} oracle_scene;

/* Appends a Gaussian to an object, its numbers rounded to single precision. */
void oracle_object_add(oracle_object *object, const oracle_splat *splat);
/* Keyframes for all Gaussians of an object: room for `frames` of them, filled with the Gaussians as they are. */
void oracle_object_key(oracle_object *object, int moves, int frames, int law);
/* The numbers of Gaussian i at a frame, to be changed before oracle_scene_finish. */
oracle_splat *oracle_object_frame(oracle_object *object, int frame, int i);
/* A path with room for samples, at rest in the origin. */
oracle_curve oracle_path_make(int count, int law);

/* Computes what follows from the rest: slopes, factors, opacities, the splats' numbers. */
void oracle_scene_finish(oracle_scene *scene);
void oracle_scene_free(oracle_scene *scene);

#endif
