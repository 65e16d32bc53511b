/* The choice of the events that are measured: how many of each macro step, whichever order they come in. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "solver/td_solve_portion.h"
#include "solver/td_timing.h"

#include <math.h>
#include <string.h>

enum { SIDE = 200 };

static td_sampled event_of(int i) { return (td_sampled){.point = {1e-6 * (i % 977), i % SIDE, i / SIDE}}; }

/* Events 0 to count - 1, forwards or backwards. */
static td_solve_portion step_of(int count, int backwards) {
    td_solve_portion portion;
    memset(&portion, 0, sizeof portion);
    for (int i = 0; i < count; i++) {
        const td_sampled one = event_of(backwards ? count - 1 - i : i);
        assert_int_equal(td_solve_sample(&portion, &one, NULL), TIDES_OK);
    }
    return portion;
}

/* Each measured event stands for at most a TD_TIMING_SAMPLE-th of all so far, and no more are measured than that needs. */
static void test_number(void **state) {
    static const int steps[] = {10, 700, 58, 1, 5000, 5000, 0, 3, 20000, 40000, 7};
    double before = 0;
    (void)state;
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        td_solve_portion portion = step_of(steps[k], 0);
        td_solve_cut(&portion, before);
        const double all = before + steps[k], chosen = (double)portion.sampled_count;
        if (all <= TD_TIMING_SAMPLE) assert_true(chosen == steps[k]);
        if (chosen > 0) assert_true(steps[k] / chosen <= fmax(1, all / TD_TIMING_SAMPLE) * (1 + 1e-12));
        assert_true(chosen - 1 < steps[k] * TD_TIMING_SAMPLE / all && chosen <= TD_TIMING_SAMPLE);
        assert_true(steps[k] == 0 || chosen > 0);
        before = all;
        td_solve_portion_release(&portion);
    }
}

static void test_any_order(void **state) {
    static const int counts[] = {1, 767, 769, 1536, 1537, 30000};
    (void)state;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        td_solve_portion one = step_of(counts[k], 0), two = step_of(counts[k], 1);
        td_solve_cut(&one, 500);
        td_solve_cut(&two, 500);
        assert_int_equal(one.sampled_count, two.sampled_count);
        for (size_t i = 0; i < one.sampled_count; i++)
            assert_memory_equal(&one.sampled[i].point, &two.sampled[i].point, sizeof one.sampled[i].point);
        td_solve_portion_release(&one);
        td_solve_portion_release(&two);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_number), cmocka_unit_test(test_any_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
