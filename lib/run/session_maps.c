/* Writes the values that a run's sensor drew for each pixel, as a file for sensor.maps of another run. */
#include "sensor/td_maps.h"
#include "sensor/td_between.h"
#include "sensor/td_sensor.h"
#include "td_session.h"

#include <math.h>
#include <stdlib.h>

/* Takes the values of pixel i. This sensor's pixels are in the image's order, so i is also the index in the maps. */
static void take_pixel(const td_sensor *sensor, size_t i, double value[TD_MAPS]) {
    const double on = td_sensor_threshold_on(sensor, i), off = td_sensor_threshold_off(sensor, i);
    const td_shot_noise *noise = &sensor->noise;
    value[TD_MAP_DEAD] = on >= TD_OUT_OF_REACH;
    value[TD_MAP_ON] = on >= TD_OUT_OF_REACH ? NAN : on;
    value[TD_MAP_OFF] = on >= TD_OUT_OF_REACH ? NAN : off;
    value[TD_MAP_LEAK] = sensor->on && sensor->leak[i] > 0 ? 1e9 * sensor->leak[i] / on : 0;
    value[TD_MAP_NOISE] =
        1e9 * (td_shot_noise_rate(noise, TD_NOISE_SHOT_ON, i) + td_shot_noise_rate(noise, TD_NOISE_SHOT_OFF, i));
    value[TD_MAP_SIZE] = sensor->additive.on ? td_additive_noise_own(&sensor->additive, (uint32_t)i) : NAN;
    value[TD_MAP_HOT] = 1e9 * td_shot_noise_rate(noise, TD_NOISE_HOT, i);
}

tides_status tides_session_maps(tides_session *session, const char *path, tides_error *error) {
    if (!session || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_maps: session or path is NULL");
    const tides_session_facts *facts = &session->facts;
    const int32_t width = facts->intrinsics.width, height = facts->intrinsics.height;
    const td_tile tile = {0, 0, width, width * height};
    const td_sensor_tiles tiles = {&tile, 1, width};
    td_sensor sensor;
    td_maps maps = {.checksum = 0};
    tides_status status = td_session_apart(session, &path, 1, error);
    if (status != TIDES_OK) return status;
    status = td_sensor_create(&facts->values.sensor, TIDES_MODEL_HERMITE, facts->values.image.log_eps, facts->values.start,
                              &tiles, &sensor, error);
    if (status != TIDES_OK) return status;
    for (int m = 0; m < TD_MAPS && status == TIDES_OK; m++)
        if (!(maps.map[m] = td_alloc(sensor.count, sizeof **maps.map, error))) status = TIDES_NO_MEMORY;
    for (size_t i = 0; status == TIDES_OK && i < sensor.count; i++) {
        double value[TD_MAPS];
        take_pixel(&sensor, i, value);
        for (int m = 0; m < TD_MAPS; m++) maps.map[m][i] = value[m];
    }
    if (status == TIDES_OK) status = td_maps_write(path, width, height, &maps, error);
    td_maps_release(&maps);
    td_sensor_release(&sensor);
    return status;
}
