/* Cost of a level of refinement beyond its tiles: rendering, unpacking and judging 1 % of the tiles against all of them.
 *   bench_overhead [SCENE] [DEVICE]
 * Without SCENE: 20 000 random Gaussians that fill the view. At 346x260, seen from an orbit. Full frames and levels take turns.
 * The best of each is the machine's capability, the median what it did; compare numbers of one run only. */
#include "render/td_renderer.h"
#include "solver/td_simulator.h"
#include "tests/support/model_steps.h"
#include "tests/support/random_scene.h"
#include "td_sort.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 12, OFFSETS = 16, SIZES = 4, TILES_MAX = 4096, RANDOM_COUNT = 20000 };
static const double size_shares[SIZES] = {1.0, 0.01, 0.03, 0.1}; /* of the tiles that hold a splat */
static const double interval_s = 1e-3;                           /* of the candidate lists */

static void stop_on(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "bench_overhead: %s\n", error->text);
    exit(1);
}

/* As refine.c does it for the cuts of a level: one launch, and each tile's samples judged. */
static double level_seconds(tides_simulator *s, const int *tiles, int count, double *planes) {
    static double sample[4 * TD_TILE_PIXELS];
    tides_error error;
    static td_request requests[TILES_MAX];
    double begun = td_now(), time = 0.5 * interval_s;
    for (int i = 0; i < count; i++) {
        requests[i].tile = tiles[i];
        requests[i].slot = 0;
    }
    stop_on(td_renderer_tiles(s->renderer, s->camera,
                              &(td_tile_batch){&time, 1, TD_SIDE_BEGINS, requests, count, TD_OUT_SIGNAL}, planes, &error),
            &error);
    for (int i = 0; i < count; i++) {
        const td_tile *tile = &s->layout.unit[tiles[i]];
        size_t at = s->layout.first_pixel[tiles[i]];
        td_unpack_tile(tile, planes + (size_t)i * TD_OUT_SIGNAL * TD_TILE_PIXELS, sample, sample + TD_TILE_PIXELS);
        td_signals signals = {s->now.plane[TD_PLANE_S] + at, s->now.plane[TD_PLANE_S_DOT] + at, sample,
                              sample + TD_TILE_PIXELS};
        const td_estimated judged = {0.5 * interval_s, &signals, s->sensor.pixels.reference + at, NULL, 0, tile->count};
        td_sensor_estimate(&s->sensor, &judged, at, 0, 0);
    }
    return td_now() - begun;
}

/* `count` of the tiles with splats, evenly spread, beginning at `offset`. */
static void pick(const int *filled, int filled_count, int count, int offset, int *tiles) {
    for (int i = 0; i < count; i++) tiles[i] = filled[((int)((double)i * filled_count / count) + offset) % filled_count];
}

/* The candidates of these tiles: their share of the work. */
static double work_of(const tides_simulator *s, const int *tiles, int count) {
    double work = 0;
    for (int i = 0; i < count; i++)
        work += s->renderer->candidates.first[tiles[i] + 1] - s->renderer->candidates.first[tiles[i]];
    return work;
}

/* Seconds of a size: each offset's best, averaged, since tiles differ; and the average of all. */
static double typical(double seconds[OFFSETS][ROUNDS], double *average) {
    double best = 0;
    *average = 0;
    for (int i = 0; i < OFFSETS; i++) {
        qsort(seconds[i], ROUNDS, sizeof(double), td_ascending);
        best += seconds[i][0] / OFFSETS;
        *average += seconds[i][ROUNDS / 2] / OFFSETS;
    }
    return best;
}

