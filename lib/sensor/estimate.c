/* The estimated error of a tile's step, over the pixels that may fire in it, for the step control of the solver. */
#include "td_estimate.h"
#include "signal/td_model_error.h"
#include "td_between.h"
#include "td_extremes.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

/* Error of S that single precision leaves in the renderer. A smaller error is rounding, which no cut removes. Divided by the
 * slope of a pixel that hardly moves, it would be a large error of time. */
static const double noise = 1e-6;

/* Additive noise takes a pixel to levels up to this many sigmas from its signal, and rarely farther. */
static const double noise_swing = 5;

/* -- one pixel ----------------------------------------------------------------------------------------------------------- */

/* A pixel's step: values, rates per step, the estimated error, and by how much the range of its control values is widened. */
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

/* The greatest way of S: along the control values. */
static inline double way_of(const pixel_step *p) {
    double first = p->rate0 * (1.0 / 3.0), last = p->rate1 * (1.0 / 3.0);
    return fabs(first) + fabs(p->S1 - p->S0 - (first + last)) + fabs(last);
}

/* 1 where a level reference + n C lies in [low, high]. */
static int reaches_level(double low, double high, double reference, double threshold) {
    return floor((high - reference) / threshold) > floor((low - reference) / threshold) ||
           floor((low - reference) / threshold) * threshold + reference == low;
}

/* Adds a pixel to the worst case. `scale`: nominal over own threshold; `moved`: how far the signal moves in the step. */
static void count_pixel(const td_estimated *step, const pixel_step *p, double scale, double moved, td_estimate *worst) {
    int says_nothing = step->deviation && p->bump <= step->rounding;
    double timed = td_greater(p->error - noise, 0);
    worst->rounded = td_greater(worst->rounded, p->error * scale);
    if (says_nothing) return;
    worst->error = td_greater(worst->error, p->error * scale);
    if (step->deviation) worst->deviation = td_greater(worst->deviation, p->bump * scale);
    if (moved > 0) worst->seconds = td_greater(worst->seconds, timed * step->h / moved);
}

/* -- a tile of ideal pixels ---------------------------------------------------------------------------------------------- */

enum { LANES = 16 };  /* pixels side by side; each lane keeps the worst of every LANESth pixel */
enum { BLOCK = 256 }; /* pixels handled together */

/* td_estimate of each lane, with `way` in place of crossings. Doubts are pixels of a block of which this loop can't tell
 * whether they count. */
typedef struct lanes {
    double error[LANES], seconds[LANES], deviation[LANES], rounded[LANES], way[LANES];
    double doubts[LANES]; /* their number in the lane */
    double doubt[BLOCK];  /* 1 or 0, for each pixel */
} lanes;

/* Does what count_pixel does for `count` pixels from number `at` of the block that begins at pixel `block`. With `probed` and
 * `levelled` constant the loop is straight-line code that vectorises: flags are doubles, and adding 1.5 x 2^52 rounds to a
 * whole number. `slack` covers rounding in this test: within it of a level a pixel is in doubt. Where such sums can't be
 * trusted, `slack` is as large as a level. NaN is passed over: no comparison is true of it. */
