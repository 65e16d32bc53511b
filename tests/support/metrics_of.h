/* Test support: compares two event streams by the library's metrics. */
#ifndef TESTS_SUPPORT_METRICS_OF_H
#define TESTS_SUPPORT_METRICS_OF_H

#include "tides/metrics.h"

/* tides_metrics_compare of a reference and a simulated stream; a failure fails the running cmocka test. */
tides_metrics metrics_of(const tides_event *reference, size_t reference_count, const tides_event *simulated,
                         size_t simulated_count, const tides_metrics_options *options);

#endif
