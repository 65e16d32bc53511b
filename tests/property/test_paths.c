/* Record paths (kernels/path.h): images made of them are those of projections to within the tolerance, and better for a smaller
 * one; their rates are their own; they depend on the interval alone; what moves by itself is worked out at nodes only; and the
 * device takes the reference's bits. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_device.h"
#include "tests/property/renderer_of.h"
#include "tests/support/moving_scene.h"
#include "tests/support/opencl.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 1409;
enum { TIMES = 7 };

/* Across a sample of the paths, at 0.5 s. */
static const double start = 0.494, stop = 0.504;
static const double shares[TIMES] = {0, 0.061, 0.25, 0.47, 0.6, 0.83, 1};

/* L and L_dot of all tiles at the times, (times x tiles x 2 x TD_TILE_PIXELS). */
static double *tiles_at(tides_renderer *renderer, const tides_trajectory *path, const double *times, int count) {
    int tiles = renderer->stats.tiles;
    double *planes = malloc((size_t)count * (size_t)tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS * sizeof *planes);
    td_request *requests = calloc((size_t)count * (size_t)tiles, sizeof *requests);
    tides_error error;
    assert_true(planes && requests);
    for (int i = 0; i < count * tiles; i++) requests[i].tile = i % tiles, requests[i].slot = i / tiles;
    const td_tile_batch batch = {times, count, TD_SIDE_BEGINS, requests, count * tiles, TD_OUT_SIGNAL};
    scene_expect_ok(td_renderer_tiles(renderer, path, &batch, planes, &error), &error);
    free(requests);
    return planes;
}

static void set_times(double times[TIMES]) {
    for (int i = 0; i < TIMES; i++) times[i] = i == TIMES - 1 ? stop : start + shares[i] * (stop - start);
}

/* All times of a renderer that has just been made; with tolerance > 0 on record paths. */
static double *render(tides_renderer *renderer, const tides_trajectory *path, double tolerance) {
    double times[TIMES];
    tides_error error;
    set_times(times);
    if (tolerance > 0) scene_expect_ok(td_renderer_paths(renderer, tolerance, 0, &error), &error);
    scene_expect_ok(td_renderer_sweep(renderer, path, start, stop, &error), &error);
    return tiles_at(renderer, path, times, TIMES);
}

/* Pixels that aren't cut off by the image's edge. */
static int is_inside(const tides_renderer *renderer, size_t at) {
    int tile = (int)(at / (TD_OUT_SIGNAL * TD_TILE_PIXELS)) % renderer->stats.tiles, pixel = (int)(at % TD_TILE_PIXELS);
    int x = tile % renderer->candidates.tiles_x * TD_TILE + pixel / 16 % 4 * 4 + pixel % 4;
    int y = tile / renderer->candidates.tiles_x * TD_TILE + pixel / 64 * 4 + pixel / 4 % 4;
    return x < renderer->image.width && y < renderer->image.height;
}

/* The largest difference in L, and in L_dot over the interval. */
static void compare(const tides_renderer *renderer, const double *a, const double *b, double worst[2]) {
    size_t reals = (size_t)TIMES * (size_t)renderer->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS;
    worst[0] = worst[1] = 0;
    for (size_t i = 0; i < reals; i++) {
        int plane = (int)(i / TD_TILE_PIXELS % TD_OUT_SIGNAL);
        if (is_inside(renderer, i)) worst[plane] = fmax(worst[plane], fabs(a[i] - b[i]) * (plane ? stop - start : 1));
    }
}

typedef struct world_kind {
    const char *name;
    double spread, size, camera_speed;
    int rules, objects;
} world_kind;

static const world_kind kinds[] = {{"ordinary", 1.5, 0.12, 1, TIDES_RULES_SMOOTH, 3},
                                   {"around the camera", 5, 0.3, 4, TIDES_RULES_SMOOTH, 1},
                                   {"small, fast", 1.5, 0.01, 8, TIDES_RULES_SMOOTH, 2},
                                   {"gsplat", 1.5, 0.12, 1, TIDES_RULES_GSPLAT, 3}};
