/* Pendulums one behind the other, on a beam that crosses the room diagonally. */
#include "generate/td_generate.h"

#include "td_math.h"

#include <math.h>
#include <stdio.h>

#define GRAVITY 9.81   /* [m/s^2] */
#define RELEASE 0.62   /* [rad] at release */
#define STAGGER_S 0.37 /* [s] between the releases of two neighbours */
#define BEAM_Y 1.0     /* [m] */

typedef struct pendulum {
    double pivot[3], length, radius;
    double angle, angle_dot, time; /* current values */
    td_disc bob;
    double detail;
} pendulum;

static double swing(const void *body, double angle, double angle_dot) {
    const pendulum *p = body;
    (void)angle_dot;
    return -GRAVITY / p->length * td_sin(angle);
}

/* Sets the pose of a pendulum; the pivot is fixed. */
static void pose_at(void *shape, tides_pose_sample *sample) {
    static const double axis[3] = {0, 0, 1};
    pendulum *p = shape;
    td_integrate(swing, p, sample->time - p->time, &p->angle, &p->angle_dot);
    p->time = sample->time;
    for (int k = 0; k < 3; k++) sample->position[k] = p->pivot[k];
    td_quaternion_about(axis, p->angle, sample->quaternion);
    sample->angular_velocity[2] = p->angle_dot;
}

static void build(td_splats *splats, const void *shape) {
    const pendulum *p = shape;
    const td_tube rod = {{0, 0, 0}, {0, -p->length, 0}, 0.008, {0.80, 0.80, 0.82}, 8, 60};
    const td_tube rim = {{0, -p->length, -0.012}, {0, -p->length, -0.002}, p->radius, {0.45, 0.36, 0.16}, 60, 1};
    const double centre[3] = {0, -p->length, 0.02};
    td_build_tube(splats, &rod);
    td_build_tube(splats, &rim);
    const int64_t first = splats->gaussians.count;
    splats->detail = p->detail;
    td_build_disc(splats, &p->bob);
    td_splats_place(splats, first, centre, p->radius);
}

static void build_frame(td_splats *splats, const void *shape) {
    static const td_tube tubes[] = {
        {{-1.15, BEAM_Y, 0.55}, {1.15, BEAM_Y, -0.60}, 0.025, {0.55, 0.40, 0.24}, 16, 90},
        {{-1.15, BEAM_Y, 0.55}, {-1.28, TD_TABLE_Y, 0.80}, 0.03, {0.55, 0.40, 0.24}, 16, 70},
        {{-1.15, BEAM_Y, 0.55}, {-1.10, TD_TABLE_Y, 0.20}, 0.03, {0.50, 0.36, 0.21}, 16, 70},
        {{1.15, BEAM_Y, -0.60}, {1.28, TD_TABLE_Y, -0.30}, 0.03, {0.55, 0.40, 0.24}, 16, 70},
        {{1.15, BEAM_Y, -0.60}, {1.20, TD_TABLE_Y, -0.85}, 0.03, {0.50, 0.36, 0.21}, 16, 70},
    };
    (void)shape;
    for (size_t i = 0; i < sizeof tubes / sizeof tubes[0]; i++) td_build_tube(splats, &tubes[i]);
}

static tides_status add(const tides_generate_options *options, int32_t number, tides_scene *scene, tides_error *error) {
    const double share = options->count > 1 ? (double)number / (options->count - 1) : 0.5; /* from front left to back right */
    const double rod_and_rim = 8 * 60 + 60;
    pendulum p = {.pivot = {-1.0 + 2.0 * share, BEAM_Y, 0.46 - 0.96 * share},
                  .length = 1.0 + 0.45 * td_hash((int32_t)options->seed, number, 1),
                  .radius = 0.26 * fmin(1, sqrt(5.0 / options->count)),
                  .angle = RELEASE,
                  .bob = {.sectors = 6 + 2 * (number % 3)},
                  .detail = sqrt(fmax((double)options->gaussians - rod_and_rim, 1) / TD_DISC_GAUSSIANS)};
    td_colour_pair(options->seed, number, p.bob.light, p.bob.dark);
    td_integrate(swing, &p, STAGGER_S * number, &p.angle, &p.angle_dot);
    char name[32];
    snprintf(name, sizeof name, "pendulum %d", (int)number);
    const td_part part = {name, build, &p, 0, 0};
    tides_trajectory *path = NULL;
    pendulum moved = p;
    tides_status status = td_sample_path(pose_at, &moved, options, 0.02, &path, error);
    if (status == TIDES_OK) status = td_part_add(scene, &part, path, 1.0, error);
    tides_trajectory_destroy(path);
    return status;
}

tides_status td_generate_pendulum(const tides_generate_options *options, tides_world *world, tides_error *error) {
    static const td_part parts[] = {{"wall", td_build_wall, NULL, 0, 0},
                                    {"table", td_build_table, NULL, 0, 0},
                                    {"frame", build_frame, NULL, 0, 0}};
    static const double position[3] = {0.25, 0.35, 3.05}, target[3] = {0.0, 0.05, 0.0};
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && status == TIDES_OK; i++)
        status = td_part_add(world->scene, &parts[i], NULL, 1.0, error);
    for (int32_t i = 0; i < options->count && status == TIDES_OK; i++) status = add(options, i, world->scene, error);
    return status == TIDES_OK ? td_path_camera(position, target, options, &world->camera, error) : status;
}
