/* Hints for depth order. Whatever a sweep's earlier jobs left, tiles are equal to the bit. A list whose order lasts is sorted
 * once, and one whose order changes is sorted again. On the reference, and in OpenCL with vectors and with work-groups, which
 * sort differently. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_device.h"
#include "tests/property/renderer_of.h"
#include "tests/support/event_stream.h"
#include "tests/support/opencl.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 60221;
static const double START = 0.1, STOP = 0.3;

enum { BATCHES = 6, SLOTS_MOST = 3 };

/* -- rendering ----------------------------------------------------------------------------------------------------- */

/* All tiles at each of the times, in one batch. */
static double *render(tides_renderer *r, const tides_trajectory *path, const double *times, int slots, size_t *reals) {
    int tiles = r->stats.tiles, count = tiles * slots;
    td_request *requests = calloc((size_t)count, sizeof *requests);
    tides_error error;
    *reals = (size_t)count * TD_OUT_COLOUR * TD_TILE_PIXELS;
    double *planes = calloc(*reals, sizeof *planes);
    assert_true(requests && planes);
    for (int i = 0; i < count; i++) requests[i] = (td_request){i % tiles, i / tiles, 0};
    scene_expect_ok(td_renderer_tiles(r, path, &(td_tile_batch){times, slots, TD_SIDE_BEGINS, requests, count, TD_OUT_COLOUR},
                                      planes, &error),
                    &error);
    free(requests);
    return planes;
}

static void sweep(tides_renderer *r, const tides_trajectory *path) {
    tides_error error;
    scene_expect_ok(td_renderer_sweep(r, path, START, STOP, &error), &error);
}

static uint64_t kept_by(const tides_renderer *r, uint64_t *jobs) {
    tides_render_stats stats;
    tides_renderer_stats(r, &stats);
    *jobs = stats.tile_jobs;
    return stats.lists_kept;
}

/* -- the same whatever was left ------------------------------------------------------------------------------------- */

static void compare_batches(tides_device *device, const random_scene *scene, uint64_t *state) {
    tides_renderer *hinted = make_renderer(device, scene->scene, &scene->camera, TIDES_RULES_SMOOTH);
    tides_renderer *plain = make_renderer(device, scene->scene, &scene->camera, TIDES_RULES_SMOOTH);
    sweep(hinted, scene->path);
    sweep(plain, scene->path);
    plain->candidates.instant = 1; /* no hints */
    for (int batch = 0; batch < BATCHES; batch++) {
        double times[SLOTS_MOST];
        int slots = 1 + (int)(random_uniform(state) * SLOTS_MOST);
        for (int k = 0; k < slots; k++) times[k] = START + (STOP - START) * random_uniform(state);
        size_t reals;
        double *with = render(hinted, scene->path, times, slots, &reals);
        double *without = render(plain, scene->path, times, slots, &reals);
        assert_memory_equal(with, without, reals * sizeof *with);
        free(with);
        free(without);
    }
    uint64_t jobs, jobs_plain, kept = kept_by(hinted, &jobs), kept_plain = kept_by(plain, &jobs_plain);
    assert_int_equal(jobs, jobs_plain);
    print_message("%s: %d of %d lists were in order, %d without hints\n", device->info.name, (int)kept, (int)jobs,
                  (int)kept_plain);
    tides_renderer_destroy(hinted);
    tides_renderer_destroy(plain);
}

/* `lanes` 0: the reference in single precision, -1: in double. */
static tides_device *device_of(int lanes) {
    tides_device *device = NULL;
    tides_error error;
    if (lanes <= 0) return open_device(lanes ? "reference" : "reference-f32");
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        return NULL;
    }
    scene_expect_ok(status, &error);
    device->info.lanes = lanes;
    return device;
}

static const int all_lanes[] = {-1, 0, 1, 16};
enum { DEVICES = sizeof all_lanes / sizeof *all_lanes };

/* Some blocks of each tile, in batches of their own sets, from lists and orders that other jobs left: as in whole tiles. */
static void compare_sets(tides_device *device, const random_scene *scene, uint64_t *state) {
    tides_renderer *r = make_renderer(device, scene->scene, &scene->camera, TIDES_RULES_SMOOTH);
    int tiles = r->stats.tiles;
    size_t reals;
    td_request *requests = calloc((size_t)tiles, sizeof *requests);
    assert_non_null(requests);
    sweep(r, scene->path);
    for (int batch = 0; batch < BATCHES; batch++) {
        double time = START + (STOP - START) * random_uniform(state);
        for (int i = 0; i < tiles; i++)
            requests[i] = (td_request){i, 0, 1 + (int)(random_uniform(state) * (TD_ALL_BLOCKS - 1))};
        const td_tile_batch sets = {&time, 1, TD_SIDE_BEGINS, requests, tiles, TD_OUT_COLOUR};
        double *part = calloc((size_t)tiles * TD_OUT_COLOUR * TD_TILE_PIXELS, sizeof *part);
        tides_error error;
        assert_non_null(part);
        scene_expect_ok(td_renderer_tiles(r, scene->path, &sets, part, &error), &error);
        double *whole = render(r, scene->path, &time, 1, &reals);
        for (size_t i = 0; i < reals; i++) {
            int blocks = requests[i / (TD_OUT_COLOUR * TD_TILE_PIXELS)].blocks, block = (int)(i % TD_TILE_PIXELS) / 16;
            if ((blocks >> block & 1) && memcmp(&part[i], &whole[i], sizeof *part) != 0)
                fail_msg("%s: number %zu is %.9g, in the whole tile %.9g", device->info.name, i, part[i], whole[i]);
        }
        free(part);
        free(whole);
    }
    free(requests);
    tides_renderer_destroy(r);
}

