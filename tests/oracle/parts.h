/* Parts of random scenes: random numbers, splats, paths. */
#ifndef TESTS_ORACLE_PARTS_H
#define TESTS_ORACLE_PARTS_H

#include "tests/oracle/scene.h"

#define PARTS_PI 3.14159265358979323846

typedef unsigned long long parts_seed;
double parts_between(parts_seed *seed, double low, double high);
double parts_log(parts_seed *seed, double low, double high);
int parts_one_of(parts_seed *seed, int count);
double parts_sign(parts_seed *seed);

/* A grey Gaussian, round, at a place. */
oracle_splat parts_splat(double x, double y, double z, double scale, double opacity, double light);
void parts_set_light(oracle_splat *splat, double light);
void parts_set_opacity(oracle_splat *splat, double opacity);
void parts_colour(oracle_splat *splat, parts_seed *seed, double low, double high);
/* A random rotation and scales from low to high. */
void parts_shape(oracle_splat *splat, parts_seed *seed, double low, double high);

/* The next object of a scene. */
oracle_object *parts_object(oracle_scene *scene);
/* `count` random splats in a box about (0, 0, depth). */
void parts_cloud(oracle_object *object, parts_seed *seed, int count, const double half[3], double depth, double low,
                 double high, double faintest, double most_opaque);

/* Position (t - centre) velocity + (t - centre)^2 bend + place; turned by spin (t - centre) about an axis. */
typedef struct parts_motion {
    double place[3], velocity[3], bend[3], axis[3], spin, centre;
} parts_motion;
/* Even samples over [0, stop], enough of them for the turn. */
oracle_curve parts_path(const parts_motion *motion, double stop, int least);

/* 32x24 to 96x72 pixels and 10 to 50 ms, thresholds, background, from the seed; focal length 1.25 widths. */
void parts_camera(oracle_scene *scene, parts_seed *seed, int width, double stop);

#endif
