/* Internal: one pixel's signal on one step as the comparator sees it, exactly as the front end gives it: a cubic in time, plus
 * decaying modes, by which filters remember their past. Time within the step is s in [0, 1].
 *
 * Functions that are cubic in s (a leak's ramp) may be added to `cubic` before the response is used. The response of a filter
 * whose rates go with the light refers to its front end, which must outlive it. It computes its substeps again in each call,
 * unless they are kept. */
#ifndef TD_RESPONSE_H
#define TD_RESPONSE_H

#include "signal/td_crossing.h"
#include "signal/td_pieces.h"

#include <stddef.h>

enum { TD_RESPONSE_MODES_MAX = 4, TD_FRONTEND_STATE = 4, TD_SEGMENTS_MAX = 8 };

/* The real part of (cosine + i sine) B(s) with lambda = rate + i frequency, both per step, rate >= 0. B is
 *   e^(-lambda s)            that is, e^(-rate s) (cosine cos(frequency s) + sine sin(frequency s))
 *   its part beyond s^3      where `tail`: the sum over k >= 4 of (-lambda)^(k-4) s^k / k!, for |lambda| <= 1. With it slow
 *                            filters need no difference of a large cubic and a large mode. */
typedef struct td_mode {
    double rate, frequency, cosine, sine;
    int tail;
} td_mode;

/* The state of a filter whose rates go with the light at a place of the step, and bounds of S from there to the next such
 * place. */
typedef struct td_segment {
    double from, length; /* of the first substep to try */
    double state[TD_FRONTEND_STATE];
    double low, high;
    int tried;
    int number; /* of the first substep */
} td_segment;

/* The response of such a filter: its input, and segments, at which a walk along substeps can begin. */
typedef struct td_filter_input {
    const struct td_frontend *frontend;  /* NULL: there is none, and other members aren't set */
    const struct td_kept_substeps *kept; /* nullable: all substeps as they were solved; else walks solve them again */
    td_model input;                      /* log-luminance */
    double h, log_eps, dark_L;           /* dark_L: L of Y = 0, log(log_eps) */
    int segments;
    td_segment segment[TD_SEGMENTS_MAX];
} td_filter_input;

/* S(s) = cubic + modes + the response to `source`. A response of zeros except `cubic` is that cubic. */
typedef struct td_response {
    td_model cubic;
    const td_pieces *pieces; /* nullable; replace the cubic, which then only gives the ends; without modes and source */
    int modes;               /* 0: only the cubic */
    td_mode mode[TD_RESPONSE_MODES_MAX];
    td_filter_input source;
} td_response;

/* Makes the response that is this cubic; other members aren't set. */
static inline void td_response_set(td_response *response, const td_model *cubic) {
    response->cubic = *cubic;
    response->pieces = NULL;
    response->modes = 0;
    response->source.frontend = NULL;
}

double td_response_value(const td_response *response, double s);
double td_response_slope(const td_response *response, double s);

/* The first s in [from, to] at which S - reference >= threshold_on (returns +1) or <= -threshold_off (-1), 0 where there is
 * none; `from` <= `to` within [0, 1]. S on a level counts as reached. No two crossings within the step can cancel and go
 * unseen, but for bumps that are lower than rounding. Bounded work for any input: NaN and infinities reach nothing. */
int td_response_crossing(const td_response *response, double reference, double threshold_on, double threshold_off, double from,
                         double to, double *s);

/* Bounds of S on the whole step, rounding included. */
void td_response_range(const td_response *response, double *low, double *high);

#endif
