/* Error bars of the values: each is measured again on halves of the time, of the image, and of pixels drawn by chance. Random
 * halves of n pixels scatter about the whole as whole samples do about the truth. */
#include "td_calibrate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HALVES = 12 };
/* Relative variance of thresholds from pixel to pixel where it isn't known: spreads of 0 to 15 % have this in the mean. */
#define SPREAD_VARIANCE 0.0075

/* The values of a fit, in the order of TIDES_CALIBRATED_*. Values that other parts measure aren't set. */
static void values_of(const td_fit *fit, double value[TIDES_CALIBRATED_VALUES]) {
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) value[i] = NAN;
    value[TIDES_CALIBRATED_ON] = fit->on;
    value[TIDES_CALIBRATED_OFF] = fit->off;
    value[TIDES_CALIBRATED_EPS] = fit->front.log_eps;
    value[TIDES_CALIBRATED_POLE] = fit->front.pole_s;
    value[TIDES_CALIBRATED_REFRACTORY] = fit->front.refractory_s;
    value[TIDES_CALIBRATED_OFFSET] = fit->front.offset_s;
}

static void of_part(td_calibration *c, const td_fit *whole, td_part part, double value[TIDES_CALIBRATED_VALUES]) {
    td_fit fit = *whole;
    part.width = c->taken.width;
    td_refine(&c->light, &c->pairs, &fit, c->free, c->longest_refractory_s, &part);
    values_of(&fit, value);
}

/* The column that has half of the light's pixels to its left. */
static double middle_column(const td_calibration *c) {
    const uint32_t width = (uint32_t)c->taken.width;
    size_t before = 0, column = 0;
    for (; column < width && 2 * before < c->light.count; column++)
        for (size_t i = 0; i < c->light.count; i++) before += c->light.pixel[i] % width == column;
    return (double)column;
}

static void halves(td_calibration *c, const td_fit *whole, tides_calibration *found) {
    const double half_s = 0.5e-9 * (double)(c->taken.stop_ns - c->taken.start_ns);
    const double column = middle_column(c);
    const double middle[] = {0, half_s, half_s, column, column};
    for (int32_t what = TD_EARLY; what <= TD_RIGHT; what++) {
        double value[TIDES_CALIBRATED_VALUES];
        of_part(c, whole, (td_part){.what = what, .middle = middle[what]}, value);
        for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) {
            tides_calibrated *v = &found->values[i];
            double *place[] = {NULL, &v->early, &v->late, &v->left, &v->right};
            *place[what] = value[i];
        }
    }
}

/* Pixels with low thresholds fire more often, so that a median over events is low by the relative variance of thresholds. The
 * unknown part of that variance is an error of the thresholds. */
static double spread_doubt(const td_calibration *c, const tides_calibration *found) {
    const tides_calibrated *sigma = &found->values[TIDES_CALIBRATED_SIGMA];
    const double mean = 0.5 * (c->raw.on + c->raw.off);
    if (sigma->state == TIDES_CALIBRATED_GIVEN) return 0;
    if (!(sigma->value == sigma->value) || !(mean > 0)) return SPREAD_VARIANCE;
    const double known = 2 * sigma->value * sigma->error, bound = sigma->value * sigma->value;
    return (sigma->state == TIDES_CALIBRATED_MEASURED ? known : fmin(bound, SPREAD_VARIANCE * mean * mean)) / (mean * mean);
}

static tides_status scatter(td_calibration *c, const td_fit *whole, tides_calibration *found, tides_error *error) {
    double centre[TIDES_CALIBRATED_VALUES], sum[TIDES_CALIBRATED_VALUES] = {0}, cross = 0;
    values_of(whole, centre);
    for (int32_t k = 0; k < HALVES; k++) {
        double value[TIDES_CALIBRATED_VALUES];
        of_part(c, whole, (td_part){.what = TD_RANDOM_HALF, .seed = c->options->seed + (uint64_t)k}, value);
        for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) sum[i] += (value[i] - centre[i]) * (value[i] - centre[i]);
        cross += (value[TIDES_CALIBRATED_ON] - centre[TIDES_CALIBRATED_ON]) *
                 (value[TIDES_CALIBRATED_EPS] - centre[TIDES_CALIBRATED_EPS]);
        tides_status status = td_calibrate_told(c, 0.85 + 0.15 * k / HALVES, "error bars", error);
        if (status != TIDES_OK) return status;
    }
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++)
        if (sum[i] == sum[i]) found->values[i].error = sqrt(sum[i] / HALVES);
    for (int32_t i = TIDES_CALIBRATED_ON; i <= TIDES_CALIBRATED_OFF; i++) {
        const double spread = centre[i] * spread_doubt(c, found), drawn = found->values[i].error;
        found->values[i].error = sqrt(drawn * drawn + spread * spread);
    }
    const double both = sqrt(sum[TIDES_CALIBRATED_ON] * sum[TIDES_CALIBRATED_EPS]);
    found->correlation = both > 0 ? cross / both : 0;
    return TIDES_OK;
}

/* The deviation as one parameter varies and the others stay. */
static void scan(td_calibration *c, const td_fit *whole, tides_calibration *found) {
    const double pole_to = 2 * whole->front.pole_s + 4e-3, eps_to = 2 * whole->front.log_eps + 0.02;
    for (int32_t i = 0; i < TIDES_CALIBRATION_SCAN; i++) {
        const double share = (double)i / (TIDES_CALIBRATION_SCAN - 1);
        td_front front = whole->front;
        td_fit fit;
        front.pole_s = found->pole_scan[i][0] = share * pole_to;
        td_try(&c->light, &c->pairs, &front, NULL, &fit);
        found->pole_scan[i][1] = fit.deviation;
        front = whole->front;
        front.log_eps = found->eps_scan[i][0] = fmax(share * eps_to, 1e-4);
        td_try(&c->light, &c->pairs, &front, NULL, &fit);
        found->eps_scan[i][1] = fit.deviation;
    }
}

tides_status td_doubt(td_calibration *c, tides_calibration *found, tides_error *error) {
    const td_fit whole = c->raw;
    halves(c, &whole, found);
    tides_status status = td_calibrate_told(c, 0.85, "error bars", error);
    if (status == TIDES_OK) status = scatter(c, &whole, found, error);
    if (status == TIDES_OK) scan(c, &whole, found);
    return status;
}
