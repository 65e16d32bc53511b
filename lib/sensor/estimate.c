/* The estimated error of a tile's step, over the pixels that may fire in it, for the solver's step control. */
#include "td_estimate.h"
#include "signal/td_model_error.h"
#include "td_extremes.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>

/* What single precision leaves of S on its way through the renderer: an error below it is rounding, which no cut removes, and
 * divided by the slope of a pixel that hardly moves it would look like any time. */
static const double noise = 1e-6;

/* Additive noise brings a pixel to levels that are this many sigmas from its signal; beyond it hardly ever is. */
static const double noise_swing = 5;

/* -- one pixel ----------------------------------------------------------------------------------------------------------- */

/* A pixel's step: rates per step; what it may be off by; by how much the range of its control values is widened. */
typedef struct pixel_step {
    double S0, S1, rate0, rate1, error, bump;
} pixel_step;

static inline pixel_step pixel_of(const td_estimated *step, int32_t i) {
    const td_signals *at = step->signals;
    pixel_step p = {at->S0[i], at->S1[i], step->h * at->S0_dot[i], step->h * at->S1_dot[i], 0, 0};
    p.error = p.bump = td_embedded(p.S1 - p.S0, p.rate0, p.rate1);
    if (!step->deviation) return p;
    p.bump = step->deviation[i];
    p.error = td_probe_error(p.error, p.bump);
    return p;
}

/* Range of the control values, widened. */
static void range_of(const pixel_step *p, double *low, double *high) {
    double a = p->S0 + p->rate0 / 3, b = p->S1 - p->rate1 / 3;
    *low = td_lesser(td_lesser(p->S0, p->S1), td_lesser(a, b)) - p->bump;
    *high = td_greater(td_greater(p->S0, p->S1), td_greater(a, b)) + p->bump;
}

/* How far S comes at most: along the control values. */
static inline double way_of(const pixel_step *p) {
    double first = p->rate0 * (1.0 / 3.0), last = p->rate1 * (1.0 / 3.0);
    return fabs(first) + fabs(p->S1 - p->S0 - (first + last)) + fabs(last);
}

/* Is there a level reference + n C in [low, high]? */
static int reaches_level(double low, double high, double reference, double threshold) {
    return floor((high - reference) / threshold) > floor((low - reference) / threshold) ||
           floor((low - reference) / threshold) * threshold + reference == low;
}

/* Counts a pixel with an error of `error`, which is `scale` as much in nominal thresholds, and how far it moves in the step. */
static void count_pixel(const td_estimated *step, const pixel_step *p, double scale, double moved, td_estimate *worst) {
    int says_nothing = step->deviation && p->bump <= step->rounding;
    double timed = td_greater(p->error - noise, 0);
    worst->rounded = td_greater(worst->rounded, p->error * scale);
    if (says_nothing) return;
    worst->error = td_greater(worst->error, p->error * scale);
    if (step->deviation) worst->deviation = td_greater(worst->deviation, p->bump * scale);
    if (moved > 0) worst->seconds = td_greater(worst->seconds, timed * step->h / moved);
}

/* -- a tile -------------------------------------------------------------------------------------------------------------- */

enum { BLOCK = 64 }; /* pixels marked together */
enum { APART = 32 }; /* pixels asked first, so that the first block's marks have something to be held against */

/* Of a block's pixels. */
typedef struct marks {
    double mark[BLOCK]; /* 0 where the pixel can't add to the estimate: no worse than what is there, or no level within reach;
                           otherwise 1, and it is asked exactly */
    double way[BLOCK];  /* the longest of these pixels and of those as far behind the blocks before */
} marks;

/* Marks the pixels from `first` on. With `probed` and `levelled` constant the loop is straight-line code that vectorises, by
 * the same means as comparator.c's: marks are doubles, and rounding to a whole number is adding 1.5 x 2^52. `slack` is for
 * rounding here, so that none is passed over that reaches_level would find; it is as large as a level where that sum is of no
 * use. */
static inline void mark_some(int probed, int levelled, const td_estimated *step, const td_estimate *worst, double threshold,
                             int32_t first, int32_t count, double *restrict mark, double *restrict way) {
    const double *S0 = step->signals->S0 + first, *S0_dot = step->signals->S0_dot + first;
    const double *S1 = step->signals->S1 + first, *S1_dot = step->signals->S1_dot + first;
    const double *deviation = probed ? step->deviation + first : NULL, *reference = levelled ? step->reference + first : NULL;
    const double h = step->h, per_level = 1 / threshold, whole = 0x1.8p52;
    const td_estimate most = *worst;
    for (int32_t k = 0; k < count; k++) {
        const pixel_step p = {S0[k], S1[k], h * S0_dot[k], h * S1_dot[k], 0, 0};
        double embedded = td_embedded(p.S1 - p.S0, p.rate0, p.rate1), bump = probed ? deviation[k] : embedded;
        double error = probed ? td_probe_error(embedded, bump) : embedded;
        double timed = td_greater(error - noise, 0), moved = td_greater(fabs(p.S1 - p.S0), error);
        double flag = error > most.error ? 1.0 : 0.0;
        flag = timed * h > most.seconds * moved ? 1.0 : flag;
        if (probed) flag = bump > most.deviation ? 1.0 : flag;
        if (levelled) {
            double a = p.S0 + p.rate0 * (1.0 / 3.0), b = p.S1 - p.rate1 * (1.0 / 3.0);
            double low = td_lesser(td_lesser(p.S0, p.S1), td_lesser(a, b)) - bump;
            double high = td_greater(td_greater(p.S0, p.S1), td_greater(a, b)) + bump;
            double slack = 64 * DBL_EPSILON * (fabs(low) + fabs(high) + fabs(reference[k]));
            double middle = (0.5 * (low + high) - reference[k]) * per_level, half = (0.5 * (high - low) + slack) * per_level;
            flag = fabs(middle - ((middle + whole) - whole)) > half ? 0.0 : flag;
        }
        mark[k] = flag;
        way[k] = td_greater(way_of(&p), way[k]);
    }
}

