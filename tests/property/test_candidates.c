/* Candidate lists are conservative: a Gaussian that isn't in a tile's list isn't in the tile at any time of the interval. And
 * results don't depend on batches: how many jobs go to the device at once, in how many launches. On random scenes that move
 * fast. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"
#include "tests/support/opencl.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 4242;
enum { OUTPUTS = TD_OUT_DIAGNOSTICS };

/* -- candidate lists ----------------------------------------------------------------------------------------------- */

/* Every tile at each time from the lists that the renderer has, into planes (slots x tiles x OUTPUTS x TD_TILE_PIXELS). */
static double *render_tiles(tides_renderer *renderer, const tides_trajectory *path, const double *times, int slots) {
    int tiles = renderer->stats.tiles;
    double *planes = malloc((size_t)slots * (size_t)tiles * OUTPUTS * TD_TILE_PIXELS * sizeof *planes);
    td_request *requests = calloc((size_t)slots * (size_t)tiles, sizeof *requests);
    tides_error error;
    assert_true(planes && requests);
    for (int i = 0; i < slots * tiles; i++) requests[i].tile = i % tiles, requests[i].slot = i / tiles;
    scene_expect_ok(td_renderer_tiles(renderer, path,
                                      &(td_tile_batch){times, slots, TD_SIDE_BEGINS, requests, slots * tiles, OUTPUTS}, planes,
                                      &error),
                    &error);
    free(requests);
    return planes;
}

static void sweep(tides_renderer *renderer, const tides_trajectory *path, double start, double stop) {
    tides_error error;
    scene_expect_ok(td_renderer_sweep(renderer, path, start, stop, &error), &error);
}

/* Lists that hold every Gaussian. */
static void list_everything(tides_renderer *renderer) {
    tides_error error;
    int count = renderer->store.count;
    float *boxes = calloc((size_t)count * 4, sizeof *boxes);
    assert_non_null(boxes);
    for (int i = 0; i < count; i++) {
        boxes[4 * (size_t)i + 2] = (float)renderer->image.width;
        boxes[4 * (size_t)i + 3] = (float)renderer->image.height;
    }
    const td_boxes all = {.box = boxes, .travel = renderer->sweep.travel, .object_moves = renderer->sweep.object_moves};
    scene_expect_ok(td_candidates_build(&renderer->candidates, &renderer->store, &all, &error), &error);
    renderer->sweep.listed = 0; /* what the renderer has isn't of its boxes any more */
    free(boxes);
}

/* Fails where two sets of tiles differ within the image. */
static void expect_same_tiles(const tides_renderer *renderer, const double *a, const double *b, const double *times, int slots,
                              const char *what) {
    int tiles_x = renderer->candidates.tiles_x, tiles = renderer->stats.tiles;
    size_t tile = OUTPUTS * TD_TILE_PIXELS;
    for (int slot = 0; slot < slots; slot++)
        for (int y = 0; y < renderer->image.height; y++)
            for (int x = 0; x < renderer->image.width; x++)
                for (int k = 0; k < OUTPUTS; k++) {
                    int which = slot * tiles + y / TD_TILE * tiles_x + x / TD_TILE;
                    size_t at = (size_t)which * tile + (size_t)(k * TD_TILE_PIXELS + td_tile_pixel(x % TD_TILE, y % TD_TILE));
                    if (memcmp(&a[at], &b[at], sizeof *a) != 0)
                        fail_msg("%s: plane %d at (%d, %d), time %.9g: %.9g and %.9g", what, k, x, y, times[slot], a[at],
                                 b[at]);
                }
}

enum { SLOTS = 5 };

