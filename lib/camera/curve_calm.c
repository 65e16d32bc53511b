/* Replaces segments of a spline that swing far beyond the samples by calmer ones.
 *
 * In a C2 spline each segment affects the next ones. Between two noisy samples 0.1 us apart its slope is the noise divided by
 * that time. In the next ten milliseconds it then swings to many times the range of the samples. So each component is
 * checked: a segment may leave the range of the samples around it by at most that range once more. Otherwise its ends get the
 * slopes of Fritsch and Butland (1984), with which a cubic is monotone between two samples, and 0 where the samples turn
 * round. If the samples have rates, the ends keep these rates. The curve is only C1 there; rates stay the derivatives of the
 * segments, and other segments keep their bits. */
#include "camera/td_curve_segment.h"

#include "td_base.h"
#include "td_extremes.h"

#include <math.h>
#include <stdlib.h>

/* AROUND: samples on either side of a segment whose range is used. The spline's own ringing beside a step falls by a factor of
 * 3.7 per sample; beyond these samples it is 0.2 % of the step. PROBES: parts of a segment at whose borders it is checked. */
enum { AROUND = 4, PROBES = 16 };
/* A segment may leave the range of the samples around it by this multiple of the range. Sines of more than two samples per
 * period leave it by at most 0.19. Noise leaves it by 0.25 at even times, and by 0.7 at intervals of 1 to 3 (200 samples, 300
 * draws). */
static const double most_beyond = 1.0;
/* A segment is calmed only if it leaves that range by more than this share of the range of all samples: less is ringing, and
 * harmless. */
static const double share_of_all = 0.01;

/* Range of component k over samples [from, to). */
static void range_of(const td_knot *knots, size_t from, size_t to, int k, double *low, double *high) {
    *low = *high = knots[from].value[k];
    for (size_t i = from + 1; i < to; i++) {
        *low = td_lesser(*low, knots[i].value[k]);
        *high = td_greater(*high, knots[i].value[k]);
    }
}

/* How far the rates at a segment's ends alone carry it beyond its samples: motion with such rates is real, no swing. */
static double owed_to_rates(const td_knot *knot, int k) {
    return td_greater(fabs(knot[0].rate[k]), fabs(knot[1].rate[k])) * (knot[1].time - knot[0].time);
}

/* 1 if the segment leaves its allowed range. */
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

/* The slope at a sample from its neighbours: the weighted harmonic mean of the slopes on either side, 0 if their signs
 * differ. */
static double calm_slope(const td_knot *knots, size_t count, size_t i, int k) {
    if (i == 0) return (knots[1].value[k] - knots[0].value[k]) / (knots[1].time - knots[0].time);
    if (i + 1 == count) return (knots[i].value[k] - knots[i - 1].value[k]) / (knots[i].time - knots[i - 1].time);
    double before = knots[i].time - knots[i - 1].time, after = knots[i + 1].time - knots[i].time;
    double from = (knots[i].value[k] - knots[i - 1].value[k]) / before,
           to = (knots[i + 1].value[k] - knots[i].value[k]) / after;
    if (!(from * to > 0)) return 0;
    return 3 * (before + after) / ((2 * after + before) / from + (after + 2 * before) / to);
}

/* The cubic with these slopes at its ends. */
static void join(const td_knot *knot, int k, double start, double stop, double c[6]) {
    double span = knot[1].time - knot[0].time, rise = knot[1].value[k] - knot[0].value[k];
    c[0] = knot[0].value[k];
    c[1] = span * start;
    c[2] = 3 * rise - span * (2 * start + stop);
    c[3] = span * (start + stop) - 2 * rise;
    c[4] = c[5] = 0;
}

/* Calms one component; `slope` (count) and `calm` (count) are scratch. A calmed end may make the next segment swing, so it
 * repeats until none does. */
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
