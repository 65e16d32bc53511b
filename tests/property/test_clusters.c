/* Culling: a cluster that is left out of an interval, or a splat without a box in it, is invisible at all times in it. Cameras
 * are within the scene, turn, rush past and shake; objects have paths of their own; splats have every size; with lenses, by
 * every rule. And most that is out of view is left out. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "device/td_device.h"
#include "render/td_space_order.h"
#include "tests/property/renderer_of.h"
#include "tests/support/opencl.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 771;
enum { TRIALS = 60, TIMES = 24, OBJECTS = 80 };

/* Clusters that are in view at some time of those looked at, and the others; and of these, those that were left out. */
typedef struct tally {
    int seen, unseen, left_out;
} tally;

/* Cameras. */
static random_recipe recipe_around(uint64_t trial) {
    static const double sizes[] = {0.01, 0.1, 0.5, 3}, speeds[] = {0, 1, 3, 6};
    random_recipe recipe = random_recipe_defaults(SEED + trial);
    recipe.width = 61, recipe.height = 43;
    recipe.spread = trial % 5 == 0 ? 40 : 8; /* the camera is 4 from the middle */
    recipe.size = sizes[trial % 4];
    recipe.camera_speed = speeds[trial / 4 % 4];
    recipe.opacity_min = trial % 3 ? 0.1 : 1e-3;
    recipe.lens = trial % 7 == 5 ? TIDES_LENS_RADTAN : trial % 7 == 6 ? TIDES_LENS_EQUIDISTANT : TIDES_LENS_NONE;
    return recipe;
}

static tides_trajectory *path_through(const tides_pose_sample *samples, size_t count) {
    tides_trajectory *path = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create(samples, count, &path, &error), &error);
    return path;
}

static tides_trajectory *object_path(uint64_t *seed) {
    tides_pose_sample samples[5] = {{0}};
    for (int i = 0; i < 5; i++) {
        samples[i] = (tides_pose_sample){.time = 0.25 * i, .quaternion = {1, 0, 0, 0}};
        for (int k = 0; k < 3; k++) samples[i].position[k] = scene_between(seed, -0.5, 0.5);
        for (int k = 0; k < 3; k++) samples[i].quaternion[1 + k] = scene_between(seed, -0.3, 0.3);
    }
    return path_through(samples, 5);
}

/* Splats about a place, `wide` to each side, some with an opacity near what is cut off; where they are more than TD_CLUSTER, in
 * heaps of so many. Beside: the camera. */