/* Lists for [start, start + length] give what lists of everything give, at any time in it. */
static void check_lists(tides_renderer *renderer, const random_scene *s, double start, double length, uint64_t trial) {
    char what[100];
    double times[SLOTS] = {start, start + 0.13 * length, start + 0.5 * length, start + 0.81 * length, start + length};
    snprintf(what, sizeof what, "trial %d, lists for %g ms", (int)trial, 1e3 * length);
    sweep(renderer, s->path, start, times[SLOTS - 1]);
    int listed = renderer->candidates.first[renderer->stats.tiles];
    double *swept = render_tiles(renderer, s->path, times, SLOTS);
    list_everything(renderer);
    assert_true(listed < renderer->candidates.first[renderer->stats.tiles]); /* the lists do leave something out */
    double *full = render_tiles(renderer, s->path, times, SLOTS);
    expect_same_tiles(renderer, full, swept, times, SLOTS, what);
    for (int i = 0; i < SLOTS; i++) {
        sweep(renderer, s->path, times[i], times[i]);
        double *exact = render_tiles(renderer, s->path, &times[i], 1);
        expect_same_tiles(renderer, full + (size_t)i * (size_t)renderer->stats.tiles * OUTPUTS * TD_TILE_PIXELS, exact,
                          &times[i], 1, "lists for the time itself");
        free(exact);
    }
    free(swept);
    free(full);
}

/* Objects that move up to about 2 units/s and cameras up to about 10, with Gaussians in front of, around and behind them. */
static random_recipe fast_recipe(uint64_t trial) {
    random_recipe recipe = recipe_of(SEED + 100 + trial);
    recipe.sh_degree = 0;
    recipe.camera_speed = trial % 4 == 0 ? 6 : 3;
    recipe.spread = trial % 3 == 0 ? 4.5 : 1.5;
    recipe.size = trial % 2 == 0 ? 0.02 : 0.12;
    return recipe;
}

/* A scene of that recipe; the camera rests in every fifth, so that only some of the boxes change from sweep to sweep. */
static random_scene fast_scene(uint64_t trial) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0.01, -0.02, 0.03};
    random_recipe recipe = fast_recipe(trial);
    random_scene s = random_scene_make(&recipe);
    if (trial % 5 == 4) {
        tides_error error;
        tides_trajectory_destroy(s.path);
        s.path = NULL;
        scene_expect_ok(tides_trajectory_create_static(position, quaternion, &s.path, &error), &error);
    }
    return s;
}

/* Lists are made again where a camera, or an object before one at rest, moves, and only there. */
static void test_lists_hold_on_where_nothing_moves(void **state) {
    (void)state;
    tides_device *device = open_fast_device();
    for (int moves = 0; moves < 2; moves++) {
        random_recipe recipe = fast_recipe(4);
        recipe.objects = 1 + moves; /* the first is at rest */
        random_scene s = random_scene_make(&recipe);
        tides_trajectory *rest = NULL;
        tides_error error;
        scene_expect_ok(tides_trajectory_create_static((double[]){0, 0, -4}, (double[]){1, 0, 0, 0}, &rest, &error), &error);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_SMOOTH);
        const uint64_t *made = &renderer->candidates.serial;
        sweep(renderer, rest, 0.1, 0.11);
        const uint64_t first = *made;
        sweep(renderer, rest, 0.11, 0.12);
        sweep(renderer, rest, 0.12, 0.12);
        assert_int_equal(*made, first + 2 * (uint64_t)moves);
        sweep(renderer, s.path, 0.12, 0.13);
        const uint64_t moved = *made;
        assert_int_equal(moved, first + 2 * (uint64_t)moves + 1);
        sweep(renderer, rest, 0.13, 0.14); /* back: what there is of before is another camera's */
        assert_int_equal(*made, moved + 1);
        tides_renderer_destroy(renderer);
        tides_trajectory_destroy(rest);
        random_scene_free(&s);
    }
    tides_device_close(device);
}

static const double lengths[] = {1e-3, 3e-3, 10e-3, 25e-3, 50e-3};
enum { LENGTHS = sizeof lengths / sizeof *lengths };

/* For boxes, up to nearly the distance of the paths' samples: beyond it, what a splat does is no longer near a cubic. */
static const double box_lengths[] = {1e-3, 10e-3, 50e-3, 100e-3, 200e-3};
enum { BOX_LENGTHS = sizeof box_lengths / sizeof *box_lengths };

static double random_start(uint64_t *seed, double length) { return scene_between(seed, 0, 1 - length); }

