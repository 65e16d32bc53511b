/* Finds pixels that may do something in a step, for the solver, which then takes them one at a time. */
#include "td_extremes.h"
#include "td_sensor.h"
#include "td_single.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>
#include <string.h>

tides_status td_sensor_shows_signal(const tides_sensor *params, int *shows, tides_error *error) {
    td_frontend frontend;
    td_additive_noise additive;
    tides_status status = td_sensor_check(params, error);
    if (status == TIDES_OK) status = td_frontend_make(params, &frontend, error);
    if (status == TIDES_OK) status = td_additive_noise_make(params, 0, &additive, error);
    if (status == TIDES_OK) status = td_kick_check(params, error);
    if (status == TIDES_OK)
        *shows = !frontend.on && !additive.on && params->kick == 0 && !(params->surround_lambda_px > 0) &&
                 !(params->psf_sigma_px > 0);
    return status;
}

/* 1 where the signal stays strictly between the levels, with an error of up to `widen`, else 0; NaN doesn't. `ramp` is the
 * leak's at the step's start, `rise` its change within it. One comparison at a time, so that loops vectorise. */
static inline double stays(const td_signals *at, double h, int32_t i, double ramp, double rise, double widen, double low,
                           double high) {
    const td_model model = td_model_fit(TIDES_MODEL_HERMITE, h, at->S0[i], at->S0_dot[i], at->S1[i], at->S1_dot[i]);
    const double *b = model.control, third = rise / 3;
    const double r0 = b[0] + ramp, r1 = b[1] + ramp + third, r2 = b[2] + ramp + 2 * third, r3 = b[3] + ramp + rise;
    const double slack = widen + 16 * DBL_EPSILON * (fabs(r0) + fabs(r3) + fabs(low) + fabs(high));
    double most = r0 > r1 ? r0 : r1, least = r0 < r1 ? r0 : r1;
    const double most_late = r2 > r3 ? r2 : r3, least_late = r2 < r3 ? r2 : r3;
    most = most > most_late ? most : most_late;
    least = least < least_late ? least : least_late;
    double still = most + slack < high ? 1.0 : 0.0;
    still = least - slack > low ? still : 0.0;
    still = r0 < high ? still : 0.0;
    still = r0 > low ? still : 0.0;
    still = r3 < high ? still : 0.0;
    return r3 > low ? still : 0.0;
}

enum { BLOCK = 64 }; /* pixels handled together */

/* The levels of ideal pixels: their references, and the thresholds, which all share. */
typedef struct ideal_levels {
    const double *reference;
    double on, off;
} ideal_levels;

/* Marks the ideal pixels from number `first` on whose signal stays between the levels. */
TD_WIDE static void find_still(const td_signals *signals, double h, int32_t first, int32_t count, const double *widen,
                               const ideal_levels *levels, double *restrict still) {
    const td_signals at = *signals;
    const double *reference = levels->reference, on = levels->on, off = levels->off;
    for (int32_t k = 0; k < count; k++) {
        const int32_t i = first + k;
        still[k] = stays(&at, h, i, 0, 0, widen[i], reference[i] - off, reference[i] + on);
    }
}

void td_sensor_find(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first, const td_signals *signals,
                    const double *widen, uint8_t *active) {
    const double *reference = sensor->pixels.reference + first, h = step->length_s;
    const ideal_levels levels = {reference, sensor->sensor.threshold_on, sensor->sensor.threshold_off};
    for (int32_t i = 0; i < tile->count && !sensor->on; i += BLOCK) {
        const int32_t count = tile->count - i < BLOCK ? tile->count - i : BLOCK;
        double still[BLOCK];
        find_still(signals, h, i, count, widen, &levels, still);
        for (int32_t k = 0; k < count; k++) active[i + k] = (uint8_t)(active[i + k] | !(still[k] > 0));
    }
    if (!sensor->on) return;
    const double start = td_sensor_time(sensor, step->start_ns, step->start_fraction);
    const double stop = (double)(step->stop_ns - sensor->start.ns) + 2; /* + 2: the stop is rounded down, and may be one less */
    for (int32_t i = 0; i < tile->count; i++) {
        const size_t k = first + (size_t)i;
        const double still = stays(signals, h, i, sensor->leak[k] * start, sensor->leak[k] * step->length_ns, widen[i],
                                   reference[i] - sensor->threshold_off[k], reference[i] + sensor->threshold_on[k]);
        active[i] |= (uint8_t) !(still > 0 && sensor->wake[k] > stop);
    }
}

/* Thresholds are counted from so many below the reference: numbers are then positive, and are rounded down by cutting off. No
 * log-luminance is farther away. */
static const double levels_below = 1 << 24;

/* 1 where a level may be within the signal's range, else 0. */
TD_WIDE static void find_reached(const td_signals *signals, double h, double per, int32_t first, int32_t count,
                                 const double *widen, const double *reference, double *restrict reached) {
    const td_signals at = *signals;
    const double slack = 0x1p-20; /* [thresholds] more than the rounding of numbers as large as levels_below */
    for (int32_t k = 0; k < count; k++) {
        const int32_t i = first + k;
        const double a = at.S0[i], d = at.S1[i], b = a + h / 3 * at.S0_dot[i], c = d - h / 3 * at.S1_dot[i];
        const double low = td_lesser(td_lesser(a, d), td_lesser(b, c)) - widen[i] - reference[i];
        const double high = td_greater(td_greater(a, d), td_greater(b, c)) + widen[i] - reference[i];
        const double from = low * per + levels_below - slack, to = high * per + levels_below + slack;
        double same = td_whole(from) == td_whole(to) ? 1.0 : 0.0;
        same = from > 0 ? same : 0.0; /* false for NaN */
        reached[k] = to < 2 * levels_below ? 1.0 - same : 1.0;
    }
}

void td_sensor_reaches(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                       const td_signals *signals, const double *widen, uint8_t *reaches) {
    const double threshold = sensor->sensor.threshold_on, per = 1 / threshold;
    if (sensor->on || threshold != sensor->sensor.threshold_off) {
        memset(reaches, 1, (size_t)tile->count);
        return;
    }
    for (int32_t i = 0; i < tile->count; i += BLOCK) {
        const int32_t count = tile->count - i < BLOCK ? tile->count - i : BLOCK;
        double reached[BLOCK];
        find_reached(signals, step->length_s, per, i, count, widen, sensor->pixels.reference + first, reached);
        for (int32_t k = 0; k < count; k++) reaches[i + k] = reached[k] > 0;
    }
}