enum { KINDS = sizeof kinds / sizeof *kinds };

static random_scene make_kind(const world_kind *kind) {
    random_recipe recipe = recipe_of(SEED);
    recipe.spread = kind->spread;
    recipe.size = kind->size;
    recipe.camera_speed = kind->camera_speed;
    recipe.objects = kind->objects;
    recipe.sh_degree = 2;
    return random_scene_make(&recipe);
}

/* In double: a pixel may see some splats that are off by the tolerance each, at an edge of darkness the log more. */
static void test_images_are_those_of_projections(void **state) {
    static const double tolerances[] = {1e-3, 1e-5, 1e-7};
    tides_device *device = open_device("reference");
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        random_scene scene = make_kind(&kinds[k]);
        tides_renderer *exact = make_renderer(device, scene.scene, &scene.camera, kinds[k].rules);
        double *projected = render(exact, scene.path, 0), worst[3][2];
        for (int i = 0; i < 3; i++) {
            tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, kinds[k].rules);
            double *on_paths = render(renderer, scene.path, tolerances[i]);
            tides_render_stats stats;
            tides_renderer_stats(renderer, &stats);
            compare(renderer, projected, on_paths, worst[i]);
            print_message("%s, tolerance %g: L is off by %.2g, L_dot by %.2g per interval; %d rows of %d nodes, %d of %d "
                          "taken\n",
                          kinds[k].name, tolerances[i], worst[i][0], worst[i][1], (int)stats.gaussians_at_nodes,
                          (int)stats.path_nodes, (int)stats.gaussians_on_paths,
                          (int)(stats.gaussians_on_paths + stats.gaussians_projected));
            assert_true(stats.gaussians_on_paths > 0);
            if (kinds[k].rules == TIDES_RULES_SMOOTH) assert_true(worst[i][0] <= 3 * tolerances[i]);
            free(on_paths);
            tides_renderer_destroy(renderer);
        }
        if (kinds[k].rules == TIDES_RULES_SMOOTH) assert_true(worst[2][0] < 0.1 * worst[0][0] || worst[0][0] < 1e-9);
        free(projected);
        tides_renderer_destroy(exact);
        random_scene_free(&scene);
    }
    tides_device_close(device);
}

/* Central differences of L against L_dot, in double, of the images that paths make: well within one node's interval, where
 * nothing is cut (an edge is where a rate jumps). */
static void test_rates_are_its_own(void **state) {
    const double at[3] = {0.4972, 0.4972 - 1e-6, 0.4972 + 1e-6};
    tides_device *device = open_device("reference");
    tides_error error;
    (void)state;
    for (int k = 0; k < 3; k++) {
        random_scene scene = make_kind(&kinds[k]);
        tides_renderer *renderer = make_renderer(device, scene.scene, &scene.camera, kinds[k].rules);
        scene_expect_ok(td_renderer_paths(renderer, 1e-2, 0, &error), &error); /* coarse: not the projection's rates */
        scene_expect_ok(td_renderer_sweep(renderer, scene.path, start, stop, &error), &error);
        double *planes = tiles_at(renderer, scene.path, at, 3), largest = 0, worst = 0;
        size_t slot = (size_t)renderer->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS;
        for (size_t i = 0; i < slot; i++) {
            if (i / TD_TILE_PIXELS % TD_OUT_SIGNAL != TD_OUT_L || !is_inside(renderer, i)) continue;
            double difference = (planes[2 * slot + i] - planes[slot + i]) / (at[2] - at[1]);
            worst = fmax(worst, fabs(difference - planes[i + TD_TILE_PIXELS]));
            largest = fmax(largest, fabs(difference));
        }
        print_message("%s: rates up to %.3g, off by %.2g\n", kinds[k].name, largest, worst);
        assert_true(largest > 0.1 && worst < 1e-5 * largest);
        free(planes);
        tides_renderer_destroy(renderer);
        random_scene_free(&scene);
    }
    tides_device_close(device);
}

