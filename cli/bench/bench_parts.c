/* Parts of the benchmark's scenes: objects taken from worlds that tides_generate makes, on their own paths or on other ones. */
#include "bench.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define SEED 346 /* of every world; an arbitrary number, fixed so that each run of a benchmark has the same scenes */

/* -- objects --------------------------------------------------------------------------------------------------------- */

/* The object called `name` of a generated world; all objects of that world if `name` is NULL. */
typedef struct source {
    const char *kind, *name;
    int64_t gaussians; /* about as many in each moving object; 0: the default of this kind of world */
} source;

/* Adds the objects of `from`. If `path` is NULL, they keep their own paths and scales; else they get `path` and `scale`. */
static tides_status add(tides_scene *scene, source from, double stop, const tides_trajectory *path, double scale,
                        tides_error *error) {
    tides_generate_options options;
    tides_world world = {.scene = NULL};
    tides_generate_options_defaults(&options);
    options.seed = SEED;
    options.gaussians = from.gaussians;
    options.duration_s = stop;
    tides_status status = tides_generate(from.kind, &options, &world, error);
    for (int32_t i = 0; i < tides_scene_objects(world.scene) && status == TIDES_OK; i++) {
        tides_object o;
        status = tides_scene_object(world.scene, i, &o, error);
        if (status != TIDES_OK || (from.name && strcmp(o.name, from.name) != 0)) continue;
        status = tides_scene_add(scene, &o.gaussians, path ? path : o.trajectory, path ? scale : o.scale, o.name, NULL, error);
    }
    tides_world_release(&world);
    return status;
}

tides_status bench_add_wall(tides_scene *scene, tides_error *error) {
    return add(scene, (source){"room", "wall", 0}, 0, NULL, 1, error);
}

tides_status bench_add_room(tides_scene *scene, tides_error *error) {
    return add(scene, (source){"room", NULL, 0}, 0, NULL, 1, error);
}

tides_status bench_add_fan(tides_scene *scene, double stop, tides_error *error) {
    static const char *const names[] = {"stand", "guard", "blades"};
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && status == TIDES_OK; i++)
        status = add(scene, (source){"fan", names[i], 0}, stop, NULL, 1, error);
    return status;
}

/* -- motion: samples have rates, so cubics through values and rates join them --------------------------------------------- */

/* A path that turns steadily about z. With 33 samples, 6 turns up to `stop` deviate from a steady turn by at most 4e-5 rad:
 * the cubics interpolate the quaternion's components. */
static tides_status turning(const double centre[3], double turns_per_s, double stop, tides_trajectory **path,
                            tides_error *error) {
    enum { SAMPLES = 33 };
    tides_pose_sample samples[SAMPLES];
    memset(samples, 0, sizeof samples);
    const double rate = 2 * PI * turns_per_s;
    for (int i = 0; i < SAMPLES; i++) {
        tides_pose_sample *s = &samples[i];
        s->time = stop * i / (SAMPLES - 1);
        s->quaternion[0] = cos(0.5 * rate * s->time);
        s->quaternion[3] = sin(0.5 * rate * s->time);
        memcpy(s->position, centre, sizeof s->position);
        s->angular_velocity[2] = rate;
        s->has_rates = 1;
    }
    return tides_trajectory_create(samples, SAMPLES, path, error);
}

/* A path that moves steadily along x, and is at `centre` at stop / 2. A cubic is exact for it. */
static tides_status flying(const double centre[3], double speed, double stop, tides_trajectory **path, tides_error *error) {
    tides_pose_sample samples[2];
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 2; i++) {
        samples[i].time = i * stop;
        memcpy(samples[i].position, centre, sizeof samples[i].position);
        samples[i].position[0] += (i - 0.5) * speed * stop;
        samples[i].velocity[0] = speed;
        samples[i].quaternion[0] = 1;
        samples[i].has_rates = 1;
    }
    return tides_trajectory_create(samples, 2, path, error);
}

/* -- things that move --------------------------------------------------------------------------------------------------- */

tides_status bench_add_flying_ball(tides_scene *scene, const double centre[3], double radius, double speed, double stop,
                                   tides_error *error) {
    static const source chequered = {"balls", "ball 1", 0};
    tides_trajectory *path = NULL;
    tides_status status = flying(centre, speed, stop, &path, error);
    if (status == TIDES_OK) status = add(scene, chequered, 0, path, radius, error);
    tides_trajectory_destroy(path);
    return status;
}

tides_status bench_add_turning_disc(tides_scene *scene, const double centre[3], double radius, double turns_per_s, double stop,
                                    tides_error *error) {
    static const source disc = {"disc", "disc 0", 720};
    tides_trajectory *path = NULL;
    tides_status status = turning(centre, turns_per_s, stop, &path, error);
    if (status == TIDES_OK) status = add(scene, disc, 0, path, radius, error);
    tides_trajectory_destroy(path);
    return status;
}

tides_status bench_add_plane(tides_scene *scene, int64_t gaussians, tides_error *error) {
    return add(scene, (source){"plane", NULL, gaussians}, 0, NULL, 1, error);
}

tides_status bench_add_vibrating_ball(tides_scene *scene, const bench_vibration *vibration, double radius, double stop,
                                      tides_error *error) {
    static const source chequered = {"balls", "ball 1", 300};
    tides_trajectory *path = NULL;
    tides_status status = bench_vibrating_path(vibration, stop, &path, error);
    if (status == TIDES_OK) status = add(scene, chequered, 0, path, radius, error);
    tides_trajectory_destroy(path);
    return status;
}
