/* Estimated errors of event times, event by event. The simulator reports them (error_p50_s and so on) and counts uncertain
 * events. Errors of S come from probes and from the embedded estimate (signal/td_model_error.h). These estimates change no step
 * and no event. */
#include "solver/td_timing.h"
#include "render/td_render.h"
#include "sensor/td_between.h"
#include "signal/td_model_error.h"
#include "td_extremes.h"
#include "td_exponential.h"
#include "solver/td_probe.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const int first_octave = -48; /* 2^-48 s = 3.6 fs */

/* -- one event ----------------------------------------------------------------------------------------------------------- */

/* The signal is `error` beyond the level at the d that solves v d + a d^2 / 2 = error, and was `error` short of it as long
 * before. Where it bends back, one of these may not exist: the crossing is then a touch, and both crossings and all times
 * between are within the error. Written with one comparison at a time, one root and one division, so that loops vectorise. */
static inline double reach_of(double v, double a, double error, double *touches) {
    const double bend = fabs(a), forwards = v > 0 ? v : 0, left = forwards * forwards - 2 * bend * error;
    const double root = sqrt(left >= 0 ? left : forwards * forwards + 2 * bend * error);
    double above = left >= 0 ? 2 * error : forwards + root, below = left >= 0 ? forwards + root : bend;
    above = bend > 0 ? above : error;
    below = bend > 0 ? below : forwards;
    const double passed = above / below, straight = forwards > error ? passed : 1, d = bend > 0 ? passed : straight;
    double touch = left < 0 ? 1.0 : 0.0;
    touch = a < 0 ? touch : 0.0;
    *touches = d < 1 ? touch : 0.0;
    return td_lesser(d, 1);
}

double td_timing_reach(double v, double a, double error, int *touches) {
    double touch;
    const double reach = reach_of(v, a, error, &touch);
    *touches = touch > 0;
    return reach;
}

/* -- many ---------------------------------------------------------------------------------------------------------------- */

/* The bin of a time [s]: its exponent and the first bits of its mantissa, without a logarithm. */
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

/* Least share of the middle's error that is assumed at any s of the step. The cubic is right at both ends, in value and slope,
 * and a smooth signal's error lies between as 16 s^2 (1 - s)^2. A kink's error falls to 0 only near the ends. */
static const double least_share = 0.05;

static inline double share_of(int is_smooth, double s) {
    const double bow = 4 * s * (1 - s);
    return least_share + (1 - least_share) * (is_smooth ? bow * bow : bow);
}

static double share_at(const td_probe_law *law, double s) { return share_of(law->is_smooth, s); }

/* The largest difference of pixel i, which is in column x of the tile, from a neighbour within the tile, along x and along y
 * [log units/px]. */
static inline void differences(const td_tile *tile, const double *S, int32_t i, int32_t x, double *along, double *across) {
    *along = *across = 0;
    if (x > 0) *along = fabs(S[i] - S[i - 1]);
    if (x + 1 < tile->width) *along = td_greater(*along, fabs(S[i + 1] - S[i]));
    if (i >= tile->width) *across = fabs(S[i] - S[i - tile->width]);
    if (i + tile->width < tile->count) *across = td_greater(*across, fabs(S[i + tile->width] - S[i]));
}

/* Rounding of S: two units of the sums and of the logarithm, and the change of S where splats' places on the screen are rounded
 * at the size of the image. Against the double reference, over pixels of 45 random scenes (grazing_world.h) at 20, 80 and 320
 * px: the median error is 0.19 times this, 95 % are below 0.66 times, 99 % below 1.0 times, at each size. */
static inline double rounding_at(const td_timing *timing, double S, double along, double across) {
    return timing->epsilon * (2 * (1 + fabs(S)) + timing->size * sqrt(along * along + across * across));
}

double td_timing_rounding(const td_timing *timing, const td_tile *tile, const double *S, int32_t i) {
    if (!(timing->epsilon > 0)) return 0;
    double along, across;
    differences(tile, S, i, i % tile->width, &along, &across);
    return rounding_at(timing, S[i], along, across);
}

static double rounding_of(const td_timing *timing, const td_timed *timed, int32_t i) {
    return td_timing_rounding(timing, timed->tile, timed->signals->S1, i);
}

