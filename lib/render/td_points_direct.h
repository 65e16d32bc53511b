/* Internal to lib/render: single pixels that see a splat whose path cubics don't follow (point_nodes.c): a clamp of colour,
 * of the Jacobian or at the near plane makes a kink of it, and what cubics make of that is wrong by thresholds. All that
 * such a pixel may see is projected at the point's own time, and nothing is between rows. It costs ten times as much as a
 * point on curves. */
#ifndef TD_POINTS_DIRECT_H
#define TD_POINTS_DIRECT_H

#include "td_point_nodes.h"
#include "td_render.h"

typedef struct td_points_direct {
    td_points_engine *engine; /* NULL: none has been needed */
    td_point_nodes nodes;     /* of a lot: a row for each splat of each point */
    uint8_t *bent;            /* (height x width) pixels that may see one */
    int any;
    int *end;     /* (points of a lot) in nodes.gaussians; */
    double *time; /* and their times */
    int *lists;   /* what tiles point into */
    int *numbers; /* 0, 1, ... */
    int *sights;  /* (2 x Gaussians of the lot) the pixels that may see each */
    td_points_tile *tiles;
    td_points_chunk *chunks;
    double *column[TD_POINT_COLUMNS], *values;
    int *piece;
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

/* Values of the points numbered which[0 .. count). `exact`: the scene in double, whose rows are others' no more after this. */
tides_status td_points_direct_values(struct tides_renderer *renderer, const tides_trajectory *camera, td_points_direct *direct,
                                     td_exact *exact, const td_point_span *span, const td_point *points, const int *which,
                                     int count, td_point_value *values, tides_error *error);

#endif
