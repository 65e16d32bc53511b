/* Error bars of the values: their scatter over the image (scatter.c), what isn't known of the spread between pixels, and, where
 * light comes from frames, what it does between them. Values of halves of the time and of the image are beside them. */
#include "td_calibrate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW_FRAMES = 5 /* of which three stay where every other one is left out */ };

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

static int32_t is_fitted(int32_t i) {
    return i != TIDES_CALIBRATED_SIGMA && i != TIDES_CALIBRATED_LEAK && i != TIDES_CALIBRATED_SHOT;
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
    const double half_s = td_half_s(&c->taken);
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

static void add_error(tides_calibrated *v, double more) {
    if (more == more) v->error = sqrt(v->error * v->error + more * more);
}

/* Simulations that the bias was taken from scatter as the recording does. Pixels with low thresholds fire more often, so that a
 * median over events is low by the relative variance of thresholds: its doubt is an error of the thresholds. */
static tides_status scatter(td_calibration *c, const td_fit *whole, tides_calibration *found, tides_error *error) {
    double one[TIDES_CALIBRATED_VALUES];
    const double times = sqrt(1 + (c->rounds ? 1.0 / c->rounds : 0));
    tides_status status = td_scatter(c, whole, one, &found->correlation, error);
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES && status == TIDES_OK; i++)
        if (is_fitted(i)) found->values[i].error = times * one[i];
    double doubt;
    td_spread_used(c, &doubt);
    add_error(&found->values[TIDES_CALIBRATED_ON], whole->on * doubt);
    add_error(&found->values[TIDES_CALIBRATED_OFF], whole->off * doubt);
    return status;
}

/* -- light between frames -------------------------------------------------------------------------------------------------- */

/* The values by another light that the same frames allow: what it changes counts as an error. */
static tides_status by_other_light(td_calibration *c, const td_fit *whole, int32_t every, int32_t how, tides_calibration *found,
                                   tides_error *error) {
    td_light other;
    td_fit fit = *whole;
    double now[TIDES_CALIBRATED_VALUES], then[TIDES_CALIBRATED_VALUES];
    const tides_status status = td_light_between(&c->light, every, how, &other, error);
    const double clip = c->pairs.clip, scattered = c->scattered;
    if (status == TIDES_OK) {
        for (int32_t i = 0; i < 2; i++) td_come_closer(c, &other, &fit);
        td_changes(&other, &c->pairs, &fit.front, NULL);
        const td_variance spread = td_spread_of(&other, &c->pairs, &fit, &c->taken);
        values_of(whole, now);
        values_of(&fit, then);
        now[TIDES_CALIBRATED_SIGMA] = found->values[TIDES_CALIBRATED_SIGMA].raw;
        if (spread.known) then[TIDES_CALIBRATED_SIGMA] = sqrt(fmax(spread.value, 0));
        for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) add_error(&found->values[i], then[i] - now[i]);
    }
    c->pairs.clip = clip;
    c->scattered = scattered;
    other.pixel = NULL;
    td_light_free(&other);
    return status;
}

/* The step between the two darkest code values of the frames; 0 where there is one value alone. */
static double dark_step(const td_light *light) {
    float least = INFINITY, next = INFINITY;
    for (size_t i = 0; i < light->count * light->samples; i++)
        if (i % light->samples % (size_t)light->finer == 0) least = fminf(least, light->Y[i]);
    for (size_t i = 0; i < light->count * light->samples; i++)
        if (i % light->samples % (size_t)light->finer == 0 && light->Y[i] > least) next = fminf(next, light->Y[i]);
    return isfinite(next) ? (double)next - (double)least : 0;
}

/* Wrong light between two frames is wrong for all pixels alike, and no halves of them tell. So the values are measured three
 * times more: with straight lines between the frames, with every other frame left out, and blurred, since exposures blur
 * edges, and a frame that is left out has the others' exposure. Dark light is known to half a code value, and what it is off
 * by goes to the black level. */
static tides_status between_frames(td_calibration *c, const td_fit *whole, tides_calibration *found, tides_error *error) {
    const size_t frames = (c->light.samples - 1) / (size_t)c->light.finer + 1;
    if (!c->facts.frames) return TIDES_OK;
    add_error(&found->values[TIDES_CALIBRATED_EPS], 0.5 * dark_step(&c->light));
    tides_status status = by_other_light(c, whole, 1, TD_LINES, found, error);
    if (status == TIDES_OK) status = by_other_light(c, whole, 1, TD_BLURRED, found, error);
    return status == TIDES_OK && frames >= FEW_FRAMES ? by_other_light(c, whole, 2, TD_CUBICS, found, error) : status;
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
    if (status == TIDES_OK) status = td_calibrate_told(c, 0.9, "error bars", error);
    if (status == TIDES_OK) status = between_frames(c, &whole, found, error);
    if (status == TIDES_OK) scan(c, &whole, found);
    return status;
}