/* Error of S in the middle of the step. Without a probe the embedded estimate stands for it. */
static inline double deviation_of(const td_timed *timed, int32_t i) {
    const td_signals *at = timed->signals;
    double h = timed->step->length_s;
    if (timed->deviation) return timed->adds * timed->deviation[i];
    return timed->adds * td_embedded(at->S1[i] - at->S0[i], h * at->S0_dot[i], h * at->S1_dot[i]);
}

static inline td_probe_law law_of(const td_timed *timed, int32_t i) {
    static const td_probe_law embedded = {1, {1, 1, 1}, {1, 0, 0}};
    return timed->deviation ? td_probe_left(timed->fall[i]) : embedded;
}

/* Place in the step of an event that is `passed` whole nanoseconds after the step's start. */
static inline double place_after(const td_step *step, double passed) {
    const double s = (passed + 0.5 - step->start_fraction) / step->length_ns, within = td_lesser(s, 1);
    return s > 0 ? within : 0;
}

static double place_of(const td_step *step, int64_t t) { return place_after(step, (double)(t - step->start_ns)); }

static td_model model_of(const td_timed *timed, int32_t i) {
    const td_signals *at = timed->signals;
    return td_model_fit(TIDES_MODEL_HERMITE, timed->step->length_s, at->S0[i], at->S0_dot[i], at->S1[i], at->S1_dot[i]);
}

static int32_t pixel_of(const td_tile *tile, const tides_event *event) {
    return (event->y - tile->y0) * tile->width + (event->x - tile->x0);
}

/* The leak's ramp at `s`, which is added to the signal. */
static double ramp_at(const td_timed *timed, int32_t i, double s) {
    const td_levels *levels = &timed->levels;
    return levels->leak ? levels->leak[i] * (levels->time + s * timed->step->length_ns) : 0;
}

/* The pixel's reference at `s`: the present one, less events of this step that fired after `s`. */
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

/* Up to EVENTS events of a step: what is read for each, the signal there, its error, and the error of time. */
enum { EVENTS = 64 };
typedef struct some {
    int count;
    int32_t pixel[EVENTS];
    double passed[EVENTS]; /* whole nanoseconds since the step's start */
    double S0[EVENTS], S0_dot[EVENTS], S1[EVENTS], S1_dot[EVENTS];
    double polarity[EVENTS], rise[EVENTS]; /* rise of the leak's ramp per step */
    td_slope own[EVENTS];                  /* slopes that the comparator knows, with the ramp's; NaN: it doesn't */
    double deviation[EVENTS], is_smooth[EVENTS], along[EVENTS], across[EVENTS];
    double s[EVENTS], slope[EVENTS], bend[EVENTS], middle[EVENTS], rounding[EVENTS]; /* slope and curvature per step */
    double share[TD_PROBE_SHARES][EVENTS], weight[TD_PROBE_SHARES][EVENTS];          /* of the probe's law */
    double reach[TD_PROBE_SHARES][EVENTS], touches[TD_PROBE_SHARES][EVENTS];         /* one for each share */
} some;

static void read_event(const td_timed *timed, const tides_event *event, int n, some *to) {
    const int32_t i = pixel_of(timed->tile, event);
    const td_signals *at = timed->signals;
    const td_probe_law law = law_of(timed, i);
    to->pixel[n] = i;
    to->passed[n] = (double)(event->t - timed->step->start_ns);
    to->S0[n] = at->S0[i];
    to->S0_dot[n] = at->S0_dot[i];
    to->S1[n] = at->S1[i];
    to->S1_dot[n] = at->S1_dot[i];
    to->polarity[n] = event->polarity;
    to->rise[n] = ramp_at(timed, i, 1) - ramp_at(timed, i, 0);
    to->own[n] = timed->slopes ? timed->slopes[event - timed->events] : (td_slope){NAN, NAN};
    to->deviation[n] = deviation_of(timed, i);
    to->is_smooth[n] = law.is_smooth;
    differences(timed->tile, at->S1, i, event->x - timed->tile->x0, &to->along[n], &to->across[n]);
    for (int k = 0; k < TD_PROBE_SHARES; k++) {
        to->share[k][n] = law.share[k];
        to->weight[k][n] = law.weight[k];
    }
}

