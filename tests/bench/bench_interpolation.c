/* Gain and cost of interpolating rows where a deformation network moves a scene (scene.interpolate_motion), and of look-ups in
 * addition.
 *   bench_interpolation [DEVICE] [GAUSSIANS] [STEP_S] [TIME_ROWS]
 * 4DGaussians with the sizes of its D-NeRF configuration and random weights, 2 s long. 0.1 s of it are simulated without
 * interpolation, with it, and by default with look-ups; in turns, and the best of the rounds counts. Then the streams of events
 * are compared with those without interpolation. Its planes have TIME_ROWS rows of random numbers: 75 as in that configuration.
 * Training makes planes smooth; with fewer rows random ones have as few kinks. Last comes a model that isn't interpolated
 * because its rows are cheap: a polynomial's. */
#include "td_base.h"
#include "tests/support/model_steps.h"
#include "tests/support/moving_scene.h"
#include "tests/support/random_network.h"
#include "tides.h"
#include "td_sort.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 3, WAYS = 3, SOLVED = 2 };
static const char *const ways[WAYS] = {"without", "rows", "default"};
static const double START = 0.5, STOP = 0.6, DURATION = 2;

static void stop_on(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "bench_interpolation: %s\n", error->text);
    exit(1);
}

typedef struct stream {
    tides_event *events;
    size_t count, capacity;
    tides_stats stats;
    double processor_s;
} stream;

