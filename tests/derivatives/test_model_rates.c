/* Rates of every motion model equal central differences of its double reference to 1e-6 of the largest rate, at random times,
 * with cuts that fade and with hard ones (away from those jumps). */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/move.h"
#include "tests/support/random_motion.h"

#include <math.h>
#include <stdlib.h>

enum { N = RANDOM_MOTION_GAUSSIANS, TIMES = 12, SH = 48, REALS = TD_GEOMETRY_STRIDE + SH };
static const uint64_t SEED = 4001;
static const double TAU_DOT = 0.7; /* rates come out per second */

/* Geometry, then SH, of all Gaussians at one time. */
typedef struct rows_at {
    double value[N * REALS], rate[N * REALS];
} rows_at;

static void rows_take(const move_rows *rows, rows_at *out) {
    for (int i = 0; i < N; i++)
        for (int k = 0; k < REALS; k++) {
            int in_sh = k >= TD_GEOMETRY_STRIDE, at = in_sh ? i * SH + k - TD_GEOMETRY_STRIDE : i * TD_GEOMETRY_STRIDE + k;
            out->value[i * REALS + k] = in_sh ? rows->sh[at] : rows->geometry[at];
            out->rate[i * REALS + k] = in_sh ? rows->sh_rates[at] : rows->rates[at];
        }
}

static void evaluate(const random_motion *made, const td_mover_numbers *numbers, double tau, int fades, rows_at *out) {
    static double geometry[N * TD_GEOMETRY_STRIDE], rates[N * TD_GEOMETRY_STRIDE], sh[N * SH], sh_rates[N * SH];
    move_rows rows = {SH, geometry, rates, sh, sh_rates};
    double moment[TD_MOMENT_REALS];
    int gaussian[N];
    memset(sh, 0, sizeof sh);
    memset(sh_rates, 0, sizeof sh_rates);
    for (int i = 0; i < N; i++) gaussian[i] = i;
    td_motion_moment(made->motion, tau, TAU_DOT, 1, moment);
    const move_job job = {made->motion->type->code,
                          fades,
                          numbers->moves_sh,
                          numbers->real,
                          numbers->own,
                          numbers->data,
                          numbers->data_count,
                          moment,
                          gaussian,
                          N,
                          N};
    move_f64(&job, &rows);
    rows_take(&rows, out);
}

/* A hard cut between the two times: opacity is 0 on one side only. */
static int jumps(const rows_at *before, const rows_at *after, int gaussian) {
    int at = gaussian * REALS + TD_G_OPACITY;
    return (before->value[at] == 0) != (after->value[at] == 0);
}

/* Differences by entry, against the largest rate of that entry over all Gaussians. */
static double compare(const random_motion *made, const rows_at *before, const rows_at *here, const rows_at *after,
                      double span) {
    double worst = 0;
    for (int k = 0; k < REALS; k++) {
        double largest = 1e-3, error = 0;
        for (int i = 0; i < N; i++) {
            int at = i * REALS + k;
            double difference = (after->value[at] - before->value[at]) / span * TAU_DOT;
            if (jumps(before, after, i)) continue;
            largest = fmax(largest, fabs(here->rate[at]));
            error = fmax(error, fabs(difference - here->rate[at]));
        }
        if (error > 1e-6 * largest) fail_msg("%s: entry %d is off by %g of %g", made->name, k, error, largest);
        worst = fmax(worst, error / largest);
    }
    return worst;
}

static void test_rates_equal_differences(void **state) {
    static rows_at before, here, after;
    (void)state;
    for (int kind = 0; kind < random_motion_kinds(); kind++) {
        random_motion made = random_motion_make(kind, SEED);
        td_mover_numbers numbers = {0};
        double start = made.motion->start, range = made.motion->stop - start, h = 1e-6 * range, worst = 0;
        assert_int_equal(made.motion->type->pack(made.motion, &made.gaussians, &numbers, NULL), TIDES_OK);
        for (int i = 0; i < 2 * TIMES; i++) {
            const int time = i / 2;
            double tau = start + range * (0.013 + 0.97 * time / TIMES);
            evaluate(&made, &numbers, tau - h, i % 2, &before);
            evaluate(&made, &numbers, tau, i % 2, &here);
            evaluate(&made, &numbers, tau + h, i % 2, &after);
            worst = fmax(worst, compare(&made, &before, &here, &after, (tau + h) - (tau - h)));
        }
        print_message("%s: at most %.2g of the largest rate\n", made.name, worst);
        td_mover_release(&numbers);
        random_motion_free(&made);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rates_equal_differences)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
