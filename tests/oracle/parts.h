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

/* A round, grey Gaussian at (x, y, z); light is its colour in all channels. */
oracle_splat parts_splat(double x, double y, double z, double scale, double opacity, double light);
void parts_set_light(oracle_splat *splat, double light);
void parts_set_opacity(oracle_splat *splat, double opacity);
void parts_colour(oracle_splat *splat, parts_seed *seed, double low, double high);
/* A random rotation and scales from low to high. */
void parts_shape(oracle_splat *splat, parts_seed *seed, double low, double high);

/* Adds an empty object to a scene. */
oracle_object *parts_object(oracle_scene *scene);
/* Adds `count` random splats in a box about (0, 0, depth) with half-sides `half`: scales from low to high, opacities from
 * faintest to most_opaque, colours from 0.02 to 1. */
void parts_cloud(oracle_object *object, parts_seed *seed, int count, const double half[3], double depth, double low,
                 double high, double faintest, double most_opaque);

/* A motion by d = t - centre [s]: position place + d velocity + d^2 bend, turned by the angle spin d [rad] about a unit
 * axis. */
typedef struct parts_motion {
    double place[3], velocity[3], bend[3], axis[3], spin, centre;
} parts_motion;
/* A path of even samples over [0, stop]: at least `least`, and 48 a turn. */
oracle_curve parts_path(const parts_motion *motion, double stop, int least);

/* Sets an image of `width` pixels times the scene's share, 4:3, a focal length of 1.25 widths, the run's length `stop` [s],
 * leak and grid. Thresholds are drawn. */
void parts_camera(oracle_scene *scene, parts_seed *seed, int width, double stop);

#endif
