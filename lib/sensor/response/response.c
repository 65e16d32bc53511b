/* A pixel's signal on a step: its value, its bounds, and where it crosses a level. */
#include "td_response.h"
#include "td_extremes.h"
#include "td_modes.h"
#include "td_substeps.h"

#include <float.h>
#include <math.h>

/* -- values -------------------------------------------------------------------------------------------------------------- */

static double direct_value(const td_response *response, double s) {
    double value = td_model_value(&response->cubic, s);
    for (int k = 0; k < response->modes; k++) value += td_mode_value(&response->mode[k], s);
    return value;
}

static double direct_slope(const td_response *response, double s) {
    double slope = td_model_slope(&response->cubic, s);
    for (int k = 0; k < response->modes; k++) slope += td_mode_slope(&response->mode[k], s);
    return slope;
}

/* Finds the substep that contains s. */
static void find_substep(td_substeps *substeps, const td_response *response, double s) {
    int segment = response->source.segments - 1;
    while (segment > 0 && response->source.segment[segment].from > s) segment--;
    td_substeps_begin(substeps, &response->source, segment);
    while (td_substeps_next(substeps) && substeps->to < s) continue;
}

double td_response_value(const td_response *response, double s) {
    td_substeps substeps;
    if (response->pieces) return td_pieces_value(response->pieces, s);
    if (!response->source.frontend) return direct_value(response, s);
    find_substep(&substeps, response, s);
    return direct_value(response, s) + direct_value(&substeps.response, td_substeps_place(&substeps, s));
}

double td_response_slope(const td_response *response, double s) {
    td_substeps substeps;
    if (response->pieces) return td_pieces_slope(response->pieces, s);
    if (!response->source.frontend) return direct_slope(response, s);
    find_substep(&substeps, response, s);
    return direct_slope(response, s) +
           direct_slope(&substeps.response, td_substeps_place(&substeps, s)) * td_substeps_speed(&substeps, s);
}

/* -- bounds -------------------------------------------------------------------------------------------------------------- */

void td_response_range(const td_response *response, double *low, double *high) {
    const double *b = response->cubic.control;
    double size = 0;
    *low = *high = b[0];
    for (int i = 0; i < 4; i++) {
        *low = b[i] < *low ? b[i] : *low;
        *high = b[i] > *high ? b[i] : *high;
        size = td_greater(fabs(b[i]), size);
    }
    if (response->modes == 0 && !response->source.frontend) return;
    double mode_low = response->source.frontend ? INFINITY : 0, mode_high = -mode_low;
    for (int k = 0; response->source.frontend && k < response->source.segments; k++) {
        mode_low = td_lesser(response->source.segment[k].low, mode_low);
        mode_high = td_greater(response->source.segment[k].high, mode_high);
    }
    for (int k = 0; k <= response->modes; k++) { /* first the source's bounds, or 0 and 0 */
        *low += mode_low;
        *high += mode_high;
        size += td_greater(fabs(mode_low), fabs(mode_high)); /* both are NaN, or neither */
        if (k < response->modes) td_mode_range(&response->mode[k], &mode_low, &mode_high);
    }
    *low -= 16 * DBL_EPSILON * size;
    *high += 16 * DBL_EPSILON * size;
}

/* -- crossings ----------------------------------------------------------------------------------------------------------- */

static int is_finite(const td_response *response) {
    int finite = td_model_is_finite(&response->cubic);
    for (int k = 0; k < response->modes; k++) {
        const td_mode *mode = &response->mode[k];
        finite &= isfinite(mode->rate) && isfinite(mode->frequency) && isfinite(mode->cosine) && isfinite(mode->sine);
    }
    return finite;
}

/* A level, and the part of the step in which its crossing is searched. */
typedef struct request {
    double reference, on, off, from, to;
} request;

/* 1 where a segment's bounds with the cubic's on it reach a level. */
static int may_reach(const td_response *response, int segment, double until, const request *asked) {
    td_response part;
    double low, high;
    td_model cubic = td_model_part(&response->cubic, response->source.segment[segment].from, until);
    td_response_set(&part, &cubic);
    td_response_range(&part, &low, &high);
    low += response->source.segment[segment].low - asked->reference;
    high += response->source.segment[segment].high - asked->reference;
    return high >= asked->on || low <= -asked->off;
}

/* Greatest correction by polish, as a share of the substep: it is for the last digits. A longer Newton step means that S is
 * about to turn, and the crossing is left as it was found. A choice. */
static const double most_polish = 1e-5;

/* The search in the mapped time of a substep takes the cubic that is added to the response as a cubic of that time, too. One
 * Newton step with S itself corrects that error, unless S is about to turn. */
static double polish(const td_response *response, const td_substeps *substeps, const request *asked, int polarity, double s) {
    if (!substeps->map.on || s <= asked->from) return s;
    double v = td_substeps_place(substeps, s), level = asked->reference + (polarity > 0 ? asked->on : -asked->off);
    double off = td_model_value(&response->cubic, s) + direct_value(&substeps->response, v) - level;
    double slope = td_model_slope(&response->cubic, s) + direct_slope(&substeps->response, v) * td_substeps_speed(substeps, s);
    double step = off / slope;
    return fabs(step) <= most_polish * (substeps->to - substeps->from) ? s - step : s;
}

static int crossing_in_segment(const td_response *response, int segment, double until, const request *asked, double *s) {
    td_substeps substeps;
    td_substeps_begin(&substeps, &response->source, segment);
    while (substeps.to < until && td_substeps_next(&substeps)) {
        if (substeps.to < asked->from || substeps.from > asked->to) continue;
        td_response substep;
        td_substeps_with(&substeps, &response->cubic, &substep);
        double begin = td_substeps_place(&substeps, asked->from), end = td_substeps_place(&substeps, asked->to), v;
        int polarity = td_response_crossing(&substep, asked->reference, asked->on, asked->off, begin, end, &v);
        if (polarity == 0) continue;
        *s = polish(response, &substeps, asked, polarity, td_substeps_time(&substeps, v));
        *s = fmin(fmax(*s, asked->from), asked->to);
        return polarity;
    }
    return 0;
}

static int crossing_in_substeps(const td_response *response, const request *asked, double *s) {
    const td_filter_input *source = &response->source;
    for (int k = 0; k < source->segments; k++) {
        double until = k + 1 < source->segments ? source->segment[k + 1].from : 1;
        if (until < asked->from || source->segment[k].from > asked->to || !may_reach(response, k, until, asked)) continue;
        int polarity = crossing_in_segment(response, k, until, asked, s);
        if (polarity) return polarity;
    }
    return 0;
}

int td_response_crossing(const td_response *response, double reference, double threshold_on, double threshold_off, double from,
                         double to, double *s) {
    if (response->pieces) return td_pieces_crossing(response->pieces, reference, threshold_on, threshold_off, from, to, s);
    if (response->modes == 0 && !response->source.frontend)
        return td_crossing_within(&response->cubic, NULL, reference, threshold_on, threshold_off, from, to, s);
    double low, high;
    *s = to;
    td_response_range(response, &low, &high);
    if (!is_finite(response) || !(high - reference >= threshold_on || low - reference <= -threshold_off)) return 0;
    if (!response->source.frontend) return td_modes_crossing(response, reference, threshold_on, threshold_off, from, to, s);
    request asked = {reference, threshold_on, threshold_off, from, to};
    return crossing_in_substeps(response, &asked, s);
}