/* Slope, curvature and error of the signal within the step, for each event. */
TD_WIDE static void find_turns(const td_timing *timing, const td_timed *timed, some *restrict of) {
    const td_step step = *timed->step;
    const td_timing known = {.epsilon = timing->epsilon, .size = timing->size};
    const int count = td_whole_vectors(of->count);
    for (int n = 0; n < count; n++) {
        const td_model model =
            td_model_fit(TIDES_MODEL_HERMITE, step.length_s, of->S0[n], of->S0_dot[n], of->S1[n], of->S1_dot[n]);
        const double s = place_after(&step, of->passed[n]);
        of->s[n] = s;
        of->slope[n] = td_model_slope(&model, s);
        of->bend[n] = td_model_curvature(&model, s);
        of->middle[n] = of->deviation[n] * share_of(of->is_smooth[n] > 0, s);
        of->rounding[n] = rounding_at(&known, of->S1[n], of->along[n], of->across[n]);
    }
}

/* -- behind a first-order low-pass ---------------------------------------------------------------------------------------- */

/* S' = rate (L - S) also takes in errors of L. S has two errors with independent signs, which add as squares: the part of this
 * step's error that has come through so far, and the rest of earlier steps' errors. */

/* The integral from 0 to s of the error's shape, which is 1 in the middle. A kink in the middle has the shape (1 - |2 s - 1|)^2
 * with the integral 1/3. Kinks are anywhere in the step, so that the shape here is a parabola of that integral. */
static inline double bow_until(int is_smooth, double s) {
    return is_smooth ? 16 * s * s * s * (1.0 / 3 - s * (0.5 - 0.2 * s)) : 2 * s * s * (0.5 - s * (1.0 / 3));
}

/* The part of an error, 1 in the middle, that has come through by s in a step of `rate`. S is an average over what came last:
 * of what came more than `memory` time constants before, e^-memory is left. */
static inline double passed_until(int is_smooth, double rate, double s) {
    const double memory = 3, from = rate * s > memory ? s - memory / rate : 0;
    const double nearest = s < 0.5 ? s : td_greater(from, 0.5); /* to the middle */
    return td_lesser(rate * bow_until(is_smooth, s), share_of(is_smooth, nearest));
}

/* The rounding of S over that of L. Roundings of a step's ends are independent of earlier ones, and the filter averages them
 * over its time constant: rate^2 times the sum of e^(-2 rate k). */
static inline double averaged(double rate) { return sqrt(td_lesser(0.5 * rate, 1)); }

/* The filter's rate in a step, where the light is L. */
static inline double rate_at(const td_timed *timed, double L) {
    const td_frontend *frontend = timed->frontend;
    const double rate = frontend->rate * timed->step->length_s;
    if (frontend->kind != TD_FRONTEND_INTENSITY) return rate;
    return rate * (frontend->light * td_greater(td_exponential(L) - timed->log_eps, 0) + frontend->dark);
}

/* At an event S is at the level that became the reference. Where a hold ends later, S is the reference at that time. */
static void filter_turn(const td_timed *timed, int n, some *of) {
    /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): set for each of the of->count events */
    const int32_t i = of->pixel[n];
    const td_model model = model_of(timed, i);
    const int known = !isnan(of->own[n].signal);
    const double s = of->s[n], later = s + timed->held, at = later <= 1 && !known ? later : s;
    const double L = td_model_value(&model, at), rate = rate_at(timed, L);
    of->slope[n] =
        known ? (double)of->own[n].light - of->rise[n] : rate * (L - (reference_at(timed, i, s) - ramp_at(timed, i, at)));
    of->bend[n] = rate * (td_model_slope(&model, at) - of->slope[n]);
    of->middle[n] = of->deviation[n] * passed_until(of->is_smooth[n] > 0, rate, s);
    of->rounding[n] =
        td_timing_together(of->rounding[n] * averaged(rate), timed->adds * timed->filter_error[i] * td_exponential(-rate * s));
}

/* Carries the filter's errors to the step's end. It uses the law's most probable share, since the carried error is a sum over
 * many steps. */
