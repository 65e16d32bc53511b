/* The functions of kernels/numerics.h: the device equals the host bit for bit on a million numbers in every vector width, and
 * both are within 2 ulp of the truth (libm in double). */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "kernels/extent.h" /* without TD_REAL_DOUBLE: the kernels' precision */
#include "kernels/soft_order.h"
#include "td_launch.h"
#include "tests/support/scene_make.h"

#include <stdlib.h>

enum { COUNT = 1 << 20, FUNCTIONS = 4 };
static const uint64_t SEED = 20240607;

static const char *const names[FUNCTIONS] = {"td_exp2", "td_log", "td_floor", "td_smootherstep"};

/* One thread per TD_LANES numbers; inputs and outputs function by function. */
static const char kernel_text[] = "__kernel void td_numerics(__global const float *in, __global float *out, int count) {\n"
                                  "    int i = (int)get_global_id(0) * TD_LANES;\n"
                                  "    float lane[TD_LANES];\n"
                                  "    td_index at;\n"
                                  "    for (int k = 0; k < TD_LANES; k++) ((__private int *)&at)[k] = i + k;\n"
                                  "    td_scatter(out + i, 1, 0, td_exp2(td_gather(in, at)));\n"
                                  "    td_scatter(out + i + count, 1, 0, td_log(td_gather(in + count, at)));\n"
                                  "    td_scatter(out + i + 2 * count, 1, 0, td_floor(td_gather(in + 2 * count, at)));\n"
                                  "    td_scatter(out + i + 3 * count, 1, 0, td_smootherstep(td_gather(in + 3 * count, at)));\n"
                                  "}\n";

typedef struct numbers {
    float *in, *host, *device; /* (FUNCTIONS x COUNT) */
} numbers;

static float between(uint64_t *state, double from, double to) { return (float)scene_between(state, from, to); }

/* Positive normal floats of every exponent. */
static float any_positive(uint64_t *state) {
    const uint32_t least = 0x00800000u, infinity = 0x7f800000u;
    return td_from_bits((int32_t)(least + scene_next(state) % (infinity - least)));
}

/* Inputs where each function is defined; the first few are where it is most likely to go wrong. */
static void make_inputs(float *in) {
    static const float hard[FUNCTIONS][8] = {{0.0f, 127.0f, -126.0f, -126.5f, -1e30f, 0.5f, -0.5f, 1.0f},
                                             {1.0f, 0.99999994f, 1.0000001f, 0x1p-126f, 3.4028235e38f, 0.70710678f, 0.70710677f,
                                              1e-3f},
                                             {0.0f, -0.0f, 0.99999994f, -0.00000001f, -1.0f, 4194303.5f, -4194303.5f, 2.5f},
                                             {0.0f, 1.0f, 0.5f, 1e-20f, 0.99999994f, 1e-38f, 0.25f, 0.75f}};
    uint64_t state = SEED;
    for (size_t i = 0; i < COUNT; i++) {
        in[i] = between(&state, i % 4 == 0 ? -160 : -20, i % 4 == 0 ? 127 : 1);
        in[COUNT + i] = i % 4 == 0 ? any_positive(&state) : between(&state, 1e-4, 3);
        in[2 * COUNT + i] = between(&state, i % 4 == 0 ? -4194304.0 : -100, i % 4 == 0 ? 4194303.0 : 100);
        in[3 * COUNT + i] = between(&state, 0, 1);
    }
    for (size_t f = 0; f < FUNCTIONS; f++) memcpy(in + f * COUNT, hard[f], sizeof hard[f]);
}

static void on_host(const float *in, float *out) {
    for (size_t i = 0; i < COUNT; i++) {
        out[i] = td_exp2(in[i]);
        out[COUNT + i] = td_log(in[COUNT + i]);
        out[2 * COUNT + i] = td_floor(in[2 * COUNT + i]);
        out[3 * COUNT + i] = td_smootherstep(in[3 * COUNT + i]);
    }
}

static int set_up(void **state) {
    numbers *n = td_alloc(1, sizeof *n, NULL);
    if (!n) return -1;
    n->in = td_alloc((size_t)FUNCTIONS * COUNT, sizeof(float), NULL);
    n->host = td_alloc((size_t)FUNCTIONS * COUNT, sizeof(float), NULL);
    n->device = td_alloc((size_t)FUNCTIONS * COUNT, sizeof(float), NULL);
    *state = n;
    if (!n->in || !n->host || !n->device) return -1;
    make_inputs(n->in);
    on_host(n->in, n->host);
    return 0;
}