static int collect(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    tides_error error;
    stop_on(td_reserve((void **)&s->events, &s->capacity, s->count + count, sizeof *events, &error), &error);
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

static double processor_now(void) {
    struct timespec now = {0};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static stream simulate(tides_device *device, const tides_scene *scene, double step_s, int way) {
    static const double position[3] = {0, 0, -5}, quaternion[4] = {1, 0, 0, 0};
    const tides_intrinsics intrinsics = {346, 260, 300, 300, 173, 130, {0}};
    stream s;
    tides_error error;
    tides_image_params params;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_trajectory *camera = NULL;
    tides_simulator *simulator = NULL;
    memset(&s, 0, sizeof s);
    tides_image_params_defaults(&params);
    tides_sensor_defaults(&sensor);
    if (way < SOLVED)
        model_steps(&stepping);
    else
        tides_stepping_defaults(&stepping);
    stepping.step_s = step_s;
    stepping.interpolate_motion = way == 1;
    stop_on(tides_trajectory_create_static(position, quaternion, &camera, &error), &error);
    stop_on(tides_simulator_create(device, scene, camera, &intrinsics, &params, &sensor, &stepping, START, STOP, NULL, NULL,
                                   &simulator, &error),
            &error);
    double begun = processor_now();
    stop_on(tides_simulator_run(simulator, STOP, collect, &s, NULL, NULL, &error), &error);
    s.processor_s = processor_now() - begun;
    tides_simulator_stats(simulator, &s.stats);
    tides_simulator_destroy(simulator);
    tides_trajectory_destroy(camera);
    return s;
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *x = a, *y = b;
    if (x->y != y->y) return x->y < y->y ? -1 : 1;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return x->t < y->t ? -1 : x->t > y->t;
}

/* Events of the same pixel and polarity within 1 ms of one another, in order. */
static void print_apart(stream *a, stream *b) {
    double *apart = malloc((a->count + 1) * sizeof *apart);
    size_t i = 0, k = 0, pairs = 0;
    if (!apart) exit(1);
    qsort(a->events, a->count, sizeof *a->events, by_pixel);
    qsort(b->events, b->count, sizeof *b->events, by_pixel);
    while (i < a->count && k < b->count) {
        const tides_event *x = &a->events[i], *y = &b->events[k];
        double us = 1e-3 * (double)(x->t - y->t);
        if (x->y == y->y && x->x == y->x && x->polarity == y->polarity && fabs(us) < 1e3)
            apart[pairs++] = fabs(us), i++, k++;
        else if (by_pixel(x, y) < 0)
            i++;
        else
            k++;
    }
    qsort(apart, pairs, sizeof *apart, td_ascending);
    printf("%zu events and %zu, %zu of them pairs; apart: median %.3g, p95 %.3g, p99 %.3g us (estimated error without: p95 "
           "%.3g, "
           "p99 %.3g us)\n",
           a->count, b->count, pairs, apart[pairs / 2], apart[pairs * 95 / 100], apart[pairs * 99 / 100],
           1e6 * a->stats.error_p95_s, 1e6 * a->stats.error_p99_s);
    free(apart);
}

static void keep_least(double *least, double value, int round) { *least = round == 0 || value < *least ? value : *least; }

static void compare(const char *name, tides_device *device, const tides_scene *scene, double step_s) {
    double run[WAYS], processor[WAYS], motion[WAYS];
    stream kept[WAYS];
    for (int round = 0; round < ROUNDS; round++)
        for (int on = 0; on < WAYS; on++) {
            stream s = simulate(device, scene, step_s, on);
            double seconds = s.stats.run_time_s - s.stats.render.time_build_s;
            keep_least(&run[on], seconds, round);
            keep_least(&processor[on], s.processor_s, round);
            keep_least(&motion[on], s.stats.render.time_motion_s, round);
            if (round) free(kept[on].events);
            kept[on] = s;
        }
    printf("%s, steps of at most %g s\n", name, step_s);
    for (int on = 0; on < WAYS; on++) {
        const tides_stats *stats = &kept[on].stats;
        printf("%-14s run %7.2f s, processor %7.2f s, motion %7.2f s, projection %7.2f s; rows %8.0f k worked out, %8.0f k "
               "interpolated; %8.0f k projected; %.1f renders\n",
               ways[on], run[on], processor[on], motion[on], stats->render.time_project_s,
               1e-3 * (double)stats->render.gaussians_moved, 1e-3 * (double)stats->render.gaussians_interpolated,
               1e-3 * (double)stats->render.gaussians_projected, stats->renders_full_frame_equivalent);
    }
    for (int on = 1; on < WAYS; on++) print_apart(&kept[0], &kept[on]);
    for (int on = 0; on < WAYS; on++) free(kept[on].events);
}

static tides_scene *scene_of(const tides_gaussians *gaussians, tides_motion *motion) {
    tides_error error;
    tides_scene *scene = NULL;
    stop_on(tides_scene_create(&scene, &error), &error);
    stop_on(tides_scene_add_moving(scene, gaussians, motion, DURATION, NULL, 1, NULL, NULL, &error), &error);
    return scene;
}

int main(int count, char **words) {
    tides_device *device = NULL;
    tides_error error = {0};
    int gaussians = count > 2 ? atoi(words[2]) : 100000;
    double step_s = count > 3 ? atof(words[3]) : 0.01;
    random_hexplane_recipe recipe = random_hexplane_defaults(1);
    recipe.strength = 0.05;
    if (count > 4) recipe.size[3] = atoi(words[4]);
    if (gaussians < 16 || recipe.size[3] < 2) return fprintf(stderr, "bench_interpolation: at least 16 Gaussians, 2 rows\n"), 2;
    stop_on(tides_device_open(count > 1 ? words[1] : "cpu", &device, &error), &error);
    random_gaussians some = random_gaussians_make(2, gaussians, 0, 1.5);
    tides_scene *scenes[2] = {scene_of(&some.view, random_hexplane_make(&recipe)),
                              scene_of(&some.view, polynomial_motion_make(1, gaussians, 0.2))};
    compare("4DGaussians", device, scenes[0], step_s);
    compare("polynomial", device, scenes[1], step_s);
    for (int i = 0; i < 2; i++) tides_scene_destroy(scenes[i]);
    random_gaussians_free(&some);
    tides_device_close(device);
    return 0;
}