static inline void look_at(int probed, int levelled, const td_estimated *step, double threshold, int32_t block, int32_t at,
                           int32_t count, lanes *restrict to) {
    const int32_t first = block + at;
    const double *S0 = step->signals->S0 + first, *S0_dot = step->signals->S0_dot + first;
    const double *S1 = step->signals->S1 + first, *S1_dot = step->signals->S1_dot + first;
    const double *deviation = probed ? step->deviation + first : NULL, *reference = levelled ? step->reference + first : NULL;
    const double h = step->h, per_level = 1 / threshold, whole = 0x1.8p52, rounding = step->rounding;
    double *restrict doubt = to->doubt + at;
    for (int32_t k = 0; k < count; k++) {
        const pixel_step p = {S0[k], S1[k], h * S0_dot[k], h * S1_dot[k], 0, 0};
        double embedded = td_embedded(p.S1 - p.S0, p.rate0, p.rate1), bump = probed ? deviation[k] : embedded;
        double error = probed ? td_probe_error(embedded, bump) : embedded;
        double timed = td_greater(error - noise, 0), moved = td_greater(fabs(p.S1 - p.S0), error);
        double counts = 1.0, open = 0.0;
        if (levelled) {
            double a = p.S0 + p.rate0 * (1.0 / 3.0), b = p.S1 - p.rate1 * (1.0 / 3.0);
            double low = td_lesser(td_lesser(p.S0, p.S1), td_lesser(a, b)) - bump;
            double high = td_greater(td_greater(p.S0, p.S1), td_greater(a, b)) + bump;
            double slack = 64 * DBL_EPSILON * (fabs(low) + fabs(high) + fabs(reference[k])) * per_level;
            double middle = (0.5 * (low + high) - reference[k]) * per_level, half = 0.5 * (high - low) * per_level;
            double away = fabs(middle - ((middle + whole) - whole));
            counts = away < half - slack ? 1.0 : 0.0;
            open = away > half + slack ? 0.0 : 1.0 - counts;
        }
        double told = probed && !(bump > rounding) ? 0.0 : counts, seconds = timed * h / moved;
        to->rounded[k] = td_greater(counts > 0.0 ? error : 0.0, to->rounded[k]);
        to->error[k] = td_greater(told > 0.0 ? error : 0.0, to->error[k]);
        if (probed) to->deviation[k] = td_greater(told > 0.0 ? bump : 0.0, to->deviation[k]);
        to->seconds[k] = td_greater(told > 0.0 ? seconds : 0.0, to->seconds[k]);
        to->way[k] = td_greater(way_of(&p), to->way[k]);
        if (!levelled) continue;
        double worse = error > to->error[k] ? open : 0.0; /* a pixel that hardly moves is on a level, and no worse */
        worse = seconds > to->seconds[k] ? open : worse;
        if (probed) worse = bump > to->deviation[k] ? open : worse;
        doubt[k] = worse;
        to->doubts[k] += worse;
    }
}

static inline void look_at_all(int probed, int levelled, const td_estimated *step, double threshold, int32_t block,
                               int32_t count, lanes *to) {
    for (int32_t at = 0; at < count; at += LANES)
        look_at(probed, levelled, step, threshold, block, at, count - at < LANES ? count - at : LANES, to);
}

TD_WIDE static void look(const td_estimated *step, int levelled, double threshold, int32_t block, int32_t count, lanes *to) {
    if (step->deviation && levelled)
        look_at_all(1, 1, step, threshold, block, count, to);
    else if (step->deviation)
        look_at_all(1, 0, step, threshold, block, count, to);
    else if (levelled)
        look_at_all(0, 1, step, threshold, block, count, to);
    else
        look_at_all(0, 0, step, threshold, block, count, to);
}

/* Pixel i, if it was in doubt: decides with reaches_level. */
static void ask_ideal(const td_estimated *step, double threshold, int32_t i, td_estimate *worst) {
    const pixel_step p = pixel_of(step, i);
    /* Where the signal hardly rises, a crossing's time is only as accurate as the range that the signal moves in. */
    double moved = td_greater(fabs(p.S1 - p.S0), p.error), low, high;
    range_of(&p, &low, &high);
    if (reaches_level(low, high, step->reference[i], threshold)) count_pixel(step, &p, 1, moved, worst);
}

/* Joins the worst of the lanes. */
static void take_lanes(const lanes *of, double threshold, td_estimate *worst) {
    double way = 0;
    for (int k = 0; k < LANES; k++) {
        worst->error = td_greater(of->error[k], worst->error);
        worst->seconds = td_greater(of->seconds[k], worst->seconds);
        worst->deviation = td_greater(of->deviation[k], worst->deviation);
        worst->rounded = td_greater(of->rounded[k], worst->rounded);
        way = td_greater(of->way[k], way);
    }
    worst->crossings = way / threshold;
}

static double doubts_of(const lanes *of) {
    double doubts = 0;
    for (int k = 0; k < LANES; k++) doubts += of->doubts[k];
    return doubts;
}

static td_estimate estimate_ideal(const td_sensor *sensor, const td_estimated *step) {
    td_estimate worst = {0, 0, 0, 0, 0};
    const double threshold = sensor->sensor.threshold_on;
    const int levelled = step->reference && threshold == sensor->sensor.threshold_off;
    lanes of; /* large: a doubt is set where its pixel is looked at */
    memset(&of, 0, offsetof(lanes, doubt));
    for (int32_t block = 0; block < step->count; block += BLOCK) {
        const int32_t count = step->count - block < BLOCK ? step->count - block : BLOCK;
        look(step, levelled, threshold, block, count, &of);
        if (!levelled || !(doubts_of(&of) > 0)) continue;
        for (size_t k = 0; (k = td_next_mark(of.doubt, k, (size_t)count)) < (size_t)count; k++)
            ask_ideal(step, threshold, block + (int32_t)k, &worst);
    }
    take_lanes(&of, td_sensor_least_threshold(&sensor->sensor), &worst);
    return worst;
}

