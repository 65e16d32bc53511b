/* The kernel td_move_gaussians equals the single-precision reference bit for bit: every model that is not the host's, every
 * vector width, random motions, times at the ends and between. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_launch.h"
#include "tests/support/move.h"
#include "tests/support/random_motion.h"

#include <stdlib.h>

enum { N = RANDOM_MOTION_GAUSSIANS, COUNT = 64, TIMES = 3, SH = 48, G = COUNT * TD_GEOMETRY_STRIDE, S = COUNT * SH };
static const uint64_t SEED = 52;

typedef struct kernel_run {
    float geometry[G], rates[G], sh[S], sh_rates[S];
} kernel_run;

static void expect_ok(tides_status status, const tides_error *error) {
    if (status != TIDES_OK) fail_msg("%s", error->text);
}

static void send(tides_device *device, td_buffer *buffer, const double *values, size_t count) {
    tides_error error = {0, ""};
    float *narrow = malloc((count + 1) * sizeof *narrow);
    assert_non_null(narrow);
    for (size_t i = 0; i < count; i++) narrow[i] = (float)values[i];
    expect_ok(td_buffer_write(device, buffer, narrow, (count + 1) * sizeof *narrow, &error), &error);
    free(narrow);
}

/* One job of COUNT rows in two work-groups' worth of items. */
static void run_kernel(tides_device *device, const move_job *job, kernel_run *out) {
    enum { MOVERS, DATA, MOMENTS, JOBS, GAUSSIANS, OUT };
    tides_error error = {0, ""};
    td_buffer buffer[OUT + 4] = {{0}};
    char defines[64];
    int stride = SH, first = 0;
    cl_kernel kernel = NULL;
    const size_t global = 4, local = 4;
    td_move_job whole = {0, 0, 0, COUNT, 0, {0}};
    float *results[4] = {out->geometry, out->rates, out->sh, out->sh_rates};
    void *mover = calloc(1, move_mover_bytes());
    assert_non_null(mover);
    move_mover_f32(job, mover);
    snprintf(defines, sizeof defines, "#define TD_BUILD_MODEL %d\n", job->model);
    expect_ok(td_kernel_create(device, "motion.cl", defines, "td_move_gaussians", &kernel, &error), &error);
    expect_ok(td_buffer_write(device, &buffer[MOVERS], mover, move_mover_bytes(), &error), &error);
    send(device, &buffer[DATA], job->data, job->data_count);
    send(device, &buffer[MOMENTS], job->moment, TD_MOMENT_REALS);
    expect_ok(td_buffer_write(device, &buffer[JOBS], &whole, sizeof whole, &error), &error);
    expect_ok(td_buffer_write(device, &buffer[GAUSSIANS], job->gaussian, COUNT * sizeof(int), &error), &error);
    memset(out, 0, sizeof *out);
    for (int i = 0; i < 4; i++)
        expect_ok(td_buffer_write(device, &buffer[OUT + i], results[i], (i < 2 ? G : S) * sizeof(float), &error), &error);
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(buffer[MOVERS]),
                                     TD_BUFFER_ARGUMENT(buffer[DATA]),
                                     TD_BUFFER_ARGUMENT(buffer[MOMENTS]),
                                     TD_BUFFER_ARGUMENT(buffer[JOBS]),
                                     TD_BUFFER_ARGUMENT(buffer[GAUSSIANS]),
                                     TD_VALUE_ARGUMENT(first),
                                     TD_VALUE_ARGUMENT(stride),
                                     TD_VALUE_ARGUMENT(first),
                                     TD_BUFFER_ARGUMENT(buffer[OUT]),
                                     TD_BUFFER_ARGUMENT(buffer[OUT + 1]),
                                     TD_BUFFER_ARGUMENT(buffer[OUT + 2]),
                                     TD_BUFFER_ARGUMENT(buffer[OUT + 3])};
    expect_ok(td_launch(device, kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, &error), &error);
    for (int i = 0; i < 4; i++)
        expect_ok(td_buffer_read(device, &buffer[OUT + i], results[i], (i < 2 ? G : S) * sizeof(float), &error), &error);
    for (int i = 0; i < OUT + 4; i++) td_buffer_release(&buffer[i]);
    clReleaseKernel(kernel);
    free(mover);
}

static void compare(const char *name, const char *array, const double *reference, const float *device, int count, int stride) {
    for (int i = 0; i < count; i++) {
        float expected = (float)reference[i];
        if (memcmp(&expected, &device[i], sizeof expected) != 0)
            fail_msg("%s, %s of row %d, entry %d: %.9g on the device, %.9g on the host", name, array, i / stride, i % stride,
                     (double)device[i], (double)expected);
    }
}

static void compare_job(const random_motion *made, const move_job *job, tides_device *device) {
    static kernel_run run;
    static double geometry[G], rates[G], sh[S], sh_rates[S];
    move_rows rows = {SH, geometry, rates, sh, sh_rates};
    memset(sh, 0, sizeof sh);
    memset(sh_rates, 0, sizeof sh_rates);
    move_f32(job, &rows);
    run_kernel(device, job, &run);
    compare(made->name, "geometry", geometry, run.geometry, G, TD_GEOMETRY_STRIDE);
    compare(made->name, "rates", rates, run.rates, G, TD_GEOMETRY_STRIDE);
    compare(made->name, "sh", sh, run.sh, S, SH);
    compare(made->name, "sh rates", sh_rates, run.sh_rates, S, SH);
}

static void compare_motion(const random_motion *made, tides_device *device) {
    td_mover_numbers numbers = {0};
    double moment[TD_MOMENT_REALS];
    int gaussian[COUNT]; /* some of the object's, not in its order; the last repeated */
    for (int i = 0; i < COUNT; i++) gaussian[i] = i < N ? (i * 7 + 3) % N : (N - 1) * 7 % N;
    assert_int_equal(made->motion->type->pack(made->motion, &made->gaussians, &numbers, NULL), TIDES_OK);
    for (int i = 0; i < 2 * TIMES; i++) {
        const int time = i / 2;
        double tau = made->motion->start + (made->motion->stop - made->motion->start) * time / (TIMES - 1.0) * 0.9999;
        td_motion_moment(made->motion, tau, 0.3, 1, moment);
        const move_job job = {made->motion->type->code,
                              i % 2,
                              numbers.moves_sh,
                              numbers.real,
                              numbers.own,
                              numbers.data,
                              numbers.data_count,
                              moment,
                              gaussian,
                              N,
                              COUNT};
        compare_job(made, &job, device);
    }
    td_mover_release(&numbers);
}

static void test_kernel_equals_reference(void **state) {
    static const int widths[] = {1, 4, 8, 16};
    tides_error error = {0, ""};
    tides_device *device = NULL;
    (void)state;
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    expect_ok(status, &error);
    for (int w = 0; w < 4; w++)
        for (int kind = 0; kind < random_motion_kinds(); kind++) {
            random_motion made = random_motion_make(kind, SEED);
            device->info.lanes = widths[w];
            compare_motion(&made, device);
            random_motion_free(&made);
        }
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kernel_equals_reference)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
