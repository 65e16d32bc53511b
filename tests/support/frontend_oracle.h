/* Test support: the photoreceptor's equations integrated by an independent method, in long double with tiny Runge-Kutta
 * steps. */
#ifndef FRONTEND_ORACLE_H
#define FRONTEND_ORACLE_H

#include "sensor/response/td_frontend.h"

/* Integrates over the part [0, s] of a step of h seconds (s from 0 to 1) and returns S. `state` begins as td_frontend_rest
 * sets it. `fineness`: largest rate times length of a Runge-Kutta step. */
long double oracle_advance(const tides_sensor *sensor, double h, const td_model *input, double log_eps, double s,
                           double fineness, long double state[TD_FRONTEND_STATE]);

#endif