static void carry_errors(const td_timed *timed) {
    for (int32_t i = 0; i < timed->tile->count; i++) {
        const td_probe_law law = law_of(timed, i);
        const double rate = rate_at(timed, timed->signals->S1[i]), error = deviation_of(timed, i) / timed->adds;
        const double fresh = law.share[0] * error * passed_until(law.is_smooth, rate, 1);
        const double sum = td_timing_together(timed->filter_error[i] * td_exponential(-rate), fresh);
        timed->filter_error[i] = sum >= 0 ? sum : 0; /* statistics count NaN elsewhere */
    }
}

/* Light and noise cross a level together, and the noise is the steeper by far. An error of the light moves the crossing by what
 * their common slope makes of it. */
static void add_noise(some *of) {
    for (int n = 0; n < of->count; n++)
        if (!isnan(of->own[n].signal)) of->slope[n] = (double)of->own[n].signal - of->rise[n];
}

TD_WIDE static void find_reaches(some *restrict of) {
    const int count = td_whole_vectors(of->count);
    for (int k = 0; k < TD_PROBE_SHARES; k++) {
        const double *shares = of->share[k];
        double *restrict reach = of->reach[k], *restrict touches = of->touches[k];
        for (int n = 0; n < count; n++) {
            double touch;
            const double slope = of->polarity[n] * (of->slope[n] + of->rise[n]), bend = of->polarity[n] * of->bend[n];
            reach[n] = reach_of(slope, bend, td_timing_together(shares[n] * of->middle[n], of->rounding[n]), &touch);
            touches[n] = touch;
        }
    }
}

static void add_some(td_timing *timing, const td_timed *timed, const some *of) {
    for (int n = 0; n < of->count; n++) {
        int touches = 0;
        /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): whole vectors are written */
        for (int k = 0; k < TD_PROBE_SHARES && of->weight[k][n] > 0; k++) {
            const double reach = of->reach[k][n];
            const int may_touch = of->touches[k][n] > 0 || (timed->is_last && of->s[n] + reach >= 1);
            timing->weight[bin_of(reach * timed->step->length_s + 1e-9)] +=
                of->weight[k][n]; /* times are floored to nanoseconds */
            touches |= may_touch && (k == 0 || of->share[k][n] <= TD_PROBE_LEFT_MOST);
        }
        timing->uncertain += (uint64_t)touches;
    }
}

void td_timing_add_solved(td_timing *timing, double stands_for, double error, double slope, double bend, double h) {
    int touches;
    timing->weight[bin_of(td_timing_reach(slope, bend, error, &touches) * h + 1e-9)] += stands_for; /* floored to nanoseconds */
    timing->measured++;
}

void td_timing_add(td_timing *timing, const td_timed *timed) {
    const int filters = timed->filter_error != NULL;
    some taken; /* large: only members that are used are set */
    for (size_t begin = 0; begin < timed->count; begin += EVENTS) {
        const size_t left = timed->count - begin;
        taken.count = left < EVENTS ? (int)left : EVENTS;
        for (int n = 0; n < td_whole_vectors(taken.count); n++) /* repeats the last event in a whole vector */
            read_event(timed, &timed->events[begin + (size_t)(n < taken.count ? n : taken.count - 1)], n, &taken);
        find_turns(timing, timed, &taken);
        for (int n = 0; n < taken.count && filters; n++) filter_turn(timed, n, &taken);
        if (timed->slopes) add_noise(&taken);
        find_reaches(&taken);
        add_some(timing, timed, &taken);
    }
    if (filters) carry_errors(timed);
}

/* -- events that might have been ----------------------------------------------------------------------------------------- */

/* A bound that the error of S at s rarely exceeds. */
static double most_error(const td_timing *timing, const td_timed *timed, int32_t i, double s) {
    const td_probe_law law = law_of(timed, i);
    const double share = timed->deviation ? TD_PROBE_LEFT_MOST : 1;
    return td_timing_together(share * deviation_of(timed, i) * share_at(&law, s), rounding_of(timing, timed, i));
}

/* An upper bound of the rounding of S, in single and in double precision, over the tile's pixels; from the largest difference
 * between any two. */
