/* Test support: the values that the renderer's tiles have at single pixels at single times, by whole tiles at these times.
 * Exact points are compared with them. */
#ifndef TESTS_SUPPORT_TILE_POINTS_H
#define TESTS_SUPPORT_TILE_POINTS_H

#include "render/td_render.h"

/* As td_renderer_points. */
tides_status tile_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                         td_point_value *values, tides_error *error);

#endif
