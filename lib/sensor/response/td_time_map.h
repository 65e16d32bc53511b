/* Internal: a time of its own for a piece in which a first-order filter's rate goes with the light: S' = r(t) (L - S) is
 * dS/dv = rate (L - S) with a constant rate where v goes as the integral of r. Only L as a function of v is no cubic any more.
 * */
#ifndef TD_WARP_H
#define TD_WARP_H

#include "td_response.h"

enum { TD_WARP_TERMS = 11 };

/* v = sum of term[k] x^k from 0 to 1, rising, where x = 2 u - 1 and u in [0, 1] is the piece's time. */
typedef struct td_warp {
    int on; /* 0: v = u */
    double term[TD_WARP_TERMS];
} td_warp;

/* v for the rate light (e^L - log_eps) + dark, which mustn't be negative on the piece. Returns the rate's mean; `*error` gets
 * the largest relative error of the rate that v stands for. */
double td_warp_make(td_warp *warp, const td_model *L, double log_eps, double light, double dark, double *error);

double td_warp_place(const td_warp *warp, double u); /* v at u */
double td_warp_time(const td_warp *warp, double v);  /* u at v */
double td_warp_speed(const td_warp *warp, double u); /* dv/du */

/* A cubic of u as one of v: with the values and the slopes of both ends. */
td_model td_warp_model(const td_warp *warp, const td_model *model);

#endif
