/* Rates of deformation networks are derivatives: against central differences of the double reference on random models, and on
 * the documented side at the knots of the time planes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_hexplane.h"
#include "tests/support/motion_rows.h"
#include "tests/support/random_network.h"

#include <math.h>
#include <stdlib.h>

enum { COUNT = 60, SH_STRIDE = 48, TIMES = 6 };
static const double STEP = 1e-6, TOLERANCE = 1e-6;

/* How a comparison went: entries compared, entries with a kink of a ReLU within the step, the largest error. */
typedef struct tally {
    const char *name;
    long compared, kinks;
    double worst;
} tally;

/* One entry: its rate equals the difference, or there's a kink: the difference is between the rates on both sides. */
static void compare_entry(tally *t, double before, double after, const double rate[3], int row, int entry) {
    double difference = (after - before) / (2 * STEP), scale = 1 + fabs(rate[1]);
    double error = fabs(difference - rate[1]) / scale;
    t->compared++;
    if (error <= TOLERANCE) {
        if (error > t->worst) t->worst = error;
        return;
    }
    double lower = rate[0] < rate[2] ? rate[0] : rate[2], upper = rate[0] < rate[2] ? rate[2] : rate[0];
    if (difference < lower - TOLERANCE * scale || difference > upper + TOLERANCE * scale)
        fail_msg("%s: row %d, entry %d: rate %.12g, central difference %.12g", t->name, row, entry, rate[1], difference);
    t->kinks++;
}

static void compare_arrays(tally *t, const double *const value[3], const double *const rate[3], int rows, int stride) {
    if (!value[0]) return;
    for (int i = 0; i < rows * stride; i++) {
        const double rates[3] = {rate[0][i], rate[1][i], rate[2][i]};
        compare_entry(t, value[0][i], value[2][i], rates, i / stride, i % stride);
    }
}

static void compare_at(tally *t, const packed_motion *packed, double tau) {
    motion_rows at[3];
    for (int k = 0; k < 3; k++) at[k] = motion_rows_f64(packed, tau + (k - 1) * STEP, 1, NULL, COUNT, SH_STRIDE);
    const double *const geometry[3] = {at[0].geometry, at[1].geometry, at[2].geometry};
    const double *const rates[3] = {at[0].rates, at[1].rates, at[2].rates};
    const double *const sh[3] = {at[0].sh, at[1].sh, at[2].sh}, *const sh_rates[3] = {at[0].sh_rates, at[1].sh_rates,
                                                                                      at[2].sh_rates};
    compare_arrays(t, geometry, rates, COUNT, TD_GEOMETRY_STRIDE);
    compare_arrays(t, sh, sh_rates, COUNT, SH_STRIDE);
    for (int k = 0; k < 3; k++) motion_rows_free(&at[k]);
}

/* Frees the motion. */
static void compare(const char *name, tides_motion *motion) {
    static const double times[TIMES] = {0.0123, 0.13, 0.37, 0.512, 0.777, 0.9871};
    random_gaussians gaussians = random_gaussians_make(32, COUNT, 3, 1.8);
    packed_motion packed = packed_motion_make(motion, &gaussians.view);
    tally t = {name, 0, 0, 0};
    for (int i = 0; i < TIMES; i++) compare_at(&t, &packed, times[i]);
    print_message("%s: %ld rates, largest error %.2g, %ld entries with a kink within 2e-6\n", name, t.compared, t.worst,
                  t.kinks);
    assert_true(t.kinks * 100 < t.compared);
    packed_motion_free(&packed);
    random_gaussians_free(&gaussians);
    tides_motion_destroy(motion);
}

static void test_hexplane(void **state) {
    random_hexplane_recipe recipe = random_hexplane_defaults(21);
    (void)state;
    compare("hexplane as for D-NeRF", random_hexplane_make(&recipe));
}

static void test_hexplane_all(void **state) {
    random_hexplane_recipe recipe = {22, 5, {6, 7, 9, 11}, 3, 22, 3, 31, 0, 0.2};
    (void)state;
    compare("hexplane with all heads", random_hexplane_make(&recipe));
    recipe.turns = 1;
    recipe.size[3] = 10;
    recipe.heads = TD_HEAD_ROTATION | TD_HEAD_OPACITY;
    compare("hexplane, rotations multiplied", random_hexplane_make(&recipe));
}

static void test_network(void **state) {
    random_network_recipe recipe = random_network_defaults(23);
    (void)state;
    recipe.width = 64;
    recipe.octaves = 4; /* with 10 there are several kinks in every step */
    compare("network", random_network_make(&recipe));
    recipe.screw = 1;
    compare("network, rigid", random_network_make(&recipe));
}

static void test_network_time(void **state) {
    const random_network_recipe recipe = {24, 32, 4, 2, 6, 40, 30, 0, 0.5};
    (void)state;
    compare("network with a network over the time", random_network_make(&recipe));
}

