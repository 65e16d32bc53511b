/* The renderer's work on the host, shared out to threads: lists, swaps of depth, single pixels and the order of Gaussians are
 * the same to the bit with any number of them, and without a pool. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "renderer_of.h"
#include "render/td_swaps.h"
#include "td_hash.h"

#include <stdlib.h>
#include <string.h>

static const double START = 0.3, LENGTH = 0.4; /* [s] */
enum { POINTS = 20000, DIRECT = 100, MOST_SWAPS = 100000 };

/* What a renderer says of the scene. */
typedef struct said {
    td_swap *swap; /* (swaps) block by block */
    int swaps;
    td_point_value *value; /* (POINTS, and DIRECT that are projected at their own times) */
    uint64_t lists;        /* a hash of the lists, and of what tells which blocks move */
    double shared_time;    /* the pool's [s] */
} said;

static void take_swaps(const tides_renderer *renderer, said *to) {
    for (int block = 0; block < renderer->stats.tiles * TD_TILE_BLOCKS; block++) {
        int count;
        const td_swap *swap = td_renderer_swaps(renderer, block / TD_TILE_BLOCKS, block % TD_TILE_BLOCKS, &count);
        assert_true(to->swaps + count <= MOST_SWAPS);
        if (count > 0) memcpy(to->swap + to->swaps, swap, (size_t)count * sizeof *swap);
        to->swaps += count;
    }
}

static uint64_t hash_lists(const tides_renderer *renderer) {
    const td_candidates *lists = &renderer->candidates;
    const size_t tiles = (size_t)renderer->stats.tiles;
    uint64_t hash = td_hash_words(0, lists->first, (tiles + 1) * sizeof *lists->first);
    hash = td_hash_words(hash, lists->list, (size_t)lists->first[tiles] * sizeof *lists->list);
    hash = td_hash_words(hash, lists->moving, tiles * sizeof *lists->moving);
    hash = td_hash_words(hash, lists->travel, tiles * sizeof *lists->travel);
    hash = td_hash_words(hash, lists->moving_blocks, tiles * sizeof *lists->moving_blocks);
    return td_hash_words(hash, lists->block_travel, tiles * TD_TILE_BLOCKS * sizeof *lists->block_travel);
}

/* Points all over the image and the interval, most of them in a few tiles. */
static void take_points(tides_renderer *renderer, const random_scene *scene, said *to) {
    tides_error error;
    td_point *point = malloc(POINTS * sizeof *point);
    assert_non_null(point);
    for (int i = 0; i < POINTS; i++)
        point[i] = (td_point){START + LENGTH * (double)(i * 37 % POINTS) / (POINTS - 1),
                              i * 13 % (i % 4 ? 20 : scene->recipe.width), i * 29 % (i % 4 ? 20 : scene->recipe.height)};
    scene_expect_ok(td_renderer_exact_points(renderer, &error), &error);
    scene_expect_ok(td_renderer_points(renderer, scene->path, point, POINTS, to->value, &error), &error);
    scene_expect_ok(td_renderer_direct_points(renderer, scene->path, point, DIRECT, to->value + POINTS, &error), &error);
    free(point);
}

/* threads 0: no pool. */
static said ask(tides_device *device, const random_scene *scene, int threads) {
    tides_error error;
    td_pool *pool = NULL;
    said made = {malloc(MOST_SWAPS * sizeof(td_swap)), 0, malloc((POINTS + DIRECT) * sizeof(td_point_value)), 0, 0};
    assert_true(made.swap && made.value);
    tides_renderer *renderer = make_renderer(device, scene->scene, &scene->camera, TIDES_RULES_SMOOTH);
    if (threads > 0) scene_expect_ok(td_pool_create(threads, &pool, &error), &error);
    td_renderer_share(renderer, pool);
    td_renderer_by_blocks(renderer);
    scene_expect_ok(td_renderer_sweep(renderer, scene->path, START, START + LENGTH, &error), &error);
    scene_expect_ok(td_renderer_find_swaps(renderer, scene->path, &error), &error);
    made.lists = hash_lists(renderer);
    take_swaps(renderer, &made);
    take_points(renderer, scene, &made);
    made.shared_time = td_pool_shared_time(pool);
    tides_renderer_destroy(renderer);
    td_pool_release(pool);
    return made;
}

