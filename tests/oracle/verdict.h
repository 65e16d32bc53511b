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

/* Receives an event that only one stream has: the library's (is_false) or the oracle's. nearest: time of the other stream's
 * nearest event at this pixel [s]; NAN: none. */
typedef void verdict_odd(void *user, const oracle_scene *scene, int is_false, int pixel, double time, int polarity,
                         double nearest);

/* Compares two streams. The events of a pixel are matched in their order, with equal polarity and at most 0.1 ms apart, so
 * that fewest are left over. Where the two thresholds differ, a lost or false event changes the reference of all later ones
 * of its pixel. These are then matched by polarity alone, and their times don't count. `odd` (nullable) receives each event
 * left over. */
verdict verdict_of(const oracle_scene *scene, const oracle_events *truth, const library_run *run, verdict_odd *odd, void *user);

/* Half of the unit in which the library's event times are floored [ns]: with it added, they are off by at most as much. */
#define VERDICT_ROUNDING_NS 0.5
/* Number of the three reported percentiles that are smaller than the true ones by more than VERDICT_ROUNDING_NS. */
int verdict_dishonest(const verdict *v);

#endif
