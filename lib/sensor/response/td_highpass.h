/* Internal: the high-pass behind the photoreceptor. Its state is y, and z, the output of its low-pass. */
#ifndef TD_HIGHPASS_H
#define TD_HIGHPASS_H

#include "td_frontend.h"

/* Adds the sensor's high-pass to a front end that is off or constant. TIDES_BAD_ARGUMENT; TIDES_UNSUPPORTED behind filters
 * whose rates go with the light. */
TIDES_MUST_CHECK tides_status td_highpass_make(const tides_sensor *sensor, td_frontend *frontend, tides_error *error);

/* td_frontend_step of TD_FRONTEND_HIGHPASS, for an input that is finite. */
void td_highpass_step(const td_frontend *frontend, double h, const td_model *input, double state[TD_FRONTEND_STATE],
                      td_response *response);

#endif
