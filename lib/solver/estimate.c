/* The embedded error estimate of a tile's step. */
#include "td_estimate.h"

#include <math.h>
#include <string.h>

/* The largest value of s^2 (1 - s) on [0, 1]: cubic and quadratic differ by s^2 (1 - s) times the difference of their end
 * rates. */
static const double bulge = 4.0 / 27.0;

/* What single precision leaves of S on its way through the renderer: an error below it is rounding, which no halving removes,
 * and divided by the slope of a pixel that hardly moves it would look like any time. */
static const double noise = 1e-6;

/* Additive noise brings a pixel to levels that are this many sigmas from its signal; beyond it hardly ever is. */
static const double noise_swing = 5;

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

/* Is there a level reference + n C in [low, high]? */
static int reaches_level(double low, double high, double reference, double threshold) {
    return floor((high - reference) / threshold) > floor((low - reference) / threshold) ||
           floor((low - reference) / threshold) * threshold + reference == low;
}

/* May the pixel's signal touch a level within the step? The range of its control values, widened by the estimate. */
static int may_fire(double S0, double rate0, double S1, double rate1, double error, double reference, double threshold) {
    double a = S0 + rate0 / 3, b = S1 - rate1 / 3;
    double low = smaller(smaller(S0, S1), smaller(a, b)) - error;
    double high = larger(larger(S0, S1), larger(a, b)) + error;
    return reaches_level(low, high, reference, threshold);
}

td_estimate td_estimate_step(const td_comparator *comparator, double h, const td_signals *signals, const double *reference,
                             int32_t count) {
    td_estimate worst = {0, 0};
    double threshold = comparator->threshold_on;
    int equal = threshold == comparator->threshold_off;
    for (int32_t i = 0; i < count; i++) {
        double S0 = signals->S0[i], S1 = signals->S1[i], rise = S1 - S0;
        double rate0 = h * signals->S0_dot[i], rate1 = h * signals->S1_dot[i];
        /* The mirror image differs from the cubic by h S0_dot - (2 (S1 - S0) - h S1_dot): the same number. */
        double error = bulge * fabs(rate1 + rate0 - 2 * rise);
        /* Where the signal hardly rises, the time of a crossing is only as good as the range that it moves in. */
        double moved = larger(fabs(rise), error);
        /* Most pixels are no worse than one already seen: they needn't be asked about levels. NaN: the comparator passes it
         * over. */
        double timed = larger(error - noise, 0);
        if (!(error > worst.error || timed * h > worst.seconds * moved)) continue;
        if (equal && reference && !may_fire(S0, rate0, S1, rate1, error, reference[i], threshold)) continue;
        worst.error = larger(worst.error, error);
        worst.seconds = larger(worst.seconds, timed * h / moved);
    }
    return worst;
}

/* May the pixel fire within the step, or have fired in the macro step before it, as far as is known? `low` and `high` bound
 * S_eff. */
static int may_fire_sensor(td_sensor *sensor, size_t i, int whole, double low, double high, double reference) {
    double on = sensor->threshold_on[i], off = sensor->threshold_off[i];
    if (sensor->frontend.on) return 1;
    int holds = sensor->sensor.refractory_law == TIDES_REFRACTORY_HOLD && sensor->refractory_ns > 0;
    if (on == off && !holds) return reaches_level(low, high, reference, on);
    if (whole) sensor->reach[i] = sensor->held_until[i] > -INFINITY;
    if (!(low > reference - off && high < reference + on)) sensor->reach[i] = 1;
    return sensor->reach[i];
}

td_estimate td_estimate_sensor(td_sensor *sensor, size_t first, int whole, double time, double h, const td_signals *signals,
                               const double *reference, int32_t count) {
    td_estimate worst = {0, 0};
    double swing = sensor->additive.on ? noise_swing * sensor->additive.sigma : 0;
    double nominal = smaller(sensor->sensor.threshold_on, sensor->sensor.threshold_off);
    for (int32_t k = 0; k < count; k++) {
        size_t i = first + (size_t)k;
        double S0 = signals->S0[k], S1 = signals->S1[k], rise = S1 - S0;
        double rate0 = h * signals->S0_dot[k], rate1 = h * signals->S1_dot[k];
        double error = bulge * fabs(rate1 + rate0 - 2 * rise);
        if (!(error >= 0)) continue; /* NaN */
        double ramp0 = sensor->leak[i] * time, ramp1 = ramp0 + sensor->leak[i] * h * 1e9;
        double a = S0 + rate0 / 3, b = S1 - rate1 / 3; /* the ramp lies between its ends: bounds need no more */
        double low = smaller(smaller(S0, S1), smaller(a, b)) - error + ramp0 - swing;
        double high = larger(larger(S0, S1), larger(a, b)) + error + ramp1 + swing;
        if (reference && !may_fire_sensor(sensor, i, whole, low, high, reference[k])) continue;
        double own = smaller(sensor->threshold_on[i], sensor->threshold_off[i]);
        double moved = larger(fabs(rise + (ramp1 - ramp0)), error), timed = larger(error - noise, 0);
        worst.error = larger(worst.error, error * nominal / own);
        if (moved > 0) worst.seconds = larger(worst.seconds, timed * h / moved);
    }
    return worst;
}

/* Pixels that would move by less than this share of a threshold in slow_s fire hardly ever. */
static const double least_move = 0.02;
static const int first_octave = -48; /* 2^-48 s: far below a nanosecond */

/* The bin of a time [s]: its exponent and the first bits of its mantissa, which is no logarithm's work. */
static int bin_of(double seconds) {
    enum { DOUBLE_BIAS = 1023, SHIFT = 52 - TD_TIMING_BITS };
    uint64_t bits;
    memcpy(&bits, &seconds, sizeof bits);
    int bin = (int)(bits >> SHIFT) - ((DOUBLE_BIAS + first_octave) << TD_TIMING_BITS);
    if (bin < 0) return 0;
    return bin < TD_TIMING_BINS ? bin : TD_TIMING_BINS - 1;
}

/* Where a bin ends [s]. */
static double end_of(int bin) {
    int octave = bin >> TD_TIMING_BITS, part = bin & ((1 << TD_TIMING_BITS) - 1);
    return ldexp(1 + (part + 1.0) / (1 << TD_TIMING_BITS), octave + first_octave);
}

void td_timing_add(td_timing *timing, const td_comparator *comparator, double h, const td_signals *signals, int32_t count) {
    double threshold = 0.5 * (comparator->threshold_on + comparator->threshold_off);
    double least = least_move * threshold * (timing->slow_s > h ? h / timing->slow_s : 1);
    for (int32_t i = 0; i < count; i++) {
        double rise = signals->S1[i] - signals->S0[i], moved = fabs(rise);
        if (!(moved > least)) continue;
        double error = bulge * fabs(h * (signals->S1_dot[i] + signals->S0_dot[i]) - 2 * rise) + timing->rounding;
        timing->weight[bin_of(error * h / larger(moved, error))] += moved / threshold;
    }
}

double td_timing_percentile(const td_timing *timing, double share) {
    double total = 0, passed = 0;
    for (int k = 0; k < TD_TIMING_BINS; k++) total += timing->weight[k];
    for (int k = 0; k < TD_TIMING_BINS && total > 0; k++) {
        passed += timing->weight[k];
        if (passed >= share * total) return k == 0 ? 0 : end_of(k);
    }
    return 0;
}
