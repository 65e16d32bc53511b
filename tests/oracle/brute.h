/* Brute force, to check the event finder: a pixel sampled at fixed intervals of nanoseconds, with all splats each time. */
#ifndef TESTS_ORACLE_BRUTE_H
#define TESTS_ORACLE_BRUTE_H

#include "tests/oracle/events.h"

/* Number of events on which the finder and samples `spacing` [s] apart disagree: one of both lacks the event, or the
 * finder's time isn't between the two samples that enclose it. A signal that passes a level and returns between two samples
 * counts too, although the finder is right there. */
size_t oracle_brute_differences(const oracle_scene *scene, const oracle_events *events, int pixel, double spacing);

#endif