static void test_same_images(void **unused) {
    (void)unused;
    print_message("seed %llu\n", (unsigned long long)SEED);
    for (int k = 0; k < DEVICES; k++) {
        tides_device *device = device_of(all_lanes[k]);
        for (uint64_t trial = 0; device && trial < 3; trial++) {
            uint64_t state = SEED + trial;
            random_recipe recipe = recipe_of(SEED + 10 * trial);
            random_scene scene = random_scene_make(&recipe);
            compare_batches(device, &scene, &state);
            compare_sets(device, &scene, &state);
            random_scene_free(&scene);
        }
        tides_device_close(device);
    }
    skip_without_opencl();
}

/* -- what is sorted -------------------------------------------------------------------------------------------------- */

/* From (x, 0, z) at time 0 on at (x_dot, 0, z_dot) per second. */
static tides_trajectory *line(double x, double x_dot, double z, double z_dot) {
    tides_pose_sample samples[3] = {{0}};
    tides_trajectory *path = NULL;
    tides_error error;
    for (int i = 0; i < 3; i++) { /* splines reproduce straight lines */
        samples[i].time = 0.5 * i;
        samples[i].position[0] = x + x_dot * samples[i].time;
        samples[i].position[2] = z + z_dot * samples[i].time;
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, 3, &path, &error), &error);
    return path;
}

static void add_splat(tides_scene *scene, double z, double z_dot) {
    const float mean[3] = {0, 0, 0}, log_scale[3] = {-2, -2, -2}, quaternion[4] = {1, 0, 0, 0}, opacity = 0;
    const float sh[3] = {(float)z, 1, 1};
    const tides_gaussians gaussian =
        {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = &opacity, .sh = sh};
    tides_trajectory *path = line(0, 0, z, z_dot);
    tides_error error;
    scene_expect_ok(tides_scene_add(scene, &gaussian, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
}

/* Two splats, the farther first, the other moving towards it: they change places at 0.2 s where z_dot is 5. Renders at three
 * times, one after the other; returns how many lists were in order, in a tile that sees both. */
static int kept_in_run(tides_device *device, double z_dot) {
    static const tides_intrinsics camera = {16, 16, 20, 20, 8, 8, {0}};
    static const double times[3] = {0.11, 0.15, 0.29};
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    add_splat(scene, 5, 0);
    add_splat(scene, 4, z_dot);
    tides_trajectory *path = line(0, 0.1, 0, 0);
    tides_renderer *r = make_renderer(device, scene, &camera, TIDES_RULES_SMOOTH);
    uint64_t jobs;
    size_t reals;
    sweep(r, path);
    for (int i = 0; i < 3; i++) free(render(r, path, &times[i], 1, &reals));
    int kept = (int)kept_by(r, &jobs);
    assert_int_equal(jobs, 3);
    tides_renderer_destroy(r);
    tides_trajectory_destroy(path);
    tides_scene_destroy(scene);
    return kept;
}

static void test_sorted_where_order_changes(void **unused) {
    (void)unused;
    for (int k = 0; k < DEVICES; k++) {
        tides_device *device = device_of(all_lanes[k]);
        if (!device) continue;
        assert_int_equal(kept_in_run(device, 0), 2); /* all but the first */
        assert_int_equal(kept_in_run(device, 5), 1); /* nor the last, after they have met */
        tides_device_close(device);
    }
    skip_without_opencl();
}

/* -- who leaves one ------------------------------------------------------------------------------------------------ */

static td_job ask(td_candidates *candidates) {
    td_job job = {.count = TD_PAD};
    td_candidates_give_hint(candidates, 0, &job);
    return job;
}

static int asks_again(td_candidates *candidates) {
    td_job job = ask(candidates);
    uint8_t kept = 1;
    td_candidates_take_hints(candidates, &job, 1, &kept);
    return job.new_hint != 0;
}

/* One job of a batch leaves an order and no other; where the batch fails there is none; where it changed the tile asks for no
 * other. */
static void test_who_leaves_one(void **unused) {
    (void)unused;
    int first[2] = {0, TD_PAD};
    uint8_t hint = 0, kept = 0;
    td_candidates candidates = {.tiles_x = 1, .tiles_y = 1, .first = first, .hint = &hint};
    td_job one = ask(&candidates), two = ask(&candidates);
    assert_int_equal(one.new_hint, 1);
    assert_int_equal(one.hint + two.hint + two.new_hint, 0);
    td_candidates_take_hints(&candidates, &one, 1, NULL);
    assert_true(asks_again(&candidates));
    two = ask(&candidates);
    assert_int_equal(two.hint, 1);
    assert_int_equal(two.new_hint, 0);
    td_candidates_take_hints(&candidates, &two, 1, &kept);
    two = ask(&candidates);
    assert_int_equal(two.hint + two.new_hint, 0);
    assert_int_equal(td_candidates_hint_count(&candidates), 1 + TD_PAD);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_images),
        cmocka_unit_test(test_sorted_where_order_changes),
        cmocka_unit_test(test_who_leaves_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
