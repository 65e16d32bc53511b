/* Double precision on devices (kernels/exact.h): every function and the arithmetic itself, subnormal numbers too, have the bits
 * of their twin in C in every vector width, and are within an ulp or two of libm in long double. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define TD_REAL_DOUBLE
#include "kernels/extent.h"
#include "kernels/layout.h"
#include "kernels/soft_order.h"
#include "td_launch.h"
#include "tests/support/scene_make.h"

#include <stdlib.h>

enum { COUNT = 1 << 20, FUNCTIONS = 10, EXP2 = 0, LOG, LOG_TOO, INVERSE, TAKEN, POWER, FLOOR, SQRT, QUOTIENT, PRODUCT };
static const uint64_t SEED = 20261122;
static const char *const names[FUNCTIONS] = {"td_exp2",          "td_log",   "td_log_inverse", "1/x",      "td_soft_taken",
                                             "td_inverse_power", "td_floor", "sqrt",           "quotient", "product"};

typedef struct numbers {
    double *x, *y;         /* (COUNT) any; positive and normal */
    double *host, *device; /* (FUNCTIONS x COUNT) */
} numbers;

/* Between 2^from and 2^to, of either sign or positive. */
static double scaled(uint64_t *state, int from, int to) { return exp2(scene_between(state, from, to)); }

/* The first few are where functions are most likely to go wrong; then each quarter is another kind of number. */
static void make_inputs(double *x, double *y) {
    static const double hard_x[8] = {0.0, -0.0, 1023.0, -1022.0, -1022.5, 0.5, -0.5, -1e300};
    static const double hard_y[8] = {1.0,    0.99999999999999989, 1.0000000000000002, 0x1p-1022, 1.7976931348623157e308,
                                     1e-300, 0.70710678118654757, 0.70710678118654746};
    uint64_t state = SEED;
    for (size_t i = 0; i < COUNT; i++) {
        x[i] = i % 4 == 0 ? scene_between(&state, -1100, 1023) : scene_between(&state, -60, 1);
        y[i] = i % 4 == 0 ? scaled(&state, -1022, 1023) : scene_between(&state, 1e-4, 3);
        if (i % 4 == 1) y[i] = 1 - scaled(&state, -53, -1);
        if (i % 8 == 2) x[i] = -scaled(&state, -60, 1), y[i] = scaled(&state, -1022, -960); /* subnormal products */
        if (i % 8 == 6) x[i] = scaled(&state, -1040, -960);                                 /* and quotients, or themselves */
    }
    memcpy(x, hard_x, sizeof hard_x);
    memcpy(y, hard_y, sizeof hard_y);
}

/* kernels/exact_check.cl */
static void on_host(const double *x, const double *y, double *out) {
    for (size_t i = 0; i < COUNT; i++) {
        double a = x[i], b = y[i], magnitude = td_size(a);
        int above = b < 1 ? a > b : magnitude > b;
        out[EXP2 * (size_t)COUNT + i] = td_exp2(a);
        out[LOG * (size_t)COUNT + i] = td_log(b);
        out[LOG_TOO * (size_t)COUNT + i] = td_log_inverse(b, &out[INVERSE * (size_t)COUNT + i]);
        out[TAKEN * (size_t)COUNT + i] = td_soft_taken(td_clamp(magnitude, 0, 41));
        out[POWER * (size_t)COUNT + i] = td_inverse_power(td_larger(b, 1));
        out[FLOOR * (size_t)COUNT + i] = td_floor(a) + above;
        out[SQRT * (size_t)COUNT + i] = td_sqrt(b);
        out[QUOTIENT * (size_t)COUNT + i] = a / b;
        out[PRODUCT * (size_t)COUNT + i] = above ? td_fma(a, b, 1) : a * b;
    }
}

static int set_up(void **state) {
    numbers *n = td_alloc(1, sizeof *n, NULL);
    if (!n) return -1;
    n->x = td_alloc(COUNT, sizeof(double), NULL);
    n->y = td_alloc(COUNT, sizeof(double), NULL);
    n->host = td_alloc((size_t)FUNCTIONS * COUNT, sizeof(double), NULL);
    n->device = td_alloc((size_t)FUNCTIONS * COUNT, sizeof(double), NULL);
    *state = n;
    if (!n->x || !n->y || !n->host || !n->device) return -1;
    make_inputs(n->x, n->y);
    on_host(n->x, n->y, n->host);
    return 0;
}

