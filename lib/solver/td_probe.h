/* Internal: what an evaluation inside a step says of its model.
 *
 * Two renders at a step's ends can't tell how wrong the cubic between them is: any difference of what they hold is 0 for some
 * signal, and for signals that people have. (S1 + S0_dot = S0 + S1_dot = 0 for whatever is even about the step's middle; a lamp
 * of period h returns to where it was.) So each macro step in which something moves is cut once whatever its ends say, and each
 * cut is a probe: a third evaluation, compared with the cubic in value and in rate.
 *
 * Where: not in the middle, nor at the same place of every step, or what is even about that place or repeats with the steps
 * would pass again. The place is drawn for each interval, the same in all tiles, so that tiles share render times. */
#ifndef TD_PROBE_H
#define TD_PROBE_H

#include "td_comparator.h"

/* Where [from, to] of macro step `macro` is cut; to - from > 1. */
uint32_t td_probe_place(uint64_t macro, uint32_t from, uint32_t to);

/* How far S and h S_dot at the share `theta` of a step of h seconds are off its cubic [log units]: (count). NaN where a signal
 * isn't finite. */
void td_probe_deviation(double h, double theta, const td_signals *ends, const double *S, const double *S_dot, int32_t count,
                        double *deviation);

/* What step control takes for the error of a step's cubic [log units]: from the embedded estimate of its own ends, and the
 * deviation at the place where it was cut out of a longer one. The deviation bounds it from both sides, and between the bounds
 * the step's own estimate decides: a kink leaves one part as rough as the whole was and the other smooth.
 *
 * TD_PROBE_MOST: wherever a kink is, both parts' errors are about the deviation at most (probe.c).
 * TD_PROBE_LEAST: of a smooth signal the parts have a fourteenth. The ends of a part with a kink in its middle say nothing of
 * it, and that mustn't hide more than what 1 / TD_PROBE_LEAST tolerances let through. TD_PROBE_EMBEDDED: the cubic is an order
 * better than the quadratic in the embedded estimate. With 0.7 the scenes of tides bench accuracy have the errors at a
 * tolerance that they had when the embedded estimate alone was held against it. */
#define TD_PROBE_MOST 1.0
#define TD_PROBE_LEAST 0.25
#define TD_PROBE_EMBEDDED 0.7

static inline double td_probe_error(double embedded, double deviation) {
    double error = TD_PROBE_EMBEDDED * embedded, least = TD_PROBE_LEAST * deviation, most = TD_PROBE_MOST * deviation;
    error = error > least ? error : least;
    return error < most ? error : most;
}

/* What is reported as left of a deviation in the parts of a step: as much as was left of the one before, within bounds. Of 200
 * random scenes (turning and passing clouds of splats, balls over flat ground; C 0.05 to 0.4) the reported median, p95 and p99
 * are then no smaller than the true ones in any; without the lower bound in 9 of 10. */
static inline double td_probe_left(double deviation, double before) {
    double left = before > 0 ? deviation / before : 0.25;
    return left < 0.17 ? 0.17 : left < 0.5 ? left : 0.5;
}

#endif
