/* The axes of `own_bench scaling`, and the worlds along them: one number grows, and the others stay. */
#include "bench_scaling.h"
#include "bench_worlds.h"

#include <math.h>

#define RUN_S 0.02         /* length of the runs [s] */
#define ORBIT_RAD_S 1.5    /* of a moving camera [rad/s] */
enum { STANDARD = 20000 }; /* number of Gaussians on axes where another number grows */

static int64_t fewer(const scaling_world *w, int64_t count) { return w->quick ? count / 20 : count; }

/* A world of random Gaussians that fill the view. */
static tides_status random_world(scaling_world *w, int64_t count, double rad_per_s, tides_error *error) {
    bench_lay_out(&w->scene, "scaling", "random splats");
    bench_resize(&w->scene, w->quick ? 96 : 346, w->quick ? 72 : 260);
    w->scene.stop = w->quick ? RUN_S / 4 : RUN_S;
    tides_status status = tides_scene_create(&w->scene.scene, error);
    if (status == TIDES_OK) status = bench_add_random(w->scene.scene, count, error);
    return status == TIDES_OK ? bench_orbit_all(&w->scene, rad_per_s, error) : status;
}

static tides_status in_view(double x, scaling_world *w, tides_error *error) {
    return random_world(w, (int64_t)x, ORBIT_RAD_S, error);
}

/* A hundred thousand Gaussians in view and x behind the camera. They are one object, whose list mixes them. */
static tides_status out_of_view(double x, scaling_world *w, tides_error *error) {
    tides_status status = random_world(w, fewer(w, 100000), ORBIT_RAD_S, error); /* the others are put behind its camera */
    tides_pose pose = {{0}, {0}, {0}, {0}};
    double at[3];
    if (status == TIDES_OK) status = tides_trajectory_at(w->scene.camera, 0, &pose, error);
    if (status != TIDES_OK) return status;
    for (int k = 0; k < 3; k++) at[k] = 3 * pose.position[k]; /* the middle of the orbit is near 0 */
    tides_scene_destroy(w->scene.scene);
    w->scene.scene = NULL;
    status = tides_scene_create(&w->scene.scene, error);
    if (status != TIDES_OK) return status;
    return bench_add_random_apart(w->scene.scene, fewer(w, 100000), fewer(w, (int64_t)x), at, error);
}

/* The camera passes between the Gaussians. */
static tides_status around(double x, scaling_world *w, tides_error *error) {
    const double speed = 1; /* [half sides of the cube / s] */
    const tides_pose_sample ends[2] = {{.time = 0, .quaternion = {1, 0, 0, 0}},
                                       {.time = 0.1, .position = {0, 0, 0.1 * speed}, .quaternion = {1, 0, 0, 0}}};
    tides_status status = random_world(w, fewer(w, (int64_t)x), ORBIT_RAD_S, error);
    if (status != TIDES_OK) return status;
    tides_trajectory_destroy(w->scene.camera);
    w->scene.camera = NULL;
    return tides_trajectory_create(ends, 2, &w->scene.camera, error);
}

static tides_status pixels(double x, scaling_world *w, tides_error *error) {
    tides_status status = random_world(w, fewer(w, STANDARD), ORBIT_RAD_S, error);
    const int32_t height = (int32_t)lround(sqrt(0.75 * x));
    bench_resize(&w->scene, (int32_t)lround(x / height), height);
    return status;
}

/* Smaller thresholds give more events. */
static tides_status events(double x, scaling_world *w, tides_error *error) {
    tides_status status = random_world(w, fewer(w, STANDARD), ORBIT_RAD_S, error);
    w->scene.sensor.threshold_on = w->scene.sensor.threshold_off = 1 / x;
    w->scene.sensor.max_events_per_step = 1000000;
    return status;
}

static tides_status layers(double x, scaling_world *w, tides_error *error) {
    bench_lay_out(&w->scene, "layers", "planes one behind the other, seen through");
    bench_resize(&w->scene, w->quick ? 96 : 346, w->quick ? 72 : 260);
    tides_status status = tides_scene_create(&w->scene.scene, error);
    const bench_patch stack =
        {.columns = 1, .rows = 1, .layers = (int32_t)x, .apart = 0.001, .spacing = 0.04, .width = 0.6, .opacity = 0.02};
    if (status == TIDES_OK) status = bench_add_patches(w->scene.scene, &stack, error);
    return status == TIDES_OK ? bench_face_patches(&w->scene, error) : status;
}

/* Splats of one plane, of which x cover each pixel. */
static tides_status coplanar(double x, scaling_world *w, tides_error *error) {
    bench_lay_out(&w->scene, "coplanar", "splats in one plane");
    bench_resize(&w->scene, w->quick ? 48 : 173, w->quick ? 36 : 130);
    w->scene.stop = w->quick ? RUN_S / 4 : RUN_S;
    tides_status status = tides_scene_create(&w->scene.scene, error);
    const bench_patch plane = {.columns = 1, .rows = 1, .layers = (int32_t)x, .spacing = 0.03, .width = 0.19, .opacity = 0.3};
    if (status == TIDES_OK) status = bench_add_patches(w->scene.scene, &plane, error);
    return status == TIDES_OK ? bench_pass_patches(&w->scene, error) : status;
}