static int tear_down(void **state) {
    numbers *n = *state;
    free(n->x);
    free(n->y);
    free(n->host);
    free(n->device);
    free(n);
    return 0;
}

/* -- device -------------------------------------------------------------------------------------------------------- */

static tides_status run(tides_device *device, const numbers *n, tides_error *error) {
    const size_t bytes = COUNT * sizeof(double), items = (size_t)COUNT / (size_t)td_double_lanes(device);
    const size_t group = 16; /* PoCL's own choice, 4096, keeps the items' variables on the stack: 23 MB on arm64, too many */
    td_buffer x = {0}, y = {0}, out = {0};
    cl_kernel kernel = NULL;
    cl_int count = COUNT;
    tides_status status = td_kernel_create_double(device, "exact_check.cl", "", "td_exact_check", &kernel, error);
    if (status == TIDES_OK) status = td_buffer_write(device, &x, n->x, bytes, error);
    if (status == TIDES_OK) status = td_buffer_write(device, &y, n->y, bytes, error);
    if (status == TIDES_OK) status = td_buffer_reserve(device, &out, FUNCTIONS * bytes, error);
    if (status == TIDES_OK) {
        const td_argument arguments[] = {TD_BUFFER_ARGUMENT(x), TD_BUFFER_ARGUMENT(y), TD_BUFFER_ARGUMENT(out),
                                         TD_VALUE_ARGUMENT(count)};
        status = td_launch(device, kernel, 1, &items, &group, TD_ARGUMENTS(arguments), NULL, error);
    }
    if (status == TIDES_OK) status = td_buffer_read(device, &out, n->device, FUNCTIONS * bytes, error);
    if (kernel) clReleaseKernel(kernel);
    td_buffer_release(&x);
    td_buffer_release(&y);
    td_buffer_release(&out);
    return status;
}

static void compare_bits(const numbers *n, int lanes) {
    for (size_t i = 0; i < (size_t)FUNCTIONS * COUNT; i++)
        if (memcmp(&n->host[i], &n->device[i], sizeof(double)) != 0)
            fail_msg("%s, %d lanes, x = %.17g, y = %.17g: %.17g on the device, %.17g on the host", names[i / COUNT], lanes,
                     n->x[i % COUNT], n->y[i % COUNT], n->device[i], n->host[i]);
}

static tides_device *open_device(void) {
    tides_error error = {0, ""};
    tides_device *device = NULL;
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    if (status != TIDES_OK) fail_msg("%s", error.text);
    return device;
}

static void test_device_equals_host(void **state) {
    static const int widths[] = {1, 4, 8};
    const numbers *n = *state;
    tides_error error = {0, ""};
    tides_device *device = open_device();
    tides_status status = TIDES_OK;
    for (size_t w = 0; w < sizeof widths / sizeof *widths && status == TIDES_OK; w++) {
        device->info.lanes = device->double_lanes = widths[w];
        memset(n->device, 0xff, (size_t)FUNCTIONS * COUNT * sizeof(double));
        status = run(device, n, &error);
        if (status == TIDES_OK) compare_bits(n, widths[w]);
    }
    tides_device_close(device);
    if (status != TIDES_OK) fail_msg("%s", error.text);
}

/* A device without cl_khr_fp64 is refused in words. */
static void test_single_precision_is_refused(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_device *device = open_device();
    cl_kernel kernel = NULL;
    device->has_double = 0;
    assert_int_equal(td_kernel_create_double(device, "exact_check.cl", "", "td_exact_check", &kernel, &error),
                     TIDES_UNSUPPORTED);
    assert_null(kernel);
    assert_non_null(strstr(error.text, device->info.name));
    assert_non_null(strstr(error.text, "cl_khr_fp64"));
    tides_device_close(device);
}