static int tear_down(void **state) {
    numbers *n = *state;
    free(n->in);
    free(n->host);
    free(n->device);
    free(n);
    return 0;
}

/* -- device -------------------------------------------------------------------------------------------------------- */

/* numerics.h and its users, then the kernel, as program.c would put them together. */
static tides_status build(tides_device *device, int lanes, cl_program *program, tides_error *error) {
    char prelude[128];
    td_source_text text = {0};
    tides_status status = td_source_gather(&text, "extent.h", error);
    if (status != TIDES_OK) return status;
    snprintf(prelude, sizeof prelude, "#pragma OPENCL FP_CONTRACT OFF\n#define TD_OPENCL 1\n#define TD_LANES %d\n", lanes);
    const char **pieces = td_alloc(text.count + 2, sizeof *pieces, error);
    cl_int code = CL_OUT_OF_HOST_MEMORY;
    if (pieces) {
        pieces[0] = prelude;
        for (size_t i = 0; i < text.count; i++) pieces[i + 1] = text.piece[i];
        pieces[text.count + 1] = kernel_text;
        *program = clCreateProgramWithSource(device->context, (cl_uint)text.count + 2, pieces, NULL, &code);
    }
    if (code == CL_SUCCESS)
        code = clBuildProgram(*program, 1, &device->id, "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt", NULL, NULL);
    free(pieces);
    td_source_release(&text);
    return code == CL_SUCCESS ? TIDES_OK : td_cl_fail(error, code, "building the test's kernel");
}

static tides_status run(tides_device *device, cl_program program, int lanes, const numbers *n, tides_error *error) {
    const size_t bytes = (size_t)FUNCTIONS * COUNT * sizeof(float), items = (size_t)COUNT / (size_t)lanes;
    const size_t group = 16; /* PoCL's own choice overruns the stack on arm64, as in test_exact.c */
    td_buffer in = {0}, out = {0};
    cl_int code, count = COUNT;
    cl_kernel kernel = clCreateKernel(program, "td_numerics", &code);
    if (code != CL_SUCCESS) return td_cl_fail(error, code, "clCreateKernel");
    tides_status status = td_buffer_write(device, &in, n->in, bytes, error);
    if (status == TIDES_OK) status = td_buffer_reserve(device, &out, bytes, error);
    if (status == TIDES_OK) {
        const td_argument arguments[] = {TD_BUFFER_ARGUMENT(in), TD_BUFFER_ARGUMENT(out), TD_VALUE_ARGUMENT(count)};
        status = td_launch(device, kernel, 1, &items, &group, TD_ARGUMENTS(arguments), NULL, error);
    }
    if (status == TIDES_OK) status = td_buffer_read(device, &out, n->device, bytes, error);
    clReleaseKernel(kernel);
    td_buffer_release(&in);
    td_buffer_release(&out);
    return status;
}

static void compare_bits(const numbers *n, int lanes) {
    for (size_t i = 0; i < (size_t)FUNCTIONS * COUNT; i++)
        if (memcmp(&n->host[i], &n->device[i], sizeof(float)) != 0)
            fail_msg("%s(%.9g), %d lanes: %.9g on the device, %.9g on the host", names[i / COUNT], n->in[i], lanes,
                     n->device[i], n->host[i]);
}

static void test_device_equals_host(void **state) {
    static const int widths[] = {1, 4, 8, 16};
    const numbers *n = *state;
    tides_error error = {0, ""};
    tides_device *device = NULL;
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    for (size_t w = 0; w < sizeof widths / sizeof *widths && status == TIDES_OK; w++) {
        cl_program program = NULL;
        memset(n->device, 0xff, (size_t)FUNCTIONS * COUNT * sizeof(float));
        status = build(device, widths[w], &program, &error);
        if (status == TIDES_OK) status = run(device, program, widths[w], n, &error);
        if (program) clReleaseProgram(program);
        if (status == TIDES_OK) compare_bits(n, widths[w]);
    }
    tides_device_close(device);
    if (status != TIDES_OK) fail_msg("%s", error.text);
}

/* -- accuracy ------------------------------------------------------------------------------------------------------ */