TD_WIDE static void mark_block(const td_estimated *step, const td_estimate *worst, int levelled, double threshold,
                               int32_t first, int32_t count, marks *to) {
    if (step->deviation && levelled)
        mark_some(1, 1, step, worst, threshold, first, count, to->mark, to->way);
    else if (step->deviation)
        mark_some(1, 0, step, worst, threshold, first, count, to->mark, to->way);
    else if (levelled)
        mark_some(0, 1, step, worst, threshold, first, count, to->mark, to->way);
    else
        mark_some(0, 0, step, worst, threshold, first, count, to->mark, to->way);
}

/* Pixel i, if it is worse than what was seen and may fire. NaN: the comparator passes it over. */
static void ask_ideal(const td_estimated *step, int levelled, double threshold, int32_t i, td_estimate *worst) {
    const pixel_step p = pixel_of(step, i);
    /* Where the signal hardly rises, the time of a crossing is only as good as the range that it moves in. */
    double moved = td_greater(fabs(p.S1 - p.S0), p.error);
    double timed = td_greater(p.error - noise, 0);
    int is_new = p.error > worst->error || timed * step->h > worst->seconds * moved;
    if (!is_new && !(step->deviation && p.bump > worst->deviation)) return;
    double low, high;
    range_of(&p, &low, &high);
    if (levelled && !reaches_level(low, high, step->reference[i], threshold)) return;
    count_pixel(step, &p, 1, moved, worst);
}

static td_estimate estimate_ideal(const td_sensor *sensor, const td_estimated *step) {
    td_estimate worst = {0, 0, 0, 0, 0};
    const double threshold = sensor->sensor.threshold_on;
    const int levelled = step->reference && threshold == sensor->sensor.threshold_off;
    marks block = {.way = {0}};
    double way = 0;
    for (int32_t i = 0; i < step->count; i += APART) ask_ideal(step, levelled, threshold, i, &worst);
    for (int32_t first = 0; first < step->count; first += BLOCK) {
        const int32_t count = step->count - first < BLOCK ? step->count - first : BLOCK;
        mark_block(step, &worst, levelled, threshold, first, count, &block);
        for (size_t k = 0; (k = td_next_mark(block.mark, k, (size_t)count)) < (size_t)count; k++)
            ask_ideal(step, levelled, threshold, first + (int32_t)k, &worst);
    }
    for (int k = 0; k < BLOCK; k++) way = td_greater(block.way[k], way);
    worst.crossings = way / td_sensor_least_threshold(&sensor->sensor);
    return worst;
}

void td_sensor_begin_estimates(td_sensor *sensor, size_t first, int32_t count) {
    for (size_t i = first; sensor->on && i < first + (size_t)count; i++) sensor->reach[i] = sensor->held_until[i] > -INFINITY;
}

/* May the pixel fire within the step, or have fired in the macro step before it, as far as is known? `low` and `high` bound
 * S_eff. */
static int may_fire(td_sensor *sensor, size_t i, int cuts, double low, double high, double reference) {
    double on = sensor->threshold_on[i], off = sensor->threshold_off[i];
    if (sensor->frontend.on) return 1;
    if (on == off && !td_sensor_holds(sensor)) return reaches_level(low, high, reference, on);
    int leaves = !(low > reference - off && high < reference + on);
    if (leaves && cuts <= TD_FEW_CUTS) sensor->reach[i] = 1;
    return leaves || sensor->reach[i];
}

static td_estimate estimate_blocks(td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time) {
    td_estimate worst = {0, 0, 0, 0, 0};
    double swing = sensor->additive.on ? noise_swing * sensor->additive.sigma : 0;
    double nominal = td_sensor_least_threshold(&sensor->sensor);
    for (int32_t k = 0; k < step->count; k++) {
        size_t i = first + (size_t)k;
        const pixel_step p = pixel_of(step, k);
        if (!(p.error >= 0)) continue; /* NaN */
        double ramp0 = sensor->leak[i] * time, ramp1 = ramp0 + sensor->leak[i] * step->h * 1e9;
        double low, high, own = td_lesser(sensor->threshold_on[i], sensor->threshold_off[i]);
        worst.crossings = td_greater((way_of(&p) + fabs(ramp1 - ramp0)) / own, worst.crossings);
        range_of(&p, &low, &high); /* the ramp lies between its ends: bounds need no more */
        if (step->reference && !may_fire(sensor, i, cuts, low + ramp0 - swing, high + ramp1 + swing, step->reference[k]))
            continue;
        double moved = td_greater(fabs(p.S1 - p.S0 + (ramp1 - ramp0)), p.error);
        count_pixel(step, &p, nominal / own, moved, &worst);
    }
    return worst;
}

td_estimate td_sensor_estimate(td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time) {
    return sensor->on ? estimate_blocks(sensor, step, first, cuts, time) : estimate_ideal(sensor, step);
}
