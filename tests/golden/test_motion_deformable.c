/* Deformable-3D-Gaussians against its own code, differentiated in double precision: every model of
 * $TIDES_SHARED/golden/deformable. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/golden_model.h"

#include <math.h>

static void test_models(void **state) {
    const golden_model model = {td_deformable_open, {"means", "scales", "quats_to_rasteriser", "opacity", NULL}, INFINITY};
    (void)state;
    golden_model_check("golden/deformable", &model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_models)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