/* Distance of a float from the true value, in units of the truth's last place. */
static double ulps(float value, double truth) {
    int exponent;
    frexp(truth, &exponent);
    if (exponent < -125) exponent = -125; /* subnormals have the same spacing as the smallest normal numbers */
    return fabs((double)value - truth) / ldexp(1.0, exponent - 24);
}

static void test_exp2_is_within_2_ulp(void **state) {
    const numbers *n = *state;
    double worst = 0, at = 0;
    for (size_t i = 0; i < COUNT; i++) {
        double x = n->in[i] < -126.0f ? -126.0 : (double)n->in[i], error = ulps(n->host[i], exp2(x));
        if (error > worst) worst = error, at = x;
    }
    print_message("td_exp2: at most %.3f ulp, at %.9g\n", worst, at);
    assert_true(worst < 2.0);
}

static void test_log_is_within_2_ulp(void **state) {
    const numbers *n = *state;
    double worst = 0, at = 0;
    for (size_t i = COUNT; i < 2 * (size_t)COUNT; i++) {
        if (n->in[i] == 1.0f) continue; /* exact, checked below: a zero has no last place */
        double error = ulps(n->host[i], log((double)n->in[i]));
        if (error > worst) worst = error, at = (double)n->in[i];
    }
    print_message("td_log: at most %.3f ulp, at %.9g\n", worst, at);
    assert_true(worst < 2.0);
    assert_true(td_log(1.0f) == 0.0f);
}

static void test_floor_is_exact(void **state) {
    const numbers *n = *state;
    for (size_t i = 2 * (size_t)COUNT; i < 3 * (size_t)COUNT; i++)
        if (n->host[i] != floorf(n->in[i])) fail_msg("td_floor(%.9g) = %.9g", n->in[i], n->host[i]);
}

/* 0 at 0, 1 at 1, 1/2 in the middle; never decreasing; its slope is the derivative. */
static void test_smootherstep_is_a_step(void **state) {
    (void)state;
    assert_true(td_smootherstep(0.0f) == 0.0f);
    assert_true(td_smootherstep(0.5f) == 0.5f);
    assert_true(td_smootherstep(1.0f) == 1.0f);
    for (int i = 1; i < 1000; i++) {
        float x = (float)i / 1000.0f, h = 1e-2f;
        if (x < h || x > 1 - h) continue;
        double difference = ((double)td_smootherstep(x + h) - td_smootherstep(x - h)) / ((double)(x + h) - (x - h));
        assert_true(fabs(difference - td_smootherstep_slope(x)) < 2e-3); /* h^2 / 6 times the third derivative, 60 */
        assert_true(td_smootherstep(x) >= td_smootherstep(x - 1e-3f));
    }
}

/* Optical depth and what is taken of it have their own digits for small arguments too (soft_order.h). */
static void test_soft_order_keeps_small_numbers(void **state) {
    (void)state;
    uint64_t seed = SEED + 1;
    for (int i = 0; i < COUNT; i++) {
        float tau = between(&seed, 0, 0.99) * (i % 4 == 0 ? between(&seed, 0, 1) : 1.0f);
        float a, a_dot, x = between(&seed, 0, TD_SOFT_REACH) * (i % 4 == 1 ? between(&seed, 0, 1) : 1.0f);
        if (i % 4 == 2) tau = td_exp2(-tau * 80), x = td_exp2(-x * 4);
        td_optical_depth(tau, 1, &a, &a_dot);
        double want = -log1p(-(double)tau), taken = -expm1(-(double)x);
        if (!(fabs(a - want) <= 5e-7 * want)) fail_msg("-ln(1 - %.9g) is %.9g, not %.9g", (double)tau, (double)a, want);
        if (!(fabs(a_dot - 1 / (1 - (double)tau)) <= 5e-7 * a_dot)) fail_msg("1 / (1 - %.9g)", (double)tau);
        if (!(fabs(td_soft_taken(x) - taken) <= 5e-7 * taken))
            fail_msg("1 - exp(-%.9g) is %.9g, not %.9g", (double)x, (double)td_soft_taken(x), taken);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_device_equals_host),
                                       cmocka_unit_test(test_exp2_is_within_2_ulp),
                                       cmocka_unit_test(test_log_is_within_2_ulp),
                                       cmocka_unit_test(test_floor_is_exact),
                                       cmocka_unit_test(test_smootherstep_is_a_step),
                                       cmocka_unit_test(test_soft_order_keeps_small_numbers)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