/* -- a tile with blocks -------------------------------------------------------------------------------------------------- */

void td_sensor_begin_estimates(const td_sensor *sensor, size_t first, int32_t count) {
    for (size_t i = first; sensor->on && i < first + (size_t)count; i++) sensor->reach[i] = sensor->held_until[i] > -INFINITY;
}

/* 1 where the pixel may fire within the step, or may have fired earlier in the macro step, as far as is known. `low` and `high`
 * bound S_eff. */
static int may_fire(const td_sensor *sensor, size_t i, int cuts, double low, double high, double reference) {
    double on = sensor->threshold_on[i], off = sensor->threshold_off[i];
    if (on == off && !td_sensor_holds(sensor)) return reaches_level(low, high, reference, on);
    int leaves = !(low > reference - off && high < reference + on);
    if (leaves && cuts <= TD_FEW_CUTS) sensor->reach[i] = 1;
    return leaves || sensor->reach[i];
}

/* Some pixels of a tile side by side. `worse` is 0 where count_pixel would change nothing, so that nobody need ask whether the
 * pixel counts. `way` is in thresholds. */
typedef struct suspects {
    double worse[LANES], way[LANES];
} suspects;

/* Looks at the LANES pixels from number `at` of the tile on, or at those that are left, by the formulas of pixel_of. */
static inline void look_for_worse(int probed, const td_sensor *sensor, const td_estimated *step, size_t first, double time,
                                  int32_t at, const td_estimate *worst, suspects *restrict to) {
    const double *S0 = step->signals->S0 + at, *S0_dot = step->signals->S0_dot + at;
    const double *S1 = step->signals->S1 + at, *S1_dot = step->signals->S1_dot + at;
    const double *on = sensor->threshold_on + first + at, *off = sensor->threshold_off + first + at;
    const double *leak = sensor->leak + first + at, *deviation = probed ? step->deviation + at : NULL;
    const double h = step->h, nominal = td_sensor_least_threshold(&sensor->sensor);
    const td_estimate known = *worst;
    const int32_t count = step->count - at < LANES ? step->count - at : LANES;
    for (int32_t k = 0; k < count; k++) {
        const pixel_step p = {S0[k], S1[k], h * S0_dot[k], h * S1_dot[k], 0, 0};
        const double embedded = td_embedded(p.S1 - p.S0, p.rate0, p.rate1), bump = probed ? deviation[k] : embedded;
        const double error = probed ? td_probe_error(embedded, bump) : embedded, own = td_lesser(on[k], off[k]);
        const double ramp0 = leak[k] * time, ramp1 = ramp0 + leak[k] * h * 1e9, scale = nominal / own;
        const double timed = td_greater(error - noise, 0), moved = td_greater(fabs(p.S1 - p.S0 + (ramp1 - ramp0)), error);
        double worse = error * scale <= known.rounded ? 0.0 : 1.0;
        worse = error * scale <= known.error ? worse : 1.0;
        worse = timed * h / moved <= known.seconds ? worse : 1.0;
        if (probed) worse = bump * scale <= known.deviation ? worse : 1.0;
        to->worse[k] = worse;
        to->way[k] = error >= 0 ? (way_of(&p) + fabs(ramp1 - ramp0)) / own : 0;
    }
}

TD_WIDE static void find_suspects(const td_sensor *sensor, const td_estimated *step, size_t first, double time, int32_t at,
                                  const td_estimate *worst, suspects *to) {
    if (step->deviation)
        look_for_worse(1, sensor, step, first, time, at, worst, to);
    else
        look_for_worse(0, sensor, step, first, time, at, worst, to);
}

/* Pixel k of the tile: adds it if it may fire. */
static void ask_block(const td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time, int32_t k,
                      td_estimate *worst) {
    const size_t i = first + (size_t)k;
    const pixel_step p = pixel_of(step, k);
    if (!(p.error >= 0)) return; /* NaN */
    const double swing =
        (sensor->additive.on ? noise_swing * sensor->additive.sigma : 0) + (sensor->kick.on ? sensor->kick.most : 0);
    const double ramp0 = sensor->leak[i] * time, ramp1 = ramp0 + sensor->leak[i] * step->h * 1e9;
    const double own = td_lesser(sensor->threshold_on[i], sensor->threshold_off[i]);
    const double moved = td_greater(fabs(p.S1 - p.S0 + (ramp1 - ramp0)), p.error);
    double low, high;
    range_of(&p, &low, &high); /* the ramp lies between its ends, which are added below */
    if (step->reference && !may_fire(sensor, i, cuts, low + ramp0 - swing, high + ramp1 + swing, step->reference[k])) return;
    count_pixel(step, &p, td_sensor_least_threshold(&sensor->sensor) / own, moved, worst);
}

