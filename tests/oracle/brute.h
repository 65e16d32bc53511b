/* Brute force, to check the event finder: a pixel sampled at fixed intervals of nanoseconds, with all splats each time. */
#ifndef TESTS_ORACLE_BRUTE_H
#define TESTS_ORACLE_BRUTE_H

#include "tests/oracle/events.h"

/* How many of a pixel's events differ: one has it and the other hasn't, or their times are further apart than a sample. An
 * excursion shorter than a sample is the brute one's miss. */
size_t oracle_brute_differences(const oracle_scene *scene, const oracle_events *events, int pixel, double spacing);

#endif
