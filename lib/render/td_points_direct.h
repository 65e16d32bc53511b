/* Internal to lib/render: points that see a splat whose path cubics don't follow, because a clamp (of colour, of the
 * Jacobian, at the near plane) makes a kink in it. A cubic there would be wrong by whole thresholds. All that such a point
 * may see is projected at the point's own time, without curves. That costs several times as much as a point on curves. */
#ifndef TD_POINTS_DIRECT_H
#define TD_POINTS_DIRECT_H

#include "td_points_near.h"

enum { TD_DIRECT_LOT = 256 }; /* most points of a lot */

typedef struct td_points_direct {
    td_point_nodes nodes; /* of a lot (a batch of points): a row for each splat of each point */
    uint8_t *bent;        /* (height x width) 1: pixels that may see such a splat */
    int any;
    int end[TD_DIRECT_LOT]; /* of the lot's points: ends in nodes.gaussians, */
    double time[TD_DIRECT_LOT], x[TD_DIRECT_LOT], y[TD_DIRECT_LOT], values[2 * TD_DIRECT_LOT];
    int most; /* Gaussians of one of them at most */
    int laid; /* Gaussians for which all but nodes.group.gaussians is there: it is the same in each lot */
    td_points_near near;
    size_t capacity[4];
} td_points_direct;

void td_points_direct_release(td_points_direct *direct);

/* Another interval: nothing is bent; and which pixels see what is bent of a group. */
void td_points_direct_clear(const struct tides_renderer *renderer, td_points_direct *direct);
tides_status td_points_direct_add(const struct tides_renderer *renderer, const td_point_nodes *nodes, const float *boxes,
                                  td_points_direct *direct, tides_error *error);

static inline int td_points_direct_sees(const td_points_direct *direct, const td_point *point, int width) {
    return direct->any && direct->bent[(size_t)point->y * (size_t)width + (size_t)point->x];
}

/* The renderer, the camera's path, and the engine that computes points. No values of the engine may be under way. */
typedef struct td_direct_user {
    struct tides_renderer *renderer;
    const tides_trajectory *camera;
    td_points_engine *engine;
} td_direct_user;

/* Computes some points. `exact`: the scene in double; the rows that it held before are lost. */
tides_status td_points_direct_values(const td_direct_user *user, td_points_direct *direct, td_exact *exact,
                                     const td_point_span *span, const td_points_some *some, tides_error *error);

#endif
