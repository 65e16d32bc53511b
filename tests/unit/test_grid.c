/* The grid of steps: regular points don't change without knots, knots are points too, no step is tiny, and times lead back to
 * points. Compared with an independent grid: a sorted list. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "solver/td_grid.h"
#include "tests/support/scene_folder.h"
#include "td_sort.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static td_grid make(double start, double stop, double step, const double *knots, size_t count, double gap) {
    td_grid grid;
    tides_error error;
    scene_expect_ok(td_grid_create(start, stop, step, knots, count, gap, &grid, &error), &error);
    return grid;
}

static void test_without_knots(void **state) {
    (void)state;
    td_grid grid = make(0.2, 0.2795, 2e-3, NULL, 0, 1e-6);
    assert_int_equal(grid.steps, 40);
    for (int64_t k = 0; k < 40; k++) {
        assert_true(td_grid_at(&grid, k) == 0.2 + (double)k * 2e-3);
        assert_false(td_grid_is_knot(&grid, k));
    }
    assert_true(td_grid_at(&grid, 40) == 0.2795);
    assert_true(td_grid_at(&grid, 41) == 0.2795);
    assert_int_equal(td_grid_last_until(&grid, 0, 0.1), 0);
    assert_int_equal(td_grid_last_until(&grid, 0, 0.2039), 1);
    assert_int_equal(td_grid_last_until(&grid, 0, 1), 40);
    td_grid_release(&grid);
}

static void expect_points(const td_grid *grid, const double *points, const int *is_knot, int count) {
    assert_int_equal(grid->steps, count - 1);
    for (int k = 0; k < count; k++) {
        if (td_grid_at(grid, k) != points[k]) fail_msg("point %d: %.17g, not %.17g", k, td_grid_at(grid, k), points[k]);
        assert_int_equal(td_grid_is_knot(grid, k), is_knot[k]);
        assert_int_equal(td_grid_last_until(grid, 0, points[k]), k);
        if (k) assert_int_equal(td_grid_last_until(grid, 0, 0.5 * (points[k - 1] + points[k])), k - 1);
    }
}

/* By hand: before and behind a regular point that gives way, two at one of them, at and outside the ends, and close to
 * these. */
static void test_by_hand(void **state) {
    (void)state;
    const double knots[] = {-1, 0, 0.01, 0.95, 1.5, 2.05, 2.95, 3.02, 4.5, 4.9, 4.99, 5, 7};
    const double points[] = {0, 0.01, 0.95, 1.5, 2.05, 2.95, 3.02, 4, 4.5, 4.9, 4.99, 5};
    const int is_knot[] = {0, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 0};
    td_grid grid = make(0, 5, 1, knots, sizeof knots / sizeof *knots, 0.1);
    expect_points(&grid, points, is_knot, sizeof points / sizeof *points);
    td_grid_release(&grid);
}

/* A last step is shorter than 1/1024 of the others, or longer than 1 + 1/1024 of them, in no grid; and none is of no length. */
static void test_no_slivers(void **state) {
    (void)state;
    srand(78);
    for (int trial = 0; trial < 200000; trial++) {
        double step = pow(10, 3 - 12.0 * rand() / RAND_MAX), share = trial % 2 ? 0 : pow(10, -14.0 * rand() / RAND_MAX);
        double length = step * (1 + rand() % 1000 + (trial % 4 ? share : -0.5 * share));
        td_grid grid = make(0, length, step, NULL, 0, 0);
        double last = length - td_grid_at(&grid, grid.steps - 1), least = step / 1024;
        if (!(last > (grid.steps > 1 ? 0.999999 * least : 0) && last < step + 1.000001 * least) || grid.steps > 1001)
            fail_msg("%.17g s in steps of %.17g s: %lld, the last of %g s", length, step, (long long)grid.steps, last);
        td_grid_release(&grid);
    }
}

/* A time worked out as start + k step_s reaches point k at any start, also where doubles are further apart than steps. */
static void test_until(void **state) {
    (void)state;
    static const double starts[] = {0, 0.1, 1e6 + 0.1, 1.305031102e9, 2e9 + 0.3};
    static const double steps[] = {1e-3, 1.0 / 3, 1e-5, 7e-7};
    for (int i = 0; i < 5; i++)
        for (int n = 0; n < 4; n++) {
            td_grid grid = make(0, 1000 * steps[n], steps[n], NULL, 0, 0);
            for (int64_t k = 0; k <= 1000; k++) {
                int64_t found = td_grid_last_until(&grid, starts[i], starts[i] + (double)k * steps[n]);
                assert_true(found >= k);
                assert_true(starts[i] + td_grid_at(&grid, found) == starts[i] + (double)k * steps[n]);
            }
            td_grid_release(&grid);
        }
}