TD_WIDE static double most_rounding(const td_timing *timing, const double *S, int32_t pixels) {
    enum { LANES = 16 };
    double low[LANES], high[LANES];
    for (int k = 0; k < LANES; k++) low[k] = high[k] = S[0];
    for (int32_t first = 0; first < pixels; first += LANES) {
        const int count = pixels - first < LANES ? pixels - first : LANES;
        for (int k = 0; k < count; k++) {
            low[k] = td_lesser(S[first + k], low[k]);
            high[k] = td_greater(S[first + k], high[k]);
        }
    }
    for (int k = 1; k < LANES; k++) {
        low[0] = td_lesser(low[k], low[0]);
        high[0] = td_greater(high[k], high[0]);
    }
    const double size = 1 + td_greater(fabs(low[0]), fabs(high[0])), epsilon = timing->epsilon;
    return epsilon * (2 * size + 1.5 * timing->size * (high[0] - low[0])) +
           2 * TD_DOUBLE_ROUNDING * size; /* 1.5: at least root 2, for both directions */
}

/* Marks of pixels: 1 for those that are looked at one by one, else 0. */
typedef struct marks {
    double fired[TD_TILE_PIXELS]; /* 1: the reference has changed within the step */
    double turns[TD_TILE_PIXELS], ends[TD_TILE_PIXELS];
} marks;

/* Marks the pixels whose control values rise and fall and come so near a level that an error may decide whether it is reached,
 * and those that end so near one. Margins are `rounding`, twice the other errors, and the rounding of this test. Marks are
 * doubles, with one comparison at a time, so that the loop vectorises. */
static inline void mark(int own, const td_timed *timed, double rounding, const double *leak, marks *restrict to) {
    const td_signals at = *timed->signals;
    const td_levels levels = timed->levels;
    const double h = timed->step->length_s, length = timed->step->length_ns, adds = timed->adds;
    const double same_on = levels.threshold_on[0], same_off = levels.threshold_off[0];
    const double *deviation = timed->deviation;
    for (int32_t k = 0; k < timed->tile->count; k++) {
        const td_model model = td_model_fit(TIDES_MODEL_HERMITE, h, at.S0[k], at.S0_dot[k], at.S1[k], at.S1_dot[k]);
        const double *b = model.control, ramp = own ? leak[k] * levels.time : 0, rise = own ? leak[k] * length : 0;
        const double on = own ? levels.threshold_on[k] : same_on, off = own ? levels.threshold_off[k] : same_off;
        const double first = b[1] - b[0], second = b[2] - b[1], last = b[3] - b[2], reference = levels.reference[k] - ramp;
        const double most = td_greater(td_greater(first, second), last), least = td_lesser(td_lesser(first, second), last);
        const double low = td_least4(b) + td_lesser(rise, 0);
        const double high = td_most4(b) + td_greater(rise, 0);
        const double bump = deviation ? TD_PROBE_LEFT_MOST * deviation[k]
                                      : td_embedded(at.S1[k] - at.S0[k], h * at.S0_dot[k], h * at.S1_dot[k]);
        const double lost = 64 * DBL_EPSILON * (fabs(low) + fabs(high) + fabs(reference)) + rounding;
        const double error = adds * bump + lost, residual = at.S1[k] + rise - reference;
        double near = on - (high - reference) > error ? to->fired[k] : 1.0;
        near = low - reference + off > error ? near : 1.0;
        near = most > 0.0 ? near : 0.0;
        to->turns[k] = least < 0.0 ? near : 0.0;
        const double end = on - residual > lost ? 0.0 : 1.0;
        to->ends[k] = residual + off > lost ? end : 1.0;
    }
}

TD_WIDE static void mark_all(const td_timed *timed, double rounding, marks *to) {
    static const double none[TD_TILE_PIXELS] = {0};
    const double *leak = timed->levels.leak ? timed->levels.leak : none;
    if (timed->levels.stride)
        mark(1, timed, rounding, leak, to);
    else
        mark(0, timed, rounding, leak, to);
}

