/* Compares motion models of trained folders with golden_theta.npz. */
#include "tests/support/golden_model.h"
#include "tests/support/golden_folder.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>

enum { SH_STRIDE = 48 };

static void compare_times(const char *name, const golden_model *model, const packed_motion *packed, npz *file) {
    golden_errors wide = {0, 0}, narrow = {0, 0};
    size_t times = 0;
    double *t = npz_doubles(file, "t", &times);
    assert_non_null(t);
    for (size_t i = 0; i < times; i++) {
        const int rates = t[i] < model->rates_before;
        motion_rows f64 = motion_rows_f64(packed, t[i], 1, NULL, packed->count, SH_STRIDE);
        motion_rows f32 = motion_rows_f32(packed, t[i], 1, NULL, packed->count, SH_STRIDE);
        golden_rows_compare(file, &model->names, i, &f64, rates, &wide);
        golden_rows_compare(file, &model->names, i, &f32, rates, &narrow);
        motion_rows_free(&f64);
        motion_rows_free(&f32);
    }
    print_message("%s: %d Gaussians, %d times: values to %.1e, rates to %.1e; in single precision %.1e, %.1e\n", name,
                  packed->count, (int)times, wide.value, wide.rate, narrow.value, narrow.rate);
    assert_true(wide.value < 1e-12);
    assert_true(wide.rate < 1e-12);
    assert_true(narrow.value < 1e-5);
    assert_true(narrow.rate < 1e-5);
    free(t);
}

static int visit(void *user, const char *path, const char *name) {
    const golden_model *model = user;
    char golden[512];
    td_gaussians gaussians = {0};
    td_model_dir dir;
    tides_motion *motion = NULL;
    tides_error error = {0};
    snprintf(golden, sizeof golden, "%s/golden_theta.npz", path);
    npz *file = npz_open(golden);
    assert_non_null(file);
    if (td_model_dir_find(path, NULL, &dir, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (model->open(&dir, &gaussians, &motion, &error) != TIDES_OK) fail_msg("%s", error.text);
    tides_gaussians view = td_gaussians_view(&gaussians);
    packed_motion packed = packed_motion_make(motion, &view);
    compare_times(name, model, &packed, file);
    packed_motion_free(&packed);
    tides_motion_destroy(motion);
    td_gaussians_free(&gaussians);
    td_model_dir_free(&dir);
    npz_close(file);
    return 0;
}

void golden_model_check(const char *relative, const golden_model *model) {
    golden_model copy = *model; /* the visitor's argument isn't const */
    golden_folder(relative, "", visit, &copy);
}
