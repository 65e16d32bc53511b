/* Internal: how a sensor is made and begun, and how its pixels are woken, for the files of lib/sensor alone. */
#ifndef TD_SENSOR_PARTS_H
#define TD_SENSOR_PARTS_H

#include "td_sensor.h"

/* Makes the list of what pixels carry, when all arrays exist. */
TIDES_MUST_CHECK tides_status td_sensor_list(td_sensor *sensor, tides_error *error);

/* The state of a pixel that has rested at log-luminance L: its signal less its reference, the time since its last reset, and
 * how long it is still held [ns]. All are 0 where references begin at the signal. */
typedef struct td_initial {
    double offset, age, held;
} td_initial;
td_initial td_sensor_initial(const td_sensor *sensor, size_t pixel, double L);

/* Draws the random numbers of td_sensor_initial, when the rest of the sensor exists. */
tides_status td_sensor_draw_initial(td_sensor *sensor, const td_sensor_tiles *tiles, tides_error *error);

/* Sets the time of the pixel's next wake-up, after any of its parts changed. */
void td_sensor_set_wake(const td_sensor *sensor, size_t pixel);

#endif
