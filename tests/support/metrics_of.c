/* Compares two event streams by the library's metrics. */
#include "tests/support/metrics_of.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

tides_metrics metrics_of(const tides_event *reference, size_t reference_count, const tides_event *simulated,
                         size_t simulated_count, const tides_metrics_options *options) {
    tides_metrics m;
    tides_error error;
    if (tides_metrics_compare(reference, reference_count, simulated, simulated_count, options, NULL, NULL, &m, &error) !=
        TIDES_OK)
        fail_msg("%s", error.text);
    return m;
}
