/* Exposed pictures by the run's exposure.* keys: light over an exposure time, with a global or rolling shutter, and noise.
 * The colour picture and the grey one, both of 8 bits, come from the same exposure. */
#include "td_dataset.h"

#include <math.h>

void td_exposed_between(const td_member *camera, int64_t us, int64_t *from_us, int64_t *to_us) {
    double from, to;
    tides_exposure_span(&camera->facts.values.exposure, camera->facts.intrinsics.height, 0, &from, &to);
    *from_us = us + (int64_t)floor(1e6 * from);
    *to_us = us + (int64_t)ceil(1e6 * to);
}

tides_status td_exposed_make(const td_member *camera, const tides_trajectory *path, tides_renderer *renderer,
                             const td_picture *picture, const td_exposed *to, tides_error *error) {
    double *light = to->light;
    uint16_t *values = to->values;
    const int32_t width = camera->facts.intrinsics.width, height = camera->facts.intrinsics.height;
    const double *weights = camera->facts.values.image.luminance;
    const size_t pixels = td_pixels(camera);
    tides_exposure exposure = camera->facts.values.exposure;
    exposure.colour = 1;
    exposure.bits = 8;
    double *y = light + 3 * pixels;
    tides_status status = tides_renderer_expose(renderer, path, td_seconds(picture->us), &exposure, light, NULL, error);
    if (status == TIDES_OK) status = tides_exposure_values(&exposure, width, height, picture->index, light, values, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < 3 * pixels; i++) to->rgb[i] = (uint8_t)values[i];
    for (size_t i = 0; i < pixels; i++)
        y[i] = weights[0] * light[i] + weights[1] * light[pixels + i] + weights[2] * light[2 * pixels + i];
    exposure.colour = 0;
    status = tides_exposure_values(&exposure, width, height, picture->index, y, values, error);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++) to->grey[i] = (uint8_t)values[i];
    return status;
}