/* Fifty patches that fill the view, x percent of which swing. */
static tides_status moving_share(double x, scaling_world *w, tides_error *error) {
    bench_lay_out(&w->scene, "moving", "patches, some of which swing, before a camera at rest");
    bench_resize(&w->scene, w->quick ? 96 : 346, w->quick ? 72 : 260);
    w->scene.stop = w->quick ? RUN_S / 4 : 5 * RUN_S;
    tides_status status = tides_scene_create(&w->scene.scene, error);
    const bench_patch grid = {.columns = 10,
                              .rows = 5,
                              .layers = 1,
                              .spacing = 0.02,
                              .width = 0.6,
                              .opacity = 0.9,
                              .swinging = (int32_t)lround(0.5 * x)};
    if (status == TIDES_OK) status = bench_add_patches(w->scene.scene, &grid, error);
    return status == TIDES_OK ? bench_face_patches(&w->scene, error) : status;
}

static tides_status speed(double x, scaling_world *w, tides_error *error) {
    return random_world(w, fewer(w, STANDARD), x, error);
}

static tides_status threads(double x, scaling_world *w, tides_error *error) {
    w->threads = (int32_t)x;
    return random_world(w, fewer(w, STANDARD), ORBIT_RAD_S, error);
}

/* A million Gaussians of SH 3 at 1280x720. Its memory is measured. */
static tides_status memory(double x, scaling_world *w, tides_error *error) {
    tides_status status = random_world(w, (int64_t)x, ORBIT_RAD_S, error);
    bench_resize(&w->scene, 1280, 720);
    w->scene.stop = 0.002;
    return status;
}

/* x is the state of the device's cache of kernels: 1 as the run before left it, 2 empty. */
static tides_status start(double x, scaling_world *w, tides_error *error) {
    w->kernels = x > 1;
    return random_world(w, 2000, 4 * ORBIT_RAD_S, error);
}

static const scaling_axis axes[] = {
    {"in view",
     "Gaussians",
     "random Gaussians that fill the view; a frame",
     WORK_FRAMES,
     in_view,
     {2000, 6300, 20000, 63000, 200000},
     1.05,
     0,
     2},
    {"out of view",
     "Gaussians",
     "100 000 Gaussians in view and others behind the camera, in no order; a run",
     WORK_RUN,
     out_of_view,
     {0, 100000, 300000, 900000},
     0,
     0,
     2},
    {"around",
     "Gaussians",
     "random Gaussians around a camera that passes between them; a run",
     WORK_RUN,
     around,
     {30000, 100000, 300000, 1000000},
     1.05,
     0,
     2},
    {"pixels", "px", "20 000 random Gaussians; a frame", WORK_FRAMES, pixels, {4800, 19200, 76800, 307200, 921600}, 1.05, 0, 2},
    {"events",
     "events",
     "20 000 random Gaussians and thresholds from 1 to 0.01; a run",
     WORK_RUN,
     events,
     {1, 3, 10, 30, 100},
     1.05,
     1,
     2},
    {"layers",
     "planes",
     "planes one behind the other and each seen through; a frame",
     WORK_FRAMES,
     layers,
     {1, 4, 16, 64, 256},
     1.05,
     0,
     2},
    {"coplanar",
     "splats a pixel",
     "splats in one plane and a camera that passes by; a run",
     WORK_RUN,
     coplanar,
     {3, 12},
     0,
     0,
     2},
    {"moving share",
     "% of the view",
     "fifty patches of which some swing and a camera at rest; a run",
     WORK_RUN,
     moving_share,
     {0, 2, 6, 20, 50, 100},
     0,
     0,
     3},
    {"speed", "rad/s", "20 000 random Gaussians and a camera in orbit; a run", WORK_RUN, speed, {0.5, 1, 2, 4, 8, 16}, 0, 0, 2},
    {"threads",
     "threads",
     "20 000 random Gaussians; a run on as many processors, by wall time",
     WORK_RUN,
     threads,
     {1, 2, 4, 8, 16, 32, 64},
     0,
     0,
     1},
    {"memory", "Gaussians", "random Gaussians of SH 3 at 1280x720; a run of 2 ms", WORK_RUN, memory, {1000000}, 0, 0, 0},
    {"start",
     "1: cached; 2: not",
     "2 000 random Gaussians; from opening the device to the first event",
     WORK_START,
     start,
     {1, 2},
     0,
     0,
     1},
};

const scaling_axis *scaling_axes(size_t *count) {
    *count = sizeof axes / sizeof axes[0];
    return axes;
}
