/* The engine that gives points their values, OpenCL's or its twin in C; and a value taken from it, which must be finite. */
#include "td_points.h"
#include "td_renderer.h"

#include <math.h>

tides_status td_points_create_engine(const tides_renderer *renderer, const td_image_numbers *image, td_points_engine **engine,
                                     tides_error *error) {
    return td_device_has_double(renderer->device) ? td_points_create_opencl(renderer->device, image, engine, error)
                                                  : td_points_create_twin(image, engine, error);
}

tides_status td_point_take(const td_point *point, const double *found, td_point_value *value, tides_error *error) {
    *value = (td_point_value){found[0], found[1]};
    if (isfinite(value->L) && isfinite(value->L_dot)) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "pixel (%d, %d) at %.9g s isn't finite: log_luminance %g, its rate %g",
                   (int)point->x, (int)point->y, point->time, value->L, value->L_dot);
}
