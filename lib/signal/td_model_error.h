/* Internal: the error of a local model on a step, from the step's ends, and from the render inside the longer step that it was
 * cut out of. For step control, and for reported errors of event times. The sensor decides which pixels count. */
#ifndef TD_MODEL_ERROR_H
#define TD_MODEL_ERROR_H

/* The embedded estimate (DESIGN 3.2): the cubic against the quadratic through S0, S0_dot, S1 and its mirror image through S0,
 * S1, S1_dot. Their difference is greatest at a third of the step, 4/27 |h S1_dot - (2 (S1 - S0) - h S0_dot)|. It uses the ends
 * alone, and is 0 for signals that are even about the middle. `rise` is S1 - S0, rates are per step. */
static inline double td_embedded(double rise, double rate0, double rate1) {
    double bent = rate1 + rate0 - 2 * rise;
    return 4.0 / 27.0 * (bent < 0 ? -bent : bent);
}

/* Error of a step's cubic for step control [log units]. It follows from the embedded estimate of the step's own ends, and from
 * the deviation at the place where the step was cut out of a longer one. The deviation bounds it from both sides, and between
 * the bounds the step's own estimate decides: a kink leaves one part as rough as the whole was, and the other part smooth.
 *
 * TD_PROBE_MOST: wherever a kink is, both parts' errors are about the deviation at most. TD_PROBE_LEAST: the parts of a smooth
 * signal have a fourteenth of the deviation. The ends of a part don't show a kink in its middle, which mustn't hide more than
 * 1 / TD_PROBE_LEAST tolerances. TD_PROBE_EMBEDDED: the cubic is an order better than the quadratic in the embedded estimate.
 * With 0.7 the scenes of `tides bench accuracy` have the errors, at a tolerance, that they had with the embedded estimate
 * alone. */
#define TD_PROBE_MOST 1.0
#define TD_PROBE_LEAST 0.25
#define TD_PROBE_EMBEDDED 0.7

static inline double td_probe_error(double embedded, double deviation) {
    double error = TD_PROBE_EMBEDDED * embedded, least = TD_PROBE_LEAST * deviation, most = TD_PROBE_MOST * deviation;
    error = error > least ? error : least;
    return error < most ? error : most;
}

#endif
