/* The OpenCL kernels equal the single-precision reference bit for bit in every stage: all rules, SH degrees, rates on and off,
 * several objects, and scenes that are hard on single precision. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/kernels/backend_pair.h"

#include <math.h>

static const uint64_t SEED = 71;

/* -- scenes -------------------------------------------------------------------------------------------------------- */

static random_recipe ordinary(void) { return pair_ordinary(SEED); }

/* Some Gaussians at, around and behind the camera, which moves fast. */
static random_recipe around_the_camera(void) {
    random_recipe recipe = ordinary();
    recipe.spread = 5;
    recipe.size = 0.3;
    recipe.camera_speed = 8;
    return recipe;
}

static random_recipe huge(void) {
    random_recipe recipe = ordinary();
    recipe.count = 60;
    recipe.size = 6;
    recipe.opacity_max = 0.3;
    return recipe;
}

static random_recipe smaller_than_a_pixel(void) {
    random_recipe recipe = ordinary();
    recipe.size = 2e-3; /* 0.04 px: as small as the antialiasing of gsplat still shows */
    recipe.opacity_max = 0.999;
    recipe.count = 400;
    return recipe;
}

/* From invisible to exactly 1 in single precision. */
static random_recipe extreme_opacities(void) {
    random_recipe recipe = ordinary();
    recipe.opacity_min = 1e-9;
    recipe.opacity_max = 1 - 1e-12;
    recipe.count = 100;
    return recipe;
}

/* Half of them opaque, half at or below every cut. */
static void make_opacities_extreme(td_store *store) {
    for (int i = 0; i < store->count; i++) {
        double *opacity = store->geometry + (size_t)i * TD_GEOMETRY_STRIDE + TD_G_OPACITY;
        if (*opacity == 0) continue; /* padding */
        if (i % 6 == 1) *opacity = 1;
        if (i % 6 == 2) *opacity = 1.0 / 255;
        if (i % 6 == 3) *opacity = 0.1 / 255;
        if (i % 6 == 4) *opacity = 0.0039;
        if (i % 6 == 5) *opacity = 1e-12;
    }
}

/* Pairs of Gaussians with one mean: equal depths, told apart by place only. */
static void make_ties(td_store *store) {
    for (int i = 0; i + 1 < store->count; i += 2) {
        double *mean = store->geometry + (size_t)i * TD_GEOMETRY_STRIDE;
        if (store->object[i] == store->object[i + 1]) memcpy(mean + TD_GEOMETRY_STRIDE, mean, 3 * sizeof *mean);
    }
}

typedef struct scene_kind {
    const char *name;
    random_recipe (*recipe)(void);
    void (*edit)(td_store *store);
} scene_kind;

static const scene_kind kinds[] = {{"ordinary", ordinary, NULL},
                                   {"ties", ordinary, make_ties},
                                   {"around the camera", around_the_camera, NULL},
                                   {"huge", huge, NULL},
                                   {"smaller than a pixel", smaller_than_a_pixel, NULL},
                                   {"extreme opacities", extreme_opacities, make_opacities_extreme}};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* -- settings ------------------------------------------------------------------------------------------------------ */

/* Each setting is a set of kernels to build, about a second each, so this is a cover and not a product: each rule with each of
 * antialias and moving; every degree, evaluated in full and cut; every width (test_widths.c has them on one scene). Planes of
 * all kinds for a few, of the last kind, colour, for all. */
typedef struct case_setting {
    const char *name;
    pair_setting image;
    int scene_degree, moving, lanes;
    int all_outputs;
    int lens;
} case_setting;