static void test_candidate_lists_are_conservative(void **state) {
    (void)state;
    tides_device *device = open_fast_device();
    for (uint64_t trial = 0; trial < 12; trial++) {
        random_scene s = fast_scene(trial);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, (int)trial % RULES);
        uint64_t seed = s.recipe.seed;
        for (int i = 0; i < LENGTHS; i++) check_lists(renderer, &s, random_start(&seed, lengths[i]), lengths[i], trial);
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
    }
    tides_device_close(device);
}

/* How far a splat's box at one time reaches out of a swept box, within the image [px]; 0 where either is outside of it. */
static double overhang(const tides_renderer *renderer, const float *swept, const float *now) {
    double right = renderer->image.width, bottom = renderer->image.height;
    if (!(now[0] < right && now[1] < bottom && now[2] > 0 && now[3] > 0)) return 0;
    double x = fmax(swept[0] - fmax(now[0], 0), fmin(now[2], right) - swept[2]);
    double y = fmax(swept[1] - fmax(now[1], 0), fmin(now[3], bottom) - swept[3]);
    return fmax(fmax(x, y), 0);
}

/* The largest overhang over times within [start, start + length]. */
static double worst_overhang(tides_renderer *renderer, const random_scene *s, double start, double length) {
    enum { TIMES = 16 };
    size_t bytes = (size_t)renderer->store.count * 4 * sizeof(float);
    float *swept = malloc(bytes);
    double worst = 0;
    assert_non_null(swept);
    sweep(renderer, s->path, start, start + length);
    memcpy(swept, renderer->sweep.boxes, bytes);
    for (int k = 0; k <= TIMES; k++) {
        double time = start + length * k / TIMES;
        sweep(renderer, s->path, time, time);
        for (int i = 0; i < renderer->store.count; i++)
            worst = fmax(worst, overhang(renderer, swept + 4 * (size_t)i, renderer->sweep.boxes + 4 * (size_t)i));
    }
    free(swept);
    return worst;
}

/* Tiles are coarse and edges faint, so wrong boxes need not show in images: here they are looked at themselves. Both are a
 * hundredth of a pixel wider than the splat, which is what rounding may use up. */
static void test_swept_boxes_hold_the_splats(void **state) {
    (void)state;
    double worst = 0;
    tides_device *device = open_fast_device();
    for (uint64_t trial = 0; trial < 40; trial++) {
        random_scene s = fast_scene(trial);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, (int)trial % RULES);
        uint64_t seed = s.recipe.seed;
        for (int i = 0; i < BOX_LENGTHS; i++) {
            double start = random_start(&seed, box_lengths[i]);
            worst = fmax(worst, worst_overhang(renderer, &s, start, box_lengths[i]));
        }
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
    }
    print_message("swept boxes: splats reach out by at most %.3g px\n", worst);
    assert_true(worst < 0.01);
    tides_device_close(device);
}

/* -- batches ------------------------------------------------------------------------------------------------------- */

static void check_batches(const char *spec) {
    static const double times[SLOTS] = {0.50, 0.502, 0.504, 0.506, 0.508};
    static const int limits[] = {1, 100, 1000};
    random_recipe recipe = recipe_of(SEED + 200);
    random_scene s = random_scene_make(&recipe);
    tides_device *device = NULL;
    if (tides_device_open(spec, &device, NULL) == TIDES_OK) {
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_SMOOTH);
        int tiles = renderer->stats.tiles, record_limit = renderer->record_limit;
        sweep(renderer, s.path, times[0], times[SLOTS - 1]);
        double *all = render_tiles(renderer, s.path, times, SLOTS);
        for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) { /* in several launches */
            renderer->record_limit = limits[i];
            double *cut = render_tiles(renderer, s.path, times, SLOTS);
            expect_same_tiles(renderer, all, cut, times, SLOTS, "small record limit");
            free(cut);
        }
        renderer->record_limit = record_limit;
        for (int i = 0; i < SLOTS * tiles; i++) { /* one by one */
            td_request request = {i % tiles, 0, 0};
            double tile[OUTPUTS * TD_TILE_PIXELS];
            tides_error error;
            scene_expect_ok(td_renderer_tiles(renderer, s.path,
                                              &(td_tile_batch){&times[i / tiles], 1, TD_SIDE_BEGINS, &request, 1, OUTPUTS},
                                              tile, &error),
                            &error);
            assert_memory_equal(tile, all + (size_t)i * OUTPUTS * TD_TILE_PIXELS, sizeof tile);
        }
        free(all);
        tides_renderer_destroy(renderer);
    }
    tides_device_close(device);
    random_scene_free(&s);
}

