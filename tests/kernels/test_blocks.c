/* Tile jobs that ask for some blocks only. These equal those of the whole tile, to the bit, on the device and in the reference.
 * Nothing else is written, and a list only has splats that touch them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/kernels/backend_pair.h"
#include "tests/support/scene_make.h"

static const uint64_t SEED = 1606;
static const double UNTOUCHED = -7;

typedef struct case_setting {
    pair_setting image;
    int lanes, outputs;
} case_setting;

static const case_setting settings[] = {{{TIDES_RULES_SMOOTH, 0, 3, 0}, 16, TD_OUT_SIGNAL},
                                        {{TIDES_RULES_SMOOTH, 1, 3, 0}, 1, TD_OUT_DIAGNOSTICS},
                                        {{TIDES_RULES_INRIA, 0, 3, 0}, 8, TD_OUT_COLOUR},
                                        {{TIDES_RULES_GSPLAT, 0, 3, 0}, 16, TD_OUT_SIGNAL}};

/* Sets of all sizes; the first jobs' are one block each, and one is whole. */
static void draw_sets(backend_pair *pair, uint64_t *state) {
    for (int i = 0; i < pair->job_count; i++) {
        const uint64_t some = scene_next(state), others = scene_next(state);
        int blocks = (int)(some & others & TD_ALL_BLOCKS);
        if (i < TD_TILE_BLOCKS || blocks == 0) blocks = 1 << (i & 15);
        pair->jobs[i].blocks = i == TD_TILE_BLOCKS ? TD_ALL_BLOCKS : blocks;
    }
}

static double *render(backend_pair *pair, int which, int outputs, uint64_t *blocks) {
    size_t reals = (size_t)pair->job_count * (size_t)outputs * TD_TILE_PIXELS;
    td_backend *backend = pair->backend[which];
    td_batch batch = pair_batch(pair, pair->jobs, pair->job_count, pair->records, outputs);
    double *planes = malloc(reals * sizeof *planes);
    tides_error error;
    assert_non_null(planes);
    for (size_t i = 0; i < reals; i++) planes[i] = UNTOUCHED;
    *blocks = backend->stats.blocks;
    scene_expect_ok(backend->type->render(backend, &batch, planes, &error), &error);
    *blocks = backend->stats.blocks - *blocks;
    return planes;
}

static int size_of(int blocks) {
    int size = 0;
    for (int k = 0; k < TD_TILE_BLOCKS; k++) size += blocks >> k & 1;
    return size;
}

/* `part` is `whole` where blocks are asked for. */
static void expect_parts(const backend_pair *pair, int outputs, const double *whole, const double *part) {
    for (int i = 0; i < pair->job_count; i++)
        for (int at = 0; at < outputs * TD_TILE_PIXELS; at++) {
            const td_job *job = &pair->jobs[i];
            int block = at % TD_TILE_PIXELS / TD_BLOCK_PIXELS;
            size_t place = (size_t)job->out * (size_t)outputs * TD_TILE_PIXELS + (size_t)at;
            double expected = job->blocks >> block & 1 ? whole[place] : UNTOUCHED;
            if (memcmp(&part[place], &expected, sizeof expected) != 0)
                fail_msg("%s: job %d, blocks %x, block %d, plane %d: %.9g, in the whole tile %.9g", pair->name, i,
                         (unsigned)job->blocks, block, at / TD_TILE_PIXELS, part[place], whole[place]);
        }
}

static void check_setting(const case_setting *setting, uint64_t seed) {
    tides_device *device = pair_device(setting->lanes);
    random_recipe recipe = pair_ordinary(seed);
    recipe.opacity_max = 0.999;
    recipe.sh_degree = 3;
    backend_pair pair = pair_make("blocks", device, &recipe, &setting->image, NULL);
    uint64_t state = seed, asked = 0, blocks;
    double *whole = pair_compare_planes(&pair, setting->outputs);
    draw_sets(&pair, &state);
    assert_true(pair.job_count > TD_TILE_BLOCKS);
    for (int i = 0; i < pair.job_count; i++) asked += (uint64_t)size_of(pair.jobs[i].blocks);
    for (int which = 0; which < 2; which++) {
        double *part = render(&pair, which, setting->outputs, &blocks);
        expect_parts(&pair, setting->outputs, whole, part);
        assert_int_equal(blocks, asked);
        free(part);
    }
    free(whole);
    pair_free(&pair);
    tides_device_close(device);
}

static void test_parts_are_of_the_whole(void **state) {
    (void)state;
    print_message("seed %llu\n", (unsigned long long)SEED);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) check_setting(&settings[i], SEED + i);
}

/* The list of one job: what touches its blocks, in order; how bright it may get is the whole tile's. */
static void check_list(backend_pair *pair, int which, const td_job *job) {
    td_job all = *job;
    all.blocks = TD_ALL_BLOCKS;
    td_stages whole = pair_stages_of(pair, which, &all), part = pair_stages_of(pair, which, job);
    int count = 0;
    for (int i = 0; i < whole.count; i++) {
        if (!(whole.sorted_mask[i] & job->blocks)) continue;
        assert_true(count < part.count);
        assert_int_equal(part.order[count], whole.order[i]);
        assert_int_equal(part.sorted_mask[count++], whole.sorted_mask[i]);
    }
    assert_int_equal(part.count, count);
    assert_memory_equal(&part.brightest, &whole.brightest, sizeof part.brightest);
    pair_stages_free(&whole);
    pair_stages_free(&part);
}

static void test_lists_hold_what_touches(void **unused) {
    (void)unused;
    const pair_setting smooth = {TIDES_RULES_SMOOTH, 0, 3, 0};
    tides_device *device = pair_device(16);
    random_recipe recipe = pair_ordinary(SEED);
    backend_pair pair = pair_make("lists", device, &recipe, &smooth, NULL);
    uint64_t state = SEED;
    draw_sets(&pair, &state);
    for (int i = 0; i < pair.job_count; i++)
        for (int which = 0; which < 2; which++) check_list(&pair, which, &pair.jobs[i]);
    pair_free(&pair);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_parts_are_of_the_whole),
                                       cmocka_unit_test(test_lists_hold_what_touches)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
