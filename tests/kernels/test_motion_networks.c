/* The kernel of each deformation network gives the single-precision reference's rows to the bit, at every vector width, for any
 * selection of Gaussians. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_hexplane.h"
#include "tests/support/motion_device.h"
#include "tests/support/random_network.h"

#include <string.h>

enum { COUNT = 75, SELECTED = 41, SH_STRIDE = 48 };
static const double times[] = {0, 0.37, 0.5, 1};

/* Opens the OpenCL CPU device; skips the test where there's none. */
static tides_device *open_device(void) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    if (status != TIDES_OK) fail_msg("%s", error.text);
    return device;
}

static void expect_same(const char *name, int lanes, const double *device, const double *reference, int rows, int stride) {
    if (!reference) return;
    for (int i = 0; i < rows * stride; i++)
        if (memcmp(&device[i], &reference[i], sizeof *device) != 0)
            fail_msg("%s, %d lanes: row %d, entry %d: %.9g on the device, %.9g in the reference", name, lanes, i / stride,
                     i % stride, device[i], reference[i]);
}

static void compare_rows(const char *name, int lanes, const motion_rows *device, const motion_rows *reference) {
    expect_same(name, lanes, device->geometry, reference->geometry, reference->count, TD_GEOMETRY_STRIDE);
    expect_same(name, lanes, device->rates, reference->rates, reference->count, TD_GEOMETRY_STRIDE);
    expect_same(name, lanes, device->sh, reference->sh, reference->count, SH_STRIDE);
    expect_same(name, lanes, device->sh_rates, reference->sh_rates, reference->count, SH_STRIDE);
}

/* Frees the motion. */
static void compare(const char *name, tides_motion *motion) {
    static const int widths[] = {1, 4, 8, 16};
    tides_device *device = open_device();
    random_gaussians gaussians = random_gaussians_make(31, COUNT, 3, 1.8);
    packed_motion packed = packed_motion_make(motion, &gaussians.view);
    int selected[SELECTED];
    for (int i = 0; i < SELECTED; i++) selected[i] = i * 29 % COUNT;
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
        device->info.lanes = widths[w];
        motion_device on = motion_device_make(device, &packed, 48, SH_STRIDE);
        motion_device_set(&on, selected, SELECTED, 32);
        for (size_t t = 0; t < sizeof times / sizeof *times; t++) {
            motion_rows reference = motion_rows_f32(&packed, times[t], -1, selected, SELECTED, SH_STRIDE);
            motion_device_run(&on, times[t], -1);
            motion_rows rows = motion_device_read(&on, SELECTED);
            compare_rows(name, widths[w], &rows, &reference);
            motion_rows_free(&rows);
            motion_rows_free(&reference);
        }
        motion_device_free(&on);
    }
    packed_motion_free(&packed);
    random_gaussians_free(&gaussians);
    tides_motion_destroy(motion);
    tides_device_close(device);
}

static void test_hexplane(void **state) {
    random_hexplane_recipe recipe = random_hexplane_defaults(11);
    (void)state;
    recipe.size[3] = 20;
    compare("hexplane as for D-NeRF", random_hexplane_make(&recipe));
}

static void test_hexplane_all(void **state) {
    const random_hexplane_recipe recipe = {12, 5, {6, 7, 9, 11}, 3, 22, 3, 31, 1, 0.2};
    (void)state;
    compare("hexplane with all heads", random_hexplane_make(&recipe));
}

static void test_network(void **state) {
    random_network_recipe recipe = random_network_defaults(13);
    (void)state;
    recipe.width = 50;
    compare("network", random_network_make(&recipe));
}

static void test_network_screw(void **state) {
    const random_network_recipe recipe = {14, 32, 4, 2, 6, 40, 30, 1, 0.5};
    (void)state;
    compare("network, rigid, with a network over the time", random_network_make(&recipe));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hexplane), cmocka_unit_test(test_hexplane_all),
                                       cmocka_unit_test(test_network), cmocka_unit_test(test_network_screw)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
