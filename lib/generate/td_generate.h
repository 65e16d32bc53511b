/* Internal: building blocks of generated worlds. y is up, z points to the camera, lengths are in metres. */
#ifndef TD_GENERATE_H
#define TD_GENERATE_H

#include "tides/generate.h"
#include "camera/td_rotation.h"
#include "scene/td_scene.h"

/* -- Gaussians that lie in surfaces, shaded once by a fixed light ----------------------------------------*/

/* A growing set of Gaussians. If memory is short, `status` and `error` are set, and nothing more is added. */
typedef struct td_splats {
    td_gaussians gaussians;
    size_t capacity;
    double detail;    /* factor by which td_splats_cover multiplies nu and nv */
    double thickness; /* standard deviation along the normal */
    tides_status status;
    tides_error *error;
} td_splats;

/* A point and colour (sRGB, 0..1) of a surface at (u, v) in [0, 1]^2. */
typedef void (*td_surface)(const void *shape, double u, double v, double point[3], double colour[3]);

/* Begins a set with detail 1 and thickness 2 mm. */
void td_splats_start(td_splats *splats, tides_error *error);
void td_splats_free(td_splats *splats);
/* Adds a Gaussian, with standard deviations along two tangents and along the normal (tangent x tangent). */
void td_splats_add(td_splats *splats, const double point[3], const double along[3], const double across[3],
                   const double sigma[3], const double colour[3]);
/* Covers a surface with nu x nv Gaussians that follow it in axes and size. */
void td_splats_cover(td_splats *splats, td_surface surface, const void *shape, int32_t nu, int32_t nv);
/* Adds a thin line from a to b of `count` Gaussians; `width` is a standard deviation. It faces +z. */
void td_splats_line(td_splats *splats, const double a[3], const double b[3], int32_t count, double width,
                    const double colour[3]);
/* Scales the Gaussians from number `first` on about the origin, then moves them to `centre`. */
void td_splats_place(td_splats *splats, int64_t first, const double centre[3], double scale);
/* A pseudo-random number in [0, 1) that depends only on its arguments. */
double td_hash(int32_t a, int32_t b, int32_t c);

/* Builds a set with `build`, and adds it as an object, moved by `path` (may be NULL). */
typedef void (*td_part_builder)(td_splats *splats, const void *shape);
typedef struct td_part {
    const char *name;
    td_part_builder build;
    const void *shape;
    double detail, thickness; /* 0: as td_splats_start sets them */
} td_part;
tides_status td_part_add(tides_scene *scene, const td_part *part, const tides_trajectory *path, double scale,
                         tides_error *error);

/* -- shapes of radius 1 around the origin -------------------------------------------------------------------------*/

enum { TD_BALL_STRIPES, TD_BALL_CHECKER, TD_BALL_DOTS, TD_BALL_PATTERNS };

/* A ball with a pattern in two colours (stripes: with a third, white). */
typedef struct td_ball {
    int32_t pattern;
    double light[3], dark[3];
} td_ball;
enum { TD_BALL_GAUSSIANS = 60 * 30 };
void td_build_ball(td_splats *splats, const void *ball);

/* A disc with sectors, in the plane z = 0, visible from +z. */
typedef struct td_disc {
    int32_t sectors; /* even */
    double light[3], dark[3];
} td_disc;
enum { TD_DISC_GAUSSIANS = 60 * 12 };
void td_build_disc(td_splats *splats, const void *disc);

/* A die; its corners are at distance 1. */
typedef struct td_die {
    double colour[3], pips[3];
} td_die;
enum { TD_DIE_GAUSSIANS = 6 * 12 * 12 };
void td_build_die(td_splats *splats, const void *die);

/* A cylinder. */
typedef struct td_tube {
    double from[3], to[3], radius;
    double colour[3];
    int32_t around, along; /* numbers of Gaussians */
} td_tube;
void td_build_tube(td_splats *splats, const void *tube);

/* Makes a strong colour, and a pale or dark one, from a seed and a number. */
void td_colour_pair(uint64_t seed, int32_t number, double light[3], double dark[3]);

/* -- parts of rooms in world coordinates; `shape` isn't used ----------------------------------------------------------*/

#define TD_TABLE_Y (-0.92)
#define TD_WALL_Z (-0.95)
void td_build_wall(td_splats *splats, const void *shape);
void td_build_table(td_splats *splats, const void *shape);
void td_build_still_balls(td_splats *splats, const void *shape);

/* -- paths --------------------------------------------------------------------------------------------------------------*/

/* Fills position, quaternion, velocity and angular velocity of `sample` at its time. Called with increasing times from 0. */
typedef void (*td_pose_at)(void *shape, tides_pose_sample *sample);

/* Makes a path over [0, duration]. `pose` gets times that pass options->speed times as fast as the path's. `step` is the
 * longest distance between samples in this faster time [s]. */
tides_status td_sample_path(td_pose_at pose, void *shape, const tides_generate_options *options, double step,
                            tides_trajectory **path, tides_error *error);

/* Steady rotation about the object's own `axis`, a unit vector, from the pose `rest` (wxyz). */
typedef struct td_turning {
    double centre[3], rest[4], axis[3];
    double rate; /* [rad/s] */
} td_turning;
tides_status td_path_turning(const td_turning *turning, const tides_generate_options *options, tides_trajectory **path,
                             tides_error *error);

/* The quaternion (wxyz) of a rotation by `angle` about a unit vector. */
void td_quaternion_about(const double axis[3], double angle, double q[4]);

/* Acceleration d^2 x / dt^2 of a body that swings or falls. */
typedef double (*td_acceleration)(const void *body, double x, double x_dot);
/* Advances x and x_dot by `step` seconds, by Runge-Kutta of fourth order in steps of at most 0.25 ms. */
void td_integrate(td_acceleration acceleration, const void *body, double step, double *x, double *x_dot);

/* A handheld camera at `position` that looks at `target`, shaken by 12 mm and 6 mrad at 1.5 Hz. */
tides_status td_path_camera(const double position[3], const double target[3], const tides_generate_options *options,
                            tides_trajectory **path, tides_error *error);

/* A camera at rest at (0, 0.1, 3.05) that looks along -z. */
tides_status td_path_still_camera(tides_trajectory **path, tides_error *error);

/* -- kinds of worlds: each fills scene and camera; options are checked and complete ---------------------------------------*/

tides_status td_generate_room(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_fan(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_disc(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_pendulum(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_balls(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_plane(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_crowd(const tides_generate_options *options, tides_world *world, tides_error *error);

enum { TD_FAN_GAUSSIANS = 5 * 42 * 20 + 48 * 9, TD_PLANE_GAUSSIANS = 160 * 120 };

/* The detail that gives about options->gaussians Gaussians, for a set that has `made` of them at detail 1. */
double td_generate_detail(const tides_generate_options *options, int64_t made);

#endif