static void measure(tides_simulator *s) {
    static double seconds[SIZES][OFFSETS][ROUNDS];
    tides_error error;
    int filled[TILES_MAX], tiles[TILES_MAX], filled_count = 0;
    double work[SIZES] = {0}, frame = 0, average;
    double *planes = malloc((size_t)s->layout.units * TD_OUT_SIGNAL * TD_TILE_PIXELS * sizeof *planes);
    if (!planes || s->layout.units > TILES_MAX) exit(1);
    stop_on(tides_simulator_run(s, s->epoch, NULL, NULL, NULL, NULL, &error), &error);
    stop_on(td_renderer_sweep(s->renderer, s->camera, 0, interval_s, &error), &error);
    for (int t = 0; t < s->layout.units; t++)
        if (s->renderer->candidates.first[t + 1] > s->renderer->candidates.first[t]) filled[filled_count++] = t;
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < OFFSETS; i++)
            for (int k = 0; k < SIZES; k++) {
                int count = (int)fmax(1, rint(size_shares[k] * filled_count));
                pick(filled, filled_count, count, i * filled_count / OFFSETS, tiles);
                seconds[k][i][round] = level_seconds(s, tiles, count, planes);
                work[k] += work_of(s, tiles, count);
            }
    printf("%d of %d tiles hold splats\n%8s %10s %10s %10s %12s %12s\n", filled_count, s->layout.units, "tiles", "best us",
           "median us", "of frame %", "its work %", "beyond %");
    for (int k = 0; k < SIZES; k++) {
        double best = typical(seconds[k], &average);
        if (k == 0) frame = best;
        double share = 100 * best / frame, ideal = 100 * work[k] / work[0];
        printf("%7.3g%% %10.1f %10.1f %10.2f %12.2f %12.2f\n", 100 * size_shares[k], 1e6 * best, 1e6 * average, share, ideal,
               share - ideal);
    }
    free(planes);
}

/* An orbit around what is there, as bench_render's. */
static tides_trajectory *orbit_of(const tides_scene *scene, tides_error *error) {
    double lower[3], upper[3], size = 0;
    tides_trajectory *camera = NULL;
    tides_scene_bounds(scene, lower, upper);
    tides_orbit orbit = {{0}, {0, -1, 0}, 0, 0, 0, 1.0, 0, 1};
    for (int i = 0; i < 3; i++) {
        orbit.target[i] = 0.5 * (lower[i] + upper[i]);
        size = fmax(size, upper[i] - lower[i]);
    }
    orbit.radius = 0.8 * size;
    stop_on(tides_trajectory_create_orbit(&orbit, &camera, error), error);
    return camera;
}

int main(int argc, char **argv) {
    tides_error error;
    tides_scene *scene = NULL;
    tides_device *device;
    tides_simulator *s;
    random_scene random = {.scene = NULL};
    tides_intrinsics intrinsics = {346, 260, 300, 300, 173, 130, {0}};
    if (argc > 1 && argv[1][0]) {
        stop_on(tides_scene_create(&scene, &error), &error);
        stop_on(tides_scene_add_file(scene, argv[1], NULL, 1, &error), &error);
    } else {
        random_recipe recipe = random_recipe_defaults(1);
        recipe.count = RANDOM_COUNT;
        recipe.size = 0.03;
        recipe.width = 346;
        recipe.height = 260;
        random = random_scene_make(&recipe);
        scene = random.scene;
        intrinsics = random.camera;
    }
    tides_trajectory *camera = random.scene ? random.path : orbit_of(scene, &error);
    stop_on(tides_device_open(argc > 2 ? argv[2] : NULL, &device, &error), &error);
    tides_image_params image;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_image_params_defaults(&image);
    tides_sensor_defaults(&sensor);
    model_steps(&stepping);
    stop_on(tides_simulator_create(device, scene, camera, &intrinsics, &image, &sensor, &stepping, 0, 0.5, NULL, NULL, &s,
                                   &error),
            &error);
    printf("%lld Gaussians\n", (long long)tides_scene_count(scene));
    measure(s);
    tides_simulator_destroy(s);
    tides_device_close(device);
    if (random.scene) {
        random_scene_free(&random);
    } else {
        tides_trajectory_destroy(camera);
        tides_scene_destroy(scene);
    }
    return 0;
}
