/* The estimated error of a tile's step, over the pixels that may fire in it, for the solver's step control. */
#include "td_estimate.h"
#include "signal/td_model_error.h"
#include "td_extremes.h"

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
static double way_of(const pixel_step *p) {
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

static td_estimate estimate_ideal(const td_sensor *sensor, const td_estimated *step) {
    td_estimate worst = {0, 0, 0, 0, 0};
    double threshold = sensor->sensor.threshold_on, way = 0;
    int equal = threshold == sensor->sensor.threshold_off;
    for (int32_t i = 0; i < step->count; i++) {
        const pixel_step p = pixel_of(step, i);
        way = td_greater(way_of(&p), way);
        /* Where the signal hardly rises, the time of a crossing is only as good as the range that it moves in. */
        double moved = td_greater(fabs(p.S1 - p.S0), p.error);
        /* Most pixels are no worse than one already seen: they needn't be asked about levels. NaN: the comparator passes it
         * over. */
        double timed = td_greater(p.error - noise, 0);
        int is_new = p.error > worst.error || timed * step->h > worst.seconds * moved || p.error > worst.rounded;
        if (!is_new && !(step->deviation && p.bump > worst.deviation)) continue;
        double low, high;
        range_of(&p, &low, &high);
        if (equal && step->reference && !reaches_level(low, high, step->reference[i], threshold)) continue;
        count_pixel(step, &p, 1, moved, &worst);
    }
    worst.crossings = way / td_sensor_least_threshold(&sensor->sensor);
    return worst;
}

/* May the pixel fire within the step, or have fired in the macro step before it, as far as is known? `low` and `high` bound
 * S_eff. */
static int may_fire(td_sensor *sensor, size_t i, int cuts, double low, double high, double reference) {
    double on = sensor->threshold_on[i], off = sensor->threshold_off[i];
    if (sensor->frontend.on) return 1;
    if (on == off && !td_sensor_holds(sensor)) return reaches_level(low, high, reference, on);
    if (cuts == 0) sensor->reach[i] = sensor->held_until[i] > -INFINITY;
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
