/* Test support: the photoreceptor's equations integrated by an independent method, in long double with tiny Runge-Kutta
 * steps. */
#ifndef FRONTEND_ORACLE_H
#define FRONTEND_ORACLE_H

#include "sensor/response/td_frontend.h"

/* Over the part [0, s] of a step of h seconds: `state` as td_frontend_rest has it, and S is returned. `fineness` is the product
 * of the largest rate and the step's length in which Runge-Kutta steps. */
long double oracle_advance(const tides_sensor *sensor, double h, const td_model *input, double log_eps, double s,
                           double fineness, long double state[TD_FRONTEND_STATE]);

#endif
