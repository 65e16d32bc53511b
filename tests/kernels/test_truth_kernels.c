/* Planes of ground truth: the OpenCL kernels equal the single-precision reference to the bit, in every width, for all rules, at
 * rest and moving, with one object, a few, and more than one pass of objects. Blocks that are asked for alone equal those of
 * the whole tile. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/kernels/backend_pair.h"

static const uint64_t SEED = 1702;

typedef struct case_setting {
    const char *name;
    pair_setting image;
    int lanes, objects, moving;
    double size; /* of splats [scene units] */
    int lens;
} case_setting;

static const case_setting settings[] = {{"smooth", {TIDES_RULES_SMOOTH, 0, 0, 0}, 16, 3, 0, 0.12, 0},
                                        {"smooth, one lane, moving", {TIDES_RULES_SMOOTH, 1, 0, 0}, 1, 3, 1, 0.12, 0},
                                        {"smooth, one object", {TIDES_RULES_SMOOTH, 0, 0, 0}, 8, 1, 0, 0.12, 0},
                                        {"inria, twenty objects, moving", {TIDES_RULES_INRIA, 0, 0, 0}, 16, 20, 1, 0.3, 0},
                                        {"gsplat, smaller than a pixel", {TIDES_RULES_GSPLAT, 0, 0, 0}, 4, 3, 1, 2e-3, 0},
                                        {"radtan", {TIDES_RULES_SMOOTH, 0, 0, 0}, 16, 1, 1, 0.12, TIDES_LENS_RADTAN},
                                        {"equidistant", {TIDES_RULES_INRIA, 0, 0, 0}, 8, 3, 0, 0.12, TIDES_LENS_EQUIDISTANT}};

/* Sheets of five splats a place: soft order has something to do. */
static void make_sheets(td_store *store) {
    for (int i = 1; i < store->count; i++) {
        double *mean = store->geometry + (size_t)i * TD_GEOMETRY_STRIDE;
        if (i % 5 && store->object[i] == store->object[i - 1]) memcpy(mean, mean - TD_GEOMETRY_STRIDE, 3 * sizeof *mean);
    }
}

/* How many planes have more than one value: all but what can't. */
static int count_speaking(const backend_pair *pair, const double *planes) {
    int speaking = 0;
    for (size_t plane = 0; plane < TD_OUT_TRUTH; plane++) {
        int differs = 0;
        for (size_t job = 0; job < (size_t)pair->job_count; job++)
            for (size_t i = 0; i < TD_TILE_PIXELS; i++)
                differs |= planes[(job * TD_OUT_TRUTH + plane) * TD_TILE_PIXELS + i] != planes[plane * TD_TILE_PIXELS];
        speaking += differs;
    }
    return speaking;
}

/* Some blocks alone, on both. */
static void compare_blocks(backend_pair *pair, const double *whole) {
    for (int i = 0; i < pair->job_count; i++) pair->jobs[i].blocks = 1 << (i & 15) | 1 << (i * 7 & 15);
    for (int k = 0; k < 2; k++) {
        const size_t reals = (size_t)pair->job_count * TD_OUT_TRUTH * TD_TILE_PIXELS;
        td_batch batch = pair_batch(pair, pair->jobs, pair->job_count, pair->records, TD_OUT_TRUTH);
        double *planes = malloc(reals * sizeof *planes);
        tides_error error;
        assert_non_null(planes);
        scene_expect_ok(pair->backend[k]->type->render(pair->backend[k], &batch, planes, &error), &error);
        for (int i = 0; i < pair->job_count; i++)
            for (size_t at = 0; at < TD_OUT_TRUTH * TD_TILE_PIXELS; at++) {
                const size_t place = (size_t)pair->jobs[i].out * TD_OUT_TRUTH * TD_TILE_PIXELS + at;
                if (!(pair->jobs[i].blocks >> (at % TD_TILE_PIXELS / TD_BLOCK_PIXELS) & 1)) continue;
                assert_memory_equal(&planes[place], &whole[place], sizeof *planes);
            }
        free(planes);
    }
}

static void compare_setting(const case_setting *setting) {
    tides_device *device = pair_device(setting->lanes);
    random_recipe recipe = pair_ordinary(SEED);
    recipe.objects = setting->objects;
    recipe.moving = setting->moving;
    recipe.lens = setting->lens;
    recipe.sh_degree = 0;
    recipe.size = setting->size;
    recipe.opacity_max = 0.999;
    backend_pair pair = pair_make(setting->name, device, &recipe, &setting->image, setting->moving ? NULL : make_sheets);
    print_message("%s, %d lanes\n", setting->name, setting->lanes);
    assert_true(pair.job_count > 0);
    double *planes = pair_compare_planes(&pair, TD_OUT_TRUTH);
    assert_int_equal(count_speaking(&pair, planes), TD_OUT_TRUTH);
    compare_blocks(&pair, planes);
    free(planes);
    pair_free(&pair);
    tides_device_close(device);
}

static void test_kernels_equal_the_reference(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) compare_setting(&settings[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kernels_equal_the_reference)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