/* One time at a time, after other intervals, in another order: the same bits. */
static void test_paths_depend_on_the_interval_alone(void **state) {
    tides_device *device = open_fast_device();
    random_scene scene = make_kind(&kinds[0]);
    tides_error error;
    double times[TIMES];
    (void)state;
    set_times(times);
    tides_renderer *a = make_renderer(device, scene.scene, &scene.camera, TIDES_RULES_SMOOTH);
    tides_renderer *b = make_renderer(device, scene.scene, &scene.camera, TIDES_RULES_SMOOTH);
    double *all = render(a, scene.path, 1e-5);
    size_t slot = (size_t)a->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS;
    scene_expect_ok(td_renderer_paths(b, 1e-5, 0, &error), &error);
    scene_expect_ok(td_renderer_sweep(b, scene.path, 0.2, 0.22, &error), &error);
    scene_expect_ok(td_renderer_sweep(b, scene.path, start, stop, &error), &error);
    for (int i = TIMES - 1; i >= 0; i--) {
        double *one = tiles_at(b, scene.path, &times[i], 1);
        assert_memory_equal(one, all + (size_t)i * slot, slot * sizeof *one);
        free(one);
    }
    free(all);
    tides_renderer_destroy(a);
    tides_renderer_destroy(b);
    random_scene_free(&scene);
    tides_device_close(device);
}

/* Gaussians that move by themselves: the device's planes are the reference's, near the projection's, for fewer rows. */
static void test_moving_gaussians(void **state) {
    random_recipe recipe = recipe_of(SEED + 1);
    moving_scene scene = moving_scene_make(&recipe, 0.5);
    tides_device *reference = open_device("reference-f32"), *device = NULL;
    tides_renderer *direct = make_renderer(reference, scene.scene, &scene.base.camera, TIDES_RULES_SMOOTH);
    tides_renderer *paths = make_renderer(reference, scene.scene, &scene.base.camera, TIDES_RULES_SMOOTH);
    double *projected = render(direct, scene.base.path, 0), *on_paths = render(paths, scene.base.path, 1e-4), worst[2];
    size_t bytes = (size_t)TIMES * (size_t)paths->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS * sizeof *projected;
    tides_render_stats with, without;
    (void)state;
    tides_renderer_stats(paths, &with);
    tides_renderer_stats(direct, &without);
    compare(paths, projected, on_paths, worst);
    print_message("moving: L is off by %.2g; %d rows moved instead of %d\n", worst[0], (int)with.gaussians_moved,
                  (int)without.gaussians_moved);
    assert_true(worst[0] < 1e-3);
    assert_true(with.gaussians_moved < without.gaussians_moved);
    if (tides_device_open("cpu", &device, NULL) == TIDES_OK) {
        tides_renderer *quick = make_renderer(device, scene.scene, &scene.base.camera, TIDES_RULES_SMOOTH);
        double *planes = render(quick, scene.base.path, 1e-4);
        assert_memory_equal(planes, on_paths, bytes);
        free(planes);
        tides_renderer_destroy(quick);
        tides_device_close(device);
    }
    free(projected);
    free(on_paths);
    tides_renderer_destroy(direct);
    tides_renderer_destroy(paths);
    moving_scene_free(&scene);
    tides_device_close(reference);
    skip_without_opencl();
}

/* Intervals in which all that moves follows paths, and others in which some doesn't, in turns: jobs have lists of their own in
 * these, which a device must not take for the sweep's. */
