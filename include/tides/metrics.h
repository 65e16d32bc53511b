/* How good a stream is: distances between streams of events. */
#ifndef TIDES_METRICS_H
#define TIDES_METRICS_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a stream compares with the exact one. Percentiles are of |dt| over the matched pairs, interpolated linearly between
 * neighbours in the sorted list; NaN where no pair was matched. */
typedef struct tides_match {
    uint64_t reference, simulated; /* events in the streams */
    uint64_t matched;              /* pairs */
    uint64_t missing, spurious;    /* events of the reference, of the simulated stream, that have no counterpart */
    double mismatch_percent;       /* 100 (missing + spurious) / reference; 0 where both are empty, infinite where only the
                                      reference is */
    double dt_median_us, dt_p95_us, dt_p99_us, dt_max_us;
    double dt_mean_us; /* of the signed simulated - reference: the bias */
} tides_match;

/* Matches the events of each pixel and polarity in order of time: of all pairings that don't cross and pair nothing further
 * apart than `limit_s` (above 0, at most 10), the one with the largest sum of (limit - |dt|). An event too many or too few thus
 * costs one mismatch and doesn't shift its neighbours. Each event is offered the 64 counterparts nearest to it in time.
 * Streams may be in any order, 0 events are fine; neither is changed. n log n. */
TIDES_MUST_CHECK TIDES_API tides_status tides_match_events(const tides_event *reference, size_t reference_count,
                                                           const tides_event *simulated, size_t simulated_count, double limit_s,
                                                           tides_match *match, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
