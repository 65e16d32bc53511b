/* Estimated errors of event times. */
#include "td_timing.h"
#include "td_estimate.h"
#include "td_probe.h"

#include <math.h>
#include <string.h>

static const int first_octave = -48; /* 2^-48 s: far below a nanosecond */

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

/* -- one event ----------------------------------------------------------------------------------------------------------- */

static double curvature(const td_model *model, double s) {
    const double *b = model->control;
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    return 6 * ((1 - s) * (d1 - d0) + s * (d2 - d1));
}

/* The signal is `error` beyond the level after v d + a d^2 / 2 = error, and was `error` short of it as long before. Where it
 * bends back, the one that lies that way may not exist: a touch, of which both crossings and all between them are within the
 * error. */
double td_timing_reach(double v, double a, double error, int *touches) {
    double bend = fabs(a);
    v = v > 0 ? v : 0;
    *touches = 0;
    if (!(bend > 0)) return v > error ? error / v : 1;
    double left = v * v - 2 * bend * error;
    double d = left >= 0 ? 2 * error / (v + sqrt(left)) : (v + sqrt(v * v + 2 * bend * error)) / bend;
    *touches = left < 0 && a < 0 && d < 1;
    return smaller(d, 1);
}

/* -- many ---------------------------------------------------------------------------------------------------------------- */

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

/* The cubic is right at both ends of the step: 16 s^2 (1 - s)^2 is how its error lies between them where the signal is smooth;
 * not all are. */
static const double least_share = 0.2;

static double share_at(double s) {
    double bow = 4 * s * (1 - s);
    return least_share + (1 - least_share) * bow * bow;
}

/* Of S at `s`: the model's, and rounding. */
static double error_of(const td_timing *timing, const td_timed *timed, int32_t i, double s) {
    const td_signals *at = timed->signals;
    double h = timed->step->length_s, error = timed->left;
    if (timed->deviation)
        error *= timed->deviation[i];
    else
        error = td_embedded(at->S1[i] - at->S0[i], h * at->S0_dot[i], h * at->S1_dot[i]);
    return hypot(error * share_at(s), timing->rounding);
}

static double place_of(const td_step *step, int64_t t) {
    double s = ((double)(t - step->start_ns) + 0.5 - step->start_fraction) / step->length_ns;
    return s > 0 ? smaller(s, 1) : 0;
}

static td_model model_of(const td_timed *timed, int32_t i) {
    const td_signals *at = timed->signals;
    return td_model_fit(TIDES_MODEL_HERMITE, timed->step->length_s, at->S0[i], at->S0_dot[i], at->S1[i], at->S1_dot[i]);
}

static int32_t pixel_of(const td_tile *tile, const tides_event *event) {
    return (event->y - tile->y0) * tile->width + (event->x - tile->x0);
}

/* What the leak has added to the signal at `s`, and adds per step. */
static double ramp_at(const td_timed *timed, int32_t i, double s) {
    const td_levels *levels = &timed->levels;
    return levels->leak ? levels->leak[i] * (levels->time + s * timed->step->length_ns) : 0;
}

/* The pixel's reference at `s`: what it is now, without what fired since. */
static double reference_at(const td_timed *timed, int32_t i, double s) {
    const td_levels *levels = &timed->levels;
    double reference = levels->reference[i];
    for (size_t k = timed->count; k-- > 0;) {
        const tides_event *event = &timed->events[k];
        if (pixel_of(timed->tile, event) != i || place_of(timed->step, event->t) <= s) continue;
        reference +=
            event->polarity > 0 ? -levels->threshold_on[i * levels->stride] : levels->threshold_off[i * levels->stride];
    }
    return reference;
}

/* Slope and curvature of the signal where the event fired, per step. Behind a first-order low-pass S' = rate (L - S), and S is
 * on the level that the event took the reference to; behind the circuit those of L stand in for them. */
static void turn_of(const td_timed *timed, const td_model *model, int32_t i, double s, double *slope, double *bend) {
    double L_dot = td_model_slope(model, s);
    *slope = L_dot;
    *bend = curvature(model, s);
    const td_frontend *frontend = timed->frontend;
    if (!frontend || !frontend->on || frontend->kind == TD_FRONTEND_CIRCUIT) return;
    double L = td_model_value(model, s), rate = frontend->rate * timed->step->length_s;
    if (frontend->kind == TD_FRONTEND_INTENSITY) rate *= frontend->light * larger(exp(L) - timed->log_eps, 0) + frontend->dark;
    *slope = rate * (L - (reference_at(timed, i, s) - ramp_at(timed, i, s)));
    *bend = rate * (L_dot - *slope);
}

void td_timing_add(td_timing *timing, const td_timed *timed) {
    for (size_t k = 0; k < timed->count; k++) {
        const tides_event *event = &timed->events[k];
        const int32_t i = pixel_of(timed->tile, event);
        const td_model model = model_of(timed, i);
        const double s = place_of(timed->step, event->t);
        double slope, bend;
        int touches;
        turn_of(timed, &model, i, s, &slope, &bend);
        slope += ramp_at(timed, i, 1) - ramp_at(timed, i, 0);
        double reach =
            td_timing_reach(event->polarity * slope, event->polarity * bend, error_of(timing, timed, i, s), &touches);
        timing->uncertain += (uint64_t)touches;
        timing->weight[bin_of(reach * timed->step->length_s + 1e-9)] += 1; /* times are floored to nanoseconds */
    }
}

/* -- events that might have been ----------------------------------------------------------------------------------------- */

void td_timing_add_turns(td_timing *timing, const td_timed *timed) {
    const td_levels *levels = &timed->levels;
    if (timed->frontend && timed->frontend->on) return; /* the model is of L, not of S */
    for (int32_t i = 0; i < timed->tile->count; i++) {
        const td_model model = model_of(timed, i);
        const double *b = model.control;
        int rises = b[1] > b[0] || b[2] > b[1] || b[3] > b[2], falls = b[1] < b[0] || b[2] < b[1] || b[3] < b[2];
        if (!(rises && falls)) continue;
        double turn[2];
        for (int k = td_model_extrema(&model, turn); k-- > 0;) {
            double residual = td_model_value(&model, turn[k]) + ramp_at(timed, i, turn[k]) - reference_at(timed, i, turn[k]);
            int is_top = curvature(&model, turn[k]) < 0;
            double left = is_top ? levels->threshold_on[i * levels->stride] - residual
                                 : residual + levels->threshold_off[i * levels->stride];
            timing->uncertain += (uint64_t)(left > 0 && left < error_of(timing, timed, i, turn[k]));
        }
    }
}

double td_timing_percentile(const td_timing *timing, double share) {
    double total = 0, passed = 0;
    for (int k = 0; k < TD_TIMING_BINS; k++) total += timing->weight[k];
    if (total > 0) share = smaller(share + 0.5 * sqrt(share * (1 - share) / total), 1);
    for (int k = 0; k < TD_TIMING_BINS && total > 0; k++) {
        double weight = timing->weight[k];
        if (weight > 0 && passed + weight >= share * total) {
            double begin = k == 0 ? 0 : end_of(k - 1), part = (share * total - passed) / weight;
            return begin + (end_of(k) - begin) * (part > 0 ? part : 0);
        }
        passed += weight;
    }
    return 0;
}
