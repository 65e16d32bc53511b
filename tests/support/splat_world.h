/* Test support: scenes made splat by splat, in rgb and linear sizes, and paths that vibrate by a sum of sines. Errors fail the
 * running cmocka test. Their camera is at the origin and looks along +z. */
#ifndef TESTS_SUPPORT_SPLAT_WORLD_H
#define TESTS_SUPPORT_SPLAT_WORLD_H

#include "tides/camera.h"
#include "tides/scene.h"

/* Degree 0 of spherical harmonics: colour = 1/2 + SH0 sh. */
#define WORLD_SH0 0.28209479177387814
#define WORLD_PI 3.14159265358979323846

/* Gaussians under construction: {0} to begin with. Colours are of degree 0, one value for all directions. */
typedef struct splat_set {
    float *mean, *log_scale, *quaternion, *logit, *sh;
    int count, capacity;
} splat_set;

/* A splat as a person would describe it. */
typedef struct splat {
    double mean[3], sigma[3]; /* [scene units] */
    double quaternion[4];     /* wxyz; zeros: not turned */
    double opacity, rgb[3];
} splat;

void splat_set_add(splat_set *set, const splat *one);
/* Adds a round grey splat. */
void splat_set_ball(splat_set *set, double x, double y, double z, double sigma, double opacity, double grey);
/* `count` splats of random size (about `sigma`), shape and colour on the plane at depth z, |x| <= half_x, |y| <= half_y; each a
 * little nearer than the one before, so that depths differ. */
void splat_set_texture(splat_set *set, uint64_t *seed, int count, double z, double half_x, double half_y, double sigma);
tides_gaussians splat_set_view(const splat_set *set);
void splat_set_free(splat_set *set);

/* Log-uniform in [lower, upper). */
double world_between_log(uint64_t *seed, double lower, double upper);

/* The colour of an SH coefficient of degree 0, and back; the logit of an opacity. */
double world_colour(float sh);
float world_sh(double colour);
double world_logit(double opacity);

/* -- motions that are sums of sines -------------------------------------------------------------------------------------- */

enum { WAVES_MAX = 4 };
/* sum_i amplitude_i sin(2 pi hz_i t + phase_i) */
typedef struct waves {
    int count;
    double amplitude[WAVES_MAX], hz[WAVES_MAX], phase[WAVES_MAX];
} waves;
waves waves_one(double amplitude, double hz, double phase);
double waves_at(const waves *w, double t, double *rate);

/* A path around a place: sums of sines in position and rotation vector (angle times axis), and steady parts. */
typedef struct shaking {
    double place[3];
    waves shift[3], turn[3];     /* [scene units], [rad] about x, y, z in that order; small angles */
    double velocity[3], spin[3]; /* steady parts [1/s], of the shift and (one axis at a time) of the turn */
    double centre_time;          /* where the steady parts are 0 */
} shaking;
/* Samples a path every `interval` [s] from start to at least stop; with exact rates, or without, as recorded paths are. */
tides_trajectory *shaking_path(const shaking *s, double start, double stop, double interval, int rates);

/* -- raw parameters that pulse --------------------------------------------------------------------------------------------- */

/* Functions of time that are added to the Gaussians' raw parameters. */
typedef struct pulsing {
    waves logit, log_size, turn; /* turn: about z [rad] */
    waves light;                 /* colours are multiplied by 1 + light */
    waves shift[2];              /* of means along x and y */
    int catmull_rom;             /* 1: keyframes' slopes are Catmull-Rom's */
} pulsing;
/* Keyframes from 0 to duration_s, every `interval` or a little less. */
tides_motion *pulsing_keyframes(const splat_set *set, const pulsing *p, double duration_s, double interval);

/* Adds and frees the Gaussians. */
void world_add(tides_scene *scene, splat_set *set, const tides_trajectory *path);
void world_add_moving(tides_scene *scene, splat_set *set, tides_motion *motion, double duration_s);

#endif
