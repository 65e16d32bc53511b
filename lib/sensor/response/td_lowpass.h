/* Internal: a chain of linear filters with unit gain at rest, as a sum of first-order low-passes of the same input, one for
 * each pole: S = sum of weight_k x_k, x_k' = lambda_k (L - x_k), and the weights add up to 1. Each x_k is exact for a cubic
 * input and well-conditioned for any lambda, from 1e-12 to 1e12 per step; what can cancel is weights of poles that are close.
 * */
#ifndef TD_LOWPASS_H
#define TD_LOWPASS_H

#include "td_complex.h"
#include "td_response.h"

typedef struct td_pole {
    td_complex rate;   /* lambda per step; real part > 0 */
    td_complex weight; /* of a pair: the sum has twice its real part */
    td_complex offset; /* weight (x - origin) at the step's start */
    int pair;          /* 1: it stands for itself and its conjugate */
} td_pole;

/* Poles of one signal. */
typedef struct td_poles {
    td_pole pole[TD_RESPONSE_MODES_MAX];
    int count;
    double origin, start; /* reference of the offsets; S at the start */
} td_poles;

/* The signal over the step. */
void td_poles_respond(const td_poles *poles, const td_model *input, td_response *response);

/* One real pole, whose origin is the input's beginning. Results equal those of td_poles_respond to the bit, in less time. */
void td_pole_respond(double rate, double S, const td_model *input, td_response *response);

/* One pole alone: S' = rate (L - S). */
td_poles td_poles_first_order(double rate, double S, double origin);

/* Second order: S'' + (first + second) S' + first second S = first second L, where first + second = `sum` and first second =
 * `product`; S' = slope at the start. Poles closer than TD_POLES_APART are put that far apart about their mean. */
td_poles td_poles_second_order(double sum, double product, double S, double slope, double origin);

/* A low-pass of `rate` behind a filter: S' = rate (signal - S), S at the start. A rate closer to a pole than TD_POLES_APART is
 * moved by that much. */
td_poles td_poles_then(const td_poles *signal, double rate, double S);

/* Least relative distance of poles: closer ones have weights that cancel too much. Moving a pole by a millionth moves S by a
 * millionth of that pole's lag, and S keeps 10 digits where two poles meet. */
#define TD_POLES_APART 1e-6

#endif
