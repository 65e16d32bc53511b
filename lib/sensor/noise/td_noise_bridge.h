/* Internal: additive noise between the points of its grid, so that it crosses levels as often as the process does.
 *
 * A straight line between two points misses the crossings of what goes there and back: segments of tau / 8 fire a third less
 * than the process where a threshold is twice noise_rms. So a segment is a tree of parts. Where a part begins and ends with a
 * and b, its middle is drawn from the process's own law given these (l its length / tau),
 *
 *   normal of mean (a + b) / (2 cosh(l / 2)) and variance noise_rms^2 tanh(l / 2),
 *
 * down to parts that are short: their standard deviation is a quarter of the threshold at most (`depth` halvings, 1 at least).
 * On such a part the process is a Brownian bridge of variance v = 4 noise_rms^2 tanh(l / 2), whose maximum M and minimum m have
 *
 *   P(M > c) = exp(-2 (c - a) (c - b) / v),  hence  M = (a + b + w) / 2,  w = sqrt((b - a)^2 + 2 v q),  q = -log(uniform)
 *
 * and likewise m. The noise there goes straight from a to one, to the other, to b; at M after the share (M - a) / w of the
 * part, where the Brownian bridge's maximum comes on average. M and m are drawn as if independent, which the one that comes
 * near a level doesn't notice: the levels are 8 standard deviations apart.
 *
 * So the noise is one function of time, of (seed, pixel) alone; a level is crossed where that function crosses it, and only
 * parts that come near a level are ever drawn. That the others can't is certain, not likely: q is at most 12 (which one part in
 * 160 000 would exceed), on every part of the tree the noise is kept within what that leaves to its bridge, and so are its
 * halves.
 *
 * An event re-references the comparator, so that the rate of crossings is finite and has a limit as parts get shorter: at this
 * depth it is within 0.1 % of it (measured to 0.07 %; without halvings 0.8 % where the threshold is noise_rms).
 *
 * At the ends of parts the noise is the process. Within them straight stretches between extremes stay near these longer than a
 * bridge does: their variance is a quarter more than its, v / 6. That adds 0.54 % to the variance at a time, with parts of
 * tau / 16, and nothing to the covariance of times in different parts; over less than a third of a part the noise changes less
 * than the process. All that was found of this in events is of pixels that are held (HOLD) for less than a part: they fire 1 %
 * more often. */
#ifndef TD_NOISE_BRIDGE_H
#define TD_NOISE_BRIDGE_H

#include "td_additive_noise.h"
#include "sensor/response/td_response.h"

/* level, depth and reach of a noise whose sigma and spacing_ns are set, for levels at least `threshold` away. */
void td_noise_bridge_make(td_additive_noise *noise, double tau_ns, double threshold);

/* reach of parts of length l (in tau). */
double td_noise_reach(double sigma, double l);

/* The noise on a pixel's segment at a time that it holds; beyond its ends, theirs. */
double td_noise_value(const td_additive_noise *noise, uint32_t pixel, const td_noise_segment *segment, double time_ns);

/* A search for a crossing: a pixel's response on a step, and its levels. */
typedef struct td_noise_search {
    const td_additive_noise *noise;
    uint32_t pixel;
    double start_ns, length_ns;  /* of the step */
    const td_response *response; /* without noise, */
    double low, high;            /* its bounds on the step, */
    td_response *scratch;        /* and a copy whose cubic changes */
    double reference, on, off;
} td_noise_search;

/* td_response_crossing of response + noise, for `from` to `to` on the segment. */
int td_noise_crossing(const td_noise_search *search, const td_noise_segment *segment, double from, double to, double *s);

#endif
