/* Balls that bounce on a table. A bounce is a stiff spring and not a jump, so velocities are continuous. It lasts about 15
 * ms, as for a rubber ball, and takes some of the speed. (Damping is Hunt and Crossley's, which begins and ends at 0.) */
#include "generate/td_generate.h"

#include "td_math.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define GRAVITY 9.81     /* [m/s^2] */
#define STIFFNESS 44000. /* [1/s^2]: half a period of this spring is 15 ms */
#define DAMPING 0.03     /* [s/m] */
#define DRIFT_RATE 1.3   /* [rad/s] of the motion to and fro on the table */

typedef struct bouncing {
    double radius, height, height_dot, time; /* height of the centre; current time */
    double place[3], drift[3], phase;
    td_turning spin; /* axis in the world; its centre isn't used */
} bouncing;

static double fall(const void *body, double height, double height_dot) {
    const double depth = ((const bouncing *)body)->radius - height;
    return depth > 0 ? STIFFNESS * depth * fmax(0, 1 - DAMPING * height_dot) - GRAVITY : -GRAVITY;
}

static void pose_at(void *shape, tides_pose_sample *sample) {
    bouncing *b = shape;
    double turn[4];
    td_integrate(fall, b, sample->time - b->time, &b->height, &b->height_dot);
    b->time = sample->time;
    const double angle = DRIFT_RATE * sample->time + b->phase;
    for (int k = 0; k < 3; k++) {
        sample->position[k] = b->place[k] + b->drift[k] * td_sin(angle);
        sample->velocity[k] = b->drift[k] * DRIFT_RATE * td_cos(angle);
    }
    sample->position[1] += b->height;
    sample->velocity[1] += b->height_dot;
    td_quaternion_about(b->spin.axis, b->spin.rate * sample->time, turn);
    td_quaternion_product(turn, b->spin.rest, sample->quaternion);
    for (int k = 0; k < 3; k++) sample->angular_velocity[k] = b->spin.rate * b->spin.axis[k];
}

static double chance(const tides_generate_options *options, int32_t number, int32_t which) {
    return td_hash((int32_t)options->seed, number, 100 + which);
}

/* Throws a ball. Steps of the golden ratio spread the balls over lanes from left to right. The distance from the camera, the
 * height and the speed are random. */
static void throw_ball(const tides_generate_options *options, int32_t number, bouncing *b) {
    static const double z_axis[3] = {0, 0, 1};
    const double lane = ((number * 0.618034) - floor(number * 0.618034)), tilt = TD_PI * chance(options, number, 0);
    memset(b, 0, sizeof *b);
    b->radius = fmin(1, sqrt(7.0 / options->count)) * (0.13 + 0.11 * chance(options, number, 1));
    b->height = b->radius + 0.25 + 1.1 * chance(options, number, 2);
    b->height_dot = 3 * chance(options, number, 3) - 1.5;
    b->place[0] = -1.45 + 2.9 * lane;
    b->place[1] = TD_TABLE_Y;
    b->place[2] = -0.6 + 1.3 * chance(options, number, 4);
    b->drift[0] = 0.35 * (chance(options, number, 5) - 0.5);
    b->drift[2] = 0.2 * (chance(options, number, 6) - 0.5);
    b->phase = 2 * TD_PI * chance(options, number, 7);
    b->spin.axis[0] = td_cos(tilt);
    b->spin.axis[1] = td_sin(tilt);
    b->spin.rate = 3 + 9 * chance(options, number, 8);
    td_quaternion_about(z_axis, 2 * TD_PI * chance(options, number, 9), b->spin.rest);
}

static tides_status add(const tides_generate_options *options, int32_t number, tides_scene *scene, tides_error *error) {
    bouncing b;
    td_ball ball = {.pattern = number % TD_BALL_PATTERNS};
    char name[32];
    throw_ball(options, number, &b);
    td_colour_pair(options->seed, number, ball.light, ball.dark);
    snprintf(name, sizeof name, "ball %d", (int)number);
    const td_part part = {name, td_build_ball, &ball, td_generate_detail(options, TD_BALL_GAUSSIANS), 0.008};
    const double radius = b.radius;
    tides_trajectory *path = NULL;
    tides_status status = td_sample_path(pose_at, &b, options, 0.001, &path, error);
    if (status == TIDES_OK) status = td_part_add(scene, &part, path, radius, error);
    tides_trajectory_destroy(path);
    return status;
}

tides_status td_generate_balls(const tides_generate_options *options, tides_world *world, tides_error *error) {
    static const td_part parts[] = {{"wall", td_build_wall, NULL, 0, 0}, {"table", td_build_table, NULL, 0, 0}};
    static const double position[3] = {0.10, 0.42, 3.05}, target[3] = {0.0, -0.02, 0.0};
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && status == TIDES_OK; i++)
        status = td_part_add(world->scene, &parts[i], NULL, 1.0, error);
    for (int32_t i = 0; i < options->count && status == TIDES_OK; i++) status = add(options, i, world->scene, error);
    return status == TIDES_OK ? td_path_camera(position, target, options, &world->camera, error) : status;
}
