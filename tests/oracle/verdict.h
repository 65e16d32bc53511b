/* The library's events against the oracle's: which are lost, which are false, and the errors of the times of the others. */
#ifndef TESTS_ORACLE_VERDICT_H
#define TESTS_ORACLE_VERDICT_H

#include "tests/oracle/events.h"
#include "tests/oracle/library.h"

typedef struct verdict {
    size_t events, matched, lost, false_ones, wrong_pixels;
    double true_ns[4];     /* p50, p95, p99 and the largest |dt| of matched ones [ns] */
    double reported_ns[3]; /* p50, p95, p99 [ns] */
    unsigned long long uncertain;
    double run_s, oracle_s;
} verdict;

/* An event of one of the two that the other hasn't, and the nearest of its pixel that the other has (NAN: none) [s]. */
typedef void verdict_odd(void *user, const oracle_scene *scene, int is_false, int pixel, double time, int polarity,
                         double nearest);

/* A pixel's events are taken for each other in their order, of one polarity, no more than 0.1 ms apart, so that fewest are left
 * over. Where thresholds differ, all that follows a lost or false event of a pixel has another reference: there they are taken
 * for each other by polarity alone, and their times don't count. `odd` (nullable) is told of each that is left over. */
verdict verdict_of(const oracle_scene *scene, const oracle_events *truth, const library_run *run, verdict_odd *odd, void *user);

/* Event times are whole nanoseconds, floored: in their middle they are off by at most half of one. */
#define VERDICT_ROUNDING_NS 0.5
/* How many of the three reported percentiles are smaller than the true ones, by more than that. */
int verdict_dishonest(const verdict *v);

#endif