static void add_object(tides_scene *scene, const random_recipe *recipe, int count, double wide, int moves, int beside,
                       uint64_t *seed) {
    td_gaussians g;
    tides_error error;
    double place[3];
    const double near = count > TD_CLUSTER ? 0.05 : wide;
    scene_expect_ok(td_gaussians_create(&g, count, 0, &error), &error);
    const double far = beside ? 1 : recipe->spread;
    for (int k = 0; k < 3; k++) place[k] = scene_between(seed, -far, far) - (beside && k == 2 ? 4 : 0);
    for (int64_t i = 0; i < g.count; i++) {
        const double opacity = scene_between(seed, recipe->opacity_min, 0.9);
        for (int k = 0; k < 3; k++)
            g.mean[3 * i + k] = i % TD_CLUSTER
                                    ? g.mean[3 * (i / TD_CLUSTER * TD_CLUSTER) + k] + (float)scene_between(seed, 0, near)
                                    : (float)(place[k] + scene_between(seed, -wide, wide));
        for (int k = 0; k < 3; k++) g.log_scale[3 * i + k] = (float)(log(recipe->size) + scene_between(seed, -2, 1));
        for (int k = 0; k < 4; k++) g.quaternion[4 * i + k] = (float)scene_between(seed, -1, 1) + 0.01F;
        for (int k = 0; k < 3; k++) g.sh[3 * i + k] = 0.5F;
        g.opacity_logit[i] = (float)log(opacity / (1 - opacity));
    }
    tides_gaussians view = td_gaussians_view(&g);
    tides_trajectory *path = moves ? object_path(seed) : NULL;
    scene_expect_ok(tides_scene_add(scene, &view, path, scene_between(seed, 0.5, 1.5), NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
    td_gaussians_free(&g);
}

/* Each of its objects is a cluster, but for a large one. */
static tides_scene *scene_around(const random_recipe *recipe, uint64_t *seed) {
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    for (int i = 0; i < OBJECTS; i++)
        add_object(scene, recipe, 1 + (int)scene_between(seed, 0, 20), scene_between(seed, 0, 1.5) * scene_between(seed, 0, 1),
                   i % 2, i % 3 == 0, seed);
    add_object(scene, recipe, 40 * TD_CLUSTER, recipe->spread, 0, 0, seed);
    return scene;
}

/* As wide as 70 degrees, of which a fifth is brought in from beside. */
static void widen(tides_intrinsics *camera) {
    static const tides_lens barrel = {TIDES_LENS_RADTAN, 0, -0.25, 0.07, -0.004, 0, 2e-3, -3e-3};
    camera->fx = camera->fy = 0.7 * camera->width;
    camera->lens = barrel;
}

/* A camera at rest but for shaking at about 200 Hz, about its place and its axes. */
static tides_trajectory *shaking_path(uint64_t *seed) {
    enum { SAMPLES = 401 };
    static tides_pose_sample samples[SAMPLES];
    for (int i = 0; i < SAMPLES; i++) {
        samples[i] = (tides_pose_sample){.time = i / 400.0, .position = {0, 0, -4}, .quaternion = {1, 0, 0, 0}};
        for (int k = 0; k < 3; k++) {
            samples[i].position[k] += scene_between(seed, -0.005, 0.005);
            samples[i].quaternion[1 + k] = scene_between(seed, -0.2, 0.2);
        }
    }
    return path_through(samples, SAMPLES);
}

/* A camera that rushes ahead, along what is beside it. */
static tides_trajectory *rushing_path(uint64_t *seed) {
    tides_pose_sample samples[5] = {{0}};
    for (int i = 0; i < 5; i++) {
        samples[i] = (tides_pose_sample){.time = 0.25 * i, .position = {0, 0, -7 + 1.5 * i}, .quaternion = {1, 0, 0, 0}};
        for (int k = 0; k < 2; k++) samples[i].position[k] = scene_between(seed, -0.2, 0.2);
    }
    return path_through(samples, 5);
}

/* Boxes of all Gaussians at a time, whatever is in view. */
static void boxes_at(tides_renderer *renderer, const tides_trajectory *path, double time, float *boxes, float *travel) {
    tides_error error;
    scene_expect_ok(td_renderer_sweep_views(renderer, path, time, time, 0, &error), &error);
    const td_sweep_request request = {.views = (const double *)renderer->scratch.views, .end = renderer->store.count};
    scene_expect_ok(renderer->backend->type->sweep(renderer->backend, &request, boxes, travel, &error), &error);
}

static int touches_image(const tides_renderer *renderer, const float *box) {
    return box[0] < (float)renderer->image.width && box[1] < (float)renderer->image.height && box[2] > 0 && box[3] > 0;
}

static void check_interval(tides_renderer *renderer, const tides_trajectory *path, double start, double length, uint64_t trial,
                           tally *all) {
    const int count = renderer->store.count, clusters = renderer->clusters.count;
    float *boxes = calloc((size_t)count, 4 * sizeof *boxes), *travel = calloc((size_t)count, sizeof *travel);
    uint8_t *seen = calloc((size_t)clusters, 1);
    tides_error error;
    assert_true(boxes && travel && seen);
    scene_expect_ok(td_renderer_sweep_alone(renderer, path, start, start + length, &error), &error);
    for (int i = 0; i <= TIMES; i++) {
        const double time = start + length * i / TIMES;
        boxes_at(renderer, path, time, boxes, travel);
        for (int c = 0; c < clusters; c++)
            for (int g = renderer->clusters.of[c].begin; g < renderer->clusters.of[c].end; g++) {
                if (!touches_image(renderer, boxes + 4 * (size_t)g)) continue;
                seen[c] = 1;
                if (!touches_image(renderer, renderer->sweep.boxes + 4 * (size_t)g))
                    fail_msg("trial %d: splat %d, of no box in [%g, %g] s, is at [%g, %g] x [%g, %g] at %g s", (int)trial, g,
                             start, start + length, boxes[4 * g], boxes[4 * g + 2], boxes[4 * g + 1], boxes[4 * g + 3], time);
                if (renderer->clusters.state[c] != TD_CLUSTER_SEEN)
                    fail_msg("trial %d: splat %d of cluster %d, left out of [%g, %g] s, is at [%g, %g] x [%g, %g] at %g s",
                             (int)trial, g, c, start, start + length, boxes[4 * g], boxes[4 * g + 2], boxes[4 * g + 1],
                             boxes[4 * g + 3], time);
            }
    }
    for (int c = 0; c < clusters; c++) {
        all->seen += seen[c];
        all->unseen += !seen[c];
        all->left_out += renderer->clusters.state[c] != TD_CLUSTER_SEEN;
    }
    free(boxes), free(travel), free(seen);
}

static void test_nothing_is_seen_of_what_is_left_out(void **state) {
    (void)state;
    static const double lengths[] = {0, 1e-3, 1e-2, 5e-2, 0.2};
    tally small = {0, 0, 0}, large = {0, 0, 0}, bent = {0, 0, 0}; /* splats; through lenses */
    tides_device *device = open_fast_device();
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        const random_recipe recipe = recipe_around(trial);
        random_scene s = random_scene_make(&recipe);
        uint64_t seed = recipe.seed;
        if (recipe.lens == TIDES_LENS_RADTAN) widen(&s.camera);
        tides_scene *scene = scene_around(&recipe, &seed);
        tides_trajectory *other = trial % 6 == 3 ? shaking_path(&seed) : trial % 3 == 1 ? rushing_path(&seed) : NULL;
        tides_renderer *renderer = make_renderer(device, scene, &s.camera, (int)(trial / 3 % RULES));
        for (int i = 0; i < 5; i++)
            check_interval(renderer, other ? other : s.path, scene_between(&seed, 0, 1 - lengths[i]), lengths[i], trial,
                           recipe.lens != TIDES_LENS_NONE ? &bent
                           : recipe.size > 0.2            ? &large
                                                          : &small);
        tides_renderer_destroy(renderer);
        tides_trajectory_destroy(other);
        tides_scene_destroy(scene);
        random_scene_free(&s);
    }
    const tally *all[] = {&small, &large, &bent};
    for (int i = 0; i < 3; i++)
        print_message("clusters of %s: %d of %d out of view left out, %d in view\n",
                      i == 0   ? "small splats"
                      : i == 1 ? "large ones"
                               : "any, through lenses",
                      all[i]->left_out, all[i]->unseen, all[i]->seen);
    assert_true(small.seen > 500 && small.left_out > 0.8 * small.unseen);
    assert_true(large.seen > 500 && large.left_out > 0.6 * large.unseen);
    assert_true(bent.seen > 500 && bent.left_out > 0.5 * bent.unseen); /* what is behind */
    tides_device_close(device);
}

/* What leaves the view has no box and is in no list; what comes back has. Splats that can't be bounded are always looked at. */
static void test_clusters_come_and_go(void **state) {
    (void)state;
    const random_recipe recipe = recipe_around(1);
    random_scene s = random_scene_make(&recipe);
    uint64_t seed = recipe.seed;
    tides_scene *scene = scene_around(&recipe, &seed);
    tides_device *device = open_fast_device();
    tides_renderer *renderer = make_renderer(device, scene, &s.camera, TIDES_RULES_SMOOTH);
    tides_trajectory *away = NULL, *there = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create_static((double[]){0, 0, -4}, (double[]){1, 0, 0, 0}, &there, &error), &error);
    scene_expect_ok(tides_trajectory_create_static((double[]){0, 0, -100}, (double[]){0, 0, 1, 0}, &away, &error), &error);
    const int tiles = renderer->stats.tiles;
    int listed[3];
    for (int i = 0; i < 3; i++) {
        scene_expect_ok(td_renderer_sweep_alone(renderer, i == 1 ? away : there, 0.2, 0.21, &error), &error);
        listed[i] = renderer->candidates.first[tiles];
        for (int g = 0; g < renderer->store.count && i == 1; g++)
            assert_false(touches_image(renderer, renderer->sweep.boxes + 4 * (size_t)g));
    }
    assert_true(listed[0] > 0 && listed[1] == 0 && listed[2] == listed[0]);
    for (int c = 0; c < renderer->clusters.count; c++) renderer->clusters.of[c].radius = INFINITY;
    scene_expect_ok(td_renderer_sweep_alone(renderer, s.path, 0.2, 0.21, &error), &error);
    for (int c = 0; c < renderer->clusters.count; c++) assert_int_equal(renderer->clusters.state[c], TD_CLUSTER_SEEN);
    tides_trajectory_destroy(away);
    tides_trajectory_destroy(there);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    tides_scene_destroy(scene);
    random_scene_free(&s);
}