static const case_setting settings[] =
    {{"smooth, degree 3", {TIDES_RULES_SMOOTH, 0, 3, 0}, 3, 0, 16, 1, 0},
     {"smooth, antialias, degree 4, moving", {TIDES_RULES_SMOOTH, 1, 4, 0}, 4, 1, 8, 0, 0},
     {"inria, antialias, degree 0", {TIDES_RULES_INRIA, 1, 0, 0}, 0, 0, 4, 0, 0},
     {"inria, degree 2, moving", {TIDES_RULES_INRIA, 0, 2, 0}, 2, 1, 16, 0, 0},
     {"gsplat, antialias, degree 1 of 3, moving", {TIDES_RULES_GSPLAT, 1, 1, 0}, 3, 1, 1, 1, 0},
     {"gsplat, degree 4", {TIDES_RULES_GSPLAT, 0, 4, 0}, 4, 0, 16, 0, 0},
     {"smooth, radtan, moving", {TIDES_RULES_SMOOTH, 0, 1, 0}, 1, 1, 16, 0, TIDES_LENS_RADTAN},
     {"inria, equidistant", {TIDES_RULES_INRIA, 1, 0, 0}, 0, 0, 8, 0, TIDES_LENS_EQUIDISTANT},
     {"smooth, srgb", {TIDES_RULES_SMOOTH, 0, 3, TIDES_TRANSFER_SRGB}, 3, 1, 16, 1, 0},
     {"gsplat, gamma", {TIDES_RULES_GSPLAT, 0, 1, TIDES_TRANSFER_GAMMA}, 1, 0, 1, 0, 0}};

static backend_pair make_case(const scene_kind *kind, const case_setting *setting, tides_device *device) {
    random_recipe recipe = kind->recipe();
    recipe.sh_degree = setting->scene_degree;
    recipe.moving = setting->moving;
    recipe.lens = setting->lens;
    return pair_make(kind->name, device, &recipe, &setting->image, kind->edit);
}

/* The planes show something: finite signals, some of them moving. */
static void check_planes(const double *planes, int outputs, int jobs) {
    int moving = 0;
    for (size_t job = 0; job < (size_t)jobs; job++)
        for (size_t i = 0; i < TD_TILE_PIXELS; i++) {
            const double *pixel = planes + job * (size_t)outputs * TD_TILE_PIXELS + i;
            assert_true(isfinite(pixel[0]));
            if (outputs == TD_OUT_LUMINANCE) continue;
            assert_true(isfinite(pixel[TD_TILE_PIXELS]));
            moving += pixel[TD_TILE_PIXELS] != 0;
        }
    assert_true(moving > 0 || outputs == TD_OUT_LUMINANCE);
}

/* Every stage of one scene under one setting. Returns 1 where tiles shared what was projected. */
static int compare_all(const scene_kind *kind, const case_setting *setting, tides_device *device) {
    static const int outputs[] = {TD_OUT_LUMINANCE, TD_OUT_SIGNAL, TD_OUT_SIGNAL_Y, TD_OUT_DIAGNOSTICS, TD_OUT_COLOUR};
    backend_pair pair = make_case(kind, setting, device);
    int splats = 0, candidates = 0;
    assert_true(pair.job_count > 0);
    /* Projected once for all tiles, and for each tile. */
    const tides_render_stats *done = &pair.backend[PAIR_DEVICE]->stats;
    uint64_t shared = 0;
    for (pair.alone = 0; pair.alone < 2; pair.alone++) {
        shared = done->gaussians_shared;
        for (int i = setting->all_outputs ? 0 : 4; i < 5; i++) {
            double *planes = pair_compare_planes(&pair, outputs[i]);
            check_planes(planes, outputs[i], pair.job_count);
            free(planes);
        }
    }
    assert_int_equal(done->gaussians_shared, shared);
    for (int i = 0; i < pair.job_count; i += 4) {
        splats += pair_compare_stages(&pair, &pair.jobs[i]);
        candidates += pair.jobs[i].count;
    }
    assert_true(splats > 0);
    assert_true(splats < candidates); /* masks of both kinds have been seen */
    pair_compare_empty_pixel(&pair);
    pair_free(&pair);
    return shared > 0;
}

static void compare_setting(const case_setting *setting) {
    tides_device *device = pair_device(setting->lanes);
    const int own_builtins = device->own_builtins;
    print_message("%s, %d lanes\n", setting->name, setting->lanes);
    int shared = 0;
    for (int i = 0; i < KINDS; i++) shared += compare_all(&kinds[i], setting, device);
    assert_true(shared > 0);
    assert_int_equal(device->own_builtins, own_builtins); /* all are declared that these kernels call */
    tides_device_close(device);
}

static void test_kernels_equal_the_reference(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) compare_setting(&settings[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kernels_equal_the_reference)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
