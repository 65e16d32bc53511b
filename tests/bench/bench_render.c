/* Renders frames along an orbit and prints the time of each stage, best and median, for every vector width of the device.
 *   bench_render [SCENE] [DEVICE] [WIDTH HEIGHT]
 * Without SCENE: 100 000 random Gaussians of SH degree 3 that fill the view. Best of a run is what the machine can do; compare
 * numbers of one run only. */
#include "td_device.h"
#include "tides.h"
#include "td_base.h"
#include "td_sort.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FRAMES = 40, RANDOM_COUNT = 100000 };

static void stop_on(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "bench_render: %s\n", error->text);
    exit(1);
}

static double normal(uint64_t *state) {
    double sum = 0;
    for (int i = 0; i < 12; i++) sum += scene_between(state, 0, 1);
    return sum - 6;
}

/* A ball of Gaussians of log-normal size, opacity sigmoid(2 n). */
static void add_random(tides_scene *scene) {
    static float mean[RANDOM_COUNT * 3], scale[RANDOM_COUNT * 3], quaternion[RANDOM_COUNT * 4], opacity[RANDOM_COUNT];
    float *sh = malloc(sizeof *sh * RANDOM_COUNT * 48);
    uint64_t state = 1;
    tides_error error;
    if (!sh) exit(1);
    for (int i = 0; i < 3 * RANDOM_COUNT; i++) mean[i] = (float)(scene_between(&state, -1, 1));
    for (int i = 0; i < 3 * RANDOM_COUNT; i++) scale[i] = (float)(log(0.006) + 0.5 * normal(&state));
    for (int i = 0; i < 4 * RANDOM_COUNT; i++) quaternion[i] = (float)normal(&state);
    for (int i = 0; i < RANDOM_COUNT; i++) opacity[i] = (float)(2 * normal(&state));
    for (int i = 0; i < 48 * RANDOM_COUNT; i++) sh[i] = (float)((i % 48 < 3 ? 1 : 0.1) * normal(&state));
    tides_gaussians gaussians = {.count = RANDOM_COUNT, .sh_degree = 3, .mean = mean, .log_scale = scale, .sh = sh};
    gaussians.quaternion = quaternion;
    gaussians.opacity_logit = opacity;
    stop_on(tides_scene_add(scene, &gaussians, NULL, 1, "random", NULL, &error), &error);
    free(sh);
}

static void run(tides_device *device, const tides_scene *scene, const tides_trajectory *camera,
                const tides_intrinsics *intrinsics, int32_t rules) {
    tides_error error;
    tides_image_params params;
    tides_renderer *renderer;
    tides_render_stats before, after;
    double total[FRAMES];
    size_t pixels = (size_t)intrinsics->width * intrinsics->height;
    tides_image_params_defaults(&params);
    params.rules = rules;
    stop_on(tides_renderer_create(device, scene, intrinsics, &params, NULL, NULL, &renderer, &error), &error);
    tides_frame frame = {{NULL}};
    frame.plane[TIDES_L] = malloc(sizeof(double) * pixels);
    frame.plane[TIDES_L_DOT] = malloc(sizeof(double) * pixels);
    stop_on(tides_renderer_frame(renderer, camera, 0, &frame, &error), &error); /* builds kernels */
    tides_renderer_stats(renderer, &before);
    for (int i = 0; i < FRAMES; i++) {
        double begun = td_now();
        stop_on(tides_renderer_frame(renderer, camera, 0.01 * i, &frame, &error), &error);
        total[i] = 1e3 * (td_now() - begun);
    }
    tides_renderer_stats(renderer, &after);
    qsort(total, FRAMES, sizeof *total, td_ascending);
    double per = 1e3 / FRAMES;
    printf("%-7s %2d lanes  best %7.2f  median %7.2f ms | sweep %6.2f project %6.2f sort %6.2f composite %6.2f transfer %6.2f "
           "| "
           "%6.0f k projected, %6.2f M pairs\n",
           rules == TIDES_RULES_SMOOTH ? "smooth" : "inria", (int)device->info.lanes, total[0], total[FRAMES / 2],
           per * (after.time_sweep_s - before.time_sweep_s), per * (after.time_project_s - before.time_project_s),
           per * (after.time_sort_s - before.time_sort_s), per * (after.time_composite_s - before.time_composite_s),
           per * (after.time_transfer_s - before.time_transfer_s),
           1e-3 * (double)(after.gaussians_projected - before.gaussians_projected) / FRAMES,
           1e-6 * (double)(after.pairs_evaluated - before.pairs_evaluated) / FRAMES);
    free(frame.plane[TIDES_L]);
    free(frame.plane[TIDES_L_DOT]);
    tides_renderer_destroy(renderer);
}

int main(int argc, char **argv) {
    tides_error error;
    tides_scene *scene;
    tides_device *device;
    tides_trajectory *camera;
    double lower[3], upper[3];
    stop_on(tides_scene_create(&scene, &error), &error);
    if (argc > 1 && argv[1][0])
        stop_on(tides_scene_add_file(scene, argv[1], NULL, 1, &error), &error);
    else
        add_random(scene);
    int width = argc > 4 ? atoi(argv[3]) : 346, height = argc > 4 ? atoi(argv[4]) : 260;
    tides_scene_bounds(scene, lower, upper);
    tides_orbit orbit = {{0}, {0, -1, 0}, 0, 0, 0, 1.0, 0, 1};
    double size = 0;
    for (int i = 0; i < 3; i++) {
        orbit.target[i] = 0.5 * (lower[i] + upper[i]);
        size = upper[i] - lower[i] > size ? upper[i] - lower[i] : size;
    }
    orbit.radius = 1.1 * size;
    stop_on(tides_trajectory_create_orbit(&orbit, &camera, &error), &error);
    tides_intrinsics intrinsics = {width, height, 1.2 * height, 1.2 * height, 0.5 * width, 0.5 * height, {0}};
    stop_on(tides_device_open(argc > 2 ? argv[2] : NULL, &device, &error), &error);
    printf("%s, %lld Gaussians, %d x %d\n", device->info.name, (long long)tides_scene_count(scene), width, height);
    static const int widths[] = {16, 8, 4};
    for (int round = 0; round < 2; round++)
        for (int i = 0; i < 3; i++) {
            if (device->info.lanes > 1) device->info.lanes = widths[i];
            run(device, scene, camera, &intrinsics, TIDES_RULES_SMOOTH);
            if (device->info.lanes == 16) run(device, scene, camera, &intrinsics, TIDES_RULES_INRIA);
        }
    tides_device_close(device);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    return 0;
}