/* Counts the turns of pixel i at which an error decides whether a level is reached. */
static void add_turns(td_timing *timing, const td_timed *timed, int32_t i) {
    const td_levels *levels = &timed->levels;
    const td_model model = model_of(timed, i);
    double turn[2];
    for (int k = td_model_extrema(&model, turn); k-- > 0;) {
        double residual = td_model_value(&model, turn[k]) + ramp_at(timed, i, turn[k]) - reference_at(timed, i, turn[k]);
        int is_top = td_model_curvature(&model, turn[k]) < 0;
        double left =
            is_top ? levels->threshold_on[i * levels->stride] - residual : residual + levels->threshold_off[i * levels->stride];
        timing->uncertain += (uint64_t)(left > 0 && left < most_error(timing, timed, i, turn[k]));
    }
}

/* Counts a signal that ends the run so near a level that its error decides. The error there is rounding alone. */
static void add_end(td_timing *timing, const td_timed *timed, int32_t i) {
    const td_levels *levels = &timed->levels;
    const double S = timed->signals->S1[i], residual = S + ramp_at(timed, i, 1) - levels->reference[i];
    const double left =
        td_lesser(levels->threshold_on[i * levels->stride] - residual, residual + levels->threshold_off[i * levels->stride]);
    const double error = td_greater(rounding_of(timing, timed, i), TD_DOUBLE_ROUNDING * (1 + fabs(S)));
    timing->uncertain += (uint64_t)(left > 0 && left < error);
}

void td_timing_add_turns(td_timing *timing, const td_timed *timed) {
    if (timed->frontend && timed->frontend->on) return; /* the model is of L, not of S */
    const size_t pixels = (size_t)timed->tile->count;
    marks marked; /* large: only members that are used are set */
    memset(marked.fired, 0, pixels * sizeof *marked.fired);
    for (size_t k = 0; k < timed->count; k++) marked.fired[pixel_of(timed->tile, &timed->events[k])] = 1;
    mark_all(timed, most_rounding(timing, timed->signals->S1, timed->tile->count), &marked);
    for (size_t k = 0; (k = td_next_mark(marked.turns, k, pixels)) < pixels; k++) add_turns(timing, timed, (int32_t)k);
    if (!timed->is_last) return;
    for (size_t k = 0; (k = td_next_mark(marked.ends, k, pixels)) < pixels; k++) add_end(timing, timed, (int32_t)k);
}

/* Margins in standard errors of a share: as many as keep percentiles of few events from being too small. For estimates of all
 * events: with 0.5 p99 was too small in 1 of 200 scenes. A measured sample has no other reserve: with 0.75 one of three
 * percentiles was too small in 2 of 54 scenes of tests/oracle. With 2.5 none was in 40 samples of each of 164 scenes. */
static const double margin = 0.75, margin_of_sample = 2.5;

double td_timing_events(const td_timing *timing) {
    double total = 0;
    for (int k = 0; k < TD_TIMING_BINS; k++) total += timing->weight[k];
    return total;
}

/* The margin of a share among `total` events. Measured events stand for different numbers of others. They count as no more than
 * TD_TIMING_SAMPLE: the tail's events may all be of steps whose measured ones stand for most. Where all events are measured,
 * nothing is left to chance. */
static double margin_at(const td_timing *timing, double share, double total) {
    const double spread = share * (1 - share);
    if (!(timing->measured > 0)) return margin * sqrt(spread / total);
    return margin_of_sample * sqrt(spread * td_greater(1 / td_lesser(timing->measured, TD_TIMING_SAMPLE) - 1 / total, 0));
}

/* Within a bin, estimates are taken to lie evenly; of measured events it is the bin's end. */
double td_timing_percentile(const td_timing *timing, double share) {
    const double total = td_timing_events(timing);
    double passed = 0;
    if (total > 0) share = td_lesser(share + margin_at(timing, share, total), 1);
    for (int k = 0; k < TD_TIMING_BINS && total > 0; k++) {
        double weight = timing->weight[k];
        if (weight > 0 && passed + weight >= share * total) {
            double begin = k == 0 ? 0 : end_of(k - 1), part = timing->measured > 0 ? 1 : (share * total - passed) / weight;
            return begin + (end_of(k) - begin) * (part > 0 ? part : 0);
        }
        passed += weight;
    }
    return 0;
}
