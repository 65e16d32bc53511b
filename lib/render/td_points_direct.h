/* Internal to lib/render: points that see a splat whose path cubics don't follow, because a clamp (of colour, of the
 * Jacobian, at the near plane) makes a kink in it. A cubic there would be wrong by whole thresholds. All that such a point
 * may see is projected at the point's own time, without curves. That costs ten times as much as a point on curves. */
#ifndef TD_POINTS_DIRECT_H
#define TD_POINTS_DIRECT_H

#include "td_points_near.h"

typedef struct td_points_direct {
    td_points_engine *engine; /* NULL: not needed so far */
    td_point_nodes nodes;     /* of a lot (a batch of points): a row for each splat of each point */
    uint8_t *bent;            /* (height x width) 1: pixels that may see such a splat */
    int any;
    int *end;     /* (points of a lot) ends in nodes.gaussians, */
    double *time; /* and times */
    int *lists;   /* lists of the tiles */
    int *numbers; /* 0, 1, ... */
    int *sights;  /* (2 x Gaussians of the lot) the pixels that may see each */
    int laid;     /* Gaussians for which all but nodes.group.gaussians is there: it is the same in each lot */
    td_points_tile *tiles;
    td_points_chunk *chunks;
    double *column[TD_POINT_COLUMNS], *values;
    int *piece;
    td_points_near near;
    td_points_some away; /* the lot that is under way; count 0: there is none */
    size_t gaussian_capacity[6], list_capacity, number_capacity;
} td_points_direct;

void td_points_direct_release(td_points_direct *direct);

/* Another interval: nothing is bent; and which pixels see what is bent of a group. */
void td_points_direct_clear(const struct tides_renderer *renderer, td_points_direct *direct);
tides_status td_points_direct_add(const struct tides_renderer *renderer, const td_point_nodes *nodes, const float *boxes,
                                  td_points_direct *direct, tides_error *error);

static inline int td_points_direct_sees(const td_points_direct *direct, const td_point *point, int width) {
    return direct->any && direct->bent[(size_t)point->y * (size_t)width + (size_t)point->x];
}

/* Computes some points. `exact`: the scene in double; the rows that it held before are lost. */
tides_status td_points_direct_values(struct tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct,
                                     td_exact *exact, const td_point_span *span, const td_points_some *some,
                                     tides_error *error);

#endif