static void forget(said *of) {
    free(of->swap);
    free(of->value);
}

static void test_any_number_of_threads(void **state) {
    static const int threads[] = {1, 2, 3, 7};
    (void)state;
    random_recipe recipe = recipe_of(11);
    recipe.width = 200;
    recipe.height = 120;
    tides_device *device = open_device("reference");
    random_scene scene = random_scene_make(&recipe);
    said alone = ask(device, &scene, 0);
    assert_true(alone.swaps > 100);
    for (size_t i = 0; i < sizeof threads / sizeof *threads; i++) {
        said own = ask(device, &scene, threads[i]);
        assert_int_equal(own.swaps, alone.swaps);
        assert_memory_equal(own.swap, alone.swap, (size_t)alone.swaps * sizeof *alone.swap);
        assert_memory_equal(own.value, alone.value, (POINTS + DIRECT) * sizeof *alone.value);
        assert_true(own.lists == alone.lists);
        assert_true(threads[i] > 1 ? own.shared_time > 0 : !(own.shared_time > 0));
        forget(&own);
    }
    forget(&alone);
    random_scene_free(&scene);
    tides_device_close(device);
}

/* A hash of what is found by looking at each of many Gaussians: the store, and who may swap. */
static uint64_t look_at_all(tides_device *device, const random_scene *scene, int threads) {
    tides_error error;
    td_pool *pool = NULL;
    scene_expect_ok(tides_device_set_threads(device, threads, &error), &error);
    tides_renderer *renderer = make_renderer(device, scene->scene, &scene->camera, TIDES_RULES_SMOOTH);
    scene_expect_ok(td_pool_create(threads, &pool, &error), &error);
    td_renderer_share(renderer, pool);
    scene_expect_ok(td_renderer_sweep(renderer, scene->path, START, START + 1e-4, &error), &error);
    scene_expect_ok(td_renderer_find_swaps(renderer, scene->path, &error), &error);
    const td_store *store = &renderer->store;
    const size_t count = (size_t)store->count;
    const struct td_swaps *swaps = renderer->sweep.swaps;
    const int some[2] = {swaps->some_may, swaps->some_fade};
    uint64_t hash = td_hash_words(hash_lists(renderer), store->geometry, count * TD_GEOMETRY_STRIDE * sizeof *store->geometry);
    hash = td_hash_words(hash, store->sh, count * (size_t)store->sh_stride * sizeof *store->sh);
    hash = td_hash_words(hash, store->number, count * sizeof *store->number);
    hash = td_hash_words(hash, store->object, count * sizeof *store->object);
    hash = td_hash_words(hash, swaps->may, count * sizeof *swaps->may);
    hash = td_hash_words(hash, some, sizeof some);
    assert_true(swaps->some_may);
    tides_renderer_destroy(renderer);
    td_pool_release(pool);
    return hash;
}

static void test_many_gaussians(void **state) {
    static const int threads[] = {2, 3, 7};
    (void)state;
    random_recipe recipe = recipe_of(12);
    recipe.count = 30000;
    recipe.size = 0.002;
    tides_device *device = open_device("reference");
    random_scene scene = random_scene_make(&recipe);
    const uint64_t alone = look_at_all(device, &scene, 1);
    for (size_t i = 0; i < sizeof threads / sizeof *threads; i++) assert_true(look_at_all(device, &scene, threads[i]) == alone);
    random_scene_free(&scene);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_number_of_threads), cmocka_unit_test(test_many_gaussians)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