static td_estimate estimate_blocks(const td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time) {
    td_estimate worst = {0, 0, 0, 0, 0};
    const int notes = step->reference && cuts <= TD_FEW_CUTS; /* may_fire keeps what it finds */
    suspects of;
    for (int32_t at = 0; at < step->count; at += LANES) {
        const int32_t count = step->count - at < LANES ? step->count - at : LANES;
        find_suspects(sensor, step, first, time, at, &worst, &of);
        for (int32_t k = 0; k < count; k++) {
            worst.crossings = td_greater(of.way[k], worst.crossings);
            if (notes || of.worse[k] > 0.0) ask_block(sensor, step, first, cuts, time, at + k, &worst);
        }
    }
    return worst;
}

/* Thresholds and leaks of a tile's pixels, the nominal threshold, and the step's start. */
typedef struct tile_levels {
    const double *on, *off, *leak;
    double nominal, time;
} tile_levels;

/* Does what count_pixel does, to the bit, for a tile in which every pixel counts. */
static inline void look_filtered(int probed, const td_estimated *step, const tile_levels *levels, int32_t first, int32_t count,
                                 lanes *restrict to) {
    const double *on = levels->on, *off = levels->off, *leak = levels->leak;
    const double nominal = levels->nominal, time = levels->time;
    const double *S0 = step->signals->S0 + first, *S0_dot = step->signals->S0_dot + first;
    const double *S1 = step->signals->S1 + first, *S1_dot = step->signals->S1_dot + first;
    const double *deviation = probed ? step->deviation + first : NULL;
    const double h = step->h, rounding = step->rounding;
    for (int32_t k = 0; k < count; k++) {
        const pixel_step p = {S0[k], S1[k], h * S0_dot[k], h * S1_dot[k], 0, 0};
        const double embedded = td_embedded(p.S1 - p.S0, p.rate0, p.rate1), bump = probed ? deviation[k] : embedded;
        const double error = probed ? td_probe_error(embedded, bump) : embedded;
        const double own = td_lesser(on[first + k], off[first + k]), scale = nominal / own;
        const double ramp0 = leak[first + k] * time, ramp1 = ramp0 + leak[first + k] * h * 1e9;
        const double timed = td_greater(error - noise, 0), moved = td_greater(fabs(p.S1 - p.S0 + (ramp1 - ramp0)), error);
        const double counts = error >= 0 ? 1.0 : 0.0, told = probed && !(bump > rounding) ? 0.0 : counts;
        const double way = (way_of(&p) + fabs(ramp1 - ramp0)) / own, seconds = moved > 0 ? timed * h / moved : 0.0;
        to->rounded[k] = td_greater(counts > 0.0 ? error * scale : 0.0, to->rounded[k]);
        to->error[k] = td_greater(told > 0.0 ? error * scale : 0.0, to->error[k]);
        if (probed) to->deviation[k] = td_greater(told > 0.0 ? bump * scale : 0.0, to->deviation[k]);
        to->seconds[k] = td_greater(told > 0.0 ? seconds : 0.0, to->seconds[k]);
        to->way[k] = td_greater(counts > 0.0 ? way : 0.0, to->way[k]);
    }
}

TD_WIDE static void look_filtered_all(const td_estimated *step, const tile_levels *levels, lanes *to) {
    for (int32_t at = 0; at < step->count; at += LANES) {
        const int32_t count = step->count - at < LANES ? step->count - at : LANES;
        if (step->deviation)
            look_filtered(1, step, levels, at, count, to);
        else
            look_filtered(0, step, levels, at, count, to);
    }
}

static td_estimate estimate_filtered(const td_sensor *sensor, const td_estimated *step, size_t first, double time) {
    td_estimate worst = {0, 0, 0, 0, 0};
    lanes of;
    memset(&of, 0, offsetof(lanes, doubt));
    const tile_levels levels = {sensor->threshold_on + first, sensor->threshold_off + first, sensor->leak + first,
                                td_sensor_least_threshold(&sensor->sensor), time};
    look_filtered_all(step, &levels, &of);
    take_lanes(&of, 1, &worst);
    return worst;
}

td_estimate td_sensor_estimate(const td_sensor *sensor, const td_estimated *step, size_t first, int cuts, double time) {
    if (sensor->frontend.on || (sensor->on && !step->reference)) return estimate_filtered(sensor, step, first, time);
    return sensor->on ? estimate_blocks(sensor, step, first, cuts, time) : estimate_ideal(sensor, step);
}
