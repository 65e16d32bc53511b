/* Internal: additive noise between the points of its grid, so that it crosses levels as often as the process does.
 *
 * A straight line between two points misses crossings: with points tau / 8 apart it fires a third less than the process where
 * a threshold is twice noise_rms. So a segment is a tree of parts. Where a part begins and ends with a and b, its middle is
 * drawn from the process's own law given these (l its length / tau),
 *
 *   normal of mean (a + b) / (2 cosh(l / 2)) and variance noise_rms^2 tanh(l / 2),
 *
 * down to parts whose standard deviation is at most a quarter of the threshold (`depth` halvings, 3 at least). On such a part
 * the process is a Brownian bridge of variance v = 4 noise_rms^2 tanh(l / 2), whose maximum M and minimum m have
 *
 *   P(M > c) = exp(-2 (c - a) (c - b) / v),  hence  M = (a + b + w) / 2,  w = sqrt((b - a)^2 + 2 v q),  q = -log(uniform)
 *
 * and likewise m. There the noise goes straight from a to one extreme, to the other, and to b. It is at M after the share
 * (M - a) / w of the part, the mean place of a bridge's maximum. M and m are drawn as if independent. That does no harm: levels
 * are 8 standard deviations apart, so that only one of them comes near a level.
 *
 * So the noise is one function of time, of (seed, pixel) alone. A level is crossed where that function crosses it, and only
 * parts that come near a level are ever drawn. That others don't reach it is certain: q is at most 12, which one part in 160
 * 000 would exceed. On every part of the tree the noise is kept within its bridge's bounds for this q, and so are its halves.
 * The process's variance on a segment of tau / 2 is at most 2 % above that of its bridge: (l / 2) / tanh(l / 2).
 *
 * An event re-references the comparator, so that the rate of crossings has a finite limit as parts get shorter. At this depth
 * the rate is within 0.1 % of the limit (measured to 0.07 %; without halvings 0.8 % where the threshold is noise_rms).
 *
 * At the ends of parts the noise is the process. Within parts its variance is v / 6 more, since lines stay near extremes longer
 * than a bridge. That adds 0.54 % to the variance at a time, with parts of tau / 16, and nothing to the covariance of times in
 * different parts. Over less than a third of a part the noise changes less than the process. The only effect found in events is
 * for pixels that are held (HOLD) for less than a part: they fire 1 % more often. */
#ifndef TD_NOISE_BRIDGE_H
#define TD_NOISE_BRIDGE_H

#include "td_additive_noise.h"
#include "sensor/response/td_response.h"

/* Greatest standard deviation of the shortest parts, as a share of the threshold. */
#define TD_NOISE_FINEST 0.25

/* The greatest q = -log(uniform) that is used: a bridge exceeds its bound once in e^12. */
#define TD_NOISE_Q_MAX 12.0

/* Sets level, depth and reach of a noise whose sigma and spacing_ns are set, for levels at least `threshold` away. */
void td_noise_bridge_make(td_additive_noise *noise, double tau_ns, double threshold);

/* The reach of a segment of size sigma and this tau: how far the noise goes beyond its ends. */
double td_noise_reach(const td_additive_noise *noise, double sigma, double tau_ns);

/* The noise on a pixel's segment at a time; outside of the segment, the value at its nearer end. */
double td_noise_value(const td_additive_noise *noise, uint32_t pixel, const td_noise_segment *segment, double time_ns);

/* A search for a crossing: a pixel's response on a step, and its levels. */
typedef struct td_noise_search {
    const td_additive_noise *noise;
    uint32_t pixel;
    double start_ns, length_ns;  /* of the step */
    const td_response *response; /* of the pixel, without noise */
    double low, high;            /* bounds of `response` on the step */
    td_response *scratch;        /* a copy of `response` whose cubic changes */
    double reference, on, off;
} td_noise_search;

/* The first crossing of response + noise with a level, on [from, to] of the segment; results as td_response_crossing. */
int td_noise_crossing(const td_noise_search *search, const td_noise_segment *segment, double from, double to, double *s);

#endif