/* Boxes of what is seen are the same where they come from a device's own memory, and those of others stay. */
static void test_boxes_from_afar(void **state) {
    (void)state;
    skip_without_opencl();
    const random_recipe recipe = recipe_around(1);
    random_scene s = random_scene_make(&recipe);
    uint64_t seed = recipe.seed;
    tides_scene *scene = scene_around(&recipe, &seed);
    float *boxes[2] = {NULL, NULL};
    size_t bytes = 0;
    for (int far = 0; far < 2; far++) {
        tides_device *device = open_device("cpu");
        tides_error error;
        if (far) device->near = 0;
        tides_renderer *renderer = make_renderer(device, scene, &s.camera, TIDES_RULES_SMOOTH);
        for (int i = 0; i < 4; i++) /* some come, some go */
            scene_expect_ok(td_renderer_sweep_alone(renderer, s.path, 0.2 * i, 0.2 * i + 0.01, &error), &error);
        const td_groups groups = td_clusters_seen(&renderer->clusters, 0, renderer->store.objects);
        int runs = 1;
        for (int i = 1; i < groups.count; i++) runs += groups.number[i] != groups.number[i - 1] + 1;
        assert_true(runs > 10);
        bytes = (size_t)renderer->store.count * 4 * sizeof *boxes[far];
        boxes[far] = malloc(bytes);
        assert_non_null(boxes[far]);
        memcpy(boxes[far], renderer->sweep.boxes, bytes);
        tides_renderer_destroy(renderer);
        tides_device_close(device);
    }
    assert_memory_equal(boxes[0], boxes[1], bytes);
    free(boxes[0]), free(boxes[1]);
    tides_scene_destroy(scene);
    random_scene_free(&s);
}