/* A rigid motion by no angle at all is a shift, with finite rates: theta = |w| isn't differentiable there. */
static void test_network_at_rest(void **state) {
    const random_network_recipe recipe = {25, 16, 3, 2, 4, 0, 0, 1, 0.5};
    tides_motion *motion = random_network_make(&recipe);
    random_gaussians gaussians = random_gaussians_make(33, COUNT, 0, 1);
    (void)state;
    const td_field *weight = td_motion_field(motion, "branch_w.weight"), *bias = td_motion_field(motion, "branch_w.bias");
    for (int i = 0; i < 3 * 16; i++) weight->value[i] = 0;
    for (int i = 0; i < 3; i++) bias->value[i] = 0;
    packed_motion packed = packed_motion_make(motion, &gaussians.view);
    motion_rows wide = motion_rows_f64(&packed, 0.3, 1, NULL, COUNT, 0),
                narrow = motion_rows_f32(&packed, 0.3, 1, NULL, COUNT, 0);
    for (int i = 0; i < COUNT * TD_GEOMETRY_STRIDE; i++) {
        assert_true(isfinite(wide.geometry[i]));
        assert_true(isfinite(wide.rates[i]));
        assert_true(isfinite(narrow.geometry[i]));
        assert_true(isfinite(narrow.rates[i]));
    }
    motion_rows_free(&wide);
    motion_rows_free(&narrow);
    packed_motion_free(&packed);
    random_gaussians_free(&gaussians);
    tides_motion_destroy(motion);
}

/* -- knots --------------------------------------------------------------------------------------------------------- */

/* The largest difference of two sets of rates. */
static double rates_apart(const motion_rows *a, const motion_rows *b) {
    double most = 0;
    for (int i = 0; i < a->count * TD_GEOMETRY_STRIDE; i++) most = fmax(most, fabs(a->rates[i] - b->rates[i]));
    return most;
}

/* At tau, asked for `side`, rates are those just beside it on the `beside` side. */
static double side_error(const packed_motion *packed, double tau, int side, int beside) {
    motion_rows at = motion_rows_f64(packed, tau, side, NULL, COUNT, SH_STRIDE);
    motion_rows near = motion_rows_f64(packed, tau + beside * 1e-10, side, NULL, COUNT, SH_STRIDE);
    double apart = rates_apart(&at, &near);
    motion_rows_free(&at);
    motion_rows_free(&near);
    return apart;
}

static void check_knots(int rows) {
    random_hexplane_recipe recipe = random_hexplane_defaults(26);
    recipe.size[3] = rows;
    recipe.channels = 4;
    tides_motion *motion = random_hexplane_make(&recipe);
    random_gaussians gaussians = random_gaussians_make(34, COUNT, 0, 1.5);
    packed_motion packed = packed_motion_make(motion, &gaussians.view);
    double tau[64];
    size_t count = motion->type->knots(motion, tau, 64);
    assert_int_equal(count, rows < 3 ? 0 : (rows - 2) / 2);
    assert_int_equal(motion->type->knots(motion, tau, 0), count);
    for (size_t k = 0; k < count; k++) {
        assert_true(fabs(tau[k] - (1 - 2.0 * (double)(count - k) / (rows - 1))) < 1e-15);
        assert_true(side_error(&packed, tau[k], 1, 1) < 1e-6);
        assert_true(side_error(&packed, tau[k], -1, -1) < 1e-6);
        assert_true(side_error(&packed, tau[k], 1, -1) > 1e-3);
    }
    for (int side = -1; side <= 1; side += 2) { /* at the ends there's one side only */
        assert_true(side_error(&packed, 0, side, 1) < 1e-6);
        assert_true(side_error(&packed, 1, side, -1) < 1e-6);
    }
    packed_motion_free(&packed);
    random_gaussians_free(&gaussians);
    tides_motion_destroy(motion);
}

static void test_knots(void **state) {
    static const int rows[] = {2, 3, 10, 11, 75};
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) check_knots(rows[i]);
}

/* At t = 1 the rate is the left derivative, where the trainer's automatic differentiation gives 0. */
static void test_last_time(void **state) {
    random_hexplane_recipe recipe = random_hexplane_defaults(27);
    tides_motion *motion = random_hexplane_make(&recipe);
    random_gaussians gaussians = random_gaussians_make(35, COUNT, 0, 1.5);
    packed_motion packed = packed_motion_make(motion, &gaussians.view);
    motion_rows at[3];
    int kinks = 0;
    (void)state;
    for (int k = 0; k < 3; k++) at[k] = motion_rows_f64(&packed, 1 - k * STEP, 1, NULL, COUNT, SH_STRIDE);
    for (int i = 0; i < COUNT * TD_GEOMETRY_STRIDE; i++) {
        double difference = (3 * at[0].geometry[i] - 4 * at[1].geometry[i] + at[2].geometry[i]) / (2 * STEP);
        kinks += fabs(difference - at[0].rates[i]) > TOLERANCE * (1 + fabs(at[0].rates[i]));
    }
    assert_true(kinks <= COUNT * TD_GEOMETRY_STRIDE / 100);
    for (int k = 0; k < 3; k++) motion_rows_free(&at[k]);
    packed_motion_free(&packed);
    random_gaussians_free(&gaussians);
    tides_motion_destroy(motion);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hexplane),        cmocka_unit_test(test_hexplane_all),
                                       cmocka_unit_test(test_network),         cmocka_unit_test(test_network_time),
                                       cmocka_unit_test(test_network_at_rest), cmocka_unit_test(test_knots),
                                       cmocka_unit_test(test_last_time)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
