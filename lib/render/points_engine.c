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

/* Fewest points that are worth a thread of their own. */
enum { FEWEST_POINTS = 4096 };

/* Arguments that the pool's threads share. */
typedef struct taking {
    const td_point *points;
    const int *which;
    const double *found;
    td_point_value *values;
    int count, portions, *wrong; /* wrong: (portions) the first that isn't finite, or -1 */
} taking;

static void take_some(void *user, int k) {
    const taking *of = user;
    const int end = td_pool_begin(of->count, of->portions, k + 1);
    of->wrong[k] = -1;
    for (int i = td_pool_begin(of->count, of->portions, k); i < end && of->wrong[k] < 0; i++) {
        const int own = of->which[i];
        if (td_point_take(&of->points[own], of->found + 2 * (size_t)i, &of->values[own], NULL) != TIDES_OK) of->wrong[k] = i;
    }
}

tides_status td_points_take(td_pool *pool, const td_point *points, const int *which, int count, const double *found,
                            td_point_value *values, tides_error *error) {
    int wrong[TD_POOL_PORTIONS];
    taking of = {points, which, found, values, count, td_pool_portions(pool, count, FEWEST_POINTS), wrong};
    td_pool_run(pool, of.portions, take_some, &of);
    for (int k = 0; k < of.portions; k++)
        if (wrong[k] >= 0)
            return td_point_take(&points[which[wrong[k]]], found + 2 * (size_t)wrong[k], &values[which[wrong[k]]], error);
    return TIDES_OK;
}
