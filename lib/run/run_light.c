/* Sets keys that follow from the illuminance at Y = 1 (camera.lux) and from the black level (image.log_eps), unless file or
 * override gives them. They become values of the run, so that its record includes them. */
#include "td_base.h"
#include "td_run.h"

#include <math.h>

/* DVS-Voltmeter assumes frames of 8 bits. */
static const double full_scale_dn = 255;

/* Sets a row to a number, clamped to its range, unless it is given. */
static tides_status follow(tides_run *run, const char *key, double number, tides_error *error) {
    const tides_param *row = td_param_find(key);
    if (tides_run_gives(run, key)) return TIDES_OK;
    cJSON *value = cJSON_CreateNumber(fmin(fmax(number, row->lower), row->upper));
    const tides_status status =
        value ? td_run_store(run, row, value, error) : td_fail(error, TIDES_NO_MEMORY, "out of memory: %s", key);
    cJSON_Delete(value);
    return status;
}

tides_status td_run_light(tides_run *run, tides_error *error) {
    const double lux = td_run_number(run, "camera.lux"), dark_lux = td_run_number(run, "sensor.dark_lux");
    tides_status status = TIDES_OK;
    if (tides_run_gives(run, "sensor.dark_lux") && dark_lux > 0 && !(lux > 0))
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: sensor.dark_lux = %g lux: of how much at full scale isn't known; give camera.lux, or image.log_eps",
                       run->origin, dark_lux);
    if (lux > 0 && dark_lux > 0) status = follow(run, "image.log_eps", dark_lux / lux, error);
    const double current = td_run_number(run, "sensor.amperes_per_lux") * lux;
    if (status == TIDES_OK && lux > 0) status = follow(run, "frontend.circuit.photocurrent_a", current, error);
    const double dark = td_run_number(run, "image.log_eps");
    const int32_t is_default = td_param_is_default(td_param_find("image.log_eps"), td_run_value(run, "image.log_eps"));
    if (status == TIDES_OK && !is_default) status = follow(run, "esim.log_eps", dark, error);
    if (status == TIDES_OK && !is_default) status = follow(run, "voltmeter.k2", full_scale_dn * dark, error);
    if (status == TIDES_OK && (lux > 0 || !is_default)) /* IEBCS takes ln(scale Y + 1 lux) */
        status = follow(run, "iebcs.scale", lux > 0 ? lux : 1 / dark, error);
    return status;
}
