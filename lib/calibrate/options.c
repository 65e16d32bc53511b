/* A calibration's options, the table of its values, and its progress. */
#include "td_calibrate.h"

#include <math.h>
#include <string.h>

tides_status td_calibrate_told(const td_calibration *c, double fraction, const char *stage, tides_error *error) {
    if (c->progress && c->progress(c->user, fraction, stage)) return td_fail(error, TIDES_CANCELLED, "stopped on request");
    return TIDES_OK;
}

void tides_calibrate_options_defaults(tides_calibrate_options *options) {
    memset(options, 0, sizeof *options);
    options->size = sizeof *options;
    options->start_ns = INT64_MIN;
    options->stop_ns = INT64_MAX;
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) options->given[i] = NAN;
}

int32_t tides_calibrated_at(int32_t index, tides_calibrated_row *row) {
    static const tides_calibrated_row rows[TIDES_CALIBRATED_VALUES] = {
        {"threshold_on", "sensor.threshold_on", "log units"},
        {"threshold_off", "sensor.threshold_off", "log units"},
        {"threshold_sigma", "sensor.threshold_sigma", "log units"},
        {"log_eps", "image.log_eps", ""},
        {"pole_s", "frontend.photoreceptor_cutoff_hz", "s"},
        {"refractory_s", "sensor.refractory_s", "s"},
        {"leak_rate_hz", "sensor.leak_rate_hz", "Hz"},
        {"shot_noise_hz", "frontend.shot_noise_hz", "Hz"},
        {"offset_s", "", "s"},
    };
    if (index < 0 || index >= TIDES_CALIBRATED_VALUES) return 0;
    *row = rows[index];
    return 1;
}
