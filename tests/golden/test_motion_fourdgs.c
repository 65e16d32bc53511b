/* 4DGaussians against its own code, differentiated in double precision: every model of $TIDES_SHARED/golden/fourdgs. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/td_method_networks.h"
#include "tests/support/golden_rows.h"
#include "tests/support/shared.h"

#include <stdlib.h>
#include <string.h>

enum { SH_STRIDE = 48 };
static const golden_names names = {"means", "scales", "quats", "opacity", "sh"};

/* At t = 1 the files hold 0, because PyTorch clips the row of the time planes there; ours is the left derivative
 * (tests/derivatives/test_motion_networks.c). */
static int has_rates(double t) { return t < 1; }

static void compare_times(const char *name, const packed_motion *packed, npz *file) {
    golden_errors wide = {0, 0}, narrow = {0, 0};
    size_t times = 0;
    double *t = npz_doubles(file, "t", &times);
    assert_non_null(t);
    for (size_t i = 0; i < times; i++) {
        motion_rows f64 = motion_rows_f64(packed, t[i], 1, NULL, packed->count, SH_STRIDE);
        motion_rows f32 = motion_rows_f32(packed, t[i], 1, NULL, packed->count, SH_STRIDE);
        golden_rows_compare(file, &names, i, &f64, has_rates(t[i]), &wide);
        golden_rows_compare(file, &names, i, &f32, has_rates(t[i]), &narrow);
        motion_rows_free(&f64);
        motion_rows_free(&f32);
    }
    print_message("%s: %d Gaussians, %d times: values to %.1e, rates to %.1e; in single precision %.1e, %.1e\n", name,
                  packed->count, (int)times, wide.value, wide.rate, narrow.value, narrow.rate);
    assert_true(wide.value < 1e-12 && wide.rate < 1e-12);
    assert_true(narrow.value < 1e-5 && narrow.rate < 1e-5);
    free(t);
}

static int visit(void *user, const char *path, const char *name) {
    char golden[512];
    td_gaussians gaussians = {0};
    td_model_dir dir;
    tides_motion *motion = NULL;
    tides_error error = {0};
    (void)user;
    snprintf(golden, sizeof golden, "%s/golden_theta.npz", path);
    npz *file = npz_open(golden);
    assert_non_null(file);
    if (td_model_dir_find(path, &dir, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (td_fourdgs_open(&dir, &gaussians, &motion, &error) != TIDES_OK) fail_msg("%s", error.text);
    tides_gaussians view = td_gaussians_view(&gaussians);
    packed_motion packed = packed_motion_make(motion, &view);
    compare_times(name, &packed, file);
    packed_motion_free(&packed);
    tides_motion_destroy(motion);
    td_gaussians_free(&gaussians);
    td_model_dir_free(&dir);
    npz_close(file);
    return 0;
}

static void test_models(void **state) {
    char folder[512];
    (void)state;
    if (shared_path(folder, sizeof folder, "golden/fourdgs") != 0) {
        print_message("skipped: no golden/fourdgs below $TIDES_SHARED\n");
        skip();
    }
    assert_true(shared_scan(folder, "", visit, NULL) > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_models)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