static void test_intervals_of_both_kinds(void **state) {
    enum { INTERVALS = 12 };
    random_recipe recipe = recipe_of(SEED + 1);
    moving_scene scene = moving_scene_make(&recipe, 0.5);
    tides_device *reference = open_device("reference-f32"), *device = open_fast_device();
    tides_renderer *exact = make_renderer(reference, scene.scene, &scene.base.camera, TIDES_RULES_SMOOTH);
    tides_renderer *quick = make_renderer(device, scene.scene, &scene.base.camera, TIDES_RULES_SMOOTH);
    const size_t bytes = (size_t)exact->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS * sizeof(double);
    int direct = 0;
    tides_error error;
    (void)state;
    scene_expect_ok(td_renderer_paths(exact, 1e-4, 0, &error), &error);
    scene_expect_ok(td_renderer_paths(quick, 1e-4, 0, &error), &error);
    for (int k = 0; k < INTERVALS; k++) {
        const double from = start + 0.01 * k, to = from + (k % 3 == 1 ? 1e-4 : 0.2), time = from + 0.3 * (to - from);
        scene_expect_ok(td_renderer_sweep(exact, scene.base.path, from, to, &error), &error);
        scene_expect_ok(td_renderer_sweep(quick, scene.base.path, from, to, &error), &error);
        direct += exact->paths.direct_moves != 0;
        double *expected = tiles_at(exact, scene.base.path, &time, 1), *planes = tiles_at(quick, scene.base.path, &time, 1);
        if (memcmp(planes, expected, bytes) != 0) fail_msg("interval %d has other bits than the reference's", k);
        free(expected);
        free(planes);
    }
    assert_true(direct > 2 && direct < INTERVALS - 2);
    tides_renderer_destroy(exact);
    tides_renderer_destroy(quick);
    moving_scene_free(&scene);
    tides_device_close(reference);
    tides_device_close(device);
}

/* The scene's camera, shaken to and fro 40 times within the interval. */
static tides_trajectory *shaken(const random_scene *scene) {
    enum { SAMPLES = 81 };
    tides_pose_sample samples[SAMPLES];
    tides_trajectory *path = NULL;
    tides_pose pose;
    tides_error error;
    memset(samples, 0, sizeof samples);
    scene_expect_ok(tides_trajectory_sample(scene->path, 0, &samples[0], &error), &error);
    scene_expect_ok(tides_trajectory_at(scene->path, start, &pose, &error), &error);
    for (int i = SAMPLES - 1; i >= 0; i--) {
        samples[i] = samples[0];
        samples[i].time = start + (stop - start) * i / (SAMPLES - 1);
        samples[i].has_rates = 0;
        for (int k = 0; k < 3; k++) samples[i].position[k] = pose.position[k] + (i % 2 ? 0.02 : -0.02);
    }
    scene_expect_ok(tides_trajectory_create(samples, SAMPLES, &path, &error), &error);
    return path;
}

/* A camera that no cubic follows: no node is projected, and the image is that of projections, in both references too. */
static void test_nobody_has_one(void **state) {
    static const char *const specs[] = {"reference-f32", "reference", "cpu"};
    random_recipe recipe = recipe_of(SEED + 2);
    random_scene scene = random_scene_make(&recipe);
    tides_trajectory *camera = shaken(&scene);
    (void)state;
    for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
        tides_device *device = NULL;
        tides_error error;
        if (tides_device_open(specs[i], &device, &error) != TIDES_OK) continue; /* skipped below */
        tides_renderer *direct = make_renderer(device, scene.scene, &scene.camera, TIDES_RULES_SMOOTH);
        tides_renderer *paths = make_renderer(device, scene.scene, &scene.camera, TIDES_RULES_SMOOTH);
        double *projected = render(direct, camera, 0), *on_paths = render(paths, camera, 1e-4);
        tides_render_stats stats;
        tides_renderer_stats(paths, &stats);
        assert_true(stats.path_nodes == 0 && stats.gaussians_projected > 0);
        assert_memory_equal(projected, on_paths,
                            (size_t)TIMES * (size_t)paths->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS * sizeof *projected);
        free(projected);
        free(on_paths);
        tides_renderer_destroy(direct);
        tides_renderer_destroy(paths);
        tides_device_close(device);
    }
    tides_trajectory_destroy(camera);
    random_scene_free(&scene);
    skip_without_opencl();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_images_are_those_of_projections),
                                       cmocka_unit_test(test_rates_are_its_own),
                                       cmocka_unit_test(test_paths_depend_on_the_interval_alone),
                                       cmocka_unit_test(test_moving_gaussians),
                                       cmocka_unit_test(test_intervals_of_both_kinds),
                                       cmocka_unit_test(test_nobody_has_one)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
