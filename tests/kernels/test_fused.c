/* The references compiled for processors with fused multiply-add have the bits of those compiled for any: sweeps, records,
 * order, planes with rates and colour, under each image's rules, in both precisions. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_fused.h"
#include "tests/kernels/backend_pair.h"

#ifdef TD_FUSED

static const uint64_t SEED = 2311;

typedef tides_status (*create)(const td_store *store, const td_image_numbers *image, td_backend **backend, tides_error *error);

/* With a camera at rest rates are 0, of either sign. */
static void compare(const char *name, int32_t rules, double speed, create plain, create fused) {
    random_recipe recipe = random_recipe_defaults(SEED + (uint64_t)rules);
    recipe.count = 3000;
    recipe.camera_speed = speed;
    const pair_setting setting = {rules, 0, recipe.sh_degree, 0};
    backend_pair pair = pair_begin(name, &recipe, &setting, NULL);
    tides_error error;
    scene_expect_ok(plain(&pair.store, &pair.image, &pair.backend[PAIR_REFERENCE], &error), &error);
    scene_expect_ok(fused(&pair.store, &pair.image, &pair.backend[PAIR_DEVICE], &error), &error);
    pair_sweep(&pair); /* compares boxes */
    pair_make_jobs(&pair);
    assert_true(pair_compare_stages(&pair, &pair.jobs[0]) > 0);
    free(pair_compare_planes(&pair, TD_OUT_COLOUR));
    pair_free(&pair);
}

static void test_references(void **state) {
    (void)state;
    static const int32_t rules[] = {TIDES_RULES_SMOOTH, TIDES_RULES_INRIA, TIDES_RULES_GSPLAT};
    if (!td_has_fused()) skip();
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        for (int moves = 0; moves < 2; moves++) {
            compare("single", rules[i], moves, td_backend_create_f32_plain, td_backend_create_f32_fused);
            compare("double", rules[i], moves, td_backend_create_f64_plain, td_backend_create_f64_fused);
        }
}

#else

static void test_references(void **state) {
    (void)state;
    skip();
}

#endif

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_references)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
