/* Internal: probes, which test a step's model by a render inside the step.
 *
 * Two renders at a step's ends can't tell the error of the cubic between them: any difference of their values is 0 for some
 * signal, and for common ones. (S1 + S0_dot = S0 + S1_dot = 0 for a signal that is even about the step's middle; a lamp of
 * period h returns to where it was.) So each macro step in which something moves is cut once, whatever its ends say. Each cut
 * is a probe: a third evaluation, compared with the cubic in value and in rate.
 *
 * The place is neither the middle nor the same in every step: a signal that is even about that place, or repeats with the
 * steps, would pass again. It is drawn for each interval, the same in all tiles, so that tiles share render times. */
#ifndef TD_PROBE_H
#define TD_PROBE_H

#include "signal/td_signals.h"

#include <stddef.h>

/* Where [from, to] of macro step `macro` is cut; to - from > 1. */
uint32_t td_probe_place(uint64_t macro, uint32_t from, uint32_t to);

/* How far S and h S_dot at the share `theta` of a step of h seconds are off the cubic through its ends [log units], summed:
 * (count). NaN where a signal isn't finite. */
void td_probe_deviation(double h, double theta, const td_signals *ends, const double *S, const double *S_dot, int32_t count,
                        double *deviation);

/* The error that is reported for the parts of a step, from the deviation at its cut. It is a law of probability, since one
 * number doesn't tell the error of a part: shares of the deviation by which a part's cubic may be off in its middle, each with
 * a weight. Weights are whole 64ths, so that their sums are exact in any order.
 *
 * Smooth signals. The cubic's error in the middle is the fourth derivative times h^4 / 384. The deviation is the step's error,
 * and each part has a sixteenth of it, less towards its ends as 16 s^2 (1 - s)^2. Smooth pixels are those whose deviation has
 * fallen to about a sixteenth since the cut before. Where a step is long for the signal, the deviation falls less at each cut.
 *
 * Kinks. A kink of the slope at a drawn place leaves its part with 2.3 / 16 of the deviation in the median, 9 / 16 in a tenth,
 * and 18 / 16 in a hundredth of cases. A kink of the curvature leaves 1.8, 4 and 8.5 sixteenths. The error may be anywhere in
 * the part, and the deviation has fallen to about a half or a quarter. A deviation may also be small by chance, where terms of
 * an error cancel: it has fallen too far, and counts as rough.
 *
 * Measured on the events of 200 random scenes (grazing_world.h), 90, 95, 99 % of the errors are below these sixteenths: smooth
 * 1.4, 1.9, 4.3; rough 2, 3, 11; kink of the slope 3, 4, 14. The weights of the tails are higher than that: a run has few
 * places where its signals bend, and all pixels there share one chance. */
typedef struct td_probe_law {
    int is_smooth;
    double share[3], weight[3];
} td_probe_law;
enum { TD_PROBE_SHARES = 3 };

/* How far a deviation has fallen since the cut before, as a byte: their ratio in units of 1 / TD_PROBE_FALLS, rounded up, and
 * at most 255, the value of a deviation that didn't fall. 0: no cut before. */
enum { TD_PROBE_FALLS = 255 };

static inline uint8_t td_probe_fall(double deviation, double before) {
    const double fallen = TD_PROBE_FALLS * deviation / before, most = TD_PROBE_FALLS - 1;
    return (uint8_t)(1 + (int)(fallen < most ? fallen : most)); /* no branch, so that loops vectorise; NaN gives 255 */
}

/* Limits of falls. A smooth signal's is near a sixteenth: cuts are off the middle, and higher terms count. A kink of the slope
 * has a larger one. */
enum { TD_PROBE_SMOOTH_LEAST = 6, TD_PROBE_SMOOTH_MOST = 38, TD_PROBE_KINK_LEAST = 90 }; /* 0.02, 0.15, 0.35 */

/* td_probe_left(fall).is_smooth. */
static inline int td_probe_is_smooth(uint8_t fall) { return fall >= TD_PROBE_SMOOTH_LEAST && fall <= TD_PROBE_SMOOTH_MOST; }

static inline td_probe_law td_probe_left(uint8_t fall) {
    static const td_probe_law rough = {0, {2.0 / 16, 6.0 / 16, 1}, {52.0 / 64, 6.0 / 64, 6.0 / 64}};
    static const td_probe_law kink = {0, {2.0 / 16, 8.0 / 16, 1}, {32.0 / 64, 16.0 / 64, 16.0 / 64}};
    td_probe_law smooth = {1, {1.4 / 16, 4.0 / 16, 8.0 / 16}, {57.0 / 64, 1.0 / 64, 6.0 / 64}};
    if (fall >= TD_PROBE_KINK_LEAST) return kink;
    if (!td_probe_is_smooth(fall)) return rough;
    const double falls_on = 1.1 / TD_PROBE_FALLS * fall;
    if (falls_on > smooth.share[0]) smooth.share[0] = falls_on;
    return smooth;
}

/* Share of the deviation that the error of a part rarely exceeds; used to decide whether a near miss may be an event. */
#define TD_PROBE_LEFT_MOST 0.5

/* Bound of a part's error within which events are still looked for. A part with a kink keeps the whole deviation. A deviation
 * that fell to less than a sixteenth was small by chance, and counts as a sixteenth of the one before. Measured on 1.4 million
 * events of the scenes of `tides bench accuracy` with twelve thresholds each: with the whole deviation 4 were lost, for 2.4 %
 * more looks, with half of it 13. With twice it 8 were, all after a look. */
static inline double td_probe_most(double deviation, uint8_t fall) {
    const double sixteenth = (double)TD_PROBE_FALLS / 16;
    return fall > 0 && fall < sixteenth ? deviation * (sixteenth / fall) : deviation;
}

/* Share of td_probe_most that a look in a smooth part may miss. Half of that remains where the signal is as smooth as it seems;
 * a look that finds far less found it by chance. (The bench's fan lost an event 1.2e-4 of a threshold beyond its level, after a
 * look that found a sixtieth; check_lost, near 1110, one after a look that found an eightieth. This share costs one look in ten
 * thousand.) */
#define TD_PROBE_SMOOTH_UNSEEN (1.0 / 8)

#endif
