/* Writes the demo's world as a user would have it: splat files, path files, and a run file that names them. */
#include "demo.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { WIDTH = 346, HEIGHT = 260 }; /* a DAVIS 346 */
#define FOCAL 300.0
#define DURATION 0.3 /* [s] */
#define TURNS_PER_S 4.0
#define SLACK 0.02 /* [s] that paths last beyond the run */

static tides_status join(const char *directory, const char *name, char *path, size_t size, tides_error *error) {
    int length = snprintf(path, size, "%s/%s", directory, name);
    if (length >= 0 && (size_t)length < size) return TIDES_OK;
    return cli_error(error, TIDES_BAD_ARGUMENT, "%.100s...: the path is too long", directory);
}

/* -- splat files ---------------------------------------------------------------------------------------------------- */

typedef void (*part_builder)(demo_splats *splats);
typedef struct part {
    const char *name;
    part_builder build;
} part;

static tides_status add_part(tides_scene *scene, const part *one, tides_error *error) {
    demo_splats splats;
    demo_splats_start(&splats, 0);
    one->build(&splats);
    tides_status status = splats.failed ? cli_error(error, TIDES_NO_MEMORY, "out of memory: building the demo's %s", one->name)
                                        : tides_scene_add(scene, &splats.view, NULL, 1.0, one->name, NULL, error);
    demo_splats_free(&splats);
    return status;
}

static tides_status write_splats(const char *path, const part *parts, size_t count, tides_error *error) {
    tides_scene *scene = NULL;
    tides_status status = tides_scene_create(&scene, error);
    for (size_t i = 0; status == TIDES_OK && i < count; i++) status = add_part(scene, &parts[i], error);
    if (status == TIDES_OK) status = tides_scene_save(scene, path, error);
    tides_scene_destroy(scene);
    return status;
}

static tides_status write_scene(const char *directory, tides_error *error) {
    static const part room[] = {{"wall", demo_wall},
                                {"table", demo_table},
                                {"balls", demo_balls},
                                {"stand", demo_stand},
                                {"guard", demo_guard}};
    static const part fan[] = {{"fan", demo_blades}};
    char path[4096];
    tides_status status = join(directory, "room.h5", path, sizeof path, error);
    if (status == TIDES_OK) status = write_splats(path, room, sizeof room / sizeof room[0], error);
    if (status == TIDES_OK) status = join(directory, "fan.ply", path, sizeof path, error);
    if (status == TIDES_OK) status = write_splats(path, fan, 1, error);
    return status;
}

/* -- paths ---------------------------------------------------------------------------------------------------------- */

/* q = (fan's rest rotation) (turn by `angle` about its z). */
static void fan_pose(const double rest[4], double angle, double q[4]) {
    const double c = cos(0.5 * angle), s = sin(0.5 * angle);
    q[0] = rest[0] * c - rest[3] * s;
    q[1] = rest[1] * c + rest[2] * s;
    q[2] = rest[2] * c - rest[1] * s;
    q[3] = rest[3] * c + rest[0] * s;
}

/* The fan turns steadily: rates are given, so the path between the samples is exact. */
static tides_status write_fan_path(const char *path, tides_error *error) {
    enum { SAMPLES = 65 };
    tides_pose_sample samples[SAMPLES];
    memset(samples, 0, sizeof samples);
    double axes[9];
    demo_fan_axes(axes);
    /* Ry(a) Rx(b) as a quaternion; the angles are demo_fan_axes's, read back from its matrix. */
    const double a = atan2(-axes[6], axes[0]), b = atan2(-axes[5], axes[4]);
    const double rest[4] = {cos(a / 2) * cos(b / 2), cos(a / 2) * sin(b / 2), sin(a / 2) * cos(b / 2),
                            -sin(a / 2) * sin(b / 2)};
    for (int i = 0; i < SAMPLES; i++) {
        const double time = (DURATION + SLACK) * i / (SAMPLES - 1);
        tides_pose_sample *s = &samples[i];
        s->time = time;
        s->position[0] = DEMO_FAN_X;
        s->position[1] = DEMO_FAN_Y;
        fan_pose(rest, 2 * PI * TURNS_PER_S * time, s->quaternion);
        for (int k = 0; k < 3; k++) s->angular_velocity[k] = 2 * PI * TURNS_PER_S * axes[3 * k + 2];
        s->has_rates = 1;
    }
    tides_trajectory *trajectory = NULL;
    tides_status status = tides_trajectory_create(samples, SAMPLES, &trajectory, error);
    if (status == TIDES_OK) status = tides_path_save(path, trajectory, NULL, error);
    tides_trajectory_destroy(trajectory);
    return status;
}

static tides_status write_camera_path(const char *path, tides_error *error) {
    const tides_handheld hand = {
        .position = {0.10, 0.42, 3.05},
        .target = {0.0, -0.02, 0.0},
        .up = {0, 1, 0},
        .position_amplitude = 0.012,
        .rotation_amplitude = 0.006,
        .frequency = 1.5,
        .seed = 346,
        .start = 0,
        .stop = DURATION + SLACK,
    };
    const tides_intrinsics camera = {WIDTH, HEIGHT, FOCAL, FOCAL, 0.5 * WIDTH, 0.5 * HEIGHT};
    tides_trajectory *trajectory = NULL;
    tides_status status = tides_trajectory_create_handheld(&hand, &trajectory, error);
    if (status == TIDES_OK) status = tides_path_save(path, trajectory, &camera, error);
    tides_trajectory_destroy(trajectory);
    return status;
}

static tides_status write_paths(const char *directory, tides_error *error) {
    char path[4096];
    tides_status status = join(directory, "fan.json", path, sizeof path, error);
    if (status == TIDES_OK) status = write_fan_path(path, error);
    if (status == TIDES_OK) status = join(directory, "camera.json", path, sizeof path, error);
    if (status == TIDES_OK) status = write_camera_path(path, error);
    return status;
}

/* -- run file ------------------------------------------------------------------------------------------------------- */

static tides_status write_run(const char *directory, tides_error *error) {
    char path[4096], text[1024];
    snprintf(text, sizeof text,
             "{\n"
             "  \"scene\":    { \"file\": \"room.h5\", \"background\": [0.02, 0.02, 0.03],\n"
             "                \"objects\": [ { \"file\": \"fan.ply\", \"trajectory\": \"fan.json\" } ] },\n"
             "  \"camera\":   { \"file\": \"camera.json\" },\n"
             "  \"time\":     { \"start\": 0.0, \"stop\": %.17g },\n"
             "  \"image\":    { \"rules\": \"smooth\", \"log_eps\": 0.01 },\n"
             "  \"sensor\":   { \"threshold_on\": 0.2, \"threshold_off\": 0.2 },\n"
             "  \"stepping\": { \"mode\": \"error\", \"step_s\": 0.01, \"tolerance\": 0.01 },\n"
             "  \"seed\":     \"1\"\n"
             "}",
             DURATION);
    tides_status status = join(directory, "run.json", path, sizeof path, error);
    return status == TIDES_OK ? cli_write_text(path, text, error) : status;
}

tides_status demo_scene_write(const char *directory, tides_error *error) {
    tides_status status = write_scene(directory, error);
    if (status == TIDES_OK) status = write_paths(directory, error);
    if (status == TIDES_OK) status = write_run(directory, error);
    return status;
}
