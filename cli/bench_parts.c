/* What the benchmark's scenes are made of: the demo's parts, a ball that flies past, a disc that turns. */
#include "bench.h"
#include "demo.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* -- objects --------------------------------------------------------------------------------------------------------- */

typedef void (*part_builder)(demo_splats *splats, const void *shape);

/* Builds a set of Gaussians and adds it as one object, moved by `path` (nullable). */
static tides_status add(tides_scene *scene, const char *name, part_builder build, const void *shape,
                        const tides_trajectory *path, tides_error *error) {
    demo_splats splats;
    demo_splats_start(&splats, 0);
    build(&splats, shape);
    tides_status status = splats.failed ? cli_error(error, TIDES_NO_MEMORY, "out of memory: building the %s", name)
                                        : tides_scene_add(scene, &splats.view, path, 1.0, name, NULL, error);
    demo_splats_free(&splats);
    return status;
}

static void build_wall(demo_splats *splats, const void *shape) {
    (void)shape;
    demo_wall(splats);
}

static void build_furniture(demo_splats *splats, const void *shape) {
    (void)shape;
    demo_table(splats);
    demo_balls(splats);
}

static void build_stand(demo_splats *splats, const void *shape) {
    (void)shape;
    demo_stand(splats);
    demo_guard(splats);
}

static void build_blades(demo_splats *splats, const void *shape) {
    (void)shape;
    demo_blades(splats);
}

tides_status bench_add_wall(tides_scene *scene, tides_error *error) {
    return add(scene, "wall", build_wall, NULL, NULL, error);
}

tides_status bench_add_room(tides_scene *scene, tides_error *error) {
    tides_status status = bench_add_wall(scene, error);
    return status == TIDES_OK ? add(scene, "furniture", build_furniture, NULL, NULL, error) : status;
}

/* -- motion: both have rates, so the paths are exact between their samples ------------------------------------------------ */

/* Turns steadily about its own z axis, from the pose `rest` (wxyz) on. */
static tides_status turning(const double centre[3], const double rest[4], double turns_per_s, double stop,
                            tides_trajectory **path, tides_error *error) {
    enum { SAMPLES = 33 };
    tides_pose_sample samples[SAMPLES];
    memset(samples, 0, sizeof samples);
    const double w = rest[0], x = rest[1], y = rest[2], z = rest[3], rate = 2 * PI * turns_per_s;
    const double axis[3] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}; /* R e_z */
    for (int i = 0; i < SAMPLES; i++) {
        tides_pose_sample *s = &samples[i];
        s->time = stop * i / (SAMPLES - 1);
        const double half_cos = cos(0.5 * rate * s->time), half_sin = sin(0.5 * rate * s->time);
        const double turned[4] = {w * half_cos - z * half_sin, x * half_cos + y * half_sin, y * half_cos - x * half_sin,
                                  z * half_cos + w * half_sin};
        memcpy(s->quaternion, turned, sizeof turned);
        memcpy(s->position, centre, sizeof s->position);
        for (int k = 0; k < 3; k++) s->angular_velocity[k] = rate * axis[k];
        s->has_rates = 1;
    }
    return tides_trajectory_create(samples, SAMPLES, path, error);
}

/* Moves steadily along x through the origin halfway. */
static tides_status flying(double speed, double stop, tides_trajectory **path, tides_error *error) {
    tides_pose_sample samples[2];
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 2; i++) {
        samples[i].time = i * stop;
        samples[i].position[0] = (i - 0.5) * speed * stop;
        samples[i].velocity[0] = speed;
        samples[i].quaternion[0] = 1;
        samples[i].has_rates = 1;
    }
    return tides_trajectory_create(samples, 2, path, error);
}

tides_status bench_add_fan(tides_scene *scene, double stop, tides_error *error) {
    static const double centre[3] = {DEMO_FAN_X, DEMO_FAN_Y, 0};
    double m[9];
    demo_fan_axes(m);
    /* Ry(a) Rx(b), the angles read back from the matrix. */
    const double a = atan2(-m[6], m[0]), b = atan2(-m[5], m[4]);
    const double rest[4] = {cos(a / 2) * cos(b / 2), cos(a / 2) * sin(b / 2), sin(a / 2) * cos(b / 2),
                            -sin(a / 2) * sin(b / 2)};
    tides_trajectory *path = NULL;
    tides_status status = add(scene, "stand", build_stand, NULL, NULL, error);
    if (status == TIDES_OK) status = turning(centre, rest, 4.0, stop, &path, error);
    if (status == TIDES_OK) status = add(scene, "blades", build_blades, NULL, path, error);
    tides_trajectory_destroy(path);
    return status;
}

/* -- ball ------------------------------------------------------------------------------------------------------------ */

typedef struct ball {
    double centre[3], radius;
} ball;

static void ball_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double pale[3] = {0.95, 0.93, 0.86}, dark[3] = {0.10, 0.10, 0.16};
    const ball *b = shape;
    const double longitude = 2 * PI * u, latitude = PI * (v - 0.5);
    point[0] = b->centre[0] + b->radius * cos(latitude) * sin(longitude);
    point[1] = b->centre[1] + b->radius * sin(latitude);
    point[2] = b->centre[2] + b->radius * cos(latitude) * cos(longitude);
    memcpy(colour, ((int32_t)floor(10 * u) + (int32_t)floor(5 * v)) % 2 ? pale : dark, sizeof pale);
}

static void build_ball(demo_splats *splats, const void *shape) { demo_cover(splats, ball_surface, shape, 60, 30); }

tides_status bench_add_flying_ball(tides_scene *scene, const double centre[3], double radius, double speed, double stop,
                                   tides_error *error) {
    const ball made = {{centre[0], centre[1], centre[2]}, radius};
    tides_trajectory *path = NULL;
    tides_status status = flying(speed, stop, &path, error);
    if (status == TIDES_OK) status = add(scene, "ball", build_ball, &made, path, error);
    tides_trajectory_destroy(path);
    return status;
}

/* -- disc ------------------------------------------------------------------------------------------------------------ */

static void disc_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double pale[3] = {0.94, 0.90, 0.80}, dark[3] = {0.08, 0.16, 0.36};
    const double radius = *(const double *)shape * (0.04 + 0.96 * v), angle = -2 * PI * u; /* faces the camera */
    point[0] = radius * cos(angle);
    point[1] = radius * sin(angle);
    point[2] = 0;
    memcpy(colour, (int32_t)floor(6 * u + (v > 0.55 ? 0.5 : 0)) % 2 ? pale : dark, sizeof pale);
}

static void build_disc(demo_splats *splats, const void *shape) { demo_cover(splats, disc_surface, shape, 60, 12); }

tides_status bench_add_turning_disc(tides_scene *scene, const double centre[3], double radius, double turns_per_s, double stop,
                                    tides_error *error) {
    static const double upright[4] = {1, 0, 0, 0};
    tides_trajectory *path = NULL;
    tides_status status = turning(centre, upright, turns_per_s, stop, &path, error);
    if (status == TIDES_OK) status = add(scene, "disc", build_disc, &radius, path, error);
    tides_trajectory_destroy(path);
    return status;
}
