/* Internal: one substep of a first-order filter whose rate goes with the light: S' = r (L - S). It is straight-line code:
 * substeps.c uses it for one pixel, and light_many.c in loops that vectorise. Both get the same bits.
 *
 * r is light (e^L - log_eps) + dark, times the filter's own rate. The filter cuts e^L - log_eps off at 0; callers use the
 * result only where L >= log(log_eps), so that nothing is cut off here. With x = 2 u - 1, where u in [0, 1] is the substep's
 * time, E = light e^L is a Taylor series about the middle, from E' = L' E. v is the integral of r up to u, over that of the
 * whole substep. In v the rate is constant: dS/dv = rate (L - S), where `rate` is r's integral over the substep. */
#ifndef TD_LIGHT_STEP_H
#define TD_LIGHT_STEP_H

#include "td_exponential.h"
#include "td_extremes.h"
#include "td_tail.h"
#include "td_time_map.h"
#include "td_wide.h"

#include <math.h>

enum { TD_LIGHT_TAIL = 13 }; /* terms of the tail: exact to 1e-13 for rates up to 1 */

#define TD_LIGHT_MOST 60.0 /* greatest log-luminance: an HDR image is far below e^60 */

/* The law of the rate: light (e^L - log_eps) + dark, as a multiple of the filter's own rate. */
typedef struct td_light_law {
    double log_eps, light, dark;
} td_light_law;

/* The series of v, from 0 to 1 over the substep; b: control values of L. Returns the law's mean; `*missing` is the error of
 * the law's series, over the law's least value. */
TD_WITHIN double td_light_series(const double b[4], td_light_law law, double term[TD_TIME_MAP_TERMS], double *missing) {
    const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    const double slope = 0.375 * (d0 + 2 * d1 + d2), twice = 2 * (0.375 * (d2 - d0)), thrice = 3 * (0.125 * (d2 - 2 * d1 + d0));
    const double E0 = law.light * td_exponential(0.125 * (b[0] + 3 * b[1] + 3 * b[2] + b[3]));
    const double E1 = slope * E0, E2 = (slope * E1 + twice * E0) * (1.0 / 2);
    const double E3 = (slope * E2 + twice * E1 + thrice * E0) * (1.0 / 3);
    const double E4 = (slope * E3 + twice * E2 + thrice * E1) * (1.0 / 4);
    const double E5 = (slope * E4 + twice * E3 + thrice * E2) * (1.0 / 5);
    const double E6 = (slope * E5 + twice * E4 + thrice * E3) * (1.0 / 6);
    const double E7 = (slope * E6 + twice * E5 + thrice * E4) * (1.0 / 7); /* the last one is the error */
    const double i1 = E0 + (law.dark - law.light * law.log_eps), i2 = E1 * (1.0 / 2), i3 = E2 * (1.0 / 3), i4 = E3 * (1.0 / 4);
    const double i5 = E4 * (1.0 / 5), i6 = E5 * (1.0 / 6), i7 = E6 * (1.0 / 7);
    const double odd = i1 + i3 + i5 + i7, even = i2 + i4 + i6, by = 1 / (2 * odd);
    term[0] = (odd - even) * by; /* 0 at x = -1 */
    term[1] = i1 * by;
    term[2] = i2 * by;
    term[3] = i3 * by;
    term[4] = i4 * by;
    term[5] = i5 * by;
    term[6] = i6 * by;
    term[7] = i7 * by;
    const double least = law.light * (td_exponential(td_lesser(b[0], b[3])) - law.log_eps) + law.dark;
    *missing = 2 * fabs(E7) / least;
    return odd;
}

/* v at x, within [0, 1]. */
TD_WITHIN double td_light_place(const double term[TD_TIME_MAP_TERMS], double x) {
    double sum = term[7] * x + term[6];
    sum = sum * x + term[5];
    sum = sum * x + term[4];
    sum = sum * x + term[3];
    sum = sum * x + term[2];
    sum = sum * x + term[1];
    sum = sum * x + term[0];
    return td_lesser(td_greater(sum, 0), 1);
}

/* The control values of L as a cubic of v: with the values and the slopes of both ends. */
TD_WITHIN void td_light_mapped(const double b[4], const double term[TD_TIME_MAP_TERMS], double mapped[4]) {
    const double odd = term[1] + 3 * term[3] + 5 * term[5] + 7 * term[7];
    const double even = 2 * term[2] + 4 * term[4] + 6 * term[6];
    mapped[0] = b[0];
    mapped[1] = b[0] + (b[1] - b[0]) / (2 * (odd - even));
    mapped[2] = b[3] - (b[3] - b[2]) / (2 * (odd + even));
    mapped[3] = b[3];
}

/* S at the substep's end: S' = rate (L - S) at v = 1, to 1e-13; b: control values of L. */
TD_WITHIN double td_light_end(double rate, double S, const double b[4]) {
    const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2], offset = S - b[0];
    const double l1 = 3 * d0, l2 = 3 * (d1 - d0), l3 = d2 - 2 * d1 + d0;
    const double x1 = -(rate * offset), x2 = rate * (l1 - x1) * (1.0 / 2), x3 = rate * (l2 - x2) * (1.0 / 3);
    const double slow = S + x1 + x2 + x3 + rate * (l3 - x3) * (1.0 / 4) * td_tail_series(-td_lesser(rate, 1), TD_LIGHT_TAIL);
    const double inverse = 1 / rate, p2 = l2 - l3 * inverse * 3, p1 = l1 - p2 * inverse * 2, size = offset + p1 * inverse;
    const double fast = S - size + p1 + p2 + l3 + size * td_exponential(-rate);
    return rate > 1 ? fast : slow;
}

/* The result of a substep. */
typedef struct td_light_answer {
    double rate;      /* of the filter in v */
    double end;       /* S at the end */
    double mapped[4]; /* control values of L in v */
    double error;     /* error of S, estimated at u = 1/4, 1/2 and 3/4; NaN: not solved */
} td_light_answer;

/* `seconds`: the substep's length [s] times the filter's own rate [1/s], at which the law is 1. */
TD_WITHIN td_light_answer td_light_step(const double b[4], double S, double seconds, td_light_law law,
                                        double term[TD_TIME_MAP_TERMS]) {
    td_light_answer answer;
    const td_model input = {{b[0], b[1], b[2], b[3]}};
    double missing;
    answer.rate = seconds * td_light_series(b, law, term, &missing);
    td_light_mapped(b, term, answer.mapped);
    answer.end = td_light_end(answer.rate, S, answer.mapped);
    const td_model mapped = {{answer.mapped[0], answer.mapped[1], answer.mapped[2], answer.mapped[3]}};
    const double L1 = td_model_value(&input, 0.25), L2 = td_model_value(&input, 0.5), L3 = td_model_value(&input, 0.75);
    const double e1 = fabs(td_model_value(&mapped, td_light_place(term, -0.5)) - L1);
    const double e2 = fabs(td_model_value(&mapped, td_light_place(term, 0)) - L2);
    const double e3 = fabs(td_model_value(&mapped, td_light_place(term, 0.5)) - L3);
    const double g1 = fabs(L1 - S) + fabs(b[1] - b[0]), g2 = fabs(L2 - S) + fabs(b[2] - b[0]);
    const double lag = td_greater(td_greater(g1, g2), fabs(L3 - S) + fabs(b[3] - b[0]));
    const double odd = (e1 + e2 + e3) - (e1 + e2 + e3); /* 0, or NaN */
    answer.error = td_greater(td_greater(e1, e2), e3) + missing * lag + odd;
    return answer;
}

#endif
