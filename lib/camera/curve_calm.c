/* Splines that swing, and what is put in their place.
 *
 * A C2 spline passes on what happens in one interval to the next. Through samples that are a tenth of a microsecond apart, with
 * the noise that samples have, it leaves at a slope of that noise over that time, and over the next ten milliseconds swings to
 * many times the range of the samples themselves. Component by component: where a piece leaves the range of the samples around
 * it by as much as that range once more, its ends get the slopes of Fritsch and Butland (1984) instead, with which a cubic is
 * monotone between two samples; where the samples turn round, 0. There the curve is C1, its rates still those of its own
 * pieces, and everywhere else it has the bits that it would have without this. Where the samples have rates, they are what the
 * piece's ends keep. */
#include "camera/td_curve_segment.h"

#include "td_base.h"
#include "td_extremes.h"

#include <math.h>
#include <stdlib.h>

/* Samples on either side whose range counts: a spline's own ringing beside a step falls by 3.7 from one to the next, to 0.2 %
 * of the step beyond these. */
enum { AROUND = 4, PROBES = 16 };
/* How far a piece may leave that range, in units of it. Sines of more than two samples per period leave it by 0.19 at most,
 * noise at even times by 0.25, at times 1 to 3 apart by 0.7 (200 samples, 300 draws). */
static const double most_beyond = 1.0;
/* And of the range of all samples: what rings further away is no swing. */
static const double share_of_all = 0.01;

/* Range of component k over samples [from, to). */
static void range_of(const td_knot *knots, size_t from, size_t to, int k, double *low, double *high) {
    *low = *high = knots[from].value[k];
    for (size_t i = from + 1; i < to; i++) {
        *low = td_lesser(*low, knots[i].value[k]);
        *high = td_greater(*high, knots[i].value[k]);
    }
}

/* How far the rates of a piece's ends make it go by themselves: what is thrown up comes down at the same place. */
static double owed_to_rates(const td_knot *knot, int k) {
    return td_greater(fabs(knot[0].rate[k]), fabs(knot[1].rate[k])) * (knot[1].time - knot[0].time);
}

/* 1 where the piece leaves what is allowed it. */
static int swings(const td_knot *knots, size_t count, size_t i, int k, const double c[6], double range, double owed) {
    double low, high;
    range_of(knots, i + 1 < AROUND ? 0 : i + 1 - AROUND, i + 1 + AROUND < count ? i + 1 + AROUND : count, k, &low, &high);
    double slack = td_greater(most_beyond * (high - low), share_of_all * range) + owed;
    for (int probe = 1; probe < PROBES; probe++) {
        double u = (double)probe / PROBES, x = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
        if (x < low - slack || x > high + slack) return 1;
    }
    return 0;
}

/* The slope at a sample by its neighbours: the harmonic mean of theirs, weighted, 0 where they disagree. */
static double calm_slope(const td_knot *knots, size_t count, size_t i, int k) {
    if (i == 0) return (knots[1].value[k] - knots[0].value[k]) / (knots[1].time - knots[0].time);
    if (i + 1 == count) return (knots[i].value[k] - knots[i - 1].value[k]) / (knots[i].time - knots[i - 1].time);
    double before = knots[i].time - knots[i - 1].time, after = knots[i + 1].time - knots[i].time;
    double from = (knots[i].value[k] - knots[i - 1].value[k]) / before,
           to = (knots[i + 1].value[k] - knots[i].value[k]) / after;
    if (!(from * to > 0)) return 0;
    return 3 * (before + after) / ((2 * after + before) / from + (after + 2 * before) / to);
}

/* The cubic with these slopes at both ends. */
static void join(const td_knot *knot, int k, double start, double stop, double c[6]) {
    double span = knot[1].time - knot[0].time, rise = knot[1].value[k] - knot[0].value[k];
    c[0] = knot[0].value[k];
    c[1] = span * start;
    c[2] = 3 * rise - span * (2 * start + stop);
    c[3] = span * (start + stop) - 2 * rise;
    c[4] = c[5] = 0;
}

/* One component; `slope` (count) and `calm` (count) are scratch. A calmed end may make the next piece swing: until none does.
 */
static void calm_component(const td_knot *knots, size_t count, int with_rates, int k, td_segment *segments, double *slope,
                           unsigned char *calm) {
    double low, high;
    int found = 1;
    range_of(knots, 0, count, k, &low, &high);
    for (size_t i = 0; i < count; i++) {
        const double *c = segments[i + 1 < count ? i : i - 1].coefficient[k];
        size_t left = i + 1 < count ? i : i - 1;
        double span = knots[left + 1].time - knots[left].time;
        slope[i] = (i + 1 < count ? c[1] : c[1] + 2 * c[2] + 3 * c[3] + 4 * c[4] + 5 * c[5]) / span;
        calm[i] = 0;
    }
    while (found) {
        found = 0;
        for (size_t i = 0; i + 1 < count; i++) {
            double owed = with_rates ? owed_to_rates(knots + i, k) : 0;
            if ((calm[i] && calm[i + 1]) || !swings(knots, count, i, k, segments[i].coefficient[k], high - low, owed)) continue;
            found = calm[i] = calm[i + 1] = 1;
            for (size_t end = i; end <= i + 1; end++)
                slope[end] = with_rates ? knots[end].rate[k] : calm_slope(knots, count, end, k);
        }
        for (size_t i = 0; i + 1 < count && found; i++)
            if (calm[i] || calm[i + 1]) join(knots + i, k, slope[i], slope[i + 1], segments[i].coefficient[k]);
    }
}

tides_status td_curve_calm(const td_knot *knots, size_t count, int with_rates, td_segment *segments, unsigned char *bends,
                           tides_error *error) {
    double *slope = td_alloc(count, sizeof *slope, error);
    unsigned char *calm = td_alloc(count, sizeof *calm, error);
    if (slope && calm)
        for (int k = 0; k < TD_CURVE_WIDTH; k++) {
            calm_component(knots, count, with_rates, k, segments, slope, calm);
            for (size_t i = 0; i < count; i++) bends[i] |= calm[i];
        }
    free(slope);
    free(calm);
    return slope && calm ? TIDES_OK : TIDES_NO_MEMORY;
}
