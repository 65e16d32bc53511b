/* 4DGaussians against its own code, differentiated in double precision: every model of $TIDES_SHARED/golden/fourdgs. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/golden_model.h"

/* At t = 1 the files hold rates of 0, because PyTorch clips the row of the time planes there; ours is the left derivative
 * (tests/derivatives/test_motion_networks.c). */
static void test_models(void **state) {
    const golden_model model = {td_fourdgs_open, {"means", "scales", "quats", "opacity", "sh"}, 1};
    (void)state;
    golden_model_check("golden/fourdgs", &model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_models)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
