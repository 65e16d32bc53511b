/* The parameters of a sensor that a caller gets first, with their sources. */
#include "tides/sensor.h"

void tides_sensor_defaults(tides_sensor *sensor) {
    /* DVS128 at 100 lux (nominal constants of wengflow's simulator). */
    const tides_circuit dvs128 = {.photocurrent_a = 2000e-15,
                                  .dark_current_a = 4e-15,
                                  .gain = 140,
                                  .kappa = 0.7,
                                  .thermal_v = 0.025,
                                  .photodiode_f = 35e-15,
                                  .miller_f = 0.6e-15,
                                  .output_s = 1815e-6,
                                  .source_follower_hz = 3122,
                                  .difference_hz = 16000};
    *sensor = (tides_sensor){.size = sizeof *sensor, .max_events_per_step = 64, .threshold_on = 0.2, .threshold_off = 0.2};
    sensor->threshold_min = 0.01; /* the limit of v2e and ESIM */
    sensor->hot_pixel_rate_hz = 100;
    sensor->temperature_c = 25;
    sensor->kick_recovery_s = 2e-3; /* a DAVIS240C's as measured: rows 35.3 us apart, recovery about 2 ms */
    sensor->kick_row_s = 35.3e-6;
    sensor->kick_rate_hz = 25; /* libcaer's frame interval, and its exposure */
    sensor->kick_reads_s[1] = 4e-3;
    sensor->noise_cutoff_hz = 1000;
    sensor->circuit = dvs128;
}
