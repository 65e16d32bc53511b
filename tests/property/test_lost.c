/* Events that are lost or invented with look-ups (stepping.solve): random worlds that graze their levels, each with several
 * thresholds, in default steps, against steps a quarter as long with a hundredth of the tolerance.
 *
 * A signal may reach a level and return between two samples, and no finite number of looks is sure to find it. So the test
 * bounds the share of such events, below what the default tolerance must give on real scenes (0.01 %).
 *
 * TIDES_TRIALS=N: N worlds. TIDES_SEED=N: the first one's seed. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/grazing_world.h"
#include "tests/support/number_of.h"

#include <stdlib.h>

enum { WORLDS = 120, THRESHOLDS = 6 };

/* Of all events, pixels that have others. 1.1e-5 in these worlds (and 0.7e-5 in 600 of them, where some are lost by the short
 * steps); 2.6e-5 where only turns of the model were looked at, within half of what a probe had seen. */
#define MOST_LOST 1.6e-5

typedef struct tally {
    uint64_t events, wrong, uncertain, looks;
} tally;

static void run_once(judged *j, tally *of) {
    const tides_stepping stepping = j->stepping;
    judged_stream fine = {0};
    tides_stats stats;
    j->stepping.step_s *= 0.25;
    j->stepping.tolerance *= 0.01;
    assert_int_equal(judged_simulate(j, "reference", &fine, &stats), 1);
    j->stepping = stepping;
    const judged_verdict v = judged_against(j, "reference", JUDGED_LIMIT_S, &fine);
    free(fine.events);
    /* A light that goes through 0 has a logarithm that steps of a microsecond can't follow, and the statistics say so. */
    if (stats.steps_at_minimum > 0 || v.stats.steps_at_minimum > 0) return;
    of->events += fine.count;
    of->wrong += (uint64_t)v.wrong_pixels;
    of->uncertain += v.stats.events_uncertain;
    of->looks += v.stats.points_looked_up;
    if (v.wrong_pixels > 0) print_message("%s, threshold %g: %d pixels\n", j->name, j->sensor.threshold_on, v.wrong_pixels);
}

static void test_few_are_lost(void **state) {
    (void)state;
    const uint64_t first = number_of("TIDES_SEED", 1), count = number_of("TIDES_TRIALS", WORLDS);
    tally all = {0};
    for (uint64_t seed = first; seed < first + count; seed++) {
        judged j = grazing_world_make(seed);
        judged_look_up(&j);
        for (int k = 0; k < THRESHOLDS; k++, j.sensor.threshold_on *= 1.12, j.sensor.threshold_off *= 1.1) run_once(&j, &all);
        judged_free(&j);
    }
    print_message("%llu events, %llu pixels with others, %llu uncertain, %.4f looks an event\n", (unsigned long long)all.events,
                  (unsigned long long)all.wrong, (unsigned long long)all.uncertain, (double)all.looks / (double)all.events);
    assert_true(all.events > 1000 * count);
    if ((double)all.wrong > MOST_LOST * (double)all.events)
        fail_msg("%llu pixels have other events", (unsigned long long)all.wrong);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_few_are_lost)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
