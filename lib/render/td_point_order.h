/* Internal to lib/render: which points of a tile are worked out together (kernels/points.h): neighbours in place and time,
 * which see the same splats and are on the same curves. A tile's points are cut in two where they are farthest apart, and each
 * part again. Along a curve that has neighbours together, as they were before, 3 to 8 % more splats are entered for them. */
#ifndef TD_POINT_ORDER_H
#define TD_POINT_ORDER_H

#include <stdint.h>

/* A point in its tile: its pixel, and when in the interval, TD_PLACE_STEPS of each; and which one it is. */
enum { TD_PLACE_AXES = 3, TD_PLACE_STEPS = 16 };
typedef struct td_point_place {
    uint8_t at[TD_PLACE_AXES];
    int which;
} td_point_place;

/* Orders a tile's places so that those that go together, `lanes` from the first on, are near one another. room: (count). */
void td_point_gather(td_point_place *places, td_point_place *room, int count, int lanes);

#endif