static void test_batches_do_not_matter(void **state) {
    (void)state;
    check_batches("reference");
    check_batches("reference-f32");
    check_batches("cpu");
    skip_without_opencl();
}

/* -- blocks ---------------------------------------------------------------------------------------------------------------- */

/* A tile moves where one of its blocks does, and travels as far as the one that goes furthest. */
static void expect_of_blocks(const tides_renderer *r, int tile) {
    double travel = 0;
    int moves = 0;
    for (int k = 0; k < TD_TILE_BLOCKS; k++) {
        moves |= td_renderer_block_moves(r, tile, k);
        travel = fmax(travel, td_renderer_block_travel(r, tile, k));
        assert_true(td_renderer_block_moves(r, tile, k) || td_renderer_block_travel(r, tile, k) <= 0);
    }
    assert_true(moves == td_renderer_tile_moves(r, tile));
    assert_true(!(travel < td_renderer_tile_travel(r, tile)) && !(travel > td_renderer_tile_travel(r, tile)));
}

/* Blocks of moving tiles of which the sweep says that nothing moves in them: how many; fails where one changes by more than the
 * end of its list may (image.stop, of the brightest splat). */
static int check_still_blocks(tides_renderer *r, const random_scene *s, double start, double length) {
    double times[SLOTS] = {start, start + 0.2 * length, start + 0.5 * length, start + 0.9 * length, start + length};
    const int tiles = r->stats.tiles;
    int still = 0;
    sweep(r, s->path, start, start + length);
    double *planes = render_tiles(r, s->path, times, SLOTS);
    for (int t = 0; t < tiles; t++) expect_of_blocks(r, t);
    for (int i = 0; i < tiles * TD_TILE_BLOCKS; i++) {
        int tile = i / TD_TILE_BLOCKS, block = i % TD_TILE_BLOCKS;
        if (!td_renderer_tile_moves(r, tile) || td_renderer_block_moves(r, tile, block)) continue;
        still++;
        for (int k = TD_TILE_BLOCKS * block; k < TD_TILE_BLOCKS * (block + 1); k++)
            for (int slot = 1; slot < SLOTS; slot++) {
                const double *first = planes + (size_t)tile * OUTPUTS * TD_TILE_PIXELS + k;
                const double *now = first + (size_t)slot * (size_t)tiles * OUTPUTS * TD_TILE_PIXELS;
                if (!(fabs(now[TD_OUT_L] - first[TD_OUT_L]) <= 2 * (double)r->image.stop))
                    fail_msg("tile %d, block %d: L was %.9g and is %.9g", tile, block, first[TD_OUT_L], now[TD_OUT_L]);
            }
    }
    free(planes);
    return still;
}

static void test_blocks_say_what_moves_in_them(void **state) {
    (void)state;
    tides_device *device = open_fast_device();
    int still = 0;
    for (uint64_t trial = 4; trial < 35; trial += 5) { /* before a camera at rest */
        random_scene s = fast_scene(trial);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, (int)(trial / 5) % 2);
        uint64_t seed = s.recipe.seed;
        td_renderer_by_blocks(renderer);
        for (int i = 0; i < LENGTHS; i++)
            still += check_still_blocks(renderer, &s, random_start(&seed, lengths[i]), lengths[i]);
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
    }
    tides_device_close(device);
    print_message("%d blocks of moving tiles were still\n", still);
    assert_true(still > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lists_hold_on_where_nothing_moves),
                                       cmocka_unit_test(test_candidate_lists_are_conservative),
                                       cmocka_unit_test(test_swept_boxes_hold_the_splats),
                                       cmocka_unit_test(test_batches_do_not_matter),
                                       cmocka_unit_test(test_blocks_say_what_moves_in_them)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
