/* Tests the layout of structs that host and device share, in single precision. kernels/layout_check.cl reports the sizes of
 * td_view, td_backdrop, td_job and td_image and four offsets on the device. The first test compares them with sizeof and
 * offsetof. The second checks the numbers of reals and ints in td_backend.h. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_backend.h" /* without TD_REAL_DOUBLE: the kernels' precision */
#include "td_launch.h"

enum { NUMBERS = 8 };

static const int expected[NUMBERS] = {(int)sizeof(td_view),
                                      (int)sizeof(td_backdrop),
                                      (int)sizeof(td_job),
                                      (int)sizeof(td_image),
                                      (int)offsetof(td_view, eye_dot),
                                      (int)offsetof(td_image, width),
                                      (int)offsetof(td_image, outputs),
                                      (int)offsetof(td_job, blocks)};

static const char *const names[NUMBERS] = {"sizeof(td_view)", "sizeof(td_backdrop)", "sizeof(td_job)",   "sizeof(td_image)",
                                           "td_view.eye_dot", "td_image.width",      "td_image.outputs", "td_job.blocks"};

/* Runs td_layout_check on the device, and reads its numbers. A number that the kernel doesn't write is -1. */
static tides_status ask(tides_device *device, int *numbers, tides_error *error) {
    td_buffer out = {0};
    cl_kernel kernel = NULL;
    const size_t one = 1;
    for (int i = 0; i < NUMBERS; i++) numbers[i] = -1;
    tides_status status = td_kernel_create(device, "layout_check.cl", "", "td_layout_check", &kernel, error);
    if (status == TIDES_OK) status = td_buffer_write(device, &out, numbers, NUMBERS * sizeof *numbers, error);
    if (status == TIDES_OK) {
        const td_argument arguments[] = {TD_BUFFER_ARGUMENT(out)};
        status = td_launch(device, kernel, 1, &one, NULL, TD_ARGUMENTS(arguments), NULL, error);
    }
    if (status == TIDES_OK) status = td_buffer_read(device, &out, numbers, NUMBERS * sizeof *numbers, error);
    if (kernel) clReleaseKernel(kernel);
    td_buffer_release(&out);
    return status;
}

static void test_device_sees_the_hosts_layout(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_device *device = NULL;
    int numbers[NUMBERS];
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    if (status == TIDES_OK) status = ask(device, numbers, &error);
    tides_device_close(device);
    if (status != TIDES_OK) fail_msg("%s", error.text);
    for (int i = 0; i < NUMBERS; i++)
        if (numbers[i] != expected[i]) fail_msg("%s: %d on the device, %d on the host", names[i], numbers[i], expected[i]);
}

/* Backends copy these structs as arrays of numbers. So the compiler must insert no padding, and td_backend.h must have their
 * numbers of reals and ints, members called `padding` included. The enums of records and planes must end at their counts. */
static void test_structs_are_arrays_of_numbers(void **state) {
    (void)state;
    assert_int_equal(sizeof(td_view), TD_VIEW_REALS * sizeof(td_real));
    assert_int_equal(sizeof(td_backdrop), TD_BACKDROP_REALS * sizeof(td_real));
    assert_int_equal(sizeof(td_image), TD_IMAGE_REALS * sizeof(td_real) + TD_IMAGE_INTS * sizeof(int));
    assert_int_equal(offsetof(td_image, width), TD_IMAGE_REALS * sizeof(td_real));
    assert_int_equal(sizeof(td_job), TD_JOB_INTS * sizeof(int));
    assert_int_equal(TD_R_DEPTH_DOT + 1, TD_RECORD_STRIDE);
    assert_int_equal(TD_OUT_Z_DOT + 1, TD_OUT_COLOUR);
    assert_int_equal(TD_OUT_CONTRIBUTORS + 1, TD_OUT_DIAGNOSTICS);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_device_sees_the_hosts_layout),
                                       cmocka_unit_test(test_structs_are_arrays_of_numbers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
