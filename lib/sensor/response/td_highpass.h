/* Internal: the high-pass behind the photoreceptor: what frontend.c needs of it. Its state is y, and what the low-pass is
 * at. */
#ifndef TD_HIGHPASS_H
#define TD_HIGHPASS_H

#include "td_frontend.h"

/* Turns a front end that is off or constant into one with a high-pass, where the sensor has one. TIDES_BAD_ARGUMENT,
 * TIDES_UNSUPPORTED behind filters whose rates go with the light. */
TIDES_MUST_CHECK tides_status td_highpass_make(const tides_sensor *sensor, td_frontend *frontend, tides_error *error);

/* td_frontend_step of TD_FRONTEND_HIGHPASS, for an input that is finite. */
void td_highpass_step(const td_frontend *frontend, double h, const td_model *input, double state[TD_FRONTEND_STATE],
                      td_response *response);

#endif