/* Structs of reals and ints have the host's sizes and offsets (kernels/layout_check.cl). */
static void test_layout(void **state) {
    static const int want[] = {(int)sizeof(td_view),
                               (int)sizeof(td_backdrop),
                               (int)sizeof(td_job),
                               (int)sizeof(td_image),
                               (int)offsetof(td_view, eye_dot),
                               (int)offsetof(td_image, width),
                               (int)offsetof(td_image, outputs),
                               (int)offsetof(td_job, blocks)};
    enum { NUMBERS = sizeof want / sizeof *want };
    (void)state;
    int got[NUMBERS] = {0};
    tides_error error = {0, ""};
    tides_device *device = open_device();
    td_buffer out = {0};
    cl_kernel kernel = NULL;
    const size_t one = 1;
    tides_status status = td_kernel_create_double(device, "layout_check.cl", "", "td_layout_check", &kernel, &error);
    if (status == TIDES_OK) status = td_buffer_write(device, &out, got, sizeof got, &error);
    if (status == TIDES_OK) {
        const td_argument arguments[] = {TD_BUFFER_ARGUMENT(out)};
        status = td_launch(device, kernel, 1, &one, NULL, TD_ARGUMENTS(arguments), NULL, &error);
    }
    if (status == TIDES_OK) status = td_buffer_read(device, &out, got, sizeof got, &error);
    if (kernel) clReleaseKernel(kernel);
    td_buffer_release(&out);
    tides_device_close(device);
    if (status != TIDES_OK) fail_msg("%s", error.text);
    for (int i = 0; i < NUMBERS; i++)
        if (got[i] != want[i]) fail_msg("number %d: %d on the device, %d on the host", i, got[i], want[i]);
}

/* -- accuracy ------------------------------------------------------------------------------------------------------ */

/* Distance of a double from the true value, in units of the truth's last place. */
static double ulps(double value, long double truth) {
    int exponent;
    frexpl(truth, &exponent);
    if (exponent < -1021) exponent = -1021; /* subnormals have the same spacing as the smallest normal numbers */
    return (double)(fabsl((long double)value - truth) / ldexpl(1.0L, exponent - 53));
}

static long double truth_of(int function, double x, double y) {
    switch (function) {
        case EXP2: return exp2l(x < -1022 ? -1022.0L : (long double)x);
        case LOG:
        case LOG_TOO: return logl(y);
        case INVERSE: return 1.0L / y;
        case TAKEN: return -expm1l(-(long double)td_clamp(fabs(x), 0, 41));
        default: return exp2l(-floorl(log2l(y > 1 ? (long double)y : 1.0L)));
    }
}

static void test_functions_are_within_some_ulp(void **state) {
    static const double most[POWER + 1] = {1.0, 1.5, 1.5, 2.0, 2.5, 0.0};
    const numbers *n = *state;
    for (int f = EXP2; f <= POWER; f++) {
        double worst = 0, at = 0;
        for (size_t i = 0; i < COUNT; i++) {
            double x = n->x[i], y = n->y[i], value = n->host[(size_t)f * COUNT + i];
            if (f >= LOG_TOO && f != TAKEN && !(y > 1e-300 && y < 1e300)) continue;
            long double truth = truth_of(f, x, y);
            double error = truth == 0 ? (value == 0 ? 0 : 1e9) : ulps(value, truth);
            if (error > worst) worst = error, at = f == EXP2 || f == TAKEN ? x : y;
        }
        print_message("%s: at most %.3f ulp, at %.17g\n", names[f], worst, at);
        if (!(worst <= most[f])) fail_msg("%s(%.17g) is off by %.3f ulp", names[f], at, worst);
    }
}

static void test_floor_is_exact(void **state) {
    const numbers *n = *state;
    for (size_t i = 0; i < COUNT; i++) {
        double y = n->y[i], size = fabs(n->x[i]), got = n->host[FLOOR * (size_t)COUNT + i];
        int above = y < 1 ? n->x[i] > y : size > y;
        if (size < 0x1p51 && got != floor(n->x[i]) + above) fail_msg("td_floor(%.17g) = %.17g", n->x[i], got - above);
    }
}

/* Whole powers are exact, ln 1 is 0, and nothing is taken on no way. */
static void test_exact_values(void **state) {
    (void)state;
    for (int k = -1022; k <= 1023; k++)
        if (td_exp2(k) != ldexp(1.0, k)) fail_msg("2^%d", k);
    assert_true(td_log(1.0) == 0.0);
    assert_true(td_soft_taken(0.0) == 0.0);
    assert_true(td_not_a_number() != td_not_a_number());
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_device_equals_host),
                                       cmocka_unit_test(test_single_precision_is_refused),
                                       cmocka_unit_test(test_layout),
                                       cmocka_unit_test(test_functions_are_within_some_ulp),
                                       cmocka_unit_test(test_floor_is_exact),
                                       cmocka_unit_test(test_exact_values)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