/* So many ten-millionths of a second as people write them, and as the nearest double. */
static double decimal(int64_t units) {
    char text[48];
    snprintf(text, sizeof text, "%lld.%07lld", (long long)(units / 10000000), (long long)(units % 10000000));
    return strtod(text, NULL);
}

static void expect_point(const td_grid *grid, double epoch, double until, int64_t k, const char *what) {
    const int64_t found = td_grid_last_until(grid, epoch, until);
    if (found != k)
        fail_msg("%s: %.17g s after %.17g s in steps of %.17g s is point %lld, not %lld", what, until, epoch, grid->step_s,
                 (long long)k, (long long)found);
}

/* A grid point written in decimals, worked out as a product, or added up step by step is that point, at any epoch; what is
 * earlier by more than rounding isn't, be it by a billionth of what it is. */
static void test_decimals(void **state) {
    enum { TRIALS = 400, ADDED = 3000 };
    static const int64_t epochs[] = {0, 1, 3000000, 37000001, 11112223334445, 13050311023000000, 20000000003000001};
    (void)state;
    srand(79);
    for (int trial = 0; trial < TRIALS; trial++) {
        const int64_t start = epochs[trial % 7] + (trial % 3 == 2 ? rand() % 10000000 : 0);
        const int64_t step_units = trial < 20 ? 10000 : 50 + rand() % (rand() % 2 ? 1000 : 1000000);
        const int64_t steps = trial % 2 ? ADDED : 1000000;
        const double epoch = decimal(start), step = decimal(step_units), last = epoch + (double)steps * step;
        if (step < 32 * DBL_EPSILON * last) continue; /* doubles hardly tell points apart */
        td_grid grid = make(0, (double)steps * step, step, NULL, 0, 0);
        double sum = epoch;
        for (int64_t i = 1; i < ADDED; i++) {
            const int64_t k = steps == ADDED ? i : 1 + ((int64_t)rand() << 8) % (steps - 1);
            const double until = decimal(start + k * step_units), after = (double)k * step;
            const double early = 4 * DBL_EPSILON * until + fmin(1e-9 * after, 1e-10);
            expect_point(&grid, epoch, until, k, "decimals");
            expect_point(&grid, epoch, epoch + after, k, "product");
            expect_point(&grid, epoch, until - early, k - 1, "earlier");
            expect_point(&grid, epoch, until + 0.5 * step, k, "half a step later");
            sum += step;
            if (steps == ADDED && epoch < 1e4) expect_point(&grid, epoch, sum, k, "sum");
        }
        td_grid_release(&grid);
    }
}

/* The same the slow way: a regular point between the ends stays unless a knot is within the gap of it. */
static void test_against_a_list(void **state) {
    enum { TRIALS = 300, MOST = 60 };
    (void)state;
    srand(77);
    for (int trial = 0; trial < TRIALS; trial++) {
        double knots[MOST], points[2 * MOST + 32], gap = 0.2 * rand() / RAND_MAX;
        int is_knot[2 * MOST + 32], count = rand() % MOST, total = 0, regular = 1 + rand() % 20;
        for (int i = 0; i < count; i++) knots[i] = 1 + (regular + 2.0) * rand() / RAND_MAX - 1;
        qsort(knots, (size_t)count, sizeof *knots, td_ascending);
        for (int r = 0; r <= regular; r++) {
            int stays = 1;
            for (int i = 0; i < count && r > 0 && r < regular; i++)
                if (fabs(knots[i] - (1.0 + r)) < gap && knots[i] > 1 && knots[i] < 1.0 + regular) stays = 0;
            if (stays) points[total++] = 1.0 + r;
        }
        for (int i = 0; i < count; i++)
            if (knots[i] > 1 + 1e-9 && knots[i] < 1.0 + regular - 1e-9) points[total++] = knots[i];
        qsort(points, (size_t)total, sizeof *points, td_ascending);
        for (int k = 0; k < total; k++)
            is_knot[k] = bsearch(&points[k], knots, (size_t)count, sizeof *knots, td_ascending) != NULL;
        td_grid grid = make(1, 1.0 + regular, 1, knots, (size_t)count, gap);
        expect_points(&grid, points, is_knot, total);
        td_grid_release(&grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_without_knots), cmocka_unit_test(test_by_hand),
                                       cmocka_unit_test(test_no_slivers),    cmocka_unit_test(test_until),
                                       cmocka_unit_test(test_decimals),      cmocka_unit_test(test_against_a_list)};
    print_message("seed 77\n");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
