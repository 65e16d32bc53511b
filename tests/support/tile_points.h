/* Test support: L and L_dot of single pixels at single times, taken from whole tiles rendered at these times. Points are
 * compared with them. */
#ifndef TESTS_SUPPORT_TILE_POINTS_H
#define TESTS_SUPPORT_TILE_POINTS_H

#include "render/td_render.h"

/* As td_renderer_points. */
tides_status tile_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                         td_point_value *values, tides_error *error);

#endif
