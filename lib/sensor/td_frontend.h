/* Internal: what the photoreceptor makes of a pixel's log-luminance on a step: exact for a cubic input, so that nothing depends
 * on how long steps are. The filter's state is TD_FRONTEND_STATE doubles per pixel. */
#ifndef TD_FRONTEND_H
#define TD_FRONTEND_H

#include "td_path.h"
#include "tides/sensor.h"

enum { TD_FRONTEND_STATE = 4 };

typedef struct td_frontend {
    const tides_sensor *sensor;
    int on; /* 0: the path is the cubic itself, and there is no state */
} td_frontend;

/* `sensor` must outlive it. TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_frontend_make(const tides_sensor *sensor, td_frontend *frontend, tides_error *error);

/* A pixel that has rested at log-luminance L for ever: its state, and the signal S. */
double td_frontend_rest(const td_frontend *frontend, double L, double log_eps, double state[TD_FRONTEND_STATE]);

/* One step of h seconds with input `input` (log-luminance): `path` is the output S; `state` goes to the step's end. Cutting a
 * step in two changes the output by rounding only. */
void td_frontend_step(const td_frontend *frontend, double h, const td_model *input, double log_eps,
                      double state[TD_FRONTEND_STATE], td_path *path);

#endif