/* -- the order of what rests ---------------------------------------------------------------------------------------------- */

/* The way from each to the next, in all. */
static double way_of(const float *mean, const int64_t *order, int count) {
    double way = 0;
    for (int i = 1; i < count; i++) {
        const float *a = mean + 3 * (order ? order[i - 1] : i - 1), *b = mean + 3 * (order ? order[i] : i);
        if (isfinite(a[0] + b[0])) way += hypot(hypot((double)a[0] - b[0], (double)a[1] - b[1]), (double)a[2] - b[2]);
    }
    return way;
}

static void test_neighbours_in_space_are_neighbours(void **state) {
    (void)state;
    enum { COUNT = 4000 };
    static float mean[3 * COUNT];
    static uint8_t left_out[COUNT], taken[COUNT];
    static int64_t order[COUNT];
    uint64_t seed = SEED;
    tides_error error;
    for (int i = 0; i < COUNT; i++) {
        left_out[i] = i % 10 == 3;
        for (int k = 0; k < 3; k++) mean[3 * i + k] = (float)scene_between(&seed, -1, 1);
    }
    const double before = way_of(mean, NULL, COUNT);
    mean[0] = 1e30F, mean[30] = NAN, mean[60] = -INFINITY; /* in nobody's way */
    scene_expect_ok(td_space_order(mean, left_out, COUNT, order, &error), &error);
    for (int i = 0; i < COUNT * 9 / 10; i++) {
        assert_true(order[i] >= 0 && order[i] < COUNT && !left_out[order[i]] && !taken[order[i]]);
        taken[order[i]] = 1;
        if (!(fabsf(mean[3 * order[i]]) < 2)) mean[3 * order[i]] = mean[3 * order[i] + 1] = mean[3 * order[i] + 2] = 0;
    }
    assert_true(way_of(mean, order, COUNT * 9 / 10) < 0.2 * before);
    for (int i = 0; i < 3 * COUNT; i++) mean[i] = 0.25F; /* all in one place: as they came */
    scene_expect_ok(td_space_order(mean, left_out, COUNT, order, &error), &error);
    for (int i = 1; i < COUNT * 9 / 10; i++) assert_true(order[i] > order[i - 1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_nothing_is_seen_of_what_is_left_out),
                                       cmocka_unit_test(test_clusters_come_and_go), cmocka_unit_test(test_boxes_from_afar),
                                       cmocka_unit_test(test_neighbours_in_space_are_neighbours)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
