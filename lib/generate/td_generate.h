/* Internal: what the generators of worlds are made of. y is up, z towards the camera, metres. */
#ifndef TD_GENERATE_H
#define TD_GENERATE_H

#include "tides/generate.h"
#include "camera/td_rotation.h"
#include "scene/td_scene.h"

#define TD_GENERATE_PI 3.14159265358979323846

/* -- splats.c: Gaussians that lie in surfaces, shaded once by a fixed light ----------------------------------------*/

/* A growing set. Where memory runs out, `status` and `error` say so, and nothing more is added. */
typedef struct td_splats {
    td_gaussians gaussians;
    size_t capacity;
    double detail;    /* td_splats_cover makes this many times as many in each direction */
    double thickness; /* standard deviation along the normal */
    tides_status status;
    tides_error *error;
} td_splats;

/* A point and colour (sRGB, 0..1) of a surface at (u, v) in [0, 1]^2. */
typedef void (*td_surface)(const void *shape, double u, double v, double point[3], double colour[3]);

/* Detail 1, 2 mm thick. */
void td_splats_start(td_splats *splats, tides_error *error);
void td_splats_free(td_splats *splats);
/* One Gaussian: standard deviations along two tangents and the normal (tangent x tangent). */
void td_splats_add(td_splats *splats, const double point[3], const double along[3], const double across[3],
                   const double sigma[3], const double colour[3]);
/* Covers a surface with nu x nv Gaussians whose axes and sizes follow it. */
void td_splats_cover(td_splats *splats, td_surface surface, const void *shape, int32_t nu, int32_t nv);
/* A thin line from a to b in `count` pieces, `width` wide (one standard deviation), facing +z. */
void td_splats_line(td_splats *splats, const double a[3], const double b[3], int32_t count, double width,
                    const double colour[3]);
/* Moves the Gaussians from number `first` on: scaled about the origin, then brought to `centre`. */
void td_splats_place(td_splats *splats, int64_t first, const double centre[3], double scale);
/* A number in [0, 1) that depends on its arguments only. */
double td_hash(int32_t a, int32_t b, int32_t c);

/* Builds a set with `build` and adds it as one object, moved by `path` (nullable). */
typedef void (*td_part_builder)(td_splats *splats, const void *shape);
typedef struct td_part {
    const char *name;
    td_part_builder build;
    const void *shape;
    double detail, thickness; /* 0: those of td_splats_start */
} td_part;
tides_status td_part_add(tides_scene *scene, const td_part *part, const tides_trajectory *path, double scale,
                         tides_error *error);

/* -- shapes.c: of radius 1, about the origin -------------------------------------------------------------------------*/

enum { TD_BALL_STRIPES, TD_BALL_CHECKER, TD_BALL_DOTS, TD_BALL_PATTERNS };

/* A ball with a pattern in two colours (stripes: with a third, white). */
typedef struct td_ball {
    int32_t pattern;
    double light[3], dark[3];
} td_ball;
enum { TD_BALL_GAUSSIANS = 60 * 30 };
void td_build_ball(td_splats *splats, const void *ball);

/* A disc with sectors, in the plane z = 0, seen from +z. */
typedef struct td_disc {
    int32_t sectors; /* even */
    double light[3], dark[3];
} td_disc;
enum { TD_DISC_GAUSSIANS = 60 * 12 };
void td_build_disc(td_splats *splats, const void *disc);

/* A cube with pips, a die; corners are at distance 1. */
typedef struct td_die {
    double colour[3], pips[3];
} td_die;
enum { TD_DIE_GAUSSIANS = 6 * 12 * 12 };
void td_build_die(td_splats *splats, const void *die);

/* A cylinder. */
typedef struct td_tube {
    double from[3], to[3], radius;
    double colour[3];
    int32_t around, along; /* Gaussians */
} td_tube;
void td_build_tube(td_splats *splats, const void *tube);

/* A strong colour and a pale or a dark one, from a seed and a number. */
void td_colour_pair(uint64_t seed, int32_t number, double light[3], double dark[3]);

/* -- room.c, fan.c: parts in world coordinates, shape unused ----------------------------------------------------------*/

#define TD_TABLE_Y (-0.92)
#define TD_WALL_Z (-0.95)
void td_build_wall(td_splats *splats, const void *shape);
void td_build_table(td_splats *splats, const void *shape);
void td_build_still_balls(td_splats *splats, const void *shape);

/* -- paths.c ----------------------------------------------------------------------------------------------------------*/

/* Fills position, quaternion, velocity and angular velocity of `sample` at its time. Called with rising times from 0. */
typedef void (*td_pose_at)(void *shape, tides_pose_sample *sample);

/* A path over [0, duration] with samples at most `step` of the formula's own time apart, which runs `speed` times as fast. */
tides_status td_sample_path(td_pose_at pose, void *shape, const tides_generate_options *options, double step,
                            tides_trajectory **path, tides_error *error);

/* Turns steadily about `axis` of its own, a unit vector, from the pose `rest` (wxyz) on. */
typedef struct td_turning {
    double centre[3], rest[4], axis[3];
    double rate; /* [rad/s] */
} td_turning;
tides_status td_path_turning(const td_turning *turning, const tides_generate_options *options, tides_trajectory **path,
                             tides_error *error);

/* The quaternion (wxyz) of a turn by `angle` about a unit vector. */
void td_quaternion_about(const double axis[3], double angle, double q[4]);

/* d^2 x / dt^2 of what swings or falls. */
typedef double (*td_acceleration)(const void *body, double x, double x_dot);
/* Carries x and x_dot on by `step` seconds: Runge and Kutta's fourth order, in steps of at most 0.25 ms. */
void td_integrate(td_acceleration acceleration, const void *body, double step, double *x, double *x_dot);

/* A handheld camera at `position` that looks at `target`: shaken by 12 mm and 6 mrad at 1.5 Hz. */
tides_status td_path_camera(const double position[3], const double target[3], const tides_generate_options *options,
                            tides_trajectory **path, tides_error *error);

/* A camera at rest at (0, 0.1, 3.05) that looks along -z. */
tides_status td_path_still_camera(tides_trajectory **path, tides_error *error);

/* -- the kinds: fill scene and camera; options are checked, with no defaults left ---------------------------------------*/

tides_status td_generate_room(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_fan(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_disc(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_pendulum(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_balls(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_plane(const tides_generate_options *options, tides_world *world, tides_error *error);
tides_status td_generate_crowd(const tides_generate_options *options, tides_world *world, tides_error *error);

enum { TD_FAN_GAUSSIANS = 5 * 42 * 20 + 48 * 9, TD_PLANE_GAUSSIANS = 160 * 120 };

/* The detail that makes about options->gaussians of what is `made` at detail 1. */
double td_generate_detail(const tides_generate_options *options, int64_t made);

#endif
